//! Poses that a device can take: drawn between its limits, refused by workspace, cables and clearance.

use haptical_calibration::frame_origins_m;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, Evaluation, Joint, JointType, Recording};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::DesignError;
use crate::posture::clearance::clearance_m;

/// How joint readings are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spread {
    /// Uniform between the limits.
    Uniform,
    /// Normal about home with the joint's `sampling_sd_rad` (a third of the nearer limit without it), cut at
    /// 3 sd and at the limits: the paper's poses.
    Normal,
}

/// Limits of the poses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// How readings are drawn.
    pub spread: Spread,
    /// Box that the handle stays in: lowest and highest x, y, z in frame (-1) \[m\].
    pub workspace_m: Option<[[f64; 3]; 2]>,
    /// Shortest and longest length of every cable \[m\].
    pub cable_m: [f64; 2],
    /// Radius of the links, for their clearance from each other \[m\]; none where they are not looked at.
    pub link_radius_m: Option<f64>,
}

impl Default for Limits {
    /// Uniform, no cable shorter than 30 mm (it has no direction at its exit), nothing else.
    fn default() -> Self {
        Self {
            spread: Spread::Uniform,
            workspace_m: None,
            cable_m: [0.03, f64::INFINITY],
            link_radius_m: None,
        }
    }
}

/// Draws for each candidate that is asked for, before it counts as impossible.
const DRAWS_EACH: usize = 500;
/// Standard deviations at which normal readings are cut.
const CUT: f64 = 3.0;
/// Limit of a joint that has none in its file: a turn is a whole range.
const A_TURN_RAD: f64 = std::f64::consts::PI;

/// What refuses a pose, by its place in the counts.
const FILTERS: [&str; 4] = [
    "the transmissions' or the chain's domain",
    "the workspace",
    "the cables' lengths",
    "the links' clearance",
];

impl Limits {
    fn check(&self) -> Result<(), DesignError> {
        let [shortest, longest] = self.cable_m;
        let setting = |setting, value, allowed| {
            Err(DesignError::Setting {
                setting,
                value,
                allowed,
            })
        };
        if !(shortest >= 0.0 && shortest.is_finite()) {
            return setting("the shortest cable", shortest, "a length in m, 0 or more");
        }
        if longest.is_nan() || longest <= shortest {
            return setting("the longest cable", longest, "more than the shortest");
        }
        for axis in 0..3 {
            if let Some([low, high]) = self.workspace_m
                && !(low[axis] < high[axis] && low[axis].is_finite() && high[axis].is_finite())
            {
                let allowed = "finite numbers, the lowest below the highest";
                return setting("a side of the workspace", high[axis], allowed);
            }
        }
        match self.link_radius_m {
            Some(radius) if !(radius >= 0.0 && radius.is_finite()) => {
                setting("the links' radius", radius, "a length in m, 0 or more")
            }
            _ => Ok(()),
        }
    }
}

/// Lowest and highest reading of a joint.
pub(crate) fn range(joint: &Joint, number: usize) -> Result<[f64; 2], DesignError> {
    let turns = joint.joint_type == JointType::Revolute;
    let limit = |value: f64, open: f64| match value.is_finite() {
        true => Some(value),
        false => turns.then_some(open),
    };
    let (lower, upper) = (joint.lower_rad, joint.upper_rad);
    match (limit(lower, -A_TURN_RAD), limit(upper, A_TURN_RAD)) {
        (Some(lower), Some(upper)) if lower < upper => Ok([lower, upper]),
        _ => Err(DesignError::NoLimits {
            joint: number,
            unit: joint.unit(),
        }),
    }
}

/// A generator of poses.
pub(crate) struct Draws<'d> {
    device: &'d Device,
    limits: Limits,
    ranges: Vec<[f64; 2]>,
    random: ChaCha8Rng,
    pub(crate) evaluation: Evaluation<'d>,
    refused: [usize; 4],
    drawn: usize,
}

impl<'d> Draws<'d> {
    pub(crate) fn new(device: &'d Device, limits: &Limits, seed: u64) -> Result<Self, DesignError> {
        limits.check()?;
        let joints = device.joints.iter().enumerate();
        let ranges = joints.map(|(index, joint)| range(joint, index + 1));
        Ok(Self {
            device,
            limits: *limits,
            ranges: ranges.collect::<Result<_, _>>()?,
            random: ChaCha8Rng::seed_from_u64(seed),
            evaluation: Evaluation::new(device),
            refused: [0; 4],
            drawn: 0,
        })
    }

    /// The next pose within the joint limits.
    pub(crate) fn draw(&mut self) -> Vec<f64> {
        self.drawn += 1;
        let joints = self.device.joints.iter().zip(&self.ranges);
        let (spread, random) = (self.limits.spread, &mut self.random);
        let one = |(joint, &[lower, upper]): (&Joint, &[f64; 2])| match spread {
            Spread::Uniform => lower + (upper - lower) * random.random::<f64>(),
            Spread::Normal => {
                let third = upper.abs().min(lower.abs()) / CUT;
                let sd = joint.sampling_sd_rad.unwrap_or(third);
                loop {
                    let number = normal(random);
                    let reading = sd * number;
                    if number.abs() <= CUT && (lower..=upper).contains(&reading) {
                        break reading;
                    }
                    // home may lie outside the limits
                    if !(lower..=upper).contains(&0.0) {
                        break lower + (upper - lower) * random.random::<f64>();
                    }
                }
            }
        };
        joints.map(one).collect()
    }

    /// Whether the joints' limits allow readings.
    pub(crate) fn is_within(&self, readings: &[f64]) -> bool {
        let ranges = self.ranges.iter().zip(readings);
        let mut within = ranges.map(|([lower, upper], reading)| (lower..=upper).contains(&reading));
        within.all(|is_within| is_within)
    }

    /// Whether nothing but the joint limits refuses a pose; moves there.
    pub(crate) fn admits(&mut self, readings: &[f64]) -> bool {
        let refused = self.refusal(readings);
        if let Some(filter) = refused {
            self.refused[filter] += 1;
        }
        refused.is_none()
    }

    fn refusal(&mut self, readings: &[f64]) -> Option<usize> {
        if self.evaluation.move_pose_to(readings).is_err() {
            return Some(0);
        }
        if !self.device.has_links() {
            return None;
        }
        let Ok(pose) = self.evaluation.pose() else {
            return Some(0);
        };
        let handle = pose.position_m;
        if let Some([low, high]) = self.limits.workspace_m
            && (0..3).any(|axis| !(low[axis]..=high[axis]).contains(&handle[axis]))
        {
            return Some(1);
        }
        let [shortest, longest] = self.limits.cable_m;
        for cable in &self.device.cables {
            let length = (handle - Vector3::from(cable.anchor_m)).norm();
            let reads = cable.reading(&handle).is_ok();
            if !reads || !(shortest..=longest).contains(&length) {
                return Some(2);
            }
        }
        let radius_m = self.limits.link_radius_m?;
        let recording = Recording {
            line: vec![1],
            joint: readings.iter().map(|reading| vec![*reading]).collect(),
            output: vec![None; readings.len()],
            ..Recording::default()
        };
        let origins = frame_origins_m(self.device, &recording).ok()?;
        let clearance_m = clearance_m(origins.first().map_or(&[], Vec::as_slice), radius_m);
        (clearance_m < 0.0).then_some(3)
    }

    /// Draws until `one`, which is given the number of those found, has made `wanted` of them.
    ///
    /// # Errors
    /// [`DesignError::NoCandidates`] where too few are found.
    pub(crate) fn find<T>(
        &mut self,
        wanted: usize,
        mut one: impl FnMut(&mut Self, usize) -> Option<T>,
    ) -> Result<Vec<T>, DesignError> {
        let mut found = Vec::with_capacity(wanted.min(1 << 20));
        while found.len() < wanted {
            if self.drawn >= DRAWS_EACH * wanted.max(20) {
                let most =
                    (0..FILTERS.len()).max_by_key(|&filter| (self.refused[filter], 4 - filter));
                return Err(DesignError::NoCandidates {
                    found: found.len(),
                    wanted,
                    drawn: self.drawn,
                    filter: FILTERS[most.unwrap_or(0)],
                });
            }
            let next = one(self, found.len());
            found.extend(next);
        }
        Ok(found)
    }
}

/// A normal number by Box and Muller (1958), with `libm`: the same bits on every machine.
fn normal(random: &mut ChaCha8Rng) -> f64 {
    // in (0, 1]: the logarithm of 0 does not exist
    let first = 1.0 - random.random::<f64>();
    let second = std::f64::consts::TAU * random.random::<f64>();
    libm::sqrt(-2.0 * libm::log(first)) * libm::cos(second)
}

/// Draws `count` poses, each a reading per joint (\[rad\], \[m\] for a prismatic joint), of a device within
/// limits. The same seed gives the same poses; more of them begin with the same ones.
///
/// ```
/// use haptical_design::{Limits, candidates};
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
/// let device = haptical_model::Device::load(path.as_ref())?.device;
/// let poses = candidates(&device, &Limits::default(), 20, 1)?;
/// assert!(poses.iter().all(|pose| pose.len() == 7));
/// assert_eq!(poses[..10], candidates(&device, &Limits::default(), 10, 1)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DesignError::Setting`], [`DesignError::NoLimits`], [`DesignError::NoCandidates`].
pub fn candidates(
    device: &Device,
    limits: &Limits,
    count: usize,
    seed: u64,
) -> Result<Vec<Vec<f64>>, DesignError> {
    let mut draws = Draws::new(device, limits, seed)?;
    draws.find(count, |draws, _| {
        let pose = draws.draw();
        draws.admits(&pose).then_some(pose)
    })
}
