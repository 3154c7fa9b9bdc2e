//! `<include file="..."/>` of an MJCF: the parts of other files in its place, from the folder of the main file alone.

use std::path::{Component, Path, PathBuf};

use haptical_model::{Position, read_text_file};

use crate::UrdfError;
use crate::robot::places::{mark, place_of};
use crate::robot::prefixes::without_prefixes;
use crate::robot::xml::{Element, Reader, Result, document};

/// Most files of a model, and most of them one inside another.
const MOST_FILES: usize = 256;
/// What may be in the place of a file that was refused.
const IN_FOLDER: &str =
    "a file in the folder of the main file or below it is expected, without `..`";

/// The text of an MJCF with all that it includes; any other text as it is.
///
/// # Errors
/// A file that cannot be read, is no XML, is outside the folder of the main file, or is included twice; the place is in the
/// error.
pub(crate) fn with_includes(text: String, path: &Path, mebibytes: u64) -> Result<String> {
    if !text.contains("<include") {
        return Ok(text);
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut files = Files {
        folder,
        seen: path.canonicalize().into_iter().collect(),
        mebibytes,
        whole: String::with_capacity(2 * text.len()),
    };
    let entry = Own {
        text: &text,
        file: &path.display().to_string(),
        folder: Path::new(""),
        is_main: true,
    };
    match files.add(&entry)? {
        true => Ok(files.whole),
        false => Ok(text),
    }
}

/// One file of a model.
struct Own<'f> {
    text: &'f str,
    /// Its name in errors.
    file: &'f str,
    /// Its folder, from that of the main file.
    folder: &'f Path,
    is_main: bool,
}

/// What is read so far.
struct Files<'f> {
    /// Of the main file.
    folder: &'f Path,
    /// All files, as the system calls them.
    seen: Vec<PathBuf>,
    mebibytes: u64,
    whole: String,
}

impl Files<'_> {
    /// Adds a file's text with what it includes; whether it is an MJCF that includes anything.
    fn add(&mut self, entry: &Own<'_>) -> Result<bool> {
        let plain = without_prefixes(entry.text);
        let document = match document(&plain, entry.file) {
            // it is refused where it is read
            Err(_) if entry.is_main => return Ok(false),
            other => other?,
        };
        let reader = Reader {
            document: &document,
            file: entry.file,
        };
        let root = document.root_element();
        if entry.is_main && root.tag_name().name() != "mujoco" {
            return Ok(false);
        }
        let range = match entry.is_main {
            true => 0..entry.text.len(),
            false => match (
                root.first_element_child(),
                root.first_child(),
                root.last_child(),
            ) {
                (Some(_), Some(first), Some(last)) => first.range().start..last.range().end,
                _ => return Err(reader.tree(root.range().start, "the file is empty".to_owned())),
            },
        };
        if !entry.is_main {
            self.mark(entry, range.start);
        }
        let mut done = range.start;
        let is_include = |node: &Element<'_, '_>| node.has_tag_name("include");
        for include in root.descendants().filter(is_include) {
            let place = include.range();
            self.push(entry, done, place.start);
            done = place.end;
            self.include(&reader, entry, include)?;
            self.mark(entry, done);
        }
        self.push(entry, done, range.end);
        Ok(done > range.start)
    }

    fn push(&mut self, entry: &Own<'_>, from: usize, to: usize) {
        self.whole
            .push_str(entry.text.get(from..to).unwrap_or_default());
    }

    /// Says that what follows is of this place.
    fn mark(&mut self, entry: &Own<'_>, byte: usize) {
        self.whole
            .push_str(&mark(&place_of(entry.text, entry.file, byte)));
    }

    fn include(
        &mut self,
        reader: &Reader<'_, '_>,
        entry: &Own<'_>,
        node: Element<'_, '_>,
    ) -> Result<()> {
        let place = "<include>";
        let name = reader.required(node, place, "file")?;
        let refuse =
            |allowed: &str| reader.refuse(node, place, "the file", &format!("\"{name}\""), allowed);
        if node.has_children() {
            return Err(refuse("an <include> has nothing inside"));
        }
        if self.seen.len() > MOST_FILES {
            return Err(refuse(&format!(
                "at most {MOST_FILES} files are read of a model"
            )));
        }
        let relative = inside(name).ok_or_else(|| refuse(IN_FOLDER))?;
        // as MuJoCo: from the folder of the main file, else from that of the file that includes it
        let from = [Path::new(""), entry.folder];
        let known = from.map(|from| from.join(&relative));
        let found = known
            .into_iter()
            .find(|entry| self.folder.join(entry).is_file());
        let found = found.ok_or_else(|| refuse("there is no such file"))?;
        let path = self.folder.join(&found);
        let whole = path
            .canonicalize()
            .map_err(|_| refuse("it cannot be read"))?;
        let folder = match self.folder.as_os_str().is_empty() {
            true => Path::new(".").canonicalize(),
            false => self.folder.canonicalize(),
        };
        // a link may lead elsewhere
        if !folder.is_ok_and(|folder| whole.starts_with(folder)) {
            return Err(refuse(IN_FOLDER));
        }
        if self.seen.contains(&whole) {
            return Err(refuse("each file is included once, and none by itself"));
        }
        self.seen.push(whole);
        let text = read_text_file(&path, self.mebibytes)
            .map_err(|error| refuse(&format!("it cannot be read: {error}")))?;
        let inner = Own {
            text: &text,
            file: &path.display().to_string(),
            folder: found.parent().unwrap_or(Path::new("")),
            is_main: false,
        };
        self.add(&inner)?;
        if self.whole.len() as u64 > self.mebibytes << 20 {
            let allowed = format!("at most {} MiB are read of a model", self.mebibytes);
            return Err(refuse(&allowed));
        }
        Ok(())
    }
}

/// A path that leads nowhere but into the folder that it is taken from.
fn inside(name: &str) -> Option<PathBuf> {
    let is_odd = |entry: char| entry.is_control() || entry == ':';
    if name.contains(is_odd) || name.contains("?>") {
        return None;
    }
    // MuJoCo takes the separators of Windows, too
    let path = PathBuf::from(name.replace('\\', "/"));
    let is_plain = |entry: Component<'_>| matches!(entry, Component::Normal(_) | Component::CurDir);
    (!path.as_os_str().is_empty() && path.components().all(is_plain)).then_some(path)
}

/// What is said where a text in memory includes files, or a file that includes others is to be changed.
pub(crate) fn refuse_includes(reader: &Reader<'_, '_>) -> Result<()> {
    let includes = |node: &Element<'_, '_>| node.has_tag_name("include");
    let Some(include) = reader.document.descendants().find(includes) else {
        return Ok(());
    };
    let found = format!("\"{}\"", include.attribute("file").unwrap_or_default());
    let allowed = "other files are read for a file and not for a text: save the model as one file, as MuJoCo's mj_saveLastXML does";
    Err(reader.refuse(include, "<include>", "the file", &found, allowed))
}

/// The refusal to write into a model of several files.
pub(crate) fn of_several_files(file: &str) -> UrdfError {
    UrdfError::Includes {
        at: Box::new(Position {
            file: file.to_owned(),
            line: 1,
            column: 1,
        }),
    }
}
