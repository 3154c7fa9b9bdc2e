//! Whether what changed between two groups of runs is a payload: it is, where one mass accounts for unseen blocks of several
//! joints, and no change of the drives does as well.

use super::blocks::Pair;
use super::columns::{Columns, Own, flange};
use super::folds::{Fitted, Folds};
use super::size::{Size, size};
use crate::force::along::Along;
use crate::force::base::Base;
use crate::force::posture::PER_LINK;
use crate::thresholds::payload::{
    ALIKE, FLANGE_REACH_M, LEAST_CHANNELS, LEAST_GAIN_OF_CHANNEL, LEAST_SIGNAL, LEAST_T_OF_CHANNEL,
    SIZE_BESIDE,
};

/// A payload that differs from a run on.
#[derive(Debug, Clone)]
pub(in crate::force) struct Payload {
    /// First run with it, from 0.
    pub(in crate::force) run: usize,
    /// Link that carries it, from 0; none at the flange.
    pub(in crate::force) link: Option<usize>,
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

/// A hypothesis: its columns beside the common ones, and the link that it puts a mass on.
struct Carrier {
    link: Option<usize>,
    columns: Vec<usize>,
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
    let common: Vec<usize> = columns.common.clone().collect();
    let null = folds.fit(&common);
    let (carrier, fitted) = carrier(&columns, &mut folds, &null, &every)?;
    let shown = shown_on(&fitted, &null, &every);
    if shown.len() < LEAST_CHANNELS {
        return None;
    }
    let with = |more: &[usize]| folds.fit(&[common.as_slice(), more].concat());
    let drives = columns.every(Own::all);
    let beside = with(&drives);
    let both = with(&[drives.as_slice(), &carrier.columns].concat());
    let inertia = [&fitted, &both].map(|fit| inertia_of(along, &columns, &carrier, fit));
    let is_more = both.gain_over(&beside, &every).is_beyond_chance();
    if !is_more || !agree(along, [&inertia[0], &inertia[1]]) {
        return None;
    }
    let least = least_of_drives(&columns, &with, &shown).min(beside.left_on(&shown));
    if fitted.left_on(&shown) >= least {
        return None;
    }
    // changes of the drives beside it would take a part of it: a gain resembles weight, an offset its mean
    let [inertia, _] = inertia;
    let size = size(along, &columns, carrier.link, &fitted);
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
    let beyond = |left: &Fitted| {
        let of = |&channel: &usize| folds.weight[channel] * noise[channel] * folds.rows(channel);
        (left.left_on(&every) - every.iter().map(of).sum::<f64>()).max(0.0)
    };
    Some(Payload {
        run,
        link: carrier.link,
        inertia,
        torque_nm,
        unseen: UnseenBlocks {
            channel,
            rows: folds.rows(channel),
            before: squares(&null, channel),
            after: squares(&fitted, channel),
            floor: noise[channel],
        },
        closed_share: (1.0 - beyond(&fitted) / beyond(&null).max(1e-300)).clamp(0.0, 1.0),
        size,
    })
}

/// The place of a mass that does best on unseen blocks: the flange, unless a link does much better.
fn carrier(
    columns: &Columns,
    folds: &mut Folds,
    null: &Fitted,
    every: &[usize],
) -> Option<(Carrier, Fitted)> {
    let common: Vec<usize> = columns.common.clone().collect();
    let with = |more: &[usize]| [common.as_slice(), more].concat();
    // the place of a mass at the flange is known to some centimetres of it: to find its size first
    let mass = columns.flange.start;
    let first = folds.fit(&with(&[mass])).number(mass).abs();
    for (number, column) in columns.flange.clone().enumerate().skip(1) {
        let reach = if number < 4 { 1 } else { 2 };
        folds.knowing(column, FLANGE_REACH_M.powi(reach) * first.max(1e-6));
    }
    let flange = Carrier {
        link: None,
        columns: columns.flange.clone().collect(),
    };
    let links = (1..columns.links.len()).map(|link| Carrier {
        link: Some(link),
        columns: columns.links[link]
            .iter()
            .map(|(column, _)| *column)
            .collect(),
    });
    let mut best: Option<(Carrier, Fitted)> = None;
    for carrier in std::iter::once(flange).chain(links) {
        let fitted = folds.fit(&with(&carrier.columns));
        let is_found = fitted.gain_over(null, every).is_beyond_chance();
        let is_better = best
            .as_ref()
            .is_none_or(|(_, best)| fitted.gain_over(best, every).is_beyond_chance());
        if is_found && is_better {
            best = Some((carrier, fitted));
        }
    }
    best
}

/// What changes of one drive, or of one kind on all drives, leave at least of some channels.
fn least_of_drives(columns: &Columns, with: &dyn Fn(&[usize]) -> Fitted, shown: &[usize]) -> f64 {
    let kinds: [fn(&Own) -> Vec<usize>; 3] = [
        |own| vec![own.offset],
        |own| own.friction.clone().collect(),
        |own| vec![own.gain],
    ];
    let of_kinds = kinds.iter().map(|kind| columns.every(kind));
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
        gain.sum >= LEAST_GAIN_OF_CHANNEL && gain.t >= LEAST_T_OF_CHANNEL
    };
    every.iter().copied().filter(is_shown).collect()
}

/// Whether two fits of a carrier give about the same torques, each channel over its noise.
fn agree(along: &Along<'_>, fits: [&[f64]; 2]) -> bool {
    let recorded = along.recorded;
    let count = recorded.blocks.len();
    let [alone, beside] = fits.map(|inertia| {
        let torque_nm = along.link_torques(inertia);
        let channels = torque_nm.chunks_exact(count).zip(&recorded.torque_sd);
        let scaled = channels.flat_map(|(own, sd)| own.iter().map(move |torque| torque / sd));
        scaled.collect::<Vec<f64>>()
    });
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (own, other) = (dot(&alone, &alone).sqrt(), dot(&beside, &beside).sqrt());
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
    let mut inertia = vec![0.0; PER_LINK * along.recorded.context.device.joints.len()];
    if let Some(link) = carrier.link {
        for &(column, number) in &columns.links[link] {
            inertia[PER_LINK * link + number] = fitted.number(column);
        }
        return inertia;
    }
    let first = inertia.len() - PER_LINK;
    for (numbers, &column) in flange(&along.flange_m()).iter().zip(&carrier.columns) {
        for (own, number) in inertia[first..].iter_mut().zip(numbers) {
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
