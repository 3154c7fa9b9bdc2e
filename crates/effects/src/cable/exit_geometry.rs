//! The cable bends over a round guide where it leaves its encoder.

use crate::cable::EXIT;
use crate::laws::{Input, Law};
use crate::{Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "cable-exit-geometry",
    meaning: "the measuring cable bends round its guide where it leaves",
    inspect: "the radius of the guide; enter it, or turn the encoder towards the workspace",
    adds: "Exit guide",
    source: "C5, C11",
    parameters: &[Parameter::size("radius_m", 0.0, 0.05)],
    ..EXIT
};

pub(crate) const LAW: ExitGeometry = ExitGeometry;

#[derive(Debug)]
pub(crate) struct ExitGeometry;

/// Length over a guide of radius r that the cable touches along its exit axis, minus the straight
/// distance `length_m` at the angle `angle_rad` from that axis: with the guide's centre at r across
/// the axis, v the handle seen from it, s^2 = v^2 - r^2 and the arc's angle that of v plus
/// atan(r / s), the length is s + r times that angle (docs/diagnosis.md, "Exit guide").
fn over_guide(length_m: f64, angle_rad: f64, radius_m: f64) -> f64 {
    let (sin, cos) = angle_rad.sin_cos();
    let (along, across) = (length_m * cos, length_m * sin - radius_m);
    let straight = (length_m * (length_m - 2.0 * radius_m * sin))
        .max(0.0)
        .sqrt();
    let turned = across.atan2(along) + radius_m.atan2(straight);
    straight + radius_m * turned - length_m
}

/// Step of the central difference \[m\].
const STEP_M: f64 = 1e-5;

impl Law for ExitGeometry {
    fn columns(&self, input: Input<'_, '_>, amplitudes: &[f64], _: f64) -> Option<Vec<Vec<f64>>> {
        let (wider, narrower) = (amplitudes[0] + STEP_M, amplitudes[0] - STEP_M);
        let (wider, narrower) = (along(input, wider)?, along(input, narrower)?);
        let pairs = wider.iter().zip(&narrower);
        Some(vec![pairs.map(|(a, b)| (a - b) / (2.0 * STEP_M)).collect()])
    }

    fn error(&self, input: Input<'_, '_>, amplitudes: &[f64]) -> Option<Vec<f64>> {
        along(input, amplitudes[0])
    }
}

/// The error at every row.
fn along(input: Input<'_, '_>, radius_m: f64) -> Option<Vec<f64>> {
    let cable = input.context.cable.as_ref()?;
    let error = |row| over_guide(cable.length_m[row], cable.exit_angle_rad(row), radius_m);
    Some((0..input.context.rows()).map(error).collect())
}
