//! Where a device's handle is at rest, row by row: its geometry, what joints yield, and the effects of its posture.

use haptical_effects::device::PostureEffects;
use haptical_kinematics::Twist;
use haptical_kinematics::nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use haptical_model::rigid::rotation_vector;
use haptical_model::{Evaluation, Recording, Wanted, holding_torques_nm};

use super::path::Waypoints;
use crate::device::Device;
use crate::error::Error;

/// A device at the rows of a path.
pub(super) struct Stance<'d> {
    device: &'d Device,
    path: &'d Waypoints,
    effects: PostureEffects,
    /// Row by row, joint by joint; empty where no joint yields.
    torques_nm: Vec<Vec<f64>>,
    moved: Vec<Twist>,
}

impl<'d> Stance<'d> {
    pub(super) fn new(device: &'d Device, path: &'d Waypoints) -> Result<Self, Error> {
        let rows = path.recording();
        let effects = PostureEffects::new(&device.model, rows)
            .map_err(|error| refuse(device, path, &error))?;
        Ok(Self {
            device,
            path,
            effects,
            torques_nm: Vec::new(),
            moved: vec![Twist::default(); rows.len()],
        })
    }

    /// Effects that are left out, a sentence each.
    pub(super) fn left_out(&self) -> Vec<String> {
        let left_out = self.effects.left_out().into_iter();
        let said = left_out.map(|own| format!("effect left out: {own}"));
        said.collect()
    }

    /// Torques that a row's joints yield to; none where nothing yields.
    pub(super) fn torques_nm(&self, row: usize) -> &[f64] {
        self.torques_nm.get(row).map_or(&[], Vec::as_slice)
    }

    /// Works out what bends the arm at these readings.
    pub(super) fn bend(&mut self, readings: &[Vec<f64>]) -> Result<(), Error> {
        let model = &self.device.model;
        let mut rows = self.path.recording().clone();
        for (joint, column) in rows.joint.iter_mut().enumerate() {
            *column = readings.iter().map(|own| own[joint]).collect();
        }
        if model.has_compliance() {
            self.torques_nm = torques_nm(self.device, &rows)?;
        }
        let moved = self.effects.displacements(&rows);
        self.moved = moved.map_err(|error| refuse(self.device, self.path, &error))?;
        Ok(())
    }

    /// Where the unbent handle must be for the bent one to be where it is wanted.
    pub(super) fn unbent(&self, row: usize, wanted: &Wanted) -> Wanted {
        let moved = &self.moved[row];
        Wanted {
            position_m: wanted.position_m - moved.linear,
            rotation: wanted.rotation.map(|own| turn(&-moved.angular) * own),
        }
    }

    /// Whether what bends the arm is the same at these readings, of the rows that count; it is that of these readings
    /// afterwards.
    pub(super) fn settles(
        &mut self,
        readings: &[Vec<f64>],
        limit: f64,
        counts: &[bool],
    ) -> Result<bool, Error> {
        let (moved, torques_nm) = (self.moved.clone(), self.torques_nm.clone());
        self.bend(readings)?;
        let is_same = |row: usize| {
            let (before, now) = (&moved[row], &self.moved[row]);
            let way = (before.linear - now.linear).norm();
            let turn = (before.angular - now.angular).norm();
            let torques = torques_nm.get(row).zip(self.torques_nm.get(row));
            let pairs = torques.into_iter().flat_map(|(a, b)| a.iter().zip(b));
            let yields = pairs.enumerate().map(|(joint, (before, now))| {
                self.device.model.compliance_rad_per_nm(joint) * (before - now).abs()
            });
            yields.fold(way.max(turn), f64::max) <= limit
        };
        let mut rows = (0..readings.len()).filter(|row| counts[*row]);
        Ok(rows.all(is_same))
    }

    /// Poses at readings.
    pub(super) fn poses(&mut self, readings: &[Vec<f64>]) -> Result<Vec<Wanted>, Error> {
        self.bend(readings)?;
        let model = &self.device.model;
        let mut evaluation = Evaluation::new(model);
        let mut poses = Vec::with_capacity(readings.len());
        for (row, readings) in readings.iter().enumerate() {
            evaluation.choose_hand(model.hand_at(self.path.recording(), row));
            evaluation.set_torques(self.torques_nm(row));
            let there = evaluation.move_pose_to(readings);
            let pose = there.and_then(|()| evaluation.pose());
            let pose = pose.map_err(|error| self.path.refuse_row(row, &error))?;
            let moved = &self.moved[row];
            poses.push(Wanted {
                position_m: pose.position_m + moved.linear,
                rotation: Some(turn(&moved.angular) * pose.rotation),
            });
        }
        Ok(poses)
    }

    /// Way \[m\] and turn \[rad\] from the poses at readings to the wanted ones; no turn where any orientation will do.
    pub(super) fn rests(
        &mut self,
        readings: &[Vec<f64>],
        wanted: &[Wanted],
    ) -> Result<Vec<(f64, f64)>, Error> {
        let poses = self.poses(readings)?;
        let rests = poses.iter().zip(wanted).map(|(pose, wanted)| {
            let turns = wanted.rotation.zip(pose.rotation);
            let turn = turns.map_or(0.0, |(wanted, own)| {
                rotation_vector(&(wanted * own.transpose())).norm()
            });
            ((wanted.position_m - pose.position_m).norm(), turn)
        });
        Ok(rests.collect())
    }
}

/// Torques that the joints of each row yield to: the path's, else those that hold masses and hand.
fn torques_nm(device: &Device, rows: &Recording) -> Result<Vec<Vec<f64>>, Error> {
    let held = holding_torques_nm(&device.model, rows).map_err(Error::internal)?;
    let torque = |row: usize, joint: usize| {
        let stated = rows.torque_nm.get(joint).and_then(Option::as_ref);
        let stated = stated.map(|column| column[row]);
        let stated = stated.filter(|own| own.is_finite());
        let held = held.as_ref().map(|columns| columns[joint][row]);
        stated.or(held).unwrap_or(0.0)
    };
    let joints = device.model.joints.len();
    let all = (0..rows.len()).map(|row| (0..joints).map(|joint| torque(row, joint)).collect());
    Ok(all.collect())
}

fn refuse(
    device: &Device,
    path: &Waypoints,
    error: &haptical_effects::device::DeviceEffectError,
) -> Error {
    Error::effect(error, &device.source().path, &path.log.source().path)
}

fn turn(vector: &Vector3<f64>) -> Matrix3<f64> {
    Rotation3::from_scaled_axis(*vector).into_inner()
}

/// The poses of a recording that has positions.
pub(super) fn wanted(recording: &Recording) -> Vec<Wanted> {
    let rows = 0..recording.len();
    let of_row = |row: usize| {
        let position = recording.position_m.as_ref();
        let axes = position.map_or([f64::NAN; 3], |axes| axes.each_ref().map(|axis| axis[row]));
        let rotation = recording.orientation_wxyz.as_ref().map(|parts| {
            let [w, x, y, z] = parts.each_ref().map(|part| part[row]);
            let quaternion = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
            quaternion.to_rotation_matrix().into_inner()
        });
        Wanted {
            position_m: Vector3::from(axes),
            rotation,
        }
    };
    rows.map(of_row).collect()
}

/// A wanted orientation as a quaternion.
pub(super) fn quaternion_wxyz(wanted: &Wanted) -> Option<[f64; 4]> {
    let rotation = Rotation3::from_matrix_unchecked(wanted.rotation?);
    let quaternion = UnitQuaternion::from_rotation_matrix(&rotation).into_inner();
    Some([quaternion.w, quaternion.i, quaternion.j, quaternion.k])
}
