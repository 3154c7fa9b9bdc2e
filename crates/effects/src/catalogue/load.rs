//! Effects of load: stretch of capstan cables, creep, flexible joints, base and handle.

use haptical_model::kinematics::nalgebra::Vector3;

use super::{Effect, Family, Hook, Need, ParameterSpec, parameter};
use crate::context::Context;
use crate::signal::Signal;

pub(super) fn at_joint(joint: usize, has_drums: bool) -> Vec<Box<dyn Effect>> {
    let mut effects: Vec<Box<dyn Effect>> = vec![
        Box::new(Compliance {
            joint,
            behind_encoder: false,
        }),
        Box::new(Compliance {
            joint,
            behind_encoder: true,
        }),
    ];
    if has_drums {
        effects.push(Box::new(Creep { joint }));
    }
    effects
}

pub(super) fn of_device() -> Vec<Box<dyn Effect>> {
    vec![Box::new(BaseCompliance), Box::new(ToolCompliance)]
}

/// A1 and D1: the joint yields by torque over stiffness, in front of its external encoder
/// (capstan cable) or behind it (joint and link). The motor side leads by tau / k.
#[derive(Debug)]
struct Compliance {
    joint: usize,
    behind_encoder: bool,
}

impl Effect for Compliance {
    fn name(&self) -> &'static str {
        if self.behind_encoder {
            "joint-compliance"
        } else {
            "capstan-compliance"
        }
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn hook(&self) -> Hook {
        if self.behind_encoder {
            Hook::Joint
        } else {
            Hook::Transmission
        }
    }

    fn family(&self) -> Family {
        Family::Load
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        const { &[parameter("stiffness_nm_per_rad", 20.0, 1e7)] }
    }

    fn needs(&self) -> Vec<Need> {
        let second = if self.behind_encoder {
            Need::Chain
        } else {
            Need::Output(self.joint)
        };
        vec![Need::Torque(self.joint), second]
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let Some(torque) = context.torque_nm.get(self.joint).and_then(Option::as_ref) else {
            return vec![];
        };
        let error: Vec<f64> = torque.iter().map(|torque| -torque).collect();
        vec![if self.behind_encoder {
            context.downstream(self.joint, &error)
        } else {
            context.upstream(self.joint, &error)
        }]
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![1.0 / amplitudes[0]]
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![1.0 / values[0]], 0.0)
    }

    fn is_possible(&self, amplitudes: &[f64]) -> bool {
        amplitudes[0] > 0.0
    }

    fn scale_uncertainty(&self, context: &Context<'_>) -> f64 {
        context.device.joints[self.joint].torque_scale_sd
    }
}

/// A2: the wrap slips a little with every loaded travel, d(theta) = kappa tau |d(theta)|.
#[derive(Debug)]
struct Creep {
    joint: usize,
}

impl Effect for Creep {
    fn name(&self) -> &'static str {
        "capstan-creep"
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn hook(&self) -> Hook {
        Hook::Transmission
    }

    fn family(&self) -> Family {
        Family::Drift
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        const { &[parameter("creep_per_nm", 0.0, 4e-3)] }
    }

    fn needs(&self) -> Vec<Need> {
        vec![Need::Motion, Need::Torque(self.joint)]
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let Some(torque) = context.torque_nm.get(self.joint).and_then(Option::as_ref) else {
            return vec![];
        };
        let travel = &context.recording.joint[self.joint];
        let mut error = vec![0.0; context.rows()];
        for run in &context.runs {
            let mut crept = 0.0;
            for row in run.clone().skip(1) {
                let mean = 0.5 * (torque[row] + torque[row - 1]);
                crept -= mean * (travel[row] - travel[row - 1]).abs();
                error[row] = crept;
            }
        }
        vec![context.upstream(self.joint, &error)]
    }

    fn scale_uncertainty(&self, context: &Context<'_>) -> f64 {
        context.device.joints[self.joint].torque_scale_sd
    }

    fn is_possible(&self, amplitudes: &[f64]) -> bool {
        // the wrap gives way to the load
        amplitudes[0] > 0.0
    }

    fn log_prior(&self) -> f64 {
        -1.0
    }
}

/// D6: the mount of the robot turns against the cable encoder by C M, M the moment of hand and
/// weights about the base.
#[derive(Debug)]
struct BaseCompliance;

impl Effect for BaseCompliance {
    fn name(&self) -> &'static str {
        "base-compliance"
    }

    fn hook(&self) -> Hook {
        Hook::Structure
    }

    fn family(&self) -> Family {
        Family::Load
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        const { &[parameter("rad_per_nm", 0.0, 1e-2)] }
    }

    fn needs(&self) -> Vec<Need> {
        vec![Need::Chain, Need::BaseMoment]
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let Some(moment) = &context.base_moment_nm else {
            return vec![];
        };
        vec![context.handle(|row| (moment[row].cross(&context.way_from_base(row)), moment[row]))]
    }

    fn is_possible(&self, amplitudes: &[f64]) -> bool {
        amplitudes[0] > 0.0
    }
}

/// D7: the handle's fastening gives way along the hand's force.
#[derive(Debug)]
struct ToolCompliance;

impl Effect for ToolCompliance {
    fn name(&self) -> &'static str {
        "tool-compliance"
    }

    fn hook(&self) -> Hook {
        Hook::Structure
    }

    fn family(&self) -> Family {
        Family::Tool
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        const { &[parameter("m_per_n", 0.0, 2e-3)] }
    }

    fn needs(&self) -> Vec<Need> {
        vec![Need::Chain, Need::Force]
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let Some(force) = &context.force_n else {
            return vec![];
        };
        vec![context.handle(|row| (force[row], Vector3::zeros()))]
    }

    fn is_possible(&self, amplitudes: &[f64]) -> bool {
        amplitudes[0] > 0.0
    }
}
