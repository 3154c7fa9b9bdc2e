//! A joint that gives way to the torque on it: theta = u - tau / k.
//!
//! Where the device has masses tau is gravity's torque. Where it has none, tau is a sum of sines and cosines of the joints'
//! angles: for revolute joints gravity's torque is such a sum (equations.md, Torques at rest).

use crate::log::{Series, range};
use crate::thresholds::{STILL_COUNTS, STILL_RANGE};

/// Columns that gravity's torque may have: the torque itself, else sines and cosines of all angles that move.
pub(crate) fn columns(series: &Series) -> Vec<Vec<f64>> {
    if let Some(load_nm) = &series.load_nm {
        return vec![load_nm.iter().map(|torque| -torque).collect()];
    }
    let moves = |column: &&Vec<f64>| {
        range(column) > (STILL_COUNTS * series.count).max(STILL_RANGE).max(0.1)
    };
    let angles = std::iter::once(&series.command).chain(&series.others);
    angles
        .filter(moves)
        .flat_map(|angle| {
            let sine = angle.iter().map(|angle| angle.sin()).collect();
            let cosine = angle.iter().map(|angle| angle.cos()).collect();
            [sine, cosine]
        })
        .collect()
}
