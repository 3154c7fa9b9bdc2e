//! Files that results are made from and files of results: names, hashes, provenance, writing all or none.

mod output;
mod provenance;
mod source;

pub use output::{
    MadeFolders, NewFile, check_folder, check_outputs, make_folder, reason, write_all,
};
pub(crate) use provenance::without_comments;
pub use provenance::{
    OutputFile, Record, Thresholds, VERSION, is_seal_whole, sealed_json, shell_word,
};
pub(crate) use source::HashingReader;
pub use source::{Fingerprint, InputFile, Source, file_name};
