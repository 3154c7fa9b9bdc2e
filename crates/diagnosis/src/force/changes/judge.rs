//! Whether what changed between two groups of runs is a payload: it is, where one mass accounts for unseen blocks of several
//! joints, and no change of the drives does as well.

use haptical_effects::force::{PAYLOAD, PAYLOAD_ON_LINK};
use haptical_motion::Unseen;

use super::columns::{Columns, Pair, Place};
use super::folds::{Fitted, Folds};
use super::gain::{is_beyond_chance, is_steady};
use super::hypothesis::Hypothesis;
use super::size::{Size, size};
use crate::answer::{CauseAnswer, HeldOutAnswer, ParameterAnswer, held_out};
use crate::force::Means;
use crate::force::along::Along;
use crate::force::base::Base;
use crate::force::posture::PER_LINK;
use crate::thresholds::payload::{
    ALIKE, LEAST_CHANNELS, LEAST_GAIN_OF_CHANNEL, LEAST_SIGNAL, LEAST_T_OF_CHANNEL, SIZE_BESIDE,
};
use crate::thresholds::torque::LISTED_PROBABILITY;

/// A payload that differs from a run on.
#[derive(Debug, Clone)]
pub(in crate::force) struct Payload {
    /// First run with it, from 0.
    pub(in crate::force) run: usize,
    pub(in crate::force) cause: CauseAnswer,
    /// What its numbers depend on that the torques do not fix.
    pub(in crate::force) warning: Option<String>,
    /// What it changes of the links' inertial numbers.
    pub(in crate::force) inertia: Vec<f64>,
    /// What it adds to the torques of all blocks.
    pub(in crate::force) torque_nm: Means,
    /// Share of the squares beyond noise, all channels together, that it closes on blocks that the fit did not see.
    pub(in crate::force) closed_share: f64,
}

/// The payload that changed between two groups of runs, the later one beginning with `run`; none where none did.
pub(super) fn payload(along: &Along<'_>, base: &Base, pair: &Pair, run: usize) -> Option<Payload> {
    let recorded = &along.recorded;
    // of a repeated trajectory the noise of both runs counts
    let sides = if pair.twin.is_some() { 2.0 } else { 1.0 };
    let noise = recorded.block_variances().into_iter();
    let noise: Vec<f64> = noise.map(|variance| sides * variance).collect();
    let columns = Columns::new(along, base, pair);
    let mut folds = Folds::new(&columns, pair, &noise);
    let found = Hypothesis::found(along, &columns, &mut folds)?;
    let (place, fitted, null) = (&found.place, &found.fitted, &found.null);
    // channels on which it gains beyond chance
    let is_shown = |channel: &usize| {
        let gain = fitted.gain_over(null, Some(*channel));
        gain.sum >= LEAST_GAIN_OF_CHANNEL && is_steady(gain, LEAST_T_OF_CHANNEL)
    };
    let shown: Vec<usize> = (0..noise.len()).filter(is_shown).collect();
    if shown.len() < LEAST_CHANNELS {
        return None;
    }
    let common: Vec<usize> = columns.common.clone().collect();
    let with = |more: &[usize]| folds.fit(&[common.as_slice(), more].concat());
    let drives = columns.drives.concat().concat();
    let of_drives = with(&drives);
    let both = with(&[drives.as_slice(), &place.all()].concat());
    let is_more = is_beyond_chance(both.gain_over(&of_drives, None));
    if !is_more || !agree(&folds, place, &of_drives.columns, [fitted, &both]) {
        return None;
    }
    // a change of one drive, or of one kind on all drives, may leave as little of these channels
    let of_kinds = (0..3).map(|kind| columns.every(kind));
    let mut rivals = of_kinds.chain(columns.drives.iter().map(|kinds| kinds.concat()));
    let left = fitted.left_on(&shown);
    if left >= of_drives.left_on(&shown) || rivals.any(|rival| left >= with(&rival).left_on(&shown))
    {
        return None;
    }
    let mut numbers = [0.0; PER_LINK];
    for &(column, number) in &place.numbers {
        numbers[number] = fitted.number(column);
    }
    let inertia = along.carrying(place.link, numbers);
    let size = size(along, &columns, &folds, place, fitted);
    let mut torque_nm = along.link_torques(&inertia);
    torque_nm.rows_mut(0, pair.from).fill(0.0);
    if !is_large(along, &torque_nm, pair.from) || !size.is_certain() {
        return None;
    }
    let gain_of = |channel: usize| fitted.gain_over(null, Some(channel)).sum;
    let shown = shown.into_iter();
    let channel = shown.max_by(|a, b| gain_of(*a).total_cmp(&gain_of(*b)))?;
    let mut unseen = Unseen::new(recorded.channels[channel], noise[channel].sqrt());
    folds.unseen(channel, [null, fitted], &mut unseen);
    let unseen = held_out(recorded.named(channel), &unseen, &unseen.after);
    Some(Payload {
        run,
        cause: cause(
            &size,
            run,
            place.link.map(|link| (link, found.links)),
            unseen,
        ),
        warning: size.warning(run, place.link),
        inertia,
        torque_nm,
        closed_share: folds.closed([null, fitted], &noise),
    })
}

/// A payload as a cause. `link` is the link that carries it, with the first and the last link that could as well.
fn cause(
    size: &Size,
    run: usize,
    link: Option<(usize, [usize; 2])>,
    unseen: HeldOutAnswer,
) -> CauseAnswer {
    let number = |value: f64, ci95: [f64; 2]| Some(ParameterAnswer { value, ci95 });
    let from_one = |place: usize| (place + 1) as f64;
    let value = |name: &str| match name {
        "mass_kg" => number(size.mass_kg, size.ci95_kg),
        "moment_kg_m" => size
            .moment_kg_m
            .and_then(|(value, ci95)| number(value, ci95)),
        "on_link" => number(from_one(link?.0), link?.1.map(from_one)),
        "from_run" => number(from_one(run), [from_one(run); 2]),
        _ => None,
    };
    let spec = match link {
        Some(_) => &PAYLOAD_ON_LINK,
        None => &PAYLOAD,
    };
    let parameters = spec.parameters.iter();
    let parameters = parameters
        .filter_map(|parameter| Some((parameter.name.to_owned(), value(parameter.name)?)));
    CauseAnswer {
        parameters: parameters.collect(),
        held_out: Some(unseen),
        ..CauseAnswer::named(spec.name, None, LISTED_PROBABILITY)
    }
}

/// Whether a torque is visible in some channel from a block on.
fn is_large(along: &Along<'_>, torque_nm: &Means, from: usize) -> bool {
    let later = (torque_nm.nrows() - from).max(1) as f64;
    let mut channels = torque_nm.column_iter().zip(&along.recorded.noise);
    channels.any(|(column, noise)| column.norm_squared() / later > LEAST_SIGNAL * noise.sd.powi(2))
}

/// Whether two fits of a mass at a place, without and with changes of all drives, give about the same torques. Only
/// the part counts that no change of a drive can explain (Hausman 1978).
fn agree(folds: &Folds, place: &Place, drives: &[usize], fits: [&Fitted; 2]) -> bool {
    let columns = place.columns();
    let apart = folds.apart(&columns, drives);
    let numbers = |fitted: &Fitted| -> Vec<f64> {
        let numbers = columns.iter().map(|&column| fitted.number(column));
        numbers.collect()
    };
    let [alone, with_drives] = fits.map(numbers);
    let dot = |a: &[f64], b: &[f64]| -> f64 {
        let along = |(index, a): (usize, &f64)| a * haptical_linalg::dot(apart.column(index), b);
        a.iter().enumerate().map(along).sum()
    };
    let size = dot(&alone, &alone).max(0.0).sqrt();
    let other = dot(&with_drives, &with_drives).max(0.0).sqrt();
    let [least, most] = SIZE_BESIDE;
    dot(&alone, &with_drives) > ALIKE * size * other && (least..most).contains(&(other / size))
}
