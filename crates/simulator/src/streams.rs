//! Random numbers that mean the same on every machine: one ChaCha stream per purpose.
//!
//! Normal numbers are made here, not by `rand_distr`: its normal distribution calls `exp` and `ln`
//! through `num-traits`, which takes the platform's instead of `libm`'s as soon as any crate of the
//! build turns on `num-traits/std`, and faer, nalgebra and proptest do. What a seed means would then
//! depend on what else is compiled. Box & Muller's method with `libm` does not, and it takes
//! exactly two uniform numbers for a normal one, so row k's noise does not depend on other rows'.

use rand::distr::OpenClosed01;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// What a stream of random numbers is for: the kind of the crate's documentation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stream {
    /// Readings of a whole device.
    Poses = 0,
    /// Noise of an external encoder.
    Output = 2,
    /// Noise of a cable encoder.
    Cable = 3,
    /// Readings of one transmission.
    TransmissionPoses = 4,
    /// Noise of the external encoder of one transmission recorded alone. Not [`Stream::Output`], so
    /// that one seed may serve both recordings of a device.
    TransmissionOutput = 5,
    /// Where a hand moves a joint.
    MotionTarget = 6,
    /// Noise of an external encoder of a moved device.
    MotionOutput = 7,
    /// Noise of a cable encoder of a moved device.
    MotionCable = 8,
    /// Force of the hand along one axis of the handle.
    HandForce = 9,
    /// Roughness of a joint's drums; opened with the device's seed, not the recording's.
    Roughness = 10,
    /// Noise of a torque.
    MotionTorque = 11,
    /// Noise of one axis of the force sensor.
    MotionForce = 12,
    /// Noise of the thermometer.
    Temperature = 13,
    /// Where a tracker stands and what it sees, where neither is known.
    TrackerPlace = 14,
    /// Noise of a tracker's positions.
    TrackerPosition = 15,
    /// Noise of its orientations.
    TrackerOrientation = 16,
    /// Where a tracker stands in one run, where that is not known.
    RunPlace = 17,
    /// Where a named tool is on the hand, where that is not known.
    ToolPlace = 18,
    /// What a known distance or angle between touched things is off.
    TouchPair = 19,
    /// How far a touch misses its point or plane.
    Touch = 20,
    /// How far a homing fixture misses the angle of a joint.
    Fixture = 21,
    /// Noise of an external encoder at single postures.
    PostureOutput = 22,
    /// Noise of a cable encoder at single postures.
    PostureCable = 23,
    /// Noise of a tracker's positions at single postures.
    PosturePosition = 24,
    /// Noise of its orientations there.
    PostureOrientation = 25,
    /// How far a drawn device deviates from its file.
    Deviation = 26,
}

impl Stream {
    /// The numbers of a joint, cable or axis (from 0): ChaCha stream kind times 2^32 plus index.
    pub(crate) fn open(self, index: usize, seed: u64) -> ChaCha8Rng {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(((self as u64) << 32) + index as u64);
        generator
    }
}

/// Each row's section of a pose stream is 2^36 words long, more than the bounded draws of 170 joints
/// use, so a rejected draw in one row does not shift the next row.
const ROW_WORDS_LOG2: u32 = 36;

/// Moves to the section of a row.
pub(crate) fn seek_row(generator: &mut ChaCha8Rng, row: usize) {
    generator.set_word_pos((row as u128) << ROW_WORDS_LOG2);
}

/// A number in (0, 1], a multiple of 2^-53.
pub(crate) fn uniform(generator: &mut ChaCha8Rng) -> f64 {
    generator.sample(OpenClosed01)
}

/// A normal number of mean 0 and standard deviation 1: sqrt(-2 ln u) cos(2 pi v), u and v uniform
/// (Box & Muller, "A note on the generation of random normal deviates", 1958). The second number of
/// the pair is not used, so that each call takes four words.
pub(crate) fn normal(generator: &mut ChaCha8Rng) -> f64 {
    let radius = libm::sqrt(-2.0 * libm::log(uniform(generator)));
    radius * libm::cos(std::f64::consts::TAU * uniform(generator))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// libm's logarithm, sine and cosine are within an ulp, and numbers here are below 8 in size.
    const NORMAL_TOLERANCE: f64 = 4e-15;

    /// Uniform and normal numbers from an implementation of the documented streams in Python.
    #[test]
    fn streams_are_what_the_documentation_says() {
        let text = include_str!("../tests/fixtures/streams.csv");
        let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
        assert_eq!(lines.len(), 24);
        for line in lines {
            let cells: Vec<&str> = line.split(',').collect();
            let whole = |cell: usize| cells[cell].parse::<u64>().expect("an integer");
            let (seed, kind, index) = (whole(0), whole(1), whole(2) as usize);
            let (row, position) = (whole(3) as usize, whole(4));
            let stream = match kind {
                0 => Stream::Poses,
                2 => Stream::Output,
                3 => Stream::Cable,
                4 => Stream::TransmissionPoses,
                _ => Stream::TransmissionOutput,
            };
            let mut generator = stream.open(index, seed);
            seek_row(&mut generator, row);
            let mut again = generator.clone();
            (0..position).for_each(|_| _ = normal(&mut generator));
            (0..2 * position).for_each(|_| _ = uniform(&mut again));
            let bits = u64::from_str_radix(cells[5], 16).expect("the bits of a number");
            assert_eq!(uniform(&mut again).to_bits(), bits, "uniform of {line}");
            let want: f64 = cells[6].parse().expect("a number");
            let got = normal(&mut generator);
            assert!((got - want).abs() <= NORMAL_TOLERANCE, "{got} for {line}");
        }
    }
}
