//! The parts of a budget at every posture, with their sensitivities.

use haptical_calibration::{Calibration, Channel, ParameterFit};
use haptical_data::LogColumn;
use haptical_identification::{Added, Matrix};
use haptical_kinematics::nalgebra::{Matrix3, Vector3};
use haptical_metrics::budget::{Distribution, Group, Input, covariance_of};
use haptical_metrics::student_t_quantile;
use haptical_model::Recording;

use super::handle::{Handle, Place};
use super::instruments::{ActsAs, Instrument, Instruments};
use super::{Contribution, ParameterPart};
use crate::device::Device;
use crate::error::Error;
use crate::identify::{Identify, identify};
use crate::log::Log;

/// A part of a budget at one posture: inputs that are known together, and how the handle moves with each.
pub(super) struct Part {
    pub(super) name: String,
    /// What a single input is, and how it is known; none of the identified parameters.
    pub(super) input: Option<(Input, Origin)>,
    /// Columns of the derivative of the position.
    pub(super) slopes: Vec<Vector3<f64>>,
    /// Covariance of the inputs, row by row.
    pub(super) covariance: Vec<f64>,
    pub(super) degrees: f64,
}

/// Where an input comes from.
#[derive(Clone, Copy)]
pub(super) struct Origin {
    distribution: &'static str,
    unit: &'static str,
    kind: &'static str,
}

/// How the handle moves, at every posture, where an instrument was off by its standard uncertainty while the device was calibrated;
/// none of an instrument that is used afterwards.
pub(super) type Changed = Vec<Option<Vec<Vector3<f64>>>>;

/// Standard deviation of a scale whose uncertainty is a contribution of its own.
const CERTIFIED_SD: f64 = 1e-12;

/// The device, with the scale of each length that an instrument's certificate is about as good as known to the fit.
pub(super) fn with_certified_scales(device: &Device, instruments: &Instruments) -> Device {
    let mut own = device.clone();
    let acts = |name: &str| {
        let mut all = instruments.instrument.iter();
        all.any(|one| one.acts_as == ActsAs::Scale && one.acts_on == name)
    };
    if let Some(tracker) = own.model.tracker.as_mut().filter(|_| acts("position")) {
        tracker.scale_sd = Some(CERTIFIED_SD);
    }
    for (index, cable) in own.model.cables.iter_mut().enumerate() {
        let name = Channel::Cable { index }.name();
        if acts(&name) {
            cable.scale_sd = Some(CERTIFIED_SD);
        }
    }
    own
}

/// The device identified anew from a log whose readings are off by what each instrument may be: the sensitivity of what was
/// identified to an error that all readings share.
pub(super) fn identified_anew(
    (device, log): (&Device, &Log),
    options: &Identify,
    instruments: &Instruments,
    (handle, postures): (&Handle, &Recording),
) -> Result<Changed, Error> {
    let before = handle.positions(postures)?;
    let path = &log.source().path;
    let mut changed = Vec::new();
    for own in &instruments.instrument {
        if joint_of(own).is_some() {
            changed.push(None);
            continue;
        }
        let size = total(own);
        let mut shifted = log.recording.as_ref().clone();
        shift(&mut shifted, own, size).ok_or_else(|| {
            let what = format!(
                "`{}` acts on `{}`, which the log does not have",
                own.name, own.acts_on
            );
            let next =
                "name a channel of the log: out1, cable, position; or theta1 for a reading in use";
            Error::in_file("instruments", what, path, next)
        })?;
        let name = format!("{} with `{}` off", log.source().label, own.name);
        let shifted = Log::from_recording(shifted, &name, device)?;
        let found = identify(device, &shifted, options)?;
        let Some(again) = &found.calibration.fitted.whole else {
            let name = &own.name;
            let what = format!("with `{name}` off by its uncertainty nothing is identified");
            return Err(Error::in_file("instruments", what, path, "check its sizes"));
        };
        let after = Handle::new(again, &log.recording).positions(postures)?;
        let moved = before.iter().zip(&after);
        let moved = moved.map(|(before, after)| (after - before) / size);
        changed.push(Some(moved.collect()));
    }
    Ok(changed)
}

/// Standard uncertainty of an instrument, all its parts together.
fn total(own: &Instrument) -> f64 {
    let parts = own.parts().into_iter();
    let inputs = parts.filter_map(|(_, known)| known.input().ok());
    let squares = inputs.map(|input| input.standard_uncertainty().powi(2));
    squares.sum::<f64>().sqrt()
}

/// The joint that an instrument acts on in use: `theta3`.
fn joint_of(own: &Instrument) -> Option<usize> {
    let number: usize = own.acts_on.strip_prefix("theta")?.parse().ok()?;
    number.checked_sub(1)
}

/// Moves the readings of a channel; none where the recording has no such channel.
fn shift(recording: &mut Recording, own: &Instrument, size: f64) -> Option<()> {
    let apply = |column: &mut Vec<f64>| {
        for value in column {
            *value += match own.acts_as {
                ActsAs::Offset => size,
                ActsAs::Scale => size * *value,
            };
        }
    };
    let number = |name: &str| match own.acts_on.strip_prefix(name)? {
        "" => Some(0),
        number => number.parse::<usize>().ok()?.checked_sub(1),
    };
    if own.acts_on == "position" {
        let axes = recording.position_m.as_mut()?;
        axes.iter_mut().for_each(apply);
        return Some(());
    }
    let column = match own.acts_on.strip_prefix("position.") {
        Some(axis) => LogColumn::Position("xyz".find(axis)?),
        None => match number("out") {
            Some(joint) => LogColumn::Output(joint),
            None => LogColumn::Cable(number("cable")?),
        },
    };
    column.readings_mut(recording).map(apply)
}

/// Root mean square that the model leaves beyond noise, of the channels that measure lengths \[m\], on rows that the fit did not see.
pub(super) fn unexplained_m(calibration: &Calibration) -> f64 {
    let judged = match calibration.held_out_channels.is_empty() {
        true => &calibration.fit_channels,
        false => &calibration.held_out_channels,
    };
    let own = judged.iter().filter(|channel| channel.unit == "m");
    let squares = own.map(|channel| channel.rms_after.powi(2) - channel.noise_floor.powi(2));
    squares.fold(0.0, f64::max).sqrt()
}

/// The parts at every posture.
pub(super) fn parts(
    (handle, fit): (&Handle, &ParameterFit),
    postures: &Recording,
    places: &[Place],
    instruments: &Instruments,
    (changed, beyond_m): (&[Option<Vec<Vector3<f64>>>], f64),
) -> Result<Vec<Vec<Part>>, Error> {
    let readings = handle.by_reading(postures)?;
    let mut all = Vec::with_capacity(postures.len());
    for (row, (place, by_reading)) in places.iter().zip(&readings).enumerate() {
        let mut parts = vec![Part {
            name: "identified parameters".to_owned(),
            input: None,
            slopes: place.by_parameter.clone(),
            covariance: handle.covariance.clone(),
            degrees: degrees(fit, place, &handle.covariance),
        }];
        for (joint, own) in fit.device.joints.iter().enumerate() {
            if let Some(step) = own.reading_quantum_rad().filter(|step| *step > 0.0) {
                let half_width = 0.5 * step;
                let input = Input::new(Distribution::Rectangular { half_width }, f64::INFINITY);
                let name = format!("step of the encoder of joint {}, in use", joint + 1);
                let slope = by_reading[joint];
                parts.push(Part::single(
                    name,
                    input,
                    ["rectangular", "rad", "B"],
                    slope,
                ));
            }
        }
        for (own, moved) in instruments.instrument.iter().zip(changed) {
            for (part, known) in own.parts() {
                let slope = match (joint_of(own), moved) {
                    (Some(joint), _) if joint < by_reading.len() => match own.acts_as {
                        ActsAs::Offset => by_reading[joint],
                        ActsAs::Scale => by_reading[joint] * postures.joint[joint][row],
                    },
                    (None, Some(moved)) => moved[row],
                    _ => {
                        let (name, on) = (&own.name, &own.acts_on);
                        let what = format!("`{name}` acts on `{on}`, and there is no such joint");
                        let next = "joints count from 1";
                        return Err(Error::command_line("instruments", what, next));
                    }
                };
                let name = format!("{}: {part}", own.name);
                let input = known.input().map_err(Error::internal)?;
                let origin = [known.words(), unit(own), "B"];
                parts.push(Part::single(name, input, origin, slope));
            }
        }
        if beyond_m > 0.0 {
            let standard_uncertainty = beyond_m;
            let distribution = Distribution::Normal {
                standard_uncertainty,
            };
            let input = Input::new(distribution, f64::INFINITY);
            for (axis, slope) in ["x", "y", "z"]
                .iter()
                .zip(Matrix3::identity().column_iter())
            {
                let name = format!("what the model leaves on unseen rows, {axis}");
                let slope = slope.into_owned();
                parts.push(Part::single(name, input, ["normal", "m", "A"], slope));
            }
        }
        all.push(parts);
    }
    Ok(all)
}

fn unit(own: &Instrument) -> &'static str {
    match own.acts_as {
        ActsAs::Scale => "1",
        ActsAs::Offset if own.acts_on.starts_with("out") || own.acts_on.starts_with("theta") => {
            "rad"
        }
        ActsAs::Offset => "m",
    }
}

/// Degrees of freedom of the axis that the fit knows least: those of Student's factor of its interval.
fn degrees(fit: &ParameterFit, place: &Place, covariance: &[f64]) -> f64 {
    let count = place.by_parameter.len();
    let variance = |axis: usize| {
        let slopes = place.by_parameter.iter().map(|slope| slope[axis]);
        let slopes: Vec<f64> = slopes.collect();
        covariance_of(&slopes, &slopes, covariance).unwrap_or(0.0)
    };
    let variances = [0, 1, 2].map(variance);
    let larger = |a: &usize, b: &usize| variances[*a].total_cmp(&variances[*b]);
    let widest = (0..3).max_by(larger).unwrap_or(0);
    let fitted = fit.fitted.len().min(count);
    let slope = |row: usize| place.by_parameter[row][widest];
    let part = |own: &Matrix| {
        let row = |a: usize| (0..fitted).map(move |b| slope(a) * own[(a, b)] * slope(b));
        (0..fitted).map(|a| row(a).sum::<f64>()).sum::<f64>()
    };
    let added = Added {
        variance: variances[widest] - part(&fit.uncertainty.covariance),
        scatter: 0.0,
    };
    let half_widths = fit.uncertainty.half_widths(fit.noise);
    let factor = half_widths.of_function(&part, added);
    let is_above = |degrees: f64| {
        student_t_quantile(0.95, degrees).is_ok_and(|own| own > factor * (1.0 + 1e-9))
    };
    let (mut low, mut high) = (1.0_f64, 1e7_f64);
    if is_above(high) {
        return f64::INFINITY;
    }
    for _ in 0..60 {
        let middle = (low * high).sqrt();
        match is_above(middle) {
            true => low = middle,
            false => high = middle,
        }
    }
    high
}

impl Part {
    fn single(
        name: String,
        input: Input,
        [distribution, unit, kind]: [&'static str; 3],
        slope: Vector3<f64>,
    ) -> Self {
        let origin = Origin {
            distribution,
            unit,
            kind,
        };
        Self {
            name,
            slopes: vec![slope],
            covariance: vec![input.standard_uncertainty().powi(2)],
            degrees: input.degrees_of_freedom,
            input: Some((input, origin)),
        }
    }

    /// Covariance of the position.
    pub(super) fn covariance(&self) -> Matrix3<f64> {
        let count = self.slopes.len();
        let mut sum = Matrix3::zeros();
        for (a, own) in self.slopes.iter().enumerate() {
            let others = self.slopes.iter().enumerate();
            let along: Vector3<f64> = others
                .map(|(b, other)| other * self.covariance[a * count + b])
                .sum();
            sum += own * along.transpose();
        }
        // rounding must not turn its axes
        0.5 * (sum + sum.transpose())
    }

    /// Along a direction.
    pub(super) fn along(&self, axis: &Vector3<f64>) -> Group {
        Group {
            sensitivities: self.slopes.iter().map(|slope| axis.dot(slope)).collect(),
            covariance: self.covariance.clone(),
            degrees_of_freedom: self.degrees,
        }
    }

    /// Its line.
    pub(super) fn tell(
        &self,
        handle: &Handle,
        axis: &Vector3<f64>,
        whole: f64,
    ) -> Result<Contribution, Error> {
        let group = self.along(axis);
        let variance = group.variance().map_err(Error::internal)?;
        let single = self.input.as_ref();
        let origin = single.map(|(_, origin)| *origin).unwrap_or(Origin {
            distribution: "Student",
            unit: "",
            kind: "A",
        });
        let slope = group.sensitivities.first().copied();
        let mut told = Contribution {
            name: self.name.clone(),
            kind: origin.kind,
            distribution: origin.distribution,
            standard_uncertainty: single.map(|(input, _)| input.standard_uncertainty()),
            unit: origin.unit.to_owned(),
            sensitivity: slope.filter(|_| single.is_some()),
            contribution_m: variance.sqrt(),
            share: variance / whole.max(f64::MIN_POSITIVE),
            degrees_of_freedom: self.degrees.is_finite().then_some(self.degrees),
            parameters: Vec::new(),
        };
        if single.is_none() {
            let count = handle.parameters.len();
            let own = handle.parameters.iter().zip(&group.sensitivities);
            let parts = own.enumerate().map(|(at, (parameter, sensitivity))| {
                let size = self.covariance[at * (count + 1)].max(0.0).sqrt();
                ParameterPart {
                    name: parameter.name(&handle.device),
                    standard_uncertainty: size,
                    unit: parameter.unit(&handle.device).to_owned(),
                    sensitivity: *sensitivity,
                    contribution_m: (sensitivity * size).abs(),
                }
            });
            told.parameters = parts.collect();
            let larger = |a: &ParameterPart, b: &ParameterPart| {
                b.contribution_m.total_cmp(&a.contribution_m)
            };
            told.parameters.sort_by(larger);
        }
        Ok(told)
    }
}
