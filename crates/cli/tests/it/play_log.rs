//! A simulated log with times, runs, a tracker and gaps, and the pages that play it.

use std::path::PathBuf;
use std::process::Output;

use haptical_data::{JointShape, LogShape, write_log_to};
use haptical_model::{Device, Evaluation, JointType, Recording};
use haptical_simulator::{Noise, Settings, apply_deviations, simulate};

use crate::{haptical, text};

/// Deviations of the true device, of the size of the paper's [m, rad, 1].
const DEVIATIONS: [(&str, f64); 6] = [
    ("a0", 1.9e-3),
    ("d3", -1.3e-3),
    ("alpha2", 1.3e-3),
    ("theta4", 2.0e-3),
    ("ratio_deviation1", -0.025),
    ("output_drum_x2", 2.5e-4),
];

/// Rows of the log.
pub(crate) const ROWS: usize = 60;
/// Row whose cable and out2 cells are empty.
pub(crate) const GAP: usize = 17;
/// First row of the second run.
pub(crate) const SECOND_RUN: usize = 40;
/// Step of the log's time [s].
pub(crate) const STEP_S: f64 = 0.02;

/// A folder with device.toml (nominal), truth.toml and log.csv, which holds exact measurements of
/// the true device.
pub(crate) struct Played {
    folder: tempfile::TempDir,
    pub(crate) nominal: Device,
    pub(crate) truth: Device,
    pub(crate) recording: Recording,
}

impl Played {
    pub(crate) fn new() -> Self {
        Self::with_rows(ROWS)
    }

    pub(crate) fn with_rows(rows: usize) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let template = include_str!("../../assets/haptic7.toml");
        let nominal = Device::from_toml(template, "device.toml").unwrap().device;
        let truth = apply_deviations(&nominal, &DEVIATIONS).unwrap();
        let settings = Settings {
            output_noise: Noise::None,
            cable_noise: Noise::None,
            ..Settings::paper()
        };
        let mut recording = simulate(&truth, &settings, rows, 3).unwrap();
        recording.time_s = Some((0..rows).map(|row| STEP_S * row as f64).collect());
        recording.run = Some((0..rows).map(|row| i64::from(row >= SECOND_RUN)).collect());
        recording.position_m = Some(handles(&truth, &recording));
        recording.cable_m[0].as_mut().unwrap()[GAP] = f64::NAN;
        recording.output[1].as_mut().unwrap()[GAP] = f64::NAN;
        let played = Self {
            folder,
            nominal,
            truth,
            recording,
        };
        played.write("device.toml", template);
        let true_text = played.truth.to_toml(template, "device.toml").unwrap();
        played.write("truth.toml", true_text);
        played.write_log();
        played
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    /// Writes log.csv from the recording as it is now.
    pub(crate) fn write_log(&self) {
        let joints = &self.nominal.joints;
        let shape = LogShape {
            joints: joints
                .iter()
                .map(|joint| JointShape {
                    name: joint.name.clone(),
                    prismatic: joint.joint_type == JointType::Prismatic,
                    lower: joint.lower_rad,
                    upper: joint.upper_rad,
                })
                .collect(),
            cable_count: 1,
            hands: Vec::new(),
        };
        let mut log = Vec::new();
        write_log_to(&mut log, &self.recording, &shape).unwrap();
        self.write("log.csv", log);
    }

    /// `haptical play` of the log to page.html, with further arguments.
    pub(crate) fn play(&self, further: &[&str]) -> Output {
        haptical()
            .current_dir(self.folder.path())
            .args(["play", "--device", "device.toml", "--log", "log.csv"])
            .args(further)
            .output()
            .unwrap()
    }

    /// The page after a run that must go well.
    pub(crate) fn page(&self, further: &[&str]) -> String {
        let mut all = vec!["--out", "page.html"];
        all.extend(further);
        let output = self.play(&all);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        std::fs::read_to_string(self.path("page.html")).unwrap()
    }

    /// Handle of a device and its output angles at a row.
    pub(crate) fn at(&self, device: &Device, row: usize) -> ([f64; 3], Vec<f64>) {
        let readings: Vec<f64> = self
            .recording
            .joint
            .iter()
            .map(|joint| joint[row])
            .collect();
        let mut evaluation = Evaluation::new(device);
        evaluation.move_to(&readings).unwrap();
        let outputs = (0..readings.len()).map(|joint| evaluation.output_rad(joint));
        let handle = evaluation.pose().unwrap().position_m;
        (handle.into(), outputs.collect())
    }
}

/// Handle positions of a device at every row.
fn handles(device: &Device, recording: &Recording) -> [Vec<f64>; 3] {
    let mut evaluation = Evaluation::new(device);
    let mut axes = [const { Vec::new() }; 3];
    for row in 0..recording.len() {
        let readings: Vec<f64> = recording.joint.iter().map(|joint| joint[row]).collect();
        evaluation.move_to(&readings).unwrap();
        let position = evaluation.pose().unwrap().position_m;
        for (axis, value) in axes.iter_mut().zip(position.iter()) {
            axis.push(*value);
        }
    }
    axes
}

/// The data that a page embeds.
pub(crate) fn data(page: &str) -> serde_json::Value {
    let (_, rest) = page.split_once("id=\"data\">").unwrap();
    let (json, _) = rest.split_once("</script>").unwrap();
    serde_json::from_str(json).unwrap()
}
