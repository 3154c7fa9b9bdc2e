//! Noise that has a memory: autoregressions up to 0.95, drifts, noise that is uneven over a channel's range; with an
//! effect beside it or without.

use anyhow::Result;

use crate::effects::Group;
use crate::random::Random;
use crate::rig::noise::{ChannelNoise, NoisePlan};
use crate::suites::{Joints, named, of_device, of_group, one_of, visible};
use crate::trial::Order;

/// Kinds of noise: label, correlation of successive rows, whether it is uneven.
const KINDS: [(&str, f64, bool); 5] = [
    ("ar-0.5", 0.5, false),
    ("ar-0.8", 0.8, false),
    ("ar-0.95", 0.95, false),
    ("uneven", 0.0, true),
    ("ar-and-uneven", 0.8, true),
];
/// Drifts that may be taken for noise, at this part of a strong one.
const DRIFTS: [&str; 3] = ["cable-drift", "external-encoder-drift", "joint-drift"];
const SLIGHT: f64 = 0.3;

/// Of eight trials three are clean and one drifts a little; three have an effect, and of one its names are withheld.
pub(crate) fn order(index: u64, random: &mut Random) -> Result<Order> {
    let (member, round) = (index % 8, index / 8);
    let kind = KINDS[((3 * round + member) % KINDS.len() as u64) as usize];
    let mut order = match member {
        0..=2 => Order {
            label: Some(format!("coloured-clean-{}", kind.0)),
            ..of_device(random)?.0
        },
        3 => one_of(&named(&DRIFTS), round, SLIGHT, Joints::Seen, random)?.or_no_gap(),
        4..=6 => {
            let kinds = of_group(Group::Single);
            one_of(&kinds, 3 * round + member - 4, 1.0, Joints::All, random)?
        }
        _ => one_of(&visible(), 5 * round, 1.0, Joints::Seen, random)?.withheld(),
    };
    colour(&mut order.noise, kind, random);
    Ok(order)
}

fn colour(noise: &mut NoisePlan, kind: (&str, f64, bool), random: &mut Random) {
    let (_, autoregression, is_uneven) = kind;
    for channel in noise.output.iter_mut().chain([&mut noise.cable]) {
        let range_ratio = if is_uneven {
            random.around(6.0, 4.0)
        } else {
            1.0
        };
        *channel = ChannelNoise {
            autoregression,
            range_ratio,
            ..*channel
        };
    }
}
