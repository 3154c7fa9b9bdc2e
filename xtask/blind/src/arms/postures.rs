//! Postures of a measured arm: which, how often, in which order, in which run.

use haptical_model::Device;

use crate::random::Random;

/// The rows of a log.
#[derive(Debug, Clone)]
pub(crate) struct Postures {
    /// Angles from home \[rad\], posture by posture.
    pub(crate) angle_rad: Vec<Vec<f64>>,
    pub(crate) of_row: Vec<usize>,
    /// Run of each row, from 0.
    pub(crate) run: Vec<usize>,
}

/// Part of the range between the limits that postures reach.
const REACH: f64 = 0.8;

/// `count` postures, anywhere within the limits.
pub(crate) fn anywhere(device: &Device, count: usize, random: &mut Random) -> Postures {
    let angle = |random: &mut Random| -> Vec<f64> {
        let joints = device.joints.iter();
        joints
            .map(|joint| REACH * random.uniform(joint.lower_rad, joint.upper_rad))
            .collect()
    };
    Postures {
        angle_rad: (0..count).map(|_| angle(random)).collect(),
        of_row: (0..count).collect(),
        run: vec![0; count],
    }
}

impl Postures {
    /// Each recorded 2 to 5 times: at once one after the other, or the whole list in a new order each time.
    pub(crate) fn repeated(mut self, random: &mut Random) -> Self {
        let times = 2 + random.index(4);
        let count = self.angle_rad.len();
        if random.unit() < 0.5 {
            self.of_row = (0..count)
                .flat_map(|posture| vec![posture; times])
                .collect();
        } else {
            let mut rows = Vec::new();
            for _ in 0..times {
                let mut order: Vec<usize> = (0..count).collect();
                for last in (1..count).rev() {
                    order.swap(last, random.index(last + 1));
                }
                rows.extend(order);
            }
            self.of_row = rows;
        }
        self.run = vec![0; self.of_row.len()];
        self
    }

    /// In so many runs of about equal length.
    pub(crate) fn in_runs(mut self, runs: usize) -> Self {
        let rows = self.of_row.len();
        self.run = (0..rows).map(|row| row * runs / rows.max(1)).collect();
        self
    }

    pub(crate) fn len(&self) -> usize {
        self.of_row.len()
    }
}
