//! A whole plan: its parts agree with the steps taken one by one, and what makes no sense is refused.

use std::cell::RefCell;

use haptical_design::{
    Criterion, DesignError, Information, Limits, Plan, Posture, Request, Rig, Search, Step, Terms,
    described_rigs, driving_order, plan, postures, select,
};
use haptical_model::Device;

use crate::support::{arm, rig};

fn request(rigs: &[&str]) -> Request {
    Request {
        rigs: rigs.iter().map(|text| Rig::parse(text).unwrap()).collect(),
        terms: Terms::Known,
        candidates: 150,
        seed: 5,
        poses: 30,
        chooses: true,
        ..Request::default()
    }
}

#[test]
fn it_is_the_steps_one_by_one() {
    let mut device = arm();
    // an exact drum adds nothing to what the steps say
    device.cables[0].scale_sd = Some(0.0);
    let steps = RefCell::new(Vec::new());
    let step = |step: Step<'_>| steps.borrow_mut().push(format!("{step:?}"));
    let found = plan(&device, &request(&["cable", "pose"]), &[], &step).unwrap();

    let mut equipped = rig(&device, "cable", Terms::Known);
    let candidates = postures(&mut equipped, &Limits::default(), 150, 5).unwrap();
    let information = Information::new(&equipped, &candidates, &[]).unwrap();
    let judged = information.judge(30).unwrap();
    let settings = Search {
        seed: 5,
        ..Search::default()
    };
    let best = select(&information, &judged, 30, Criterion::D, &[], &settings).unwrap();
    let chosen: Vec<&Posture> = best.chosen.iter().map(|&pose| &candidates[pose]).collect();
    let readings: Vec<Vec<f64>> = chosen.iter().map(|pose| pose.readings.clone()).collect();
    let order = driving_order(&readings);

    let next = found.next_poses.unwrap();
    let driven: Vec<Posture> = order.iter().map(|&pose| chosen[pose].clone()).collect();
    assert_eq!(next.postures, driven);
    let deviations = next.parameters.iter().map(|next| next.standard_deviation);
    assert_eq!(deviations.collect::<Vec<_>>(), best.deviations);
    assert_eq!(found.rigs.len(), 2);
    assert_eq!(found.rigs[0].rank, judged.rank);
    for (index, found) in found.rigs[0].parameters.iter().enumerate() {
        assert_eq!(found.name, judged.names[index]);
        assert_eq!(found.status, judged.statuses[index]);
        assert_eq!(found.reason, judged.reason(index));
    }
    let expected = [
        "Rig(\"cable\")",
        "Choosing { poses: 30, candidates: 150 }",
        "Rig(\"pose\")",
    ];
    assert_eq!(steps.into_inner(), expected);
}

/// No number of poses makes a length better known than the drum that measures it: `identify` says so afterwards, the plan before.
#[test]
fn lengths_carry_the_scale_of_their_instrument() {
    let mut device = arm();
    let mut planned = |scale_sd: f64| {
        device.cables[0].scale_sd = Some(scale_sd);
        plan(&device, &request(&["cable"]), &[], &|_| ()).unwrap()
    };
    let (exact, known) = (planned(0.0), planned(2e-3));
    assert_eq!(exact.rigs[0].length_scales, []);
    let scale = &known.rigs[0].length_scales[0];
    assert_eq!((scale.name.as_str(), scale.sd), ("cable_scale", 2e-3));
    let sd = |plan: &Plan, name: &str| {
        let mut entries = plan.rigs[0].parameters.iter();
        let entry = entries.find(|entry| entry.name == name).unwrap();
        entry.status.standard_deviation().unwrap()
    };
    // of the base's lengths some are held, and others make up for them
    for (name, length_m) in [("a2", 0.2), ("a3", 0.15)] {
        let added = (sd(&known, name).powi(2) - sd(&exact, name).powi(2)).sqrt();
        let expected = 2e-3 * length_m;
        assert!((added / expected - 1.0).abs() < 0.1, "{name}: {added}");
    }
    // so do the poses that it chooses
    let predicted = known.next_poses.unwrap().parameters;
    let a2 = predicted.iter().find(|entry| entry.name == "a2").unwrap();
    assert!(
        a2.standard_deviation > 0.9 * 2e-3 * 0.2,
        "{}",
        a2.standard_deviation
    );
}

#[test]
fn measured_poses_count_for_the_first_rig_alone() {
    let device = arm();
    let measured: Vec<Posture> = (0..40)
        .map(|row| f64::from(row) / 40.0)
        .map(|share| Posture::free(vec![share - 0.9, 0.8 - share, (share * 5.0).sin() * 0.8]))
        .collect();
    let asked = request(&["cable", "cable"]);
    let found = plan(&device, &asked, &measured, &|_| ()).unwrap();
    assert_eq!(found.measured_poses, 40);
    let deviation = |rig: usize, parameter: usize| {
        found.rigs[rig].parameters[parameter]
            .status
            .standard_deviation()
    };
    let mut told = 0;
    for parameter in 0..found.rigs[0].parameters.len() {
        if let Some((with, without)) = deviation(0, parameter).zip(deviation(1, parameter)) {
            assert!(with < without, "{with} {without}");
            told += 1;
        }
    }
    assert!(told > 5, "{told}");
}

#[test]
fn without_rigs_those_of_the_device_file_are_compared() {
    let device = arm();
    let asked = Request {
        chooses: false,
        ..request(&[])
    };
    let found = plan(&device, &asked, &[], &|_| ()).unwrap();
    let names: Vec<&str> = found.rigs.iter().map(|rig| rig.measure.as_str()).collect();
    assert_eq!(names, ["out,cable", "out,position", "out,pose"]);
    assert!(found.next_poses.is_none());
    let bare = Device::from_toml("[[joint]]\n", "bare.toml")
        .unwrap()
        .device;
    let refused = described_rigs(&bare).unwrap_err();
    assert!(matches!(refused, DesignError::Measure { .. }), "{refused}");
}

#[test]
fn what_makes_no_sense_is_refused() {
    let device = arm();
    let refusal = |request: &Request, measured: &[Posture]| {
        let refused = plan(&device, request, measured, &|_| ());
        refused.map(|_| ()).unwrap_err().to_string()
    };
    let none = Request {
        poses: 0,
        ..request(&["cable"])
    };
    assert_eq!(refusal(&none, &[]), "poses is 0: give 1 or more");
    let none = Request {
        candidates: 0,
        ..request(&["cable"])
    };
    assert_eq!(refusal(&none, &[]), "candidates is 0: give 1 or more");
    let touched = refusal(&request(&["contact:2:0.2"]), &[Posture::free(vec![0.1; 3])]);
    assert!(touched.contains("which touch a pose was at"), "{touched}");
}
