//! Payloads taken up before other effects are asked for, and how they are reported.

use std::collections::BTreeMap;

use haptical_effects::force::{PAYLOAD, PAYLOAD_ON_LINK};

use super::base::Base;
use super::changes::{Changes, Payload, UnseenBlocks, changes};
use super::effects::Effects;
use super::recorded::Recorded;
use crate::answer::{CauseAnswer, HeldOutAnswer, NoReduction, ParameterAnswer};
use crate::select::excess;
use crate::thresholds::torque::LISTED_PROBABILITY;

/// What the arm carries in some runs and not in others, in the base model from here on.
#[derive(Debug)]
pub(super) struct Carried {
    pub(super) changes: Changes,
    /// What the base model says of the block means, no payload taken up.
    pub(super) fitted_before: Vec<f64>,
    /// What it leaves of them; none where no payload was taken up.
    pub(super) rest_before: Option<Vec<f64>>,
    /// Structured energy without the payloads, and with them.
    energy: [f64; 2],
}

impl Carried {
    /// Looks for payloads and puts them into the base model, one column each.
    pub(super) fn taken(effects: &Effects<'_, '_>, base: &mut Base) -> Self {
        let along = effects.along;
        let rest = base.rest();
        let fitted_before = along.less(&rest);
        let mut changes = match effects.is_left_out(PAYLOAD.name) {
            true => Changes::default(),
            false => changes(along, base),
        };
        let before = excess(&effects.energy(base)).0.max(0.0);
        for payload in &changes.payloads {
            let column = base.regression.system.layout.of_means(&payload.torque_nm);
            base.adopt(&[column]);
        }
        let after = excess(&effects.energy(base)).0.max(0.0);
        // what leaves no less in the whole model is none
        if after >= before {
            changes.payloads.clear();
        }
        Self {
            rest_before: (!changes.payloads.is_empty()).then_some(rest),
            fitted_before,
            energy: [before, after],
            changes,
        }
    }

    /// Share of the gap that is left for other effects, `total` being their squares.
    pub(super) fn rest_share(&self, total: f64) -> f64 {
        if self.changes.payloads.is_empty() {
            return 1.0;
        }
        let [before, after] = self.energy;
        let closed = (before - after).max(0.0);
        total / (total + closed).max(1e-300)
    }

    /// Share of the squares beyond noise that the payloads close on unseen blocks: of the change that closes least.
    pub(super) fn closed_share(&self) -> Option<f64> {
        let shares = self
            .changes
            .payloads
            .iter()
            .map(|payload| payload.closed_share);
        shares.reduce(f64::min)
    }

    /// The payloads as findings, largest first.
    pub(super) fn findings(&self, effects: &Effects<'_, '_>, total: f64) -> Vec<CauseAnswer> {
        let payloads = &self.changes.payloads;
        let square = |payload: &Payload| {
            payload
                .torque_nm
                .iter()
                .map(|torque| torque * torque)
                .sum::<f64>()
        };
        let all: f64 = payloads.iter().map(square).sum();
        let closed = 1.0 - self.rest_share(total);
        let mut found: Vec<CauseAnswer> = payloads
            .iter()
            .map(|payload| {
                let share = closed * square(payload) / all.max(1e-300);
                finding(effects, payload, share)
            })
            .collect();
        found.sort_by(|a, b| b.share.total_cmp(&a.share));
        found
    }
}

fn finding(effects: &Effects<'_, '_>, payload: &Payload, share: f64) -> CauseAnswer {
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
            parameters.insert("on_link".to_owned(), exact((link + 1) as f64));
            &PAYLOAD_ON_LINK
        }
        None => &PAYLOAD,
    };
    for parameter in spec.parameters {
        let value = match (parameter.name, payload.size.moment_kg_m) {
            ("mass_kg", _) => mass,
            ("moment_kg_m", Some((moment, sd))) => ParameterAnswer::normal(moment, sd),
            ("from_run", _) => exact((payload.run + 1) as f64),
            _ => continue,
        };
        parameters.insert(parameter.name.to_owned(), value);
    }
    CauseAnswer {
        parameters,
        share,
        held_out: Some(held_out(effects.along.recorded, &payload.unseen)),
        ..CauseAnswer::named(spec.name, None, LISTED_PROBABILITY)
    }
}

/// The gap of the channel that gains most, on block means that the fit did not see, with an interval from its folds.
pub(super) fn held_out(recorded: &Recorded<'_>, unseen: &UnseenBlocks) -> HeldOutAnswer {
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
