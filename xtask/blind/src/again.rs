//! A trial's device once more: further recordings of it, along motions that are given or drawn.

use anyhow::Result;
use haptical_model::{Device, Recording};

use crate::effects::Effect;
use crate::random::Random;
use crate::rig::motion::{Motion, MotionPlan};
use crate::rig::noise::NoisePlan;
use crate::rig::scene::{Scene, stream};
use crate::rig::surroundings::hand_force;

/// Of the force of a usual hand, what a hand that is told to press is off by.
const UNSTEADY: f64 = 0.25;

/// The device of a trial, with its effects.
#[derive(Debug)]
pub struct Again {
    pub(crate) device: Device,
    pub(crate) effects: Vec<Effect>,
    pub(crate) plan: MotionPlan,
    pub(crate) noise: NoisePlan,
    pub(crate) scales: Vec<f64>,
}

/// A motion along which a device is led.
#[derive(Debug, Clone, PartialEq)]
pub struct Led<'m> {
    /// Angle of each joint from home, row by row \[rad\].
    pub angle_rad: &'m [Vec<f64>],
    /// Rows per second \[1/s\].
    pub rate_hz: f64,
    /// Force of the hand in the handle's frame \[N\], row by row; none where it is told to press nothing.
    pub force_n: Option<&'m [Vec<f64>; 3]>,
    /// Temperature to which the device is warmed up before \[degC\]; none where it starts cold.
    pub warm_degc: Option<f64>,
}

impl Again {
    /// A recording along a motion that is given. The hand is off by a quarter of a usual force; noise, temperature and events
    /// are drawn.
    pub fn led(&self, led: &Led<'_>, seed: u64) -> Result<Recording> {
        let rows = led.angle_rad.first().map_or(0, Vec::len);
        let plan = MotionPlan {
            rows,
            rate_hz: led.rate_hz,
            runs: 1,
            hand: UNSTEADY * self.plan.hand,
            ..self.plan
        };
        let mut force_n = hand_force(rows, &plan, &mut Random::new(seed, stream::FORCE));
        for (axis, column) in led.force_n.into_iter().flatten().enumerate() {
            for (force, told) in force_n.iter_mut().zip(column) {
                force[axis] += told;
            }
        }
        let rates = |column: &Vec<f64>| slopes(column, led.rate_hz);
        let rate_rad_s: Vec<Vec<f64>> = led.angle_rad.iter().map(rates).collect();
        let motion = Motion {
            time_s: (0..rows).map(|row| row as f64 / led.rate_hz).collect(),
            run: vec![0; rows],
            angle_rad: led.angle_rad.to_vec(),
            acceleration_rad_s2: rate_rad_s.iter().map(rates).collect(),
            rate_rad_s,
        };
        let scene = Scene::of_motion(&self.device, &plan, motion, force_n, led.warm_degc, seed);
        Ok(scene.record(&self.effects, &self.noise, &self.scales)?.log)
    }

    /// A recording like that of the trial, of so many rows.
    pub fn drawn(&self, rows: usize, seed: u64) -> Result<Recording> {
        let plan = MotionPlan {
            rows,
            runs: 1,
            ..self.plan
        };
        let scene = Scene::draw(&self.device, &plan, seed)?;
        Ok(scene.record(&self.effects, &self.noise, &self.scales)?.log)
    }
}

/// Slopes by central differences \[1/s\].
fn slopes(values: &[f64], rate_hz: f64) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let slope = |row: usize| {
        let (before, after) = (row.saturating_sub(1), (row + 1).min(last));
        let rows = (after - before).max(1) as f64;
        (values[after] - values[before]) * rate_hz / rows
    };
    (0..values.len()).map(slope).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Suite;

    #[test]
    fn a_device_is_led_along_a_motion_and_is_the_same_device() {
        let (trial, again) = Suite::Clean.draw_again(0, 1).unwrap().unwrap();
        assert_eq!(trial.log, Suite::Clean.draw(0, 1).unwrap().log);
        assert!(Suite::Wrist.draw_again(0, 1).unwrap().is_none());
        let wave = |joint: usize| -> Vec<f64> {
            let rows = (0..300).map(f64::from);
            rows.map(|row| 0.2 * (0.02 * row + joint as f64).sin())
                .collect()
        };
        let angle_rad: Vec<Vec<f64>> = (0..trial.device.joints.len()).map(wave).collect();
        let led = Led {
            angle_rad: &angle_rad,
            rate_hz: 100.0,
            force_n: None,
            warm_degc: None,
        };
        let log = again.led(&led, 7).unwrap();
        let column = log.output.iter().flatten().next().unwrap();
        let joint = log.output.iter().position(Option::is_some).unwrap();
        let worst = column
            .iter()
            .zip(&angle_rad[joint])
            .map(|(a, b)| (a - b).abs());
        // an external encoder reads what it was led along, but for noise
        assert!(worst.fold(0.0, f64::max) < 2e-3);
        assert_eq!(log, again.led(&led, 7).unwrap());
        assert_ne!(log, again.led(&led, 8).unwrap());
        // warmed up it stays nearly as warm
        let warm = Led {
            warm_degc: Some(30.0),
            ..led.clone()
        };
        let degc = |log: &Recording| log.temperature_degc.clone().unwrap();
        let (cold, warm) = (degc(&log), degc(&again.led(&warm, 7).unwrap()));
        assert!(
            cold[0] < 24.0 && (warm[0] - 30.0).abs() < 1.5,
            "{} {}",
            cold[0],
            warm[0]
        );
        assert!((warm[299] - warm[0]).abs() < 1.0 && cold[299] - cold[0] > 0.4);
    }

    #[test]
    fn slopes_are_those_of_a_parabola() {
        let values: Vec<f64> = (0..50).map(|row| (f64::from(row) * 0.01).powi(2)).collect();
        let found = slopes(&values, 100.0);
        for (row, slope) in found.iter().enumerate().skip(1).take(48) {
            assert!((slope - 0.02 * row as f64).abs() < 1e-12);
        }
    }
}
