//! The one set of files that every contender reads, and the same numbers in memory for ours.
//!
//! A file is numbers alone, each a little-endian IEEE double, in this order:
//!
//! | count | numbers |
//! | --- | --- |
//! | 1 | poses, n |
//! | 1 | standard deviation of a distance \[m\] |
//! | 32 | the nominal table: a \[m\], alpha \[rad\], d \[m\], theta \[rad\] of rows 0 to 7, home angles included |
//! | 28 | places (from 0) of the free parameters among those 32 |
//! | 8 n | of each pose: seven joint variables \[rad\], each added to its row's theta; the distance \[m\] |

use std::path::Path;

use anyhow::{Context, Result, ensure};
use haptical_calibration::{Channel, Weights};
use haptical_model::{Device, Parameter, ParameterId, Recording};
use haptical_report::write_atomically;
use xtask_paper::{Paper, Scenario, nominal_device, with_transmissions_of};

/// Rows of the chain, and joints.
const ROWS: usize = 8;
/// The four parameters of a row, in the order of the file.
const PARAMETERS: [Parameter; 4] = [
    Parameter::A,
    Parameter::Alpha,
    Parameter::D,
    Parameter::Theta,
];
/// Random numbers of the recordings.
const SEED: u64 = 1;

/// Distances of a simulated device to identify 28 parameters from, at known joint angles.
#[derive(Debug, Clone)]
pub(crate) struct DataSet {
    /// Where the search starts.
    pub(crate) nominal: Device,
    pub(crate) recording: Recording,
    /// The 28 parameters of Table 3.
    pub(crate) free: Vec<ParameterId>,
    /// Standard deviation of a distance \[m\].
    pub(crate) sd_m: f64,
}

impl DataSet {
    /// The device of Table 3, its transmissions without errors, in random poses.
    pub(crate) fn simulate(poses: usize) -> Result<Self> {
        let paper = Paper::load()?;
        let mut scenario = Scenario::paper(nominal_device(None)?, &paper, false)?;
        scenario.truth = with_transmissions_of(&scenario.truth, &scenario.nominal);
        let recording = scenario.simulate(poses, SEED)?;
        let nominal = scenario.nominal;
        let rows = paper.table3.iter();
        let free = rows.map(|row| Ok(nominal.parameter(&row.name)?));
        let free: Vec<ParameterId> = free.collect::<Result<_>>()?;
        let sd_m = nominal.cable_sd_m(0).context("the cable has no sd")?;
        Ok(Self {
            nominal,
            recording,
            free,
            sd_m,
        })
    }

    pub(crate) fn poses(&self) -> usize {
        self.recording.len()
    }

    pub(crate) fn channels() -> [Channel; 1] {
        [Channel::Cable { index: 0 }]
    }

    /// Weights of the residuals: one over the standard deviation in the file.
    pub(crate) fn weights(&self) -> Weights {
        Weights::stated(&self.nominal, &Self::channels())
    }

    pub(crate) fn numbers(&self) -> Result<Vec<f64>> {
        let links = self.nominal.chain_links();
        ensure!(links.len() == ROWS, "the chain has {} rows", links.len());
        let mut numbers = vec![self.poses() as f64, self.sd_m];
        for link in &links {
            numbers.extend(PARAMETERS.map(|parameter| link.get(parameter)));
        }
        for free in &self.free {
            numbers.push(place(*free)? as f64);
        }
        let distances = self.recording.cable_m.first().and_then(Option::as_ref);
        let distances = distances.context("the recording has no distances")?;
        for (row, distance) in distances.iter().enumerate() {
            numbers.extend(self.recording.joint.iter().map(|column| column[row]));
            numbers.push(*distance);
        }
        Ok(numbers)
    }

    pub(crate) fn write(&self, path: &Path) -> Result<()> {
        let numbers = self.numbers()?;
        let bytes = numbers.iter().flat_map(|number| number.to_le_bytes());
        let bytes: Vec<u8> = bytes.collect();
        Ok(write_atomically(path, &bytes)?)
    }
}

/// Place of a parameter among the numbers of the table.
fn place(parameter: ParameterId) -> Result<usize> {
    let found = match parameter {
        ParameterId::Link { row, parameter } => PARAMETERS
            .iter()
            .position(|each| *each == parameter)
            .map(|position| row * PARAMETERS.len() + position),
        _ => None,
    };
    found.context("a free parameter is not in the table")
}

/// Reads any file of doubles.
#[cfg(test)]
pub(crate) fn read(path: &Path) -> Result<Vec<f64>> {
    let bytes = std::fs::read(path)?;
    let (numbers, rest) = bytes.as_chunks::<8>();
    ensure!(rest.is_empty(), "{} is cut off", path.display());
    Ok(numbers
        .iter()
        .map(|number| f64::from_le_bytes(*number))
        .collect())
}
