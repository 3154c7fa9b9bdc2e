//! What a tracker saw: from where and of what, and which of its bases and tools have no place yet.

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::{Device, Placement, Recording, RunBase, SurroundingParameter, Tool};

use crate::problem::measurement::rotation::measured_rotation;
use crate::start::ids::listed;

/// One row: the handle in frame (-1), and what the tracker saw.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sight {
    /// Row of the recording.
    pub(crate) row: usize,
    /// Which of [`Frames::bases`] and [`Frames::tools`].
    pub(crate) base: usize,
    pub(crate) tool: usize,
    pub(crate) handle: Pose,
    pub(crate) position_m: Option<Vector3<f64>>,
    pub(crate) rotation: Option<Matrix3<f64>>,
}

/// Bases B and tools X with `seen = B handle X`: first the one that is not of a run, or has no id, then those of
/// [`Rig::runs`] and [`Rig::ids`].
#[derive(Debug, Clone)]
pub(crate) struct Frames {
    pub(crate) bases: Vec<Pose>,
    pub(crate) tools: Vec<Pose>,
}

impl Frames {
    /// What is seen, in frame (-1).
    pub(crate) fn point_m(&self, sight: &Sight) -> Vector3<f64> {
        let handle = &sight.handle;
        handle.position_m + handle.rotation * self.tools[sight.tool].position_m
    }
}

/// Which bases and tools are unknown and without a place.
#[derive(Debug, Clone, Default)]
pub(crate) struct Open {
    pub(crate) bases: Vec<bool>,
    pub(crate) tools: Vec<bool>,
}

impl Open {
    pub(crate) fn is_any(&self) -> bool {
        self.bases.contains(&true) || self.tools.contains(&true)
    }
}

/// A tracker's frames as far as a device has them, and which are open.
#[derive(Debug, Clone)]
pub(crate) struct Rig {
    runs: Vec<i64>,
    ids: Vec<String>,
    pub(crate) known: Frames,
    pub(crate) open: Open,
}

impl Rig {
    /// The runs and tools of a recording. A device without a tracker sees the handle in frame (-1).
    pub(crate) fn new(device: &Device, recording: &Recording) -> Self {
        let around = &device.surroundings;
        let (base, tool) = (around.tracker_base, around.tracker_tool);
        let has_runs = device.has_run_bases();
        let mut runs: Vec<i64> = Vec::new();
        let mut ids = Vec::new();
        if has_runs {
            runs.extend((0..recording.len()).map(|row| recording.run_at(row)));
            runs.dedup();
        }
        if device.has_tools(recording) {
            let all = (0..recording.len()).map(|row| device.tool_at(recording, row).to_owned());
            ids = listed(&all.collect::<Vec<String>>());
        }
        let of_run = |run: &i64| {
            let mut own = around.run_bases.iter().filter(|base| base.run == *run);
            own.next().map(|base| base.placement)
        };
        let of_id = |id: &String| {
            let own = around.tool_index(id);
            own.and_then(|own| around.tools[own].placement)
        };
        let bases: Vec<Option<Placement>> = runs.iter().map(of_run).collect();
        let tools: Vec<Option<Placement>> = ids.iter().map(of_id).collect();
        let tracker = device.tracker.as_ref();
        let base_unknown = tracker.is_some_and(|own| !own.base_known && !has_runs);
        let tool_unknown = tracker.is_some_and(|own| !own.tool_known);
        let poses = |first: Option<Placement>, further: &[Option<Placement>]| {
            let all = std::iter::once(&first).chain(further);
            all.map(|place| place.unwrap_or_default().pose()).collect()
        };
        let open = |first: bool, further: &[Option<Placement>]| {
            let further = further.iter().map(Option::is_none);
            std::iter::once(first).chain(further).collect()
        };
        Self {
            known: Frames {
                bases: poses(base, &bases),
                tools: poses(tool, &tools),
            },
            open: Open {
                bases: open(base_unknown && base.is_none(), &bases),
                tools: open(tool_unknown && tool.is_none(), &tools),
            },
            runs,
            ids,
        }
    }

    /// Whether several places or tools were seen.
    pub(crate) fn has_several(&self) -> bool {
        !self.runs.is_empty() || !self.ids.is_empty()
    }

    /// Leaves what no sight is about without a place.
    pub(crate) fn close_unseen(&mut self, sights: &[Sight]) {
        for (base, is_open) in self.open.bases.iter_mut().enumerate() {
            *is_open &= sights.iter().any(|sight| sight.base == base);
        }
        for (tool, is_open) in self.open.tools.iter_mut().enumerate() {
            *is_open &= sights.iter().any(|sight| sight.tool == tool);
        }
    }

    /// Puts what is open at a place.
    pub(crate) fn place(&self, device: &mut Device, frames: &Frames, sights: &[Sight]) {
        let around = &mut device.surroundings;
        let bases = frames.bases.iter().zip(&self.open.bases).enumerate();
        for (index, (pose, _)) in bases.filter(|(_, (_, is_open))| **is_open) {
            let placement = Placement::from_pose(pose);
            match index.checked_sub(1) {
                None => around.tracker_base = Some(placement),
                Some(run) => around.run_bases.push(RunBase {
                    run: self.runs[run],
                    placement,
                }),
            }
        }
        let tools = frames.tools.iter().zip(&self.open.tools).enumerate();
        for (index, (pose, _)) in tools.filter(|(_, (_, is_open))| **is_open) {
            let placement = Some(Placement::from_pose(pose));
            let Some(id) = index.checked_sub(1) else {
                around.tracker_tool = placement;
                continue;
            };
            let mut own = sights.iter().filter(|sight| sight.tool == index);
            let has_turn = own.any(|sight| sight.rotation.is_some());
            let tool = tool_of(&mut around.tools, &self.ids[id]);
            (tool.placement, tool.has_turn) = (placement, tool.has_turn || has_turn);
        }
    }

    /// The numbers of what was open in a device that has a place for it. Positions tell a base's turn too; only
    /// orientations tell a tool's.
    pub(crate) fn open_parameters(
        &self,
        device: &Device,
        slides: bool,
        turns: bool,
    ) -> Vec<SurroundingParameter> {
        let around = &device.surroundings;
        let first = if slides { 0 } else { 3 };
        let mut found = Vec::new();
        for (index, _) in self.open.bases.iter().enumerate().filter(|own| *own.1) {
            let number = |number: usize| match index.checked_sub(1) {
                None => Some(SurroundingParameter::TrackerBase { index: number }),
                Some(run) => {
                    let own = |base: &RunBase| base.run == self.runs[run];
                    let base = around.run_bases.iter().position(own)?;
                    Some(SurroundingParameter::RunBase {
                        base,
                        index: number,
                    })
                }
            };
            found.extend((first..6).filter_map(number));
        }
        for (index, _) in self.open.tools.iter().enumerate().filter(|own| *own.1) {
            let tool = index.checked_sub(1);
            let tool = tool.map(|id| around.tool_index(&self.ids[id]));
            let is_turned = |tool: &Tool| tool.has_turn;
            let turns = match tool {
                Some(own) => own.is_some_and(|own| is_turned(&around.tools[own])),
                None => turns,
            };
            let number = |number: usize| match tool {
                None => Some(SurroundingParameter::TrackerTool { index: number }),
                Some(tool) => Some(SurroundingParameter::Tool {
                    tool: tool?,
                    index: number,
                }),
            };
            let end = if turns { 6 } else { 3 };
            found.extend((first..end).filter_map(number));
        }
        found
    }
}

/// The tool of an id, put behind the others where there is none.
pub(crate) fn tool_of<'t>(tools: &'t mut Vec<Tool>, id: &str) -> &'t mut Tool {
    let own = tools.iter().position(|tool| tool.id == id);
    let own = own.unwrap_or_else(|| {
        tools.push(Tool::new(id));
        tools.len() - 1
    });
    &mut tools[own]
}

/// What the tracker saw, row by row.
pub(crate) fn sights(
    recording: &Recording,
    poses: &[Pose],
    device: &Device,
    rig: &Rig,
) -> Vec<Sight> {
    let rows = poses.iter().enumerate();
    let sights = rows.map(|(row, handle)| {
        let position = recording.position_m.as_ref();
        let position = position.map(|axes| Vector3::from(axes.each_ref().map(|axis| axis[row])));
        let rotation = measured_rotation(recording, row);
        let run = recording.run_at(row);
        let base = rig.runs.iter().position(|own| *own == run);
        let tool = match rig.ids.is_empty() {
            true => None,
            false => {
                let id = device.tool_at(recording, row);
                rig.ids.iter().position(|own| own == id)
            }
        };
        Sight {
            row,
            base: base.map_or(0, |base| base + 1),
            tool: tool.map_or(0, |tool| tool + 1),
            handle: *handle,
            position_m: position.filter(|position| position.iter().all(|part| part.is_finite())),
            rotation: rotation
                .iter()
                .all(|part| part.is_finite())
                .then_some(rotation),
        }
    });
    sights
        .filter(|sight| sight.position_m.is_some() || sight.rotation.is_some())
        .collect()
}
