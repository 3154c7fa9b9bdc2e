//! Pictures of a batch: who was taken for whom, what probabilities are worth, how small is too small.

use std::collections::BTreeMap;

use haptical_report::{Figure, HeatCell, HeatMap, Mark, Series};
use xtask_blind::{Rate, TrialScore, Verdict};

use crate::batch::Case;
use crate::calibration::Bin;

/// Answers without one name, in the order of their columns.
const NAMELESS: [&str; 4] = ["A+", "A-", "?", "0"];

/// Truth against answer, with the caption that explains its numbers; none without scores.
///
/// A row is an effect or a kind of clean recording, with a number. A column is the name that was given
/// as `named`, by its number; then come `ambiguous` (with and without the truth), `unknown` and `no-gap`.
/// The text is the count, the shade its share of the row.
pub(crate) fn confusion(title: &str, cases: &[&Case]) -> Option<(HeatMap, String)> {
    let scores = cases.iter().filter_map(|case| case.score.as_ref());
    let scores: Vec<&TrialScore> = scores.collect();
    let mut rows: Vec<&str> = Vec::new();
    for score in &scores {
        if !rows.contains(&score.name.as_str()) {
            rows.push(&score.name);
        }
    }
    // names that were answered; those of the rows first, in the order of the rows
    let given = scores.iter();
    let given = given.filter(|score| score.verdict == Verdict::Named);
    let given: Vec<&str> = given.map(|score| score.answered.as_str()).collect();
    let mut named: Vec<&str> = rows.clone();
    named.retain(|row| given.contains(row));
    for name in &given {
        if !named.contains(name) {
            named.push(name);
        }
    }
    let number = |name: &str| rows.iter().position(|row| *row == name);
    let foreign = named.iter().copied();
    let foreign: Vec<&str> = foreign.filter(|name| number(name).is_none()).collect();
    let label = |name: &str| {
        let at = number(name).or_else(|| {
            let place = foreign.iter().position(|other| *other == name)?;
            Some(rows.len() + place)
        });
        at.map_or_else(String::new, |at| (at + 1).to_string())
    };
    let mut columns: Vec<String> = named.iter().map(|name| label(name)).collect();
    columns.extend(NAMELESS.map(str::to_owned));
    let mut map = HeatMap::new(title, columns);
    for (place, row) in rows.iter().enumerate() {
        let of_row: Vec<&&TrialScore> = scores.iter().filter(|score| score.name == *row).collect();
        let mut counts = vec![0_usize; map.columns.len()];
        for score in &of_row {
            if let Some(column) = column(score, &named) {
                counts[column] += 1;
            }
        }
        let cell = |count: usize| {
            (count > 0).then(|| HeatCell {
                shade: count as f64 / of_row.len() as f64,
                text: count.to_string(),
            })
        };
        let name = format!("{row} {}", place + 1);
        map.rows
            .push((name, counts.into_iter().map(cell).collect()));
    }
    let more = foreign.iter().map(|name| format!("{} {name}", label(name)));
    let more: Vec<String> = more.collect();
    let more = match more.is_empty() {
        true => String::new(),
        false => format!(" Further names: {}.", more.join(", ")),
    };
    let caption = format!(
        "Rows: what was put in. Columns: the name that was answered as `named`, by its number; A+ and A-: \
         ambiguous, with and without the truth among the names; ?: unknown; 0: no gap.{more}"
    );
    (!map.rows.is_empty()).then_some((map, caption))
}

fn column(score: &TrialScore, named: &[&str]) -> Option<usize> {
    match score.verdict {
        Verdict::Named => named.iter().position(|name| *name == score.answered),
        Verdict::Ambiguous if score.right => Some(named.len()),
        Verdict::Ambiguous => Some(named.len() + 1),
        Verdict::Unknown => Some(named.len() + 2),
        Verdict::NoGap => Some(named.len() + 3),
    }
}

/// A place on the axis, and the ends of an interval with its middle between them.
type Interval = (f64, f64, f64, f64);

fn interval(x: f64, rate: &Rate) -> Option<Interval> {
    let [low, high] = rate.ci95?;
    Some((x, low, rate.share?, high))
}

/// How often answers of each probability were right.
pub(crate) fn reliability(bins: &[Bin]) -> Figure {
    let mut figure = Figure::new(
        "What a probability is worth",
        "stated probability [-]",
        "share that was so [-]",
    );
    figure.x_range = Some((0.0, 1.0));
    figure.y_range = Some((0.0, 1.0));
    let ideal = vec![(0.0, 0.0), (1.0, 1.0)];
    let ideal = Series::new("as stated", Mark::DashedLine, 6, ideal);
    figure.series.push(ideal);
    let points = bins.iter();
    let points = points.filter_map(|bin| interval(bin.probability, &bin.happened));
    let points: Vec<Interval> = points.collect();
    let answers = Series::intervals("answers, 95 % interval", 0, &points);
    figure.series.push(answers);
    figure
}

type Judgement = fn(&TrialScore) -> bool;

/// Detection and naming against the size of an effect; none without scores.
pub(crate) fn ladder(cases: &[Case]) -> Option<Figure> {
    let mut rungs: BTreeMap<u64, (f64, Vec<&TrialScore>)> = BTreeMap::new();
    for case in cases.iter().filter(|case| case.suite == "s5") {
        let size = case.truth.effects.first().map_or(0.0, |effect| effect.size);
        if let Some(score) = &case.score {
            // sizes are powers of 10^(1/3)
            let key = (1e6 * size).round() as u64;
            let rung = rungs.entry(key).or_insert_with(|| (size, Vec::new()));
            rung.1.push(score);
        }
    }
    if rungs.is_empty() {
        return None;
    }
    let mut figure = Figure::new(
        "Power: detection and naming against size",
        "size of the effect, strong is 1 [-]",
        "share of trials [-]",
    );
    figure.y_range = Some((0.0, 1.0));
    figure.categories = Some(rungs.values().map(|(size, _)| rung_name(*size)).collect());
    let kinds: [(&str, Judgement); 3] = [
        ("detected", |score| score.detected),
        ("right, class allowed", |score| score.right),
        ("named and right", |score| {
            score.verdict == Verdict::Named && score.right
        }),
    ];
    for (colour, (label, is)) in kinds.into_iter().enumerate() {
        let points = rungs
            .values()
            .enumerate()
            .filter_map(|(rung, (_, scores))| {
                let rate = Rate::of_cases(scores.iter().map(|score| is(score)));
                interval(rung as f64, &rate)
            });
        let points: Vec<Interval> = points.collect();
        let series = Series::intervals(label, colour, &points);
        figure.series.push(series);
    }
    Some(figure)
}

fn rung_name(size: f64) -> String {
    if size > 0.99 {
        "1".to_owned()
    } else {
        format!("{size:.2}")
    }
}
