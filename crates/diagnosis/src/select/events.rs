//! Steps: the instants at which they explain most (docs/diagnosis.md, "Events").

use haptical_effects::{Context, Effect, Signal};
use haptical_linalg::Direction;

use crate::engine::system::{ALWAYS, System, across, dot, take_off};
use crate::select::scan::{Candidate, Score};
use crate::thresholds::steps::{
    APART_S, MOST_STEPS_OF_AN_EVENT, RESTING_RAD, STEP_SCORE, STEP_SHARE, SWEEPS,
};
use crate::thresholds::steps::{LEAST_LEFT, MARGIN};

/// The best instant of an event, searched at every block.
pub(crate) fn event_score(
    system: &System,
    context: &Context<'_>,
    effect: &dyn Effect,
    index: usize,
) -> Option<Score> {
    best_instant(&Rest::new(system), context, effect, index)
}

fn best_instant(
    rest: &Rest<'_>,
    context: &Context<'_>,
    effect: &dyn Effect,
    index: usize,
) -> Option<Score> {
    let system = rest.system;
    let mut best: Option<Score> = None;
    for run in context.runs.iter().filter(|run| run.len() > 1) {
        let margin = margin_rows(context, run);
        let signal = effect.derivative(context, &[0.0], run.start as f64);
        let column = system.column(signal.first()?);
        // entries of all streams, latest first
        let mut entries: Vec<(usize, usize, f64)> = Vec::new();
        for (stream, values) in &column.parts {
            let first = system.layout.range(*stream).start;
            for (block, &value) in values.iter().enumerate() {
                let row = system.layout.row(*stream, block);
                if run.contains(&row) {
                    entries.push((row, first + block, value));
                }
            }
        }
        entries.sort_unstable_by(|a, b| b.0.cmp(&a.0).then(a.1.cmp(&b.1)));
        let directions: Vec<&Direction> = rest.directions().collect();
        let mut taken = vec![0.0; directions.len()];
        let (mut along, mut own) = (0.0, 0.0);
        for (position, &(row, place, value)) in entries.iter().enumerate() {
            along += value * rest.residual[place];
            own += value * value;
            for (sum, direction) in taken.iter_mut().zip(&directions) {
                *sum += value * direction.entry(place);
            }
            let last_of_row = entries.get(position + 1).is_none_or(|next| next.0 != row);
            let inside = row >= run.start + margin && row + margin < run.end;
            if !last_of_row || !inside || rest.is_taken(context, row) {
                continue;
            }
            let left = own - dot(&taken, &taken);
            if left <= LEAST_LEFT * own || left <= 0.0 {
                continue;
            }
            let score = along * along / left;
            if best.as_ref().is_none_or(|best| score > best.score) {
                best = Some(Score {
                    effect: index,
                    shape: row as f64,
                    score,
                    rank: 1,
                    amplitudes: vec![along / left],
                    times: vec![row as f64],
                    retained: (left / own).sqrt(),
                    unit_amplitude: 1.0 / left.sqrt(),
                });
            }
        }
    }
    best
}

/// Rows at either end of a run within which a step is one with the zero that the base model
/// adjusts: a part of the run, and at the start as long as the device rests.
fn margin_rows(context: &Context<'_>, run: &std::ops::Range<usize>) -> usize {
    let columns = &context.recording.joint;
    let moves = |row: &usize| {
        columns
            .iter()
            .filter(|column| (column[*row] - column[run.start]).abs() > RESTING_RAD)
            .count()
            > 0
    };
    let rest = run.clone().find(moves).map_or(0, |row| row - run.start);
    rest + run.len().div_ceil(MARGIN)
}

/// An event's further steps (counts are lost more than once): each at its best instant, after which
/// the others move to theirs. Three steps up look like a ramp whose middle is the best single one.
pub(crate) fn with_more_steps(
    system: &System,
    context: &Context<'_>,
    effect: &dyn Effect,
    first: Score,
) -> Score {
    let one = first.score;
    let mut times = first.times.clone();
    while times.len() < MOST_STEPS_OF_AN_EVENT {
        let rest = Rest::with_steps(system, context, effect, &times, usize::MAX);
        match best_instant(&rest, context, effect, first.effect) {
            Some(next) if next.score > STEP_SCORE && next.score > STEP_SHARE * one => {
                times.push(next.shape);
            }
            _ => break,
        }
        for _ in 0..SWEEPS {
            let before = times.clone();
            for index in 0..times.len() {
                let rest = Rest::with_steps(system, context, effect, &times, index);
                if let Some(best) = best_instant(&rest, context, effect, first.effect) {
                    times[index] = best.shape;
                }
            }
            if times == before {
                break;
            }
        }
    }
    if times.len() == 1 {
        return first;
    }
    let signals: Vec<Signal> = times
        .iter()
        .flat_map(|&time| effect.derivative(context, &[0.0], time))
        .collect();
    let candidate = Candidate::of_signals(system, &signals, first.effect, times[0]);
    Score {
        times,
        ..candidate.score(system)
    }
}

/// Moves each instant of an event to the row, within a block's reach, that explains most.
pub(crate) fn sharpen(
    system: &System,
    context: &Context<'_>,
    effect: &dyn Effect,
    mut event: Score,
) -> Score {
    let reach = (system.layout.size + 1).min(12);
    for index in 0..event.times.len() {
        let rest = Rest::with_steps(system, context, effect, &event.times, index);
        let row = event.times[index] as usize;
        let mut best: Option<(f64, f64, f64)> = None;
        for row in row.saturating_sub(reach)..(row + reach + 1).min(context.rows()) {
            let at = row as f64;
            for signal in effect.derivative(context, &[0.0], at) {
                let (score, amplitude) = rest.score(&signal);
                if best.is_none_or(|(most, ..)| score > most) {
                    best = Some((score, amplitude, at));
                }
            }
        }
        if let Some((_, amplitude, at)) = best {
            event.times[index] = at;
            event.amplitudes[index] = amplitude;
        }
    }
    event
}

/// Residual of a system with further directions projected out.
struct Rest<'s> {
    system: &'s System,
    further: Vec<Direction>,
    residual: Vec<f64>,
    /// Rows of the other steps.
    steps: Vec<usize>,
}

impl<'s> Rest<'s> {
    fn new(system: &'s System) -> Self {
        Self {
            system,
            further: Vec::new(),
            residual: system.residual.clone(),
            steps: Vec::new(),
        }
    }

    /// With all steps of an event but one projected out.
    fn with_steps(
        system: &'s System,
        context: &Context<'_>,
        effect: &dyn Effect,
        times: &[f64],
        but: usize,
    ) -> Self {
        let mut rest = Self::new(system);
        for (index, &time) in times.iter().enumerate() {
            if index != but {
                rest.steps.push(time as usize);
                for signal in effect.derivative(context, &[0.0], time) {
                    rest.take(&signal);
                }
            }
        }
        rest
    }

    /// Whether another step is so near that the two would be one, or take each other back.
    fn is_taken(&self, context: &Context<'_>, row: usize) -> bool {
        let Some(time_s) = &context.recording.time_s else {
            return self.steps.contains(&row);
        };
        let near = |step: &usize| (time_s[row] - time_s[*step]).abs() < APART_S;
        self.steps.iter().any(near)
    }

    fn directions(&self) -> impl Iterator<Item = &Direction> {
        self.system.basis.iter().chain(&self.further)
    }

    fn take(&mut self, signal: &Signal) {
        let dense = self.system.dense(&self.system.column(signal));
        if let Some(across) = across(dense, ALWAYS, || self.directions()) {
            take_off(&mut self.residual, &across.direction);
            self.further.push(Direction::new(across.direction));
        }
    }

    /// What one signal explains, and its amplitude.
    fn score(&self, signal: &Signal) -> (f64, f64) {
        let dense = self.system.dense(&self.system.column(signal));
        let across = across(dense.clone(), ALWAYS, || self.directions());
        across.map_or((0.0, 0.0), |across| {
            let along = dot(&across.direction, &self.residual);
            (along * along, along / dot(&across.direction, &dense))
        })
    }
}
