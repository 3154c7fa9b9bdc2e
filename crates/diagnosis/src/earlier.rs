//! A model identified earlier: which terms of the base model it lacks or has wrong (docs/diagnosis.md,
//! "Earlier model").

use std::collections::BTreeMap;

use haptical_model::{Device, ParameterId, TransmissionError, TransmissionKind};
use nalgebra::{DMatrix, DVector};

use crate::answer::ParameterAnswer;
use crate::engine::Engine;
use crate::system::{compress_rows, dot};

/// A base term that differs from the earlier model.
#[derive(Debug, Clone)]
pub(crate) struct BaseTerm {
    pub(crate) name: &'static str,
    pub(crate) joint: Option<usize>,
    /// Squared whitened residual that it explains.
    pub(crate) explained: f64,
    pub(crate) parameters: BTreeMap<String, ParameterAnswer>,
    /// It enters in front of the external encoder.
    pub(crate) in_drive: bool,
}

/// What a model differs in.
#[derive(Debug, Clone, Default)]
pub(crate) struct Difference {
    pub(crate) terms: Vec<BaseTerm>,
    /// Squared whitened residual of the earlier model beyond that of the refitted one.
    pub(crate) total: f64,
}

/// Share of the difference below which a term is not named.
const SHARE: f64 = 0.005;
/// The earlier model was fitted to noise too: its own errors double the squares.
const TWO_FITS: f64 = 2.0;
/// Squared standard deviations beyond which a group of one parameter is more than chance.
const BEYOND_CHANCE: f64 = 16.0;

/// Compares residuals of an earlier model with the base model refitted to the recording.
pub(crate) fn difference(engine: &Engine<'_>, earlier: &[Vec<f64>]) -> Difference {
    let free = engine.free();
    let count = free.columns();
    if count == 0 {
        return Difference::default();
    }
    let target = compress_rows(&engine.system.blocks, earlier);
    if target.iter().any(|value| !value.is_finite()) {
        return Difference::default();
    }
    let norms: Vec<f64> = (0..count)
        .map(|column| {
            dot(free.column(column), free.column(column))
                .sqrt()
                .max(1e-300)
        })
        .collect();
    let normal = DMatrix::from_fn(count, count, |a, b| {
        dot(free.column(a), free.column(b)) / (norms[a] * norms[b])
    });
    let right = DVector::from_fn(count, |index, _| {
        dot(free.column(index), &target) / norms[index]
    });
    let explained = |chosen: &[usize]| explained(&normal, &right, chosen);
    let all: Vec<usize> = (0..count).collect();
    let total = explained(&all);
    let groups = groups(engine);
    let links: Vec<usize> = groups
        .iter()
        .filter(|group| !group.in_drive)
        .flat_map(|group| group.columns.clone())
        .collect();
    // The lengths of a model without transmission errors have taken part of those up: with the
    // transmissions in question the links are free.
    let mut terms = forward(
        engine, &groups, true, &links, &explained, total, &normal, &norms,
    );
    if terms.is_empty() {
        terms = forward(
            engine,
            &groups,
            false,
            &[],
            &explained,
            total,
            &normal,
            &norms,
        );
    }
    // A ratio and an eccentricity resemble each other over a small range: whatever cannot be dropped
    // without loss differs too.
    let in_drive = terms.first().is_some_and(|term| term.in_drive);
    for group in groups.iter().filter(|group| group.in_drive && in_drive) {
        let named = |term: &BaseTerm| term.name == group.name && term.joint == group.joint;
        if terms.iter().any(named) {
            continue;
        }
        let others: Vec<usize> = (0..count).filter(|k| !group.columns.contains(k)).collect();
        let lost = total - explained(&others);
        if lost > chance(group.columns.len()) {
            terms.push(BaseTerm {
                name: group.name,
                joint: group.joint,
                explained: lost,
                parameters: parameters(engine, group, &normal, &norms),
                in_drive: true,
            });
        }
    }
    terms.sort_by(|a, b| b.explained.total_cmp(&a.explained));
    Difference { terms, total }
}

#[allow(
    clippy::too_many_arguments,
    reason = "one call site, all of one decomposition"
)]
fn forward(
    engine: &Engine<'_>,
    groups: &[Group],
    in_drive: bool,
    given: &[usize],
    explained: &dyn Fn(&[usize]) -> f64,
    total: f64,
    normal: &DMatrix<f64>,
    norms: &[f64],
) -> Vec<BaseTerm> {
    let mut chosen = given.to_vec();
    let mut have = explained(&chosen);
    let mut left: Vec<&Group> = groups
        .iter()
        .filter(|group| group.in_drive == in_drive)
        .collect();
    let mut terms = Vec::new();
    while !left.is_empty() {
        let gains: Vec<f64> = left
            .iter()
            .map(|group| {
                let with: Vec<usize> = chosen.iter().chain(&group.columns).copied().collect();
                explained(&with) - have
            })
            .collect();
        let Some(best) = (0..left.len()).max_by(|&a, &b| gains[a].total_cmp(&gains[b])) else {
            break;
        };
        if gains[best] < chance(left[best].columns.len()) || gains[best] < SHARE * total {
            break;
        }
        let group = left.remove(best);
        chosen.extend(&group.columns);
        have += gains[best];
        terms.push(BaseTerm {
            name: group.name,
            joint: group.joint,
            explained: gains[best],
            parameters: parameters(engine, group, normal, norms),
            in_drive,
        });
    }
    terms
}

/// Squared standard deviations that chance and the earlier model's own errors give a group.
fn chance(rank: usize) -> f64 {
    let rank = rank as f64;
    TWO_FITS * (rank + BEYOND_CHANCE * rank.sqrt())
}

/// Squared length of the target's part in the span of the chosen columns.
fn explained(normal: &DMatrix<f64>, right: &DVector<f64>, chosen: &[usize]) -> f64 {
    if chosen.is_empty() {
        return 0.0;
    }
    let part = DMatrix::from_fn(chosen.len(), chosen.len(), |a, b| {
        normal[(chosen[a], chosen[b])] + if a == b { 1e-11 } else { 0.0 }
    });
    let side = DVector::from_fn(chosen.len(), |a, _| right[chosen[a]]);
    match part.cholesky() {
        Some(factor) => side.dot(&factor.solve(&side)),
        None => 0.0,
    }
}

/// Parameters that belong to one name at one place.
#[derive(Debug)]
struct Group {
    name: &'static str,
    joint: Option<usize>,
    /// Among the free columns.
    columns: Vec<usize>,
    in_drive: bool,
}

fn groups(engine: &Engine<'_>) -> Vec<Group> {
    let device = engine.context.device;
    let mut groups: Vec<Group> = Vec::new();
    for (column, &position) in engine.base.free.iter().enumerate() {
        let (name, joint, in_drive) = match engine.base.parameters[position] {
            ParameterId::Link { row, .. } => ("link-geometry", row.checked_sub(1), false),
            ParameterId::Compliance { joint } => ("joint-compliance", Some(joint), false),
            // where a rig stands is no effect of the device
            ParameterId::Surrounding(_) => continue,
            ParameterId::Transmission { joint, index } => {
                (term_name(device, joint, index), Some(joint), true)
            }
        };
        match groups
            .iter_mut()
            .find(|group| group.name == name && group.joint == joint)
        {
            Some(group) => group.columns.push(column),
            None => groups.push(Group {
                name,
                joint,
                columns: vec![column],
                in_drive,
            }),
        }
    }
    groups
}

fn term_name(device: &Device, joint: usize, index: usize) -> &'static str {
    let is_capstan = matches!(
        device.joints[joint].transmission_error,
        TransmissionError::Capstan(_)
    );
    match (device.joints[joint].transmission, is_capstan, index) {
        (TransmissionKind::Parallelogram, _, _) => "parallelogram-error",
        (_, _, 0) => "joint-offset",
        (_, true, 1) => "ratio-error",
        (_, true, _) => "drum-eccentricity",
        (_, false, 1) => "ratio-error",
        (_, false, _) => "drum-eccentricity",
    }
}

/// The refitted values with intervals; of a polynomial its root mean square.
fn parameters(
    engine: &Engine<'_>,
    group: &Group,
    normal: &DMatrix<f64>,
    norms: &[f64],
) -> BTreeMap<String, ParameterAnswer> {
    let device = engine.context.device;
    let inverse = (normal + DMatrix::identity(norms.len(), norms.len()) * 1e-11).try_inverse();
    let mut answers = BTreeMap::new();
    for &column in &group.columns {
        let position = engine.base.free[column];
        let parameter = engine.base.parameters[position];
        let value = engine.start.model.values[position];
        let sd = inverse.as_ref().map_or(0.0, |inverse| {
            inverse[(column, column)].max(0.0).sqrt() / norms[column]
        });
        answers.insert(
            parameter.name(device),
            ParameterAnswer {
                value,
                ci95: [value - 1.96 * sd, value + 1.96 * sd],
            },
        );
    }
    answers
}
