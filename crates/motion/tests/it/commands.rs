//! Commands that a controller hears late: two links under a controller, integrated by Runge and Kutta. Nothing of it is the library's.

use haptical_model::Recording;
use haptical_motion::{Tracking, Untracked, examine, examine_tracking};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::arm::device;

/// What the drives compute.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Controller {
    /// Stiffness, damping of the error's rate times a weight, and the nominal weights.
    Damped { weight: f64 },
    /// Computed torque with the nominal bodies.
    Computed,
    /// Stiffness that softens with the error: no law of the library's.
    Cubic,
}

#[derive(Debug, Clone, Copy)]
struct Drives {
    controller: Controller,
    /// How late each joint's command is heard \[s\].
    late_s: [f64; 2],
    /// How late positions are logged \[s\].
    logged_late_s: f64,
    /// Frequency of the slowest wave of the commands \[Hz\].
    slow_hz: f64,
}

const SOUND: Drives = Drives {
    controller: Controller::Damped { weight: 1.0 },
    late_s: [0.0, 0.0],
    logged_late_s: 0.0,
    slow_hz: 0.12,
};

/// Position, speed and acceleration of the commands at a time.
fn command(slow_hz: f64, time: f64) -> [[f64; 3]; 2] {
    [0.0, 1.0].map(|joint: f64| {
        let mut own = [0.0; 3];
        for wave in 0..5 {
            let rate = std::f64::consts::TAU * slow_hz * (1.0 + 1.4 * f64::from(wave));
            let size = 0.2 / (1.0 + 0.4 * f64::from(wave));
            let (sine, cosine) = (rate * time + 1.3 * f64::from(wave) + 0.7 * joint).sin_cos();
            own[0] += size * sine;
            own[1] += size * rate * cosine;
            own[2] -= size * rate * rate * sine;
        }
        own
    })
}

/// Mass matrix, and the torques at no acceleration, of two links whose masses are so many times the nominal ones.
fn bodies(factor: f64, q: [f64; 2], w: [f64; 2]) -> ([f64; 3], [f64; 2]) {
    let (l1, c1, c2) = (0.4, 0.2, 0.15);
    let (m1, m2) = (3.0 * factor, 2.0 * factor);
    let about = m2 * c2 * c2 + 0.02 * factor;
    let (sine, cosine) = q[1].sin_cos();
    let moment = m2 * c2;
    let d11 =
        m1 * c1 * c1 + 0.05 * factor + m2 * l1 * l1 + about + 2.0 * l1 * moment * cosine + 0.3;
    let d12 = about + l1 * moment * cosine;
    let h = -l1 * moment * sine;
    let g2 = moment * 9.81 * (q[0] + q[1]).cos();
    let g1 = (m1 * c1 + m2 * l1) * 9.81 * q[0].cos() + g2;
    let bias = [
        h * (2.0 * w[0] * w[1] + w[1] * w[1]) + g1,
        -h * w[0] * w[0] + g2,
    ];
    ([d11, d12, about + 0.1], bias)
}

impl Drives {
    fn torque(&self, time: f64, q: [f64; 2], w: [f64; 2]) -> [f64; 2] {
        let heard = [0, 1].map(|k| command(self.slow_hz, time - self.late_s[k])[k]);
        let error = [0, 1].map(|k| heard[k][0] - q[k]);
        let rate = |weight: f64| [0, 1].map(|k| weight * heard[k][1] - w[k]);
        match self.controller {
            Controller::Damped { weight } => {
                let (_, gravity) = bodies(1.0, q, [0.0; 2]);
                let rate = rate(weight);
                [
                    700.0 * error[0] + 45.0 * rate[0] + gravity[0],
                    260.0 * error[1] + 15.0 * rate[1] + gravity[1],
                ]
            }
            Controller::Computed => {
                let ([d11, d12, d22], bias) = bodies(1.0, q, w);
                let rate = rate(1.0);
                let [a, b] = [0, 1].map(|k| heard[k][2] + 900.0 * error[k] + 55.0 * rate[k]);
                [d11 * a + d12 * b + bias[0], d12 * a + d22 * b + bias[1]]
            }
            Controller::Cubic => {
                let stiff = |k: f64, e: f64| k * e * (1.0 + (e / 0.004).powi(2));
                [
                    stiff(500.0, error[0]) - 30.0 * w[0],
                    stiff(200.0, error[1]) - 10.0 * w[1],
                ]
            }
        }
    }

    fn accelerations(&self, time: f64, q: [f64; 2], w: [f64; 2]) -> [f64; 2] {
        let ([d11, d12, d22], bias) = bodies(1.04, q, w);
        let torque = self.torque(time, q, w);
        let friction = |w: f64, dry: f64| dry * (w / 0.01).tanh() + 0.4 * w;
        let [a, b] = [
            torque[0] - bias[0] - friction(w[0], 1.2),
            torque[1] - bias[1] - friction(w[1], 0.5),
        ];
        let det = d11 * d22 - d12 * d12;
        [(d22 * a - d12 * b) / det, (d11 * b - d12 * a) / det]
    }

    /// 20 s at 200 Hz, integrated at 0.5 ms.
    fn log(&self, seed: u64) -> Recording {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let step = 5e-4;
        let offset = 10.0 * seed as f64;
        let start = command(self.slow_hz, offset);
        let (mut q, mut w) = (start.map(|own| own[0]), start.map(|own| own[1]));
        let lag = (self.logged_late_s / step).round() as usize;
        let mut past = vec![q; lag + 1];
        let mut log = Recording {
            line: (2..4202).collect(),
            time_s: Some((0..4200).map(|row| 0.005 * f64::from(row)).collect()),
            joint: vec![Vec::new(); 2],
            output: vec![None; 2],
            torque_nm: vec![Some(Vec::new()), Some(Vec::new())],
            ..Recording::default()
        };
        let mut commands = [Vec::new(), Vec::new()];
        for tick in 0..42_000 {
            let time = offset + step * f64::from(tick);
            if tick % 10 == 0 {
                let sent = command(self.slow_hz, time);
                let torque = self.torque(time, q, w);
                for k in 0..2 {
                    let count = std::f64::consts::TAU / 400_000.0;
                    let noise: f64 = StandardNormal.sample(&mut random);
                    log.joint[k].push((past[0][k] / count).round() * count);
                    commands[k].push(sent[k][0]);
                    let own = log.torque_nm[k].as_mut().unwrap();
                    own.push(torque[k] + 0.1 * noise);
                }
            }
            let add = |a: [f64; 2], b: [f64; 2], by: f64| [a[0] + by * b[0], a[1] + by * b[1]];
            let a1 = self.accelerations(time, q, w);
            let (q2, w2) = (add(q, w, 0.5 * step), add(w, a1, 0.5 * step));
            let a2 = self.accelerations(time + 0.5 * step, q2, w2);
            let (q3, w3) = (add(q, w2, 0.5 * step), add(w, a2, 0.5 * step));
            let a3 = self.accelerations(time + 0.5 * step, q3, w3);
            let (q4, w4) = (add(q, w3, step), add(w, a3, step));
            let a4 = self.accelerations(time + step, q4, w4);
            for k in 0..2 {
                q[k] += step / 6.0 * (w[k] + 2.0 * w2[k] + 2.0 * w3[k] + w4[k]);
                w[k] += step / 6.0 * (a1[k] + 2.0 * a2[k] + 2.0 * a3[k] + a4[k]);
            }
            past.push(q);
            past.remove(0);
        }
        let names = ["command1_rad", "command2_rad"].map(str::to_owned);
        log.covariates = names.into_iter().zip(commands).collect();
        log
    }

    fn examined(&self, seed: u64, without: &[&str]) -> Result<Tracking, Untracked> {
        let without: Vec<String> = without.iter().map(|own| (*own).to_owned()).collect();
        let (log, second) = (self.log(seed), self.log(seed + 1));
        let torques = examine(&device(), &log, None, &without).unwrap();
        examine_tracking(&device(), (&log, Some(&second)), &torques, &without)
    }
}

#[test]
fn a_command_that_is_heard_in_time_is_no_gap_whatever_the_controller() {
    for controller in [
        Controller::Damped { weight: 1.0 },
        Controller::Damped { weight: 0.0 },
        Controller::Computed,
    ] {
        for seed in 1..=3 {
            let found = Drives {
                controller,
                ..SOUND
            }
            .examined(seed, &[])
            .unwrap();
            let told = &found.examined;
            assert!(
                told.findings.is_empty(),
                "{controller:?} {seed}: {:?}",
                told.findings
            );
            assert!(
                !told
                    .channels
                    .iter()
                    .any(haptical_motion::ChannelFit::has_gap),
                "{controller:?} {seed}"
            );
        }
    }
}

#[test]
fn a_late_command_is_named_with_its_delay_under_each_controller() {
    for (controller, delay_s) in [
        (Controller::Damped { weight: 1.0 }, 0.009),
        (Controller::Damped { weight: 0.0 }, 0.006),
        (Controller::Computed, 0.012),
    ] {
        let late_s = [delay_s; 2];
        let drives = Drives {
            controller,
            late_s,
            ..SOUND
        };
        for seed in [1, 2] {
            let found = drives.examined(seed, &[]).unwrap().examined;
            let [own] = found.findings.as_slice() else {
                panic!("{controller:?} {seed}: {:?}", found.findings);
            };
            assert_eq!((own.effect, own.joint), ("command-latency", None));
            let (_, value, sd) = own.numbers[0];
            assert!((value - delay_s).abs() < 3e-4, "{controller:?}: {value}");
            assert!(sd < 0.002, "{sd}");
            assert!(
                found
                    .channels
                    .iter()
                    .all(|own| own.has_gap() && !own.has_rest())
            );
            // the gains of one log and the delay give the torques of the other
            for unseen in &found.unseen {
                let [before, after] =
                    [&unseen.before, &unseen.after].map(|own| own.iter().sum::<f64>());
                let noise = unseen.noise.powi(2) * unseen.rows.iter().sum::<usize>() as f64;
                assert!(after < 1.3 * noise, "{controller:?}: {after} {noise}");
                assert!(before > 5.0 * noise, "{controller:?}: {before} {noise}");
            }
            assert_eq!(found.unseen.len(), 2);
        }
    }
}

#[test]
fn one_joints_late_command_is_placed() {
    let drives = Drives {
        late_s: [0.0, 0.01],
        ..SOUND
    };
    let found = drives.examined(1, &[]).unwrap().examined;
    let told: Vec<_> = found
        .findings
        .iter()
        .map(|own| (own.effect, own.joint))
        .collect();
    assert_eq!(told, [("command-latency", Some(1))]);
    let (_, value, _) = found.findings[0].numbers[0];
    assert!((value - 0.01).abs() < 3e-4, "{value}");
}

#[test]
fn a_late_command_without_its_name_is_a_gap() {
    let drives = Drives {
        late_s: [0.01; 2],
        ..SOUND
    };
    let found = drives.examined(1, &["command-latency"]).unwrap().examined;
    assert!(found.findings.is_empty() && found.has_gap());
    assert!(
        found
            .channels
            .iter()
            .all(haptical_motion::ChannelFit::has_rest)
    );
}

#[test]
fn a_speed_that_weighs_less_is_no_late_command() {
    // 0.7 of the damping for the command's speed lags as 19 ms would
    let controller = Controller::Damped { weight: 0.7 };
    for seed in 1..=3 {
        match (Drives {
            controller,
            ..SOUND
        })
        .examined(seed, &[])
        {
            Err(Untracked::Slow { .. } | Untracked::NoLaw) => (),
            Ok(found) => assert!(
                found.examined.findings.is_empty(),
                "{:?}",
                found.examined.findings
            ),
            Err(other) => panic!("{other}"),
        }
    }
}

#[test]
fn positions_that_are_logged_late_are_no_late_command() {
    for logged_late_s in [0.004, 0.02] {
        let drives = Drives {
            logged_late_s,
            ..SOUND
        };
        let found = drives.examined(1, &[]);
        if let Ok(found) = found {
            assert!(
                found.examined.findings.is_empty(),
                "{logged_late_s}: {:?}",
                found.examined.findings
            );
        }
    }
}

/// Where the file says that positions are late, commands go with the torques.
#[test]
fn a_command_is_in_time_next_to_positions_that_the_file_says_are_late() {
    let drives = Drives {
        logged_late_s: 0.02,
        ..SOUND
    };
    let mut device = device();
    for joint in &mut device.joints {
        joint.torque_delay_s = Some(-0.02);
    }
    let log = drives.log(1);
    let torques = examine(&device, &log, None, &[]).unwrap();
    let found = examine_tracking(&device, (&log, None), &torques, &[]).unwrap();
    assert!(
        found.examined.findings.is_empty(),
        "{:?}",
        found.examined.findings
    );
}

#[test]
fn what_cannot_be_told_says_why() {
    let cubic = Drives {
        controller: Controller::Cubic,
        late_s: [0.01; 2],
        ..SOUND
    };
    assert_eq!(cubic.examined(1, &[]), Err(Untracked::NoLaw));
    let mut log = SOUND.log(1);
    let torques = examine(&device(), &log, None, &[]).unwrap();
    log.covariates.clear();
    let why = examine_tracking(&device(), (&log, None), &torques, &[]).unwrap_err();
    assert_eq!(why, Untracked::NoCommands);
    assert!(why.to_string().contains("command1_rad"), "{why}");
}
