//! Damaged and made-up files: read or refused, no panic, no more memory than is there.

use std::io::Write;
use std::path::Path;

use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use haptical_tables::{Mapping, Reading, guess, table_from_bytes};
use proptest::prelude::*;

const FILES: [&str; 6] = [
    "arm.mat",
    "joints.npy",
    "poses.npz",
    "poses.xlsx",
    "protocol.txt",
    "counts.dat",
];

fn fixture(name: &str) -> Vec<u8> {
    std::fs::read(
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../fixtures/tables")
            .join(name),
    )
    .unwrap()
}

/// A small file that unpacks to more than is read.
#[test]
#[ignore = "unpacks 2 GiB, without optimisation for more than a minute: --ignored with --release"]
fn a_bomb_is_refused() {
    let zeros = vec![0; 1 << 20];
    let mut gzip = GzEncoder::new(Vec::new(), Compression::fast());
    (0..2050).for_each(|_| gzip.write_all(&zeros).unwrap());
    let error = table_from_bytes(gzip.finish().unwrap(), "bomb", &Reading::default()).unwrap_err();
    assert_eq!(error.kind, "too-large");
}

/// Lines and rows that would take more memory than their file.
#[test]
fn wide_rows_are_refused() {
    let long = vec![b'1'; (1 << 20) + 1];
    let error = table_from_bytes(
        [b"a\n".to_vec(), long].concat(),
        "file",
        &Reading::default(),
    )
    .unwrap_err();
    assert_eq!((error.kind, error.line), ("line-too-long", Some(2)));
    for separator in [",", ";", " "] {
        let wide = ["1"; 5000].join(separator);
        let error = table_from_bytes(
            format!("{wide}\n{wide}\n").into_bytes(),
            "file",
            &Reading::default(),
        )
        .unwrap_err();
        assert_eq!(
            (error.kind, error.line),
            ("too-many-columns", Some(1)),
            "{error}"
        );
    }
    let keys: String = (0..6000).map(|key| format!("{{\"k{key}\":1}}\n")).collect();
    let error = table_from_bytes(keys.into(), "file", &Reading::default()).unwrap_err();
    assert_eq!(
        (error.kind, error.line),
        ("too-many-columns", Some(4097)),
        "{error}"
    );
    let skipping = Reading {
        skip_lines: Some(usize::MAX),
        ..Reading::default()
    };
    let error = table_from_bytes(b"a\n1\n".to_vec(), "file", &skipping).unwrap_err();
    assert_eq!(error.kind, "no-rows");
}

/// An array within a compressed element that says it is larger than it is.
#[test]
fn sizes_that_lie_are_refused() {
    let mut inner = 14_u32.to_le_bytes().to_vec();
    inner.extend(u32::MAX.to_le_bytes());
    inner.extend([0; 64]);
    let mut zlib = ZlibEncoder::new(Vec::new(), Compression::fast());
    zlib.write_all(&inner).unwrap();
    let packed = zlib.finish().unwrap();
    let mut bytes = fixture("arm.mat")[..128].to_vec();
    bytes.extend(15_u32.to_le_bytes());
    bytes.extend(u32::try_from(packed.len()).unwrap().to_le_bytes());
    bytes.extend(packed);
    let error = table_from_bytes(bytes, "file", &Reading::default()).unwrap_err();
    assert_eq!(error.kind, "damaged");
}

/// Whether a proposal is a mapping file; how many counts are a turn it leaves to a person.
fn is_mapping(text: &str) -> bool {
    let said = text.replace("counts_per_turn = 0 ", "counts_per_turn = 4096 ");
    Mapping::from_toml(&said, "columns.toml").is_ok()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(192) })]

    #[test]
    fn damage_is_survived(
        name in prop::sample::select(&FILES[..]),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut content = fixture(name);
        for (place, byte) in damage {
            let place = place.index(content.len());
            content[place] = byte;
        }
        if let Some(cut) = cut {
            content.truncate(cut.index(content.len()));
        }
        if let Ok(table) = table_from_bytes(content, "file", &Reading::default()) {
            // whatever was read, a proposal for it is a mapping file
            let text = guess(&[table], &[]);
            prop_assert!(is_mapping(&text), "{text}");
        }
    }

    #[test]
    fn any_text_is_survived(text in "[0-9a-z;,. \\[\\]\"#%\n\t\\-]{0,200}") {
        if let Ok(table) = table_from_bytes(text.into_bytes(), "file", &Reading::default()) {
            let text = guess(&[table], &[]);
            prop_assert!(is_mapping(&text), "{text}");
        }
    }

    #[test]
    fn any_mapping_is_survived(text in "[a-z_0-9=\\[\\]' \n.]{0,120}") {
        let _ = Mapping::from_toml(&text, "columns.toml");
    }
}
