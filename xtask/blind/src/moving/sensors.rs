//! What sensors and recorder make of the ticks: counts, noise, rows.

use haptical_model::Recording;

use crate::moving::arms::Arm;
use crate::moving::arms::OUTPUT_COUNTS;
use crate::moving::motion::log::Ticks;
use crate::moving::motion::run::count;
use crate::random::Random;
use crate::rig::readings::rounded;

/// Digits of a log: angles to 1e-6, torques to 1e-3, times to 1e-4.
const ANGLE_STEPS: f64 = 1e6;
const TORQUE_STEPS: f64 = 1e3;
const TIME_STEPS: f64 = 1e4;

/// How an arm is logged.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sensors {
    pub(crate) rate_hz: f64,
    pub(crate) duration_s: f64,
    /// Standard deviation of each torque \[N m\] (\[N\]).
    pub(crate) noise: Vec<f64>,
    /// Correlation of the torque noise of rows 1/200 s apart; 0 for white noise.
    pub(crate) memory: f64,
    pub(crate) has_command: bool,
    pub(crate) has_outputs: bool,
}

impl Sensors {
    /// The recording of so many ticks; `rows` are the ticks that are shown, at regular times.
    pub(crate) fn read(
        &self,
        arm: &Arm,
        ticks: &Ticks,
        rows: &[usize],
        random: &mut Random,
    ) -> Recording {
        let joints = arm.count();
        let pick = |column: &[f64], read: &dyn Fn(f64) -> f64| -> Vec<f64> {
            rows.iter()
                .map(|row| rounded(read(column[*row]), ANGLE_STEPS))
                .collect()
        };
        let step = |size: f64| move |value: f64| libm::round(value / size) * size;
        let time = |row: usize| rounded(row as f64 / self.rate_hz, TIME_STEPS);
        let mut log = Recording {
            line: (0..rows.len() as u64).map(|row| row + 2).collect(),
            time_s: Some((0..rows.len()).map(time).collect()),
            run: Some(vec![1; rows.len()]),
            // a chain may have a cable, as a reader keeps it
            cable_m: vec![None],
            ..Recording::default()
        };
        for joint in 0..joints {
            log.joint
                .push(pick(&ticks.angle[joint], &step(count(arm, joint))));
            let of_output = std::f64::consts::TAU / OUTPUT_COUNTS;
            let output = self
                .has_outputs
                .then(|| pick(&ticks.output[joint], &step(of_output)));
            log.output.push(output);
            let noise = self.noise_of(joint, rows, random);
            let torque = rows
                .iter()
                .zip(noise)
                .map(|(row, noise)| rounded(ticks.torque[joint][*row] + noise, TORQUE_STEPS));
            log.torque_nm.push(Some(torque.collect()));
            if self.has_command {
                let unit = if arm.axes[joint].slides { "m" } else { "rad" };
                let command = pick(&ticks.command[joint], &|value| value);
                log.covariates
                    .push((format!("command{}_{unit}", joint + 1), command));
            }
        }
        log
    }

    /// Noise of the rows; a row that is shown twice has the same.
    pub(crate) fn noise_of(&self, joint: usize, rows: &[usize], random: &mut Random) -> Vec<f64> {
        let memory = libm::pow(self.memory, 200.0 / self.rate_hz);
        let fresh = libm::sqrt(1.0 - memory * memory);
        let mut before = random.normal();
        let mut last = None;
        rows.iter()
            .map(|row| {
                if last != Some(*row) {
                    before = memory * before + fresh * random.normal();
                    last = Some(*row);
                }
                self.noise[joint] * before
            })
            .collect()
    }
}
