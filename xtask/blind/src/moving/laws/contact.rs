//! A wall in the flange's way for a part of the log.

use haptical_model::kinematics::nalgebra::Vector3;

use super::{Draw, Drawn, Instant};

/// Power of the depth: between a flat stamp's 1 and a ball's 3/2.
const POWER: f64 = 1.3;
/// Damping over stiffness \[s/m\].
const DAMPING: f64 = 0.5;

/// Source: Hunt & Crossley, "Coefficient of restitution interpreted as damping in vibroimpact", Journal of Applied Mechanics
/// 42, 1975: `k d^p (1 + c d')`.
pub(crate) fn wall(draw: &mut Draw<'_>) -> Drawn {
    let reach: Vec<f64> = draw.flange_m.iter().map(Vector3::norm).collect();
    let lever_m = reach.iter().fold(0.1_f64, |most, value| value.max(most));
    let strongest = draw.arm.axes[0].range.max(draw.arm.axes[1].range);
    let force_n = draw.size * draw.random.uniform(0.25, 0.5) * strongest / lever_m;
    let (sine, cosine) = libm::sincos(draw.random.phase_rad());
    let down = match draw.arm.axes.iter().any(|axis| axis.slides) {
        true => 0.0,
        false => draw.random.uniform(-0.8, 0.3),
    };
    let normal = Vector3::new(cosine, sine, down).normalize();
    let from_s = draw.duration_s * draw.random.uniform(0.1, 0.3);
    let until_s = draw.duration_s * draw.random.uniform(0.7, 0.95);
    let along = draw.flange_m.iter().map(|place| normal.dot(place));
    let mut along: Vec<f64> = along.collect();
    along.sort_by(f64::total_cmp);
    let share = draw.random.uniform(0.12, 0.25);
    let last = along.len() - 1;
    let place_m = along[(last as f64 * (1.0 - share)) as usize];
    let deepest = (along[last] - place_m).max(1e-3);
    let stiffness = force_n / libm::pow(deepest, POWER);
    let press = move |instant: &Instant<'_>, torque: &mut [f64]| {
        if instant.time_s < from_s || instant.time_s > until_s {
            return;
        }
        let (at_m, velocity) = instant.at.flange();
        let depth = normal.dot(&at_m) - place_m;
        if depth > 0.0 {
            let rate = normal.dot(&velocity);
            let force_n = stiffness * libm::pow(depth, POWER) * (1.0 + DAMPING * rate);
            let force = normal * -force_n.max(0.0);
            instant.at.add_at_flange(&force, torque);
        }
    };
    let [normal_x, normal_y, normal_z]: [f64; 3] = normal.into();
    Drawn::new(|drawn| drawn.torque = Box::new(press))
        .with_all(named!(force_n, place_m, normal_x, normal_y, normal_z))
        .with_all(named!(from_s, until_s))
}
