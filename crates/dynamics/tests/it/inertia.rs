//! Conversions of inertias, and which of them are physical.

use haptical_dynamics::nalgebra::{Matrix3, Rotation3, Vector3};
use haptical_dynamics::{Inertia, Pose};
use proptest::prelude::*;

use crate::support::{gap, vector};

fn points(list: &[(f64, Vector3<f64>)]) -> Inertia {
    let mut sum = Inertia::default();
    for (mass_kg, place_m) in list {
        sum += Inertia::about_centre(*mass_kg, place_m, &Matrix3::zeros());
    }
    sum
}

fn clouds() -> impl Strategy<Value = Vec<(f64, Vector3<f64>)>> {
    prop::collection::vec((0.01..2.0_f64, vector(2.0)), 1..6)
}

proptest! {
    /// Point masses moved one by one, or all at once.
    #[test]
    fn a_body_is_seen_from_another_frame(cloud in clouds(), place in vector(3.0), turn in vector(3.0)) {
        let rotation = *Rotation3::new(turn).matrix();
        let pose = Pose { position_m: place, rotation };
        let moved: Vec<_> = cloud.iter().map(|(m, own)| (*m, place + rotation * own)).collect();
        let (found, expected) = (points(&cloud).seen_from(&pose), points(&moved));
        prop_assert!(gap(&found.parameters(), &expected.parameters()) < 1e-14);
    }

    #[test]
    fn ten_numbers_are_the_same_body(cloud in clouds()) {
        let body = points(&cloud);
        prop_assert_eq!(Inertia::from_parameters(body.parameters()), body);
        let centre_m = body.centre_of_mass_m().unwrap();
        let again = Inertia::about_centre(body.mass_kg, &centre_m, &body.about_centre_kgm2());
        prop_assert!(gap(&again.parameters(), &body.parameters()) < 1e-14);
    }

    /// One to five points, so all kinds of flat bodies too; a little more about one axis than the others have
    /// together is no body.
    #[test]
    fn masses_are_physical_and_broken_triangles_are_not(cloud in clouds(), turn in vector(3.0)) {
        let body = points(&cloud);
        prop_assert!(body.is_physical());
        let pseudo = body.pseudo_inertia();
        prop_assert!(pseudo.symmetric_eigenvalues().min() > -1e-13 * pseudo.trace());
        let frame = *Rotation3::new(turn).matrix();
        for excess in [1e-3, 1.0] {
            let moments = Vector3::new(0.1, 0.2, 0.3 + excess * 0.1);
            let moments = frame * Matrix3::from_diagonal(&moments) * frame.transpose();
            let centre_m = body.centre_of_mass_m().unwrap();
            let broken = Inertia::about_centre(body.mass_kg, &centre_m, &moments);
            prop_assert!(!broken.is_physical());
            prop_assert!(broken.pseudo_inertia().symmetric_eigenvalues().min() < 0.0);
        }
    }
}

/// The pseudo-inertia of a point is the square of its place, with a 1 behind it.
#[test]
fn the_pseudo_inertia_of_a_point() {
    let place_m = Vector3::new(0.2, -0.7, 0.4);
    let expected = place_m.push(1.0) * place_m.push(1.0).transpose() * 3.0;
    let found = points(&[(3.0, place_m)]).pseudo_inertia();
    assert!((found - expected).norm() < 1e-15, "{found}");
}

#[test]
fn bodies_without_mass_or_with_a_negative_one() {
    assert!(Inertia::default().is_physical());
    // the second moments about the centre of a point are rounding, of either sign
    for place_m in [1.730_525_176_529_095_2, 1e3 / 3.0, 1e-3 / 7.0] {
        assert!(points(&[(0.210_501_179_692_101_58, Vector3::y() * place_m)]).is_physical());
    }
    let mut body = Inertia::default();
    body.first_moment_kgm.x = 0.1;
    assert!(!body.is_physical());
    let whole = |mass_kg| Inertia {
        mass_kg,
        about_origin_kgm2: Matrix3::identity(),
        ..Inertia::default()
    };
    assert!(whole(1.0).is_physical());
    assert!(!whole(-1.0).is_physical());
    assert!(!whole(f64::NAN).is_physical());
    assert!(!whole(f64::INFINITY).is_physical());
    // the centre is too far out for the moments about the origin
    let mut far = whole(1.0);
    far.first_moment_kgm.x = 1.1;
    assert!(!far.is_physical());
}
