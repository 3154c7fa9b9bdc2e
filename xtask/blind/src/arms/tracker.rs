//! A tracker beside a measured arm: where it stands, what it is told to follow, what it reads.

use haptical_model::Recording;
use haptical_model::kinematics::nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::random::Random;
use crate::rig::geometry::HandlePose;
use crate::rig::readings::rounded;

/// A place: frame (-1) seen from the tracker.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    turn: Matrix3<f64>,
    shift_m: Vector3<f64>,
}

impl Place {
    /// Anywhere, turned in any way.
    pub(crate) fn anywhere(random: &mut Random) -> Self {
        Self {
            turn: turned(std::f64::consts::PI, random),
            shift_m: direction(random) * random.uniform(0.5, 3.0),
        }
    }

    /// Set up anew, about where it was: from a push to another corner of the cell.
    pub(crate) fn moved(self, random: &mut Random) -> Self {
        let far = random.around(1e-2, 1e3);
        Self {
            turn: turned(far * random.uniform(0.2, 1.0), random) * self.turn,
            shift_m: self.shift_m + direction(random) * far,
        }
    }
}

fn direction(random: &mut Random) -> Vector3<f64> {
    Vector3::new(random.normal(), random.normal(), random.normal()).normalize()
}

fn turned(angle_rad: f64, random: &mut Random) -> Matrix3<f64> {
    *Rotation3::from_scaled_axis(direction(random) * angle_rad).matrix()
}

#[derive(Debug, Clone)]
pub(crate) struct Tracker {
    pub(crate) places: Vec<Place>,
    /// The marker in the handle's frame \[m\], and its axes there.
    pub(crate) tool_m: Vector3<f64>,
    pub(crate) tool_turn: Matrix3<f64>,
    /// Whether it reads orientations too.
    pub(crate) sees_orientation: bool,
    pub(crate) position_sd_m: f64,
    pub(crate) rotation_sd_rad: f64,
}

impl Tracker {
    pub(crate) fn draw(scale_m: f64, random: &mut Random) -> Self {
        Self {
            places: vec![Place::anywhere(random)],
            tool_m: direction(random) * scale_m * random.uniform(0.06, 0.2),
            tool_turn: turned(random.uniform(0.0, 3.0), random),
            sees_orientation: random.unit() < 0.35,
            position_sd_m: 0.0,
            rotation_sd_rad: 0.0,
        }
    }

    /// The marker in frame (-1).
    pub(crate) fn marker_m(&self, handle: &HandlePose) -> Vector3<f64> {
        handle.position_m + handle.rotation * self.tool_m
    }

    /// What it reads of the handle, row by row, with noise.
    pub(crate) fn read(
        &self,
        handles: &[HandlePose],
        run: &[usize],
        random: &mut Random,
        log: &mut Recording,
    ) {
        let mut position_m: [Vec<f64>; 3] = Default::default();
        let mut orientation: [Vec<f64>; 4] = Default::default();
        for (handle, run) in handles.iter().zip(run) {
            let place = self.places[run % self.places.len()];
            let at_m = place.turn * self.marker_m(handle) + place.shift_m;
            for (column, value) in position_m.iter_mut().zip(at_m.iter()) {
                column.push(rounded(value + self.position_sd_m * random.normal(), 1e8));
            }
            if self.sees_orientation {
                let noise = Vector3::new(random.normal(), random.normal(), random.normal());
                let noise = Rotation3::from_scaled_axis(noise * self.rotation_sd_rad);
                let turn = place.turn * handle.rotation * self.tool_turn * noise.matrix();
                let turn = Rotation3::from_matrix_unchecked(turn);
                let quaternion = UnitQuaternion::from_rotation_matrix(&turn);
                let parts = [quaternion.w, quaternion.i, quaternion.j, quaternion.k];
                for (column, value) in orientation.iter_mut().zip(parts) {
                    column.push(rounded(value, 1e9));
                }
            }
        }
        log.position_m = Some(position_m);
        log.orientation_wxyz = self.sees_orientation.then_some(orientation);
    }
}
