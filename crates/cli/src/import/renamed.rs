//! Columns of a table under new names and in other units, as flags say it.

use std::collections::BTreeSet;

/// `TARGET=SOURCE` of `--map`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Renaming {
    pub(super) target: String,
    /// Name in the table's header, or `#3` for its third column.
    pub(super) source: String,
}

/// `TARGET=FACTOR` of `--scale`; `theta*` means all targets that begin so.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scaling {
    target: String,
    factor: f64,
}

/// Reads one entry of `--map`.
pub(super) fn renaming(text: &str) -> Result<Renaming, String> {
    let (target, source) = two_sides(text)?;
    Ok(Renaming { target, source })
}

/// Reads one entry of `--scale`.
pub(super) fn scaling(text: &str) -> Result<Scaling, String> {
    let (target, factor) = two_sides(text)?;
    let factor = match factor.as_str() {
        "deg" => 1.0_f64.to_radians(),
        "mm" | "ms" => 1e-3,
        "um" | "us" => 1e-6,
        "ns" => 1e-9,
        number => {
            let factor = number.parse::<f64>().ok();
            let factor = factor.filter(|factor| factor.is_finite() && *factor != 0.0);
            factor.ok_or("TARGET=FACTOR with a number, deg, mm, um, ms, us or ns is expected")?
        }
    };
    Ok(Scaling { target, factor })
}

fn two_sides(text: &str) -> Result<(String, String), String> {
    let (left, right) = text.split_once('=').unwrap_or_default();
    match (left.trim(), right.trim()) {
        ("", _) | (_, "") => Err("NAME=VALUE is expected, such as theta1_rad=q1".to_owned()),
        (left, right) => Ok((left.to_owned(), right.to_owned())),
    }
}

impl Scaling {
    fn fits(&self, target: &str) -> bool {
        match self.target.strip_suffix('*') {
            Some(begin) => target.starts_with(begin),
            None => self.target == target,
        }
    }
}

/// The factor on a column; none where it is taken as it is. Of several the last counts.
pub(super) fn factor(scalings: &[Scaling], target: &str) -> Option<f64> {
    let fitting = scalings.iter().rev().find(|scaling| scaling.fits(target));
    fitting.map(|scaling| scaling.factor)
}

/// A target that is given twice, or a scaling without a target, in words.
pub(super) fn fault(renamings: &[Renaming], scalings: &[Scaling]) -> Option<String> {
    let mut seen = BTreeSet::new();
    let mut targets = renamings.iter().map(|renaming| &renaming.target);
    if let Some(twice) = targets.find(|target| !seen.insert(*target)) {
        return Some(format!("--map gives `{twice}` twice"));
    }
    let is_idle = |scaling: &&Scaling| !seen.iter().any(|target| scaling.fits(target));
    let idle = &scalings.iter().find(is_idle)?.target;
    Some(format!("--scale names `{idle}`, which --map does not"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_found_by_name_and_by_begin() {
        let scalings = ["theta*=deg", "theta2_rad=-1", "x_m=mm"].map(|text| scaling(text).unwrap());
        let degree = std::f64::consts::PI / 180.0;
        assert_eq!(factor(&scalings, "theta1_rad"), Some(degree));
        assert_eq!(factor(&scalings, "theta2_rad"), Some(-1.0));
        assert_eq!(factor(&scalings, "x_m"), Some(1e-3));
        assert_eq!(factor(&scalings, "y_m"), None);
        for wrong in ["x_m", "=1", "x_m=", "x_m=0", "x_m=inf", "x_m=inch"] {
            assert!(scaling(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn faults_of_the_flags_are_named() {
        let map = |texts: &[&str]| -> Vec<Renaming> {
            texts.iter().map(|text| renaming(text).unwrap()).collect()
        };
        assert_eq!(fault(&map(&["a=b", "c=b"]), &[]), None);
        assert!(
            fault(&map(&["a=b", "a=c"]), &[])
                .unwrap()
                .contains("`a` twice")
        );
        let idle = [scaling("x_m=mm").unwrap()];
        assert!(fault(&map(&["a=b"]), &idle).unwrap().contains("`x_m`"));
    }
}
