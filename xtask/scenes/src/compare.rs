//! Compares an answer with the recorded one: numbers within named tolerances, texts exactly.

use std::fmt;

use serde_json::{Map, Value};

/// How far a number may be from the recorded one. The first class that fits decides.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tolerance {
    pub(crate) name: &'static str,
    /// What of the path, from the root of the answer, must be there; empty for every path.
    keys: &'static [&'static str],
    /// Of the larger of both numbers.
    relative: f64,
    /// Of the width of the interval in the same object.
    of_width: f64,
    /// In the number's own unit.
    absolute: f64,
}

/// The classes. Order of sums differs between processors with and without fused multiplications, and between profiles: what a
/// search converges to differs by more than rounding, but by far less than its interval.
const TOLERANCES: [Tolerance; 2] = [
    Tolerance {
        name: "near rounding",
        // directions that the data do not show are rounding errors, and searches end at steps of any size
        keys: &["/gap/ratio", "/singular_values/", "/last_step"],
        relative: 1e-2,
        of_width: 0.0,
        absolute: 1e-9,
    },
    Tolerance {
        name: "value",
        keys: &[],
        relative: 1e-9,
        of_width: 1e-6,
        absolute: 1e-15,
    },
];

/// Keys of the two ends of an interval.
const INTERVALS: [&str; 3] = ["ci95", "reduction_ci95", "ci95_rad"];

/// Something that is not as it was recorded.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Difference {
    /// Where in the answer.
    pub(crate) path: String,
    pub(crate) recorded: Option<Value>,
    pub(crate) now: Option<Value>,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let said = |own: &Option<Value>| match own {
            Some(own) => own.to_string().chars().take(200).collect(),
            None => "absent".to_owned(),
        };
        let (recorded, now) = (said(&self.recorded), said(&self.now));
        write!(f, "{}: {recorded} -> {now}", self.path)
    }
}

/// Everything that differs, in the order of the recorded answer.
pub(crate) fn compare(recorded: &Value, now: &Value) -> Vec<Difference> {
    let mut differences = Vec::new();
    walk("", recorded, now, 0.0, &mut differences);
    differences
}

/// Every number that is not the same to its last recorded digit.
pub(crate) fn exact(one: &Value, other: &Value) -> Vec<Difference> {
    let mut differences = compare(one, other);
    if differences.is_empty() && one != other {
        differences.push(Difference {
            path: "within every tolerance".to_owned(),
            recorded: None,
            now: None,
        });
    }
    differences
}

/// `width` is that of the interval around.
fn walk(path: &str, recorded: &Value, now: &Value, width: f64, found: &mut Vec<Difference>) {
    let mut both =
        |path: String, old: Option<&Value>, new: Option<&Value>, width: f64| match (old, new) {
            (Some(old), Some(new)) => walk(&path, old, new, width, found),
            (recorded, now) => found.push(Difference {
                path,
                recorded: recorded.cloned(),
                now: now.cloned(),
            }),
        };
    match (recorded, now) {
        (Value::Object(old), Value::Object(new)) => {
            let width = interval(old).unwrap_or(width);
            let added = new.keys().filter(|key| !old.contains_key(*key));
            for key in old.keys().chain(added) {
                both(format!("{path}/{key}"), old.get(key), new.get(key), width);
            }
        }
        (Value::Array(old), Value::Array(new)) => {
            for index in 0..old.len().max(new.len()) {
                both(
                    format!("{path}/{index}"),
                    old.get(index),
                    new.get(index),
                    width,
                );
            }
        }
        _ if is_same(path, recorded, now, width) => {}
        _ => found.push(Difference {
            path: path.to_owned(),
            recorded: Some(recorded.clone()),
            now: Some(now.clone()),
        }),
    }
}

/// Whether a number is near enough, or anything else the same.
fn is_same(path: &str, recorded: &Value, now: &Value, width: f64) -> bool {
    let (Value::Number(old), Value::Number(new)) = (recorded, now) else {
        return recorded == now;
    };
    let [old, new] = [old, new].map(|own| own.as_f64().unwrap_or(f64::NAN));
    tolerance(path).holds(old, new, width)
}

impl Tolerance {
    fn holds(&self, recorded: f64, now: f64, width: f64) -> bool {
        let size = recorded.abs().max(now.abs());
        let allowed = (self.relative * size).max(self.of_width * width);
        (recorded - now).abs() <= allowed.max(self.absolute)
    }
}

fn tolerance(path: &str) -> Tolerance {
    let [near_rounding, value] = TOLERANCES;
    let is_near = near_rounding.keys.iter().any(|key| path.contains(key));
    if is_near { near_rounding } else { value }
}

/// Width of the interval in an object.
fn interval(object: &Map<String, Value>) -> Option<f64> {
    INTERVALS.iter().find_map(|key| {
        let ends = object.get(*key)?;
        let width = ends.get(1)?.as_f64()? - ends.get(0)?.as_f64()?;
        (width > 0.0).then_some(width)
    })
}

pub(crate) fn tolerances() -> String {
    let said = TOLERANCES.iter().map(|own| {
        let (relative, width, absolute) = (own.relative, own.of_width, own.absolute);
        let which = match own.keys {
            [] => "others".to_owned(),
            keys => keys.join(", "),
        };
        format!(
            "{}: {relative:e} relative, {width:e} of its interval's width or {absolute:e} ({which})",
            own.name
        )
    });
    said.collect::<Vec<_>>().join("; ")
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::compare;

    fn paths(recorded: &serde_json::Value, now: &serde_json::Value) -> Vec<String> {
        let found = compare(recorded, now);
        found.into_iter().map(|own| own.path).collect()
    }

    #[test]
    fn a_millionth_of_the_interval_is_allowed_and_no_more() {
        let value = |value: f64| json!({"value": value, "ci95": [900.0, 1100.0]});
        assert!(paths(&value(1000.0), &value(1000.0001)).is_empty());
        assert_eq!(paths(&value(1000.0), &value(1000.0003)), ["/value"]);
        let bare = |value: f64| json!({"rms": value});
        assert!(paths(&bare(1.0), &bare(1.0 + 1e-10)).is_empty());
        assert_eq!(paths(&bare(1.0), &bare(1.0 + 1e-8)), ["/rms"]);
        let sign = [json!({"rms": 1.0}), json!({"rms": -1.0})];
        assert_eq!(paths(&sign[0], &sign[1]), ["/rms"]);
    }

    #[test]
    fn what_is_new_what_is_gone_and_each_word_is_a_difference() {
        let recorded = json!({"verdict": "named", "gone": 1, "causes": [{"effect": "backlash"}]});
        let now = json!({"verdict": "named", "new": 1, "causes": [{"effect": "slip"}, {}]});
        let expected = ["/causes/0/effect", "/causes/1", "/gone", "/new"];
        assert_eq!(paths(&recorded, &now), expected);
        let words = [json!({"answer": "a gap"}), json!({"answer": "a gap."})];
        assert_eq!(paths(&words[0], &words[1]), ["/answer"]);
    }

    #[test]
    fn directions_that_the_data_do_not_show_may_be_any_rounding_error() {
        let found = |value: f64| json!({"singular_values": [1.0, value]});
        assert!(paths(&found(1e-17), &found(3e-16)).is_empty());
        assert_eq!(paths(&found(0.5), &found(0.6)), ["/singular_values/1"]);
    }
}
