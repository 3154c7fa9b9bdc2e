//! Recordings of a device that a hand moves, row by row in any number.

use haptical_model::{Device, Recording};

use crate::effect::Effects;
use crate::motion::channels::{Motor, Output, Scenes, cables, motors, outputs};
use crate::motion::clearance::keep_clear;
use crate::motion::scene::{Hand, Scene};
use crate::motion::settings::{Encoders, MotionSettings};
use crate::sensor::Sensor;
use crate::settings::Settings;
use crate::simulate::{FIRST_LINE, finite};
use crate::streams::Stream;
use crate::waves::Waves;
use crate::{Motion, SimulatorError};

/// Band of the hand's force \[rad/s\]: 0.05 to 1.5 Hz, assumption A46.
const FORCE_BAND_RAD_PER_S: [f64; 2] = [0.314, 9.42];
/// Sines of the hand's force along one axis.
const FORCE_SINES: usize = 12;

/// A hand-guided recording in the making. Memory does not grow with the rows that were made; the way
/// of the hand is kept, a number for every second or so of every joint.
#[derive(Debug, Clone)]
pub struct MotionSimulation<'d> {
    settings: MotionSettings,
    motion: Motion,
    hand: Hand,
    /// The device with every delay that a channel has; the first has none.
    scenes: Vec<Scene<'d>>,
    motors: Vec<Motor>,
    outputs: Vec<Option<Output>>,
    cables: Vec<(usize, Sensor)>,
    torques: Vec<Sensor>,
    forces: [Sensor; 3],
    thermometer: Sensor,
    truth: &'d Device,
    rows: u64,
    row: u64,
}

/// Prepares a hand-guided recording of `truth`, a device whose every number is known.
///
/// | column | value |
/// |---|---|
/// | `time_s` | k / rate |
/// | `joint` | motor-side reading theta, of which a hand-led play or friction is part |
/// | `output` | theta + error(theta) and what effects add, roughness of the drums, noise |
/// | `cable_m` | distance from anchor to handle along the cable's way |
/// | `torque_nm` | drive torque on the link that holds weights and hand and moves the links, joint side |
/// | `force_n` | force of the hand on the handle, in the handle's frame |
/// | `temperature_degc` | if the settings have one |
///
/// What a file does not weigh has neither weight nor inertia. A device without links has no cables, torques and forces; joints have an `output` as in [`crate::simulate`]. Late channels show
/// the motion of an earlier time. The hand keeps `minimum_distance_m` (0.03 m unless
/// [`Encoders::Same`] says otherwise) clear of cables' exits. Source: docs/equations.md, Motion
/// simulation.
///
/// # Errors
/// [`SimulatorError`]: settings, effects or numbers of the device out of range, no way clear of the
/// cables' exits.
///
/// # Examples
/// ```
/// use haptical_simulator::model::{Device, Recording};
/// use haptical_simulator::{Effects, HandMotion, MotionSettings, simulate_motion};
/// let text = "[[joint]]\nlower_rad = -1.0\nupper_rad = 1.0\nexternal_encoder_sd_rad = 1e-4\n";
/// let truth = Device::from_toml(text, "one.toml")?.device;
/// let motion = HandMotion { seconds: 10.0, rate_hz: 100.0, ..HandMotion::default() };
/// let settings = MotionSettings { motion, ..MotionSettings::default() };
/// let mut simulation = simulate_motion(&truth, &Effects::none(), &settings, 1)?;
/// let mut chunk = Recording::default();
/// let mut rows = 0;
/// while simulation.fill(&mut chunk, 256)? > 0 {
///     rows += chunk.len(); // write them somewhere
/// }
/// assert_eq!(rows, 1000);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simulate_motion<'d>(
    truth: &'d Device,
    effects: &Effects,
    settings: &MotionSettings,
    seed: u64,
) -> Result<MotionSimulation<'d>, SimulatorError> {
    let rows = settings.rows()?;
    effects.check_device(truth, settings.temperature.is_some())?;
    let mut motion = Motion::new(truth, &settings.motion, seed)?;
    let clearance_m = match &settings.encoders {
        Encoders::Same(settings) => settings.minimum_distance_m,
        Encoders::Exact | Encoders::Described => Settings::paper().minimum_distance_m,
    };
    keep_clear(&mut motion, truth, settings.motion.seconds, clearance_m)?;
    let mut scenes = Scenes::new(truth, effects.as_slice())?;
    let motors = motors(truth, settings, &mut scenes)?;
    let outputs = outputs(truth, settings, &mut scenes, seed)?;
    let cables = cables(truth, settings, &mut scenes, seed)?;
    let hand = [0, 1, 2].map(|axis| {
        let generator = Stream::HandForce.open(axis, seed);
        let rms_n = settings.force_rms_n;
        Waves::new(generator, FORCE_SINES, FORCE_BAND_RAD_PER_S, rms_n)
    });
    let noisy_torque = |joint| {
        let generator = Stream::MotionTorque.open(joint, seed);
        Sensor::noisy(settings.torque_sd_nm, generator)
    };
    let noisy_force = |axis| {
        let generator = Stream::MotionForce.open(axis, seed);
        Sensor::noisy(settings.force_sd_n, generator)
    };
    let sd_k = settings.temperature.map_or(0.0, |warm| warm.sd_k);
    Ok(MotionSimulation {
        settings: settings.clone(),
        motion,
        hand,
        motors,
        outputs,
        cables,
        torques: (0..truth.joints.len()).map(noisy_torque).collect(),
        forces: [0, 1, 2].map(noisy_force),
        thermometer: Sensor::noisy(sd_k, Stream::Temperature.open(0, seed)),
        truth,
        scenes: scenes.made,
        rows,
        row: 0,
    })
}

/// [`simulate_motion`] to the end, as one recording in memory.
///
/// # Errors
/// As [`simulate_motion`] and [`MotionSimulation::fill`].
pub fn record_motion(
    truth: &Device,
    effects: &Effects,
    settings: &MotionSettings,
    seed: u64,
) -> Result<Recording, SimulatorError> {
    let mut simulation = simulate_motion(truth, effects, settings, seed)?;
    let rows = usize::try_from(simulation.rows()).unwrap_or(usize::MAX);
    let mut recording = Recording::default();
    simulation.fill(&mut recording, rows)?;
    Ok(recording)
}

impl MotionSimulation<'_> {
    /// Rows of the whole recording.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// The way of the hand.
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// A recording without rows that has this recording's columns.
    pub fn no_rows(&self) -> Recording {
        let mut recording = Recording::default();
        self.shape(&mut recording);
        recording
    }

    /// Replaces the rows of `chunk` by the next ones, `rows` at most; how many. At the end there are
    /// none. A chunk that is filled again is not allocated again.
    ///
    /// # Errors
    /// [`SimulatorError::Row`] where the device has no value, [`SimulatorError::NoBalance`] where a
    /// spring is too weak, [`SimulatorError::InsideGuide`], [`SimulatorError::NonFinite`].
    pub fn fill(&mut self, chunk: &mut Recording, rows: usize) -> Result<usize, SimulatorError> {
        self.shape(chunk);
        let left = usize::try_from(self.rows - self.row).unwrap_or(usize::MAX);
        let count = rows.min(left);
        for _ in 0..count {
            self.add_row(chunk)?;
            self.row += 1;
        }
        Ok(count)
    }

    /// Gives a recording this one's columns, without rows.
    fn shape(&self, chunk: &mut Recording) {
        fn cleared(column: &mut Option<Vec<f64>>, is_there: bool) {
            *column = is_there.then(|| {
                let mut column = column.take().unwrap_or_default();
                column.clear();
                column
            });
        }
        let (joints, has_links) = (self.truth.joints.len(), self.truth.has_links());
        chunk.line.clear();
        cleared(&mut chunk.time_s, true);
        chunk.joint.resize_with(joints, Vec::new);
        chunk.joint.iter_mut().for_each(Vec::clear);
        chunk.output.resize_with(joints, || None);
        for (column, output) in chunk.output.iter_mut().zip(&self.outputs) {
            cleared(column, output.is_some());
        }
        // without links no cable has readings
        chunk.cable_m.resize_with(self.truth.cables.len(), || None);
        for (index, column) in chunk.cable_m.iter_mut().enumerate() {
            cleared(column, index < self.cables.len());
        }
        chunk.torque_nm.resize_with(joints, || None);
        for column in &mut chunk.torque_nm {
            cleared(column, has_links);
        }
        chunk.force_n = has_links.then(|| {
            let mut axes = chunk.force_n.take().unwrap_or_default();
            axes.iter_mut().for_each(Vec::clear);
            axes
        });
        cleared(
            &mut chunk.temperature_degc,
            self.settings.temperature.is_some(),
        );
    }

    fn add_row(&mut self, chunk: &mut Recording) -> Result<(), SimulatorError> {
        let row = usize::try_from(self.row).unwrap_or(usize::MAX);
        let time_s = self.row as f64 / self.settings.motion.rate_hz;
        let temperature = self.settings.temperature.as_ref();
        for scene in &mut self.scenes {
            scene.move_to(row, time_s, &self.motion, &self.hand, temperature)?;
        }
        chunk.line.push(FIRST_LINE + self.row);
        push(&mut chunk.time_s, time_s);
        for (joint, motor) in self.motors.iter_mut().enumerate() {
            let scene = &self.scenes[motor.scene];
            let mut shown = motor.sensor.read(scene.drives[joint].motor);
            for [from_s, step] in &motor.steps {
                if scene.time_s >= *from_s {
                    shown += step;
                }
            }
            // a count of minus nothing is 0, not -0
            chunk.joint[joint].push(finite(shown + 0.0, row, "theta", joint)?);
        }
        for (joint, output) in self.outputs.iter_mut().enumerate() {
            let Some(output) = output else {
                continue;
            };
            let angle = self.scenes[output.scene].arm.outputs[joint];
            let rough = output.roughness.as_ref();
            let jiggle = rough.map_or(0.0, |rough| rough.value(angle));
            let shown = output.sensor.read(angle + jiggle);
            let shown = finite(shown + 0.0, row, "out", joint)?;
            push(&mut chunk.output[joint], shown);
        }
        for (index, (scene, sensor)) in self.cables.iter_mut().enumerate() {
            let shown = sensor.read(self.scenes[*scene].cables_m[index]);
            push(
                &mut chunk.cable_m[index],
                finite(shown, row, "cable ", index)?,
            );
        }
        let now = &self.scenes[0];
        if let Some(axes) = &mut chunk.force_n {
            for (joint, sensor) in self.torques.iter_mut().enumerate() {
                let shown = sensor.read(now.arm.torques_nm[joint]);
                push(
                    &mut chunk.torque_nm[joint],
                    finite(shown, row, "torque", joint)?,
                );
            }
            for (axis, column) in axes.iter_mut().enumerate() {
                column.push(self.forces[axis].read(now.force_n[axis]));
            }
        }
        if let Some(warm) = temperature {
            let now_degc = warm.start_degc + warm.rise_at(time_s);
            push(&mut chunk.temperature_degc, self.thermometer.read(now_degc));
        }
        Ok(())
    }
}

fn push(column: &mut Option<Vec<f64>>, value: f64) {
    if let Some(column) = column {
        column.push(value);
    }
}
