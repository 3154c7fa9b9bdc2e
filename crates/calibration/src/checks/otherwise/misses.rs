//! What a device misses of a log before any fit, channel by channel.

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, Recording};

use crate::problem::measurement::rotation::rotation_vector;
use crate::start::hand_eye::{closed_form, missed};
use crate::start::points::spread_m;
use crate::start::prepare::handle_poses;
use crate::start::sights::{Frames, Rig, Sight, sights};

/// Fewest rows: through fewer, wrong places and turns fit as well.
pub(super) const LEAST_ROWS: usize = 8;
/// Spread of positions that an error is a share of at least \[m\]: a device file's lengths are known to 5 mm.
const LEAST_SPREAD_M: f64 = 0.1;
/// What the ratio of a transmission may be off by, as a share.
pub(super) const RATIO_OFF: f64 = 0.5;

/// Root mean squares of what is missed: positions, turns \[rad\], cables, external encoders; lengths and encoders over the
/// deviation of what was measured. Not a number where nothing was measured.
#[derive(Debug)]
pub(super) struct Misses {
    all: Vec<f64>,
    /// Whether each row has a pose.
    pub(super) has_poses: bool,
}

impl Misses {
    pub(super) fn new(device: &Device, recording: &Recording) -> Self {
        let poses = device
            .has_links()
            .then(|| handle_poses(device, recording).ok());
        let poses = poses.flatten();
        let has_poses = poses.is_some();
        let poses = poses.unwrap_or_default();
        let mut all = seen(device, recording, &poses).to_vec();
        for (index, distances) in recording.cable_m.iter().enumerate() {
            let anchor_m = device
                .cables
                .get(index)
                .map_or([0.0; 3], |cable| cable.anchor_m);
            let share = |read: &Vec<f64>| cable_share(anchor_m, read, &poses);
            all.push(distances.as_ref().map_or(f64::NAN, share));
        }
        let outputs = recording.output.iter().enumerate();
        all.extend(outputs.map(|(joint, output)| {
            let output = output.as_ref();
            output.map_or(f64::NAN, |output| output_share(recording, joint, output))
        }));
        Self { all, has_poses }
    }

    /// Whether anything was measured that a device can miss.
    pub(super) fn any(&self) -> bool {
        self.all.iter().any(|miss| miss.is_finite())
    }

    /// Root of the sum of squares over some channels.
    pub(super) fn total(&self, is_counted: impl Fn(usize) -> bool) -> f64 {
        let counted = self.all.iter().enumerate();
        let counted = counted.filter(|(channel, miss)| is_counted(*channel) && miss.is_finite());
        counted.map(|(_, miss)| miss * miss).sum::<f64>().sqrt()
    }

    /// Channels in which two logs differ.
    pub(super) fn differ(&self, other: &Self) -> Vec<usize> {
        let pairs = self.all.iter().zip(&other.all).enumerate();
        let differ = pairs.filter(|(_, (a, b))| a.to_bits() != b.to_bits());
        differ.map(|(channel, _)| channel).collect()
    }
}

/// Positions and turns that a tracker saw, by the places of tracker and marker that fit them best.
fn seen(device: &Device, recording: &Recording, poses: &[Pose]) -> [f64; 2] {
    let rig = Rig::new(device, recording);
    let seen = sights(recording, poses, device, &rig);
    if seen.len() < LEAST_ROWS {
        return [f64::NAN; 2];
    }
    let frames = closed_form(&seen, &rig);
    let places: Vec<Vector3<f64>> = seen.iter().filter_map(|sight| sight.position_m).collect();
    let square = missed(&seen, &frames) / places.len() as f64;
    let has_turns = seen.iter().any(|sight| sight.rotation.is_some());
    [
        square.sqrt() / spread_m(&places).max(LEAST_SPREAD_M),
        if has_turns {
            angle_rad(&seen, &frames)
        } else {
            f64::NAN
        },
    ]
}

/// Root mean square angle between what was seen and what the device has.
fn angle_rad(sights: &[Sight], frames: &Frames) -> f64 {
    let turned = sights.iter().filter_map(|sight| {
        let (base, tool) = (&frames.bases[sight.base], &frames.tools[sight.tool]);
        let have = base.rotation * sight.handle.rotation * tool.rotation;
        Some(rotation_vector(&(have.transpose() * sight.rotation?)).norm_squared())
    });
    let (count, sum) = turned.fold((0, 0.0), |(count, sum), square| (count + 1, sum + square));
    (sum / f64::from(count)).sqrt()
}

/// Deviation of what a cable reads from the distance to its exit, over the deviation of the readings: its zero does not count.
fn cable_share(anchor_m: [f64; 3], distances_m: &[f64], poses: &[Pose]) -> f64 {
    let anchor_m = Vector3::from(anchor_m);
    let pairs = poses.iter().zip(distances_m);
    share(
        pairs.map(|(pose, read)| ((pose.position_m - anchor_m).norm(), *read)),
        [1.0; 2],
    )
}

/// The same of an external encoder and the joint's readings, whose ratio may be off by half.
fn output_share(recording: &Recording, joint: usize, output: &[f64]) -> f64 {
    let pairs = pairs_of(recording, joint, output);
    share(pairs, [1.0 - RATIO_OFF, 1.0 + RATIO_OFF])
}

/// A joint's readings with those of an external encoder.
pub(super) fn pairs_of(
    recording: &Recording,
    joint: usize,
    output: &[f64],
) -> impl Iterator<Item = (f64, f64)> {
    let readings = recording.joint.get(joint).map_or(&[][..], Vec::as_slice);
    readings.iter().copied().zip(output.iter().copied())
}

/// Deviation that a line over `x` leaves of `y`, over the deviation of `y`; the line's slope is between two.
fn share(pairs: impl Iterator<Item = (f64, f64)>, [low, high]: [f64; 2]) -> f64 {
    Course::new(pairs).map_or(f64::NAN, |course| {
        let slope = course.slope.clamp(low, high);
        (course.rest + (course.slope - slope).powi(2) * course.ratio).sqrt()
    })
}

/// The line through one column over another.
pub(super) struct Course {
    pub(super) slope: f64,
    /// Part of the variance that it leaves.
    pub(super) rest: f64,
    /// Variance of the column below over that of the other.
    ratio: f64,
}

impl Course {
    /// None where either column does not change, or has few readings.
    pub(super) fn new(pairs: impl Iterator<Item = (f64, f64)>) -> Option<Self> {
        let pairs: Vec<(f64, f64)> = pairs
            .filter(|(x, y)| x.is_finite() && y.is_finite())
            .collect();
        if pairs.len() < LEAST_ROWS {
            return None;
        }
        let count = pairs.len() as f64;
        let (x, y) = pairs.iter().fold((0.0, 0.0), |(x, y), pair| {
            (x + pair.0 / count, y + pair.1 / count)
        });
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for (own_x, own_y) in pairs {
            xx += (own_x - x) * (own_x - x);
            xy += (own_x - x) * (own_y - y);
            yy += (own_y - y) * (own_y - y);
        }
        let course = Self {
            slope: xy / xx,
            rest: (1.0 - xy * xy / (xx * yy)).max(0.0),
            ratio: xx / yy,
        };
        (course.slope.is_finite() && course.rest.is_finite()).then_some(course)
    }
}
