//! `haptical play`: the page is whole, and its numbers are those of the model.

use haptical_calibration::frame_origins_m;
use haptical_simulator::apply_deviations;
use serde_json::Value;

use crate::play_log::{GAP, Played, ROWS, SECOND_RUN, STEP_S, data};
use crate::text;

/// Positions are embedded as whole micrometres, twice rounded where two of them are added \[um\].
const ROUNDING_UM: f64 = 1.001;
/// Errors in um have one digit after the point, in mrad four.
const ROUNDING_SHOWN_UM: f64 = 0.0501;
const ROUNDING_SHOWN_MRAD: f64 = 5.01e-5;
/// What double precision leaves of exact measurements \[m or rad\].
const EXACT: f64 = 1e-12;

const WITH_TRUTH: [&str; 2] = ["--model", "truth.toml"];

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

fn channel<'a>(data: &'a Value, name: &str) -> &'a Value {
    let all = data["channels"].as_array().unwrap();
    all.iter().find(|channel| channel["name"] == name).unwrap()
}

/// The last point of a row of flattened points \[um\].
fn last_point(row: &Value) -> [f64; 3] {
    let row = row.as_array().unwrap();
    [3, 2, 1].map(|back| number(&row[row.len() - back]))
}

#[test]
fn the_page_is_one_file_that_loads_nothing() {
    let page = Played::new().page(&WITH_TRUTH);
    assert!(page.starts_with("<!DOCTYPE html>"));
    for outside in [
        "http://", "https://", "src=", "href=", "@import", "url(", "fetch(",
    ] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(page.contains("default-src 'none'"));
    for part in [
        "id=\"play\"",
        "id=\"at\"",
        "id=\"speed\"",
        "id=\"gain\"",
        "id=\"arm\"",
    ] {
        assert_eq!(page.matches(part).count(), 1, "{part}");
    }
    assert!(page.contains("prefers-color-scheme: dark"));
    assert_eq!(
        page,
        Played::new().page(&WITH_TRUTH),
        "same input, same bytes"
    );
}

#[test]
fn the_data_are_what_the_model_says() {
    let played = Played::new();
    let data = data(&played.page(&WITH_TRUTH));
    assert_eq!(data["calibrated"], true);
    let points = played.nominal.links.len() + 1;
    for row in [0, 23, ROWS - 1] {
        let (nominal_m, nominal_rad) = played.at(&played.nominal, row);
        let (true_m, true_rad) = played.at(&played.truth, row);
        let origins = &data["origins_um"][row];
        assert_eq!(origins.as_array().unwrap().len(), 3 * points);
        let (nominal_um, shift_um) = (last_point(origins), last_point(&data["deviations_um"][row]));
        for axis in 0..3 {
            assert_eq!(number(&origins[axis]), 0.0, "frame (-1) is the origin");
            assert!((nominal_um[axis] - 1e6 * nominal_m[axis]).abs() < ROUNDING_UM);
            let calibrated_um = nominal_um[axis] + shift_um[axis];
            assert!((calibrated_um - 1e6 * true_m[axis]).abs() < ROUNDING_UM);
            let tracked_um = number(&data["tracked_um"][row][axis]);
            assert!((tracked_um - 1e6 * true_m[axis]).abs() < ROUNDING_UM);
        }
        // the log is exact, so the nominal error is nominal minus true, and the other one is none
        let distance = |p: [f64; 3]| p.iter().map(|axis| axis * axis).sum::<f64>().sqrt();
        let cable = channel(&data, "cable");
        let wanted_um = 1e6 * (distance(nominal_m) - distance(true_m));
        assert!((number(&cable["nominal"][row]) - wanted_um).abs() < ROUNDING_SHOWN_UM);
        assert_eq!(number(&cable["calibrated"][row]), 0.0);
        let apart = [0, 1, 2].map(|axis| nominal_m[axis] - true_m[axis]);
        let position = number(&channel(&data, "position")["nominal"][row]);
        assert!((position - 1e6 * distance(apart)).abs() < ROUNDING_SHOWN_UM);
        for joint in 0..4 {
            let out = channel(&data, &format!("out{}", joint + 1));
            assert_eq!(out["unit"], "mrad");
            let wanted_mrad = 1e3 * (nominal_rad[joint] - true_rad[joint]);
            let shown = number(&out["nominal"][row]);
            assert!((shown - wanted_mrad).abs() < ROUNDING_SHOWN_MRAD, "{shown}");
        }
        let time_s = number(&data["axis"]["values"][row]);
        assert!((time_s - STEP_S * row as f64).abs() < 1e-6);
    }
    // row 0 of the device alone: the base is where its a0 puts it
    assert_eq!(number(&data["origins_um"][5][3]), 250_000.0);
    assert_eq!(number(&data["deviations_um"][5][3]), 1900.0);
    // against gravity, which the template has along -y
    assert_eq!(data["up"], serde_json::json!([-0.0, 9.81, -0.0]));
}

/// Stiffness in front of joint 2's external encoder, and behind joint 3's \[N m/rad\].
const STIFFNESS_NM_PER_RAD: [f64; 2] = [1000.0, 2000.0];

#[test]
fn effects_of_the_model_bend_the_arm_and_its_errors() {
    let mut played = Played::new();
    let torque = |joint: usize, row: usize| (0.7 * row as f64 + joint as f64).sin();
    for joint in [1, 2] {
        let column = (0..ROWS).map(|row| torque(joint, row)).collect();
        played.recording.torque_nm[joint] = Some(column);
    }
    played.write_log();
    let truth = std::fs::read_to_string(played.path("truth.toml")).unwrap();
    let [capstan, bearing] = STIFFNESS_NM_PER_RAD;
    let effects = format!(
        "\n[[effect]]\nname = \"capstan-compliance\"\njoint = 2\nstiffness_nm_per_rad = {capstan:?}\n\
         \n[[effect]]\nname = \"joint-compliance\"\njoint = 3\nstiffness_nm_per_rad = {bearing:?}\n"
    );
    played.write("elastic.toml", truth + &effects);
    let page = played.page(&["--model", "elastic.toml"]);
    assert!(page.contains("capstan-compliance@2, joint-compliance@3"));
    let data = data(&page);
    for row in [3, 31, ROWS - 2] {
        let bent = [
            ("theta2", -torque(1, row) / capstan),
            ("theta3", -torque(2, row) / bearing),
        ];
        // the frames in between show what yields behind the encoder alone
        let yields = apply_deviations(&played.truth, &bent[1..]).unwrap();
        let frames = &frame_origins_m(&yields, &played.recording).unwrap()[row];
        for (frame, origin_m) in frames.iter().enumerate().take(frames.len() - 1) {
            for axis in 0..3 {
                let at = |name: &str| number(&data[name][row][3 * frame + axis]);
                let shown_um = at("origins_um") + at("deviations_um");
                assert!(
                    (shown_um - 1e6 * origin_m[axis]).abs() < 2.5 * ROUNDING_UM,
                    "{frame}"
                );
            }
        }
        let bent = apply_deviations(&played.truth, &bent).unwrap();
        let (handle_m, _) = played.at(&bent, row);
        let (nominal_um, shift_um) = (
            last_point(&data["origins_um"][row]),
            last_point(&data["deviations_um"][row]),
        );
        for axis in 0..3 {
            let shown_um = nominal_um[axis] + shift_um[axis];
            // 1 mrad of 1 m bends by 1 um more than the laws say, which are of first order
            assert!((shown_um - 1e6 * handle_m[axis]).abs() < 2.5 * ROUNDING_UM);
        }
        let error = |name| number(&channel(&data, name)["calibrated"][row]);
        let wanted_mrad = -1e3 * torque(1, row) / capstan;
        assert!((error("out2") - wanted_mrad).abs() < ROUNDING_SHOWN_MRAD);
        assert_eq!(error("out3"), 0.0, "behind the encoder");
    }
}

#[test]
fn an_effect_that_the_log_does_not_drive_is_refused() {
    let played = Played::new();
    let truth = std::fs::read_to_string(played.path("truth.toml")).unwrap();
    let effect = "\n[[effect]]\nname = \"thermal-drift\"\nm_per_degc = 1e-5\nbeyond_m_per_degc = 0.0\nlength_m = 0.4\nreference_degc = 20.0\n";
    played.write("elastic.toml", truth + effect);
    let output = played.play(&["--out", "page.html", "--model", "elastic.toml"]);
    let said = text(&output.stderr);
    assert!(
        output.status.code() != Some(0) && said.contains("thermal-drift"),
        "{said}"
    );
    assert!(said.contains("temp_degc"), "{said}");
}

#[test]
fn nominal_errors_are_larger_than_those_of_the_true_model() {
    let played = Played::new();
    let output = played.play(&["--out", "page.html", "--json", "--model", "truth.toml"]);
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(said["page"], "page.html");
    assert_eq!((&said["rows"], &said["every"]), (&ROWS.into(), &1.into()));
    assert_eq!(said["axis"], "t_s");
    let size = std::fs::metadata(played.path("page.html")).unwrap().len();
    assert_eq!(said["bytes"], size);
    let channels = said["channels"].as_array().unwrap();
    let names: Vec<&str> = channels
        .iter()
        .map(|channel| channel["channel"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["out1", "out2", "out3", "out4", "cable", "position"]);
    for channel in channels {
        let (nominal, truth) = (&channel["rms_nominal"], &channel["rms_calibrated"]);
        assert!(number(truth) < EXACT, "{channel}");
        // joints 3 and 4 deviate in their offsets alone, which their encoders do not see
        let sees_error = !["out3", "out4"].contains(&channel["channel"].as_str().unwrap());
        assert_eq!(number(nominal) > 1e-5, sees_error, "{channel}");
    }
}

#[test]
fn missing_cells_and_runs_leave_gaps() {
    let data = data(&Played::new().page(&WITH_TRUTH));
    for name in ["cable", "out2"] {
        for arm in ["nominal", "calibrated"] {
            let errors = channel(&data, name)[arm].as_array().unwrap();
            let empty: Vec<usize> = (0..ROWS).filter(|&row| errors[row].is_null()).collect();
            assert_eq!((errors.len(), empty), (ROWS, vec![GAP]), "{name}");
        }
    }
    assert_eq!(data["run_starts"], serde_json::json!([SECOND_RUN]));
}

#[test]
fn without_a_model_only_the_nominal_arm_is_drawn() {
    let page = Played::new().page(&[]);
    assert!(!page.contains("calibrated now"));
    let data = data(&page);
    assert_eq!(data["calibrated"], false);
    assert!(data["deviations_um"].is_null());
    let cable = channel(&data, "cable");
    assert!(cable["calibrated"].is_null());
    assert!(number(&cable["nominal"][0]).abs() > 1.0);
}

#[test]
fn rows_are_the_axis_where_time_does_not_increase() {
    let mut played = Played::new();
    played.recording.time_s = None;
    played.write_log();
    let without = data(&played.page(&["--every", "7"]));
    assert_eq!(without["axis"]["is_time"], false);
    let values: Vec<f64> = (0..ROWS).step_by(7).map(|row| row as f64 + 1.0).collect();
    assert_eq!(without["axis"]["values"], serde_json::json!(values));
    // a second run that starts at 0 again
    let times = (0..ROWS).map(|row| STEP_S * (row % SECOND_RUN) as f64);
    played.recording.time_s = Some(times.collect());
    played.write_log();
    assert_eq!(data(&played.page(&[]))["axis"]["is_time"], false);
}

#[test]
fn thinning_keeps_every_nth_row_of_everything() {
    let played = Played::new();
    let (all, thinned) = (
        data(&played.page(&WITH_TRUTH)),
        data(&played.page(&["--every", "17", "--model", "truth.toml"])),
    );
    assert_eq!(thinned["every"], 17);
    assert_eq!(thinned["origins_um"].as_array().unwrap().len(), 4);
    for (short, long) in [(0, 0), (1, 17), (3, 51)] {
        assert_eq!(thinned["origins_um"][short], all["origins_um"][long]);
        assert_eq!(thinned["tracked_um"][short], all["tracked_um"][long]);
        for name in ["cable", "out2"] {
            let (thin, whole) = (channel(&thinned, name), channel(&all, name));
            assert_eq!(thin["calibrated"][short], whole["calibrated"][long]);
            assert_eq!(thin["nominal"][short], whole["nominal"][long]);
        }
    }
    // the row that begins the run is not kept, the first one behind it is: 51
    assert_eq!(thinned["run_starts"], serde_json::json!([3]));
    let page = played.page(&["--every", "1000"]);
    assert_eq!(data(&page)["origins_um"].as_array().unwrap().len(), 1);
}

#[test]
fn a_long_log_makes_a_page_below_3_mb() {
    let played = Played::with_rows(20_000);
    let output = played.play(&["--out", "page.html", "--model", "truth.toml"]);
    let said = text(&output.stdout);
    assert!(said.contains("20000 rows"), "{said}");
    assert!(
        !text(&output.stderr).contains("MB"),
        "{}",
        text(&output.stderr)
    );
    let page = std::fs::read_to_string(played.path("page.html")).unwrap();
    assert!(
        (1_000_000..3_000_000).contains(&page.len()),
        "{}",
        page.len()
    );
    assert!(number(&data(&page)["every"]) > 1.0);
}
