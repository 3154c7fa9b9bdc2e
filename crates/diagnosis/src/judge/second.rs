//! What the base model and the causes leave of a second recording's positions, and what one fit of both leaves.

use haptical_calibration::Channel;
use haptical_model::Recording;

use crate::Result;
use crate::answer::{
    Left, SECOND_RECORDING, SecondAnswer, SecondChannel, Unseen, Verdict, channel_rms,
    not_predicted,
};
use crate::engine::{Base, Engine, Prepared};
use crate::judge::{Findings, torque_nm};
use crate::noise::without_readings;
use crate::thresholds::torque::BEYOND_WRONG_ANGLES;

/// What the second recording shows of positions and torques; none without one.
pub(crate) fn on_second(findings: &Findings<'_>, verdict: Verdict) -> Result<Option<SecondAnswer>> {
    let Some(second) = findings.inputs.options.validation else {
        return Ok(None);
    };
    let seen: &[Unseen] = match findings.shrink.description == SECOND_RECORDING {
        true => &findings.shrink.channels,
        false => &[],
    };
    let rest = &findings.selection.refit.residual;
    let of_log = |own: &Unseen| channel_rms(findings.engine(), own.channel, rest).0;
    let mut channels: Vec<SecondChannel> = seen
        .iter()
        .map(|own| own.on_second(of_log(own), None))
        .collect();
    // the base model of the log alone is no evidence where the log does not fix it
    if verdict == Verdict::NoGap && channels.iter().any(|own| own.has_gap) {
        let both = of_both(findings, second)?;
        let left = |own: &Unseen| both.iter().find(|(channel, _)| *channel == own.channel);
        channels = (seen.iter())
            .map(|own| own.on_second(of_log(own), left(own).map(|both| both.1)))
            .collect();
    }
    let is_seen = |channel: &Channel| seen.iter().any(|own| own.channel == *channel);
    let missing = findings.floors.iter().filter(|own| !is_seen(&own.channel));
    let missing = missing.map(|own| {
        format!(
            "{}: the second recording has too few readings, of this or of another sensor, for the model of the log",
            own.channel.name()
        )
    });
    let mut answer = SecondAnswer {
        channels,
        not_predicted: missing.collect(),
        is_gap_of_it_alone: false,
    };
    if let Some(torques) = &findings.force.second {
        let mut of_torques = match &findings.force.not_tested {
            Some(why) => SecondAnswer::not_predicted(not_predicted(why)),
            None => torques.second.clone(),
        };
        // as in the log, a torque that wrong angles cause is none of the device's
        let has_effects = !findings.inputs.recording.added.is_empty();
        if has_effects || verdict != Verdict::NoGap {
            let squares = of_torques
                .channels
                .iter()
                .map(SecondChannel::square_beyond_noise);
            let found_nm = squares.sum::<f64>().sqrt();
            if found_nm < BEYOND_WRONG_ANGLES * torque_nm(&findings.selection) {
                of_torques
                    .channels
                    .iter_mut()
                    .for_each(SecondChannel::quieten);
            }
        }
        answer.extend(of_torques);
    }
    Ok(Some(answer))
}

/// What one fit of the base model to both recordings leaves, in the first and in the second; nothing where there is no such fit.
fn of_both(findings: &Findings<'_>, second: &Recording) -> Result<Vec<(Channel, [Left; 2])>> {
    let inputs = &findings.inputs;
    let first = inputs.recording;
    let has_effects = !first.added.is_empty();
    let Some(both) = (!has_effects)
        .then(|| Recording::joined(&[first, second]).ok())
        .flatten()
    else {
        return Ok(Vec::new());
    };
    let options = inputs.options;
    let base = match Base::fit(inputs.nominal, &both, options.loss, &options.interrupt) {
        Ok(base) => base,
        Err(error) if error.is_unidentifiable() => return Ok(Vec::new()),
        Err(error) => return Err(error),
    };
    let prepared = Prepared::new(&base, &both, &both)?;
    let gone = prepared.outlying();
    let cleaned = without_readings(&both, &gone);
    let engine = prepared.without(&gone, &cleaned).fit(None)?;
    let left = |channel: Channel, noise: f64| {
        let rows = [0..first.len(), first.len()..both.len()];
        (
            channel,
            rows.map(|rows| left_in(&engine, channel, rows, noise)),
        )
    };
    let floors = findings.floors.iter();
    Ok(floors.map(|own| left(own.channel, own.ci95()[1])).collect())
}

/// What the base model leaves of a channel in some rows.
fn left_in(
    engine: &Engine<'_>,
    channel: Channel,
    rows: std::ops::Range<usize>,
    noise: f64,
) -> Left {
    let (mut squares, mut readings) = (0.0, 0.0);
    for stream in engine.context.streams_of(channel) {
        let residual = &engine.start.residual[stream];
        for row in rows.clone().filter(|row| engine.usable[stream][*row]) {
            squares += residual[row] * residual[row];
            readings += 1.0;
        }
    }
    Left {
        rms: f64::sqrt(squares / f64::max(readings, 1.0)),
        noise,
        readings,
        error_of_fit: 0.0,
    }
}
