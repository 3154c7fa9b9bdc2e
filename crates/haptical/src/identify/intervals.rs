//! The kind of an identification's intervals, in a sentence.

use haptical_calibration::{ChannelNoise, Intervals, ScaleOfLengths, SourceOfScale};

/// The same as a sentence.
pub(super) fn sentence(intervals: &Intervals) -> String {
    let considered = match intervals.considered.as_slice() {
        [] => String::new(),
        names => format!(
            " They are widened by what plausible errors of parameters that were not fitted here do: {}.",
            names.join(", ")
        ),
    };
    let checked = match (intervals.checked, intervals.profile_likelihood.as_slice()) {
        (false, _) => String::new(),
        (true, []) => " At the ends of all, the sum of squares is as that says.".to_owned(),
        (true, names) => format!(
            " By profile likelihood, since the sum of squares is another there: {}.",
            names.join(", ")
        ),
    };
    let open = match intervals.open.as_slice() {
        [] => String::new(),
        names => format!(
            " Without an interval, since the data tell no end: {}.",
            names.join(", ")
        ),
    };
    let noise = of_noise(intervals);
    let scales = of_scales(&intervals.length_scales);
    format!(
        "95 % intervals: {}, {} degrees of freedom.{noise}{scales}{checked}{open}{considered} No interval is given for what is not \
         identified.",
        intervals.kind, intervals.degrees_of_freedom
    )
}

/// What the lengths are in proportion to, and how well that is known.
pub(crate) fn of_scales(scales: &[ScaleOfLengths]) -> String {
    let sentences = scales.iter().map(|scale| {
        let (name, percent) = (&scale.name, 100.0 * scale.sd);
        match scale.source {
            SourceOfScale::Instrument => {}
            SourceOfScale::HeldLength => {
                return format!(
                    " Lengths are in proportion to {name}, which is held: its plausible error of {percent:.2} % no touch \
                     shows and every length's interval counts."
                );
            }
            SourceOfScale::KnownDistance => {
                return format!(
                    " Lengths rest on the distance of the touched points {name}, whose standard deviation of \
                     {percent:.2} % (sd_m) every length's interval counts."
                );
            }
        }
        let instrument = name.trim_end_matches("_scale");
        let source = match scale.is_stated {
            true => "stated",
            false => "assumed: state it as scale_sd in the device file",
        };
        format!(
            " Lengths rest on the scale of the {instrument}, whose standard deviation of {percent:.2} % ({source}) no \
             reading shows and every length's interval counts."
        )
    });
    sentences.collect()
}

/// What the residuals say of noise that is not independent and of one size.
fn of_noise(intervals: &Intervals) -> String {
    if !intervals.noise_checked {
        return " The noise is taken as independent from row to row: the log is too long or too short to look."
            .to_owned();
    }
    let channels = &intervals.channel_noise;
    let names = |has: &dyn Fn(&ChannelNoise) -> bool| -> Option<String> {
        let own: Vec<&str> = (channels.iter().filter(|own| has(own)))
            .map(|own| own.channel.as_str())
            .collect();
        (!own.is_empty()).then(|| own.join(", "))
    };
    let mut sentences = Vec::new();
    if let Some(names) = names(&|own| own.has_memory) {
        let least = intervals.least_degrees_of_freedom;
        let least = least.map(|least| format!(" of at least {least:.1} degrees of freedom"));
        sentences.push(format!(
            " The noise has memory along the log in {names}: intervals follow from its spectrum{}.",
            least.unwrap_or_default()
        ));
    }
    for own in channels {
        for uneven in &own.uneven {
            let then = match own.is_in_intervals_alone {
                true => "intervals count that",
                false => "rows are weighted by that",
            };
            sentences.push(format!(
                " The noise of {} is up to {:.1} times larger in a part of joint {}'s range: {then}.",
                own.channel, uneven.ratio, uneven.joint
            ));
        }
    }
    if let Some(names) = names(&|own| !own.drift_sd.is_empty()) {
        sentences.push(match channels.iter().any(|own| own.is_in_intervals_alone) {
            true => format!(
                " A drift is not excluded in {names}: intervals count it. A line in time would move the values to where the fit is no longer \
                 straight, so it is not in them."
            ),
            false => format!(
                " A line in time was fitted besides, as a drift is not excluded: {names}."
            ),
        });
    }
    sentences.concat()
}
