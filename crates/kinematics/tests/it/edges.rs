//! Which row an answer that does not exist is put down to.

use haptical_kinematics::nalgebra::Vector3;
use haptical_kinematics::{Chain, Convention, KinematicsError, Link, Motion, Pose, PreparedChain};

fn displaced(x_m: f64) -> Option<Pose> {
    Some(Pose {
        position_m: Vector3::new(x_m, 0.0, 0.0),
        ..Pose::default()
    })
}

/// The end's own transform belongs to the last row; one before a row belongs to that row.
#[test]
fn a_transform_out_of_range_is_named_by_its_row() {
    let (links, motions) = ([Link::default(); 2], [Motion::Revolute; 2]);
    let far = 6e149;
    for (origins, expected) in [
        ([displaced(far), None, displaced(far)], 1),
        ([displaced(far), displaced(far), None], 1),
        ([None, displaced(far), displaced(far)], 1),
    ] {
        let chain = Chain::with_origins(Convention::Standard, &links, &motions, &origins).unwrap();
        for error in [
            chain.pose(&[0.0, 0.0]).unwrap_err(),
            PreparedChain::<2>::new(&chain).unwrap_err(),
        ] {
            assert!(
                matches!(error, KinematicsError::PositionOutOfRange { row, .. } if row == expected),
                "{error}"
            );
        }
    }
    let origins = [displaced(far), None, None];
    let chain = Chain::with_origins(Convention::Standard, &links, &motions, &origins).unwrap();
    assert!(chain.pose(&[0.0, 0.0]).is_ok());
}
