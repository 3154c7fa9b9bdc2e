//! What was examined of a motion, torques or encoders on links, as channels, causes and predictions, and what the largest gap follows.

use haptical_calibration::Channel;
use haptical_judge::probability;
use haptical_model::{Device, JointType};
use haptical_motion::{ChannelFit, Dependence, Examined, Finding, MotionError, Quantity, Unseen};

use crate::answer::{
    AdjustedAnswer, CauseAnswer, ChannelGap, Floor, HeldOutAnswer, NoReduction, OnSecond, OwnModel,
    ParameterAnswer, Trace, held_out, not_predicted,
};
use crate::force::answer::Followed;
use crate::noise::NoiseSource;
use crate::thresholds::moving::{FOLLOWED_OF_MOST, FOLLOWED_SHARE, LESS_BY_FREEDOM};
use crate::thresholds::torque::LISTED_PROBABILITY;

/// What is examined of each joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shown {
    Torque,
    Output,
    Tracking,
}

pub(super) struct Words<'e> {
    pub(super) device: &'e Device,
    pub(super) examined: &'e Examined,
    pub(super) is_adequate: bool,
    shown: Shown,
}

impl<'e> Words<'e> {
    pub(super) fn of_torques(device: &'e Device, examined: &'e Examined) -> Self {
        Self {
            device,
            examined,
            is_adequate: examined.is_answer(),
            shown: Shown::Torque,
        }
    }

    /// Of encoders on links, whose gap is explained.
    pub(super) fn of_outputs(device: &'e Device, examined: &'e Examined) -> Self {
        Self {
            device,
            examined,
            is_adequate: true,
            shown: Shown::Output,
        }
    }

    /// Of torques beside the commands that they follow.
    pub(super) fn of_commands(device: &'e Device, examined: &'e Examined) -> Self {
        Self {
            device,
            examined,
            is_adequate: !examined.findings.is_empty(),
            shown: Shown::Tracking,
        }
    }

    fn slides(&self, joint: usize) -> bool {
        self.device.joints[joint].joint_type == JointType::Prismatic
    }

    /// Unit of a joint's readings.
    pub(super) fn unit(&self, joint: usize) -> &'static str {
        match (self.shown, self.slides(joint)) {
            (Shown::Torque | Shown::Tracking, false) => "N m",
            (Shown::Torque | Shown::Tracking, true) => "N",
            (Shown::Output, false) => "rad",
            (Shown::Output, true) => "m",
        }
    }

    /// A joint's channel by its name and its unit.
    fn named(&self, joint: usize) -> (String, &'static str) {
        (self.channel(joint), self.unit(joint))
    }

    pub(super) fn channel(&self, joint: usize) -> String {
        let name = match self.shown {
            Shown::Torque => "torque",
            Shown::Output => "out",
            Shown::Tracking => "tracking",
        };
        format!("{name}{}", joint + 1)
    }

    /// Channel by channel, on the rows that were fitted.
    fn gaps_of_fit(&self) -> Vec<ChannelGap> {
        let gaps = self.examined.channels.iter().map(|own| {
            let channel = Channel::Output { joint: own.joint };
            let freedom = (own.before.len() as f64).max(1.0);
            let floor = Floor::new(channel, own.noise, freedom, NoiseSource::Motion);
            let after = if self.is_adequate {
                own.rms_after
            } else {
                own.rms_before
            };
            let mut gap = ChannelGap::fitted(
                self.channel(own.joint),
                Some(own.joint),
                [own.rms_before, after],
                &floor,
                self.unit(own.joint),
            );
            gap.has_gap = own.has_gap();
            gap
        });
        gaps.collect()
    }

    /// Channel by channel; where there is a gap that is explained, with the sizes of rows that were not fitted.
    pub(super) fn gaps(&self) -> Vec<ChannelGap> {
        if !self.is_adequate {
            return self.gaps_of_fit();
        }
        let on_unseen = |(gap, own): (ChannelGap, &ChannelFit)| {
            let mut unseen = self.examined.unseen.iter();
            let seen = unseen.find(|unseen| unseen.joint == own.joint);
            match seen.filter(|_| gap.has_gap) {
                Some(seen) => gap.on_unseen(&self.answer_of(seen), &Floor::of_rows(seen)),
                None => gap,
            }
        };
        let gaps = self.gaps_of_fit().into_iter().zip(&self.examined.channels);
        gaps.map(on_unseen).collect()
    }

    /// All findings with their shares of the gap.
    pub(super) fn causes(&self) -> Vec<CauseAnswer> {
        let findings = &self.examined.findings;
        let total: f64 = findings.iter().map(|own| own.nats.max(0.0)).sum();
        let explained = 1.0 - self.examined.unexplained_share();
        let share = |found: &Finding| explained * found.nats.max(0.0) / total.max(1e-300);
        let causes = findings.iter().map(|found| self.cause(found, share(found)));
        causes.collect()
    }

    pub(super) fn cause(&self, found: &Finding, share: f64) -> CauseAnswer {
        let near = found.rivals.iter().filter(|own| own.is_near());
        let among_rivals = probability(found.rivals.iter().map(|rival| rival.behind_nats));
        let by_freedom = match found.is_told || found.has_near_rival() {
            true => 1.0,
            false => LESS_BY_FREEDOM,
        };
        let name = |effect: &str, joint: Option<usize>| match joint {
            Some(joint) if Some(joint) != found.joint => format!("{effect} at joint {}", joint + 1),
            _ => effect.to_owned(),
        };
        let ratio = found
            .joint
            .map_or(1.0, |joint| self.device.joints[joint].transmission_ratio);
        let numbers = found.numbers.iter().map(|(name, value, sd)| {
            // periods of the motor's turn
            let value = if *name == "order" {
                value / ratio
            } else {
                *value
            };
            (
                self.number_name(found.joint, name),
                ParameterAnswer::normal(value, *sd),
            )
        });
        CauseAnswer {
            confusable_with: near.map(|own| name(own.effect, own.joint)).collect(),
            parameters: numbers
                .filter(|(_, own)| {
                    own.value.is_finite() && own.ci95.iter().all(|end| end.is_finite())
                })
                .collect(),
            share,
            class_probability: LISTED_PROBABILITY,
            held_out: match found.is_of_sampling() {
                true => self.set_right(),
                false => self
                    .held_out(found.joint)
                    .map(|held_out| of_log(found, held_out)),
            },
            ..CauseAnswer::named(
                found.effect,
                found.joint,
                LISTED_PROBABILITY * among_rivals * by_freedom,
            )
        }
    }

    /// Of a joint that slides numbers have other units.
    fn number_name(&self, joint: Option<usize>, name: &str) -> String {
        let slides = joint.is_some_and(|joint| self.slides(joint));
        match slides {
            true => name
                .replace("nm_s_per_rad", "n_s_per_m")
                .replace("nm_per_rad", "n_per_m")
                .replace("rad_per_s", "m_per_s")
                .replace("_rad", "_m")
                .replace("_nm", "_n")
                .replace("_kgm2", "_kg"),
            false => name.to_owned(),
        }
    }

    /// The gap of the torque with the largest one, or a joint's own, on rows that were not fitted.
    fn held_out(&self, joint: Option<usize>) -> Option<HeldOutAnswer> {
        // the share of a channel is said where the fit has a gap of it
        let has_gap = |seen: &&Unseen| {
            let mut channels = self.examined.channels.iter();
            channels.any(|channel| channel.joint == seen.joint && channel.has_gap())
        };
        let mut unseen = self.examined.unseen.iter().filter(has_gap);
        let of_joint = unseen.clone().find(|seen| Some(seen.joint) == joint);
        let shown = of_joint.or_else(|| largest_of(&mut unseen));
        shown.map(|seen| self.answer_of(seen))
    }

    /// The gap of the torques as the log has them, and once its rows are set right: no torque was fitted for that.
    pub(super) fn set_right(&self) -> Option<HeldOutAnswer> {
        let own = largest_of(&mut self.examined.set_right.iter())?;
        Some(held_out(self.named(own.joint), own, &own.after))
    }

    fn answer_of(&self, unseen: &Unseen) -> HeldOutAnswer {
        // what is not named closes nothing
        let sums_after = match self.is_adequate {
            true => &unseen.after,
            false => &unseen.before,
        };
        held_out(self.named(unseen.joint), unseen, sums_after)
    }

    fn why_not_predicted(&self, why: &MotionError) -> String {
        match self.shown {
            Shown::Output => {
                format!(
                    "the encoders on the links were not predicted on the second recording: {why}"
                )
            }
            Shown::Torque | Shown::Tracking => not_predicted(&why.to_string()),
        }
    }

    /// What is said of rows that are not predicted.
    pub(super) fn not_predicted(&self) -> Vec<String> {
        let with_such = (self.examined.unseen.iter()).filter(|own| own.left_out.0 > 0);
        let said = with_such.map(|own| {
            format!(
                "{}: {} of {} rows that the fit did not see are not predicted and left out: the rows that it saw hardly show what the \
                 prediction depends on",
                self.channel(own.joint),
                own.left_out.0,
                own.left_out.0 + own.rows_in_all()
            )
        });
        said.collect()
    }

    /// Numbers of the drives that were fitted, next to those of the file.
    pub(super) fn adjusted(&self) -> Vec<AdjustedAnswer> {
        let all = self.examined.adjusted.iter();
        all.map(|own| {
            let joint = &self.device.joints[own.joint];
            let before = match own.number {
                "armature_kgm2" => joint.armature_kgm2,
                number => Some(self.in_file(own.joint, number)),
            };
            let name = self.number_name(Some(own.joint), own.number);
            let (after, sd) = own.beside(before.unwrap_or(0.0));
            AdjustedAnswer::new(&name, own.joint, before, ParameterAnswer::normal(after, sd))
        })
        .collect()
    }

    /// A number of a drive's friction as effects of the file have it; 0 without.
    fn in_file(&self, joint: usize, number: &str) -> f64 {
        let effects = self.device.effects.iter();
        let own = effects.filter(|own| own.joint == Some(joint));
        own.filter_map(|own| own.numbers.get(number))
            .fold(0.0, |sum, own| sum + own)
    }

    /// How far the file as it is was off, and what is left on unseen rows, or those of the fit where there are none.
    pub(super) fn own_model(&self) -> Vec<OwnModel> {
        let all = self.examined.as_described.iter();
        all.filter_map(|(joint, rms)| {
            let mut channels = self.examined.channels.iter();
            let own = channels.find(|own| own.joint == *joint)?;
            let mut unseen = self.examined.unseen.iter();
            let unseen = unseen.find(|own| own.joint == *joint);
            let left = match unseen.filter(|own| own.rows_in_all() > 0) {
                Some(unseen) => {
                    let sums = match self.is_adequate {
                        true => &unseen.after,
                        false => &unseen.before,
                    };
                    (sums.iter().sum::<f64>() / unseen.rows_in_all() as f64).sqrt()
                }
                None if self.is_adequate => own.rms_after,
                None => own.rms_before,
            };
            Some(OwnModel {
                channel: self.channel(*joint),
                unit: self.unit(*joint).to_owned(),
                rms_before: *rms,
                rms_after: left,
            })
        })
        .collect()
    }

    /// What the second recording shows, where it was predicted.
    pub(super) fn on_second(&self) -> OnSecond {
        let is_second = self.examined.second.is_none();
        let unseen = self.examined.unseen.iter().filter(|_| is_second);
        let not_predicted = self.examined.second.iter();
        let not_predicted = not_predicted.map(|why| self.why_not_predicted(why));
        let mut found = OnSecond::default();
        found.second.not_predicted.extend(not_predicted);
        for own in unseen {
            let mut fitted = self.examined.channels.iter();
            let fitted = fitted.find(|fit| fit.joint == own.joint);
            let fitted = fitted.map_or((0.0, 0), |fit| (fit.rms_after, fit.before.len()));
            let answer = self.answer_of(own);
            found.add(answer, own, fitted, self.is_adequate);
        }
        found
    }

    /// The torque with the largest gap over time.
    pub(super) fn course(&self, channels: &[ChannelGap]) -> Option<Trace> {
        let most = largest(channels)?;
        let own = &self.examined.channels[most];
        let after = match self.is_adequate {
            true => &own.after,
            false => &own.before,
        };
        Some(Trace::over_time(
            self.channel(own.joint),
            self.unit(own.joint),
            &self.examined.time_s,
            [&own.before, after].map(Clone::clone),
        ))
    }
}

/// A push belongs to its log alone: on other rows no share of it can close.
fn of_log(found: &Finding, held_out: HeldOutAnswer) -> HeldOutAnswer {
    let why = found.is_push().then_some(NoReduction::Undetermined);
    HeldOutAnswer {
        no_reduction: why.or(held_out.no_reduction),
        ..held_out
    }
    .settled()
}

/// The joint whose torque has the largest gap over its noise.
fn largest_of<'u>(unseen: &mut dyn Iterator<Item = &'u Unseen>) -> Option<&'u Unseen> {
    let beyond = |own: &Unseen| {
        let rows = own.rows_in_all().max(1);
        own.before.iter().sum::<f64>() / (own.noise.powi(2) * rows as f64)
    };
    unseen.max_by(|a, b| beyond(a).total_cmp(&beyond(b)))
}

pub(super) fn largest(channels: &[ChannelGap]) -> Option<usize> {
    let share = |index: &usize| channels[*index].share_of_gap;
    (0..channels.len()).max_by(|a, b| share(a).total_cmp(&share(b)))
}

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
