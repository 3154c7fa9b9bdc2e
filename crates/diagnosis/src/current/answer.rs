//! What is said of joints' currents, as one diagnosis.

use haptical_calibration::Channel;
use haptical_judge::{Closed, Evidence, Rival, closed_share, probability};
use haptical_linalg::jackknife_sd;
use haptical_model::{Device, Recording};

use super::choose::{Chosen, Fitted, choose};
use super::rows::Rows;
use crate::Options;
use crate::answer::{
    CauseAnswer, ChannelGap, Diagnosis, Floor, Gap, ParameterAnswer, Place, Provenance, Trace,
    Verdict, reduction_percent,
};
use crate::noise::NoiseSource;
use crate::thresholds::chance::CONFUSABLE_NATS;
use crate::thresholds::current::{CHANCE, FOLLOWS, LAW_ERROR, LEAST_CLOSED, LEAST_GAP, STUDENT};
use crate::thresholds::servo::SURE_CLASS;

/// A joint's rows with what they show.
pub(super) struct Joint {
    index: usize,
    rows: Rows,
    chosen: Chosen,
    closed: Closed,
    verdict: Verdict,
    /// Squares before over those of noise; none without a gap.
    energy: f64,
}

impl Joint {
    /// Judges a joint.
    pub(super) fn new(index: usize, rows: Rows) -> Self {
        let chosen = choose(&rows);
        let (before, after) = (&chosen.before.unseen, &chosen.fitted.unseen);
        let count = rows.torque_nm.len() as f64;
        let closed = closed_share(before, after, count);
        let torque = rows.all.target_square() / rows.noise_nm.powi(2);
        let chance = CHANCE * count.sqrt();
        let excess = |unseen: &[f64]| unseen.iter().sum::<f64>() - count;
        let is_closed = closed.share >= LEAST_CLOSED || excess(after) <= chance;
        let first = chosen.rivals.first();
        let verdict = haptical_judge::verdict(Evidence {
            has_gap: first.is_some() || excess(before) > chance.max(LEAST_GAP * torque),
            is_supported: rows.follows >= FOLLOWS && is_closed && closed.ci95[0] > 0.0,
            probability: first.map(|rivals| of_name(rivals)),
        });
        Self {
            energy: match verdict {
                Verdict::NoGap => 0.0,
                _ => before.iter().sum::<f64>() / count,
            },
            index,
            closed,
            verdict,
            chosen,
            rows,
        }
    }

    fn channel(&self) -> String {
        format!("current{}", self.index + 1)
    }

    /// The model without laws, and the one that is answered.
    fn models(&self) -> [&Fitted; 2] {
        let before = &self.chosen.before;
        match self.verdict.has_causes() {
            true => [before, &self.chosen.fitted],
            false => [before; 2],
        }
    }

    fn gap(&self) -> ChannelGap {
        let count = self.rows.torque_nm.len() as f64;
        let channel = Channel::Output { joint: self.index };
        let floor = Floor::new(channel, self.rows.noise_nm, count, NoiseSource::Motion);
        let rms = self.models().map(|own| {
            let square = own.unseen.iter().sum::<f64>() / count;
            square.sqrt() * self.rows.noise_nm
        });
        let gap = ChannelGap::fitted(self.channel(), Some(self.index), rms, &floor, "N m");
        let gap = ChannelGap {
            held_out: true,
            rms_fit: None,
            reduction_ci95: (self.verdict.has_causes())
                .then(|| self.closed.ci95.map(reduction_percent)),
            ..gap
        };
        match self.verdict {
            Verdict::NoGap => gap.without_gap(),
            _ => gap,
        }
    }

    /// Its causes, where it has the `weight` of all joints' gap.
    fn causes(&self, weight: f64) -> Vec<CauseAnswer> {
        let Chosen {
            fitted,
            worth,
            rivals,
            ..
        } = &self.chosen;
        let all: f64 = worth.iter().sum();
        let numbers = |own: &[f64]| self.rows.numbers(&fitted.taken, own);
        let folds: Vec<_> = fitted.folds.iter().map(|own| numbers(own)).collect();
        let laws = numbers(&fitted.coefficients).into_iter().enumerate();
        let causes = laws.map(|(law, values)| {
            let term = &self.rows.terms[fitted.taken[law]];
            let near = rivals[law]
                .iter()
                .filter(|own| own.behind <= CONFUSABLE_NATS);
            let number = |(at, value): (usize, f64)| {
                let sd = STUDENT * jackknife_sd(folds.iter().map(|fold| fold[law][at]));
                let answer = ParameterAnswer::normal(value, sd).off_by_a_factor(LAW_ERROR);
                (term.numbers[at].0.to_owned(), answer)
            };
            CauseAnswer {
                class_probability: SURE_CLASS,
                confusable_with: near.map(|own| own.name.to_owned()).collect(),
                parameters: values.into_iter().enumerate().map(number).collect(),
                share: weight * self.closed.share * worth[law] / all,
                held_out: Some(self.gap().as_held_out()),
                ..CauseAnswer::named(term.effect, Some(self.index), of_name(&rivals[law]))
            }
        });
        let mut causes: Vec<CauseAnswer> = causes.collect();
        causes.sort_by(|a, b| b.share.total_cmp(&a.share));
        causes
    }

    fn trace(&self) -> Trace {
        let left = |own: &Fitted| self.rows.residual(&own.taken, &own.coefficients);
        let rest = self.models().map(left);
        Trace::over_time(self.channel(), "N m", &self.rows.time_s, rest)
    }

    fn warning(&self) -> Option<String> {
        let (joint, share) = (self.index + 1, 100.0 * self.rows.follows);
        if self.rows.follows < FOLLOWS {
            return Some(format!(
                "joint {joint}: its torque does not follow its current, which explains {share:.0} % of it; check the column"
            ));
        }
        let constant = self.chosen.before.coefficients[0];
        (constant < 0.0).then(|| {
            format!(
                "joint {joint}: its torque is against its current ({constant:.3} N m/A): turn the sign of `current{joint}_a` or of \
                 `torque{joint}_nm`, whichever is wrong"
            )
        })
    }
}

/// Probability of a name among its rivals.
fn of_name(rivals: &[Rival<&'static str, ()>]) -> f64 {
    SURE_CLASS * probability(rivals.iter().map(|own| own.behind))
}

/// Puts the joints together; `untested`: why nothing is said of others.
pub(super) fn answer(
    (device, recording, options): (&Device, &Recording, &Options<'_>),
    mut joints: Vec<Joint>,
    untested: Vec<String>,
) -> Diagnosis {
    joints.sort_by(|a, b| b.energy.total_cmp(&a.energy));
    let total: f64 = joints.iter().map(|own| own.energy).sum();
    let weight = |own: &Joint| own.energy / total.max(f64::MIN_POSITIVE);
    let mut named = joints.iter().filter(|own| own.verdict.has_causes());
    let causes: Vec<CauseAnswer> = (named.clone())
        .flat_map(|own| own.causes(weight(own)))
        .collect();
    let first = named.next().or(joints.first());
    let verdict = first.map_or(Verdict::NoGap, |own| own.verdict);
    let located = first.filter(|_| verdict != Verdict::NoGap);
    let name = located.map(Joint::channel);
    let gaps = joints.iter().map(|own| ChannelGap {
        share_of_gap: weight(own),
        ..own.gap()
    });
    let closed: f64 = causes.iter().map(|own| own.share).sum();
    let second = (options.validation)
        .map(|_| "the currents of the second recording were not compared".to_owned());
    let warnings = joints.iter().filter_map(Joint::warning).chain(second);
    let tested = joints.iter().map(|own| own.rows.terms.len()).sum();
    let provenance = Provenance::new(recording.len(), joints.len(), tested, options);
    let model = options.model.unwrap_or(device).clone();
    let gap = Gap::new(verdict, name.as_deref(), gaps.collect());
    let not_held = |own: &CauseAnswer| {
        format!(
            "{} at {}: a device file has no currents",
            own.effect,
            own.place()
        )
    };
    let with_gap = joints.iter().filter(|own| own.verdict != Verdict::NoGap);
    Diagnosis {
        place: located.map(|own| {
            let number = own.index + 1;
            let region = format!("torque of joint {number} against its current");
            let share = causes.first().map_or(0.0, |_| own.closed.share);
            let on = [(format!("current{number}_a"), share)];
            Place::new(own.channel(), Some(own.index), region, on)
        }),
        unexplained_share: located.map_or(0.0, |_| 1.0 - closed),
        closed_unseen_share: (verdict.has_causes() && closed < LEAST_CLOSED).then_some(closed),
        not_in_file: causes.iter().map(not_held).collect(),
        warnings: warnings.chain(untested).collect(),
        held_out: "a twelfth of the log in turn".to_owned(),
        traces: with_gap.map(Joint::trace).collect(),
        ..Diagnosis::of_causes(verdict, gap, causes, model, provenance)
    }
}
