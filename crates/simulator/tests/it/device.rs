//! The devices that the tests simulate.

use haptical_simulator::model::Device;

/// Four joints, each with another transmission, and two cables.
const ARM: &str = r#"
[[link]]
a_m = 0.25
alpha_rad = -1.570796326794897
d_m = 0.0
[[link]]
a_m = 0.1
alpha_rad = 1.570796326794897
d_m = 0.35
[[link]]
a_m = 0.2
alpha_rad = 1.570796326794897
d_m = 0.01
theta_offset_rad = 0.02
[[link]]
a_m = 0.0
alpha_rad = 0.1
d_m = 0.05
[[link]]
a_m = 0.03
alpha_rad = 0.0
d_m = 0.02

[[joint]]
name = "turret"
home_rad = -2.6
lower_rad = -1.570796326794897
upper_rad = 1.570796326794897
sampling_sd_rad = 0.5235987755982988
transmission = "capstan"
transmission_ratio = 8.0
drum_distance_m = 0.0675
encoder_counts_per_rev = 20000
external_encoder_counts_per_rev = 20000
[joint.transmission_error]
offset_rad = 0.001
ratio_deviation = -0.02
output_drum_xy_m = [1.5e-4, -8e-5]
input_drum_xy_m = [2e-6, 4e-6]

[[joint]]
name = "elbow"
home_rad = 1.2
lower_rad = -0.7853981633974483
upper_rad = 0.7853981633974483
sampling_sd_rad = 0.2617993877991494
transmission = "parallelogram"
transmission_ratio = -12.0
drum_distance_m = 0.0975
parallelogram_lengths_m = [0.18, 0.076, 0.18, 0.076]
encoder_counts_per_rev = 20000
external_encoder_counts_per_rev = 18000
external_encoder_sd_rad = 1.2e-4
[joint.transmission_error]
ratio_deviation = 0.03
length_deviations_m = [-5e-4, -7e-4, 0.0, 0.0]

[[joint]]
name = "slide"
type = "prismatic"
home_m = 0.2
lower_m = -0.1
upper_m = 0.1
sampling_sd_rad = 0.04
transmission_ratio = 300.0
encoder_counts_per_rev = 4000
external_encoder_counts_per_rev = 400000
external_encoder_sd_rad = 2e-5
[joint.transmission_error]
chebyshev = [1e-4, -2e-4, 5e-5]
range_rad = [-0.1, 0.1]

[[joint]]
name = "wrist"
home_rad = -0.5
lower_rad = -0.3
upper_rad = 1.2
sampling_sd_rad = 0.3
encoder_counts_per_rev = 5000

[cable_encoder]
drum_radius_m = 0.015
counts_per_rev = 20000
distance_sd_m = 2e-5

[[cable]]
anchor_m = [0.1, -0.2, 0.3]
drum_radius_m = 0.02
counts_per_rev = 10000
distance_sd_m = 4e-5
"#;

/// The arm of [`ARM`].
pub(crate) fn arm() -> Device {
    parse(ARM)
}

/// Two links in a plane, both driven by a capstan with all six deviations, and one cable.
pub(crate) fn planar() -> Device {
    let joint = |error: &str| {
        format!(
            "[[joint]]\nhome_rad = 0.3\nlower_rad = -1.0\nupper_rad = 1.0\nsampling_sd_rad = 0.3\n\
             transmission = \"capstan\"\ntransmission_ratio = 8.0\ndrum_distance_m = 0.07\n\
             input_drum_denominator_m = 0.003\n[joint.transmission_error]\n{error}"
        )
    };
    let link = |a_m: f64| format!("[[link]]\na_m = {a_m}\nalpha_rad = 0.0\nd_m = 0.0\n");
    let [one, two] = [
        "offset_rad = 0.002\nratio_deviation = 0.1\noutput_drum_xy_m = [0.001, -0.002]\n\
         input_drum_xy_m = [2e-6, 5e-6]\n",
        "offset_rad = -0.001\nratio_deviation = -0.2\noutput_drum_xy_m = [-0.001, 0.0005]\n\
         input_drum_xy_m = [-3e-6, 1e-6]\n",
    ]
    .map(joint);
    parse(&format!(
        "{}{}{}{one}{two}[cable_encoder]\nanchor_m = [0.05, -0.1, 0.2]\n",
        link(0.1),
        link(0.3),
        link(0.2)
    ))
}

/// Joints without links.
pub(crate) fn transmissions_only() -> Device {
    let mut device = arm();
    device.links.clear();
    device.bodies.clear();
    device
}

fn parse(text: &str) -> Device {
    let loaded = Device::from_toml(text, "test.toml").expect("a device");
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    loaded.device
}
