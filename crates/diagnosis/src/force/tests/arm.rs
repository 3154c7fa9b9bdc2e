//! A small arm of point masses, its torques by virtual work: another route than the module's.

use haptical_model::kinematics::{Chain, Convention, Link};
use haptical_model::{Device, JointType, Recording};
use nalgebra::{Matrix3, Vector3};

/// Time between rows unless said otherwise.
const STEP_S: f64 = 0.01;
pub(super) const TORQUE_SD_NM: f64 = 3e-3;
pub(super) const FORCE_SD_N: f64 = 0.01;

/// Five joints; the drives turn 6, 9, 9, 1 and 1 times as fast.
pub(super) const FILE: &str = r#"
[device]
name = "arm"
dof = 5
[[link]]
a_m = 0.3
alpha_rad = -1.5707963267948966
d_m = 0.01
[[link]]
a_m = 0.0
alpha_rad = -1.5707963267948966
d_m = 0.2
mass_kg = 0.3
centre_of_mass_m = [0.0, 0.02, 0.0]
[[link]]
a_m = 0.17
alpha_rad = 0.0
d_m = 0.0
mass_kg = 0.25
centre_of_mass_m = [0.06, 0.0, 0.01]
[[link]]
a_m = 0.12
alpha_rad = -1.5707963267948966
d_m = 0.0
mass_kg = 0.15
centre_of_mass_m = [0.04, 0.01, 0.0]
[[link]]
a_m = 0.0
alpha_rad = 1.5707963267948966
d_m = 0.05
mass_kg = 0.08
centre_of_mass_m = [0.01, 0.0, 0.02]
[[link]]
a_m = 0.02
alpha_rad = 0.0
d_m = 0.06
mass_kg = 0.06
centre_of_mass_m = [0.01, 0.0, 0.03]
[[joint]]
name = "1"
home_rad = 2.6
lower_rad = -1.3
upper_rad = 1.3
transmission = "direct"
transmission_ratio = 6.0
encoder_counts_per_rev = 20000
[[joint]]
name = "2"
home_rad = 0.3
lower_rad = -1.0
upper_rad = 1.0
transmission = "direct"
transmission_ratio = 9.0
encoder_counts_per_rev = 20000
[[joint]]
name = "3"
home_rad = 0.9
lower_rad = -0.9
upper_rad = 0.9
transmission = "direct"
transmission_ratio = 9.0
encoder_counts_per_rev = 20000
[[joint]]
name = "4"
home_rad = 1.1
lower_rad = -1.2
upper_rad = 1.2
transmission = "direct"
transmission_ratio = 1.0
encoder_counts_per_rev = 40000
[[joint]]
name = "5"
home_rad = 0.4
lower_rad = -1.6
upper_rad = 1.6
transmission = "direct"
transmission_ratio = 1.0
encoder_counts_per_rev = 40000
[gravity]
vector_mps2 = [0.0, -9.81, 0.0]
"#;

/// The arm as its file has it.
pub(super) fn arm() -> Device {
    Device::from_toml(FILE, "arm").unwrap().device
}

/// The same with Craig's rows and a sliding third joint.
pub(super) fn other_arm() -> Device {
    let mut device = arm();
    device.convention = Convention::Modified;
    for (row, link) in device.links.iter_mut().enumerate() {
        link.beta_rad = 0.1 * row as f64;
        link.a_m += 0.02;
    }
    device.joints[2].joint_type = JointType::Prismatic;
    device.joints[2].home_rad = 0.1;
    device
}

/// Uniform numbers of a linear congruence, and normal ones by the sum of twelve.
#[derive(Debug, Clone)]
pub(super) struct Noise(pub(super) u64);

impl Noise {
    pub(super) fn uniform(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(super) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// Point masses of each link, in the frame that the module uses for its inertia.
pub(super) type Masses = Vec<Vec<(f64, Vector3<f64>)>>;

/// Four points per link with the file's mass and centre.
pub(super) fn masses(device: &Device) -> Masses {
    let points = |joint: usize| {
        let body = device.bodies[joint + 1].unwrap();
        let centre = Vector3::from(body.centre_of_mass_m);
        let corners = [
            [1.0, 0.3, 0.0],
            [-1.0, 0.5, 0.2],
            [0.2, -0.8, 0.7],
            [-0.2, 0.0, -0.9],
        ];
        let arm = 0.02 + 0.01 * joint as f64;
        corners
            .map(|corner| (0.25 * body.mass_kg, centre + Vector3::from(corner) * arm))
            .to_vec()
    };
    (0..device.joints.len()).map(points).collect()
}

/// Mass, first moments, inertia of the points: the ten parameters of each link.
pub(super) fn parameters(masses: &Masses) -> Vec<f64> {
    let mut all = Vec::new();
    for points in masses {
        let (mut mass, mut moment, mut inertia) = (0.0, Vector3::zeros(), Matrix3::zeros());
        for (own, place) in points {
            mass += own;
            moment += place * *own;
            let square = Matrix3::identity() * place.norm_squared();
            inertia += (square - place * place.transpose()) * *own;
        }
        all.extend([mass, moment.x, moment.y, moment.z]);
        all.extend([inertia[(0, 0)], inertia[(1, 1)], inertia[(2, 2)]]);
        all.extend([inertia[(0, 1)], inertia[(0, 2)], inertia[(1, 2)]]);
    }
    all
}

/// A place fixed to link `joint` (or to the handle) in frame (-1).
fn placed(
    device: &Device,
    joint: Option<usize>,
    place: &Vector3<f64>,
    angles: &[f64],
) -> Vector3<f64> {
    let mut links = device.chain_links();
    let last = joint.map_or(links.len() - 1, |joint| joint + 1);
    links.truncate(last + 1);
    if joint.is_some() {
        // a link's frame comes right after its joint's motion: home is before it, the row's d_m behind it
        let own = &mut links[last];
        own.d_m -= device.links[last].d_m;
        if device.convention == Convention::Standard {
            *own = Link {
                theta_rad: own.theta_rad,
                d_m: own.d_m,
                ..Link::default()
            };
        }
    }
    let motions = device.motions();
    let chain = Chain::new(device.convention, &links, &motions[..=last]).unwrap();
    let pose = chain.pose(&angles[..last]).unwrap();
    pose.position_m + pose.rotation * place
}

/// Torques of the drives by virtual work: the sum over masses of `m (a - g) . dp/dq`, less the
/// hand's. `angles` are those at three instants `step_s` apart; `force` in the handle's frame.
pub(super) fn virtual_work(
    device: &Device,
    masses: &Masses,
    angles: &[Vec<f64>; 3],
    step_s: f64,
    force: &Vector3<f64>,
) -> Vec<f64> {
    let gravity = Vector3::from(device.gravity_mps2.unwrap());
    let now = &angles[1];
    let slope = |joint: Option<usize>, place: &Vector3<f64>, by: usize| {
        let step = 1e-5;
        let (mut more, mut less) = (now.clone(), now.clone());
        more[by] += step;
        less[by] -= step;
        (placed(device, joint, place, &more) - placed(device, joint, place, &less)) / (2.0 * step)
    };
    let mut torque = vec![0.0; now.len()];
    for (joint, points) in masses.iter().enumerate() {
        for (mass, place) in points {
            let at = |angles: &Vec<f64>| placed(device, Some(joint), place, angles);
            let acceleration =
                (at(&angles[0]) - at(now) * 2.0 + at(&angles[2])) / (step_s * step_s);
            for by in 0..=joint {
                torque[by] += mass * (acceleration - gravity).dot(&slope(Some(joint), place, by));
            }
        }
    }
    // the handle's frame from three places in it
    let origin = placed(device, None, &Vector3::zeros(), now);
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let turned: Vector3<f64> = (0..3)
        .map(|k| (placed(device, None, &axes[k], now) - origin) * force[k])
        .sum();
    for (by, torque) in torque.iter_mut().enumerate() {
        *torque -= turned.dot(&slope(None, &Vector3::zeros(), by));
    }
    torque
}

/// A recording before its noise.
#[derive(Debug, Clone)]
pub(super) struct Scene {
    pub(super) time_s: Vec<f64>,
    pub(super) angle_rad: Vec<Vec<f64>>,
    pub(super) torque_nm: Vec<Vec<f64>>,
    pub(super) force_n: [Vec<f64>; 3],
    /// What each torque is read times.
    pub(super) scales: Vec<f64>,
    noise: Noise,
}

impl Scene {
    /// Slow random motion of a calibrated arm: 0.3 mm and 0.6 mrad off the file, torque scales off
    /// by 3 %.
    pub(super) fn new(seed: u64, rows: usize) -> Self {
        Self::sampled(seed, rows, STEP_S)
    }

    /// The same with another time between rows.
    pub(super) fn sampled(seed: u64, rows: usize, step_s: f64) -> Self {
        Self::held(seed, rows, step_s, [1.0, 1.0, 0.0])
    }

    /// An arm that moves by itself.
    pub(super) fn alone(seed: u64, rows: usize) -> Self {
        Self::held(seed, rows, STEP_S, [0.0, 1.0, 0.0])
    }

    /// A tenth as fast, on a base that is tilted against the file's.
    pub(super) fn tilted(seed: u64, rows: usize, tilt_rad: f64) -> Self {
        Self::held(seed, rows, STEP_S, [1.0, 0.1, tilt_rad])
    }

    /// `hand` and `pace`: the hand's force and the joints' rates over their usual ones.
    fn held(seed: u64, rows: usize, step_s: f64, [hand, pace, tilt_rad]: [f64; 3]) -> Self {
        let mut noise = Noise(seed);
        let mut device = arm();
        for link in &mut device.links {
            link.a_m += 3e-4 * noise.normal();
            link.d_m += 3e-4 * noise.normal();
            link.theta_rad += 6e-4 * noise.normal();
            link.alpha_rad += 6e-4 * noise.normal();
        }
        device.links[0].theta_rad += tilt_rad;
        let mut waves = |sizes: [f64; 3]| -> Vec<[f64; 3]> {
            let place = |size: f64| {
                [
                    size,
                    pace * (0.5 + 3.5 * noise.uniform()),
                    6.3 * noise.uniform(),
                ]
            };
            sizes.map(place).to_vec()
        };
        let angles: Vec<Vec<[f64; 3]>> = device
            .joints
            .iter()
            .map(|joint| waves([0.5, 0.3, 0.2].map(|s| s * joint.upper_rad)))
            .collect();
        let forces: Vec<Vec<[f64; 3]>> = (0..3).map(|_| waves([0.7, 0.5, 0.3])).collect();
        let value = |waves: &Vec<[f64; 3]>, time: f64| -> f64 {
            waves
                .iter()
                .map(|[size, rate, phase]| size * (rate * time + phase).sin())
                .sum()
        };
        let scales: Vec<f64> = device
            .joints
            .iter()
            .map(|_| 1.0 + 0.03 * noise.normal())
            .collect();
        let masses = masses(&device);
        let time_s: Vec<f64> = (0..rows).map(|row| row as f64 * step_s).collect();
        let mut scene = Self {
            angle_rad: vec![Vec::with_capacity(rows); angles.len()],
            torque_nm: vec![Vec::with_capacity(rows); angles.len()],
            force_n: [0, 1, 2].map(|k| {
                time_s
                    .iter()
                    .map(|time| hand * value(&forces[k], *time))
                    .collect()
            }),
            time_s,
            scales,
            noise,
        };
        let small = 2e-3;
        for (row, &time) in scene.time_s.iter().enumerate() {
            let at = |time: f64| {
                angles
                    .iter()
                    .map(|waves| value(waves, time))
                    .collect::<Vec<f64>>()
            };
            let three = [at(time - small), at(time), at(time + small)];
            let force = Vector3::from([0, 1, 2].map(|k| scene.force_n[k][row]));
            let torque = virtual_work(&device, &masses, &three, small, &force);
            for joint in 0..torque.len() {
                scene.angle_rad[joint].push(three[1][joint]);
                scene.torque_nm[joint].push(torque[joint] * scene.scales[joint]);
            }
        }
        scene
    }

    /// A row, or its neighbour that has one on either side in its run.
    fn inner(&self, row: usize) -> usize {
        let time_s = &self.time_s;
        if row == 0 || time_s[row] <= time_s[row - 1] {
            row + 1
        } else if row + 1 == time_s.len() || time_s[row + 1] <= time_s[row] {
            row - 1
        } else {
            row
        }
    }

    /// Rate of a joint.
    pub(super) fn rate(&self, joint: usize, row: usize) -> f64 {
        let angle = &self.angle_rad[joint];
        let row = self.inner(row);
        let (before, after) = (row - 1, row + 1);
        (angle[after] - angle[before]) / (self.time_s[after] - self.time_s[before])
    }

    /// A point mass on a link, from 0, in some rows.
    pub(super) fn carry(
        &mut self,
        joint: usize,
        mass_kg: f64,
        place: &Vector3<f64>,
        rows: std::ops::Range<usize>,
    ) {
        let device = arm();
        let mut masses: Masses = vec![Vec::new(); device.joints.len()];
        masses[joint].push((mass_kg, *place));
        let step_s = self.time_s[1] - self.time_s[0];
        for row in rows {
            let middle = self.inner(row);
            let at = |row: usize| -> Vec<f64> {
                self.angle_rad.iter().map(|angle| angle[row]).collect()
            };
            let three = [at(middle - 1), at(middle), at(middle + 1)];
            let torque = virtual_work(&device, &masses, &three, step_s, &Vector3::zeros());
            for (joint, torque) in torque.into_iter().enumerate() {
                self.torque_nm[joint][row] += torque * self.scales[joint];
            }
        }
    }

    /// The same motion once more, as another run of the same length.
    pub(super) fn repeated(mut self) -> Self {
        let columns = [&mut self.angle_rad, &mut self.torque_nm];
        columns
            .into_iter()
            .flatten()
            .for_each(|column| column.extend_from_within(..));
        self.force_n
            .iter_mut()
            .for_each(|column| column.extend_from_within(..));
        self.time_s.extend_from_within(..);
        self
    }

    /// What is recorded: angles in counts, noise on torques and forces.
    pub(super) fn record(mut self) -> Recording {
        let device = arm();
        let rows = self.time_s.len();
        let mut noisy = |values: Vec<f64>, sd: f64| -> Vec<f64> {
            values
                .into_iter()
                .map(|value| value + sd * self.noise.normal())
                .collect()
        };
        let torque_nm = self
            .torque_nm
            .into_iter()
            .map(|torque| Some(noisy(torque, TORQUE_SD_NM)));
        let torque_nm = torque_nm.collect();
        let force_n = Some(self.force_n.map(|force| noisy(force, FORCE_SD_N)));
        let joint = device
            .joints
            .iter()
            .zip(self.angle_rad)
            .map(|(joint, angle)| {
                let count = joint.reading_quantum_rad().unwrap();
                angle
                    .into_iter()
                    .map(|angle| (angle / count).round() * count)
                    .collect()
            });
        Recording {
            line: (2..rows as u64 + 2).collect(),
            time_s: Some(self.time_s),
            joint: joint.collect(),
            output: vec![None; device.joints.len()],
            torque_nm,
            force_n,
            ..Recording::default()
        }
    }
}
