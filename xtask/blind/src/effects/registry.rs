//! All kinds of effects, by name: where each can act and how it is drawn.

use haptical_model::{Device, TransmissionKind};

use super::{
    Draw, Effect, base, cable, drums, forces, foreign, friction, noises, payload, springs,
    structure, timing, unknown,
};

/// What a kind of effect is to a diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Group {
    /// In the catalogue, visible on its own.
    Single,
    /// In the catalogue, but absorbed by the base model on these devices.
    Absorbed,
    /// An error of the base model itself.
    Base,
    /// A pathology of the noise.
    Noise,
    /// On the force and torque channels.
    Force,
    /// In no catalogue.
    Unknown,
    /// On the force and torque channels, in no catalogue.
    ForceUnknown,
    /// On torques of an arm that moves by itself.
    Alone,
}

/// A kind of effect.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    /// Name.
    pub name: &'static str,
    /// What it is to a diagnosis.
    pub group: Group,
    sites: Sites,
    draw: fn(&mut Draw<'_>) -> Effect,
}

/// The joints at which a kind can act.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sites {
    /// No joint: the device as a whole, or its cable.
    Whole,
    /// Joints whose external encoder sees them.
    External,
    /// The same with drums and a capstan alone: a polynomial takes up what depends on the angle.
    ExternalCapstan,
    Any,
    Drums,
    /// Joints with drums that carry weight: all but the first, whose axis is vertical.
    LoadedDrums,
    /// Joints with an external encoder but the first: its axis is the chain's own freedom.
    ExternalNotFirst,
    Parallelogram,
    TwoRuns,
}

impl Kind {
    /// Joints (from 0) of `device` at which this kind can act; one entry for a kind without joint.
    pub fn joints(&self, device: &Device) -> Vec<usize> {
        let joints = device.joints.iter().enumerate();
        let has_drums = |kind: TransmissionKind| kind != TransmissionKind::Direct;
        joints
            .filter(|(index, joint)| {
                let external = joint.output_sd_rad().is_some();
                match self.sites {
                    Sites::Whole | Sites::TwoRuns => *index == 0,
                    Sites::External => external,
                    Sites::ExternalCapstan => {
                        external && joint.transmission == TransmissionKind::Capstan
                    }
                    Sites::Any => true,
                    Sites::Drums => has_drums(joint.transmission),
                    Sites::LoadedDrums => has_drums(joint.transmission) && *index > 0,
                    Sites::ExternalNotFirst => external && *index > 0,
                    Sites::Parallelogram => joint.transmission == TransmissionKind::Parallelogram,
                }
            })
            .map(|(index, _)| index)
            .collect()
    }

    /// Whether the effect belongs to no joint.
    pub fn is_whole(&self) -> bool {
        matches!(self.sites, Sites::Whole | Sites::TwoRuns)
    }

    /// Whether the effect shows only between two runs of one log.
    pub fn needs_two_runs(&self) -> bool {
        self.sites == Sites::TwoRuns
    }

    /// Draws an effect of this kind.
    pub fn draw(&self, draw: &mut Draw<'_>) -> Effect {
        (self.draw)(draw)
    }
}

/// The kind with that name.
pub fn kind(name: &str) -> Option<&'static Kind> {
    KINDS.iter().find(|kind| kind.name == name)
}

macro_rules! kinds {
    ($($name:literal $group:ident $sites:ident $draw:path;)*) => {
        &[$(Kind { name: $name, group: Group::$group, sites: Sites::$sites, draw: $draw },)*]
    };
}

/// All kinds.
pub const KINDS: &[Kind] = kinds! {
    "capstan-compliance" Single Drums springs::capstan_compliance;
    "capstan-creep" Single LoadedDrums springs::capstan_creep;
    "capstan-slip" Single Drums springs::capstan_slip;
    "backlash" Single Any friction::backlash;
    "hysteresis" Single Any friction::hysteresis;
    "viscous-lag" Single Any timing::viscous_lag;
    "drum-out-of-round" Single ExternalCapstan drums::out_of_round;
    "cable-pitch" Single ExternalCapstan drums::cable_pitch;
    "encoder-count-loss" Single Any timing::encoder_count_loss;
    "input-drum-harmonic" Single ExternalCapstan drums::input_harmonic;
    "cross-coupling" Single External drums::cross_coupling;
    "joint-drift" Single Any timing::joint_drift;
    "external-encoder-eccentricity" Single External drums::external_eccentricity;
    "external-encoder-windup" Single External friction::external_windup;
    "external-encoder-count-loss" Single External timing::external_count_loss;
    "external-encoder-drift" Single External timing::external_drift;
    "external-encoder-latency" Single External timing::external_latency;
    "encoder-latency" Single Whole timing::encoder_latency;
    "cable-zero-offset" Single Whole cable::zero_offset;
    "cable-twist" Single Whole cable::twist;
    "cable-exit-geometry" Single Whole cable::exit_geometry;
    "cable-drum-eccentricity" Single Whole drums::cable_drum;
    "cable-hysteresis" Single Whole friction::cable_hysteresis;
    "thermal-drift" Single Whole cable::thermal;
    "cable-drift" Single Whole timing::cable_drift;
    "cable-count-loss" Single Whole timing::cable_count_loss;
    "cable-latency" Single Whole timing::cable_latency;
    "joint-compliance" Single Drums springs::joint_compliance;
    "axis-wobble" Single ExternalNotFirst structure::axis_wobble;
    "base-compliance" Single Whole structure::base_compliance;
    "tool-compliance" Single Whole structure::tool_compliance;
    "tool-changed" Single TwoRuns structure::tool_changed;
    "cable-scale" Absorbed Whole cable::scale;
    "cable-stretch" Absorbed Whole cable::stretch;
    "cable-sag" Absorbed Whole cable::sag;
    "ratio-error" Base ExternalCapstan base::ratio_error;
    "drum-eccentricity" Base ExternalCapstan base::drum_eccentricity;
    "parallelogram-error" Base Parallelogram base::parallelogram_error;
    "noise-level" Noise External noises::noise_level;
    "outliers" Noise Whole noises::outliers;
    "force-bias" Force Whole forces::force_bias;
    "force-gain" Force Whole forces::force_gain;
    "force-crosstalk" Force Whole forces::force_crosstalk;
    "force-hysteresis" Force Whole forces::force_hysteresis;
    "grip-force" Force Whole forces::grip_force;
    "joint-friction" Force Drums forces::joint_friction;
    "motor-cogging" Force Drums forces::motor_cogging;
    "torque-gain" Force Drums forces::torque_gain;
    "unbalanced-gravity" Force Drums forces::unbalanced_gravity;
    "torque-tone" ForceUnknown Any foreign::torque_tone;
    "torque-bump" ForceUnknown Any foreign::torque_bump;
    "torque-walk" ForceUnknown Any foreign::torque_walk;
    "torque-step" ForceUnknown Any foreign::torque_step;
    "torque-product" ForceUnknown Any foreign::torque_product;
    "force-switching" ForceUnknown Whole foreign::force_switching;
    "payload" Alone TwoRuns payload::payload;
    "payload-on-link" Alone TwoRuns payload::payload_on_link;
    "friction-beside" Alone Whole payload::friction_beside;
    "friction-alone" Alone Whole payload::friction_alone;
    "drum-dent" Unknown External unknown::drum_dent;
    "angle-product" Unknown External unknown::angle_product;
    "random-walk" Unknown External unknown::random_walk;
    "warm-ratio" Unknown External unknown::warm_ratio;
    "chirp-vibration" Unknown External unknown::chirp;
    "loosening" Unknown External unknown::loosening;
    "worn-grooves" Unknown External unknown::grooves;
    "speed-lift" Unknown External unknown::lift;
    "loaded-angle" Unknown External unknown::loaded_angle;
    "half-range-force" Unknown External unknown::half_range_force;
    "ringing" Unknown External unknown::ringing;
    "foreign-sense" Unknown External unknown::foreign_sense;
    "cable-knot" Unknown Whole unknown::cable_knot;
    "cable-chirp" Unknown Whole unknown::cable_chirp;
    "cable-walk" Unknown Whole unknown::cable_walk;
};
