//! Whether what changed between two groups of runs is a payload: it is, where one mass accounts for unseen blocks of several
//! joints, and no change of the drives does as well.

use super::blocks::Pair;
use super::columns::{Columns, Own, point_mass};
use super::folds::{Fitted, Folds};
use super::size::{Size, size};
use crate::force::along::Along;
use crate::force::base::Base;
use crate::force::posture::PER_LINK;
use crate::thresholds::payload::{
    FLANGE_REACH_M, LEAST_CHANNELS, LEAST_GAIN_OF_CHANNEL, LEAST_SIGNAL, LEAST_T_OF_CHANNEL,
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
    let with = |more: &[usize]| [common.as_slice(), more].concat();
    let null = folds.fit(&common);
    // the place of a mass at the flange is known to some centimetres of it: to find its size first
    let mass = columns.flange.start;
    let first = folds.fit(&with(&[mass])).number(mass).abs();
    for moment in columns.flange.clone().skip(1) {
        folds.knowing(moment, FLANGE_REACH_M * first.max(1e-6));
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
        let is_found = fitted.gain_over(&null, &every).is_beyond_chance();
        let is_better = best.as_ref().is_none_or(|(_, best)| {
            // a mass anywhere on a link must do much better than one whose place is known
            fitted.gain_over(best, &every).is_beyond_chance()
        });
        if is_found && is_better {
            best = Some((carrier, fitted));
        }
    }
    let (carrier, fitted) = best?;
    let shown = shown_on(&fitted, &null, &every);
    if shown.len() < LEAST_CHANNELS {
        return None;
    }
    let drives = columns.every(Own::all);
    let beside = folds.fit(&with(&drives));
    let both = folds.fit(&with(&[drives.as_slice(), &carrier.columns].concat()));
    if !both.gain_over(&beside, &every).is_beyond_chance() || !agree(&fitted, &both, &carrier) {
        return None;
    }
    let kinds: [fn(&Own) -> Vec<usize>; 3] = [
        |own| vec![own.offset],
        |own| own.friction.clone().collect(),
        |own| vec![own.gain],
    ];
    let mut rivals: Vec<Vec<usize>> = kinds.iter().map(|kind| columns.every(kind)).collect();
    rivals.extend(columns.own.iter().map(Own::all));
    let of_rivals = rivals
        .iter()
        .map(|rival| folds.fit(&with(rival)).left_on(&shown));
    let least = of_rivals.fold(beside.left_on(&shown), f64::min);
    if fitted.left_on(&shown) >= least {
        return None;
    }
    // what the drives changed by as well is allowed for where unseen blocks want it
    let sized = match both.gain_over(&fitted, &every).is_beyond_chance() {
        true => &both,
        false => &fitted,
    };
    let size = size(along, &columns, carrier.link, sized);
    let inertia = inertia_of(along, &columns, &carrier, sized);
    let torque_nm = torque_of(along, &inertia, pair.from);
    let count = recorded.blocks.len();
    let later = (count - pair.from).max(1) as f64;
    let is_large = every.iter().any(|&channel| {
        let own = &torque_nm[channel * count..(channel + 1) * count];
        let square = own.iter().map(|torque| torque * torque).sum::<f64>() / later;
        square > LEAST_SIGNAL * recorded.torque_sd[channel].powi(2)
    });
    if !is_large || !size.is_certain() {
        return None;
    }
    let squares = |left: &Fitted, channel: usize| -> Vec<f64> {
        left.left
            .iter()
            .map(|left| left[channel] / folds.weight[channel])
            .collect()
    };
    let gain_of = |channel: usize| fitted.gain_over(&null, &[channel]).sum;
    let channel = shown
        .iter()
        .copied()
        .max_by(|a, b| gain_of(*a).total_cmp(&gain_of(*b)))?;
    let beyond = |left: &Fitted| {
        let noise = every
            .iter()
            .map(|&channel| folds.weight[channel] * noise[channel] * folds.rows(channel));
        (left.left_on(&every) - noise.sum::<f64>()).max(0.0)
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

/// Channels on which a hypothesis gains beyond chance.
fn shown_on(fitted: &Fitted, null: &Fitted, every: &[usize]) -> Vec<usize> {
    let is_shown = |channel: &usize| {
        let gain = fitted.gain_over(null, &[*channel]);
        gain.sum >= LEAST_GAIN_OF_CHANNEL && gain.t >= LEAST_T_OF_CHANNEL
    };
    every.iter().copied().filter(is_shown).collect()
}

/// Whether a carrier's numbers point the same way beside changes of the drives.
fn agree(alone: &Fitted, beside: &Fitted, carrier: &Carrier) -> bool {
    if carrier.link.is_none() {
        let mass = carrier.columns[0];
        let (alone, beside) = (alone.number(mass), beside.number(mass));
        return alone * beside > 0.0 && (0.5..2.0).contains(&(beside / alone));
    }
    let of = |fitted: &Fitted| -> Vec<f64> {
        carrier
            .columns
            .iter()
            .map(|&column| fitted.number(column))
            .collect()
    };
    let (alone, beside) = (of(alone), of(beside));
    let dot: f64 = alone.iter().zip(&beside).map(|(a, b)| a * b).sum();
    dot > 0.0
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
    let mass_kg = fitted.number(carrier.columns[0]);
    let numbers = point_mass(&along.flange_m());
    for (own, number) in inertia[first..].iter_mut().zip(numbers) {
        *own = mass_kg * number;
    }
    for (axis, &column) in carrier.columns[1..].iter().enumerate() {
        inertia[first + 1 + axis] += fitted.number(column);
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
