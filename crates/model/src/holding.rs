//! The torques with which the drives hold a device at rest against gravity and the hand.

use haptical_kinematics::nalgebra::Vector3;
use haptical_kinematics::{KinematicsError, Pose};

use crate::{Device, Recording, Statics};

/// Torques of the drives \[N m\] (\[N\] for a prismatic joint), joint by joint and row by row, that hold the
/// device at rest at the motor-side readings of a recording; positive along +theta.
///
/// With m the mass of a row and c its centre, F the force of the hand on the handle at P (the columns
/// `fx_n`, `fy_n`, `fz_n`, end-effector frame), the torque of joint i is
/// `-(sum_rows m g . dc/dq_i + F . dP/dq_i)` (virtual work; Siciliano et al. 2009, section 7.1), at the angles
/// to which joints with a compliance have yielded. The mass of row 0 stands still. Of a device that branches the masses
/// of all branches count, and the force is that on the hand of the row. `None` where neither masses
/// with gravity nor forces are known.
///
/// ```
/// use haptical_model::{Device, Recording, holding_torques_nm};
/// let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
///     [[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = 2.0\ncentre_of_mass_m = [0.3, 0.0, 0.0]\n\
///     [[joint]]\n[gravity]\nvector_mps2 = [0.0, -10.0, 0.0]\n";
/// let lever = Device::from_toml(text, "lever.toml")?.device;
/// let level = Recording { joint: vec![vec![0.0]], ..Recording::default() };
/// let torques = holding_torques_nm(&lever, &level)?;
/// // 2 kg at 0.3 m, held up
/// assert!((torques.unwrap()[0][0] - 6.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`KinematicsError`] where the chain has no pose.
pub fn holding_torques_nm(
    device: &Device,
    recording: &Recording,
) -> Result<Option<Vec<Vec<f64>>>, KinematicsError> {
    let mut statics = Statics::new(device);
    let force_n = recording.force_n.as_ref();
    if !device.has_links() || (!statics.has_weights() && force_n.is_none()) {
        return Ok(None);
    }
    let rows = recording.len();
    let mut torques = vec![vec![0.0; rows]; device.joints.len()];
    let mut outputs = vec![0.0; device.joints.len()];
    let mut yielded = vec![0.0; device.joints.len()];
    let compliance = |joint| device.compliance_rad_per_nm(joint);
    for row in 0..rows {
        // two hands at one posture are two rows of one load
        let is_same = |column: &Vec<f64>| row > 0 && column[row] == column[row - 1];
        if force_n.is_none() && recording.joint.iter().all(is_same) {
            for column in &mut torques {
                column[row] = column[row - 1];
            }
            continue;
        }
        for (joint, output) in outputs.iter_mut().enumerate() {
            let reading = recording
                .joint
                .get(joint)
                .map_or(f64::NAN, |column| column[row]);
            // a transmission without a value moves its joint by next to nothing here
            *output = reading + device.joints[joint].error_rad(reading).unwrap_or(0.0);
        }
        statics.choose_hand(device.hand_at(recording, row));
        let hand_n = force_n.map(|axes| Vector3::from(axes.each_ref().map(|axis| axis[row])));
        let hand = |handle: &Pose| hand_n.map(|hand_n| handle.rotation * hand_n);
        yielded.copy_from_slice(&outputs);
        for _ in 0..MOST_SETTLINGS {
            let load = statics.load(&yielded, hand)?;
            let mut moved_rad = 0.0_f64;
            for (joint, (column, torque)) in torques.iter_mut().zip(load.torques_nm).enumerate() {
                column[row] = *torque;
                let settled = outputs[joint] - compliance(joint) * torque;
                moved_rad = moved_rad.max((settled - yielded[joint]).abs());
                yielded[joint] = settled;
            }
            if moved_rad <= SETTLED_RAD {
                break;
            }
        }
    }
    Ok(Some(torques))
}

/// Most repetitions of torques and yielding: each leaves a compliance times a stiffness of gravity of the error
/// before, some hundredths.
const MOST_SETTLINGS: usize = 16;
/// A joint that moves by less has settled \[rad\].
const SETTLED_RAD: f64 = 1e-12;
