//! The result of one step, and the torques that exert a wanted force there.

use haptical_kinematics::nalgebra::Vector3;
use haptical_kinematics::{Pose, Twist};

use crate::RuntimeError;

/// A device at one set of readings. Vectors are in frame (-1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State<const JOINTS: usize> {
    /// Corrected joint values, from home: \[rad\], or \[m\] for a prismatic joint.
    pub outputs: [f64; JOINTS],
    /// d(output)/d(reading) of each joint, no unit.
    pub output_slopes: [f64; JOINTS],
    /// The handle's frame.
    pub pose: Pose,
    /// Geometric Jacobian with respect to the outputs, one column per joint. With respect to the
    /// readings each column is multiplied by its joint's slope.
    pub jacobian: [Twist; JOINTS],
}

impl<const JOINTS: usize> State<JOINTS> {
    /// Torques at the joint axes with which the device exerts a force on the hand: `J^T [F; M]`, in Nm,
    /// or in N for a prismatic joint.
    ///
    /// `force_n` acts at the handle's origin, `moment_nm` about it, both in frame (-1). Gravity,
    /// friction and acceleration are not part of it.
    /// Source: Siciliano et al., Robotics: Modelling, Planning and Control, section on statics.
    ///
    /// # Errors
    /// [`RuntimeError::NonFiniteWrench`], [`RuntimeError::TorqueOverflow`].
    ///
    /// ```
    /// use haptical_runtime::{Convention, Joint, Link, Model, Motion, Transmission};
    /// let arm = Link { a_m: 0.3, ..Link::IDENTITY };
    /// let joint = Joint { motion: Motion::Revolute, home: 0.0, transmission: Transmission::Exact };
    /// let model = Model::new(Convention::Standard, Link::IDENTITY, [arm], [joint])?;
    /// let torques_nm = model.step(&[0.0])?.joint_torques_nm([0.0, 2.0, 0.0], [0.0; 3])?;
    /// assert!((torques_nm[0] - 0.6).abs() < 1e-15); // 2 N at 0.3 m
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn joint_torques_nm(
        &self,
        force_n: [f64; 3],
        moment_nm: [f64; 3],
    ) -> Result<[f64; JOINTS], RuntimeError> {
        self.torques_nm(force_n, moment_nm, &[1.0; JOINTS])
    }

    /// The same torques as they load the motors: joint torque times d(output)/d(reading), by the
    /// principle of virtual work. A motor's own torque is this over the nominal transmission ratio.
    ///
    /// # Errors
    /// As [`State::joint_torques_nm`].
    ///
    /// ```
    /// use haptical_runtime::{Capstan, Convention, Joint, Link, Model, Motion, Transmission};
    /// let arm = Link { a_m: 0.3, ..Link::IDENTITY };
    /// let drive = Capstan {
    ///     transmission_ratio: 8.0, drum_distance_m: 0.07, input_drum_denominator_m: 0.07,
    ///     offset: 0.0, ratio_deviation: 2.0, output_drum_xy_m: [0.0; 2], input_drum_xy_m: [0.0; 2],
    /// };
    /// let transmission = Transmission::Capstan(drive);
    /// let joint = Joint { motion: Motion::Revolute, home: 0.0, transmission };
    /// let model = Model::new(Convention::Standard, Link::IDENTITY, [arm], [joint])?;
    /// let torques_nm = model.step(&[0.0])?.reading_torques_nm([0.0, 2.0, 0.0], [0.0; 3])?;
    /// assert!((torques_nm[0] - 0.6 * 0.8).abs() < 1e-15); // the joint turns 8/10 of the reading
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn reading_torques_nm(
        &self,
        force_n: [f64; 3],
        moment_nm: [f64; 3],
    ) -> Result<[f64; JOINTS], RuntimeError> {
        self.torques_nm(force_n, moment_nm, &self.output_slopes)
    }

    // in a program with several callers it is called rather than inlined, with its arrays through memory
    #[inline(always)]
    fn torques_nm(
        &self,
        force_n: [f64; 3],
        moment_nm: [f64; 3],
        factors: &[f64; JOINTS],
    ) -> Result<[f64; JOINTS], RuntimeError> {
        for (quantity, vector) in [("force", force_n), ("moment", moment_nm)] {
            for value in vector {
                if !value.is_finite() {
                    return Err(RuntimeError::NonFiniteWrench { quantity, value });
                }
            }
        }
        let (force_n, moment_nm) = (Vector3::from(force_n), Vector3::from(moment_nm));
        let mut torques_nm = [0.0; JOINTS];
        let columns = self.jacobian.iter().zip(factors);
        for (index, (torque_nm, (column, factor))) in torques_nm.iter_mut().zip(columns).enumerate()
        {
            let sum = factor * (column.linear.dot(&force_n) + column.angular.dot(&moment_nm));
            if !sum.is_finite() {
                return Err(RuntimeError::TorqueOverflow { joint: index + 1 });
            }
            *torque_nm = sum;
        }
        Ok(torques_nm)
    }
}
