//! Rows behind origins, and rows that follow another row's joint: their keys, refusals, kinematics.

use haptical_model::kinematics::nalgebra::{Matrix4, UnitQuaternion, Vector3};
use haptical_model::kinematics::{Convention, Link, Pose};
use haptical_model::{
    Device, DeviceChain, DeviceFileError, Drive, Evaluation, Joint, JointType, Parameter,
    ParameterId,
};
use proptest::prelude::*;

use crate::support::{CASES, bends_near, device_and_readings};

/// Rounding of some twenty transforms of lengths of at most 1 m, with a factor of ten.
const ROUNDING: f64 = 1e-13;

const LINKAGE: &str = "\
[device]
handle_xyz_m = [0.0, 0.0, 0.1]

[[link]]
a_m = 0.0
alpha_rad = 0.0
d_m = 0.0

[[link]]
a_m = 0.1
alpha_rad = 0.2
d_m = 0.3
b_m = 0.4
origin_xyz_m = [1.0, 2.0, 3.0]
origin_wxyz = [0.6, 0.0, 0.8, 0.0]

[[link]]
a_m = 0.2
alpha_rad = 0.0
d_m = 0.0
driven_by = 1
driven_multiplier = -2.0
driven_offset_rad = 0.25

[[link]]
a_m = 0.2
alpha_rad = 0.0
d_m = 0.0
driven_by = 2
driven_type = \"prismatic\"
driven_offset_m = 0.01

[[joint]]
home_rad = 0.5

[[joint]]
home_rad = 0.1
";

fn linkage() -> Device {
    let loaded = Device::from_toml(LINKAGE, "linkage.toml").unwrap();
    assert_eq!(loaded.warnings, Vec::<String>::new());
    loaded.device
}

fn refusal(from: &str, to: &str) -> DeviceFileError {
    assert_eq!(LINKAGE.matches(from).count(), 1, "{from}");
    Device::from_toml(&LINKAGE.replace(from, to), "linkage.toml").unwrap_err()
}

#[test]
fn the_keys_mean_what_they_say() {
    let device = linkage();
    assert_eq!(device.links[1].b_m, 0.4);
    let origin = device.origins[1].unwrap();
    assert_eq!(origin.position_m, [1.0, 2.0, 3.0]);
    assert_eq!(origin.orientation_wxyz, [0.6, 0.0, 0.8, 0.0]);
    let placed: Vec<bool> = device.origins.iter().map(Option::is_some).collect();
    assert_eq!(placed, [false, true, false, false, true]);
    let drive = |joint, motion, multiplier, offset| Drive {
        joint,
        motion,
        multiplier,
        offset,
    };
    let expected = [
        drive(0, JointType::Revolute, 1.0, 0.0),
        drive(0, JointType::Revolute, -2.0, 0.25),
        drive(1, JointType::Prismatic, 1.0, 0.01),
    ];
    assert_eq!(device.drives, expected);
    assert_eq!(
        (device.drive(0), device.first_row(1), device.first_row(2)),
        (None, Some(3), None)
    );
    // home takes part in what a row does: multiplier home + offset
    let links = device.chain_links();
    assert_eq!(
        (links[1].theta_rad, links[2].theta_rad),
        (0.5, -2.0 * 0.5 + 0.25)
    );
    assert_eq!((links[3].theta_rad, links[3].d_m), (0.0, 0.1 + 0.01));
}

#[test]
fn only_general_rows_offer_a_slide_along_y() {
    let device = linkage();
    let names: Vec<String> = device
        .link_parameters(false)
        .iter()
        .map(|id| id.name(&device))
        .collect();
    let expected = [
        "a0", "alpha0", "d0", "theta0", "a1", "alpha1", "d1", "theta1", "beta1", "b1", "a2",
        "alpha2", "d2", "theta2", "a3", "alpha3", "d3", "theta3",
    ];
    assert_eq!(names, expected);
    let slide = device.parameter("b1").unwrap();
    let parameter = Parameter::B;
    assert_eq!(slide, ParameterId::Link { row: 1, parameter });
    assert_eq!(
        (slide.key(&device).as_str(), slide.unit(&device)),
        ("link[1].b_m", "m")
    );
    assert!(device.parameter("b2").is_err());
}

#[test]
fn what_is_said_of_one_s_own_joint_is_nothing() {
    let plain = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
        [[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\ndriven_by = 1\n[[joint]]\n";
    let device = Device::from_toml(plain, "plain.toml").unwrap().device;
    assert!(device.is_plain_table());
    assert!(!linkage().is_plain_table() && !linkage().drives_are_plain());
}

#[test]
fn wrong_rows_are_refused() {
    for (from, to, said) in [
        (
            "[0.6, 0.0, 0.8, 0.0]",
            "[0.6, 0.0, 0.9, 0.0]",
            "a unit quaternion w, x, y, z is expected",
        ),
        (
            "[0.6, 0.0, 0.8, 0.0]",
            "[0.0, 0.0, 0.0, 0.0]",
            "a quaternion of length 0",
        ),
        ("[0.6, 0.0, 0.8, 0.0]", "[1.0, 0.0, 0.0]", "3 numbers"),
        (
            "driven_by = 2",
            "driven_by = 3",
            "`driven_by` is 3, but a joint from 1 to 2",
        ),
        (
            "driven_by = 2",
            "driven_by = 1",
            "no row is driven by joint 2",
        ),
        ("driven_by = 2", "driven_by = 1.5", "`driven_by` is 1.5"),
        (
            "driven_by = 1\n",
            "",
            "`driven_multiplier` is about the joint that drives the row",
        ),
        (
            "driven_multiplier = -2.0",
            "driven_multiplier = 0.0",
            "`driven_multiplier` is 0",
        ),
        (
            "\"prismatic\"",
            "\"screw\"",
            "it must be \"revolute\" or \"prismatic\"",
        ),
        (
            "driven_offset_rad = 0.25",
            "driven_offset_rad = 25.0",
            "looks like degrees",
        ),
    ] {
        let error = refusal(from, to);
        assert!(error.position().is_some());
        assert!(error.to_string().contains(said), "{to}: {error}");
    }
    // one row more than joints, and nobody says who drives it
    let error = refusal(
        "driven_by = 2\ndriven_type = \"prismatic\"\ndriven_offset_m = 0.01\n",
        "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n",
    );
    assert!(
        error.to_string().contains("names it with `driven_by`"),
        "{error}"
    );
}

/// Origins, drives, b and a handle at random on top of a random device.
fn general() -> impl Strategy<Value = (Device, Vec<f64>)> {
    let origin = (
        prop::array::uniform3(-0.3..0.3_f64),
        prop::array::uniform3(-3.0..3.0_f64),
    )
        .prop_map(|(position_m, [roll, pitch, yaw])| {
            let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
            haptical_model::Origin::from_pose(&Pose {
                position_m: Vector3::from(position_m),
                rotation: turn.to_rotation_matrix().into_inner(),
            })
        });
    let row = (
        prop::option::of(origin),
        -0.2..0.2_f64,
        0.0..1.0_f64,
        any::<bool>(),
        prop_oneof![-2.0..-0.1, 0.1..2.0],
        -0.5..0.5_f64,
    );
    (device_and_readings(), prop::collection::vec(row, 9)).prop_map(
        |((mut device, readings), rows)| {
            let joints = device.joints.len();
            // a row more than joints, or two
            let count = (joints + 2).min(rows.len() - 1);
            let links = device.links.iter().cycle().take(count + 1).copied();
            device.links = links
                .zip(&rows)
                .map(|(link, row)| Link { b_m: row.1, ..link })
                .collect();
            device.bodies = vec![None; count + 1];
            device.origins = rows.iter().take(count + 2).map(|row| row.0).collect();
            if device.origins.iter().all(Option::is_none) {
                device.origins.clear();
            }
            device.drives = (0..count)
                .map(|index| {
                    let (_, _, which, slides, multiplier, offset) = rows[index];
                    Drive {
                        joint: if index < joints {
                            index
                        } else {
                            (which * joints as f64) as usize
                        },
                        motion: if slides {
                            JointType::Prismatic
                        } else {
                            JointType::Revolute
                        },
                        multiplier,
                        offset,
                    }
                })
                .collect();
            (device, readings)
        },
    )
}

fn matrix(pose: &Pose) -> Matrix4<f64> {
    let mut matrix = pose.rotation.to_homogeneous();
    matrix.set_column(3, &pose.position_m.push(1.0));
    matrix
}

fn turn(axis: Vector3<f64>, angle: f64) -> Matrix4<f64> {
    UnitQuaternion::from_scaled_axis(axis * angle).to_homogeneous()
}

/// The product O_0 A_0 O_1 A_1 ... O_(n+1), with each row's variable multiplier (home + output) + offset.
fn product(device: &Device, outputs: &[f64]) -> Matrix4<f64> {
    let origin = |row: usize| match device.origins.get(row) {
        Some(Some(origin)) => matrix(&origin.pose()),
        _ => Matrix4::identity(),
    };
    let slide = |x, y, z| Matrix4::new_translation(&Vector3::new(x, y, z));
    let mut product = Matrix4::<f64>::identity();
    for (row, link) in device.links.iter().enumerate() {
        let (mut theta, mut d) = (link.theta_rad, link.d_m);
        if row > 0 {
            let drive = device.drives[row - 1];
            let home = device.joints[drive.joint].home_rad;
            let variable = drive.multiplier * (home + outputs[drive.joint]) + drive.offset;
            match drive.motion {
                JointType::Revolute => theta += variable,
                JointType::Prismatic => d += variable,
            }
        }
        let [rz, rx, ry] = [
            turn(Vector3::z(), theta),
            turn(Vector3::x(), link.alpha_rad),
            turn(Vector3::y(), link.beta_rad),
        ];
        let (a, b) = (link.a_m, link.b_m);
        product *= origin(row);
        product *= match device.convention {
            Convention::Standard => rz * slide(a, b, d) * rx * ry,
            Convention::Modified => slide(a, b, 0.0) * rx * ry * rz * slide(0.0, 0.0, d),
        };
    }
    product * origin(device.links.len())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    #[test]
    fn the_pose_is_the_product_of_origins_and_rows((device, readings) in general()) {
        let mut at = Evaluation::new(&device);
        at.move_to(&readings).unwrap();
        let outputs: Vec<f64> = (0..readings.len()).map(|joint| at.output_rad(joint)).collect();
        let expected = product(&device, &outputs);
        let pose = matrix(at.pose().unwrap());
        prop_assert!((pose - expected).amax() < ROUNDING, "{}", pose - expected);
        let chain = DeviceChain::new(&device);
        prop_assert!((matrix(&chain.pose(&outputs).unwrap()) - expected).amax() < ROUNDING);
        // the other ways to move agree
        at.move_pose_to(&readings).unwrap();
        prop_assert_eq!(matrix(at.pose().unwrap()), pose);
        at.move_outputs(&outputs).unwrap();
        prop_assert_eq!(matrix(at.pose().unwrap()), pose);
    }

    #[test]
    fn derivatives_are_differences((device, readings) in general()) {
        /// Step of the differences, small against the eccentric drums' 3 mm; rounding of 1 m over it is
        /// 1e-11, and derivatives with respect to eccentricities reach some hundred.
        const STEP: f64 = 1e-5;
        const DIFFERENCE: f64 = 1e-8;
        let mut at = Evaluation::new(&device);
        at.move_to(&readings).unwrap();
        let handle = |device: &Device, readings: &[f64]| {
            let mut moved = Evaluation::new(device);
            moved.move_pose_to(readings).unwrap();
            *moved.pose().unwrap()
        };
        let difference = |pose: &dyn Fn(f64) -> Pose| {
            let weights = [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)];
            let mut rate = Matrix4::zeros();
            for (steps, weight) in weights {
                rate += matrix(&pose(steps * STEP)) * (weight / (12.0 * STEP));
            }
            rate
        };
        let as_rate = |twist: haptical_model::kinematics::Twist| {
            let mut rate = (twist.angular.cross_matrix() * at.pose().unwrap().rotation).to_homogeneous();
            rate.set_column(3, &twist.linear.push(0.0));
            rate
        };
        let transmissions = (0..readings.len()).flat_map(|joint| device.transmission_parameters(joint));
        for id in device.link_parameters(true).into_iter().chain(transmissions) {
            let moved = |step: f64| {
                let mut other = device.clone();
                id.set(&mut other, id.value(&device) + step);
                handle(&other, &readings)
            };
            let rate = as_rate(at.pose_derivative(id));
            let gap = rate - difference(&moved);
            prop_assert!(gap.amax() < DIFFERENCE * (1.0 + rate.amax()), "{} {gap}", id.key(&device));
        }
        for joint in 0..readings.len() {
            if bends_near(&device, joint, readings[joint], 2.0 * STEP) {
                continue;
            }
            let moved = |step: f64| {
                let mut other = readings.clone();
                other[joint] += step;
                handle(&device, &other)
            };
            let rate = as_rate(at.reading_twist(joint));
            let gap = rate - difference(&moved);
            prop_assert!(gap.amax() < DIFFERENCE * (1.0 + rate.amax()), "joint {joint} {gap}");
        }
    }

    #[test]
    fn new_files_come_back_bit_by_bit((device, _) in general()) {
        let text = device.to_new_toml().unwrap();
        let again = Device::from_toml(&text, "again.toml").unwrap();
        prop_assert_eq!(again.warnings, Vec::<String>::new());
        prop_assert_eq!(again.device, device);
    }

    #[test]
    fn new_files_of_plain_devices_come_back((device, _) in device_and_readings()) {
        let again = Device::from_toml(&device.to_new_toml().unwrap(), "again.toml").unwrap().device;
        prop_assert_eq!(again, device);
    }
}

#[test]
fn a_device_that_no_file_describes_is_not_written() {
    let links = vec![Link::default(); 3];
    let joints: Vec<Joint> = vec![Joint::default()];
    let device = Device::new(Convention::Standard, links, joints);
    assert!(device.to_new_toml().is_err(), "a row without a joint");
    let mut device = Device::new(
        Convention::Standard,
        vec![Link::default(); 2],
        vec![Joint::default()],
    );
    device.links[1].a_m = f64::NAN;
    assert!(device.to_new_toml().is_err(), "not a number");
    assert!(DeviceChain::new(&device).pose(&[0.0]).is_err());
    assert!(DeviceChain::new(&device).pose(&[0.0, 1.0]).is_err());
}
