//! Proposals: what columns are taken for, by name, number and size.

use haptical_tables::{Mapping, guess};

use crate::support::{is, proposed, table};

#[test]
fn joints_are_counted_from_1_whatever_the_file_says() {
    is(
        "q0,q1\n0.1,0.2\n0.3,0.4\n",
        &[("theta1_rad", "q0", ""), ("theta2_rad", "q1", "")],
    );
    is(
        "q1,q2\n0.1,0.2\n0.3,0.4\n",
        &[("theta1_rad", "q1", ""), ("theta2_rad", "q2", "")],
    );
    is(
        "joint_1_pos,joint_1_vel,tau_1\n0.1,1,2\n0.3,1,2\n",
        &[
            ("theta1_rad", "joint_1_pos", ""),
            ("velocity1_rad_per_s", "joint_1_vel", ""),
            ("torque1_nm", "tau_1", ""),
        ],
    );
}

/// A log's own names need no correction.
#[test]
fn a_log_is_known_by_its_own_names() {
    is(
        "t_s,theta1_rad,theta2_m,x_m,y_m,z_m\n0,0.1,0.2,1,2,3\n1,0.2,0.3,1,2,3\n",
        &[
            ("t_s", "t_s", ""),
            ("theta1_rad", "theta1_rad", ""),
            ("theta2_m", "theta2_m", ""),
            ("x_m", "x_m", ""),
            ("y_m", "y_m", ""),
            ("z_m", "z_m", ""),
        ],
    );
    let text = guess(&[table("t_s,q1\n0,0.1\n1,0.2\n")], &[]);
    assert!(!text.contains("no ms"), "{text}");
}

/// One column beyond a turn makes all joints of the file degrees: the others are in the same unit.
#[test]
fn joints_of_a_file_share_a_unit() {
    is(
        "A1,A2\n0.5,90\n-1,-45\n",
        &[("theta1_rad", "A1", "deg"), ("theta2_rad", "A2", "deg")],
    );
    is(
        "j1 [rad],j2 [rad]\n7,8\n1,2\n",
        &[
            ("theta1_rad", "j1 [rad]", ""),
            ("theta2_rad", "j2 [rad]", ""),
        ],
    );
    is(
        "enc1,enc2\n40000,20\n-3,5\n",
        &[("theta1_rad", "enc1", ""), ("theta2_rad", "enc2", "")],
    );
}

#[test]
fn places_and_times_have_the_units_that_their_sizes_allow() {
    is(
        "time,q1,x,y,z\n0,0.1,300,20,5\n1,0.2,301,21,6\n",
        &[
            ("t_s", "time", ""),
            ("theta1_rad", "q1", ""),
            ("x_m", "x", "mm"),
            ("y_m", "y", "mm"),
            ("z_m", "z", "mm"),
        ],
    );
    is(
        "timestamp,q1\n1700000000000000000,0.1\n1700000000010000000,0.2\n",
        &[("t_s", "timestamp", "ns"), ("theta1_rad", "q1", "")],
    );
    // half a position is none
    is("q1,x,y\n0.1,1,2\n0.2,2,3\n", &[("theta1_rad", "q1", "")]);
}

/// The device's names count, whatever the order of the columns; a name within a name is not taken for it.
#[test]
fn joints_are_found_by_the_device_s_names() {
    let joints = [("arm_shoulder", false), ("shoulder", false), ("lift", true)];
    let found = proposed(
        &["lift_position,shoulder_position,arm_shoulder_position\n0.1,0.2,0.3\n0.2,0.3,0.4\n"],
        &joints,
    );
    let found: Vec<(&str, &str)> = found
        .iter()
        .map(|(log, from, _)| (log.as_str(), from.as_str()))
        .collect();
    assert_eq!(
        found,
        [
            ("theta3_m", "lift_position"),
            ("theta2_rad", "shoulder_position"),
            ("theta1_rad", "arm_shoulder_position")
        ]
    );
}

#[test]
fn what_is_not_sure_says_so() {
    let unnamed = guess(
        &[table("1 2 3 4 5 6 0.1 0.2 0.3\n2 3 4 5 6 1 0.2 0.3 0.4\n")],
        &[],
    );
    assert!(
        unnamed.contains("UNSURE") && unnamed.contains("theta6_rad") && unnamed.contains("z_m"),
        "{unnamed}"
    );
    let none = guess(&[table("a thing,b thing\nx,y\nz,w\n")], &[]);
    assert!(none.contains("NO JOINT WAS FOUND"), "{none}");
    Mapping::from_toml(&none, "columns.toml").unwrap();
    // a name that would end the comment, or the text, stays one
    let odd = guess(
        &[table(
            "\"q1\"\"\n[rows]\nfirst = 9\",\"it's\\\"\n0.1,2\n0.3,4\n",
        )],
        &[],
    );
    let mapping =
        Mapping::from_toml(&odd, "columns.toml").unwrap_or_else(|error| panic!("{error}\n{odd}"));
    assert_eq!(mapping.rows.first, None, "{odd}");
}

#[test]
fn files_alike_are_runs_and_files_unlike_side_by_side() {
    let joints = "q1,q2\n0.1,0.2\n0.3,0.4\n";
    let place = "x,y,z\n1,2,3\n1,2,3\n";
    let text = |texts: &[&str]| {
        guess(
            &texts.iter().map(|text| table(text)).collect::<Vec<_>>(),
            &[],
        )
    };
    assert!(!text(&[joints, joints]).contains("files_per_run"));
    // columns are found by their names
    let turned = text(&[joints, "q2,q1\n0.2,0.1\n0.4,0.3\n"]);
    assert!(!turned.contains("files_per_run"), "{turned}");
    let degrees = text(&["q1_rad,q2_rad\n0.1,0.2\n", "q1_deg,q2_deg\n5,10\n"]);
    assert!(
        degrees.contains("CHECK") && degrees.contains("in other units"),
        "{degrees}"
    );
    assert!(text(&[joints, place]).contains("files_per_run = 2\nmatch = \"row\""));
    assert!(text(&[joints, place, joints, place]).contains("files_per_run = 2"));
    let thrice = "x,y,z\n1,2,3\n1,2,3\n1,2,3\n1,2,3\n1,2,3\n1,2,3\n";
    assert!(text(&[joints, thrice]).contains("match = \"repeat\""));
}

/// What sees the handle is a word before the axis, whichever instrument it is.
#[test]
fn a_place_is_known_by_the_instrument_that_reads_it() {
    for word in [
        "Tracker",
        "Leica",
        "SMR",
        "OptiTrack",
        "End-effector",
        "flange",
    ] {
        let header: Vec<String> = ["X", "Y", "Z"]
            .map(|axis| format!("{word} {axis} [mm]"))
            .into();
        let text = format!("q1,{}\n0.1,900,10,20\n0.2,910,11,21\n", header.join(","));
        let wanted = [
            ("theta1_rad", "q1", ""),
            ("x_m", &header[0], "mm"),
            ("y_m", &header[1], "mm"),
            ("z_m", &header[2], "mm"),
        ];
        is(&text, &wanted);
    }
    let turns = "q1,tracker_qw,tracker_qx,tracker_qy,tracker_qz\n0.1,1,0,0,0\n0.2,1,0,0,0\n";
    let text = guess(&[table(turns)], &[]);
    let orientation = text.split("[orientation]").nth(1).unwrap();
    assert!(
        orientation.contains("\"tracker_qw\", \"tracker_qx\""),
        "{text}"
    );
}

/// Words of units in capitals, in full and with a full stop; one that is not known is not passed over.
#[test]
fn units_are_known_as_people_write_them() {
    is(
        "J1 [Degrees],J2 [DEG.],X (Millimeters),Y (MM),Z (Inch)\n1,2,3,4,5\n1.5,2,3,4,5\n",
        &[
            ("theta1_rad", "J1 [Degrees]", "Degrees"),
            ("theta2_rad", "J2 [DEG.]", "DEG."),
            ("x_m", "X (Millimeters)", "Millimeters"),
            ("y_m", "Y (MM)", "MM"),
            ("z_m", "Z (Inch)", "Inch"),
        ],
    );
    let text = guess(&[table("J1 [gon],J2 [gon]\n1,2\n3,4\n")], &[]);
    assert!(
        text.contains("the file says `gon`, which is NO KNOWN UNIT"),
        "{text}"
    );
}

#[test]
fn a_unit_that_one_column_says_is_not_its_neighbours() {
    is(
        "J1,J2 [deg]\n1.5,90\n-1,45\n",
        &[("theta1_rad", "J1", ""), ("theta2_rad", "J2 [deg]", "deg")],
    );
}

#[test]
fn what_is_measured_beside_a_joint_is_not_its_angle() {
    let joints = [("elbow", false)];
    let found = proposed(&["elbow_temp,elbow\n40,0.2\n41,0.3\n"], &joints);
    let angles = found.iter().filter(|(log, ..)| log == "theta1_rad");
    let from: Vec<&str> = angles.map(|(_, from, _)| from.as_str()).collect();
    assert_eq!(from, ["elbow"]);
}

#[test]
fn two_clocks_are_matched_by_time_though_the_rows_are_as_many() {
    let joints = "t,q1,q2\n0,0.1,0.2\n0.02,0.3,0.4\n0.04,0.5,0.6\n";
    let at = |step: f64| {
        let rows = (0..3).map(|row| format!("{},1,2,3\n", step * f64::from(row)));
        format!("time,x,y,z\n{}", rows.collect::<String>())
    };
    let matching = |place: &str| guess(&[table(joints), table(place)], &[]);
    assert!(matching(&at(0.01)).contains("match = \"time\""));
    assert!(matching(&at(0.02)).contains("match = \"row\""));
}

/// A place that was commanded is no measurement, and stands before the measured one in some files.
#[test]
fn what_was_measured_is_taken_before_what_was_commanded() {
    is(
        "target_x,target_y,target_z,actual_x,actual_y,actual_z,q1\n1,2,3,1.1,2.1,3.1,0.5\n1,2,4,1.1,2.1,4.1,0.6\n",
        &[
            ("theta1_rad", "q1", ""),
            ("x_m", "actual_x", ""),
            ("y_m", "actual_y", ""),
            ("z_m", "actual_z", ""),
        ],
    );
}

#[test]
fn a_column_counted_from_0_does_not_move_the_joints() {
    let joints = [("theta1_rad", "J1", ""), ("theta2_rad", "J2", "")];
    is("J1,J2,Q0\n0.1,0.2,7\n0.3,0.4,7\n", &joints);
    is("Q0,J1,J2\n7,0.1,0.2\n7,0.3,0.4\n", &joints);
    // the longest list is the joints
    is(
        "Q0,Q1,Q2,J1\n0.1,0.2,0.3,7\n0.3,0.4,0.5,7\n",
        &[
            ("theta1_rad", "Q0", ""),
            ("theta2_rad", "Q1", ""),
            ("theta3_rad", "Q2", ""),
        ],
    );
}

#[test]
fn four_letters_of_length_1_are_a_quaternion_and_no_place() {
    let text = guess(
        &[table("J1,X,Y,Z,W\n0.1,0.6,0,0,0.8\n0.2,0,0.6,0,0.8\n")],
        &[],
    );
    let mapping = Mapping::from_toml(&text, "columns.toml").unwrap();
    assert_eq!(mapping.orientation.unwrap().from, ["W", "X", "Y", "Z"]);
    assert_eq!(mapping.column.len(), 1, "{text}");
}

#[test]
fn times_of_a_clock_are_seconds() {
    let text = "time,q1\n2026-11-27T12:00:00.25Z,nan\n2026-11-27T12:00:00.50Z,0.2\n";
    is(text, &[("t_s", "time", ""), ("theta1_rad", "q1", "")]);
    assert_eq!(
        crate::support::numbers(&table(text))[0],
        ("time", &[1_795_780_800.25, 1_795_780_800.5][..])
    );
}

/// A first row without a reading is no line of names.
#[test]
fn a_first_row_without_readings_is_a_row() {
    let read = table("q1,q2\nnan,nan\n0.1,0.2\n");
    assert_eq!((read.columns[0].name.as_str(), read.lines.len()), ("q1", 2));
}

/// How many counts are a turn is for a person to say: no number is right by itself.
#[test]
fn counts_of_an_encoder_are_refused_until_a_turn_is_said() {
    let text = guess(&[table("q1\n100000\n-20000\n")], &[]);
    let refused = Mapping::from_toml(&text, "columns.toml").unwrap_err();
    assert!(
        refused
            .what
            .contains("`theta1_rad` needs its counts_per_turn"),
        "{refused}"
    );
    let said = text.replace("counts_per_turn = 0 ", "counts_per_turn = 4096 ");
    assert!(Mapping::from_toml(&said, "columns.toml").is_ok());
}
