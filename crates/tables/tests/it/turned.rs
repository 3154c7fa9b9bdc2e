//! Rotations: values of another implementation, and laws that hold for all.

use haptical_tables::rotation::{from_euler, from_matrix, from_rotation_vector, inverse, is_order};
use haptical_tables::{Applied, TableError};
use proptest::prelude::*;

use crate::support::{close, column, log};

/// `scipy.spatial.transform.Rotation.from_euler(ORDER, [20, -35, 50], degrees=True).as_quat(canonical=True)`, scalar first; SciPy
/// 1.17.1 writes intrinsic orders in capitals.
const SCIPY: [(&str, bool, [f64; 4]); 6] = include!("scipy.in");

#[test]
fn euler_angles_are_those_of_scipy() {
    let angles = [20.0_f64, -35.0, 50.0].map(f64::to_radians);
    for (order, is_intrinsic, wanted) in SCIPY {
        close(&from_euler(angles, order, is_intrinsic), &wanted, 1e-12);
    }
    assert!(!is_order("xxy") && !is_order("xy") && !is_order("abc") && is_order("zyz"));
}

fn turned(rule: &str, cells: &str) -> Result<Applied, TableError> {
    let names: Vec<String> = (1..=cells.split(' ').count())
        .map(|number| format!("'#{number}'"))
        .collect();
    let rule = format!("[orientation]\nfrom = [{}]\n{rule}", names.join(","));
    log(&[&format!("{cells}\n{cells}\n")], &rule)
}

fn quaternion(log: &Applied) -> Vec<f64> {
    ["qw", "qx", "qy", "qz"]
        .map(|part| column(log, part)[0])
        .to_vec()
}

const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// A quarter turn about z, and what a wrong reading of it would be.
#[test]
fn each_way_of_writing_gives_the_turn_that_is_meant() {
    let quarter = [HALF, 0.0, 0.0, HALF];
    let root = HALF.to_string();
    let cases = [
        (
            "kind = 'quaternion'\norder = 'wxyz'".to_owned(),
            format!("{root} 0 0 {root}"),
        ),
        (
            "kind = 'quaternion'\norder = 'xyzw'".to_owned(),
            format!("0 0 {root} {root}"),
        ),
        (
            "kind = 'rotation_vector'\nunit = 'deg'".to_owned(),
            "0 0 90".to_owned(),
        ),
        (
            "kind = 'euler'\norder = 'xyz'\naxes = 'extrinsic'\nunit = 'deg'".to_owned(),
            "0 0 90".to_owned(),
        ),
        (
            "kind = 'euler'\norder = 'zyx'\naxes = 'intrinsic'\nunit = 'deg'".to_owned(),
            "90 0 0".to_owned(),
        ),
        (
            "kind = 'matrix'\nlayout = 'row'".to_owned(),
            "0 -1 0 1 0 0 0 0 1".to_owned(),
        ),
        (
            "kind = 'matrix'\nlayout = 'column'".to_owned(),
            "0 1 0 -1 0 0 0 0 1".to_owned(),
        ),
    ];
    for (rule, cells) in cases {
        close(
            &quaternion(&turned(&rule, &cells).unwrap()),
            &quarter,
            1e-12,
        );
    }
    // read the other way round, the turn is the opposite one
    let other = turned("kind = 'matrix'\nlayout = 'column'", "0 -1 0 1 0 0 0 0 1").unwrap();
    close(&quaternion(&other), &[HALF, 0.0, 0.0, -HALF], 1e-12);
}

#[test]
fn a_pose_has_its_position_in_its_last_column() {
    let rows = "0 -1 0 100 1 0 0 200 0 0 1 300 0 0 0 1";
    let log = turned("kind = 'pose'\nlayout = 'row'\nunit = 'mm'", rows).unwrap();
    close(
        &["x_m", "y_m", "z_m"].map(|part| column(&log, part)[0]),
        &[0.1, 0.2, 0.3],
        1e-15,
    );
    close(&quaternion(&log), &[HALF, 0.0, 0.0, HALF], 1e-12);
    let columns = "0 1 0 0 -1 0 0 0 0 0 1 0 100 200 300 1";
    let same = turned("kind = 'pose'\nlayout = 'column'\nunit = 'mm'", columns).unwrap();
    assert_eq!(log, same);
    let error = turned("kind = 'pose'\nlayout = 'row'\nunit = 'mm'", columns).unwrap_err();
    assert!(error.what.contains("layout = \"column\""), "{error}");
    let twelve = turned(
        "kind = 'pose'\nlayout = 'row'\nunit = 'mm'",
        &rows[..rows.len() - 8],
    )
    .unwrap();
    assert_eq!(log, twelve);
}

/// The board seen from the camera becomes the camera seen from the board.
#[test]
fn an_inverse_pose_is_turned_back() {
    let rows = "0 -1 0 1 1 0 0 2 0 0 1 3 0 0 0 1";
    let log = turned("kind = 'pose'\nlayout = 'row'\ninvert = true", rows).unwrap();
    // -Rᵀ p with p = (1, 2, 3): x to y
    close(
        &["x_m", "y_m", "z_m"].map(|part| column(&log, part)[0]),
        &[-2.0, 1.0, -3.0],
        1e-12,
    );
    close(&quaternion(&log), &[HALF, 0.0, 0.0, -HALF], 1e-12);
    let alone = turned(
        "kind = 'quaternion'\norder = 'wxyz'\ninvert = true",
        "1 0 0 0",
    )
    .unwrap_err();
    assert!(alone.what.contains("x_m"), "{alone}");
}

#[test]
fn what_is_no_rotation_is_refused_with_its_line() {
    for (rule, cells, word) in [
        (
            "kind = 'matrix'\nlayout = 'row'",
            "1 0 0 0 1 0 0 0 -1",
            "mirrors",
        ),
        (
            "kind = 'matrix'\nlayout = 'row'",
            "1 0 0 0 1 0 0 0 2",
            "no rotation",
        ),
        (
            "kind = 'matrix'\nlayout = 'row'",
            "1 0 0 0 1 0 0 0 nan",
            "empty",
        ),
        ("kind = 'quaternion'\norder = 'wxyz'", "1 1 0 0", "norm"),
    ] {
        let error = turned(rule, cells).unwrap_err();
        assert!(
            error.what.contains(word) && error.line == Some(1),
            "{error}"
        );
    }
    let missing = turned(
        "kind = 'matrix'\nlayout = 'row'",
        "nan nan nan nan nan nan nan nan nan",
    )
    .unwrap();
    assert!(quaternion(&missing)[0].is_nan());
}

/// The matrix of a quaternion (Diebel 2006, eq. 125), written out.
fn matrix([w, x, y, z]: [f64; 4]) -> [[f64; 3]; 3] {
    [
        [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
        ],
        [
            2.0 * (x * y + w * z),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - w * x),
        ],
        [
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            1.0 - 2.0 * (x * x + y * y),
        ],
    ]
}

fn product([w, x, y, z]: [f64; 4], [a, b, c, d]: [f64; 4]) -> [f64; 4] {
    [
        w * a - x * b - y * c - z * d,
        w * b + x * a + y * d - z * c,
        w * c - x * d + y * a + z * b,
        w * d + x * c - y * b + z * a,
    ]
}

const ORDERS: [&str; 12] = [
    "xyz", "xzy", "yxz", "yzx", "zxy", "zyx", "xyx", "xzx", "yxy", "yzy", "zxz", "zyz",
];

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(256) })]

    #[test]
    fn a_matrix_gives_back_its_quaternion(angles in prop::array::uniform3(-7.0_f64..7.0), order in prop::sample::select(&ORDERS[..])) {
        let turned = from_euler(angles, order, true);
        let again = from_matrix(matrix(turned)).unwrap();
        // at half a turn q and -q are the same
        let same: f64 = turned.iter().zip(again).map(|(a, b)| a * b).sum();
        prop_assert!(same.abs() > 1.0 - 1e-12, "{turned:?} {again:?}");
    }

    /// Turning about moved axes in one order is turning about fixed axes in the other.
    #[test]
    fn intrinsic_is_extrinsic_backwards(angles in prop::array::uniform3(-7.0_f64..7.0), order in prop::sample::select(&ORDERS[..])) {
        let backwards: String = order.chars().rev().collect();
        let [a, b, c] = angles;
        close(&from_euler(angles, order, true), &from_euler([c, b, a], &backwards, false), 1e-9);
    }

    /// Each angle alone is the turn about its axis, and the whole their product in the order of the letters.
    #[test]
    fn the_whole_is_the_product_of_its_turns(angles in prop::array::uniform3(-3.0_f64..3.0), order in prop::sample::select(&ORDERS[..])) {
        let single = |letter: char, angle: f64| from_rotation_vector(["xyz".find(letter)].map(|axis| std::array::from_fn(|own| if Some(own) == axis { angle } else { 0.0 }))[0]);
        let letters: Vec<char> = order.chars().collect();
        let turns: Vec<[f64; 4]> = letters.iter().zip(angles).map(|(letter, angle)| single(*letter, angle)).collect();
        let whole = product(product(turns[0], turns[1]), turns[2]);
        let found = from_euler(angles, order, true);
        let same: f64 = whole.iter().zip(found).map(|(a, b)| a * b).sum();
        prop_assert!(same.abs() > 1.0 - 1e-12);
    }

    #[test]
    fn the_inverse_of_the_inverse_is_the_pose(place in prop::array::uniform3(-2.0_f64..2.0), vector in prop::array::uniform3(-1.7_f64..1.7)) {
        let turned = from_rotation_vector(vector);
        let (back, back_turned) = inverse(place, turned);
        let (again, again_turned) = inverse(back, back_turned);
        close(&again, &place, 1e-12);
        close(&again_turned, &turned, 1e-12);
    }

    /// A matrix that was written with four digits is the rotation that it was.
    #[test]
    fn few_digits_do_not_matter(vector in prop::array::uniform3(-1.7_f64..1.7)) {
        let turned = from_rotation_vector(vector);
        let rounded = matrix(turned).map(|row| row.map(|element| (element * 1e4).round() / 1e4));
        let found = from_matrix(rounded).unwrap();
        let norm: f64 = found.iter().map(|part| part * part).sum();
        prop_assert!((norm - 1.0).abs() < 1e-12);
        close(&found, &turned, 2e-4);
    }
}
