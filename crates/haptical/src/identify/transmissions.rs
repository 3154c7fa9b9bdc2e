//! The transmissions' part of identified.json: form, evidence, parameters, powers of the angle.

use haptical_calibration::{Calibration, EvidenceEntry, TransmissionTerms};
use haptical_identification::Convergence;
use serde::Serialize;

use super::result::{ParameterEntry, RankEntry};

/// One transmission with an external encoder.
#[derive(Debug, Clone, Serialize)]
pub struct TransmissionEntry {
    /// Joint, from 1.
    pub joint: usize,
    /// Terms of its error.
    pub terms: TransmissionTerms,
    /// Range rad.
    pub range_rad: [f64; 2],
    /// Forms that were weighed; none where the form was given.
    pub evidence: Vec<EvidenceEntry>,
    /// How the search ended.
    pub convergence: Option<Convergence>,
    /// Its parameters.
    pub parameters: Vec<ParameterEntry>,
    /// Powers k0 .. kn of the angle that equal the polynomial \[rad/rad^i\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub polynomial_monomials: Option<Vec<f64>>,
    /// Of the transmission's own fit to its external encoder.
    pub identifiability: Option<RankEntry>,
}

/// The transmissions with an external encoder; their parameters are those of the last fit.
pub(super) fn transmissions(
    calibration: &Calibration,
    parameters: &[ParameterEntry],
) -> Vec<TransmissionEntry> {
    calibration
        .fitted
        .transmissions
        .iter()
        .map(|transmission| {
            let prefix = format!("joint[{}].", transmission.joint + 1);
            let own = parameters
                .iter()
                .filter(|entry| entry.key.starts_with(&prefix));
            let fit = transmission.fit.as_ref();
            TransmissionEntry {
                joint: transmission.joint + 1,
                terms: transmission.terms,
                range_rad: transmission.range_rad,
                evidence: transmission.evidence.clone(),
                convergence: fit.map(|fit| fit.convergence),
                parameters: own.cloned().collect(),
                polynomial_monomials: calibration.device.joints[transmission.joint]
                    .transmission_error
                    .monomials(),
                identifiability: fit
                    .map(|fit| RankEntry::from_judgements(std::iter::once(&fit.identifiability))),
            }
        })
        .collect()
}

/// A form in words.
pub(super) fn form_in_words(terms: TransmissionTerms) -> String {
    let words = match terms {
        TransmissionTerms::None => "no error",
        TransmissionTerms::Offset => "offset",
        TransmissionTerms::OffsetRatio => "offset and ratio",
        TransmissionTerms::OffsetEccentricity => "offset and output eccentricity",
        TransmissionTerms::OffsetRatioEccentricity => "offset, ratio and output eccentricity",
        TransmissionTerms::Capstan => "equation (1)",
        TransmissionTerms::ZeroedCapstan => "equation (1) without offset, zero at home",
        TransmissionTerms::Polynomial(degree) => return format!("polynomial of degree {degree}"),
    };
    words.to_owned()
}
