//! Poses of step 2 that are chosen among candidates at the nominal device.

use anyhow::{Context, Result};
use haptical_calibration::Channel;
use haptical_design::{
    Criterion, Information, Limits, Posture, Region, Rig, Search, Spread, Terms, equip, postures,
    select, task_rows,
};
use haptical_simulator::simulate_transmission;
use xtask_paper::Scenario;

/// Candidates that poses are chosen from, drawn as the paper's random poses are.
pub(super) const CANDIDATES: usize = 2000;
const SEED: u64 = 1;

/// Standard deviations of joint 4's readings that 200 samples of step 1 are sure to reach.
const SURE_REACH: f64 = 2.0;
/// Those that they reach on both sides in half of the recordings.
const USUAL_REACH: f64 = 2.5;

/// What a choice counts on of the transmissions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Counted {
    /// That they are known.
    Known,
    /// What poses as those of step 1 tell of them, where step 1 is sure to have seen joint 4.
    StepOne,
    /// The same where step 1 has usually seen joint 4: poses out there make its polynomial better in one fit.
    OneFit,
}

/// Candidates of step 2 and what they tell.
pub(super) struct Choice {
    information: Information,
    candidates: Vec<Posture>,
    limits: Limits,
    counted: Counted,
}

/// What candidates tell at the nominal device.
pub(super) fn information(scenario: &Scenario, spread: Spread, counted: Counted) -> Result<Choice> {
    let mut nominal = scenario.nominal.clone();
    let fourth = &mut nominal.joints[3];
    let reach = match (spread, counted) {
        (_, Counted::OneFit) => Some(USUAL_REACH),
        (Spread::Uniform, _) | (_, Counted::StepOne) => Some(SURE_REACH),
        (_, Counted::Known) => None,
    };
    if let Some(reach) = reach {
        // beyond what step 1 saw its polynomial is not known, and the rows would be left out
        let reach = reach
            * fourth
                .sampling_sd_rad
                .context("joint 4 has no sampling_sd_rad")?;
        (fourth.lower_rad, fourth.upper_rad) = (-reach, reach);
    }
    let (rig, terms) = match counted {
        Counted::Known => ("cable", Terms::Known),
        Counted::StepOne | Counted::OneFit => ("cable,out", Terms::Degree(scenario.degree)),
    };
    let mut equipped = equip(&nominal, &Rig::parse(rig)?, terms)?;
    let limits = Limits {
        spread,
        ..Limits::default()
    };
    let candidates = postures(&mut equipped, &limits, CANDIDATES, SEED)?;
    let (outputs, cables) = (equipped.channels.iter().copied())
        .partition(|channel| matches!(channel, Channel::Output { .. }));
    equipped.channels = cables;
    let mut information = Information::new(&equipped, &candidates, &[])?;
    if counted != Counted::Known {
        let outputs: Vec<Channel> = outputs;
        for channel in outputs {
            let Channel::Output { joint } = channel else {
                continue;
            };
            let (settings, samples) = (&scenario.settings, scenario.samples);
            let recording = simulate_transmission(&nominal, settings, joint, samples, SEED)?;
            let row = |row: usize| recording.joint.iter().map(|column| column[row]).collect();
            let poses: Vec<Posture> = (0..samples)
                .map(|index| Posture::free(row(index)))
                .collect();
            equipped.channels = vec![channel];
            information = information.knowing(&Information::new(&equipped, &poses, &[])?);
        }
    }
    Ok(Choice {
        information,
        candidates,
        limits,
        counted,
    })
}

/// Readings of the chosen poses, at the nominal device.
pub(super) fn choose(choice: &Choice, criterion: Criterion, count: usize) -> Result<Vec<Vec<f64>>> {
    let information = &choice.information;
    let judged = information.judge(count)?;
    // the task is where the paper's poses are, wherever one measures
    let limits = match choice.counted {
        Counted::OneFit => Limits {
            spread: Spread::Normal,
            ..choice.limits
        },
        Counted::Known | Counted::StepOne => choice.limits,
    };
    let region = (&Region::Everywhere, &limits);
    let task = task_rows(criterion, information, &judged.independent, region, SEED)?;
    let search = Search::default();
    let chosen = select(information, &judged, count, criterion, &task, &search)?;
    let readings = |&pose: &usize| choice.candidates[pose].readings.clone();
    Ok(chosen.chosen.iter().map(readings).collect())
}
