//! Whether what changed between two groups of runs is a payload: it is, where one mass accounts for unseen blocks of several
//! joints, and no change of the drives does as well.

use haptical_motion::Unseen;

use super::blocks::Pair;
use super::columns::{Columns, Own, flange};
use super::folds::{Fitted, Folds};
use super::gain::{is_beyond_chance, is_steady};
use super::hypothesis::{Carrier, Hypothesis, KINDS};
use super::size::{Size, size};
use crate::answer::HeldOutAnswer;
use crate::answer::gap::held_out;
use crate::force::Means;
use crate::force::along::Along;
use crate::force::base::Base;
use crate::force::posture::PER_LINK;
use crate::thresholds::payload::{
    ALIKE, LEAST_CHANNELS, LEAST_GAIN_OF_CHANNEL, LEAST_SIGNAL, LEAST_T_OF_CHANNEL, SIZE_BESIDE,
};

/// A payload that differs from a run on.
#[derive(Debug, Clone)]
pub(in crate::force) struct Payload {
    /// First run with it, from 0.
    pub(in crate::force) run: usize,
    /// Link that carries it, from 0; none at the flange.
    pub(in crate::force) link: Option<usize>,
    /// First and last link that could as well carry it, from 0.
    pub(in crate::force) links: [usize; 2],
    pub(in crate::force) size: Size,
    /// What it changes of the links' inertial numbers.
    pub(in crate::force) inertia: Vec<f64>,
    /// What it adds to the torques of all blocks.
    pub(in crate::force) torque_nm: Means,
    /// On blocks that the fit did not see, the channel that gains most.
    pub(in crate::force) unseen: HeldOutAnswer,
    /// Share of the squares beyond noise, all channels together, that it closes on those blocks.
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
    let (carrier, fitted, null) = (&found.carrier, &found.fitted, &found.null);
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
    let drives = columns.every(Own::all);
    let beside = with(&drives);
    let both = with(&[drives.as_slice(), &carrier.all()].concat());
    let is_more = is_beyond_chance(both.gain_over(&beside, None));
    if !is_more || !agree(&folds, carrier, &beside.columns, [fitted, &both]) {
        return None;
    }
    // changes of one drive, or of one kind on all drives, that leave as little of these channels
    let of_kinds = KINDS.iter().map(|kind| columns.every(kind));
    let mut rivals = of_kinds.chain(columns.own.iter().map(Own::all));
    let left = fitted.left_on(&shown);
    if left >= beside.left_on(&shown) || rivals.any(|own| left >= with(&own).left_on(&shown)) {
        return None;
    }
    let inertia = inertia_of(along, &columns, carrier, fitted);
    let size = size(along, &columns, &folds, carrier.link, fitted);
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
    Some(Payload {
        run,
        link: carrier.link,
        links: found.links,
        inertia,
        torque_nm,
        unseen: held_out(recorded.named(channel), &unseen, &unseen.after),
        closed_share: folds.closed([null, fitted], &noise),
        size,
    })
}

/// Whether a torque is visible in some channel from a block on.
fn is_large(along: &Along<'_>, torque_nm: &Means, from: usize) -> bool {
    let later = (torque_nm.nrows() - from).max(1) as f64;
    let mut channels = torque_nm.column_iter().zip(&along.recorded.noise);
    channels.any(|(own, noise)| own.norm_squared() / later > LEAST_SIGNAL * noise.sd.powi(2))
}

/// Whether two fits of a carrier, without and with changes of all drives, give about the same torques: of the part that no
/// change of a drive can take (Hausman 1978).
fn agree(folds: &Folds, carrier: &Carrier, drives: &[usize], fits: [&Fitted; 2]) -> bool {
    let apart = folds.apart(&carrier.columns, drives);
    let numbers = |fitted: &Fitted| -> Vec<f64> {
        let columns = carrier.columns.iter();
        columns.map(|&column| fitted.number(column)).collect()
    };
    let [alone, beside] = fits.map(numbers);
    let dot = |a: &[f64], b: &[f64]| -> f64 {
        let along = |(index, a): (usize, &f64)| a * haptical_linalg::dot(apart.column(index), b);
        a.iter().enumerate().map(along).sum()
    };
    let own = dot(&alone, &alone).max(0.0).sqrt();
    let other = dot(&beside, &beside).max(0.0).sqrt();
    let [least, most] = SIZE_BESIDE;
    dot(&alone, &beside) > ALIKE * own * other && (least..most).contains(&(other / own))
}

/// What the carrier's numbers change of the links' inertial numbers.
fn inertia_of(
    along: &Along<'_>,
    columns: &Columns,
    carrier: &Carrier,
    fitted: &Fitted,
) -> Vec<f64> {
    let mut inertia = vec![0.0; along.inertia.len()];
    match carrier.link {
        Some(link) => {
            for &(column, number) in &columns.links[link] {
                inertia[PER_LINK * link + number] = fitted.number(column);
            }
        }
        None => {
            for (numbers, &column) in flange(along).iter().zip(&carrier.columns) {
                let numbers = inertia.iter_mut().zip(numbers);
                numbers.for_each(|(own, number)| *own += fitted.number(column) * number);
            }
        }
    }
    inertia
}
