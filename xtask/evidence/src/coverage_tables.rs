//! Tables, figure and verdicts of the intervals' trials.

use anyhow::{Context, Result};
use haptical_metrics::{binomial_two_sided_p, holm_adjusted, wilson_interval};
use haptical_report::{Figure, Series, Table};
use xtask_output::{Output, cells, or_none};

use super::intervals::{LEVEL, POSTURES, Quantity, TRIALS};
use super::rigs::{Errors, Rig};

/// Chance of a false rejection among all quantities.
const ALPHA: f64 = 0.05;
/// Writes what the trials gave.
pub(super) fn report(
    output: &mut Output,
    devices: usize,
    quantities: &[Quantity],
    failures: &[Vec<String>],
    notes: &[(usize, usize)],
) -> Result<()> {
    let p_values = quantities
        .iter()
        .map(|quantity| binomial_two_sided_p(quantity.held, quantity.devices, LEVEL))
        .collect::<Result<Vec<f64>, _>>()?;
    let adjusted = holm_adjusted(&p_values)?;
    let columns = "trial | poses | quantities | devices | failed | with held weak parameters | mean coverage [%] | \
             lowest [%] | of | highest [%] | of | least p, corrected | rejected";
    let mut table = Table::with_heads("Coverage of 95 % intervals", columns);
    let share = Quantity::percent;
    for (index, trial) in TRIALS.iter().enumerate() {
        let own: Vec<usize> = (0..quantities.len())
            .filter(|&k| quantities[k].trial == index)
            .collect();
        let by =
            |a: &&usize, b: &&usize| share(&quantities[**a]).total_cmp(&share(&quantities[**b]));
        let ends = own.iter().min_by(by).zip(own.iter().max_by(by));
        let (lowest, highest) = ends.context("a trial without quantities")?;
        let mean = own.iter().map(|&k| share(&quantities[k])).sum::<f64>() / own.len() as f64;
        let least = own.iter().map(|&k| adjusted[k]).fold(1.0, f64::min);
        let rejected = own.iter().filter(|&&k| adjusted[k] < ALPHA).count();
        table.push(cells! {
            trial.name, trial.rows => 0, own.len() => 0, devices => 0, failures[index].len() => 0,
            notes[index].1 => 0, mean => 2, share(&quantities[*lowest]) => 1,
            quantities[*lowest].name.clone(), share(&quantities[*highest]) => 1,
            quantities[*highest].name.clone(), least => 3, rejected => 0,
        })?;
    }
    output.table("intervals", table)?;
    let figure = figure(quantities)?;
    output.figure("intervals", "Coverage of every quantity", &figure)?;
    let rejected: Vec<String> = (0..quantities.len())
        .filter(|&k| adjusted[k] < ALPHA)
        .map(|k| {
            let (trial, name) = (TRIALS[quantities[k].trial].name, &quantities[k].name);
            format!("{name} ({trial}, {:.1} %)", share(&quantities[k]))
        })
        .collect();
    let text = format!(
        "no quantity of {} is rejected at 5 % after Holm's correction; rejected: {}",
        quantities.len(),
        or_none(&rejected)
    );
    output.verdict(rejected.is_empty(), text);
    left_out(output, devices, failures, notes);
    Ok(())
}

/// What was not calibrated, and what got no interval.
fn left_out(
    output: &mut Output,
    devices: usize,
    failures: &[Vec<String>],
    notes: &[(usize, usize)],
) {
    // a reading a hundred deviations off is none of the noise that least squares is for, and is to be doubted
    let [failed, doubted] = [false, true].map(|tails| {
        let own = failures.iter().zip(&TRIALS);
        let own = own.filter(|(_, trial)| (trial.errors == Errors::Tails) == tails);
        own.flat_map(|(list, trial)| list.iter().map(move |why| format!("{}, {why}", trial.name)))
            .collect::<Vec<String>>()
    });
    let trials = |tails: bool| {
        let own = TRIALS.iter();
        own.filter(|trial| (trial.errors == Errors::Tails) == tails)
            .count()
    };
    let text = format!(
        "every device whose noise is as modelled was calibrated without doubt: {} of {} were not: {}",
        failed.len(),
        trials(false) * devices,
        or_none(&failed[..failed.len().min(5)])
    );
    output.verdict(failed.is_empty(), text);
    output.words(format!(
        "Among heavy tails {} of {} devices were doubted for a far reading, said so, and are not counted: {}.",
        doubted.len(),
        trials(true) * devices,
        or_none(&doubted[..doubted.len().min(5)])
    ));
    let cables = TRIALS.iter().zip(notes).zip(failures);
    let cables: Vec<_> = cables
        .filter(|((trial, _), _)| trial.rig == Rig::Cable)
        .collect();
    let counted = cables.iter().map(|(_, failed)| devices - failed.len());
    let asked = 3 * POSTURES * counted.sum::<usize>();
    let refused: usize = cables.iter().map(|((_, (refused, _)), _)| refused).sum();
    let text = format!(
        "one cable fixes no coordinate of the handle: {refused} of {asked} got no interval"
    );
    output.verdict(refused == asked, text);
}

/// Every quantity's coverage with its own 95 % interval, trial by trial.
fn figure(quantities: &[Quantity]) -> Result<Figure> {
    let mut figure = Figure::new(
        "Coverage of 95 % intervals",
        "quantity",
        "devices whose interval holds the truth [%]",
    );
    for (index, trial) in TRIALS.iter().enumerate() {
        let own = quantities.iter().enumerate();
        let points = own
            .filter(|(_, quantity)| quantity.trial == index)
            .map(|(k, quantity)| (k as f64, quantity.percent()));
        figure.points(trial.name, index, points.collect());
    }
    if let Some(most) = quantities.iter().map(|quantity| quantity.devices).max() {
        let held = (LEVEL * most as f64).round() as usize;
        let band = wilson_interval(held, most, LEVEL)?;
        for end in [band.low, band.high] {
            figure.series.push(Series::reference("", 6, 100.0 * end));
        }
    }
    Ok(figure)
}
