//! Whether what changed between two groups of runs is a payload: it is, where one mass accounts for unseen blocks of several
//! joints, and no change of the drives does as well.

use nalgebra::DVector;

use super::blocks::Pair;
use super::columns::{Columns, Own, flange};
use super::folds::{Fitted, Folds};
use super::gain::{is_beyond_chance, is_steady};
use super::hypothesis::{Carrier, Hypothesis, KINDS};
use super::size::{Size, size};
use crate::force::along::{Along, numbers};
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
    /// What it adds to the torques of all blocks, channel after channel.
    pub(in crate::force) torque_nm: Vec<f64>,
    /// On blocks that the fit did not see, the channel that gains most.
    pub(in crate::force) unseen: UnseenBlocks,
    /// Share of the squares beyond noise, all channels together, that it closes on those blocks.
    pub(in crate::force) closed_share: f64,
}

/// Squares of a channel on unseen blocks, fold by fold: the numbers of rows, without and with the payload.
#[derive(Debug, Clone)]
pub(in crate::force) struct UnseenBlocks {
    pub(in crate::force) channel: usize,
    pub(in crate::force) rows: f64,
    pub(in crate::force) before: Vec<f64>,
    pub(in crate::force) after: Vec<f64>,
    /// Mean square of a block by noise alone.
    pub(in crate::force) floor: f64,
}

/// The payload that changed between two groups of runs, the later one beginning with `run`; none where none did.
pub(super) fn payload(along: &Along<'_>, base: &Base, pair: &Pair, run: usize) -> Option<Payload> {
    let recorded = along.recorded;
    let every: Vec<usize> = (0..recorded.channels.len()).collect();
    // of a repeated trajectory the noise of both runs counts
    let sides = if pair.twin.is_some() { 2.0 } else { 1.0 };
    let noise: Vec<f64> = every
        .iter()
        .map(|&channel| sides * recorded.block_variance(channel))
        .collect();
    let columns = Columns::new(along, base, pair);
    let mut folds = Folds::new(&columns, pair, &noise);
    let Hypothesis {
        carrier,
        fitted,
        null,
        links,
    } = Hypothesis::found(along, &columns, &mut folds, &every)?;
    let shown = shown_on(&fitted, &null, &every);
    if shown.len() < LEAST_CHANNELS {
        return None;
    }
    let common: Vec<usize> = columns.common.clone().collect();
    let with = |more: &[usize]| folds.fit(&[common.as_slice(), more].concat());
    let drives = columns.every(Own::all);
    let beside = with(&drives);
    let both = with(&[drives.as_slice(), &carrier.all()].concat());
    let is_more = is_beyond_chance(both.gain_over(&beside, &every));
    if !is_more || !agree(&folds, &carrier, &beside.columns, [&fitted, &both]) {
        return None;
    }
    let least = least_of_drives(&columns, &with, &shown).min(beside.left_on(&shown));
    if fitted.left_on(&shown) >= least {
        return None;
    }
    let inertia = inertia_of(along, &columns, &carrier, &fitted);
    let size = size(along, &columns, &folds, carrier.link, &fitted);
    let torque_nm = torque_of(along, &inertia, pair.from);
    if !is_large(along, &torque_nm, pair.from) || !size.is_certain() {
        return None;
    }
    let squares = |left: &Fitted, channel: usize| -> Vec<f64> {
        let folds = left
            .left
            .iter()
            .map(|left| left[channel] / folds.weight[channel]);
        folds.collect()
    };
    let gain_of = |channel: usize| fitted.gain_over(&null, &[channel]).sum;
    let channels = shown.iter().copied();
    let channel = channels.max_by(|a, b| gain_of(*a).total_cmp(&gain_of(*b)))?;
    Some(Payload {
        run,
        link: carrier.link,
        links,
        inertia,
        torque_nm,
        unseen: UnseenBlocks {
            channel,
            rows: folds.rows(channel),
            before: squares(&null, channel),
            after: squares(&fitted, channel),
            floor: noise[channel],
        },
        closed_share: fitted.closed_of(&null, &every, folds.noise(&every, &noise)),
        size,
    })
}

/// What changes of one drive, or of one kind on all drives, leave at least of some channels.
fn least_of_drives(columns: &Columns, with: &dyn Fn(&[usize]) -> Fitted, shown: &[usize]) -> f64 {
    let of_kinds = KINDS.iter().map(|kind| columns.every(kind));
    let of_drives = columns.own.iter().map(Own::all);
    let left = of_kinds
        .chain(of_drives)
        .map(|rival| with(&rival).left_on(shown));
    left.fold(f64::INFINITY, f64::min)
}

/// Whether a torque is visible in some channel from a block on.
fn is_large(along: &Along<'_>, torque_nm: &[f64], from: usize) -> bool {
    let recorded = along.recorded;
    let count = recorded.blocks.len();
    let later = (count - from).max(1) as f64;
    let channels = torque_nm.chunks_exact(count).zip(&recorded.torque_sd);
    let mut sizes = channels.map(|(own, sd)| {
        let square = own.iter().map(|torque| torque * torque).sum::<f64>() / later;
        square > LEAST_SIGNAL * sd * sd
    });
    sizes.any(|is_large| is_large)
}

/// Channels on which a hypothesis gains beyond chance.
fn shown_on(fitted: &Fitted, null: &Fitted, every: &[usize]) -> Vec<usize> {
    let is_shown = |channel: &usize| {
        let gain = fitted.gain_over(null, &[*channel]);
        gain.sum >= LEAST_GAIN_OF_CHANNEL && is_steady(gain, LEAST_T_OF_CHANNEL)
    };
    every.iter().copied().filter(is_shown).collect()
}

/// Whether two fits of a carrier, without and with changes of all drives, give about the same torques: of the part that no
/// change of a drive can take (Hausman 1978).
fn agree(folds: &Folds, carrier: &Carrier, drives: &[usize], fits: [&Fitted; 2]) -> bool {
    let apart = folds.apart(&carrier.columns, drives);
    let [alone, beside] = fits.map(|fitted| {
        let numbers = carrier.columns.iter().map(|&column| fitted.number(column));
        DVector::from_iterator(carrier.columns.len(), numbers)
    });
    let dot = |a: &DVector<f64>, b: &DVector<f64>| a.dot(&(&apart * b));
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
    let joints = along.recorded.context.device.joints.len();
    let mut inertia = vec![0.0; numbers(joints)];
    if let Some(link) = carrier.link {
        for &(column, number) in &columns.links[link] {
            inertia[PER_LINK * link + number] = fitted.number(column);
        }
        return inertia;
    }
    let first = PER_LINK * (joints - 1);
    for (numbers, &column) in flange(&along.flange_m()).iter().zip(&carrier.columns) {
        for (own, number) in inertia[first..first + PER_LINK].iter_mut().zip(numbers) {
            *own += fitted.number(column) * number;
        }
    }
    inertia
}

/// Torque of such a change, from a block on.
fn torque_of(along: &Along<'_>, inertia: &[f64], from: usize) -> Vec<f64> {
    let mut torque_nm = along.link_torques(inertia);
    for own in torque_nm.chunks_exact_mut(along.recorded.blocks.len()) {
        own[..from].fill(0.0);
    }
    torque_nm
}
