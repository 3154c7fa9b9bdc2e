//! What stands behind the bodies of an MJCF: equalities, tendons, actuators, sensors.

use std::fmt::Write;

use crate::numbers::{escaped, written};
use crate::write::effects::{YieldKind, has_own_row};
use crate::write::mjcf::{Model, stiff};
use crate::write::urdf::FAR;

impl Model<'_> {
    /// Rows that follow another's joint, and joints that another one moves.
    pub(super) fn equalities(&self, text: &mut String) {
        let mut bonds = String::new();
        let stiff = stiff(self.step_s);
        let mut bond = |first: &str, second: &str, multiplier: f64| {
            let _ = writeln!(
                bonds,
                "    <joint joint1=\"{first}\" joint2=\"{second}\" polycoef=\"0 {} 0 0 0\" {stiff}/>",
                written(&[multiplier])
            );
        };
        for (row, name) in self.names.iter().enumerate() {
            let name = escaped(name);
            if let Some((source, multiplier)) = self.segments.followed(self.device, row) {
                bond(&name, &escaped(&self.names[source]), multiplier);
            }
            for own in &self.rows[row].yields {
                if let YieldKind::Coupling(gain, from) = own.of.kind
                    && let Some(source) = self.device.own_row(from)
                {
                    let first = format!("{name}{}", own.of.suffix);
                    bond(&first, &escaped(&self.names[source - 1]), gain);
                }
            }
        }
        if !bonds.is_empty() {
            let _ = write!(text, "  <equality>\n{bonds}  </equality>\n");
        }
    }

    /// Joints of the device with an external encoder in the file.
    pub(super) fn with_external_encoders(&self) -> Vec<bool> {
        let joints = self.device.joints.iter().enumerate();
        let has = joints.map(|(joint, own)| {
            let mut yields = self.effects.yields[joint].iter();
            let is_seen = own.external_encoder_counts_per_rev.is_some()
                || own.external_encoder_sd_rad.is_some()
                || self.effects.external_delay_s[joint] > 0.0
                || yields.any(|own| own.is_before_encoder);
            is_seen && has_own_row(self.device, joint)
        });
        has.collect()
    }

    /// The sum of what each external encoder sees.
    pub(super) fn tendons(&self, text: &mut String) {
        let mut tendons = String::new();
        for (joint, _) in self.outs() {
            let Some(row) = self.device.own_row(joint) else {
                continue;
            };
            let name = escaped(&self.names[row - 1]);
            let (number, unit) = (joint + 1, self.device.joints[joint].unit());
            let _ = writeln!(tendons, "    <fixed name=\"out{number}_{unit}\">");
            let _ = writeln!(tendons, "      <joint joint=\"{name}\" coef=\"1\"/>");
            for own in self.rows[row - 1]
                .yields
                .iter()
                .filter(|own| own.of.is_before_encoder)
            {
                let suffix = own.of.suffix;
                let _ = writeln!(
                    tendons,
                    "      <joint joint=\"{name}{suffix}\" coef=\"1\"/>"
                );
            }
            tendons.push_str("    </fixed>\n");
        }
        if !tendons.is_empty() {
            let _ = write!(text, "  <tendon>\n{tendons}  </tendon>\n");
        }
    }

    /// Joints with an external encoder, and how late it is.
    fn outs(&self) -> impl Iterator<Item = (usize, f64)> {
        let delays = self.effects.external_delay_s.iter().copied().enumerate();
        let has = self.with_external_encoders();
        delays.filter(move |(joint, _)| has[*joint])
    }

    /// A position actuator for each row that no other one moves.
    pub(super) fn actuators(&self, text: &mut String) {
        text.push_str("  <!-- plausible: kp and kv, which hold each joint against its weight -->\n  <actuator>\n");
        for (row, own) in self.rows.iter().enumerate() {
            if self.segments.followed(self.device, row).is_some() {
                continue;
            }
            let name = escaped(&self.names[row]);
            let [stiffness, damping] = own.gains;
            let _ = write!(
                text,
                "    <position name=\"{name}\" joint=\"{name}\" kp=\"{}\" kv=\"{}\"",
                written(&[stiffness]),
                written(&[damping])
            );
            if let Some(range) = self.range(row) {
                let _ = write!(text, " ctrlrange=\"{}\"", written(&range));
            }
            if let Some(limit) = self.segments.rows[row].torque_limit(self.device) {
                let _ = write!(text, " forcerange=\"{}\"", written(&[-limit, limit]));
            }
            text.push_str("/>\n");
        }
        text.push_str("  </actuator>\n");
    }

    /// Sensors by the names of a log's columns.
    pub(super) fn sensors(&self, text: &mut String) {
        text.push_str("  <sensor>\n");
        for row in 0..self.rows.len() {
            if self.segments.followed(self.device, row).is_some() {
                continue;
            }
            let joint = self.segments.rows[row].drive.joint;
            let name = escaped(&self.names[row]);
            let unit = self.segments.rows[row].drive.motion.unit();
            let is_own = has_own_row(self.device, joint);
            let (of, force) = match (is_own, unit) {
                (true, "m") => (
                    format!("theta{}_m", joint + 1),
                    format!("force{}_n", joint + 1),
                ),
                (true, _) => (
                    format!("theta{}_rad", joint + 1),
                    format!("torque{}_nm", joint + 1),
                ),
                // its value is no reading
                (false, _) => (format!("{name}_{unit}"), format!("{name}_drive")),
            };
            let late = match is_own {
                true => self.late(self.effects.encoder_delay_s[joint]),
                false => String::new(),
            };
            let _ = write!(
                text,
                "    <jointpos name=\"{of}\" joint=\"{name}\"{late}/>\n    <jointvel name=\"{of}_per_s\" \
                 joint=\"{name}\"/>\n    <actuatorfrc name=\"{force}\" actuator=\"{name}\"/>\n",
            );
        }
        for (joint, delay_s) in self.outs() {
            let (number, unit) = (joint + 1, self.device.joints[joint].unit());
            let late = self.late(delay_s);
            let _ = writeln!(
                text,
                "    <tendonpos name=\"out{number}_{unit}\" tendon=\"out{number}_{unit}\"{late}/>"
            );
        }
        let hands = self.device.hands.iter().map(|hand| hand.name.as_str());
        let only = ["handle"].into_iter().filter(|_| !self.device.has_hands());
        for hand in hands.chain(only) {
            let hand = escaped(hand);
            let _ = write!(
                text,
                "    <framepos name=\"{hand}_xyz_m\" objtype=\"site\" objname=\"{hand}\"/>\n    <framequat \
                 name=\"{hand}_wxyz\" objtype=\"site\" objname=\"{hand}\"/>\n"
            );
        }
        text.push_str("  </sensor>\n");
    }

    /// Where a row can begin: at 0, or in the middle of limits that exclude it.
    pub(super) fn start(&self, row: usize) -> f64 {
        if let Some((source, multiplier)) = self.segments.followed(self.device, row) {
            return multiplier * self.start(source);
        }
        match self.range(row) {
            Some([lower, upper]) if lower < upper && (lower > 0.0 || upper < 0.0) => {
                let [nearer, farther] = [lower.max(-FAR), upper.min(FAR)];
                // of one limit alone, what is next to it
                match (lower <= -FAR, upper >= FAR) {
                    (true, _) => farther,
                    (_, true) => nearer,
                    _ => 0.5 * (nearer + farther),
                }
            }
            _ => 0.0,
        }
    }

    /// A keyframe within the limits, where 0 is not.
    pub(super) fn keyframe(&self, text: &mut String) {
        let mut positions = Vec::new();
        for (row, _) in self.order() {
            positions.push(self.start(row));
            positions.extend(self.rows[row].yields.iter().map(|own| {
                match own.of.kind {
                    YieldKind::Coupling(gain, from) => self
                        .device
                        .own_row(from)
                        .map_or(0.0, |source| gain * self.start(source - 1)),
                    _ => 0.0,
                }
            }));
        }
        if positions.iter().all(|own| *own == 0.0) {
            return;
        }
        let rows = 0..self.rows.len();
        let is_driven = |row: &usize| self.segments.followed(self.device, *row).is_none();
        let targets: Vec<f64> = rows.filter(is_driven).map(|row| self.start(row)).collect();
        let _ = write!(
            text,
            "  <keyframe>\n    <key name=\"start\" qpos=\"{}\" ctrl=\"{}\"/>\n  </keyframe>\n",
            written(&positions),
            written(&targets)
        );
    }

    /// Attributes of a late sensor.
    fn late(&self, delay_s: f64) -> String {
        if delay_s <= 0.0 {
            return String::new();
        }
        let samples = libm::ceil(delay_s / self.step_s) + 1.0;
        format!(" delay=\"{}\" nsample=\"{samples}\"", written(&[delay_s]))
    }
}
