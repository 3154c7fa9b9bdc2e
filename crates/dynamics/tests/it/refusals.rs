//! What is not answered, and why.

use haptical_dynamics::nalgebra::{Matrix3, Unit, Vector3};
use haptical_dynamics::{Body, DynamicsError, Inertia, Joint, Pose, Scratch, Tree, Wrench};

fn body() -> Body {
    Body {
        parent: None,
        placement: Pose::default(),
        joint: Joint::Revolute(Vector3::z_axis()),
        inertia: Inertia::about_centre(1.0, &Vector3::x(), &Matrix3::identity()),
        armature_kgm2: 0.0,
    }
}

/// Why a tree whose second body was changed is refused.
fn refusal(change: impl Fn(&mut Body)) -> DynamicsError {
    let mut second = body();
    change(&mut second);
    Tree::new(&[body(), second], Vector3::zeros()).unwrap_err()
}

#[test]
fn bodies_that_are_none() {
    use DynamicsError as E;
    let none = Tree::new(&[], Vector3::zeros()).unwrap_err();
    assert_eq!(none, E::EmptyTree);
    for parent in [1, 7] {
        let error = refusal(|body| body.parent = Some(parent));
        assert_eq!(error, E::Parent { body: 1, parent });
    }
    let error = refusal(|body| body.placement.rotation *= 1.1);
    assert_eq!(error, E::Placement { body: 1 });
    let error = refusal(|body| body.placement.position_m.y = f64::NAN);
    assert_eq!(error, E::Placement { body: 1 });
    for length in [0.0, 1.01] {
        let axis = Unit::new_unchecked(Vector3::x() * length);
        let error = refusal(|body| body.joint = Joint::Prismatic(axis));
        assert_eq!(error, E::Axis { body: 1, length });
    }
    for mass_kg in [-1e-9, f64::INFINITY] {
        let error = refusal(|body| body.inertia.mass_kg = mass_kg);
        assert_eq!(error, E::Mass { body: 1, mass_kg });
    }
    let error = refusal(|body| body.inertia.first_moment_kgm.z = f64::NAN);
    assert!(matches!(error, E::Inertia { body: 1, .. }), "{error}");
    for value in [f64::NAN, 0.1] {
        let error = refusal(|body| body.inertia.about_origin_kgm2.m12 = value);
        assert!(matches!(error, E::Inertia { body: 1, .. }), "{error}");
    }
    let error = refusal(|body| body.armature_kgm2 = -0.1);
    let value = -0.1;
    assert_eq!(error, E::Armature { body: 1, value });
    let error = Tree::new(&[body()], Vector3::x() * f64::INFINITY).unwrap_err();
    assert!(matches!(error, E::NonFiniteVector { .. }), "{error}");
}

#[test]
fn vectors_that_do_not_fit() {
    use DynamicsError as E;
    let bodies = [body(), body()];
    let tree = Tree::new(&bodies, Vector3::zeros()).unwrap();
    let (mut scratch, mut out) = ([Scratch::default(); 2], [0.0; 2]);
    let (two, three) = ([0.0; 2], [0.0; 3]);
    let error = tree
        .inverse_dynamics(&two, &three, &two, &[], &mut scratch, &mut out)
        .unwrap_err();
    let (buffer, expected, got) = ("velocity", 2, 3);
    assert_eq!(
        error,
        E::Length {
            buffer,
            expected,
            got
        }
    );
    let error = tree
        .mass_matrix(&two, &mut scratch, &mut [0.0; 3])
        .unwrap_err();
    assert!(matches!(error, E::Length { expected: 4, .. }), "{error}");
    let error = tree
        .regressor(&two, &two, &two, &mut scratch, &mut [0.0; 20])
        .unwrap_err();
    assert!(matches!(error, E::Length { expected: 40, .. }), "{error}");
    let error = tree
        .bias_forces(&two, &two, &mut scratch[..1], &mut out)
        .unwrap_err();
    assert!(matches!(error, E::Length { got: 1, .. }), "{error}");
    let error = tree
        .forward_dynamics(&two, &two, &[0.0, f64::NAN], &[], &mut scratch, &mut out)
        .unwrap_err();
    assert!(
        matches!(
            error,
            E::NonFiniteJoint {
                quantity: "torque",
                joint: 1,
                ..
            }
        ),
        "{error}"
    );
    let wrench = Wrench {
        body: 2,
        point_m: Vector3::zeros(),
        force_n: Vector3::zeros(),
        moment_nm: Vector3::zeros(),
    };
    let error = tree
        .inverse_dynamics(&two, &two, &two, &[wrench], &mut scratch, &mut out)
        .unwrap_err();
    assert_eq!(error, E::WrenchBody { body: 2, bodies: 2 });
}

/// A joint that carries a point on its axis accelerates as it likes, whatever rounding says in one posture or another;
/// with the least rotor it does not.
#[test]
fn a_joint_that_moves_nothing() {
    let axis = Unit::new_normalize(Vector3::new(0.3, -0.5, 0.7));
    let turned = |armature_kgm2, count: f64| {
        let empty = Body {
            parent: Some(0),
            placement: Pose {
                position_m: Vector3::new(0.3, 0.1 * count, -0.4),
                ..Pose::default()
            },
            joint: Joint::Revolute(axis),
            inertia: Inertia::about_centre(2.0, &axis, &Matrix3::zeros()),
            armature_kgm2,
        };
        let bodies = [body(), empty];
        let tree = Tree::new(&bodies, Vector3::zeros()).unwrap();
        let (q, tau) = ([0.37 * count, 0.9], [0.0, 0.5]);
        let (mut scratch, mut out) = ([Scratch::default(); 2], [0.0; 2]);
        tree.forward_dynamics(&q, &[0.0; 2], &tau, &[], &mut scratch, &mut out)
            .map(|()| out[1])
    };
    for count in 0..30 {
        let count = f64::from(count);
        assert_eq!(
            turned(0.0, count),
            Err(DynamicsError::NoInertia { joint: 1 })
        );
        assert!((turned(1e-6, count).unwrap() - 0.5e6).abs() < 1.0);
    }
}

/// Numbers up to the limits are answered or refused, never answered with what is no number.
#[test]
fn numbers_too_large() {
    let mut heavy = body();
    heavy.inertia = Inertia::about_centre(1e50, &Vector3::zeros(), &Matrix3::identity());
    heavy.placement.position_m.x = 1e50;
    let mut far = heavy;
    far.parent = Some(0);
    let bodies = [heavy, far];
    let tree = Tree::new(&bodies, Vector3::zeros()).unwrap();
    let large = [1e50; 2];
    let mut out = [0.0; 2];
    let answer = tree.inverse_dynamics(
        &large,
        &large,
        &large,
        &[],
        &mut [Scratch::default(); 2],
        &mut out,
    );
    match answer {
        Ok(()) => assert!(out.iter().all(|value| value.is_finite())),
        Err(error) => assert!(matches!(error, DynamicsError::Overflow { .. }), "{error}"),
    }
}
