//! Poses as makers write them: the proposal, applied as it is, gives the place and the orientation that the numbers were made from.

use haptical_tables::{Mapping, apply, guess};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::support::{column, table};

/// Rows of two joints in degrees, a place in m, an orientation.
fn postures() -> Vec<([f64; 2], Vector3<f64>, Rotation3<f64>)> {
    let rows = (0..5).map(f64::from);
    rows.map(|row| {
        let joints = [20.0 + 31.0 * row, -50.0 + 17.0 * row];
        let place = Vector3::new(0.4 + 0.05 * row, -0.3, 0.1 * row);
        let turn = Rotation3::from_euler_angles(0.3 * row - 0.7, 0.5 - 0.2 * row, 1.1 - 0.6 * row);
        (joints, place, turn)
    })
    .collect()
}

/// What is guessed and applied of columns after the two joints is what the postures are.
#[track_caller]
fn is_read(names: &str, cells: impl Fn(&Vector3<f64>, &Rotation3<f64>) -> Vec<f64>) {
    let mut text = format!("J1,J2,{names}\n");
    for (joints, place, turn) in postures() {
        let row = [joints.to_vec(), cells(&place, &turn)].concat();
        let row: Vec<String> = row.iter().map(f64::to_string).collect();
        text.push_str(&(row.join(",") + "\n"));
    }
    let tables = [table(&text)];
    let proposal = guess(&tables, &[]);
    let mapping = Mapping::from_toml(&proposal, "columns.toml")
        .unwrap_or_else(|error| panic!("{error}\n{proposal}"));
    let log = apply(&tables, &mapping).unwrap_or_else(|error| panic!("{error}\n{proposal}"));
    let of = |name: &str| column(&log, name);
    for (row, (joints, place, turn)) in postures().iter().enumerate() {
        let near = |name: &str, expected: f64| {
            let found = of(name)[row];
            assert!(
                (found - expected).abs() < 1e-9,
                "{name} {found}, not {expected}\n{proposal}"
            );
        };
        near("theta2_rad", joints[1].to_radians());
        near("x_m", place.x);
        near("z_m", place.z);
        let expected = UnitQuaternion::from_rotation_matrix(turn);
        let [w, x, y, z] = ["qw", "qx", "qy", "qz"].map(|name| of(name)[row]);
        let cosine = expected.w * w + expected.i * x + expected.j * y + expected.k * z;
        assert!((cosine.abs() - 1.0).abs() < 1e-9, "{proposal}");
    }
}

/// A quaternion's parts, w first.
fn parts(turn: &Rotation3<f64>) -> [f64; 4] {
    let turn = UnitQuaternion::from_rotation_matrix(turn);
    [turn.w, turn.i, turn.j, turn.k]
}

fn list(name: &str, numbers: impl Iterator<Item = usize>) -> String {
    let names: Vec<String> = numbers.map(|number| format!("{name}[{number}]")).collect();
    names.join(",")
}

#[test]
fn kuka_turns_about_z_then_the_new_y_then_the_new_x() {
    is_read(
        "X [mm],Y [mm],Z [mm],A [deg],B [deg],C [deg]",
        |place, turn| {
            let (about_x, about_y, about_z) = turn.euler_angles();
            // made from its own law, not from the library's angles alone
            let about = |axis: Vector3<f64>, angle: f64| Rotation3::new(axis * angle);
            let whole = about(Vector3::z(), about_z)
                * about(Vector3::y(), about_y)
                * about(Vector3::x(), about_x);
            assert!((whole.matrix() - turn.matrix()).norm() < 1e-12);
            let mm = place * 1e3;
            let angles = [about_z, about_y, about_x].map(f64::to_degrees);
            [mm.x, mm.y, mm.z, angles[0], angles[1], angles[2]].to_vec()
        },
    );
}

#[test]
fn fanuc_turns_about_fixed_axes() {
    is_read("X,Y,Z,W,P,R", |place, turn| {
        let (w, p, r) = turn.euler_angles();
        let mm = place * 1e3;
        [
            mm.x,
            mm.y,
            mm.z,
            w.to_degrees(),
            p.to_degrees(),
            r.to_degrees(),
        ]
        .to_vec()
    });
}

#[test]
fn abb_numbers_the_parts_of_a_quaternion() {
    is_read("trans_x,trans_y,trans_z,q1,q2,q3,q4", |place, turn| {
        let mm = place * 1e3;
        [&[mm.x, mm.y, mm.z][..], &parts(turn)].concat()
    });
}

#[test]
fn universal_robots_number_a_place_and_a_rotation_vector() {
    let names: Vec<String> = (0..6)
        .map(|part| format!("actual_TCP_pose_{part}"))
        .collect();
    // where it should be is no measurement
    let target: Vec<String> = (0..6)
        .map(|part| format!("target_TCP_pose_{part}"))
        .collect();
    is_read(&[target, names].concat().join(","), |place, turn| {
        let vector = turn.scaled_axis();
        [&[0.0; 6][..], place.as_slice(), vector.as_slice()].concat()
    });
}

fn homogeneous(place: &Vector3<f64>, turn: &Rotation3<f64>) -> [[f64; 4]; 4] {
    let mut all = turn.to_homogeneous();
    all.fixed_view_mut::<3, 1>(0, 3).copy_from(place);
    std::array::from_fn(|row| std::array::from_fn(|column| all[(row, column)]))
}

#[test]
fn matrices_are_known_by_their_numbers() {
    let by_rows = |place: &Vector3<f64>, turn: &Rotation3<f64>| homogeneous(place, turn).concat();
    let by_columns = |place: &Vector3<f64>, turn: &Rotation3<f64>| {
        let all = homogeneous(place, turn);
        (0..16)
            .map(|element| all[element % 4][element / 4])
            .collect()
    };
    is_read(&list("O_T_EE", 0..16), by_columns);
    is_read(&list("T_base_tool", 1..17), by_rows);
    let names: Vec<String> = (0..16)
        .map(|element| format!("T{}{}", element / 4 + 1, element % 4 + 1))
        .collect();
    is_read(&names.join(","), by_rows);
    is_read(&list("T", 0..12), |place, turn| {
        homogeneous(place, turn)[..3].concat()
    });
    let nine = format!("x,y,z,{}", list("R", 1..10));
    is_read(&nine, |place, turn| {
        let matrix: &Matrix3<f64> = turn.matrix();
        [place.as_slice(), matrix.transpose().as_slice()].concat()
    });
}

#[test]
fn a_list_says_the_order_of_its_quaternion() {
    let x_first = |turn: &Rotation3<f64>| {
        let [w, x, y, z] = parts(turn);
        [x, y, z, w]
    };
    let names = format!("x,y,z,{}", list("quaternion_xyzw", 1..5));
    is_read(&names, |place, turn| {
        [place.as_slice(), &x_first(turn)].concat()
    });
    // as ROS lists a pose
    is_read(&list("ee_pose", 0..7), |place, turn| {
        [place.as_slice(), &x_first(turn)].concat()
    });
}

/// Nine or sixteen numbers that are no rotation are joints; fields within others are found by the last name.
#[test]
fn a_list_of_joints_is_no_matrix() {
    for count in [9, 16] {
        let cells = |row: usize| {
            let cells = (0..count).map(|joint| (0.1 * (joint + row) as f64).to_string());
            cells.collect::<Vec<_>>().join(",")
        };
        let names = list("joint_states.position", 1..count + 1);
        let text = format!("{names}\n{}\n{}\n", cells(0), cells(3));
        let proposal = guess(&[table(&text)], &[]);
        let last = format!("log = \"theta{count}_rad\"\nfrom = \"joint_states.position[{count}]\"");
        assert!(proposal.contains(&last), "{proposal}");
        assert!(!proposal.contains("[orientation]"), "{proposal}");
    }
    let nested = "data.robot.q_deg[1],data.robot.q_deg[2]\n1,2\n1.5,2.5\n";
    let proposal = guess(&[table(nested)], &[]);
    let second = "log = \"theta2_rad\"\nfrom = \"data.robot.q_deg[2]\"\nunit = \"deg\"";
    assert!(proposal.contains(second), "{proposal}");
}
