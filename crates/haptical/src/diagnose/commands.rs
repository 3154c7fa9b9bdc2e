//! Commands that go on from a diagnosis.

use haptical_diagnosis::{Diagnosis, Verdict};
use haptical_effects::{Hook, specs};

use crate::files::{DEVICE_FLAGS, FIT_FLAGS, Record};

/// A command that goes on from a diagnosis, as one would type it where that was started; `gap.json` and `corrected.toml` by their names alone.
#[derive(Debug, Clone, PartialEq)]
pub struct NextCommand {
    /// A word for a terminal.
    pub label: &'static str,
    /// What it is for.
    pub purpose: &'static str,
    /// The command.
    pub command: String,
}

/// Which kinds of fit and of prediction a log is for.
#[derive(Debug, Clone, Copy)]
struct Shows {
    /// Poses, distances or encoders on links.
    geometry: bool,
    /// Of it, what a replay predicts.
    is_replayed: bool,
    /// Torques of a moving arm.
    dynamics: bool,
}

impl Shows {
    fn of(diagnosis: &Diagnosis) -> Self {
        let has = |begins: &[&str]| {
            let mut channels = diagnosis.gap.channels.iter();
            channels.any(|of| begins.iter().any(|begin| of.channel.starts_with(begin)))
        };
        let is_replayed = has(&["out", "cable", "position", "orientation"]);
        Self {
            geometry: is_replayed || has(&["contact"]),
            is_replayed,
            dynamics: !diagnosis.own_model.is_empty(),
        }
    }
}

/// Commands that go on from here; `repaired`: the log without its faults.
pub(super) fn commands(
    diagnosis: &Diagnosis,
    record: &Record,
    repaired: Option<&str>,
) -> Vec<NextCommand> {
    let (device, fit) = (record.typed(&DEVICE_FLAGS), record.typed(&FIT_FLAGS));
    let logs = record.typed(&["--log"]);
    let shows = Shows::of(diagnosis);
    let is_corrected = diagnosis.corrected.is_some();
    // `identify` takes one log
    let of_log = |argument: &&String| argument.starts_with("--log=");
    let is_one = record.arguments.iter().filter(of_log).count() == 1;
    let is_calibrated = diagnosis.verdict == Verdict::NoGap;
    let all = [
        (
            repaired.is_some() && shows.geometry,
            ("identify", "Calibrate from the log without its faults:"),
            format!(
                "haptical identify{device} --log {} --out result",
                repaired.unwrap_or_default()
            ),
        ),
        (
            is_settled_by_plan(diagnosis),
            (
                "plan",
                "Choose the recording that tells the candidates apart:",
            ),
            format!("haptical plan{device}{logs} --settle gap.json --out next"),
        ),
        (
            is_corrected && is_one && shows.geometry && are_fitted_by_identify(diagnosis),
            ("fit", "Fit the causes together with geometry and drives:"),
            format!("haptical identify{fit} --with gap.json --out result"),
        ),
        (
            is_corrected && shows.is_replayed,
            (
                "check",
                "Check the corrected device on a log that nobody has seen:",
            ),
            "haptical simulate --device corrected.toml --replay NEW_LOG --out predicted.csv"
                .to_owned(),
        ),
        (
            is_corrected && !shows.is_replayed,
            (
                "check",
                "Check the corrected device on a log that nobody has seen:",
            ),
            format!(
                "haptical diagnose{device} --model corrected.toml --log NEW_LOG --out gap-after"
            ),
        ),
        (
            is_corrected,
            ("use", "Put it into a simulator:"),
            "haptical export --device corrected.toml --format mjcf --out model.xml".to_owned(),
        ),
        (
            is_calibrated && is_one && shows.geometry,
            ("identify", "The identified device of these data:"),
            format!("haptical identify{fit} --out result"),
        ),
        (
            is_calibrated && is_one && shows.dynamics,
            (
                "identify",
                "Friction, armatures and masses of these data in a device file:",
            ),
            format!("haptical identify{device}{logs} --with dynamics --out dynamics"),
        ),
    ];
    let those = all.into_iter().filter(|(is_one, ..)| *is_one);
    those
        .map(|(_, (label, purpose), command)| NextCommand {
            label,
            purpose,
            command,
        })
        .collect()
}

/// Whether `plan` can choose the recording that tells candidates apart: it places the handle.
pub(super) fn is_settled_by_plan(diagnosis: &Diagnosis) -> bool {
    Shows::of(diagnosis).geometry && haptical_diagnosis::Question::of(diagnosis).is_some()
}

/// Whether `identify` fits the named causes together with geometry and drives: it takes none of torques and forces.
fn are_fitted_by_identify(diagnosis: &Diagnosis) -> bool {
    let is_left = |hook| matches!(hook, Hook::Torque | Hook::ForceSensor | Hook::Readings);
    let is_taken = |name: &str| specs().any(|spec| spec.name == name && !is_left(spec.hook));
    let mut causes = diagnosis.causes.iter();
    diagnosis.verdict == Verdict::Named && causes.all(|cause| is_taken(&cause.effect))
}
