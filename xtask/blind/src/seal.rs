//! Sealed truths: a commitment that is published before the diagnosis, and opened after it.

use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::random::Random;
use crate::truth::Truth;

/// A truth with the salt that hides it in its commitment.
///
/// The truth is kept as the text that was committed to: a number that passes through a parser could
/// come back changed in its last digit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sealed {
    /// SHA-256 of the salt, a line feed and the text of the truth, hexadecimal.
    pub commitment: String,
    /// 128 random bits, hexadecimal.
    pub salt: String,
    /// Canonical JSON of the truth: keys in alphabetical order, no blanks.
    pub truth_json: String,
}

/// Seals a truth with a salt drawn from `random`.
pub fn seal(truth: &Truth, random: &mut Random) -> Result<Sealed> {
    let salt = format!("{:016x}{:016x}", random.seed(), random.seed());
    // the map of a `Value` is ordered by key
    let truth_json = serde_json::to_string(&serde_json::to_value(truth)?)?;
    Ok(Sealed {
        commitment: commitment(&salt, &truth_json),
        salt,
        truth_json,
    })
}

impl Sealed {
    /// The truth, if it belongs to the commitment published before.
    pub fn open(&self, published: &str) -> Result<Truth> {
        ensure!(
            commitment(&self.salt, &self.truth_json) == published,
            "the truth does not match the commitment {published}"
        );
        serde_json::from_str(&self.truth_json)
            .context("a sealed truth cannot be turned into JSON or back")
    }
}

fn commitment(salt: &str, truth_json: &str) -> String {
    sha256_hex(&format!("{salt}\n{truth_json}"))
}

/// SHA-256 of a text, hexadecimal.
pub fn sha256_hex(text: &str) -> String {
    let digest = Sha256::digest(text.as_bytes());
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
