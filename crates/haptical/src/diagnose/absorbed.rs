//! What an earlier model had taken up of the causes, in a sentence.

use haptical_diagnosis::{Diagnosis, MovedNumber};

use super::words::{named_at, percent};
use crate::units::Shown;

/// Of the numbers at most `listed`, those that moved farthest.
pub(crate) fn absorbed_sentence(diagnosis: &Diagnosis, listed: usize) -> Option<String> {
    let absorbed = diagnosis.absorbed.as_ref()?;
    let first = diagnosis.causes.first()?;
    let share = absorbed.share.map_or("a part".to_owned(), percent);
    let cause = named_at(&first.effect, first.joint);
    let count = match absorbed.moved.len() {
        1 => "1 number moves".to_owned(),
        count => format!("{count} numbers move"),
    };
    let moved = absorbed.moved.iter().take(listed);
    let mut moved: Vec<String> = moved.map(moved_number).collect();
    if absorbed.moved.len() > listed {
        moved.push("others in gap.json".to_owned());
    }
    let numbers = match moved.as_slice() {
        [] => String::new(),
        moved => format!(": {}", moved.join(", ")),
    };
    Some(format!(
        "The earlier model took up {share} of {cause}: identify it again. With the cause in the model {count}{numbers}."
    ))
}

/// `a3 by 0.31 mm`.
fn moved_number(number: &MovedNumber) -> String {
    let step = number.value.value - number.earlier;
    let size = match number.unit.as_str() {
        unit @ ("m" | "rad") => Shown::fine(unit).text(step),
        "1" => format!("{step:.2e}"),
        unit => format!("{step:.2e} {unit}"),
    };
    format!("{} by {size}", number.parameter)
}
