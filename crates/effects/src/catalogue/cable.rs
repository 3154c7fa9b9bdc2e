//! Effects of the measuring cable: zero, scale, sag, twist, exit guide, drum.

use super::{Effect, Family, Hook, Need, ParameterSpec, parameter};
use crate::context::{CableGeometry, Context};
use crate::signal::Signal;
use haptical_model::kinematics::nalgebra::Vector3;

pub(super) fn of_device() -> Vec<Box<dyn Effect>> {
    vec![
        Box::new(Reading { what: What::Zero }),
        Box::new(Reading { what: What::Scale }),
        Box::new(Reading {
            what: What::Stretch,
        }),
        Box::new(Reading { what: What::Sag }),
        Box::new(Reading { what: What::Twist }),
        Box::new(DrumEccentricity),
        Box::new(ExitGuide),
    ]
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum What {
    /// C2.
    Zero,
    /// C1.
    Scale,
    /// C8.
    Stretch,
    /// C3.
    Sag,
    /// C4.
    Twist,
}

/// An error of the reading that is one number times a function of the cable's place.
#[derive(Debug)]
struct Reading {
    what: What,
}

/// Angle between the cable and the axis along which it leaves its guide straight.
fn angle_rad(cable: &CableGeometry, row: usize) -> f64 {
    let cosine = cable.direction[row].dot(&cable.exit_axis).clamp(-1.0, 1.0);
    let sine = cable.direction[row].cross(&cable.exit_axis).norm();
    sine.atan2(cosine)
}

impl Effect for Reading {
    fn name(&self) -> &'static str {
        match self.what {
            What::Zero => "cable-zero-offset",
            What::Scale => "cable-scale",
            What::Stretch => "cable-stretch",
            What::Sag => "cable-sag",
            What::Twist => "cable-twist",
        }
    }

    fn hook(&self) -> Hook {
        Hook::CableSensor
    }

    fn family(&self) -> Family {
        Family::Exit
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        match self.what {
            What::Zero => const { &[parameter("offset_m", 0.0, 0.05)] },
            What::Scale | What::Stretch => const { &[parameter("scale", 0.0, 0.05)] },
            // a cable of 1e-2 N/m under 3 N has 1e-5 per m^2; ten times that is no cable
            What::Sag => const { &[parameter("weight_n_per_m_over_tension", 0.0, 0.05)] },
            What::Twist => const { &[parameter("twist_m_per_rad2", 0.0, 0.02)] },
        }
    }

    fn needs(&self) -> Vec<Need> {
        match self.what {
            What::Sag => vec![Need::Cable, Need::Gravity],
            _ => vec![Need::Cable],
        }
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let Some(cable) = &context.cable else {
            return vec![];
        };
        let down = context
            .device
            .gravity_mps2
            .and_then(|gravity| Vector3::from(gravity).try_normalize(1e-12))
            .unwrap_or(Vector3::zeros());
        let value = |row: usize| match self.what {
            What::Zero => 1.0,
            What::Scale | What::Stretch => cable.length_m[row],
            // (w cos(elevation) / T)^2 L^3 / 24, the amplitude being (w / T)^2
            What::Sag => {
                let level = 1.0 - cable.direction[row].dot(&down).powi(2);
                level * cable.length_m[row].powi(3) / 24.0
            }
            What::Twist => angle_rad(cable, row).powi(2),
        };
        vec![context.cable_error((0..context.rows()).map(value).collect())]
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        match self.what {
            What::Sag => vec![amplitudes[0].max(0.0).sqrt()],
            _ => vec![amplitudes[0]],
        }
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        match self.what {
            What::Sag => (vec![values[0] * values[0]], 0.0),
            _ => (vec![values[0]], 0.0),
        }
    }

    fn is_possible(&self, amplitudes: &[f64]) -> bool {
        self.what != What::Sag || amplitudes[0] > 0.0
    }

    fn log_prior(&self) -> f64 {
        match self.what {
            // physically negligible (docs/diagnosis.md): a fit that needs it is a warning
            What::Sag => -4.0,
            _ => 0.0,
        }
    }
}

/// C6: the drum on which the measuring cable is wound is eccentric, one period per turn.
#[derive(Debug)]
struct DrumEccentricity;

impl Effect for DrumEccentricity {
    fn name(&self) -> &'static str {
        "cable-drum-eccentricity"
    }

    fn hook(&self) -> Hook {
        Hook::CableSensor
    }

    fn family(&self) -> Family {
        Family::Shape
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        const {
            &[
                parameter("amplitude_m", 0.0, 5e-3),
                parameter("phase_rad", 0.0, 10.0),
            ]
        }
    }

    fn needs(&self) -> Vec<Need> {
        vec![Need::Cable, Need::DrumRadius]
    }

    fn shapes(&self, context: &Context<'_>) -> Vec<f64> {
        let radius = context
            .device
            .cables
            .first()
            .and_then(|cable| cable.drum_radius_m);
        radius.into_iter().collect()
    }

    /// The constant is the turn at the zero: no larger than the amplitude, its own uncertainty allowed for.
    fn is_possible(&self, amplitudes: &[f64]) -> bool {
        amplitudes[2].abs() <= 2.5 * amplitudes[0].hypot(amplitudes[1])
    }

    fn amplitude_count(&self) -> usize {
        3
    }

    /// The turn of the drum, and a constant: the reading was set where the drum had turned already.
    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        let Some(cable) = &context.cable else {
            return vec![];
        };
        let turns = cable.length_m.iter().map(|length| length / shape);
        vec![
            context.cable_error(turns.clone().map(f64::cos).collect()),
            context.cable_error(turns.map(f64::sin).collect()),
            context.cable_error(vec![1.0; context.rows()]),
        ]
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![
            amplitudes[0].hypot(amplitudes[1]),
            amplitudes[1].atan2(amplitudes[0]),
        ]
    }

    fn amplitudes(&self, context: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        let (sin, cos) = values[1].sin_cos();
        let shape = self.shapes(context).first().copied().unwrap_or(0.015);
        (vec![values[0] * cos, values[0] * sin, 0.0], shape)
    }
}

/// C5, C11: the cable bends over a round guide where it leaves its encoder.
#[derive(Debug)]
struct ExitGuide;

/// Length over a guide of radius r that the cable touches along its exit axis, minus the straight
/// distance `length_m` at the angle `angle_rad` from that axis: with the guide's centre at r across
/// the axis, v the handle seen from it, s^2 = v^2 - r^2 and the arc's angle that of v plus
/// atan(r / s), the length is s + r times that angle (docs/diagnosis.md, "Exit guide").
fn over_guide(length_m: f64, angle_rad: f64, radius_m: f64) -> f64 {
    let (sin, cos) = angle_rad.sin_cos();
    let (along, across) = (length_m * cos, length_m * sin - radius_m);
    let straight = (length_m * (length_m - 2.0 * radius_m * sin))
        .max(0.0)
        .sqrt();
    let turned = across.atan2(along) + radius_m.atan2(straight);
    straight + radius_m * turned - length_m
}

impl Effect for ExitGuide {
    fn name(&self) -> &'static str {
        "cable-exit-geometry"
    }

    fn hook(&self) -> Hook {
        Hook::CableSensor
    }

    fn family(&self) -> Family {
        Family::Exit
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        const { &[parameter("radius_m", 0.0, 0.05)] }
    }

    fn needs(&self) -> Vec<Need> {
        vec![Need::Cable]
    }

    fn derivative(&self, context: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<Signal> {
        let Some(cable) = &context.cable else {
            return vec![];
        };
        let radius = amplitudes.first().copied().unwrap_or(0.0);
        let step = 1e-5;
        let slope = |row: usize| {
            let angle = angle_rad(cable, row);
            let length = cable.length_m[row];
            (over_guide(length, angle, radius + step) - over_guide(length, angle, radius - step))
                / (2.0 * step)
        };
        vec![context.cable_error((0..context.rows()).map(slope).collect())]
    }

    fn contribution(&self, context: &Context<'_>, amplitudes: &[f64], _: f64) -> Signal {
        let Some(cable) = &context.cable else {
            return Signal::default();
        };
        let error = |row| over_guide(cable.length_m[row], angle_rad(cable, row), amplitudes[0]);
        context.cable_error((0..context.rows()).map(error).collect())
    }
}
