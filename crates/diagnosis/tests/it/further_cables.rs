//! Three cables, of which the second or third reads by another scale: the scale is named with its cable.

use haptical_diagnosis::{Options, Verdict, diagnose};
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Cable, CableFit, Device, Evaluation};

use crate::arm::{self, CABLE_SD_M, Errors, Session};
use crate::normal::Normal;

/// Places by tape, and as they are \[m\].
const ANCHORS_M: [[f64; 3]; 2] = [[0.7, 0.3, 0.1], [-0.1, 0.6, 0.5]];
const BUILT_M: [[f64; 3]; 2] = [[0.703, 0.298, 0.102], [-0.102, 0.601, 0.497]];
const ROWS: usize = 600;

fn device() -> Device {
    let mut device = arm::device();
    let further = ANCHORS_M.map(|anchor_m| Cable {
        anchor_m,
        distance_sd_m: Some(CABLE_SD_M),
        fit: CableFit {
            anchor: true,
            zero: true,
            ..CableFit::default()
        },
        ..Cable::default()
    });
    device.cables.extend(further);
    device
}

/// What is answered where a cable, from 0, reads longer by a share of its length.
fn answer(cable: usize, share: f64, seed: u64) -> haptical_diagnosis::Diagnosis {
    let session = Session {
        seed,
        runs: 1,
        rows_of_a_run: ROWS,
        ..Session::default()
    };
    let mut recording = arm::record(&session, |_| Errors::default());
    let built = arm::built();
    let mut evaluation = Evaluation::new(&built);
    let mut normal = Normal::new(seed + 100);
    let mut readings = [0.0; 3];
    let handles_m: Vec<Vector3<f64>> = (0..recording.len())
        .map(|row| {
            recording.read_joints(row, &mut readings);
            evaluation.move_to(&readings).unwrap();
            evaluation.pose().unwrap().position_m
        })
        .collect();
    for (further, anchor_m) in BUILT_M.into_iter().enumerate() {
        let scale = if further + 1 == cable {
            1.0 + share
        } else {
            1.0
        };
        let reads = |handle_m: &Vector3<f64>| {
            scale * (handle_m - Vector3::from(anchor_m)).norm() + CABLE_SD_M * normal.next()
        };
        let column = handles_m.iter().map(reads).collect();
        recording.cable_m.push(Some(column));
    }
    diagnose(&device(), &recording, &Options::default()).unwrap()
}

#[test]
fn the_scale_of_each_cable_is_named_with_its_number() {
    for cable in [1, 2] {
        let found = answer(cable, 0.01, 7);
        assert_ne!(found.verdict, Verdict::Unknown, "{:?}", found.causes);
        let first = &found.causes[0];
        let names = ["cable-scale", "cable-stretch"];
        assert!(names.contains(&first.effect.as_str()), "{first:?}");
        assert_eq!(first.parameters["cable"].value, (cable + 1) as f64);
        let [low, high] = first.parameters["scale"].ci95;
        assert!(
            low < 0.01 && 0.01 < high && high - low < 1e-3,
            "{low} {high}"
        );
        // the file that corrects it has the cable's number, and says no other
        let corrected = &found.corrected.as_ref().unwrap().effects;
        assert_eq!(corrected.len(), 1);
        assert_eq!(corrected[0].numbers["cable"], (cable + 1) as f64);
    }
}

#[test]
fn sound_cables_have_no_gap() {
    let found = answer(0, 0.0, 8);
    assert_eq!(found.verdict, Verdict::NoGap, "{:?}", found.causes);
    let is_said = |name: &str| {
        let mut untestable = found.untestable.iter();
        untestable.any(|own| own.effect == name && own.why.contains("cable2_m"))
    };
    assert!(is_said("cable-latency") && !is_said("cable-scale"));
}
