//! What a device at rest carries: its masses under gravity, and the hand.

use haptical_kinematics::nalgebra::Vector3;
use haptical_kinematics::{KinematicsError, Pose, Twist};

use crate::{Body, Device, DeviceChain, Drive, JointType};

/// What a device at rest carries: its masses under gravity, and the hand.
///
/// The one place where torques are computed from statics: a calibration's compliances and a diagnosis's are
/// those of the same torques.
///
/// ```
/// use haptical_model::{Device, Statics};
/// let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
///     [[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = 2.0\ncentre_of_mass_m = [0.3, 0.0, 0.0]\n\
///     [[joint]]\n[gravity]\nvector_mps2 = [0.0, -10.0, 0.0]\n";
/// let lever = Device::from_toml(text, "lever.toml")?.device;
/// let mut statics = Statics::new(&lever);
/// let load = statics.load(&[0.0], |_| None)?;
/// // held up by the drive, pulled down about the base
/// assert!((load.torques_nm[0] - 6.0).abs() < 1e-12);
/// assert!((load.base_moment_nm.z + 6.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Statics {
    /// One for each hand, then those to masses that are on no hand's chain.
    chains: Vec<Carrier>,
    hands: usize,
    hand: usize,
    rows: Vec<Row>,
    /// Of the chain that is looked at: variables and screws of its moving rows, frames of all its rows.
    variables: Vec<f64>,
    screws: Vec<Twist>,
    frames: Vec<Pose>,
    torques_nm: Vec<f64>,
    beyond: Vec<Beyond>,
}

/// A chain with the masses that are looked at along it.
#[derive(Debug, Clone)]
struct Carrier {
    chain: DeviceChain,
    masses: Vec<Mass>,
}

/// A mass of a row.
#[derive(Debug, Clone)]
struct Mass {
    /// Row of the chain.
    place: usize,
    /// Behind the row's turn about z \[m\].
    centre_m: Vector3<f64>,
    /// Whether the row's variable is a slide along z, which carries the centre.
    slides: bool,
    weight_n: Vector3<f64>,
}

impl Mass {
    /// Where it is, from the turned frames and the variables of its chain.
    fn place_m(&self, frames: &[Pose], variables: &[f64]) -> Vector3<f64> {
        let frame = &frames[self.place];
        let slide_m = if self.slides {
            variables[self.place - 1]
        } else {
            0.0
        };
        frame.position_m + frame.rotation * (self.centre_m + slide_m * Vector3::z())
    }
}

/// A row of the device but row 0, with what pulls at it and at all rows behind it.
#[derive(Debug, Clone)]
struct Row {
    parent: usize,
    drive: Option<Drive>,
    /// Whether no row before it moves with its joint.
    is_first: bool,
    screw: Twist,
    pulled: Beyond,
}

/// What pulls at the parts beyond a joint: their weights and the hand.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Beyond {
    /// Sum of the forces \[N\], frame (-1).
    pub force_n: Vector3<f64>,
    /// Their moment about the origin of frame (-1) \[N m\].
    pub moment_nm: Vector3<f64>,
}

impl Beyond {
    /// Adds a force at a place, both in frame (-1).
    fn bear(&mut self, place_m: &Vector3<f64>, force_n: &Vector3<f64>) {
        self.force_n += force_n;
        self.moment_nm += place_m.cross(force_n);
    }

    fn add(&mut self, other: &Self) {
        self.force_n += other.force_n;
        self.moment_nm += other.moment_nm;
    }

    /// Their moment about a place, both in frame (-1) \[N m\].
    ///
    /// ```
    /// use haptical_model::Beyond;
    /// use haptical_model::kinematics::nalgebra::Vector3;
    /// // 10 N down at 2 m, seen from 0.5 m
    /// let pulled = Beyond { force_n: -10.0 * Vector3::z(), moment_nm: 20.0 * Vector3::y() };
    /// assert_eq!(pulled.moment_about_nm(&(0.5 * Vector3::x())), 15.0 * Vector3::y());
    /// ```
    pub fn moment_about_nm(&self, place_m: &Vector3<f64>) -> Vector3<f64> {
        self.moment_nm - place_m.cross(&self.force_n)
    }
}

/// The weight of a row's mass at one posture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weight {
    /// Row of the device.
    pub row: usize,
    /// Where the mass is, frame (-1).
    pub place_m: Vector3<f64>,
    /// What gravity pulls at it with, frame (-1).
    pub force_n: Vector3<f64>,
}

/// What drives and base bear at one posture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load<'s> {
    /// Torque of each drive \[N m\] (\[N\] where it slides), positive along +theta.
    pub torques_nm: &'s [f64],
    /// What pulls beyond each joint.
    pub beyond: &'s [Beyond],
    /// Moment of weights and hand about the robot's base, the end of row 0 \[N m\], frame (-1).
    pub base_moment_nm: Vector3<f64>,
}

impl Statics {
    /// The masses of a device; without `[gravity]` they weigh nothing. The mass of row 0 stands still.
    pub fn new(device: &Device) -> Self {
        let hands = device.chain_count();
        let chain = |hand| Carrier {
            chain: DeviceChain::of_hand(device, hand),
            masses: Vec::new(),
        };
        let mut chains: Vec<Carrier> = (0..hands).map(chain).collect();
        let gravity = device.gravity_mps2.map(Vector3::from);
        let bodies = device.bodies.iter().enumerate();
        let bodies = bodies.filter_map(|(row, body)| Some((row, (*body)?)));
        let heavy = bodies.filter(|(row, body)| *row > 0 && body.mass_kg > 0.0);
        // the outermost first: a chain to it has the masses before it too
        let mut heavy: Vec<(usize, Body)> = gravity.map_or_else(Vec::new, |_| heavy.collect());
        heavy.reverse();
        for (row, body) in heavy {
            let has = |own: &Carrier| own.chain.place(row).is_some();
            let index = chains.iter().position(has).unwrap_or_else(|| {
                let chain = DeviceChain::to_row(device, row);
                let masses = Vec::new();
                chains.push(Carrier { chain, masses });
                chains.len() - 1
            });
            let own = &mut chains[index];
            let (Some(place), Some(gravity)) = (own.chain.place(row), gravity) else {
                continue;
            };
            // a slide's home is in the chain's row; the row's own offset is behind the centre
            let home_m = own.chain.links[place].d_m - device.links[row].d_m;
            own.masses.push(Mass {
                place,
                centre_m: Vector3::from(body.centre_of_mass_m) + home_m * Vector3::z(),
                slides: device
                    .drive(row)
                    .is_some_and(|drive| drive.motion == JointType::Prismatic),
                weight_n: gravity * body.mass_kg,
            });
        }
        let count = device.links.len();
        Self {
            chains,
            hands,
            hand: 0,
            rows: (1..count).map(|row| Row::new(device, row)).collect(),
            variables: vec![0.0; count.saturating_sub(1)],
            screws: vec![Twist::default(); count.saturating_sub(1)],
            frames: vec![Pose::default(); count],
            torques_nm: vec![0.0; device.joints.len()],
            beyond: vec![Beyond::default(); device.joints.len()],
        }
    }

    /// Chooses the hand (from 0) that the next force is on; the first one without a choice.
    pub fn choose_hand(&mut self, hand: Option<usize>) {
        self.hand = hand.unwrap_or(0).min(self.hands - 1);
    }

    /// Whether gravity pulls at any moving mass.
    pub fn has_weights(&self) -> bool {
        self.chains.iter().any(|own| !own.masses.is_empty())
    }

    /// The load at output angles (one per joint, \[rad\] or \[m\]). `hand` gives the force of the hand on the
    /// handle \[N\], frame (-1), at the handle's pose; none, or one that is not finite, is no force.
    ///
    /// Each chain is walked once for the places of its masses; what pulls at a row is carried on to the row that it hangs
    /// on, from the outermost inwards, and each drive bears what is beyond it (Featherstone 2008, section 5.3, at rest).
    ///
    /// # Errors
    /// [`KinematicsError`] where the chain has no pose.
    pub fn load(
        &mut self,
        outputs: &[f64],
        hand: impl FnOnce(&Pose) -> Option<Vector3<f64>>,
    ) -> Result<Load<'_>, KinematicsError> {
        for row in &mut self.rows {
            row.pulled = Beyond::default();
        }
        let base_m = self.chains[self.hand].chain.part(1)?.pose(&[])?.position_m;
        let mut base = Beyond::default();
        let mut handle = Pose::default();
        for (index, own) in self.chains.iter().enumerate() {
            if index != self.hand && own.masses.is_empty() {
                continue;
            }
            let count = own.chain.drives().len();
            let (variables, screws) = (&mut self.variables[..count], &mut self.screws[..count]);
            let frames = &mut self.frames[..own.chain.row_count()];
            own.chain.variables(outputs, variables);
            let end = own
                .chain
                .chain()?
                .turned_frames(variables, frames, screws)?;
            let rows = own.chain.rows();
            for (row, screw) in rows.iter().skip(1).zip(screws) {
                self.rows[row - 1].screw = *screw;
            }
            for mass in &own.masses {
                let place_m = mass.place_m(frames, variables);
                base.bear(&(place_m - base_m), &mass.weight_n);
                self.rows[rows[mass.place] - 1]
                    .pulled
                    .bear(&place_m, &mass.weight_n);
            }
            if index == self.hand {
                handle = end;
            }
        }
        let hand_n = hand(&handle).filter(|hand_n| hand_n.iter().all(|part| part.is_finite()));
        if let Some(hand_n) = hand_n {
            base.bear(&(handle.position_m - base_m), &hand_n);
            let last = self.chains[self.hand].chain.rows().last();
            let last = last.and_then(|row| self.rows.get_mut(row.checked_sub(1)?));
            if let Some(last) = last {
                last.pulled.bear(&handle.position_m, &hand_n);
            }
        }
        self.carry();
        Ok(Load {
            torques_nm: &self.torques_nm,
            beyond: &self.beyond,
            base_moment_nm: base.moment_nm,
        })
    }

    /// The weights of all moving masses at output angles; none without gravity.
    ///
    /// ```
    /// use haptical_model::{Device, Statics};
    /// let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
    ///     [[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = 2.0\ncentre_of_mass_m = [0.3, 0.0, 0.0]\n\
    ///     [[joint]]\n[gravity]\nvector_mps2 = [0.0, -10.0, 0.0]\n";
    /// let lever = Device::from_toml(text, "lever.toml")?.device;
    /// let weights = Statics::new(&lever).weights(&[0.0])?;
    /// assert_eq!((weights[0].row, weights[0].place_m.x, weights[0].force_n.y), (1, 0.3, -20.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`KinematicsError`] where the chain has no pose.
    pub fn weights(&mut self, outputs: &[f64]) -> Result<Vec<Weight>, KinematicsError> {
        let mut weights = Vec::new();
        for own in self.chains.iter().filter(|own| !own.masses.is_empty()) {
            let count = own.chain.drives().len();
            let (variables, screws) = (&mut self.variables[..count], &mut self.screws[..count]);
            let frames = &mut self.frames[..own.chain.row_count()];
            own.chain.variables(outputs, variables);
            own.chain
                .chain()?
                .turned_frames(variables, frames, screws)?;
            weights.extend(own.masses.iter().map(|mass| Weight {
                row: own.chain.rows()[mass.place],
                place_m: mass.place_m(frames, variables),
                force_n: mass.weight_n,
            }));
        }
        Ok(weights)
    }

    /// Carries what pulls at each row inwards, and gives each drive its part.
    fn carry(&mut self) {
        self.torques_nm.fill(0.0);
        self.beyond.fill(Beyond::default());
        for index in (0..self.rows.len()).rev() {
            let row = &self.rows[index];
            let (parent, pulled) = (row.parent, row.pulled);
            if let Some(drive) = &row.drive {
                let along = match drive.motion {
                    JointType::Prismatic => row.screw.linear.dot(&pulled.force_n),
                    JointType::Revolute => {
                        let moment_nm = pulled.moment_about_nm(&row.screw.linear);
                        row.screw.angular.dot(&moment_nm)
                    }
                };
                self.torques_nm[drive.joint] -= drive.multiplier * along;
                // a joint that moves several rows bears a force once
                if row.is_first {
                    self.beyond[drive.joint].add(&pulled);
                }
            }
            if let Some(parent) = parent.checked_sub(1) {
                self.rows[parent].pulled.add(&pulled);
            }
        }
    }
}

impl Row {
    fn new(device: &Device, row: usize) -> Self {
        let drive = device.drive(row);
        let path = device.path_to(row);
        let joint = |row: &usize| device.drive(*row).map(|drive| drive.joint);
        let mut before = path[..path.len() - 1].iter();
        Self {
            parent: device.parent(row).unwrap_or(0),
            is_first: !before.any(|other| drive.is_some() && joint(other) == joint(&row)),
            drive,
            screw: Twist::default(),
            pulled: Beyond::default(),
        }
    }
}
