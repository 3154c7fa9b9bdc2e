//! plan.json: what a plan says, and how it came about.

use haptical_design::{DesignError, NextPoses, Posture, Request, RigIdentifiability, Step, plan};
use haptical_model::Device;
use serde::Serialize;

use crate::provenance::{Record, VERSION};
use crate::terminal::Progress;

/// plan.json.
#[derive(Debug, Serialize)]
pub(crate) struct Plan {
    pub(crate) device: String,
    #[serde(flatten)]
    pub(crate) said: haptical_design::Plan,
    pub(crate) warnings: Vec<String>,
    pub(crate) provenance: Record,
}

impl Plan {
    /// Plans; names and provenance are still to come.
    pub(crate) fn new(
        request: &Request,
        device: &Device,
        measured: &[Posture],
        progress: &Progress,
    ) -> Result<Self, DesignError> {
        let step = |step: Step<'_>| {
            progress.say(match step {
                Step::Rig(name) => format!("rig {name}"),
                Step::Choosing { poses, candidates } => {
                    format!("choosing {poses} of {candidates} poses")
                }
            });
        };
        Ok(Self {
            device: String::new(),
            said: plan(device, request, measured, &step)?,
            warnings: Vec::new(),
            provenance: Record::new(VERSION, "plan", Vec::new(), Vec::new()),
        })
    }

    pub(crate) fn rigs(&self) -> &[RigIdentifiability] {
        &self.said.rigs
    }

    pub(crate) fn next_poses(&self) -> Option<&NextPoses> {
        self.said.next_poses.as_ref()
    }

    /// Rigs side by side: names of the columns.
    pub(crate) fn rig_names(&self) -> Vec<String> {
        self.rigs().iter().map(|rig| rig.measure.clone()).collect()
    }
}
