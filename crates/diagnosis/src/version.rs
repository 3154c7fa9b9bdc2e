//! Version of the numbers that decide: a hash of the texts of their files, so that nobody needs to remember it.

/// Texts of the files with the numbers of this crate.
const THRESHOLDS: [&str; 10] = [
    include_str!("thresholds.rs"),
    include_str!("thresholds/admission.rs"),
    include_str!("thresholds/answer.rs"),
    include_str!("thresholds/current.rs"),
    include_str!("thresholds/engine.rs"),
    include_str!("thresholds/moving.rs"),
    include_str!("thresholds/payload.rs"),
    include_str!("thresholds/servo.rs"),
    include_str!("thresholds/settle.rs"),
    include_str!("thresholds/torque.rs"),
];

/// Hash of nothing, and factor of a step (Fowler, Noll and Vo: FNV-1a of 64 bits).
const START: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0100_0000_01b3;

/// Version of every number that decides, printed in each result. A changed comment changes it too.
pub(crate) fn version() -> String {
    const HASH: u64 = {
        let judge = fnv1a(START, &haptical_judge::THRESHOLDS);
        let motion = fnv1a(judge, &haptical_motion::THRESHOLDS);
        fnv1a(fnv1a(motion, &haptical_servo::THRESHOLDS), &THRESHOLDS)
    };
    format!("{HASH:016x}")
}

/// Continues a hash over further texts. Carriage returns do not count: a checkout with other line ends has the same version.
const fn fnv1a(mut hash: u64, texts: &[&str]) -> u64 {
    let mut text = 0;
    while text < texts.len() {
        let bytes = texts[text].as_bytes();
        let mut at = 0;
        while at < bytes.len() {
            if bytes[at] != b'\r' {
                hash = (hash ^ bytes[at] as u64).wrapping_mul(PRIME);
            }
            at += 1;
        }
        text += 1;
    }
    hash
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vectors of the authors' page.
    #[test]
    fn the_hash_is_fnv_1a() {
        assert_eq!(fnv1a(START, &[]), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv1a(START, &["a"]), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv1a(START, &["foo\r", "bar"]), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn a_number_of_any_crate_changes_the_version() {
        let files: Vec<&str> = (haptical_judge::THRESHOLDS.iter())
            .chain(&haptical_motion::THRESHOLDS)
            .chain(&haptical_servo::THRESHOLDS)
            .chain(&THRESHOLDS)
            .copied()
            .collect();
        let said = |texts: &[&str]| format!("{:016x}", fnv1a(START, texts));
        assert_eq!(version(), said(&files));
        for at in 0..files.len() {
            let changed = files[at].replacen(": f64 = ", ": f64 = 1", 1);
            assert_ne!(changed, files[at], "file {at} has no number");
            let mut others = files.clone();
            others[at] = &changed;
            assert_ne!(version(), said(&others));
        }
    }
}
