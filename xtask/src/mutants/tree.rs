//! A copy of the tracked files, in which faults are planted.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};
use xtask_output::said;

pub(super) struct Tree {
    checkout: PathBuf,
    copy: PathBuf,
}

impl Tree {
    /// Copies what is tracked into `folder`: files that are the same keep their time, so that nothing is built again for them.
    pub(super) fn copied(checkout: &Path, folder: &Path) -> Result<Self> {
        let tree = Self {
            checkout: checkout.to_owned(),
            copy: folder.join("tree"),
        };
        let mut git = Command::new("git");
        let listed = said(git.current_dir(checkout).args(["ls-files", "-z"]))?;
        let tracked: BTreeSet<&str> = listed.split_terminator('\0').collect();
        for path in &tracked {
            tree.restore_one(Path::new(path))?;
        }
        // what an earlier run copied and is tracked no more
        let list = folder.join("tracked");
        let earlier = std::fs::read_to_string(&list).unwrap_or_default();
        for gone in earlier
            .split_terminator('\0')
            .filter(|path| !tracked.contains(path))
        {
            remove(&tree.copy.join(gone))?;
        }
        std::fs::write(&list, &listed)?;
        Ok(tree)
    }

    pub(super) fn path(&self) -> &Path {
        &self.copy
    }

    /// Applies a diff to the copy; the files that it changes.
    pub(super) fn plant(&self, diff: &Path) -> Result<Vec<PathBuf>> {
        let changed = apply(&self.copy, diff, &["--numstat", "-z"])?;
        apply(&self.copy, diff, &[])?;
        let names = changed
            .split_terminator('\0')
            .filter_map(|line| line.split('\t').nth(2));
        let files: Vec<PathBuf> = names.map(PathBuf::from).collect();
        ensure!(!files.is_empty(), "{} changes no file", diff.display());
        Ok(files)
    }

    /// Takes out what was planted.
    pub(super) fn restore(&self, files: &[PathBuf]) -> Result<()> {
        files.iter().try_for_each(|file| self.restore_one(file))
    }

    fn restore_one(&self, path: &Path) -> Result<()> {
        let (from, to) = (self.checkout.join(path), self.copy.join(path));
        if !from.exists() {
            return remove(&to);
        }
        let text = std::fs::read(&from).with_context(|| from.display().to_string())?;
        if std::fs::read(&to).is_ok_and(|there| there == text) {
            return Ok(());
        }
        std::fs::create_dir_all(to.parent().unwrap_or(&to))?;
        std::fs::copy(&from, &to).with_context(|| to.display().to_string())?;
        Ok(())
    }
}

fn remove(file: &Path) -> Result<()> {
    if file.exists() {
        std::fs::remove_file(file).with_context(|| file.display().to_string())?;
    }
    Ok(())
}

/// Applies a diff to the files in a folder, with further options; what git prints.
///
/// In a folder that a repository contains and does not track, git skips every file and says nothing: it must not look above.
pub(super) fn apply(folder: &Path, diff: &Path, options: &[&str]) -> Result<String> {
    let mut git = Command::new("git");
    git.current_dir(folder)
        .env("GIT_CEILING_DIRECTORIES", folder.parent().unwrap_or(folder))
        .arg("apply");
    let applied = said(git.args(options).arg(diff));
    applied.with_context(|| format!("{} DOES NOT APPLY", diff.display()))
}
