//! Equation (1) at many readings at once.

use haptical_batch::sines_cosines;
use haptical_model::transmission::{Capstan, CapstanError};

/// Values at the rows; kept from call to call.
#[derive(Debug, Default)]
pub(crate) struct ErrorValues {
    pub(crate) values: Vec<f64>,
    /// One column for each parameter of the error, where they are not the law's own.
    pub(crate) derivatives: Vec<Vec<f64>>,
}

/// Equation (1) at many readings: the drums' angles do not change with the parameters.
#[derive(Debug)]
pub(crate) struct CapstanRows {
    capstan: Capstan,
    readings: Vec<f64>,
    /// Sines and cosines of the output drum's angle, then the input drum's.
    sines: [Vec<f64>; 2],
    cosines: [Vec<f64>; 2],
}

impl CapstanRows {
    pub(crate) fn new(capstan: Capstan, readings: &[f64]) -> Self {
        let zeros = || [vec![0.0; readings.len()], vec![0.0; readings.len()]];
        let (mut sines, mut cosines) = (zeros(), zeros());
        sines_cosines(readings, &mut sines[0], &mut cosines[0]);
        let ratio = capstan.transmission_ratio();
        let input: Vec<f64> = readings.iter().map(|reading| ratio * reading).collect();
        sines_cosines(&input, &mut sines[1], &mut cosines[1]);
        Self {
            capstan,
            readings: readings.to_vec(),
            sines,
            cosines,
        }
    }

    /// The formulas of [`Capstan::evaluate`], which also says whether the parameters are allowed.
    pub(crate) fn evaluate(
        &self,
        parameters: &[f64],
        derivatives: bool,
        into: &mut ErrorValues,
    ) -> Option<()> {
        let error = CapstanError::from_array(parameters.try_into().ok()?);
        self.capstan.evaluate(&error, 0.0).ok()?;
        let ratio = self.capstan.transmission_ratio();
        let actual_ratio = ratio + error.ratio_deviation;
        let ratio_slope = -error.ratio_deviation / actual_ratio;
        let per_ratio = -(ratio / actual_ratio) / actual_ratio;
        let rows = self.readings.len();
        into.values.clear();
        let values = self.readings.iter();
        into.values
            .extend(values.map(|reading| error.offset_rad + ratio_slope * reading));
        if derivatives {
            into.derivatives.resize_with(6, Vec::new);
            for column in &mut into.derivatives {
                column.resize(rows, 0.0);
            }
            into.derivatives[0].fill(1.0);
            for (value, reading) in into.derivatives[1].iter_mut().zip(&self.readings) {
                *value = per_ratio * reading;
            }
        }
        let drums = [
            (error.output_drum_xy_m, self.capstan.drum_distance_m()),
            (
                error.input_drum_xy_m,
                self.capstan.input_drum_denominator_m(),
            ),
        ];
        let drums = drums.map(|(xy_m, denominator_m)| Drum::new(xy_m, denominator_m));
        let is_small = drums.iter().all(Drum::is_small);
        if !is_small {
            for (value, reading) in into.values.iter_mut().zip(&self.readings) {
                *value = self.capstan.error(&error, *reading).ok()?;
            }
        }
        for (index, drum) in drums.iter().enumerate() {
            let angles = (&self.sines[index][..rows], &self.cosines[index][..rows]);
            if !derivatives {
                if is_small {
                    drum.add_angles(angles, &mut into.values);
                }
                continue;
            }
            let [per_x, per_y] = &mut into.derivatives[2 + 2 * index..4 + 2 * index] else {
                return None;
            };
            if is_small {
                drum.add_with_derivatives(angles, &mut into.values, [per_x, per_y]);
            } else {
                drum.write_derivatives(angles, per_x, per_y);
            }
        }
        Some(())
    }

    /// 1 + d error / d reading of allowed parameters, as [`Capstan::evaluate`] has it.
    pub(crate) fn slopes(&self, error: &CapstanError) -> Vec<f64> {
        let ratio = self.capstan.transmission_ratio();
        let constant = 1.0 - error.ratio_deviation / (ratio + error.ratio_deviation);
        let output = Drum::new(error.output_drum_xy_m, self.capstan.drum_distance_m());
        let denominator_m = self.capstan.input_drum_denominator_m();
        let input = Drum::new(error.input_drum_xy_m, denominator_m);
        let angles = |drum: usize| self.sines[drum].iter().zip(&self.cosines[drum]);
        let rows = angles(0).zip(angles(1));
        rows.map(|((&sine, &cosine), (&input_sine, &input_cosine))| {
            let turn = output.slope(sine, cosine);
            constant + turn + ratio * input.slope(input_sine, input_cosine)
        })
        .collect()
    }
}

/// One drum of equation (1), as `haptical_transmission` has it: with x and y over D,
/// n = x sin + y cos, d = 1 - x cos + y sin, its angle atan(n / d) less that at home, as d > 0.
struct Drum {
    x: f64,
    y: f64,
    denominator_m: f64,
}

impl Drum {
    fn new([x_m, y_m]: [f64; 2], denominator_m: f64) -> Self {
        Self {
            x: x_m / denominator_m,
            y: y_m / denominator_m,
            denominator_m,
        }
    }

    fn tangent(&self, sine: f64, cosine: f64) -> f64 {
        let n = self.x * sine + self.y * cosine;
        n / (1.0 - (self.x * cosine - self.y * sine))
    }

    fn per_xy(&self, sine: f64, cosine: f64) -> [f64; 2] {
        let n = self.x * sine + self.y * cosine;
        let d = 1.0 - (self.x * cosine - self.y * sine);
        let scale = 1.0 / ((n * n + d * d) * self.denominator_m);
        [
            (sine * d + n * cosine) * scale,
            (cosine * d - n * sine) * scale,
        ]
    }

    /// Derivative of the angle with respect to the drum's own: dn = 1 - d, dd = n.
    fn slope(&self, sine: f64, cosine: f64) -> f64 {
        let n = self.x * sine + self.y * cosine;
        let q = self.x * cosine - self.y * sine;
        let d = 1.0 - q;
        (q * d - n * n) / (n * n + d * d)
    }

    fn add_angles(&self, (sines, cosines): (&[f64], &[f64]), values: &mut [f64]) {
        if self.x == 0.0 && self.y == 0.0 {
            return;
        }
        let home = small_arctangent(self.tangent(0.0, 1.0));
        for (value, (&sine, &cosine)) in values.iter_mut().zip(sines.iter().zip(cosines)) {
            *value += small_arctangent(self.tangent(sine, cosine)) - home;
        }
    }

    /// As [`Drum::add_angles`] and [`Drum::write_derivatives`] in one go.
    fn add_with_derivatives(
        &self,
        (sines, cosines): (&[f64], &[f64]),
        values: &mut [f64],
        [per_x, per_y]: [&mut [f64]; 2],
    ) {
        let home = small_arctangent(self.tangent(0.0, 1.0));
        let per_home = self.per_xy(0.0, 1.0);
        let angles = sines.iter().zip(cosines);
        let into = values.iter_mut().zip(per_x.iter_mut().zip(per_y));
        for ((value, (per_x, per_y)), (&sine, &cosine)) in into.zip(angles) {
            *value += small_arctangent(self.tangent(sine, cosine)) - home;
            let here = self.per_xy(sine, cosine);
            *per_x = here[0] - per_home[0];
            *per_y = here[1] - per_home[1];
        }
    }

    /// Whether no tangent can exceed [`SMALL_TANGENT`]: |n / d| <= e / (1 - e), e the eccentricity over D.
    fn is_small(&self) -> bool {
        let eccentricity = (self.x * self.x + self.y * self.y).sqrt();
        eccentricity <= SMALL_TANGENT * (1.0 - eccentricity)
    }

    fn write_derivatives(
        &self,
        (sines, cosines): (&[f64], &[f64]),
        per_x: &mut [f64],
        per_y: &mut [f64],
    ) {
        let home = self.per_xy(0.0, 1.0);
        let into = per_x.iter_mut().zip(per_y);
        for ((per_x, per_y), (&sine, &cosine)) in into.zip(sines.iter().zip(cosines)) {
            let here = self.per_xy(sine, cosine);
            *per_x = here[0] - home[0];
            *per_y = here[1] - home[1];
        }
    }
}

/// Up to here the series below is exact to rounding: the next term is t^12 / 13 of the first.
const SMALL_TANGENT: f64 = 0.04;

/// atan t = t - t^3/3 + ... - t^11/11, for all rows in lanes: a capstan's drums are centred to a hundredth of
/// their distance.
fn small_arctangent(tangent: f64) -> f64 {
    let square = tangent * tangent;
    let mut sum = -1.0 / 11.0;
    for coefficient in [1.0 / 9.0, -1.0 / 7.0, 0.2, -1.0 / 3.0] {
        sum = sum * square + coefficient;
    }
    tangent + tangent * square * sum
}
