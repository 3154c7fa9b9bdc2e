//! Chosen poses as a table, verdicts and pictures.

use anyhow::Result;
use haptical_report::{Cell, Figure, Series, Table};
use xtask_output::Output;

use super::choice::Counted;
use super::{Accuracy, Apart, BAR, RANDOM};

pub(super) const HEADS: &str = "poses are | poses | position [um] | over 200 random | distance [um] | over 200 random | position, one \
    fit [um] | over 200 random | position, one fit, joint 4 as seen [um] | over 200 random | position, \
    transmissions known [um] | over 200 random | parameters, transmissions known, over 200 random";

/// Geometric mean over the parameters of the rms error over that of the random poses.
fn ratio(found: &Apart, random: &Apart) -> f64 {
    let logs = found.errors.iter().zip(&random.errors);
    let sum: f64 = logs.map(|(found, random)| (found / random).ln()).sum();
    (sum / found.errors.len() as f64).exp()
}

pub(super) fn push(
    table: &mut Table,
    name: &str,
    count: usize,
    found: &Accuracy,
    random: &Accuracy,
) -> Result<()> {
    let apart = found.apart.as_ref().zip(random.apart.as_ref());
    let pair = |pair: Option<(f64, f64)>| {
        [
            Cell::number_or_missing(pair.map(|(found, _)| found * 1e6), 1),
            Cell::number_or_missing(pair.map(|(found, random)| found / random), 3),
        ]
    };
    let of_apart = |of: fn(&Apart) -> f64| apart.map(|(found, random)| (of(found), of(random)));
    let mut row: Vec<Cell> = vec![name.into(), Cell::number(count as f64, 0)];
    row.extend(pair(of_apart(|apart| apart.position_m)));
    row.extend(pair(of_apart(|apart| apart.distance_m)));
    let of = |of: fn(&Accuracy) -> f64| pair(Some((of(found), of(random))));
    row.extend(of(|accuracy| accuracy.whole_position_m));
    row.extend(of(|accuracy| accuracy.seen_position_m));
    row.extend(pair(of_apart(|apart| apart.known_position_m)));
    let parameters = apart.map(|(found, random)| ratio(found, random));
    row.push(Cell::number_or_missing(parameters, 3));
    Ok(table.push(row)?)
}

/// The least number of poses that gives the accuracy of the random ones in each respect.
pub(super) fn verdict(
    output: &mut Output,
    (name, counted): (&str, Counted),
    curve: &[(usize, Accuracy)],
    random: &Accuracy,
) {
    // the least number from which on every larger one does
    let least = |is_as_good: &dyn Fn(&Accuracy) -> bool| {
        let from_the_most = curve.iter().rev();
        let good = from_the_most.take_while(|(_, found)| is_as_good(found));
        good.last().map(|(count, _)| *count)
    };
    let of_apart = |is_as_good: &dyn Fn(&Apart, &Apart) -> bool| {
        least(&|found| {
            let pair = found.apart.as_ref().zip(random.apart.as_ref());
            pair.is_some_and(|(found, random)| is_as_good(found, random))
        })
    };
    let position = of_apart(&|found, random| found.known_position_m <= random.known_position_m);
    let parameters = of_apart(&|found, random| ratio(found, random) <= 1.0);
    let after = of_apart(&|found, random| found.position_m <= random.position_m);
    let distance = of_apart(&|found, random| found.distance_m <= random.distance_m);
    let whole = least(&|found| found.whole_position_m <= random.whole_position_m);
    let seen = least(&|found| found.seen_position_m <= random.seen_position_m);
    let said = |least: Option<usize>| {
        least.map_or_else(|| "more than 200".to_owned(), |count| count.to_string())
    };
    let one_fit = format!(
        "in one fit {} chosen poses give the handle's position where joint 4 reads what step 1 has seen, {} everywhere",
        said(seen),
        said(whole)
    );
    let apart = format!(
        "with known transmissions {} the position and {} the parameters; in two steps {} the position and {} the predicted \
         distances",
        said(position),
        said(parameters),
        said(after),
        said(distance)
    );
    let (bar, respects, found) = match counted {
        Counted::Known => (
            [position, parameters],
            "by itself",
            format!("{apart}; {one_fit}"),
        ),
        Counted::StepOne => (
            [after, after],
            "behind step 1 as in the paper",
            format!("{apart}; {one_fit}"),
        ),
        Counted::OneFit => ([seen, seen], "in one fit with step 1", one_fit),
    };
    let is_few = |count: &Option<usize>| count.is_some_and(|count| count <= BAR);
    let is_met = bar.iter().all(is_few);
    let text = format!(
        "{name}, step 2 {respects}, at most {BAR} are asked for: as {RANDOM} random ones do, {found}"
    );
    output.verdict(is_met, text);
}

/// Numbers of poses, and what they give, under the name of a way of choosing.
type Curve = (&'static str, Vec<(usize, Accuracy)>);

/// An error that a picture shows \[m\]; none where a way of choosing does not have it.
pub(super) type ErrorM = fn(&Accuracy) -> Option<f64>;

/// Curves of one error over the number of poses; ways that do not have it are left out.
pub(super) fn figure(
    title: &str,
    ways: &[&Curve],
    by_chance: &Curve,
    random: &Accuracy,
    error_m: ErrorM,
) -> Figure {
    let mut figure = Figure::new(
        title,
        "poses of step 2",
        "position error at unseen poses [um]",
    );
    let colours = (0..BLACK).zip(ways.iter().copied());
    for (colour, (name, curve)) in colours.chain([(BLACK, by_chance)]) {
        let point =
            |(count, found): &(usize, Accuracy)| Some((*count as f64, error_m(found)? * 1e6));
        let points: Vec<(f64, f64)> = curve.iter().filter_map(point).collect();
        if !points.is_empty() {
            figure.line(*name, colour, points);
        }
    }
    let random_um = error_m(random).unwrap_or(f64::NAN) * 1e6;
    let random = Series::reference("200 random", BLACK, random_um);
    figure.series.push(random);
    figure
}

/// The palette's last colour that differs from the others on white.
const BLACK: usize = 6;
