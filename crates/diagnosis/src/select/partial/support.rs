//! Whether unseen rows support a hypothesis: its laws against free functions of their covariates, and its place against
//! others.

use haptical_effects::{Effect, Family, Hook};

use super::{Taken, With};
use crate::engine::{Cause, Segments, System, dot};
use crate::select::{Covariate, Place, Selector, free_function, own_covariates, varying_gain};
use crate::thresholds::partial::{
    BEYOND_CHANCE_SD, ELSEWHERE_SHARE, FINE_KNOTS, FREE_KNOTS, GAIN_KNOTS, KEPT_SHARE,
    SURELY_BESIDE_SD,
};

impl Selector<'_> {
    /// Whether causes predict unseen rows as well as free functions of their own covariates do, and leave nothing that
    /// depends on their places' covariates but what their laws may get wrong.
    pub(super) fn laws_hold(
        &self,
        causes: &[Cause],
        taken: &Taken,
        with: With<'_>,
        segments: &Segments,
    ) -> bool {
        let effects = causes
            .iter()
            .map(|cause| self.effects[cause.effect].as_ref());
        let wrong = taken.wrong + self.wrong_by_law(causes, with.gain);
        let of_group = with.gain / causes.len() as f64;
        let is_mirrored = causes.iter().zip(effects.clone()).any(|(cause, effect)| {
            let mirrored = self.other_side(with.system, effect, cause, of_group);
            !Self::law_is_kept(effect, mirrored)
        });
        if is_mirrored {
            return false;
        }
        let own = effects.clone().flat_map(own_covariates);
        let free = self.with_free_functions(
            &taken.system,
            own.map(|(place, of, knots)| (place, of, knots / 2)),
        );
        let is_beaten =
            free.is_some_and(|free| with.unseen.gain_on(&segments.unseen(&free)).sum < -wrong);
        let (own, others): (Vec<_>, Vec<_>) = effects
            .flat_map(|effect| self.covariates_beside(effect))
            .partition(|(is_own, _)| *is_own);
        !is_beaten
            && !causes
                .iter()
                .any(|cause| self.gain_varies(cause, with, wrong, segments))
            && !haptical_parallel::any(own, |(_, function)| {
                let beside = self.with_free_functions(with.system, [function]);
                let readings = with.system.layout.count();
                beside.is_some_and(|beside| {
                    with.depends_on((function.1, &beside), readings, wrong, segments)
                })
            })
            && !haptical_parallel::any(others, |(_, function)| {
                !self.gains_beside(function, taken, with, segments)
            })
    }

    /// Whether causes gain on unseen rows beside free functions of another covariate of their joint, too: one that stands in for
    /// such a dependence does not. What the free functions explain themselves may be another error of the same joint.
    fn gains_beside(
        &self,
        function: (Place, Covariate, usize),
        taken: &Taken,
        with: With<'_>,
        segments: &Segments,
    ) -> bool {
        let alone = self.with_free_functions(&taken.system, [function]);
        let beside = self.with_free_functions(with.system, [function]);
        let (Some(alone), Some(beside)) = (alone, beside) else {
            return true;
        };
        let gain = segments.unseen(&beside).gain_on(&segments.unseen(&alone));
        gain.deviations() >= BEYOND_CHANCE_SD && gain.sum >= KEPT_SHARE * with.gain
    }

    /// Squares that the laws of causes may get wrong.
    pub(super) fn wrong_by_law(&self, causes: &[Cause], gain: f64) -> f64 {
        let share = |cause: &Cause| self.effects[cause.effect].spec().law_error.share;
        gain * causes.iter().map(share).fold(0.0, f64::max)
    }

    /// Whether a coupling's gain depends on its joint's own angle by more than `wrong`, and more surely than by chance.
    fn gain_varies(&self, cause: &Cause, with: With<'_>, wrong: f64, segments: &Segments) -> bool {
        let effect = self.effects[cause.effect].as_ref();
        let is_coupling = effect.spec().family == Family::Coupling;
        let Some(from) = effect.other_joint().filter(|_| is_coupling) else {
            return false;
        };
        let place = Place::at(effect.spec().hook, effect.joint());
        let context = &self.engine.context;
        let Some(signals) = varying_gain(context, place, from, GAIN_KNOTS) else {
            return false;
        };
        let mut beside = with.system.clone();
        for signal in signals {
            beside.project_out(&signal);
        }
        let more = segments.unseen(&beside).gain_on(with.unseen);
        more.sum > wrong && more.deviations() > SURELY_BESIDE_SD
    }

    /// Whether free functions at some other place predict unseen rows better than the causes do: the gap lies there.
    pub(super) fn lies_elsewhere(
        &self,
        causes: &[Cause],
        taken: &Taken,
        with: With<'_>,
        segments: &Segments,
    ) -> bool {
        let joints: Vec<usize> = causes
            .iter()
            .filter_map(|cause| self.effects[cause.effect].joint())
            .collect();
        let is_elsewhere = |place: &Place| place.joint.is_none_or(|joint| !joints.contains(&joint));
        let places: Vec<Place> = self.places().filter(is_elsewhere).collect();
        let square = dot(&taken.system.residual, &taken.system.residual);
        haptical_parallel::any(places, |place| {
            let Some(free) = self.with_free_functions(&taken.system, covariates_at(place)) else {
                return false;
            };
            if square - dot(&free.residual, &free.residual) < with.gain {
                return false;
            }
            let lead = segments.unseen(&free).gain_on(with.unseen);
            lead.sum > ELSEWHERE_SHARE * with.gain
        })
    }

    /// What the rest of an effect may depend on, and whether its law is about that: all covariates of its joint, on either side
    /// of the joint's encoders; of an effect of the device the covariates of its law, at every place.
    fn covariates_beside(&self, effect: &dyn Effect) -> Vec<(bool, (Place, Covariate, usize))> {
        let is_of_cable =
            effect.spec().hook == Hook::CableSensor && effect.spec().family != Family::Lag;
        if let Some(joint) = effect.joint() {
            let functions = self.places_at(joint).flat_map(covariates_at);
            let is_posture = !self.engine.context.ordered;
            return functions
                .map(|function| {
                    (
                        is_of_law(effect.spec().family, function.1, is_posture),
                        function,
                    )
                })
                .collect();
        }
        let own = |function| (true, function);
        if is_of_cable {
            return covariates_at(OF_CABLE).into_iter().map(own).collect();
        }
        let of_law = |(_, covariate, _): &(Place, Covariate, usize)| match effect.spec().family {
            Family::Lag => matches!(covariate, Covariate::Speed(_) | Covariate::CableSpeed),
            Family::Load => matches!(covariate, Covariate::Torque(_)),
            Family::Drift | Family::Step | Family::Tool => *covariate == Covariate::Time,
            _ => true,
        };
        self.places()
            .flat_map(covariates_at)
            .filter(of_law)
            .map(own)
            .collect()
    }

    /// Every place at which free functions can act.
    fn places(&self) -> impl Iterator<Item = Place> {
        let joints = 0..self.engine.context.device.joints.len();
        joints
            .flat_map(|joint| self.places_at(joint))
            .chain([OF_CABLE])
    }

    /// On either side of a joint's encoders: what only repeats another place is left out.
    fn places_at(&self, joint: usize) -> impl Iterator<Item = Place> + use<> {
        let has_encoder = self.engine.context.output_stream(joint).is_some();
        let hooks: &[Hook] = match has_encoder {
            true => &[Hook::ExternalEncoder, Hook::Joint],
            false => &[Hook::Joint],
        };
        hooks.iter().map(move |&hook| Place::at(hook, Some(joint)))
    }

    /// A system with free functions in it; none where the recording has none of their covariates.
    fn with_free_functions(
        &self,
        system: &System,
        functions: impl IntoIterator<Item = (Place, Covariate, usize)>,
    ) -> Option<System> {
        let context = &self.engine.context;
        let mut with = system.clone();
        let functions = functions
            .into_iter()
            .filter_map(|(place, covariate, knots)| {
                free_function(context, place, covariate, knots)
            });
        for signal in functions.flatten() {
            with.project_out(&signal);
        }
        (with.basis.len() > system.basis.len()).then_some(with)
    }
}

impl With<'_> {
    /// Whether the rest depends on a covariate, whose free functions the system `beside` has too, by more than `wrong`, and more surely than
    /// by chance.
    pub(super) fn depends_on(
        self,
        (of, beside): (Covariate, &System),
        readings: usize,
        wrong: f64,
        segments: &Segments,
    ) -> bool {
        let rest = dot(&self.system.residual, &self.system.residual);
        let freedom = (beside.basis.len() - self.system.basis.len()) as f64;
        let misfit = (rest / readings as f64).max(1.0);
        let explained = rest - dot(&beside.residual, &beside.residual) - misfit * freedom;
        // a segment that is left out takes its part of a function of time with it
        if of == Covariate::Time || explained <= wrong {
            return explained > wrong;
        }
        let more = segments.unseen(beside).gain_on(self.unseen);
        more.sum > wrong && more.deviations() > SURELY_BESIDE_SD
    }
}

/// Whether a law at a joint is one of this covariate of the joint. A play that is crossed between two postures is a
/// function of the side alone.
fn is_of_law(family: Family, covariate: Covariate, is_posture: bool) -> bool {
    match family {
        Family::Load => matches!(covariate, Covariate::Torque(_)),
        Family::Loop if is_posture => matches!(covariate, Covariate::Side(_)),
        _ => true,
    }
}

/// The cable's encoder.
const OF_CABLE: Place = Place::at(Hook::CableSensor, None);

/// What an error at a place may depend on, with the intervals of its free functions.
fn covariates_at(place: Place) -> Vec<(Place, Covariate, usize)> {
    let found = match place.joint {
        Some(joint) => vec![
            Covariate::Angle(joint),
            Covariate::MotorPhase(joint),
            Covariate::Side(joint),
            Covariate::Speed(joint),
            Covariate::Torque(joint),
            Covariate::Time,
        ],
        None => vec![
            Covariate::Length(0),
            Covariate::CableSpeed,
            Covariate::ExitAngle,
            Covariate::Time,
        ],
    };
    found
        .into_iter()
        .map(|of| match of {
            // steps of grooves and of counts
            Covariate::MotorPhase(_) | Covariate::Time => (place, of, FINE_KNOTS),
            of => (place, of, FREE_KNOTS),
        })
        .collect()
}
