//! What is said of effects whose columns are absent or constant.

use haptical_model::Recording;

use super::rig::{
    AnyEffect, Rig, SECOND_RUN_S, amplitudes, context, rigs, seven_joints, three_joints,
};
use super::{NOTHING, follows_a_slide, size};
use crate::context::Context;
use crate::{Family, Follows, catalogue};

/// Ways to spoil a recording, with what the reason must mention and which effects must be lost.
type Spoilt = (
    &'static str,
    fn(&mut Recording),
    &'static str,
    fn(&AnyEffect) -> bool,
);

const SPOILT: [Spoilt; 8] = [
    (
        "without time",
        |log| log.time_s = None,
        "t_s",
        |effect| {
            let parameters = effect.spec().parameters.iter();
            let in_time =
                |name: &str| ["time_s", "delay_s"].contains(&name) || name.ends_with("_per_s");
            parameters.clone().any(|spec| in_time(spec.name))
        },
    ),
    (
        "without temperature",
        |log| log.temperature_degc = None,
        "temp_degc",
        |effect| effect.spec().parameters[0].name.ends_with("_per_degc"),
    ),
    (
        "at constant temperature",
        |log| log.temperature_degc = Some(vec![22.3; log.len()]),
        "temp_degc is constant",
        |effect| effect.spec().parameters[0].name.ends_with("_per_degc"),
    ),
    (
        "under constant torques",
        |log| log.torque_nm = vec![Some(vec![0.7; log.len()]); log.joint.len()],
        "is constant",
        |effect| {
            [
                "capstan-compliance",
                "joint-compliance",
                "capstan-creep",
                "capstan-slip",
            ]
            .contains(&effect.name())
        },
    ),
    (
        "without force",
        |log| log.force_n = None,
        "fx_n",
        |effect| effect.name() == "tool-compliance",
    ),
    (
        "without external encoders",
        |log| log.output.iter_mut().for_each(|column| *column = None),
        "no column out",
        |effect| effect.name().starts_with("external-") || effect.name() == "capstan-compliance",
    ),
    (
        "without the first cable",
        |log| log.cable_m[0] = None,
        "cable_m",
        |effect| {
            let name = effect.name();
            // the pitch is that of a capstan's cable
            let is_of_first = name.starts_with("cable-") && name != "cable-pitch";
            is_of_first && effect.further_cable().is_none()
        },
    ),
    (
        "in one run",
        |log| {
            log.run = None;
            log.time_s = Some(steady(log.len()));
        },
        "run",
        |effect| effect.spec().follows == Follows::Run,
    ),
];

fn steady(rows: usize) -> Vec<f64> {
    // the instant of rig::typical lies within
    (0..rows)
        .map(|row| SECOND_RUN_S + 0.01 * row as f64)
        .collect()
}

#[test]
fn effects_without_their_column_are_untestable_and_it_is_said_why() {
    for Rig {
        name,
        device,
        recording,
    } in rigs()
    {
        for (how, spoil, reason, lost) in &SPOILT {
            let mut spoilt = recording.clone();
            spoil(&mut spoilt);
            if *how == "without the first cable" && name == "seven joints" {
                // the external encoders remain
                assert!(spoilt.output[0].is_some());
            }
            let context = context(&device, &spoilt);
            let effects = catalogue(&device);
            for effect in effects.iter().filter(|effect| lost(effect.as_ref())) {
                let why = effect.untestable(&context);
                let why =
                    why.unwrap_or_else(|| panic!("{name} {how}: {} is tested", effect.label()));
                let had = super::rig::context(&device, &recording);
                // what could not be tested before may be refused for that reason
                let before = effect.untestable(&had);
                assert!(
                    why.contains(reason) || before.is_some(),
                    "{name} {how}: {}: {why}",
                    effect.label()
                );
            }
        }
    }
}

#[test]
fn an_absent_torque_is_replaced_by_the_one_that_masses_and_hand_need() {
    for Rig {
        device, recording, ..
    } in rigs()
    {
        let mut spoilt = recording.clone();
        spoilt
            .torque_nm
            .iter_mut()
            .for_each(|column| *column = None);
        let with_masses = context(&device, &spoilt);
        let unloaded = Recording {
            force_n: None,
            ..spoilt.clone()
        };
        let mut bare = device.clone();
        bare.bodies.iter_mut().for_each(|body| *body = None);
        let without = context(&bare, &unloaded);
        for effect in catalogue(&device) {
            if effect.name() == "joint-compliance" {
                assert_eq!(effect.untestable(&with_masses), None, "{}", effect.label());
                let why = effect.untestable(&without).unwrap_or_default();
                let joint = effect.joint().unwrap();
                let column = device.joints[joint].torque_column(joint + 1);
                assert!(why.contains(&column), "{}: {why}", effect.label());
            }
        }
    }
}

/// What is left after something was taken away is either refused or felt.
fn assert_refused_or_felt(how: &str, context: &Context<'_>) {
    for effect in catalogue(context.device) {
        if effect.untestable(context).is_some() || follows_a_slide(effect.as_ref(), context) {
            continue;
        }
        let (amplitudes, shape) = amplitudes(effect.as_ref(), context);
        let felt = size(&effect.signal(context, &amplitudes, shape));
        assert!(
            felt > NOTHING,
            "{how}: {} is tested and adds {felt:e}",
            effect.label()
        );
    }
}

#[test]
fn whatever_column_is_absent_a_tested_effect_is_felt() {
    for Rig {
        device, recording, ..
    } in rigs()
    {
        for (how, spoil, ..) in &SPOILT {
            let mut spoilt = recording.clone();
            spoil(&mut spoilt);
            assert_refused_or_felt(how, &context(&device, &spoilt));
        }
    }
}

#[test]
fn a_joint_that_rests_has_no_effect_of_motion() {
    const RESTING: usize = 1;
    for Rig {
        name,
        device,
        mut recording,
    } in rigs()
    {
        let reading = recording.joint[RESTING][0];
        // one count to and fro
        for (row, at) in recording.joint[RESTING].iter_mut().enumerate() {
            *at = reading + if row % 3 == 0 { 3e-5 } else { 0.0 };
        }
        let context = context(&device, &recording);
        let mut refused = 0;
        for effect in catalogue(&device) {
            let of_motion = matches!(effect.spec().family, Family::Loop | Family::Lag);
            let why = effect.untestable(&context).unwrap_or_default();
            let says_rest = why == "joint 2 does not move";
            let wanted = of_motion && effect.joint() == Some(RESTING);
            assert!(wanted || !says_rest, "{name}: {}: {why}", effect.label());
            assert!(
                !wanted || !why.is_empty(),
                "{name}: {} is tested",
                effect.label()
            );
            refused += usize::from(says_rest);
        }
        assert!(refused >= 2, "{name}: {refused}");
    }
}

#[test]
fn effects_of_a_joint_that_nothing_shows_are_refused() {
    let Rig {
        device,
        mut recording,
        ..
    } = seven_joints();
    recording.cable_m[0] = None;
    let context = context(&device, &recording);
    for effect in catalogue(&device) {
        let Some(joint) = effect.joint().filter(|joint| *joint >= 4) else {
            continue;
        };
        // external encoders sit on joints 1 to 4 alone
        let why = effect.untestable(&context).unwrap_or_default();
        let column = format!("no column out{}_rad", joint + 1);
        let chain = "no distance, position or orientation";
        let said = [column.as_str(), chain, "encoder_counts_per_rev"];
        assert!(
            said.iter().any(|words| why.contains(words)),
            "{}: `{why}`",
            effect.label()
        );
    }
}

#[test]
fn single_postures_test_nothing_that_remembers_the_motion() {
    let Rig {
        device, recording, ..
    } = seven_joints();
    // rows far apart, in an order that is no motion
    let rows: Vec<usize> = (0..recording.len())
        .map(|row| row * 97 % recording.len())
        .collect();
    let mut shuffled = recording.select(&rows);
    (shuffled.time_s, shuffled.run) = (None, None);
    let context = context(&device, &shuffled);
    assert!(!context.ordered);
    for effect in catalogue(&device) {
        if [
            "external-encoder-windup",
            "cable-hysteresis",
            "capstan-creep",
        ]
        .contains(&effect.name())
            && effect.joint().is_none_or(|joint| joint < 4)
        {
            let why = effect.untestable(&context).unwrap_or_default();
            assert!(why.contains("not a motion"), "{}: {why}", effect.label());
        }
    }
}

#[test]
fn a_constant_force_tests_no_handle() {
    for Rig {
        device,
        mut recording,
        ..
    } in rigs()
    {
        recording.force_n = Some([1.0, 2.0, -0.5].map(|axis| vec![axis; recording.len()]));
        let context = context(&device, &recording);
        for effect in catalogue(&device) {
            if effect.name() == "tool-compliance" {
                // a constant shift in the handle's frame is that of another handle
                let why = effect.untestable(&context).unwrap_or_default();
                assert!(why.contains("force is constant"), "{why}");
            }
        }
    }
}

#[test]
fn a_reason_names_the_column_of_a_sliding_joint() {
    let Rig {
        device,
        mut recording,
        ..
    } = three_joints();
    recording.output[1] = None;
    let context = context(&device, &recording);
    for effect in catalogue(&device) {
        if effect.joint() == Some(1)
            && let Some(why) = effect.untestable(&context)
        {
            assert!(why.contains("out2_m"), "{}: {why}", effect.label());
        }
    }
}
