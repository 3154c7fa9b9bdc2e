//! The motion at fine steps, and rows behind one low pass for torques and all that explains them.

use std::ops::Range;

use haptical_linalg::dot;

use crate::signal::link::Link;
use crate::signal::local_polynomial::LocalPolynomial;
use crate::signal::low_pass::LowPass;
use crate::signal::noise::Noise;
use crate::signal::samples::Samples;
use crate::signal::stretches::stretches;
use crate::thresholds::signal::{FINE_STEPS, SLIDING_NOISE, SMOOTHED_BEYOND};

/// Positions, velocities and accelerations of one side of the drives, joint by joint.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Side {
    pub(crate) q: Vec<Vec<f64>>,
    pub(crate) dq: Vec<Vec<f64>>,
    pub(crate) ddq: Vec<Vec<f64>>,
}

/// The whole motion.
#[derive(Debug, Clone)]
pub(crate) struct States {
    pub(crate) pass: LowPass,
    /// Time of each fine step \[s\].
    pub(crate) time_s: Vec<f64>,
    /// Row of the recording that each fine step is nearest to.
    pub(crate) row_of: Vec<usize>,
    /// Motors' side.
    pub(crate) motor: Side,
    /// Motors' speeds with as little smoothing as the noise of the positions allows: friction changes sides faster than the band, and a
    /// speed that is smoothed to the band changes sides too early at the end of a motion that sticks.
    pub(crate) sliding: Vec<Vec<f64>>,
    /// Links' side: by the encoder there where a joint has one, else the motor's.
    pub(crate) link: Side,
    /// Fine step in the middle of each row.
    pub(crate) centre: Vec<usize>,
    /// Piece and sample of each fine step.
    fine: Vec<(usize, usize)>,
    pub(crate) fine_s: f64,
    step_s: f64,
    /// Weights of the fine steps of a row, around its centre.
    weights: Vec<f64>,
    /// Standard deviation of a reading of each joint's position; motors' side.
    pub(crate) position_sd: Vec<f64>,
    /// Standard deviation of a row of a joint's acceleration, from the noise of its positions; motors' side.
    pub(crate) acceleration_sd: Vec<f64>,
    /// Noise of the links' positions.
    pub(crate) link_noise: Vec<LinkNoise>,
    /// What is said of a log of which stretches alone are looked at.
    pub(crate) of_stretches: Option<String>,
}

/// Noise of a link's positions where it is not that of its motor's alone.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct LinkNoise {
    /// Whether the motor's positions are not part of the link's.
    pub(crate) is_apart: bool,
    /// Standard deviation of a reading of the encoder on the link; 0 without one.
    pub(crate) position_sd: f64,
    /// What it adds to the standard deviation of a row of the acceleration.
    pub(crate) acceleration_sd: f64,
}

impl States {
    /// The motion for rows of a band; none where no piece is long enough.
    pub(crate) fn new(samples: &Samples, edge_hz: f64) -> Option<Self> {
        let pass = LowPass { edge_hz };
        let step_s = samples.step_s;
        let stride = (samples.rate_hz() / (FINE_STEPS * edge_hz))
            .floor()
            .max(1.0) as usize;
        let fine_s = step_s * stride as f64;
        let local = LocalPolynomial::new(step_s, SMOOTHED_BEYOND * edge_hz);
        let (first, weights) = pass.weights(fine_s, 0.0);
        let half = first.unsigned_abs();
        let every = (pass.row_s() / fine_s).round().max(1.0) as usize;
        let fine_steps = |length: usize| length.saturating_sub(2 * local.half).div_ceil(stride);
        let lengths = samples.pieces.iter().map(|own| fine_steps(own.length));
        let lengths: Vec<usize> = lengths.collect();
        let stretches = stretches(&lengths, half, every);
        let seconds = |steps: usize| steps as f64 * fine_s;
        let seen = stretches.iter().map(|(_, steps)| steps.len()).sum();
        let all = lengths.iter().filter(|length| **length > 2 * half).sum();
        let of_stretches = (seen < all).then(|| {
            format!(
                "stretches of {:.0} of the log's {:.0} s were looked at: what the torques do between them alone is not seen",
                seconds(seen),
                seconds(all)
            )
        });
        let joints = samples.pieces.first()?.motor.len();
        let empty = || Side {
            q: vec![Vec::new(); joints],
            dq: vec![Vec::new(); joints],
            ddq: vec![Vec::new(); joints],
        };
        let mut states = Self {
            pass,
            time_s: Vec::new(),
            row_of: Vec::new(),
            motor: empty(),
            sliding: vec![Vec::new(); joints],
            link: empty(),
            centre: Vec::new(),
            fine: Vec::new(),
            fine_s,
            step_s,
            weights,
            position_sd: position_sds(samples, &local),
            acceleration_sd: Vec::new(),
            link_noise: Vec::new(),
            of_stretches,
        };
        let links: Vec<Option<Link>> = (0..joints)
            .map(|joint| Link::new(samples, joint, SMOOTHED_BEYOND * edge_hz))
            .collect();
        // by the narrowest window: the band's own would take what friction does to a motion for noise
        let noise = position_sds(samples, &LocalPolynomial::new(step_s, 0.5 / step_s));
        let of = |sd: &f64| sharpest(step_s, SMOOTHED_BEYOND * edge_hz, *sd);
        let sharp: Vec<LocalPolynomial> = noise.iter().map(of).collect();
        for (number, steps) in stretches {
            let piece = &samples.pieces[number];
            let base = states.time_s.len();
            let at = |k: usize| local.half + k * stride;
            for joint in 0..joints {
                let motor = &piece.motor[joint];
                let along = || steps.clone().map(at);
                states.motor.extend(joint, &local, motor, along());
                let sliding = along().map(|at| sharp[joint].at(1, motor, at));
                states.sliding[joint].extend(sliding);
                let link = (links[joint].as_ref()).map_or(motor, |link| &link.pieces[number]);
                states.link.extend(joint, &local, link, along());
            }
            for k in steps.clone() {
                states.time_s.push(piece.start_s + at(k) as f64 * step_s);
                states.row_of.push(piece.first_row + at(k));
                states.fine.push((number, at(k)));
            }
            let inner = (half..steps.len() - half).step_by(every);
            states.centre.extend(inner.map(|k| base + k));
        }
        if states.centre.is_empty() {
            return None;
        }
        let gain = |smoother: Option<&LocalPolynomial>| {
            acceleration_gain(&local, smoother, &states.weights, stride)
        };
        let motor = gain(None);
        states.acceleration_sd = states.position_sd.iter().map(|sd| motor * sd).collect();
        let noise = |link: &Option<Link>| match link {
            None => LinkNoise::default(),
            Some(link) => LinkNoise {
                is_apart: link.smoother.is_none(),
                position_sd: link.sd,
                acceleration_sd: link.sd * gain(link.smoother.as_ref()),
            },
        };
        states.link_noise = links.iter().map(noise).collect();
        Some(states)
    }

    /// Number of rows of a joint.
    pub(crate) fn rows(&self) -> usize {
        self.centre.len()
    }

    /// Whether a fine step follows the one before without a gap.
    pub(crate) fn follows(&self, step: usize) -> bool {
        let Some(before) = step.checked_sub(1) else {
            return false;
        };
        let ((piece, sample), (of_before, last)) = (self.fine[step], self.fine[before]);
        let apart_s = (sample as f64 - last as f64) * self.step_s;
        piece == of_before && apart_s < 1.5 * self.fine_s
    }

    /// Number of fine steps.
    pub(crate) fn steps(&self) -> usize {
        self.time_s.len()
    }

    /// Fine steps of a row with their weights.
    pub(crate) fn window(&self, row: usize) -> (usize, &[f64]) {
        (self.centre[row] - self.weights.len() / 2, &self.weights)
    }

    /// Rows that fine steps are part of.
    pub(crate) fn rows_of(&self, steps: &Range<usize>) -> Range<usize> {
        let half = self.weights.len() / 2;
        let from = self.centre.partition_point(|own| own + half < steps.start);
        let to = self.centre.partition_point(|own| *own < steps.end + half);
        from..to.max(from)
    }

    /// Rows of a signal that is zero but at some fine steps, of which it is given.
    pub(crate) fn filtered_at(&self, steps: &Range<usize>, signal: &[f64]) -> Vec<f64> {
        let row = |row: usize| -> f64 {
            let (first, weights) = self.window(row);
            let from = first.max(steps.start);
            let to = (first + weights.len()).min(steps.end);
            match from < to {
                true => dot(
                    &weights[from - first..to - first],
                    &signal[from - steps.start..to - steps.start],
                ),
                false => 0.0,
            }
        };
        self.rows_of(steps).map(row).collect()
    }

    /// Rows of a signal at the fine steps.
    pub(crate) fn filtered(&self, signal: &[f64]) -> Vec<f64> {
        (0..self.rows())
            .map(|row| {
                let (first, weights) = self.window(row);
                dot(weights, &signal[first..first + weights.len()])
            })
            .collect()
    }

    /// What fine steps have to be multiplied with for the product of their rows with others: the transpose of [`Self::filtered`].
    pub(crate) fn spread(&self, rows: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.steps()];
        for (row, value) in rows.iter().enumerate() {
            let (first, weights) = self.window(row);
            let into = &mut all[first..first + weights.len()];
            (into.iter_mut().zip(weights)).for_each(|(into, weight)| *into += value * weight);
        }
        all
    }

    /// Rows of recorded torques; what belongs to the motion at a time was recorded `early_s` before it.
    pub(crate) fn torque(&self, samples: &Samples, joint: usize, early_s: f64) -> Vec<f64> {
        let torque = |piece: usize| samples.pieces[piece].torque[joint].as_deref();
        self.passed(|piece| torque(piece).unwrap_or(&[]), early_s)
    }

    /// Rows of what an effect adds, by its place among them.
    pub(crate) fn added(&self, samples: &Samples, effect: usize) -> Vec<f64> {
        self.passed(|piece| &samples.pieces[piece].added[effect], 0.0)
    }

    /// Rows of a column of samples, of which each piece has its own.
    fn passed<'s>(&self, column: impl Fn(usize) -> &'s [f64], early_s: f64) -> Vec<f64> {
        let whole = (early_s / self.step_s).round();
        let (first, weights) = self
            .pass
            .weights(self.step_s, whole * self.step_s - early_s);
        (self.centre.iter())
            .map(|&centre| {
                let (piece, sample) = self.fine[centre];
                let own = column(piece);
                let from = sample as isize - whole as isize + first;
                let from_start = usize::try_from(from).ok();
                let within = from_start.and_then(|from| own.get(from..from + weights.len()));
                if let Some(within) = within {
                    return dot(&weights, within);
                }
                // a shift may reach beyond the piece: the value at its end then
                let last = own.len() as isize - 1;
                let value = |k: usize| own[(from + k as isize).clamp(0, last) as usize];
                (weights.iter().enumerate())
                    .map(|(k, weight)| weight * value(k))
                    .sum()
            })
            .collect()
    }

    /// Recorded torques at the fine steps, smoothed as the positions are.
    pub(crate) fn smoothed(&self, samples: &Samples, joint: usize) -> Vec<f64> {
        self.smoothed_of(|piece| samples.pieces[piece].torque[joint].as_deref())
    }

    /// The same of what an effect adds.
    pub(crate) fn smoothed_added(&self, samples: &Samples, effect: usize) -> Vec<f64> {
        self.smoothed_of(|piece| Some(&samples.pieces[piece].added[effect]))
    }

    fn smoothed_of<'s>(&self, column: impl Fn(usize) -> Option<&'s [f64]>) -> Vec<f64> {
        let local = LocalPolynomial::new(self.step_s, SMOOTHED_BEYOND * self.pass.edge_hz);
        let at = |&(piece, sample): &(usize, usize)| {
            column(piece).map_or(0.0, |own| local.at(0, own, sample))
        };
        self.fine.iter().map(at).collect()
    }

    /// Speed of a joint's motor at the fine steps, smoothed over twice as long; the same as otherwise where that reaches beyond a piece.
    pub(crate) fn slower_speed(&self, samples: &Samples, joint: usize) -> Vec<f64> {
        let local = LocalPolynomial::new(samples.step_s, 0.5 * SMOOTHED_BEYOND * self.pass.edge_hz);
        let at = |(&(piece, sample), own): (&(usize, usize), &f64)| {
            let motor = &samples.pieces[piece].motor[joint];
            match sample >= local.half && sample + local.half < motor.len() {
                true => local.at(1, motor, sample),
                false => *own,
            }
        };
        self.fine
            .iter()
            .zip(&self.motor.dq[joint])
            .map(at)
            .collect()
    }

    /// Rows of each channel's rest, run by run: none where rows are not a whole number of samples apart; and the samples from row to row.
    pub(crate) fn runs<'r>(&self, rest: &'r [f64]) -> (Vec<&'r [f64]>, usize) {
        let sample = |row: usize| self.fine[self.centre[row]];
        let apart = |row: usize| {
            let (own, next) = (sample(row), sample(row + 1));
            (own.0 == next.0).then(|| next.1 - own.1)
        };
        let mut steps: Vec<usize> = (0..self.rows().saturating_sub(1))
            .filter_map(apart)
            .collect();
        steps.sort_unstable();
        let Some(&every) = steps.get(steps.len() / 2) else {
            return (Vec::new(), 1);
        };
        let mut runs = Vec::new();
        let mut from = 0;
        for row in 0..rest.len() {
            let ends = row + 1 == rest.len() || apart(row) != Some(every);
            if ends {
                runs.push(&rest[from..=row]);
                from = row + 1;
            }
        }
        (runs, every)
    }

    /// Weights of the samples of a row of the recorded torques.
    pub(crate) fn row_weights(&self) -> Vec<f64> {
        self.pass.weights(self.step_s, 0.0).1
    }

    /// What the low pass leaves of the standard deviation of a noise of the recorded torques.
    pub(crate) fn behind(&self, noise: Noise) -> f64 {
        noise.behind(&self.row_weights())
    }
}

impl Side {
    fn extend(
        &mut self,
        joint: usize,
        local: &LocalPolynomial,
        samples: &[f64],
        at: impl Iterator<Item = usize>,
    ) {
        for index in at {
            self.q[joint].push(local.at(0, samples, index));
            self.dq[joint].push(local.at(1, samples, index));
            self.ddq[joint].push(local.at(2, samples, index));
        }
    }
}

/// The narrowest window through which the speed of noisy positions is quiet, at most that of a cutoff.
fn sharpest(step_s: f64, cutoff_hz: f64, position_sd: f64) -> LocalPolynomial {
    let whole = LocalPolynomial::new(step_s, cutoff_hz);
    let windows = (0..).map(|k| LocalPolynomial::new(step_s, 0.5 / step_s * 0.8_f64.powi(k)));
    let narrower = windows.take_while(|own| own.half < whole.half);
    let quiet = |own: &LocalPolynomial| {
        position_sd * dot(&own.weights[1], &own.weights[1]).sqrt() <= SLIDING_NOISE
    };
    let found = narrower.into_iter().find(quiet);
    found.unwrap_or(whole)
}

/// Noise of the positions of each joint's motor.
fn position_sds(samples: &Samples, local: &LocalPolynomial) -> Vec<f64> {
    let joints = samples.pieces[0].motor.len();
    let noise = |joint: usize| {
        let pieces = samples.pieces.iter();
        let own = pieces.map(|piece| piece.motor[joint].as_slice());
        Noise::white(own, local).sd
    };
    (0..joints).map(noise).collect()
}

/// What the second derivative and the low pass leave of the standard deviation of white noise of positions, which may be smoothed
/// before.
fn acceleration_gain(
    local: &LocalPolynomial,
    smoother: Option<&LocalPolynomial>,
    weights: &[f64],
    stride: usize,
) -> f64 {
    let mut strided = vec![0.0; stride * (weights.len() - 1) + 1];
    for (k, weight) in weights.iter().enumerate() {
        strided[k * stride] = *weight;
    }
    let mut kernel = convolved(&strided, &local.weights[2]);
    if let Some(smoother) = smoother {
        kernel = convolved(&kernel, &smoother.weights[0]);
    }
    dot(&kernel, &kernel).sqrt()
}

fn convolved(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut found = vec![0.0; a.len() + b.len() - 1];
    for (k, factor) in a.iter().enumerate().filter(|(_, factor)| **factor != 0.0) {
        (found[k..].iter_mut().zip(b)).for_each(|(into, value)| *into += factor * value);
    }
    found
}

#[cfg(test)]
mod tests {
    use haptical_model::Recording;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    const TURNOVER: f64 = 0.01;

    #[test]
    fn a_log_that_is_looked_at_in_stretches_says_so() {
        let of = |rows: u32| {
            let time_s: Vec<f64> = (0..rows).map(|k| 0.01 * f64::from(k)).collect();
            let log = Recording {
                line: (2..).take(time_s.len()).collect(),
                joint: vec![time_s.iter().map(|t| t.sin()).collect()],
                output: vec![None],
                torque_nm: vec![Some(time_s.iter().map(|t| t.cos()).collect())],
                time_s: Some(time_s),
                ..Recording::default()
            };
            States::new(&Samples::new(&log, false).unwrap(), 8.0).unwrap()
        };
        assert_eq!(of(18_000).of_stretches, None);
        let long = of(100_000);
        let said = long.of_stretches.as_ref().unwrap();
        assert!(said.contains("of the log's 1000 s"), "{said}");
        let seen_s = format!("of {:.0} of", long.steps() as f64 * long.fine_s);
        assert!(said.contains(&seen_s), "{said}");
    }

    #[test]
    fn spread_is_the_transpose_of_filtered() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let time_s: Vec<f64> = (0..1500).map(|k| 0.005 * f64::from(k)).collect();
        let log = Recording {
            line: (2..).take(time_s.len()).collect(),
            joint: vec![time_s.iter().map(|t| t.sin()).collect()],
            output: vec![None],
            torque_nm: vec![Some(time_s.iter().map(|t| t.cos()).collect())],
            time_s: Some(time_s),
            ..Recording::default()
        };
        let states = States::new(&Samples::new(&log, false).unwrap(), 8.0).unwrap();
        let mut normal = |count: usize| -> Vec<f64> {
            (0..count)
                .map(|_| StandardNormal.sample(&mut random))
                .collect()
        };
        let (signal, rows) = (normal(states.steps()), normal(states.rows()));
        let one = dot(&states.filtered(&signal), &rows);
        let other = dot(&signal, &states.spread(&rows));
        assert!(
            (one - other).abs() < 1e-12 * states.steps() as f64,
            "{one} {other}"
        );
    }

    /// Speed of a joint that slows down, sticks, and leaves at once in the other direction.
    fn speed(t: f64) -> f64 {
        let side = if t.rem_euclid(4.0) < 2.0 { 1.0 } else { -1.0 };
        side * 0.5 * (1.0 - t.rem_euclid(2.0) / 1.6).max(0.0)
    }

    /// Its integral.
    fn position(t: f64) -> f64 {
        let whole = |t: f64| 0.5 * (t.min(1.6) - t.min(1.6).powi(2) / 3.2);
        let within = t.rem_euclid(4.0);
        match within < 2.0 {
            true => whole(within),
            false => whole(2.0) - whole(within - 2.0),
        }
    }

    /// Friction changes sides when the joint does, however narrow the band: with the speed of the band it does not.
    #[test]
    fn friction_has_the_speed_of_the_joint_and_not_that_of_the_band() {
        let time_s: Vec<f64> = (0..4000).map(|k| 0.005 * (f64::from(k) + 0.5)).collect();
        let log = Recording {
            line: (2..).take(time_s.len()).collect(),
            joint: vec![time_s.iter().map(|t| position(*t)).collect()],
            output: vec![None],
            torque_nm: vec![Some(time_s.iter().map(|t| t.sin()).collect())],
            time_s: Some(time_s),
            ..Recording::default()
        };
        let samples = Samples::new(&log, false).unwrap();
        let states = States::new(&samples, 8.0).unwrap();
        let side = |speeds: &[f64]| {
            let side: Vec<f64> = speeds.iter().map(|own| (own / TURNOVER).tanh()).collect();
            states.filtered(&side)
        };
        let truth: Vec<f64> = states.time_s.iter().map(|t| speed(*t)).collect();
        let truth = side(&truth);
        let off = |speeds: &[f64]| {
            let own = side(speeds);
            let square: f64 = own.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum();
            (square / truth.len() as f64).sqrt()
        };
        let (sharp, smooth) = (off(&states.sliding[0]), off(&states.motor.dq[0]));
        assert!(sharp < 0.035 && smooth > 1.4 * sharp, "{sharp} {smooth}");
    }

    /// Noise that would be a speed of its own widens the window, to that of the band at most.
    #[test]
    fn noisy_positions_are_smoothed_as_the_band_is() {
        let whole = LocalPolynomial::new(0.005, 16.0);
        assert_eq!(sharpest(0.005, 16.0, 1e-7).half, 3);
        let between = sharpest(0.005, 16.0, 1e-5).half;
        assert!(between > 3 && between < whole.half, "{between}");
        assert_eq!(sharpest(0.005, 16.0, 1e-3).half, whole.half);
    }

    /// The scatter that noise of the positions makes in rows of a link's acceleration, over what is said of it.
    fn scatter(wave_rad: f64, [motor_sd, link_sd]: [f64; 2]) -> (bool, f64) {
        let mut random = ChaCha8Rng::seed_from_u64(11);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let time_s: Vec<f64> = (0..8000).map(|k| 0.005 * f64::from(k)).collect();
        let states = |motor: Vec<f64>, link: Vec<f64>| {
            let log = Recording {
                line: (2..).take(time_s.len()).collect(),
                joint: vec![motor],
                output: vec![Some(link)],
                torque_nm: vec![Some(time_s.iter().map(|t| t.sin()).collect())],
                time_s: Some(time_s.clone()),
                ..Recording::default()
            };
            States::new(&Samples::new(&log, false).unwrap(), 8.0).unwrap()
        };
        let motor: Vec<f64> = time_s.iter().map(|t| t.sin()).collect();
        let yields = |t: &f64| wave_rad * (std::f64::consts::TAU * 10.0 * t).sin();
        let link: Vec<f64> = (motor.iter().zip(&time_s))
            .map(|(motor, t)| motor - yields(t))
            .collect();
        let mut noisy = |exact: &[f64], sd: f64| -> Vec<f64> {
            exact.iter().map(|value| value + sd * normal()).collect()
        };
        let read = states(noisy(&motor, motor_sd), noisy(&link, link_sd));
        let exact = states(motor, link);
        let rows = |states: &States| states.filtered(&states.link.ddq[0]);
        let off = rows(&read).into_iter().zip(rows(&exact));
        let squares: f64 = off.map(|(read, exact)| (read - exact).powi(2)).sum();
        let noise = read.link_noise[0];
        let of_motor = if noise.is_apart {
            0.0
        } else {
            read.acceleration_sd[0]
        };
        let said = of_motor.hypot(noise.acceleration_sd);
        (noise.is_apart, (squares / read.rows() as f64).sqrt() / said)
    }

    #[test]
    fn noise_of_a_links_acceleration_is_what_its_rows_scatter_by() {
        // as it reads, because the drive yields near the edge of the band
        let (is_apart, share) = scatter(1e-3, [1e-6, 1e-4]);
        assert!(is_apart && (share - 1.0).abs() < 0.15, "{share}");
        // the smoothed difference on a motor that is as noisy behind the window
        let (is_apart, share) = scatter(0.0, [2e-5, 1e-4]);
        assert!(!is_apart && (share - 1.0).abs() < 0.15, "{share}");
    }
}
