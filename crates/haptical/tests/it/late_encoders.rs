//! Three axes of a real robot whose encoders on the links are late, and whose gears yield.

use std::path::PathBuf;

use haptical::diagnosis::Verdict;
use haptical::{Device, Diagnose, Log, diagnose};

/// One delay of 2.5 to 3.2 ms is named at each axis, the gears of axes 2 and 3 yield besides, and at most 0.1 mrad is left of the second
/// recording. The stiffnesses are near those of a regression with the delay taken out first: 1.4e7 and 8.2e6 N m/rad.
#[test]
fn a_robots_delay_and_gears_are_named() {
    let folder =
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/measured/kuka_kr300");
    if !folder.exists() {
        println!("skipped: no {}", folder.display());
        return;
    }
    let device = Device::load(folder.join("device_axes_1_to_3.toml")).unwrap();
    let [log, second] = ["identification.csv.gz", "validation.csv.gz"]
        .map(|name| Log::read(folder.join(name), &device).unwrap());
    let options = Diagnose {
        validate: Some(&second),
        ..Diagnose::default()
    };
    let found = diagnose(&device, &log, &options).unwrap().diagnosis;
    assert_eq!(found.verdict, Verdict::Named);
    let number = |effect: &str, joint: usize, name: &str| {
        let mut causes = found.causes.iter();
        let own = causes.find(|own| own.effect == effect && own.joint == Some(joint));
        own.unwrap_or_else(|| panic!("no {effect} at joint {joint}: {:?}", found.causes))
            .parameters[name]
            .value
    };
    for joint in 1..=3 {
        let delay_s = number("external-encoder-latency", joint, "delay_s");
        assert!((0.0025..0.0032).contains(&delay_s), "{joint}: {delay_s} s");
        let channel = format!("out{joint}");
        let rest = found
            .predictions
            .iter()
            .filter(|own| own.channel == channel);
        let (mut sum, mut count) = (0.0, 0.0);
        for own in rest {
            sum += (own.measured - own.after).powi(2);
            count += 1.0;
        }
        let rms_rad = f64::sqrt(sum / count);
        assert!(count > 100.0 && rms_rad < 1e-4, "{joint}: {rms_rad} rad");
    }
    for (joint, stiffness) in [(2, 1.4e7), (3, 8.2e6)] {
        let own = number("capstan-compliance", joint, "stiffness_nm_per_rad");
        assert!((own / stiffness - 1.0).abs() < 0.2, "{joint}: {own}");
    }
}
