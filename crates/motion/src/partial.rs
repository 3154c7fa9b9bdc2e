//! Effects that explain a part of the gap, and what else is in it.

use crate::effect::{is_exact, is_of_an_arm, is_scale};
use crate::examined::{ChannelFit, Examined, Finding};
use crate::thresholds::examine::{
    ALL_FRICTION, LEFT_BY_PART, MOST_FRICTION, MOST_OF_CLOSED, NO_WORSE,
};
use crate::unseen::Unseen;

impl Examined {
    /// Whether the effects explain a part of the gap, and nothing speaks against them: on rows that no fit saw every torque loses a part
    /// that counts of its gap, and none gets one; what is left does not follow the posture where their laws are exact.
    pub fn is_partial(&self) -> bool {
        let lose =
            || self.unexplained_share() <= LEFT_BY_PART && self.unseen.iter().all(Unseen::loses);
        !self.is_adequate()
            && self.refusal().is_none()
            && self.unseen.iter().any(Unseen::has_gap)
            && (lose() || self.lose_but_friction())
    }

    /// Whether effects of exact laws leave nothing but friction that depends on the position of its joint, which is no law of theirs, and
    /// such friction alone would not explain the gap (A332).
    pub fn leaves_friction(&self) -> bool {
        let energy = |own: &ChannelFit| ((own.rms_before / own.noise).powi(2) - 1.0).max(0.0);
        let whole: f64 = self.channels.iter().map(energy).sum();
        let friction = |own: &ChannelFit| energy(own) * own.share_of_friction[0];
        let mut rests = self.channels.iter().filter(|own| own.has_rest()).peekable();
        !self.findings.is_empty()
            && self.findings.iter().all(|own| is_exact(own.effect))
            && self.channels.iter().map(friction).sum::<f64>() < MOST_FRICTION * whole
            && rests.peek().is_some()
            && rests.all(|own| own.share_of_friction[1] > ALL_FRICTION)
    }

    /// The same, and on rows that no fit saw some torque loses most of its gap; those that lose no part that counts have such friction and
    /// do not get worse.
    fn lose_but_friction(&self) -> bool {
        let is_friction = |joint: usize| {
            let mut channels = self.channels.iter().filter(|own| own.joint == joint);
            channels.any(|own| own.share_of_friction[1] > ALL_FRICTION)
        };
        let stays = |own: &Unseen| own.beyond_after() <= NO_WORSE * own.beyond_before();
        let is_fine = |own: &Unseen| own.loses() || (is_friction(own.joint) && stays(own));
        let most = |own: &Unseen| {
            own.has_gap() && own.beyond_after() <= MOST_OF_CLOSED * own.beyond_before()
        };
        self.leaves_friction() && self.unseen.iter().any(most) && self.unseen.iter().all(is_fine)
    }

    /// One factor on all torques and another body than described, both at once, as the log of an arm of other lengths and masses has them
    /// (A333): the factor, and what is found next to it.
    pub fn of_another_arm(&self) -> Option<(f64, &Finding)> {
        let is_factor = |own: &&Finding| is_scale(own.effect) && own.joint.is_none();
        let factor = self.findings.iter().find(is_factor)?.numbers.first()?.1;
        let mut others = self.findings.iter().filter(|own| own.joint.is_some());
        Some((factor, others.find(|own| is_of_an_arm(own.effect))?))
    }
}
