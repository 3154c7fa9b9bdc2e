//! What admits a verdict on positions, encoders and touches.

use haptical_calibration::{Channel, apart, implausible_deviations};
use haptical_judge::{Admission, Check};
use haptical_model::Recording;

use crate::answer::{ChannelGap, Gap, Verdict, channel_rms};
use crate::engine::Engine;
use crate::judge::Findings;
use crate::noise::{NoiseSource, is_stated};
use crate::thresholds::admission::{
    LEAST_SPREAD, MOST_APART, MOST_LEFT, MOST_MISSED, MOST_MISSED_BY_ENCODER, READINGS_PER_NUMBER,
};

/// The four questions, of a verdict that they may admit.
pub(crate) fn of_positions(findings: &Findings<'_>, verdict: Verdict, gap: &Gap) -> Admission {
    Admission {
        belongs: belongs(findings),
        credible_base: credible_base(findings),
        known_noise: known_noise(findings, verdict, gap),
        enough: enough(findings.engine()),
    }
}

/// Whether the model, causes included, follows what was measured.
fn belongs(findings: &Findings<'_>) -> Check {
    let engine = findings.engine();
    let rest = &findings.selection.refit.residual;
    let missed = findings.floors.iter().filter_map(|floor| {
        let spread = spread(engine.context.recording, floor.channel)?;
        let left = channel_rms(engine, floor.channel, rest).0;
        Some((floor.channel, left / spread, left, spread))
    });
    let most = |channel: Channel| match channel {
        Channel::Output { .. } => MOST_MISSED_BY_ENCODER,
        _ => MOST_MISSED,
    };
    let worst = missed.max_by(|a, b| (a.1 / most(a.0)).total_cmp(&(b.1 / most(b.0))));
    let Some((channel, share, left, spread)) = worst else {
        return Check::unknown("no channel moves enough to say how much of it the model follows");
    };
    let unit = channel.unit(engine.context.device);
    let left = match left < 0.01 {
        true => format!("{left:.2e}"),
        false => format!("{left:.3}"),
    };
    let missed = format!("the model misses {} by {left} {unit}", channel.name());
    let figure = match channel {
        Channel::Orientation => missed,
        _ => format!(
            "{missed}, {:.2} % of what it varies by ({spread:.3} {unit})",
            100.0 * share
        ),
    };
    match share > most(channel) {
        true => Check::no(
            format!("log and device do not belong together: {figure}"),
            format!(
                "check that the log is of this device, that its columns are those of these joints in this order and these units, and \
                 that rows are as they were measured{}",
                resting(engine.context.recording)
            ),
        ),
        false => Check::yes(figure),
    }
}

/// A hint at joints that have one value throughout.
fn resting(recording: &Recording) -> String {
    let is_one = |column: &&(usize, &Vec<f64>)| {
        let mut values = column.1.iter();
        let first = values.next();
        values.all(|value| Some(value) == first)
    };
    let columns: Vec<(usize, &Vec<f64>)> = recording.joint.iter().enumerate().collect();
    let names = columns.iter().filter(is_one);
    let names: Vec<String> = names.map(|entry| format!("theta{}", entry.0 + 1)).collect();
    match names.is_empty() {
        true => String::new(),
        false => format!("; {} has one value throughout", names.join(", ")),
    }
}

/// Root mean square of what a channel's readings vary by, per axis \[rad\] or \[m\]; turns by a radian. None where they vary by so little that
/// noise or a wrong zero is a large part of it, and of touches, of which a reading is a difference.
fn spread(recording: &Recording, channel: Channel) -> Option<f64> {
    let of = |columns: &[&Vec<f64>]| {
        let squares: f64 = columns.iter().map(|column| variance(column)).sum();
        (squares / columns.len() as f64).sqrt()
    };
    let spread = match channel {
        Channel::Position => of(&recording.position_m.as_ref()?.each_ref()),
        Channel::Orientation => 1.0 / f64::sqrt(3.0),
        Channel::Cable { index } => of(&[recording.cable_m.get(index)?.as_ref()?]),
        Channel::Output { joint } => of(&[recording.output.get(joint)?.as_ref()?]),
        _ => return None,
    };
    (spread > LEAST_SPREAD).then_some(spread)
}

fn variance(column: &[f64]) -> f64 {
    let read: Vec<f64> = column
        .iter()
        .copied()
        .filter(|value| value.is_finite())
        .collect();
    let count = read.len().max(1) as f64;
    let mean = read.iter().sum::<f64>() / count;
    read.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count
}

/// Whether the base model, next to the causes, has numbers that a device can have.
fn credible_base(findings: &Findings<'_>) -> Check {
    if findings.inputs.earlier.is_some() {
        return Check::yes("what changed since an earlier model is named, whatever its size");
    }
    let engine = findings.engine();
    let fitted = engine
        .problem
        .device_with(&findings.selection.refit.model.values);
    let (parameters, free) = (&engine.base.parameters, &engine.base.free);
    let odd = implausible_deviations(findings.inputs.nominal, &fitted, parameters, free);
    match odd {
        None => Check::yes(format!(
            "none of {} fitted numbers is further from the device file than devices are",
            free.len()
        )),
        Some(odd) => {
            let why = odd.split(';').next().unwrap_or(&odd);
            let nominal = findings.inputs.nominal;
            // one chain has many descriptions: a fit may end at one that is far from the file's and predicts the same
            match apart(nominal, &fitted, findings.inputs.recording) {
                Some(apart) if apart > MOST_APART => Check::no(
                    format!("the base model needs {why}"),
                    "check units, signs and order of the columns, and that the device file describes this device",
                ),
                Some(apart) => Check::yes(format!(
                    "the fit is another description of the device file's chain, {:.2} % of its motion apart: {why}",
                    100.0 * apart
                )),
                None => Check::unknown(format!("the base model has {why}")),
            }
        }
    }
}

/// Whether something else than what the model leaves says how large the noise is. Without it the size of a gap is not known, so that there
/// may be one; a cause may have a name, as what it explains is compared with what it leaves.
fn known_noise(findings: &Findings<'_>, verdict: Verdict, gap: &Gap) -> Check {
    let device = findings.engine().context.device;
    let unit = |channel: Channel| channel.unit(device);
    let unknown = findings
        .floors
        .iter()
        .find(|floor| floor.source == NoiseSource::Rest && !is_stated(device, floor.channel));
    match unknown {
        None => {
            let said = findings.floors.iter().map(|floor| {
                let (rms, unit) = (floor.rms, unit(floor.channel));
                format!(
                    "{} {rms:.3e} {unit} by {}",
                    floor.channel.name(),
                    floor.source.words()
                )
            });
            Check::yes(said.collect::<Vec<_>>().join(", "))
        }
        Some(floor) => {
            let why = format!(
                "nothing but what the model leaves says how large the noise of {} is ({:.3e} {})",
                floor.channel.name(),
                floor.rms,
                unit(floor.channel)
            );
            let next = "state the noise in the device file or the rig, or repeat some postures, each from one side";
            match verdict {
                Verdict::Named | Verdict::Ambiguous if !gap.channels.iter().any(is_closed) => {
                    Check::no(
                        format!("{why}, and the causes close too little for that"),
                        next,
                    )
                }
                Verdict::Named | Verdict::Ambiguous | Verdict::Unknown => Check::unknown(why),
                Verdict::NoGap => Check::no(why, next),
            }
        }
    }
}

/// Whether causes close a part of a channel's gap beyond chance, or half of it where its noise is not known.
fn is_closed(channel: &ChannelGap) -> bool {
    let is_beyond_chance = channel.reduction_ci95.is_some_and(|ci95| ci95[0] > 0.0);
    is_beyond_chance || channel.rms_after <= MOST_LEFT * channel.rms_before
}

/// Whether there are readings enough for the numbers that are fitted.
fn enough(engine: &Engine<'_>) -> Check {
    let readings: usize = (engine.usable.iter().flatten())
        .filter(|usable| **usable)
        .count();
    let numbers = engine.base.free.len().max(1);
    let figure = format!("{readings} readings for {numbers} fitted numbers");
    match readings as f64 >= READINGS_PER_NUMBER * numbers as f64 {
        true => Check::yes(figure),
        false => Check::no(
            format!(
                "{figure}, of which {:.0} are needed",
                READINGS_PER_NUMBER * numbers as f64
            ),
            "record at more postures",
        ),
    }
}
