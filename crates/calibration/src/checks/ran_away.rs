//! A fit that ended far above what its own folds predict: it started elsewhere than they did, and found another minimum.

use crate::{CalibrationError, ChannelReport};

/// Residuals on the rows of a fit over those of folds that did not see them, from which the fit is no minimum: least squares
/// leaves less on its own rows than on others.
const RAN_AWAY: f64 = 3.0;

/// The channel that a fit leaves larger on its own rows than its folds leave it on rows that they did not see.
pub(crate) fn ran_away<'r>(
    fit: &'r [ChannelReport],
    folds: &'r [ChannelReport],
) -> Option<(&'r ChannelReport, &'r ChannelReport)> {
    let of_channel = |own: &'r ChannelReport| {
        let unseen = folds.iter().find(|unseen| unseen.channel == own.channel)?;
        let most = RAN_AWAY * unseen.rms_after.max(unseen.noise_floor);
        // a residual without a number is none
        (own.rms_after.is_nan() || own.rms_after > most).then_some((own, unseen))
    };
    fit.iter().find_map(of_channel)
}

/// The refusal of such a fit.
pub(crate) fn refusal(fit: &[ChannelReport], folds: &[ChannelReport]) -> Option<CalibrationError> {
    let (own, unseen) = ran_away(fit, folds)?;
    Some(CalibrationError::NotConverged {
        what: "joint identification".to_owned(),
        reason: format!(
            "it leaves {:.3e} {unit} of {} on its own rows, and fits without some of these rows leave {:.3e} {unit} on rows that they \
             did not see: the recording does not fix where the search ends; record more postures, in which the handle turns too",
            own.rms_after,
            own.channel,
            unseen.rms_after,
            unit = own.unit
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Channel;
    use crate::problem::residuals::ChannelResiduals;
    use haptical_model::Device;

    fn report(rms: f64) -> ChannelReport {
        let residuals = ChannelResiduals {
            channel: Channel::Output { joint: 0 },
            rows: vec![0, 1],
            residuals: vec![rms, -rms],
            outside_range: 0,
            noise_floor: 1e-5,
        };
        let device = Device::from_toml("[[joint]]\n", "one.toml").unwrap().device;
        ChannelReport::new(&device, residuals.clone(), residuals)
    }

    #[test]
    fn a_fit_far_above_its_folds_is_no_minimum() {
        for (own, unseen, is_refused) in [
            (0.395, 24e-6, true),
            (f64::NAN, 24e-6, true),
            (20e-6, 24e-6, false),
            (30e-6, 24e-6, false),
            // both are noise
            (29e-6, 1e-6, false),
        ] {
            let refusal = refusal(&[report(own)], &[report(unseen)]);
            assert_eq!(refusal.is_some(), is_refused, "{own} {unseen}");
        }
        assert!(
            refusal(&[report(1.0)], &[]).is_none(),
            "nothing was held out"
        );
    }
}
