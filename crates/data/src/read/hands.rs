//! Checks that each row of a log of a device with several hands names one of them.

use haptical_model::Recording;

use crate::column::Role;
use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::read::header::Header;
use crate::read::order::cell_of;
use crate::shape::LogShape;

/// Refuses a missing column, a hand that the device does not have, and a column of a device without hands.
pub(crate) fn check(
    recording: &Recording,
    header: &Header,
    file: &str,
    shape: &LogShape,
) -> Result<(), DataError> {
    let hands = &shape.hands;
    let Some(named) = &recording.hand else {
        if hands.is_empty() {
            return Ok(());
        }
        let hands = hands.clone();
        return Err(Place::line(file, header.line).error(Fault::NoHandColumn { hands }));
    };
    if hands.is_empty() {
        let at = cell_of(&header.columns, Role::Hand, file, header.line);
        return Err(at.error(Fault::HandColumn));
    }
    let mut rows = recording.line.iter().zip(named);
    match rows.find(|(_, name)| !hands.contains(name)) {
        None => Ok(()),
        Some((line, name)) => {
            let at = cell_of(&header.columns, Role::Hand, file, *line);
            Err(at.error(Fault::UnknownHand {
                found: name.clone(),
                hands: hands.clone(),
            }))
        }
    }
}
