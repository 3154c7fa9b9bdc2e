//! Drums, cables and discs that are not round or not centred, and joints that pull on each other.

use std::f64::consts::TAU;

use crate::effects::{Draw, Effect, Facts, Info, Stage, fixed};
use crate::laws::slope_of;
use crate::rig::scene::Scene;

/// A profile of the joint's output angle alone, zero at home.
fn of_angle(
    info: Info,
    stage: Stage,
    facts: Facts,
    profile: impl Fn(f64) -> f64 + Send + Sync + 'static,
) -> Effect {
    let joint = info.joint.unwrap_or(0);
    let law = move |scene: &Scene<'_>, _: &[f64]| {
        let home = profile(0.0);
        let angles = scene.motion.angle_rad[joint].iter();
        angles.map(|angle| profile(*angle) - home).collect()
    };
    Effect::added(info, stage, fixed(facts), law)
}

/// A convex output drum with two lobes (and a little of three): the strand unwinds from its
/// circumference and its point of contact wanders.
///
/// A drum with support function `p(psi)` that is turned to the contact angle `psi` has released the
/// length `integral p dpsi` (Cauchy's formula with the shift of the point of contact); the strand's
/// direction turns by the change of `p` over the length `l` of the free strand.
pub(crate) fn out_of_round(draw: &mut Draw<'_>) -> Effect {
    // half the relative out-of-roundness of the two-lobe part: the amplitude at the joint
    let amplitude_rad = draw.amplitude(1.2e-3);
    let phase_rad = draw.random.phase_rad();
    let three_lobes = draw.random.uniform(0.0, 0.06);
    let three_phase_rad = draw.random.phase_rad();
    // radius over the free strand's length
    let radius_per_strand = draw.random.uniform(0.2, 0.5);
    // sin(2 psi)/2 and the strand's turn, a quarter of a period apart
    let turn = 2.0 * radius_per_strand;
    let amplitude = amplitude_rad.abs() * libm::hypot(1.0, turn);
    let facts = Facts::default()
        .with("amplitude_rad", amplitude)
        .law("three_lobes", three_lobes);
    let depth = 2.0 * amplitude_rad;
    let profile = move |angle: f64| {
        let support = depth
            * (libm::cos(2.0 * angle + phase_rad)
                + three_lobes * libm::cos(3.0 * angle + three_phase_rad));
        let psi = angle + radius_per_strand * support;
        let released = psi
            + depth
                * (libm::sin(2.0 * psi + phase_rad) / 2.0
                    + three_lobes * libm::sin(3.0 * psi + three_phase_rad) / 3.0);
        released - angle
    };
    let info = draw.at_joint("drum-out-of-round", &["drum-out-of-round", "cable-pitch"]);
    of_angle(info, Stage::Upstream, facts, profile)
}

/// The strand's pitch: it runs off at an angle, so that its length is a hypotenuse.
pub(crate) fn cable_pitch(draw: &mut Draw<'_>) -> Effect {
    let quadratic_per_rad = draw.signed(6e-3);
    let lead_rad = draw.random.uniform(1.5, 4.0);
    let centre_rad = draw.random.uniform(-0.4, 0.4);
    let facts = Facts::default()
        .with("quadratic_per_rad", quadratic_per_rad)
        .laws(named!(lead_rad, centre_rad));
    let profile = move |angle: f64| {
        let turned = (angle - centre_rad) / lead_rad;
        2.0 * quadratic_per_rad * lead_rad * lead_rad * (libm::hypot(1.0, turned) - 1.0)
    };
    let info = draw.at_joint("cable-pitch", &["cable-pitch", "drum-out-of-round"]);
    of_angle(info, Stage::Upstream, facts, profile)
}

/// Ripple of the input drum: a higher harmonic, with the smaller one of the next order that comes with it.
pub(crate) fn input_harmonic(draw: &mut Draw<'_>) -> Effect {
    let amplitude_rad = draw.amplitude(0.4e-3);
    let phase_rad = draw.random.phase_rad();
    let order = 2.0 + draw.random.index(3) as f64;
    let next_share = draw.random.uniform(-0.05, 0.05);
    let ratio = draw.device.joints[draw.joint].transmission_ratio;
    let facts = Facts::default()
        .with("amplitude_rad", amplitude_rad)
        .with("order", order)
        .law("next", next_share);
    let profile = move |angle: f64| {
        let motor = order * ratio * angle + phase_rad;
        let next = (order + 1.0) * ratio * angle;
        amplitude_rad * (libm::sin(motor) + next_share * libm::sin(next))
    };
    let info = draw.at_joint("input-drum-harmonic", &["input-drum-harmonic"]);
    of_angle(info, Stage::Upstream, facts, profile)
}

/// The external encoder's disc has its grating off its axis: it reads the arc seen from the grating's centre.
pub(crate) fn external_eccentricity(draw: &mut Draw<'_>) -> Effect {
    let eccentricity = draw.amplitude(2e-3);
    let phase_rad = draw.random.phase_rad();
    let facts = Facts::default().with("amplitude_rad", eccentricity.abs());
    let profile = move |angle: f64| {
        let (sin, cos) = libm::sincos(angle + phase_rad);
        libm::atan2(eccentricity * sin, 1.0 + eccentricity * cos)
    };
    let name = "external-encoder-eccentricity";
    let info = draw.at_joint(name, &[name]);
    of_angle(info, Stage::External, facts, profile)
}

/// The measuring cable's drum sits off its axis: the distance from the guide to a tangent point of a circle whose centre runs
/// on a circle. The free strand changes along its direction and, in the second order, across it.
pub(crate) fn cable_drum(draw: &mut Draw<'_>) -> Effect {
    let eccentricity_m = draw.amplitude(80e-6);
    let phase_rad = draw.random.uniform(0.0, TAU);
    // free strand from the drum to the guide
    let free_m = draw.random.uniform(0.03, 0.1);
    let facts = Facts::default().with("amplitude_m", eccentricity_m.abs());
    let law = move |scene: &Scene<'_>, signal: &[f64]| {
        let cable = scene.device.cables.first();
        let radius_m = cable.and_then(|cable| cable.drum_radius_m).unwrap_or(0.015);
        let strand_m = |length_m: &f64| {
            let (sin, cos) = libm::sincos(length_m / radius_m + phase_rad);
            libm::hypot(free_m + eccentricity_m * sin, eccentricity_m * cos)
        };
        let home_m = signal.first().map_or(0.0, strand_m);
        let signal = signal.iter().map(|length_m| strand_m(length_m) - home_m);
        signal.collect()
    };
    let info = draw.anywhere("cable-drum-eccentricity", &["cable-drum-eccentricity"]);
    Effect::added(info, Stage::Cable, fixed(facts), law)
}

/// Coupling from another joint, mostly a neighbour: the joint's cable runs over its axis and is drawn a little when that turns.
pub(crate) fn cross_coupling(draw: &mut Draw<'_>) -> Effect {
    let joints = draw.device.joints.len();
    let mut from = if draw.joint > 0 { draw.joint - 1 } else { 1 };
    if draw.random.unit() < 0.4 || from >= joints {
        from = draw.other_joint();
    }
    let gain = draw.signed(2e-3);
    let curvature = draw.random.uniform(-0.05, 0.05);
    let law = move |scene: &Scene<'_>, _: &[f64]| -> Vec<f64> {
        let angles = scene.motion.angle_rad[from].iter();
        angles
            .map(|angle| gain * angle * (1.0 + curvature * angle))
            .collect()
    };
    let facts = move |scene: &Scene<'_>| {
        let angle = &scene.motion.angle_rad[from];
        Facts::default()
            .with("gain", slope_of(angle, &law(scene, &[])))
            .with("from_joint", from as f64 + 1.0)
            .law("curvature_per_rad", curvature)
    };
    let info = draw.at_joint("cross-coupling", &["cross-coupling"]);
    Effect::added(info, Stage::Upstream, facts, law)
}
