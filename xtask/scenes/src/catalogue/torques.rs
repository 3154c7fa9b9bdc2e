//! Arms in motion: torques that rigid bodies, friction and one effect ask for, angles in counts.

use std::f64::consts::TAU;

use anyhow::Result;
use haptical::model::{DeviceChain, MotionWork, RigidBodies};

use super::{TRACKER, TRACKER_SD_M};
use crate::noise::Noise;
use crate::scene::{DeviceFile, Identified, Made, Scene, scenes};
use crate::table::Table;

pub(crate) const SCENES: &[Scene] = scenes! {
    "moving-clean" [] made(|_| {});
    "moving-payload" ["payload"] with_second(|own| own.payload_kg = 0.8, |own| own.payload_kg = 0.8);
    "moving-second-of-another" ["payload"] with_second(|_| {}, |own| own.payload_kg = 2.0);
    "moving-payload-friction-in-file" ["payload"]
        with_friction(|own| (own.payload_kg, own.play_rad) = (0.8, Some(0.0)));
    "moving-stribeck" ["stribeck-friction"] made(|own| own.stribeck_nm = 1.5);
    "moving-late-encoders" ["encoder-latency"] made(|own| own.late_s = 0.012);
    "moving-late-encoders-friction-in-file" ["encoder-latency"]
        with_friction(|own| own.late_s = 0.012);
    "moving-saturation" ["torque-saturation"] made(|own| own.end_nm = Some(4.0));
    "moving-cogging" ["motor-cogging"] made(|own| own.cogging_nm = 0.6);
    "moving-gain" ["torque-gain"] made(|own| own.gain = -0.07);
    "moving-unknown" [] made(|own| own.dent_nm = 3.0);
    "link-elastic" ["capstan-compliance", "joint-compliance"]
        made(|own| own.yields_nm_per_rad = Some(3000.0));
    "tracked-elastic" ["joint-compliance", "capstan-compliance"]
        made(|own| (own.yields_nm_per_rad, own.is_tracked) = (Some(3000.0), true));
    "link-play" ["backlash"] made(|own| own.play_rad = Some(0.004));
    "loop-late-commands" ["command-latency"] made(|own| own.command_late_s = Some(0.04));
};

/// What the true arm has and its file does not say.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Truth {
    /// At the flange.
    payload_kg: f64,
    /// Friction more at low speed, first joint.
    stribeck_nm: f64,
    /// How late angles are logged.
    late_s: f64,
    /// Where readings of the second torque end.
    end_nm: Option<f64>,
    /// Torque of 30 periods a turn of the first joint.
    cogging_nm: f64,
    /// By which share of itself the first torque is logged too large.
    gain: f64,
    /// Friction near an angle of the first joint, in no catalogue.
    dent_nm: f64,
    /// Stiffness of the first drive, where links have encoders or a tracker sees the arm.
    yields_nm_per_rad: Option<f64>,
    /// Whether a tracker sees the end of the arm, in the place of encoders on the links.
    is_tracked: bool,
    /// Play of the first drive, where links have encoders; 0 is encoders alone.
    play_rad: Option<f64>,
    /// How late the drives follow, where commands are logged.
    command_late_s: Option<f64>,
}

/// An arm that has one thing of these.
fn truth(change: fn(&mut Truth)) -> Truth {
    let mut truth = Truth::default();
    change(&mut truth);
    truth
}

/// Length and rate of each recording.
const SECONDS: f64 = 16.0;
const STEP_S: f64 = 0.005;
/// Noise of a torque, of a link's encoder.
const TORQUE_SD_NM: f64 = 0.1;
const OUTPUT_SD_RAD: f64 = 5e-5;
const ARMATURES_KGM2: [f64; 2] = [0.3, 0.1];
/// Step of the differences that make speeds and accelerations of what a drive yields.
const APART_S: f64 = 1e-4;
/// Seed of the log on which an arm is identified before it has anything.
const SOUND_SEED: u64 = 3;
/// Gains of the controller \[N m/rad, N m s/rad\].
const GAINS: [[f64; 2]; 2] = [[900.0, 60.0], [400.0, 25.0]];

/// The device file; `factors` are what the true masses are multiples of.
fn device_toml(factors: [f64; 2], payload_kg: f64, has_outputs: bool) -> String {
    let encoder = match has_outputs {
        true => format!("external_encoder_sd_rad = {OUTPUT_SD_RAD}\n"),
        false => String::new(),
    };
    let [first, second] = [3.0 * factors[0], 2.0 * factors[1]];
    // the load is a part of the second link, at its end
    let whole = second + payload_kg;
    let centre = (0.15 * second + 0.3 * payload_kg) / whole;
    let apart = second * (centre - 0.15_f64).powi(2) + payload_kg * (0.3 - centre).powi(2);
    let about = 0.02 + apart;
    let [shoulder, elbow] = ARMATURES_KGM2;
    format!(
        "[device]\nname = \"two links\"\ndof = 2\n[gravity]\nvector_mps2 = [0.0, -9.81, 0.0]\n\
         [[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
         [[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = {first}\ncentre_of_mass_m = [0.2, 0.0, 0.0]\n\
         inertia_kgm2 = [0.002, 0.05, 0.05, 0.0, 0.0, 0.0]\n\
         [[link]]\na_m = 0.3\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = {whole}\ncentre_of_mass_m = [{centre}, 0.0, 0.0]\n\
         inertia_kgm2 = [0.001, {about}, {about}, 0.0, 0.0, 0.0]\n\
         [[joint]]\nname = \"shoulder\"\narmature_kgm2 = {shoulder}\nlower_rad = -3.0\nupper_rad = 3.0\n{encoder}\
         [[joint]]\nname = \"elbow\"\narmature_kgm2 = {elbow}\nlower_rad = -3.0\nupper_rad = 3.0\n{encoder}"
    )
}

/// Angle, speed and acceleration of a joint that six sines move.
struct Course {
    waves: Vec<[f64; 3]>,
}

impl Course {
    fn drawn(noise: &mut Noise) -> Self {
        let wave = |k: usize| {
            let rate = TAU * (0.1 + 0.15 * k as f64);
            [noise.between(0.05, 0.25), rate, noise.between(0.0, TAU)]
        };
        Self {
            waves: (0..6).map(wave).collect(),
        }
    }

    fn at(&self, time_s: f64) -> [f64; 3] {
        let mut state = [0.0; 3];
        for [size, rate, phase] in &self.waves {
            let (sine, cosine) = libm::sincos(rate * time_s + phase);
            state[0] += size * sine;
            state[1] += size * rate * cosine;
            state[2] -= size * rate * rate * sine;
        }
        state
    }
}

/// The true arm on its course.
struct Arm<'t> {
    truth: &'t Truth,
    bodies: RigidBodies,
    work: MotionWork,
    courses: [Course; 2],
}

impl Arm<'_> {
    /// Links' angles, speeds and accelerations.
    fn links(&self, time_s: f64) -> [[f64; 3]; 2] {
        [0, 1].map(|joint: usize| self.courses[joint].at(time_s))
    }

    /// What the links ask of their drives, motors' inertias left out.
    fn loads(&mut self, time_s: f64) -> Result<[f64; 2]> {
        let states = self.links(time_s);
        let of = |order: usize| states.map(|state| state[order]);
        let mut torques = [0.0; 2];
        let bodies = &self.bodies;
        bodies.torques(&of(0), &of(1), &of(2), &mut self.work, &mut torques)?;
        Ok([0, 1].map(|joint: usize| torques[joint] - ARMATURES_KGM2[joint] * states[joint][2]))
    }

    /// Motors' angles, speeds and accelerations: before the links by what the first drive yields.
    fn states(&mut self, time_s: f64) -> Result<[[f64; 3]; 2]> {
        let mut states = self.links(time_s);
        if let Some(nm_per_rad) = self.truth.yields_nm_per_rad {
            let mut yields = |at_s: f64| self.loads(at_s).map(|loads| loads[0] / nm_per_rad);
            let [before, now, after] = [
                yields(time_s - APART_S)?,
                yields(time_s)?,
                yields(time_s + APART_S)?,
            ];
            let speed = (after - before) / (2.0 * APART_S);
            let acceleration = (after - 2.0 * now + before) / (APART_S * APART_S);
            let more = [now, speed, acceleration];
            (states[0].iter_mut().zip(more)).for_each(|(state, more)| *state += more);
        }
        Ok(states)
    }

    fn torques(&mut self, time_s: f64) -> Result<[f64; 2]> {
        let states = self.states(time_s)?;
        let loads = self.loads(time_s)?;
        let mut torques =
            [0, 1].map(|joint: usize| loads[joint] + ARMATURES_KGM2[joint] * states[joint][2]);
        add_friction(self.truth, &states, &mut torques);
        Ok(torques)
    }

    /// What each controller was sent, so that it exerts these torques once it hears it.
    fn commands(&mut self, time_s: f64, late_s: f64) -> Result<[f64; 2]> {
        let heard_s = time_s + late_s;
        let (torques, states) = (self.torques(heard_s)?, self.states(heard_s)?);
        Ok([0, 1].map(|joint: usize| {
            let [stiffness, damping] = GAINS[joint];
            states[joint][0] + (torques[joint] + damping * states[joint][1]) / stiffness
        }))
    }
}

fn log(truth: &Truth, seed: u64) -> Result<Table> {
    let has_outputs = truth.has_outputs();
    let true_arm = DeviceFile::toml(device_toml([1.04, 0.97], truth.payload_kg, has_outputs));
    let bodies = RigidBodies::of_device(&true_arm.open()?.model)?;
    let mut noise = Noise::new(seed);
    let mut arm = Arm {
        truth,
        work: bodies.work(),
        bodies,
        courses: [Course::drawn(&mut noise), Course::drawn(&mut noise)],
    };
    let rows = (SECONDS / STEP_S) as usize;
    let times: Vec<f64> = (0..rows).map(|row| row as f64 * STEP_S).collect();
    let model = true_arm.open()?.model;
    let chain = DeviceChain::new(&model);
    let mut places = [const { Vec::new() }; 3];
    let mut columns = [(); 4].map(|()| [Vec::new(), Vec::new()]);
    let mut follows = 0.0;
    for &time_s in &times {
        let torques = arm.torques(time_s)?;
        let logged = arm.states(time_s - truth.late_s)?.map(|state| state[0]);
        let links = arm.links(time_s).map(|state| state[0]);
        let [angles, readings, outputs, commands] = &mut columns;
        for joint in 0..2 {
            let count = TAU / 400_000.0;
            angles[joint].push(libm::round(logged[joint] / count) * count);
            let factor = if joint == 0 { 1.0 + truth.gain } else { 1.0 };
            let reading = factor * torques[joint] + noise.normal(TORQUE_SD_NM);
            let end = truth.end_nm.filter(|_| joint == 1);
            readings[joint].push(end.map_or(reading, |end| reading.clamp(-end, end)));
        }
        if has_outputs {
            let half = 0.5 * truth.play_rad.unwrap_or(0.0);
            follows = f64::clamp(follows, links[0] - half, links[0] + half);
            outputs[0].push(follows + noise.normal(OUTPUT_SD_RAD));
            outputs[1].push(links[1] + noise.normal(OUTPUT_SD_RAD));
        }
        if truth.is_tracked {
            let position_m = chain.pose(&links)?.position_m;
            for (column, along_m) in places.iter_mut().zip(position_m.iter()) {
                column.push(along_m + noise.normal(TRACKER_SD_M));
            }
        }
        if let Some(late_s) = truth.command_late_s {
            for (column, command) in commands.iter_mut().zip(arm.commands(time_s, late_s)?) {
                column.push(command);
            }
        }
    }
    let mut table = Table::default();
    table.push("t_s", times);
    let stems = [
        ("theta", "rad"),
        ("torque", "nm"),
        ("out", "rad"),
        ("command", "rad"),
    ];
    for ((stem, unit), cells) in stems.into_iter().zip(columns) {
        for (joint, cells) in cells.into_iter().enumerate() {
            if !cells.is_empty() {
                table.push(format!("{stem}{}_{unit}", joint + 1), cells);
            }
        }
    }
    for (name, cells) in ["x_m", "y_m", "z_m"].into_iter().zip(places) {
        if !cells.is_empty() {
            table.push(name, cells);
        }
    }
    Ok(table)
}

impl Truth {
    /// Whether links have encoders of their own.
    fn has_outputs(&self) -> bool {
        !self.is_tracked && (self.yields_nm_per_rad.is_some() || self.play_rad.is_some())
    }
}

/// Coulomb's and viscous friction of both joints, and what the truth adds.
fn add_friction(truth: &Truth, [first, second]: &[[f64; 3]; 2], torques: &mut [f64; 2]) {
    let side = |speed: f64| libm::tanh(speed / 0.006);
    let more = truth.stribeck_nm / (1.0 + (first[1] / 0.15).powi(2))
        + truth.dent_nm * libm::exp(-0.5 * ((first[0] - 0.1) / 0.05).powi(2));
    torques[0] += (1.5 + more) * side(first[1]) + 0.8 * first[1];
    torques[0] += truth.cogging_nm * libm::sin(30.0 * first[0] + 0.4);
    torques[1] += 0.6 * side(second[1]) + 0.3 * second[1];
}

/// An arm that has one thing of a truth.
fn made(change: fn(&mut Truth)) -> Result<Made> {
    let truth = truth(change);
    let device = DeviceFile::toml(device_toml([1.0, 1.0], 0.0, truth.has_outputs()));
    let device = match truth.is_tracked {
        true => device.rigged(TRACKER),
        false => device,
    };
    Ok(Made {
        identify: Identified::Dynamics,
        links_follow: truth.late_s == 0.0
            && truth.yields_nm_per_rad.is_none()
            && !truth.has_outputs(),
        sound: Some(log(&Truth::default(), SOUND_SEED)?),
        is_of_true_geometry: truth.late_s == 0.0,
        ..Made::new(device, log(&truth, 1)?)
    })
}

/// The same of a device file that has the friction of its drives, as an identification writes it.
fn with_friction(change: fn(&mut Truth)) -> Result<Made> {
    let mut made = made(change)?;
    for (joint, coulomb_nm, viscous) in [(1, 1.5, 0.8), (2, 0.6, 0.3)] {
        made.device.text += &format!(
            "[[effect]]\nname = \"joint-friction\"\njoint = {joint}\ncoulomb_nm = {coulomb_nm}\nstribeck_nm = 0.0\n\
             transition_rad_per_s = 0.006\nviscous_nm_s_per_rad = {viscous}\n"
        );
    }
    Ok(made)
}

/// The same with a second recording of another truth.
fn with_second(change: fn(&mut Truth), second: fn(&mut Truth)) -> Result<Made> {
    Ok(Made {
        validate: Some(log(&truth(second), 2)?),
        ..made(change)?
    })
}
