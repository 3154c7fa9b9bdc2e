//! A planar arm of two links whose shoulder is driven by a capstan: from encoder readings to the handle.
#![forbid(unsafe_code)]

use std::error::Error;

use haptical_kinematics::{Chain, Convention, Link, Motion, Pose, Twist};
use haptical_transmission::{Capstan, CapstanError};

/// Lengths of upper arm and forearm.
pub const LENGTHS_M: [f64; 2] = [0.2, 0.15];

/// The arm with what a calibration found of its capstan.
#[derive(Debug, Clone, Copy)]
pub struct Arm {
    /// Drive of the shoulder; the elbow's motor sits on its joint.
    pub drive: Capstan,
    /// Its identified error.
    pub error: CapstanError,
}

impl Arm {
    /// Handle pose, and its derivatives with respect to the two motor-side readings.
    ///
    /// # Errors
    /// Whatever the two crates say of the numbers.
    pub fn handle(&self, readings_rad: [f64; 2]) -> Result<(Pose, [Twist; 2]), Box<dyn Error>> {
        let shoulder = self.drive.evaluate(&self.error, readings_rad[0])?;
        let links = LENGTHS_M.map(|a_m| Link {
            a_m,
            ..Link::default()
        });
        let chain = Chain::new(Convention::Standard, &links, &[Motion::Revolute; 2])?;
        let mut columns = [Twist::default(); 2];
        let joints_rad = [readings_rad[0] + shoulder.value_rad, readings_rad[1]];
        let pose = chain.geometric_jacobian(&joints_rad, &mut columns)?;
        columns[0].linear *= 1.0 + shoulder.slope;
        columns[0].angular *= 1.0 + shoulder.slope;
        Ok((pose, columns))
    }
}
