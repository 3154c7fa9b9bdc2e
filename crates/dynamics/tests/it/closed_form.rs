//! Textbook formulas, with numbers that no symmetry hides.

use haptical_dynamics::nalgebra::{Matrix3, Vector3};
use haptical_dynamics::{Body, Inertia, Joint, Pose};

use crate::support::{Robot, State, gap};

const G: f64 = 9.81;

/// The planar arm of two links: Siciliano et al. (2009), section 7.3.2, without motors. Links of masses m, centres at l
/// and inertias i about them, turning about z; gravity along -y.
#[test]
fn a_planar_arm_of_two_links() {
    let ([m1, m2], [l1, l2], [i1, i2], a1) = ([2.3, 1.1], [0.2, 0.15], [0.05, 0.02], 0.4);
    let link = |parent, x_m, mass_kg, centre_m, own| Body {
        parent,
        placement: Pose {
            position_m: Vector3::new(x_m, 0.0, 0.0),
            ..Pose::default()
        },
        joint: Joint::Revolute(Vector3::z_axis()),
        inertia: Inertia::about_centre(
            mass_kg,
            &Vector3::new(centre_m, 0.0, 0.0),
            &Matrix3::from_diagonal(&Vector3::new(0.9, 0.8, own)),
        ),
        armature_kgm2: 0.0,
    };
    let robot = Robot {
        bodies: vec![link(None, 0.0, m1, l1, i1), link(Some(0), a1, m2, l2, i2)],
        gravity_mps2: Vector3::new(0.0, -G, 0.0),
    };
    let state = State {
        q: vec![0.7, -1.2],
        dq: vec![1.3, -0.4],
        ddq: vec![2.0, -3.0],
    };
    let (c2, s2) = (state.q[1].cos(), state.q[1].sin());
    let b11 = i1 + m1 * l1 * l1 + i2 + m2 * (a1 * a1 + l2 * l2 + 2.0 * a1 * l2 * c2);
    let b12 = i2 + m2 * (l2 * l2 + a1 * l2 * c2);
    let b22 = i2 + m2 * l2 * l2;
    assert!(gap(&robot.mass(&state.q), &[b11, b12, b12, b22]) < 1e-15);
    let h = -m2 * a1 * l2 * s2;
    let (c1, c12) = (state.q[0].cos(), (state.q[0] + state.q[1]).cos());
    let (v1, v2) = (state.dq[0], state.dq[1]);
    let bias = [
        2.0 * h * v1 * v2 + h * v2 * v2 + (m1 * l1 + m2 * a1) * G * c1 + m2 * l2 * G * c12,
        -h * v1 * v1 + m2 * l2 * G * c12,
    ];
    assert!(gap(&robot.bias(&state), &bias) < 1e-15);
}

/// A mass that slides along a turning rail: tau = (I + m r^2) a + 2 m r r' w, f = m (r'' - r w^2).
#[test]
fn a_slide_on_a_turning_rail() {
    let (m, i, r) = (1.7, 0.3, 0.6);
    let body = |parent, joint, inertia| Body {
        parent,
        placement: Pose::default(),
        joint,
        inertia,
        armature_kgm2: 0.0,
    };
    let about_z = Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, i));
    let rail = Inertia::about_centre(0.4, &Vector3::zeros(), &about_z);
    let mass = Inertia::about_centre(m, &Vector3::zeros(), &Matrix3::zeros());
    let robot = Robot {
        bodies: vec![
            body(None, Joint::Revolute(Vector3::z_axis()), rail),
            body(Some(0), Joint::Prismatic(Vector3::x_axis()), mass),
        ],
        gravity_mps2: Vector3::new(0.0, 0.0, -G),
    };
    let (w, v, alpha, a) = (1.5, -0.8, 0.9, 0.35);
    let state = State {
        q: vec![0.3, r],
        dq: vec![w, v],
        ddq: vec![alpha, a],
    };
    let expected = [
        (i + m * r * r) * alpha + 2.0 * m * r * v * w,
        m * (a - r * w * w),
    ];
    assert!(gap(&robot.inverse(&state, &[]), &expected) < 1e-15);
}
