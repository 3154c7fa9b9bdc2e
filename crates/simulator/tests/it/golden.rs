//! The same bits on every machine: recordings against a committed file.

use haptical_simulator::model::Recording;
use haptical_simulator::{
    CableSigma, Noise, Sampling, Settings, SimulatorError, simulate, simulate_transmission,
};

use crate::device::arm;

const ROWS: usize = 3;
const SEED: u64 = 2026;

/// Every number of a recording as the 16 hexadecimal digits of its bits.
fn lines(name: &str, recording: &Recording) -> String {
    let mut text = String::new();
    for row in 0..recording.len() {
        let optional = recording.output.iter().chain(&recording.cable_m).flatten();
        let cells: Vec<String> = recording
            .joint
            .iter()
            .chain(optional)
            .map(|column| format!("{:016x}", column[row].to_bits()))
            .collect();
        text += &format!("{name},{},{}\n", recording.line[row], cells.join(","));
    }
    text
}

fn recordings() -> Result<String, SimulatorError> {
    let truth = arm();
    let uniform = Settings {
        sampling: Sampling::Uniform,
        motor_counts: true,
        output_noise: Noise::GaussianAndCounts,
        cable_noise: Noise::Gaussian,
        cable_sigma: CableSigma::Stated,
        ..Settings::paper()
    };
    let mut text = String::from(
        "# bits of theta1..4, out1..3, cable_m, cable2_m (transmission: theta1..4, out2)\n",
    );
    for (name, settings) in [
        ("paper", Settings::paper()),
        ("real_encoders", Settings::real_encoders()),
        ("uniform", uniform),
    ] {
        text += &lines(name, &simulate(&truth, &settings, ROWS, SEED)?);
    }
    let alone = simulate_transmission(&truth, &Settings::paper(), 1, ROWS, SEED)?;
    Ok(text + &lines("transmission", &alone))
}

#[test]
fn recordings_have_the_committed_bits() {
    let want = include_str!("golden.csv");
    let got = recordings().expect("recordings");
    // printed in full, so that an intended change can be committed
    assert!(
        got == want.replace("\r\n", "\n"),
        "golden.csv should be:\n{got}"
    );
}
