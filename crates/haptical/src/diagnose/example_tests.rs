//! Diagnoses made by hand, for tests of what is said of them.

use std::collections::BTreeMap;

use haptical_diagnosis::{
    Admission, CandidateAnswer, CauseAnswer, ChannelGap, Detectable, Diagnosis, FitRows, Gap,
    HeldOutAnswer, Invisible, NoReduction, NoiseAnswer, NoiseSource, Over, ParameterAnswer, Place,
    Provenance, Trace, Untestable, Verdict, Whiteness,
};
use haptical_model::Device;

const TEMPLATE: &str = include_str!("../../../../fixtures/devices/haptic7.toml");

fn channel(name: &str, joint: Option<usize>, unit: &str, floor: f64) -> ChannelGap {
    ChannelGap {
        channel: name.to_owned(),
        joint,
        has_gap: false,
        held_out: false,
        rms_before: 1.01 * floor,
        rms_after: 1.01 * floor,
        rms_fit: Some(1.01 * floor),
        noise_floor: floor,
        noise_floor_ci95: [0.98 * floor, 1.02 * floor],
        noise_source: NoiseSource::Motion,
        unit: unit.to_owned(),
        share_of_gap: 0.0,
        reduction_percent: None,
        reduction_ci95: None,
        no_reduction: Some(NoReduction::NoGap),
    }
}

/// A recording without a gap.
pub(crate) fn no_gap() -> Diagnosis {
    let noise = |name: &str| NoiseAnswer {
        channel: name.to_owned(),
        ratio: 1.02,
        colour: 0.01,
        outlier_share: 0.0,
        from: "differences of successive rows".to_owned(),
        speed_ratio: 1.0,
        readings: 6000,
        degrees_of_freedom: 4400.0,
        source: NoiseSource::Motion,
    };
    Diagnosis {
        admission: Admission::default(),
        adjusted: Vec::new(),
        own_model: Vec::new(),
        bodies: Vec::new(),
        split_row: None,
        verdict: Verdict::NoGap,
        gap: Gap {
            channels: vec![
                channel("out1", Some(1), "rad", 1.05e-4),
                channel("out2", Some(2), "rad", 1.05e-4),
                channel("cable", None, "m", 1.1e-5),
            ],
        },
        place: None,
        causes: vec![],
        unexplained_share: 0.0,
        own_effects_leave: None,
        silent: Vec::new(),
        second: None,
        corrected: None,
        not_in_file: vec![],
        fit_rows: FitRows::default(),
        probability_unknown: 0.0,
        untestable: vec![Untestable {
            effect: "thermal-drift".to_owned(),
            joints: vec![],
            why: "no column temp_degc".to_owned(),
        }],
        invisible: vec![Invisible {
            effect: "cable-scale".to_owned(),
            joint: None,
            why: "indistinguishable from scaling every length".to_owned(),
            would_bias: "all lengths by the same factor".to_owned(),
        }],
        detectable: [(Some(1), 2e-5), (Some(2), 3e-5)]
            .map(|(joint, value)| Detectable {
                effect: "backlash".to_owned(),
                joint,
                parameter: "width_rad".to_owned(),
                value,
            })
            .to_vec(),
        noise: ["out1", "out2", "cable"].map(noise).to_vec(),
        whiteness: Whiteness {
            tests: 19,
            over: vec![Over::Frequency, Over::Time, Over::Posture],
            least_p_adjusted: Some(0.4),
            on: Some("the angle of joint 2".to_owned()),
        },
        candidates: vec![],
        closed_unseen_share: None,
        absorbed: None,
        plausibility: vec![],
        next_experiment: None,
        warnings: vec![],
        held_out: "a second recording".to_owned(),
        provenance: Provenance {
            rows: 1200,
            base_parameters: 61,
            base_identifiable: 57,
            tested: 87,
            thresholds: "1".to_owned(),
            last_step: 0.001,
            without: vec![],
        },
        device: Device::from_toml(TEMPLATE, "device.toml").unwrap().device,
        traces: vec![],
        steps: vec![],
        correction: None,
        correction_refused: None,
        predictions: vec![],
    }
}

/// The gap of joint 2, before and after.
fn with_gap(after: f64) -> Diagnosis {
    let mut diagnosis = no_gap();
    let out2 = &mut diagnosis.gap.channels[1];
    out2.rms_before = 1.2e-3;
    out2.rms_after = after;
    out2.share_of_gap = 0.83;
    out2.has_gap = true;
    out2.no_reduction = Some(NoReduction::WithinNoise);
    diagnosis.gap.channels[2].has_gap = true;
    diagnosis.gap.channels[2].no_reduction = None;
    diagnosis.gap.channels[2].rms_before = 9e-5;
    diagnosis.gap.channels[2].share_of_gap = 0.17;
    diagnosis.gap.channels[2].reduction_percent = Some(99.0);
    let at: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k) - 2.0).collect();
    diagnosis.traces = vec![Trace {
        channel: "out2".to_owned(),
        unit: "rad".to_owned(),
        covariate: "torque2_nm".to_owned(),
        is_held_out: false,
        before: at.iter().map(|torque| torque / 258.0).collect(),
        after: at
            .iter()
            .map(|torque| 1e-4 * (40.0 * torque).sin())
            .collect(),
        at,
    }];
    diagnosis
}

/// One cause, named.
pub(crate) fn named() -> Diagnosis {
    let mut diagnosis = with_gap(1.1e-4);
    diagnosis.verdict = Verdict::Named;
    diagnosis.gap.channels[1].reduction_percent = Some(97.3);
    diagnosis.gap.channels[1].reduction_ci95 = Some([96.1, 98.0]);
    diagnosis.gap.channels[1].no_reduction = None;
    diagnosis.place = Some(Place {
        channel: "out2".to_owned(),
        joint: Some(2),
        depends_on: vec!["torque2_nm".to_owned()],
        region: "everywhere".to_owned(),
        explained: vec![0.95],
        dependence: Vec::new(),
    });
    diagnosis.causes = vec![CauseAnswer {
        effect: "capstan-compliance".to_owned(),
        joint: Some(2),
        probability: 0.98,
        confusable_with: vec![],
        parameters: BTreeMap::from([(
            "stiffness_nm_per_rad".to_owned(),
            ParameterAnswer {
                value: 258.0,
                ci95: [243.0, 273.0],
            },
        )]),
        earlier: BTreeMap::new(),
        changed: Vec::new(),
        plausible: true,
        implausible: false,
        class_probability: 0.98,
        share: 1.0,
        held_out: Some(HeldOutAnswer {
            channel: "out2".to_owned(),
            rms_before: 1.2e-3,
            rms_after: 1.1e-4,
            noise_floor: 1.05e-4,
            unit: "rad".to_owned(),
            reduction_percent: Some(97.3),
            reduction_ci95: Some([96.1, 98.0]),
            no_reduction: None,
        }),
    }];
    let candidate = |effect: &str, joint, nats_behind, probability| CandidateAnswer {
        effect: effect.to_owned(),
        joint,
        share: 0.9,
        nats_behind,
        probability,
        parameters: BTreeMap::new(),
        refused: None,
    };
    diagnosis.candidates = vec![
        candidate("capstan-compliance", Some(2), 0.0, 0.98),
        candidate("hysteresis", Some(2), 4.2, 0.015),
        candidate("backlash", Some(1), 250.0, 0.0),
        candidate("cable-latency", None, 3100.0, 0.0),
    ];
    diagnosis.probability_unknown = 0.005;
    diagnosis
}

/// A gap without a name.
pub(crate) fn unknown() -> Diagnosis {
    let mut diagnosis = with_gap(1.2e-3);
    diagnosis.verdict = Verdict::Unknown;
    diagnosis.unexplained_share = 1.0;
    diagnosis.probability_unknown = 0.97;
    diagnosis.place = Some(Place {
        channel: "out2".to_owned(),
        joint: Some(2),
        depends_on: vec!["theta2_rad".to_owned()],
        region: "near theta2 = 0.25 rad".to_owned(),
        explained: vec![0.88],
        dependence: Vec::new(),
    });
    diagnosis
}

#[test]
fn an_open_answer_names_the_command_that_settles_it() {
    let mut open = named();
    open.verdict = Verdict::Ambiguous;
    let said = crate::diagnose::next::next_step(&open, None);
    assert!(
        !said.contains("--settle"),
        "no candidate has a size: {said}"
    );
    for candidate in &mut open.candidates {
        candidate.parameters = [("size".to_owned(), 1.0)].into();
    }
    let said = crate::diagnose::next::next_step(&open, None);
    for wanted in [
        "haptical plan --settle gap.json",
        "haptical diagnose --log log.csv --log next.csv",
        "by hand: ",
    ] {
        assert!(said.contains(wanted), "{said}");
    }
    open.verdict = Verdict::Named;
    assert!(!crate::diagnose::next::next_step(&open, None).contains("--settle"));
}
