//! The same input gives the same answer, to the byte.

use serde_json::Value;

use crate::arm::{Session, diagnosed, record_yielding};

#[test]
fn the_same_recording_gives_the_same_bytes() {
    let recording = record_yielding(&Session::default());
    let one = serde_json::to_string(&diagnosed(&recording)).unwrap();
    let other = serde_json::to_string(&diagnosed(&recording)).unwrap();
    assert_eq!(one, other);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let recording = record_yielding(&Session::default());
    let answers = [1, 4].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| serde_json::to_string(&diagnosed(&recording)).unwrap())
    });
    assert_eq!(answers[0], answers[1]);
}

/// Another processor rounds otherwise: no digit that is reported may hang on it.
#[test]
fn the_last_digits_of_readings_change_nothing() {
    let recording = record_yielding(&Session::default());
    let mut rounded = recording.clone();
    let cables = rounded.cable_m.iter_mut().flatten();
    for (row, reading) in cables.flatten().enumerate() {
        if row % 3 == 0 {
            *reading *= 1.0 + f64::EPSILON;
        }
    }
    let [one, other] =
        [&recording, &rounded].map(|recording| serde_json::to_value(diagnosed(recording)).unwrap());
    let (mut compared, mut worst) = (0, (0.0, String::new()));
    walk(&one, &other, "", &mut |path, a, b| {
        compared += 1;
        let away = (a - b).abs() / a.abs().max(b.abs()).max(1e-12);
        if away > worst.0 {
            worst = (away, format!("{path}: {a} and {b}"));
        }
    });
    assert!(compared > 200, "{compared}");
    assert!(worst.0 < 1e-6, "{worst:?}");
}

/// All numbers of two answers, of which everything else is equal.
fn walk(one: &Value, other: &Value, path: &str, seen: &mut impl FnMut(&str, f64, f64)) {
    match (one, other) {
        (Value::Number(a), Value::Number(b)) => {
            seen(path, a.as_f64().unwrap(), b.as_f64().unwrap());
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{path}");
            let pairs = a.iter().zip(b).enumerate();
            pairs.for_each(|(k, (a, b))| walk(a, b, &format!("{path}/{k}"), seen));
        }
        (Value::Object(a), Value::Object(b)) => {
            assert_eq!(a.len(), b.len(), "{path}");
            a.iter()
                .for_each(|(key, a)| walk(a, &b[key], &format!("{path}/{key}"), seen));
        }
        _ => assert_eq!(one, other, "{path}"),
    }
}

#[test]
fn the_json_has_the_stable_fields() {
    let recording = record_yielding(&Session::default());
    let json = serde_json::to_value(diagnosed(&recording)).unwrap();
    assert_eq!(json["verdict"], "named");
    let channel = &json["gap"]["channels"][1];
    let keys = [
        "channel",
        "joint",
        "rms_before",
        "rms_after",
        "noise_floor",
        "unit",
        "share_of_gap",
        "reduction_percent",
        "reduction_ci95",
    ];
    for key in keys {
        assert!(channel.get(key).is_some(), "gap.channels[].{key}");
    }
    assert_eq!(
        (&channel["channel"], &channel["joint"]),
        (&"out2".into(), &2.into())
    );
    for key in ["channel", "joint", "depends_on", "region"] {
        assert!(json["where"].get(key).is_some(), "where.{key}");
    }
    assert_eq!(json["where"]["depends_on"][0], "torque2_nm");
    let cause = &json["causes"][0];
    for key in [
        "effect",
        "joint",
        "probability",
        "confusable_with",
        "parameters",
        "held_out",
    ] {
        assert!(cause.get(key).is_some(), "causes[].{key}");
    }
    let stiffness = &cause["parameters"]["stiffness_nm_per_rad"];
    assert!(stiffness["value"].is_f64() && stiffness["ci95"].as_array().unwrap().len() == 2);
    for key in [
        "unexplained_share",
        "untestable",
        "invisible",
        "next_experiment",
    ] {
        assert!(json.get(key).is_some(), "{key}");
    }
    for entry in json["invisible"].as_array().unwrap() {
        for key in ["effect", "why", "would_bias"] {
            assert!(
                entry[key].as_str().is_some_and(|text| !text.is_empty()),
                "invisible[].{key}"
            );
        }
    }
    let names: Vec<&str> = json["invisible"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|e| e["effect"].as_str())
        .collect();
    assert!(names.contains(&"cable-scale"), "{names:?}");
}
