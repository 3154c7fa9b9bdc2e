//! One recording from torques to what they show.

use haptical_model::{Device, Recording};

use crate::MotionError;
use crate::arm::Arm;
use crate::base::Base;
use crate::problem::Problem;
use crate::select::{Rival, Selection, select};

/// What the torques of a moving arm show.
#[derive(Debug, Clone, PartialEq)]
pub struct Examined {
    /// One entry a joint with torques.
    pub channels: Vec<ChannelFit>,
    /// Effects, strongest first.
    pub findings: Vec<Finding>,
    /// Energy beyond noise that the base model leaves, and that all effects leave \[nats\].
    pub before_nats: f64,
    /// See [`Examined::before_nats`].
    pub after_nats: f64,
    /// Independent rows behind both.
    pub freedom: f64,
    /// Edge of the band that rows were taken of \[Hz\].
    pub edge_hz: f64,
}

/// One joint's torque.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelFit {
    /// Joint, from 0.
    pub joint: usize,
    /// Root mean square of what the base model leaves within the band, in the torque's unit.
    pub rms_before: f64,
    /// With all effects.
    pub rms_after: f64,
    /// Noise of a row.
    pub noise: f64,
}

/// An effect that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Name.
    pub effect: &'static str,
    /// Joint, from 0.
    pub joint: Option<usize>,
    /// What it explains \[nats\].
    pub nats: f64,
    /// Numbers with their standard deviations.
    pub numbers: Vec<(&'static str, f64, f64)>,
    /// Effects that would explain nearly as much in its place, nearest first: how far behind \[nats\], and the share of its gain.
    pub rivals: Vec<(&'static str, Option<usize>, f64, f64)>,
}

/// Examines the torques of a motion; `without`: names of effects that are left out.
///
/// # Errors
/// [`MotionError`] for a recording that says nothing of a moving arm.
pub fn examine(
    device: &Device,
    recording: &Recording,
    without: &[String],
) -> Result<Examined, MotionError> {
    let arm = Arm::new(device)?;
    let mut problem = Problem::new(arm, recording, None)?;
    let base = Base::weighted(&mut problem);
    let selection = select(&problem, &base, without);
    Ok(examined(&problem, &selection))
}

fn examined(problem: &Problem, selection: &Selection) -> Examined {
    let rows = problem.states.rows();
    let rms = |rest: &[f64], channel: usize| {
        let own = &rest[channel * rows..][..rows];
        problem.row_sd[channel] * (haptical_linalg::dot(own, own) / rows as f64).sqrt()
    };
    let channels = problem
        .channels
        .iter()
        .enumerate()
        .map(|(channel, &joint)| ChannelFit {
            joint,
            rms_before: rms(&selection.rest_before, channel),
            rms_after: rms(&selection.rest_after, channel),
            noise: problem.row_sd[channel],
        });
    let rival = |own: &Rival| (own.effect, own.joint, own.behind, own.share);
    let findings = selection.picks.iter().map(|pick| Finding {
        effect: pick.effect,
        joint: pick.joint,
        nats: pick.nats,
        numbers: pick.numbers.clone(),
        rivals: pick.rivals.iter().map(rival).collect(),
    });
    Examined {
        channels: channels.collect(),
        findings: findings.collect(),
        before_nats: selection.before,
        after_nats: selection.after,
        freedom: selection.freedom,
        edge_hz: problem.states.pass.edge_hz,
    }
}
