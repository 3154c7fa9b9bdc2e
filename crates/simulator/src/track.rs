//! What an external tracker sees of a device.

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Rotation3, UnitQuaternion, Vector3};
use haptical_model::{Device, Evaluation, Origin, Placement, Recording};
use rand_chacha::ChaCha8Rng;

use crate::SimulatorError;
use crate::streams::{Stream, normal, uniform};

/// Noise of a tracker whose file states none: of a coordinate \[m\], and of a rotation \[rad\].
pub const UNSTATED_TRACKER_SD: [f64; 2] = [1e-4, 1e-3];
/// How far from the robot a tracker stands whose place is not known \[m\].
pub(crate) const STANDS_AT_M: f64 = 1.5;
/// How far from the handle the thing is that it sees \[m\].
pub(crate) const TOOL_M: f64 = 0.05;

/// Adds positions and orientations of the handle to a recording, as the tracker of the device sees them; nothing for a device
/// without tracker or links. `truth` is the device whose every number is known.
///
/// A place that the file leaves open is drawn: where the tracker stands within 1.5 m in any orientation, what it sees within
/// 5 cm of the handle. Noise is normal, of the stated size, else [`UNSTATED_TRACKER_SD`].
///
/// # Errors
/// [`SimulatorError::Row`] where the device has no value.
///
/// # Examples
/// ```
/// use haptical_simulator::add_tracker;
/// use haptical_simulator::model::{Device, Recording};
/// let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n[[link]]\na_m = 0.5\nalpha_rad = 0.0\nd_m = 0.0\n\
///             [[joint]]\n[tracker]\nbase = \"known\"\ntool = \"known\"\nposition_sd_m = 1e-6\n";
/// let truth = Device::from_toml(text, "lever.toml")?.device;
/// let mut recording = Recording { line: vec![2], joint: vec![vec![0.0]], ..Recording::default() };
/// add_tracker(&truth, &mut recording, 1)?;
/// let [x, ..] = recording.position_m.ok_or("seen")?;
/// assert!((x[0] - 0.5).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn add_tracker(
    truth: &Device,
    recording: &mut Recording,
    seed: u64,
) -> Result<(), SimulatorError> {
    let Some(tracker) = truth.tracker.filter(|_| truth.has_links()) else {
        return Ok(());
    };
    let mut places = Stream::TrackerPlace.open(0, seed);
    let base = place(
        tracker.base_known,
        truth.surroundings.tracker_base,
        (&mut places, STANDS_AT_M),
    );
    let tool = place(
        tracker.tool_known,
        truth.surroundings.tracker_tool,
        (&mut places, TOOL_M),
    );
    let sds = [
        tracker.position_sd_m.unwrap_or(UNSTATED_TRACKER_SD[0]),
        tracker.rotation_sd_rad.unwrap_or(UNSTATED_TRACKER_SD[1]),
    ];
    let mut noise =
        [Stream::TrackerPosition, Stream::TrackerOrientation].map(|stream| stream.open(0, seed));
    let rows = recording.len();
    let mut position_m: [Vec<f64>; 3] = std::array::from_fn(|_| Vec::with_capacity(rows));
    let mut orientation: [Vec<f64>; 4] = std::array::from_fn(|_| Vec::with_capacity(rows));
    let mut evaluation = Evaluation::new(truth);
    let mut readings = vec![0.0; truth.joints.len()];
    for row in 0..rows {
        recording.read_joints(row, &mut readings);
        evaluation.choose_hand(truth.hand_at(recording, row));
        let moved = evaluation.move_pose_to(&readings);
        let refuse = |source| SimulatorError::Row { row, source };
        moved.map_err(refuse)?;
        let seen = base.then(evaluation.pose().map_err(refuse)?).then(&tool);
        for (axis, column) in position_m.iter_mut().enumerate() {
            column.push(seen.position_m[axis] + sds[0] * normal(&mut noise[0]));
        }
        let exact = Rotation3::from_matrix_unchecked(seen.rotation);
        let parts = noisy_orientation(&exact, sds[1], &mut noise[1]);
        for (column, part) in orientation.iter_mut().zip(parts) {
            column.push(part);
        }
    }
    recording.position_m = Some(position_m);
    recording.orientation_wxyz = Some(orientation);
    Ok(())
}

/// One pose after the other.
pub(crate) trait Then {
    /// This pose, then the next one seen from it.
    fn then(&self, next: &Pose) -> Pose;
}

impl Then for Pose {
    fn then(&self, next: &Pose) -> Pose {
        Pose {
            position_m: self.position_m + self.rotation * next.position_m,
            rotation: self.rotation * next.rotation,
        }
    }
}

/// A known place is none at all; an open one is that of the file, or drawn.
fn place(
    is_known: bool,
    stated: Option<Placement>,
    (generator, reach_m): (&mut ChaCha8Rng, f64),
) -> Pose {
    // drawn in any case: what is known of one place moves no other
    let drawn = drawn_place(generator, reach_m);
    if is_known {
        return Pose::default();
    }
    stated.unwrap_or(drawn).pose()
}

/// A place in a box of half this width, turned any way.
pub(crate) fn drawn_place(generator: &mut ChaCha8Rng, reach_m: f64) -> Placement {
    let mut number = |size: f64| size * (2.0 * uniform(generator) - 1.0);
    let position_m = [0, 1, 2].map(|_| number(reach_m));
    let turn_rad = [0, 1, 2].map(|_| number(1.5));
    Placement {
        start: Origin {
            position_m,
            ..Origin::IDENTITY
        },
        turn_rad,
    }
}

/// What an orientation reads like with rotations of this standard deviation \[rad\] about each axis, as w, x, y, z.
pub(crate) fn noisy_orientation(
    exact: &Rotation3<f64>,
    sd_rad: f64,
    generator: &mut ChaCha8Rng,
) -> [f64; 4] {
    let wrong = Vector3::from_fn(|_, _| sd_rad * normal(generator));
    let read = Rotation3::new(wrong) * exact;
    let read = UnitQuaternion::from_rotation_matrix(&read).into_inner();
    [read.w, read.i, read.j, read.k]
}
