//! Reads an SVG picture back: texts with their boxes, shapes with their colours.

use roxmltree::{Document, Node};

/// Units of the drawing in one px, as in the view box.
const UNITS_PER_PX: f64 = 10.0;
/// Width of a character over the size of the face: the mean of Liberation Sans is 0.52.
const CHARACTER: f64 = 0.52;

/// An upright box in px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Area {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Area {
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        let apart = |a: f64, b: f64| a >= b - 0.05;
        !(apart(self.left, other.right)
            || apart(other.left, self.right)
            || apart(self.top, other.bottom)
            || apart(other.top, self.bottom))
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Words {
    pub(crate) text: String,
    pub(crate) anchor_point: (f64, f64),
    pub(crate) area: Area,
    pub(crate) size_px: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shape {
    pub(crate) colour: String,
    pub(crate) points: Vec<(f64, f64)>,
}

#[derive(Debug, Clone, Default)]
pub(crate) struct Picture {
    pub(crate) size: (f64, f64),
    pub(crate) words: Vec<Words>,
    pub(crate) lines: Vec<Shape>,
    pub(crate) polygons: Vec<Shape>,
    pub(crate) rectangles: Vec<(String, Area)>,
    pub(crate) circles: Vec<(f64, f64)>,
}

impl Picture {
    /// Parses the picture; malformed XML fails the test.
    pub(crate) fn read(svg: &str) -> Self {
        let document = Document::parse(svg).unwrap();
        let root = document.root_element();
        assert_eq!(root.tag_name().name(), "svg");
        let side = |name| root.attribute(name).unwrap().parse::<f64>().unwrap();
        let mut picture = Self {
            size: (side("width"), side("height")),
            ..Self::default()
        };
        for node in root.children().filter(Node::is_element) {
            let number =
                |name: &str| node.attribute(name).unwrap().parse::<f64>().unwrap() / UNITS_PER_PX;
            let colour = |name| node.attribute(name).unwrap_or_default().to_owned();
            match node.tag_name().name() {
                "text" => picture.words.push(words(&node)),
                "polyline" => {
                    picture.lines.push(Shape {
                        colour: colour("stroke"),
                        points: points(&node),
                    });
                }
                "polygon" => {
                    picture.polygons.push(Shape {
                        colour: colour("fill"),
                        points: points(&node),
                    });
                }
                "rect" => {
                    let (left, top) = (number("x"), number("y"));
                    let (right, bottom) = (left + number("width"), top + number("height"));
                    picture.rectangles.push((
                        colour("fill"),
                        Area {
                            left,
                            top,
                            right,
                            bottom,
                        },
                    ));
                }
                "circle" => picture.circles.push((number("cx"), number("cy"))),
                "title" | "style" => {}
                other => panic!("unexpected element {other}"),
            }
        }
        picture
    }

    pub(crate) fn has(&self, text: &str) -> bool {
        self.words.iter().any(|words| words.text == text)
    }

    pub(crate) fn find(&self, text: &str) -> &Words {
        self.words.iter().find(|words| words.text == text).unwrap()
    }

    /// The plot, from the line along its left and lower edge.
    pub(crate) fn plot(&self) -> Area {
        let frame = self
            .lines
            .iter()
            .find(|l| l.colour == "#555555" && l.points.len() == 3);
        let points = &frame.unwrap().points;
        Area {
            left: points[1].0,
            top: points[0].1,
            right: points[2].0,
            bottom: points[1].1,
        }
    }

    pub(crate) fn lines_of(&self, colour: &str) -> Vec<&Shape> {
        self.lines
            .iter()
            .filter(|line| line.colour == colour)
            .collect()
    }

    pub(crate) fn rectangles_of(&self, colour: &str) -> Vec<Area> {
        self.rectangles
            .iter()
            .filter(|(fill, _)| fill == colour)
            .map(|(_, area)| *area)
            .collect()
    }

    /// Fails when two texts touch or a text leaves the picture.
    pub(crate) fn assert_texts_apart(&self) {
        for (index, words) in self.words.iter().enumerate() {
            let area = words.area;
            let inside = area.left >= 0.0
                && area.top >= 0.0
                && area.right <= self.size.0
                && area.bottom <= self.size.1;
            assert!(inside, "outside: {words:?}");
            for other in &self.words[index + 1..] {
                assert!(!area.overlaps(&other.area), "{words:?}\n{other:?}");
            }
        }
    }
}

fn points(node: &Node<'_, '_>) -> Vec<(f64, f64)> {
    let pair = |text: &str| {
        let (x, y) = text.split_once(',').unwrap();
        (
            x.parse::<f64>().unwrap() / UNITS_PER_PX,
            y.parse::<f64>().unwrap() / UNITS_PER_PX,
        )
    };
    node.attribute("points")
        .unwrap()
        .split_whitespace()
        .map(pair)
        .collect()
}

fn words(node: &Node<'_, '_>) -> Words {
    let text = node.text().unwrap_or_default().trim().to_owned();
    let number = |name| node.attribute(name).unwrap().parse::<f64>().unwrap() / UNITS_PER_PX;
    let (x, y, size_px) = (number("x"), number("y"), number("font-size"));
    let width = text.chars().count() as f64 * CHARACTER * size_px;
    let (before, after) = match node.attribute("text-anchor").unwrap() {
        "start" => (0.0, width),
        "middle" => (0.5 * width, 0.5 * width),
        _ => (width, 0.0),
    };
    let half = 0.5 * size_px;
    let upward = node
        .attribute("transform")
        .is_some_and(|turn| turn.starts_with("rotate(270"));
    let area = if upward {
        Area {
            left: x - half,
            top: y - after,
            right: x + half,
            bottom: y + before,
        }
    } else {
        Area {
            left: x - before,
            top: y - half,
            right: x + after,
            bottom: y + half,
        }
    };
    Words {
        text,
        anchor_point: (x, y),
        area,
        size_px,
    }
}
