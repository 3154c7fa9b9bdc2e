//! Payloads taken off before other effects are asked for, and how they are reported.

use std::collections::BTreeMap;

use haptical_effects::force::{PAYLOAD, PAYLOAD_ON_LINK};

use super::{Changes, Payload, UnseenBlocks, changes};
use crate::answer::{CauseAnswer, HeldOutAnswer, NoReduction, ParameterAnswer};
use crate::force::along::Along;
use crate::force::base::Base;
use crate::force::recorded::Recorded;
use crate::select::excess;
use crate::thresholds::torque::LISTED_PROBABILITY;

/// What the arm carries in some runs and not in others: off the readings from here on.
#[derive(Debug)]
pub(in crate::force) struct Carried {
    pub(in crate::force) changes: Changes,
    /// What the base model says of the block means, no payload taken off.
    pub(in crate::force) fitted_before: Vec<f64>,
    /// What it leaves of them; none where there is no payload.
    pub(in crate::force) rest_before: Option<Vec<f64>>,
    /// Structured energy of that.
    energy: f64,
    /// Torque of all payloads together; none where there is none.
    torque_nm: Option<Vec<f64>>,
}

impl Carried {
    /// Looks for payloads, unless their name is left out of the catalogue.
    pub(in crate::force) fn new(along: &Along<'_>, base: &Base, without: &[String]) -> Self {
        let rest = base.rest();
        let fitted_before = along.less(&rest);
        let changes = match without.iter().any(|name| name == PAYLOAD.name) {
            true => Changes::default(),
            false => changes(along, base),
        };
        let mut torque_nm: Option<Vec<f64>> = None;
        for payload in &changes.payloads {
            let sum = torque_nm.get_or_insert_with(|| vec![0.0; rest.len()]);
            let pairs = sum.iter_mut().zip(&payload.torque_nm);
            pairs.for_each(|(sum, torque)| *sum += torque);
        }
        Self {
            rest_before: torque_nm.is_some().then_some(rest),
            fitted_before,
            energy: excess(&base.energy(along.recorded.free_directions()))
                .0
                .max(0.0),
            torque_nm,
            changes,
        }
    }

    /// Torque of all payloads, block means channel after channel.
    pub(in crate::force) fn torque_nm(&self) -> Option<&[f64]> {
        self.torque_nm.as_deref()
    }

    /// Torques of a model with those of the payloads.
    pub(in crate::force) fn on(&self, fitted: &[f64]) -> Vec<f64> {
        let mut sum = fitted.to_vec();
        for (sum, torque) in sum.iter_mut().zip(self.torque_nm.iter().flatten()) {
            *sum += torque;
        }
        sum
    }

    /// Share of the gap that the payloads leave for other effects: `left` is its structured energy, `total` the squares that
    /// other effects are asked of.
    pub(in crate::force) fn rest_share(&self, left: f64, total: f64) -> f64 {
        if self.torque_nm.is_none() {
            return 1.0;
        }
        let closed = (self.energy - left.max(0.0)).max(0.0);
        total / (total + closed).max(1e-300)
    }

    /// Share of the squares beyond noise that the payloads close on unseen blocks: of the change that closes least.
    pub(in crate::force) fn closed_share(&self) -> Option<f64> {
        let shares = self
            .changes
            .payloads
            .iter()
            .map(|payload| payload.closed_share);
        shares.reduce(f64::min)
    }

    /// What the numbers of a payload rest on that the torques do not fix.
    pub(in crate::force) fn warnings(&self) -> Vec<String> {
        let told = |payload: &Payload| {
            let ([least, most], link) = (payload.size.lever_m?, payload.link? + 1);
            Some(format!(
                "payload from run {}: the torques fix its moment about link {link}, mass times distance, and not its mass; the \
                 interval of mass_kg is what the moment gives at distances of {least:.3} m to {most:.3} m",
                payload.run + 1
            ))
        };
        self.changes.payloads.iter().filter_map(told).collect()
    }

    /// The payloads as findings, largest first.
    pub(in crate::force) fn findings(
        &self,
        recorded: &Recorded<'_>,
        rest_share: f64,
    ) -> Vec<CauseAnswer> {
        let payloads = &self.changes.payloads;
        let square = |payload: &Payload| {
            payload
                .torque_nm
                .iter()
                .map(|torque| torque * torque)
                .sum::<f64>()
        };
        let all: f64 = payloads.iter().map(square).sum();
        let closed = 1.0 - rest_share;
        let mut found: Vec<CauseAnswer> = payloads
            .iter()
            .map(|payload| {
                let share = closed * square(payload) / all.max(1e-300);
                finding(recorded, payload, share)
            })
            .collect();
        found.sort_by(|a, b| b.share.total_cmp(&a.share));
        found
    }
}

fn finding(recorded: &Recorded<'_>, payload: &Payload, share: f64) -> CauseAnswer {
    let exact = |value: f64| ParameterAnswer {
        value,
        ci95: [value, value],
    };
    let mass = ParameterAnswer {
        value: payload.size.mass_kg,
        ci95: payload.size.ci95_kg,
    };
    let mut parameters = BTreeMap::new();
    let spec = match payload.link {
        Some(link) => {
            let on_link = ParameterAnswer {
                value: (link + 1) as f64,
                ci95: payload.links.map(|link| (link + 1) as f64),
            };
            parameters.insert("on_link".to_owned(), on_link);
            &PAYLOAD_ON_LINK
        }
        None => &PAYLOAD,
    };
    for parameter in spec.parameters {
        let value = match (parameter.name, payload.size.moment_kg_m) {
            ("mass_kg", _) => mass,
            ("moment_kg_m", Some((value, ci95))) => ParameterAnswer { value, ci95 },
            ("from_run", _) => exact((payload.run + 1) as f64),
            _ => continue,
        };
        parameters.insert(parameter.name.to_owned(), value);
    }
    CauseAnswer {
        parameters,
        share,
        held_out: Some(held_out(recorded, &payload.unseen)),
        ..CauseAnswer::named(spec.name, None, LISTED_PROBABILITY)
    }
}

/// The gap of the channel that gains most, on block means that the fit did not see, with an interval from its folds.
pub(in crate::force) fn held_out(recorded: &Recorded<'_>, unseen: &UnseenBlocks) -> HeldOutAnswer {
    let reduction = |left_out: Option<usize>| {
        let sum = |squares: &[f64]| {
            let kept = squares
                .iter()
                .enumerate()
                .filter(|(fold, _)| Some(*fold) != left_out);
            kept.map(|(_, square)| square).sum::<f64>()
        };
        let folds = unseen.before.len() as f64;
        let kept = match left_out {
            Some(_) => (folds - 1.0) / folds,
            None => 1.0,
        };
        let floor = unseen.floor * unseen.rows * kept;
        let before = sum(&unseen.before) - floor;
        let after = (sum(&unseen.after) - floor).max(0.0);
        (before > 0.0).then(|| 100.0 * (1.0 - (after / before).sqrt()))
    };
    let whole = reduction(None);
    let each: Vec<f64> = (0..unseen.before.len())
        .filter_map(|fold| reduction(Some(fold)))
        .collect();
    let count = each.len().max(2) as f64;
    let mean = each.iter().sum::<f64>() / count;
    let square: f64 = each.iter().map(|value| (value - mean).powi(2)).sum();
    let half = 1.96 * (square * (count - 1.0) / count).sqrt();
    let rms = |squares: &[f64]| (squares.iter().sum::<f64>() / unseen.rows.max(1.0)).sqrt();
    HeldOutAnswer {
        channel: format!("torque{}", recorded.channels[unseen.channel] + 1),
        rms_before: rms(&unseen.before),
        rms_after: rms(&unseen.after),
        noise_floor: unseen.floor.sqrt(),
        unit: recorded.unit(unseen.channel).to_owned(),
        reduction_percent: whole,
        reduction_ci95: whole.map(|whole| [whole - half, (whole + half).min(100.0)]),
        no_reduction: whole.is_none().then_some(NoReduction::WithinNoise),
    }
}
