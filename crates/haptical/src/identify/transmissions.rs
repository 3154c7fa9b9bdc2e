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
    let all = calibration.fitted.transmissions.iter();
    let entries = all.map(|own| {
        let number = own.joint + 1;
        let is_own = |entry: &&ParameterEntry| entry.key.starts_with(&format!("joint[{number}]."));
        let fit = own.fit.as_ref();
        let joint = &calibration.device.joints[own.joint];
        TransmissionEntry {
            joint: number,
            terms: own.terms,
            range_rad: own.range_rad,
            evidence: own.evidence.clone(),
            convergence: fit.map(|fit| fit.convergence),
            parameters: parameters.iter().filter(is_own).cloned().collect(),
            polynomial_monomials: joint.transmission_error.monomials(),
            identifiability: fit
                .map(|fit| RankEntry::from_judgements(std::iter::once(&fit.identifiability))),
        }
    });
    entries.collect()
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
