//! A seven-joint device, a planar one, and serial arms from a few numbers.

use haptical_model::Device;

/// The device file of the paper's device: seven joints, three capstans, a parallelogram, one cable.
pub const HAPTIC7: &str = include_str!("../../../fixtures/devices/haptic7.toml");

/// The paper's device.
///
/// ```
/// assert_eq!(haptical_testkit::haptic7().joints.len(), 7);
/// ```
///
/// # Panics
/// If the fixture is no device file.
#[allow(clippy::expect_used, reason = "a test's device is a device")]
pub fn haptic7() -> Device {
    Device::from_toml(HAPTIC7, "haptic7.toml")
        .expect("the fixture is a device file")
        .device
}

/// A serial arm: `rows` are (a \[m\], alpha \[rad\], d \[m\]) from row 0 on, `joints` the keys of each `[[joint]]` in TOML, and
/// `sensors` the sections of its sensors in TOML.
///
/// ```
/// let sensors = "[cable_encoder]\ndistance_sd_m = 1e-5\n";
/// let arm = haptical_testkit::arm(&[(0.2, 0.7, 0.1), (0.25, -1.1, 0.05)], &["lower_rad = -1.2"], sensors);
/// assert_eq!((arm.links.len(), arm.joints[0].lower_rad, arm.cables.len()), (2, -1.2, 1));
/// ```
///
/// # Panics
/// If this is no device, such as one with a row missing.
#[allow(clippy::expect_used, reason = "a test's device is a device")]
pub fn arm(rows: &[(f64, f64, f64)], joints: &[&str], sensors: &str) -> Device {
    let mut text = String::from("[device]\nname = \"arm\"\n");
    for (a_m, alpha_rad, d_m) in rows {
        text += &format!("[[link]]\na_m = {a_m}\nalpha_rad = {alpha_rad}\nd_m = {d_m}\n");
    }
    for joint in joints {
        text += &format!("[[joint]]\n{joint}\n");
    }
    Device::from_toml(&(text + sensors), "arm.toml")
        .expect("rows, joints and sensors are a device file")
        .device
}

/// Two revolute joints about parallel axes, links of 0.4 m and 0.3 m, an external encoder of 0.1 mrad each, and one cable
/// of 10 µm whose exit is 0.5 m from the first axis, in the plane.
///
/// ```
/// let device = haptical_testkit::planar();
/// let mut evaluation = haptical_model::Evaluation::new(&device);
/// evaluation.move_to(&[0.0, 0.0])?;
/// assert!((evaluation.pose()?.position_m.x - 1.2).abs() < 1e-15);
/// # Ok::<(), haptical_model::ModelError>(())
/// ```
pub fn planar() -> Device {
    let rows = [(0.5, 0.0, 0.0), (0.4, 0.0, 0.0), (0.3, 0.0, 0.0)];
    let joint = "lower_rad = -1.2\nupper_rad = 1.2\nexternal_encoder_sd_rad = 1e-4";
    arm(
        &rows,
        &[joint; 2],
        "[cable_encoder]\ndistance_sd_m = 1e-5\n",
    )
}
