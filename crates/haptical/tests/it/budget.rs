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
    const LOGS: u64 = 24;
    let assets = concat!(env!("CARGO_MANIFEST_DIR"), "/../cli/assets");
    let path = format!("{assets}/arm6.urdf");
    let device = Device::load(&path).unwrap();
    let postures = Log::read(format!("{assets}/arm6-poses.csv"), &device).unwrap();
    let one = Log::from_recording(postures.recording.select(&[7]), "one", &device).unwrap();
    let rig = Rig::parse("position").unwrap();
    let request = Identify {
        with: vec!["ratio-error@2".to_owned()],
        ..quick()
    };
    let options = BudgetOptions {
        draws: 10_000,
        ..BudgetOptions::default()
    };
    let mut positions = Vec::new();
    let mut stated = None;
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
        let found = budget(
            &equipped,
            &log,
            &request,
            &instruments("").unwrap(),
            Some(&one),
            &options,
        )
        .unwrap();
        positions.push(found.worst.position_m);
        stated.get_or_insert(found.worst);
    }
    let stated = stated.unwrap();
    let along = positions.iter().map(|position| {
        let pairs = position.iter().zip(stated.direction);
        pairs.map(|(p, n)| p * n).sum::<f64>()
    });
    let along: Vec<f64> = along.collect();
    let mean = along.iter().sum::<f64>() / LOGS as f64;
    let squares: f64 = along.iter().map(|own| (own - mean).powi(2)).sum();
    let scatter = (squares / (LOGS - 1) as f64).sqrt();
    let ratio = scatter / stated.combined.standard_uncertainty;
    // 23 degrees of freedom: between 0.66 and 1.37 with 99 %
    assert!((0.66..1.37).contains(&ratio), "{ratio}");
}
