//! Commands that make a result: `identify`, `diagnose` and `plan`; `haptical verify` makes it again.

use std::path::{Path, PathBuf};

use haptical::files::{
    NewFile, ResultKind, Source, VERSION, WrittenResult, check_folder, shell_word,
};
use haptical::{Device, Equipment, Log};

use crate::arguments::IdentifyArguments;
use crate::failure::Failure;
use crate::flags::OverwriteOptions;
use crate::interrupt::write_result;
use crate::progress::Progress;
use crate::terminal;

/// A command line that makes a result from files.
pub(crate) trait ResultCommand {
    /// Its name and its files.
    fn kind(&self) -> ResultKind;

    /// The identification, where it is one of links and drives.
    fn as_identification(&self) -> Option<&IdentifyArguments> {
        None
    }

    /// Which files of its folder it may overwrite.
    fn overwrite(&self) -> OverwriteOptions;

    /// The files that it reads, by flag.
    fn inputs(&self) -> Vec<(&'static str, &Path)>;

    /// Reads the inputs and makes the result, under the name of a version.
    fn make(
        &self,
        version: &str,
        inputs: &Inputs,
        progress: &Progress,
    ) -> Result<MadeResult, Failure>;
}

/// A result in memory.
pub(crate) struct MadeResult {
    pub(crate) files: Vec<NewFile<'static>>,
    pub(crate) warnings: Vec<String>,
    /// For a terminal.
    pub(crate) summary: String,
    /// Commands that go on from it, each behind a word; files of the result by their names alone.
    pub(crate) next: Vec<(&'static str, String)>,
}

impl MadeResult {
    /// The files of a result, what is odd about it, and its summary.
    pub(crate) fn of(
        files: Vec<NewFile<'static>>,
        warnings: &[String],
        summary: &dyn ToString,
    ) -> Self {
        Self {
            files,
            warnings: warnings.to_vec(),
            summary: summary.to_string(),
            next: Vec::new(),
        }
    }

    /// The same with commands that go on from it.
    pub(crate) fn with_next(self, next: Vec<(&'static str, String)>) -> Self {
        Self { next, ..self }
    }

    /// Those commands, with the places at which its files were written.
    /// Inputs that a result calls by their names alone get theirs.
    fn said_next(&self, paths: &[String], inputs: &[(&'static str, &Path)]) -> String {
        let given = inputs.iter().map(|(_, path)| Source::given(path));
        let given = given.map(|source| (shell_word(&source.label), source.path));
        let written = paths.iter().map(PathBuf::from);
        let written = written.filter_map(|path| {
            let name = path.file_name()?.to_str()?.to_owned();
            Some((name, path))
        });
        let places: Vec<(String, PathBuf)> = written.chain(given).collect();
        let line = |(label, command): &(&str, String)| {
            let placed = places
                .iter()
                .fold(format!("{command} "), |command, (name, path)| {
                    let place = shell_word(&path.display().to_string());
                    command.replace(&format!(" {name} "), &format!(" {place} "))
                });
            let width = if label.is_empty() { 2 } else { 9 };
            format!("{label:<width$}{}\n", placed.trim_end())
        };
        self.next.iter().map(line).collect()
    }
}

/// The places of the files to read, by flag.
pub(crate) struct Inputs(pub(crate) Vec<(&'static str, Source)>);

impl Inputs {
    /// The file of a flag, where it is given.
    pub(crate) fn optional(&self, flag: &str) -> Option<&Source> {
        let mut all = self.0.iter();
        all.find(|(own, _)| *own == flag).map(|(_, source)| source)
    }

    fn required(&self, flag: &str) -> Result<&Source, Failure> {
        let missing = || Failure::internal(format!("--{flag} is not among the inputs"));
        self.optional(flag).ok_or_else(missing)
    }

    /// The device, with the rig file in it.
    pub(crate) fn device(&self, equipment: Equipment) -> Result<Device, Failure> {
        let rig = self.optional("rig").cloned();
        Device::open(self.required("device")?, &Equipment { rig, ..equipment })
    }

    /// The model of the device identified earlier.
    pub(crate) fn model(&self, device: &Device) -> Result<Option<Device>, Failure> {
        let open = |source| device.open_model(source);
        self.optional("model").map(open).transpose()
    }

    /// The log, where there must be one.
    pub(crate) fn log(&self, device: &Device) -> Result<Log, Failure> {
        Log::open(self.required("log")?, device)
    }

    /// The logs behind the first one.
    pub(crate) fn further_logs(&self, device: &Device) -> Result<Vec<Log>, Failure> {
        let logs = self.0.iter().filter(|(flag, _)| *flag == "log").skip(1);
        logs.map(|(_, source)| Log::open(source, device)).collect()
    }

    /// The log of a flag, where it is given.
    pub(crate) fn optional_log(&self, flag: &str, device: &Device) -> Result<Option<Log>, Failure> {
        let open = |source| Log::open(source, device);
        self.optional(flag).map(open).transpose()
    }
}

/// Makes a result, writes it into a folder, and prints the summary or the result; `written` puts the
/// paths that were written into words.
pub(crate) fn run(
    command: &impl ResultCommand,
    out: Option<&Path>,
    json: bool,
    written: &dyn Fn(&[String]) -> String,
) -> Result<(), Failure> {
    let (kind, inputs) = (command.kind(), command.inputs());
    let rule = command.overwrite().rule(kind.command);
    if let Some(out) = out {
        check_folder(out)?;
        let outputs: Vec<PathBuf> = kind.outputs().map(|name| out.join(name)).collect();
        rule.check(&outputs)?;
    }
    let progress = Progress::start("reading");
    let given = inputs
        .iter()
        .map(|(flag, path)| (*flag, Source::given(path)));
    let made = command.make(VERSION, &Inputs(given.collect()), &progress)?;
    progress.say("writing");
    let WrittenResult {
        written: paths,
        removed,
        foreign,
    } = match out {
        Some(out) => write_result(out, &kind, &made.files, &rule)?,
        None => WrittenResult::default(),
    };
    drop(progress);
    for path in removed {
        let (path, command) = (path.display(), kind.command);
        terminal::write_message(&format!(
            "removed: {path}, which an earlier `haptical {command}` wrote and this one does not"
        ));
    }
    for path in foreign {
        let path = path.display();
        terminal::write_message(&format!("warning: {path} is not of this result"));
    }
    terminal::warn(&made.warnings);
    if json {
        let mut files = made.files.iter();
        let result = files.find(|(name, _)| *name == kind.result);
        return terminal::write_output(result.map_or(&[], |(_, content)| content));
    }
    let paths: Vec<String> = paths
        .iter()
        .map(|path| path.display().to_string())
        .collect();
    let said = made.said_next(&paths, &inputs);
    terminal::write_output((made.summary + &written(&paths) + &said).as_bytes())
}

/// The inputs of which there is a path.
pub(crate) fn given<'a>(
    inputs: &[(&'static str, Option<&'a PathBuf>)],
) -> Vec<(&'static str, &'a Path)> {
    let given = inputs
        .iter()
        .filter_map(|(flag, path)| Some((*flag, path.as_ref()?.as_path())));
    given.collect()
}
