//! What is refused, and in which words.

use haptical_batch::{BatchError, DistanceModel, PoseBatch};
use haptical_kinematics::{Convention, Link, Motion, Parameter};

const ARM: [Motion; 2] = [Motion::Revolute; 2];

fn arm() -> DistanceModel {
    let links = [Link {
        a_m: 0.3,
        ..Link::default()
    }; 2];
    DistanceModel::new(Convention::Standard, &links, &ARM, [0.0; 3]).unwrap()
}

fn batch(joints: &[Vec<f64>], distances: &[f64], weights: &[f64]) -> Result<PoseBatch, BatchError> {
    PoseBatch::new(&ARM, joints, distances, weights)
}

#[test]
fn a_batch_names_the_number() {
    let joints = vec![vec![0.1, 0.2], vec![0.3, f64::NAN]];
    let said = batch(&joints, &[1.0; 2], &[1.0; 2])
        .unwrap_err()
        .to_string();
    assert!(said.contains("a joint variable of pose 1 is NaN"), "{said}");
    let joints = vec![vec![0.1, 0.2]; 2];
    let said = |distances: &[f64], weights: &[f64]| {
        batch(&joints, distances, weights).unwrap_err().to_string()
    };
    assert!(said(&[1.0, f64::INFINITY], &[1.0; 2]).contains("the distance of pose 1 is inf"));
    assert!(said(&[1.0; 2], &[-0.5, 1.0]).contains("the weight of pose 0 is -0.5"));
    assert!(said(&[1.0; 2], &[1.0]).contains("weights: 1 entries; 2 are needed"));
    assert!(said(&[1.0; 3], &[1.0; 3]).contains("a joint's variables: 2 entries; 3 are needed"));
    assert_eq!(batch(&joints, &[], &[]).unwrap_err(), BatchError::NoPose);
    let one = batch(&joints[..1], &[1.0; 2], &[1.0; 2])
        .unwrap_err()
        .to_string();
    assert!(
        one.contains("joint variables' slices: 1 entries; 2 are needed"),
        "{one}"
    );
}

#[test]
fn a_model_names_the_parameter() {
    let twice = [(0, Parameter::A), (0, Parameter::A)];
    for parameters in [&twice[..], &[(2, Parameter::D)]] {
        let error = arm().with_parameters(parameters).unwrap_err();
        assert!(
            matches!(error, BatchError::Parameter { rows: 2, .. }),
            "{error}"
        );
    }
    let anchor = DistanceModel::new(
        Convention::Standard,
        &[Link::default()],
        &[Motion::Fixed],
        [0.0, f64::NAN, 0.0],
    );
    assert!(matches!(anchor.unwrap_err(), BatchError::Anchor { .. }));
    let link = Link {
        d_m: f64::INFINITY,
        ..Link::default()
    };
    let chain = DistanceModel::new(Convention::Standard, &[link], &[Motion::Fixed], [0.0; 3]);
    assert!(matches!(chain.unwrap_err(), BatchError::Chain(_)));
}

#[test]
fn a_pass_names_the_pose() {
    // folded back on itself, the arm ends at its shoulder
    let mut joints = vec![vec![0.2; 300], vec![1.0; 300]];
    let pi = std::f64::consts::PI;
    joints[1][131] = pi;
    let model = arm();
    let visit = |joints: &[Vec<f64>], at: &[f64]| {
        let poses = batch(joints, &[0.5; 300], &[1.0; 300]).unwrap();
        let mut cost = 0.0;
        let add = |residuals: &[f64]| residuals.iter().map(|r| r * r).sum::<f64>();
        let visited = poses.visit(&model, at, &[0, 4], |tile| cost += add(tile.residuals()));
        visited.map(|()| cost)
    };
    let start = model.start();
    // cos(pi) is -1 to the last bit, sin(pi) is 1e-16: a distance of 4e-17 m is not zero
    assert!(visit(&joints, &start).unwrap().is_finite());
    let straight = [0.3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    joints[1][131] = 1.0;
    let mut at = straight;
    at[0] = 0.0;
    assert_eq!(
        visit(&joints, &at).unwrap_err(),
        BatchError::ZeroDistance { pose: 0 }
    );
    at[0] = 1e200;
    assert_eq!(
        visit(&joints, &at).unwrap_err(),
        BatchError::OutOfRange { pose: 0 }
    );
    at[0] = f64::NAN;
    assert_eq!(
        visit(&joints, &at).unwrap_err(),
        BatchError::OutOfRange { pose: 0 }
    );
    assert!(matches!(
        visit(&joints, &at[..3]).unwrap_err(),
        BatchError::Length { .. }
    ));
}

#[test]
fn a_batch_of_another_chain_is_refused() {
    let joints = vec![vec![0.1, 0.2], vec![0.3, 0.9]];
    let motions = [Motion::Prismatic; 2];
    let other = PoseBatch::new(&motions, &joints, &[0.5; 2], &[1.0; 2]).unwrap();
    let model = arm();
    let own = batch(&joints, &[0.5; 2], &[1.0; 2]).unwrap();
    let start = model.start();
    for (poses, parameters, free) in [
        (&other, &start[..], 0),
        (&own, &start[1..], 0),
        (&own, &start[..], 9),
    ] {
        let refused = poses
            .visit(&model, parameters, &[free], |_| ())
            .unwrap_err();
        assert!(matches!(refused, BatchError::Length { .. }), "{refused}");
    }
}
