//! Motions that may be recorded: pieces about postures, slow and fast, with and without a load, and one path through them.

mod path;
mod pieces;

use haptical_model::{Device, Recording};

pub use self::path::path;
pub use self::pieces::pieces;
use crate::posture::recording_of;
use crate::{DesignError, Posture};

/// How motions are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motions {
    /// Rows per second \[1/s\]; none where single postures are recorded, without times.
    pub rate_hz: Option<f64>,
    /// Number of motions to draw.
    pub count: usize,
    /// Seed.
    pub seed: u64,
    /// Force with which the hand, or a weight, can press on the handle \[N\]; none where nothing presses.
    pub press_n: Option<f64>,
}

/// A motion: what the joints read row by row, when, and what presses.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Motion {
    /// Reading of each joint, row by row (\[rad\], \[m\] for a prismatic joint).
    pub joint: Vec<Vec<f64>>,
    /// Time of each row \[s\], from 0; none of single postures.
    pub time_s: Option<Vec<f64>>,
    /// Force on the handle in its frame \[N\], row by row, where a rig can press.
    pub force_n: Option<[Vec<f64>; 3]>,
    /// In words.
    pub words: String,
}

impl Motion {
    /// Rows.
    pub fn len(&self) -> usize {
        self.joint.first().map_or(0, Vec::len)
    }

    /// Whether it has no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The recording that a device without effects and noise would make of it, with the sensors of another recording: the
    /// readings of which that one has columns. Its tracker, tool and temperature stay as they were at that one's end. Torques are
    /// left out: they are those that masses and hand need.
    ///
    /// # Errors
    /// [`DesignError::Pose`] where the device has no value at a row.
    pub fn recording(&self, device: &Device, like: &Recording) -> Result<Recording, DesignError> {
        let rows = self.len();
        let posture = |row: usize| Posture::free(self.joint.iter().map(|own| own[row]).collect());
        let postures: Vec<Posture> = (0..rows).map(posture).collect();
        let mut made = recording_of(device, &postures)?;
        for (own, like) in [
            (&mut made.output, &like.output),
            (&mut made.cable_m, &like.cable_m),
        ] {
            for (column, like) in own.iter_mut().zip(like) {
                *column = column.take().filter(|_| like.is_some());
            }
        }
        made.position_m = made.position_m.filter(|_| like.position_m.is_some());
        made.orientation_wxyz = made
            .orientation_wxyz
            .filter(|_| like.orientation_wxyz.is_some());
        made.time_s.clone_from(&self.time_s);
        let last = |column: &Option<Vec<f64>>| {
            let mut known = column.iter().flatten().rev();
            known.find(|value| value.is_finite()).copied()
        };
        made.temperature_degc = last(&like.temperature_degc).map(|degc| vec![degc; rows]);
        let run = like.run.as_ref().and_then(|run| run.last());
        made.run = run.map(|run| vec![*run; rows]);
        let tool = like.tool.as_ref().and_then(|tool| tool.last());
        made.tool = tool.map(|tool| vec![tool.clone(); rows]);
        made.force_n = like.force_n.as_ref().map(|_| {
            let rest = || [(); 3].map(|()| vec![0.0; rows]);
            self.force_n.clone().unwrap_or_else(rest)
        });
        Ok(made)
    }
}
