//! Hedges of the causes beyond their own evidence: rivals that no scan could list, how little a name is worth that explains a part of a gap
//! only, and springs under loads that nothing tells, whose sag passes for an error of a drive or of an angle.

use haptical_effects::{Context, Effect, Family, Need, Shape};
use haptical_model::{Device, RigidBodies};

use crate::Result;
use crate::answer::{CauseAnswer, IN_NO_CATALOGUE, Verdict};
use crate::judge::{BaseTerm, Difference, Findings};
use crate::select::Candidate;
use crate::thresholds::chance::CONFUSABLE_NATS;
use crate::thresholds::rivals::{SAG_SHARE, UNTOLD_PROBABILITY};

/// What to do next where a sag may be in a cause's place.
pub(crate) const WEIGH: &str = "write the masses of the links into the device file (`mass_kg` and `centre_of_mass_m`, or \
    `<inertial>`) and diagnose again; or record the torques";

/// Makes causes that follow the posture less sure where springs under assumed weights would explain as much; what to say.
pub(crate) fn doubt_of_loads(
    findings: &Findings<'_>,
    causes: &mut [CauseAnswer],
) -> Result<Option<String>> {
    // what changed since an earlier model is no matter of the loads
    let is_term = |cause: &CauseAnswer| {
        let mut terms = findings.base_terms.terms.iter();
        terms.any(|term| term.name == cause.effect)
    };
    let is_doubtful = |cause: &CauseAnswer| is_of_posture(cause) && !is_term(cause);
    if !causes.iter().any(is_doubtful) {
        return Ok(None);
    }
    let Some(sag) = sag(findings)?.filter(|sag| sag.share >= SAG_SHARE) else {
        return Ok(None);
    };
    for cause in causes.iter_mut().filter(|cause| is_doubtful(cause)) {
        cause.probability = cause.probability.min(UNTOLD_PROBABILITY);
        cause.class_probability = cause.class_probability.min(UNTOLD_PROBABILITY);
        if !cause.confusable_with.iter().any(|name| name == sag.name) {
            cause.confusable_with.push(sag.name.to_owned());
        }
    }
    if !causes.first().is_some_and(is_doubtful) {
        return Ok(None);
    }
    let much = match sag.share < 1.0 {
        true => format!("{:.0} % of what the causes do", 100.0 * sag.share),
        false => "more than the causes do".to_owned(),
    };
    Ok(Some(format!(
        "what bends under its load was not tested: the device file has no masses (`mass_kg`, or `<inertial>`), the log no \
         torques. With assumed masses {} explains {much}, and may be in their place",
        sag.name
    )))
}

/// Whether a cause is a function of the posture, as a sag is.
fn is_of_posture(cause: &CauseAnswer) -> bool {
    haptical_effects::spec(&cause.effect).is_some_and(|spec| {
        matches!(
            spec.family,
            Family::Shape | Family::Coupling | Family::Wobble | Family::Tool | Family::Exit
        )
    })
}

/// Springs in all joints.
struct Sag {
    name: &'static str,
    /// What they explain over what the causes do.
    share: f64,
}

fn sag(findings: &Findings<'_>) -> Result<Option<Sag>> {
    let selector = &findings.selection.selector;
    let (engine, known) = (selector.engine, &selector.engine.context);
    let is_told = known.torque_nm.iter().any(Option::is_some) || known.base_moment_nm.is_some();
    let Some(weighed) = (!is_told).then(|| weighed(known.device)).flatten() else {
        return Ok(None);
    };
    let context = Context::new(&weighed, known.recording, &known.streams)?;
    let is_spring = |effect: &&dyn Effect| {
        let spec = effect.spec();
        spec.family == Family::Load
            && spec.shape == Shape::NONE
            && spec.needs.contains(&Need::Torque)
            && effect.untestable(known).is_some()
            && effect.untestable(&context).is_none()
    };
    let effects = selector.effects.iter().map(AsRef::as_ref);
    let springs: Vec<&dyn Effect> = effects.filter(is_spring).collect();
    let Some(name) = springs.first().map(|effect| effect.name()) else {
        return Ok(None);
    };
    let springs = springs.iter().filter(|effect| effect.name() == name);
    let signals: Vec<_> = springs
        .flat_map(|effect| effect.derivative(&context, &[0.0], 0.0))
        .collect();
    let explained = Candidate::of_signals(&engine.system, &signals, 0, 0.0);
    let explained = explained.score(&engine.system).score;
    let by_causes = selector.cost(&engine.start) - selector.cost(&findings.selection.refit);
    Ok((by_causes > 0.0).then(|| Sag {
        name,
        share: explained / by_causes,
    }))
}

/// The device with the weights that written robot descriptions would have (assumption A150).
fn weighed(device: &Device) -> Option<Device> {
    let plausible = RigidBodies::plausible(device).ok()?;
    let mut weighed = device.clone();
    for row in plausible.masses() {
        weighed.set_row_inertia(row.row, &row.inertia).ok()?;
    }
    weighed.gravity_mps2 = Some((*plausible.gravity_mps2()).into());
    Some(weighed)
}

/// Gives the first cause the rivals and the probability that belong to it.
pub(crate) fn hedge(findings: &Findings<'_>, verdict: Verdict, causes: &mut [CauseAnswer]) {
    match verdict {
        Verdict::Unknown => {
            let unknown = findings.adequacy.probability_unknown(verdict);
            doubt_partial(causes, &findings.base_terms, unknown);
        }
        Verdict::Ambiguous => complete_rivals(findings, causes),
        Verdict::NoGap | Verdict::Named => {}
    }
}

/// What explains a part of a gap that is none of the catalogue's has the probability that it is one after all.
fn doubt_partial(causes: &mut [CauseAnswer], base_terms: &Difference, unknown: f64) {
    let is_term = |cause: &CauseAnswer| {
        let same = |term: &BaseTerm| term.name == cause.effect;
        base_terms.terms.iter().any(same)
    };
    for cause in causes.iter_mut().filter(|cause| !is_term(cause)) {
        cause.probability *= 1.0 - unknown;
        cause.class_probability *= 1.0 - unknown;
    }
}

/// Completes the rivals of a first cause that is not sure. Where no effect of the catalogue is one, the weak gap may be
/// that of an effect in no catalogue.
fn complete_rivals(findings: &Findings<'_>, causes: &mut [CauseAnswer]) {
    let Some(first) = causes.first_mut() else {
        return;
    };
    if first.confusable_with.is_empty() {
        first.confusable_with = unlisted_rivals(findings);
    }
    if first.confusable_with.is_empty() {
        first.confusable_with.push(IN_NO_CATALOGUE.to_owned());
    }
}

/// What the first cause may be taken for although no other name refits as well: itself at another place, and
/// effects of the same course at its place whose covariate was not recorded (a cable that creeps under a load
/// that no torque tells drifts as a joint that follows the time).
fn unlisted_rivals(findings: &Findings<'_>) -> Vec<String> {
    let Some(first) = findings.first() else {
        return Vec::new();
    };
    let mut names: Vec<String> = Vec::new();
    let elsewhere = findings.rivals.first().is_some_and(|list| {
        let mut others = list.iter().skip(1);
        others.any(|rival| rival.name == first.name() && rival.nats_behind <= CONFUSABLE_NATS)
    });
    if elsewhere {
        names.push(first.name().to_owned());
    }
    let context = &findings.engine().context;
    let untried = |effect: &(dyn Effect + 'static)| {
        effect.is_kin_of(first) && effect.name() != first.name() && effect.lacks_covariate(context)
    };
    for effect in findings
        .selection
        .selector
        .effects
        .iter()
        .map(AsRef::as_ref)
    {
        if untried(effect) && !names.iter().any(|name| name == effect.name()) {
            names.push(effect.name().to_owned());
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A centre is given behind the row's theta, which an inertia does not know of.
    #[test]
    fn the_assumed_weights_are_where_a_description_has_them() {
        let text = "[[link]]\na_m = 0.1\nalpha_rad = 0.3\nd_m = 0.0\n\
             [[link]]\na_m = 0.4\nalpha_rad = -0.7\nd_m = 0.05\ntheta_offset_rad = 1.1\n\
             [[link]]\na_m = 0.3\nalpha_rad = 0.2\nd_m = 0.1\ntheta_offset_rad = -0.6\n[[joint]]\n[[joint]]\n";
        let device = Device::from_toml(text, "two.toml").unwrap().device;
        let weighed = weighed(&device).unwrap();
        let [wanted, found] = [&device, &weighed].map(|own| RigidBodies::plausible(own).unwrap());
        assert_eq!(found.assumed(), []);
        for (wanted, found) in wanted.masses().iter().zip(found.masses()) {
            assert!(wanted.inertia.first_moment_kgm.norm() > 0.05);
            let apart = wanted.inertia.first_moment_kgm - found.inertia.first_moment_kgm;
            assert!(apart.norm() < 1e-12, "{wanted:?} {found:?}");
        }
    }
}
