//! Keys that nobody knows are warnings with their line.

use haptical_model::Device;

const MISSPELT: &str = "\
favourite = 1
[device]
nam = \"arm\"
[[link]]
a_m = 0.0
alpha_rad = 0.0
d_m = 0.0
beta = 0.1
[[link]]
a_m = 0.2
alpha_rad = 0.0
d_m = 0.0
[[joint]]
home_deg = 30
[joint.transmission_error]
ofset_rad = 0.1
[cable_encoder]
radius_m = 0.015
[[cable]]
anchor_m = [0, 0, 1]
anchor = 1
[tracker]
position_sd = 1e-4
[[contact_pair]]
a = \"p\"
b = \"q\"
distance_m = 0.1
sd_m = 1e-5
distance_mm = 100
[gravity]
vector_mps2 = [0, 0, -9.81]
vector = 1
[nominal]
when = 2026-11-21
[[nominal.link]]
a_m = 0.0
alpha_rad = 0.0
d_m = 0.0
[[nominal.link]]
a_m = 0.2
alpha_rad = 0.0
d_m = 0.0
length = 1
";

#[test]
fn every_unknown_key_is_named_with_its_line() {
    let mut found: Vec<(usize, String)> = Device::from_toml(MISSPELT, "arm.toml")
        .unwrap()
        .warnings
        .iter()
        .map(|warning| {
            let mut parts = warning.splitn(3, ':');
            assert_eq!(parts.next(), Some("arm.toml"), "{warning}");
            let line = parts.next().unwrap().parse().unwrap();
            let key = warning.split('`').nth(1).unwrap().to_owned();
            (line, key)
        })
        .collect();
    found.sort();
    let expected = [
        "favourite",
        "nam",
        "beta",
        "home_deg",
        "ofset_rad",
        "radius_m",
        "anchor",
        "position_sd",
        "distance_mm",
        "vector",
        "when",
        "length",
    ]
    .map(|key| {
        let line = MISSPELT
            .lines()
            .position(|line| line.split(' ').next() == Some(key));
        (line.unwrap() + 1, key.to_owned())
    });
    assert_eq!(found, expected);
}

#[test]
fn the_keys_of_another_kind_of_error_are_not_used() {
    let text = "[[joint]]\n[joint.transmission_error]\nrange_rad = [-1, 1]\nchebyshev = [0, 0.1]\n\
                offset_rad = 0.2\n";
    let warnings = Device::from_toml(text, "f").unwrap().warnings;
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].starts_with("f:5: ") && warnings[0].contains("`offset_rad`"));
}

fn warnings_of(text: &str) -> Vec<String> {
    Device::from_toml(text, "arm.toml").unwrap().warnings
}

#[test]
fn a_misspelt_key_is_answered_with_the_one_that_is_meant() {
    let joint = |key: &str| warnings_of(&format!("[[joint]]\n{key} = 0.5\n")).join("\n");
    for (key, meant) in [
        ("home_deg", "`home_rad`"),
        ("upper_limit_rad", "`upper_rad`"),
        ("drum_distanse_m", "`drum_distance_m`"),
    ] {
        let said = joint(key);
        assert!(said.ends_with(&format!("did you mean {meant}?")), "{said}");
    }
    assert!(joint("colour").ends_with("not known and not used"));
    // A key that is there already is not the one that is meant.
    let both = warnings_of("[[joint]]\nhome_rad = 0.1\nhome_radd = 0.2\n").join("\n");
    assert!(!both.contains("`home_rad`"), "{both}");
}

#[test]
fn many_unknown_keys_are_counted() {
    let keys: String = (0..1000).map(|key| format!("key{key} = 1\n")).collect();
    let said = warnings_of(&format!("{keys}[[joint]]\n"));
    assert_eq!(said.len(), 21);
    assert!(said[0].contains("980 further keys"), "{}", said[0]);
}

#[test]
fn long_lengths_are_suspected_to_be_millimetres() {
    let text = |length: &str| {
        let row = format!("[[link]]\na_m = {length}\nalpha_rad = 0\nd_m = 0\n");
        format!("{row}{row}[[joint]]\n")
    };
    assert_eq!(warnings_of(&text("-10")), Vec::<String>::new());
    let said = warnings_of(&text("-250"));
    assert_eq!(said.len(), 2);
    let wanted = "arm.toml:2:7: [[link]] 0: `a_m` is -250 m; if it is in millimetres, write -0.25";
    assert_eq!(said[0], wanted);
}

#[test]
fn more_joints_or_coefficients_than_any_device_has_are_refused() {
    let refusal = |text: String| {
        Device::from_toml(&text, "arm.toml")
            .unwrap_err()
            .to_string()
    };
    assert!(Device::from_toml(&"[[joint]]\n".repeat(256), "arm.toml").is_ok());
    let said = refusal("[[joint]]\n".repeat(257));
    assert!(
        said.contains("257 tables") && said.contains("at most 256"),
        "{said}"
    );
    let polynomial = |count: usize| {
        let zeros = "0,".repeat(count);
        format!(
            "[[joint]]\n[joint.transmission_error]\nrange_rad = [-1, 1]\nchebyshev = [{zeros}]\n"
        )
    };
    assert!(Device::from_toml(&polynomial(100), "arm.toml").is_ok());
    let said = refusal(polynomial(101));
    assert!(
        said.contains("101 numbers") && said.contains("at most 100"),
        "{said}"
    );
}
