//! A log's motion out of its torques or commands: how far a device's equations of motion drift from it.

mod drift;
mod inputs;
mod predict;
mod told;

use haptical_model::{Device as Model, GivenInertia, Missing, ModelError, Segments};
use haptical_simulator::{ControllerFile, ForwardModel};
use serde::Serialize;

pub use self::drift::{Drift, JointDrift};
use self::inputs::Inputs;
use self::predict::Prediction;
use crate::device::Device;
use crate::error::Error;
use crate::log::Log;

/// Times after which a prediction begins again from the log's state \[s\]; the whole of each run is one more.
pub const HORIZONS_S: [f64; 4] = [0.1, 0.5, 1.0, 5.0];
/// The one of them whose predictions are kept row by row \[s\].
pub const KEPT_HORIZON_S: f64 = 1.0;
/// Windows in which the step is halved.
const CHECKED_WINDOWS: usize = 10;

/// What moves the devices.
#[derive(Debug, Clone, Copy, Default)]
pub enum Drive<'c> {
    /// The torques of the log, in straight lines from row to row.
    #[default]
    Torques,
    /// A controller that follows the commands of the log (`command1_rad`, ...). It has the gravity of the first device.
    Controller(&'c ControllerFile),
}

/// How far devices drift from a log.
#[derive(Debug, Clone, Serialize)]
pub struct Forward {
    /// Device by device.
    pub devices: Vec<ForwardDevice>,
    /// What is odd.
    #[serde(skip)]
    pub warnings: Vec<String>,
    /// Rows of the log that begin a window of [`KEPT_HORIZON_S`].
    #[serde(skip)]
    pub starts: Vec<usize>,
}

/// Predictions of one device.
#[derive(Debug, Clone, Serialize)]
pub struct ForwardDevice {
    /// What it is called: `before`, `after`.
    pub name: String,
    /// The shortest horizon first, the whole log last.
    pub drifts: Vec<Drift>,
    /// Step of the integration \[s\].
    pub step_s: f64,
    /// Root mean square by which half the step moves the predictions of [`KEPT_HORIZON_S`], joint by joint \[rad\], \[m\].
    pub halved_step_moves: Vec<f64>,
    /// Predicted positions of each joint, begun again every [`KEPT_HORIZON_S`], row by row; NaN where there is none.
    #[serde(skip)]
    pub theta: Vec<Vec<f64>>,
    /// Torques of the controller, likewise; empty without one.
    #[serde(skip)]
    pub torque: Vec<Vec<f64>>,
}

/// Moves devices through a log: from its state at the start of each window, under its torques or its commands, and compares
/// with its positions.
///
/// Positions and velocities of the log are those of local cubics through seven rows ([`haptical_effects::signal`]). A drive
/// gives the log's torque less `torque_offset_nm`, `torque_delay_s` before it was logged.
///
/// ```no_run
/// use haptical::{Device, Drive, Log, forward};
/// let nominal = Device::load("nominal.toml")?;
/// let corrected = Device::load("corrected.toml")?;
/// let log = Log::read("log.csv", &nominal)?;
/// let told = forward(&[("before", &nominal), ("after", &corrected)], &log, Drive::Torques)?;
/// for device in &told.devices {
///     println!("{}: joint 1 drifts by {} rad", device.name, device.drifts[0].joints[0].rms);
/// }
/// # Ok::<(), haptical::Error>(())
/// ```
///
/// # Errors
/// A log without times, torques or commands; a device without masses, inertias or gravity; other joints in a further device.
///
/// # Panics
/// Without a device.
pub fn forward(devices: &[(&str, &Device)], log: &Log, drive: Drive<'_>) -> Result<Forward, Error> {
    let (_, nominal) = devices[0];
    let joints = devices.iter().flat_map(|(_, own)| &own.model.joints);
    let delays_s: Vec<f64> = joints.filter_map(|own| own.torque_delay_s).collect();
    let inputs = Inputs::new(nominal, log, drive, &delays_s)?;
    let mut told = Forward {
        devices: Vec::new(),
        warnings: inputs.warnings.clone(),
        starts: Vec::new(),
    };
    let controller = match drive {
        Drive::Torques => None,
        Drive::Controller(file) => Some(file.of(&nominal.model)),
    };
    let controller = controller.transpose();
    let controller = controller.map_err(|error| refusal(&error, nominal))?;
    for (name, device) in devices {
        crate::refuse_other_device(&nominal.model, &device.model, &device.source().path)?;
        let refuse = |error: ModelError| refusal(&error, device);
        let runs = inputs.runs();
        let models = (0..runs).map(|run| ForwardModel::of_device(&device.model, (run, runs)));
        let models = models.collect::<Result<Vec<_>, _>>().map_err(refuse)?;
        let said = said(name, &device.model, models.first());
        told.warnings.extend(said);
        let prediction = Prediction {
            inputs: &inputs,
            models: &models,
            controller: controller.as_ref(),
        };
        let made = prediction.device(name, &mut told.starts);
        told.devices.push(made.map_err(refuse)?);
    }
    Ok(told)
}

/// What is not as it seems.
fn said(name: &str, device: &Model, model: Option<&ForwardModel>) -> Vec<String> {
    let left_out = model.map_or(&[][..], ForwardModel::left_out).join(", ");
    let segments = Segments::of_device(device);
    let rows = segments.iter().flat_map(|own| &own.rows).enumerate();
    let points = rows.filter(|(_, own)| {
        let weighs = own.body.filter(|own| own.mass_kg > 0.0);
        weighs.is_some_and(|own| own.given_inertia() == GivenInertia::Point)
    });
    let points: Vec<String> = points.map(|(row, _)| (row + 1).to_string()).collect();
    let joints = device.joints.iter();
    let bare = joints.filter(|joint| joint.armature_kgm2.is_none());
    let bare: Vec<&str> = bare.map(|joint| joint.name.as_str()).collect();
    let said = [
        ("not part of the motion: ", left_out, ""),
        (
            "the inertia of the rows ",
            points.join(", "),
            " is given as 0: points here, where a diagnosis takes rods",
        ),
        (
            "no armature_kgm2 of the joints ",
            bare.join(", "),
            ": their rotors and gears weigh nothing here",
        ),
    ];
    let said = said.into_iter().filter(|(_, names, _)| !names.is_empty());
    said.map(|(before, names, after)| format!("{name}: {before}{names}{after}"))
        .collect()
}

fn refusal(error: &ModelError, device: &Device) -> Error {
    let is_no_body = |own: &Missing| matches!(own, Missing::Body { .. });
    let next = match error {
        ModelError::Unweighed { missing, .. } if missing.iter().all(is_no_body) => {
            "correct these inertias (`haptical check` names their links): a prediction with them means nothing"
        }
        ModelError::Unweighed { .. } => {
            "give what is missing in the device file, or take a URDF or MJCF with inertias"
        }
        _ => "correct the device file",
    };
    Error::in_file("device", error.to_string(), &device.source().path, next).with_equipment(device)
}
