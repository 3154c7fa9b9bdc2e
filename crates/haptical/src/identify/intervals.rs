//! The kind of an identification's intervals, in a sentence.

use haptical_calibration::Intervals;

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
    format!(
        "95 % intervals: {}, {} degrees of freedom.{checked}{open}{considered} No interval is given for what is not \
         identified.",
        intervals.kind, intervals.degrees_of_freedom
    )
}
