//! A joint's columns as means of blocks.

use haptical_model::{Device, JointType, Recording};

use crate::thresholds::current::{LARGEST_READING, LEAST_BLOCKS, NOISE_OF_SLOPE};

/// A block of rows.
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
