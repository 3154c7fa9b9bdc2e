//! Whether an answer to a changed log keeps the law.

use serde_json::Value;

use crate::laws::Allows;

/// Evidence, in nats, from which a name may not come or go.
const NATS: f64 = 10.0;
/// Probability from which a name is asserted: that of a verdict `named`.
const ASSERTED: f64 = 0.8;
/// Width of an interval of every row twice over that of each once: rounding, and searches that end a step earlier.
const NARROWER: f64 = 0.98;
/// Parameter that is a time of the log.
const TIME: &str = "time_s";
/// What an answer may differ by besides its interval: of a number whose interval is its rounding.
const RELATIVE: f64 = 1e-6;

/// A scene's truth and its answers, before and after a change.
pub(super) struct Pair<'p> {
    /// Names that are right.
    pub(super) truth: &'p [&'static str],
    /// `{"identify": .., "diagnose": ..}`.
    pub(super) before: &'p Value,
    pub(super) after: &'p Value,
}

impl Pair<'_> {
    /// What of the law is broken, in words; none where it holds.
    pub(super) fn broken(&self, allows: Allows) -> Option<String> {
        if allows == Allows::SameBits {
            let differences = crate::compare::exact(self.before, self.after);
            return differences.first().map(|own| format!("other bits: {own}"));
        }
        let (before, after) = (&self.before["diagnose"], &self.after["diagnose"]);
        if before["refused"].is_null() != after["refused"].is_null() {
            let words = |own: &Value| own["refused"].as_str().unwrap_or("answered").to_owned();
            return Some(format!("{} -> {}", words(before), words(after)));
        }
        self.verdict()
            .or_else(|| self.numbers(allows))
            .or_else(|| match allows {
                Allows::Same | Allows::OtherTimes | Allows::SameBits => None,
                Allows::SameIdentification => self.identification(false),
                Allows::NoNarrowerInterval => self.identification(true),
            })
    }

    fn verdict(&self) -> Option<String> {
        let (before, after) = (&self.before["diagnose"], &self.after["diagnose"]);
        let verdicts = [before, after].map(|own| own["verdict"].as_str().unwrap_or_default());
        let turned = |what: String| format!("{} -> {}: {what}", verdicts[0], verdicts[1]);
        let is_gap = verdicts.map(|own| own != "no-gap");
        let is_true = |name: &&Name| self.truth.contains(&name.effect.as_str());
        if is_gap[0] && !is_gap[1] && nats(before) >= NATS {
            return Some(turned("the gap is gone".to_owned()));
        }
        let asserted = asserted(after);
        let considered = considered(before);
        let mut gained = asserted.iter().filter(|own| !is_true(own));
        let gained = gained.find(|own| !considered.contains(own));
        if let Some(name) = gained.filter(|_| nats(after) >= NATS) {
            return Some(turned(format!("{name} is named")));
        }
        let is_true_now = asserted.iter().any(|own| is_true(&own));
        if !is_gap[0] && is_gap[1] && !is_true_now && nats(after) >= NATS {
            return Some(turned("a gap that was none".to_owned()));
        }
        let still = self::considered(after);
        // a size that is so near to zero has no evidence that is so far from any threshold
        let of_size = |own: &Name| {
            causes(before)
                .iter()
                .any(|cause| Name::of(cause) == *own && size_nats(cause) >= NATS)
        };
        let mut lost = self::asserted(before).into_iter();
        let lost = lost.find(|own| is_true(&own) && !still.contains(own) && of_size(own));
        lost.filter(|_| nats(before) >= NATS)
            .map(|name| turned(format!("{name} is lost")))
    }

    /// Numbers of causes that both answers have.
    fn numbers(&self, allows: Allows) -> Option<String> {
        let before = causes(&self.before["diagnose"]);
        let after = causes(&self.after["diagnose"]);
        for (own, other) in pairs(&before, &after) {
            let parameters = own["parameters"].as_object().into_iter().flatten();
            let is_asked = |key: &str| !(allows == Allows::OtherTimes && key == TIME);
            for (key, own) in parameters.filter(|(key, _)| is_asked(key)) {
                let name = Name::of(other);
                let now = &other["parameters"][key];
                if let Some(words) = outside(own, now) {
                    return Some(format!("{name}: {key} {words}"));
                }
            }
        }
        None
    }

    /// Numbers of the calibration, and how wide their intervals are.
    fn identification(&self, asks_width: bool) -> Option<String> {
        let list = |own: &Value| own["identify"]["parameters"].as_array().cloned();
        let (before, after) = (list(self.before)?, list(self.after)?);
        // other rows are held out of another order, and a polynomial's basis is that of the range of the fitted ones
        let ranges = |own: &Value| -> Vec<Value> {
            let drives = own["identify"]["transmissions"].as_array();
            let ranges = drives.into_iter().flatten().map(|own| &own["range_rad"]);
            ranges.cloned().collect()
        };
        let is_other_basis = ranges(self.before) != ranges(self.after);
        let is_compared = |own: &&Value| {
            let name = own["name"].as_str().unwrap_or_default();
            !(is_other_basis && name.starts_with("chebyshev"))
        };
        for own in before.iter().filter(is_compared) {
            let mut others = after.iter();
            let Some(now) = others.find(|other| other["name"] == own["name"]) else {
                continue;
            };
            let name = own["name"].as_str().unwrap_or_default();
            if let Some(words) = outside(own, now) {
                return Some(format!("identify: {name} {words}"));
            }
            let [width, width_now] = [own, now].map(width);
            let narrower = width
                .zip(width_now)
                .filter(|(own, now)| *now < NARROWER * own);
            if let Some((own, now)) = narrower.filter(|_| asks_width) {
                return Some(format!(
                    "identify: the interval of {name} is {:.2} times as wide",
                    now / own
                ));
            }
        }
        None
    }
}

/// An effect at a joint.
#[derive(Debug, Clone, PartialEq)]
struct Name {
    effect: String,
    joint: Option<u64>,
}

impl Name {
    fn of(cause: &Value) -> Self {
        Self {
            effect: cause["effect"].as_str().unwrap_or_default().to_owned(),
            joint: cause["joint"].as_u64(),
        }
    }
}

impl std::fmt::Display for Name {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.joint {
            Some(joint) => write!(f, "{}@{joint}", self.effect),
            None => write!(f, "{}", self.effect),
        }
    }
}

fn causes(gap: &Value) -> Vec<Value> {
    gap["causes"].as_array().cloned().unwrap_or_default()
}

/// Causes of the same name in both.
fn pairs<'v>(before: &'v [Value], after: &'v [Value]) -> Vec<(&'v Value, &'v Value)> {
    let pair = |own: &'v Value| {
        let mut others = after.iter();
        let mut alone = before
            .iter()
            .filter(|other| Name::of(other) == Name::of(own));
        // two changes of one kind at one joint are not told from each other
        let is_alone = alone.next().is_some() && alone.next().is_none();
        let other = others.find(|other| Name::of(other) == Name::of(own))?;
        is_alone.then_some((own, other))
    };
    before.iter().filter_map(pair).collect()
}

/// What is said to be a cause.
fn asserted(gap: &Value) -> Vec<Name> {
    let is_named = gap["verdict"] == "named";
    let sure = |cause: &&Value| cause["probability"].as_f64().unwrap_or(0.0) >= ASSERTED;
    let causes = causes(gap);
    let named = causes.iter().filter(|_| is_named).filter(sure);
    named.map(Name::of).collect()
}

/// Every name that an answer gives, with those that it is confused with.
fn considered(gap: &Value) -> Vec<Name> {
    let is_given = gap["verdict"] == "named" || gap["verdict"] == "ambiguous";
    let mut names = Vec::new();
    for cause in causes(gap).iter().filter(|_| is_given) {
        let own = Name::of(cause);
        for other in cause["confusable_with"].as_array().into_iter().flatten() {
            let other = other.as_str().unwrap_or_default();
            let (effect, joint) = match other.split_once('@') {
                Some((effect, joint)) => (effect, joint.parse().ok()),
                None => (other, own.joint),
            };
            let effect = effect.to_owned();
            names.push(Name { effect, joint });
        }
        names.push(own);
    }
    names
}

/// Evidence that a cause's sizes are not all zero: half the square of the surest in its standard deviations; without bound where it has none.
fn size_nats(cause: &Value) -> f64 {
    let sizes = cause["parameters"].as_object().into_iter().flatten();
    let nats = sizes.filter_map(|(_, size)| {
        Some(0.5 * (size["value"].as_f64()? / (width(size)? / 3.92)).powi(2))
    });
    nats.reduce(f64::max).unwrap_or(f64::INFINITY)
}

/// Evidence of an answer's gap: half the squares beyond noise that its causes close, or all of them where it has none, and of
/// candidates how far the next name is behind.
fn nats(gap: &Value) -> f64 {
    let rows = gap["provenance"]["rows"].as_f64().unwrap_or(1.0);
    let number = |own: &Value| own.as_f64().unwrap_or(0.0);
    let is_answered = gap["verdict"] == "named" || gap["verdict"] == "ambiguous";
    let channels = gap["gap"]["channels"].as_array().into_iter().flatten();
    let of_channel = |own: &Value| {
        let [before, after, floor] =
            ["rms_before", "rms_after", "noise_floor"].map(|key| number(&own[key]));
        let left = if is_answered { after.max(floor) } else { floor };
        match floor > 0.0 {
            true => 0.5 * rows * (before.powi(2) - left.powi(2)).max(0.0) / floor.powi(2),
            false => 0.0,
        }
    };
    let closed: f64 = channels.map(of_channel).sum();
    let given: Vec<String> = considered(gap).into_iter().map(|own| own.effect).collect();
    let candidates = gap["candidates"].as_array().into_iter().flatten();
    let others = candidates.filter(|own| {
        let name = own["effect"].as_str().unwrap_or_default();
        !given.iter().any(|own| own == name)
    });
    let behind = others.map(|own| number(&own["nats_behind"]));
    match is_answered {
        true => behind.fold(closed, f64::min),
        false => closed,
    }
}

/// Width of a number's interval.
fn width(own: &Value) -> Option<f64> {
    Some(own["ci95"][1].as_f64()? - own["ci95"][0].as_f64()?)
}

/// In words how a number left its interval; none where one of the two has no number.
fn outside(own: &Value, now: &Value) -> Option<String> {
    let value = own["value"].as_f64()?;
    let other = now["value"].as_f64()?;
    let [low, high] = [own["ci95"][0].as_f64()?, own["ci95"][1].as_f64()?];
    let slack = RELATIVE * value.abs();
    let is_outside = other < low - slack || other > high + slack;
    is_outside.then(|| format!("{value:.4e} [{low:.4e}, {high:.4e}] -> {other:.4e}"))
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::Pair;
    use crate::laws::Allows;

    fn answer(verdict: &str, effect: &str, value: f64) -> Value {
        let cause = json!({"effect": effect, "joint": 2, "probability": 0.97, "confusable_with": [],
            "parameters": {"delay_s": {"value": value, "ci95": [value - 0.1, value + 0.1]}}});
        let causes = if effect.is_empty() {
            json!([])
        } else {
            json!([cause])
        };
        let after = if verdict == "unknown" { 5.0 } else { 1.0 };
        let channel = json!({"rms_before": 5.0, "rms_after": after, "noise_floor": 1.0});
        json!({"diagnose": {"verdict": verdict, "causes": causes, "candidates": [], "provenance": {"rows": 1000},
            "gap": {"channels": [channel]}}})
    }

    fn broken(before: &Value, after: &Value) -> Option<String> {
        let truth = &["lag"];
        Pair {
            truth,
            before,
            after,
        }
        .broken(Allows::Same)
    }

    #[test]
    fn a_true_name_that_is_lost_and_a_false_one_that_is_gained_break_a_law() {
        let (named, unknown) = (answer("named", "lag", 1.0), answer("unknown", "", 0.0));
        let (false_name, none) = (answer("named", "play", 1.0), answer("no-gap", "", 0.0));
        assert_eq!(broken(&named, &named), None);
        assert!(broken(&named, &unknown).unwrap().contains("lag@2 is lost"));
        assert!(
            broken(&unknown, &false_name)
                .unwrap()
                .contains("play@2 is named")
        );
        assert!(broken(&named, &none).unwrap().contains("the gap is gone"));
        assert!(
            broken(&none, &unknown)
                .unwrap()
                .contains("a gap that was none")
        );
        // the other way round all is well
        assert_eq!(broken(&unknown, &named), None);
        assert_eq!(broken(&none, &named), None);
        assert_eq!(broken(&false_name, &unknown), None);
    }

    #[test]
    fn what_hardly_stands_out_may_come_and_go() {
        let mut named = answer("named", "lag", 1.0);
        named["diagnose"]["candidates"] = json!([{"effect": "play", "nats_behind": 3.0}]);
        assert_eq!(broken(&named, &answer("unknown", "", 0.0)), None);
    }

    #[test]
    fn a_number_stays_within_its_interval() {
        let at = |value| answer("named", "lag", value);
        assert_eq!(broken(&at(1.0), &at(1.09)), None);
        assert!(broken(&at(1.0), &at(1.2)).unwrap().contains("delay_s"));
    }

    #[test]
    fn rows_that_are_there_twice_tell_no_more() {
        let with = |half: f64| {
            let mut answer = answer("no-gap", "", 0.0);
            let parameter = json!({"name": "a1", "value": 1.0, "ci95": [1.0 - half, 1.0 + half]});
            answer["identify"] = json!({"parameters": [parameter]});
            answer
        };
        let pair = |after: &Value, allows| {
            let before = with(0.1);
            let pair = Pair {
                truth: &[],
                before: &before,
                after,
            };
            pair.broken(allows)
        };
        assert_eq!(pair(&with(0.1), Allows::NoNarrowerInterval), None);
        assert!(pair(&with(0.07), Allows::NoNarrowerInterval).is_some());
        assert_eq!(pair(&with(0.07), Allows::SameIdentification), None);
    }

    #[test]
    fn another_bit_is_another_answer() {
        let (one, other) = (json!({"diagnose": 1.0}), json!({"diagnose": 1.0 + 1e-12}));
        let pair = |after| Pair {
            truth: &[],
            before: &one,
            after,
        };
        assert_eq!(pair(&one).broken(Allows::SameBits), None);
        assert!(pair(&other).broken(Allows::SameBits).is_some());
    }
}
