//! Cable-driven wrists whose joints all move at once: play, loops and coupling of several cables in one log, seen by
//! encoders behind the cables.

mod drives;

use std::collections::BTreeMap;
use std::fmt::Write;

use anyhow::Result;
use haptical_model::{Device, Recording};

use crate::gap::ChannelGapTruth;
use crate::planted::{Planted, Story};
use crate::random::Random;
use crate::rig::motion::{Motion, MotionPlan};
use crate::rig::noise::ChannelNoise;
use crate::rig::readings::rounded;
use crate::rig::scene::CleanChannels;
use crate::trial::{Trial, TrialId};

use drives::{Size, Wrist};

/// Names of what a joint loses at a reversal.
const LOOPS: [&str; 2] = ["backlash", "hysteresis"];
const COUPLING: &str = "cross-coupling";
/// What of another joint's cable a joint may show: a finer name for the same thing.
const SHARED: &str = "coupled-backlash";

/// What a trial of a wrist is about.
#[derive(Debug, Clone, Copy)]
struct Plan {
    has_play: bool,
    has_coupling: bool,
    is_shared: bool,
    without: &'static [&'static str],
    label: &'static str,
}

fn plan(index: u64) -> Plan {
    const PLANS: [Plan; 7] = rows! {
        Plan {has_play has_coupling is_shared without label}
        true, true, false, &[], "wrist-play-and-coupling";
        true, true, true, &[], "wrist-shared-cables";
        true, false, false, &[], "wrist-plays";
        false, true, false, &[], "wrist-couplings";
        false, false, false, &[], "wrist-clean";
        true, true, false, &["backlash", "hysteresis", SHARED], "wrist-play-withheld";
        true, true, false, &[COUPLING], "wrist-coupling-withheld";
    };
    PLANS[[0, 0, 0, 1, 1, 2, 3, 4, 5, 6][(index % 10) as usize]]
}

/// How a wrist is built and recorded.
#[derive(Debug, Clone, Copy)]
struct Rig {
    joints: usize,
    /// First joint with an encoder behind its cable; those before it drive the arm.
    first: usize,
    size: Size,
    noise_sd_rad: f64,
    /// Stated noise over the true one.
    stated: f64,
    /// Correlation of the noise of successive rows.
    colour: f64,
    motion: MotionPlan,
}

impl Rig {
    fn draw(random: &mut Random) -> Self {
        let [joints, first] = [[3, 0], [4, 0], [6, 3], [7, 3]][random.index(4)];
        let size = if random.unit() < 0.6 {
            Size::Fair
        } else {
            Size::Worn
        };
        let noise_sd_rad = match size {
            Size::Fair => random.around(1e-3, 4.0),
            Size::Worn => random.around(8e-3, 4.0),
        };
        // a camera that is waited for, or a recorder beside a motion
        let is_slow = random.unit() < 0.3;
        Self {
            joints,
            first,
            size,
            noise_sd_rad,
            stated: random.around(1.0, 1.5),
            colour: if random.unit() < 0.25 { 0.6 } else { 0.0 },
            motion: MotionPlan {
                rows: 1500 + random.index(2500),
                rate_hz: if is_slow { 10.0 } else { 50.0 },
                runs: 1 + random.index(2),
                pace_s: random.uniform(0.9, 1.8) * if is_slow { 3.0 } else { 1.0 },
                reach: random.uniform(0.6, 0.95),
                home_rest_s: 1.0,
                ..MotionPlan::default()
            },
        }
    }

    fn file(&self) -> String {
        let mut text = format!("[device]\nname = \"wrist{0}\"\ndof = {0}\n", self.joints);
        for joint in 0..self.joints {
            let reach = if joint < self.first { 0.8 } else { 1.4 };
            let _ = write!(
                text,
                "\n[[joint]]\nhome_rad = 0.0\nlower_rad = -{reach}\nupper_rad = {reach}\n\
                 transmission = \"direct\"\ntransmission_ratio = 1.0\nencoder_counts_per_rev = 1000000\n"
            );
            if joint >= self.first {
                let sd = self.noise_sd_rad * self.stated;
                let _ = writeln!(text, "external_encoder_sd_rad = {sd:.3e}");
            }
        }
        text
    }

    fn record(
        &self,
        device: &Device,
        wrist: &Wrist,
        random: &mut Random,
    ) -> (Recording, CleanChannels) {
        let mut random = Random::new(random.seed(), 1);
        let motion = Motion::draw(device, &self.motion, &mut random);
        let runs = 0..=self.motion.runs;
        let starts: Vec<usize> = runs.map(|run| run * self.motion.rows).collect();
        let joints = wrist.joints_rad(&motion.angle_rad, &starts);
        let noise = ChannelNoise {
            autoregression: self.colour,
            ..ChannelNoise::default()
        };
        let time_s = motion.time_s.iter().map(|time| rounded(*time, 1e3));
        let mut log = Recording {
            line: (0..motion.len() as u64).map(|row| row + 2).collect(),
            time_s: Some(time_s.collect()),
            run: (self.motion.runs > 1).then(|| motion.run.clone()),
            torque_nm: vec![None; self.joints],
            ..Recording::default()
        };
        let mut clean = CleanChannels::default();
        for (joint, truth) in joints.into_iter().enumerate() {
            let motor = motion.angle_rad[joint].iter();
            log.joint
                .push(motor.map(|angle| rounded(*angle, 1e6)).collect());
            let is_seen = joint >= self.first;
            log.output.push(is_seen.then(|| {
                let speed = &motion.rate_rad_s[joint];
                noise.read(&truth, speed, self.noise_sd_rad, None, &mut random)
            }));
            clean.output_rad.push(is_seen.then_some(truth));
        }
        (log, clean)
    }

    fn gap(&self, log: &Recording, clean: &CleanChannels) -> BTreeMap<String, ChannelGapTruth> {
        let channels = clean.output_rad.iter().zip(&log.joint).enumerate();
        channels
            .filter_map(|(joint, (truth, motor))| {
                let truth = truth.as_ref()?;
                let apart: Vec<f64> = truth.iter().zip(motor).map(|(a, b)| a - b).collect();
                let rms = crate::laws::rms(&apart);
                let over_sd = rms / self.noise_sd_rad;
                Some((
                    format!("out{}", joint + 1),
                    ChannelGapTruth { rms, over_sd },
                ))
            })
            .collect()
    }
}

/// A wrist in motion, all joints at once.
pub(crate) fn draw(id: TrialId, random: &mut Random) -> Result<Trial> {
    let plan = plan(id.index);
    let rig = Rig::draw(random);
    let device_toml = rig.file();
    let device = Device::from_toml(&device_toml, "wrist")?.device;
    let mut wrist = Wrist::ideal(rig.joints);
    if plan.has_play {
        wrist = wrist.with_play(rig.first, rig.size, random);
    }
    if plan.is_shared {
        wrist = wrist.with_shared_cables(rig.first, random);
    }
    if plan.has_coupling {
        wrist = wrist.with_coupling(rig.first, rig.size, random);
    }
    let (log, clean) = rig.record(&device, &wrist, random);
    let (log2, clean2) = rig.record(&device, &wrist, random);
    let gap = rig.gap(&log, &clean);
    let truth = story(plan, &device, &wrist).truth(id, gap);
    Trial::of(device_toml, [log, log2], clean2, truth)
}

fn story(plan: Plan, device: &Device, wrist: &Wrist) -> Story {
    let mut planted = Vec::new();
    if plan.has_play {
        let widths = wrist.widths_rad();
        planted.push(Planted {
            name: LOOPS[0],
            joint: wrist.widest(),
            right: LOOPS.to_vec(),
            acceptable: if plan.is_shared {
                vec![SHARED]
            } else {
                Vec::new()
            },
            law: widths
                .map(|(joint, width)| (format!("width{}_rad", joint + 1), width))
                .collect(),
            ..Planted::default()
        });
    }
    if plan.has_coupling {
        planted.push(Planted {
            name: COUPLING,
            right: vec![COUPLING],
            ..Planted::default()
        });
    }
    Story {
        label: plan.label.to_owned(),
        device: device.name.clone(),
        planted,
        without: plan.without.to_vec(),
        ..Story::default()
    }
}
