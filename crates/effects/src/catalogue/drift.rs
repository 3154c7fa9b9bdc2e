//! Effects of time and temperature: drifting encoders, drives and cables, thermal growth.

use haptical_model::kinematics::nalgebra::Vector3;

use super::{Effect, Family, Hook, Need, ParameterSpec, parameter};
use crate::context::Context;
use crate::signal::Signal;

pub(super) fn at_joint(joint: usize) -> Vec<Box<dyn Effect>> {
    vec![
        Box::new(Drift {
            what: What::Drive(joint),
        }),
        Box::new(Drift {
            what: What::DriveWarming(joint),
        }),
        Box::new(Drift {
            what: What::External(joint),
        }),
    ]
}

pub(super) fn of_device() -> Vec<Box<dyn Effect>> {
    vec![
        Box::new(Drift { what: What::Cable }),
        Box::new(ThermalGrowth { links: false }),
        Box::new(ThermalGrowth { links: true }),
    ]
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum What {
    /// In time.
    Drive(usize),
    /// A14.
    DriveWarming(usize),
    /// B4.
    External(usize),
    /// C10.
    Cable,
}

/// A slow change.
#[derive(Debug)]
struct Drift {
    what: What,
}

impl Drift {
    /// Time constants of a drift that settles, as shares of the recording; 0 is a steady one.
    fn course(context: &Context<'_>, shape: f64) -> Vec<f64> {
        let Some(elapsed_s) = context.elapsed_s() else {
            return vec![0.0; context.rows()];
        };
        let whole = elapsed_s.iter().copied().fold(0.0, f64::max).max(1e-9);
        if shape == 0.0 {
            return elapsed_s;
        }
        // scaled to the slope of a steady drift with the same end
        let end = 1.0 - (-1.0 / shape).exp();
        elapsed_s
            .into_iter()
            .map(|time| whole * (1.0 - (-time / (shape * whole)).exp()) / end)
            .collect()
    }
}

impl Effect for Drift {
    fn name(&self) -> &'static str {
        match self.what {
            What::Drive(_) | What::DriveWarming(_) => "joint-drift",
            What::External(_) => "external-encoder-drift",
            What::Cable => "cable-drift",
        }
    }

    fn joint(&self) -> Option<usize> {
        match self.what {
            What::Drive(joint) | What::DriveWarming(joint) | What::External(joint) => Some(joint),
            _ => None,
        }
    }

    fn hook(&self) -> Hook {
        match self.what {
            What::Drive(_) | What::DriveWarming(_) => Hook::Transmission,
            What::External(_) => Hook::ExternalEncoder,
            What::Cable => Hook::CableSensor,
        }
    }

    fn family(&self) -> Family {
        Family::Drift
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        match self.what {
            What::Drive(_) | What::External(_) => const { &[parameter("rad_per_s", 0.0, 5e-4)] },
            What::DriveWarming(_) => const { &[parameter("rad_per_degc", 0.0, 2e-3)] },
            What::Cable => const { &[parameter("m_per_s", 0.0, 1e-4)] },
        }
    }

    fn needs(&self) -> Vec<Need> {
        match self.what {
            What::Drive(_) => vec![Need::Time],
            What::DriveWarming(_) => vec![Need::Temperature],
            What::External(joint) => vec![Need::Time, Need::Output(joint)],
            What::Cable => vec![Need::Time, Need::Cable],
        }
    }

    fn shapes(&self, _: &Context<'_>) -> Vec<f64> {
        match self.what {
            What::Drive(_) | What::External(_) | What::Cable => vec![0.0, 1.0, 0.3, 0.1],
            What::DriveWarming(_) => vec![0.0],
        }
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        let warming = context.warming_k.clone().unwrap_or_default();
        vec![match self.what {
            What::Drive(joint) => context.upstream(joint, &Self::course(context, shape)),
            What::DriveWarming(joint) => context.upstream(joint, &warming),
            What::External(joint) => context.encoder(joint, &Self::course(context, shape)),
            What::Cable => context.cable_error(Self::course(context, shape)),
        }]
    }
}

/// C9 and D8: the cable and its encoder, or all links, grow with temperature.
#[derive(Debug)]
struct ThermalGrowth {
    links: bool,
}

/// Mean distance of the first cable; 1 m without one.
fn mean_length_m(context: &Context<'_>) -> f64 {
    context.cable.as_ref().map_or(1.0, |cable| {
        cable.length_m.iter().sum::<f64>() / cable.length_m.len().max(1) as f64
    })
}

impl Effect for ThermalGrowth {
    fn name(&self) -> &'static str {
        "thermal-drift"
    }

    fn hook(&self) -> Hook {
        if self.links {
            Hook::Structure
        } else {
            Hook::CableSensor
        }
    }

    fn family(&self) -> Family {
        Family::Drift
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        const { &[parameter("m_per_degc", 0.0, 3e-4)] }
    }

    fn needs(&self) -> Vec<Need> {
        let place = if self.links { Need::Chain } else { Need::Cable };
        vec![Need::Temperature, place]
    }

    fn amplitude_count(&self) -> usize {
        if self.links { 1 } else { 2 }
    }

    /// Of the cable: a shift at the mean distance (housing and cable), and what grows with the
    /// distance beyond that. Of the links: growth of the way from base to handle.
    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let Some(warming) = &context.warming_k else {
            return vec![];
        };
        let mean = mean_length_m(context);
        if self.links {
            return vec![context.handle(|row| {
                let grown = context.way_from_base(row) * (warming[row] / mean);
                (grown, Vector3::zeros())
            })];
        }
        let Some(cable) = &context.cable else {
            return vec![];
        };
        let beyond = warming.iter().zip(&cable.length_m);
        let beyond = beyond.map(|(warming, length)| warming * (length / mean - 1.0));
        vec![
            context.cable_error(warming.clone()),
            context.cable_error(beyond.collect()),
        ]
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        let mut amplitudes = vec![0.0; self.amplitude_count()];
        amplitudes[0] = values[0];
        (amplitudes, 0.0)
    }
}
