//! Drums, cables and discs that are not round or not centred, and joints that pull on each other.

use std::f64::consts::TAU;

use crate::effects::added::{Added, Law, Place};
use crate::effects::{Draw, Effect, Facts};
use crate::laws::slope_of;
use crate::rig::scene::Scene;

/// A function of one angle alone.
trait Profile: std::fmt::Debug + Send + Sync {
    fn value(&self, angle: f64) -> f64;
    fn facts(&self) -> Facts;
}

/// A profile of the joint's output angle, zero at home.
#[derive(Debug)]
struct OfAngle<P>(P);

impl<P: Profile> Law for OfAngle<P> {
    fn deviation(&self, scene: &Scene<'_>, place: Place, _signal: &[f64]) -> Vec<f64> {
        let home = self.0.value(0.0);
        place.joint().map_or_else(Vec::new, |joint| {
            let angles = scene.motion.angle_rad[joint].iter();
            angles.map(|angle| self.0.value(*angle) - home).collect()
        })
    }

    fn facts(&self, _scene: &Scene<'_>, _place: Place) -> Facts {
        self.0.facts()
    }
}

/// A convex output drum with two lobes (and a little of three): the strand unwinds from its
/// circumference and its point of contact wanders.
///
/// A drum with support function `p(psi)` that is turned to the contact angle `psi` has released the
/// length `integral p dpsi` (Cauchy's formula with the shift of the point of contact); the strand's
/// direction turns by the change of `p` over the length `l` of the free strand.
#[derive(Debug)]
struct Lobes {
    /// Half the relative out-of-roundness of the two-lobe part \[rad\]: the amplitude at the joint.
    amplitude_rad: f64,
    phase_rad: f64,
    three_lobes: f64,
    three_phase_rad: f64,
    /// Radius over the free strand's length.
    radius_per_strand: f64,
}

impl Profile for Lobes {
    fn value(&self, angle: f64) -> f64 {
        let depth = 2.0 * self.amplitude_rad;
        let support = |psi: f64| {
            depth
                * (libm::cos(2.0 * psi + self.phase_rad)
                    + self.three_lobes * libm::cos(3.0 * psi + self.three_phase_rad))
        };
        let released = |psi: f64| {
            psi + depth
                * (libm::sin(2.0 * psi + self.phase_rad) / 2.0
                    + self.three_lobes * libm::sin(3.0 * psi + self.three_phase_rad) / 3.0)
        };
        let contact = angle + self.radius_per_strand * support(angle);
        released(contact) - angle
    }

    fn facts(&self) -> Facts {
        // sin(2 psi)/2 and the strand's turn, a quarter of a period apart
        let turn = 2.0 * self.radius_per_strand;
        Facts::default()
            .with(
                "amplitude_rad",
                self.amplitude_rad.abs() * libm::hypot(1.0, turn),
            )
            .law("three_lobes", self.three_lobes)
    }
}

/// The output drum is oval.
pub(crate) fn out_of_round(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = OfAngle(Lobes {
        amplitude_rad: draw.amplitude(1.2e-3),
        phase_rad: draw.random.phase_rad(),
        three_lobes: draw.random.uniform(0.0, 0.06),
        three_phase_rad: draw.random.phase_rad(),
        radius_per_strand: draw.random.uniform(0.2, 0.5),
    });
    let names = ["drum-out-of-round", "cable-pitch"];
    let info = draw.at_joint("drum-out-of-round", &names);
    Added::boxed(info, Place::Upstream(draw.joint), law)
}

/// A strand that runs off at an angle: its length is a hypotenuse.
#[derive(Debug)]
struct Helix {
    quadratic_per_rad: f64,
    lead_rad: f64,
    centre_rad: f64,
}

impl Profile for Helix {
    fn value(&self, angle: f64) -> f64 {
        let turned = (angle - self.centre_rad) / self.lead_rad;
        2.0 * self.quadratic_per_rad
            * self.lead_rad
            * self.lead_rad
            * (libm::hypot(1.0, turned) - 1.0)
    }

    fn facts(&self) -> Facts {
        Facts::default()
            .with("quadratic_per_rad", self.quadratic_per_rad)
            .law("lead_rad", self.lead_rad)
            .law("centre_rad", self.centre_rad)
    }
}

/// The strand's pitch.
pub(crate) fn cable_pitch(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = OfAngle(Helix {
        quadratic_per_rad: draw.signed(6e-3),
        lead_rad: draw.random.uniform(1.5, 4.0),
        centre_rad: draw.random.uniform(-0.4, 0.4),
    });
    let names = ["cable-pitch", "drum-out-of-round"];
    let info = draw.at_joint("cable-pitch", &names);
    Added::boxed(info, Place::Upstream(draw.joint), law)
}

/// A higher harmonic of the input drum, with the smaller one of the next order that comes with it.
#[derive(Debug)]
struct Harmonic {
    amplitude_rad: f64,
    phase_rad: f64,
    order: f64,
    next: f64,
    ratio: f64,
}

impl Profile for Harmonic {
    fn value(&self, angle: f64) -> f64 {
        let motor = self.order * self.ratio * angle + self.phase_rad;
        let next = (self.order + 1.0) * self.ratio * angle;
        self.amplitude_rad * (libm::sin(motor) + self.next * libm::sin(next))
    }

    fn facts(&self) -> Facts {
        Facts::default()
            .with("amplitude_rad", self.amplitude_rad)
            .with("order", self.order)
            .law("next", self.next)
    }
}

/// Ripple of the input drum.
pub(crate) fn input_harmonic(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = OfAngle(Harmonic {
        amplitude_rad: draw.amplitude(0.4e-3),
        phase_rad: draw.random.phase_rad(),
        order: 2.0 + draw.random.index(3) as f64,
        next: draw.random.uniform(-0.05, 0.05),
        ratio: draw.device.joints[draw.joint].transmission_ratio,
    });
    let info = draw.at_joint("input-drum-harmonic", &["input-drum-harmonic"]);
    Added::boxed(info, Place::Upstream(draw.joint), law)
}

/// A disc whose grating is off its axis: the reading of the arc seen from the grating's centre.
#[derive(Debug)]
struct Disc {
    eccentricity: f64,
    phase_rad: f64,
}

impl Profile for Disc {
    fn value(&self, angle: f64) -> f64 {
        let (sin, cos) = libm::sincos(angle + self.phase_rad);
        libm::atan2(self.eccentricity * sin, 1.0 + self.eccentricity * cos)
    }

    fn facts(&self) -> Facts {
        Facts::default().with("amplitude_rad", self.eccentricity.abs())
    }
}

/// The external encoder sits off its axis.
pub(crate) fn external_eccentricity(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = OfAngle(Disc {
        eccentricity: draw.amplitude(2e-3),
        phase_rad: draw.random.phase_rad(),
    });
    let name = "external-encoder-eccentricity";
    let info = draw.at_joint(name, &["external-encoder-eccentricity"]);
    Added::boxed(info, Place::External(draw.joint), law)
}

/// The measuring cable's drum sits off its axis.
#[derive(Debug)]
struct CableDrum {
    eccentricity_m: f64,
    phase_rad: f64,
    /// Free strand from the drum to the guide \[m\].
    strand_m: f64,
}

impl Law for CableDrum {
    /// The distance from the guide to a tangent point of a circle whose centre runs on a circle: the
    /// free strand changes along its direction and, in the second order, across it.
    fn deviation(&self, scene: &Scene<'_>, _place: Place, signal: &[f64]) -> Vec<f64> {
        let radius_m = drum_radius_m(scene);
        let strand_m = |length_m: f64| {
            let (sin, cos) = libm::sincos(length_m / radius_m + self.phase_rad);
            let along_m = self.strand_m + self.eccentricity_m * sin;
            libm::hypot(along_m, self.eccentricity_m * cos)
        };
        let home_m = signal.first().map_or(0.0, |first| strand_m(*first));
        signal
            .iter()
            .map(|length_m| strand_m(*length_m) - home_m)
            .collect()
    }

    fn facts(&self, _scene: &Scene<'_>, _place: Place) -> Facts {
        Facts::default().with("amplitude_m", self.eccentricity_m.abs())
    }
}

fn drum_radius_m(scene: &Scene<'_>) -> f64 {
    let radius_m = scene
        .device
        .cables
        .first()
        .and_then(|cable| cable.drum_radius_m);
    radius_m.unwrap_or(0.015)
}

/// The measuring cable's drum sits off its axis.
pub(crate) fn cable_drum(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = CableDrum {
        eccentricity_m: draw.amplitude(80e-6),
        phase_rad: draw.random.uniform(0.0, TAU),
        strand_m: draw.random.uniform(0.03, 0.1),
    };
    let info = draw.anywhere("cable-drum-eccentricity", &["cable-drum-eccentricity"]);
    Added::boxed(info, Place::Cable, law)
}

/// A joint's cable runs over another joint's axis: it is drawn a little when that one turns.
#[derive(Debug)]
struct Coupling {
    gain: f64,
    from: usize,
    curvature: f64,
}

impl Law for Coupling {
    fn deviation(&self, scene: &Scene<'_>, _place: Place, _signal: &[f64]) -> Vec<f64> {
        scene.motion.angle_rad[self.from]
            .iter()
            .map(|angle| self.gain * angle * (1.0 + self.curvature * angle))
            .collect()
    }

    fn facts(&self, scene: &Scene<'_>, place: Place) -> Facts {
        let angle = &scene.motion.angle_rad[self.from];
        Facts::default()
            .with("gain", slope_of(angle, &self.deviation(scene, place, &[])))
            .with("from_joint", self.from as f64 + 1.0)
            .law("curvature_per_rad", self.curvature)
    }
}

/// Coupling from another joint, mostly a neighbour.
pub(crate) fn cross_coupling(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let joints = draw.device.joints.len();
    let mut from = if draw.joint > 0 { draw.joint - 1 } else { 1 };
    if draw.random.unit() < 0.4 || from >= joints {
        let others: Vec<usize> = (0..joints).filter(|joint| *joint != draw.joint).collect();
        from = draw.random.choose(&others).unwrap_or(0);
    }
    let law = Coupling {
        gain: draw.signed(2e-3),
        from,
        curvature: draw.random.uniform(-0.05, 0.05),
    };
    let info = draw.at_joint("cross-coupling", &["cross-coupling"]);
    Added::boxed(info, Place::Upstream(draw.joint), law)
}
