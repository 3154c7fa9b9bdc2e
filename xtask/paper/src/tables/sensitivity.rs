//! Sensitivity of the results to each number that the paper does not print.

use anyhow::Result;
use haptical_model::Device;
use haptical_report::Table;
use haptical_simulator::{CableSigma, Noise, Sampling};
use xtask_blind::rows;
use xtask_output::{Progress, cells, or_none};

use super::sweeps::{Seeds, summarise};
use crate::published::Paper;
use crate::scenario::{PRESET_DENOMINATORS_M, Scenario, true_device};

struct Variation {
    name: &'static str,
    change: fn(&mut Scenario),
}

/// One assumption at a time, changed.
const VARIATIONS: [Variation; 15] = rows! {
    Variation {name change}
    "as assumed", |_| {};
    "home of joint 7: 0 instead of -30 deg", |s| s.nominal.joints[6].home_rad = 0.0;
    "home of joint 1: -120 instead of -150 deg", |s| {
        s.nominal.joints[0].home_rad = -120.0_f64.to_radians();
    };
    "a0: 180 mm instead of 250 mm", |s| s.nominal.links[0].a_m = 0.180;
    "a0: 330 mm", |s| s.nominal.links[0].a_m = 0.330;
    "d1: 260 mm instead of 350 mm", |s| s.nominal.links[1].d_m = 0.260;
    "d3, d5: 215, 170 mm (Phantom) instead of 180, 280 mm", |s| {
        s.nominal.links[3].d_m = 0.215;
        s.nominal.links[5].d_m = 0.170;
    };
    "a7: 10 mm instead of 20 mm", |s| s.nominal.links[7].a_m = 0.010;
    "R of joints 1 to 3: 5, D 40 mm instead of 8, 67.5 mm", |s| {
        for joint in &mut s.nominal.joints[..3] {
            joint.transmission_ratio = 5.0;
            joint.drum_distance_m = Some(0.040);
        }
    };
    "R of joint 4: 13 instead of 12", |s| s.nominal.joints[3].transmission_ratio = 13.0;
    "crank L2 = L4: 82 mm instead of 76 mm", |s| {
        s.nominal.joints[3].parallelogram_lengths_m = Some([0.18, 0.082, 0.18, 0.082]);
    };
    "input drum denominators 2.9 and 2.6 mm (--paper-preset)", |s| {
        for (joint, denominator) in s.nominal.joints.iter_mut().zip(PRESET_DENOMINATORS_M) {
            joint.input_drum_denominator_m = Some(denominator);
        }
    };
    "poses uniform within 2/3 of the limits", |s| s.settings.sampling = Sampling::Uniform;
    "sigma_m without the extra 2 pi (1.57 um)", |s| {
        s.settings.cable_sigma = CableSigma::Geometric;
        for cable in &mut s.nominal.cables {
            let drum = cable.drum_radius_m.zip(cable.counts_per_rev);
            cable.distance_sd_m =
                drum.map(|(radius, counts)| radius * std::f64::consts::TAU / counts / 3.0);
        }
    };
    "motor encoders with 20000 counts, external ones with counts", |s| {
        s.settings.motor_counts = true;
        s.settings.output_noise = Noise::Counts;
        for joint in &mut s.nominal.joints {
            joint.encoder_counts_per_rev = Some(20000.0);
        }
    };
};

pub(crate) fn table(nominal: &Device, paper: &Paper, seeds: Seeds) -> Result<Table> {
    let progress = Progress::new("sensitivity", VARIATIONS.len());
    let mut table = Table::with_heads(
        "Sensitivity: one assumption at a time",
        "assumption changed | distance improvement [%] | position before [mm rms] | after [mm rms] | \
                  orientation before [mrad rms] | after [mrad rms] | lowest median I [%] | of | I of at least 97 \
                  % [of 28] | not identified in some run",
    );
    for Variation { name, change } in VARIATIONS {
        let mut scenario = Scenario::paper(nominal.clone(), paper, false)?;
        change(&mut scenario);
        scenario.truth = true_device(&scenario.nominal, paper, 1.0)?;
        let summary = summarise(&scenario, paper, seeds)?;
        progress.step();
        table.push(cells! {
            name, summary.distance_improvement => 2, summary.position_before_m * 1e3 => 2,
            summary.position_after_m * 1e3 => 3, summary.orientation_before_rad * 1e3 => 2,
            summary.orientation_after_rad * 1e3 => 2, summary.lowest.1 => 1, summary.lowest.0,
            summary.good => 0, or_none(&summary.lost),
        })?;
    }
    Ok(table)
}
