//! The NIST problems: a file's starts, certified values and data, as a least-squares problem.
//!
//! Shared by the tests of this crate and `cargo xtask evidence`, which includes it by path.

pub(crate) mod digits;
mod models;

use std::path::Path;

use haptical_identification::{IdentificationError, Matrix, Problem};

use models::{MODELS, Model};

/// One file with its model.
pub(crate) struct Certified {
    pub(crate) name: &'static str,
    /// Starts 1 and 2.
    pub(crate) starts: [Vec<f64>; 2],
    pub(crate) parameters: Vec<f64>,
    pub(crate) standard_deviations: Vec<f64>,
    pub(crate) residual_sum_of_squares: f64,
    model: Model,
    /// Response, already transformed where the model is of log(y).
    responses: Vec<f64>,
    /// One or two predictors per row.
    predictors: Vec<Vec<f64>>,
}

/// All problems of the folder fixtures/nist.
///
/// # Errors
/// A text that names the file that cannot be read and what is wrong with it.
pub(crate) fn read_all(folder: &Path) -> Result<Vec<Certified>, String> {
    let problems = MODELS.iter().map(|&(name, model)| {
        let text = std::fs::read_to_string(folder.join(format!("{name}.dat")))
            .map_err(|error| error.to_string());
        text.and_then(|text| read(name, model, &text))
            .map_err(|error| format!("fixtures/nist/{name}.dat: {error}"))
    });
    problems.collect()
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace()
        .map_while(|word| word.parse().ok())
        .collect()
}

/// The number behind a label and a colon.
fn labelled(text: &str, label: &str) -> Result<f64, String> {
    let line = text.lines().find(|line| line.starts_with(label));
    let number = line
        .and_then(|line| line.split_once(':'))
        .and_then(|(_, right)| numbers(right).first().copied());
    number.ok_or_else(|| format!("no number behind `{label}`"))
}

fn read(name: &'static str, model: Model, text: &str) -> Result<Certified, String> {
    let table: Vec<Vec<f64>> = text
        .lines()
        .filter_map(|line| {
            let (left, right) = line.trim().split_once('=')?;
            let index = left.trim().strip_prefix('b')?;
            index.parse::<usize>().ok()?;
            Some(numbers(right)).filter(|row| row.len() == 4)
        })
        .collect();
    let column = |index: usize| table.iter().map(|row| row[index]).collect();
    let header = text.rfind("\nData:").ok_or("no line `Data:`")?;
    let rows: Vec<Vec<f64>> = text[header + 1..]
        .lines()
        .skip(1)
        .map(numbers)
        .filter(|row| row.len() >= 2)
        .collect();
    if rows.len() as f64 != labelled(text, "Number of Observations:")? {
        return Err(format!("{} observations were read", rows.len()));
    }
    let response = |row: &Vec<f64>| match name {
        "Nelson" => row[0].ln(),
        _ => row[0],
    };
    Ok(Certified {
        name,
        starts: [column(0), column(1)],
        parameters: column(2),
        standard_deviations: column(3),
        residual_sum_of_squares: labelled(text, "Residual Sum of Squares:")?,
        model,
        responses: rows.iter().map(response).collect(),
        predictors: rows.iter().map(|row| row[1..].to_vec()).collect(),
    })
}

impl Problem for Certified {
    fn parameter_count(&self) -> usize {
        self.parameters.len()
    }

    fn residual_count(&self) -> usize {
        self.responses.len()
    }

    fn evaluate(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
        mut jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let mut slopes = vec![0.0; parameters.len()];
        for (row, (response, predictors)) in self.responses.iter().zip(&self.predictors).enumerate()
        {
            residuals[row] = (self.model)(parameters, predictors, &mut slopes) - response;
            if let Some((free, matrix)) = &mut jacobian {
                for (column, &parameter) in free.iter().enumerate() {
                    matrix[(row, column)] = slopes[parameter];
                }
            }
        }
        Ok(())
    }
}
