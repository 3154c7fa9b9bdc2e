//! Every refusal of a device file names the exact line and column.

use std::path::Path;

use haptical_model::{Device, DeviceFileError};

/// Stands in a text where the error should point to.
const MARK: char = '^';

const ARM: &str = "\
[device]
name = \"arm\"
dof = 1
convention = \"standard\"

[[link]]
a_m = 0.25
alpha_rad = 0.5
d_m = 0.0

[[link]]
a_m = 0.2
alpha_rad = 0.0
d_m = 0.1

[[joint]]
home_rad = 0.4
lower_rad = -1.0
upper_rad = 1.0
transmission = \"capstan\"
transmission_ratio = 8.0
drum_distance_m = 0.0675
";

/// Refuses the text without its mark, and checks the position against the mark's.
#[track_caller]
fn refused(marked: &str) -> DeviceFileError {
    let before: Vec<&str> = marked.split(MARK).collect();
    let [before, after] = before[..] else {
        panic!("one mark is needed in {marked}");
    };
    let line = before.lines().count() + usize::from(before.is_empty() || before.ends_with('\n'));
    let column = 1 + before.chars().rev().take_while(|c| *c != '\n').count();
    let error = Device::from_toml(&format!("{before}{after}"), "arm.toml").unwrap_err();
    let at = error.position().unwrap_or_else(|| panic!("{error}"));
    assert_eq!((at.line, at.column), (line, column), "{error}");
    assert_eq!(at.file, "arm.toml");
    assert!(
        error
            .to_string()
            .starts_with(&format!("arm.toml:{line}:{column}: ")),
        "{error}"
    );
    error
}

/// The arm with one part of its text replaced.
#[track_caller]
fn changed(from: &str, to: &str) -> String {
    assert_eq!(ARM.matches(from).count(), 1, "{from}");
    ARM.replace(from, to)
}

#[track_caller]
fn refused_value(marked: &str, expected_key: &str, expected_found: &str) {
    match refused(marked) {
        DeviceFileError::Value { key, found, .. } => {
            assert_eq!(
                (key.as_str(), found.as_str()),
                (expected_key, expected_found)
            );
        }
        other => panic!("{other}"),
    }
}

#[track_caller]
fn refused_missing(marked: &str, expected_place: &str, expected_key: &str) {
    match refused(marked) {
        DeviceFileError::MissingKey { place, key, .. } => {
            assert_eq!(
                (place.as_str(), key.as_str()),
                (expected_place, expected_key)
            );
        }
        other => panic!("{other}"),
    }
}

#[test]
fn the_arm_itself_is_accepted() {
    let loaded = Device::from_toml(ARM, "arm.toml").unwrap();
    assert_eq!(loaded.warnings, Vec::<String>::new());
    assert_eq!(loaded.device.links[1].d_m, 0.1);
}

#[test]
fn a_file_that_is_not_there() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("no such file.toml");
    let error = Device::load(&path).unwrap_err();
    assert!(
        matches!(error, DeviceFileError::Unreadable { .. }),
        "{error}"
    );
    assert!(error.to_string().contains("no such file.toml"));
    assert!(error.position().is_none());
}

#[test]
fn text_that_is_not_toml() {
    for marked in [
        "theta1_rad^,cable_m\n0.1,0.2\n".to_owned(),
        changed("a_m = 0.2\n", "a_m = ^0.2 m\n"),
        changed("d_m = 0.1\n", "d_m = 0.1\n^d_m = 0.1\n"),
        // an unknown key, but a number that no file can hold
        changed("d_m = 0.1\n", "d_m = 0.1\nserial = ^1e999\n"),
    ] {
        let error = refused(&marked);
        assert!(matches!(error, DeviceFileError::Syntax { .. }), "{error}");
    }
}

#[test]
fn missing_keys_point_at_their_table() {
    for (key, line) in [("a_m", "a_m = 0.2\n"), ("d_m", "d_m = 0.1\n")] {
        let marked = changed(line, "").replacen("[[link]]\na_m = 0.25", "@", 1);
        let marked = marked.replacen("[[link]]", "^[[link]]", 1);
        refused_missing(
            &marked.replacen('@', "[[link]]\na_m = 0.25", 1),
            "[[link]] 1",
            key,
        );
    }
    let first = changed(
        "[[link]]\na_m = 0.25\nalpha_rad = 0.5\n",
        "^[[link]]\na_m = 0.25\n",
    );
    refused_missing(&first, "[[link]] 0", "alpha_rad");
    for key in ["transmission_ratio = 8.0\n", "drum_distance_m = 0.0675\n"] {
        let marked = changed(key, "").replace("[[joint]]", "^[[joint]]");
        refused_missing(&marked, "[[joint]] 1", key.split(' ').next().unwrap());
    }
    refused_missing(&format!("{ARM}^[gravity]\n"), "[gravity]", "vector_mps2");
    let pair = "^[[contact_pair]]\na = \"p\"\nb = \"q\"\ndistance_m = 0.1\nsd_m = 1e-5\n";
    for key in ["a", "b", "distance_m", "sd_m"] {
        let without: String = pair
            .split_inclusive('\n')
            .filter(|line| !line.starts_with(&format!("{key} =")))
            .collect();
        refused_missing(&format!("{ARM}{without}"), "[[contact_pair]] 1", key);
    }
}

#[test]
fn wrong_types() {
    refused_value(&changed("name = \"arm\"", "name = ^7"), "name", "integer");
    refused_value(
        &changed("dof = 1", "dof = ^\"one\""),
        "dof",
        "the text \"one\"",
    );
    let text = changed("a_m = 0.25", "a_m = ^\"0.25\"");
    refused_value(&text, "a_m", "the text \"0.25\"");
    let boolean = changed("home_rad = 0.4", "home_rad = ^true");
    refused_value(&boolean, "home_rad", "boolean");
    let array = changed("drum_distance_m = 0.0675", "drum_distance_m = ^[0.0675]");
    refused_value(&array, "drum_distance_m", "array");
    let lengths = format!("{ARM}parallelogram_lengths_m = ^0.18\n");
    refused_value(&lengths, "parallelogram_lengths_m", "float");
    let item = format!("{ARM}parallelogram_lengths_m = [0.18, 0.07, ^\"b\", 0.07]\n");
    refused_value(&item, "parallelogram_lengths_m", "the text \"b\"");
    let short = format!("{ARM}parallelogram_lengths_m = ^[0.18, 0.07, 0.18]\n");
    refused_value(&short, "parallelogram_lengths_m", "3 numbers");
    refused_value(
        &format!("cable_encoder = ^1\n{ARM}"),
        "cable_encoder",
        "integer",
    );
    refused_value(
        &format!("contact_pair = [^1]\n{ARM}"),
        "contact_pair",
        "integer",
    );
    refused_value(
        &format!("contact_pair = ^1\n{ARM}"),
        "contact_pair",
        "integer",
    );
}

#[test]
fn numbers_that_are_not_finite() {
    // The last ones are numbers, but their squares are not.
    for number in ["nan", "-nan", "inf", "-inf", "1e999", "1e308", "-1.1e12"] {
        let marked = changed("d_m = 0.1", &format!("d_m = ^{number}"));
        refused_value(&marked, "d_m", number);
    }
    let marked = changed("drum_distance_m = 0.0675", "drum_distance_m = ^1e-300");
    refused_value(&marked, "drum_distance_m", "1e-300");
    let list = format!("{ARM}\n[gravity]\nvector_mps2 = [0, 0, ^nan]\n");
    refused_value(&list, "vector_mps2", "nan");
}

#[test]
fn degrees_where_radians_are_meant() {
    for (from, key, degrees) in [
        ("alpha_rad = 0.5", "alpha_rad", "-90"),
        ("home_rad = 0.4", "home_rad", "90.5"),
        ("lower_rad = -1.0", "lower_rad", "-30"),
        ("upper_rad = 1.0", "upper_rad", "120"),
    ] {
        let marked = changed(from, &format!("{key} = ^{degrees}"));
        refused_value(&marked, key, degrees);
        assert!(refused(&marked).to_string().contains("looks like degrees"));
    }
    let radians = refused(&changed("alpha_rad = 0.5", "alpha_rad = ^180")).to_string();
    assert!(radians.contains("180 deg is 3.141593 rad"), "{radians}");
    let turns = changed("upper_rad = 1.0", "upper_rad = 12.6");
    assert!(
        Device::from_toml(&turns, "f").is_ok(),
        "two turns are a limit"
    );
}

#[test]
fn values_out_of_their_range() {
    let zero = changed("transmission_ratio = 8.0", "transmission_ratio = ^0.0");
    refused_value(&zero, "transmission_ratio", "0");
    for key in [
        "drum_distance_m",
        "input_drum_denominator_m",
        "encoder_counts_per_rev",
        "external_encoder_counts_per_rev",
        "external_encoder_sd_rad",
        "torque_scale_sd",
        "sampling_sd_rad",
    ] {
        let others = changed("drum_distance_m = 0.0675\n", "");
        let others = if key == "drum_distance_m" {
            others
        } else {
            ARM.to_owned()
        };
        refused_value(&format!("{others}{key} = ^-0.5\n"), key, "-0.5");
        refused_value(&format!("{others}{key} = ^0\n"), key, "0");
    }
    for key in ["drum_radius_m", "counts_per_rev", "distance_sd_m"] {
        refused_value(&format!("{ARM}[cable_encoder]\n{key} = ^-1\n"), key, "-1");
    }
    for key in ["position_sd_m", "rotation_sd_rad"] {
        refused_value(&format!("{ARM}[tracker]\n{key} = ^-1\n"), key, "-1");
    }
    let limits = changed("lower_rad = -1.0", "lower_rad = ^1.5");
    refused_value(&limits, "lower_rad", "1.5");
    let slide = changed("home_rad = 0.4", "type = \"prismatic\"")
        .replace("lower_rad = -1.0", "lower_m = ^2.5");
    refused_value(&slide, "lower_m", "2.5");
    let mass = changed("d_m = 0.1", "d_m = 0.1\nmass_kg = ^-0.1");
    refused_value(&mass, "mass_kg", "-0.1");
}

#[test]
fn words_that_are_not_in_the_list() {
    let convention = changed("\"standard\"", "^\"hayati\"");
    refused_value(&convention, "convention", "\"hayati\"");
    let drive = changed("\"capstan\"", "^\"belt\"");
    refused_value(&drive, "transmission", "\"belt\"");
    let joint_type = changed("home_rad = 0.4", "type = ^\"screw\"");
    refused_value(&joint_type, "type", "\"screw\"");
    for key in ["base", "tool"] {
        let marked = format!("{ARM}[tracker]\n{key} = ^\"maybe\"\n");
        refused_value(&marked, key, "\"maybe\"");
    }
}

#[test]
fn counts_that_do_not_agree() {
    refused_value(&changed("dof = 1", "dof = ^7"), "dof", "7");
    let rows = changed("[[link]]\na_m = 0.25", "^[[link]]\na_m = 0.25");
    let more = format!("{rows}[[link]]\na_m = 0\nalpha_rad = 0\nd_m = 0\n");
    refused_value(&more, "link", "a list of 3 rows");
    assert!(
        refused(&more)
            .to_string()
            .contains("1 joints need 2 [[link]] rows")
    );
    let nominal = format!("{ARM}^[[nominal.link]]\na_m = 0\nalpha_rad = 0\nd_m = 0\n");
    refused_value(&nominal, "link", "a list of 1 rows");
    let error = Device::from_toml("[device]\nname = \"empty\"\n", "empty.toml").unwrap_err();
    assert!(matches!(error, DeviceFileError::Shape { .. }), "{error}");
    assert!(error.to_string().contains("no [[joint]]"), "{error}");
}

#[test]
fn transmission_errors_that_cannot_be_used() {
    let table = |lines: &str| format!("{ARM}^[joint.transmission_error]\n{lines}\n");
    let place = "[transmission_error] of [[joint]] 1";
    refused_missing(&table("chebyshev = [0.0, 0.1]"), place, "range_rad");
    let inner = |lines: &str| format!("{ARM}[joint.transmission_error]\n{lines}\n");
    let reversed = inner("chebyshev = [0.0, 0.1]\nrange_rad = ^[0.5, -0.5]");
    refused_value(&reversed, "range_rad", "[0.5, -0.5]");
    let empty = inner("range_rad = [-0.5, 0.5]\nchebyshev = ^[]");
    refused_value(&empty, "chebyshev", "empty");
    // the ratio's deviation cancels the ratio; the centre lies beyond the other drum; no bars
    for line in [
        "ratio_deviation = -8.0",
        "output_drum_xy_m = [0.1, 0.0]",
        "length_deviations_m = [0.0, 0.0, 0.0, 0.0]",
    ] {
        refused_value(&table(line), "transmission_error", "not usable");
    }
}

#[test]
fn a_further_cable_without_the_first() {
    let marked = format!("{ARM}^[[cable]]\nanchor_m = [0.1, 0.0, 0.0]\n");
    refused_missing(&marked, "the file", "cable_encoder");
    let anchor = format!("{ARM}[cable_encoder]\n^[[cable]]\ndistance_sd_m = 1e-5\n");
    refused_missing(&anchor, "[[cable]] 2", "anchor_m");
}

#[test]
fn columns_count_characters_and_not_bytes() {
    let marked = format!("contact_pair = [{{ a = \"\u{e9}\u{4e2d}\", b = ^4 }}]\n{ARM}");
    refused_value(&marked, "b", "integer");
    let windows = changed("d_m = 0.1", "d_m = ^true").replace('\n', "\r\n");
    refused_value(&windows, "d_m", "boolean");
}

/// A place that is not used would be lost without a word.
#[test]
fn a_place_beside_a_tracker_that_sees_the_handle_itself_is_refused() {
    for known in ["tool = \"known\"\n", ""] {
        let place = format!(
            "[tracker]\nbase = \"unknown\"\n{known}tool_xyz_m = ^[0.0, 0.0, 0.1]\ntool_wxyz = [1.0, 0.0, 0.0, 0.0]\n"
        );
        let error = refused(&format!("{ARM}{place}")).to_string();
        assert!(error.contains("write tool = \"unknown\""), "{error}");
    }
    let place = "[tracker]\nbase_xyz_m = ^[0.0, 0.0, 0.1]\nbase_wxyz = [1.0, 0.0, 0.0, 0.0]\n";
    let error = refused(&format!("{ARM}{place}")).to_string();
    assert!(error.contains("write base = \"unknown\""), "{error}");
}
