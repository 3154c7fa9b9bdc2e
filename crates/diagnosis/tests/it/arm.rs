//! A small arm with three capstans, recorded here: what it shows is the model's, plus errors that a test
//! adds, plus noise.

use haptical_diagnosis::{Diagnosis, Options, Verdict, diagnose};
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::transmission::CapstanError;
use haptical_model::{Device, Evaluation, Recording, TransmissionError};

use crate::normal::Normal;

/// Sampling interval \[s\].
pub(crate) const STEP_S: f64 = 0.01;
/// Standard deviation of the external encoders \[rad\].
pub(crate) const OUTPUT_SD_RAD: f64 = 1e-4;
/// And of the cable encoder \[m\].
pub(crate) const CABLE_SD_M: f64 = 1e-5;

/// The arm as its file describes it.
pub(crate) fn device() -> Device {
    let mut text = String::from("[device]\nname = \"arm\"\n");
    let rows = [
        (0.3, 1.5, 0.05),
        (0.02, -1.4, 0.3),
        (0.25, 0.4, 0.1),
        (0.22, 0.3, 0.03),
    ];
    for (a, alpha, d) in rows {
        text += &format!("[[link]]\na_m = {a}\nalpha_rad = {alpha}\nd_m = {d}\n");
    }
    for home in [0.3, -0.6, 0.9] {
        text += &format!(
            "[[joint]]\nhome_rad = {home}\ntransmission = \"capstan\"\ntransmission_ratio = 8.0\n\
             drum_distance_m = 0.0675\nencoder_counts_per_rev = 20000\n\
             external_encoder_sd_rad = {OUTPUT_SD_RAD}\nexternal_encoder_counts_per_rev = 20000\n\
             torque_scale_sd = 0.03\n"
        );
    }
    text += &format!(
        "[cable_encoder]\ndrum_radius_m = 0.015\ncounts_per_rev = 20000\ndistance_sd_m = {CABLE_SD_M}\n"
    );
    Device::from_toml(&text, "arm.toml").unwrap().device
}

/// The arm as it was built: lengths, offsets and drums are a little off.
pub(crate) fn built() -> Device {
    let mut device = device();
    device.links[1].a_m += 8e-4;
    device.links[2].d_m -= 6e-4;
    device.links[2].theta_rad += 4e-3;
    device.links[3].a_m += 5e-4;
    for (joint, ratio_deviation) in device.joints.iter_mut().zip([0.11, -0.07, 0.05]) {
        joint.transmission_error = TransmissionError::Capstan(CapstanError {
            offset_rad: 2e-3,
            ratio_deviation,
            output_drum_xy_m: [3e-4, -2e-4],
            input_drum_xy_m: [1e-5, 2e-5],
        });
    }
    device
}

/// What is true at an instant.
#[derive(Debug)]
pub(crate) struct Instant {
    pub(crate) time_s: f64,
    /// Seconds since the start of the run.
    pub(crate) elapsed_s: f64,
    pub(crate) reading_rad: [f64; 3],
    pub(crate) torque_nm: [f64; 3],
}

/// Errors that the model does not have.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Errors {
    /// Of each joint in front of its external encoder \[rad\].
    pub(crate) transmission_rad: [f64; 3],
    /// Of each joint behind it \[rad\].
    pub(crate) joint_rad: [f64; 3],
    /// Of the external encoders alone \[rad\].
    pub(crate) encoder_rad: [f64; 3],
    /// Of the cable encoder \[m\].
    pub(crate) cable_m: f64,
}

/// What is recorded of the arm.
#[derive(Debug, Clone)]
pub(crate) struct Session {
    pub(crate) seed: u64,
    pub(crate) runs: usize,
    pub(crate) rows_of_a_run: usize,
    /// Later than this \[s\].
    pub(crate) start_s: f64,
}

impl Default for Session {
    fn default() -> Self {
        Self {
            seed: 1,
            runs: 2,
            rows_of_a_run: 1200,
            start_s: 0.0,
        }
    }
}

/// Reading of a joint at a time: three waves whose periods have no common multiple in a recording.
pub(crate) fn motion_rad(joint: usize, time_s: f64) -> f64 {
    let pace = 1.0 + 0.31 * joint as f64;
    let phase = 1.9 * joint as f64;
    let slow = (0.37 * pace * time_s + phase).sin();
    let middle = (1.41 * pace * time_s + 2.0 * phase).sin();
    let fast = (3.3 * pace * time_s).sin();
    0.55 * slow + 0.45 * middle + 0.1 * fast
}

/// Torque on a joint's link, from a hand that pushes this way and that.
pub(crate) fn torque_nm(joint: usize, time_s: f64) -> f64 {
    let pace = 0.83 + 0.29 * joint as f64;
    let phase = 0.7 + 1.3 * joint as f64;
    0.8 * (pace * time_s + phase).cos() + 0.5 * (2.7 * pace * time_s - phase).sin()
}

/// Records the arm with errors.
pub(crate) fn record(session: &Session, errors: impl Fn(&Instant) -> Errors) -> Recording {
    record_with_noise(session, 1.0, errors)
}

/// The same with noise of another size than stated.
pub(crate) fn record_with_noise(
    session: &Session,
    size: f64,
    errors: impl Fn(&Instant) -> Errors,
) -> Recording {
    let built = built();
    let step_rad = std::f64::consts::TAU / 20_000.0 / 8.0;
    let rows = session.runs * session.rows_of_a_run;
    let mut noise = Normal::new(session.seed);
    let mut evaluation = Evaluation::new(&built);
    let mut recording = Recording {
        line: (2..).take(rows).collect(),
        time_s: Some(Vec::new()),
        run: Some(Vec::new()),
        joint: vec![Vec::new(); 3],
        output: vec![Some(Vec::new()); 3],
        cable_m: vec![Some(Vec::new())],
        torque_nm: vec![Some(Vec::new()); 3],
        ..Recording::default()
    };
    let push = |column: &mut Option<Vec<f64>>, value: f64| column.as_mut().unwrap().push(value);
    for row in 0..rows {
        let (run, within) = (row / session.rows_of_a_run, row % session.rows_of_a_run);
        let elapsed_s = STEP_S * within as f64;
        // a break of 40 s between two runs
        let run_s = STEP_S * session.rows_of_a_run as f64 + 40.0;
        let time_s = session.start_s + run_s * run as f64 + elapsed_s;
        // the hand does not know where the clock started
        let moved_s = time_s - session.start_s;
        let instant = Instant {
            time_s: moved_s,
            elapsed_s,
            reading_rad: [0, 1, 2].map(|joint| motion_rad(joint, moved_s)),
            torque_nm: [0, 1, 2].map(|joint| torque_nm(joint, moved_s)),
        };
        let extra = errors(&instant);
        evaluation.move_to(&instant.reading_rad).unwrap();
        let mut outputs = [0, 1, 2].map(|joint| evaluation.output_rad(joint));
        for joint in 0..3 {
            outputs[joint] += extra.transmission_rad[joint];
            let seen =
                outputs[joint] + extra.encoder_rad[joint] + size * OUTPUT_SD_RAD * noise.next();
            push(&mut recording.output[joint], seen);
            outputs[joint] += extra.joint_rad[joint];
            let counts = (instant.reading_rad[joint] / step_rad).round();
            recording.joint[joint].push(counts * step_rad);
            push(&mut recording.torque_nm[joint], instant.torque_nm[joint]);
        }
        evaluation.move_outputs(&outputs).unwrap();
        let handle: Vector3<f64> = evaluation.pose().unwrap().position_m;
        let distance_m = handle.norm() + extra.cable_m + size * CABLE_SD_M * noise.next();
        push(&mut recording.cable_m[0], distance_m);
        push(&mut recording.time_s, time_s);
        recording.run.as_mut().unwrap().push(run as i64);
    }
    recording
}

/// The arm with a yielding capstan cable: the case that most tests start from.
pub(crate) const YIELDING_JOINT: usize = 1;
/// Its stiffness \[N m/rad\].
pub(crate) const STIFFNESS_NM_PER_RAD: f64 = 400.0;

pub(crate) fn record_yielding(session: &Session) -> Recording {
    record(session, |at| {
        let mut errors = Errors::default();
        errors.transmission_rad[YIELDING_JOINT] =
            -at.torque_nm[YIELDING_JOINT] / STIFFNESS_NM_PER_RAD;
        errors
    })
}

/// Diagnoses with the whole catalogue.
pub(crate) fn diagnosed(recording: &Recording) -> Diagnosis {
    diagnose(&device(), recording, &Options::default()).unwrap()
}

/// Every k-th row.
pub(crate) fn every(recording: &Recording, step: usize) -> Recording {
    let rows: Vec<usize> = (0..recording.len()).step_by(step).collect();
    recording.select(&rows)
}

/// Verdict and names in short, for messages.
pub(crate) fn summary(diagnosis: &Diagnosis) -> String {
    let causes: Vec<String> = diagnosis
        .causes
        .iter()
        .map(|cause| {
            format!(
                "{}@{:?} {:.3}",
                cause.effect, cause.joint, cause.probability
            )
        })
        .collect();
    format!(
        "{} {causes:?} {:?}",
        diagnosis.verdict.name(),
        diagnosis.place
    )
}

/// Asserts one named cause, and returns the answer's interval of a parameter.
pub(crate) fn assert_named(
    diagnosis: &Diagnosis,
    effect: &str,
    joint: Option<usize>,
    parameter: &str,
) -> (f64, [f64; 2]) {
    let summary = summary(diagnosis);
    assert_eq!(diagnosis.verdict, Verdict::Named, "{summary}");
    assert_eq!(diagnosis.causes.len(), 1, "{summary}");
    let cause = &diagnosis.causes[0];
    assert_eq!(
        (cause.effect.as_str(), cause.joint),
        (effect, joint),
        "{summary}"
    );
    let answer = cause.parameters[parameter];
    (answer.value, answer.ci95)
}

/// Asserts that a number lies within twice the half-width of a 95 % interval: of normal errors one in 10^4
/// does not.
pub(crate) fn assert_near((value, [low, high]): (f64, [f64; 2]), truth: f64) {
    let half = 0.5 * (high - low);
    assert!(
        half > 0.0 && (low..=high).contains(&value),
        "{value} [{low}, {high}]"
    );
    assert!(
        (value - truth).abs() < 2.0 * half,
        "{value} [{low}, {high}], true {truth}"
    );
}
