//! Everything that a diagnosis found, before it is put into words.

use haptical_calibration::Channel;
use haptical_effects::Effect;
use haptical_model::{Device, Recording};

use crate::answer::{
    AbsorbedAnswer, Floor, Shrink, Unseen, floors, model_residual, on_held_back, on_second,
};
use crate::engine::{Base, Engine};
use crate::force::answer::ForceAnswer;
use crate::force::examine;
use crate::judge::{Adequacy, Difference, adequacy, difference, settle, take_absorbed, torque_nm};
use crate::select::{Partial, Rival, Selection, excess};
use crate::thresholds::earlier_model::CONFIRMED_SD;
use crate::{Options, Result};

/// Inputs of a diagnosis in addition to the fitted base model.
#[derive(Clone, Copy)]
pub(crate) struct Inputs<'i> {
    pub(crate) nominal: &'i Device,
    /// Without its outliers.
    pub(crate) recording: &'i Recording,
    /// Readings left out as outliers.
    pub(crate) gone: &'i [(Channel, usize)],
    /// Effects that the base model has already.
    pub(crate) in_base: &'i [usize],
    /// The model identified earlier.
    pub(crate) earlier: Option<&'i Base>,
    pub(crate) options: &'i Options<'i>,
    /// What the torques say, where they are those of a moving arm.
    pub(crate) moving: Option<&'i ForceAnswer>,
}

/// A selection with the judgements on it.
pub(crate) struct Findings<'f> {
    pub(crate) inputs: Inputs<'f>,
    pub(crate) selection: Selection<'f>,
    /// Of each cause, itself first.
    pub(crate) rivals: Vec<Vec<Rival>>,
    pub(crate) adequacy: Adequacy,
    /// Where the causes leave a rest: what unseen rows say for them.
    pub(crate) partial: Option<Partial>,
    /// Residuals of the model identified earlier, per stream and row.
    pub(crate) earlier: Option<Vec<Vec<f64>>>,
    /// Terms of the base model that the earlier model lacks or has wrong.
    pub(crate) base_terms: Difference,
    /// What the earlier model had taken up of the causes.
    pub(crate) absorbed: Option<AbsorbedAnswer>,
    pub(crate) shrink: Shrink,
    /// Noise of the channels, checked against all that is left.
    pub(crate) floors: Vec<Floor>,
    pub(crate) force: ForceAnswer,
}

impl<'f> Findings<'f> {
    /// Judges a selection.
    pub(crate) fn new(mut selection: Selection<'f>, inputs: Inputs<'f>) -> Result<Self> {
        let mut rivals = settle(&mut selection)?;
        let mut adequacy_of = adequacy(&selection)?;
        let engine = selection.engine();
        let mut earlier = None;
        let mut base_terms = Difference::default();
        let mut absorbed = None;
        if let Some(model) = inputs.earlier {
            let residual = model_residual(model, inputs.recording, engine)?;
            let causes = selection.columns_of_causes();
            base_terms = difference(engine, &model.device, &residual, &causes);
            base_terms = base_terms.without(&inputs.options.without);
            earlier = Some(residual);
        }
        let is_open = !adequacy_of.accounts_for_the_gap(&selection)
            && !base_terms.accounts_for(excess(&selection.after).0);
        let mut partial = None;
        if is_open {
            partial = selection.take_cables()?;
            if partial.is_none() {
                partial = selection.take_partial()?;
            }
            if let Some(partial) = &partial {
                rivals.clone_from(&partial.rivals);
                adequacy_of = adequacy(&selection)?;
            }
        }
        if let Some(model) = inputs.earlier {
            absorbed = take_absorbed(&selection, &model.device, &mut base_terms);
        }
        let mut findings = Self {
            adequacy: adequacy_of,
            partial,
            inputs,
            selection,
            rivals,
            earlier,
            base_terms,
            absorbed,
            shrink: Shrink::default(),
            floors: Vec::new(),
            force: ForceAnswer::default(),
        };
        let (shrink, force) = rayon::join(
            || findings.on_unseen_rows(),
            || match inputs.moving {
                Some(moving) => Ok(moving.clone()),
                None => {
                    let (second, without) = (inputs.options.validation, &inputs.options.without);
                    examine(&engine.context, second, without)
                }
            },
        );
        findings.shrink = shrink?;
        findings.force = force?;
        findings.forget_what_no_row_confirms();
        findings.floors = floors(&findings.selection, &findings.shrink.channels);
        for unseen in &mut findings.shrink.channels {
            let mut floors = findings.floors.iter();
            if let Some(floor) = floors.find(|floor| floor.channel == unseen.channel) {
                unseen.correct(floor);
            }
        }
        let has_own_effects = !engine.context.recording.added.is_empty();
        if has_own_effects || !findings.selection.causes().is_empty() || !findings.is_quiet() {
            let wrong_nm = torque_nm(&findings.selection);
            findings.force = findings.force.beside_wrong_angles(wrong_nm);
        }
        Ok(findings)
    }

    /// Takes a difference from the earlier model back that makes nothing better on rows that its fit did not see: it is what
    /// two fits of one device differ by.
    fn forget_what_no_row_confirms(&mut self) {
        let channels = &self.shrink.channels;
        let confirms = |unseen: &Unseen| unseen.gain_sd() > CONFIRMED_SD;
        let is_alone = self.selection.causes().is_empty() && !self.base_terms.terms.is_empty();
        if is_alone && !channels.is_empty() && !channels.iter().any(confirms) {
            self.base_terms = Difference::default();
        }
    }

    fn on_unseen_rows(&self) -> Result<Shrink> {
        let selection = &self.selection;
        match self.inputs.options.validation {
            Some(second) => on_second(selection, second, self.inputs.earlier),
            None if selection.causes().is_empty() && self.base_terms.terms.is_empty() => {
                Ok(Shrink::default())
            }
            None => on_held_back(selection, self.inputs.recording, self.earlier.as_deref()),
        }
    }

    pub(crate) fn engine(&self) -> &'f Engine<'f> {
        self.selection.engine()
    }

    /// Residuals without the causes: of the earlier model where there is one, else of the base model.
    pub(crate) fn before(&self) -> &[Vec<f64>] {
        let of_base = &self.engine().start.residual;
        self.earlier.as_ref().unwrap_or(of_base)
    }

    pub(crate) fn first(&self) -> Option<&'f dyn Effect> {
        let first = self.selection.causes().first();
        first.map(|cause| self.selection.effect(cause))
    }

    /// Whether positions show nothing but noise, no cause taken up.
    pub(crate) fn is_quiet(&self) -> bool {
        self.adequacy.is_noise() && self.selection.refused.is_none()
    }
}
