//! Compares two JSON values: numbers within a tolerance, names exactly, sentences apart.

use std::fmt;

use serde_json::Value;

/// Largest relative change of a number.
const RELATIVE: f64 = 1e-9;
/// Largest change of a value over the half width of its 95 % interval.
const OF_HALF_WIDTH: f64 = 1e-3;
/// Largest change of a number that is 0 but for rounding: a residual in metres or radians, a share.
const ROUNDING: f64 = 1e-15;
/// Key of what says how a result was made, not what it is.
const PROVENANCE: &str = "provenance";
/// Keys of columns in the tables of a report whose cells are texts with numbers.
const RATIOS_NEAR_ROUNDING: [&str; 2] = ["gap", "singular_values"];

/// Something that is not as it was recorded.
#[derive(Debug)]
pub(super) struct Difference {
    path: String,
    recorded: String,
    found: String,
    of_words: bool,
}

impl Difference {
    /// Whether a sentence changed rather than a number or a name.
    pub(super) fn is_of_words(&self) -> bool {
        self.of_words
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} -> {}", self.path, self.recorded, self.found)
    }
}

/// Everything that differs. A key that is new is no difference; one that is gone is.
pub(super) fn compare(recorded: &Value, found: &Value) -> Vec<Difference> {
    let mut walk = Walk::default();
    walk.values("", recorded, found, 0.0);
    walk.differences
}

#[derive(Debug, Default)]
struct Walk {
    differences: Vec<Difference>,
}

impl Walk {
    /// `allowed` is the change that the interval around allows.
    fn values(&mut self, path: &str, recorded: &Value, found: &Value, allowed: f64) {
        match (recorded, found) {
            (Value::Object(old), Value::Object(new)) => {
                let allowed = half_width(recorded).map_or(allowed, |half| OF_HALF_WIDTH * half);
                for (key, value) in old.iter().filter(|(key, _)| *key != PROVENANCE) {
                    let path = format!("{path}/{key}");
                    match new.get(key) {
                        Some(other) => self.values(&path, value, other, allowed),
                        None => self.add(&path, value, &Value::Null, false),
                    }
                }
            }
            (Value::Array(old), Value::Array(new)) if old.len() == new.len() => {
                for (index, (value, other)) in old.iter().zip(new).enumerate() {
                    self.values(&format!("{path}/{index}"), value, other, allowed);
                }
            }
            (Value::Number(old), Value::Number(new)) => {
                let (old, new) = (old.as_f64(), new.as_f64());
                let near = old.zip(new).is_some_and(|(old, new)| {
                    let size = old.abs().max(new.abs());
                    (old - new).abs() <= allowed.max(RELATIVE * size).max(ROUNDING)
                });
                if !near && !is_rounding(path, recorded, found) {
                    self.add(path, recorded, found, false);
                }
            }
            _ if recorded == found => {}
            (Value::String(old), Value::String(new)) => {
                self.add(path, recorded, found, is_sentence(old) && is_sentence(new));
            }
            (Value::Array(old), Value::Array(new)) if old.iter().chain(new).all(is_text) => {
                self.add(path, recorded, found, true);
            }
            _ => self.add(path, recorded, found, false),
        }
    }

    fn add(&mut self, path: &str, recorded: &Value, found: &Value, of_words: bool) {
        let short = |value: &Value| value.to_string().chars().take(80).collect();
        self.differences.push(Difference {
            path: path.to_owned(),
            recorded: short(recorded),
            found: short(found),
            of_words,
        });
    }
}

/// Half the width of the interval in an object.
fn half_width(object: &Value) -> Option<f64> {
    ["ci95", "reduction_ci95", "ci95_rad"]
        .iter()
        .find_map(|key| {
            let ends = object.get(key)?;
            let half = 0.5 * (ends.get(1)?.as_f64()? - ends.get(0)?.as_f64()?);
            (half > 0.0).then_some(half)
        })
}

/// Whether a number is the rounding error of a direction that the data do not show.
fn is_rounding(path: &str, recorded: &Value, found: &Value) -> bool {
    let tiny = |value: &Value| value.as_f64().is_some_and(|value| value.abs() < 1e-9);
    RATIOS_NEAR_ROUNDING
        .iter()
        .any(|key| path.contains(&format!("/{key}/")))
        && tiny(recorded)
        && tiny(found)
}

fn is_sentence(text: &str) -> bool {
    text.trim().contains(' ')
}

fn is_text(value: &Value) -> bool {
    value.as_str().is_some_and(is_sentence)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::compare;

    fn moved(recorded: &serde_json::Value, found: &serde_json::Value) -> (usize, usize) {
        let differences = compare(recorded, found);
        let words = differences.iter().filter(|one| one.is_of_words()).count();
        (differences.len() - words, words)
    }

    #[test]
    fn a_thousandth_of_the_half_width_is_allowed_and_no_more() {
        let value = |value: f64| json!({"value": value, "ci95": [0.9, 1.1]});
        assert_eq!(moved(&value(1.0), &value(1.00009)), (0, 0));
        assert_eq!(moved(&value(1.0), &value(1.0002)), (1, 0));
        assert_eq!(
            moved(&json!({"rms": 1.0}), &json!({"rms": 1.0 + 1e-10})),
            (0, 0)
        );
        assert_eq!(
            moved(&json!({"rms": 1.0}), &json!({"rms": 1.0 + 1e-8})),
            (1, 0)
        );
    }

    #[test]
    fn a_name_or_a_missing_key_moved_and_a_sentence_was_reworded() {
        let recorded = json!({"verdict": "named", "warnings": ["one thing", "another one"]});
        let found = json!({"verdict": "unknown", "warnings": ["one thing"], "new": 1});
        assert_eq!(moved(&recorded, &found), (1, 1));
        assert_eq!(moved(&json!({"verdict": "named"}), &json!({})), (1, 0));
        assert_eq!(
            moved(
                &json!({"why": "no column"}),
                &json!({"why": "t_s is absent"})
            ),
            (0, 1)
        );
    }
}
