//! Equation (1) at the readings of one joint.

use haptical_batch::sines_cosines;
use haptical_model::transmission::{Capstan, CapstanError, CapstanRows};

/// Values at the rows; kept from call to call.
#[derive(Debug, Default)]
pub(crate) struct ErrorValues {
    pub(crate) values: Vec<f64>,
    /// One column for each parameter of equation (1).
    pub(crate) derivatives: [Vec<f64>; 6],
}

/// The readings of a capstan with the sines and cosines of its drums' angles, which do not change with the
/// parameters.
#[derive(Debug)]
pub(crate) struct CapstanReadings {
    capstan: Capstan,
    readings: Vec<f64>,
    /// Sines and cosines of the output drum's angle.
    output: [Vec<f64>; 2],
    /// Those of the input drum's.
    input: [Vec<f64>; 2],
}

impl CapstanReadings {
    pub(crate) fn new(capstan: Capstan, readings: &[f64]) -> Self {
        let ratio = capstan.transmission_ratio();
        let angles = |ratio: f64| {
            let angles: Vec<f64> = readings.iter().map(|reading| ratio * reading).collect();
            let [mut sines, mut cosines] = [vec![0.0; angles.len()], vec![0.0; angles.len()]];
            sines_cosines(&angles, &mut sines, &mut cosines);
            [sines, cosines]
        };
        Self {
            output: angles(1.0),
            input: angles(ratio),
            readings: readings.to_vec(),
            capstan,
        }
    }

    fn rows(&self) -> CapstanRows<'_> {
        CapstanRows {
            capstan: self.capstan,
            angles_rad: &self.readings,
            output: self.output.each_ref().map(Vec::as_slice),
            input: self.input.each_ref().map(Vec::as_slice),
        }
    }

    /// None where the law refuses the parameters.
    pub(crate) fn evaluate(
        &self,
        parameters: &[f64],
        derivatives: bool,
        into: &mut ErrorValues,
    ) -> Option<()> {
        let error = CapstanError::from_array(parameters.try_into().ok()?);
        let rows = self.readings.len();
        into.values.resize(rows, 0.0);
        let columns = derivatives.then(|| {
            into.derivatives.each_mut().map(|column| {
                column.resize(rows, 0.0);
                column.as_mut_slice()
            })
        });
        let evaluated = self.rows().evaluate(&error, &mut into.values, columns);
        evaluated.ok()
    }

    /// 1 + d error / d reading of allowed parameters.
    pub(crate) fn slopes(&self, error: &CapstanError) -> Vec<f64> {
        self.rows().output_slopes(error).collect()
    }
}
