//! Effects that cannot be seen: those that the base model swallows, with what they would falsify, and the
//! smallest size of every other one that would have been noticed.

use haptical_effects::{Absorbed, Effect, Role, Shape, parameter};
use haptical_linalg::Direction;
use nalgebra::{DMatrix, DVector};

use crate::answer::{Detectable, Hint, Invisible};
use crate::engine::{Engine, dot};
use crate::judge::Findings;
use crate::select::{Candidate, Score, Selector};
use crate::thresholds::unseen::{HINT_DEVIATIONS, MOST_BIASED, NOTICED_SCORE, VISIBLE};

/// Sizes that would have been noticed, and effects that never are.
pub(crate) fn unseen(findings: &Findings<'_>) -> (Vec<Detectable>, Vec<Invisible>) {
    let selector = &findings.selection.selector;
    let engine = selector.engine;
    let mut detectable = Vec::new();
    let mut invisible = Vec::new();
    let biases = Biases::new(engine);
    for &index in selector.tested {
        let effect = selector.effects[index].as_ref();
        let Some((score, candidate)) = most_sensitive(selector, index) else {
            continue;
        };
        let scale = NOTICED_SCORE.sqrt() * score.unit_amplitude;
        let mut amplitudes = vec![0.0; effect.spec().amplitudes];
        amplitudes[0] = scale;
        let values = effect.values(&engine.context, &amplitudes, score.shape);
        let visible = score.rank > 0
            && scale.is_finite()
            && (score.retained > VISIBLE || effect.is_plausible(&values));
        if visible {
            detectable.push(Detectable {
                effect: effect.name().to_owned(),
                joint: effect.joint().map(|joint| joint + 1),
                parameter: effect.spec().parameters[0].name.to_owned(),
                value: values[0].abs(),
            });
        } else {
            invisible.push(Invisible {
                effect: effect.name().to_owned(),
                joint: effect.joint().map(|joint| joint + 1),
                why: why(effect, &score, &candidate),
                would_bias: biases.largest(engine, &candidate),
            });
        }
    }
    for &index in findings.inputs.in_base {
        let effect = selector.effects[index].as_ref();
        if effect.spec().absorbed_by == Absorbed::ByInputDrum {
            invisible.push(Invisible {
                effect: effect.name().to_owned(),
                joint: effect.joint().map(|joint| joint + 1),
                why: "the base model's input drum has the same term: a relabelling".to_owned(),
                would_bias: format!(
                    "input_drum_xy_m of joint {}",
                    effect.joint().map_or(0, |joint| joint + 1)
                ),
            });
        }
    }
    (merge(detectable), invisible)
}

/// One line for an effect at a place: its best case.
fn merge(mut all: Vec<Detectable>) -> Vec<Detectable> {
    let mut kept: Vec<Detectable> = Vec::new();
    for entry in all.drain(..) {
        let parameter = parameter(&entry.effect, &entry.parameter);
        let stiff = parameter.is_some_and(|parameter| parameter.role == Role::Inverse);
        match kept.iter_mut().find(|other| {
            other.effect == entry.effect
                && other.joint == entry.joint
                && other.parameter == entry.parameter
        }) {
            Some(other) if (entry.value < other.value) != stiff => *other = entry,
            Some(_) => {}
            None => kept.push(entry),
        }
    }
    kept
}

fn why(effect: &dyn Effect, score: &Score, candidate: &Candidate) -> String {
    let retained = score.retained;
    match effect.spec().absorbed_by {
        Absorbed::ByLengths => "indistinguishable from scaling every length".to_owned(),
        _ if candidate.is_nothing() => "nothing that was measured depends on it".to_owned(),
        _ => format!(
            "the base model's own parameters imitate {:.2} % of it",
            100.0 * (1.0 - retained * retained).max(0.0).sqrt()
        ),
    }
}

fn most_sensitive(selector: &Selector<'_>, index: usize) -> Option<(Score, Candidate)> {
    let engine = selector.engine;
    let effect = selector.effects[index].as_ref();
    if effect.spec().shape == Shape::Event {
        let middle = (engine.context.rows() / 2) as f64;
        let candidate = Candidate::new(
            &engine.system,
            &engine.context,
            effect,
            index,
            &[0.0],
            middle,
        );
        return Some((candidate.score(&engine.system), candidate));
    }
    selector
        .base_candidates()
        .filter(|candidate| candidate.effect == index)
        .map(|candidate| (candidate.score_at_base(&engine.system), candidate))
        .min_by(|a, b| a.0.unit_amplitude.total_cmp(&b.0.unit_amplitude))
        .map(|(score, candidate)| (score, candidate.clone()))
}

/// Least-squares answers of the base model to a column: what an effect would falsify.
struct Biases {
    normal: Option<nalgebra::Cholesky<f64, nalgebra::Dyn>>,
    norms: Vec<f64>,
}

impl Biases {
    fn new(engine: &Engine<'_>) -> Self {
        let free = engine.free();
        let columns: Vec<&Direction> = (0..free.columns()).map(|k| free.column(k)).collect();
        let length = |column: &&Direction| dot(column.values(), column.values()).sqrt();
        let norms = columns.iter().map(|column| length(column).max(1e-300));
        let norms: Vec<f64> = norms.collect();
        // where joints do not know of each other, most products are zero
        let normal = DMatrix::from_fn(free.columns(), free.columns(), |a, b| {
            let ridge = if a == b { 1e-9 } else { 0.0 };
            let product = columns[a].dot_part(columns[b].values(), columns[b].first());
            product / (norms[a] * norms[b]) + ridge
        });
        Self {
            normal: normal.cholesky(),
            norms,
        }
    }

    /// The parameters that change most, in units of a plausible deviation.
    fn largest(&self, engine: &Engine<'_>, candidate: &Candidate) -> String {
        let (Some(normal), Some(column)) = (&self.normal, candidate.columns.first()) else {
            return String::new();
        };
        let free = engine.free();
        let right = DVector::from_fn(free.columns(), |index, _| {
            engine.system.dot_direction(column, free.column(index)) / self.norms[index]
        });
        let solution = normal.solve(&right);
        let device = engine.context.device;
        let mut changes: Vec<(f64, String)> = engine
            .base
            .free
            .iter()
            .enumerate()
            .map(|(index, &parameter)| {
                let parameter = engine.base.parameters[parameter];
                let change = solution[index] / self.norms[index];
                let size = parameter.plausible_size(device).max(1e-300);
                ((change / size).abs(), parameter.name(device))
            })
            .collect();
        changes.sort_by(|a, b| b.0.total_cmp(&a.0));
        let names: Vec<String> = changes
            .into_iter()
            .take(MOST_BIASED)
            .map(|(_, name)| name)
            .collect();
        names.join(", ")
    }
}

/// Fitted lengths and drums that a sound device hardly has: an effect may hide in them.
pub(crate) fn hints(engine: &Engine<'_>, nominal: &haptical_model::Device) -> Vec<Hint> {
    let mut hints = Vec::new();
    let fitted = engine.problem.device_with(&engine.start.model.values);
    for &index in &engine.base.free {
        let parameter = engine.base.parameters[index];
        // where a rig is, nobody knows beforehand
        if let haptical_model::ParameterId::Surrounding(_) = parameter {
            continue;
        }
        let value = parameter.value(&fitted);
        let before = if matches!(parameter, haptical_model::ParameterId::Link { .. }) {
            parameter.value(nominal)
        } else {
            0.0
        };
        let size = parameter.plausible_size(nominal);
        if size > 0.0 && (value - before).abs() > HINT_DEVIATIONS * size {
            hints.push(Hint {
                parameter: parameter.name(nominal),
                why: format!(
                    "fitted {:.3e} {} from nominal, {:.0} times a plausible deviation: an effect may hide in it",
                    value - before,
                    parameter.unit(nominal),
                    ((value - before) / size).abs()
                ),
            });
        }
    }
    hints
}
