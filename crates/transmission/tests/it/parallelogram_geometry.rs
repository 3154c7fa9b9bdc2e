//! The parallelogram's error read off a loop built from points, without any law of cosines.

use crate::fixture::assert_close;
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use haptical_transmission::Parallelogram;

/// Roundings of coordinates of order 0.1 over bars of 0.07, and of four angles.
const ROUNDING_RAD: f64 = 1e-14;

type Point = [f64; 2];

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn length(v: Point) -> f64 {
    v[0].hypot(v[1])
}

/// Angle at `apex` from `first` to `second`, counterclockwise, in 0 .. 2 pi.
fn angle(first: Point, apex: Point, second: Point) -> f64 {
    let (a, b) = (minus(first, apex), minus(second, apex));
    (a[0] * b[1] - a[1] * b[0])
        .atan2(a[0] * b[0] + a[1] * b[1])
        .rem_euclid(TAU)
}

/// A at the origin, B on the x axis, C from the angle at B, E by walking from C at the angle that
/// closes the loop, found by bisection on the length EA.
fn four_bar(lengths_m: [f64; 4], theta_a_rad: f64) -> [Point; 4] {
    let [l1, l2, l3, l4] = lengths_m;
    let (a, b) = ([0.0, 0.0], [l1, 0.0]);
    // seen from B, A lies at the angle pi; the interior angle opens clockwise from there
    let direction = PI - (FRAC_PI_2 - theta_a_rad);
    let c = [b[0] + l2 * direction.cos(), b[1] + l2 * direction.sin()];
    // seen from C, turning from A away from B, E recedes from A
    let to_a = minus(a, c);
    let towards_a = to_a[1].atan2(to_a[0]);
    let at = |turn: f64| {
        let heading = towards_a - turn;
        [c[0] + l3 * heading.cos(), c[1] + l3 * heading.sin()]
    };
    let (mut near, mut far) = (0.0, PI);
    for _ in 0..200 {
        let middle = 0.5 * (near + far);
        if length(minus(at(middle), a)) < l4 {
            near = middle;
        } else {
            far = middle;
        }
    }
    [a, b, c, at(near)]
}

#[test]
fn error_is_read_off_the_closed_loop() {
    let loops = [
        [0.18, 0.076, 0.18, 0.076],
        [0.1795, 0.0753, 0.18, 0.076],
        [0.18, 0.076, 0.183, 0.071],
        [0.2, 0.05, 0.19, 0.06],
    ];
    for lengths_m in loops {
        let joint = Parallelogram::new(lengths_m).unwrap();
        let interior_a = |theta: f64| {
            let [a, b, c, e] = four_bar(lengths_m, theta);
            let bars = [minus(b, a), minus(c, b), minus(e, c), minus(a, e)].map(length);
            for (bar, want) in bars.into_iter().zip(lengths_m) {
                assert_close(bar, want, 1e-15, "length of a bar");
            }
            let angles = [
                angle(b, a, e),
                angle(c, b, a),
                angle(e, c, b),
                angle(a, e, c),
            ];
            assert_close(
                angles.iter().sum(),
                TAU,
                ROUNDING_RAD,
                "sum of interior angles",
            );
            assert_close(angles[1], FRAC_PI_2 - theta, ROUNDING_RAD, "angle at B");
            angles[0]
        };
        for theta in [-1.0, -0.5, -0.01, 0.0, 0.2, 0.7, 1.0] {
            let want = interior_a(theta) - interior_a(0.0) - theta;
            let got = joint.error(&[0.0; 4], theta).unwrap();
            assert_close(
                got,
                want,
                ROUNDING_RAD,
                &format!("{lengths_m:?} at {theta}"),
            );
        }
    }
}

#[test]
fn deviations_are_added_to_their_own_bar() {
    let nominal = Parallelogram::new([0.18, 0.076, 0.18, 0.076]).unwrap();
    let deviations_m = [0.001, -0.002, 0.003, 0.0005];
    let built = Parallelogram::new([0.181, 0.074, 0.183, 0.0765]).unwrap();
    let got = nominal.error(&deviations_m, 0.6).unwrap();
    assert_close(
        got,
        built.error(&[0.0; 4], 0.6).unwrap(),
        ROUNDING_RAD,
        "moved lengths",
    );
}
