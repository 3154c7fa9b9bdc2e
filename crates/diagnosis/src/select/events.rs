//! Steps: the instants at which they explain most (docs/diagnosis.md, "Events").

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::ops::Range;

use haptical_effects::{Context, Effect, Signal};
use haptical_judge::{Forward, Proposal, Proposals, Ruled, Ruling};
use haptical_linalg::Direction;

use crate::Result;
use crate::engine::{ALWAYS, Cause, Engine, Model, Refit, System, across, dot, take_off};
use crate::select::{Candidate, Score, Selector};
use crate::thresholds::steps::{
    APART_S, INSTANT_COST, LEAST_LEFT, MARGIN, MOST_STEPS_OF_AN_EVENT, RESTING_RAD, STEP_SCORE,
    STEP_SHARE, SWEEPS,
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
                    let row = system.layout.first_row(*stream, block);
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
            let inside = inside(context, run);
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
                entries[position].is_instant = inside.contains(&row) && next != Some(row);
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
    fn best(&self, rest: &Rest) -> Option<Score> {
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
        let mut further = FurtherSteps {
            instants: self,
            one: first.score,
            known: BTreeMap::new(),
        };
        let Ok(times) = haptical_judge::select(&mut further, first.times.clone());
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

struct FurtherSteps<'s> {
    instants: &'s Instants<'s>,
    /// What the first step explains alone.
    one: f64,
    /// The step at a row, across the system's directions: computed once, however often the others move.
    known: BTreeMap<usize, Vec<Vec<f64>>>,
}

impl FurtherSteps<'_> {
    /// What is left of the system with all steps but one projected out.
    fn taken(&mut self, times: &[f64], but: usize) -> Rest {
        let mut rest = Rest::new(self.instants.system);
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
        let Instants {
            system,
            context,
            effect,
            ..
        } = self.instants;
        self.known.entry(row).or_insert_with(|| {
            let signals = effect.derivative(context, &[0.0], row as f64);
            let dense = signals.iter().map(|signal| system.layout.dense(signal));
            dense
                .filter_map(|dense| across(dense, ALWAYS, || system.basis.iter()))
                .map(|across| across.direction)
                .collect()
        })
    }
}

impl Forward for FurtherSteps<'_> {
    type State = Vec<f64>;
    type Further = Score;
    type Error = Infallible;

    fn proposals(&mut self, times: &Vec<f64>) -> Proposals<Self> {
        if times.len() >= MOST_STEPS_OF_AN_EVENT {
            return Ok(Vec::new());
        }
        let best = self.instants.best(&self.taken(times, usize::MAX));
        Ok(Proposal::of_best(best, |best| best.score))
    }

    fn rule(&mut self, times: &Vec<f64>, best: Proposal<Score>) -> Ruled<Self> {
        if best.merit <= STEP_SCORE || best.merit <= STEP_SHARE * self.one {
            return Ok(Ruling::Ended);
        }
        let mut times = [times.as_slice(), &[best.further.shape]].concat();
        for _ in 0..SWEEPS {
            let before = times.clone();
            for index in 0..times.len() {
                if let Some(best) = self.instants.best(&self.taken(&times, index)) {
                    times[index] = best.shape;
                }
            }
            if times == before {
                break;
            }
        }
        Ok(Ruling::Taken(times))
    }
}

/// Rows of a run at which a step may be: not within a part of it at its end, nor where it is one with the zero that the base model
/// adjusts. That is the first row of one of several runs; of one run such a part too, and as long as the device rests at first.
fn inside(context: &Context<'_>, run: &Range<usize>) -> Range<usize> {
    let part = run.len().div_ceil(MARGIN);
    let end = run.end - part;
    if context.runs.len() > 1 {
        return run.start + 1..end;
    }
    let columns = &context.recording.joint;
    let moves = |row: &usize| {
        let mut columns = columns.iter();
        columns.any(|column| (column[*row] - column[run.start]).abs() > RESTING_RAD)
    };
    let rest = run.clone().find(moves).unwrap_or(run.start);
    rest + part..end
}

/// Where a step of an event may be: the row from which on it leaves least, and the rows that chance alone may keep apart from it.
pub(crate) struct StepPlace {
    pub(crate) row: usize,
    /// First and last row that leave hardly more.
    pub(crate) rows: [usize; 2],
}

impl StepPlace {
    /// Of one step of a cause, between its others, by the squares that a refit leaves row by row. `misfit` counts as more noise.
    pub(crate) fn new(
        engine: &Engine<'_>,
        effect: &dyn Effect,
        (refit, cause, index): (&Refit, &Cause, usize),
        misfit: f64,
    ) -> Self {
        let context = &engine.context;
        let found = cause.times[index] as usize;
        let run = context.runs.iter().find(|run| run.contains(&found));
        let run = run.cloned().unwrap_or(found..found + 1);
        let Range { mut start, mut end } = inside(context, &run);
        for other in cause.times.iter().map(|time| *time as usize) {
            match other.cmp(&found) {
                Ordering::Less => start = start.max(other + 1),
                Ordering::Greater => end = end.min(other),
                Ordering::Equal => {}
            }
        }
        // what the squares of a row are less without the step than with it
        let mut costs = vec![0.0; end.saturating_sub(start)];
        let whole = effect.signal(context, &[cause.amplitudes[index]], run.start as f64);
        for (stream, step) in &whole.parts {
            let noise = &engine.noise[*stream];
            let variance = (engine.floor[*stream] / noise.ratio).powi(2) * noise.level();
            for row in (start..end).filter(|&row| engine.usable[*stream][row]) {
                let left = refit.residual[*stream][row];
                let without = if row >= found { left + step[row] } else { left };
                let with = without - step[row];
                costs[row - start] += (with.powi(2) - without.powi(2)) / variance.max(1e-300);
            }
        }
        // a step at a row costs the sum from there on
        for row in (1..costs.len()).rev() {
            costs[row - 1] += costs[row];
        }
        let best = (0..costs.len()).reduce(|a, b| if costs[b] < costs[a] { b } else { a });
        let Some(best) = best else {
            return Self {
                row: found,
                rows: [found; 2],
            };
        };
        let least = costs[best] + INSTANT_COST * misfit;
        let near = |row: &usize| costs[*row] <= least;
        let mut rows = (0..costs.len()).filter(near);
        let low = rows.next().unwrap_or(best);
        Self {
            row: start + best,
            rows: [start + low, start + rows.next_back().unwrap_or(low)],
        }
    }
}

impl Selector<'_> {
    /// A refit with each step of its events at the row that leaves least: blocks, by which they are found, leave it open.
    /// Two steps that come to be one are one.
    pub(crate) fn with_steps_at_rows(
        &self,
        mut refit: Refit,
        again: &dyn Fn(&Model) -> Result<Refit>,
    ) -> Result<Refit> {
        for _ in 0..SWEEPS {
            let mut model = refit.model.clone();
            for (moved, cause) in model.causes.iter_mut().zip(&refit.model.causes) {
                let effect = self.effects[cause.effect].as_ref();
                let mut steps: Vec<(f64, f64)> = Vec::new();
                for (index, (_, amplitude)) in cause.times.iter().zip(&cause.amplitudes).enumerate()
                {
                    let place = StepPlace::new(self.engine, effect, (&refit, cause, index), 1.0);
                    let same = |step: &&mut (f64, f64)| {
                        are_one(&self.engine.context, step.0 as usize, place.row)
                    };
                    match steps.iter_mut().find(same) {
                        Some(step) => step.1 += amplitude,
                        None => steps.push((place.row as f64, *amplitude)),
                    }
                }
                if !steps.is_empty() {
                    (moved.times, moved.amplitudes) = steps.into_iter().unzip();
                }
            }
            if model == refit.model {
                break;
            }
            refit = again(&model)?;
        }
        Ok(refit)
    }
}

/// Residual of a system with further directions projected out.
struct Rest {
    further: Vec<Direction>,
    residual: Vec<f64>,
    /// Rows of the other steps.
    steps: Vec<usize>,
}

impl Rest {
    fn new(system: &System) -> Self {
        Self {
            further: Vec::new(),
            residual: system.residual.clone(),
            steps: Vec::new(),
        }
    }

    /// Whether another step is so near that the two would be one, or take each other back.
    fn is_taken(&self, context: &Context<'_>, row: usize) -> bool {
        self.steps.iter().any(|step| are_one(context, row, *step))
    }

    /// Projects out a vector that lies across the system's directions already.
    fn take(&mut self, own: Vec<f64>) {
        if let Some(across) = across(own, ALWAYS, || self.further.iter()) {
            take_off(&mut self.residual, &across.direction);
            self.further.push(Direction::new(across.direction));
        }
    }
}

/// Whether steps at two rows are so near that they would be one, or take each other back.
fn are_one(context: &Context<'_>, a: usize, b: usize) -> bool {
    let time_s = context.recording.time_s.as_ref();
    time_s.map_or(a == b, |time_s| (time_s[a] - time_s[b]).abs() < APART_S)
}
