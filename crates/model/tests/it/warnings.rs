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
