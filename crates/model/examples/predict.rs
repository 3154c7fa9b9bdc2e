//! Prints what a device predicts at one pose, and how its cable depends on each parameter.
#![allow(clippy::print_stdout, reason = "an example prints its result")]

use haptical_model::kinematics::distance_derivative;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, Evaluation};

const DEVICE: &str = r#"
[device]
name = "two-joint arm"

[[link]]                     # row 0: from the cable's guide to the base
a_m = 0.25
alpha_rad = 0.0
d_m = 0.0

[[link]]
a_m = 0.2
alpha_rad = 0.0
d_m = 0.0

[[link]]
a_m = 0.15
alpha_rad = 0.0
d_m = 0.0

[[joint]]
home_rad = 0.8
transmission = "capstan"
transmission_ratio = 8.0
drum_distance_m = 0.0675
[joint.transmission_error]
offset_rad = 0.001
ratio_deviation = 0.02
output_drum_xy_m = [2.0e-4, -1.0e-4]

[[joint]]
home_rad = 1.2

[cable_encoder]
distance_sd_m = 1.0e-5
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let loaded = Device::from_toml(DEVICE, "arm.toml")?;
    let device = loaded.device;
    let mut at = Evaluation::new(&device);
    at.move_to(&[0.3, -0.4])?;

    println!("{}", device.name);
    for joint in 0..device.joints.len() {
        println!(
            "output {}: {:.6} rad, of which transmission error {:.3} mrad",
            joint + 1,
            at.output_rad(joint),
            1e3 * at.error_rad(joint)
        );
    }
    let pose = at.pose()?;
    let [x, y, z] = pose.position_m.into();
    let length_m = pose.position_m.norm();
    println!("handle: {x:.6} {y:.6} {z:.6} m, cable {length_m:.6} m\n");

    println!("parameter          value          unit  d cable / d parameter");
    let transmission = device.transmission_parameters(0);
    for id in device
        .link_parameters(false)
        .into_iter()
        .chain(transmission)
    {
        let slope = distance_derivative(pose, &Vector3::zeros(), &at.pose_derivative(id))?;
        println!(
            "{:17}  {:13.6e}  {:4}  {slope:12.6}",
            id.name(&device),
            id.value(&device),
            id.unit(&device)
        );
    }
    Ok(())
}
