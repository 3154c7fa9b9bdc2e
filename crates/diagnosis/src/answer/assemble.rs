//! Puts the answer together from a selection.

use haptical_calibration::{Channel, implausible_deviations};
use haptical_effects::{Parameter, Stream};
use haptical_model::{Device, Recording};

use crate::answer::advice::{next_experiment, of_tool};
use crate::answer::causes::{base_term, cause_answer, force_findings, noise_findings};
use crate::answer::place::{Located, locate};
use crate::answer::place_touched::{by_dependence, of_base_term};
use crate::answer::shrink::{Shrink, model_residual, on_held_back, on_second};
use crate::answer::tables::{channel_gaps, noise, shared, traces, untestable};
use crate::answer::unseen::{hints, unseen};
use crate::answer::{
    CandidateAnswer, CauseAnswer, Diagnosis, Gap, HeldOutAnswer, NoiseAnswer, Place, Provenance,
    Verdict,
};
use crate::engine::Engine;
use crate::engine::base::Base;
use crate::force::answer::ForceAnswer;
use crate::judge::adequacy::{Adequacy, adequacy};
use crate::judge::earlier::{Difference, difference};
use crate::judge::rivals::{Rival, settle};
use crate::judge::touched::Touched;
use crate::judge::unlisted::hedged;
use crate::judge::wrong_angles::torque_nm;
use crate::select::{Selection, Selector, excess};
use crate::thresholds::chance::{
    FAMILY_WISE_P, MOST_NAMES, NAMED_PROBABILITY, OMNIBUS_Z, OUTLIER_SD,
};
use crate::thresholds::rivals::LATER_PROBABILITY;
use crate::{DiagnosisError, Options};

/// What the answer is put together from.
#[derive(Clone, Copy)]
pub(crate) struct Inputs<'i> {
    pub(crate) nominal: &'i Device,
    pub(crate) recording: &'i Recording,
    /// Readings left out as outliers.
    pub(crate) gone: &'i [(Channel, usize)],
    /// Effects that the base model has already.
    pub(crate) in_base: &'i [usize],
    /// The model identified earlier.
    pub(crate) earlier: Option<&'i Base>,
    pub(crate) options: &'i Options<'i>,
}

pub(crate) fn assemble(
    selector: &mut Selector<'_, '_>,
    selection: &mut Selection,
    inputs: &Inputs<'_>,
) -> Result<Diagnosis, DiagnosisError> {
    let rivals = settle(selector, selection)?;
    let (selector, selection) = (&*selector, &*selection);
    let engine = selector.engine;
    let adequacy = adequacy(selector, selection)?;
    let Against {
        residual: earlier_residual,
        difference: base_terms,
    } = against_earlier(engine, inputs)?;
    let (shrink, force) = beside_each_other(
        selector,
        selection,
        inputs,
        &adequacy,
        &base_terms,
        earlier_residual.as_deref(),
    )?;
    let mut causes = position_causes(
        selector,
        selection,
        &rivals,
        &adequacy,
        &base_terms,
        &shrink,
    );
    let mut verdict = verdict(selection, &adequacy, &causes, &base_terms);
    let touches = Touched::new(selector, verdict)?;
    if selection.refit.model.causes.is_empty() {
        let is_quiet = adequacy.worst < OMNIBUS_Z;
        let p = FAMILY_WISE_P;
        verdict = touches.verdict(verdict, is_quiet, !causes.is_empty(), p);
    }
    verdict = hedged(
        selector,
        selection,
        &rivals,
        (verdict, adequacy.probability_unknown(verdict)),
        &base_terms,
        &mut causes,
    );
    let on_forces = force_findings(&force);
    let in_positions = verdict != Verdict::NoGap;
    verdict = with_forces(verdict, on_forces.first(), &force);
    causes.extend(on_forces);
    let unstated = touches.unstated.clone();
    let located = located(
        selector,
        selection,
        (verdict, adequacy.is_adequate),
        touches,
        &base_terms,
    )
    .filter(|_| in_positions);
    let noise = noise(selector, inputs.gone);
    let streams = engine.context.streams.iter();
    let joints: Vec<Option<usize>> = streams.map(Stream::joint).collect();
    if causes.is_empty() {
        causes = on_the_data(&noise, &joints, &inputs.options.without);
    }
    let before = earlier_residual.as_ref().unwrap_or(&engine.start.residual);
    let (detectable, invisible) = unseen(selector, inputs.in_base);
    let next_step = match base_terms.is_tool() {
        true => Some(of_tool()),
        false => next_step(selector, selection, verdict, &causes, located.as_ref()),
    };
    let fitted = engine.problem.device_with(&engine.start.model.values);
    let mut warnings = warnings(&shrink, &causes, unstated);
    warnings.extend(of_torques(&force, verdict));
    warnings.extend(far_from_nominal(engine, inputs.nominal, &fitted));
    Ok(Diagnosis {
        verdict,
        gap: Gap {
            channels: shared(channel_gaps(selector, selection, before, &shrink), &force),
        },
        next_experiment: next_step,
        traces: traces(selector, selection, before, located.as_ref()),
        place: match located {
            Some(located) => Some(located.answer),
            None => in_torques(&force).filter(|_| verdict != Verdict::NoGap),
        },
        unexplained_share: match in_positions {
            true => unexplained_share(engine, verdict, &adequacy, causes.is_empty()),
            false => force.unexplained_share,
        },
        probability_unknown: adequacy.probability_unknown(verdict),
        causes,
        untestable: untestable(selector, &force.untestable),
        invisible,
        detectable,
        noise,
        candidates: rivals
            .first()
            .map(|list| candidates(list))
            .unwrap_or_default(),
        plausibility: hints(engine, inputs.nominal),
        warnings,
        held_out: shrink.description,
        provenance: provenance(selector, inputs),
        device: fitted,
        predictions: shrink.predictions,
    })
}

/// What to record next, by the first cause.
fn next_step(
    selector: &Selector<'_, '_>,
    selection: &Selection,
    verdict: Verdict,
    causes: &[CauseAnswer],
    located: Option<&Located>,
) -> Option<String> {
    let first = selection.refit.model.causes.first();
    let effect = first.map(|cause| selector.effects[cause.effect].as_ref());
    let confused = causes.first().map(|cause| cause.confusable_with.as_slice());
    next_experiment(verdict, effect, confused.unwrap_or_default(), located)
}

/// Where a gap lies.
fn located(
    selector: &Selector<'_, '_>,
    selection: &Selection,
    (verdict, is_adequate): (Verdict, bool),
    touches: Touched,
    base_terms: &Difference,
) -> Option<Located> {
    let engine = selector.engine;
    match verdict {
        Verdict::NoGap => None,
        Verdict::Unknown if touches.says_where() => {
            by_dependence(&engine.context, selection, touches.dependence)
        }
        Verdict::Unknown => locate(selector, selection, is_adequate)
            .map(|located| located.with_dependence(touches.dependence)),
        Verdict::Named | Verdict::Ambiguous => match base_terms.terms.first() {
            Some(term) => of_base_term(engine, term),
            None => locate(selector, selection, is_adequate),
        },
    }
}

/// Findings on the data but those left out on request. Next to a gap none is told: what its effect leaves in fast
/// motion would pass for noise.
fn on_the_data(
    noise: &[NoiseAnswer],
    joints: &[Option<usize>],
    without: &[String],
) -> Vec<CauseAnswer> {
    let mut findings = noise_findings(noise, joints);
    findings.retain(|finding| !without.contains(&finding.effect));
    findings
}

fn unexplained_share(
    engine: &Engine<'_>,
    verdict: Verdict,
    adequacy: &Adequacy,
    no_cause: bool,
) -> f64 {
    match verdict {
        Verdict::NoGap => 0.0,
        // of touches whose noise is what is left, the excess over noise says nothing
        Verdict::Unknown if engine.is_noise_unknown() && no_cause => 1.0,
        _ => adequacy.unexplained,
    }
}

fn warnings(shrink: &Shrink, causes: &[CauseAnswer], unstated: Option<String>) -> Vec<String> {
    let mut warnings = shrink.warnings.clone();
    warnings.extend(implausible(causes));
    warnings.extend(unstated);
    warnings
}

/// A warning where the base model's numbers are no sound device's.
fn far_from_nominal(engine: &Engine<'_>, nominal: &Device, fitted: &Device) -> Option<String> {
    let (parameters, free) = (&engine.base.parameters, &engine.base.free);
    implausible_deviations(nominal, fitted, parameters, free)
}

/// The recording against a model identified earlier, where there is one.
#[derive(Default)]
struct Against {
    /// Per stream and row.
    residual: Option<Vec<Vec<f64>>>,
    difference: Difference,
}

fn against_earlier(engine: &Engine<'_>, inputs: &Inputs<'_>) -> Result<Against, DiagnosisError> {
    let Some(model) = inputs.earlier else {
        return Ok(Against::default());
    };
    let residual = model_residual(model, inputs.recording, engine)?;
    Ok(Against {
        difference: difference(engine, &model.device, &residual).without(&inputs.options.without),
        residual: Some(residual),
    })
}

/// Where positions show no gap, the torques decide: by their first finding, or by a gap without one.
fn with_forces(verdict: Verdict, first: Option<&CauseAnswer>, force: &ForceAnswer) -> Verdict {
    let named = NAMED_PROBABILITY;
    match (verdict, first) {
        (Verdict::NoGap, Some(first)) if first.probability >= named => Verdict::Named,
        (Verdict::NoGap, Some(_)) => Verdict::Ambiguous,
        (Verdict::NoGap, None) if force.unexplained().is_some() => Verdict::Unknown,
        (verdict, _) => verdict,
    }
}

/// The torque that shows most of the torques' gap.
fn in_torques(force: &ForceAnswer) -> Option<Place> {
    let largest = force.largest()?;
    let joint = largest.joint + 1;
    Some(Place {
        channel: format!("torque{joint}"),
        joint: Some(joint),
        depends_on: Vec::new(),
        region: format!("in the torque of joint {joint}: positions show no gap"),
        explained: Vec::new(),
        dependence: Vec::new(),
    })
}

/// A warning where the torques show a gap that the verdict does not speak of, or were not tested.
fn of_torques(force: &ForceAnswer, verdict: Verdict) -> Option<String> {
    if let Some(why) = &force.not_tested {
        return Some(format!("the torques were not tested: {why}"));
    }
    let gap = force.unexplained()?;
    (matches!(verdict, Verdict::Named | Verdict::Ambiguous)).then(|| {
        format!(
            "the torque of joint {} shows a gap that no cause explains: {:.3} N m, noise {:.3} N m",
            gap.joint + 1,
            gap.rms_before,
            gap.noise_floor
        )
    })
}

/// What unseen rows and what forces show.
fn beside_each_other(
    selector: &Selector<'_, '_>,
    selection: &Selection,
    inputs: &Inputs<'_>,
    adequacy: &Adequacy,
    base_terms: &Difference,
    earlier: Option<&[Vec<f64>]>,
) -> Result<(Shrink, ForceAnswer), DiagnosisError> {
    let engine = selector.engine;
    let (shrink, force) = rayon::join(
        || shrink(selector, selection, inputs, base_terms, earlier),
        || crate::force::examine(&engine.context, &inputs.options.without),
    );
    let mut force = force?;
    if !selection.refit.model.causes.is_empty() || !quiet(selection, adequacy) {
        force = force.beside_wrong_angles(torque_nm(selector, selection));
    }
    Ok((shrink?, force))
}

fn provenance(selector: &Selector<'_, '_>, inputs: &Inputs<'_>) -> Provenance {
    let engine = selector.engine;
    Provenance {
        rows: inputs.recording.len(),
        base_parameters: engine.base.parameters.len(),
        base_identifiable: engine.base.free.len(),
        tested: selector.tested.len(),
        thresholds: crate::thresholds::VERSION.to_owned(),
        last_step: engine.start.last_step,
        without: inputs.options.without.clone(),
    }
}

/// Whether a later cause is more than what an earlier one's law gets wrong: its class is likely and
/// small, and its size is not zero.
fn is_reported(cause: &CauseAnswer) -> bool {
    let is_size = |name: &str| is_size(&cause.effect, name);
    let sizes = cause.parameters.iter().filter(|(name, _)| is_size(name));
    cause.class_probability >= LATER_PROBABILITY
        && cause.confusable_with.len() < MOST_NAMES
        && sizes
            .into_iter()
            .all(|(_, size)| size.ci95[0] * size.ci95[1] > 0.0)
}

/// Whether a parameter is a size, not a place of it.
fn is_size(effect: &str, name: &str) -> bool {
    haptical_effects::parameter(effect, name).is_none_or(Parameter::is_size)
}

/// The causes that positions show, strongest first.
fn position_causes(
    selector: &Selector<'_, '_>,
    selection: &Selection,
    rivals: &[Vec<Rival>],
    adequacy: &Adequacy,
    base_terms: &Difference,
    shrink: &Shrink,
) -> Vec<CauseAnswer> {
    let total: f64 = selection.explained.iter().sum::<f64>() + base_terms.total;
    let mut causes: Vec<CauseAnswer> = base_terms
        .terms
        .iter()
        .map(|term| base_term(term, total, shrink))
        .collect();
    for (index, list) in rivals.iter().enumerate() {
        let answer = cause_answer(selector, selection, index, list, adequacy, total, shrink);
        if causes.is_empty() || is_reported(&answer) {
            causes.push(answer);
        }
    }
    if !base_terms.terms.is_empty() {
        causes.sort_by(|a, b| b.share.total_cmp(&a.share));
    }
    causes
}

fn shrink(
    selector: &Selector<'_, '_>,
    selection: &Selection,
    inputs: &Inputs<'_>,
    base_terms: &Difference,
    earlier_residual: Option<&[Vec<f64>]>,
) -> Result<Shrink, DiagnosisError> {
    match inputs.options.validation {
        Some(second) => on_second(selector, selection, second, OUTLIER_SD, inputs.earlier),
        None if selection.refit.model.causes.is_empty() && base_terms.terms.is_empty() => {
            Ok(Shrink::default())
        }
        None => on_held_back(selector, selection, inputs.recording, earlier_residual),
    }
}

/// Whether positions show nothing but noise, no cause taken up.
fn quiet(selection: &Selection, adequacy: &Adequacy) -> bool {
    adequacy.worst < OMNIBUS_Z && selection.refused.is_none()
}

fn verdict(
    selection: &Selection,
    adequacy: &Adequacy,
    causes: &[CauseAnswer],
    base_terms: &Difference,
) -> Verdict {
    let is_sure = |cause: &CauseAnswer| cause.probability >= NAMED_PROBABILITY;
    // beside a tool that was changed the rest may be as small as the tool's own law gets wrong
    if base_terms.accounts_for(excess(&selection.after).0) {
        return match causes.first().is_some_and(is_sure) {
            true => Verdict::Named,
            false => Verdict::Ambiguous,
        };
    }
    let found = !selection.refit.model.causes.is_empty();
    if !found {
        return match (quiet(selection, adequacy), causes.is_empty()) {
            (true, true) if !base_terms.is_unnamed => Verdict::NoGap,
            (true, false) => Verdict::Named,
            (false, _) | (true, true) => Verdict::Unknown,
        };
    }
    let hedged = causes
        .first()
        .is_some_and(|cause| cause.confusable_with.len() >= MOST_NAMES);
    let is_void = base_terms.terms.is_empty() && !causes.first().is_some_and(stands);
    if !adequacy.is_adequate || hedged || is_void {
        return Verdict::Unknown;
    }
    if causes.first().is_some_and(is_sure) {
        Verdict::Named
    } else {
        Verdict::Ambiguous
    }
}

/// Whether a cause has a size, and does not make predictions of what the fit did not see worse.
fn stands(cause: &CauseAnswer) -> bool {
    let mut sizes = cause
        .parameters
        .iter()
        .filter(|(name, _)| is_size(&cause.effect, name))
        .peekable();
    let has_size =
        sizes.peek().is_none() || sizes.any(|(_, size)| size.ci95[0] * size.ci95[1] > 0.0);
    let is_worse =
        |held_out: &HeldOutAnswer| held_out.reduction_ci95.is_some_and(|ci95| ci95[1] <= 0.0);
    has_size && !cause.held_out.as_ref().is_some_and(is_worse)
}

fn implausible(causes: &[CauseAnswer]) -> Vec<String> {
    causes
        .iter()
        .filter(|cause| !cause.plausible)
        .map(|cause| {
            format!(
                "{} at {} has a size that no sound device shows: check the units and signs of the log, or look for \
                 damage",
                cause.effect,
                cause.joint.map_or("the device".to_owned(), |joint| format!("joint {joint}"))
            )
        })
        .collect()
}

fn candidates(rivals: &[Rival]) -> Vec<CandidateAnswer> {
    rivals
        .iter()
        .take(8)
        .map(|rival| CandidateAnswer {
            effect: rival.name.to_owned(),
            joint: rival.joint.map(|joint| joint + 1),
            share: rival.share,
            nats_behind: rival.nats_behind,
            probability: rival.probability,
        })
        .collect()
}
