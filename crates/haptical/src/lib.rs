//! The front door: loads devices and logs, checks, identifies, diagnoses and plans, and writes what the command writes.
//!
#![doc = include_str!("../README.md")]

mod budget;
mod check;
mod columns;
mod correct;
mod device;
mod diagnose;
mod error;
mod export;
pub mod files;
mod forward;
mod identify;
mod lines;
mod log;
mod page;
mod plan;
mod replay;
mod reproduced;
mod simulate;
pub mod units;
pub mod watch;

pub use haptical_batch as batch;
pub use haptical_calibration as calibration;
pub use haptical_data as data;
pub use haptical_design as design;
pub use haptical_diagnosis as diagnosis;
pub use haptical_dynamics as dynamics;
pub use haptical_effects as effects;
pub use haptical_identification as identification;
pub use haptical_kinematics as kinematics;
pub use haptical_linalg as linalg;
pub use haptical_metrics as metrics;
pub use haptical_model as model;
pub use haptical_monitor as monitor;
pub use haptical_motion as motion;
pub use haptical_report as report;
pub use haptical_runtime as runtime;
pub use haptical_servo as servo;
pub use haptical_simulator as simulator;
pub use haptical_transmission as transmission;
pub use haptical_urdf as urdf;

pub use budget::{
    ActsAs, Budget, BudgetOptions, Contribution, Draws, Instrument, Instruments, Known,
    ParameterPart, PostureBudget, Shape, budget,
};
pub use check::{Checked, CheckedChannel, CheckedDevice, CheckedJoint, CheckedLog, check};
pub use correct::{
    Correct, Corrected, CorrectedWaypoint, Match, RestPoses, Waypoints, correct, rest_poses,
};
pub use device::{Device, Equipment, InputDrumDenominators, is_mjcf, is_urdf, refuse_other_device};
pub use diagnose::{
    Cause, Diagnose, Diagnosed, NextCommand, Repair, RepairChange, RepairCheck, diagnose,
    diagnose_as,
};
pub use error::{Error, ErrorKind, Place};
pub use export::{Export, Exported, Form, export};
pub use forward::{
    Drift, Drive, Forward, ForwardDevice, HORIZONS_S, JointDrift, KEPT_HORIZON_S, forward,
};
pub use identify::{
    BodyEntry, CombinationEntry, DYNAMICS, EffectEntry, EffectNumber, Found, FoundDynamics,
    IdentifiabilityEntry, Identified, IdentifiedDynamics, Identify, JointEntry, LossEntry,
    MovedEntry, NoiseEntry, NotIdentified, NumberEntry, ParameterEntry, RankEntry, RejectedEntry,
    StackedEntry, TorqueEntry, TransmissionEntry, identify, identify_as, identify_dynamics,
    identify_dynamics_as,
};
pub use log::Log;
pub use plan::{
    Chosen, ExpectedOdds, GapFile, Planned, SettleRequest, Settled, choose_next, plan, plan_as,
    settle, settle_as,
};
pub use replay::{Drawn, Replayed, ReplayedChannel, drawn, replay};
pub use simulate::{SimulatedPostures, Truth, simulate_postures, true_device};

/// What a program needs from a device file to a cause: `use haptical::prelude::*;`.
pub mod prelude {
    pub use crate::calibration::{CalibrationMethod, Degree, HeldOut, LossChoice, Options};
    pub use crate::design::{Request, Rig};
    pub use crate::diagnosis::Verdict;
    pub use crate::identification::Status;
    pub use crate::{
        Cause, Checked, Device, Diagnose, Diagnosed, Equipment, Error, ErrorKind, Found, Identify,
        Log, Planned, check, diagnose, identify, plan,
    };
}
