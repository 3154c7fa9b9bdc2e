//! Two links in a vertical plane, by the closed form of a textbook: Spong, Hutchinson and Vidyasagar, Robot Modeling and Control
//! (2006), example 7.2, with armatures. Nothing of it is the library's.

use haptical_model::{Device, Recording};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// What the file says; the true arm has other numbers.
const NOMINAL: &str = "\
[device]
name = \"two links\"
dof = 2
[gravity]
vector_mps2 = [0.0, -9.81, 0.0]
[[link]]
a_m = 0.0
alpha_rad = 0.0
d_m = 0.0
[[link]]
a_m = 0.4
alpha_rad = 0.0
d_m = 0.0
mass_kg = 3.0
centre_of_mass_m = [0.2, 0.0, 0.0]
inertia_kgm2 = [0.002, 0.05, 0.05, 0.0, 0.0, 0.0]
[[link]]
a_m = 0.3
alpha_rad = 0.0
d_m = 0.0
mass_kg = 2.0
centre_of_mass_m = [0.15, 0.0, 0.0]
inertia_kgm2 = [0.001, 0.02, 0.02, 0.0, 0.0, 0.0]
[[joint]]
armature_kgm2 = 0.3
[[joint]]
armature_kgm2 = 0.1
";

/// What is added to the true arm, or to its log.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Truth {
    /// At the flange \[kg\].
    pub(crate) payload_kg: f64,
    /// How far beyond the flange it hangs, along the second link \[m\].
    pub(crate) beyond_m: f64,
    /// How far the mount is tilted in the plane \[rad\].
    pub(crate) tilt_rad: f64,
    /// A force on the flange, along the base's x, for 1.5 s of every log \[N\].
    pub(crate) push_n: f64,
    /// How late positions are logged \[s\].
    pub(crate) late_s: f64,
    /// What the second joint's torque is logged too large by.
    pub(crate) gain: f64,
    /// Amplitude of a torque of 30 periods a turn of the first joint \[N m\].
    pub(crate) cogging_nm: f64,
    /// Friction more at low speed, first joint \[N m\].
    pub(crate) stribeck_nm: f64,
    /// Friction more near an angle, first joint: in no catalogue \[N m\].
    pub(crate) dent_nm: f64,
    /// Where the readings of the second joint's torque end, if they do \[N m\].
    pub(crate) end_nm: Option<f64>,
    /// Its own inertia about its centre \[kg m^2\].
    pub(crate) payload_kgm2: f64,
    /// Further dry friction of the first joint \[N m\].
    pub(crate) rough_nm: f64,
    /// Share by which both armatures are larger than stated.
    pub(crate) armatures: f64,
    /// Share of the first drive's torque that it loses to friction.
    pub(crate) load_share: f64,
    /// How long before the motion its friction turns over \[s\].
    pub(crate) lead_s: f64,
    /// Whether it rests for half a second after every two of motion.
    pub(crate) rests: bool,
    /// Noise of the positions \[rad\].
    pub(crate) position_sd: f64,
    /// What the first joint's torque reads without any \[N m\].
    pub(crate) offset_nm: f64,
    /// Share of the second drive's torque that loads the first.
    pub(crate) coupling: f64,
    /// Rows beyond 20 s, in which the motion begins again.
    pub(crate) further_rows: usize,
    /// The torques are noise of this size and nothing else \[N m\].
    pub(crate) unrelated_nm: f64,
    /// Noise of the torques that lasts for 30 ms, next to a white one of 0.1 N m \[N m\].
    pub(crate) lasting_nm: f64,
}

pub(crate) fn device() -> Device {
    Device::from_toml(NOMINAL, "two_links.toml").unwrap().device
}

/// Sizes and phases of six waves of each joint.
type Courses = [[(f64, f64); 6]; 2];

/// 20 s at 200 Hz.
pub(crate) fn recording(truth: Truth, seed: u64) -> Recording {
    with_factors(truth, seed).0
}

/// Another motion of the same arm.
pub(crate) fn second_recording(truth: Truth, seed: u64) -> Recording {
    let mut random = ChaCha8Rng::seed_from_u64(seed + 1000);
    let (courses, _) = drawn(&mut random);
    let (_, factor) = drawn(&mut ChaCha8Rng::seed_from_u64(seed));
    log_of(truth, &mut random, (4000, &courses, &factor))
}

/// The same with what the true arm's first mass, second mass and armatures are multiples of.
pub(crate) fn with_factors(truth: Truth, seed: u64) -> (Recording, [f64; 4]) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let rows = 4000 + truth.further_rows;
    let (courses, factor) = drawn(&mut random);
    (
        log_of(truth, &mut random, (rows, &courses, &factor)),
        factor,
    )
}

/// A course, and how far an arm is off its file.
fn drawn(random: &mut ChaCha8Rng) -> (Courses, [f64; 4]) {
    let mut courses = [[(0.0, 0.0); 6]; 2];
    for course in &mut courses {
        for wave in course {
            *wave = (
                random.random_range(0.05..0.25),
                random.random_range(0.0..std::f64::consts::TAU),
            );
        }
    }
    let factor: Vec<f64> = (0..4).map(|_| random.random_range(0.94..1.06)).collect();
    let factor: [f64; 4] = std::array::from_fn(|k| factor[k]);
    (courses, factor)
}

fn log_of(
    truth: Truth,
    random: &mut ChaCha8Rng,
    (rows, courses, factor): (usize, &Courses, &[f64; 4]),
) -> Recording {
    let mut log = Recording {
        line: (2..).take(rows).collect(),
        time_s: Some((0..rows).map(|row| 0.005 * row as f64).collect()),
        joint: vec![Vec::new(); 2],
        output: vec![None; 2],
        torque_nm: vec![Some(Vec::new()), Some(Vec::new())],
        ..Recording::default()
    };
    let mut lasting = [0.0; 2];
    for row in 0..rows {
        let time = 0.005 * row as f64;
        let [logged, now] =
            [time - truth.late_s, time].map(|time| motion(courses, course_time(&truth, time)));
        let torque = torque(&truth, factor, time, now);
        for joint in 0..2 {
            let count = 2.0 * std::f64::consts::PI / 400_000.0;
            log.joint[joint].push((logged[joint][0] / count).round() * count);
            if truth.position_sd > 0.0 {
                let noise: f64 = StandardNormal.sample(random);
                *log.joint[joint].last_mut().unwrap() += truth.position_sd * noise;
            }
            let noise: f64 = StandardNormal.sample(random);
            let own = match truth.unrelated_nm > 0.0 {
                true => truth.unrelated_nm * (3.0 * time + joint as f64).sin() * (0.7 * time).cos(),
                false => torque[joint] * (1.0 + truth.gain * joint as f64),
            };
            let own = match (joint, truth.end_nm) {
                (1, Some(end)) => own.clamp(-end, end),
                _ => own,
            };
            log.torque_nm[joint]
                .as_mut()
                .unwrap()
                .push(own + 0.1 * noise + lasting[joint] + truth.offset_nm * (1 - joint) as f64);
            if truth.lasting_nm > 0.0 {
                let noise: f64 = StandardNormal.sample(random);
                let kept = (-0.005 / 0.03_f64).exp();
                lasting[joint] =
                    kept * lasting[joint] + truth.lasting_nm * (1.0 - kept * kept).sqrt() * noise;
            }
        }
    }
    log
}

/// How far along its course the arm is, how fast that goes on, and how fast that changes.
fn course_time(truth: &Truth, time: f64) -> [f64; 3] {
    if !truth.rests {
        return [time, 1.0, 0.0];
    }
    const CYCLE: f64 = 2.5;
    const RAMP: f64 = 0.2;
    const MOVES: f64 = 2.0;
    let (cycles, phase) = ((time / CYCLE).floor(), time.rem_euclid(CYCLE));
    // half a cosine up, and the same backwards
    let up = |x: f64| {
        let (sine, cosine) = (std::f64::consts::PI * x / RAMP).sin_cos();
        let pi = std::f64::consts::PI;
        [
            0.5 * (x - RAMP / pi * sine),
            0.5 * (1.0 - cosine),
            0.5 * pi / RAMP * sine,
        ]
    };
    let whole = MOVES - RAMP;
    let [gone, rate, change] = match phase {
        p if p < RAMP => up(p),
        p if p < MOVES - RAMP => [p - 0.5 * RAMP, 1.0, 0.0],
        p if p < MOVES => {
            let [left, rate, change] = up(MOVES - p);
            [whole - left, rate, -change]
        }
        _ => [whole, 0.0, 0.0],
    };
    [cycles * whole + gone, rate, change]
}

/// Position, velocity and acceleration of both joints.
fn motion(courses: &Courses, [time, faster, change]: [f64; 3]) -> [[f64; 3]; 2] {
    courses.map(|course| {
        let mut own = [0.0; 3];
        for (k, (size, phase)) in course.iter().enumerate() {
            let rate = 2.0 * std::f64::consts::PI * (0.1 + 0.15 * k as f64);
            let (sine, cosine) = (rate * time + phase).sin_cos();
            own[0] += size * sine;
            own[1] += size * rate * cosine;
            own[2] -= size * rate * rate * sine;
        }
        let [q, w, a] = own;
        own = [q, w * faster, a * faster * faster + w * change];
        own
    })
}

fn torque(
    truth: &Truth,
    factor: &[f64],
    time: f64,
    [[q1, w1, a1], [q2, w2, a2]]: [[f64; 3]; 2],
) -> [f64; 2] {
    let (l1, l2, c1, c2) = (0.4, 0.3, 0.2, 0.15);
    let (m1, m2, p) = (3.0 * factor[0], 2.0 * factor[1], truth.payload_kg);
    let (i1, i2) = (0.05 * factor[0], 0.02 * factor[1]);
    // second link and payload together about the second joint
    let l3 = l2 + truth.beyond_m;
    let moment = m2 * c2 + p * l3;
    let about = m2 * c2 * c2 + i2 + p * l3 * l3 + truth.payload_kgm2;
    let (sine, cosine) = q2.sin_cos();
    let d11 = m1 * c1 * c1 + i1 + (m2 + p) * l1 * l1 + about + 2.0 * l1 * moment * cosine;
    let d12 = about + l1 * moment * cosine;
    let h = -l1 * moment * sine;
    let g = 9.81;
    let g2 = moment * g * (q1 + q2 + truth.tilt_rad).cos();
    let g1 = (m1 * c1 + (m2 + p) * l1) * g * (q1 + truth.tilt_rad).cos() + g2;
    // what the drives do against a push at the tip, by the transposed Jacobian
    let push = if (8.0..9.5).contains(&time) {
        truth.push_n
    } else {
        0.0
    };
    let push = [
        push * (l1 * q1.sin() + l2 * (q1 + q2).sin()),
        push * l2 * (q1 + q2).sin(),
    ];
    let friction = |w: f64, coulomb: f64, viscous: f64| coulomb * (w / 0.006).tanh() + viscous * w;
    let more = truth.stribeck_nm / (1.0 + (w1 / 0.15).powi(2))
        + truth.dent_nm * (-0.5 * ((q1 - 0.1) / 0.05).powi(2)).exp();
    let [first, second] = [
        d11 * a1
            + d12 * a2
            + h * (2.0 * w1 * w2 + w2 * w2)
            + g1
            + 0.3 * (factor[2] + truth.armatures) * a1
            + friction(w1 + truth.lead_s * a1, 1.5 + truth.rough_nm + more, 0.8)
            + 0.8 * (w1 - (w1 + truth.lead_s * a1))
            + push[0]
            + truth.cogging_nm * (30.0 * q1 + 0.4).sin(),
        push[1] + d12 * a1 + about * a2 - h * w1 * w1
            + g2
            + 0.1 * (factor[3] + truth.armatures) * a2
            + friction(w2 + truth.lead_s * a2, 0.6, 0.3)
            + 0.3 * (w2 - (w2 + truth.lead_s * a2)),
    ];
    // tau = tau_b + c s |tau|
    let side = (w1 / 0.006).tanh() * first.signum();
    let first = first / (1.0 - truth.load_share * side);
    [first + truth.coupling * second, second]
}
