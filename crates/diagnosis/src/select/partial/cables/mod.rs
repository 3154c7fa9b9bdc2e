//! Play and coupling of the cables that drive a joint, judged by the joint's own external encoder, which sees all of its
//! drive and nothing else (docs/diagnosis.md, "Cables of a joint").

mod laws;

use std::convert::Infallible;

use haptical_effects::{Effect, Family, Hook, Shape, Signal};
use haptical_judge::{Forward, Proposal, Proposals, Ruled, Ruling};
use nalgebra::{DMatrix, DVector};

use crate::Result;
use crate::engine::{Cause, Refit, Segments, System, Unseen, dot, mask};
use crate::select::partial::With;
use crate::select::{Partial, Rival, Selection, Selector, worst_excess};
use crate::thresholds::chance::OMNIBUS_Z;
use crate::thresholds::partial::{
    BEYOND_CHANCE_SD, LEAST_CABLE_SD, LEAST_CABLE_SHARE, LEAST_CABLES, LEAST_PREDICTED,
    LEAST_SHARE, MOST_CABLES, PLAYS_RAD,
};

impl Selection<'_> {
    /// Takes up what the cables of the joints do, from no cause at all, joint by joint where its own encoder supports it; none
    /// where fewer than two effects are supported, and then nothing is changed.
    pub(crate) fn take_cables(&mut self) -> Result<Option<Partial>> {
        let engine = self.selector.engine;
        if !engine.context.ordered || engine.base.anchor.is_some() {
            return Ok(None);
        }
        let mut refit = engine.start.clone();
        let mut rivals = Vec::new();
        for joint in 0..engine.context.device.joints.len() {
            let Some(stream) = engine.context.output_stream(joint) else {
                continue;
            };
            let own = stream..stream + 1;
            let has_gap = worst_excess(&self.before[own.clone()], &engine.noise[own]) >= OMNIBUS_Z;
            let drive = Drive::new(&self.selector, joint, stream);
            if let Some((next, of_joint)) = drive.explained(&refit, has_gap)? {
                refit = next;
                rivals.extend(of_joint);
            }
        }
        if rivals.len() < LEAST_CABLES {
            return Ok(None);
        }
        let system = self.selector.system_of(&refit);
        let segments = Segments::new(&engine.context, &engine.system);
        let alone = segments.unseen(&engine.system);
        let noise = engine.system.layout.count() as f64;
        let share = segments.unseen(&system).closed_of(&alone, noise);
        self.explained = self.selector.explained_alone(&refit.model);
        self.after = system.slow_energy(&system.residual);
        (self.refit, self.system) = (refit, system);
        Ok(Some(Partial {
            share,
            rivals,
            is_of_cables: true,
        }))
    }
}

/// A model with a joint's causes, and of each of them, itself first, what could be in its place.
type Explained = (Refit, Vec<Vec<Rival>>);

/// The drive of a joint as its external encoder sees it.
struct Drive<'d> {
    selector: &'d Selector<'d>,
    joint: usize,
    stream: usize,
    /// The base model's system, with nothing of the other streams in it.
    base: System,
    segments: Segments,
    alone: Unseen,
}

/// What a cable can do to the joint, linear at a start value.
#[derive(Debug, Clone)]
struct Cable {
    effect: usize,
    shape: f64,
    /// Another joint's, or its own.
    from: Option<usize>,
    family: Family,
    /// Across the base model.
    column: Vec<f64>,
    /// Across all that was chosen.
    left: Vec<f64>,
}

impl Cable {
    fn is_instead_of(&self, other: &Self) -> bool {
        self.from == other.from && self.family == other.family
    }

    fn score(&self, system: &System) -> f64 {
        let length = dot(&self.left, &self.left);
        // what the others leave of it is rounding
        if length <= 1e-6 * dot(&self.column, &self.column) {
            return 0.0;
        }
        dot(&self.left, &system.residual).powi(2) / length
    }
}

impl<'d> Drive<'d> {
    fn new(selector: &'d Selector<'d>, joint: usize, stream: usize) -> Self {
        let engine = selector.engine;
        let base = engine.system.of_stream(stream);
        let segments = Segments::new(&engine.context, &base);
        let alone = segments.unseen(&base);
        Self {
            selector,
            joint,
            stream,
            base,
            segments,
            alone,
        }
    }

    fn effect(&self, index: usize) -> &dyn Effect {
        self.selector.effects[index].as_ref()
    }

    /// The base model with the cables' effects at this joint, and what could be in their places, where its encoder supports
    /// them.
    fn explained(&self, before: &Refit, has_gap: bool) -> Result<Option<Explained>> {
        let readings = self.base.layout.range(self.stream).len() as f64;
        // fast gaps may pass for noise; noise is not predicted
        let gap = match has_gap {
            true => (self.alone.sum() - readings).max(0.0),
            false => self.alone.sum(),
        };
        let (chosen, all) = self.chosen(gap);
        let Some(causes) = self.sized(&chosen) else {
            return Ok(None);
        };
        let engine = self.selector.engine;
        let mut model = before.model.clone();
        let first = model.causes.len();
        model.causes.extend(causes);
        let refit = engine.refit(self.selector.effects, &model)?;
        if !refit.has_converged() || !self.selector.is_possible(&refit.model) {
            return Ok(None);
        }
        let system = self.after(&refit, first);
        let unseen = self.segments.unseen(&system);
        let gain = unseen.gain_on(&self.alone);
        let causes = &refit.model.causes[first..];
        let least = if has_gap {
            LEAST_SHARE
        } else {
            LEAST_PREDICTED
        };
        let is_enough = gain.deviations_by_sign() >= BEYOND_CHANCE_SD && gain.sum >= least * gap;
        let with = With {
            system: &system,
            unseen: &unseen,
            gain: gain.sum,
        };
        if !is_enough || !self.laws_hold(causes, with) {
            return Ok(None);
        }
        let rivals = self.rivals(&chosen, &all);
        Ok(Some((refit, rivals)))
    }

    /// What cables can do to the joint, at every start value.
    fn cables(&self) -> Vec<Cable> {
        let context = &self.selector.engine.context;
        let mut found = Vec::new();
        for &index in self.selector.tested {
            let effect = self.effect(index);
            let spec = effect.spec();
            let is_of_drive = effect.joint() == Some(self.joint)
                && spec.hook == Hook::Transmission
                && matches!(spec.family, Family::Loop | Family::Coupling);
            if !is_of_drive {
                continue;
            }
            let starts: Vec<(f64, f64)> = match spec.shape {
                // a play's course depends on its width
                Shape::Sides => PLAYS_RAD.iter().map(|&width| (0.0, width)).collect(),
                _ => {
                    let shapes = effect.shapes(context).into_iter();
                    shapes.map(|shape| (shape, 0.0)).collect()
                }
            };
            for (shape, amplitude) in starts {
                let signals = effect.derivative(context, &[amplitude], shape);
                let [signal] = &signals[..] else { continue };
                let mut column = self.masked(signal);
                for direction in &self.base.basis {
                    direction.take_off(&mut column);
                }
                found.push(Cable {
                    effect: index,
                    shape,
                    from: effect.other_joint(),
                    family: spec.family,
                    left: column.clone(),
                    column,
                });
            }
        }
        found
    }

    /// A signal in the joint's stream alone.
    fn masked(&self, signal: &Signal) -> Vec<f64> {
        let mut column = self.base.column(signal);
        column.parts.retain(|(stream, _)| *stream == self.stream);
        self.base.dense(&column)
    }

    /// Effects that were added one after the other, the best first, while unseen rows are predicted better; and all that were
    /// tried.
    fn chosen(&self, gap: f64) -> (Vec<Cable>, Vec<Cable>) {
        let all = self.cables();
        let mut search = Search {
            drive: self,
            gap,
            open: all.clone(),
        };
        let start = Chosen {
            cables: Vec::new(),
            system: self.base.clone(),
            unseen: self.alone.clone(),
        };
        let Ok(chosen) = haptical_judge::select(&mut search, start);
        (chosen.cables, all)
    }

    /// The effects with the sizes that fit best together; none where there are none.
    fn sized(&self, chosen: &[Cable]) -> Option<Vec<Cause>> {
        if chosen.is_empty() {
            return None;
        }
        let count = chosen.len();
        let gram = DMatrix::from_fn(count, count, |a, b| {
            dot(&chosen[a].column, &chosen[b].column)
        });
        let right = DVector::from_fn(count, |k, _| dot(&chosen[k].column, &self.base.residual));
        let sizes = gram.cholesky()?.solve(&right);
        let causes = chosen.iter().zip(sizes.iter());
        let causes = causes.map(|(cable, size)| Cause {
            effect: cable.effect,
            amplitudes: vec![*size],
            shape: cable.shape,
            times: Vec::new(),
        });
        Some(causes.collect())
    }

    /// The joint's system with the causes from `first` on.
    fn after(&self, refit: &Refit, first: usize) -> System {
        let mut system = self.with_causes(&refit.model.causes[first..], None);
        let mut residual = system.layout.compress_rows(&refit.residual);
        mask(&mut residual, system.layout.range(self.stream));
        system.project_reading(residual);
        system
    }
}

/// Effects of a joint's cables that were added so far.
struct Chosen {
    cables: Vec<Cable>,
    system: System,
    unseen: Unseen,
}

/// The search of what a joint's cables do.
struct Search<'s, 'd> {
    drive: &'s Drive<'d>,
    /// Squares beyond noise that the base model leaves of unseen rows.
    gap: f64,
    /// Effects that may be added, across those that were.
    open: Vec<Cable>,
}

impl Forward for Search<'_, '_> {
    type State = Chosen;
    type Further = Cable;
    type Error = Infallible;

    fn proposals(&mut self, chosen: &Chosen) -> Proposals<Self> {
        if chosen.cables.len() >= MOST_CABLES {
            return Ok(Vec::new());
        }
        let scores = (self.open.iter()).map(|cable| (cable, cable.score(&chosen.system)));
        let scores = scores.filter(|(_, score)| *score > 0.0);
        Ok(scores
            .map(|(cable, merit)| Proposal {
                merit,
                further: cable.clone(),
            })
            .collect())
    }

    fn rule(&mut self, chosen: &Chosen, best: Proposal<Cable>) -> Ruled<Self> {
        let cable = best.further;
        let mut system = chosen.system.clone();
        system.take(cable.column.clone());
        let unseen = self.drive.segments.unseen(&system);
        let gain = unseen.gain_on(&chosen.unseen);
        if gain.deviations_by_sign() < LEAST_CABLE_SD || gain.sum < LEAST_CABLE_SHARE * self.gap {
            return Ok(Ruling::Ended);
        }
        self.open.retain(|other| !other.is_instead_of(&cable));
        if let Some(direction) = system.basis.last() {
            for other in &mut self.open {
                direction.take_off(&mut other.left);
            }
        }
        Ok(Ruling::Taken(Chosen {
            cables: [chosen.cables.as_slice(), &[cable]].concat(),
            system,
            unseen,
        }))
    }
}
