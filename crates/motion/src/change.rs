//! What an effect of motion changes of a device's numbers.

use haptical_dynamics::Inertia;
use haptical_model::{Device, RigidBodies};
use nalgebra::{Matrix3, Vector3};

use crate::arm::Arm;
use crate::effect::gravity_axes;
use crate::select::Pick;

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
    /// Gravity has another direction.
    Gravity {
        /// In frame (-1) \[m/s^2\].
        gravity_mps2: [f64; 3],
    },
}

impl Change {
    /// Of an effect that was taken; none where it changes nothing that a device file has.
    pub(crate) fn of(arm: &Arm, pick: &Pick) -> Option<Self> {
        let number = |name: &str| {
            let mut own = pick.numbers.iter().filter(|own| own.0 == name);
            own.next().map(|own| own.1)
        };
        // what no torque feels stays as it is
        let vector =
            |names: [&str; 3]| Vector3::from(names.map(|name| number(name).unwrap_or(0.0)));
        match pick.effect {
            "payload" => {
                let flange = arm.bodies.flange(0)?;
                let mass_kg = number("mass_kg").filter(|mass_kg| *mass_kg > 0.0)?;
                let moment = vector(["moment_x_kg_m", "moment_y_kg_m", "moment_z_kg_m"]);
                // the same about all axes, where it was fitted
                let own_kgm2 = pick.read_off.get(4).copied().unwrap_or(0.0).max(0.0);
                let own = Matrix3::identity() * own_kgm2;
                let point = Inertia::about_centre(mass_kg, &(moment / mass_kg), &own);
                Some(Self::Inertia {
                    body: flange.body?,
                    more: point.seen_from(&flange.pose),
                })
            }
            "link-inertia" => {
                let joint = pick.joint?;
                // of several rows of one joint the pick does not say which it is
                let mut own = (0..arm.body_count())
                    .filter(|body| arm.bodies.drive(*body).is_some_and(|own| own.0 == joint));
                let body = own.next().filter(|_| own.next().is_none())?;
                let (mass_kg, centre_m, inertia) = arm.about_centre(body);
                let now = match number("mass_kg") {
                    Some(more_kg) if mass_kg > 0.0 => Inertia::about_centre(
                        mass_kg + more_kg,
                        &centre_m,
                        &(inertia * (1.0 + more_kg / mass_kg)),
                    ),
                    Some(more_kg) => Inertia::about_centre(more_kg, &centre_m, &inertia),
                    None => {
                        let shift = vector(["centre_x_m", "centre_y_m", "centre_z_m"]);
                        Inertia::about_centre(mass_kg, &(centre_m + shift), &inertia)
                    }
                };
                let before = arm.bodies.masses()[body].inertia.parameters();
                let now = now.parameters();
                let more = std::array::from_fn(|k| now[k] - before[k]);
                Some(Self::Inertia {
                    body,
                    more: Inertia::from_parameters(more),
                })
            }
            "armature" => Some(Self::Armature {
                joint: pick.joint?,
                more_kgm2: number("inertia_kgm2")?,
            }),
            "gravity-direction" => {
                let gravity = arm.bodies.gravity_mps2();
                let [first, second] = gravity_axes(gravity)?;
                let [a, b] = *pick.read_off.first_chunk::<2>()?;
                let size = gravity.norm();
                let turned = (gravity + (first * a + second * b) * size).normalize() * size;
                Some(Self::Gravity {
                    gravity_mps2: turned.into(),
                })
            }
            _ => None,
        }
    }

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
            Self::Gravity { gravity_mps2 } => device.gravity_mps2 = Some(gravity_mps2),
        }
        Some(device)
    }
}
