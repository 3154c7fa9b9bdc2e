//! A batch of scores: rates with intervals, calibration of probabilities, confusion table.

use std::collections::BTreeMap;

use serde::Serialize;

use super::answer::Verdict;
use super::interval::Rate;
use super::judge::TrialScore;

/// Bins of the reliability table.
const BINS: usize = 10;

/// Calibration of the probabilities of what is answered, `unknown` included.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Calibration {
    /// Answers with a probability.
    pub count: usize,
    /// Expected calibration error: mean over answers of |mean probability - share right| of their bin.
    pub expected_error: Option<f64>,
    /// Mean of -ln(probability given to what happened), probabilities cut at 1e-6.
    pub log_score: Option<f64>,
    /// Per bin of a tenth: answers, mean probability, share right.
    pub bins: Vec<(usize, f64, f64)>,
}

/// Summary of a batch of one suite.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Summary {
    /// Suite.
    pub suite: String,
    /// Trials.
    pub trials: usize,
    /// Any verdict but `no-gap`.
    pub detected: Rate,
    /// Verdict `named`.
    pub named: Rate,
    /// Verdict `unknown`.
    pub unknown: Rate,
    /// Right, of all.
    pub right: Rate,
    /// Right, of detected.
    pub right_of_detected: Rate,
    /// Right, of verdicts `named`: their precision.
    pub right_of_named: Rate,
    /// The first name alone right, of detected.
    pub top_right_of_detected: Rate,
    /// Joint right, of those with a joint whose effect was found.
    pub joint_right: Rate,
    /// A column that an effect in no catalogue depends on is named, of detected.
    pub dependence_right: Rate,
    /// Verdict `named` and wrong, of detected.
    pub confidently_wrong_of_detected: Rate,
    /// All effects found, of those with several.
    pub all_found: Rate,
    /// Impossible magnitudes that were flagged.
    pub implausible_flagged: Rate,
    /// Mean size of the declared class.
    pub mean_class_size: Option<f64>,
    /// Causes that were not put in, per trial.
    pub false_causes_per_trial: Option<f64>,
    /// Median of the true reduction where the first name is right \[%\].
    pub median_true_reduction_percent: Option<f64>,
    /// Stated intervals of the reduction that hold the true one, where the first name is right.
    pub reduction_covered: Rate,
    /// Stated intervals of parameters that hold the truth.
    pub parameters_covered: Rate,
    /// The same by `effect: parameter`.
    pub parameters_covered_by_name: BTreeMap<String, Rate>,
    /// Calibration.
    pub calibration: Calibration,
    /// Right of detected, by label of the truth.
    pub by_truth: BTreeMap<String, Rate>,
    /// Detected, by label of the truth.
    pub detected_by_truth: BTreeMap<String, Rate>,
    /// Confusion table: label of the truth, then what was answered first.
    pub confusion: BTreeMap<String, BTreeMap<String, usize>>,
}

/// Summarises scores of one suite (or of several, under a joint name).
pub fn summarise(suite: &str, scores: &[TrialScore]) -> Summary {
    let rate = |of: &dyn Fn(&TrialScore) -> bool, is: &dyn Fn(&TrialScore) -> bool| {
        Rate::of_cases(scores.iter().filter(|score| of(score)).map(is))
    };
    let all = |_: &TrialScore| true;
    let detected = |score: &TrialScore| score.detected;
    let named = |score: &TrialScore| score.verdict == Verdict::Named;
    let right = |score: &TrialScore| score.right;
    let mut by_truth: BTreeMap<String, Vec<&TrialScore>> = BTreeMap::new();
    let mut confusion: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
    for score in scores {
        by_truth.entry(score.name.clone()).or_default().push(score);
        *confusion
            .entry(score.name.clone())
            .or_default()
            .entry(score.answered.clone())
            .or_default() += 1;
    }
    let shrinks = || {
        let of_right = scores.iter().filter(|score| score.top_right);
        of_right.filter_map(|score| score.shrink.as_ref())
    };
    let coverages = || scores.iter().flat_map(|score| &score.coverage);
    let mut parameters: BTreeMap<String, Vec<bool>> = BTreeMap::new();
    for one in coverages() {
        let name = format!("{}: {}", one.effect, one.parameter);
        parameters.entry(name).or_default().push(one.covered);
    }
    Summary {
        suite: suite.to_owned(),
        trials: scores.len(),
        detected: rate(&all, &detected),
        named: rate(&all, &named),
        unknown: rate(&all, &|score| score.verdict == Verdict::Unknown),
        right: rate(&all, &right),
        right_of_detected: rate(&detected, &right),
        right_of_named: rate(&named, &right),
        top_right_of_detected: rate(&detected, &|score| score.top_right),
        joint_right: Rate::of_cases(scores.iter().filter_map(|score| score.joint_right)),
        dependence_right: Rate::of_cases(scores.iter().filter_map(|score| score.dependence_right)),
        confidently_wrong_of_detected: rate(&detected, &|score| score.confidently_wrong),
        all_found: rate(&|score| score.groups > 1, &|score| {
            score.groups_found == score.groups
        }),
        implausible_flagged: Rate::of_cases(
            scores.iter().filter_map(|score| score.implausible_flagged),
        ),
        mean_class_size: mean(
            scores
                .iter()
                .filter_map(|score| score.class_size.map(to_f64)),
        ),
        false_causes_per_trial: mean(scores.iter().map(|score| to_f64(score.false_causes))),
        median_true_reduction_percent: {
            let all: Vec<f64> = shrinks().map(|one| one.true_percent).collect();
            haptical_metrics::median(&all).ok()
        },
        reduction_covered: Rate::of_cases(shrinks().filter_map(|one| one.covered)),
        parameters_covered: Rate::of_cases(coverages().map(|one| one.covered)),
        parameters_covered_by_name: parameters
            .into_iter()
            .map(|(name, cases)| (name, Rate::of_cases(cases)))
            .collect(),
        calibration: calibrate(scores.iter().filter_map(|score| score.probability)),
        by_truth: by_truth
            .iter()
            .map(|(name, of_name)| {
                let found = of_name.iter().filter(|score| score.detected);
                (name.clone(), Rate::of_cases(found.map(|score| score.right)))
            })
            .collect(),
        detected_by_truth: by_truth
            .iter()
            .map(|(name, of_name)| {
                let cases = of_name.iter().map(|score| score.detected);
                (name.clone(), Rate::of_cases(cases))
            })
            .collect(),
        confusion,
    }
}

/// Reliability of pairs of probability and outcome.
fn calibrate(pairs: impl Iterator<Item = (f64, bool)>) -> Calibration {
    let mut sums = [(0_usize, 0.0, 0.0); BINS];
    let (mut count, mut log_sum) = (0_usize, 0.0);
    for (probability, outcome) in pairs {
        let probability = probability.clamp(0.0, 1.0);
        let bin = ((probability * BINS as f64) as usize).min(BINS - 1);
        let happened = f64::from(u8::from(outcome));
        sums[bin].0 += 1;
        sums[bin].1 += probability;
        sums[bin].2 += happened;
        let given = if outcome {
            probability
        } else {
            1.0 - probability
        };
        log_sum -= libm::log(given.max(1e-6));
        count += 1;
    }
    if count == 0 {
        return Calibration::default();
    }
    let total = to_f64(count);
    Calibration {
        count,
        expected_error: Some(sums.iter().map(|(_, p, h)| (p - h).abs()).sum::<f64>() / total),
        log_score: Some(log_sum / total),
        bins: sums
            .into_iter()
            .map(|(n, p, h)| {
                let size = to_f64(n.max(1));
                (n, p / size, h / size)
            })
            .collect(),
    }
}

fn to_f64(count: usize) -> f64 {
    count as f64
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0_usize);
    for value in values {
        sum += value;
        count += 1;
    }
    (count > 0).then(|| sum / to_f64(count))
}
