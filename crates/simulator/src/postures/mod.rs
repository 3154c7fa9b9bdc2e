//! Recordings of single postures: each sensor, touches of points and planes, links held by a fixture.

pub(crate) mod places;
mod reach;
mod readings;
mod rows;
pub(crate) mod sensors;

use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{AddedReadings, Device, Evaluation, ModelError, Mount, Recording};

use crate::SimulatorError;
use crate::postures::reach::{Target, reach};
use crate::postures::rows::{Held, fixture, mounts, offset, sum_of};
use crate::postures::sensors::{PostureSensors, UNSTATED_SD};

/// Steps of a held joint.
const HELD_STEPS: usize = 60;
/// Tolerance of a held angle \[rad, m\], rounding.
const HELD: f64 = 1e-13;

/// A recording of single postures in the making: first the postures in which the true device does what is asked, then
/// what its sensors show there.
///
/// Rows of the recording that is asked for say what happens in them as those of a log do: `contact` and `plane` name what
/// the handle touches, `tool` what is on it, `hand` which hand, `run` where the tracker stands, `fixture2_rad` the angle
/// that a fixture holds joint 2 at. A row with a touch or a held angle begins at the joint readings that are asked for, and
/// ends where the true device meets it within the joints' limits, as an operator would lead it there; the others stay
/// where they are.
///
/// What no file places is put somewhere: a touched point or plane where the handle of the planned device is in its rows
/// (a known distance or angle of a pair is met), a tracker and what it sees by chance ([`with_places_of`](crate::with_places_of)
/// takes places of files).
///
/// Effects of the device are the caller's: [`PostureSimulation::exact`] has none of them, and
/// [`PostureSimulation::meet`] takes what they show of the touches. Source: docs/equations.md, Postures that touch.
///
/// # Examples
/// ```
/// use haptical_simulator::model::{Device, Recording};
/// use haptical_simulator::{PostureSensors, PostureSimulation};
/// let row = "[[link]]\na_m = 0.3\nalpha_rad = 0.0\nd_m = 0.0\n";
/// let text = format!("{row}{row}{row}[[joint]]\n[[joint]]\n[contact]\nsd_m = 1e-12\n");
/// let truth = Device::from_toml(&text.replacen("0.3", "0.31", 1), "truth.toml")?.device;
/// let planned = Device::from_toml(&text, "planned.toml")?.device;
/// let asked = Recording {
///     line: vec![2, 3],
///     joint: vec![vec![0.2, 0.9], vec![0.7, -0.7]],
///     contact: Some(vec!["socket".to_owned(); 2]),
///     ..Recording::default()
/// };
/// let sensors = PostureSensors { outputs: vec![false; 2], ..PostureSensors::default() };
/// let simulation = PostureSimulation::new(&truth, &planned, &asked, sensors, 1)?;
/// let recording = simulation.exact()?;
/// let tips = haptical_simulator::true_poses(&truth, &recording)?;
/// assert!((tips[0].position_m - tips[1].position_m).norm() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct PostureSimulation {
    truth: Device,
    sensors: PostureSensors,
    /// The rows that are asked for and met.
    asked: Recording,
    mounts: Vec<Mount>,
    /// What the noise of each row's touch is, in standard deviations.
    touch: Vec<[f64; 3]>,
    held: Vec<Held>,
    /// Readings at which the rows do what is asked of them.
    met: Vec<Vec<f64>>,
    left_out: Vec<usize>,
    seed: u64,
}

impl PostureSimulation {
    /// Finds the postures of a true device. `planned` is the device that they were planned for.
    ///
    /// # Errors
    /// [`SimulatorError`]: a device without links that is to touch something, things that are reached at none of their
    /// postures, a plane of too few postures, postures at which the device has no value.
    pub fn new(
        truth: &Device,
        planned: &Device,
        asked: &Recording,
        sensors: PostureSensors,
        seed: u64,
    ) -> Result<Self, SimulatorError> {
        let rows = asked.len();
        let unknown = || vec![f64::NAN; rows];
        let mut asked = asked.clone();
        asked.position_m = sensors.position.then(|| [(); 3].map(|()| unknown()));
        asked.orientation_wxyz = sensors.orientation.then(|| [(); 4].map(|()| unknown()));
        asked.added.clear();
        let touches = asked.contact.is_some() || asked.plane.is_some();
        if !truth.has_links() && (touches || sensors.position || sensors.orientation) {
            let what =
                "the device has no [[link]]: nothing that is touched or tracked can be simulated";
            return Err(SimulatorError::NoPosture {
                what: what.to_owned(),
            });
        }
        let mut truth = truth.clone();
        places::place_seen(&mut truth, &asked, seed);
        places::place_touched(&mut truth, planned, &asked, seed)?;
        let mounts = mounts(&truth, &asked)?;
        let held = (0..truth.joints.len()).filter_map(|joint| {
            let angle = fixture(&asked, joint)?.clone();
            let noise = readings::fixture_noise(rows, joint, seed);
            Some(Held {
                joint,
                angle,
                noise,
            })
        });
        let mut simulation = Self {
            held: held.collect(),
            touch: readings::touch_noise(rows, seed),
            met: Vec::new(),
            left_out: Vec::new(),
            truth,
            sensors,
            asked,
            mounts,
            seed,
        };
        let found = simulation.find(&[])?;
        simulation.keep(found)?;
        Ok(simulation)
    }

    /// The true device with a place for everything that its log is about.
    pub fn device(&self) -> &Device {
        &self.truth
    }

    /// Rows that were asked for, from 0, and at which the true device does not get to what it is to touch.
    pub fn left_out(&self) -> &[usize] {
        &self.left_out
    }

    /// Finds the postures again where effects displace the handle: `shown` is what they show in the channels `contact`,
    /// `plane` and `fixture1`, ... at the postures so far ([`AddedReadings::readings`]). Repeated until nothing changes
    /// it ends where readings and effects together meet what is touched. Returns the largest change of a joint reading.
    ///
    /// # Errors
    /// [`SimulatorError::NotMet`] for a row that does not get there.
    pub fn meet(&mut self, shown: &[AddedReadings]) -> Result<f64, SimulatorError> {
        let mut largest: f64 = 0.0;
        for (row, found) in self.find(shown)?.into_iter().enumerate() {
            let found = found.ok_or_else(|| SimulatorError::NotMet {
                row,
                what: self.touched(row),
            })?;
            let changes = found.iter().zip(&self.met[row]);
            largest = changes.fold(largest, |most, (new, old)| most.max((new - old).abs()));
            self.met[row] = found;
        }
        Ok(largest)
    }

    /// What every sensor shows at the postures, without noise and without effects.
    ///
    /// # Errors
    /// [`SimulatorError::Row`].
    pub fn exact(&self) -> Result<Recording, SimulatorError> {
        let mut asked = self.asked.clone();
        for (row, readings) in self.met.iter().enumerate() {
            for (column, reading) in asked.joint.iter_mut().zip(readings) {
                column[row] = *reading;
            }
        }
        readings::exact(&self.truth, &asked, &self.sensors, &self.mounts)
    }

    /// Rounds and disturbs an exact recording as the device describes its sensors.
    ///
    /// # Errors
    /// [`SimulatorError::NonFinite`], [`SimulatorError::Value`].
    pub fn disturb(&self, recording: &mut Recording) -> Result<(), SimulatorError> {
        readings::disturb(&self.truth, recording, self.seed)
    }

    /// Keeps the rows that were met.
    fn keep(&mut self, found: Vec<Option<Vec<f64>>>) -> Result<(), SimulatorError> {
        let rows = || found.iter().enumerate();
        let kept: Vec<usize> = rows()
            .filter_map(|(row, own)| own.as_ref().map(|_| row))
            .collect();
        self.left_out = rows()
            .filter_map(|(row, own)| own.is_none().then_some(row))
            .collect();
        for &row in &self.left_out {
            let what = self.touched(row);
            if !kept.iter().any(|&other| self.touched(other) == what) {
                let postures = (0..found.len()).filter(|&other| self.touched(other) == what);
                return Err(SimulatorError::OutOfReach {
                    postures: postures.count(),
                    what,
                });
            }
        }
        if self.left_out.is_empty() {
            self.met = found.into_iter().flatten().collect();
            return Ok(());
        }
        let lines_count = self.asked.tool.is_none()
            && self
                .truth
                .surroundings
                .tools
                .iter()
                .any(|tool| tool.from_line.is_some());
        if let (Some(&row), true) = (self.left_out.first(), lines_count) {
            // without it the lines of [[tool]] would mean other rows
            return Err(SimulatorError::NotMet {
                row,
                what: self.touched(row),
            });
        }
        self.asked = self.asked.select(&kept);
        let pick = |all: &[f64]| kept.iter().map(|&row| all[row]).collect();
        self.touch = kept.iter().map(|&row| self.touch[row]).collect();
        for held in &mut self.held {
            (held.angle, held.noise) = (pick(&held.angle), pick(&held.noise));
        }
        self.mounts = match self.mounts.is_empty() {
            true => Vec::new(),
            false => kept.iter().map(|&row| self.mounts[row]).collect(),
        };
        self.met = found.into_iter().flatten().collect();
        Ok(())
    }

    /// What a row is to meet, in words.
    fn touched(&self, row: usize) -> String {
        let named = |ids: &Option<Vec<String>>, kind: &str| {
            let id = ids.as_ref().map_or("", |ids| &ids[row]);
            (!id.is_empty()).then(|| format!("{kind} `{id}`"))
        };
        let touched = [
            named(&self.asked.contact, "contact"),
            named(&self.asked.plane, "plane"),
        ];
        let words: Vec<String> = touched.into_iter().flatten().collect();
        match words.is_empty() {
            true => "the fixture's angle".to_owned(),
            false => words.join(" and "),
        }
    }

    /// The readings of each row at which it does what is asked; none where it does not get there.
    fn find(&self, shown: &[AddedReadings]) -> Result<Vec<Option<Vec<f64>>>, SimulatorError> {
        let mut evaluation = Evaluation::new(&self.truth);
        let mut start = vec![0.0; self.truth.joints.len()];
        let mut found = Vec::with_capacity(self.asked.len());
        for row in 0..self.asked.len() {
            self.asked.read_joints(row, &mut start);
            evaluation.choose_hand(self.truth.hand_at(&self.asked, row));
            let refuse = |source| SimulatorError::Row { row, source };
            let is_held = self.held.iter().any(|held| held.angle[row].is_finite());
            let target = self.target(row, shown, &mut evaluation, &start)?;
            found.push(match target {
                Some(_) if is_held => return Err(SimulatorError::HeldTouch { row }),
                Some(target) => reach(&self.truth, &mut evaluation, &start, &target),
                None if is_held => self
                    .hold(row, shown, &mut evaluation, &start)
                    .map_err(refuse)?,
                None => {
                    evaluation.move_pose_to(&start).map_err(refuse)?;
                    Some(start.clone())
                }
            });
        }
        Ok(found)
    }

    /// What the handle is to meet in a row; none where it touches nothing.
    fn target(
        &self,
        row: usize,
        shown: &[AddedReadings],
        evaluation: &mut Evaluation<'_>,
        start: &[f64],
    ) -> Result<Option<Target>, SimulatorError> {
        let around = &self.truth.surroundings;
        let id = |ids: &Option<Vec<String>>| ids.as_ref().map(|ids| ids[row].clone());
        let point = id(&self.asked.contact).and_then(|id| around.contact_index(&id));
        let plane = id(&self.asked.plane).and_then(|id| around.plane_index(&id));
        if point.is_none() && plane.is_none() {
            return Ok(None);
        }
        let mount = self.mounts.get(row).copied().unwrap_or_default();
        let mut target = Target {
            arm_m: self.truth.touching_m(mount),
            ..Target::default()
        };
        let noise = self.touch[row];
        if let Some(point) = point {
            let refuse = |source| SimulatorError::Row { row, source };
            evaluation.move_pose_to(start).map_err(refuse)?;
            // points are read along the axes of the robot's base
            let base = evaluation.base_pose().map_err(refuse)?.rotation;
            let sd_m = around.contact_sd_m.unwrap_or(UNSTATED_SD);
            let off = Vector3::from_fn(|axis, _| {
                sd_m * noise[axis] - sum_of(shown, "contact", axis, row)
            });
            let place = Vector3::from(around.contacts[point].position_m);
            target.add_point(&(place + base * off));
        }
        if let Some(plane) = plane {
            let sd_m = around.plane_sd_m.unwrap_or(UNSTATED_SD);
            let off_m = sd_m * noise[0] - sum_of(shown, "plane", 0, row);
            let plane = &around.planes[plane];
            let normal = plane.normal_and_slopes().0;
            target.along.push((normal, plane.offset_m + off_m));
        }
        Ok(Some(target))
    }

    /// The readings at which links are at the angles that fixtures hold them at.
    fn hold(
        &self,
        row: usize,
        shown: &[AddedReadings],
        evaluation: &mut Evaluation<'_>,
        start: &[f64],
    ) -> Result<Option<Vec<f64>>, ModelError> {
        let mut readings = start.to_vec();
        let sd = self
            .truth
            .surroundings
            .fixture_sd_rad
            .unwrap_or(UNSTATED_SD);
        for held in self.held.iter().filter(|held| held.angle[row].is_finite()) {
            let joint = held.joint;
            let channel = format!("fixture{}", joint + 1);
            let off = sd * held.noise[row] - sum_of(shown, &channel, 0, row);
            let wanted = held.angle[row] + off - offset(&self.truth, joint);
            readings[joint] = wanted;
            let mut is_met = false;
            for _ in 0..HELD_STEPS {
                evaluation.move_joint(joint, readings[joint])?;
                let gap = wanted - evaluation.output_rad(joint);
                is_met = gap.abs() <= HELD * wanted.abs().max(1.0);
                if is_met {
                    break;
                }
                readings[joint] += gap;
            }
            if !is_met {
                return Ok(None);
            }
        }
        evaluation.move_pose_to(&readings)?;
        Ok(Some(readings))
    }
}
