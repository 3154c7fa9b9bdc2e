//! A pass asks the allocator for nothing once its room is there.

use haptical_batch::{DistanceProblem, ReducedDistance, Sines, Threads, Triangle};
use haptical_kinematics::{Convention, Motion};

use crate::support::random_case;

#[test]
fn a_pass_allocates_nothing() {
    let mut motions = vec![Motion::Revolute; 8];
    motions[0] = Motion::Fixed;
    let case = random_case(Convention::Standard, &motions, 5000, 3);
    for sines in [Sines::Cached, Sines::EachPass] {
        let (model, poses) = (case.model(), case.batch(sines));
        let problem = ReducedDistance::new(&model, &poses, Threads::One).unwrap();
        let (start, free): (Vec<f64>, Vec<usize>) = (model.start(), (0..32).collect());
        let pass = || problem.reduce(&start, &free, Triangle::cost).unwrap();
        let first = pass();
        let mut second = 0.0;
        let counted = allocation_counter::measure(|| second = pass());
        assert_eq!(first.to_bits(), second.to_bits());
        assert_eq!(counted.count_total, 0, "{counted:?}");
    }
}

#[test]
fn a_visitor_may_ask_for_another_pass() {
    let motions = [Motion::Fixed, Motion::Revolute, Motion::Revolute];
    let case = random_case(Convention::Modified, &motions, 600, 3);
    let (model, poses) = (case.model(), case.batch(Sines::Cached));
    let start = model.start();
    let rows = DistanceProblem::new(&model, &poses).unwrap();
    let reduced = ReducedDistance::new(&model, &poses, Threads::One).unwrap();
    let (mut sum, mut firsts) = (0.0, Vec::new());
    rows.visit(&start, &[0, 5], |tile| {
        firsts.push(tile.first_pose());
        assert_eq!(tile.derivatives().count(), 2);
        sum += tile.residuals().iter().map(|r| r * r).sum::<f64>();
        let inner = reduced.reduce(&start, &[0], |_| {
            reduced.reduce(&start, &[1], Triangle::cost)
        });
        assert!(inner.unwrap().is_ok());
        rows.visit(&start, &[1], |_| ()).unwrap();
    })
    .unwrap();
    assert_eq!(firsts[..2], [0, 256]);
    let cost = reduced.reduce(&start, &[0, 5], Triangle::cost).unwrap();
    assert!((sum / cost - 1.0).abs() < 1e-12);
}
