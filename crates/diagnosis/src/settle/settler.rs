//! What is known of the candidates from the recordings so far, and what further ones would add.

use std::borrow::Cow;

use haptical_calibration::{LossChoice, channels};
use haptical_effects::device::attached;
use haptical_effects::{Context, Effect, Family, catalogue};
use haptical_identification::Interrupt;
use haptical_linalg::SparseColumns;
use haptical_model::{Device, Recording};

use super::choose::choose;
use super::gram::{Gram, Odds, Places};
use super::hedge::{Courses, Judged, Warming, windows};
use super::hypothesis::Hypothesis;
use super::question::{Candidate, Question};
use crate::engine::{Base, Blocks, Prepared};
use crate::noise::{Noise, without_readings};
use crate::{DiagnosisError, Result};

/// The candidates of a diagnosis on the recording that it was made from.
#[derive(Debug)]
pub struct Settler {
    question: Question,
    device: Device,
    base: Base,
    noise: Vec<Noise>,
    effects: Vec<Box<dyn Effect>>,
    candidates: Vec<Hypothesis>,
    beside: Vec<Hypothesis>,
    places: Places,
    reference_degc: f64,
    /// Of the recording so far.
    known: Gram,
    courses: Courses,
    /// Of each candidate, whether its look-alikes can be tested with these sensors.
    is_tried: Vec<bool>,
}

impl Settler {
    /// Fits the base model to the recording that the question came from, and places the candidates in it. Candidates that
    /// the device has no effect for are left out.
    ///
    /// # Errors
    /// [`DiagnosisError`] where the base model cannot be fitted; [`DiagnosisError::NothingToSettle`] where fewer than two
    /// candidates are left, or the log has touches or torques alone, whose next recording is not planned.
    pub fn new(
        device: &Device,
        recorded: &Recording,
        question: &Question,
    ) -> Result<Self, DiagnosisError> {
        let refuse = |why: &str| {
            Err(DiagnosisError::NothingToSettle {
                why: why.to_owned(),
            })
        };
        if recorded.contact.is_some() || recorded.plane.is_some() {
            return refuse(
                "the log has touched points or planes, of which no further recording is planned",
            );
        }
        let mut device = device.clone();
        let recorded = attached(&mut device, recorded)?;
        if channels(&device, &recorded)?.is_empty() {
            return refuse(
                "the log has joints and torques alone, of which no further recording is planned",
            );
        }
        let base = Base::fit(
            &device,
            &recorded,
            LossChoice::default(),
            &Interrupt::default(),
        )?;
        let prepared = Prepared::new(&base, &recorded, &recorded)?;
        let cleaned = without_readings(&recorded, &prepared.outlying());
        let prepared = Prepared::new(&base, &cleaned, &cleaned)?;
        let engine = Prepared::new(&base, &cleaned, &cleaned)?.fit(None)?;
        let effects = catalogue(&device);
        let context = &prepared.context;
        let of = |candidate: &Candidate| Hypothesis::new(&effects, candidate, context);
        let mut question = question.clone();
        let (mut candidates, mut named) = (Vec::new(), Vec::new());
        for candidate in &question.candidates {
            if let Some(hypothesis) = of(candidate) {
                candidates.push(hypothesis);
                named.push(candidate.clone());
            }
        }
        question.candidates = named;
        if candidates.len() < 2 {
            return refuse(
                "fewer than two of its candidates are effects of this device with a size",
            );
        }
        let beside: Vec<Hypothesis> = question.beside.iter().filter_map(of).collect();
        let slopes = |all: &[Hypothesis]| -> Vec<usize> {
            all.iter().map(|own| own.slopes(&effects)).collect()
        };
        let places = Places {
            common: base.parameters.len() + slopes(&beside).iter().sum::<usize>(),
            slopes: slopes(&candidates),
        };
        let (blocks, columns) = prepared.whitened(&engine.noise);
        let mut settler = Self {
            is_tried: (candidates.iter())
                .map(|own| own.are_look_alikes_tried(&effects, context))
                .collect(),
            courses: Courses::of(context),
            places,
            noise: engine.noise.clone(),
            reference_degc: context.reference_degc,
            known: Gram::zero(0),
            device: device.clone(),
            base: base.clone(),
            effects,
            candidates,
            beside,
            question,
        };
        let (all, _) = settler.columns(context, &blocks, &columns, true);
        settler.known = Gram::new(&all, windows(context));
        for (&column, stiffness) in base.free.iter().zip(base.stiffness()) {
            settler.known.stiffen(column, *stiffness);
        }
        Ok(settler)
    }

    /// What is settled: its candidates are those that the device has.
    pub fn question(&self) -> &Question {
        &self.question
    }

    /// Whether a candidate is a drift: the course of one is known the worse, the longer it goes on.
    pub fn has_drift(&self) -> bool {
        self.has(Family::Drift)
    }

    fn has(&self, family: Family) -> bool {
        let mut own = self.candidates.iter();
        own.any(|own| own.effect(&self.effects).spec().family == family)
    }

    /// Expected odds of each candidate over each other one once `next` is recorded too. Its readings are those that the base
    /// model predicts; their values do not matter, but which there are.
    ///
    /// # Errors
    /// [`DiagnosisError`] where the device has no value at a row.
    pub fn odds(&self, next: &Recording) -> Result<Vec<Odds>, DiagnosisError> {
        let next = self.shown_by(next)?;
        let mut courses = self.courses.clone();
        courses.extend(&next.courses);
        Ok(self.odds_of(&self.known.plus(&next.gram), Some(courses.warming())))
    }

    /// What pieces to choose from would show, each as a run of its own. Those at which the device has no value are passed over.
    ///
    /// # Errors
    /// [`DiagnosisError::NothingToSettle`] where no piece is left.
    pub fn pieces(&self, pieces: &[Recording]) -> Result<Pieces, DiagnosisError> {
        let shown: Vec<Option<Shown>> =
            haptical_parallel::map(pieces, |piece| self.shown_by(piece).ok());
        if shown.iter().all(Option::is_none) {
            return Err(DiagnosisError::NothingToSettle {
                why: "the device has no value along any of the motions that could be recorded"
                    .to_owned(),
            });
        }
        let (mut all, mut courses) = (self.known.clone(), self.courses.clone());
        for piece in shown.iter().flatten() {
            all.add(&piece.gram);
            courses.extend(&piece.courses);
        }
        let lasting = |candidate: usize| {
            let of =
                |piece: &Option<Shown>| piece.as_ref().map_or(0.0, |own| own.lasting[candidate]);
            shown.iter().map(of).collect()
        };
        Ok(Pieces {
            of_all: self.odds_of(&all, Some(courses.warming())),
            lasting: (0..self.candidates.len()).map(lasting).collect(),
            grams: (shown.into_iter())
                .map(|piece| piece.map(|piece| piece.gram))
                .collect(),
        })
    }

    /// Chooses `count` of the pieces that tell the candidates apart best: greedily, then by exchanges. A piece may come again.
    pub fn choose(&self, pieces: &Pieces, count: usize) -> Vec<usize> {
        let odds_of = |all: &Gram| self.odds_of(all, None);
        choose(&self.known, &pieces.grams, count, &odds_of)
    }

    /// Odds by the products of all rows, the known ones among them; hedged as the judge does where the course of the
    /// temperature is given.
    fn odds_of(&self, all: &Gram, warming: Option<Warming>) -> Vec<Odds> {
        let (so_far, then) = (self.known.told(&self.places), all.told(&self.places));
        let behind = |candidate: usize| self.question.candidates[candidate].nats_behind;
        let judged: Vec<Judged<'_>> = (self.candidates.iter().zip(&self.is_tried))
            .map(|(own, is_tried)| own.judged(&self.effects, *is_tried))
            .collect();
        let pairs = self.places.pairs().zip(so_far.iter().zip(&then));
        pairs
            .map(|((is_true, other), (so_far, then))| {
                let nats_before = behind(other) - behind(is_true);
                // what its law gets wrong counts as noise
                let wrong = 2.0 * judged[is_true].effect.spec().law_error.share * then.whole;
                let misfit = 1.0 + wrong / all.windows.max(1.0);
                let gained = (then.distance - so_far.distance).max(0.0) / misfit;
                let nats_after = nats_before + gained;
                Odds {
                    is_true,
                    other,
                    nats_before,
                    nats_after: warming.map_or(nats_after, |warming| {
                        judged[is_true].nats(&judged[other], nats_after, *then, warming)
                    }),
                }
            })
            .collect()
    }

    fn shown_by(&self, recording: &Recording) -> Result<Shown> {
        let mut device = self.device.clone();
        let recording: Cow<'_, Recording> = attached(&mut device, recording)?;
        let mut prepared = Prepared::new(&self.base, &recording, &recording)?;
        prepared.context.set_reference_degc(self.reference_degc);
        let (blocks, columns) = prepared.whitened(&self.noise);
        let context = &prepared.context;
        let (mut all, lasting) = self.columns(context, &blocks, &columns, false);
        // a play, or a loop, stands somewhere when a recording begins
        if self.has(Family::Loop) {
            without_constants(&mut all, context, &blocks);
        }
        Ok(Shown {
            gram: Gram::new(&all, windows(context)),
            lasting,
            courses: Courses::of(context),
        })
    }

    /// The base model's columns and those of all candidates, and what each candidate leaves behind at the end.
    fn columns(
        &self,
        context: &Context<'_>,
        blocks: &Blocks,
        base: &SparseColumns,
        is_where_found: bool,
    ) -> (Vec<Vec<f64>>, Vec<f64>) {
        let mut columns: Vec<Vec<f64>> = (0..base.columns()).map(|k| base.dense(k)).collect();
        columns.resize(self.base.parameters.len(), vec![0.0; blocks.count()]);
        let of = |own: &Hypothesis| own.columns(&self.effects, context, blocks, is_where_found);
        for beside in &self.beside {
            columns.extend(of(beside).slopes);
        }
        let mut lasting = Vec::with_capacity(self.candidates.len());
        for candidate in &self.candidates {
            let own = of(candidate);
            columns.push(own.signal);
            columns.extend(own.slopes);
            lasting.push(own.lasting);
        }
        (columns, lasting)
    }
}

/// What pieces of motion to choose from would show.
#[derive(Debug)]
pub struct Pieces {
    /// Odds once all pieces are recorded, for every ordered pair of candidates.
    pub of_all: Vec<Odds>,
    /// What each candidate leaves behind at the end of each piece, candidate by candidate: drifts do.
    pub lasting: Vec<Vec<f64>>,
    grams: Vec<Option<Gram>>,
}

/// A further recording, or a piece of one.
struct Shown {
    gram: Gram,
    /// What each candidate leaves behind at its end.
    lasting: Vec<f64>,
    courses: Courses,
}

/// Takes what is constant in a stream off every column: where a play stands, or a loop, before it is first turned round is not
/// known, so a recording at rest tells nothing of it.
fn without_constants(columns: &mut [Vec<f64>], context: &Context<'_>, blocks: &Blocks) {
    for stream in 0..context.streams.len() {
        let constant = blocks.compress(stream, |_| 1.0);
        let square: f64 = constant.iter().map(|one| one * one).sum();
        if square <= 0.0 {
            continue;
        }
        let range = blocks.range(stream);
        for column in columns.iter_mut() {
            let own = &mut column[range.clone()];
            let along: f64 = own.iter().zip(&constant).map(|(a, b)| a * b).sum();
            for (value, one) in own.iter_mut().zip(&constant) {
                *value -= along / square * one;
            }
        }
    }
}
