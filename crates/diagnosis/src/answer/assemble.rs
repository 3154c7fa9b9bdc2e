//! The answer, part by part, from what was found.

use haptical_calibration::implausible_deviations;
use haptical_effects::{Ahead, Stream};
use haptical_judge::Admission;
use haptical_model::Device;

use crate::Result;
use crate::admission;
use crate::answer::{
    CandidateAnswer, CauseAnswer, Corrected, Correction, Diagnosis, FitRows, Gap, Located,
    NoiseAnswer, Outcome, Place, Provenance, TORQUES_NOT_TESTED, Verdict, Whiteness, by_dependence,
    candidates, channels, corrected, correction, hints, locate, next_experiment, noise,
    noise_findings, not_in_file, of_base_term, position_causes, steps, traces, unseen, untestable,
};
use crate::joined::energy;
use crate::judge::{
    Findings, Tested, Touched, WEIGH, contradicted, doubt_of_loads, hedge, on_second, verdict,
    why_not,
};
use crate::moving::leaves_of_second;
use crate::noise::{NoiseSource, is_stated};
use crate::select::split;
use crate::thresholds::noise::LOUD;
use crate::thresholds::servo::ALL_CLOSED;
use crate::torques_alone::OfTorques;

/// What positions show.
struct InPositions {
    verdict: Verdict,
    causes: Vec<CauseAnswer>,
    /// Why a load may be untold.
    untold: Option<String>,
    touches: Touched,
    tested: Tested,
}

impl InPositions {
    fn new(findings: &Findings<'_>) -> Result<Self> {
        let engine = findings.engine();
        let mut causes = position_causes(findings);
        let untold = doubt_of_loads(findings, &mut causes)?;
        let by_causes = verdict(findings, &causes);
        let touches = Touched::new(engine, by_causes)?;
        let mut verdict = touches.verdict(findings, by_causes, !causes.is_empty());
        let mut tested = Tested::default();
        if verdict == Verdict::NoGap && causes.is_empty() {
            tested = Tested::new(engine)?;
        }
        if tested.is_structured() {
            verdict = Verdict::Unknown;
        }
        hedge(findings, verdict, &mut causes);
        name_twins(findings, &mut causes);
        Ok(Self {
            verdict,
            causes,
            untold,
            touches,
            tested,
        })
    }

    /// Where their gap is.
    fn located(&self, findings: &Findings<'_>) -> Option<Located> {
        match self.tested.is_structured() {
            true => self.tested.located(&findings.selection),
            false => located(findings, self.verdict, &self.touches),
        }
    }

    /// Share of the gap that the causes leave; `has_cause`: whether there is any.
    fn unexplained(&self, findings: &Findings<'_>, has_cause: bool) -> f64 {
        // of touches whose noise is what is left, the excess over noise says nothing
        let says_nothing = !has_cause && findings.engine().is_noise_unknown();
        match self.verdict {
            Verdict::Unknown if self.tested.is_structured() || says_nothing => 1.0,
            _ => findings.adequacy.unexplained,
        }
    }
}

/// Puts what was found into words.
pub(crate) fn answer(findings: Findings<'_>) -> Result<Diagnosis> {
    let engine = findings.engine();
    let mut in_positions = InPositions::new(&findings)?;
    let torques = OfTorques::new(&findings.force, findings.inputs.moving.is_some());
    // the torques have the word where they say more of causes, as between other views of a log
    let is_by_positions = in_positions.verdict != Verdict::NoGap
        && (in_positions.verdict.has_causes() || !torques.verdict.has_causes());
    let verdict = match is_by_positions {
        true => in_positions.verdict,
        false => torques.verdict,
    };
    let of_positions = in_positions.located(&findings);
    let (located, without_name) = match is_by_positions {
        true => (of_positions, None),
        false => (None, of_positions),
    };
    let mut causes = std::mem::take(&mut in_positions.causes);
    let mut candidates = candidates(&findings);
    if !is_by_positions && in_positions.verdict == Verdict::Unknown {
        let unnamed = causes.drain(..);
        candidates.extend(unnamed.map(|own| CandidateAnswer::of_cause(&own, None)));
    }
    candidates.extend(torques.candidates);
    causes.extend(torques.causes);
    let of_second = on_second(&findings, verdict)?;
    let second = findings.inputs.options.validation;
    let curve = correction(&findings.selection, verdict, located.as_ref(), second)?;
    let (kept, refused) = curve.map_or((None, None), Outcome::apart);
    let noise = noise(&findings);
    if causes.is_empty() {
        causes = on_the_data(&findings, &noise);
    }
    let (detectable, invisible) = unseen(&findings);
    let of_torques = (torques.place).map(|own| in_torques(own, in_positions.verdict));
    let of_positions = located.as_ref().map(|own| own.answer.clone());
    let place = of_positions.or(of_torques);
    let located_in = place.as_ref().map(|place| place.channel.as_str());
    let (file, left) = file_of(&findings, verdict, &causes, kept.as_ref())?;
    let gap = Gap::new(verdict, located_in, channels(&findings, &left));
    gap.agree_with(&mut causes);
    let unexplained_share = match is_by_positions {
        true => in_positions.unexplained(&findings, !causes.is_empty()),
        false => {
            let of_torques = energy(&findings.force.channels);
            unexplained(&gap, (of_torques, torques.unexplained_share))
        }
    };
    let untold = in_positions.untold;
    let unsure = [untold.clone(), in_positions.touches.unstated.take()];
    let mut said = warnings(&findings, verdict, &causes, unsure);
    let closed_share = match &without_name {
        Some(_) => Some(1.0 - unexplained_share).filter(|closed| *closed < ALL_CLOSED),
        None => closed_unseen_share(&findings, is_by_positions, verdict),
    };
    said.extend(without_name.map(|own| unexplained_place(&own.answer, &gap)));
    Ok(Diagnosis {
        admission: admission_of(&findings, verdict, &gap),
        adjusted: findings.force.adjusted.clone(),
        own_model: findings.force.own_model.clone(),
        bodies: findings.force.bodies.clone(),
        verdict,
        gap,
        next_experiment: (untold.map(|_| WEIGH.to_owned()))
            .or_else(|| next_experiment(&findings, verdict, &causes, located.as_ref())),
        traces: traces(&findings, located.as_ref())?,
        unexplained_share,
        closed_unseen_share: closed_share,
        own_effects_leave: None,
        silent: findings.force.silent.clone(),
        second: of_second,
        probability_unknown: findings.adequacy.probability_unknown(verdict),
        untestable: untestable(&findings),
        invisible,
        detectable,
        noise,
        whiteness: in_positions.tested.answer,
        candidates,
        absorbed: (findings.absorbed.clone()).filter(|_| verdict.has_causes()),
        plausibility: hints(engine, findings.inputs.nominal),
        warnings: [said, torques.warnings].concat(),
        place,
        provenance: provenance(&findings),
        device: engine.problem.device_with(&engine.start.model.values),
        not_in_file: not_in_file(
            verdict,
            &causes,
            (&engine.base.device, file.as_ref().map(|file| &file.device)),
            (&findings.force.changes, findings.inputs.moving.is_some()),
        ),
        corrected: file.map(|file| file.device),
        fit_rows: fit_rows(&findings),
        correction: kept.map(|correction| correction.answer),
        correction_refused: refused,
        causes,
        split_row: split_of(&findings, verdict)?,
        steps: steps(&findings.selection),
        held_out: match is_by_positions || torques.held_out.is_empty() {
            true => findings.shrink.description,
            false => torques.held_out,
        },
        predictions: [findings.shrink.predictions, torques.predictions].concat(),
    })
}

/// What admits the verdict, by positions and by the torques of a moving arm next to them.
fn admission_of(findings: &Findings<'_>, verdict: Verdict, gap: &Gap) -> Admission {
    let of_positions = admission::of_positions(findings, verdict, gap);
    match findings.inputs.moving {
        Some(moving) if moving.not_tested.is_none() => {
            of_positions.with(findings.force.admission.clone())
        }
        _ => of_positions,
    }
}

/// Where a displacement within a run may be, of a gap without a name.
fn split_of(findings: &Findings<'_>, verdict: Verdict) -> Result<Option<usize>> {
    match verdict {
        Verdict::Unknown => split(&findings.selection),
        _ => Ok(None),
    }
}

/// The device with what was found, where a file can hold any of it, and what it leaves per stream and row.
fn file_of(
    findings: &Findings<'_>,
    verdict: Verdict,
    causes: &[CauseAnswer],
    correction: Option<&Correction>,
) -> Result<(Option<Corrected>, Vec<Vec<f64>>)> {
    let selection = &findings.selection;
    let file = match correction {
        Some(correction) => Some(Corrected {
            device: correction.device.clone(),
            residual: correction.residual.clone(),
        }),
        None => corrected(selection, verdict, (causes, &findings.force.changes))?,
    };
    let left = match &file {
        Some(file) => file.residual.clone(),
        None => {
            let effects = selection.selector.effects;
            findings
                .engine()
                .exact_residual(effects, &selection.refit.model)
        }
    };
    Ok((file, left))
}

/// Which readings the fit left out.
fn fit_rows(findings: &Findings<'_>) -> FitRows {
    let gone = findings.inputs.gone.iter();
    FitRows {
        looked_at: None,
        left_out: gone.map(|(channel, row)| (channel.name(), *row)).collect(),
    }
}

/// Share of the gap that a part's causes close on unseen rows.
fn closed_unseen_share(
    findings: &Findings<'_>,
    is_by_positions: bool,
    verdict: Verdict,
) -> Option<f64> {
    match is_by_positions {
        true => (findings.partial.as_ref())
            .filter(|_| verdict != Verdict::Unknown)
            .map(|partial| partial.share),
        false => findings.force.closed_unseen_share,
    }
}

/// Adds to what a cause is confusable with what no reading of the log tells from it. The verdict stays: the two are one fact of
/// two clocks, and have one number.
fn name_twins(findings: &Findings<'_>, causes: &mut [CauseAnswer]) {
    for cause in findings.selection.causes() {
        let effect = findings.selection.effect(cause);
        let Some(twin) = effect.twin(&findings.engine().context) else {
            continue;
        };
        let of_effect = |own: &&mut CauseAnswer| own.is_of(effect.name(), effect.joint());
        for own in causes.iter_mut().filter(of_effect) {
            if !own.confusable_with.iter().any(|name| name == twin) {
                own.confusable_with.push(twin.to_owned());
            }
        }
    }
}

/// Share of the gap that torques leave: all of the gap of positions, and a share of their part of the squares over noise.
fn unexplained(gap: &Gap, (of_torques, share): (f64, f64)) -> f64 {
    let of_positions = (energy(&gap.channels) - of_torques).max(0.0);
    match of_positions > 0.0 {
        true => (of_torques * share + of_positions) / (of_torques + of_positions),
        false => share,
    }
}

/// The place of a gap of torques; positions show none, or one that has no name.
fn in_torques(place: Place, in_positions: Verdict) -> Place {
    let of_positions = match in_positions {
        Verdict::NoGap => "positions show no gap",
        _ => "positions show another gap",
    };
    Place {
        region: format!("{}: {of_positions}", place.region),
        ..place
    }
}

/// A warning of what positions show next to torques that have the word.
fn unexplained_place(place: &Place, gap: &Gap) -> String {
    let mut channels = gap.channels.iter();
    let has_gap = channels.any(|own| own.channel == place.channel && own.has_gap);
    let what = match has_gap {
        true => "shows a gap that no cause explains",
        false => "is within its noise, which is not white",
    };
    format!("{} {what}: {}", place.channel, place.region)
}

/// The place of a gap of positions.
fn located(findings: &Findings<'_>, verdict: Verdict, touches: &Touched) -> Option<Located> {
    match verdict {
        Verdict::NoGap => None,
        Verdict::Unknown if touches.says_where() => {
            by_dependence(&findings.selection, touches.dependence.clone())
        }
        Verdict::Unknown => {
            locate(findings).map(|located| located.with_dependence(touches.dependence.clone()))
        }
        Verdict::Named | Verdict::Ambiguous => match findings.base_terms.terms.first() {
            Some(term) => of_base_term(findings.engine(), term),
            None => locate(findings),
        },
    }
}

/// Findings on the data but those left out on request. Next to a gap none is told: what its effect leaves in fast
/// motion would pass for noise.
fn on_the_data(findings: &Findings<'_>, noise: &[NoiseAnswer]) -> Vec<CauseAnswer> {
    let streams = findings.engine().context.streams.iter();
    let joints: Vec<Option<usize>> = streams.map(Stream::joint).collect();
    let mut found = noise_findings(noise, &joints);
    found.retain(|cause| !findings.inputs.options.without.contains(&cause.effect));
    found
}

fn warnings(
    findings: &Findings<'_>,
    verdict: Verdict,
    causes: &[CauseAnswer],
    first: [Option<String>; 2],
) -> Vec<String> {
    let engine = findings.engine();
    let mut warnings = findings.shrink.warnings.clone();
    let implausible = causes.iter().filter(|cause| !cause.plausible);
    warnings.extend(implausible.map(|cause| {
        format!(
            "{} at {} has a size that no sound device shows: check the units and signs of the log, or look for \
             damage",
            cause.effect,
            cause.place()
        )
    }));
    let unnamed = causes.first().filter(|_| verdict == Verdict::Unknown);
    warnings.extend(unnamed.and_then(why_not));
    let left = contradicted(findings, causes).filter(|_| verdict == Verdict::Unknown);
    warnings.extend(left.zip(causes.first()).map(|(left, cause)| {
        leaves_of_second(&format!("{} at {}", cause.effect, cause.place()), left)
    }));
    warnings.extend(
        causes
            .iter()
            .filter_map(CauseAnswer::ahead)
            .map(Ahead::words),
    );
    warnings.extend(overruled(findings));
    // where the calibration's own search found none either, the diagnosis says so
    if !engine.start.has_converged() && engine.base.unfinished.is_none() {
        warnings.push(format!(
            "the base model's fit without causes did not converge ({}): what causes gain on it is rough",
            engine.start.convergence
        ));
    }
    warnings.extend(first.into_iter().flatten());
    warnings.extend(on_torques(findings, verdict));
    warnings.extend(findings.force.warnings.iter().cloned());
    let fitted = engine.problem.device_with(&engine.start.model.values);
    let (parameters, free) = (&engine.base.parameters, &engine.base.free);
    let nominal = findings.inputs.nominal;
    warnings.extend(implausible_deviations(nominal, &fitted, parameters, free));
    warnings
}

/// A warning for each channel whose stated noise repeats overrule, with the evidence.
fn overruled(findings: &Findings<'_>) -> Vec<String> {
    let context = &findings.engine().context;
    let of_repeats = findings.floors.iter().filter(|floor| {
        floor.source == NoiseSource::Repeats && is_stated(context.device, floor.channel)
    });
    of_repeats
        .filter_map(|floor| {
            let ratios = context.streams_of(floor.channel).map(|stream| findings.engine().noise[stream].ratio);
            let (squares, axes) = ratios.fold((0.0, 0.0), |(sum, axes), ratio| (sum + ratio * ratio, axes + 1.0));
            let ratio = f64::sqrt(squares / f64::max(axes, 1.0));
            let [low, high] = floor.ci95();
            (!(1.0 / LOUD..=LOUD).contains(&ratio)).then(|| {
                let unit = floor.channel.unit(context.device);
                format!(
                    "{}: repeats of postures scatter by {:.3e} [{low:.3e}, {high:.3e}] {unit} ({:.0} degrees of freedom), \
                     {ratio:.2} times the stated noise: the diagnosis goes by the repeats",
                    floor.channel.name(), floor.rms, floor.freedom
                )
            })
        })
        .collect()
}

/// A warning where the torques show a gap that the verdict does not speak of, or were not tested.
fn on_torques(findings: &Findings<'_>, verdict: Verdict) -> Option<String> {
    if let Some(why) = &findings.force.not_tested {
        return Some(format!("{TORQUES_NOT_TESTED}: {why}"));
    }
    let gap = findings.force.unexplained()?;
    verdict.has_causes().then(|| {
        format!(
            "the torque of joint {} shows a gap that no cause explains: {:.3} {unit}, noise {:.3} {unit}",
            gap.joint.unwrap_or_default(),
            gap.rms_before,
            gap.noise_floor,
            unit = gap.unit
        )
    })
}

fn provenance(findings: &Findings<'_>) -> Provenance {
    let engine = findings.engine();
    Provenance {
        rows: findings.inputs.recording.len(),
        base_parameters: engine.base.parameters.len(),
        base_identifiable: engine.base.free.len(),
        tested: findings.selection.selector.tested.len(),
        thresholds: crate::version::version(),
        last_step: findings.selection.refit.last_step,
        without: findings.inputs.options.without.clone(),
    }
}

impl Diagnosis {
    /// An answer of a verdict, its gap and its causes, with nothing else to say.
    pub(crate) fn of_causes(
        verdict: Verdict,
        gap: Gap,
        causes: Vec<CauseAnswer>,
        device: Device,
        provenance: Provenance,
    ) -> Self {
        Self {
            probability_unknown: match (verdict, causes.first()) {
                (Verdict::NoGap, _) => 0.0,
                (Verdict::Unknown, _) | (_, None) => 1.0,
                (_, Some(first)) => 1.0 - first.class_probability,
            },
            verdict,
            admission: Admission::default(),
            adjusted: Vec::new(),
            own_model: Vec::new(),
            bodies: Vec::new(),
            gap,
            place: None,
            causes,
            absorbed: None,
            unexplained_share: 0.0,
            closed_unseen_share: None,
            own_effects_leave: None,
            silent: Vec::new(),
            second: None,
            correction: None,
            correction_refused: None,
            not_in_file: Vec::new(),
            untestable: Vec::new(),
            invisible: Vec::new(),
            detectable: Vec::new(),
            noise: Vec::new(),
            whiteness: Whiteness::default(),
            candidates: Vec::new(),
            plausibility: Vec::new(),
            next_experiment: None,
            warnings: Vec::new(),
            held_out: String::new(),
            provenance,
            device,
            corrected: None,
            fit_rows: FitRows::default(),
            steps: Vec::new(),
            split_row: None,
            traces: Vec::new(),
            predictions: Vec::new(),
        }
    }
}
