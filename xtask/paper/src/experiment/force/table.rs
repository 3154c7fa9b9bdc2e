//! Tables of the virtual wall: transverse forces before and after calibration, over seeds and over poses.

use anyhow::Result;
use haptical_metrics::{median, quantile, rms};
use haptical_report::{Cell, Table};
use xtask_output::cells;

use super::sample::{CONTROLLERS, Kind, Sample};
use crate::monte_carlo::{Spread, largest};

/// Over seeds: RMS and peak of the poses of each seed.
pub(crate) fn over_seeds(kinds: &[Kind]) -> Result<Table> {
    let mut table = Table::with_heads(
        "Transverse force of the virtual wall (2 N along the handle's z), 100 poses for each seed",
        "truth and loop | controller | RMS, median seed [mN] | RMS, 95 % of seeds [mN] | peak, median \
                  seed [mN] | peak, worst seed [mN] | RMS of nominal, median seed [%] | of nominal, 95 % of seeds \
                  [%] | of nominal, worst seed [%] | poses left out [of 100]",
    );
    for kind in kinds {
        for (index, controller) in CONTROLLERS.iter().enumerate() {
            let of = |pick: &dyn Fn(&[f64]) -> Result<f64>| -> Result<Vec<f64>> {
                let samples = kind.samples.iter();
                samples
                    .map(|sample| Ok(1e3 * pick(&sample.transverse_n[index])?))
                    .collect()
            };
            let rms_mn = Spread::new(&of(&|forces| Ok(rms(forces)?))?)?;
            let peak_mn = of(&|forces| Ok(largest(forces)))?;
            let ratios = kind.ratios(|sample| sample.ratio(index))?;
            let ratio = Spread::new(&ratios)?;
            let left_out: usize = kind.samples.iter().map(|sample| sample.left_out).sum();
            let percent = |value: f64| Cell::number(100.0 * value, 2);
            table.push(cells! {
                kind.name.as_str(), (*controller), rms_mn.median => 2,
                format!("{:.2} to {:.2}", rms_mn.low, rms_mn.high), median(&peak_mn)? => 2,
                largest(&peak_mn) => 2, percent(ratio.median),
                format!("{:.2} to {:.2}", 100.0 * ratio.low, 100.0 * ratio.high),
                percent(largest(&ratios)), left_out as f64 / kind.samples.len().max(1) as f64 => 1,
            })?;
        }
    }
    Ok(table.with_note(
        "\"95 % of seeds\" are the 2.5 % and 97.5 % quantiles over the seeds: what one calibration may come to, not \
         how well the median is known. The nominal controller differs between seeds because the poses do.",
    ))
}

/// Over poses, those of all seeds together.
pub(crate) fn over_poses(kinds: &[Kind]) -> Result<Table> {
    let mut table = Table::with_heads(
        "The same pose by pose, the poses of all seeds together",
        "truth and loop | controller | median pose [mN] | 95 % of poses below [mN] | worst pose [mN] | \
                  of nominal in that pose, median [%] | 95 % of poses below [%] | of nominal, worst pose [%] | \
                  poses",
    );
    for kind in kinds {
        for (index, controller) in CONTROLLERS.iter().enumerate() {
            let forces_n = kind.samples.iter();
            let forces_n = forces_n.flat_map(|sample| &sample.transverse_n[index]);
            let forces_mn: Vec<f64> = forces_n.map(|force| 1e3 * force).collect();
            let ratio = |sample: &Sample| -> Vec<f64> {
                let pairs = sample.transverse_n[index].iter();
                let pairs = pairs.zip(&sample.transverse_n[0]);
                let ratio = |(after, before): (&f64, &f64)| 100.0 * after / before;
                pairs.map(ratio).collect()
            };
            let percent: Vec<f64> = kind.samples.iter().flat_map(ratio).collect();
            table.push(cells! {
                kind.name.as_str(), (*controller), median(&forces_mn)? => 2,
                quantile(&forces_mn, 0.95)? => 2, largest(&forces_mn) => 2, median(&percent)? => 2,
                quantile(&percent, 0.95)? => 2, largest(&percent) => 1, forces_mn.len() => 0,
            })?;
        }
    }
    Ok(table.with_note(
        "A pose where the nominal controller happens to push straight has a large ratio and a small force.",
    ))
}
