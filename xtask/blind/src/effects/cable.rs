//! The measuring cable: where it leaves its guide, how it hangs, twists, stretches and warms.

use haptical_model::kinematics::nalgebra::Vector3;

use crate::effects::{Act, Draw, Effect, Facts, Stage, fixed};
use crate::laws::slope_of;
use crate::rig::scene::{CablePath, Scene};

/// Names between which the exit's geometry cannot be distinguished: they differ by 1 % or less after
/// the lengths of the chain are fitted.
const EXIT: [&str; 3] = ["cable-exit-geometry", "cable-twist", "cable-zero-offset"];

/// The straight line from the exit to the handle, and the cable's length.
struct Line {
    /// Along the exit axis, and across it.
    along_m: f64,
    across_m: f64,
    chord_m: f64,
    /// Sine of its angle to the ground.
    rise: f64,
    length_m: f64,
}

/// An effect of the cable's path: what it adds to the cable's length.
fn routed(
    draw: &Draw<'_>,
    name: &'static str,
    right: &[&'static str],
    facts: Facts,
    extra_m: impl Fn(&Line) -> f64 + Send + Sync + 'static,
) -> Effect {
    let act = move |scene: &Scene<'_>, path: &CablePath, cable_m: &mut [f64]| {
        let up = -Vector3::from(scene.device.gravity_mps2.unwrap_or([0.0, 0.0, -1.0])).normalize();
        for (length_m, handle) in cable_m.iter_mut().zip(&path.handle) {
            let straight = handle.position_m - path.anchor_m;
            let along_m = straight.dot(&path.exit_axis);
            *length_m += extra_m(&Line {
                along_m,
                across_m: (straight - path.exit_axis * along_m).norm(),
                chord_m: straight.norm(),
                rise: straight.dot(&up) / straight.norm(),
                length_m: *length_m,
            });
        }
    };
    let info = draw.anywhere(name, right);
    Effect::new(info, fixed(facts), Act::Path(Box::new(act)))
}

/// Length of a cable from a guide to `(along, across)` in the plane of the exit axis: the free part is
/// tangent to a circle of radius `r` that touches the axis at the exit, the rest lies on the circle.
/// With the distance `d` of the end from the circle's centre the free part is `sqrt(d^2 - r^2)` and
/// the wrapped angle `atan2(across - r, along) + asin(r / d)`.
pub(crate) fn wrapped_length_m(along_m: f64, across_m: f64, radius_m: f64) -> f64 {
    let below_m = across_m - radius_m;
    let distance_m = libm::hypot(along_m, below_m).max(radius_m);
    let free_m = libm::sqrt(distance_m * distance_m - radius_m * radius_m);
    let mut wrapped_rad = libm::atan2(below_m, along_m);
    if radius_m > 0.0 {
        wrapped_rad += libm::asin((radius_m / distance_m).min(1.0));
    }
    if wrapped_rad < -1e-9 {
        wrapped_rad += std::f64::consts::TAU;
    }
    free_m + radius_m * wrapped_rad
}

/// The guide's rounded edge: the cable wraps it, in the plane of exit axis and handle.
pub(crate) fn exit_geometry(draw: &mut Draw<'_>) -> Effect {
    let radius_m = draw.amplitude(6e-3);
    let facts = Facts::default().with("radius_m", radius_m);
    routed(draw, "cable-exit-geometry", &EXIT, facts, move |line| {
        wrapped_length_m(line.along_m, line.across_m, radius_m) - line.chord_m
    })
}

/// Twist of the cable off its exit axis: it shortens by half a number times the squared angle from the axis, which saturates.
pub(crate) fn twist(draw: &mut Draw<'_>) -> Effect {
    let m_per_rad2 = draw.signed(2e-3);
    let saturation_rad = draw.random.uniform(1.5, 3.0);
    let facts = Facts::default()
        .law("curvature_m_per_rad2", m_per_rad2)
        .law("saturation_rad", saturation_rad);
    routed(draw, "cable-twist", &EXIT, facts, move |line| {
        let angle = libm::atan2(line.across_m, line.along_m) / saturation_rad;
        let square = saturation_rad * saturation_rad;
        m_per_rad2 * square * (libm::sqrt(1.0 + angle * angle) - 1.0)
    })
}

/// The cable's zero.
pub(crate) fn zero_offset(draw: &mut Draw<'_>) -> Effect {
    let offset_m = draw.signed(3e-3);
    let facts = Facts::default().with("offset_m", offset_m);
    routed(draw, "cable-zero-offset", &EXIT, facts, move |_| offset_m)
}

/// A cable that hangs; at physical tensions nothing can be seen of it. Parabola of weight over tension:
/// length - chord = (w cos)^2 L^3 / (24 T^2).
pub(crate) fn sag(draw: &mut Draw<'_>) -> Effect {
    let weight_per_tension_per_m = draw.amplitude(0.1);
    let facts = Facts::default().with("weight_n_per_m_over_tension", weight_per_tension_per_m);
    routed(draw, "cable-sag", &["cable-sag"], facts, move |line| {
        let load = weight_per_tension_per_m * weight_per_tension_per_m;
        let length_m = line.length_m;
        load * (1.0 - line.rise * line.rise) * length_m * length_m * length_m / 24.0
    })
}

fn scaled(draw: &Draw<'_>, name: &'static str, scale: f64) -> Effect {
    let facts = Facts::default().with("scale", scale);
    routed(draw, name, &[], facts, move |line| scale * line.length_m)
}

/// The drum's radius: the chain's lengths take it up.
pub(crate) fn scale(draw: &mut Draw<'_>) -> Effect {
    let scale = draw.signed(2e-3);
    scaled(draw, "cable-scale", scale)
}

/// Stretch under a spring of constant force: like the scale.
pub(crate) fn stretch(draw: &mut Draw<'_>) -> Effect {
    let scale = -draw.amplitude(5e-4);
    scaled(draw, "cable-stretch", scale)
}

/// Thermal drift of the measuring cable: it and its housing grow with temperature, mostly the housing.
pub(crate) fn thermal(draw: &mut Draw<'_>) -> Effect {
    let housing_m = draw.random.uniform(0.6, 2.0);
    let per_degc = draw.amplitude(40e-6) / (housing_m + 0.3);
    let law = move |scene: &Scene<'_>, signal: &[f64]| -> Vec<f64> {
        let rows = scene.temperature_degc.iter().zip(signal);
        rows.map(|(degc, length_m)| -per_degc * (degc - scene.cold_degc) * (length_m + housing_m))
            .collect()
    };
    let facts = move |scene: &Scene<'_>| {
        // the mean length is a guess of the order of the device's
        let deviation = law(scene, &vec![0.3; scene.len()]);
        Facts::default()
            .laws(named!(per_degc, housing_m))
            .law("m_per_degc", slope_of(&scene.temperature_degc, &deviation))
    };
    let info = draw.anywhere("thermal-drift", &["thermal-drift"]);
    Effect::added(info, Stage::Cable, facts, law)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Straight ahead nothing is wrapped; sideways a quarter of the circle is.
    #[test]
    fn a_rounded_guide_wraps_what_geometry_says() {
        let radius_m = 6e-3;
        assert!((wrapped_length_m(0.3, 0.0, radius_m) - 0.3).abs() < 1e-15);
        let sideways_m = wrapped_length_m(radius_m, radius_m + 0.3, radius_m);
        assert!((sideways_m - (0.3 + radius_m * std::f64::consts::FRAC_PI_2)).abs() < 1e-15);
        assert_eq!(wrapped_length_m(0.3, 0.4, 0.0), 0.5);
    }

    /// The free part leaves along its tangent: moving the end by ds lengthens the path by ds times the
    /// cosine of the angle to that tangent.
    #[test]
    fn the_free_part_pulls_along_its_tangent() {
        let (radius_m, step_m) = (0.05, 1e-6);
        for (along_m, across_m) in [(0.3_f64, 0.2_f64), (0.1, 0.25), (-0.05, 0.3)] {
            let length_m =
                |dx: f64, dy: f64| wrapped_length_m(along_m + dx, across_m + dy, radius_m);
            let slope = |dx: f64, dy: f64| (length_m(dx, dy) - length_m(-dx, -dy)) / (2.0 * step_m);
            let (x, y) = (slope(step_m, 0.0), slope(0.0, step_m));
            assert!((x.hypot(y) - 1.0).abs() < 1e-8, "a unit pull");
            // the tangent line passes the circle's centre at the radius
            let centre_distance = (along_m * y - (across_m - radius_m) * x).abs();
            assert!((centre_distance - radius_m).abs() < 1e-8);
        }
    }
}
