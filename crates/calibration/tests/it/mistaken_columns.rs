//! Logs in which a joint runs backwards, or two joints are in each other's column.

use haptical_calibration::{CalibrationError, HeldOut, Options, Weighting, calibrate};
use haptical_model::{Device, Recording};

use crate::rig_scene::{placement, plain, readings, table, tracked, unknown_tracker};

/// A device, and a log of it in which a tracker sees the handle; the device's lengths differ by a millimetre.
fn scene(place_known: bool) -> (Device, Recording) {
    let mut nominal = table(6);
    unknown_tracker(&mut nominal);
    let mut truth = nominal.clone();
    for (row, link) in truth.links.iter_mut().enumerate() {
        link.a_m += 1e-3 * (row % 3) as f64 - 1e-3;
        link.d_m -= 5e-4 * (row % 2) as f64;
    }
    truth.surroundings.tracker_base = Some(placement(5, 1.0, 0.0));
    truth.surroundings.tracker_tool = Some(placement(6, 0.1, 0.0));
    let mut recording = plain(readings(&truth, 150, 1.4, 3));
    tracked(&truth, &mut recording, 1.0, 9);
    if place_known {
        nominal.surroundings = truth.surroundings.clone();
        let tracker = nominal.tracker.as_mut().unwrap();
        (tracker.base_known, tracker.tool_known) = (true, true);
    }
    recording.orientation_wxyz = None;
    (nominal, recording)
}

fn refusal(device: &Device, recording: &Recording) -> Option<String> {
    let options = Options {
        weighting: Weighting::Stated,
        held_out: HeldOut::None,
        ..Options::default()
    };
    match calibrate(device, recording, &options) {
        Err(error @ CalibrationError::MistakenColumns { .. }) => Some(error.to_string()),
        Err(error) => panic!("{error}"),
        Ok(_) => None,
    }
}

#[test]
fn a_column_that_runs_backwards_is_named() {
    for place_known in [false, true] {
        let (device, recording) = scene(place_known);
        assert_eq!(refusal(&device, &recording), None);
        for joint in [1, 3] {
            let mut turned = recording.clone();
            turned.joint[joint]
                .iter_mut()
                .for_each(|reading| *reading = -*reading);
            let said = refusal(&device, &turned).unwrap();
            let name = format!("column `theta{}_rad` negated", joint + 1);
            assert!(said.contains(&name), "{said}");
        }
    }
}

#[test]
fn swapped_columns_are_named() {
    let (device, mut recording) = scene(false);
    recording.joint.swap(0, 2);
    let said = refusal(&device, &recording).unwrap();
    assert!(
        said.contains("columns `theta1_rad` and `theta3_rad` swapped"),
        "{said}"
    );
}

/// A device five centimetres from its file is calibrated, not told that its log is wrong.
#[test]
fn a_device_far_from_its_file_has_no_mistaken_column() {
    let (mut device, recording) = scene(false);
    device.links[2].a_m += 0.05;
    device.links[3].theta_rad += 0.2;
    assert_eq!(refusal(&device, &recording), None);
}
