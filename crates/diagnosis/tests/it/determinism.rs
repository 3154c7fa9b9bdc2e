//! The same input gives the same answer, to the byte.

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
