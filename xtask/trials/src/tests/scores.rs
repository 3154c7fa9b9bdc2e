//! Figures, faults and pictures from answers written by hand.

use std::collections::BTreeMap;

use xtask_blind::{Answer, Suite, TrialScore, summarise};
use xtask_output::Progress;

use super::{NO_GAP, UNKNOWN, case, cause, right_single};
use crate::batch::Case;
use crate::calibration::{calibration_error, probabilities, reliability_bins};
use crate::closing::{Closing, Fit};
use crate::measure::{Bar, Measure, Value, mean, number};
use crate::quick::assert_sound;
use crate::report::bars::measures;
use crate::report::figures::{confusion, ladder, reliability};
use crate::report::wrong::{Fault, fault, table};
use crate::threads::in_parallel;

fn figure<'m>(all: &'m [Measure], group: &str, name: &str) -> &'m Measure {
    all.iter()
        .find(|one| one.group == group && one.name == name)
        .unwrap_or_else(|| panic!("no figure `{group}: {name}`"))
}

fn counts(one: &Measure) -> (u64, u64) {
    match &one.value {
        Value::Share(rate) => (rate.count, rate.of),
        Value::Number(_) => panic!("{} is no share", one.name),
    }
}

/// Clean recordings of index 0, 1, 6 are white, of 2 autoregressive.
#[test]
fn clean_recordings_are_counted_by_their_noise() {
    let cases = [
        case(Suite::Clean, 0, NO_GAP),
        case(Suite::Clean, 1, NO_GAP),
        case(Suite::Clean, 2, UNKNOWN),
        case(Suite::Clean, 6, &cause("named", "cable-drift", None)),
    ];
    let all = measures(&cases);
    let of = |name: &str| counts(figure(&all, "clean sets", name));
    assert_eq!(of("named, all"), (1, 4));
    assert_eq!(of("any verdict but no-gap, all"), (2, 4));
    assert_eq!(of("named, white noise"), (1, 3));
    assert_eq!(of("any verdict but no-gap, AR(0.5) noise"), (1, 1));
    assert_eq!(of("named, rough noise together"), (0, 1));
    let named = figure(&all, "clean sets", "named, white noise");
    assert_eq!((named.met, named.verdict()), (Some(false), "falls short"));
    let missing = figure(&all, "strong singles", "answered `named`");
    assert_eq!((missing.met, missing.verdict()), (None, "not measured"));
}

#[test]
fn singles_withheld_and_errors_are_counted() {
    let backlash = (0..40)
        .find(|index| Suite::Withheld.draw(*index, 3).unwrap().truth.name == "backlash")
        .unwrap();
    let cases = [
        right_single(0),
        right_single(1),
        case(Suite::Singles, 2, UNKNOWN),
        case(Suite::Singles, 3, "{"),
        case(Suite::Withheld, backlash, UNKNOWN),
        case(
            Suite::Withheld,
            backlash,
            &cause("named", "viscous-lag", Some(1)),
        ),
        case(
            Suite::Withheld,
            backlash,
            &cause("ambiguous", "viscous-lag", Some(1)),
        ),
        case(Suite::Withheld, backlash, NO_GAP),
    ];
    let all = measures(&cases);
    let of = |group: &str, name: &str| counts(figure(&all, group, name));
    assert_eq!(of("every trial", "the diagnosis answers"), (7, 8));
    assert_eq!(of("strong singles", "answered `named`"), (2, 3));
    assert_eq!(of("strong singles", "top name alone right"), (2, 3));
    let family = "family right up to the declared class";
    assert_eq!(of("detected singles", family), (2, 3));
    assert_eq!(of("precision of `named`", "strong singles"), (2, 2));
    assert_eq!(of("precision of `named`", "all suites together"), (2, 3));
    let group = "withheld and never in the catalogue";
    assert_eq!(of(group, "unknown or a twin class, withheld"), (1, 3));
    assert_eq!(of(group, "confidently wrong, together"), (1, 3));

    let faults: Vec<Option<Fault>> = cases.iter().map(fault).collect();
    let expected = [
        None,
        None,
        Some(Fault::Declined),
        Some(Fault::NoAnswer),
        None,
        Some(Fault::NamedWrong),
        Some(Fault::ClassWrong),
        Some(Fault::Missed),
    ];
    assert_eq!(faults, expected);
    let listed = table("", &cases, |_, fault| fault != Fault::Missed).unwrap();
    assert_eq!(listed.rows().len(), 4);
    assert_eq!(
        listed.rows()[0][1],
        "--suite s1 --first 3 --count 1".into(),
        "worst first"
    );
}

/// One of two effects found, nothing else named: both found no, precision yes.
#[test]
fn pairs_count_both_and_what_is_too_much() {
    let truth = Suite::Pairs.draw(0, 3).unwrap().truth;
    let causes = |names: &[(&str, Option<usize>)]| {
        let text: Vec<String> = names
            .iter()
            .map(|(name, joint)| {
                let joint = joint.map_or("null".to_owned(), |joint| joint.to_string());
                format!(r#"{{"effect": "{name}", "joint": {joint}}}"#)
            })
            .collect();
        format!(r#"{{"verdict": "named", "causes": [{}]}}"#, text.join(","))
    };
    let first = (truth.right[0][0].as_str(), truth.joints[0]);
    let second = (truth.right[1][0].as_str(), truth.joints[1]);
    let cases = [
        case(Suite::Pairs, 0, &causes(&[first, second])),
        case(Suite::Pairs, 0, &causes(&[second])),
        case(
            Suite::Pairs,
            0,
            &causes(&[first, ("cable-sag", None), second]),
        ),
    ];
    let all = measures(&cases);
    assert_eq!(counts(figure(&all, "two effects", "both found")), (2, 3));
    let extra = figure(&all, "two effects", "false extra causes per set");
    assert!((extra.value.value().unwrap() - 1.0 / 3.0).abs() < 1e-12);
    assert_eq!(extra.met, Some(false));
    let precision = |name: &str| counts(figure(&all, "precision of `named`", name));
    assert_eq!(precision("all suites together"), (3, 3));
    assert_eq!(
        precision("all suites together, and nothing else named"),
        (2, 3)
    );
    let faults: Vec<Option<Fault>> = cases.iter().map(fault).collect();
    assert_eq!(faults, [None, Some(Fault::Incomplete), Some(Fault::Extra)]);
}

/// Two parameters of one effect: the order of a harmonic is right or wrong, its amplitude has an interval.
#[test]
fn parameters_without_an_interval_do_not_count() {
    let harmonic = (0..40)
        .find(|index| Suite::Singles.draw(*index, 3).unwrap().truth.name == "input-drum-harmonic")
        .unwrap();
    let truth = Suite::Singles.draw(harmonic, 3).unwrap().truth;
    let parameters = &truth.effects[0].parameters;
    let (amplitude, order) = (parameters["amplitude_rad"], parameters["order"]);
    let stated = |low: f64, high: f64| {
        format!(
            r#"{{"verdict": "named", "causes": [{{"effect": "input-drum-harmonic", "joint": {},
                "parameters": {{"amplitude_rad": {{"value": {amplitude}, "ci95": [{low}, {high}]}},
                "order": {{"value": {order}, "ci95": [{order}, {order}]}}}}}}]}}"#,
            truth.joint.unwrap()
        )
    };
    let size = amplitude.abs();
    let cases = [
        case(
            Suite::Singles,
            harmonic,
            &stated(0.9 * amplitude, 1.1 * amplitude),
        ),
        case(
            Suite::Singles,
            harmonic,
            &stated(amplitude + size, amplitude + 2.0 * size),
        ),
    ];
    assert!(
        cases
            .iter()
            .all(|case| case.score.as_ref().unwrap().coverage.len() == 2)
    );
    let all = measures(&cases);
    let group = "95 % intervals of effect parameters hold the truth";
    assert_eq!(counts(figure(&all, group, "strong singles")), (1, 2));
}

#[test]
fn bars_hold_or_do_not() {
    let share = |value: f64| number(&[value], 2, "s", mean);
    for (bar, value, holds) in [
        (Bar::AtMost(1.0), 1.0, true),
        (Bar::AtMost(1.0), 1.01, false),
        (Bar::AtLeast(0.9), 0.9, true),
        (Bar::AtLeast(0.9), 0.89, false),
        (Bar::Between(0.9, 0.99), 0.95, true),
        (Bar::Between(0.9, 0.99), 1.0, false),
        (Bar::Between(0.9, 0.99), 0.85, false),
    ] {
        let measure = Measure::new("", "", share(value), Some(bar));
        assert_eq!(measure.met, Some(holds), "{bar:?}: {value}");
    }
    assert_eq!(Bar::AtMost(0.15).words(&share(1.0)), "at most 0.15 s");
    let rate = Value::Share(xtask_blind::Rate::new(29, 30));
    assert_eq!(Bar::Between(0.9, 0.99).words(&rate), "90 to 99 %");
    assert_eq!(rate.words(), "96.7 % (29 of 30)");
}

/// Newcombe 1998, Table I: 15 of 148 has Wilson's interval 0.0624 to 0.1605.
#[test]
fn intervals_are_wilson_s() {
    let rate = Value::Share(xtask_blind::Rate::new(15, 148));
    assert_eq!(rate.interval(), "6.2 to 16.0 %");
}

/// 0.9 twice, once right, and 0.6 twice, both right: (|1.8 - 1| + |1.2 - 2|) / 4.
#[test]
fn the_calibration_error_is_that_of_the_scores() {
    let pairs = [(0.9, true), (0.9, false), (0.6, true), (0.6, true)];
    let error = calibration_error(&pairs.iter().collect::<Vec<_>>()).unwrap();
    assert!((error - 0.4).abs() < 1e-12, "{error}");
    let cases = [
        right_single(0),
        right_single(1),
        case(Suite::Singles, 2, UNKNOWN),
        case(Suite::Unknown, 0, UNKNOWN),
        case(Suite::Clean, 0, &cause("named", "cable-drift", None)),
    ];
    let pairs = probabilities(&cases, None);
    let scores: Vec<TrialScore> = cases.iter().filter_map(|case| case.score.clone()).collect();
    let theirs = summarise("all", &scores)
        .calibration
        .expected_error
        .unwrap();
    let ours = calibration_error(&pairs.iter().collect::<Vec<_>>()).unwrap();
    assert!((ours - theirs).abs() < 1e-12, "{ours} and {theirs}");
    let bins = reliability_bins(&pairs);
    assert_eq!(bins.iter().map(|bin| bin.happened.of).sum::<u64>(), 5);
    assert!(reliability(&bins).to_svg(640, 400).is_ok());
}

#[test]
fn a_confusion_matrix_counts_every_answer() {
    let cases = [
        right_single(0),
        case(Suite::Singles, 0, &cause("named", "cable-sag", None)),
        case(
            Suite::Singles,
            0,
            &cause("ambiguous", "viscous-lag", Some(1)),
        ),
        case(Suite::Singles, 1, UNKNOWN),
        case(Suite::Clean, 0, NO_GAP),
    ];
    let all: Vec<&Case> = cases.iter().collect();
    let (map, caption) = confusion("title", &all).unwrap();
    // rows 1 to 3: the first single, the second, clean; 4: cable-sag, which was answered alone
    assert_eq!(map.columns, ["1", "4", "A+", "A-", "?", "0"]);
    assert!(caption.contains("4 cable-sag"), "{caption}");
    let counts = |row: usize| -> Vec<String> {
        let texts = map.rows[row].1.iter();
        texts
            .map(|cell| {
                cell.as_ref()
                    .map_or(String::new(), |cell| cell.text.clone())
            })
            .collect()
    };
    assert_eq!(counts(0), ["1", "1", "", "1", "", ""]);
    assert_eq!(counts(1), ["", "", "", "", "1", ""]);
    assert_eq!(counts(2), ["", "", "", "", "", "1"]);
    assert!(map.to_svg(900).is_ok());
    assert!(confusion("none", &[]).is_none());
}

#[test]
fn the_ladder_has_a_rung_for_every_size() {
    let cases: Vec<Case> = (0..14)
        .map(|index| case(Suite::Ladder, index, UNKNOWN))
        .collect();
    let figure = ladder(&cases).unwrap();
    let sizes = ["0.01", "0.02", "0.05", "0.10", "0.22", "0.46", "1"];
    assert_eq!(figure.categories.as_deref().unwrap(), sizes);
    assert!(
        figure
            .series
            .iter()
            .all(|series| series.points.len() == 3 * sizes.len())
    );
    assert!(figure.to_svg(900, 460).is_ok());
    assert!(ladder(&[]).is_none());
}

#[test]
fn a_quick_check_refuses_what_is_broken() {
    let clean = |index: u64, said: &str| case(Suite::Clean, index, said);
    let sound = [
        clean(0, NO_GAP),
        clean(1, UNKNOWN),
        right_single(0),
        right_single(1),
    ];
    assert!(assert_sound(&sound, true).is_ok());
    assert!(assert_sound(&sound, false).is_err(), "two answers");
    let alarms = [clean(0, UNKNOWN), clean(1, UNKNOWN)];
    assert!(assert_sound(&alarms, true).is_err(), "two false alarms");
    let blind = [right_single(0), case(Suite::Singles, 1, UNKNOWN)];
    assert!(assert_sound(&blind, true).is_err(), "half of the singles");
    assert!(assert_sound(&[clean(0, "{")], true).is_err(), "an error");
}

#[test]
fn work_in_parallel_comes_back_in_order() {
    for (jobs, count) in [(1, 5), (3, 50), (8, 2), (2, 0)] {
        let progress = Progress::new("test", count);
        let done = in_parallel(jobs, count, &progress, |number| {
            (number * number, rayon::current_num_threads())
        });
        let expected: Vec<_> = (0..count).map(|number| (number * number, 1)).collect();
        assert_eq!(done.unwrap(), expected);
    }
    let failed = in_parallel(2, 3, &Progress::new("test", 3), |number| {
        assert!(number != 1, "on purpose");
    });
    assert!(failed.is_err(), "a panic is an error");
}

/// A loop that was closed to this share, and what its recording then says; without a corrected device where there is none.
fn closed(suite: Suite, index: u64, closing: Option<(f64, &str)>) -> Case {
    let closing = closing.map(|(percent, again)| Closing {
        effects: Vec::new(),
        channels: BTreeMap::new(),
        closed_percent: Some(percent),
        by_c: None,
        again: Answer::from_json(again).unwrap(),
    });
    Case {
        closing,
        ..case(suite, index, UNKNOWN)
    }
}

#[test]
fn loops_are_counted_and_events_apart() {
    // the order of the generator: compliance, creep, slip, backlash
    let name = |index: u64| Suite::Loop.draw(index, 3).unwrap().truth.name;
    assert_eq!(
        (name(0), name(2)),
        ("capstan-compliance".to_owned(), "capstan-slip".to_owned())
    );
    let is_calm = |index: &u64| {
        let effects = Suite::LoopPairs.draw(*index, 3).unwrap().truth.effects;
        effects
            .iter()
            .all(|effect| effect.events.iter().all(Vec::is_empty))
    };
    let calm = (0..20).find(is_calm).unwrap();
    let cases = [
        closed(Suite::Loop, 0, Some((98.0, NO_GAP))),
        closed(Suite::Loop, 1, Some((60.0, UNKNOWN))),
        closed(Suite::Loop, 2, Some((-20.0, UNKNOWN))),
        closed(Suite::Loop, 3, None),
        closed(Suite::LoopPairs, calm, Some((94.0, NO_GAP))),
        closed(Suite::Singles, 0, Some((0.0, UNKNOWN))),
    ];
    let all = measures(&cases);
    let group = "the loop: a corrected device on a fresh recording";
    let of = |name: &str| counts(figure(&all, group, name));
    assert_eq!(of("then no gap against it, all"), (2, 3));
    assert_eq!(of("then no gap against it, one effect"), (1, 2));
    assert_eq!(of("apart: an event, one effect"), (1, 4));
    assert_eq!(of("apart: no corrected device, one effect"), (1, 4));
    let median = figure(&all, group, "gap closed, median, all");
    assert_eq!((median.value.value(), median.met), (Some(94.0), Some(true)));
    let worst = figure(&all, group, "gap closed, worst tenth, all");
    assert_eq!(worst.met, Some(false), "60 + 0.2 (94 - 60) = 66.8");
    let listed = crate::report::closed::table(&cases).unwrap();
    assert_eq!(
        listed.rows().len(),
        3,
        "little closed, an event, not corrected"
    );
}

#[test]
fn an_absent_effect_that_is_shown_is_a_fault() {
    let fit = |index: u64, shown: bool| Case {
        fit: Some(Fit {
            asked: "backlash@2".to_owned(),
            shown,
            why: String::new(),
        }),
        ..case(Suite::Absent, index, NO_GAP)
    };
    let cases = [fit(0, false), fit(1, true), case(Suite::Clean, 0, NO_GAP)];
    let all = measures(&cases);
    let name = "fitted, and said not to be shown";
    assert_eq!(
        counts(figure(&all, "an effect that is not there", name)),
        (1, 2)
    );
    let listed = crate::report::closed::table(&cases).unwrap();
    assert_eq!(listed.rows().len(), 1);
}
