//! The one rule of what a run may write: nothing that it reads, nothing that another hand wrote, each file whole or not at all.

use std::path::{Component, Path, PathBuf};

use serde_json::Value;

use super::output::{check_folder, replace_all};
use super::own::{Listing, own_text};
use super::{INDEX, NewFile, index, is_seal_whole, is_sealed_by};
use crate::error::Error;

/// Which files may be overwritten.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Overwrite {
    /// Those that an earlier run of the same command wrote and nobody changed since.
    Own,
    /// Any that the run does not read.
    Any,
}

/// What a run may write. Every file that a command writes goes through this.
///
/// # Examples
/// ```
/// use haptical::files::{Overwrite, WriteRule};
/// let folder = tempfile::tempdir()?;
/// let log = folder.path().join("log.csv");
/// std::fs::write(&log, "t_s\n")?;
/// let rule = WriteRule::new("play", vec![log.clone()], Overwrite::Any);
/// let refused = rule.check(&[log]).unwrap_err();
/// assert!(refused.what().ends_with("log.csv is an input of this run"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WriteRule {
    command: &'static str,
    inputs: Vec<PathBuf>,
    overwrite: Overwrite,
}

/// Result or provenance files of the command with their paths.
type Records = Vec<(PathBuf, Listing)>;

impl WriteRule {
    /// The rule of a run of a command that reads these files and folders.
    pub fn new(command: &'static str, inputs: Vec<PathBuf>, overwrite: Overwrite) -> Self {
        Self {
            command,
            inputs,
            overwrite,
        }
    }

    /// The same for files that another command writes too: a watch leaves a diagnosis.
    #[must_use]
    pub fn of_command(&self, command: &'static str) -> Self {
        Self {
            command,
            ..self.clone()
        }
    }

    /// Refuses, before any work, outputs that must not be written.
    ///
    /// # Errors
    /// The first one that is an input of the run, that is there and that the command did not write, that is no regular file, whose
    /// folder cannot be one, or that is named twice.
    pub fn check(&self, outputs: &[PathBuf]) -> Result<(), Error> {
        self.check_with(outputs, &|_| false)
    }

    /// The same without the question who wrote what is there, for files that may be there with the very content that is to come.
    ///
    /// # Errors
    /// As [`WriteRule::check`].
    pub fn check_inputs(&self, outputs: &[PathBuf]) -> Result<(), Error> {
        self.check_with(outputs, &|_| true)
    }

    /// Writes files into a folder, all of them or none, under the rule. It ends where `stop` says so.
    ///
    /// # Errors
    /// As [`WriteRule::check`], but a file with the same content may be there; the folder cannot be written to; `stop` said so.
    pub fn write(
        &self,
        folder: &Path,
        files: &[NewFile<'_>],
        stop: &dyn Fn() -> bool,
    ) -> Result<Vec<PathBuf>, Error> {
        let place = |name: &str| match folder == Path::new(".") {
            true => PathBuf::from(name),
            false => folder.join(name),
        };
        let outputs: Vec<PathBuf> = files.iter().map(|(name, _)| place(name)).collect();
        let is_same = |output: &Path| {
            let new = files.iter().zip(&outputs).find(|(_, own)| *own == output);
            let there = std::fs::read(output).ok();
            new.is_some_and(|((_, new), _)| there.as_ref() == Some(new))
        };
        self.check_with(&outputs, &is_same)?;
        replace_all(folder, files, &[], stop)
    }

    fn check_with(
        &self,
        outputs: &[PathBuf],
        may_be_foreign: &dyn Fn(&Path) -> bool,
    ) -> Result<(), Error> {
        for (index, output) in outputs.iter().enumerate() {
            check_folder(output.parent().unwrap_or(Path::new("")))?;
            refuse_no_file(output)?;
            if outputs[..index].iter().any(|other| is_same(other, output)) {
                let said =
                    "two outputs of this run have this name; give another name for one of them";
                return Err(Error::of_file("unwritable", said, output));
            }
        }
        let records = self.records(outputs);
        let is_there = |output: &&PathBuf| output.symlink_metadata().is_ok();
        for output in outputs.iter().filter(is_there) {
            let is_own = self.is_own(output, &records);
            if let Some(input) = self.input(output, is_own) {
                let what = format!("{} is an input of this run", input.display());
                let next = "give another name or folder for the output";
                return Err(Error::in_file("unwritable", what, output, next));
            }
            if self.overwrite == Overwrite::Own && !is_own && !may_be_foreign(output) {
                return Err(self.not_own(output));
            }
        }
        Ok(())
    }

    /// The input that an output is: the same file under any name, or a file in a folder that is read.
    fn input<'a>(&'a self, output: &'a Path, is_own: bool) -> Option<&'a Path> {
        let same = self.inputs.iter().find(|input| is_same(input, output));
        let within = || {
            let place = output.canonicalize().ok()?;
            let mut folders = self.inputs.iter().filter(|input| input.is_dir());
            let is_above =
                |input: &&PathBuf| input.canonicalize().is_ok_and(|own| place.starts_with(own));
            folders.find(is_above).map(|_| output)
        };
        // what an earlier run left in a folder that is read is none of its inputs
        let same = same.map(PathBuf::as_path);
        same.or_else(|| within().filter(|_| !is_own))
    }

    /// The records of the command among the outputs.
    fn records(&self, outputs: &[PathBuf]) -> Records {
        let is_json = |path: &&PathBuf| {
            let end = path.extension();
            end.is_some_and(|end| end.eq_ignore_ascii_case("json"))
        };
        let read = |path: &PathBuf| {
            let listing = Listing::parse(&own_text(path)?, self.command)?;
            Some((path.clone(), listing))
        };
        outputs.iter().filter(is_json).filter_map(read).collect()
    }

    /// Whether an earlier run of the command wrote a file, by the hash in it or by that in a record beside it, and nobody changed
    /// it since. The index of a folder is every command's.
    fn is_own(&self, output: &Path, records: &Records) -> bool {
        let is_record = |(path, listing): &(PathBuf, Listing)| match path == output {
            true => listing.is_whole,
            false => folder_of(path) == folder_of(output) && listing.has(output),
        };
        if records.iter().any(is_record) {
            return true;
        }
        let is_index = output.file_name().is_some_and(|name| name == INDEX);
        if is_index && index::is_one(output) {
            return true;
        }
        let in_json = |text: &str| {
            let value: Value = serde_json::from_str(text).ok()?;
            let is_of_command = value.get("command")?.as_str()? == self.command;
            Some(is_of_command && is_seal_whole(text, value.get("result_sha256")?.as_str()?))
        };
        own_text(output).is_some_and(|text| {
            is_sealed_by(&text, &format!("haptical {}", self.command))
                || in_json(&text).unwrap_or(false)
        })
    }

    /// Which of these files of a folder the command wrote, and which it did not.
    pub(super) fn partition<'n>(
        &self,
        folder: &Path,
        names: Vec<&'n str>,
        all: impl Iterator<Item = &'static str>,
    ) -> (Vec<&'n str>, Vec<&'n str>) {
        let all: Vec<PathBuf> = all.map(|name| folder.join(name)).collect();
        let records = self.records(&all);
        let is_own = |name: &&str| self.is_own(&folder.join(name), &records);
        names.into_iter().partition(is_own)
    }

    fn not_own(&self, file: &Path) -> Error {
        let said = format!(
            "the file is there, and no earlier `haptical {}` wrote it, or it was changed since; give another name or folder, or \
             --force to overwrite it",
            self.command
        );
        Error::of_file("exists", said, file)
    }
}

/// The folder of a file, however its path is written.
fn folder_of(file: &Path) -> PathBuf {
    let parent = file.parent().filter(|own| !own.as_os_str().is_empty());
    let folder = parent.unwrap_or(Path::new("."));
    folder.canonicalize().unwrap_or_else(|_| plain(folder))
}

/// A path without `.`, and without `..` behind a name: what a system that knows no canonical paths, such as WebAssembly's, can
/// compare.
fn plain(path: &Path) -> PathBuf {
    let mut parts: Vec<Component<'_>> = Vec::new();
    for part in path.components() {
        match (part, parts.last()) {
            (Component::CurDir, _) => {}
            (Component::ParentDir, Some(Component::Normal(_))) => {
                parts.pop();
            }
            _ => parts.push(part),
        }
    }
    parts.iter().collect()
}

/// Whether two paths name one file: by the same place, or by a second name of it.
fn is_same(one: &Path, other: &Path) -> bool {
    if one == other {
        return true;
    }
    let places = (one.canonicalize(), other.canonicalize());
    match places {
        (Ok(one), Ok(other)) if one == other => true,
        (Err(_), Err(_)) if plain(one) == plain(other) => true,
        _ => is_linked(one, other),
    }
}

#[cfg(unix)]
fn is_linked(one: &Path, other: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let both = (std::fs::metadata(one), std::fs::metadata(other));
    matches!(both, (Ok(one), Ok(other)) if (one.dev(), one.ino()) == (other.dev(), other.ino()))
}

#[cfg(not(unix))]
fn is_linked(_: &Path, _: &Path) -> bool {
    false
}

/// Refuses what is there and no regular file: renaming a file over a device or a pipe would replace it.
fn refuse_no_file(output: &Path) -> Result<(), Error> {
    let kind = match std::fs::metadata(output) {
        Ok(there) if there.is_dir() => "a folder",
        Ok(there) if !there.is_file() => "no regular file",
        _ => return Ok(()),
    };
    let said = format!("cannot write: it is {kind}; give the name of a file");
    Err(Error::of_file("unwritable", said, output))
}
