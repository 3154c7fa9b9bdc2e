//! Rotations in the ways that programs write them, as unit quaternions w, x, y, z with `w >= 0`.
//!
//! Laws: Diebel, "Representing Attitude: Euler Angles, Unit Quaternions, and Rotation Vectors" (2006), eq. (116), (125), (209),
//! (219). A rotation turns vectors of the moved frame into those of the fixed one (active, as `R v`).

use nalgebra::{Matrix3, Rotation3, Unit, UnitQuaternion, Vector3};

/// How far a matrix may be from a rotation, element by element of `R Rᵀ - I`: three digits after the point are enough.
pub const LARGEST_SKEW: f64 = 5e-3;

/// The axis of a letter of an order such as `zyx`.
fn axis(letter: char) -> Option<Unit<Vector3<f64>>> {
    match letter {
        'x' => Some(Vector3::x_axis()),
        'y' => Some(Vector3::y_axis()),
        'z' => Some(Vector3::z_axis()),
        _ => None,
    }
}

/// Whether a word is an order of Euler angles: three axes, none twice in a row.
pub fn is_order(order: &str) -> bool {
    let letters: Vec<char> = order.chars().collect();
    letters.len() == 3
        && letters.iter().all(|letter| axis(*letter).is_some())
        && letters[0] != letters[1]
        && letters[1] != letters[2]
}

/// The quaternion of Euler angles \[rad\], in the order in which the axes are named. Intrinsic: each turn is about an axis of the
/// frame that the turns before have moved, `R = R_1 R_2 R_3`. Extrinsic: about the fixed axes, `R = R_3 R_2 R_1`.
///
/// ```
/// use haptical_tables::rotation::{from_euler, from_matrix};
///
/// let quarter = std::f64::consts::FRAC_PI_2;
/// // about z, then about the new x: x to y, y to z
/// let turned = from_euler([quarter, quarter, 0.0], "zxz", true);
/// let same = from_matrix([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])?;
/// assert!(turned.iter().zip(same).all(|(a, b)| (a - b).abs() < 1e-12));
/// # Ok::<(), String>(())
/// ```
pub fn from_euler(angles_rad: [f64; 3], order: &str, is_intrinsic: bool) -> [f64; 4] {
    let turns = order.chars().zip(angles_rad);
    let turns = turns.filter_map(|(letter, angle)| Some((axis(letter)?, angle)));
    let turns = turns.map(|(axis, angle)| UnitQuaternion::from_axis_angle(&axis, angle));
    let whole = turns.fold(
        UnitQuaternion::identity(),
        |whole, turn| match is_intrinsic {
            true => whole * turn,
            false => turn * whole,
        },
    );
    parts(&whole)
}

/// The quaternion of a rotation vector: the axis times the angle \[rad\].
pub fn from_rotation_vector(vector_rad: [f64; 3]) -> [f64; 4] {
    parts(&UnitQuaternion::from_scaled_axis(Vector3::from(vector_rad)))
}

/// The quaternion of a rotation matrix, row by row.
///
/// # Errors
/// In words: the matrix is no rotation within [`LARGEST_SKEW`], or it mirrors.
pub fn from_matrix(rows: [[f64; 3]; 3]) -> Result<[f64; 4], String> {
    let matrix = Matrix3::from_fn(|row, column| rows[row][column]);
    let skew = (matrix * matrix.transpose() - Matrix3::identity())
        .abs()
        .max();
    if skew.is_nan() || skew > LARGEST_SKEW {
        return Err(format!(
            "the matrix is no rotation: its rows are {skew:.2e} away from being perpendicular and of length 1"
        ));
    }
    if matrix.determinant() < 0.0 {
        return Err("the matrix mirrors, so it is no rotation".to_owned());
    }
    // the nearest rotation (Higham, Functions of Matrices, 2008, theorem 8.4) by Newton's iteration, eq. (8.17)
    let mut nearest = matrix;
    for _ in 0..8 {
        let Some(inverse) = nearest.try_inverse() else {
            break;
        };
        nearest = (nearest + inverse.transpose()) * 0.5;
    }
    let rotation = Rotation3::from_matrix_unchecked(nearest);
    Ok(parts(&UnitQuaternion::from_rotation_matrix(&rotation)))
}

/// The pose of the first frame in the second, from that of the second in the first: position \[m\] and quaternion.
pub fn inverse(position_m: [f64; 3], wxyz: [f64; 4]) -> ([f64; 3], [f64; 4]) {
    let [w, x, y, z] = wxyz;
    let turn = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z)).inverse();
    let position = -(turn * Vector3::from(position_m));
    (position.into(), parts(&turn))
}

fn parts(turn: &UnitQuaternion<f64>) -> [f64; 4] {
    let sign = if turn.w < 0.0 { -1.0 } else { 1.0 };
    [turn.w, turn.i, turn.j, turn.k].map(|part| sign * part)
}
