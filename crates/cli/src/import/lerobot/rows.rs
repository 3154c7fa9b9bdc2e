//! The rows of a data set's Parquet files.

use std::path::{Path, PathBuf};

use haptical_data::{parquet_names, read_parquet_columns};

use super::keys::{Keys, of_action, of_state};
use crate::failure::Failure;

/// Where the time, the episode and the number of a row within it are.
const NUMBERS: [&str; 3] = ["timestamp", "episode_index", "frame_index"];

/// The rows of all files.
pub(crate) struct Rows {
    pub(crate) keys: Keys,
    /// All keys of the data set.
    pub(crate) known: Vec<String>,
    /// Commands, one column a joint; none where the data set has none of the joints that it observes.
    pub(crate) action: Vec<Vec<f64>>,
    pub(crate) state: Vec<Vec<f64>>,
    pub(crate) time_s: Vec<f64>,
    pub(crate) episode: Vec<i64>,
}

impl Rows {
    /// Reads a folder or a file: `asked` are the keys that the user gives, `fps` the rows in a second where no time is recorded.
    pub(crate) fn read(
        dataset: &Path,
        asked: [Option<&str>; 2],
        fps: Option<f64>,
    ) -> Result<Self, Failure> {
        let files = files(dataset)?;
        let Some(first) = files.first() else {
            let said = "the data set has no Parquet file in data/; give a data set that was recorded, with its data";
            return Err(Failure::of_file("no-data-set", said, dataset));
        };
        let known = parquet_names(first)?;
        let keys = keys(&known, asked, first)?;
        let mut all = Self::of_file(first, &keys, known, fps)?;
        for file in &files[1..] {
            all.extend(Self::of_file(file, &keys, Vec::new(), fps)?, file)?;
        }
        Ok(all)
    }

    fn of_file(
        path: &Path,
        keys: &Keys,
        known: Vec<String>,
        fps: Option<f64>,
    ) -> Result<Self, Failure> {
        let lists: Vec<&str> = std::iter::once(keys.state.as_str())
            .chain(keys.action.as_deref())
            .collect();
        let read = read_parquet_columns(path, &lists, &NUMBERS)?;
        let refused =
            |what: &str, next| Failure::in_file("no-data-set", what.to_owned(), path, next);
        let mut lists = read.lists.into_iter();
        let state = lists.next().unwrap_or_default();
        if state.is_empty() {
            let what = format!("`{}` has no numbers", keys.state);
            return Err(refused(
                &what,
                "give the key of the joints' positions as --state",
            ));
        }
        // commands of other things, such as of a hand's pose, are as many by chance alone
        let action = lists.next().filter(|action| action.len() == state.len());
        let mut numbers = read.numbers.into_iter();
        let [time_s, episode, frame] = std::array::from_fn(|_| numbers.next().flatten());
        let by_frame = || {
            let frames = frame.as_ref().zip(fps);
            frames.map(|(frames, fps)| frames.iter().map(|frame| frame / fps).collect())
        };
        let Some(time_s) = time_s.or_else(by_frame) else {
            let what =
                "it has no column `timestamp`, nor `frame_index` next to `fps` in meta/info.json";
            return Err(refused(
                what,
                "give a data set that says when its rows were recorded",
            ));
        };
        let rows = time_s.len();
        let episode = episode.map_or(vec![0; rows], |column| {
            column.iter().map(|value| *value as i64).collect()
        });
        Ok(Self {
            keys: keys.clone(),
            known,
            action: action.unwrap_or_default(),
            state,
            time_s,
            episode,
        })
    }

    fn extend(&mut self, other: Self, path: &Path) -> Result<(), Failure> {
        if [other.state.len(), other.action.len()] != [self.state.len(), self.action.len()] {
            let (own, before) = (other.state.len(), self.state.len());
            let said = format!(
                "it has {own} joints and {} commands, the files before it {before} and {}; give the files of one robot",
                other.action.len(),
                self.action.len()
            );
            return Err(Failure::of_file("no-data-set", said, path));
        }
        let pairs = (self.action.iter_mut().zip(other.action))
            .chain(self.state.iter_mut().zip(other.state));
        pairs.for_each(|(own, more)| own.extend(more));
        self.time_s.extend(other.time_s);
        self.episode.extend(other.episode);
        Ok(())
    }

    /// Puts the rows in the order of their episodes and times; whether they were.
    pub(crate) fn sort(&mut self) -> bool {
        let is_before = |a: usize, b: usize| {
            let by_time = self.time_s[a].total_cmp(&self.time_s[b]);
            self.episode[a].cmp(&self.episode[b]).then(by_time)
        };
        let mut order: Vec<usize> = (0..self.time_s.len()).collect();
        if order.is_sorted_by(|a, b| is_before(*a, *b).is_le()) {
            return true;
        }
        order.sort_by(|a, b| is_before(*a, *b));
        let columns = self
            .state
            .iter_mut()
            .chain(&mut self.action)
            .chain([&mut self.time_s]);
        for column in columns {
            *column = order.iter().map(|row| column[*row]).collect();
        }
        self.episode = order.iter().map(|row| self.episode[*row]).collect();
        false
    }

    /// The largest number of all.
    pub(crate) fn largest(&self) -> f64 {
        let all = self.action.iter().chain(&self.state).flatten();
        all.fold(0.0, |most, value| most.max(value.abs()))
    }
}

/// The keys that the user gives, else those of the data set's own words.
fn keys(
    known: &[String],
    [state, action]: [Option<&str>; 2],
    path: &Path,
) -> Result<Keys, Failure> {
    let is_there = |key: &str| match known.iter().any(|name| name == key) {
        true => Ok(key.to_owned()),
        false => {
            let said = format!("the data set has no key `{key}`, but {}", known.join(", "));
            Err(Failure::of_file("no-data-set", said, path))
        }
    };
    let found = |observed: Vec<&str>| {
        let said = format!(
            "which of its keys are the joints' positions is not clear: {}; give one as --state",
            observed.join(", ")
        );
        Failure::of_file("no-data-set", said, path)
    };
    Ok(Keys {
        state: match state {
            Some(key) => is_there(key)?,
            None => of_state(known).map_err(found)?,
        },
        action: match action {
            Some(key) => Some(is_there(key)?),
            None => of_action(known),
        },
    })
}

/// The Parquet files of a data set, in the order of their names.
fn files(dataset: &Path) -> Result<Vec<PathBuf>, Failure> {
    if !dataset.is_dir() {
        return Ok(vec![dataset.to_owned()]);
    }
    let data = dataset.join("data");
    match data.is_dir() {
        true => parquet_files(&data),
        false => Ok(Vec::new()),
    }
}

/// The Parquet files in and below a folder, in the order of their names.
pub(crate) fn parquet_files(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        let next = "give the folder that holds meta/ and data/";
        let entries = std::fs::read_dir(&folder)
            .map_err(|error| Failure::unreadable(&error, &folder, next))?;
        for entry in entries.flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|end| end == "parquet") {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}
