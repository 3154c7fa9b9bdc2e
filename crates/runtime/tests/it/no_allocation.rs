//! A step and its torques ask the allocator for nothing.

use std::hint::black_box;

use crate::exported::{identified, parallelogram};
use crate::exported_effects::{every_effect, inputs};

#[test]
fn a_step_allocates_nothing_whether_it_answers_or_refuses() {
    let readings = [0.3, -0.2, 0.4, -0.5, 0.6, -0.7, 0.8];
    for model in [&identified::MODEL, &parallelogram::MODEL] {
        let mut torques_nm = None;
        let counted = allocation_counter::measure(|| {
            let state = model.step(black_box(&readings));
            torques_nm = state.ok().map(|state| {
                state.reading_torques_nm(black_box([1.0, 2.0, 3.0]), black_box([0.0; 3]))
            });
            let refused = model.step(black_box(&[f64::NAN; 7]));
            assert!(black_box(refused).is_err());
        });
        assert!(torques_nm.unwrap().is_ok());
        assert_eq!(counted.count_total, 0, "{counted:?}");
    }
}

#[test]
fn effects_allocate_nothing_forward_and_back() {
    let model = &every_effect::COMPENSATED;
    let mut state = model.start();
    let now = inputs::<3>(7);
    let counted = allocation_counter::measure(|| {
        let before = state;
        let there = model.forward(black_box(&now), &mut state).unwrap();
        let torques = there.drive_torques_nm(black_box([1.0, 2.0, 3.0]), [0.0; 3]);
        let back = model.inverse(black_box(&there.state.outputs), &now, &before);
        let pose = model.inverse_pose(black_box(&there.state.pose), &now, &before);
        assert!(black_box((torques, back, pose)).0.is_ok());
    });
    assert_eq!(counted.count_total, 0, "{counted:?}");
}

#[test]
fn the_counter_counts() {
    let counted = allocation_counter::measure(|| drop(black_box(vec![1.0_f64; 8])));
    assert_eq!(counted.count_total, 1);
}
