//! Steps: the instants at which they explain most (docs/diagnosis.md, "Events").

use std::collections::BTreeMap;

use haptical_effects::{Context, Effect, Signal};
use haptical_linalg::Direction;

use crate::engine::system::{ALWAYS, System, across, dot, take_off};
use crate::select::scan::{Candidate, Score};
use crate::thresholds::steps::{
    APART_S, LEAST_LEFT, MARGIN, MOST_STEPS_OF_AN_EVENT, RESTING_RAD, STEP_SCORE, STEP_SHARE,
    SWEEPS,
};

/// An event's instants. A step changes its row and all later ones, so sums over what it changes run from the end of each run
/// backwards; those that no other step changes are made once.
pub(crate) struct Instants<'s> {
    system: &'s System,
    context: &'s Context<'s>,
    effect: &'s dyn Effect,
    index: usize,
    runs: Vec<Vec<Entry>>,
}

/// One value of the signal that steps at the start of its run, latest first.
struct Entry {
    row: usize,
    place: usize,
    value: f64,
    /// Square of the signal so far, and what of it lies along the system's directions.
    own: f64,
    explained: f64,
    /// Whether a step may be at this row, whose last entry it is.
    is_instant: bool,
}

impl<'s> Instants<'s> {
    /// Of the effect that has this index.
    pub(crate) fn new(
        system: &'s System,
        context: &'s Context<'s>,
        effect: &'s dyn Effect,
        index: usize,
    ) -> Self {
        let runs = context.runs.iter().filter(|run| run.len() > 1);
        let runs = runs.filter_map(|run| {
            let signal = effect.derivative(context, &[0.0], run.start as f64);
            let column = system.column(signal.first()?);
            let mut entries: Vec<Entry> = Vec::new();
            for (stream, values) in &column.parts {
                let first = system.layout.range(*stream).start;
                for (block, &value) in values.iter().enumerate() {
                    let row = system.layout.row(*stream, block);
                    if run.contains(&row) {
                        entries.push(Entry {
                            row,
                            place: first + block,
                            value,
                            own: 0.0,
                            explained: 0.0,
                            is_instant: false,
                        });
                    }
                }
            }
            entries.sort_unstable_by(|a, b| b.row.cmp(&a.row).then(a.place.cmp(&b.place)));
            let margin = margin_rows(context, run);
            let mut taken = vec![0.0; system.basis.len()];
            let mut own = 0.0;
            for position in 0..entries.len() {
                let next = entries.get(position + 1).map(|next| next.row);
                let Entry {
                    row, place, value, ..
                } = entries[position];
                own += value * value;
                for (sum, direction) in taken.iter_mut().zip(&system.basis) {
                    *sum += value * direction.entry(place);
                }
                let is_inside = row >= run.start + margin && row + margin < run.end;
                entries[position].is_instant = is_inside && next != Some(row);
                if entries[position].is_instant {
                    entries[position].own = own;
                    entries[position].explained = dot(&taken, &taken);
                }
            }
            Some(entries)
        });
        Self {
            system,
            context,
            effect,
            index,
            runs: runs.collect(),
        }
    }

    /// The best instant of one step, searched at every block.
    pub(crate) fn one_step(&self) -> Option<Score> {
        self.best(&Rest::new(self.system))
    }

    /// The instant at which a step explains most of what is left.
    fn best(&self, rest: &Rest<'_>) -> Option<Score> {
        let mut best: Option<Score> = None;
        let mut taken = vec![0.0; rest.further.len()];
        for entries in &self.runs {
            taken.fill(0.0);
            let mut along = 0.0;
            for entry in entries {
                along += entry.value * rest.residual[entry.place];
                for (sum, direction) in taken.iter_mut().zip(&rest.further) {
                    *sum += entry.value * direction.entry(entry.place);
                }
                if !entry.is_instant || rest.is_taken(self.context, entry.row) {
                    continue;
                }
                let own = entry.own;
                let left = own - entry.explained - dot(&taken, &taken);
                if left <= LEAST_LEFT * own || left <= 0.0 {
                    continue;
                }
                let score = along * along / left;
                if best.as_ref().is_none_or(|best| score > best.score) {
                    best = Some(Score {
                        effect: self.index,
                        shape: entry.row as f64,
                        score,
                        rank: 1,
                        amplitudes: vec![along / left],
                        times: vec![entry.row as f64],
                        retained: (left / own).sqrt(),
                        unit_amplitude: 1.0 / left.sqrt(),
                    });
                }
            }
        }
        best
    }

    /// An event's further steps (counts are lost more than once): each at its best instant, after which
    /// the others move to theirs. Three steps up look like a ramp whose middle is the best single one.
    pub(crate) fn with_more_steps(&self, first: Score) -> Score {
        let one = first.score;
        let mut steps = Steps::new(self.system, self.context, self.effect);
        let mut times = first.times.clone();
        while times.len() < MOST_STEPS_OF_AN_EVENT {
            match self.best(&steps.taken(&times, usize::MAX)) {
                Some(next) if next.score > STEP_SCORE && next.score > STEP_SHARE * one => {
                    times.push(next.shape);
                }
                _ => break,
            }
            for _ in 0..SWEEPS {
                let before = times.clone();
                for index in 0..times.len() {
                    if let Some(best) = self.best(&steps.taken(&times, index)) {
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
            .flat_map(|&time| self.effect.derivative(self.context, &[0.0], time))
            .collect();
        let candidate = Candidate::of_signals(self.system, &signals, first.effect, times[0]);
        Score {
            times,
            ..candidate.score(self.system)
        }
    }
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

/// Moves each instant of an event to the row, within a block's reach, that explains most.
pub(crate) fn sharpen(
    system: &System,
    context: &Context<'_>,
    effect: &dyn Effect,
    mut event: Score,
) -> Score {
    let reach = (system.layout.size + 1).min(12);
    let mut steps = Steps::new(system, context, effect);
    for index in 0..event.times.len() {
        let rest = steps.taken(&event.times, index);
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

/// The steps of an event, each across the system's directions: computed once, however often the others move.
struct Steps<'s> {
    system: &'s System,
    context: &'s Context<'s>,
    effect: &'s dyn Effect,
    known: BTreeMap<usize, Vec<Vec<f64>>>,
}

impl<'s> Steps<'s> {
    fn new(system: &'s System, context: &'s Context<'s>, effect: &'s dyn Effect) -> Self {
        Self {
            system,
            context,
            effect,
            known: BTreeMap::new(),
        }
    }

    /// What is left of the system with all steps but one projected out.
    fn taken(&mut self, times: &[f64], but: usize) -> Rest<'s> {
        let mut rest = Rest::new(self.system);
        for (index, &time) in times.iter().enumerate() {
            if index != but {
                let row = time as usize;
                rest.steps.push(row);
                for own in self.across(row) {
                    rest.take(own.clone());
                }
            }
        }
        rest
    }

    fn across(&mut self, row: usize) -> &[Vec<f64>] {
        let (system, context, effect) = (self.system, self.context, self.effect);
        self.known.entry(row).or_insert_with(|| {
            let signals = effect.derivative(context, &[0.0], row as f64);
            let dense = signals
                .iter()
                .map(|signal| system.dense(&system.column(signal)));
            dense
                .filter_map(|dense| across(dense, ALWAYS, || system.basis.iter()))
                .map(|across| across.direction)
                .collect()
        })
    }
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

    /// Projects out a vector that lies across the system's directions already.
    fn take(&mut self, own: Vec<f64>) {
        if let Some(across) = across(own, ALWAYS, || self.further.iter()) {
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
