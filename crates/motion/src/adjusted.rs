//! What the base model adjusts before anything is judged: friction and rotors of the drives, and how far the description was off without.

use haptical_dynamics::Inertia;
use haptical_linalg::dot;

use crate::arm::{Arm, PARAMETERS};
use crate::change::Change;
use crate::fit::base::{Base, BaseColumn, Term};
use crate::fit::problem::Problem;
use crate::select::Fitted;
use crate::thresholds::fit::SHARES_OF_DEVIATION;

/// A number of a drive that was fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adjusted {
    /// Joint, from 0.
    pub joint: usize,
    /// Its name, with its unit: `coulomb_nm`, `viscous_nm_s_per_rad`, `armature_kgm2`.
    pub number: &'static str,
    /// What it is beyond `of_file` times the file's.
    pub more: f64,
    /// Standard deviation of that, what the fit leaves allowed for.
    pub sd: f64,
    /// Share of the file's that was kept.
    pub of_file: f64,
    /// Variance of that share, and its covariance with `more`.
    pub of_share: [f64; 2],
}

impl Adjusted {
    /// The number and its standard deviation, where the file says `before`.
    pub fn beside(&self, before: f64) -> (f64, f64) {
        let [share, both] = self.of_share;
        let variance = self.sd.powi(2) + 2.0 * before * both + before.powi(2) * share;
        (self.of_file * before + self.more, variance.max(0.0).sqrt())
    }
}

/// Friction and armature of each joint as they were fitted.
pub(crate) fn adjusted(base: &Base, fitted: &Fitted) -> Vec<Adjusted> {
    let solution = &fitted.solved.solution;
    let mut found = Vec::new();
    let mut columns = Vec::new();
    let mut shares = Vec::new();
    for (index, entry) in base.columns.iter().enumerate() {
        let (joint, number) = match entry.term {
            Term::Coulomb { joint } => (joint, "coulomb_nm"),
            Term::Viscous { joint } => (joint, "viscous_nm_s_per_rad"),
            Term::Armature { joint } => (joint, "armature_kgm2"),
            _ => continue,
        };
        let is_own = |other: &BaseColumn| {
            let of_joint =
                matches!(other.term, Term::FileFriction { joint: of, .. } if of == joint);
            of_joint && number != "armature_kgm2"
        };
        let share = base.columns.iter().rposition(is_own);
        columns.push(index);
        shares.push(share);
        found.push(Adjusted {
            joint,
            number,
            more: solution[index],
            sd: 0.0,
            of_file: share.map_or(1.0, |share| solution[share]),
            of_share: [0.0; 2],
        });
    }
    let rest = &fitted.solved.rest;
    let misfit = (dot(rest, rest) / rest.len().max(1) as f64).max(1.0);
    let of_numbers = columns.len();
    columns.extend(shares.iter().flatten());
    let covariance = fitted.solved.covariance(&columns);
    let mut place = of_numbers..;
    for (at, (entry, share)) in found.iter_mut().zip(shares).enumerate() {
        entry.sd = (covariance[(at, at)] * misfit).max(0.0).sqrt();
        if let Some(share) = share.and_then(|_| place.next()) {
            entry.of_share = [(share, share), (at, share)].map(|pair| covariance[pair] * misfit);
        }
    }
    found
}

/// Bodies as they were fitted, within what is plausible. A body that a fit makes unphysical keeps the share of its deviation that it can
/// have; one whose numbers a device file does not give keeps those that are taken for it.
pub(crate) fn bodies(arm: &Arm, base: &Base, fitted: &Fitted) -> Vec<Change> {
    let mut more = vec![[0.0; PARAMETERS]; arm.body_count()];
    for (entry, share) in base.columns.iter().zip(&fitted.solved.solution) {
        if let Term::Body(deviation) = &entry.term {
            let into = more[deviation.body].iter_mut();
            into.zip(deviation.parameters)
                .for_each(|(into, value)| *into += share * value);
        }
    }
    let masses = arm.bodies.masses().iter().zip(more).enumerate();
    let stated = masses.filter(|(_, (of, _))| of.has_mass && of.has_centre && of.has_inertia);
    let change = stated.filter_map(|(body, (of, more))| {
        let scaled = |share: f64| {
            let more = Inertia::from_parameters(more.map(|value| share * value));
            let mut whole = of.inertia;
            whole += more;
            whole
                .is_physical()
                .then_some(Change::Inertia { body, more })
        };
        SHARES_OF_DEVIATION.into_iter().find_map(scaled)
    });
    change.collect()
}

/// Root mean square of what the description leaves of each joint's torque as it is, nothing adjusted; joint by joint, in the torque's unit.
pub(crate) fn as_described(problem: &Problem, base: &Base) -> Vec<(usize, f64)> {
    let mut left = problem.recorded(0.0);
    for entry in &base.columns {
        if matches!(entry.term, Term::FileFriction { .. }) {
            entry.column.add_to(&mut left, -1.0);
        }
    }
    let rows = problem.states.rows();
    let channels = problem.channels.iter().zip(left.chunks(rows));
    let rms = |(joint, left): (&usize, &[f64]), sd: &f64| {
        (*joint, sd * (dot(left, left) / rows as f64).sqrt())
    };
    let all = channels.zip(&problem.row_sd);
    all.map(|(channel, sd)| rms(channel, sd)).collect()
}
