//! Numbers whose size shows another unit than the one that they are read in: one rule for device files and robot descriptions.

use haptical_kinematics::nalgebra::Matrix3;

/// Length from which one in millimetres is suspected \[m\].
const LONG_M: f64 = 10.0;
/// Largest angle that a single turn needs, with the rounding of a file \[rad\]: one beyond it is taken for degrees.
pub const LARGEST_ANGLE_RAD: f64 = std::f64::consts::TAU + 1e-3;
/// Largest joint limit taken for radians: nearly five turns. Thirty and more are degrees.
pub const LARGEST_LIMIT_RAD: f64 = 29.0;
/// Two turns in degrees: a limit beyond them is written where there is none.
const MOST_DEGREES: f64 = 720.0;
/// A limit of a slide from which on there is none \[m\]; exporters write 1000 there, too.
const NO_LIMIT_M: [f64; 2] = [1e3, 1e4];
/// Density of the heaviest metals \[kg/m^3\].
const DENSEST_KG_PER_M3: f64 = 2e4;
/// Share of the inertia of a ball of that metal below which a mass is taken for grams: a radius of gyration of a twentieth.
const TOO_SMALL: f64 = 1.0 / 400.0;
/// Below this mass a large inertia is that of a rotor \[kg\].
const LIGHT_KG: f64 = 0.01;

/// What a length asks that is probably in millimetres: `is 300 m; if it is in millimetres, write 0.3`.
///
/// ```
/// use haptical_model::sizes::length_question;
/// assert_eq!(length_question(-300.0).as_deref(), Some("is -300 m; if it is in millimetres, write -0.3"));
/// assert_eq!(length_question(3.0), None);
/// ```
pub fn length_question(length_m: f64) -> Option<String> {
    (length_m.abs() > LONG_M).then(|| {
        let meant_m = length_m / 1000.0;
        format!("is {length_m} m; if it is in millimetres, write {meant_m}")
    })
}

/// What an angle of the geometry asks that is probably in degrees.
///
/// ```
/// use haptical_model::sizes::angle_question;
/// assert_eq!(angle_question(90.0).as_deref(), Some("is 90 rad; if it is in degrees, write 1.570796"));
/// assert_eq!(angle_question(-6.2832), None);
/// ```
pub fn angle_question(angle_rad: f64) -> Option<String> {
    (angle_rad.abs() > LARGEST_ANGLE_RAD).then(|| {
        let meant_rad = angle_rad.to_radians();
        format!("is {angle_rad} rad; if it is in degrees, write {meant_rad:.6}")
    })
}

/// What the limit of a joint that turns asks that is probably in degrees; it is no limit then.
///
/// ```
/// use haptical_model::sizes::limit_question;
/// let said = "is -180 rad, which is taken as no limit; if it is in degrees, write -3.141593";
/// assert_eq!(limit_question(-180.0).as_deref(), Some(said));
/// assert!(limit_question(6.3).is_none() && limit_question(1e6).is_none());
/// ```
pub fn limit_question(limit_rad: f64) -> Option<String> {
    let is_odd = (LARGEST_LIMIT_RAD..=MOST_DEGREES).contains(&limit_rad.abs());
    is_odd.then(|| {
        let meant_rad = limit_rad.to_radians();
        format!("is {limit_rad} rad, which is taken as no limit; if it is in degrees, write {meant_rad:.6}")
    })
}

/// What the limit of a slide asks that is probably in millimetres.
///
/// ```
/// use haptical_model::sizes::slide_limit_question;
/// assert_eq!(slide_limit_question(250.0).as_deref(), Some("is 250 m; if it is in millimetres, write 0.25"));
/// assert!(slide_limit_question(0.25).is_none() && slide_limit_question(1000.0).is_none());
/// ```
pub fn slide_limit_question(limit_m: f64) -> Option<String> {
    let [exporters, none] = NO_LIMIT_M;
    let size_m = limit_m.abs();
    length_question(limit_m).filter(|_| size_m != exporters && size_m < none)
}

/// What a mass asks that is probably in grams, or an inertia that is probably in kg mm^2: no matter is so dense, or no link so
/// wide.
///
/// ```
/// use haptical_model::kinematics::nalgebra::Matrix3;
/// use haptical_model::sizes::mass_question;
/// let of = |mass_kg, moment| mass_question(mass_kg, &(Matrix3::identity() * moment));
/// assert!(of(1000.0, 0.01).is_some_and(|said| said.ends_with("if the mass is in grams, write 1")));
/// assert!(of(1.0, 10_000.0).is_some_and(|said| said.ends_with("write a millionth")));
/// assert!(of(1.0, 0.01).is_none() && of(1.0, 0.0).is_none());
/// ```
pub fn mass_question(mass_kg: f64, inertia_kgm2: &Matrix3<f64>) -> Option<String> {
    let moment = inertia_kgm2.trace() / 3.0;
    if !(mass_kg > 0.0 && moment > 0.0 && mass_kg.is_finite() && moment.is_finite()) {
        return None;
    }
    let radius_m = libm::sqrt(moment / mass_kg);
    let volume_m3 = mass_kg / DENSEST_KG_PER_M3;
    let ball_m = libm::cbrt(3.0 * volume_m3 / (4.0 * std::f64::consts::PI));
    let of_ball = 0.4 * mass_kg * ball_m * ball_m;
    if moment < TOO_SMALL * of_ball {
        let meant_kg = mass_kg / 1000.0;
        return Some(format!(
            "has {mass_kg} kg with a radius of gyration of {:.2} mm, and no matter is so dense; if the mass is in grams, write \
             {meant_kg}",
            1e3 * radius_m
        ));
    }
    (radius_m > LONG_M && mass_kg >= LIGHT_KG).then(|| {
        format!(
            "has {mass_kg} kg with a radius of gyration of {radius_m:.0} m; if the inertia is in kg mm^2, write a millionth"
        )
    })
}
