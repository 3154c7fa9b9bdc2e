//! Vectors and quaternions spread over several columns: a row has all parts or none.

use crate::error::place::Place;

/// The columns of one vector or quaternion.
#[derive(Debug)]
pub(crate) struct Group<'a, const N: usize> {
    pub(crate) parts: [Vec<f64>; N],
    pub(crate) names: &'a [&'a str; N],
    pub(crate) lines: &'a [u64],
    pub(crate) file: &'a str,
}

/// Removes readings of which a part is missing, with a warning; none if no reading is left.
///
/// A position without its y is no position, and a consumer that looks at x alone would
/// otherwise compute with `NaN`.
pub(crate) fn take_group<const N: usize>(
    group: Group<'_, N>,
    warnings: &mut Vec<String>,
) -> Option<[Vec<f64>; N]> {
    let Group {
        mut parts,
        names,
        lines,
        file,
    } = group;
    let mut incomplete = Vec::new();
    let mut complete = 0_usize;
    for (row, &line) in lines.iter().enumerate() {
        let given = parts.iter().filter(|part| !part[row].is_nan()).count();
        if given == N {
            complete += 1;
        } else if given > 0 {
            incomplete.push(line);
            for part in &mut parts {
                part[row] = f64::NAN;
            }
        }
    }
    let names = names.join(", ");
    if let Some(&first) = incomplete.first() {
        warnings.push(format!(
            "{}: only a part of {names} is given here and in {} further rows; these readings are \
             left out",
            Place::line(file, first),
            incomplete.len() - 1
        ));
    }
    if complete == 0 {
        warnings.push(format!(
            "{file}: no row has a reading of {names}; taken as absent"
        ));
        return None;
    }
    Some(parts)
}
