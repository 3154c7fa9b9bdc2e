//! What a torque's gap follows, in the log's columns.

use haptical_motion::{Dependence, Quantity};

use super::words::{Words, largest};
use crate::answer::ChannelGap;
use crate::force::answer::Followed;
use crate::thresholds::moving::{FOLLOWED_OF_MOST, FOLLOWED_SHARE};

/// What the largest gap depends on, in the log's columns.
pub(super) fn followed(words: &Words<'_>, channels: &[ChannelGap]) -> Vec<Followed> {
    let (device, examined) = (words.device, words.examined);
    let Some(own) = largest(channels).map(|index| &examined.channels[index]) else {
        return Vec::new();
    };
    let most = own.depends_on.first().map_or(0.0, |own| own.share);
    let first = own.depends_on.first().map(|own| own.quantity);
    // functions of time follow everything that is slow
    let is_of_time =
        |own: &Dependence| own.quantity == Quantity::Time && first != Some(own.quantity);
    let is_told = |own: &&Dependence| {
        own.share > FOLLOWED_SHARE.max(FOLLOWED_OF_MOST * most) && !is_of_time(own)
    };
    let joint = &device.joints[own.joint];
    let number = own.joint + 1;
    let position = format!("theta{number}_{}", joint.unit());
    let told = own.depends_on.iter().filter(is_told);
    let followed = told.map(|found| {
        let (column, words) = match found.quantity {
            Quantity::Position if joint.unit() == "m" => {
                (position.clone(), format!("the travel of joint {number}"))
            }
            Quantity::Position => (position.clone(), format!("the angle of joint {number}")),
            Quantity::Velocity => (
                position.clone(),
                format!("the speed and direction of joint {number}"),
            ),
            Quantity::Acceleration => (
                position.clone(),
                format!("the acceleration of joint {number}"),
            ),
            Quantity::Load => (
                joint.torque_column(number),
                format!("the load of joint {number}"),
            ),
            Quantity::Time => ("t_s".to_owned(), "time".to_owned()),
        };
        Followed {
            column,
            words,
            share: found.share,
        }
    });
    let mut told: Vec<Followed> = Vec::new();
    for own in followed {
        // angle and speed are of one column
        if !told.iter().any(|other| other.column == own.column) {
            told.push(own);
        }
    }
    told
}
