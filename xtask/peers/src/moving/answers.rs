//! What the two programs answer, as far as the table shows it.

use std::collections::BTreeMap;

use serde::Deserialize;
use xtask_blind::Answer;

/// The arm that MuJoCo moved: what was withheld in each case, and each number's values joint by joint.
#[derive(Debug, Deserialize)]
pub(super) struct Truth {
    pub(super) cases: BTreeMap<String, BTreeMap<String, f64>>,
    #[serde(rename = "true")]
    pub(super) values: BTreeMap<String, Vec<f64>>,
}

/// The answer of `mujoco_sysid.py fit`; parameters are named as `armature1`.
#[derive(Debug, Deserialize)]
pub(super) struct Fit {
    pub(super) version: String,
    pub(super) seconds: f64,
    pub(super) values: BTreeMap<String, f64>,
    pub(super) half_widths_95: BTreeMap<String, f64>,
    pub(super) at_bound: Vec<String>,
    pub(super) warnings: Vec<String>,
    pub(super) relative_rms_before: f64,
    pub(super) relative_rms_after: f64,
}

/// Both answers on one log.
#[derive(Debug)]
pub(super) struct Case {
    pub(super) withheld: String,
    pub(super) fit: Fit,
    /// Of `gap.json`.
    pub(super) gap: Answer,
    pub(super) gap_s: f64,
}
