//! The names that `effects.toml` may contain.

/// An effect that this crate can simulate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Known {
    /// Name.
    pub(crate) name: &'static str,
    /// Keys beside `name`.
    pub(crate) parameters: &'static [&'static str],
    /// Whether it acts on links, or needs the torque that links make.
    pub(crate) needs_links: bool,
    /// Whether it acts on the cable encoder.
    pub(crate) needs_cable: bool,
}

const fn joint(name: &'static str, parameters: &'static [&'static str]) -> Known {
    Known {
        name,
        parameters,
        needs_links: false,
        needs_cable: false,
    }
}

const fn links(name: &'static str, parameters: &'static [&'static str]) -> Known {
    Known {
        needs_links: true,
        ..joint(name, parameters)
    }
}

const fn cable(name: &'static str, parameters: &'static [&'static str]) -> Known {
    Known {
        needs_cable: true,
        ..links(name, parameters)
    }
}

/// All effects, in the order of the catalogue of docs/diagnosis.md.
pub(crate) const KNOWN: [Known; 19] = [
    links("capstan-compliance", &["joint", "stiffness_nm_per_rad"]),
    joint("backlash", &["joint", "width_rad", "driven_by"]),
    joint(
        "hysteresis",
        &["joint", "amplitude_rad", "transition_rad", "driven_by"],
    ),
    joint("viscous-lag", &["joint", "delay_s"]),
    joint("encoder-count-loss", &["joint", "counts", "time_s"]),
    joint("joint-drift", &["joint", "rad_per_s", "rad_per_degc"]),
    joint("external-encoder-latency", &["joint", "delay_s"]),
    joint("encoder-latency", &["delay_s"]),
    cable("cable-zero-offset", &["offset_m"]),
    cable("cable-twist", &["twist_m_per_rad2"]),
    cable("cable-exit-geometry", &["radius_m"]),
    cable("cable-drum-eccentricity", &["amplitude_m", "phase_rad"]),
    cable("thermal-drift", &["m_per_degc"]),
    cable("cable-drift", &["m_per_s"]),
    cable("cable-latency", &["delay_s"]),
    links("joint-compliance", &["joint", "stiffness_nm_per_rad"]),
    links(
        "axis-wobble",
        &["joint", "amplitude_rad", "phase_rad", "order"],
    ),
    links("base-compliance", &["rad_per_nm"]),
    links("tool-compliance", &["m_per_n"]),
];

/// Names of the effects that can be simulated.
pub fn simulated_effects() -> Vec<&'static str> {
    KNOWN.iter().map(|known| known.name).collect()
}

/// Keys of an effect in `effects.toml`, beside `name`; none for an effect that cannot be simulated.
pub fn simulated_keys(name: &str) -> Option<&'static [&'static str]> {
    known(name).map(|known| known.parameters)
}

pub(crate) fn known(name: &str) -> Option<&'static Known> {
    KNOWN.iter().find(|known| known.name == name)
}

/// Likeness (Jaro & Winkler's) from which a name is offered in place of a wrong one.
const LIKENESS: f64 = 0.8;

/// The one of `names` that is most like `wrong`, as a question, or nothing.
pub(crate) fn did_you_mean(wrong: &str, names: &[&str]) -> String {
    let likeness = |name: &str| strsim::jaro_winkler(wrong, name);
    let nearest = names
        .iter()
        .copied()
        .max_by(|a, b| likeness(a).total_cmp(&likeness(b)))
        .filter(|name| likeness(name) > LIKENESS);
    nearest.map_or_else(String::new, |name| format!("did you mean `{name}`? "))
}
