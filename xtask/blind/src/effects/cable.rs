//! The measuring cable: where it leaves its guide, how it hangs, twists, stretches and warms.

use haptical_model::kinematics::nalgebra::Vector3;

use crate::effects::added::{Added, Law, Place};
use crate::effects::{Draw, Effect, Facts, Info};
use crate::laws::slope_of;
use crate::rig::scene::{CablePath, Scene};

/// Names between which the exit's geometry cannot be distinguished: they differ by 1 % or less after
/// the lengths of the chain are fitted.
const EXIT: [&str; 3] = ["cable-exit-geometry", "cable-twist", "cable-zero-offset"];

/// What the cable's path does to its length.
#[derive(Debug, Clone, Copy)]
enum Path {
    /// Wraps a rounded guide of this radius \[m\], in the plane of exit axis and handle.
    Guide { radius_m: f64 },
    /// Shortens as it twists: half this times the squared angle from the exit axis, saturating at an
    /// angle \[m/rad^2, rad\].
    Twist {
        m_per_rad2: f64,
        saturation_rad: f64,
    },
    /// Hangs: parabola of weight over tension \[1/m\].
    Sag { weight_per_tension_per_m: f64 },
    /// A constant \[m\].
    Zero { offset_m: f64 },
    /// Scale of the drum \[m/m\].
    Scale { scale: f64 },
}

/// An effect of the path.
#[derive(Debug)]
struct Routed {
    info: Info,
    path: Path,
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

impl Routed {
    /// What is added to a length, for the straight line from the exit to the handle.
    fn extra_m(
        &self,
        straight: &Vector3<f64>,
        exit: &Vector3<f64>,
        up: &Vector3<f64>,
        length_m: f64,
    ) -> f64 {
        let along_m = straight.dot(exit);
        let across_m = (straight - exit * along_m).norm();
        match self.path {
            Path::Guide { radius_m } => {
                wrapped_length_m(along_m, across_m, radius_m) - straight.norm()
            }
            Path::Twist {
                m_per_rad2,
                saturation_rad,
            } => {
                let angle = libm::atan2(across_m, along_m) / saturation_rad;
                let square = saturation_rad * saturation_rad;
                m_per_rad2 * square * (libm::sqrt(1.0 + angle * angle) - 1.0)
            }
            Path::Sag {
                weight_per_tension_per_m,
            } => {
                // parabola: length - chord = (w cos)^2 L^3 / (24 T^2)
                let rise = straight.dot(up) / straight.norm();
                let load = weight_per_tension_per_m * weight_per_tension_per_m;
                load * (1.0 - rise * rise) * length_m * length_m * length_m / 24.0
            }
            Path::Zero { offset_m } => offset_m,
            Path::Scale { scale } => scale * length_m,
        }
    }
}

impl Effect for Routed {
    fn info(&self) -> &Info {
        &self.info
    }

    fn facts(&self, _scene: &Scene<'_>) -> Facts {
        let facts = Facts::default();
        match self.path {
            Path::Guide { radius_m } => facts.with("radius_m", radius_m),
            Path::Twist {
                m_per_rad2,
                saturation_rad,
            } => facts
                .law("curvature_m_per_rad2", m_per_rad2)
                .law("saturation_rad", saturation_rad),
            Path::Sag {
                weight_per_tension_per_m,
            } => facts.with("weight_n_per_m_over_tension", weight_per_tension_per_m),
            Path::Zero { offset_m } => facts.with("offset_m", offset_m),
            Path::Scale { scale } => facts.with("scale", scale),
        }
    }

    fn path(&self, scene: &Scene<'_>, path: &CablePath, cable_m: &mut [f64]) {
        let up = -Vector3::from(scene.device.gravity_mps2.unwrap_or([0.0, 0.0, -1.0])).normalize();
        for (length_m, handle) in cable_m.iter_mut().zip(&path.handle) {
            let straight = handle.position_m - path.anchor_m;
            *length_m += self.extra_m(&straight, &path.exit_axis, &up, *length_m);
        }
    }
}

/// The guide's rounded edge.
pub(crate) fn exit_geometry(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let path = Path::Guide {
        radius_m: draw.amplitude(6e-3),
    };
    let info = draw.anywhere("cable-exit-geometry", &EXIT);
    Box::new(Routed { info, path })
}

/// Twist of the cable off its exit axis.
pub(crate) fn twist(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let path = Path::Twist {
        m_per_rad2: draw.signed(2e-3),
        saturation_rad: draw.random.uniform(1.5, 3.0),
    };
    let info = draw.anywhere("cable-twist", &EXIT);
    Box::new(Routed { info, path })
}

/// The cable's zero.
pub(crate) fn zero_offset(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let path = Path::Zero {
        offset_m: draw.signed(3e-3),
    };
    let info = draw.anywhere("cable-zero-offset", &EXIT);
    Box::new(Routed { info, path })
}

/// A cable that hangs; at physical tensions nothing can be seen of it.
pub(crate) fn sag(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let path = Path::Sag {
        weight_per_tension_per_m: draw.amplitude(0.1),
    };
    let info = draw.anywhere("cable-sag", &["cable-sag"]);
    Box::new(Routed { info, path })
}

/// The drum's radius: the chain's lengths take it up.
pub(crate) fn scale(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let path = Path::Scale {
        scale: draw.signed(2e-3),
    };
    let info = draw.anywhere("cable-scale", &[]);
    Box::new(Routed { info, path })
}

/// Stretch under a spring of constant force: like the scale.
pub(crate) fn stretch(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let path = Path::Scale {
        scale: -draw.amplitude(5e-4),
    };
    let info = draw.anywhere("cable-stretch", &[]);
    Box::new(Routed { info, path })
}

/// The cable and its housing grow with temperature.
#[derive(Debug)]
struct Warmth {
    per_degc: f64,
    housing_m: f64,
}

impl Law for Warmth {
    fn deviation(&self, scene: &Scene<'_>, _place: Place, signal: &[f64]) -> Vec<f64> {
        let start_degc = scene.cold_degc;
        scene
            .temperature_degc
            .iter()
            .zip(signal)
            .map(|(degc, length_m)| {
                -self.per_degc * (degc - start_degc) * (length_m + self.housing_m)
            })
            .collect()
    }

    fn facts(&self, scene: &Scene<'_>, place: Place) -> Facts {
        // the mean length is a guess of the order of the device's
        let lengths = vec![0.3; scene.len()];
        let deviation = self.deviation(scene, place, &lengths);
        Facts::default()
            .law("per_degc", self.per_degc)
            .law("housing_m", self.housing_m)
            .law("m_per_degc", slope_of(&scene.temperature_degc, &deviation))
    }
}

/// Thermal drift of the measuring cable: mostly that of its housing.
pub(crate) fn thermal(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let housing_m = draw.random.uniform(0.6, 2.0);
    let law = Warmth {
        per_degc: draw.amplitude(40e-6) / (housing_m + 0.3),
        housing_m,
    };
    let info = draw.anywhere("thermal-drift", &["thermal-drift"]);
    Added::boxed(info, Place::Cable, law)
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
