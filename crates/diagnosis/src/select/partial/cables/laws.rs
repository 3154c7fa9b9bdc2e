//! Whether the laws of a joint's cables hold on unseen rows of its encoder.

use haptical_effects::Family;

use crate::engine::model::Cause;
use crate::engine::segments::Unseen;
use crate::engine::system::{System, dot};
use crate::select::generic::{Covariate, hats};
use crate::select::partial::cables::Drive;
use crate::thresholds::partial::{
    BEYOND_CHANCE_SD, COUPLING_KNOTS, FINE_KNOTS, FREE_KNOTS, SURELY_BESIDE_SD,
};

impl Drive<'_> {
    /// Whether free functions of the angles and speeds that drive the causes, in their place, predict unseen rows no better,
    /// and what is left depends on none of the joint's covariates by more than the laws may get wrong.
    pub(super) fn laws_hold(
        &self,
        causes: &[Cause],
        system: &System,
        unseen: &Unseen,
        gain: f64,
    ) -> bool {
        if !self.are_loops(causes) {
            return false;
        }
        let wrong = self.selector.wrong_by_law(causes, gain);
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
        if unseen.gain_on(&self.segments.unseen(&free)).sum < -wrong {
            return false;
        }
        let beside = [Covariate::MotorPhase(self.joint), Covariate::Time];
        let beside = beside.into_iter().map(|of| (of, FINE_KNOTS));
        let torque = [(Covariate::Torque(self.joint), FREE_KNOTS)];
        let mut all = of_driving
            .map(|of| (of, FREE_KNOTS))
            .chain(torque)
            .chain(beside);
        !all.any(|(of, knots)| self.depends_on(of, knots, system, unseen, wrong))
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
    fn with_causes(&self, causes: &[Cause], but: Option<usize>) -> System {
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

    /// Whether the rest depends on a covariate by more than `wrong`, and more surely than by chance.
    fn depends_on(
        &self,
        of: Covariate,
        knots: usize,
        system: &System,
        unseen: &Unseen,
        wrong: f64,
    ) -> bool {
        let beside = self.with_free_functions(system, [(of, knots)]);
        let rest = dot(&system.residual, &system.residual);
        let freedom = (beside.basis.len() - system.basis.len()) as f64;
        let readings = self.base.layout.range(self.stream).len() as f64;
        let misfit = (rest / readings).max(1.0);
        let explained = rest - dot(&beside.residual, &beside.residual) - misfit * freedom;
        // a segment that is left out takes its part of a function of time with it
        if of == Covariate::Time || explained <= wrong {
            return explained > wrong;
        }
        let more = self.segments.unseen(&beside).gain_on(unseen);
        more.sum > wrong && more.deviations() > SURELY_BESIDE_SD
    }

    fn with_free_functions(
        &self,
        system: &System,
        functions: impl IntoIterator<Item = (Covariate, usize)>,
    ) -> System {
        let context = &self.selector.engine.context;
        let mut with = system.clone();
        for (of, knots) in functions {
            let values = of.values(context);
            let Some(hats) = values.and_then(|values| hats(&values, knots)) else {
                continue;
            };
            for hat in hats {
                with.take(self.masked(&context.encoder(self.joint, &hat)));
            }
        }
        with
    }
}
