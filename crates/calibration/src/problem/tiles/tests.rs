//! Tiles against the form row by row: random devices and channels of every kind.

use std::fmt::Write as _;

use haptical_identification::Matrix;
use haptical_model::{Device, ParameterId, Recording};
use proptest::prelude::*;

use crate::{DeviceProblem, Weights, channels, prepare_device};

/// Rows: more than a tile, and a part of another.
const ROWS: usize = 90;
/// Rounding of sines and sums along up to seven rows, as a share of a column's largest entry, or of 1 m or rad where that
/// is less: what does not move a channel is rounding alone.
const ROUNDING: f64 = 1e-12;

/// Numbers from -1 to 1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn column(&mut self, size: f64) -> Vec<f64> {
        (0..ROWS).map(|_| size * self.next()).collect()
    }

    fn is_one(&mut self) -> bool {
        self.next() > 0.0
    }
}

fn row(text: &mut String, numbers: &mut Numbers, driven_by: Option<usize>) {
    let mut n = || numbers.next();
    let (a, alpha, d, theta) = (0.3 * n(), 1.5 * n(), 0.3 * n(), n());
    let (beta, b) = (0.1 * n(), 0.05 * n());
    let _ = writeln!(
        text,
        "[[link]]\na_m = {a}\nalpha_rad = {alpha}\nd_m = {d}\ntheta_offset_rad = {theta}\nbeta_rad = {beta}\nb_m = {b}"
    );
    if numbers.is_one() {
        let at = [numbers.next(), numbers.next(), numbers.next()];
        let _ = writeln!(
            text,
            "origin_xyz_m = {at:?}\norigin_wxyz = [0.6, 0.0, 0.8, 0.0]"
        );
    }
    if let Some(joint) = driven_by {
        let _ = writeln!(text, "driven_by = {joint}\ndriven_multiplier = -0.7");
    }
}

const TRANSMISSIONS: [&str; 4] = [
    "",
    "transmission = \"capstan\"\ntransmission_ratio = 8.0\ndrum_distance_m = 0.0675\n[joint.transmission_error]\noffset_rad = 0.01\nratio_deviation = 0.02\noutput_drum_xy_m = [4e-4, -3e-4]\ninput_drum_xy_m = [2e-5, 1e-5]\n",
    "transmission = \"parallelogram\"\ntransmission_ratio = 12.0\ndrum_distance_m = 0.0975\nparallelogram_lengths_m = [0.18, 0.076, 0.18, 0.076]\n[joint.transmission_error]\nlength_deviations_m = [5e-4, -7e-4, 0.0, 0.0]\n",
    "[joint.transmission_error]\nchebyshev = [0.004, -0.011, 0.006]\nrange_rad = [-0.4, 0.3]\n",
];

/// A device with links of both conventions, origins, slides, rows that follow, everything that yields, and a rig.
fn device(joints: usize, numbers: &mut Numbers) -> Device {
    let convention = ["standard", "modified"][usize::from(numbers.is_one())];
    let mut text = format!("[device]\nconvention = \"{convention}\"\n");
    row(&mut text, numbers, None);
    let follows = numbers.is_one();
    for joint in 1..=joints {
        row(&mut text, numbers, follows.then_some(joint));
        if follows && joint == 2 {
            row(&mut text, numbers, Some(1));
        }
    }
    for joint in 0..joints {
        let kind = ((numbers.next() + 1.0) * 2.0) as usize;
        let slides = kind == 0 && numbers.is_one();
        let (word, key) = match slides {
            true => ("prismatic", "compliance_m_per_n"),
            false => ("revolute", "compliance_rad_per_nm"),
        };
        let size = if joint == 1 { 0.0 } else { 1e-3 };
        let _ = write!(
            text,
            "[[joint]]\ntype = \"{word}\"\n{key} = {size}\nfit = [\"compliance\"]\n{}",
            TRANSMISSIONS[kind.min(3)]
        );
    }
    let known = |unknown: bool| if unknown { "unknown" } else { "known" };
    let (base, tool) = (known(numbers.is_one()), known(numbers.is_one()));
    let _ = write!(
        text,
        "[cable_encoder]\ndistance_sd_m = 1e-5\n[tracker]\nbase = \"{base}\"\ntool = \"{tool}\"\nposition_sd_m = 1e-4\nrotation_sd_rad = 1e-4\n\
         [contact]\nsd_m = 1e-4\n[plane]\nsd_m = 1e-4\n[fixture]\nsd_rad = 1e-4\n\
         [[contact_pair]]\na = \"p\"\nb = \"q\"\ndistance_m = 0.3\nsd_m = 1e-4\n"
    );
    Device::from_toml(&text, "random.toml").unwrap().device
}

fn recording(joints: usize, numbers: &mut Numbers) -> Recording {
    let mut quaternion: [Vec<f64>; 4] = std::array::from_fn(|_| numbers.column(1.0));
    quaternion[0].iter_mut().for_each(|w| *w += 2.5);
    let mut position: [Vec<f64>; 3] = std::array::from_fn(|_| numbers.column(1.0));
    position[1]
        .iter_mut()
        .step_by(7)
        .for_each(|y| *y = f64::NAN);
    let ids = |names: [&str; 3]| (0..ROWS).map(|row| names[row * 5 % 3].to_owned()).collect();
    Recording {
        line: (2..ROWS as u64 + 2).collect(),
        joint: (0..joints).map(|_| numbers.column(0.5)).collect(),
        output: (0..joints).map(|_| Some(numbers.column(0.5))).collect(),
        cable_m: vec![Some(numbers.column(0.5))],
        position_m: Some(position),
        orientation_wxyz: Some(quaternion),
        torque_nm: (0..joints).map(|_| Some(numbers.column(20.0))).collect(),
        contact: Some(ids(["p", "q", ""])),
        plane: Some(ids(["", "", "table"])),
        covariates: vec![("fixture2_rad".to_owned(), numbers.column(0.5))],
        ..Recording::default()
    }
}

fn assert_near(found: &[f64], expected: &[f64], weight: f64, what: &str) {
    let largest = expected
        .iter()
        .fold(weight, |largest: f64, entry| largest.max(entry.abs()));
    for (row, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!(
            (a - b).abs() <= ROUNDING * largest,
            "{what}, residual {row}: {a:e} for {b:e}"
        );
    }
}

proptest! {
    #[test]
    fn tiles_are_the_rows_but_for_rounding(seed: u64, joints in 2_usize..6) {
        let mut numbers = Numbers(seed);
        let device = device(joints, &mut numbers);
        let recording = recording(joints, &mut numbers);
        let device = prepare_device(&device, &recording).unwrap();
        let channels = channels(&device, &recording).unwrap();
        let mut parameters = device.link_parameters(true);
        parameters.extend((0..joints).flat_map(|joint| device.transmission_parameters(joint)));
        parameters.extend(device.further_parameters());
        let is_transmission = |id: &ParameterId| matches!(id, ParameterId::Transmission { .. });
        if numbers.is_one() {
            parameters.retain(|id| !is_transmission(id));
        }
        let weights = Weights::stated(&device, &channels);
        let problem = DeviceProblem::new(&device, &recording, &channels, &parameters, &weights).unwrap();
        let mut values = problem.start();
        values.iter_mut().for_each(|value| *value += 1e-3 * numbers.next());
        let moved = problem.device_with(&values);
        let free: Vec<usize> = (0..parameters.len()).filter(|_| numbers.next() > -0.8).collect();
        let firsts: Vec<usize> = problem.blocks.iter().map(|block| block.first).collect();
        let count = problem.blocks.last().map_or(0, crate::problem::device_problem::Block::end);
        // what was there before must not stay
        let filled = || (vec![f64::NAN; count], Matrix::from_fn(count, free.len(), |_, _| f64::NAN));
        let ((mut found, mut derivatives), (mut expected, mut by_row)) = (filled(), filled());
        let mut jacobian = Some((free.as_slice(), &mut derivatives));
        let tiles = problem.run_tiles(&moved, &(0..ROWS), &firsts, &mut found, &mut jacobian);
        prop_assert!(tiles.is_some());
        let mut jacobian = Some((free.as_slice(), &mut by_row));
        problem.run_rows(&moved, 0..ROWS, &firsts, &mut expected, &mut jacobian).unwrap();
        for block in &problem.blocks {
            let weight = block.weights.iter().copied().fold(0.0, f64::max);
            let own = block.first..block.end();
            assert_near(&found[own.clone()], &expected[own.clone()], weight, &block.channel.name());
            for (position, &index) in free.iter().enumerate() {
                let what = format!("{} by {}", block.channel.name(), parameters[index].name(&device));
                assert_near(&derivatives.column(position)[own.clone()], &by_row.column(position)[own.clone()], weight, &what);
            }
        }
    }
}

/// Two hands on one trunk, whose rows come in no order.
#[test]
fn tiles_of_hands_are_the_rows_but_for_rounding() {
    let mut numbers = Numbers(11);
    let mut text = "[device]\nconvention = \"modified\"\n".to_owned();
    for row_of in 0..6 {
        row(&mut text, &mut numbers, None);
        if row_of == 4 {
            text.push_str("parent = 1\n");
        }
    }
    text.push_str(&"[[joint]]\ncompliance_rad_per_nm = 1e-3\nfit = [\"compliance\"]\n".repeat(5));
    text.push_str("[[hand]]\nname = \"left\"\nrow = 3\n[[hand]]\nname = \"right\"\nrow = 5\n");
    text.push_str("[tracker]\nbase = \"unknown\"\ntool = \"unknown\"\nposition_sd_m = 1e-4\n");
    let device = Device::from_toml(&text, "hands.toml").unwrap().device;
    let mut recording = recording(5, &mut numbers);
    (
        recording.contact,
        recording.plane,
        recording.orientation_wxyz,
    ) = (None, None, None);
    let hand = |_| ["left", "right"][usize::from(numbers.is_one())].to_owned();
    recording.hand = Some((0..ROWS).map(hand).collect());
    let device = prepare_device(&device, &recording).unwrap();
    let channels = [crate::Channel::Position];
    let mut parameters = device.link_parameters(true);
    parameters.extend(device.further_parameters());
    let weights = Weights::stated(&device, &channels);
    let problem =
        DeviceProblem::new(&device, &recording, &channels, &parameters, &weights).unwrap();
    let free: Vec<usize> = (0..parameters.len()).collect();
    let count = problem.blocks[0].end();
    let filled = || {
        (
            vec![f64::NAN; count],
            Matrix::from_fn(count, free.len(), |_, _| f64::NAN),
        )
    };
    let ((mut found, mut derivatives), (mut expected, mut by_row)) = (filled(), filled());
    let mut jacobian = Some((free.as_slice(), &mut derivatives));
    let tiles = problem.run_tiles(&device, &(0..ROWS), &[0], &mut found, &mut jacobian);
    assert!(tiles.is_some());
    let mut jacobian = Some((free.as_slice(), &mut by_row));
    problem
        .run_rows(&device, 0..ROWS, &[0], &mut expected, &mut jacobian)
        .unwrap();
    assert_near(&found, &expected, 1e4, "position");
    for (position, parameter) in parameters.iter().enumerate() {
        let (own, rows) = (derivatives.column(position), by_row.column(position));
        assert_near(own, rows, 1e4, &parameter.name(&device));
    }
}

/// A reading that the chain refuses is left to the form that names its line.
#[test]
fn a_number_that_is_refused_is_left_to_the_rows() {
    let mut numbers = Numbers(3);
    let device = device(3, &mut numbers);
    let mut recording = recording(3, &mut numbers);
    let all = channels(&device, &recording).unwrap();
    let device = prepare_device(&device, &recording).unwrap();
    recording.joint[1][70] = f64::INFINITY;
    let channel = [all
        .into_iter()
        .find(|channel| channel.name() == "cable")
        .unwrap()];
    let good = Recording {
        joint: vec![vec![0.0; ROWS]; 3],
        ..recording.clone()
    };
    let weights = Weights::stated(&device, &channel);
    let mut problem = DeviceProblem::new(&device, &good, &channel, &[], &weights).unwrap();
    problem.recording = &recording;
    problem.outputs = None;
    let mut residuals = vec![0.0; ROWS];
    let tiles = problem.run_tiles(&device, &(0..ROWS), &[0], &mut residuals, &mut None);
    assert!(tiles.is_none());
    let refused = problem.run(&[], &mut residuals, None).unwrap_err();
    assert!(refused.to_string().contains("line 72 "), "{refused}");
}
