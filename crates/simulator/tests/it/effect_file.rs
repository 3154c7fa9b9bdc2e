//! effects.toml: every effect that is known, and what is refused with which words.

use haptical_simulator::{Effects, record_motion, simulated_effects};

use crate::device::transmissions_only;
use crate::hand::{heavy_arm, quiet};

/// One of each, of the sizes that a real device may have.
const ALL: [&str; 20] = [
    "name = 'capstan-compliance'\njoint = 2\nstiffness_nm_per_rad = 260",
    "name = 'backlash'\njoint = 1\nwidth_rad = 1e-3\ndriven_by = 'motor'",
    "name = 'hysteresis'\njoint = 1\namplitude_rad = 5e-4\ntransition_rad = 0.05",
    "name = 'viscous-lag'\njoint = 1\ndelay_s = 0.002",
    "name = 'encoder-count-loss'\njoint = 1\ncounts = 12\ntime_s = 5",
    "name = 'joint-drift'\njoint = 4\nrad_per_degc = 1e-4",
    "name = 'external-encoder-latency'\njoint = 2\ndelay_s = 0.003",
    "name = 'encoder-latency'\ndelay_s = 0.002",
    "name = 'cable-zero-offset'\noffset_m = 1e-3",
    "name = 'cable-twist'\ntwist_m_per_rad2 = 1e-3",
    "name = 'cable-exit-geometry'\nradius_m = 0.006",
    "name = 'cable-drum-eccentricity'\namplitude_m = 1e-4\nphase_rad = 0.3",
    "name = 'thermal-drift'\nm_per_degc = 2e-5",
    "name = 'cable-drift'\nm_per_s = 1e-6",
    "name = 'cable-latency'\ndelay_s = 0.004",
    "name = 'joint-compliance'\njoint = 4\nstiffness_nm_per_rad = 400.0",
    "name = 'axis-wobble'\njoint = 2\namplitude_rad = 5e-4\nphase_rad = 1.0",
    "name = 'base-compliance'\nrad_per_nm = 1e-4",
    "name = 'tool-compliance'\nm_per_n = 2e-5",
    "name = 'drum-roughness'\njoint = 1\nrms_rad = 3e-4",
];

fn file(effects: &[&str]) -> String {
    effects
        .iter()
        .map(|effect| format!("[[effect]]\n{effect}\n"))
        .collect()
}

fn refusal(text: &str) -> String {
    Effects::from_toml(text, "e.toml")
        .expect_err(text)
        .to_string()
}

#[test]
fn every_known_effect_is_read_and_changes_a_recording() {
    let device = heavy_arm();
    let without = record_motion(&device, &Effects::none(), &quiet(), 1).expect("a recording");
    let mut names = Vec::new();
    for text in ALL {
        let effects = Effects::from_toml(&file(&[text]), "e.toml").expect(text);
        names.push(effects.as_slice()[0].name());
        let with = record_motion(&device, &effects, &quiet(), 1).expect(text);
        assert!(with != without, "{text} does nothing");
    }
    assert_eq!(names, simulated_effects());
    let together = Effects::from_toml(&file(&ALL), "e.toml").expect("all");
    let recording = record_motion(&device, &together, &quiet(), 1).expect("all at once");
    assert!(recording.joint[0].iter().all(|reading| reading.is_finite()));
}

#[test]
fn what_is_wrong_is_said_with_place_and_nearest_name() {
    let first = ALL[0];
    for (text, words) in [
        (
            file(&[ALL[7], &first.replace("capstan-c", "capstan-k")]),
            "e.toml, effect 2: `capstan-kompliance` cannot be simulated; did you mean \
             `capstan-compliance`? the names are: capstan-compliance, backlash",
        ),
        (
            file(&[&first.replace("stiffness_nm", "stifness_nm")]),
            "e.toml, effect 1 (`capstan-compliance`): no parameter `stifness_nm_per_rad`; did you \
             mean `stiffness_nm_per_rad`? its parameters are: joint, stiffness_nm_per_rad",
        ),
        (
            file(&["name = 'backlash'\njoint = 1"]),
            "effect 1 (`backlash`): missing field `width_rad`",
        ),
        (file(&["joint = 1"]), "`name` is missing"),
        (
            file(&[&first.replace("260", "-260")]),
            "`stiffness_nm_per_rad` is -260",
        ),
        (
            file(&[&first.replace("260", "inf")]),
            "`stiffness_nm_per_rad` is inf",
        ),
        (
            file(&[&first.replace("joint = 2", "joint = 0")]),
            "the joint's number, from 1",
        ),
        (
            file(&[&first.replace("joint = 2", "joint = -2")]),
            "effect 1 (`capstan-compliance`)",
        ),
        (
            file(&[&first.replace("joint = 2", "joint = 'two'")]),
            "effect 1 (`capstan-compliance`)",
        ),
        (
            file(&[&ALL[4].replace("12", "1.5")]),
            "a whole number of counts",
        ),
        (
            file(&[&ALL[1].replace("'motor'", "'gravity'")]),
            "`hand` or `motor`",
        ),
        (
            file(&["name = 'joint-drift'\njoint = 1"]),
            "`rad_per_s` or `rad_per_degc`",
        ),
        (
            file(&[first, first]),
            "e.toml, effect 2: `capstan-compliance` is there already",
        ),
        (
            "effect = 3".to_owned(),
            "write each effect as a table [[effect]]",
        ),
        (
            "[[effects]]\nname = 'x'".to_owned(),
            "`effects` is not known",
        ),
        ("[[effect]".to_owned(), "line 1"),
    ] {
        let refusal = refusal(&text);
        assert!(refusal.contains(words), "{refusal}\nhas not: {words}");
    }
}

#[test]
fn an_empty_file_is_no_effects() {
    assert_eq!(
        Effects::from_toml("# none\n", "e.toml"),
        Ok(Effects::none())
    );
}

#[test]
fn effects_that_the_device_cannot_have_are_refused() {
    let refuse = |device: &_, text: &str| {
        let effects = Effects::from_toml(&file(&[text]), "e.toml").expect(text);
        record_motion(device, &effects, &quiet(), 1)
            .expect_err(text)
            .to_string()
    };
    let mut device = heavy_arm();
    let far = ALL[1].replace("joint = 1", "joint = 5");
    assert!(refuse(&device, &far).contains("joint 5, but the device has joints 1 to 4"));
    for index in [0, 8, 15, 16, 17, 18] {
        let words = refuse(&transmissions_only(), ALL[index]);
        assert!(
            words.contains("it needs a device with [[link]] tables"),
            "{words}"
        );
    }
    let wide = ALL[11].replace("1e-4", "0.02");
    assert!(refuse(&device, &wide).contains("drum_radius_m"));
    device.joints[0].encoder_counts_per_rev = None;
    assert!(refuse(&device, ALL[4]).contains("encoder_counts_per_rev"));
    device.cables.clear();
    assert!(refuse(&device, ALL[8]).contains("[cable_encoder]"));
    let mut cold = quiet();
    cold.temperature = None;
    let effects = Effects::from_toml(&file(&[ALL[12]]), "e.toml").expect("a file");
    let error = record_motion(&heavy_arm(), &effects, &cold, 1).expect_err("no temperature");
    assert!(
        error.to_string().contains("a temperature in the settings"),
        "{error}"
    );
    // a spring that any weight pulls out without end
    let weak = ALL[0].replace("260", "0.01");
    assert!(refuse(&heavy_arm(), &weak).contains("springs"));
    // a guide wider than the way to the handle
    let wide = ALL[10].replace("0.006", "10");
    assert!(refuse(&heavy_arm(), &wide).contains("inside the guide"));
}
