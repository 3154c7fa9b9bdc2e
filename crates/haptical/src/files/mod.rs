//! Files that results are made from and files of results: names, hashes, provenance, writing all or none.

mod index;
mod kind;
mod output;
mod own;
mod provenance;
mod results;
mod rule;
mod source;

pub use index::{index, is_one as is_index};
pub(crate) use kind::{DIAGNOSIS_FILES, IDENTIFICATION_FILES, PLAN_FILES};
pub use kind::{INDEX, ResultKind};
pub use output::{MadeFolders, NewFile, check_folder, make_folder, reason};
pub(crate) use provenance::{DEVICE_FLAGS, FIT_FLAGS, provenance_of, without_comments};
pub use provenance::{
    OutputFile, Record, Thresholds, UNSEALED, VERSION, is_seal_whole, is_sealed_by, sealed_json,
    sealed_text, shell_word,
};
pub use results::{WrittenResult, write_result};
pub use rule::{Overwrite, WriteRule};
pub(crate) use source::HashingReader;
pub use source::{Fingerprint, InputFile, Source, file_name};
