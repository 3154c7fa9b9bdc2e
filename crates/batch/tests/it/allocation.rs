//! A pass asks the allocator for nothing once its room is there.

use haptical_kinematics::{Convention, Motion};

use crate::support::random_case;

#[test]
fn a_pass_allocates_nothing() {
    let mut motions = vec![Motion::Revolute; 8];
    motions[0] = Motion::Fixed;
    let case = random_case(Convention::Standard, &motions, 5000, 3);
    let (model, poses) = (case.model(), case.batch());
    let (start, free): (Vec<f64>, Vec<usize>) = (model.start(), (0..32).collect());
    let pass = || {
        let mut sum = 0.0;
        let visited = poses.visit(&model, &start, &free, |tile| {
            sum += tile.derivatives().flatten().sum::<f64>();
        });
        visited.map(|()| sum).unwrap()
    };
    let first = pass();
    let mut second = 0.0;
    let counted = allocation_counter::measure(|| second = pass());
    assert_eq!(first.to_bits(), second.to_bits());
    assert_eq!(counted.count_total, 0, "{counted:?}");
}

#[test]
fn a_visitor_may_ask_for_another_pass() {
    let motions = [Motion::Fixed, Motion::Revolute, Motion::Revolute];
    let case = random_case(Convention::Modified, &motions, 600, 3);
    let (model, poses) = (case.model(), case.batch());
    let start = model.start();
    let (mut outer, mut inner, mut firsts) = (Vec::new(), Vec::new(), Vec::new());
    let visited = poses.visit(&model, &start, &[0, 5], |tile| {
        firsts.push(tile.first_pose());
        assert_eq!(tile.derivatives().count(), 2);
        inner.clear();
        let again = poses.visit(&model, &start, &[1], |tile| inner.extend(tile.residuals()));
        again.unwrap();
        outer.extend_from_slice(tile.residuals());
    });
    visited.unwrap();
    assert_eq!(firsts, [0, 256, 512]);
    assert_eq!(outer, inner);
}
