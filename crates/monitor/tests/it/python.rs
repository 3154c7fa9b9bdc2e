//! The same stream through the program in Python (xtask/evidence/second-opinion/watch_case.py).

use haptical_monitor::{Event, Monitor, Settings, Shape};
use serde_json::Value;

fn near(own: f64, other: &Value, relative: f64) {
    let other = other.as_f64().unwrap();
    let gap = (own - other).abs();
    assert!(
        gap <= relative * other.abs().max(1e-3),
        "{own} is not {other}"
    );
}

#[test]
fn the_program_in_python_finds_the_same() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../fixtures/watch/python.json"
    );
    let case: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let number = |name: &str| case[name].as_f64().unwrap();
    let mut monitor = Monitor::new(Settings {
        floors: vec![0.0],
        tolerances: vec![0.0],
        reference_rows: number("reference_rows") as usize,
        miss: 0.05,
    })
    .unwrap();
    // evidence is compared, no alarm is wanted
    monitor.set_rows_between_false_alarms(1e300).unwrap();
    let (mut seed, mut x) = (1_u64, 0.0);
    let mut evidence = Vec::new();
    let until = case["evidence_until_change"].as_array().unwrap();
    for row in 0..number("rows") as u64 {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        x = 0.75 * x + ((seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5);
        let moved = if row < number("change_row") as u64 {
            0.0
        } else {
            number("shift")
        };
        match monitor.push(row as f64, &[x + moved]).unwrap() {
            Some(Event::Referenced) => {
                assert_eq!(row + 1, number("reference_ends") as u64);
                let reference = monitor.reference().unwrap();
                assert_eq!(reference.block_rows, number("block_rows") as usize);
                let own = reference.features[0].unwrap();
                for (own, other) in own.iter().zip(case["features"].as_array().unwrap()) {
                    near(own.mean, &other["mean"], 1e-10);
                    near(own.sd, &other["sd"], 1e-10);
                    near(own.margin, &other["margin"], 1e-8);
                    near(own.widened, &other["widened"], 1e-8);
                }
            }
            Some(Event::Block) if evidence.len() < until.len() => {
                let rows = number("block_rows");
                evidence.push(monitor.evidence() * 1e300 / rows);
            }
            _ => {}
        }
        if monitor.blocks_judged() == number("judged_blocks") as u64 {
            break;
        }
    }
    assert_eq!(evidence.len(), until.len());
    for (own, other) in evidence.iter().zip(until) {
        near(*own, other, 1e-8);
    }
    let (found, _, _) = monitor.change(0.0).unwrap();
    let since: Vec<u64> = case["since"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(Value::as_u64)
        .collect();
    assert_eq!(
        [found.interval[0], found.first, found.interval[1]].map(|block| block as u64),
        since[..]
    );
    let of_step = match found.shape {
        Shape::Step => found.shape_probability,
        Shape::Ramp => 1.0 - found.shape_probability,
    };
    near(of_step, &case["step_probability"], 1e-9);
}
