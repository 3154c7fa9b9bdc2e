//! A joint's columns as means of blocks: its torque, and the columns of what may be between it and the current.

use std::ops::Range;

use haptical_effects::force::in_motion::{TORQUE_LATENCY, TORQUE_OFFSET, TORQUE_SATURATION};
use haptical_effects::force::{JOINT_FRICTION, MAGNETIC_SATURATION, TORQUE_CONSTANT_DRIFT};
use haptical_linalg::NormalEquations;
use haptical_metrics::{correlation, median, quantile};
use haptical_model::{Device, JointType, Recording};

use crate::thresholds::current::{
    LARGEST_READING, LEAST_BLOCKS, LEAST_LEFT, LEAST_NOISE, LEAST_VARIATION, LEAST_WARMING_K,
    LIMIT_SHARES, LIMITS, NOISE_OF_SLOPE, PARTS,
};

/// A number of a law: its name, what its coefficient is multiplied by, and whether that is over the torque constant.
type Number = (&'static str, f64, bool);

/// What a coefficient is multiplied with, block by block.
type Value<'v> = &'v dyn Fn(&Block) -> f64;

/// A law between current and torque.
#[derive(Debug)]
pub(super) struct Term {
    pub(super) effect: &'static str,
    /// Whether nature allows its first number above zero alone.
    pub(super) is_positive: bool,
    pub(super) numbers: Vec<Number>,
    columns: Range<usize>,
}

/// A joint's torque with the columns of its laws; the first column is the current.
#[derive(Debug)]
pub(super) struct Rows {
    pub(super) time_s: Vec<f64>,
    pub(super) torque_nm: Vec<f64>,
    columns: Vec<Vec<f64>>,
    pub(super) terms: Vec<Term>,
    pub(super) parts: Vec<NormalEquations>,
    pub(super) all: NormalEquations,
    /// Of the mean of a block \[N m\].
    pub(super) noise_nm: f64,
    /// Squared correlation of torque and current.
    pub(super) follows: f64,
}

impl Rows {
    /// The rows of uninterrupted blocks without some laws; why there are none otherwise.
    pub(super) fn new(segments: Vec<Vec<Block>>, without: &[String]) -> Result<Self, String> {
        let ends = segments.iter().scan(0, |end, own| {
            *end += own.len();
            Some(*end - own.len()..*end)
        });
        let runs: Vec<Range<usize>> = ends.collect();
        let blocks: Vec<Block> = segments.into_iter().flatten().collect();
        let current: Vec<f64> = blocks.iter().map(|own| own.current_a).collect();
        let torque_nm: Vec<f64> = blocks.iter().map(|own| own.torque_nm).collect();
        let mut rows = Self {
            time_s: blocks.iter().map(|own| own.time_s).collect(),
            parts: Vec::new(),
            all: NormalEquations::new(0),
            follows: correlation(&current, &torque_nm).unwrap_or(0.0).powi(2),
            columns: vec![current],
            torque_nm,
            terms: Vec::new(),
            noise_nm: 0.0,
        };
        rows.add_linear(&blocks);
        let linear: Vec<usize> = (0..rows.terms.len()).collect();
        let whole = rows.products(0..blocks.len());
        let fit = whole.solve(&rows.columns_of(&linear), |_| 0.0);
        let count = blocks.len() as f64;
        let square = whole.target_square() / count;
        let residual = rows.residual(&linear, fit.coefficients());
        let noise = runs.iter().flat_map(|run| residual[run.clone()].windows(3));
        let noise: f64 = noise.map(|w| (w[0] - 2.0 * w[1] + w[2]).powi(2)).sum();
        rows.noise_nm = (noise / (6.0 * count))
            .max(LEAST_NOISE.powi(2) * square)
            .sqrt();
        let mean = rows.torque_nm.iter().sum::<f64>() / count;
        if square - mean * mean <= LEAST_VARIATION * rows.noise_nm.powi(2) {
            return Err("the torque hardly varies".to_owned());
        }
        rows.add_limits(&blocks)?;
        rows.terms
            .retain(|own| without.iter().all(|name| name != own.effect));
        let part = |part: usize| part * blocks.len() / PARTS..(part + 1) * blocks.len() / PARTS;
        rows.parts = (0..PARTS).map(|own| rows.products(part(own))).collect();
        rows.all = rows.products(0..blocks.len());
        Ok(rows)
    }

    /// Laws that enter linearly, by docs/equations.md, Between current and torque.
    fn add_linear(&mut self, blocks: &[Block]) {
        let mut law = |effect, is_positive, numbers: &[(Number, Value<'_>)]| {
            let names = numbers.iter().map(|(own, _)| *own).collect();
            let columns = numbers.iter();
            let columns = columns.map(|(_, own)| blocks.iter().map(own).collect());
            self.add(effect, is_positive, names, columns.collect());
        };
        let (start_s, start_degrees) = blocks
            .first()
            .map_or((0.0, 0.0), |own| (own.time_s, own.degrees));
        let falls = |own: &Block| own.current_a.abs() * own.current_a;
        let in_time = |own: &Block| (own.time_s - start_s) * own.current_a;
        let in_warmth = |own: &Block| (own.degrees - start_degrees) * own.current_a;
        let drift = TORQUE_CONSTANT_DRIFT.name;
        law(
            TORQUE_OFFSET.name,
            false,
            &[(("torque_nm", 1.0, false), &|_| 1.0)],
        );
        law(
            MAGNETIC_SATURATION.name,
            true,
            &[(("share_per_a", -1.0, true), &falls)],
        );
        law(drift, false, &[(("share_per_s", 1.0, true), &in_time)]);
        law(
            TORQUE_LATENCY.name,
            false,
            &[(("delay_s", -1.0, true), &|own| own.amperes_per_s)],
        );
        let viscous = ("viscous_nm_s_per_rad", -1.0, false);
        law(
            JOINT_FRICTION.name,
            true,
            &[
                (("coulomb_nm", -1.0, false), &|own| own.side),
                (viscous, &|own| own.speed),
            ],
        );
        let degrees = blocks.iter().map(|own| own.degrees);
        let most = degrees.clone().fold(f64::NEG_INFINITY, f64::max);
        if most - degrees.fold(f64::INFINITY, f64::min) >= LEAST_WARMING_K {
            law(drift, false, &[(("share_per_degc", 1.0, true), &in_warmth)]);
        }
    }

    /// What is beyond limits of the current: (U - k |omega|) / R where the voltage is known, else a constant.
    fn add_limits(&mut self, blocks: &[Block]) -> Result<(), String> {
        let amperes: Vec<f64> = blocks.iter().map(|own| own.current_a.abs()).collect();
        let median = median(&amperes).map_err(|why| why.to_string())?;
        // no limit that is tried is below the lower half
        let half = blocks.iter().filter(|own| own.current_a.abs() <= median);
        let sums = half.fold([0.0, f64::MIN_POSITIVE], |[along, square], own| {
            let current = own.current_a;
            [along + current * own.torque_nm, square + current * current]
        });
        let constant = sums[0] / sums[1];
        let left = |own: &Block| {
            let left = |volts: f64| volts - (constant * own.speed).abs();
            let known = own.volts.map(|volts| left(volts).max(LEAST_LEFT * volts));
            known.unwrap_or(1.0)
        };
        let per_left = |own: &Block| own.current_a.abs() / left(own);
        let all: Vec<f64> = blocks.iter().map(per_left).collect();
        let volts = blocks
            .iter()
            .map(|own| own.volts.unwrap_or(1.0))
            .sum::<f64>()
            / blocks.len() as f64;
        for limit in 0..LIMITS {
            let [most, least] = LIMIT_SHARES;
            let share = most * (least / most).powf(limit as f64 / LIMITS as f64);
            let limit = quantile(&all, 1.0 - share).map_err(|why| why.to_string())?;
            let beyond = |own: &Block| {
                own.current_a.signum() * (own.current_a.abs() - limit * left(own)).max(0.0)
            };
            let number = ("limit_nm", -limit * volts, false);
            let column = blocks.iter().map(beyond).collect();
            self.add(TORQUE_SATURATION.name, true, vec![number], vec![column]);
        }
        Ok(())
    }

    fn add(
        &mut self,
        effect: &'static str,
        is_positive: bool,
        numbers: Vec<Number>,
        columns: Vec<Vec<f64>>,
    ) {
        let first = self.columns.len();
        self.columns.extend(columns);
        self.terms.push(Term {
            effect,
            is_positive,
            numbers,
            columns: first..self.columns.len(),
        });
    }

    fn products(&self, rows: Range<usize>) -> NormalEquations {
        let columns = self.columns.iter().map(|own| &own[rows.clone()]);
        let columns: Vec<&[f64]> = columns.collect();
        NormalEquations::from_columns(&columns, &self.torque_nm[rows])
    }

    /// Columns of the current and of some laws.
    pub(super) fn columns_of(&self, laws: &[usize]) -> Vec<usize> {
        let of_laws = laws.iter().flat_map(|law| self.terms[*law].columns.clone());
        std::iter::once(0).chain(of_laws).collect()
    }

    /// Numbers of some laws by a model's coefficients, of which the torque constant is the first.
    pub(super) fn numbers(&self, laws: &[usize], coefficients: &[f64]) -> Vec<Vec<f64>> {
        let mut own = coefficients.iter().skip(1);
        let mut number = |(_, factor, is_share): &Number| {
            let value = factor * own.next().unwrap_or(&0.0);
            match is_share {
                true => value / coefficients[0],
                false => value,
            }
        };
        let laws = laws.iter().map(|law| self.terms[*law].numbers.iter());
        laws.map(|own| own.map(&mut number).collect()).collect()
    }

    /// What a model leaves of the torque.
    pub(super) fn residual(&self, laws: &[usize], coefficients: &[f64]) -> Vec<f64> {
        let mut left = self.torque_nm.clone();
        for (column, factor) in self.columns_of(laws).iter().zip(coefficients) {
            let pairs = left.iter_mut().zip(&self.columns[*column]);
            pairs.for_each(|(left, own)| *left -= factor * own);
        }
        left
    }
}

#[derive(Debug)]
pub(super) struct Block {
    pub(super) time_s: f64,
    pub(super) current_a: f64,
    pub(super) torque_nm: f64,
    pub(super) degrees: f64,
    /// Of the supply, where it is known.
    pub(super) volts: Option<f64>,
    pub(super) amperes_per_s: f64,
    pub(super) speed: f64,
    /// Mean of the speed's sign.
    pub(super) side: f64,
}

/// Means of a block: time, current, torque, angle, temperature, voltage.
type Means = [f64; 6];

/// Blocks within uninterrupted rows: of the fewest rows in which the slope of the current is clear of its noise, else is clearest.
pub(super) fn read(
    recording: &Recording,
    (joint, joint_type): (usize, JointType),
) -> Result<Vec<Vec<Block>>, String> {
    if joint_type == JointType::Prismatic {
        return Err("the joint slides".to_owned());
    }
    let torque = recording.torque_nm.get(joint).and_then(Option::as_deref);
    let time = recording.time_s.as_deref();
    let (Some(time), Some(current), Some(torque)) = (time, recording.current(joint), torque) else {
        return Err("the log lacks times, its current or its torque".to_owned());
    };
    let whole = |column: Option<&[f64]>| {
        let whole = column.filter(|own| own.iter().all(|value| value.is_finite()));
        whole.map_or_else(|| vec![1.0; recording.len()], <[f64]>::to_vec)
    };
    let degrees = whole(recording.temperature_degc.as_deref());
    let volts = whole(recording.supply());
    let angle = &recording.joint[joint];
    let columns: [&[f64]; 6] = [time, current, torque, angle, &degrees, &volts];
    let is_read = |row: &usize| current[*row].is_finite() && torque[*row].is_finite();
    let rows: Vec<usize> = (0..recording.len()).filter(is_read).collect();
    let is_too_large = |row: &&usize| {
        let values = [current[**row], torque[**row], volts[**row]];
        values.iter().any(|value| value.abs() > LARGEST_READING)
    };
    if let Some(row) = rows.iter().find(is_too_large) {
        let line = recording.line.get(*row).copied().unwrap_or_default();
        return Err(format!(
            "line {line} has a current, torque or voltage beyond {LARGEST_READING:e}: correct it or leave its cell empty"
        ));
    }
    if rows.len() < LEAST_BLOCKS {
        return Err(format!(
            "{} rows have current and torque: record {LEAST_BLOCKS} at least",
            rows.len()
        ));
    }
    let follows =
        |a: &usize, b: &usize| *b == *a + 1 && recording.run_at(*a) == recording.run_at(*b);
    let of_size = |size: usize| -> Vec<Vec<Means>> {
        let mean = |block: &[usize]| {
            columns.map(|own| block.iter().map(|row| own[*row]).sum::<f64>() / size as f64)
        };
        let segments = rows.chunk_by(&follows);
        segments
            .map(|own| own.chunks_exact(size).map(&mean).collect())
            .collect()
    };
    let sizes = std::iter::successors(Some(1_usize), |size| Some(2 * size));
    let sizes = sizes.take_while(|size| rows.len() / size >= LEAST_BLOCKS);
    let mut means = of_size(1);
    for size in sizes.skip(1) {
        if slope_noise(&means) <= NOISE_OF_SLOPE {
            break;
        }
        let coarser = of_size(size);
        if slope_noise(&coarser) < slope_noise(&means) {
            means = coarser;
        }
    }
    let has_supply = recording.supply().is_some();
    Ok(means.iter().map(|own| blocks(own, has_supply)).collect())
}

/// Share of noise in the squares of the current's slopes, by its second differences: these of noise have 6 variances, slopes 2.
fn slope_noise(means: &[Vec<Means>]) -> f64 {
    let threes = means.iter().flat_map(|own| own.windows(3));
    let sums = threes.fold([0.0, 0.0], |[curvature, slope], three| {
        let [a, b, c] = [three[0][1], three[1][1], three[2][1]];
        [
            curvature + (a - 2.0 * b + c).powi(2),
            slope + (c - a).powi(2),
        ]
    });
    sums[0] / (3.0 * sums[1].max(f64::MIN_POSITIVE))
}

/// Blocks but for the first and last of a segment, with their slopes.
fn blocks(means: &[Means], has_supply: bool) -> Vec<Block> {
    let block = |three: &[Means]| {
        let slope =
            |index: usize| (three[2][index] - three[0][index]) / (three[2][0] - three[0][0]);
        let [time_s, current_a, torque_nm, angle, degrees, volts] = three[1];
        let (before, after) = (angle - three[0][3], three[2][3] - angle);
        // a speed that is linear in time changes its sign within the block where it changes by more than twice itself
        let side = (before + after) / (after - before).abs().max(f64::MIN_POSITIVE);
        Block {
            time_s,
            current_a,
            torque_nm,
            degrees,
            volts: has_supply.then_some(volts),
            amperes_per_s: slope(1),
            speed: slope(3),
            side: side.clamp(-1.0, 1.0),
        }
    };
    means.windows(3).map(block).collect()
}

/// The recording without currents and voltages, which no other view reads; none where it has no currents.
pub(crate) fn without_currents(device: &Device, recording: &Recording) -> Option<Recording> {
    let mut joints = 0..device.joints.len();
    let has_currents = joints.any(|joint| recording.current(joint).is_some());
    has_currents.then(|| {
        let mut without = recording.clone();
        let is_of_motors = |name: &str| {
            name == "supply_v" || (name.starts_with("current") && name.ends_with("_a"))
        };
        without.covariates.retain(|(name, _)| !is_of_motors(name));
        without
    })
}
