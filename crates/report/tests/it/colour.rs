//! Colours on a dark page: one for each that a picture has, and far enough from the page and from each other.

use std::collections::BTreeMap;

use haptical_report::{Figure, HeatCell, HeatMap, Mark, Series};

const PAPER: &str = "#FFFFFF";
const INK: &str = "#222222";
const SHADE: &str = "#5AB4E8";

/// A picture with every colour of the palette.
fn figure() -> String {
    let mut figure = Figure::new("T", "x [m]", "y [m]");
    let series = |colour| Series::new("s", Mark::Line, colour, vec![(0.0, 0.0), (1.0, 1.0)]);
    figure.series = (0..8).map(series).collect();
    figure.to_svg(640, 400).unwrap()
}

fn map() -> String {
    let mut map = HeatMap::new("T", vec!["c".to_owned()]);
    let text = "1".to_owned();
    map.rows
        .push(("r".to_owned(), vec![Some(HeatCell { shade: 1.0, text })]));
    map.to_svg(300).unwrap()
}

/// Dark colours by light ones, of rules such as `[fill="#0072B2"]{fill:#4AA3E0}`.
fn dark(svg: &str, paint: &str) -> BTreeMap<String, String> {
    let start = format!("[{paint}=\"");
    let count = svg.split(&start).skip(1).count();
    let rules = svg.split(&start).skip(1).map(|rule| {
        let (light, rest) = rule.split_once("\"]{").unwrap();
        let (dark, _) = rest.split_once('}').unwrap();
        (light.to_owned(), dark.split_once(':').unwrap().1.to_owned())
    });
    let rules: BTreeMap<String, String> = rules.collect();
    assert_eq!(rules.len(), count, "two rules for one colour");
    rules
}

/// Relative luminance by WCAG 2.2.
fn luminance(colour: &str) -> f64 {
    let channel = |from: usize| {
        let share = f64::from(u8::from_str_radix(&colour[from..from + 2], 16).unwrap()) / 255.0;
        match share <= 0.04045 {
            true => share / 12.92,
            false => ((share + 0.055) / 1.055).powf(2.4),
        }
    };
    0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
}

fn contrast(one: &str, other: &str) -> f64 {
    let (a, b) = (luminance(one) + 0.05, luminance(other) + 0.05);
    a.max(b) / a.min(b)
}

#[test]
fn every_colour_of_a_picture_has_a_dark_one() {
    for svg in [figure(), map()] {
        for paint in ["fill", "stroke"] {
            let rules = dark(&svg, paint);
            let (_, drawing) = svg.split_once("</style>").unwrap();
            let attribute = format!(" {paint}=\"#");
            for used in drawing.split(&attribute).skip(1) {
                let used = format!("#{}", &used[..6]);
                assert!(rules.contains_key(&used), "{used}");
            }
        }
        assert_eq!(dark(&svg, "fill"), dark(&svg, "stroke"));
    }
}

/// WCAG 2.2: 3 for graphics, 4.5 for letters.
#[test]
fn lines_and_letters_stand_out_from_both_pages() {
    let rules = dark(&figure(), "fill");
    let page = &rules[PAPER];
    for index in 0..8 {
        let svg = {
            let mut figure = Figure::new("T", "", "");
            figure.series = vec![Series::new(
                "",
                Mark::Line,
                index,
                vec![(0.0, 0.0), (1.0, 1.0)],
            )];
            figure.to_svg(300, 200).unwrap()
        };
        let (_, drawing) = svg.split_once("</style>").unwrap();
        let light = drawing.split(" stroke=\"").skip(1).map(|rest| &rest[..7]);
        let light = light
            .filter(|light| !["#E2E2E2", "#555555"].contains(light))
            .last()
            .unwrap();
        assert!(contrast(&rules[light], page) >= 3.0, "{index}: {light}");
        if [Series::BEFORE, Series::AFTER].contains(&index) {
            assert!(contrast(light, PAPER) >= 3.0 && contrast(&rules[light], page) >= 4.5);
        }
    }
    for under in [PAPER, SHADE] {
        assert!(
            contrast(INK, under) >= 4.5 && contrast(&rules[INK], &rules[under]) >= 4.5,
            "{under}"
        );
    }
}
