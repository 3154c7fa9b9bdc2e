//! A joint that gives way to the torque on it: theta = u - tau / k.
//!
//! Where the device has masses tau is gravity's torque. Where it has none, tau is a sum of sines and cosines of the joints'
//! angles: for revolute joints gravity's torque is such a sum (equations.md, Torques at rest).

use crate::log::{Series, range};
use crate::thresholds::{STILL_COUNTS, STILL_RANGE};

/// Which angles move, the joint's own first.
pub(crate) fn moving(series: &Series) -> Vec<bool> {
    let least = (STILL_COUNTS * series.count).max(STILL_RANGE).max(0.1);
    angles(series).map(|column| range(column) > least).collect()
}

/// Columns that gravity's torque may have: the torque itself, else sines and cosines of the angles that it may depend on.
pub(crate) fn columns(series: &Series, depends: &[bool]) -> Vec<Vec<f64>> {
    if let Some(load_nm) = &series.load_nm {
        return vec![load_nm.iter().map(|torque| -torque).collect()];
    }
    let pairs = angles(series).zip(depends).filter(|(_, depends)| **depends);
    pairs
        .flat_map(|(angle, _)| {
            let sine = angle.iter().map(|angle| angle.sin()).collect();
            let cosine = angle.iter().map(|angle| angle.cos()).collect();
            [sine, cosine]
        })
        .collect()
}

fn angles(series: &Series) -> impl Iterator<Item = &Vec<f64>> {
    std::iter::once(&series.command).chain(&series.others)
}
