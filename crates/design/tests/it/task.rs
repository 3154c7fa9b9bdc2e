//! Criteria of a task: against Monte-Carlo over the parameters' covariance.

use haptical_design::{Criterion, Limits, Region, Search, Terms, select, task_rows};
use haptical_model::{DeviceChain, Evaluation, ForceTransmission, handle_force_n};
use haptical_testkit::haptic7;

use crate::support::plan;

#[test]
fn a_row_of_the_position_is_the_move_of_the_handle() {
    let (information, _) = plan(&haptic7(), "cable", Terms::Known, 30);
    let at = vec![0.2, -0.1, 0.1, 0.05, 0.3, -0.2, 0.1];
    let region = Region::Joints(at.iter().map(|reading| [*reading; 2]).collect());
    let limits = Limits::default();
    let rows = task_rows(
        Criterion::TaskPosition,
        &information,
        &[0],
        (&region, &limits),
        1,
    )
    .unwrap();
    // 60 times the same posture: the mean square is that of one
    for (index, parameter) in information.equipped.parameters.iter().enumerate() {
        let handle = |sign: f64| {
            let mut device = information.equipped.device.clone();
            let value = parameter.value(&device);
            parameter.set(&mut device, value + sign * 1e-6);
            DeviceChain::new(&device).pose(&at).unwrap().position_m
        };
        let moved = (handle(1.0) - handle(-1.0)) / 2e-6;
        let square: f64 = rows.iter().map(|row| row[index].powi(2)).sum();
        assert!(
            (square - moved.norm_squared()).abs() < 1e-6,
            "{parameter:?}"
        );
    }
}

#[test]
fn a_row_of_the_force_is_the_turn_of_a_unit_force() {
    let (information, _) = plan(&haptic7(), "cable", Terms::Known, 30);
    let at = vec![0.2, -0.1, 0.0, 0.05, 0.3, -0.2, 0.1];
    let region = Region::Joints(at.iter().map(|reading| [*reading; 2]).collect());
    let limits = Limits::default();
    let rows = task_rows(
        Criterion::TaskForce,
        &information,
        &[0],
        (&region, &limits),
        1,
    )
    .unwrap();
    let free = [0, 1, 3, 4, 5, 6];
    let mut truth = Evaluation::new(&information.equipped.device);
    truth.move_to(&at).unwrap();
    for (index, parameter) in information.equipped.parameters.iter().enumerate() {
        let mut device = information.equipped.device.clone();
        let value = parameter.value(&device);
        parameter.set(&mut device, value + 1e-6);
        let mut controller = Evaluation::new(&device);
        controller.move_to(&at).unwrap();
        let known = ForceTransmission::new(&truth, &controller, free).unwrap();
        let force = handle_force_n(&known, &truth, &controller, 1.0, 0.0)
            .unwrap()
            .unwrap();
        let angle = (force.x.powi(2) + force.y.powi(2)).sqrt() / 1e-6;
        let square: f64 = rows.iter().map(|row| row[index].powi(2)).sum();
        assert!(
            (square.sqrt() - angle).abs() < 1e-3 * (1.0 + angle),
            "{parameter:?}"
        );
    }
}

#[test]
fn poses_for_a_region_are_better_there_than_poses_for_all_parameters() {
    let (information, _) = plan(&haptic7(), "cable", Terms::Known, 500);
    let judged = information.judge(50).unwrap();
    let region = Region::Ball {
        centre_m: [0.1, -0.1, 0.3],
        radius_m: 0.25,
    };
    let limits = Limits::default();
    let rows = |criterion| {
        task_rows(
            criterion,
            &information,
            &judged.independent,
            (&region, &limits),
            1,
        )
    };
    let Ok(position) = rows(Criterion::TaskPosition) else {
        panic!(
            "the region is not reached: {:?}",
            rows(Criterion::TaskPosition).err()
        );
    };
    let choose = |criterion, task: &[Vec<f64>]| {
        select(
            &information,
            &judged,
            50,
            criterion,
            task,
            &Search::default(),
        )
        .unwrap()
    };
    let for_task = choose(Criterion::TaskPosition, &position);
    let for_all = choose(Criterion::D, &[]);
    // the same figure of the other selection, through a search that may not move
    let fixed = Search {
        random_starts: 0,
        passes: 0,
        seed: 1,
    };
    let own = for_task.figures.root_mean_square.unwrap();
    assert!(own < for_task.random.unwrap().root_mean_square.unwrap());
    let sds = |chosen: &[usize]| information.deviations(chosen, &judged.independent).unwrap();
    assert_ne!(for_task.chosen, for_all.chosen);
    assert!(sds(&for_task.chosen).iter().all(|sd| sd.is_finite()));
    let greedy = select(
        &information,
        &judged,
        50,
        Criterion::TaskPosition,
        &position,
        &fixed,
    )
    .unwrap();
    assert!(own <= greedy.figures.root_mean_square.unwrap());
}
