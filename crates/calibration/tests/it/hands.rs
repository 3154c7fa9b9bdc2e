//! Several things on one hand, one after the other, and a tracker that is set up anew for each run.

use haptical_calibration::{
    CalibrationError, CalibrationMethod, Channel, DeviceProblem, GaugedProblem, HeldOut, Options,
    Weighting, Weights, calibrate, candidate_parameters, channels, check_rig, check_stands,
    fit_device, prepare_device,
};
use haptical_identification::worst_derivative;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{
    ContactPair, Device, Origin, ParameterId, Placement, Recording, RunBase, SurroundingParameter,
    Tool,
};

use crate::rig_recovery::moved_within_sight;
use crate::rig_scene::{
    Target, add_touches, general, placement, plain, readings, shaken, table, touches, tracked,
    two_points, unknown_tracker, with_everything,
};

const IDS: [&str; 3] = ["r1", "r2", "r3"];

fn tool(id: &str, placement: Placement, has_turn: bool) -> Tool {
    Tool {
        placement: Some(placement),
        has_turn,
        ..Tool::new(id)
    }
}

/// What a tracker sees of a device whose rows are about these tools, and of runs with these bases.
fn seen(
    truth: &Device,
    joint: Vec<Vec<f64>>,
    ids: Option<Vec<String>>,
    runs: Option<Vec<i64>>,
    seed: u64,
) -> Recording {
    let whole = plain(joint);
    let (mut position, mut orientation) = ([(); 3].map(|()| Vec::new()), [(); 4].map(|()| vec![]));
    for row in 0..whole.len() {
        let mut own = truth.clone();
        if let Some(ids) = &ids {
            let tool = truth.surroundings.tool_index(&ids[row]);
            own.surroundings.tracker_tool = truth.surroundings.tools[tool.unwrap()].placement;
        }
        if let Some(runs) = &runs {
            let mut bases = truth.surroundings.run_bases.iter();
            let base = bases.find(|base| base.run == runs[row]).unwrap();
            own.surroundings.tracker_base = Some(base.placement);
        }
        let mut one = whole.select(&[row]);
        tracked(&own, &mut one, 1.0, seed + 1000 * row as u64);
        for (all, own) in position.iter_mut().zip(one.position_m.unwrap()) {
            all.extend(own);
        }
        for (all, own) in orientation.iter_mut().zip(one.orientation_wxyz.unwrap()) {
            all.extend(own);
        }
    }
    Recording {
        position_m: Some(position),
        orientation_wxyz: Some(orientation),
        tool: ids,
        run: runs,
        ..whole
    }
}

/// Three reflectors, one after the other at each posture: positions alone.
fn reflectors(truth: &Device, postures: usize, seed: u64) -> Recording {
    let joint = readings(truth, postures, 1.3, seed);
    let thrice = |column: Vec<f64>| {
        column
            .into_iter()
            .flat_map(|reading| [reading; 3])
            .collect()
    };
    let joint: Vec<Vec<f64>> = joint.into_iter().map(thrice).collect();
    let ids = IDS.iter().cycle().take(3 * postures);
    let ids = ids.map(|id| (*id).to_owned()).collect();
    let mut recording = seen(truth, joint, Some(ids), None, seed);
    recording.orientation_wxyz = None;
    recording
}

fn with_reflectors(device: &Device, seed: u64) -> Device {
    let mut device = device.clone();
    device.surroundings.tracker_base = Some(placement(seed, 1.0, 0.0));
    let tools = IDS.iter().zip(1..);
    device.surroundings.tools = tools
        .map(|(id, index)| tool(id, at_offset(seed + index), false))
        .collect();
    device
}

/// An offset of up to 0.1 m without a turn.
fn at_offset(seed: u64) -> Placement {
    let mut place = placement(seed, 0.1, 0.0);
    place.start.orientation_wxyz = Origin::IDENTITY.orientation_wxyz;
    place
}

/// Runs of as many rows each, before a tracker of another place in each.
fn stands(truth: &Device, runs: usize, rows: usize, seed: u64) -> Recording {
    let joint = readings(truth, runs * rows, 1.3, seed);
    let run = (0..runs * rows).map(|row| (row / rows) as i64 + 1);
    seen(truth, joint, None, Some(run.collect()), seed)
}

fn with_stands(device: &Device, runs: i64, seed: u64) -> Device {
    let mut device = device.clone();
    device.surroundings.tracker_tool = Some(placement(seed, 0.1, 0.0));
    device.surroundings.run_bases = (1..=runs)
        .map(|run| RunBase {
            run,
            placement: placement(seed + run as u64, 1.0, 0.0),
        })
        .collect();
    device
}

/// Touches of two points, with the handle and then with a tool of an unknown length.
fn balls(truth: &Device, tool_m: Vector3<f64>, seed: u64) -> Recording {
    let mut longer = truth.clone();
    longer.origins.resize(truth.links.len() + 1, None);
    let last = longer.origins.pop().flatten();
    assert!(last.is_none(), "the handle is at the last row's frame");
    longer.origins.push(Some(Origin {
        position_m: tool_m.into(),
        ..Origin::IDENTITY
    }));
    let points = two_points(truth);
    let mut recording = plain(vec![Vec::new(); truth.joints.len()]);
    let mut ids = Vec::new();
    for (device, own) in [(truth, ""), (&longer, "longer")] {
        for (point, id) in points.iter().zip(["left", "right"]) {
            let rows = touches(device, &Target::Point(*point), 25, seed + ids.len() as u64);
            add_touches(&mut recording, &rows, id, false);
            ids.resize(recording.line.len(), own.to_owned());
        }
    }
    recording.tool = Some(ids);
    recording
}

fn options() -> Options {
    Options {
        method: CalibrationMethod::TwoStep,
        weighting: Weighting::Stated,
        held_out: HeldOut::None,
        ..Options::default()
    }
}

/// Squares of the errors of links and tools over their standard deviations, and how many there are.
fn scatter(nominal: &Device, truth: &Device, recording: &Recording) -> (f64, usize) {
    let fitted = fit_device(nominal, recording, &options()).unwrap();
    let whole = fitted.whole.unwrap();
    let (mut square, mut count) = (0.0, 0);
    for &index in &whole.fitted {
        let parameter = whole.parameters[index];
        let is_turn = matches!(
            parameter,
            ParameterId::Surrounding(
                SurroundingParameter::RunBase { index: 3.., .. }
                    | SurroundingParameter::TrackerBase { index: 3.. }
                    | SurroundingParameter::TrackerTool { index: 3.. }
                    | SurroundingParameter::Tool { index: 3.., .. }
            )
        );
        let true_value = truth.parameter(&parameter.name(&whole.device));
        let true_value = true_value.map(|own| own.value(truth));
        // turns are relative to the start of the search; rows that are held take what the places then lack
        let (Ok(true_value), false) = (true_value, is_turn) else {
            continue;
        };
        let error = parameter.value(&whole.device) - true_value;
        square += (error / whole.estimates[index].standard_deviation.unwrap()).powi(2);
        count += 1;
    }
    (square, count)
}

/// The mean square is 1 where standard deviations are right. Errors of one fit are correlated: with a mean square of
/// correlations of a tenth it scatters by 0.22 over four fits, and four of that are allowed.
fn assert_within((square, count): (f64, usize), seeds: usize) {
    let mean = square / count as f64;
    let allowed = 4.0 * (2.0 * 0.1 / seeds as f64).sqrt();
    assert!(count > 10 * seeds, "{count} numbers");
    assert!((mean - 1.0).abs() < allowed, "{mean} over {count} numbers");
}

#[test]
fn every_tool_and_base_has_the_derivatives_of_its_residuals() {
    let mut device = with_everything(table(5));
    device.tracker.as_mut().unwrap().base_per_run = true;
    device.surroundings.tracker_base = None;
    device.surroundings.run_bases = vec![
        RunBase {
            run: 4,
            placement: placement(21, 1.0, 0.4),
        },
        RunBase {
            run: 5,
            placement: placement(22, 1.0, 0.4),
        },
    ];
    device.surroundings.tools = vec![
        tool("ball", placement(23, 0.1, 0.4), true),
        tool("probe", placement(24, 0.1, 0.4), true),
    ];
    let rows = 24;
    let mut recording = plain(readings(&device, rows, 1.2, 5));
    let mut other = device.clone();
    other.surroundings.tracker_base = Some(placement(11, 1.0, 0.0));
    tracked(&other, &mut recording, 0.0, 1);
    let ids = |ids: [&str; 3]| Some((0..rows).map(|row| ids[row % 3].to_owned()).collect());
    recording.contact = ids(["left", "right", ""]);
    recording.plane = ids(["wall", "", "table"]);
    recording.tool = Some(
        (0..rows)
            .map(|row| ["", "ball", "probe", "ball"][row % 4].to_owned())
            .collect(),
    );
    recording.run = Some((0..rows).map(|row| if row < 10 { 4 } else { 5 }).collect());
    let parameters = candidate_parameters(&device);
    let all = channels(&device, &recording).unwrap();
    let weights = Weights::stated(&device, &all);
    for channel in [
        Channel::Position,
        Channel::Orientation,
        Channel::Contact,
        Channel::Plane,
    ] {
        let problem =
            DeviceProblem::new(&device, &recording, &[channel], &parameters, &weights).unwrap();
        let worst = worst_derivative(&problem, &problem.start(), 1e-5).unwrap();
        assert!(
            worst.relative < 2e-6,
            "{}, {}: {} for {}",
            channel.name(),
            parameters[worst.parameter].name(&device),
            worst.analytic,
            worst.numeric
        );
    }
    // touches over how far what touches moves with the joints
    let touches = [
        Channel::Contact,
        Channel::ContactPair { index: 0 },
        Channel::Plane,
    ];
    let problem = DeviceProblem::new(&device, &recording, &touches, &parameters, &weights).unwrap();
    let gauged = GaugedProblem::new(&problem).unwrap();
    let worst = worst_derivative(&gauged, &problem.start(), 1e-5).unwrap();
    assert!(
        worst.relative < 2e-6,
        "{}: {} for {}",
        parameters[worst.parameter].name(&device),
        worst.analytic,
        worst.numeric
    );
}

#[test]
fn reflectors_on_one_hand_are_found_with_the_geometry_within_the_intervals() {
    let seeds = [40, 80, 120, 160];
    let mut nominal = general();
    unknown_tracker(&mut nominal);
    let (mut square, mut count) = (0.0, 0);
    for seed in seeds {
        let sketch = reflectors(&with_reflectors(&nominal, seed), 40, seed);
        let moved = moved_within_sight(&nominal, &sketch, seed);
        let truth = with_reflectors(&moved, seed);
        let recording = reflectors(&truth, 40, seed);
        let (own, numbers) = scatter(&nominal, &truth, &recording);
        (square, count) = (square + own, count + numbers);
    }
    assert_within((square, count), seeds.len());
}

#[test]
fn a_tracker_place_per_run_is_found_with_the_geometry_within_the_intervals() {
    let seeds = [40, 80, 120, 160];
    let mut nominal = general();
    unknown_tracker(&mut nominal);
    nominal.tracker.as_mut().unwrap().base_per_run = true;
    let (mut square, mut count) = (0.0, 0);
    for seed in seeds {
        let sketch = stands(&with_stands(&nominal, 3, seed), 3, 20, seed);
        let moved = moved_within_sight(&nominal, &sketch, seed);
        let truth = with_stands(&moved, 3, seed);
        let recording = stands(&truth, 3, 20, seed);
        let (own, numbers) = scatter(&nominal, &truth, &recording);
        (square, count) = (square + own, count + numbers);
    }
    assert_within((square, count), seeds.len());
}

#[test]
fn both_may_be_combined() {
    let mut nominal = general();
    unknown_tracker(&mut nominal);
    nominal.tracker.as_mut().unwrap().base_per_run = true;
    let mut truth = with_stands(&with_reflectors(&nominal, 7), 2, 7);
    truth.surroundings.tracker_base = None;
    let joint = readings(&truth, 40, 1.3, 7);
    let thrice = |column: Vec<f64>| {
        column
            .into_iter()
            .flat_map(|reading| [reading; 3])
            .collect()
    };
    let joint: Vec<Vec<f64>> = joint.into_iter().map(thrice).collect();
    let ids = (0..120).map(|row| IDS[row % 3].to_owned()).collect();
    let runs = (0..120).map(|row| if row < 60 { 1 } else { 2 }).collect();
    let mut recording = seen(&truth, joint, Some(ids), Some(runs), 7);
    recording.orientation_wxyz = None;
    let prepared = prepare_device(&nominal, &recording).unwrap();
    assert_eq!(prepared.surroundings.run_bases.len(), 2);
    assert_eq!(prepared.surroundings.tools.len(), 3);
    let calibration = calibrate(&nominal, &recording, &Options::default()).unwrap();
    let position = calibration.held_out_channels.iter();
    let mut position = position.filter(|report| report.channel == "position");
    let report = position.next().unwrap();
    assert!(report.rms_after < 1.5e-4, "{}", report.rms_after);
    assert_eq!(
        calibration.held_out,
        "10 folds of whole postures, each fitted without its own rows"
    );
}

#[test]
fn a_tool_that_was_put_on_is_found_by_touches_within_the_intervals() {
    let seeds = [40, 80, 120, 160];
    let mut nominal = table(5);
    nominal.surroundings.contact_sd_m = Some(1e-6);
    nominal.contact_pairs = vec![ContactPair {
        a: "left".to_owned(),
        b: "right".to_owned(),
        distance_m: 0.05,
        sd_m: 1e-6,
    }];
    let sd_rad = 2e-5;
    for joint in &mut nominal.joints {
        joint.encoder_counts_per_rev = Some(std::f64::consts::TAU / (sd_rad * 12.0_f64.sqrt()));
    }
    let tool_m = Vector3::new(0.02, -0.03, 0.08);
    let (mut square, mut count) = (0.0, 0);
    for seed in seeds {
        let sketch = balls(&nominal, tool_m, seed);
        let mut truth = moved_within_sight(&nominal, &sketch, seed);
        let mut recording = balls(&truth, tool_m, seed);
        shaken(&mut recording, sd_rad, seed + 7);
        let mut place = Placement::default();
        place.start.position_m = tool_m.into();
        truth.surroundings.tools = vec![tool("longer", place, false)];
        let (own, numbers) = scatter(&nominal, &truth, &recording);
        (square, count) = (square + own, count + numbers);
    }
    assert_within((square, count), seeds.len());
}

#[test]
fn a_line_of_the_rig_says_the_same_as_a_column() {
    let tool_m = Vector3::new(0.02, -0.03, 0.08);
    let mut nominal = table(5);
    nominal.surroundings.contact_sd_m = Some(1e-5);
    let with_column = balls(&nominal, tool_m, 3);
    let first = with_column.tool.as_ref().unwrap();
    let row = first.iter().position(|id| id == "longer").unwrap();
    let mut with_line = nominal.clone();
    with_line.surroundings.tools = vec![Tool {
        from_line: Some(with_column.line[row]),
        ..Tool::new("longer")
    }];
    let without_column = Recording {
        tool: None,
        ..with_column.clone()
    };
    let one = prepare_device(&nominal, &with_column).unwrap();
    let other = prepare_device(&with_line, &without_column).unwrap();
    let place = |device: &Device| device.surroundings.tools[0].placement.unwrap();
    assert_eq!(place(&one), place(&other));
    let error = Vector3::from(place(&one).start.position_m) - tool_m;
    assert!(error.norm() < 1e-6, "{error}");
    // both at once are two answers
    let refused = check_rig(&with_line, &with_column).unwrap_err();
    assert!(refused.to_string().contains("from_line"), "{refused}");
}

#[test]
fn a_tool_that_was_put_on_at_another_line_is_refused_with_the_right_one() {
    let tool_m = Vector3::new(0.02, -0.03, 0.08);
    let mut nominal = table(5);
    nominal.surroundings.contact_sd_m = Some(1e-5);
    let truth = moved_within_sight(&nominal, &balls(&nominal, tool_m, 3), 3);
    let mut recording = balls(&truth, tool_m, 3);
    let ids = recording.tool.take().unwrap();
    let row = ids.iter().position(|id| id == "longer").unwrap();
    let put_on = |row: usize| {
        let mut device = nominal.clone();
        device.surroundings.tools = vec![Tool {
            from_line: Some(recording.line[row]),
            ..Tool::new("longer")
        }];
        fit_device(&device, &recording, &options())
    };
    assert!(put_on(row).is_ok());
    let right = format!(
        "better with from_line = {} of [[tool]] `longer`",
        recording.line[row]
    );
    for other in [row - 20, row + 15] {
        let refused = put_on(other).unwrap_err().to_string();
        assert!(refused.contains(&right), "{refused}");
    }
}

#[test]
fn three_rows_at_one_posture_are_held_out_together_however_many_postures_there_are() {
    let mut nominal = general();
    unknown_tracker(&mut nominal);
    let recording = reflectors(&with_reflectors(&nominal, 5), 400, 5);
    let split = haptical_calibration::split(&recording, HeldOut::Share(0.2)).unwrap();
    let is_held = |row: usize| split.held_out.contains(&row);
    for posture in 0..400 {
        let own = [0, 1, 2].map(|index| is_held(3 * posture + index));
        assert!(own == [own[0]; 3], "posture {posture}: {own:?}");
    }
    assert!((200..=280).contains(&split.held_out.len()));
}

#[test]
fn a_run_with_a_place_of_its_own_is_not_held_out_whole() {
    let mut nominal = general();
    unknown_tracker(&mut nominal);
    nominal.tracker.as_mut().unwrap().base_per_run = true;
    let truth = with_stands(&nominal, 3, 5);
    let recording = stands(&truth, 3, 40, 5);
    let calibration = calibrate(&nominal, &recording, &Options::default()).unwrap();
    assert!(
        calibration.held_out.contains("folds"),
        "{}",
        calibration.held_out
    );
    let mut channels = calibration.held_out_channels.iter();
    let position = channels.find(|report| report.channel == "position");
    let position = position.unwrap();
    assert_eq!(position.rows.len(), recording.len());
    assert!(position.rms_after < 1.3e-4, "{}", position.rms_after);
}

#[test]
fn what_the_rig_leaves_open_is_refused_with_its_place() {
    let mut nominal = general();
    unknown_tracker(&mut nominal);
    let truth = with_stands(&nominal, 3, 5);
    let recording = stands(&truth, 3, 20, 5);
    // runs of another place each, fitted with one
    let refused = check_stands(&nominal, &recording).unwrap_err().to_string();
    assert!(refused.contains("base = \"per-run\""), "{refused}");
    assert!(check_rig(&nominal, &recording).is_ok());
    // a run of two rows
    let mut anew = nominal.clone();
    anew.tracker.as_mut().unwrap().base_per_run = true;
    check_rig(&anew, &recording).unwrap();
    let refused = check_rig(&anew, &recording.select(&(0..22).collect::<Vec<usize>>()));
    let refused = refused.unwrap_err().to_string();
    assert!(refused.contains("run 2 has 2 readings"), "{refused}");
    // a cable at a tool
    let mut cabled = reflectors(&with_reflectors(&nominal, 5), 10, 5);
    cabled.cable_m = vec![Some(vec![0.6; 30])];
    let refused = check_rig(&nominal, &cabled).unwrap_err();
    assert!(
        matches!(refused, CalibrationError::Reading { line: 2, .. }),
        "{refused}"
    );
    assert!(refused.to_string().contains("`r1`"), "{refused}");
    // a device that was not prepared for this recording
    let cabled = Recording {
        cable_m: Vec::new(),
        ..cabled
    };
    let weights = Weights::stated(&nominal, &[Channel::Position]);
    let problem = DeviceProblem::new(&nominal, &cabled, &[Channel::Position], &[], &weights);
    assert!(problem.unwrap_err().to_string().contains("`r1`"));
}

/// Without its ids three reflectors are one point, and the misfit is what they are apart.
#[test]
fn three_reflectors_without_their_ids_do_not_pass_for_one() {
    let mut nominal = general();
    unknown_tracker(&mut nominal);
    let recording = reflectors(&with_reflectors(&nominal, 5), 60, 5);
    let nameless = Recording {
        tool: None,
        ..recording
    };
    let calibration = calibrate(&nominal, &nameless, &Options::default()).unwrap();
    let report = &calibration.judged_channels()[0];
    assert!(report.rms_after > 1e-2, "{}", report.rms_after);
    let warned = calibration.warnings.iter();
    let mut warned = warned.filter(|warning| warning.contains("noise floor"));
    assert!(warned.next().is_some(), "{:?}", calibration.warnings);
}
