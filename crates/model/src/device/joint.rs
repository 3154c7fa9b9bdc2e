//! A joint with its motor-side encoder, transmission and external encoder.

use std::f64::consts::TAU;

use haptical_kinematics::Motion;
use haptical_transmission::chebyshev::to_monomials;
use haptical_transmission::{
    Capstan, CapstanError, CapstanParallelogram, LawError, Parallelogram, chebyshev,
};

/// Relative standard deviation of a torque's scale, unless stated.
pub(crate) const TORQUE_SCALE_SD: f64 = 0.03;

/// What the joint variable does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointType {
    /// Rotation about z.
    Revolute,
    /// Translation along z.
    Prismatic,
}

/// How the motor drives the joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TransmissionKind {
    /// Cable drive between two drums.
    Capstan,
    /// Cable drive, then a parallelogram.
    Parallelogram,
    /// Motor on the joint.
    Direct,
}

/// Error of the transmission: output = reading + error(reading).
#[derive(Debug, Clone, PartialEq)]
pub enum TransmissionError {
    /// Equation (1). For a direct joint without drums the eccentricity's denominator is 1 m, so its
    /// numbers are angles.
    Capstan(CapstanError),
    /// Chebyshev polynomial on a range of readings, with its tangents beyond.
    Chebyshev {
        /// Range of readings that the polynomial was fitted on.
        range_rad: [f64; 2],
        /// Coefficients of T_0, T_1, ...
        coefficients: Vec<f64>,
    },
    /// Equations (1) and (2): a capstan followed by a parallelogram.
    Parallelogram {
        /// The capstan's error.
        capstan: CapstanError,
        /// Deviations of the four lengths \[m\].
        length_deviations_m: [f64; 4],
    },
}

impl TransmissionError {
    /// Coefficients of the powers of the reading that equal a polynomial \[rad/rad^i\]; none for another form, or where
    /// they leave the number range.
    ///
    /// ```
    /// use haptical_model::TransmissionError;
    /// // T_2(theta / 2) = 2 (theta / 2)^2 - 1
    /// let error = TransmissionError::Chebyshev { range_rad: [-2.0, 2.0], coefficients: vec![0.0, 0.0, 1.0] };
    /// assert_eq!(error.monomials().unwrap(), [-1.0, 0.0, 0.5]);
    /// assert!(TransmissionError::default().monomials().is_none());
    /// ```
    pub fn monomials(&self) -> Option<Vec<f64>> {
        let Self::Chebyshev {
            range_rad,
            coefficients,
        } = self
        else {
            return None;
        };
        let mut powers = vec![0.0; coefficients.len()];
        to_monomials(*range_rad, coefficients, &mut powers).ok()?;
        Some(powers)
    }
}

impl Default for TransmissionError {
    fn default() -> Self {
        Self::Capstan(CapstanError::default())
    }
}

/// A joint. Angles are \[rad\]; for a prismatic joint the same fields are \[m\].
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name.
    pub name: String,
    /// Whether a file gives a name that is a number; otherwise a name such as `2` is the number of a joint without one.
    pub has_numeric_name: bool,
    /// Revolute or prismatic.
    pub joint_type: JointType,
    /// Joint variable at home.
    pub home_rad: f64,
    /// Lower limit, from home.
    pub lower_rad: f64,
    /// Upper limit, from home.
    pub upper_rad: f64,
    /// Standard deviation of random poses about home.
    pub sampling_sd_rad: Option<f64>,
    /// Kind of transmission.
    pub transmission: TransmissionKind,
    /// Nominal ratio, motor to joint.
    pub transmission_ratio: f64,
    /// Distance between the drums \[m\].
    pub drum_distance_m: Option<f64>,
    /// Denominator of the input drum's term \[m\]; the drum distance where absent.
    pub input_drum_denominator_m: Option<f64>,
    /// Counts per revolution of the motor-side encoder.
    pub encoder_counts_per_rev: Option<f64>,
    /// Counts per revolution of the external encoder.
    pub external_encoder_counts_per_rev: Option<f64>,
    /// Standard deviation of the external encoder.
    pub external_encoder_sd_rad: Option<f64>,
    /// Relative standard deviation of the torque's scale.
    pub torque_scale_sd: f64,
    /// What the motor's rotor and the gear add to the inertia, seen at the joint: the rotor's inertia times the square of the
    /// gear's ratio \[kg m^2\], \[kg\] of a prismatic joint; none where nobody says.
    pub armature_kgm2: Option<f64>,
    /// Largest torque of the drive, seen at the joint \[N m\], \[N\]; none where nobody says.
    pub torque_limit_nm: Option<f64>,
    /// What the torque reads where the drive gives none \[N m\], \[N\]; none where nobody says.
    pub torque_offset_nm: Option<f64>,
    /// How much later the torque is logged than the position of the same moment \[s\]; none where nobody says.
    pub torque_delay_s: Option<f64>,
    /// Lengths of the parallelogram's bars \[m\].
    pub parallelogram_lengths_m: Option<[f64; 4]>,
    /// Error of the transmission.
    pub transmission_error: TransmissionError,
}

impl Default for Joint {
    /// A revolute joint without transmission, limits or external encoder.
    fn default() -> Self {
        Self {
            name: String::new(),
            has_numeric_name: false,
            joint_type: JointType::Revolute,
            home_rad: 0.0,
            lower_rad: f64::NEG_INFINITY,
            upper_rad: f64::INFINITY,
            sampling_sd_rad: None,
            transmission: TransmissionKind::Direct,
            transmission_ratio: 1.0,
            drum_distance_m: None,
            input_drum_denominator_m: None,
            encoder_counts_per_rev: None,
            external_encoder_counts_per_rev: None,
            external_encoder_sd_rad: None,
            torque_scale_sd: TORQUE_SCALE_SD,
            armature_kgm2: None,
            torque_limit_nm: None,
            torque_offset_nm: None,
            torque_delay_s: None,
            parallelogram_lengths_m: None,
            transmission_error: TransmissionError::default(),
        }
    }
}

impl Joint {
    /// Whether its name is more than the number that a file without names gives it.
    ///
    /// ```
    /// use haptical_model::Device;
    /// let joints = |text| Device::from_toml(text, "arm.toml").map(|read| read.device.joints);
    /// assert!(!joints("[[joint]]\n")?[0].has_own_name());
    /// assert!(joints("[[joint]]\nname = \"1\"\n")?[0].has_own_name());
    /// # Ok::<(), haptical_model::DeviceFileError>(())
    /// ```
    pub fn has_own_name(&self) -> bool {
        self.has_numeric_name || (!self.name.is_empty() && self.name.parse::<f64>().is_err())
    }

    /// The kinematics' word for the joint type.
    pub fn motion(&self) -> Motion {
        self.joint_type.motion()
    }

    /// Unit of what its drive exerts: `N m`, or `N` where it slides.
    pub fn torque_unit(&self) -> &'static str {
        match self.joint_type {
            JointType::Revolute => "N m",
            JointType::Prismatic => "N",
        }
    }

    /// Name of the column of a log that holds it, for the joint with this number from 1: `torque2_nm`.
    pub fn torque_column(&self, number: usize) -> String {
        match self.joint_type {
            JointType::Revolute => format!("torque{number}_nm"),
            JointType::Prismatic => format!("torque{number}_n"),
        }
    }

    /// Unit of readings: `rad` or `m`.
    pub fn unit(&self) -> &'static str {
        self.joint_type.unit()
    }

    /// The capstan's fixed dimensions. A joint without drums has denominators of 1 m.
    ///
    /// # Errors
    /// If ratio or distances are out of range.
    pub fn capstan(&self) -> Result<Capstan, LawError> {
        let distance = self.drum_distance_m.unwrap_or(1.0);
        Capstan::new(
            self.transmission_ratio,
            distance,
            self.input_drum_denominator_m.unwrap_or(distance),
        )
    }

    /// Step of the joint reading: one count of the motor-side encoder over the ratio.
    pub fn reading_quantum_rad(&self) -> Option<f64> {
        self.encoder_counts_per_rev
            .map(|counts| TAU / counts / self.transmission_ratio.abs())
    }

    /// Standard deviation of the external encoder: as stated, or 2 pi / counts / 3 (the paper).
    pub fn output_sd_rad(&self) -> Option<f64> {
        self.external_encoder_sd_rad.or_else(|| {
            self.external_encoder_counts_per_rev
                .map(|counts| TAU / counts / 3.0)
        })
    }

    /// Number of parameters of the transmission error.
    pub fn error_parameter_count(&self) -> usize {
        match &self.transmission_error {
            TransmissionError::Capstan(_) => 6,
            TransmissionError::Chebyshev { coefficients, .. } => coefficients.len(),
            TransmissionError::Parallelogram { .. } => 10,
        }
    }

    /// Whether the reading lies where the transmission error is known (a polynomial has a range).
    pub fn error_is_known_at(&self, reading_rad: f64) -> bool {
        match &self.transmission_error {
            TransmissionError::Chebyshev { range_rad, .. } => {
                chebyshev::contains(*range_rad, reading_rad)
            }
            TransmissionError::Capstan(_) | TransmissionError::Parallelogram { .. } => true,
        }
    }

    /// Transmission error at a reading: value, slope, and the derivatives with respect to the
    /// error's parameters written to `derivatives` ([`Joint::error_parameter_count`] entries).
    ///
    /// # Errors
    /// Whatever the transmission says of its numbers.
    pub fn evaluate_error(
        &self,
        reading_rad: f64,
        derivatives: &mut [f64],
    ) -> Result<(f64, f64), LawError> {
        match &self.transmission_error {
            TransmissionError::Capstan(error) => {
                let at = self.capstan()?.evaluate(error, reading_rad)?;
                derivatives.copy_from_slice(&at.derivatives);
                Ok((at.value_rad, at.slope))
            }
            TransmissionError::Chebyshev {
                range_rad,
                coefficients,
            } => {
                let result = checked_chebyshev(*range_rad, coefficients, reading_rad)?;
                chebyshev::basis(*range_rad, reading_rad, derivatives);
                Ok(result)
            }
            TransmissionError::Parallelogram {
                capstan,
                length_deviations_m,
            } => {
                let cascade = self.cascade()?;
                let at = cascade.evaluate(capstan, length_deviations_m, reading_rad)?;
                derivatives.copy_from_slice(&at.derivatives);
                Ok((at.value_rad, at.slope))
            }
        }
    }

    /// Transmission error at a reading.
    ///
    /// # Errors
    /// Whatever the transmission says of its numbers.
    pub fn error_rad(&self, reading_rad: f64) -> Result<f64, LawError> {
        match &self.transmission_error {
            TransmissionError::Capstan(error) => self.capstan()?.error(error, reading_rad),
            TransmissionError::Chebyshev {
                range_rad,
                coefficients,
            } => checked_chebyshev(*range_rad, coefficients, reading_rad).map(|(value, _)| value),
            TransmissionError::Parallelogram {
                capstan,
                length_deviations_m,
            } => self
                .cascade()?
                .error(capstan, length_deviations_m, reading_rad),
        }
    }

    fn cascade(&self) -> Result<CapstanParallelogram, LawError> {
        let lengths = self.parallelogram_lengths_m.unwrap_or([f64::NAN; 4]);
        Ok(CapstanParallelogram {
            capstan: self.capstan()?,
            parallelogram: Parallelogram::new(lengths)?,
        })
    }
}

/// Value and slope, or why there are none: the polynomial itself does not check its arguments.
fn checked_chebyshev(
    range_rad: [f64; 2],
    coefficients: &[f64],
    reading_rad: f64,
) -> Result<(f64, f64), LawError> {
    chebyshev::check(range_rad, coefficients)?;
    let (value, slope) = chebyshev::evaluate(range_rad, coefficients, reading_rad);
    for (quantity, number) in [
        ("joint reading", reading_rad),
        ("Chebyshev series", value),
        ("slope of the Chebyshev series", slope),
    ] {
        if !number.is_finite() {
            return Err(LawError::NonFinite {
                quantity,
                value: number,
            });
        }
    }
    Ok((value, slope))
}
