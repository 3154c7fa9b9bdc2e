//! Prints the improvement of the link twists of the paper's table 3 and of a set of pose errors.

use haptical_metrics::{
    Bootstrap, MetricsError, median, parameter_improvement_percent, rms, rms_improvement_percent,
};

const ASSIGNED_MRAD: [f64; 6] = [-1.5, 1.3, -1.4, 1.2, -1.1, -1.6];
const IDENTIFIED_MRAD: [f64; 6] = [-1.477, 1.309, -1.396, 1.424, -1.320, -1.546];

#[allow(clippy::print_stdout, reason = "an example talks to the terminal")]
fn main() -> Result<(), MetricsError> {
    let mut percents = Vec::new();
    for (link, (&assigned, &identified)) in ASSIGNED_MRAD.iter().zip(&IDENTIFIED_MRAD).enumerate() {
        let percent = parameter_improvement_percent(assigned, identified, 0.0)?;
        println!("link twist {}: {percent:.2} %", link + 1);
        percents.push(percent);
    }
    println!("median: {:.2} %", median(&percents)?);

    let before_mm: Vec<f64> = (0..200)
        .map(|k| 4.0 + 2.0 * (0.7 * k as f64).sin())
        .collect();
    let after_mm: Vec<f64> = (0..200).map(|k| 0.3 * (1.3 * k as f64).cos()).collect();
    let improvement = |rows: &[usize]| {
        let pick = |of: &[f64]| rows.iter().map(|&row| of[row]).collect::<Vec<f64>>();
        let (before, after) = (rms(&pick(&before_mm)).ok()?, rms(&pick(&after_mm)).ok()?);
        Some(
            rms_improvement_percent(before, after)
                .ok()?
                .percent_as_printed,
        )
    };
    let whole = rms_improvement_percent(rms(&before_mm)?, rms(&after_mm)?)?;
    let bootstrap = Bootstrap {
        replicates: 1000,
        seed: 3,
        level: 0.95,
        block_length: 10,
    };
    let interval = bootstrap.interval(before_mm.len(), improvement)?;
    println!(
        "position error: {:.2} % (95 % interval {:.2} to {:.2}), worse: {}",
        whole.percent_as_printed, interval.low, interval.high, whole.worse
    );
    Ok(())
}
