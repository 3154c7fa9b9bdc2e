//! How the intervals of an identification were made.

use haptical_calibration::ParameterFit;
use haptical_identification::NoiseScale;
use serde::Serialize;

/// How intervals were made.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct IntervalEntry {
    pub(crate) level: f64,
    pub(crate) kind: String,
    pub(crate) degrees_of_freedom: usize,
    /// Parameters that were not fitted (weak, or those of step 1) and whose plausible errors widen the intervals.
    pub(crate) considered: Vec<String>,
    /// Whether the ends of the linearised intervals were compared with the sum of squares there; not where so many
    /// readings leave intervals over which everything is straight.
    pub(crate) checked: bool,
    /// Parameters whose interval is by profile likelihood instead, because the two differ.
    pub(crate) profile_likelihood: Vec<String>,
    /// Those of them without an end on one side or both, and so without an interval.
    pub(crate) open: Vec<String>,
}

impl IntervalEntry {
    pub(crate) fn of(fit: &ParameterFit) -> Self {
        let kind = match fit.noise {
            NoiseScale::Stated => "linearised at the solution, normal, with the stated noise",
            NoiseScale::Estimated => {
                "linearised at the solution, Student's t, with the noise that the residuals show"
            }
        };
        let considered = fit.considered.parameters.iter();
        let names = |indices: &[usize]| {
            let names = indices.iter().map(|&index| &fit.estimates[index].name);
            names.cloned().collect()
        };
        Self {
            checked: fit.profiled.is_checked,
            profile_likelihood: names(&fit.profiled.parameters),
            open: names(&fit.profiled.open),
            level: 0.95,
            kind: kind.to_owned(),
            degrees_of_freedom: fit.uncertainty.degrees_of_freedom,
            considered: considered
                .map(|parameter| parameter.name(&fit.device))
                .collect(),
        }
    }

    /// The same as a sentence.
    pub(crate) fn sentence(&self) -> String {
        let considered = match self.considered.as_slice() {
            [] => String::new(),
            names => format!(
                " They are widened by what plausible errors of parameters that were not fitted here do: {}.",
                names.join(", ")
            ),
        };
        let checked = match (self.checked, self.profile_likelihood.as_slice()) {
            (false, _) => String::new(),
            (true, []) => " At the ends of all, the sum of squares is as that says.".to_owned(),
            (true, names) => format!(
                " By profile likelihood, since the sum of squares is another there: {}.",
                names.join(", ")
            ),
        };
        let open = match self.open.as_slice() {
            [] => String::new(),
            names => format!(
                " Without an interval, since the data tell no end: {}.",
                names.join(", ")
            ),
        };
        format!(
            "95 % intervals: {}, {} degrees of freedom.{checked}{open}{considered} No interval is given for what is not \
             identified.",
            self.kind, self.degrees_of_freedom
        )
    }
}
