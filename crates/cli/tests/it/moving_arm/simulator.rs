//! A log that MuJoCo made (`fixtures/logs/README.md`): a payload on an arm whose armatures are all off by more than a sound arm's.

use std::path::Path;

use serde_json::Value;

use crate::haptical;

/// True armatures less those of the file \[kg m^2\].
const MORE_KGM2: [f64; 7] = [0.12, -0.09, 0.09, -0.09, 0.03, -0.03, 0.03];

#[test]
fn a_payload_and_armatures_are_named_and_their_intervals_hold_the_truth() {
    let folder = tempfile::tempdir().unwrap();
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    let output = haptical()
        .arg("diagnose")
        .arg("--device")
        .arg(assets.join("arm7.xml"))
        .arg("--log")
        .arg(assets.join("arm7-loaded.csv.gz"))
        .arg("--out")
        .arg(folder.path().join("gap"))
        .arg("--json")
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(told["verdict"], "named");
    let causes = told["causes"].as_array().unwrap();
    assert_eq!(causes[0]["effect"], "payload");
    let holds = |cause: &Value, name: &str, wanted: f64| {
        let ends = &cause["parameters"][name]["ci95"];
        let [low, high] = [0, 1].map(|end| ends[end].as_f64().unwrap());
        assert!((low..=high).contains(&wanted), "{wanted}: {cause}");
    };
    holds(&causes[0], "mass_kg", 1.0);
    let mut armatures = 0;
    for cause in causes.iter().filter(|own| own["effect"] == "armature") {
        let joint = usize::try_from(cause["joint"].as_u64().unwrap()).unwrap();
        holds(cause, "inertia_kgm2", MORE_KGM2[joint - 1]);
        armatures += 1;
    }
    assert!(armatures >= 3, "{told}");
    let others = causes
        .iter()
        .skip(1)
        .filter(|own| own["effect"] != "armature");
    assert_eq!(others.count(), 0, "{told}");
    // `identify` refuses a gap.json of torques alone: the page does not offer it
    let page = std::fs::read_to_string(folder.path().join("gap/gap.html")).unwrap();
    assert!(page.contains("<span>--device</span> <span>corrected.toml</span>"));
    assert!(!page.contains("<span>--with</span>"));
}
