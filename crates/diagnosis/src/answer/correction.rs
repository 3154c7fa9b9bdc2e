//! A curve in the place of a cause that is not known: fitted where the gap lies, and kept where it predicts unseen rows.

use haptical_effects::Effect;
use haptical_effects::correction::{Curve, NAME, Over, coefficients_key};
use haptical_effects::device::settle;
use haptical_model::transmission::spline::Splines;
use haptical_model::{Device, DeviceEffect, Recording};
use serde::Serialize;

use crate::Result;
use crate::answer::{HeldOutAnswer, Located, Normal, Smooth, Unseen, Verdict, device_on_second};
use crate::engine::{Cause, Engine, Model, take_off_all};
use crate::judge::warms_with_time;
use crate::select::{Covariate, Selection};
use crate::thresholds::answer::PARTS;
use crate::thresholds::correction::{CHANCE_SD, COEFFICIENTS, LEAST_SHARE, NEARLY_AS_MUCH};

/// A curve that is added to a joint's angle in the place of a cause that is not known. It is no cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CorrectionAnswer {
    /// Joint (from 1).
    pub joint: usize,
    /// Column of the log that it is drawn over.
    pub over: String,
    /// Lower end of its range, in the column's unit.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// Number of its coefficients.
    pub coefficients: usize,
    /// Numbers that the data decide of them.
    pub effective: f64,
    /// Largest coefficient.
    pub largest: f64,
    /// Its unit.
    pub unit: String,
    /// Share of the squares beyond noise that rows lose that its fit did not see.
    pub closed_unseen_share: f64,
    /// What it gains there, in standard deviations of a gain by chance.
    pub gain_sd: f64,
    /// The gap of a second recording, without it and with it; none without a second recording.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on_second: Option<HeldOutAnswer>,
}

/// Why a curve is not written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Refusal {
    /// It is drawn over the time: a course of one recording is no property of a device.
    CourseOfTime,
    /// It does not predict the second recording better than the device without it.
    SecondRecording,
}

/// A curve that predicts unseen rows of its log, and is not written.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RefusedCorrection {
    /// Joint (from 1).
    pub joint: usize,
    /// Column of the log that it is drawn over.
    pub over: String,
    /// Share of the squares beyond noise that rows of the log lose that its fit did not see.
    pub closed_unseen_share: f64,
    /// Why it is not written.
    pub why: Refusal,
    /// The gap of the second recording, without it and with it, where that is why.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on_second: Option<HeldOutAnswer>,
}

pub(crate) struct Correction {
    pub(crate) answer: CorrectionAnswer,
    /// The device with it, geometry and drives fitted beside it.
    pub(crate) device: Device,
    /// What it leaves, per stream and row.
    pub(crate) residual: Vec<Vec<f64>>,
}

/// What became of the curve.
pub(crate) enum Outcome {
    Kept(Box<Correction>),
    Refused(RefusedCorrection),
}

impl Outcome {
    /// What was kept, and what was refused.
    pub(crate) fn apart(self) -> (Option<Correction>, Option<RefusedCorrection>) {
        match self {
            Self::Kept(kept) => (Some(*kept), None),
            Self::Refused(refused) => (None, Some(refused)),
        }
    }
}

/// The curve of the located joint over what the gap depends on, the joint's own angle first, that unseen rows confirm, and a second
/// recording where there is one; one over time is never kept. None where a cause is named, the gap is in no joint, or no curve predicts
/// unseen rows better than chance.
pub(crate) fn correction(
    selection: &Selection<'_>,
    verdict: Verdict,
    located: Option<&Located>,
    second: Option<&Recording>,
) -> Result<Option<Outcome>> {
    let Some(located) = located.filter(|_| verdict == Verdict::Unknown) else {
        return Ok(None);
    };
    let Some(joint) = located.answer.joint.map(|joint| joint - 1) else {
        return Ok(None);
    };
    let engine = selection.engine();
    if !engine.context.ordered {
        // single postures are too few, and their order is none of time
        return Ok(None);
    }
    let sure = |over: Over, covariate: Covariate| {
        let column = covariate.column(&engine.context);
        let is_located = located.answer.depends_on.contains(&column);
        let fitted = is_located.then(|| fitted(engine, joint, over, covariate));
        let fitted = fitted.flatten()?;
        let share = fitted.smooth.share();
        let is_sure = fitted.smooth.gain_sd() > CHANCE_SD && share > LEAST_SHARE;
        is_sure.then_some((fitted, share))
    };
    let mut best: Option<(Fitted, f64)> = None;
    for (over, covariate) in [
        (Over::Angle, Covariate::Angle(joint)),
        (Over::Torque, Covariate::Torque(joint)),
        (Over::Temperature, Covariate::Temperature),
    ] {
        let Some((fitted, share)) = sure(over, covariate) else {
            continue;
        };
        let is_more = |(_, most): &(Fitted, f64)| NEARLY_AS_MUCH * share > *most;
        if best.as_ref().is_none_or(is_more) {
            best = Some((fitted, share));
        }
    }
    // a temperature that rises with the time is the time, until another recording shows that it is not
    let is_time = |fitted: &Fitted| {
        fitted.over == Over::Temperature && second.is_none() && warms_with_time(&engine.context)
    };
    let of_device = match best {
        Some((fitted, _)) if !is_time(&fitted) => Some(fitted),
        _ => None,
    };
    let Some(fitted) = of_device else {
        let of_time = sure(Over::Time, Covariate::Time);
        let refused = of_time.map(|(fitted, share)| RefusedCorrection {
            joint: joint + 1,
            over: fitted.column,
            closed_unseen_share: share,
            why: Refusal::CourseOfTime,
            on_second: None,
        });
        return Ok(refused.map(Outcome::Refused));
    };
    let Some(found) = with_it(engine, joint, fitted)? else {
        return Ok(None);
    };
    match second {
        Some(second) => confirmed(found, engine, second, &located.answer.channel),
        None => Ok(Some(Outcome::Kept(Box::new(found)))),
    }
}

/// The curve, kept where it predicts a second recording better: in all channels together, and beyond chance in the one that the gap
/// is in (the one with most of a gap, where the second recording lacks that).
fn confirmed(
    mut found: Correction,
    engine: &Engine<'_>,
    second: &Recording,
    located: &str,
) -> Result<Option<Outcome>> {
    let channels = device_on_second(engine, second, &found.device)?;
    let gained: f64 = channels.iter().map(|own| own.gained() * own.left().1).sum();
    let is_located = |own: &&Unseen| own.channel.name() == located;
    let by_gap = |a: &&Unseen, b: &&Unseen| a.gap().total_cmp(&b.gap());
    let main = channels.iter().find(is_located);
    let main = main.or_else(|| channels.iter().max_by(by_gap));
    let is_better = gained > 0.0 && main.is_some_and(|own| own.gain_sd() > CHANCE_SD);
    let on_second = main.map(Unseen::answer);
    if !is_better {
        return Ok(Some(Outcome::Refused(RefusedCorrection {
            joint: found.answer.joint,
            over: found.answer.over,
            closed_unseen_share: found.answer.closed_unseen_share,
            why: Refusal::SecondRecording,
            on_second,
        })));
    }
    found.answer.on_second = on_second;
    Ok(Some(Outcome::Kept(Box::new(found))))
}

/// A curve with what unseen rows say of it.
struct Fitted {
    over: Over,
    column: String,
    range: [f64; 2],
    smooth: Smooth,
}

fn fitted(engine: &Engine<'_>, joint: usize, over: Over, covariate: Covariate) -> Option<Fitted> {
    let context = &engine.context;
    let values = covariate.values(context)?;
    // a temperature is counted from the recording's mean there, and from zero in a device file
    let zero = match over {
        Over::Temperature => context.reference_degc,
        _ => 0.0,
    };
    let places: Vec<f64> = values.into_iter().map(|value| value + zero).collect();
    let known = || places.iter().copied().filter(|place| place.is_finite());
    let range = [
        known().fold(f64::INFINITY, f64::min),
        known().fold(f64::NEG_INFINITY, f64::max),
    ];
    Splines::at(range[0], range[0], range[1], COEFFICIENTS)?;
    let smooth = normal(engine, joint, &places, range).smooth()?;
    Some(Fitted {
        over,
        column: covariate.column(context),
        range,
        smooth,
    })
}

/// The readings as products of columns, a spline each, with all that the base model could adjust taken out of both.
fn normal(engine: &Engine<'_>, joint: usize, places: &[f64], [from, to]: [f64; 2]) -> Normal {
    let (context, system) = (&engine.context, &engine.system);
    let mut splines = vec![vec![0.0; places.len()]; COEFFICIENTS];
    for (row, place) in places.iter().enumerate() {
        let Some(own) = Splines::at(*place, from, to, COEFFICIENTS) else {
            continue;
        };
        for (index, value) in own.values.iter().enumerate() {
            splines[own.first + index][row] = *value;
        }
    }
    let across = |spline: &Vec<f64>| {
        let mut dense = system.layout.dense(&context.upstream(joint, spline));
        take_off_all(&mut dense, || system.basis.iter());
        dense
    };
    let columns: Vec<Vec<f64>> = haptical_parallel::map(&splines, across);
    let mut normal = Normal::new(COEFFICIENTS);
    for stream in 0..context.streams.len() {
        for (block, place) in system.layout.range(stream).enumerate() {
            let row: Vec<f64> = columns.iter().map(|column| column[place]).collect();
            let part = system.layout.row(stream, block) * PARTS / context.rows().max(1);
            normal.add(part, &row, system.residual[place]);
        }
    }
    normal
}

/// The device with a curve, whose size is fitted together with geometry and drives; none where that fit finds no minimum.
fn with_it(engine: &Engine<'_>, joint: usize, fitted: Fitted) -> Result<Option<Correction>> {
    let Fitted {
        over,
        column,
        range,
        smooth,
    } = fitted;
    let mut coefficients = smooth.coefficients.clone();
    let curve = Curve {
        over,
        range,
        coefficients: coefficients.clone(),
    };
    let base = &engine.base.device;
    let effects: Vec<Box<dyn Effect>> = vec![curve.at(base, joint)];
    let model = Model {
        causes: vec![Cause {
            effect: 0,
            amplitudes: vec![1.0],
            shape: 0.0,
            times: Vec::new(),
        }],
        ..engine.start.model.clone()
    };
    let refit = engine.refit(&effects, &model)?;
    if !refit.has_converged() {
        return Ok(None);
    }
    let size = refit.model.causes[0].amplitudes[0];
    for coefficient in &mut coefficients {
        *coefficient *= size;
    }
    let mut device = engine.problem.device_with(&refit.model.values);
    settle(&mut device, engine.context.recording, &|_| None)?;
    let largest = coefficients
        .iter()
        .fold(0.0_f64, |most, own| most.max(own.abs()));
    let [from_key, to_key] = [0, 1].map(|end| over.spec(base, joint).parameters[end].name);
    device.effects.push(DeviceEffect {
        name: NAME.to_owned(),
        joint: Some(joint),
        numbers: [
            (from_key.to_owned(), range[0]),
            (to_key.to_owned(), range[1]),
        ]
        .into(),
        lists: [(coefficients_key(base, joint).to_owned(), coefficients)].into(),
        ..DeviceEffect::default()
    });
    Ok(Some(Correction {
        answer: CorrectionAnswer {
            joint: joint + 1,
            over: column,
            from: range[0],
            to: range[1],
            coefficients: smooth.coefficients.len(),
            effective: smooth.effective,
            largest,
            unit: base.joints[joint].unit().to_owned(),
            closed_unseen_share: smooth.share(),
            gain_sd: smooth.gain_sd(),
            on_second: None,
        },
        device,
        residual: engine.exact_residual(&effects, &refit.model),
    }))
}
