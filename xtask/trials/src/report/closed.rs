//! Figures of the loop: a corrected device predicts a recording that it has not seen; an effect that is not there is not
//! found.

use haptical_report::{Cell, ReportError, Table};
use xtask_blind::{Answer, Rate, Verdict};
use xtask_output::cells;

use crate::batch::Case;
use crate::closing::Closing;
use crate::measure::{Bar, Measure, Value, number, quantile};

/// Suites of the loop: one effect, two effects.
const LOOPS: [(&str, &str); 2] = [("sl", "one effect"), ("slp", "two effects")];
/// Clean recordings of which an effect is asked.
const ABSENT: &str = "sla";
/// A recording of which less of the gap is closed is listed \[%\].
const LITTLE: f64 = 75.0;

/// Part of a channel's largest prediction by which C and replay may differ.
const SAME: f64 = 1e-9;

/// Why a trial is counted apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Apart {
    /// What happened in one recording does not happen again in the next.
    Event,
    /// No effect was found that is part of a device.
    NotCorrected,
}

impl Apart {
    fn of(case: &Case) -> Option<Self> {
        let mut effects = case.truth.effects.iter();
        if effects.any(|effect| effect.events.iter().any(|events| !events.is_empty())) {
            return Some(Self::Event);
        }
        case.closing.is_none().then_some(Self::NotCorrected)
    }
}

pub(super) fn measures(cases: &[Case]) -> Vec<Measure> {
    let group = "the loop: a corrected device on a fresh recording";
    let of = |suites: &[&str]| -> Vec<&Case> {
        let wanted = cases.iter().filter(|case| suites.contains(&case.suite));
        wanted.filter(|case| case.error.is_none()).collect()
    };
    let mut all = vec![];
    let mut add = |what: &str, suites: &[&str], is_judged: bool| {
        let scored = of(suites);
        let scored = scored.iter().filter(|case| Apart::of(case).is_none());
        let closings: Vec<_> = scored.filter_map(|case| case.closing.as_ref()).collect();
        let shares = closings.iter().filter_map(|own| own.closed_percent);
        let shares: Vec<f64> = shares.collect();
        let at = |share: f64| number(&shares, 1, "%", move |values| quantile(values, share));
        let is_quiet = |own: &&Closing| own.again.verdict == Verdict::NoGap;
        let quiet = closings.iter().map(is_quiet);
        let bar = |least: f64| is_judged.then_some(Bar::AtLeast(least));
        let mut put = |name: &str, value: Value, bar: Option<Bar>| {
            all.push(Measure::new(group, format!("{name}, {what}"), value, bar));
        };
        put("gap closed, median", at(0.5), bar(90.0));
        put("gap closed, worst tenth", at(0.1), bar(75.0));
        let quiet = Value::Share(Rate::of_cases(quiet));
        put("then no gap against it", quiet, bar(0.9));
        let by_c = closings.iter().filter_map(|own| own.by_c.as_ref());
        let by_c: Vec<_> = by_c.collect();
        let shares: Vec<f64> = by_c.iter().filter_map(|own| own.closed_percent).collect();
        let median = number(&shares, 1, "%", |values| quantile(values, 0.5));
        put("gap closed by the exported C, median", median, None);
        let same = by_c.iter().map(|own| own.apart <= SAME);
        let same = Value::Share(Rate::of_cases(same));
        let name = "the exported C predicts what --replay does, to 1e-9";
        put(name, same, None);
    };
    add("all", &LOOPS.map(|(suite, _)| suite), true);
    for (suite, what) in LOOPS {
        add(what, &[suite], false);
    }
    for (suite, what) in LOOPS {
        let cases = of(&[suite]);
        let is = |wanted: Apart| {
            let apart = cases.iter().map(|case| Apart::of(case) == Some(wanted));
            Value::Share(Rate::of_cases(apart))
        };
        let mut put = |name: &str, value: Value| {
            all.push(Measure::new(group, format!("{name}, {what}"), value, None));
        };
        put("apart: an event", is(Apart::Event));
        put("apart: no corrected device", is(Apart::NotCorrected));
    }
    let fits = of(&[ABSENT]);
    let fits = fits.iter().filter_map(|case| case.fit.as_ref());
    all.push(Measure::new(
        "an effect that is not there",
        "fitted, and said not to be shown",
        Value::Share(Rate::of_cases(fits.map(|fit| !fit.shown))),
        Some(Bar::AtLeast(0.97)),
    ));
    all
}

/// The trials in which the loop is not closed, and those that are counted apart.
pub(crate) fn table(cases: &[Case]) -> Result<Table, ReportError> {
    let heads = "trial | truth | corrected device has | gap closed | then | why it is here";
    let mut table = Table::with_heads("", heads);
    for case in cases {
        let is_of_loop = LOOPS.iter().any(|(suite, _)| *suite == case.suite);
        let shown = case.fit.as_ref().filter(|fit| fit.shown);
        let (effects, closed, then, why) = match (&case.closing, shown) {
            (_, Some(fit)) => (
                &[][..],
                None,
                String::new(),
                format!("{}: {}", fit.asked, fit.why),
            ),
            (Some(own), None) if is_of_loop => {
                let is_open = own.again.verdict != Verdict::NoGap;
                let is_little = own.closed_percent.is_none_or(|closed| closed < LITTLE);
                let why = match (Apart::of(case), is_little, is_open) {
                    (Some(_), ..) => "an event",
                    (None, true, _) => "little is closed",
                    (None, false, true) => "a gap against the corrected device",
                    (None, false, false) => continue,
                };
                (
                    &own.effects[..],
                    own.closed_percent,
                    said(&own.again),
                    why.to_owned(),
                )
            }
            (None, None) if is_of_loop => {
                let why = match Apart::of(case) {
                    Some(Apart::Event) => "an event",
                    _ => "no corrected device",
                };
                (&[][..], None, String::new(), why.to_owned())
            }
            _ => continue,
        };
        table.push(cells! {
            case.arguments(), super::wrong::truth(case), effects.join(", "),
            closed.map_or(Cell::Missing, |closed| format!("{closed:.1} %").into()), then, why,
        })?;
    }
    Ok(table)
}

/// `named: link-geometry`.
fn said(answer: &Answer) -> String {
    let names = answer.causes.iter().map(|cause| cause.effect.as_str());
    let names: Vec<&str> = names.collect();
    match names.is_empty() {
        true => answer.verdict.text().to_owned(),
        false => format!("{}: {}", answer.verdict.text(), names.join(", ")),
    }
}
