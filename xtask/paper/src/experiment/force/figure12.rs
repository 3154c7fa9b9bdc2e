//! Figure 12: the virtual wall over time, before and after calibration.

use anyhow::Result;
use haptical_model::kinematics::nalgebra::{Vector3, Vector6};
use haptical_model::{Device, Evaluation, ForceTransmission};
use haptical_report::{Figure, FigureGrid};
use xtask_blind::Random;

use super::closed_loop::{Axis, Law, SAMPLE_S, run};
use super::sample::{FREE, WALL_FORCE_N};

/// The wall goes in over this time, stays and goes out \[s\].
const RAMP_S: f64 = 1.0;
/// Standard deviation of the force sensor \[N\].
pub(crate) const SENSOR_SD_N: f64 = 0.01;
/// Every k-th sample is drawn.
const DRAWN: usize = 5;

/// Forces in the true handle's frame, sample by sample.
#[derive(Debug)]
pub(crate) struct Course {
    pub(crate) wanted_n: Vec<f64>,
    pub(crate) measured_n: Vec<Vector3<f64>>,
}

/// The wall's force on one controller at one posture.
pub(crate) fn course(
    truth: &Device,
    controller: &Device,
    readings: &[f64],
    axis: &Axis,
    gain: f64,
    seed: u64,
) -> Result<Course> {
    let (mut at_truth, mut at) = (Evaluation::new(truth), Evaluation::new(controller));
    at_truth.move_to(readings)?;
    at.move_to(readings)?;
    let transmission = ForceTransmission::new(&at_truth, &at, FREE)?;
    let along = at.pose()?.rotation.column(2).into_owned();
    let samples = (3.0 * RAMP_S / SAMPLE_S) as usize;
    let share = |sample: usize| {
        let time_s = sample as f64 * SAMPLE_S;
        (time_s / RAMP_S)
            .min((3.0 * RAMP_S - time_s) / RAMP_S)
            .clamp(0.0, 1.0)
    };
    let wanted_n: Vec<f64> = (0..samples)
        .map(|sample| WALL_FORCE_N * share(sample))
        .collect();
    let wanted: Vec<Vector6<f64>> = wanted_n
        .iter()
        .map(|force| {
            let force = along * *force;
            Vector6::new(force.x, force.y, force.z, 0.0, 0.0, 0.0)
        })
        .collect();
    let mut random = Random::new(seed, 1);
    let mut sensed = |axis: usize| match axis {
        0..3 => SENSOR_SD_N * random.normal(),
        _ => 0.0,
    };
    let noise: Vec<Vector6<f64>> = (0..samples)
        .map(|_| Vector6::from_fn(|axis, _| sensed(axis)))
        .collect();
    let turn = at_truth.pose()?.rotation.transpose();
    let law = Law::proportional(gain);
    let measured_n = run(axis, &transmission.matrix, &law, &wanted, &noise)
        .measured
        .iter()
        .zip(&noise)
        .map(|(wrench, noise)| turn * (wrench + noise).fixed_rows::<3>(0))
        .collect();
    Ok(Course {
        wanted_n,
        measured_n,
    })
}

/// Three forces before and after, side by side.
pub(crate) fn figure(before: &Course, after: &Course) -> FigureGrid {
    let panel = |(name, course): (&str, &Course)| {
        let mut figure = Figure::new(name, "time [s]", "force [N]");
        let drawn = |force_n: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
            let samples = (0..course.wanted_n.len()).step_by(DRAWN);
            samples
                .map(|sample| (sample as f64 * SAMPLE_S, force_n(sample)))
                .collect()
        };
        for (axis, label) in ["F_x measured", "F_y measured", "F_z measured"]
            .iter()
            .enumerate()
        {
            figure.line(
                *label,
                axis,
                drawn(&|sample| course.measured_n[sample][axis]),
            );
        }
        figure.line("F_z wanted", 3, drawn(&|sample| course.wanted_n[sample]));
        figure
    };
    let courses = [
        ("before calibration", before),
        ("after full calibration", after),
    ];
    let panels = courses.map(panel).to_vec();
    FigureGrid::new("The virtual wall, 2 N along the handle's z", 1, panels)
}
