//! Random chains, and the independent formulas with which the tests compare.

use haptical_kinematics::nalgebra::{Matrix3, Matrix4, Vector3};
use haptical_kinematics::{
    Chain, Convention, Link, LinkDerivatives, Motion, Parameter, Pose, Twist,
};
use proptest::prelude::*;

/// Cases per property.
pub(crate) const CASES: u32 = 64;

/// Two ways to the same number differ by rounding only: up to 50 elementary motions, lengths up to
/// 10 m, unit roundoff 1.1e-16; the bound leaves a factor of ten.
pub(crate) const ROUNDING: f64 = 1e-12;

/// A chain that owns its table, and a configuration.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) convention: Convention,
    pub(crate) links: Vec<Link>,
    pub(crate) motions: Vec<Motion>,
    pub(crate) joints: Vec<f64>,
    /// None, or one before each row and one behind the last.
    pub(crate) origins: Vec<Option<Pose>>,
}

impl Case {
    pub(crate) fn chain(&self) -> Chain<'_> {
        let (links, motions) = (&self.links, &self.motions);
        Chain::with_origins(self.convention, links, motions, &self.origins).unwrap()
    }

    pub(crate) fn pose(&self) -> Pose {
        self.chain().pose(&self.joints).unwrap()
    }

    pub(crate) fn derivatives(&self) -> Vec<LinkDerivatives> {
        let mut out = vec![LinkDerivatives::default(); self.links.len()];
        self.chain().derivatives(&self.joints, &mut out).unwrap();
        out
    }

    pub(crate) fn jacobian(&self) -> Vec<Twist> {
        let mut out = vec![Twist::default(); self.joints.len()];
        self.chain()
            .geometric_jacobian(&self.joints, &mut out)
            .unwrap();
        out
    }

    /// The same case with `step` added to one parameter of one row.
    pub(crate) fn moved(&self, row: usize, parameter: Parameter, step: f64) -> Self {
        let mut moved = self.clone();
        let value = moved.links[row].get(parameter);
        moved.links[row].set(parameter, value + step);
        moved
    }
}

pub(crate) fn convention() -> impl Strategy<Value = Convention> {
    prop_oneof![Just(Convention::Standard), Just(Convention::Modified)]
}

/// A row with angles over the full circle, lengths up to 0.5 m, and how it moves.
fn row() -> impl Strategy<Value = (Link, Motion, f64)> {
    let angle = || -3.2..3.2_f64;
    let length = || -0.5..0.5_f64;
    let motion = prop_oneof![1 => Just(Motion::Fixed), 3 => Just(Motion::Revolute), 2 => Just(Motion::Prismatic)];
    (
        length(),
        angle(),
        length(),
        angle(),
        angle(),
        prop_oneof![Just(0.0), length()],
        motion,
        -1.0..1.0_f64,
    )
        .prop_map(
            |(a_m, alpha_rad, d_m, theta_rad, beta_rad, b_m, motion, joint)| {
                (
                    Link {
                        a_m,
                        alpha_rad,
                        d_m,
                        theta_rad,
                        beta_rad,
                        b_m,
                    },
                    motion,
                    joint,
                )
            },
        )
}

/// As [`case`], without origins: laws of the table alone.
pub(crate) fn table(convention: impl Strategy<Value = Convention>) -> impl Strategy<Value = Case> {
    case(convention).prop_map(|case| Case {
        origins: Vec::new(),
        ..case
    })
}

/// Chains of 1 to 10 rows in the given convention, most of them with origins.
pub(crate) fn case(convention: impl Strategy<Value = Convention>) -> impl Strategy<Value = Case> {
    let rows = prop::collection::vec(row(), 1..=10);
    let cases = (convention, rows).prop_map(|(convention, rows)| Case {
        convention,
        links: rows.iter().map(|row| row.0).collect(),
        motions: rows.iter().map(|row| row.1).collect(),
        joints: rows
            .iter()
            .filter(|row| row.1 != Motion::Fixed)
            .map(|row| row.2)
            .collect(),
        origins: Vec::new(),
    });
    let origins = prop_oneof![
        1 => Just(Vec::new()),
        2 => prop::collection::vec(prop::option::of(origin()), 11),
    ];
    (cases, origins).prop_map(|(mut case, mut origins)| {
        origins.truncate(case.links.len() + 1);
        case.origins = origins;
        case
    })
}

/// A constant transform: up to 0.5 m along each axis, any turn.
fn origin() -> impl Strategy<Value = Pose> {
    let place = prop::array::uniform3(-0.5..0.5_f64);
    let turns = prop::array::uniform3(-3.2..3.2_f64);
    (place, turns).prop_map(|(place_m, [first, second, third])| Pose {
        position_m: Vector3::from(place_m),
        rotation: rotation_z(first) * rotation_x(second) * rotation_y(third),
    })
}

pub(crate) fn rotation_x(angle: f64) -> Matrix3<f64> {
    let (s, c) = angle.sin_cos();
    Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c)
}

pub(crate) fn rotation_y(angle: f64) -> Matrix3<f64> {
    let (s, c) = angle.sin_cos();
    Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c)
}

pub(crate) fn rotation_z(angle: f64) -> Matrix3<f64> {
    let (s, c) = angle.sin_cos();
    Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
}

fn turn(rotation: &Matrix3<f64>) -> Matrix4<f64> {
    rotation.to_homogeneous()
}

fn slide(x: f64, y: f64, z: f64) -> Matrix4<f64> {
    Matrix4::new_translation(&Vector3::new(x, y, z))
}

/// The pose as the product of 4x4 matrices, written as in the conventions' definitions.
pub(crate) fn homogeneous_product(case: &Case) -> Matrix4<f64> {
    let mut joints = case.joints.iter();
    let mut product = Matrix4::<f64>::identity();
    let origin = |row: usize| match case.origins.get(row) {
        Some(Some(origin)) => {
            let mut matrix = turn(&origin.rotation);
            matrix.set_column(3, &origin.position_m.push(1.0));
            matrix
        }
        _ => Matrix4::identity(),
    };
    for (row, (link, motion)) in case.links.iter().zip(&case.motions).enumerate() {
        product *= origin(row);
        let (mut theta, mut d) = (link.theta_rad, link.d_m);
        match motion {
            Motion::Fixed => {}
            Motion::Revolute => theta += joints.next().unwrap(),
            Motion::Prismatic => d += joints.next().unwrap(),
        }
        let [rz, rx, ry] = [
            rotation_z(theta),
            rotation_x(link.alpha_rad),
            rotation_y(link.beta_rad),
        ]
        .map(|rotation| turn(&rotation));
        product *= match case.convention {
            Convention::Standard => rz * slide(link.a_m, link.b_m, d) * rx * ry,
            Convention::Modified => {
                slide(link.a_m, link.b_m, 0.0) * rx * ry * rz * slide(0.0, 0.0, d)
            }
        };
    }
    product * origin(case.links.len())
}

/// Rotation vector of a rotation by less than a quarter turn: `sin(angle) axis` is the vector of
/// the antisymmetric part.
pub(crate) fn small_rotation_vector(rotation: &Matrix3<f64>) -> Vector3<f64> {
    let antisymmetric = (rotation - rotation.transpose()) / 2.0;
    let vector = Vector3::new(antisymmetric.m32, antisymmetric.m13, antisymmetric.m21);
    let sine = vector.norm();
    if sine == 0.0 {
        vector
    } else {
        vector * (sine.asin() / sine)
    }
}

/// Derivative of `function` at 0 by the five-point central difference.
pub(crate) fn five_point(step: f64, function: impl Fn(f64) -> Vector3<f64>) -> Vector3<f64> {
    let near = function(step) - function(-step);
    let far = function(2.0 * step) - function(-2.0 * step);
    (near * 8.0 - far) / (12.0 * step)
}

/// Largest absolute entry of a difference.
pub(crate) fn gap<'a>(
    left: impl IntoIterator<Item = &'a f64>,
    right: impl IntoIterator<Item = &'a f64>,
) -> f64 {
    // not f64::max alone, which would pass over a NaN
    left.into_iter()
        .zip(right)
        .map(|(l, r)| (l - r).abs())
        .fold(0.0, |worst, gap| {
            if gap.is_nan() {
                f64::INFINITY
            } else {
                worst.max(gap)
            }
        })
}

/// Largest absolute entry of the difference of two poses.
pub(crate) fn pose_gap(left: &Pose, right: &Pose) -> f64 {
    gap(&left.position_m, &right.position_m).max(gap(&left.rotation, &right.rotation))
}

/// Largest absolute entry of the difference of two twists.
pub(crate) fn twist_gap(left: &Twist, right: &Twist) -> f64 {
    gap(&left.linear, &right.linear).max(gap(&left.angular, &right.angular))
}
