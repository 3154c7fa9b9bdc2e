//! Arms by URDF, MJCF and TOML: trees, slides, touched sockets, trackers at known and unknown places, drives alone.

use anyhow::{Result, anyhow};
use haptical::design::Rig;
use haptical::simulator::{Settings, apply_deviations, simulate_transmission};
use haptical::{Truth, simulate_postures};

use crate::noise::Noise;
use crate::scene::{DeviceFile, Identified, Made, Scene, fixture, root, scenes};
use crate::table::Table;

pub(crate) const SCENES: &[Scene] = scenes! {
    "arm-urdf-sockets" [] six_axes("contact:2:0.05", "arm6-touches.csv");
    "arm-urdf-tracker-known" [] six_axes("pose", "arm6-poses.csv");
    "arm-camera" ["outliers"] camera();
    "arm-two-hands" ["joint-compliance"] two_hands();
    "arm-two-hands-elastic" [] Ok(two_hands()?.with_joint_compliance());
    "arm-slide-tracker" [] slide();
    "arm-mjcf-payload" ["payload", "armature"] mjcf();
    "arm-slow-torques-payload" ["payload", "joint-friction"] payload();
    "arm-slow-torques-payload-second" ["payload", "joint-friction"] payload_and_none();
    "drive-alone" [] drive();
};

/// Seed of every log that is simulated here.
const SEED: u64 = 1;
/// How far a simulated arm is off, as a share of what is plausible (5 mm, 20 mrad).
const DEVIATION: f64 = 0.2;

/// A log of an arm at given postures, and the rig that reads it.
fn recorded(mut device: DeviceFile, rig: &str, postures: &Table) -> Result<Made> {
    let nominal = device.open()?;
    let postures = postures.log("postures.csv", &nominal)?;
    let rig = Rig::parse(rig).map_err(|error| anyhow!("{error}"))?;
    let truth = Truth::Drawn(DEVIATION);
    let made = simulate_postures(&nominal, truth, &postures, Some(&rig), SEED)?;
    let log = Table::of(&made.recording, &made.truth)?;
    device.rig = made.rig.or(device.rig);
    Ok(Made::new(device, log))
}

fn six_axes(rig: &str, postures: &str) -> Result<Made> {
    let device = DeviceFile::read("crates/cli/assets/arm6.urdf", "arm6.urdf")?;
    let postures = Table::read(root("crates/cli/assets").join(postures))?;
    recorded(device, rig, &postures)
}

/// A measured recording of a camera in the hand.
fn camera() -> Result<Made> {
    let device = DeviceFile::read("fixtures/measured/camera/panda.urdf", "panda.urdf")?
        .rigged(fixture("fixtures/rigs/camera.toml")?);
    let log = Table::read(root("fixtures/measured/camera/log.csv"))?;
    Ok(Made::new(device, log).folds(5))
}

/// A torso with two arms, a device that branches.
fn two_hands() -> Result<Made> {
    let mut device = DeviceFile::read("fixtures/urdf/humanoid.urdf", "humanoid.urdf")?
        .rigged(fixture("fixtures/rigs/two-arms.toml")?);
    device.tips = vec!["left_hand", "right_hand"];
    let log = Table::read(root("fixtures/logs/two-arms.csv.gz"))?;
    Ok(Made::new(device, log))
}

/// An arm of four joints of which one slides.
fn slide() -> Result<Made> {
    let device = DeviceFile::toml(fixture("fixtures/payload/device.toml")?);
    let mut noise = Noise::new(SEED);
    let mut postures = Table::default();
    for (name, reach) in [
        ("theta1_rad", 1.2),
        ("theta2_rad", 0.8),
        ("theta3_m", 0.15),
        ("theta4_rad", 1.2),
    ] {
        let cells = (0..80).map(|_| noise.between(-reach, reach)).collect();
        postures.push(name, cells);
    }
    recorded(device, "pose", &postures)
}

/// Torques of an arm that MuJoCo moved with a load beyond its flange.
fn mjcf() -> Result<Made> {
    let device = DeviceFile::read("crates/cli/assets/arm7.xml", "arm7.xml")?;
    let log = Table::read(root("crates/cli/assets/arm7-loaded.csv.gz"))?;
    Ok(Made {
        identify: Identified::Dynamics,
        links_follow: true,
        is_of_true_geometry: true,
        ..Made::new(device, log)
    })
}

/// The same, and a second recording that begins and ends without the load.
fn payload_and_none() -> Result<Made> {
    let made = payload()?;
    let runs = made.log.runs();
    let before: Vec<usize> = (0..made.log.rows()).filter(|row| runs[*row] < 2).collect();
    Ok(Made {
        validate: Some(made.log.taken(&before)),
        ..made
    })
}

/// Torques at rest, with and without a load.
fn payload() -> Result<Made> {
    let device = DeviceFile::toml(fixture("fixtures/payload/device.toml")?);
    let log = Table::read(root("fixtures/payload/log.csv.gz"))?;
    Ok(Made {
        links_follow: true,
        is_of_true_geometry: true,
        ..Made::new(device, log)
    })
}

/// One capstan drive with encoders on both sides, no links.
fn drive() -> Result<Made> {
    let text = "[device]\nname = \"capstan\"\ndof = 1\n[[joint]]\ntransmission = \"capstan\"\ntransmission_ratio = 8.0\n\
                drum_distance_m = 0.0675\nlower_rad = -1.5\nupper_rad = 1.5\nsampling_sd_rad = 0.5\n\
                encoder_counts_per_rev = 20000\nexternal_encoder_sd_rad = 1e-4\n";
    let device = DeviceFile::toml(text);
    let nominal = device.open()?.model;
    let deviations = [("ratio_deviation1", -0.025), ("output_drum_x1", 1.9e-4)];
    let truth = apply_deviations(&nominal, &deviations)?;
    let log = simulate_transmission(&truth, &Settings::paper(), 0, 300, SEED)?;
    Ok(Made::new(device, Table::of(&log, &truth)?))
}
