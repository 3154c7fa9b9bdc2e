//! An uncertainty budget of a tracker's log: sensitivities that are known without it, and refusals.

use std::path::Path;

use haptical::calibration::{HeldOut, Options};
use haptical::design::Rig;
use haptical::files::Source;
use haptical::{
    BudgetOptions, Device, Equipment, Identify, Instruments, Log, Truth, budget, simulate_postures,
};

const FIXTURES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures");

fn quick() -> Identify {
    Identify {
        options: Options {
            held_out: HeldOut::None,
            ..Identify::default().options
        },
        ..Identify::default()
    }
}

fn instruments(text: &str) -> Result<Instruments, haptical::Error> {
    Instruments::from_toml(text, Path::new("instruments.toml"))
}

#[test]
fn a_scale_and_a_reading_in_use_have_the_sensitivities_of_geometry() {
    let equipment = Equipment {
        rig: Some(Source::by_path(
            format!("{FIXTURES}/rigs/tracker.toml").as_ref(),
        )),
        ..Equipment::default()
    };
    let source = Source::by_path(format!("{FIXTURES}/devices/haptic7.toml").as_ref());
    let device = Device::open(&source, &equipment).unwrap();
    let log = Log::read(format!("{FIXTURES}/logs/tracker.csv.gz"), &device).unwrap();
    let file = std::fs::read_to_string(format!("{FIXTURES}/instruments/tracker.toml")).unwrap();
    let options = BudgetOptions {
        draws: 10_000,
        ..BudgetOptions::default()
    };
    let found = budget(
        &device,
        &log,
        &quick(),
        &instruments(&file).unwrap(),
        None,
        &options,
    )
    .unwrap();
    let worst = &found.worst;
    let part = |name: &str| {
        worst
            .contributions
            .iter()
            .find(|part| part.name == name)
            .unwrap()
    };
    // everything that the tracker sees, and all that is identified, grows by the scale: c = n . p
    let along: f64 = worst
        .direction
        .iter()
        .zip(worst.position_m)
        .map(|(n, p)| n * p)
        .sum();
    let scale = part("laser tracker: calibration");
    let sensitivity = scale.sensitivity.unwrap();
    assert!(
        (sensitivity - along).abs() < 2e-3 * along.abs(),
        "{sensitivity} {along}"
    );
    assert!((scale.standard_uncertainty.unwrap() - 0.5e-5).abs() < 1e-18);
    let drift = part("laser tracker: drift").standard_uncertainty.unwrap();
    assert!((drift - 0.5e-5 / 3.0_f64.sqrt()).abs() < 1e-18);
    // a joint's reading turns all beyond it: no longer a lever than the reach
    let homing = part("homing of joint 3: conditions").sensitivity.unwrap();
    assert!(homing.abs() > 1e-3 && homing.abs() < 1.2, "{homing}");
    let sum: f64 = worst
        .contributions
        .iter()
        .map(|part| part.contribution_m.powi(2))
        .sum();
    let combined = &worst.combined;
    assert!((sum.sqrt() / combined.standard_uncertainty - 1.0).abs() < 1e-9);
    // no coordinate is known less than the direction that is known least
    assert!(
        worst
            .expanded_xyz_m
            .iter()
            .all(|size| *size <= combined.expanded_uncertainty * 1.001)
    );
    assert!(found.expanded_median_m <= found.expanded_worst_m);
    assert!(found.draws.agreement.holds, "{:?}", found.draws);
    let own = found.draws.simulated.standard_uncertainty / combined.standard_uncertainty;
    assert!((own - 1.0).abs() < 0.03, "{own}");
    let names: Vec<&str> = found
        .files()
        .unwrap()
        .iter()
        .map(|(name, _)| *name)
        .collect();
    assert_eq!(names, ["budget.json", "budget.html"]);
}

#[test]
fn a_cable_fixes_no_position_and_instruments_are_checked() {
    let device = Device::load(format!("{FIXTURES}/devices/haptic7.toml")).unwrap();
    let log = Log::read(format!("{FIXTURES}/logs/haptic7-sample.csv"), &device).unwrap();
    let run = |text: &str| {
        let own = instruments(text)?;
        budget(
            &device,
            &log,
            &quick(),
            &own,
            None,
            &BudgetOptions::default(),
        )
    };
    let refused = run("").unwrap_err();
    assert_eq!(refused.name(), "no-position");
    assert!(refused.what().contains("depends on"), "{refused}");
    let one = "[[instrument]]\nname = \"a\"\nacts_on = \"cable\"\nas = \"offset\"\n";
    for (text, said) in [
        ("[[instrument]]\nname = 1\n", "expected"),
        (one, "no calibration, drift or conditions"),
        (
            &format!("{one}drift = {{ half_width = 1e-5 }}\n"),
            "not one of the three ways",
        ),
        (&format!("{one}drift = {{ standard = 0.0 }}\n"), "above 0"),
        (
            &format!("{one}drift = {{ expanded = 1e-5, k = 2.0, divisor = 2.0 }}\n"),
            "divisor",
        ),
    ] {
        let refused = instruments(text).unwrap_err();
        assert!(refused.what().contains(said), "{refused}");
    }
}

/// Where an effect was fitted too, the handle moves with its numbers: logs that differ in their noise alone scatter as the budget says.
#[test]
fn a_fitted_effect_has_its_part_in_the_budget() {
    const LOGS: u64 = 12;
    let assets = concat!(env!("CARGO_MANIFEST_DIR"), "/../cli/assets");
    let path = format!("{assets}/arm6.urdf");
    let device = Device::load(&path).unwrap();
    let all = Log::read(format!("{assets}/arm6-poses.csv"), &device).unwrap();
    // beyond the range of the log a ratio is all that counts: with another one the handle is elsewhere
    let mut rows: Vec<usize> = (0..all.recording.len()).collect();
    rows.sort_by(|a, b| all.recording.joint[1][*a].total_cmp(&all.recording.joint[1][*b]));
    let farthest = rows.split_off(59);
    rows.truncate(45);
    let postures = Log::from_recording(all.recording.select(&rows), "postures", &device).unwrap();
    let one = Log::from_recording(all.recording.select(&farthest), "one", &device).unwrap();
    let rig = Rig::parse("position").unwrap();
    // where the tracker sees the handle then: the joint is farther than its encoder says
    let mut truly = all.recording.select(&[farthest[0]; 400]);
    for angle in &mut truly.joint[1] {
        *angle /= 1.0 - 2e-3;
    }
    let truly = Log::from_recording(truly, "truly", &device).unwrap();
    let truly = simulate_postures(&device, Truth::Nominal, &truly, Some(&rig), LOGS + 1).unwrap();
    let truly = truly.recording.position_m.unwrap();
    let truly = truly.map(|axis| axis.iter().sum::<f64>() / axis.len() as f64);
    let request = Identify {
        with: vec!["ratio-error@2".to_owned()],
        ..quick()
    };
    let options = BudgetOptions {
        draws: 10_000,
        ..BudgetOptions::default()
    };
    let mut found = Vec::new();
    for seed in 1..=LOGS {
        let made = simulate_postures(&device, Truth::Nominal, &postures, Some(&rig), seed).unwrap();
        let equipment = Equipment {
            // lengths to the scale of this tracker
            rig: Some(Source::text(
                made.rig.unwrap() + "scale_sd = 0.0\n",
                "rig.toml",
            )),
            ..Equipment::default()
        };
        let equipped = Device::open(&Source::by_path(path.as_ref()), &equipment).unwrap();
        let mut recording = made.recording;
        for reading in &mut recording.joint[1] {
            *reading *= 1.0 - 2e-3;
        }
        let log = Log::from_recording(recording, "made", &equipped).unwrap();
        let own = instruments("").unwrap();
        let budget = budget(&equipped, &log, &request, &own, Some(&one), &options).unwrap();
        found.push(budget.worst);
    }
    let direction = found[0].direction;
    let along = found.iter().map(|own| {
        let axes = 0..3;
        axes.map(|axis| (own.position_m[axis] - truly[axis]) * direction[axis])
            .sum::<f64>()
    });
    let along: Vec<f64> = along.collect();
    let mean = along.iter().sum::<f64>() / LOGS as f64;
    let squares: f64 = along.iter().map(|own| (own - mean).powi(2)).sum();
    let scatter = (squares / (LOGS - 1) as f64).sqrt();
    // each log says how much it scatters, from not many more readings than numbers
    let stated = found
        .iter()
        .map(|own| own.combined.standard_uncertainty.powi(2));
    let stated = (stated.sum::<f64>() / LOGS as f64).sqrt();
    let off = mean / (stated / (LOGS as f64).sqrt());
    assert!(off.abs() < 3.5, "{off}");
    let ratio = scatter / stated;
    // 11 degrees of freedom: between 0.48 and 1.57 with 99 %
    assert!((0.48..1.57).contains(&ratio), "{ratio}");
}
