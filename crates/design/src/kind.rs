//! Kinds of measurement by the names that a user gives them: one table entry each.

use haptical_model::Tracker;

use crate::DesignError;

/// One thing that a rig measures.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Measure {
    /// Every external encoder that the device file describes.
    Outputs,
    /// The external encoder of a joint, described or not.
    Output {
        /// Joint, from 0.
        joint: usize,
    },
    /// A cable encoder.
    Cable {
        /// Cable, from 0.
        index: usize,
        /// Where it leaves its guide in frame (-1) \[m\]; none for the device file's place.
        anchor_m: Option<[f64; 3]>,
        /// Whether its anchor and zero are fitted.
        unknown: bool,
    },
    /// A tracker of the handle.
    Tracker(Tracking),
    /// Sockets at unknown places that the handle is put into.
    Contact {
        /// How many.
        points: usize,
        /// Distance between the first two, where it is known \[m\].
        distance_m: Option<f64>,
    },
    /// Planes at unknown places that the handle touches.
    Plane {
        /// 1, or 2 at a right angle.
        planes: usize,
    },
    /// A homing fixture, at the home pose.
    Fixture {
        /// Joint, from 0; none for all.
        joint: Option<usize>,
    },
}

/// What a tracker sees, and what is known of its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tracking {
    /// Whether it sees the orientation too.
    pub orientation: bool,
    /// Whether it measures in frame (-1).
    pub base_known: bool,
    /// Whether it sees the handle frame itself.
    pub tool_known: bool,
}

/// What follows the name of a tracker, and whether it knows its base and its tool then.
const UNKNOWN: [(&[&str], bool, bool); 4] = [
    (&[], true, true),
    (&["unknown-base"], false, true),
    (&["unknown-tool"], true, false),
    (&["unknown"], false, false),
];

impl Tracking {
    /// How it is written.
    pub(crate) fn name(self) -> String {
        let known = (self.base_known, self.tool_known);
        let mut parts = vec![if self.orientation { "pose" } else { "position" }];
        for (arguments, base, tool) in UNKNOWN {
            if (base, tool) == known {
                parts.extend(arguments);
            }
        }
        parts.join(":")
    }

    /// Trackers that see or know one thing more.
    pub(crate) fn better(self) -> impl Iterator<Item = Self> {
        let better = [
            Self {
                orientation: true,
                ..self
            },
            Self {
                base_known: true,
                ..self
            },
            Self {
                tool_known: true,
                ..self
            },
        ];
        better.into_iter().filter(move |better| *better != self)
    }
}

/// How a cable is written, by its index from 0.
pub(crate) fn cable_name(index: usize) -> String {
    match index {
        0 => "cable".to_owned(),
        _ => format!("cable{}", index + 1),
    }
}

/// A kind of measurement in the table.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    /// Name that an item begins with.
    pub name: &'static str,
    /// How it is written.
    pub form: &'static str,
    /// What it is.
    pub meaning: &'static str,
    read: fn(Item<'_>) -> Result<Measure, String>,
}

/// An item taken apart: the number behind the name, and what follows each colon.
#[derive(Debug, Clone, Copy)]
struct Item<'t> {
    number: Option<usize>,
    arguments: &'t [&'t str],
}

/// Every kind, in the order of the help text.
///
/// ```
/// let names: Vec<&str> = haptical_design::KINDS.iter().map(|kind| kind.name).collect();
/// assert!(names.contains(&"cable") && names.contains(&"pose"));
/// ```
pub const KINDS: &[Kind] = &[
    Kind {
        name: "out",
        form: "out, outN",
        meaning: "external encoders of the device file, or one on joint N",
        read: output,
    },
    Kind {
        name: "cable",
        form: "cable, cableN:x,y,z[:unknown]",
        meaning: "cable encoder N, its exit at x, y, z m in frame (-1); unknown: exit and zero are fitted",
        read: cable,
    },
    Kind {
        name: "position",
        form: "position[:unknown-base|:unknown-tool|:unknown]",
        meaning: "handle position from a tracker",
        read: |item| tracker(item, false),
    },
    Kind {
        name: "pose",
        form: "pose[:unknown-base|:unknown-tool|:unknown]",
        meaning: "handle position and orientation from a tracker",
        read: |item| tracker(item, true),
    },
    Kind {
        name: "contact",
        form: "contact[:K[:DISTANCE]]",
        meaning: "K sockets at unknown places (1); DISTANCE in m between the first two, if known",
        read: contact,
    },
    Kind {
        name: "plane",
        form: "plane[:2]",
        meaning: "a touched plane at an unknown place, or two at a right angle",
        read: plane,
    },
    Kind {
        name: "fixture",
        form: "fixture, fixtureN",
        meaning: "homing fixture of all joints, or of joint N",
        read: fixture,
    },
];

/// What a rig measures.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// As it was given.
    pub name: String,
    /// Its measurements.
    pub measures: Vec<Measure>,
}

impl Rig {
    /// The same with a tracker's place and what it sees as a device or rig file states them, where the rig says nothing of either.
    ///
    /// ```
    /// let tracker = haptical_model::Tracker {
    ///     base_known: false,
    ///     base_per_run: false,
    ///     tool_known: true,
    ///     position_sd_m: None,
    ///     rotation_sd_rad: None,
    ///     scale_sd: None,
    /// };
    /// let rig = haptical_design::Rig::parse("cable,position")?.with_tracker_as(&tracker);
    /// assert_eq!(rig.name, "cable,position:unknown-base");
    /// # Ok::<(), haptical_design::DesignError>(())
    /// ```
    #[must_use]
    pub fn with_tracker_as(mut self, stated: &Tracker) -> Self {
        for measure in &mut self.measures {
            let Measure::Tracker(own) = measure else {
                continue;
            };
            if !own.base_known || !own.tool_known {
                continue;
            }
            let bare = own.name();
            own.base_known = stated.base_known;
            own.tool_known = stated.tool_known;
            let items = self.name.split(',').map(|item| match item.trim() == bare {
                true => own.name(),
                false => item.to_owned(),
            });
            self.name = items.collect::<Vec<_>>().join(",");
        }
        self
    }

    /// Reads items separated by commas, such as `out,cable,cable2:0.4,0,0.3`. A piece that begins with a
    /// digit, a sign or a point belongs to the item before it.
    ///
    /// ```
    /// use haptical_design::{Measure, Rig};
    /// let rig = Rig::parse("cable,cable2:0.4,-0.1,0.3")?;
    /// assert_eq!(rig.measures.len(), 2);
    /// let anchor_m = Some([0.4, -0.1, 0.3]);
    /// assert_eq!(rig.measures[1], Measure::Cable { index: 1, anchor_m, unknown: false });
    /// # Ok::<(), haptical_design::DesignError>(())
    /// ```
    ///
    /// # Errors
    /// [`DesignError::Measure`] with the item.
    pub fn parse(text: &str) -> Result<Self, DesignError> {
        let mut items: Vec<String> = Vec::new();
        for piece in text.split(',').map(str::trim) {
            let continues = piece.starts_with(|first: char| {
                first.is_ascii_digit() || matches!(first, '-' | '+' | '.')
            });
            match items.last_mut() {
                Some(item) if continues => {
                    item.push(',');
                    item.push_str(piece);
                }
                _ => items.push(piece.to_owned()),
            }
        }
        let measures = items.iter().map(|item| measure(item));
        let measures: Vec<Measure> = measures.collect::<Result<_, _>>()?;
        for (index, one) in measures.iter().enumerate() {
            if let Some(twice) = measures[..index]
                .iter()
                .position(|other| clashes(one, other))
            {
                let message = format!("`{}` is there already: name each once", items[twice]);
                let item = items[index].clone();
                return Err(DesignError::Measure { item, message });
            }
        }
        Ok(Self {
            name: items.join(","),
            measures,
        })
    }

    /// The same rig with one more measurement.
    #[must_use]
    pub fn with(&self, name: &str, measure: Measure) -> Self {
        let mut more = self.clone();
        more.name = format!("{},{name}", self.name);
        more.measures.push(measure);
        more
    }
}

/// Whether two measurements are the same thing.
fn clashes(a: &Measure, b: &Measure) -> bool {
    match (a, b) {
        (Measure::Cable { index: a, .. }, Measure::Cable { index: b, .. }) => a == b,
        (Measure::Output { joint: a }, Measure::Output { joint: b }) => a == b,
        _ => std::mem::discriminant(a) == std::mem::discriminant(b),
    }
}

fn measure(text: &str) -> Result<Measure, DesignError> {
    let refuse = |message: String| DesignError::Measure {
        item: text.to_owned(),
        message,
    };
    let mut parts = text.split(':').map(str::trim);
    let head = parts.next().unwrap_or_default();
    let name = head.trim_end_matches(|last: char| last.is_ascii_digit());
    let Some(kind) = KINDS.iter().find(|kind| kind.name == name) else {
        let known: Vec<&str> = KINDS.iter().map(|kind| kind.form).collect();
        let what = "there is no such kind; write one of";
        return Err(refuse(format!("{what} {}", known.join(", "))));
    };
    let digits = &head[name.len()..];
    let number = match digits.parse::<usize>() {
        Ok(number) if (1..=MOST).contains(&number) => Some(number),
        _ if digits.is_empty() => None,
        _ => return Err(refuse(format!("give a number from 1 to {MOST}"))),
    };
    let arguments: Vec<&str> = parts.collect();
    let item = Item {
        number,
        arguments: &arguments,
    };
    (kind.read)(item).map_err(|message| refuse(format!("{message}; it is written {}", kind.form)))
}

/// Most cables, joints or sockets that a name counts to.
const MOST: usize = 64;
/// Coordinates beyond this are no place in a laboratory \[m\].
const FARTHEST_M: f64 = 1e3;

fn no_number(item: Item<'_>) -> Result<(), String> {
    match item.number {
        None => Ok(()),
        Some(number) => Err(format!("the name takes no number {number}")),
    }
}

fn nothing_more(arguments: &[&str]) -> Result<(), String> {
    match arguments.first() {
        None => Ok(()),
        Some(more) => Err(format!("`{more}` is one too many")),
    }
}

fn length(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() && value.abs() <= FARTHEST_M => Ok(value),
        _ => Err(format!("`{text}` is not a length in m")),
    }
}

fn output(item: Item<'_>) -> Result<Measure, String> {
    nothing_more(item.arguments)?;
    Ok(match item.number {
        None => Measure::Outputs,
        Some(number) => Measure::Output { joint: number - 1 },
    })
}

fn cable(item: Item<'_>) -> Result<Measure, String> {
    let index = item.number.map_or(0, |number| number - 1);
    let (mut anchor_m, mut unknown) = (None, false);
    for argument in item.arguments {
        if *argument == "unknown" && !unknown {
            unknown = true;
            continue;
        }
        let numbers: Vec<f64> = argument.split(',').map(length).collect::<Result<_, _>>()?;
        let place: [f64; 3] = numbers
            .try_into()
            .map_err(|_| format!("`{argument}` is not x,y,z"))?;
        if anchor_m.replace(place).is_some() {
            return Err("two places".to_owned());
        }
    }
    Ok(Measure::Cable {
        index,
        anchor_m,
        unknown,
    })
}

fn tracker(item: Item<'_>, orientation: bool) -> Result<Measure, String> {
    no_number(item)?;
    let known = UNKNOWN.iter().find(|known| known.0 == item.arguments);
    let Some(&(_, base_known, tool_known)) = known else {
        return Err(format!("`{}` is not known", item.arguments[0]));
    };
    Ok(Measure::Tracker(Tracking {
        orientation,
        base_known,
        tool_known,
    }))
}

fn contact(item: Item<'_>) -> Result<Measure, String> {
    no_number(item)?;
    let (points, distance) = match item.arguments {
        [] => ("1", None),
        [points] => (*points, None),
        [points, distance] => (*points, Some(*distance)),
        [_, _, more, ..] => return Err(format!("`{more}` is one too many")),
    };
    let points = match points
        .split_whitespace()
        .next()
        .unwrap_or("")
        .parse::<usize>()
    {
        Ok(points) if (1..=MOST).contains(&points) => points,
        _ => return Err(format!("`{points}` is not a number of sockets")),
    };
    let distance_m = distance.map(length).transpose()?;
    match distance_m {
        Some(distance_m) if points < 2 || distance_m <= 0.0 => {
            Err("a distance above 0 needs two sockets".to_owned())
        }
        _ => Ok(Measure::Contact { points, distance_m }),
    }
}

fn plane(item: Item<'_>) -> Result<Measure, String> {
    no_number(item)?;
    match item.arguments {
        [] | ["1"] => Ok(Measure::Plane { planes: 1 }),
        ["2"] => Ok(Measure::Plane { planes: 2 }),
        [other, ..] => Err(format!("`{other}` is not 1 or 2")),
    }
}

fn fixture(item: Item<'_>) -> Result<Measure, String> {
    nothing_more(item.arguments)?;
    Ok(Measure::Fixture {
        joint: item.number.map(|number| number - 1),
    })
}
