//! Keyword arguments of `plan` as a request; names, meaning and defaults are the command's.

use haptical::design::{Criterion, DEGREE, Limits, Region, Request, Rig, Spread, Terms};
use pyo3::prelude::*;

use crate::failure::Failure;
use crate::options::unknown;

/// Options of `plan`: all but device and log.
#[derive(Debug)]
pub(crate) struct Keywords<'k, 'py> {
    pub(crate) measure: Vec<String>,
    pub(crate) poses: Option<&'k Bound<'py, PyAny>>,
    pub(crate) criterion: &'k str,
    pub(crate) region: Option<&'k Bound<'py, PyAny>>,
    pub(crate) candidates: Option<&'k Bound<'py, PyAny>>,
    pub(crate) seed: Option<&'k Bound<'py, PyAny>>,
    pub(crate) spread: &'k str,
    pub(crate) workspace: Option<&'k Bound<'py, PyAny>>,
    pub(crate) cable_length: Option<&'k Bound<'py, PyAny>>,
    pub(crate) link_radius: Option<f64>,
    pub(crate) known_transmissions: bool,
}

impl Keywords<'_, '_> {
    pub(crate) fn request(&self) -> Result<Request, Failure> {
        let usual = Request::default();
        let rigs = self.measure.iter().map(|text| Rig::parse(text));
        let poses = self.poses.map(|poses| count("poses", poses)).transpose()?;
        let candidates = self.candidates.map(|all| count("candidates", all));
        Ok(Request {
            rigs: rigs
                .collect::<Result<_, _>>()
                .map_err(|error| Failure::value(error.to_string()))?,
            terms: match self.known_transmissions {
                true => Terms::Known,
                false => Terms::Degree(DEGREE),
            },
            limits: self.limits()?,
            candidates: candidates.transpose()?.unwrap_or(usual.candidates),
            seed: match self.seed {
                Some(seed) => whole("seed", seed, "a whole number from 0 to 2**64 - 1")?,
                None => usual.seed,
            },
            poses: poses.unwrap_or(usual.poses),
            chooses: poses.is_some(),
            criterion: match self.criterion {
                "d" => Criterion::D,
                "a" => Criterion::A,
                "o1" => Criterion::O1,
                "task-position" => Criterion::TaskPosition,
                "task-force" => Criterion::TaskForce,
                other => {
                    let known = "d, a, o1, task-position, task-force";
                    return Err(unknown("criterion", other, known));
                }
            },
            region: self.region.map_or(Ok(Region::Everywhere), region)?,
        })
    }

    fn limits(&self) -> Result<Limits, Failure> {
        let usual = Limits::default();
        if let Some(radius) = self.link_radius
            && !(radius.is_finite() && radius > 0.0)
        {
            return Err(Failure::value(format!(
                "link_radius is {radius}; a number above 0 is expected"
            )));
        }
        let lengths = self
            .cable_length
            .map(|lengths| fixed("cable_length", lengths, "a pair (shortest, longest) in m"));
        let sides = |given| -> Result<[[f64; 3]; 2], Failure> {
            let allowed = "a pair (lowest, highest) of x, y, z in m";
            let [low, high]: [[f64; 3]; 2] = read("workspace", given, allowed)?;
            finite("workspace", low.iter().chain(&high), allowed)?;
            Ok([low, high])
        };
        Ok(Limits {
            spread: match self.spread {
                "uniform" => Spread::Uniform,
                "normal" => Spread::Normal,
                other => return Err(unknown("spread", other, "uniform, normal")),
            },
            workspace_m: self.workspace.map(sides).transpose()?,
            cable_m: lengths.transpose()?.unwrap_or(usual.cable_m),
            link_radius_m: self.link_radius,
        })
    }
}

/// Four numbers of a ball, or two of each joint.
fn region(given: &Bound<'_, PyAny>) -> Result<Region, Failure> {
    let allowed = "a ball x, y, z, r in m, or a pair (low, high) of each joint's reading,";
    if let Ok(ranges) = plain(given)?.extract::<Vec<[f64; 2]>>() {
        finite("region", ranges.as_flattened(), allowed)?;
        return Ok(Region::Joints(ranges));
    }
    let [x, y, z, radius_m] = fixed("region", given, allowed)?;
    let centre_m = [x, y, z];
    Ok(Region::Ball { centre_m, radius_m })
}

/// A number of things.
fn count(keyword: &str, given: &Bound<'_, PyAny>) -> Result<usize, Failure> {
    match whole(keyword, given, "a whole number from 1")? {
        0 => Err(refused(keyword, given, "a whole number from 1")),
        number => {
            usize::try_from(number).map_err(|_| refused(keyword, given, "a smaller whole number"))
        }
    }
}

fn whole(keyword: &str, given: &Bound<'_, PyAny>, allowed: &str) -> Result<u64, Failure> {
    read(keyword, given, allowed)
}

fn fixed<const N: usize>(
    keyword: &str,
    given: &Bound<'_, PyAny>,
    allowed: &str,
) -> Result<[f64; N], Failure> {
    let numbers: [f64; N] = read(keyword, given, allowed)?;
    finite(keyword, &numbers, allowed)?;
    Ok(numbers)
}

fn read<T>(keyword: &str, given: &Bound<'_, PyAny>, allowed: &str) -> Result<T, Failure>
where
    T: for<'a, 'py> FromPyObject<'a, 'py>,
{
    let refuse = |_| refused(keyword, given, allowed);
    plain(given)?.extract().map_err(refuse)
}

/// NumPy's arrays and numbers as lists and numbers of Python.
fn plain<'py>(given: &Bound<'py, PyAny>) -> Result<Bound<'py, PyAny>, Failure> {
    match given.getattr("tolist") {
        Ok(tolist) => tolist
            .call0()
            .map_err(|error| Failure::value(error.to_string())),
        Err(_) => Ok(given.clone()),
    }
}

fn finite<'n>(
    keyword: &str,
    numbers: impl IntoIterator<Item = &'n f64>,
    allowed: &str,
) -> Result<(), Failure> {
    match numbers.into_iter().find(|number| !number.is_finite()) {
        Some(number) => Err(Failure::value(format!(
            "{keyword} has {number} in it; {allowed} is expected"
        ))),
        None => Ok(()),
    }
}

fn refused(keyword: &str, given: &Bound<'_, PyAny>, allowed: &str) -> Failure {
    Failure::value(format!("{keyword} is {given}; {allowed} is expected"))
}
