//! The flag that lets a command overwrite files that it did not write.

use std::path::Path;

use clap::Args;
use haptical::files::{Overwrite, check_own_file};

use crate::failure::Failure;

/// The flag that lets a command overwrite files that it did not write.
#[derive(Debug, Clone, Copy, Default, Args)]
pub(crate) struct OverwriteOptions {
    /// Overwrite files at --out that no earlier run of this command wrote, or that were changed since
    #[arg(long)]
    pub(crate) force: bool,
}

impl OverwriteOptions {
    /// Refuses a file with its own hash in it that the command did not write, or that was changed since.
    pub(crate) fn check_file(self, out: &Path, command: &str) -> Result<(), Failure> {
        match self.overwrite() {
            Overwrite::Own => check_own_file(out, command),
            Overwrite::Any => Ok(()),
        }
    }

    /// As the library takes it.
    pub(crate) fn overwrite(self) -> Overwrite {
        match self.force {
            true => Overwrite::Any,
            false => Overwrite::Own,
        }
    }
}
