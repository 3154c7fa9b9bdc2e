//! Origins of a device's frames at each row of a recording, for drawings of the arm.

use haptical_model::{Device, DeviceChain, Evaluation, Recording};

use crate::CalibrationError;
use crate::error::at_row;
use crate::problem::loads::Loads;

/// Origins of all frames of a device, in frame (-1), for every row of a recording \[m\].
///
/// One entry for each row; in it one point for each frame: frame (-1) itself, the robot base, then
/// the frame behind each joint. There is one point more than the device has links, and the last is
/// the handle. Of a device with several hands the frames are those of the row's hand. The origin of the frame behind row i is the translation of `A_0 A_1 ... A_i`
/// (Baser & Konukseven eq. (4), the product broken off after row i; constant origins
/// of rows are part of it), at the output angles that the
/// device predicts from the motor-side readings (eq. (1), (2)), less what its joints yield to the torques of the log or,
/// without them, to its weights.
///
/// # Errors
/// [`CalibrationError::Row`] where the device has no value at a row, and for the first row of a
/// recording of a device without links.
///
/// # Examples
/// ```
/// use haptical_calibration::frame_origins_m;
/// use haptical_model::{Device, Recording};
///
/// // A lever of 0.2 m on a base 0.1 m above frame (-1).
/// let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.1\n\
///             [[link]]\na_m = 0.2\nalpha_rad = 0.0\nd_m = 0.0\n\
///             [[joint]]\ntransmission = \"direct\"\ntransmission_ratio = 1.0\n";
/// let device = Device::from_toml(text, "lever.toml")?.device;
/// let recording = Recording {
///     line: vec![2],
///     joint: vec![vec![std::f64::consts::FRAC_PI_2]],
///     output: vec![None],
///     ..Recording::default()
/// };
/// let rows = frame_origins_m(&device, &recording)?;
/// assert_eq!(rows[0][..2], [[0.0; 3], [0.0, 0.0, 0.1]]);
/// assert!(rows[0][2][0].abs() < 1e-15 && (rows[0][2][1] - 0.2).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn frame_origins_m(
    device: &Device,
    recording: &Recording,
) -> Result<Vec<Vec<[f64; 3]>>, CalibrationError> {
    let hands = 0..device.hands.len().max(1);
    let chains: Vec<DeviceChain> = hands
        .map(|hand| DeviceChain::of_hand(device, hand))
        .collect();
    let mut variables = vec![0.0; device.links.len().saturating_sub(1)];
    let loads = Loads::new(device, recording)?;
    let mut evaluation = Evaluation::new(device);
    let mut readings = vec![0.0; device.joints.len()];
    let mut outputs = vec![0.0; device.joints.len()];
    let mut rows = Vec::with_capacity(recording.len());
    for row in 0..recording.len() {
        recording.read_joints(row, &mut readings);
        let hand = device.hand_at(recording, row);
        evaluation.choose_hand(hand);
        if let Some(loads) = &loads {
            evaluation.set_torques(loads.of_row(row));
        }
        let refused = at_row(recording, row);
        evaluation.move_pose_to(&readings).map_err(&refused)?;
        let handle = evaluation.pose().map_err(&refused)?.position_m;
        for (joint, output) in outputs.iter_mut().enumerate() {
            let torque_nm = loads.as_ref().map_or(0.0, |loads| loads.of_row(row)[joint]);
            *output =
                evaluation.output_rad(joint) - torque_nm * device.compliance_rad_per_nm(joint);
        }
        let chain = &chains[hand.unwrap_or(0)];
        chain.variables(&outputs, &mut variables);
        let mut origins = Vec::with_capacity(chain.row_count() + 1);
        origins.push([0.0; 3]);
        for last in 0..chain.row_count() - 1 {
            let pose = chain
                .part(last + 1)
                .and_then(|chain| chain.pose(&variables[..last]))
                .map_err(|source| refused(source.into()))?;
            origins.push(pose.position_m.into());
        }
        origins.push(handle.into());
        rows.push(origins);
    }
    Ok(rows)
}
