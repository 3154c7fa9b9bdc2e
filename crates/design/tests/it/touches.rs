//! Rigs with sockets, planes, fixtures and unknown trackers.

use haptical_design::{Information, Limits, Posture, Rig, Terms, equip, postures};
use haptical_model::{Device, DeviceChain};
use haptical_testkit::haptic7;

use crate::support::{arm, plan};

fn rank(device: &Device, text: &str) -> (usize, Vec<String>) {
    let (information, _) = plan(device, text, Terms::Known, 200);
    let judged = information.judge(200).unwrap();
    let link = |index: &&usize| {
        let parameter = information.equipped.parameters[**index];
        matches!(parameter, haptical_model::ParameterId::Link { .. })
    };
    let names = judged.independent.iter().filter(link);
    let names: Vec<String> = names.map(|&index| judged.names[index].clone()).collect();
    (names.len(), names)
}

#[test]
fn touching_poses_touch() {
    let device = haptic7();
    let rig = Rig::parse("contact:2:0.2,plane,cable").unwrap();
    let mut equipped = equip(&device, &rig, Terms::Known).unwrap();
    let found = postures(&mut equipped, &Limits::default(), 60, 2).unwrap();
    let chain = DeviceChain::new(&equipped.device);
    let places = &equipped.device.surroundings;
    let [a, b] = [0, 1].map(|index| places.contacts[index].position_m);
    let apart = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    assert!((apart - 0.2).abs() < 1e-12);
    for posture in &found {
        let handle: [f64; 3] = chain.pose(&posture.readings).unwrap().position_m.into();
        if posture.plane.is_empty() {
            let index = places.contact_index(&posture.contact).unwrap();
            let place = places.contacts[index].position_m;
            assert!((0..3).all(|k| (handle[k] - place[k]).abs() < 1e-8));
        } else {
            let plane = &places.planes[0];
            let along: f64 = (0..3).map(|k| plane.normal[k] * handle[k]).sum();
            assert!((along - plane.offset_m).abs() < 1e-8);
        }
        let ranges = posture.readings.iter().zip(&device.joints);
        for (reading, joint) in ranges {
            assert!((joint.lower_rad..=joint.upper_rad).contains(reading));
        }
    }
    let with = |id: &str| found.iter().filter(|posture| posture.contact == id).count();
    assert_eq!([with("socket1"), with("socket2"), with("")], [20, 20, 20]);
}

#[test]
fn two_sockets_may_be_nearer_to_each_other_than_any_two_poses() {
    let rig = Rig::parse("contact:2:0.001").unwrap();
    let mut equipped = equip(&haptic7(), &rig, Terms::Known).unwrap();
    postures(&mut equipped, &Limits::default(), 20, 3).unwrap();
    let places = &equipped.device.surroundings;
    let [a, b] = [0, 1].map(|index| places.contacts[index].position_m);
    let apart_m = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    assert!((apart_m - 1e-3).abs() < 1e-12, "{apart_m}");
}

#[test]
fn a_known_distance_gives_sockets_their_scale() {
    let device = haptic7();
    let (one, _) = rank(&device, "contact");
    let (two, _) = rank(&device, "contact:2");
    let (known, _) = rank(&device, "contact:2:0.2");
    assert!(two >= one);
    // without a length every length can grow together
    assert_eq!(known, two + 1);
    let (position, _) = rank(&device, "position");
    assert!(known < position);
}

#[test]
fn an_unknown_base_takes_six_numbers_of_the_base_row() {
    let device = arm();
    let (known, _) = rank(&device, "pose");
    let (unknown, names) = rank(&device, "pose:unknown-base");
    assert!(unknown < known, "{names:?}");
    // what is left of row 0 is what moves with joint 1: nothing of where frame (-1) is
    assert!(rank(&device, "pose:unknown").0 < unknown);
    assert!(rank(&device, "position:unknown-base").0 <= unknown);
}

#[test]
fn a_fixture_tells_offsets_that_nothing_else_does() {
    let device = haptic7();
    let (without, _) = rank(&device, "cable");
    let (with, names) = rank(&device, "cable,fixture");
    assert!(with > without, "{names:?}");
    assert!(names.contains(&"theta1".to_owned()), "{names:?}");
    // its readings are there whatever is chosen
    let (information, _) = plan(&device, "cable,fixture", Terms::Known, 20);
    assert_eq!(information.readings(None), 7);
    assert_eq!(information.readings(Some(3)), 1);
}

#[test]
fn a_cable_with_an_unknown_exit_tells_less_than_a_known_one() {
    let device = arm();
    let (information, poses) = plan(
        &device,
        "cable,cable2:0.5,0.2,0.1:unknown",
        Terms::Known,
        150,
    );
    let names = &information.judge(100).unwrap().names;
    assert!(names.contains(&"cable2_anchor_x".to_owned()), "{names:?}");
    let known = equip(
        &device,
        &Rig::parse("cable,cable2:0.5,0.2,0.1").unwrap(),
        Terms::Known,
    )
    .unwrap();
    let known = Information::new(&known, &poses, &[]).unwrap();
    let links = |information: &Information| {
        let judged = information.judge(100).unwrap();
        let is_link = |index: &&usize| !judged.names[**index].starts_with("cable");
        judged.independent.iter().filter(is_link).count()
    };
    assert!(links(&information) <= links(&known));
    assert_eq!(Posture::default().readings.len(), 0);
}
