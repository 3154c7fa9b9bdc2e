//! The descriptions of a folder: URDFs by their name, MJCFs by their outermost element.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

/// What a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Kind {
    /// A URDF.
    Urdf,
    /// An MJCF.
    Mjcf,
}

/// A file to be compared.
#[derive(Debug, Clone)]
pub(crate) struct Found {
    /// Where it is.
    pub(crate) path: PathBuf,
    /// Its path in the folder.
    pub(crate) shown: String,
    /// What it is.
    pub(crate) kind: Kind,
}

/// All descriptions below a folder, in the order of their names; xacro is counted and said.
pub(crate) fn find(folder: &Path) -> Result<Vec<Found>> {
    let mut found = Vec::new();
    let mut xacro = 0;
    let mut open = vec![folder.to_owned()];
    while let Some(here) = open.pop() {
        let entries = std::fs::read_dir(&here).with_context(|| here.display().to_string())?;
        for entry in entries {
            let path = entry.with_context(|| here.display().to_string())?.path();
            if path.is_symlink() {
                continue;
            }
            if path.is_dir() {
                open.push(path);
                continue;
            }
            let name = path.to_string_lossy().to_lowercase();
            xacro += usize::from(name.ends_with(".xacro"));
            let kind = match name.rsplit('.').next() {
                Some("urdf") => Kind::Urdf,
                Some("xml") if is_mjcf(&path) => Kind::Mjcf,
                _ => continue,
            };
            let shown = path.strip_prefix(folder).unwrap_or(&path);
            let shown = shown.display().to_string();
            found.push(Found { path, shown, kind });
        }
    }
    if xacro > 0 {
        println!("skipped: {xacro} files of xacro; expand them with the program xacro first");
    }
    found.sort_by(|one, other| one.shown.cmp(&other.shown));
    Ok(found)
}

/// Whether the outermost element is that of MuJoCo.
fn is_mjcf(path: &Path) -> bool {
    let Ok(text) = std::fs::read_to_string(path) else {
        return false;
    };
    let mut rest = text.trim_start_matches('\u{feff}').trim_start();
    loop {
        let end = match rest {
            own if own.starts_with("<!--") => "-->",
            own if own.starts_with("<?") => "?>",
            own => return own.starts_with("<mujoco") && !own.starts_with("<mujocoinclude"),
        };
        match rest.split_once(end) {
            Some((_, behind)) => rest = behind.trim_start(),
            None => return false,
        }
    }
}
