//! Industrial arms of 6 and 7 joints with masses and a load: the file that a lab would write, and the arm that it has.

use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;

use anyhow::Result;
use haptical_model::Device;

use crate::random::Random;

/// One row of a data sheet: lengths relative to the arm's scale.
struct Row {
    a: f64,
    alpha: f64,
    d: f64,
    home: f64,
    /// Share of the arm's mass.
    mass: f64,
    /// Centre of mass along x and z of the turned frame, relative to the scale.
    centre: [f64; 2],
    reach: f64,
}

/// Shoulder, elbow and a wrist of three intersecting axes.
const SIX: [Row; 6] = rows! {
    Row {a alpha d home mass centre reach}
    0.16, -FRAC_PI_2, 0.45, 0.0, 0.3, [0.05, 0.2], 2.6;
    0.64, 0.0, 0.0, -FRAC_PI_2, 0.3, [0.3, 0.05], 1.0;
    0.12, -FRAC_PI_2, 0.0, 0.0, 0.2, [0.06, 0.0], 1.0;
    0.0, FRAC_PI_2, 0.65, 0.0, 0.12, [0.0, 0.3], 2.6;
    0.0, -FRAC_PI_2, 0.0, 0.0, 0.05, [0.0, 0.03], 1.7;
    0.0, 0.0, 0.12, 0.0, 0.03, [0.0, 0.05], 2.8;
};
/// Shoulder, elbow and wrist of three axes, three and one.
const SEVEN: [Row; 7] = rows! {
    Row {a alpha d home mass centre reach}
    0.0, -FRAC_PI_2, 0.36, 0.0, 0.22, [0.0, 0.2], 2.4;
    0.0, FRAC_PI_2, 0.0, 0.0, 0.2, [0.0, 0.05], 1.7;
    0.0, FRAC_PI_2, 0.42, 0.0, 0.18, [0.0, 0.25], 2.4;
    0.0, -FRAC_PI_2, 0.0, 0.0, 0.16, [0.0, 0.05], 1.7;
    0.0, -FRAC_PI_2, 0.4, 0.0, 0.12, [0.0, 0.25], 2.4;
    0.0, FRAC_PI_2, 0.0, 0.0, 0.08, [0.0, 0.02], 1.7;
    0.0, 0.0, 0.13, 0.0, 0.04, [0.0, 0.05], 2.6;
};

/// A measured arm before it is known what measures it.
#[derive(Debug, Clone)]
pub(crate) struct Arm {
    /// File without a tracker.
    text: String,
    pub(crate) nominal: Device,
    /// With its true lengths, angles and masses.
    pub(crate) truth: Device,
    /// Length that the others are relative to \[m\].
    pub(crate) scale_m: f64,
}

/// Geometry of an arm as delivered: lengths \[m\] and angles \[rad\].
const LENGTH_SD_M: f64 = 6e-4;
const ANGLE_SD_RAD: f64 = 8e-4;
/// Relative deviation of a mass from the file's, and deviation of a centre relative to the scale.
const MASS_SD: f64 = 0.07;
const CENTRE_SD: f64 = 0.01;
/// No deviation is larger than this many standard deviations.
const CUT: f64 = 2.5;

impl Arm {
    /// A random arm, nominal and as it was made.
    pub(crate) fn draw(random: &mut Random) -> Result<Self> {
        let rows: &[Row] = if random.unit() < 0.7 { &SIX } else { &SEVEN };
        let scale_m = random.around(0.9, 3.0);
        let mass_kg = 60.0 * scale_m * scale_m * random.uniform(0.7, 1.4);
        let load_kg = mass_kg * random.uniform(0.03, 0.12);
        let stretch = |random: &mut Random| random.uniform(0.85, 1.2);
        let mut text = format!(
            "[device]\nname = \"arm{}\"\ndof = {}\n",
            rows.len(),
            rows.len()
        );
        text.push_str("\n[gravity]\nvector_mps2 = [0.0, 0.0, -9.81]\n");
        text.push_str("\n[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n");
        for (index, row) in rows.iter().enumerate() {
            let (a, d) = (row.a * stretch(random), row.d * stretch(random));
            let mut mass = mass_kg * row.mass * stretch(random);
            let mut centre = row.centre.map(|along| along * scale_m);
            if index + 1 == rows.len() {
                let own = mass;
                mass += load_kg;
                let beyond = scale_m * random.uniform(0.08, 0.2);
                centre = [0.3 * beyond, (own * centre[1] + load_kg * beyond) / mass];
            }
            let _ = write!(
                text,
                "\n[[link]]\na_m = {:.4}\nalpha_rad = {}\nd_m = {:.4}\nmass_kg = {:.3}\n\
                 centre_of_mass_m = [{:.4}, 0.0, {:.4}]\n",
                a * scale_m,
                row.alpha,
                d * scale_m,
                mass,
                centre[0],
                centre[1]
            );
        }
        for row in rows {
            let _ = write!(
                text,
                "\n[[joint]]\nhome_rad = {}\nlower_rad = {}\nupper_rad = {}\ntransmission = \"direct\"\n\
                 transmission_ratio = 1.0\nencoder_counts_per_rev = 10000000\n",
                row.home, -row.reach, row.reach
            );
        }
        let nominal = Device::from_toml(&text, "arm")?.device;
        let truth = as_made(&nominal, scale_m, random);
        Ok(Self {
            text,
            nominal,
            truth,
            scale_m,
        })
    }

    /// The file with the tracker that measures it; a standard deviation of 0 is not stated.
    pub(crate) fn file(&self, position_sd_m: f64, rotation_sd_rad: f64) -> String {
        let mut text = self.text.clone();
        text.push_str("\n[tracker]\nbase = \"unknown\"\ntool = \"unknown\"\n");
        for (key, sd) in [
            ("position_sd_m", position_sd_m),
            ("rotation_sd_rad", rotation_sd_rad),
        ] {
            if sd > 0.0 {
                let _ = writeln!(text, "{key} = {sd:.3e}");
            }
        }
        text
    }
}

fn as_made(nominal: &Device, scale_m: f64, random: &mut Random) -> Device {
    let mut device = nominal.clone();
    for link in device.links.iter_mut().skip(1) {
        link.a_m += LENGTH_SD_M * random.normal_within(CUT);
        link.d_m += LENGTH_SD_M * random.normal_within(CUT);
        link.alpha_rad += ANGLE_SD_RAD * random.normal_within(CUT);
        link.theta_rad += ANGLE_SD_RAD * random.normal_within(CUT);
    }
    for body in device.bodies.iter_mut().flatten() {
        body.mass_kg *= 1.0 + MASS_SD * random.normal_within(CUT);
        for along in &mut body.centre_of_mass_m {
            *along += CENTRE_SD * scale_m * random.normal_within(CUT);
        }
    }
    device
}
