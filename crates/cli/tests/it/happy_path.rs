//! Identification of the sample log: files, JSON, pipes, repetition.

use haptical_calibration::{Options, calibrate};
use haptical_data::{JointShape, LogShape, read_log};
use haptical_model::Device;

use crate::{Sandbox, names_in, text};

const FILES: [&str; 4] = [
    "identified.json",
    "identified.toml",
    "identify.html",
    "report.html",
];

fn json_of(sandbox: &Sandbox) -> serde_json::Value {
    let text = std::fs::read_to_string(sandbox.path("result/identified.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn three_files_are_written_and_the_device_loads_again() {
    let sandbox = Sandbox::new();
    let output = sandbox.identify(&[]);
    let summary = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(names_in(&sandbox.path("result")), FILES);
    assert!(summary.lines().count() < 60, "{summary}");
    for wanted in ["cable", "Not identified", "alpha7", "result/report.html"] {
        assert!(summary.contains(wanted), "{wanted}: {summary}");
    }
    let nominal = Device::load(&sandbox.path("device.toml")).unwrap().device;
    let loaded = Device::load(&sandbox.path("result/identified.toml")).unwrap();
    assert_eq!(loaded.warnings, Vec::<String>::new());
    assert_eq!(loaded.device.nominal_links.as_ref(), Some(&nominal.links));

    let result = json_of(&sandbox);
    // The sample's device has a1 1.1 mm shorter; 0.1 mm is ten times the spread of the estimate.
    let a1 = find(&result, "parameters", "name", "a1");
    let value = a1["value"].as_f64().unwrap();
    assert!((value + 1.1e-3).abs() < 1e-4, "{value}");
    assert_eq!(loaded.device.links[1].a_m, value);
    assert_eq!(a1["key"], "link[1].a_m");
    assert_eq!(a1["nominal"], 0.0);
    let [low, high] = [0, 1].map(|end| a1["ci95"][end].as_f64().unwrap());
    assert!(low < value && value < high && high - low < 1e-3);
    let d1 = find(&result, "parameters", "name", "d1");
    assert_eq!(d1["nominal"], 0.35);
    assert!(
        (d1["deviation"].as_f64().unwrap() - 1.2e-3).abs() < 1e-4,
        "{d1}"
    );
    let refused = find(&result, "not_identified", "name", "alpha7");
    assert_eq!(refused["status"], "invisible");
    let ratio = find(&result, "parameters", "name", "ratio_deviation2");
    assert!((ratio["value"].as_f64().unwrap() + 0.020).abs() < 2e-3);
}

fn find<'a>(
    result: &'a serde_json::Value,
    list: &str,
    key: &str,
    value: &str,
) -> &'a serde_json::Value {
    result[list]
        .as_array()
        .unwrap()
        .iter()
        .find(|entry| entry[key] == value)
        .unwrap()
}

#[test]
fn all_documented_fields_are_there() {
    let sandbox = Sandbox::new();
    assert!(sandbox.identify(&[]).status.success());
    let result = json_of(&sandbox);
    for field in [
        "haptical_version",
        "device",
        "log",
        "method",
        "rows",
        "held_out",
        "convergence",
        "iterations",
        "channels",
        "channels_fit",
        "transmissions",
        "parameters",
        "not_identified",
        "identifiability",
        "correlations_above_0_95",
        "noise",
        "warnings",
    ] {
        assert!(!result[field].is_null(), "{field}");
    }
    assert_eq!(result["rows"], 400);
    let cable = find(&result, "channels", "channel", "cable");
    assert_eq!(cable["unit"], "m");
    assert_eq!(cable["readings"], 80);
    let floor = cable["noise_floor"].as_f64().unwrap();
    let after = cable["rms_after"].as_f64().unwrap();
    // 80 readings estimate a root mean square within 8 % (1 sd); 1.3 is beyond 3 sd.
    assert!(after < 1.3 * floor, "{after} {floor}");
    assert!(cable["rms_before"].as_f64().unwrap() > 100.0 * floor);
    let polynomial = &result["transmissions"][3];
    assert_eq!(polynomial["joint"], 4);
    assert_eq!(polynomial["terms"]["form"], "polynomial");
    let powers = polynomial["polynomial_monomials"].as_array().unwrap();
    let degree = polynomial["terms"]["degree"].as_u64().unwrap();
    assert_eq!(powers.len() as u64, degree + 1);
    let device = Device::load(&sandbox.path("result/identified.toml"))
        .unwrap()
        .device;
    for reading in [-0.5_f64, 0.3] {
        let power = |(k, value): (usize, &serde_json::Value)| {
            value.as_f64().unwrap() * reading.powi(i32::try_from(k).unwrap())
        };
        let sum: f64 = powers.iter().enumerate().map(power).sum();
        let series = device.joints[3].error_rad(reading).unwrap();
        // A millionth of the error's size of some mrad: powers lose digits.
        assert!((sum - series).abs() < 1e-9, "{sum} {series}");
    }
    let judged = &result["identifiability"];
    let refused = result["not_identified"].as_array().unwrap().len() as u64;
    let candidates = judged["candidates"].as_u64().unwrap();
    assert_eq!(judged["rank"].as_u64().unwrap(), candidates - refused);
    assert!(judged["at_nominal"]["rank"].is_u64());
}

#[test]
fn the_report_shows_the_numbers_of_the_json_file() {
    let sandbox = Sandbox::new();
    assert!(sandbox.identify(&[]).status.success());
    let result = json_of(&sandbox);
    let page = std::fs::read_to_string(sandbox.path("result/identify.html")).unwrap();
    let cable = find(&result, "channels", "channel", "cable");
    let out3 = find(&result, "channels", "channel", "out3");
    let shown = [
        format!(
            "{:.0} µm before",
            1e6 * cable["rms_before"].as_f64().unwrap()
        ),
        format!(
            "{:.3} mrad before",
            1e3 * out3["rms_before"].as_f64().unwrap()
        ),
    ];
    for wanted in shown.iter().map(String::as_str).chain([
        "theta3 [rad]",
        "out3 - theta3 [mrad]",
        "measured distance [m]",
        "alpha7 has no effect on any measurement",
        "--device device.toml --log log.csv",
        "after, rows not seen by the fit",
    ]) {
        assert!(page.contains(wanted), "{wanted}");
    }
    // Two figures a channel, one a transmission, and the arm.
    assert_eq!(page.matches("<svg").count(), 15);
    // Answer, picture, what moved, what to do next, and the rest folded.
    let places = [
        "parameters identified",
        "What moved",
        "numbers that moved most",
        "What to do next:",
        "<details class=\"section\">",
    ];
    let places = places.map(|words| page.find(words).unwrap_or_else(|| panic!("no `{words}`")));
    assert!(places.is_sorted(), "{places:?}");
    let command = "haptical diagnose --device device.toml --log log.csv --out gap";
    let words = command
        .split(' ')
        .map(|word| format!("<span>{word}</span>"));
    assert!(page.contains(&words.collect::<Vec<_>>().join(" ")));
    let correlated = result["correlations_above_0_95"].as_array().unwrap();
    assert!(!correlated.is_empty());
    for pair in correlated {
        assert!(pair[2].as_f64().unwrap().abs() > 0.95);
        for name in [&pair[0], &pair[1]] {
            assert!(find(&result, "parameters", "name", name.as_str().unwrap())["value"].is_f64());
        }
    }
    // The ratio's slope and the output drum's cosine term are nearly one line over the range.
    let known =
        |pair: &&serde_json::Value| pair[0] == "ratio_deviation1" && pair[1] == "output_drum_x1";
    assert!(correlated.iter().find(known).is_some());
}

#[test]
fn the_same_command_writes_the_same_bytes() {
    let sandbox = Sandbox::new();
    let read = || FILES.map(|name| std::fs::read(sandbox.path("result").join(name)).unwrap());
    assert!(sandbox.identify(&[]).status.success());
    let first = read();
    assert!(sandbox.identify(&[]).status.success());
    assert!(first == read());
}

#[test]
fn json_is_alone_on_standard_output_and_equals_the_file() {
    let sandbox = Sandbox::new();
    let output = sandbox.identify(&["--json"]);
    assert!(output.status.success());
    let file = std::fs::read(sandbox.path("result/identified.json")).unwrap();
    assert!(output.stdout == file);
    assert!(serde_json::from_slice::<serde_json::Value>(&output.stdout).is_ok());
    assert!(!text(&output.stdout).contains("NaN"));
}

#[test]
fn a_pipe_gets_no_control_characters() {
    let sandbox = Sandbox::new();
    let output = sandbox.identify(&[]);
    for stream in [&output.stdout, &output.stderr] {
        let odd = text(stream).chars().find(|c| c.is_control() && *c != '\n');
        assert_eq!(odd, None);
    }
}

#[test]
fn an_identified_device_is_a_device_again() {
    let sandbox = Sandbox::new();
    assert!(sandbox.identify(&[]).status.success());
    let identified = std::fs::read(sandbox.path("result/identified.toml")).unwrap();
    let nominal = sandbox.device_text();
    sandbox.write("device.toml", identified);
    assert!(sandbox.identify(&[]).status.success());
    let result = json_of(&sandbox);
    for channel in result["channels"].as_array().unwrap() {
        let before = channel["rms_before"].as_f64().unwrap();
        let after = channel["rms_after"].as_f64().unwrap();
        // The second search starts at the first one's minimum and stays there.
        assert!((before / after - 1.0).abs() < 1e-3, "{channel}");
    }
    let twice = Device::load(&sandbox.path("result/identified.toml"))
        .unwrap()
        .device;
    let nominal = Device::from_toml(&nominal, "device.toml").unwrap().device;
    assert_eq!(twice.nominal_links, Some(nominal.links));
}

#[test]
fn input_drum_denominators_stay_in_the_identified_device() {
    let sandbox = Sandbox::new();
    assert!(sandbox.identify(&["--paper-preset"]).status.success());
    let device = Device::load(&sandbox.path("result/identified.toml"))
        .unwrap()
        .device;
    let found: Vec<Option<f64>> = device
        .joints
        .iter()
        .map(|joint| joint.input_drum_denominator_m)
        .collect();
    let wanted = [2.9e-3, 2.9e-3, 2.9e-3, 2.6e-3].map(Some);
    assert_eq!(found[..4], wanted);
    assert_eq!(found[4..], [None; 3]);
    assert!(
        sandbox
            .identify(&["--input-drum-denominator-m", "0.004"])
            .status
            .success()
    );
    let device = Device::load(&sandbox.path("result/identified.toml"))
        .unwrap()
        .device;
    assert_eq!(device.joints[3].input_drum_denominator_m, Some(0.004));
}

#[test]
fn options_reach_the_calibration() {
    let sandbox = Sandbox::new();
    let options = ["--method", "two-step", "--degree", "5", "--held-out", "0"];
    assert!(sandbox.identify(&options).status.success());
    let result = json_of(&sandbox);
    assert_eq!(result["method"], "two-step");
    assert_eq!(result["held_out"], "nothing held out");
    assert_eq!(result["transmissions"][3]["terms"]["degree"], 5);
    assert_eq!(result["channels"], result["channels_fit"]);
    assert!(find(&result, "parameters", "name", "ratio_deviation1")["value"].is_f64());
    assert!(sandbox.identify(&["--noise", "stated"]).status.success());
    assert_eq!(json_of(&sandbox)["noise"]["cable"]["factor"], 1.0);
}

/// The figures place residuals by row: with the nominal device, which has no transmission error, the
/// residual of an external encoder is its joint's reading minus its own.
#[test]
fn residuals_know_their_rows() {
    let sandbox = Sandbox::new();
    let device = Device::load(&sandbox.path("device.toml")).unwrap().device;
    let joint = |joint: &haptical_model::Joint| JointShape {
        name: joint.name.clone(),
        prismatic: false,
        lower: joint.lower_rad,
        upper: joint.upper_rad,
    };
    let shape = LogShape {
        joints: device.joints.iter().map(joint).collect(),
        cable_count: 1,
        hands: Vec::new(),
    };
    let recording = read_log(&sandbox.path("log.csv"), &shape)
        .unwrap()
        .recording;
    let calibration = calibrate(&device, &recording, &Options::default()).unwrap();
    let reports = [&calibration.fit_channels, &calibration.held_out_channels];
    for report in reports.into_iter().flatten() {
        let Some(joint) = report.joint else { continue };
        let output = recording.output[joint - 1].as_ref().unwrap();
        for (&row, residual) in report.rows.iter().zip(&report.before) {
            let wanted = recording.joint[joint - 1][row] - output[row];
            assert!(
                (residual - wanted).abs() < 1e-12,
                "{} {row}",
                report.channel
            );
        }
    }
}
