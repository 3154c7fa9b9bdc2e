//! Whether the laws of a joint's cables hold on unseen rows of its encoder, and names that could be in their place.

use haptical_effects::{Family, Hook};
use haptical_judge::nearest;

use super::{Cable, Drive};
use crate::engine::{Cause, System, Unseen};
use crate::judge::listed;
use crate::select::partial::With;
use crate::select::{Covariate, Place, Rival, free_function};
use crate::thresholds::partial::{
    BEYOND_CHANCE_SD, COUPLING_KNOTS, FINE_KNOTS, FREE_KNOTS, LEAD_NATS,
};

impl Drive<'_> {
    /// Whether free functions of the angles and speeds that drive the causes, in their place, predict unseen rows no better,
    /// and what is left depends on none of the joint's covariates by more than the laws may get wrong.
    pub(super) fn laws_hold(&self, causes: &[Cause], with: With<'_>) -> bool {
        if !self.are_loops(causes) {
            return false;
        }
        let wrong = self.selector.wrong_by_law(causes, with.gain);
        let mut driving = vec![self.joint];
        for cause in causes {
            driving.extend(self.effect(cause.effect).other_joint());
        }
        driving.sort_unstable();
        driving.dedup();
        let of_driving = driving
            .iter()
            .flat_map(|&joint| [Covariate::Angle(joint), Covariate::Speed(joint)]);
        let own = of_driving.clone().map(|of| (of, FREE_KNOTS / 2));
        let free = self.with_free_functions(&self.base, own);
        if with.unseen.gain_on(&self.segments.unseen(&free)).sum < -wrong {
            return false;
        }
        let beside = [Covariate::MotorPhase(self.joint), Covariate::Time];
        let beside = beside.into_iter().map(|of| (of, FINE_KNOTS));
        let torque = [(Covariate::Torque(self.joint), FREE_KNOTS)];
        let mut all = of_driving
            .map(|of| (of, FREE_KNOTS))
            .chain(torque)
            .chain(beside);
        let readings = self.base.layout.range(self.stream).len();
        !all.any(|(of, knots)| {
            let beside = self.with_free_functions(with.system, [(of, knots)]);
            with.depends_on((of, &beside), readings, wrong, &self.segments)
        })
    }

    /// Whether every play of another joint's cable predicts unseen rows better than a function of that joint's angle in its
    /// place: a play wider than most of the motion is a coupling.
    fn are_loops(&self, causes: &[Cause]) -> bool {
        let all = self.segments.unseen(&self.with_causes(causes, None));
        causes.iter().enumerate().all(|(place, cause)| {
            let effect = self.effect(cause.effect);
            let is_loop = effect.spec().family == Family::Loop;
            let Some(from) = effect.other_joint().filter(|_| is_loop) else {
                return true;
            };
            let others = self.with_causes(causes, Some(place));
            let angle = [(Covariate::Angle(from), COUPLING_KNOTS)];
            let coupled = self.with_free_functions(&others, angle);
            all.gain_on(&self.segments.unseen(&coupled))
                .deviations_by_sign()
                >= BEYOND_CHANCE_SD
        })
    }

    /// The joint's system with the columns of all causes, but one.
    pub(super) fn with_causes(&self, causes: &[Cause], but: Option<usize>) -> System {
        let context = &self.selector.engine.context;
        let mut system = self.base.clone();
        for (place, cause) in causes.iter().enumerate() {
            if but != Some(place) {
                for signal in cause.derivative(self.selector.effects, context) {
                    system.take(self.masked(&signal));
                }
            }
        }
        system
    }

    fn with_free_functions(
        &self,
        system: &System,
        functions: impl IntoIterator<Item = (Covariate, usize)>,
    ) -> System {
        let context = &self.selector.engine.context;
        let mut with = system.clone();
        for (of, knots) in functions {
            let place = Place::at(Hook::ExternalEncoder, Some(self.joint));
            for signal in free_function(context, place, of, knots)
                .into_iter()
                .flatten()
            {
                with.take(self.masked(&signal));
            }
        }
        with
    }
}

impl Drive<'_> {
    /// Each effect with its own name, and what else of its kind could be in its place.
    pub(super) fn rivals(&self, chosen: &[Cable], all: &[Cable]) -> Vec<Vec<Rival>> {
        let whole = self.unseen_with(&chosen.iter().collect::<Vec<_>>());
        let of_place = |place: usize| -> Vec<Rival> {
            let cable = &chosen[place];
            let effect = self.effect(cable.effect);
            let is_other = |other: &&Cable| {
                other.is_instead_of(cable) && self.effect(other.effect).name() != effect.name()
            };
            let others = all.iter().filter(is_other).map(|other| {
                let mut members: Vec<&Cable> = chosen.iter().collect();
                members[place] = other;
                let lead = whole.gain_on(&self.unseen_with(&members)).deviations();
                let other = self.effect(other.effect);
                haptical_judge::Rival {
                    name: other.name(),
                    behind: LEAD_NATS * lead.max(0.0).powi(2),
                    fit: other,
                }
            });
            let others = nearest(others).into_iter();
            let others = others.map(|other| Rival::new(other.fit, 1.0, other.behind));
            listed(Rival::new(effect, 1.0, 0.0), others, 0.0)
        };
        (0..chosen.len()).map(of_place).collect()
    }

    fn unseen_with(&self, members: &[&Cable]) -> Unseen {
        let mut system = self.base.clone();
        for member in members {
            system.take(member.column.clone());
        }
        self.segments.unseen(&system)
    }
}
