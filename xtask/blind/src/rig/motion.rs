//! Motion of a hand that leads the handle through the workspace: smooth wander, rests, home at both ends.

use haptical_model::Device;

use crate::random::Random;

/// How a recording is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionPlan {
    /// Rows of one run.
    pub rows: usize,
    /// Rows per second \[1/s\].
    pub rate_hz: f64,
    /// Uninterrupted runs, one after the other; each starts and ends at home.
    pub runs: usize,
    /// Time between the control points of the wander \[s\].
    pub pace_s: f64,
    /// Part of the range between the limits that the wander reaches.
    pub reach: f64,
    /// Rest at home at both ends \[s\].
    pub home_rest_s: f64,
    /// Whether every run repeats the first one.
    pub repeats: bool,
    /// Force of the hand over that of a usual one; 0 of an arm that moves by itself.
    pub hand: f64,
}

impl Default for MotionPlan {
    /// 6000 rows at 100 Hz through 97 % of the range, with about 30 reversals of each joint.
    fn default() -> Self {
        Self {
            rows: 6000,
            rate_hz: 100.0,
            runs: 1,
            pace_s: 0.9,
            reach: 0.97,
            home_rest_s: 1.6,
            repeats: false,
            hand: 1.0,
        }
    }
}

/// Angles of every joint from home, their rates and accelerations, row by row.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Motion {
    /// Time \[s\]; starts again with every run.
    pub time_s: Vec<f64>,
    /// Run of each row, from 0.
    pub run: Vec<i64>,
    /// Angle of each joint from home \[rad\].
    pub angle_rad: Vec<Vec<f64>>,
    /// Its rate \[rad/s\].
    pub rate_rad_s: Vec<Vec<f64>>,
    /// Its acceleration \[rad/s^2\].
    pub acceleration_rad_s2: Vec<Vec<f64>>,
}

/// A joint without limits wanders this far from home \[rad\].
const UNLIMITED_RANGE_RAD: f64 = 1.5;
/// Standard deviation of the wander before the limits compress it.
const WANDER_SD: f64 = 0.5;

impl Motion {
    /// Draws a motion of `device`.
    pub fn draw(device: &Device, plan: &MotionPlan, random: &mut Random) -> Self {
        let joints = device.joints.len();
        let mut motion = Self {
            angle_rad: vec![Vec::new(); joints],
            rate_rad_s: vec![Vec::new(); joints],
            acceleration_rad_s2: vec![Vec::new(); joints],
            ..Self::default()
        };
        for run in 0..plan.runs {
            if plan.repeats && run > 0 {
                motion.repeat(plan.rows, run as i64);
                continue;
            }
            let pace = Pace::draw(plan, random);
            motion
                .time_s
                .extend((0..plan.rows).map(|row| row as f64 / plan.rate_hz));
            motion
                .run
                .extend(std::iter::repeat_n(run as i64, plan.rows));
            for (joint, description) in device.joints.iter().enumerate() {
                let limit = |value: f64, fallback: f64| {
                    plan.reach * if value.is_finite() { value } else { fallback }
                };
                let limits = [
                    limit(description.lower_rad, -UNLIMITED_RANGE_RAD),
                    limit(description.upper_rad, UNLIMITED_RANGE_RAD),
                ];
                let wander = Wander::draw(&pace, plan, random);
                for row in 0..plan.rows {
                    let [angle, rate, acceleration] = wander.motion_at(&pace, row, limits);
                    motion.angle_rad[joint].push(angle);
                    motion.rate_rad_s[joint].push(rate);
                    motion.acceleration_rad_s2[joint].push(acceleration);
                }
            }
        }
        motion
    }

    /// Once more the first run.
    fn repeat(&mut self, rows: usize, run: i64) {
        let columns = [
            &mut self.angle_rad,
            &mut self.rate_rad_s,
            &mut self.acceleration_rad_s2,
        ];
        for column in columns.into_iter().flatten() {
            column.extend_from_within(..rows);
        }
        self.time_s.extend_from_within(..rows);
        self.run.extend(std::iter::repeat_n(run, rows));
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }
}

/// Progress along the path: 1 s of path per second, less around rests.
#[derive(Debug)]
struct Pace {
    progress_s: Vec<f64>,
    speed: Vec<f64>,
    acceleration_per_s: Vec<f64>,
}

impl Pace {
    fn draw(plan: &MotionPlan, random: &mut Random) -> Self {
        let duration_s = plan.rows as f64 / plan.rate_hz;
        // a rest of about a second every dozen seconds
        let count = (duration_s / random.uniform(9.0, 15.0)) as usize;
        let rests: Vec<[f64; 2]> = (0..count)
            .map(|_| {
                let start_s = random.uniform(plan.home_rest_s, duration_s);
                [start_s, start_s + random.uniform(0.3, 1.5)]
            })
            .collect();
        let mut pace = Self {
            progress_s: Vec::with_capacity(plan.rows),
            speed: Vec::with_capacity(plan.rows),
            acceleration_per_s: Vec::with_capacity(plan.rows),
        };
        let step_s = 1.0 / plan.rate_hz;
        let mut progress_s = 0.0;
        for row in 0..plan.rows {
            let time_s = row as f64 * step_s;
            let (mut speed, mut relative_slope) = (1.0, 0.0);
            for rest in &rests {
                let [value, slope] = open(time_s, *rest);
                speed *= value;
                relative_slope += if value > 0.0 { slope / value } else { 0.0 };
            }
            if row > 0 {
                progress_s += 0.5 * step_s * (speed + pace.speed[row - 1]);
            }
            pace.progress_s.push(progress_s);
            pace.speed.push(speed);
            pace.acceleration_per_s.push(speed * relative_slope);
        }
        pace
    }

    fn length_s(&self) -> f64 {
        self.progress_s.last().copied().unwrap_or(0.0)
    }
}

/// Time that the hand takes to stop and to start \[s\].
const RAMP_S: f64 = 0.35;

/// 1 outside a rest, 0 within it, with smooth ramps: value and slope \[1/s\].
fn open(time_s: f64, rest_s: [f64; 2]) -> [f64; 2] {
    let [start_s, end_s] = rest_s;
    let (x, direction) = if time_s < start_s {
        ((start_s - time_s) / RAMP_S, -1.0)
    } else if time_s > end_s {
        ((time_s - end_s) / RAMP_S, 1.0)
    } else {
        return [0.0, 0.0];
    };
    if x >= 1.0 {
        return [1.0, 0.0];
    }
    let value = x * x * x * (10.0 - x * (15.0 - 6.0 * x));
    let slope = 30.0 * x * x * (1.0 - x) * (1.0 - x);
    [value, direction * slope / RAMP_S]
}

/// Samples per segment in the search for the largest value: what is missed is below 1 %.
const SAMPLES: usize = 16;

/// Value of the uniform cubic B-spline at `x` of a segment with four control points.
fn spline(controls: &[f64], x: f64) -> f64 {
    let y = 1.0 - x;
    (controls[0] * y * y * y
        + controls[1] * (4.0 - 6.0 * x * x + 3.0 * x * x * x)
        + controls[2] * (4.0 - 6.0 * y * y + 3.0 * y * y * y)
        + controls[3] * x * x * x)
        / 6.0
}

/// A uniform cubic B-spline with random control points, zero (home) at both ends.
#[derive(Debug)]
struct Wander {
    controls: Vec<f64>,
    start_s: f64,
    spacing_s: f64,
    largest: f64,
}

impl Wander {
    fn draw(pace: &Pace, plan: &MotionPlan, random: &mut Random) -> Self {
        let spacing_s = plan.pace_s * random.uniform(0.85, 1.2);
        let available_s = pace.length_s() - 2.0 * plan.home_rest_s;
        let count = ((available_s / spacing_s) as usize).max(8);
        let mut controls: Vec<f64> = (0..count).map(|_| WANDER_SD * random.normal()).collect();
        for end in [0, 1, 2, count - 3, count - 2, count - 1] {
            controls[end] = 0.0;
        }
        let largest = controls
            .windows(4)
            .flat_map(|window| (0..SAMPLES).map(|k| spline(window, k as f64 / SAMPLES as f64)))
            .fold(0.1, |largest: f64, value| largest.max(value.abs()));
        Self {
            controls,
            start_s: plan.home_rest_s,
            spacing_s,
            largest: libm::tanh(largest),
        }
    }

    /// Angle, rate, acceleration at a row. Uniform cubic B-spline: de Boor, *A Practical Guide to
    /// Splines*, chapter X.
    fn motion_at(&self, pace: &Pace, row: usize, limits_rad: [f64; 2]) -> [f64; 3] {
        let place = (pace.progress_s[row] - self.start_s) / self.spacing_s;
        let segment = libm::floor(place);
        if segment < 0.0 || segment + 3.0 >= self.controls.len() as f64 {
            return [0.0; 3];
        }
        let first = segment as usize;
        let window = &self.controls[first..first + 4];
        let [c0, c1, c2, c3] = [0, 1, 2, 3].map(|k| window[k]);
        let x = place - segment;
        let y = 1.0 - x;
        let value = spline(window, x);
        let slope = (-c0 * y * y + c1 * (3.0 * x * x - 4.0 * x) - c2 * (3.0 * y * y - 4.0 * y)
            + c3 * x * x)
            / 2.0
            / self.spacing_s;
        let curvature = (c0 * y + c1 * (3.0 * x - 2.0) + c2 * (3.0 * y - 2.0) + c3 * x)
            / (self.spacing_s * self.spacing_s);

        let (speed, change) = (pace.speed[row], pace.acceleration_per_s[row]);
        let (rate, acceleration) = (slope * speed, curvature * speed * speed + slope * change);
        // the limits compress: angle = limit tanh(value) / largest
        let compressed = libm::tanh(value);
        let gain = 1.0 - compressed * compressed;
        let limit = if value < 0.0 {
            -limits_rad[0]
        } else {
            limits_rad[1]
        } / self.largest;
        [
            limit * compressed,
            limit * gain * rate,
            limit * gain * (acceleration - 2.0 * compressed * rate * rate),
        ]
    }
}
