//! Reads fixtures/mgh: observations, known sums of squares, what MINPACK reaches.

use std::path::Path;

/// A sum of squares that the set is known to have.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Known {
    /// To the printed digits.
    pub(crate) sum_of_squares: f64,
    /// `least`, `local`, `stationary` or `at infinity`.
    pub(crate) kind: String,
}

/// Problem, parameters, residuals.
type Size = (String, usize, usize);

/// The three files.
pub(crate) struct Tables {
    observed: Vec<(String, [f64; 2])>,
    known: Vec<(Size, Known)>,
    /// Factor of the start and norm of the residuals that MINPACK ends with.
    minpack: Vec<(Size, f64, f64)>,
}

/// Fields of the rows of a file.
fn rows<const WIDTH: usize>(folder: &Path, name: &str) -> Result<Vec<[String; WIDTH]>, String> {
    let reader = csv::Reader::from_path(folder.join(name));
    let mut reader =
        reader.map_err(|error| format!("fixtures/mgh/{name} cannot be read: {error}"))?;
    let fields = |record: Result<csv::StringRecord, csv::Error>| {
        let record = record.map_err(|error| format!("fixtures/mgh/{name}: {error}"))?;
        let fields: Vec<String> = record.iter().map(str::to_owned).collect();
        fields.try_into().map_err(|found: Vec<String>| {
            let found = found.len();
            format!("fixtures/mgh/{name}: {found} fields in a row, {WIDTH} are needed")
        })
    };
    reader.records().map(fields).collect()
}

fn number<T: std::str::FromStr>(text: &str, name: &str) -> Result<T, String> {
    text.parse()
        .map_err(|_| format!("fixtures/mgh/{name}: `{text}` is not a number"))
}

fn size(fields: &[String], name: &str) -> Result<Size, String> {
    Ok((
        fields[0].clone(),
        number(&fields[1], name)?,
        number(&fields[2], name)?,
    ))
}

impl Tables {
    pub(super) fn read(folder: &Path) -> Result<Self, String> {
        let name = "observations.csv";
        let observed = rows::<3>(folder, name)?
            .into_iter()
            .map(|[problem, x, y]| Ok((problem, [number(&x, name)?, number(&y, name)?])))
            .collect::<Result<_, String>>()?;
        let name = "known.csv";
        let known = rows::<6>(folder, name)?
            .into_iter()
            .map(|row| {
                let known = Known {
                    sum_of_squares: number(&row[3], name)?,
                    kind: row[4].clone(),
                };
                Ok((size(&row, name)?, known))
            })
            .collect::<Result<_, String>>()?;
        let name = "minpack.csv";
        let minpack = rows::<7>(folder, name)?
            .into_iter()
            .map(|row| {
                Ok((
                    size(&row, name)?,
                    number(&row[3], name)?,
                    number(&row[6], name)?,
                ))
            })
            .collect::<Result<_, String>>()?;
        Ok(Self {
            observed,
            known,
            minpack,
        })
    }

    pub(super) fn observed(&self, name: &str) -> Vec<[f64; 2]> {
        let of = self.observed.iter().filter(|(problem, _)| problem == name);
        of.map(|(_, pair)| *pair).collect()
    }

    /// Sums of squares that are known of a problem of this size.
    pub(crate) fn known(
        &self,
        name: &str,
        parameters: usize,
        residuals: usize,
    ) -> impl Iterator<Item = &Known> {
        let of = move |size: &Size| size.0 == name && size.1 == parameters && size.2 == residuals;
        self.known
            .iter()
            .filter(move |(size, _)| of(size))
            .map(|(_, known)| known)
    }

    /// Sum of squares that MINPACK's test program ends with, where it tries that start.
    pub(crate) fn minpack(
        &self,
        name: &str,
        parameters: usize,
        residuals: usize,
        factor: f64,
    ) -> Option<f64> {
        let mut runs = self.minpack.iter();
        let run = runs.find(|(size, at, _)| {
            size.0 == name && size.1 == parameters && size.2 == residuals && *at == factor
        });
        run.map(|(_, _, norm)| norm * norm)
    }
}
