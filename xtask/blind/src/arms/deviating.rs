//! How far an arm is from its chain at a posture, and what a tracker would see of it.

use std::collections::BTreeMap;

use haptical_model::Device;

use super::Wrong;
use super::postures::Postures;
use super::tracker::Tracker;
use super::yielding::Yielding;
use crate::gap::ChannelGapTruth;
use crate::random::Random;
use crate::rig::geometry::{Chain, Flex, HandlePose};

/// What makes an arm deviate from its chain.
#[derive(Debug, Clone, Default)]
pub(super) struct Deviating {
    pub(super) yielding: Yielding,
    /// A joint that turns by the product of its angle's sine and another one's, and how far \[rad\].
    pub(super) product: Option<(usize, usize, f64)>,
}

impl Deviating {
    pub(super) fn draw(wrong: Wrong, device: &Device, random: &mut Random) -> Self {
        let yielding = match wrong {
            Wrong::Nothing | Wrong::Product => Yielding::default(),
            _ => Yielding::of_joints(device, random),
        };
        let yielding = match wrong {
            Wrong::JointsAndAcross => yielding.and_across(device, random),
            Wrong::JointsAndBase => yielding.and_base(device, random),
            _ => yielding,
        };
        let product = (wrong == Wrong::Product).then(|| {
            let on = 1 + random.index(2);
            (on, on + 1 + random.index(2), random.sign())
        });
        Self { yielding, product }
    }

    pub(super) fn handle(
        &self,
        device: &Device,
        chain: &Chain,
        posture: &[f64],
        unrest: &[f64],
    ) -> HandlePose {
        let (mut turns, flex) = self.yielding.at(device, posture);
        if let Some((on, by, size)) = self.product {
            turns[on] += size * libm::sin(2.0 * posture[on]) * libm::sin(1.5 * posture[by]);
        }
        chain.pose(
            |joint| posture[joint] + turns[joint] + unrest[joint],
            &flex,
            0,
        )
    }

    /// Way of the marker by the effect \[m\], posture by posture, in frame (-1).
    fn ways(&self, device: &Device, tracker: &Tracker, postures: &Postures) -> Vec<[f64; 3]> {
        let chain = Chain::new(device);
        let still = vec![0.0; device.joints.len()];
        let way = |posture: &Vec<f64>| -> [f64; 3] {
            let rigid = chain.pose(|joint| posture[joint], &Flex::default(), 0);
            let handle = self.handle(device, &chain, posture, &still);
            (tracker.marker_m(&handle) - tracker.marker_m(&rigid)).into()
        };
        postures.angle_rad.iter().map(way).collect()
    }

    /// Makes the way of the marker, less its mean, of this root mean square.
    pub(super) fn scale_to(
        &mut self,
        gap_m: f64,
        device: &Device,
        tracker: &Tracker,
        postures: &Postures,
    ) {
        // small enough for the way to be proportional
        const TRIED: f64 = 1e-4;
        let tried = Self {
            yielding: self.yielding.clone().scaled(TRIED),
            product: self.product.map(|(on, by, size)| (on, by, size * TRIED)),
        };
        let ways = tried.ways(device, tracker, postures);
        let spread = spread(&ways);
        if spread > 0.0 {
            let factor = TRIED * gap_m / spread;
            self.yielding = self.yielding.clone().scaled(factor);
            self.product = self.product.map(|(on, by, size)| (on, by, size * factor));
        }
    }

    pub(super) fn gap(
        &self,
        device: &Device,
        tracker: &Tracker,
        postures: &Postures,
    ) -> BTreeMap<String, ChannelGapTruth> {
        let rms = spread(&self.ways(device, tracker, postures));
        let over_sd = rms / tracker.position_sd_m;
        BTreeMap::from([("position".to_owned(), ChannelGapTruth { rms, over_sd })])
    }
}

/// Root mean square of vectors less their mean.
fn spread(ways: &[[f64; 3]]) -> f64 {
    let count = ways.len().max(1) as f64;
    let mean = [0, 1, 2].map(|axis| ways.iter().map(|way| way[axis]).sum::<f64>() / count);
    let square = |way: &[f64; 3]| -> f64 {
        way.iter()
            .zip(mean)
            .map(|(value, mean)| (value - mean).powi(2))
            .sum()
    };
    libm::sqrt(ways.iter().map(square).sum::<f64>() / count)
}
