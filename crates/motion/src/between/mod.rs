//! Between motor and link: what an encoder on the link reads beside its motor's, and the delays, springs and plays that explain it.
//!
//! docs/equations.md, *Between motor and link*. Rows are behind the low pass of the torques; what is not said here is as there.

mod answer;
mod choose;
mod fit;
mod own;
mod rows;
mod terms;
mod unseen;

pub use self::own::{OwnEffect, examine_own};
use haptical_model::Recording;

use self::answer::examined;
use self::choose::choose;
use self::rows::Rows;
use self::terms::Term;
use crate::MotionError;
use crate::examined::{ChannelFit, Examined};
use crate::thresholds::between::{LEFT, LEFT_UNSEEN, NOISE_SQUARE, PART_OF_GAP};

/// Where the torque that a gear carries comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoadSource {
    /// The recording's torques are those that the links ask for ([`crate::link_torques`]): they have little noise.
    Links,
    /// They are the drives' own, with friction and the noise of a current.
    Drives,
}

/// What encoders on links show beside their motors'.
#[derive(Debug, Clone, PartialEq)]
pub struct Between {
    /// In the words of the torques; a channel is a joint's encoder, in its unit.
    pub examined: Examined,
    /// Whether the fits have converged and the terms explain what it shows, on these rows and on those that were not fitted.
    pub is_adequate: bool,
    /// Delay of each joint by itself with its standard deviation \[s\], where one that they share was found.
    pub own_delays_s: Vec<(usize, f64, f64)>,
    /// Offset of each joint's encoder \[rad\], where its ratio and its drum are as they should.
    pub offsets_rad: Vec<(usize, f64)>,
}

/// Examines the encoders on the links of a motion: delays, springs and plays that follow the load, joint by joint. Offsets are free; so
/// is a ratio or a drum that is off, where it explains more than an effect. `without`: names of effects that are left out.
///
/// # Errors
/// [`MotionError`] for a recording without time, torques, motion, or encoders on links.
pub fn examine_between(
    recording: &Recording,
    second: Option<&Recording>,
    source: LoadSource,
    without: &[String],
) -> Result<Between, MotionError> {
    let rows = Rows::of(recording, source)?;
    let chosen = choose(&rows.joints, without);
    let seen = second.map(|second| unseen::on_second(&Rows::of(second, source)?, &rows, &chosen));
    let (unseen, why) = match seen {
        Some(Ok(unseen)) => (unseen, None),
        Some(Err(why)) => (unseen::within(&rows, &chosen), Some(why)),
        None => (unseen::within(&rows, &chosen), None),
    };
    let examined = Examined {
        unseen,
        second: why,
        ..examined(&rows, &chosen)
    };
    let own = rows.joints.iter().zip(&chosen.fitted);
    let own_delays_s = own
        .filter(|_| chosen.shared_s.is_some())
        .filter_map(|(rows, fitted)| {
            let (delay_s, sd) = fitted.delay_s()?;
            Some((rows.joint, delay_s, sd))
        });
    let mut all = chosen.bare.iter().chain(&chosen.fitted);
    let have_converged = all.all(|own| own.has_converged);
    let offsets = rows.joints.iter().zip(&chosen.fitted);
    let offsets = offsets.filter(|(_, own)| own.of(Term::Shape).is_none());
    Ok(Between {
        offsets_rad: offsets
            .map(|(rows, own)| (rows.joint, own.offset_rad()))
            .collect(),
        is_adequate: have_converged && is_adequate(&examined),
        own_delays_s: own_delays_s.collect(),
        examined,
    })
}

/// Whether effects explain what the encoders show: of the whole energy beyond noise, and of every joint's that has an effect or a
/// hundredth of it, they leave 2 %, and a tenth on rows that were not fitted (A169).
fn is_adequate(examined: &Examined) -> bool {
    let energy = |rms: f64, noise: f64| ((rms / noise).powi(2) - NOISE_SQUARE).max(0.0);
    let whole: f64 = (examined.channels.iter())
        .map(|own| energy(own.rms_before, own.noise))
        .sum();
    let is_explained = |own: &ChannelFit| {
        let [before, after] = [own.rms_before, own.rms_after].map(|rms| energy(rms, own.noise));
        let has_effect = examined
            .findings
            .iter()
            .any(|found| found.joint.is_none_or(|joint| joint == own.joint));
        let is_small = !has_effect && before <= PART_OF_GAP * whole;
        let mut unseen = examined
            .unseen
            .iter()
            .filter(|unseen| unseen.joint == own.joint);
        let holds = unseen.all(|unseen| {
            let [before, after] =
                [&unseen.before, &unseen.after].map(|own| own.iter().sum::<f64>());
            let floor = NOISE_SQUARE * unseen.noise.powi(2) * unseen.rows_in_all() as f64;
            !has_effect || after - floor <= LEFT_UNSEEN * (before - floor).max(0.0)
        });
        is_small || (after <= LEFT * before && holds)
    };
    !examined.findings.is_empty()
        && examined.unexplained_share() <= LEFT
        && examined.channels.iter().all(is_explained)
}
