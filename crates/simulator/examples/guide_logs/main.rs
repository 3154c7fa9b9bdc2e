//! Writes the device and the logs of docs/guides: what rigs measure of a device whose every number is known.
//!
//! ```text
//! cargo run --release -p haptical-simulator --example guide_logs -- fixtures
//! ```
//!
//! The folder has `devices/haptic7.toml`; the same folder gives the same bytes.

mod hands;

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;

use flate2::{Compression, GzBuilder};
use haptical_simulator::model::kinematics::Pose;
use haptical_simulator::model::kinematics::nalgebra::{
    Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3,
};
use haptical_simulator::model::{Cable, Device, Evaluation, Joint, Origin, Recording};
use haptical_simulator::{Sampling, Settings, apply_deviations, simulate};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// How the device deviates from its file \[m, rad, 1\]: sizes as in the paper's Tables 2 and 3. Row 0 and the last
/// twist deviate too, so that a rig that does not see them shows it.
const DEVIATIONS: [(&str, f64); 37] = [
    ("ratio_deviation1", -0.025),
    ("output_drum_x1", -5.2e-5),
    ("output_drum_y1", -1.93e-4),
    ("ratio_deviation2", -0.020),
    ("output_drum_x2", 2.46e-4),
    ("output_drum_y2", -4.3e-5),
    ("ratio_deviation3", 0.015),
    ("output_drum_x3", -1.73e-4),
    ("output_drum_y3", 1.0e-4),
    ("length_deviation4[1]", -5e-4),
    ("length_deviation4[2]", -7e-4),
    ("a0", 1.9e-3),
    ("alpha0", 1.5e-3),
    ("theta0", -1.2e-3),
    ("a1", -1.1e-3),
    ("a2", 1.6e-3),
    ("a3", -1.2e-3),
    ("a4", 1.4e-3),
    ("a5", -1.5e-3),
    ("a6", 1.4e-3),
    ("a7", -1.3e-3),
    ("d1", 1.2e-3),
    ("d2", -1.5e-3),
    ("d3", 1.3e-3),
    ("d4", -1.3e-3),
    ("d5", 1.4e-3),
    ("d6", -1.2e-3),
    ("alpha1", -1.5e-3),
    ("alpha2", 1.3e-3),
    ("alpha3", -1.4e-3),
    ("alpha4", 1.2e-3),
    ("alpha7", 1.7e-3),
    ("theta2", 1.7e-3),
    ("theta3", -1.3e-3),
    ("theta4", 1.0e-3),
    ("theta5", -1.2e-3),
    ("theta6", -1.0e-3),
];

/// Seed of every log; each has a stream of its own.
const SEED: u64 = 7;
/// Standard deviation of a distance and of an external encoder, as the device file states them.
const DISTANCE_SD_M: f64 = 9.87e-6;
const OUTPUT_SD_RAD: f64 = 1.047e-4;

type Answer<T> = Result<T, Box<dyn Error>>;

fn main() -> Answer<()> {
    let folder = std::env::args().nth(1);
    let folder = folder.ok_or("give the fixtures folder: guide_logs fixtures")?;
    let folder = Path::new(&folder);
    let nominal = folder.join("devices/haptic7.toml");
    let text = haptical_simulator::model::read_toml_text(&nominal)?;
    let nominal = Device::from_toml(&text, "haptic7.toml")?.device;
    let truth = apply_deviations(&nominal, &DEVIATIONS)?;
    let deviating = truth.to_toml(&text, "haptic7.toml")?;
    std::fs::write(folder.join("devices/haptic7-deviating.toml"), deviating)?;

    let logs = folder.join("logs");
    two_cables(&truth, &logs.join("two-cables.csv.gz"))?;
    tracker(&truth, &logs.join("tracker.csv.gz"))?;
    planes(&truth, &logs.join("planes.csv.gz"))?;
    homing(&truth, &logs.join("homing.csv.gz"))?;
    hands::reflectors(&truth, &logs.join("reflectors.csv.gz"))?;
    hands::stands(&truth, &logs.join("stands.csv.gz"))?;
    hands::balls(&truth, &logs.join("balls.csv.gz"))
}

/// Free postures, two cables of which the second leaves elsewhere and reads 2.5 mm too much.
fn two_cables(truth: &Device, path: &Path) -> Answer<()> {
    let mut truth = truth.clone();
    truth.cables.push(Cable {
        anchor_m: [0.504, 0.197, 0.303],
        zero_m: 2.5e-3,
        ..truth.cables.first().copied().unwrap_or_default()
    });
    let mut noise = Noise::new(1);
    let postures = free_postures(&truth, 300, 11)?;
    let mut recording = record(&truth, &postures, &mut noise)?;
    recording.cable_m = lengths(&truth, &postures, &mut noise)?;
    write(&recording, path)
}

/// Free postures, seen by a tracker 2 m away, with a marker off the handle.
fn tracker(truth: &Device, path: &Path) -> Answer<()> {
    let base = Origin {
        position_m: [1.4, -0.6, 1.9],
        orientation_wxyz: [0.5, 0.1, -0.7, 0.5],
    };
    let tool = Origin {
        position_m: [0.03, -0.02, 0.05],
        orientation_wxyz: [0.5, -0.3, 0.1, 0.8],
    };
    let mut noise = Noise::new(2);
    let postures = free_postures(truth, 200, 12)?;
    let mut recording = record(truth, &postures, &mut noise)?;
    let places = vec![(base.pose(), tool.pose()); postures.len()];
    see(
        &mut recording,
        &poses(truth, &postures)?,
        &places,
        &mut noise,
    );
    write(&recording, path)
}

/// What a tracker sees of the handle from a base, of a marker: positions and orientations, in that order.
fn see(recording: &mut Recording, poses: &[Pose], places: &[(Pose, Pose)], noise: &mut Noise) {
    let mut position = [(); 3].map(|()| Vec::new());
    let mut orientation = [(); 4].map(|()| Vec::new());
    for (pose, (base, tool)) in poses.iter().zip(places) {
        let marker_m = pose.position_m + pose.rotation * tool.position_m;
        let seen_m = base.rotation * marker_m + base.position_m;
        for (column, part) in position.iter_mut().zip(seen_m.iter()) {
            column.push(part + noise.normal(1e-4));
        }
        let [x, y, z] = [(); 3].map(|()| noise.normal(1e-4));
        // half the angle, without a sine: the same bits on every machine
        let small = UnitQuaternion::from_quaternion(Quaternion::new(1.0, x, y, z));
        let turned = base.rotation * pose.rotation * tool.rotation;
        let turned = Rotation3::from_matrix_unchecked(turned);
        let q = small * UnitQuaternion::from_rotation_matrix(&turned);
        for (column, part) in orientation.iter_mut().zip([q.w, q.i, q.j, q.k]) {
            column.push(part);
        }
    }
    recording.position_m = Some(position);
    recording.orientation_wxyz = Some(orientation);
}

/// Touches of a table and of a wall at a right angle, and of two sockets 200 mm apart, at postures all over them.
fn planes(truth: &Device, path: &Path) -> Answer<()> {
    let normal = Vector3::new(0.05, 1.0, -0.03).normalize();
    let across = normal.cross(&Vector3::new(0.9, 0.0, -0.4)).normalize();
    let along = normal.cross(&across);
    let home = vec![vec![0.0; truth.joints.len()]];
    let home = poses(truth, &home)?;
    let middle = home.first().ok_or("no pose")?.position_m;
    let sockets = [-0.15, 0.05].map(|shift_m| middle + along * shift_m - normal * 0.05);
    let on = |normal: &Vector3<f64>| normal * normal.transpose();
    let mut noise = Noise::new(3);
    let (mut postures, mut points, mut planes) = (Vec::new(), Vec::new(), Vec::new());
    for (is_plane, id, rows, towards, place) in [
        (true, "table", 120, on(&normal), middle - normal * 0.1),
        (true, "wall", 120, on(&across), middle + across * 0.1),
        (false, "left", 30, Matrix3::identity(), sockets[0]),
        (false, "right", 30, Matrix3::identity(), sockets[1]),
    ] {
        let starts = free_postures(truth, 1000, 13)?;
        let all = starts.iter().filter_map(|start| {
            let uneven_m = Vector3::zeros().map(|_: f64| noise.normal(2e-5));
            touch(truth, start, &towards, &(place + uneven_m))
        });
        let touched: Vec<Vec<f64>> = all.take(rows).collect();
        for _ in &touched {
            planes.push(if is_plane { id } else { "" }.to_owned());
            points.push(if is_plane { "" } else { id }.to_owned());
        }
        postures.extend(touched);
    }
    let mut recording = record(truth, &postures, &mut noise)?;
    (recording.plane, recording.contact) = (Some(planes), Some(points));
    write(&recording, path)
}

/// Free postures with the cable, then the fixture holds one link after the other at five angles, twice.
fn homing(truth: &Device, path: &Path) -> Answer<()> {
    let mut noise = Noise::new(4);
    let joints = truth.joints.len();
    let mut postures = free_postures(truth, 200, 14)?;
    let mut held = vec![vec![f64::NAN; postures.len()]; joints];
    for joint in 0..joints {
        for angle_rad in [-0.5, -0.25, 0.0, 0.25, 0.5].repeat(2) {
            let mut posture = vec![0.0; joints];
            let at_rad = angle_rad + noise.normal(1e-4);
            posture[joint] = reading_at(truth, joint, at_rad)?;
            postures.push(posture);
            for (other, column) in held.iter_mut().enumerate() {
                column.push(if other == joint { angle_rad } else { f64::NAN });
            }
        }
    }
    let mut recording = record(truth, &postures, &mut noise)?;
    recording.cable_m = lengths(truth, &postures, &mut noise)?;
    recording.covariates = held
        .into_iter()
        .enumerate()
        .map(|(joint, column)| (format!("fixture{}_rad", joint + 1), column))
        .collect();
    write(&recording, path)
}

/// The reading at which a joint's link is at an angle from home, by Newton's steps.
fn reading_at(truth: &Device, joint: usize, angle_rad: f64) -> Answer<f64> {
    let mut readings = vec![0.0; truth.joints.len()];
    let offset_rad = truth.links[joint + 1].theta_rad;
    for _ in 0..20 {
        let mut at = Evaluation::new(truth);
        at.move_to(&readings)?;
        readings[joint] += angle_rad - offset_rad - at.output_rad(joint);
    }
    Ok(readings[joint])
}

/// Readings near `start`, within the limits, at which the handle is at a place as far as `towards`, a projection,
/// sees it: Newton's steps of least norm.
fn touch(
    truth: &Device,
    start: &[f64],
    towards: &Matrix3<f64>,
    place: &Vector3<f64>,
) -> Option<Vec<f64>> {
    let mut readings = start.to_vec();
    let mut at = Evaluation::new(truth);
    for _ in 0..100 {
        at.move_to(&readings).ok()?;
        let gap = towards * (place - at.pose().ok()?.position_m);
        if gap.norm() < 1e-12 {
            let mut within = readings.iter().zip(&truth.joints);
            let is_near = |(reading, joint): (&f64, &Joint)| {
                (joint.lower_rad..=joint.upper_rad).contains(reading)
            };
            return within.all(is_near).then_some(readings);
        }
        let pulls: Vec<Vector3<f64>> = (0..readings.len())
            .map(|joint| towards * at.reading_twist(joint).linear)
            .collect();
        let mut square = Matrix3::identity() * 1e-6;
        for pull in &pulls {
            square += pull * pull.transpose();
        }
        let way = square.try_inverse()? * gap;
        for (reading, pull) in readings.iter_mut().zip(&pulls) {
            *reading += pull.dot(&way).clamp(-0.3, 0.3);
        }
    }
    None
}

/// Readings uniform over two thirds of the range between the limits.
fn free_postures(truth: &Device, rows: usize, seed: u64) -> Answer<Vec<Vec<f64>>> {
    let settings = Settings {
        sampling: Sampling::Uniform,
        ..Settings::paper()
    };
    let drawn = simulate(truth, &settings, rows, seed)?;
    let row = |row: usize| drawn.joint.iter().map(|column| column[row]).collect();
    Ok((0..rows).map(row).collect())
}

fn poses(truth: &Device, postures: &[Vec<f64>]) -> Answer<Vec<Pose>> {
    let mut at = Evaluation::new(truth);
    let mut found = Vec::with_capacity(postures.len());
    for posture in postures {
        at.move_to(posture)?;
        found.push(*at.pose()?);
    }
    Ok(found)
}

/// What the device's own encoders show: whole counts on the motor side, noise on the external ones.
fn record(truth: &Device, postures: &[Vec<f64>], noise: &mut Noise) -> Answer<Recording> {
    let joints = truth.joints.len();
    let mut recording = Recording {
        line: (2..2 + postures.len() as u64).collect(),
        joint: vec![Vec::new(); joints],
        output: vec![None; joints],
        torque_nm: vec![None; joints],
        ..Recording::default()
    };
    let mut at = Evaluation::new(truth);
    for posture in postures {
        at.move_to(posture)?;
        for (joint, described) in truth.joints.iter().enumerate() {
            let counts = described.encoder_counts_per_rev.ok_or("no counts")?;
            let step = TAU / counts / described.transmission_ratio.abs();
            recording.joint[joint].push((posture[joint] / step).round() * step);
            if described.external_encoder_counts_per_rev.is_some() {
                let seen = at.output_rad(joint) + noise.normal(OUTPUT_SD_RAD);
                recording.output[joint]
                    .get_or_insert_with(Vec::new)
                    .push(seen);
            }
        }
    }
    Ok(recording)
}

/// What the cable encoders show.
fn lengths(
    truth: &Device,
    postures: &[Vec<f64>],
    noise: &mut Noise,
) -> Answer<Vec<Option<Vec<f64>>>> {
    let poses = poses(truth, postures)?;
    let mut columns = Vec::new();
    for cable in &truth.cables {
        let mut column = Vec::with_capacity(poses.len());
        for pose in &poses {
            let seen_m = cable.reading(&pose.position_m)?.reading_m;
            column.push(seen_m + noise.normal(DISTANCE_SD_M));
        }
        columns.push(Some(column));
    }
    Ok(columns)
}

/// Writes a log as crates/data/README.md describes it.
fn write(recording: &Recording, path: &Path) -> Answer<()> {
    let mut columns: Vec<(String, Vec<String>)> = Vec::new();
    let mut numbers = |name: String, column: &[f64]| {
        let cell = |number: &f64| {
            if number.is_nan() {
                String::new()
            } else {
                number.to_string()
            }
        };
        columns.push((name, column.iter().map(cell).collect()));
    };
    for (joint, column) in recording.joint.iter().enumerate() {
        numbers(format!("theta{}_rad", joint + 1), column);
    }
    for (joint, column) in recording.output.iter().enumerate() {
        if let Some(column) = column {
            numbers(format!("out{}_rad", joint + 1), column);
        }
    }
    for (name, column) in ["cable_m", "cable2_m"].iter().zip(&recording.cable_m) {
        numbers((*name).to_owned(), column.as_deref().unwrap_or_default());
    }
    for (name, column) in ["x_m", "y_m", "z_m"]
        .iter()
        .zip(recording.position_m.iter().flatten())
    {
        numbers((*name).to_owned(), column);
    }
    let parts = recording.orientation_wxyz.iter().flatten();
    for (name, column) in ["qw", "qx", "qy", "qz"].iter().zip(parts) {
        numbers((*name).to_owned(), column);
    }
    for (name, column) in &recording.covariates {
        numbers(name.clone(), column);
    }
    let runs = recording.run.as_ref();
    let runs = runs.map(|runs| runs.iter().map(i64::to_string).collect());
    columns.extend(runs.map(|runs| ("run".to_owned(), runs)));
    for (name, column) in [
        ("contact", &recording.contact),
        ("plane", &recording.plane),
        ("tool", &recording.tool),
    ] {
        columns.extend(column.clone().map(|column| (name.to_owned(), column)));
    }
    let file = std::fs::File::create(path)?;
    // no name and no time in the head: the same bytes every time
    let mut log = csv::Writer::from_writer(GzBuilder::new().write(file, Compression::best()));
    log.write_record(columns.iter().map(|(name, _)| name))?;
    for row in 0..recording.len() {
        log.write_record(columns.iter().map(|(_, cells)| &cells[row]))?;
    }
    let file = log.into_inner().map_err(|error| error.to_string())?;
    file.finish()?;
    Ok(())
}

/// Normal numbers of one log.
struct Noise {
    generator: ChaCha8Rng,
}

impl Noise {
    fn new(stream: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(SEED);
        generator.set_stream(stream);
        Self { generator }
    }

    /// Box & Muller 1958, with `libm`'s functions: the same bits on every machine.
    fn normal(&mut self, sd: f64) -> f64 {
        let mut uniform = || (self.generator.next_u64() >> 11) as f64 / 9_007_199_254_740_992.0;
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - uniform()));
        sd * radius * libm::cos(TAU * uniform())
    }
}
