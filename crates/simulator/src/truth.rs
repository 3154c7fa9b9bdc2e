//! Makes the true device out of a nominal one, and says where its handle is.

use haptical_model::kinematics::Pose;
use haptical_model::{
    Device, Evaluation, ModelError, ParameterId, Recording, TransmissionError, TransmissionKind,
};

use crate::SimulatorError;
use crate::streams::{Stream, normal};

/// A device with deviations added to its parameters.
///
/// Each deviation is a parameter's short name ([`haptical_model::ParameterId::name`], as `alpha4` or
/// `ratio_deviation2`) and what is added to its value, in the parameter's SI unit; a name that comes
/// twice is added twice. A joint with a parallelogram whose device file gives no length deviations
/// has none as parameters; `length_deviation4[1]` (bar 1 to 4 of joint 4, as in the model) makes its
/// error that of a capstan followed by a parallelogram, with the capstan's numbers kept.
///
/// Source: docs/equations.md, Assigned deviations.
///
/// # Errors
/// [`ModelError::NoParameter`] as [`SimulatorError::Model`]; [`SimulatorError::Deviation`].
///
/// # Examples
/// ```
/// use haptical_simulator::{apply_deviations, model::Device};
/// let text = "[[joint]]\ntransmission = \"capstan\"\ntransmission_ratio = 8.0\ndrum_distance_m = 0.07\n";
/// let nominal = Device::from_toml(text, "one.toml")?.device;
/// let truth = apply_deviations(&nominal, &[("ratio_deviation1", 0.02)])?;
/// let error_rad = truth.joints[0].error_rad(1.0)?;
/// assert!((error_rad + 0.02 / 8.02).abs() < 1e-15); // -R_e / (R_e + R) theta
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn apply_deviations(
    nominal: &Device,
    deviations: &[(&str, f64)],
) -> Result<Device, SimulatorError> {
    let mut truth = nominal.clone();
    for &(name, deviation) in deviations {
        give_lengths_if_named(&mut truth, name);
        let parameter = truth.parameter(name)?;
        let nominal = parameter.value(&truth);
        let value = nominal + deviation;
        if !value.is_finite() {
            return Err(SimulatorError::Deviation {
                name: name.to_owned(),
                nominal,
                deviation,
            });
        }
        parameter.set(&mut truth, value);
    }
    Ok(truth)
}

/// A device whose parameters differ from their values by normal numbers, `share` times their plausible size each
/// ([`ParameterId::plausible_size`]).
///
/// # Errors
/// [`SimulatorError::Setting`] for a share that is no finite number from 0; [`SimulatorError::Deviation`].
///
/// # Examples
/// ```
/// use haptical_simulator::{draw_deviations, model::Device};
/// let text = "[[joint]]\ntransmission = \"capstan\"\ntransmission_ratio = 8.0\ndrum_distance_m = 0.07\n";
/// let nominal = Device::from_toml(text, "one.toml")?.device;
/// let ratio = [nominal.parameter("ratio_deviation1")?];
/// let truth = draw_deviations(&nominal, &ratio, 0.2, 1)?;
/// let off = ratio[0].value(&truth);
/// assert!(off != 0.0 && off.abs() < 5.0 * 0.2 * ratio[0].plausible_size(&nominal));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn draw_deviations(
    nominal: &Device,
    parameters: &[ParameterId],
    share: f64,
    seed: u64,
) -> Result<Device, SimulatorError> {
    if !(share >= 0.0 && share.is_finite()) {
        return Err(SimulatorError::Setting {
            setting: "share",
            value: share,
            allowed: "finite, 0 or more",
        });
    }
    let mut generator = Stream::Deviation.open(0, seed);
    let mut truth = nominal.clone();
    for parameter in parameters {
        let deviation = share * parameter.plausible_size(nominal) * normal(&mut generator);
        let before = parameter.value(&truth);
        if !(before + deviation).is_finite() {
            return Err(SimulatorError::Deviation {
                name: parameter.name(nominal),
                nominal: before,
                deviation,
            });
        }
        parameter.set(&mut truth, before + deviation);
    }
    Ok(truth)
}

/// Makes the length deviations of a parallelogram parameters if `name` is one of them.
fn give_lengths_if_named(truth: &mut Device, name: &str) {
    for (index, joint) in truth.joints.iter_mut().enumerate() {
        if joint.transmission == TransmissionKind::Parallelogram
            && joint.parallelogram_lengths_m.is_some()
            && name.starts_with(&format!("length_deviation{}[", index + 1))
            && let TransmissionError::Capstan(capstan) = joint.transmission_error
        {
            joint.transmission_error = TransmissionError::Parallelogram {
                capstan,
                length_deviations_m: [0.0; 4],
            };
        }
    }
}

/// Handle poses of a device in frame (-1), one for each row of a recording.
///
/// The readings are those of the recording. Where they are rounded to counts, the handle was at most
/// half a count of each joint away from these poses when they were recorded. Positions are in m.
/// Source: Baser & Konukseven eq. (4).
///
/// # Errors
/// [`SimulatorError::Row`] where the device has no pose (also where it has no links), or where the
/// recording has another number of joints; [`SimulatorError::ColumnLength`].
///
/// # Examples
/// ```
/// use haptical_simulator::model::{Device, Recording};
/// use haptical_simulator::true_poses;
/// let link = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n";
/// let text = format!("{link}{}[[joint]]\n", link.replace("a_m = 0.0", "a_m = 0.3"));
/// let truth = Device::from_toml(&text, "one.toml")?.device;
/// let recording = Recording { joint: vec![vec![0.0, 0.5]], ..Recording::default() };
/// let poses = true_poses(&truth, &recording)?;
/// assert!((poses[1].position_m.y - 0.3 * 0.5f64.sin()).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn true_poses(truth: &Device, recording: &Recording) -> Result<Vec<Pose>, SimulatorError> {
    let expected = recording.len();
    for (index, column) in recording.joint.iter().enumerate() {
        if column.len() != expected {
            return Err(SimulatorError::ColumnLength {
                joint: index + 1,
                expected,
                got: column.len(),
            });
        }
    }
    let mut evaluation = Evaluation::new(truth);
    let mut readings = vec![0.0; recording.joint.len()];
    (0..expected)
        .map(|row| {
            recording.read_joints(row, &mut readings);
            evaluation
                .move_to(&readings)
                .and_then(|()| evaluation.pose().copied())
                .map_err(|source: ModelError| SimulatorError::Row { row, source })
        })
        .collect()
}
