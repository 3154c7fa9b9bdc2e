//! Tables of parameters and rigs: against Fisher's information by hand, and laws of every device.

use haptical_design::{Information, Terms, equip, suggestions};
use haptical_identification::Status;
use haptical_model::Evaluation;
use haptical_testkit::haptic7;
use proptest::prelude::*;

use crate::support::{arm, is_link, plan, rig};

#[test]
fn rows_are_differences_of_what_the_rig_reads() {
    // by central differences of the model's own predictions, over the stated standard deviations
    let device = arm();
    let (information, poses) = plan(
        &device,
        "out2,cable,cable2:0.5,0.2,0.1,pose",
        Terms::Degree(2),
        6,
    );
    let equipped = &information.equipped;
    let width = 1 + 2 + 6;
    for pose in 0..poses.len() {
        assert_eq!(information.readings(Some(pose)), width);
    }
    assert_eq!(information.readings(None), 0);
    let judged = information.judge(poses.len()).unwrap();
    // the information of one parameter alone is the sum of squares of its differences
    for (index, parameter) in equipped.parameters.iter().enumerate() {
        let size = 1e-6;
        let mut sum = 0.0;
        for posture in &poses {
            let read = |sign: f64| {
                let mut device = equipped.device.clone();
                let value = parameter.value(&device);
                parameter.set(&mut device, value + sign * size);
                let mut evaluation = Evaluation::new(&device);
                evaluation.move_to(&posture.readings).unwrap();
                let pose = *evaluation.pose().unwrap();
                let lengths: Vec<f64> = device
                    .cables
                    .iter()
                    .map(|cable| cable.reading(&pose.position_m).unwrap().reading_m)
                    .collect();
                (evaluation.output_rad(1), lengths, pose)
            };
            let (after, before) = (read(1.0), read(-1.0));
            let slope = |difference: f64| difference / (2.0 * size);
            sum += (slope(after.0 - before.0) / 1e-4).powi(2);
            for cable in 0..2 {
                sum += (slope(after.1[cable] - before.1[cable]) / 1e-5).powi(2);
            }
            // no [tracker] in the file: a tenth of a millimetre or milliradian
            let moved = after.2.position_m - before.2.position_m;
            sum += moved.norm_squared() / (2.0 * size * 1e-4).powi(2);
            let turned = after.2.rotation * before.2.rotation.transpose();
            let vector = [
                turned[(2, 1)] - turned[(1, 2)],
                turned[(0, 2)] - turned[(2, 0)],
                turned[(1, 0)] - turned[(0, 1)],
            ];
            let square: f64 = vector.iter().map(|v| (v / 2.0).powi(2)).sum();
            sum += square / (2.0 * size * 1e-4).powi(2);
        }
        let found = match information.deviations(&[0, 1, 2, 3, 4, 5], &[index]) {
            Ok(found) => found[0],
            Err(error) => panic!("{}: {error}", judged.names[index]),
        };
        let wanted = 1.0 / sum.sqrt();
        assert!(
            (found / wanted - 1.0).abs() < 1e-4,
            "{}",
            judged.names[index]
        );
    }
}

fn rank(information: &Information) -> usize {
    information.judge(200).unwrap().rank
}

#[test]
fn ranks_of_the_paper_s_device_are_the_known_ones() {
    let device = haptic7();
    let links = |text: &str| rank(&plan(&device, text, Terms::Known, 300).0);
    // one cable from frame (-1)'s origin: 28 of Table 3's candidates (xtask reproduce-tables)
    let cable = links("cable");
    // the handle's position adds the three rotations about that origin
    assert_eq!(links("position"), cable + 3);
    // orientation adds the last twist
    assert_eq!(links("pose"), cable + 4);
    // two places of a cable leave the rotation about the line through them
    assert_eq!(links("cable,cable2:0.5,0.1,0.3"), cable + 2);
    assert_eq!(
        links("cable,cable2:0.5,0.1,0.3,cable3:-0.2,0.4,0.3"),
        cable + 3
    );
}

#[test]
fn standard_deviations_fall_as_the_root_of_the_number_of_poses() {
    let (information, _) = plan(&arm(), "position", Terms::Known, 100);
    let (few, many) = (
        information.judge(50).unwrap(),
        information.judge(200).unwrap(),
    );
    for (few, many) in few.statuses.iter().zip(&many.statuses) {
        if let (
            Status::Identifiable {
                standard_deviation: few,
            },
            Status::Identifiable {
                standard_deviation: many,
            },
        ) = (few, many)
        {
            assert!((few / many - 2.0).abs() < 1e-9);
        }
    }
}

#[test]
fn measured_poses_count_as_if_they_were_chosen() {
    let device = arm();
    let equipped = rig(&device, "cable", Terms::Known);
    let (_, poses) = plan(&device, "cable", Terms::Known, 60);
    let (old, new) = poses.split_at(40);
    let together = Information::new(&equipped, &poses, &[]).unwrap();
    let added = Information::new(&equipped, new, old).unwrap();
    assert_eq!(added.readings(None), 40);
    let all: Vec<usize> = (0..60).collect();
    let columns = together.judge(60).unwrap().independent;
    let wanted = together.deviations(&all, &columns).unwrap();
    let found = added.deviations(&all[..20], &columns).unwrap();
    for (found, wanted) in found.iter().zip(&wanted) {
        assert!((found / wanted - 1.0).abs() < 1e-9);
    }
}

const FURTHER: [&str; 6] = [
    "out1",
    "cable2:0.5,0.2,0.1",
    "cable2:-0.1,0.3,0.4",
    "position",
    "pose",
    "out3",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]
    #[test]
    fn a_further_measurement_never_makes_anything_worse(
        base in 0..2_usize,
        more in 0..FURTHER.len(),
        lengths in proptest::collection::vec(0.05..0.4_f64, 8),
        twists in proptest::collection::vec(-1.4..1.4_f64, 4),
    ) {
        let mut device = arm();
        for (row, link) in device.links.iter_mut().enumerate() {
            (link.a_m, link.d_m, link.alpha_rad) = (lengths[row], lengths[row + 4], twists[row]);
        }
        let base = ["cable", "out2,cable"][base];
        let (before, poses) = plan(&device, base, Terms::Known, 80);
        let equipped = rig(&device, &format!("{base},{}", FURTHER[more]), Terms::Known);
        let after = Information::new(&equipped, &poses, &[]).unwrap();
        let (had, has) = (before.judge(80).unwrap(), after.judge(80).unwrap());
        prop_assert!(has.rank >= had.rank);
        // Loewner order: with the same parameters free no variance grows
        let all: Vec<usize> = (0..80).collect();
        let columns = had.independent.clone();
        let (sd, less) = (
            before.deviations(&all, &columns).unwrap(),
            after.deviations(&all, &columns).unwrap(),
        );
        for (sd, less) in sd.iter().zip(&less) {
            prop_assert!(*less <= sd * (1.0 + 1e-6));
        }
        // and what was told alone stays told: an identifiable parameter is in the row space
        for index in 0..had.names.len() {
            if matches!(had.statuses[index], Status::Identifiable { .. }) {
                prop_assert!(has.statuses[index].is_independent() || has.rank > had.rank);
            }
        }
    }
}

#[test]
fn what_one_cable_cannot_tell_a_second_one_or_a_tracker_does() {
    let device = haptic7();
    let (information, poses) = plan(&device, "cable", Terms::Known, 300);
    let judged = information.judge(200).unwrap();
    let equipped = &information.equipped;
    let found = suggestions(equipped, Terms::Known, &poses, &judged, 200).unwrap();
    let of = |name: &str| found.iter().find(|found| found.parameter == name).unwrap();
    // the twist of the last row turns the handle about itself: only an orientation shows it
    let last = of("alpha7");
    let measures: Vec<&str> = last
        .remedies
        .iter()
        .map(|remedy| remedy.measure.as_str())
        .collect();
    assert_eq!(measures, ["pose"], "{}", last.reason);
    // the base row's place in frame (-1) needs another origin than the cable's
    let base = of("theta0");
    assert!(
        base.remedies
            .iter()
            .any(|remedy| remedy.measure.starts_with("cable2:"))
    );
    assert!(
        base.remedies
            .iter()
            .any(|remedy| remedy.measure == "position")
    );
    // a remedy is what the analysis says of that rig
    let remedy = &base.remedies[0];
    let text = format!("cable,{}", remedy.measure);
    let equipped = equip(
        &device,
        &haptical_design::Rig::parse(&text).unwrap(),
        Terms::Known,
    )
    .unwrap();
    let information = Information::new(&equipped, &poses[..300], &[]).unwrap();
    let again = information.judge(200).unwrap();
    let place = again
        .names
        .iter()
        .position(|name| name == "theta0")
        .unwrap();
    let Status::Identifiable { standard_deviation } = again.statuses[place] else {
        panic!("{:?}", again.statuses[place]);
    };
    // the scales of both cables besides
    let fixed = |index: &usize| matches!(again.statuses[*index], Status::Identifiable { .. });
    let fixed: Vec<usize> = (0..again.names.len()).filter(fixed).collect();
    let all: Vec<usize> = (0..300).collect();
    let by_scale = information.deviations_by_scale(&all, &fixed).unwrap();
    let own = fixed.iter().position(|index| *index == place).unwrap();
    let expected = standard_deviation.hypot(by_scale[own]);
    assert!((expected / remedy.standard_deviation - 1.0).abs() < 1e-9);
}

#[test]
fn an_encoder_tells_a_transmission_from_the_links() {
    let device = haptic7();
    let (information, poses) = plan(&device, "cable", Terms::Degree(4), 300);
    let judged = information.judge(200).unwrap();
    let found = suggestions(
        &information.equipped,
        Terms::Degree(4),
        &poses,
        &judged,
        200,
    )
    .unwrap();
    let offset = found
        .iter()
        .find(|found| found.parameter == "offset2")
        .unwrap();
    assert!(
        offset
            .remedies
            .iter()
            .any(|remedy| remedy.measure == "out2"),
        "{offset:?}"
    );
    assert!(
        !offset
            .remedies
            .iter()
            .any(|remedy| remedy.measure == "out5"),
        "{offset:?}"
    );
    assert!(information.equipped.parameters.iter().copied().any(is_link));
}

#[test]
fn a_better_tracker_is_a_remedy() {
    let device = haptic7();
    let remedies = |rig: &str, parameter: &str| -> Vec<(String, Option<String>)> {
        let (information, poses) = plan(&device, rig, Terms::Known, 300);
        let judged = information.judge(200).unwrap();
        let equipped = &information.equipped;
        let found = suggestions(equipped, Terms::Known, &poses, &judged, 200).unwrap();
        let found = found.into_iter().find(|found| found.parameter == parameter);
        let remedies = found.unwrap().remedies.into_iter();
        remedies
            .map(|remedy| (remedy.measure, remedy.instead_of))
            .collect()
    };
    let instead = |new: &str, old: &str| (new.to_owned(), Some(old.to_owned()));
    assert_eq!(
        remedies("position", "alpha7"),
        [instead("pose", "position")]
    );
    let with_base = remedies("pose:unknown", "theta0");
    assert!(with_base.contains(&instead("pose:unknown-tool", "pose:unknown")));
    assert!(!with_base.contains(&instead("pose:unknown-base", "pose:unknown")));
    let with_tool = remedies("pose:unknown", "alpha7");
    assert!(with_tool.contains(&instead("pose:unknown-base", "pose:unknown")));
}
