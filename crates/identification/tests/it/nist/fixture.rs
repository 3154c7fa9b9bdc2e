//! Reads a NIST file: starts, certified values and data; turns it into a problem.

use std::path::PathBuf;

use haptical_identification::{IdentificationError, Matrix, Problem};

use super::models::{MODELS, Model};

/// One file with its model.
pub(super) struct Certified {
    pub(super) name: &'static str,
    /// Starts 1 and 2.
    pub(super) starts: [Vec<f64>; 2],
    pub(super) parameters: Vec<f64>,
    pub(super) standard_deviations: Vec<f64>,
    pub(super) residual_sum_of_squares: f64,
    model: Model,
    /// Response, already transformed where the model is of log(y).
    responses: Vec<f64>,
    /// One or two predictors per row.
    predictors: Vec<Vec<f64>>,
}

/// All problems, or none (with a line on standard error) where the fixtures were not shipped.
pub(super) fn all() -> Option<Vec<Certified>> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/nist");
    if !folder.is_dir() {
        eprintln!("skip: fixtures/nist is absent");
        return None;
    }
    Some(
        MODELS
            .iter()
            .map(|&(name, model)| {
                let path = folder.join(format!("{name}.dat"));
                let text = std::fs::read_to_string(&path)
                    .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
                read(name, model, &text)
            })
            .collect(),
    )
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace()
        .map_while(|word| word.parse().ok())
        .collect()
}

fn read(name: &'static str, model: Model, text: &str) -> Certified {
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
    let labelled = |label: &str| {
        let line = text.lines().find(|line| line.starts_with(label)).unwrap();
        numbers(line.split_once(':').unwrap().1)[0]
    };
    let header = text.rfind("\nData:").unwrap();
    let rows: Vec<Vec<f64>> = text[header + 1..]
        .lines()
        .skip(1)
        .map(numbers)
        .filter(|row| row.len() >= 2)
        .collect();
    assert_eq!(
        rows.len() as f64,
        labelled("Number of Observations:"),
        "{name}"
    );
    Certified {
        name,
        starts: [column(0), column(1)],
        parameters: column(2),
        standard_deviations: column(3),
        residual_sum_of_squares: labelled("Residual Sum of Squares:"),
        model,
        responses: rows
            .iter()
            .map(|row| {
                if name == "Nelson" {
                    row[0].ln()
                } else {
                    row[0]
                }
            })
            .collect(),
        predictors: rows.iter().map(|row| row[1..].to_vec()).collect(),
    }
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
