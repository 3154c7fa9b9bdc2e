//! No text makes the reader panic.

use haptical_model::Device;
use proptest::prelude::*;

use crate::support::CASES;

/// Lines and pieces of lines that a device file is made of, and others.
const PIECES: &[&str] = &[
    "[[link]]",
    "[[joint]]",
    "[device]",
    "[joint.transmission_error]",
    "[cable_encoder]",
    "[[cable]]",
    "[tracker]",
    "[nominal]",
    "[[nominal.link]]",
    "[[contact_pair]]",
    "[gravity]",
    "link = ",
    "joint = [{}]",
    "a_m = ",
    "alpha_rad = ",
    "d_m = ",
    "transmission = ",
    "transmission_ratio = ",
    "chebyshev = ",
    "range_rad = ",
    "vector_mps2 = ",
    "dof = ",
    "\"capstan\"",
    "\"prismatic\"",
    "0",
    "-1.5",
    "1e400",
    "0x7fffffffffffffffff",
    "0b101",
    "1_000",
    "nan",
    "+inf",
    "[]",
    "[1, 2]",
    "[1, 2, 3]",
    "{}",
    "{ a_m = 1 }",
    "\"",
    "'''",
    "\u{feff}",
    "\u{e9}",
    "\u{10ffff}",
    "\0",
    "\r",
    "\n",
    "=",
    ".",
    "#",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16 * CASES))]

    #[test]
    fn arbitrary_text_never_panics(text in "\\PC*|(\\PC|\n){0,80}") {
        let _ = Device::from_toml(&text, "any");
    }

    #[test]
    fn shuffled_pieces_never_panic(picks in proptest::collection::vec((0..PIECES.len(), any::<bool>()), 0..40)) {
        let text: String = picks
            .iter()
            .map(|(pick, end)| format!("{}{}", PIECES[*pick], if *end { "\n" } else { "" }))
            .collect();
        if let Ok(loaded) = Device::from_toml(&text, "any") {
            let written = loaded.device.to_toml(&text, "any").unwrap();
            let again = Device::from_toml(&written, "any").unwrap().device;
            prop_assert_eq!(again.links, loaded.device.links);
        }
    }

    #[test]
    fn a_file_cut_off_anywhere_never_panics(cut in any::<prop::sample::Index>()) {
        let text = "# \u{e9}\n[[joint]]\ntransmission = \"capstan\"\ntransmission_ratio = 8.0 # \u{4e2d}\n\
                    drum_distance_m = 0.0675\n[joint.transmission_error]\nrange_rad = [-1, 1]\n\
                    chebyshev = [0.1, 0.2]\n";
        let ends: Vec<usize> = text.char_indices().map(|(at, _)| at).collect();
        let _ = Device::from_toml(&text[..ends[cut.index(ends.len())]], "any");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    #[test]
    fn any_bytes_as_a_file_are_read_or_refused(
        start in prop_oneof![Just(""), Just("[[joint]]\n"), Just("\u{feff}[[joint]]\n")],
        bytes in proptest::collection::vec(any::<u8>(), 0..60),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("device.toml");
        let content = [start.as_bytes(), &bytes].concat();
        std::fs::write(&path, &content).unwrap();
        let is_text = std::str::from_utf8(&content).is_ok() && !content.contains(&0);
        match Device::load(&path) {
            Ok(_) => prop_assert!(is_text),
            Err(error) => prop_assert!(error.to_string().contains("device.toml")),
        }
    }
}
