//! Results as another version or another machine would have written them: changed, with their hashes made right again.

use std::path::Path;

use serde_json::Value;
use sha2::{Digest, Sha256};

const UNSEALED: &str = "0000000000000000000000000000000000000000000000000000000000000000";

fn sha256(bytes: &[u8]) -> String {
    let hash = Sha256::digest(bytes);
    hash.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// SHA-256 of a file.
pub(crate) fn sha256_of(path: &Path) -> String {
    sha256(&std::fs::read(path).unwrap())
}

/// Makes the hashes in a result those of the files as they are now.
pub(crate) fn reseal(folder: &Path, result: &str) {
    let path = folder.join(result);
    let mut text = std::fs::read_to_string(&path).unwrap();
    let value: Value = serde_json::from_str(&text).unwrap();
    let provenance = &value["provenance"];
    for output in provenance["outputs"].as_array().unwrap() {
        let now = sha256_of(&folder.join(output["file"].as_str().unwrap()));
        text = text.replace(output["sha256"].as_str().unwrap(), &now);
    }
    text = text.replace(provenance["result_sha256"].as_str().unwrap(), UNSEALED);
    let sealed = text.replace(UNSEALED, &sha256(text.as_bytes()));
    std::fs::write(path, sealed).unwrap();
}
