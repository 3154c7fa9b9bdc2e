//! Proposals for formats that people have: pendants, ROS, EuRoC, Motive, tables without names; the numbers are invented.

use haptical_tables::{Mapping, Orientation, Reading, apply, guess};

use crate::support::{column, is, proposed, read, table};

fn proposal(text: &str) -> String {
    guess(&[table(text)], &[])
}

fn orientation(text: &str) -> Orientation {
    let mapping = Mapping::from_toml(&proposal(text), "columns.toml").unwrap();
    mapping.orientation.unwrap()
}

/// Rows of numbers of this width, the same wherever they are needed.
fn rows(width: usize, separator: &str, size: f64) -> String {
    let cell = |row: usize, column: usize| {
        let number = (1.7 * row as f64 + 2.3 * column as f64 + 0.4).sin();
        format!("{:.6}", size * number)
    };
    let row = |row: usize| {
        let cells: Vec<String> = (0..width).map(|column| cell(row, column)).collect();
        cells.join(separator) + "\n"
    };
    (0..5).map(row).collect()
}

#[test]
fn joints_that_are_called_by_limbs_stand_in_the_arm_s_order() {
    let joints = |names: [&'static str; 6]| {
        let logs = [
            "theta1_rad",
            "theta2_rad",
            "theta3_rad",
            "theta4_rad",
            "theta5_rad",
            "theta6_rad",
        ];
        logs.into_iter()
            .zip(names)
            .map(|(log, name)| (log, name, "deg"))
    };
    let names = ["Base", "Shoulder", "Elbow", "Wrist1", "Wrist2", "Wrist3"];
    let text = format!(
        "{};X;Y;Z;RX;RY;RZ\n{}",
        names.join(";"),
        rows(12, ";", 170.0)
    );
    let place = [("x_m", "X", "mm"), ("y_m", "Y", "mm"), ("z_m", "Z", "mm")];
    let wanted: Vec<_> = joints(names).chain(place).collect();
    is(&text, &wanted);
    assert_eq!(orientation(&text).from, ["RX", "RY", "RZ"]);
    // ROS sorts the joints by the alphabet
    let text = format!(
        "elbow_joint,shoulder_lift_joint,shoulder_pan_joint\n{}",
        rows(3, ",", 1.0)
    );
    is(
        &text,
        &[
            ("theta3_rad", "elbow_joint", ""),
            ("theta2_rad", "shoulder_lift_joint", ""),
            ("theta1_rad", "shoulder_pan_joint", ""),
        ],
    );
    let motoman = ["S", "L", "U", "R", "B", "T"];
    let text = format!("{}\n{}", motoman.join("\t"), rows(6, "\t", 170.0));
    is(&text, &joints(motoman).collect::<Vec<_>>());
}

/// One limb alone may be a place, and two arms are not one.
#[test]
fn limbs_that_are_no_arm_are_left_out() {
    for names in [
        "wrist1,wrist2,wrist3",
        "left_shoulder,left_elbow,right_shoulder,right_elbow",
    ] {
        let width = names.split(',').count();
        is(&format!("{names}\n{}", rows(width, ",", 1.0)), &[]);
    }
}

#[test]
fn the_only_joint_of_the_device_that_begins_so_is_meant() {
    let text = format!(
        "Elbow,Base,trk_x,trk_y,trk_z,trk_qw,trk_qx,trk_qy,trk_qz\n{}",
        rows(9, ",", 1.0)
    );
    let joints = [
        ("base_yaw", false),
        ("elbow_pitch", false),
        ("elbow_roll_2", true),
    ];
    let found = proposed(&[&text], &joints);
    let found: Vec<(&str, &str)> = found.iter().map(|entry| (&*entry.0, &*entry.1)).collect();
    // two joints begin with `elbow`
    let wanted = [
        ("theta1_rad", "Base"),
        ("x_m", "trk_x"),
        ("y_m", "trk_y"),
        ("z_m", "trk_z"),
    ];
    assert_eq!(found, wanted);
    assert_eq!(
        orientation(&text).from,
        ["trk_qw", "trk_qx", "trk_qy", "trk_qz"]
    );
    assert!(proposal(&text).contains("UNSURE: `trk` is not known"));
    // of two words that are not known none is taken
    let text = format!(
        "q1,foo_x,foo_y,foo_z,bar_x,bar_y,bar_z\n{}",
        rows(7, ",", 1.0)
    );
    is(&text, &[("theta1_rad", "q1", "")]);
    // parts of two places are none
    let text = format!("q1,tool_x,tool_y,X,Y,Z\n{}", rows(6, ",", 1.0));
    let place = [("x_m", "X", ""), ("y_m", "Y", ""), ("z_m", "Z", "")];
    is(&text, &[&[("theta1_rad", "q1", "")][..], &place].concat());
}

#[test]
fn fields_of_ros_are_places_turns_and_stamps() {
    let pose = "field.pose.position.x,field.pose.position.y,field.pose.position.z,field.pose.orientation.x,\
                field.pose.orientation.y,field.pose.orientation.z,field.pose.orientation.w,field.twist.linear.x,\
                field.twist.linear.y,field.twist.linear.z";
    let cells = ",0.1,0.2,0.3,0.6,0,0,0.8,1,2,3\n";
    let row = |nanoseconds: u64| format!("{nanoseconds},{nanoseconds}{cells}");
    let rows = row(1_700_000_000_000_000_000) + &row(1_700_000_000_010_000_000);
    let place = [
        ("x_m", "field.pose.position.x", ""),
        ("y_m", "field.pose.position.y", ""),
        ("z_m", "field.pose.position.z", ""),
    ];
    let both = format!("%time,field.header.stamp,{pose}\n{rows}");
    is(&both, &[&[("t_s", "time", "ns")][..], &place].concat());
    assert_eq!(orientation(&both).from[0], "field.pose.orientation.w");
    let stamp = format!("field.header.seq,field.header.stamp,{pose}\n{rows}");
    is(
        &stamp,
        &[&[("t_s", "field.header.stamp", "ns")][..], &place].concat(),
    );
}

#[test]
fn frames_between_the_word_of_a_place_and_its_letter_are_passed_over() {
    let text = "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], \
                v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], \
                b_w_RS_S_z [rad s^-1]\n\
                1700000000000000000,1,2,3,0.8,0.6,0,0,1,2,3,4,5,6\n1700000000005000000,1,2,3,0.8,0.6,0,0,1,2,3,4,5,6\n";
    is(
        text,
        &[
            ("t_s", "timestamp [ns]", "ns"),
            ("x_m", "p_RS_R_x [m]", ""),
            ("y_m", "p_RS_R_y [m]", ""),
            ("z_m", "p_RS_R_z [m]", ""),
        ],
    );
    assert_eq!(orientation(text).from[0], "q_RS_w []");
}

/// An export of Motive: one or two bodies, quaternions or Euler angles.
fn motive(bodies: &[&str], rotation: &str, unit: &str) -> String {
    let turn = match rotation {
        "Quaternion" => "X 0.6,Y 0,Z 0,W 0.8",
        _ => "X 20,Y -30,Z 60",
    };
    let place = "X 1713.1,Y -322.2,Z 1275.0";
    let mut lines = [
        ",Type",
        ",Name",
        ",ID",
        ",",
        "Frame,Time (Seconds)",
        "0,0.0",
        "1,0.5",
    ]
    .map(str::to_owned);
    for (number, body) in bodies.iter().enumerate() {
        let kinds = [
            ("Rotation", turn),
            ("Position", place),
            ("Mean Marker Error", " 0.1"),
        ];
        for (kind, cells) in kinds {
            for (letter, cell) in cells.split(',').filter_map(|entry| entry.split_once(' ')) {
                let number = number.to_string();
                let column = ["Rigid Body", body, &number, kind, letter, cell, cell];
                for (line, cell) in lines.iter_mut().zip(column) {
                    *line += &format!(",{cell}");
                }
            }
        }
    }
    format!(
        "Format Version,1.23,Take Name,Take 1,Rotation Type,{rotation},Length Units,{unit}\n\n{}\n",
        lines.join("\n")
    )
}

#[test]
fn motive_s_lines_of_names_are_joined() {
    let text = motive(&["Tool"], "Quaternion", "Millimeters");
    is(
        &text,
        &[
            ("t_s", "Time (Seconds)", ""),
            ("x_m", "Position.X", "Millimeters"),
            ("y_m", "Position.Y", "Millimeters"),
            ("z_m", "Position.Z", "Millimeters"),
        ],
    );
    let turn = orientation(&text);
    assert_eq!(
        turn.from,
        ["Rotation.W", "Rotation.X", "Rotation.Y", "Rotation.Z"]
    );
    assert!(
        proposal(&text).contains("OptiTrack's Motive"),
        "{}",
        proposal(&text)
    );
    // the place and the turn are those of one body
    let text = motive(&["Stand", "Tool"], "Quaternion", "Meters");
    assert_eq!(orientation(&text).from[0], "Tool.Rotation.W");
    let found = proposed(&[&text], &[]);
    assert_eq!((&*found[1].0, &*found[1].1), ("x_m", "Tool.Position.X"));
    // Euler angles in the file's order
    let text = motive(&["Tool"], "ZYX", "Meters");
    let turn = orientation(&text);
    assert_eq!(turn.from, ["Rotation.Z", "Rotation.Y", "Rotation.X"]);
    assert_eq!(
        (turn.order.as_deref(), turn.unit.as_deref()),
        (Some("zyx"), Some("deg"))
    );
}

/// A name over three columns stands above the first of them.
#[test]
fn names_over_several_columns_are_those_of_all() {
    let text = format!(
        "Trajectories\n100\n,,Tool,,,Rod,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm\n{}",
        rows(8, ",", 900.0)
    );
    let found = proposed(&[&text], &[]);
    let found: Vec<&str> = found.iter().map(|entry| &*entry.1).collect();
    assert_eq!(found, ["Tool.X", "Tool.Y", "Tool.Z"]);
}

#[test]
fn a_header_of_digits_is_no_row() {
    let joints = [
        ("theta1_rad", "0", ""),
        ("theta2_rad", "1", ""),
        ("theta3_rad", "2", ""),
    ];
    let place = [("x_m", "x", ""), ("y_m", "y", ""), ("z_m", "z", "")];
    let text = format!("0,1,2,x,y,z\n{}", rows(6, ",", 1.0));
    is(&text, &[joints, place].concat());
    assert_eq!(table(&text).lines, [2, 3, 4, 5, 6]);
    // pandas numbers columns and rows
    let body: String = rows(3, ",", 1.0)
        .lines()
        .zip(0..)
        .map(|(row, line)| format!("{line},{row}\n"))
        .collect();
    is(&format!(",0,1,2\n{body}"), &joints);
    // a row of whole numbers among such rows is a row
    assert_eq!(table("0,1,2\n3,4,5\n6,7,8\n").lines, [1, 2, 3]);
    assert_eq!(table("0.5,1,2\n3,4,5.5\n").lines, [1, 2]);
}

#[test]
fn a_log_that_was_cut_in_its_last_row_is_read_up_to_there() {
    let whole = "t,q1,q2\n0,0.1,0.2\n0.5,0.3,0.4\n";
    for cut in ["1.0,0.5", "1.0", "1.0,0.5,-", "1.0,0.5,1e-"] {
        let read = table(&format!("{whole}{cut}"));
        assert_eq!(read.lines, [2, 3], "{cut}");
        assert!(
            read.notes[0].contains("line 4, the last, is cut off"),
            "{cut}"
        );
    }
    assert_eq!(table(&format!("{whole}1.0,0.5,0.6")).lines, [2, 3, 4]);
    assert_eq!(table("q1,q2\n0.1,0.2\n0.3,nan").lines, [2, 3]);
    // within the file a short row is a fault
    let short = read(
        &format!("{whole}1.0,0.5\n1.5,0.5,0.6\n"),
        &Reading::default(),
    );
    assert_eq!(short.unwrap_err().line, Some(4));
    let objects = "{\"q1\":0.1,\"q2\":0.2}\n{\"q1\":0.3,\"q2\":0.4}\n";
    let read = table(&format!("{objects}{{\"q1\":0.5,\"q"));
    assert_eq!(read.lines, [1, 2]);
    let mapping =
        Mapping::from_toml(&guess(std::slice::from_ref(&read), &[]), "columns.toml").unwrap();
    let log = apply(&[read], &mapping).unwrap();
    assert_eq!(column(&log, "theta1_rad"), [0.1, 0.3]);
    assert!(
        log.warnings[0].contains("line 3, the last, is cut off"),
        "{:?}",
        log.warnings
    );
}

#[test]
fn whole_times_have_the_unit_that_their_steps_allow() {
    for (step, unit) in [(4_000_000, "ns"), (4000, "us"), (250, "ms"), (2, "")] {
        let rows = (0..4).map(|row| format!("{},0.{row}\n", 1000 + row * step));
        let text = format!("time,q1\n{}", rows.collect::<String>());
        is(&text, &[("t_s", "time", unit), ("theta1_rad", "q1", "")]);
    }
}

#[test]
fn one_value_a_line_is_named() {
    let long = proposal("time,name,value\n0,q1,0.1\n0,q2,0.2\n1,q1,0.3\n1,q2,0.4\n");
    assert!(
        long.contains("pivot(index='time', columns='name', values='value')"),
        "{long}"
    );
    let bare = proposal("0.1\n0.2\n0.3\n");
    assert!(bare.contains("one value a line and no names"), "{bare}");
    assert!(!proposal("q1\n0.1\n0.2\n").contains("one value a line"));
}

#[test]
fn angles_beyond_half_a_turn_are_no_rotation_vector() {
    let kind = |degrees: f64| {
        let text = format!("J1,X,Y,Z,Rx,Ry,Rz\n1,2,3,4,{degrees},{degrees},90\n2,2,3,4,5,6,7\n");
        format!("{:?}", orientation(&text).kind)
    };
    assert_eq!((&*kind(170.0), &*kind(60.0)), ("Euler", "RotationVector"));
}
