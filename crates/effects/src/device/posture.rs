//! What the effects of a device do to its handle where the arm rests, posture by posture.

use haptical_calibration::{Channel, channels};
use haptical_model::kinematics::Twist;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, Recording};

use crate::device::bare::bare;
use crate::device::error::DeviceEffectError;
use crate::device::handle::seen_exactly;
use crate::device::resolve::{OwnEffect, effects_of};
use crate::{Context, Hook, Need, Stream, streams};

/// The effects of a device that move its handle and depend on the posture, its loads and the temperature alone: not on how
/// the arm got there.
#[derive(Debug)]
pub struct PostureEffects {
    own: Vec<OwnEffect>,
    /// The device without them, its handle seen in frame (-1).
    base: Device,
    left_out: Vec<(String, &'static str)>,
}

const OF_MOTION: &str = "it depends on how the arm moves, not on the posture alone";
const OF_ONE_RECORDING: &str = "it belongs to one recording";
const NO_TEMPERATURE: &str = "there is no column temp_degc";
const NO_LOAD: &str = "there are neither torques or forces nor masses with [gravity]";
const UNKNOWN: &str = "its numbers are not known yet: identify the device first";

impl PostureEffects {
    /// Those of a device at postures: rows of readings with the conditions (torques, forces, temperature) that are known.
    ///
    /// # Errors
    /// [`DeviceEffectError`] for an effect without a meaning.
    ///
    /// ```
    /// use haptical_effects::device::PostureEffects;
    /// use haptical_model::{Device, Recording};
    /// let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
    ///     [[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = 2.0\ncentre_of_mass_m = [0.3, 0.0, 0.0]\n\
    ///     [[joint]]\ntransmission = \"capstan\"\ntransmission_ratio = 10.0\n\
    ///     drum_distance_m = 0.1\n[gravity]\nvector_mps2 = [0.0, -10.0, 0.0]\n\
    ///     [[effect]]\nname = \"capstan-compliance\"\njoint = 1\nstiffness_nm_per_rad = 600.0\n\
    ///     [[effect]]\nname = \"backlash\"\njoint = 1\nwidth_rad = 1e-3\n";
    /// let lever = Device::from_toml(text, "lever.toml")?.device;
    /// let level = Recording { line: vec![2], joint: vec![vec![0.0]], ..Recording::default() };
    /// let effects = PostureEffects::new(&lever, &level)?;
    /// // 6 N m on 600 N m/rad, at 0.4 m
    /// let moved = &effects.displacements(&level)?[0];
    /// assert!((moved.linear.y + 0.4 * 0.01_f64.sin()).abs() < 1e-12 && (moved.angular.z + 0.01).abs() < 1e-12);
    /// assert!(effects.left_out()[0].starts_with("backlash@1: it depends on how the arm moves"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(device: &Device, postures: &Recording) -> Result<Self, DeviceEffectError> {
        let base = seen_exactly(&bare(device));
        let (mut kept, mut left_out) = (Vec::new(), Vec::new());
        for own in effects_of(device)? {
            match reason(&own, &base, postures) {
                None => kept.push(own),
                Some("") => {}
                Some(why) => left_out.push((device.effects[own.index].label(), why)),
            }
        }
        Ok(Self {
            own: kept,
            base,
            left_out,
        })
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.own.is_empty()
    }

    /// Effects that move the handle and are no part of this, and why, a sentence each.
    pub fn left_out(&self) -> Vec<String> {
        let all = self.left_out.iter();
        all.map(|(label, why)| format!("{label}: {why}")).collect()
    }

    /// How far they move the handle at each row from where readings and geometry put it: a way \[m\] and a rotation vector
    /// \[rad\], frame (-1). Each acts alone; the displacements are added.
    ///
    /// # Errors
    /// [`DeviceEffectError::Context`] for a row at which the device has no value.
    pub fn displacements(&self, postures: &Recording) -> Result<Vec<Twist>, DeviceEffectError> {
        let rows = postures.len();
        let mut moved = vec![Twist::default(); rows];
        if self.is_empty() || rows == 0 {
            return Ok(moved);
        }
        let column = |value: f64| vec![value; rows];
        let seen = Recording {
            line: postures.line.clone(),
            // each row by itself: nothing is smoothed over its neighbours
            run: Some((0..rows as i64).collect()),
            joint: postures.joint.clone(),
            position_m: Some([column(0.0), column(0.0), column(0.0)]),
            orientation_wxyz: Some([column(1.0), column(0.0), column(0.0), column(0.0)]),
            torque_nm: postures.torque_nm.clone(),
            force_n: postures.force_n.clone(),
            temperature_degc: postures.temperature_degc.clone(),
            hand: postures.hand.clone(),
            output: vec![None; postures.joint.len()],
            ..Recording::default()
        };
        let channels = channels(&self.base, &seen).unwrap_or_default();
        let streams = streams(&self.base, &channels);
        let mut context = Context::new(&self.base, &seen, &streams)?;
        let mean_degc = context.reference_degc;
        for own in &self.own {
            context.set_reference_degc(own.reference_degc().unwrap_or(mean_degc));
            let (amplitudes, shape) = own.amplitudes(&context);
            let signal = own.effect.exact_signal(&context, &amplitudes, shape);
            for (stream, values) in &signal.parts {
                let Some(stream) = streams.get(*stream) else {
                    continue;
                };
                for (moved, value) in moved.iter_mut().zip(values) {
                    if let Some(part) = part(stream, moved) {
                        part[stream.axis] += value;
                    }
                }
            }
        }
        Ok(moved)
    }
}

fn part<'m>(stream: &Stream, moved: &'m mut Twist) -> Option<&'m mut Vector3<f64>> {
    match stream.channel {
        Channel::Position => Some(&mut moved.linear),
        Channel::Orientation => Some(&mut moved.angular),
        _ => None,
    }
}

/// Why an effect is left out; empty where it moves no handle, none where it is kept.
fn reason(own: &OwnEffect, device: &Device, postures: &Recording) -> Option<&'static str> {
    let spec = own.effect.spec();
    match spec.hook {
        Hook::Transmission | Hook::Joint | Hook::Structure => {}
        Hook::Timing => return Some(OF_MOTION),
        _ => return Some(""),
    }
    let lacks_load = || {
        let joint = own.effect.joint().unwrap_or(0);
        let has_torques = postures.torque_nm.get(joint).is_some_and(Option::is_some);
        let has_weights = haptical_model::Statics::new(device).has_weights();
        !has_torques && !has_weights && postures.force_n.is_none()
    };
    let of_need = |need: &Need| match need {
        Need::Runs | Need::Counts | Need::OneBase | Need::EarlierModel => Some(OF_ONE_RECORDING),
        Need::Time | Need::Motion | Need::Order | Need::Command | Need::Inertia => Some(OF_MOTION),
        Need::Temperature if postures.temperature_degc.is_none() => Some(NO_TEMPERATURE),
        Need::Torque | Need::BaseMoment if lacks_load() => Some(NO_LOAD),
        // without a force of the hand nothing yields to it
        Need::Force if postures.force_n.is_none() => Some(""),
        _ => None,
    };
    let mut needs = spec.needs.iter();
    needs
        .find_map(of_need)
        .or_else(|| own.values.is_none().then_some(UNKNOWN))
}
