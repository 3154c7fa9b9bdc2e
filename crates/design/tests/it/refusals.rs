//! A plan that cannot be made is refused with a reason, never answered with numbers.

use haptical_design::{
    Criterion, DesignError, KINDS, Limits, Region, Rig, Search, Terms, candidates, equip, select,
    task_rows,
};
use proptest::prelude::*;

use crate::support::{arm, plan};

fn refusal(text: &str) -> String {
    let device = arm();
    let rig = Rig::parse(text);
    let refused = rig.and_then(|rig| equip(&device, &rig, Terms::Known));
    refused.map(|_| ()).unwrap_err().to_string()
}

#[test]
fn measurements_that_cannot_be_read_say_what_is_allowed() {
    for (text, said) in [
        ("cabel", "cableN:x,y,z"),
        ("", "there is no such kind"),
        ("cable2:0.1,0.2", "is not x,y,z"),
        ("cable2:0.1,0.2,nan", "is not x,y,z"),
        ("cable2:1e9,0,0", "not a length"),
        ("cable,cable", "there already"),
        ("cable2", "give its place"),
        ("cable3:0,0,1", "number them without a gap"),
        ("cable0:0,0,1", "from 1 to 64"),
        ("out9", "no joint 9"),
        ("position2", "takes no number"),
        ("position:known", "not known"),
        ("out1:3", "one too many"),
        ("contact:2:-1", "above 0"),
        ("plane:3", "is not 1 or 2"),
        ("cable99999999999999999999", "from 1 to 64"),
    ] {
        let refused = refusal(text);
        assert!(refused.contains(said), "{text}: {refused}");
    }
}

proptest! {
    #[test]
    fn no_text_of_a_rig_panics(text in "[a-z0-9,:.+\\-]{0,30}") {
        if let Ok(rig) = Rig::parse(&text) {
            let _ = equip(&arm(), &rig, Terms::Degree(3));
        }
    }

    #[test]
    fn no_text_near_a_kind_panics(
        kind in 0..KINDS.len(),
        tail in "[0-9]{0,3}(:[a-z0-9.,\\-]{0,8}){0,3}",
    ) {
        if let Ok(rig) = Rig::parse(&format!("{}{tail}", KINDS[kind].name)) {
            let _ = equip(&arm(), &rig, Terms::Degree(3));
        }
    }
}

#[test]
fn limits_that_nothing_satisfies_name_the_one_that_refuses_most() {
    let limits = Limits {
        cable_m: [5.0, 6.0],
        ..Limits::default()
    };
    let error = candidates(&arm(), &limits, 5, 1).unwrap_err();
    assert!(matches!(error, DesignError::NoCandidates { found: 0, .. }));
    assert!(error.to_string().contains("the cables' lengths"), "{error}");
    for cable_m in [[f64::NAN, 1.0], [0.5, 0.4], [-1.0, 1.0], [0.1, f64::NAN]] {
        let limits = Limits {
            cable_m,
            ..Limits::default()
        };
        let error = candidates(&arm(), &limits, 5, 1).unwrap_err();
        assert!(matches!(error, DesignError::Setting { .. }), "{error}");
    }
    let workspace_m = Some([[0.0, 0.1, 0.0], [1.0, f64::NAN, 1.0]]);
    let limits = Limits {
        workspace_m,
        ..Limits::default()
    };
    assert!(candidates(&arm(), &limits, 5, 1).is_err());
}

#[test]
fn a_prismatic_joint_needs_limits() {
    let mut device = arm();
    device.joints[1].joint_type = haptical_model::JointType::Prismatic;
    device.joints[1].upper_rad = f64::INFINITY;
    let error = candidates(&device, &Limits::default(), 5, 1).unwrap_err();
    assert!(error.to_string().contains("joint 2") && error.to_string().contains("lower_m"));
}

#[test]
fn too_few_poses_are_refused_with_a_number_that_does() {
    let (information, _) = plan(&arm(), "cable", Terms::Known, 300);
    let judged = information.judge(100).unwrap();
    let choose = |count| {
        select(
            &information,
            &judged,
            count,
            Criterion::D,
            &[],
            &Search::default(),
        )
    };
    let error = choose(judged.independent.len() - 1).unwrap_err();
    let DesignError::TooFewPoses {
        advised,
        parameters,
        ..
    } = error
    else {
        panic!("{error}");
    };
    assert_eq!(parameters, judged.independent.len());
    assert_eq!(choose(advised).unwrap().chosen.len(), advised);
    assert!(matches!(
        choose(0),
        Err(DesignError::TooFewCandidates { .. })
    ));
    assert!(matches!(
        choose(301),
        Err(DesignError::TooFewCandidates { .. })
    ));
}

#[test]
fn encoders_do_not_pay_for_links() {
    // three encoders and a cable: four readings a pose, but the links are seen by one of them
    let (information, _) = plan(&arm(), "out,cable", Terms::Degree(4), 300);
    let judged = information.judge(100).unwrap();
    let choose = |count| {
        select(
            &information,
            &judged,
            count,
            Criterion::D,
            &[],
            &Search::default(),
        )
    };
    let count = judged.independent.len() * 3 / 8;
    let DesignError::TooFewPoses { advised, .. } = choose(count).unwrap_err() else {
        panic!("{count} poses are not too few");
    };
    assert!(
        advised > count,
        "{advised} advised to who asked for {count}"
    );
    assert_eq!(choose(advised).unwrap().chosen.len(), advised);
}

#[test]
fn a_task_that_the_device_does_not_have_is_refused() {
    let (information, _) = plan(&arm(), "cable", Terms::Known, 50);
    let rows = |criterion, region: &Region| {
        let limits = Limits::default();
        task_rows(criterion, &information, &[0], (region, &limits), 1)
            .unwrap_err()
            .to_string()
    };
    assert!(rows(Criterion::TaskForce, &Region::Everywhere).contains("needs six joints"));
    let far = Region::Ball {
        centre_m: [9.0; 3],
        radius_m: 0.1,
    };
    assert!(rows(Criterion::TaskPosition, &far).contains("does not reach"));
    let odd = Region::Ball {
        centre_m: [0.0; 3],
        radius_m: f64::NAN,
    };
    assert!(rows(Criterion::TaskPosition, &odd).contains("radius is not above 0"));
    let few = Region::Joints(vec![[0.0, 0.1]; 2]);
    assert!(rows(Criterion::TaskPosition, &few).contains("2 joints"));
    let wide = Region::Joints(vec![[-3.0, 0.1]; 3]);
    assert!(rows(Criterion::TaskPosition, &wide).contains("joint 1"));
}
