//! What an effect of motion changes of a device's numbers.

use haptical_dynamics::Inertia;
use haptical_model::{Device, JointType, RigidBodies};

/// What an effect changes of a device's numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// A row carries something more.
    Inertia {
        /// Body of [`RigidBodies`], from 0.
        body: usize,
        /// What, in the body's frame.
        more: Inertia,
    },
    /// A joint has another armature.
    Armature {
        /// Joint, from 0.
        joint: usize,
        /// How much more \[kg m^2\].
        more_kgm2: f64,
    },
    /// A joint has another zero.
    Offset {
        /// Joint, from 0.
        joint: usize,
        /// By how much its links stand further than its encoder says \[rad\], \[m\].
        more: f64,
    },
    /// Torques are logged later after their positions.
    TorqueDelay {
        /// Joint, from 0; none: all of them.
        joint: Option<usize>,
        /// By how much \[s\].
        more_s: f64,
    },
    /// A joint's torque reads more.
    TorqueOffset {
        /// Joint, from 0.
        joint: usize,
        /// How much \[N m\], \[N\].
        more_nm: f64,
    },
    /// Gravity has another direction.
    Gravity {
        /// In frame (-1) \[m/s^2\].
        gravity_mps2: [f64; 3],
    },
}

impl Change {
    /// The device with it; none where no body has such numbers.
    ///
    /// ```
    /// use haptical_dynamics::Inertia;
    /// use haptical_motion::Change;
    /// use haptical_model::Device;
    /// let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
    ///     [[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = 2.0\ncentre_of_mass_m = [0.2, 0.0, 0.0]\n\
    ///     inertia_kgm2 = [0.0, 0.02, 0.02, 0.0, 0.0, 0.0]\n[[joint]]\n[gravity]\nvector_mps2 = [0.0, -9.81, 0.0]\n";
    /// let lever = Device::from_toml(text, "lever.toml")?.device;
    /// let mut more = Inertia { mass_kg: 2.0, ..Inertia::default() };
    /// more.first_moment_kgm.x = 0.8; // 2 kg at the tip
    /// more.about_origin_kgm2.m22 = 0.32;
    /// more.about_origin_kgm2.m33 = 0.32;
    /// let loaded = Change::Inertia { body: 0, more }.applied(&lever).ok_or("no body")?;
    /// let body = loaded.bodies[1].ok_or("no mass")?;
    /// assert_eq!((body.mass_kg, body.centre_of_mass_m[0]), (4.0, 0.3 + 5e-17));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn applied(&self, device: &Device) -> Option<Device> {
        let mut device = device.clone();
        match *self {
            Self::Inertia { body, more } => {
                let bodies = RigidBodies::of_device(&device).ok()?;
                let own = bodies.masses().get(body)?;
                let mut whole = own.inertia;
                whole += more;
                if !whole.is_physical() {
                    return None;
                }
                whole.centre_of_mass_m()?;
                let row = own.row;
                device.set_row_inertia(row, &whole).ok()?;
            }
            Self::Armature { joint, more_kgm2 } => {
                let own = device.joints.get_mut(joint)?;
                let whole = own.armature_kgm2.unwrap_or(0.0) + more_kgm2;
                own.armature_kgm2 = Some(whole).filter(|own| *own >= 0.0);
                own.armature_kgm2?;
            }
            Self::Offset { joint, more } => {
                let row = device.own_row(joint)?;
                let link = device.links.get_mut(row)?;
                match device.joints.get(joint)?.joint_type {
                    JointType::Prismatic => link.d_m += more,
                    JointType::Revolute => link.theta_rad += more,
                }
            }
            Self::TorqueDelay { joint, more_s } => {
                let joints = device.joints.iter_mut().enumerate();
                for (_, of) in joints.filter(|(at, _)| joint.is_none_or(|joint| joint == *at)) {
                    of.torque_delay_s = Some(of.torque_delay_s.unwrap_or(0.0) + more_s);
                }
            }
            Self::TorqueOffset { joint, more_nm } => {
                let of = device.joints.get_mut(joint)?;
                of.torque_offset_nm = Some(of.torque_offset_nm.unwrap_or(0.0) + more_nm);
            }
            Self::Gravity { gravity_mps2 } => device.gravity_mps2 = Some(gravity_mps2),
        }
        Some(device)
    }
}
