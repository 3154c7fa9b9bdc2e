//! A tracker whose metre is short beside an arm with a slide, whose drive counts lengths too.

use haptical::design::Rig;
use haptical::files::Source;
use haptical::{Device, Diagnose, Equipment, Log, Truth, diagnose, simulate_postures};

/// Two joints that turn and one that slides between them.
const CRANE: &str = r#"<robot name="crane">
  <link name="base"/> <link name="column"/> <link name="boom"/> <link name="hand"/> <link name="tool"/>
  <joint name="turn" type="revolute"> <origin xyz="0 0 0.4"/> <parent link="base"/> <child link="column"/>
    <axis xyz="0 0 1"/> <limit lower="-2.5" upper="2.5" effort="10" velocity="1"/> </joint>
  <joint name="slide" type="prismatic"> <origin xyz="0.3 0.1 0.2"/> <parent link="column"/> <child link="boom"/>
    <axis xyz="1 0 0"/> <limit lower="0" upper="0.8" effort="10" velocity="1"/> </joint>
  <joint name="bend" type="revolute"> <origin xyz="0.2 0 0"/> <parent link="boom"/> <child link="hand"/>
    <axis xyz="0 1 0"/> <limit lower="-2" upper="2" effort="10" velocity="1"/> </joint>
  <joint name="flange" type="fixed"> <origin xyz="0.25 0.02 0.05"/> <parent link="hand"/> <child link="tool"/> </joint>
</robot>"#;

#[test]
fn a_trackers_scale_and_a_slides_ratio_are_each_others_rivals() {
    let source = Source::text(CRANE.to_owned(), "crane.urdf");
    let device = Device::open(&source, &Equipment::default()).unwrap();
    // angles that fill the ranges, by the golden ratio and its powers
    let spread = |low: f64, high: f64, step: f64| -> Vec<f64> {
        let at = |row: u32| low + (high - low) * (step * f64::from(row)).fract();
        (0..150).map(at).collect()
    };
    let columns = [
        ("theta1_rad", spread(-2.4, 2.4, 0.819_172_513)),
        ("theta2_m", spread(0.02, 0.78, 0.671_043_606)),
        ("theta3_rad", spread(-1.9, 1.9, 0.549_700_477)),
    ];
    let cells = columns
        .iter()
        .map(|(name, cells)| (*name, haptical::data::Cells::Numbers(cells)));
    let postures = Log::from_columns(&cells.collect::<Vec<_>>(), "poses.csv", &device).unwrap();
    let rig = Rig::parse("position:unknown").unwrap();
    let made = simulate_postures(&device, Truth::Drawn(0.1), &postures, Some(&rig), 3).unwrap();
    let equipment = Equipment {
        rig: Some(Source::text(made.rig.unwrap(), "rig.toml")),
        ..Equipment::default()
    };
    let equipped = Device::open(&source, &equipment).unwrap();
    for scale in [0.0, 2e-3] {
        let mut recording = made.recording.clone();
        for reading in recording.position_m.iter_mut().flatten().flatten() {
            *reading *= 1.0 + scale;
        }
        let log = Log::from_recording(recording, "scaled", &equipped).unwrap();
        let found = diagnose(&equipped, &log, &Diagnose::default()).unwrap();
        let causes = &found.diagnosis.causes;
        if scale == 0.0 {
            assert!(causes.is_empty(), "{:?}", causes[0]);
            continue;
        }
        let cause = &causes[0];
        let rivals = ["tracker-scale", "ratio-error"];
        assert!(rivals.contains(&cause.effect.as_str()), "{}", cause.effect);
        let other = rivals
            .into_iter()
            .find(|name| *name != cause.effect)
            .unwrap();
        let is_said = |rival: &String| rival.starts_with(other);
        assert!(cause.confusable_with.iter().any(is_said), "{cause:?}");
        if let Some(own) = cause.parameters.get("scale") {
            assert!(own.ci95[0] < scale && scale < own.ci95[1], "{own:?}");
        }
    }
}
