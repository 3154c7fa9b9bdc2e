//! Intervals that are no parabola's: a planar arm sees how far from its plane a cable leaves, but not on which side.

use haptical_calibration::{
    Calibration, CalibrationMethod, Channel, HeldOut, LossChoice, Options, Weighting, calibrate,
};
use haptical_identification::Loss;
use haptical_model::{Device, Recording};

use crate::rig_scene::{normal, plain, readings};

/// All of the arm is known; of the second cable only about where it leaves.
fn planar() -> Device {
    let row = |a_m: f64| {
        format!(
            "[[link]]\na_m = {a_m:?}\nalpha_rad = 0.0\nd_m = 0.0\nhold = [\"lengths\", \"twists\", \"offsets\"]\n"
        )
    };
    let text = [0.0, 0.3, 0.25].map(row).concat()
        + "[[joint]]\n[[joint]]\n[cable_encoder]\ndistance_sd_m = 1.0\n\
           [[cable]]\nanchor_m = [-0.19, 0.49, 0.02]\ndistance_sd_m = 2e-4\nscale_sd = 0.0\nfit = [\"anchor\"]\n";
    Device::from_toml(&text, "planar.toml").unwrap().device
}

const ROWS: usize = 60;
const SD_M: f64 = 2e-4;

/// Handle positions, and distances from an exit `height_m` above the plane, with noise.
fn scene(height_m: f64) -> (Recording, Vec<[f64; 2]>, Vec<f64>) {
    let columns = readings(&planar(), ROWS, 1.3, 3);
    let place = |row: usize| {
        let (first, both) = (columns[0][row], columns[0][row] + columns[1][row]);
        [
            0.3 * first.cos() + 0.25 * both.cos(),
            0.3 * first.sin() + 0.25 * both.sin(),
        ]
    };
    let places: Vec<[f64; 2]> = (0..ROWS).map(place).collect();
    let distance = |(row, [x, y]): (usize, &[f64; 2])| {
        let plane = (x + 0.2).hypot(y - 0.5);
        plane.hypot(height_m) + SD_M * normal(11, row as u64)
    };
    let distances: Vec<f64> = places.iter().enumerate().map(distance).collect();
    let mut recording = plain(columns);
    recording.cable_m = vec![None, Some(distances.clone())];
    (recording, places, distances)
}

fn calibrated(recording: &Recording) -> Calibration {
    let options = Options {
        method: CalibrationMethod::Joint,
        held_out: HeldOut::None,
        weighting: Weighting::Stated,
        loss: LossChoice::Fixed(Loss::Squares),
        ..Options::default()
    };
    calibrate(&planar(), recording, &options).unwrap()
}

/// Least sum of squares at a height, in units of the noise: Gauss-Newton over x and y by its normal equations.
fn at_height(places: &[[f64; 2]], distances: &[f64], height_m: f64) -> f64 {
    let (mut x, mut y) = (-0.2, 0.5);
    let mut cost = f64::INFINITY;
    for _ in 0..20 {
        let (mut matrix, mut side) = ([0.0; 3], [0.0; 2]);
        cost = 0.0;
        for (place, distance) in places.iter().zip(distances) {
            let (dx, dy) = (x - place[0], y - place[1]);
            let length = dx.hypot(dy).hypot(height_m);
            let rest = (length - distance) / SD_M;
            let slope = [dx / length / SD_M, dy / length / SD_M];
            cost += rest * rest;
            matrix[0] += slope[0] * slope[0];
            matrix[1] += slope[0] * slope[1];
            matrix[2] += slope[1] * slope[1];
            side[0] -= slope[0] * rest;
            side[1] -= slope[1] * rest;
        }
        let determinant = matrix[0] * matrix[2] - matrix[1] * matrix[1];
        x += (matrix[2] * side[0] - matrix[1] * side[1]) / determinant;
        y += (matrix[0] * side[1] - matrix[1] * side[0]) / determinant;
    }
    cost
}

#[test]
fn an_interval_ends_where_the_sum_of_squares_says() {
    let (recording, places, distances) = scene(0.015);
    let calibration = calibrated(&recording);
    let whole = calibration.fitted.whole.as_ref().unwrap();
    let of = |name: &str| {
        let position = whole.estimates.iter().position(|e| e.name == name);
        position.unwrap()
    };
    let height = of("cable2_anchor_z");
    assert!(whole.profiled.is_checked);
    assert_eq!(whole.profiled.parameters, [height]);
    assert_eq!(whole.profiled.open, [0_usize; 0]);
    let estimate = &whole.estimates[height];
    let ends = estimate.ci95.unwrap();
    for end in ends {
        let rise = at_height(&places, &distances, end) - whole.cost;
        let limit = 1.959_963_985_f64.powi(2);
        assert!((rise / limit - 1.0).abs() < 0.02, "{end}: {rise}");
    }
    // either side of the plane will do: the linearised interval has one alone
    assert!(
        (ends[0] + ends[1]).abs() < 0.01 * (ends[1] - ends[0]),
        "{ends:?}"
    );
    let sd = estimate.standard_deviation.unwrap();
    assert!(estimate.value.unwrap() - 1.96 * sd > 0.0);
    let channel = Channel::Cable { index: 1 };
    assert!(whole.channel_parameters.contains_key(&channel));
}

#[test]
fn straight_ones_stay_as_they_are() {
    let (recording, ..) = scene(0.1);
    let calibration = calibrated(&recording);
    let whole = calibration.fitted.whole.as_ref().unwrap();
    assert!(whole.profiled.is_checked);
    assert_eq!(whole.profiled.parameters, [0_usize; 0]);
    let estimate = &whole.estimates[0];
    let (value, sd) = (
        estimate.value.unwrap(),
        estimate.standard_deviation.unwrap(),
    );
    let [lower, upper] = estimate.ci95.unwrap();
    assert!((lower - (value - 1.959_963_985 * sd)).abs() < 1e-9 * sd.max(1.0));
    assert!((upper - (value + 1.959_963_985 * sd)).abs() < 1e-9 * sd.max(1.0));
}
