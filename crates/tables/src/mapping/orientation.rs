//! How a file writes orientations: quaternions, Euler angles, rotation vectors, matrices.

use serde::Deserialize;

use super::{Dimension, Unit};
use crate::rotation::is_order;

/// The columns of an orientation, or of a pose as a 4 x 4 matrix.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Orientation {
    /// What the columns are.
    pub kind: Representation,
    /// Their names in the file.
    pub from: Vec<String>,
    /// Which of the files side by side, counted from 1.
    pub file: Option<usize>,
    /// Quaternion: `wxyz` or `xyzw`. Euler angles: the axes in the order of `from`, such as `zyx`.
    pub order: Option<String>,
    /// Euler angles: `intrinsic` (about the moved axes) or `extrinsic` (about the fixed ones).
    pub axes: Option<Axes>,
    /// Matrices: whether `from` lists them row by row or column by column.
    pub layout: Option<Layout>,
    /// Unit of the angles, or of the position in a 4 x 4 matrix.
    pub unit: Option<String>,
    /// Whether the file has the inverse: the target seen from the camera where the camera seen from the target is wanted.
    #[serde(default)]
    pub invert: bool,
}

/// What the columns of an orientation are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Representation {
    /// Four parts.
    Quaternion,
    /// Three angles.
    Euler,
    /// Axis times angle.
    RotationVector,
    /// Nine elements.
    Matrix,
    /// Sixteen elements, or the first twelve row by row: orientation and position.
    Pose,
}

/// About which axes the second and third Euler angle turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Axes {
    /// The moved ones.
    Intrinsic,
    /// The fixed ones.
    Extrinsic,
}

/// How a matrix is listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Layout {
    /// Row by row.
    Row,
    /// Column by column, as MATLAB and Eigen keep it.
    Column,
}

impl Orientation {
    /// Columns of the log that come from it.
    pub(crate) fn outputs(&self) -> Vec<&'static str> {
        let position: &[&str] = match self.kind {
            Representation::Pose => &["x_m", "y_m", "z_m"],
            _ => &[],
        };
        [position, &["qw", "qx", "qy", "qz"]].concat()
    }

    /// Factor on its angles, or on the position.
    pub(crate) fn factor(&self) -> f64 {
        let unit = self.unit.as_deref().and_then(Unit::parse);
        unit.map_or(1.0, |unit| unit.factor)
    }

    pub(super) fn check(&self) -> Result<(), String> {
        use Representation::{Euler, Matrix, Pose, Quaternion, RotationVector};
        let lengths: &[usize] = match self.kind {
            Quaternion => &[4],
            Euler | RotationVector => &[3],
            Matrix => &[9],
            Pose => &[16, 12],
        };
        if !lengths.contains(&self.from.len()) {
            return Err(format!(
                "[orientation]: {} columns in `from`, {} are needed",
                self.from.len(),
                lengths[0]
            ));
        }
        let order = self.order.as_deref();
        match self.kind {
            Quaternion if !matches!(order, Some("wxyz" | "xyzw")) => {
                return Err(
                    "[orientation]: a quaternion needs order = \"wxyz\" or \"xyzw\"".to_owned(),
                );
            }
            Euler if !order.is_some_and(is_order) => {
                return Err(
                    "[orientation]: Euler angles need an order such as \"xyz\", in small letters"
                        .to_owned(),
                );
            }
            Euler if self.axes.is_none() => {
                return Err("[orientation]: Euler angles need axes = \"intrinsic\" (moved) or \"extrinsic\" (fixed)".to_owned());
            }
            Matrix | Pose if self.layout.is_none() => {
                return Err(
                    "[orientation]: a matrix needs layout = \"row\" or \"column\"".to_owned(),
                );
            }
            _ => {}
        }
        if self.from.len() == 12 && self.layout == Some(Layout::Column) {
            return Err("[orientation]: twelve columns are the first three rows of a pose, so layout = \"row\"".to_owned());
        }
        let wanted = match self.kind {
            Euler | RotationVector => Some(Dimension::Angle),
            Pose => Some(Dimension::Length),
            Quaternion | Matrix => None,
        };
        let unit = self.unit.as_deref().map(|word| (word, Unit::parse(word)));
        match unit {
            Some((word, unit)) if unit.map(|unit| unit.dimension) != wanted || wanted.is_none() => {
                Err(format!("[orientation]: `{word}` is no unit of it"))
            }
            _ => Ok(()),
        }
    }
}
