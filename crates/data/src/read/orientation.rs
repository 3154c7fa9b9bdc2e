//! Orientations as unit quaternions.

use haptical_model::Recording;

use crate::column::Role;
use crate::error::{DataError, Fault};
use crate::read::order::cell_of;

/// Allowed deviation of a quaternion's norm from 1: four components printed with three decimals
/// are off by at most 4 * 0.0005 / 2 = 0.001.
const NORM_TOLERANCE: f64 = 1e-3;

/// Squared norms this close to 1 are rounding of a unit quaternion, which is left as it is, so
/// that reading what was written gives the same numbers.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Scales the orientations to norm 1, `q / |q|`, after checking that they nearly have it.
pub(crate) fn normalise(
    recording: &mut Recording,
    columns: &[(String, Role)],
    file: &str,
) -> Result<(), DataError> {
    let Some([w, x, y, z]) = recording.orientation_wxyz.as_mut() else {
        return Ok(());
    };
    let parts = w.iter_mut().zip(x).zip(y).zip(z);
    for ((((w, x), y), z), &line) in parts.zip(&recording.line) {
        let squared = *w * *w + *x * *x + *y * *y + *z * *z;
        if squared.is_nan() || (squared - 1.0).abs() <= ROUNDING {
            continue;
        }
        let at = || cell_of(columns, Role::Orientation(0), file, line);
        if [*w, *x, *y, *z].iter().all(|part| *part == 0.0) {
            return Err(at().error(Fault::ZeroQuaternion));
        }
        let norm = squared.sqrt();
        if (norm - 1.0).abs() > NORM_TOLERANCE {
            return Err(at().error(Fault::QuaternionNorm {
                norm,
                allowed: NORM_TOLERANCE,
            }));
        }
        for part in [w, x, y, z] {
            *part /= norm;
        }
    }
    Ok(())
}
