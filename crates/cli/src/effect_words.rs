//! What each effect of the catalogue is, and what to look at on the device, in a sentence each.

/// An effect in words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct EffectWords {
    name: &'static str,
    /// What happens.
    pub(crate) what: &'static str,
    /// What to look at.
    pub(crate) check: &'static str,
}

/// The words of an effect; none for a name that has none.
pub(crate) fn effect_words(name: &str) -> Option<EffectWords> {
    WORDS.iter().find(|words| words.name == name).copied()
}

const fn effect(name: &'static str, what: &'static str, check: &'static str) -> EffectWords {
    EffectWords { name, what, check }
}

const WORDS: [EffectWords; 52] = [
    effect(
        "capstan-compliance",
        "the capstan's cable stretches with the torque",
        "the pre-tension, diameter and free length of that cable",
    ),
    effect(
        "capstan-creep",
        "the cable creeps round the drum with loaded travel and does not come back",
        "the number of turns on the drum and the cable's tension",
    ),
    effect(
        "capstan-slip",
        "the cable slipped on the drum at one moment",
        "the number of turns on the drum and the torque at that time",
    ),
    effect(
        "backlash",
        "the joint does not follow its motor for a while after each reversal",
        "the tension of the cable, clamps and pins of the joint",
    ),
    effect(
        "hysteresis",
        "friction bends the transmission, with the sign of the last motion",
        "bearings, guides and cables that rub",
    ),
    effect(
        "viscous-lag",
        "the joint lags behind its motor in proportion to the speed",
        "grease, damping and the load of the transmission",
    ),
    effect(
        "drum-out-of-round",
        "the output drum is not round",
        "the drum's run-out with a dial gauge",
    ),
    effect(
        "cable-pitch",
        "the cable walks along its drum",
        "the groove and the lead of the cable on the drum",
    ),
    effect(
        "encoder-count-loss",
        "a motor encoder lost counts at one moment",
        "plug, shield and supply of that encoder, and its counter's input filter",
    ),
    effect(
        "input-drum-harmonic",
        "the error repeats with the turns of the motor",
        "the input drum's run-out, lumps of the cable and the coupling",
    ),
    effect(
        "device-encoder-eccentricity",
        "the disc of a motor encoder sits off its axis",
        "the mounting of that encoder",
    ),
    effect(
        "cross-coupling",
        "one joint moves with another because of the cable's routing",
        "pulleys that the cable of the joint runs over at the other joint",
    ),
    effect(
        "joint-drift",
        "the joint's zero drifts with time or temperature",
        "warm-up, and the cable's tension before and after",
    ),
    effect(
        "ratio-error",
        "the transmission ratio is not the nominal one",
        "the diameters of the drums, the cable's thickness included",
    ),
    effect(
        "drum-eccentricity",
        "a drum turns off its centre",
        "the drum's run-out with a dial gauge",
    ),
    effect(
        "parallelogram-error",
        "the links of the parallelogram are not of the nominal lengths",
        "the distances of its pins",
    ),
    effect(
        "joint-offset",
        "the home of the joint is not where the device file says",
        "the homing stop or the reference pose",
    ),
    effect(
        "link-geometry",
        "lengths or twists of the links are not the nominal ones",
        "the device file against the drawing",
    ),
    effect(
        "external-encoder-eccentricity",
        "the disc of an external encoder sits off the axis",
        "the mounting of that encoder",
    ),
    effect(
        "external-encoder-windup",
        "the coupling of an external encoder winds up at each reversal",
        "the coupling and the bearing of that encoder",
    ),
    effect(
        "external-encoder-count-loss",
        "an external encoder lost counts or slipped at one moment",
        "its clamp, plug and supply",
    ),
    effect(
        "external-encoder-drift",
        "the zero of an external encoder drifts",
        "its clamp, and its temperature",
    ),
    effect(
        "external-encoder-latency",
        "an external encoder is sampled later or earlier than the motor encoders",
        "the time stamps of its channel",
    ),
    effect(
        "encoder-latency",
        "all motor encoders are sampled later or earlier than the rest",
        "the time stamps of the motor encoders",
    ),
    effect(
        "cable-scale",
        "the measuring drum's radius is not the stated one",
        "the drum with a length standard",
    ),
    effect(
        "cable-stretch",
        "the measuring cable is longer under its own tension",
        "the spring's force and the cable's stiffness",
    ),
    effect(
        "cable-zero-offset",
        "the zero of the measuring cable is not where the device file says",
        "the reference length of the cable encoder",
    ),
    effect(
        "cable-sag",
        "the measuring cable hangs through",
        "the spring's force; a real cable of this length sags far less than it shows",
    ),
    effect(
        "cable-twist",
        "the reading changes with the cable's angle to its straight direction",
        "the guide and the fastening of the cable",
    ),
    effect(
        "cable-exit-geometry",
        "the measuring cable bends round its guide where it leaves",
        "the radius of the guide; enter it, or turn the encoder towards the workspace",
    ),
    effect(
        "cable-drum-eccentricity",
        "the measuring drum turns off its centre",
        "the drum's run-out",
    ),
    effect(
        "cable-hysteresis",
        "the cable encoder reads differently on the way in and out",
        "friction of its spring, drum and guide",
    ),
    effect(
        "thermal-drift",
        "lengths grow with the temperature",
        "warm-up, and the temperature of the room",
    ),
    effect(
        "cable-drift",
        "the cable encoder's zero drifts with time",
        "warm-up of the encoder, and creep of the cable",
    ),
    effect(
        "cable-count-loss",
        "the cable encoder lost counts at one moment",
        "its plug and supply, and the speed of the cable",
    ),
    effect(
        "cable-latency",
        "the cable encoder is sampled later or earlier than the joints",
        "the time stamps of its channel",
    ),
    effect(
        "joint-compliance",
        "a joint or link bends with its torque, behind the external encoder",
        "bearings, clamps and the link's stiffness",
    ),
    effect(
        "axis-wobble",
        "the axis of a joint tilts as it turns",
        "the bearings of that joint",
    ),
    effect(
        "base-compliance",
        "the base tilts with the load",
        "screws and table under the device",
    ),
    effect(
        "tool-compliance",
        "the handle or the cable's hook gives way to the force",
        "the connector between the last link and the cable",
    ),
    effect(
        "tool-changed",
        "the last link or the handle is not the same in all runs, or not the earlier model's",
        "the handle and its fastening, now and before",
    ),
    effect(
        "noise-level",
        "the noise is not of the stated size",
        "the stated figures, shielding and the encoders' mounting",
    ),
    effect(
        "outliers",
        "single readings stand far from the rest",
        "loose plugs, and the receiver of that channel",
    ),
    effect(
        "force-bias",
        "the force sensor reads a force without one",
        "its zero, and its temperature",
    ),
    effect(
        "force-gain",
        "the force sensor's scale is not the stated one",
        "its calibration with a weight",
    ),
    effect(
        "force-crosstalk",
        "a force along one axis shows on another",
        "how the force sensor is turned on the handle",
    ),
    effect(
        "force-hysteresis",
        "the force sensor reads differently while loading and unloading",
        "its mounting and overload",
    ),
    effect(
        "joint-friction",
        "a joint's friction is missing in the torque",
        "bearings and cable of the joint",
    ),
    effect(
        "motor-cogging",
        "the motor's torque ripples as it turns",
        "the motor and its commutation",
    ),
    effect(
        "torque-gain",
        "the torque's scale is not the stated one",
        "the motor's constant and the amplifier's gain",
    ),
    effect(
        "unbalanced-gravity",
        "a weight is not balanced as the device file says",
        "counterweights and masses of the device file",
    ),
    effect(
        "grip-force",
        "the hand loads the handle beside what the force sensor sees",
        "how the handle is held while recording",
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_effect_has_words_once() {
        for (index, words) in WORDS.iter().enumerate() {
            let others = &WORDS[index + 1..];
            assert!(
                others.iter().all(|other| other.name != words.name),
                "{}",
                words.name
            );
            assert_eq!(effect_words(words.name), Some(*words));
        }
        assert_eq!(effect_words("no-such-effect"), None);
    }

    /// A name in the list that the catalogue does not know is a spelling mistake.
    #[test]
    fn words_are_of_effects_of_the_catalogue() {
        let names = haptical_diagnosis::effect_names();
        for words in WORDS {
            assert!(names.contains(&words.name), "{}", words.name);
        }
    }
}
