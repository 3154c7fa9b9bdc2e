//! Stated deviations of link parameters from the device file: zero where a user knows a number, larger than usual where
//! a user knows that it is uncertain.

use crate::{Device, Parameter};

/// Words for several numbers of a row.
const GROUPS: [(&str, &[Parameter]); 3] = [
    ("lengths", &[Parameter::A, Parameter::B, Parameter::D]),
    ("twists", &[Parameter::Alpha, Parameter::Beta]),
    ("offsets", &[Parameter::Theta]),
];
/// Words for one.
const WORDS: [(&str, &[Parameter]); 6] = [
    ("a", &[Parameter::A]),
    ("b", &[Parameter::B]),
    ("d", &[Parameter::D]),
    ("alpha", &[Parameter::Alpha]),
    ("theta", &[Parameter::Theta]),
    ("beta", &[Parameter::Beta]),
];

/// Keys of a `[[link]]` for the plausible deviation of each number.
pub(crate) const DEVIATION_KEYS: [(Parameter, &str); 6] = [
    (Parameter::A, "a_deviation_m"),
    (Parameter::B, "b_deviation_m"),
    (Parameter::D, "d_deviation_m"),
    (Parameter::Alpha, "alpha_deviation_rad"),
    (Parameter::Theta, "theta_offset_deviation_rad"),
    (Parameter::Beta, "beta_deviation_rad"),
];

/// A word that names no number of a link.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{word}` names no numbers of links: lengths, twists, offsets, a, b, d, alpha, theta or beta are \
     those of all rows but the base's; with a row's number, as in a3 or theta0, of that row (0 to {last})"
)]
pub struct UnknownNumbers {
    /// The word.
    pub word: String,
    /// Last row.
    pub last: usize,
}

/// The numbers of a row that a word means.
pub(crate) fn numbers_of(word: &str) -> Option<&'static [Parameter]> {
    let known = GROUPS
        .iter()
        .chain(&WORDS)
        .find(|(known, _)| *known == word);
    known.map(|(_, numbers)| *numbers)
}

impl Device {
    /// Keeps numbers of links in every calibration: `lengths`, `twists`, `offsets`, or one of `a`, `b`, `d`, `alpha`,
    /// `theta`, `beta`, of all rows but the base's; with a row's number of that row alone. A device file says so row
    /// by row: `hold = ["lengths"]`.
    ///
    /// Touches of a humanoid, whose links are as drawn and whose joints are mounted a few degrees off, identify offsets
    /// well only where lengths are held.
    ///
    /// ```
    /// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
    /// let mut device = haptical_model::Device::load(path.as_ref())?.device;
    /// device.hold("lengths")?;
    /// device.hold("alpha2")?;
    /// assert!(device.is_held(3, haptical_model::Parameter::D));
    /// assert!(!device.is_held(3, haptical_model::Parameter::Alpha));
    /// assert!(device.hold("length").is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`UnknownNumbers`].
    pub fn hold(&mut self, word: &str) -> Result<(), UnknownNumbers> {
        self.expect_deviation(word, 0.0)
    }

    /// States how far numbers of links may plausibly be from the device's \[m\] or \[rad\], words as for
    /// [`Device::hold`]; 0 holds them. A device file says so row by row: `theta_offset_deviation_rad = 0.06`.
    ///
    /// A calibration keeps what the recording fixes no better than to half of this size, and doubts what moves by ten
    /// times this size. Where nothing is stated it is 5 mm and 20 mrad, as of a machined device.
    ///
    /// # Errors
    /// [`UnknownNumbers`].
    pub fn expect_deviation(&mut self, word: &str, size: f64) -> Result<(), UnknownNumbers> {
        let last = self.links.len().saturating_sub(1);
        let unknown = || UnknownNumbers {
            word: word.to_owned(),
            last,
        };
        let name = word.trim_end_matches(|letter: char| letter.is_ascii_digit());
        let numbers = numbers_of(name).ok_or_else(unknown)?;
        let rows = match &word[name.len()..] {
            "" => 1..=last,
            row => {
                let row = row.parse().ok().filter(|row| *row <= last);
                let row: usize = row.ok_or_else(unknown)?;
                row..=row
            }
        };
        for row in rows {
            let numbers = numbers.iter().map(|number| ((row, *number), size));
            self.deviations.extend(numbers);
        }
        Ok(())
    }

    /// How far a number of a row may plausibly be off, where it is stated.
    pub fn deviation(&self, row: usize, number: Parameter) -> Option<f64> {
        self.deviations.get(&(row, number)).copied()
    }

    /// Whether a calibration keeps a number of a row.
    pub fn is_held(&self, row: usize, number: Parameter) -> bool {
        self.deviation(row, number) == Some(0.0)
    }
}
