//! What a row's readings are about: where the tracker stood in its run, and which tool was on the hand.

use haptical_kinematics::nalgebra::Vector3;

use crate::{Device, Origin, Placement, Recording};

/// Where a tracker stood that was set up anew for each run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunBase {
    /// Run, as in the log's column `run`.
    pub run: i64,
    /// Frame (-1) seen from the tracker.
    pub placement: Placement,
}

/// A thing on the hand that rows of a log are about: one of several reflectors, a ball, a tool that was put on later.
#[derive(Debug, Clone, PartialEq)]
pub struct Tool {
    /// As in the log's column `tool`.
    pub id: String,
    /// What is seen, or touches, seen from the handle; none until a calibration has found a start value.
    pub placement: Option<Placement>,
    /// Whether its turn shows in any reading: only that of a thing whose orientation a tracker sees does.
    pub has_turn: bool,
    /// Line of the log from which on it is on the hand, where the log has no column `tool`.
    pub from_line: Option<u64>,
}

/// What a row is about, by positions in [`crate::Surroundings::run_bases`] and [`crate::Surroundings::tools`].
///
/// Where there is none it is the tracker's one base, and the handle or the tracker's one tool.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Mount {
    /// Where the tracker stood.
    pub base: Option<usize>,
    /// What was on the hand.
    pub tool: Option<usize>,
}

/// A row that is about a tool or a run for which the device has no place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unplaced {
    /// Row of the recording, from 0.
    pub row: usize,
    /// The log's column that names it.
    pub column: &'static str,
    /// What it names.
    pub id: String,
}

impl RunBase {
    /// The same without a turn: what a file holds.
    #[must_use]
    pub fn settled(&self) -> Self {
        Self {
            placement: self.placement.settled(),
            ..*self
        }
    }
}

impl Tool {
    /// A tool of this id, of which no place is known.
    pub fn new(id: &str) -> Self {
        Self {
            id: id.to_owned(),
            placement: None,
            has_turn: false,
            from_line: None,
        }
    }

    /// The same without a turn: what a file holds.
    #[must_use]
    pub fn settled(&self) -> Self {
        Self {
            placement: self.placement.map(|placement| placement.settled()),
            ..self.clone()
        }
    }
}

impl Device {
    /// Takes what a tracker reads for the handle's poses in frame (-1).
    pub fn track_handle_in_base(&mut self) {
        if let Some(tracker) = &mut self.tracker {
            (tracker.base_known, tracker.tool_known) = (true, true);
            tracker.base_per_run = false;
        }
        self.forget_tracker_places();
    }

    /// A recording without its orientations, where nobody ever said how what the tracker sees is turned on the handle: its
    /// orientation is exactly the handle's, which no fit gives. None where orientations can be compared, or there are none.
    ///
    /// ```
    /// use haptical_model::{Device, Recording};
    /// let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n[[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\n[[joint]]\n\
    ///     [tracker]\nbase = \"unknown\"\ntool = \"unknown\"\n\
    ///     tool_xyz_m = [0.0, 0.0, 0.1]\ntool_wxyz = [1.0, 0.0, 0.0, 0.0]\n";
    /// let lever = Device::from_toml(text, "lever.toml")?.device;
    /// let recording = Recording {
    ///     joint: vec![vec![0.1]],
    ///     orientation_wxyz: Some([vec![1.0], vec![0.0], vec![0.0], vec![0.0]]),
    ///     ..Recording::default()
    /// };
    /// let without = lever.without_unknown_orientation(&recording).ok_or("nothing left out")?;
    /// assert!(without.orientation_wxyz.is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn without_unknown_orientation(&self, recording: &Recording) -> Option<Recording> {
        let tool = self.surroundings.tracker_tool?;
        let is_unsaid = self.tracker.is_some_and(|tracker| !tracker.tool_known)
            && tool.start.orientation_wxyz == Origin::IDENTITY.orientation_wxyz
            && tool.turn_rad == [0.0; 3];
        (is_unsaid && recording.orientation_wxyz.is_some()).then(|| Recording {
            orientation_wxyz: None,
            ..recording.clone()
        })
    }

    /// Leaves out where a tracker stands, run by run too, and what it sees.
    pub fn forget_tracker_places(&mut self) {
        let around = &mut self.surroundings;
        (around.tracker_base, around.tracker_tool) = (None, None);
        around.run_bases.clear();
    }

    /// Whether each run of a recording has a tracker place of its own.
    pub fn has_run_bases(&self) -> bool {
        self.tracker.is_some_and(|tracker| tracker.base_per_run)
    }

    /// Whether it has numbers of single runs: a tracker place for each, or an effect from a run on.
    pub fn has_numbers_of_runs(&self) -> bool {
        let mut effects = self.effects.iter();
        self.has_run_bases() || effects.any(|effect| effect.numbers.contains_key("from_run"))
    }

    /// The id of what is on the hand at a row: the cell of the log's column `tool`, or what the device file says of
    /// that line, or the hand's name where a tracker sees a thing on each hand; empty for the handle itself.
    ///
    /// ```
    /// use haptical_model::{Device, Recording};
    /// let text = "[[joint]]\n[[tool]]\nid = \"long\"\nfrom_line = 3\n";
    /// let device = Device::from_toml(text, "one.toml")?.device;
    /// let recording = Recording { line: vec![2, 3], joint: vec![vec![0.0, 0.1]], ..Recording::default() };
    /// assert_eq!([device.tool_at(&recording, 0), device.tool_at(&recording, 1)], ["", "long"]);
    /// # Ok::<(), haptical_model::DeviceFileError>(())
    /// ```
    ///
    /// # Panics
    /// If the recording has a column `tool` or `hand` and the row is not below its length.
    pub fn tool_at<'t>(&'t self, recording: &'t Recording, row: usize) -> &'t str {
        if let Some(ids) = &recording.tool {
            return &ids[row];
        }
        let line = recording.line.get(row).copied().unwrap_or(0);
        let put_on = self.surroundings.tools.iter();
        let put_on = put_on.filter_map(|tool| Some((tool.from_line?, tool)));
        let last = put_on.filter(|(from, _)| *from <= line);
        let last = last.max_by_key(|(from, _)| *from);
        if let Some((_, tool)) = last {
            return &tool.id;
        }
        let hands = recording
            .hand
            .as_ref()
            .filter(|_| self.sees_hands(recording));
        hands.map_or("", |hands| &hands[row])
    }

    /// Whether a tracker sees a thing on each of several hands, whose tool goes by the name of its hand.
    fn sees_hands(&self, recording: &Recording) -> bool {
        let is_tracked = recording.position_m.is_some() || recording.orientation_wxyz.is_some();
        self.has_tool_per_hand() && is_tracked && recording.tool.is_none()
    }

    /// Whether a tool's id is that of what a tracker sees on a hand.
    pub fn is_of_hand(&self, id: &str) -> bool {
        self.has_tool_per_hand() && self.hand_index(id).is_some()
    }

    /// What each row of a recording is about; empty where every row is about the handle, or the tracker's one tool,
    /// and the tracker's one base.
    ///
    /// # Errors
    /// [`Unplaced`] for the first tool, or run, for which the device has no place.
    pub fn mounts(&self, recording: &Recording) -> Result<Vec<Mount>, Unplaced> {
        let around = &self.surroundings;
        let is_tracked = recording.position_m.is_some() || recording.orientation_wxyz.is_some();
        let has_runs = self.has_run_bases() && is_tracked;
        let has_tools = self.has_tools(recording);
        let has_hands = self.sees_hands(recording);
        if !has_runs && !has_tools {
            return Ok(Vec::new());
        }
        let mount = |row: usize| -> Result<Mount, Unplaced> {
            let mut mount = Mount::default();
            if has_runs {
                let run = recording.run_at(row);
                let own = |base: &RunBase| base.run == run;
                let found = around.run_bases.iter().position(own);
                mount.base = Some(found.ok_or_else(|| Unplaced {
                    row,
                    column: "run",
                    id: run.to_string(),
                })?);
            }
            let id = if has_tools {
                self.tool_at(recording, row)
            } else {
                ""
            };
            let own = |tool: &Tool| tool.id == id && tool.placement.is_some();
            let found = around.tools.iter().position(own);
            let is_unseen =
                || recording.tool.is_none() && has_hands && !recording.is_seen_by_tracker(row);
            if !id.is_empty() && (found.is_some() || !is_unseen()) {
                mount.tool = Some(found.ok_or_else(|| Unplaced {
                    row,
                    column: "tool",
                    id: id.to_owned(),
                })?);
            }
            Ok(mount)
        };
        let mounts: Vec<Mount> = (0..recording.len()).map(mount).collect::<Result<_, _>>()?;
        let is_of_handle = mounts.iter().all(|mount| *mount == Mount::default());
        Ok(if is_of_handle { Vec::new() } else { mounts })
    }

    /// Whether any row may be about something else on the hand than the handle.
    pub fn has_tools(&self, recording: &Recording) -> bool {
        let last = recording.line.iter().max();
        let is_put_on = |tool: &Tool| tool.from_line.is_some_and(|from| last >= Some(&from));
        match &recording.tool {
            Some(ids) => ids.iter().any(|id| !id.is_empty()),
            None => {
                let hands = recording.hand.as_ref();
                self.surroundings.tools.iter().any(is_put_on)
                    || hands.is_some_and(|_| self.sees_hands(recording))
            }
        }
    }

    /// Where the tracker stood at a row: frame (-1) seen from it. None for a tracker in frame (-1).
    pub fn base_of(&self, mount: Mount) -> Option<Placement> {
        let around = &self.surroundings;
        match mount.base {
            Some(base) => around.run_bases.get(base).map(|base| base.placement),
            None => around.tracker_base,
        }
    }

    /// What a tracker sees at a row, seen from the handle. None for the handle itself.
    pub fn seen_tool_of(&self, mount: Mount) -> Option<Placement> {
        match mount.tool {
            Some(tool) => self.surroundings.tools.get(tool)?.placement,
            None => self.surroundings.tracker_tool,
        }
    }

    /// Whether a tool touches things: all do but what a tracker sees on one of several hands.
    pub fn touches(&self, tool: usize) -> bool {
        let tool = self.surroundings.tools.get(tool);
        tool.is_some_and(|tool| !self.is_of_hand(&tool.id))
    }

    /// What touches at a row, in the handle frame \[m\]: the handle's origin, unless a tool is on the hand. What a tracker
    /// sees on one of several hands touches nothing.
    pub fn touching_m(&self, mount: Mount) -> Vector3<f64> {
        let tool = mount.tool.filter(|&tool| self.touches(tool));
        let tool = tool.and_then(|tool| self.surroundings.tools.get(tool));
        let place = tool.and_then(|tool| tool.placement);
        place.map_or_else(Vector3::zeros, |place| place.start.position_m.into())
    }
}
