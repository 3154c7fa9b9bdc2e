//! What a device's own effects leave between motor and link.

use haptical_model::Recording;

use super::answer::{examined, rms};
use super::choose::Chosen;
use super::fit::{Fitted, fit, predicted};
use super::rows::{JointRows, Rows};
use super::terms::Term;
use super::unseen::{about_zero, weights_of};
use super::{Between, LEFT_UNSEEN, LoadSource};
use crate::MotionError;
use crate::thresholds::between::{FLIGHT_SHARES, NOISE_ENERGY};

/// An effect of a joint (from 0) whose size is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OwnEffect {
    /// The link's encoder is late \[s\].
    Delay(f64),
    /// The gear yields \[rad/(N m)\].
    Spring(f64),
    /// Half the width of a play that follows the load \[rad\].
    Play(f64),
}

/// What known effects of joints (from 0) leave of what the encoders on links read beside their motors'; zeros are free. It is adequate where
/// that is a tenth of the energy that is there without them, of every joint that has one (A169).
///
/// # Errors
/// As [`super::examine_between`].
pub fn examine_own(
    recording: &Recording,
    source: LoadSource,
    own: &[(usize, OwnEffect)],
) -> Result<Between, MotionError> {
    let rows = Rows::of(recording, source)?;
    let (mut bare, mut fitted) = (Vec::new(), Vec::new());
    for joint in &rows.joints {
        let mine = own.iter().filter(|own| own.0 == joint.joint);
        let (terms, coefficients): (Vec<Term>, Vec<f64>) =
            mine.map(|own| term(joint, own.1)).unzip();
        let before = fit(joint, &[], &|_| true);
        let model = predicted(joint, &terms, &coefficients);
        let rest = joint.beside.iter().zip(&model);
        let rest: Vec<f64> = rest.map(|(own, model)| own - model).collect();
        let after = Fitted {
            terms,
            coefficients,
            sd: joint.noise,
            ..before.clone()
        };
        let weights = weights_of(&after, joint);
        fitted.push(Fitted {
            rest: about_zero(joint, &weights, rest),
            weights,
            ..after
        });
        bare.push(before);
    }
    let is_left = |((joint, before), after): ((&JointRows, &Fitted), &Fitted)| {
        let energy = |own: &Fitted| (rms(&own.rest, &after.weights) / joint.noise).powi(2) - 1.0;
        energy(after) > LEFT_UNSEEN * energy(before) && energy(after) > NOISE_ENERGY
    };
    let mut triples = rows.joints.iter().zip(&bare).zip(&fitted);
    let is_adequate = bare.iter().all(|own| own.has_converged) && !triples.any(is_left);
    let none = rows.joints.iter().map(|_| Vec::new());
    let chosen = Chosen {
        nats: none.collect(),
        rivals: rows.joints.iter().map(|_| Vec::new()).collect(),
        shared_s: None,
        tried: 0,
        bare,
        fitted,
    };
    let mut examined = examined(&rows, &chosen);
    examined.findings.clear();
    for channel in &mut examined.channels {
        // what a law gets wrong is no gap
        channel.noise = channel.noise.max(channel.rms_after);
        channel.rms_before = channel.rms_after;
        channel.before.clone_from(&channel.after);
    }
    Ok(Between {
        examined,
        is_adequate,
        own_delays_s: Vec::new(),
        offsets_rad: Vec::new(),
    })
}

fn term(rows: &JointRows, own: OwnEffect) -> (Term, f64) {
    match own {
        OwnEffect::Delay(delay_s) => (Term::Delay, delay_s),
        OwnEffect::Spring(rad_per_nm) => (Term::Spring, rad_per_nm),
        OwnEffect::Play(half_rad) => {
            let play = Term::Play {
                flight_nm: FLIGHT_SHARES[1] * rows.load_rms,
                yields: false,
            };
            (play, half_rad)
        }
    }
}
