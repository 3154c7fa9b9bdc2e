//! What is known of the candidates from the recordings so far, and what further ones would add.

use std::borrow::Cow;

use haptical_calibration::{LossChoice, channels};
use haptical_effects::device::attached;
use haptical_effects::{Context, Effect, catalogue};
use haptical_linalg::SparseColumns;
use haptical_model::{Device, Recording};
use rayon::prelude::*;

use super::choose::{Settling, choose};
use super::gram::{Gram, Odds, Places};
use super::hypothesis::Hypothesis;
use super::question::{Candidate, Question};
use crate::DiagnosisError;
use crate::engine::Prepared;
use crate::engine::base::Base;
use crate::engine::blocks::Blocks;
use crate::noise::Noise;
use crate::noise::cleaning::without_readings;
use crate::thresholds::chance::OUTLIER_SD;

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
        let base = Base::fit(&device, &recorded, LossChoice::default())?;
        let prepared = Prepared::new(&base, &recorded, &recorded)?;
        let cleaned = without_readings(&recorded, &prepared.outlying(OUTLIER_SD));
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
        settler.known = settler.gram(context, &blocks, &columns, true);
        for (&column, stiffness) in base.free.iter().zip(base.stiffness()) {
            settler.known.stiffen(column, *stiffness);
        }
        Ok(settler)
    }

    /// What is settled: its candidates are those that the device has.
    pub fn question(&self) -> &Question {
        &self.question
    }

    /// Expected odds of each candidate over each other one once `next` is recorded too. Its readings are those that the base
    /// model predicts; their values do not matter, but which there are.
    ///
    /// # Errors
    /// [`DiagnosisError`] where the device has no value at a row.
    pub fn odds(&self, next: &Recording) -> Result<Vec<Odds>, DiagnosisError> {
        Ok(self.odds_of(&self.known.plus(&self.gram_of(next)?)))
    }

    /// Chooses `count` of `pieces`, each a run of its own, that tell the candidates apart best: greedily, then by exchanges.
    /// Pieces at which the device has no value are passed over.
    ///
    /// # Errors
    /// [`DiagnosisError::NothingToSettle`] where no piece is left.
    pub fn choose(&self, pieces: &[Recording], count: usize) -> Result<Settling, DiagnosisError> {
        let grams: Vec<Option<Gram>> = pieces
            .par_iter()
            .map(|piece| self.gram_of(piece).ok())
            .collect();
        if grams.iter().all(Option::is_none) {
            return Err(DiagnosisError::NothingToSettle {
                why: "the device has no value along any of the motions that could be recorded"
                    .to_owned(),
            });
        }
        let odds_of = |all: &Gram| self.odds_of(all);
        Ok(choose(&self.known, &grams, count, &odds_of))
    }

    /// Odds by the products of all rows, the known ones among them.
    fn odds_of(&self, all: &Gram) -> Vec<Odds> {
        let (so_far, then) = (
            self.known.distances(&self.places),
            all.distances(&self.places),
        );
        let behind = |candidate: usize| self.question.candidates[candidate].nats_behind;
        let pairs = self.places.pairs().zip(so_far.iter().zip(&then));
        pairs
            .map(|((is_true, other), (so_far, then))| {
                let nats_before = behind(other) - behind(is_true);
                Odds {
                    is_true,
                    other,
                    nats_before,
                    nats_after: nats_before + (then - so_far).max(0.0),
                }
            })
            .collect()
    }

    fn gram_of(&self, recording: &Recording) -> Result<Gram, DiagnosisError> {
        let mut device = self.device.clone();
        let recording: Cow<'_, Recording> = attached(&mut device, recording)?;
        let mut prepared = Prepared::new(&self.base, &recording, &recording)?;
        prepared.context.set_reference_degc(self.reference_degc);
        let (blocks, columns) = prepared.whitened(&self.noise);
        Ok(self.gram(&prepared.context, &blocks, &columns, false))
    }

    fn gram(
        &self,
        context: &Context<'_>,
        blocks: &Blocks,
        base: &SparseColumns,
        is_where_found: bool,
    ) -> Gram {
        let mut columns: Vec<Vec<f64>> = (0..base.columns()).map(|k| base.dense(k)).collect();
        columns.resize(self.base.parameters.len(), vec![0.0; blocks.count()]);
        let of = |own: &Hypothesis| own.columns(&self.effects, context, blocks, is_where_found);
        for beside in &self.beside {
            columns.extend(of(beside).slopes);
        }
        for candidate in &self.candidates {
            let own = of(candidate);
            columns.push(own.signal);
            columns.extend(own.slopes);
        }
        Gram::new(&columns)
    }
}
