//! The numbers beside the chain that a calibration may change, by a stable name.

use crate::{Device, Placement};

/// A parameter of a cable, the tracker, a touched point or plane.
///
/// As for [`crate::ParameterId`] its device must have it; where it does not, the value is NaN and setting
/// it changes nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SurroundingParameter {
    /// A coordinate of where a cable leaves its guide.
    CableAnchor {
        /// Cable, from 0.
        cable: usize,
        /// 0 to 2.
        axis: usize,
    },
    /// Constant error of a cable's reading.
    CableZero {
        /// Cable, from 0.
        cable: usize,
    },
    /// Reading per length of a cable.
    CableScale {
        /// Cable, from 0.
        cable: usize,
    },
    /// Radius of the guide that a cable bends over.
    CableExitRadius {
        /// Cable, from 0.
        cable: usize,
    },
    /// Frame (-1) seen from the tracker: 0 to 2 its position, 3 to 5 its turn.
    TrackerBase {
        /// Which number.
        index: usize,
    },
    /// What is tracked, seen from the handle: 0 to 2 its position, 3 to 5 its turn.
    TrackerTool {
        /// Which number.
        index: usize,
    },
    /// A coordinate of a touched point.
    Contact {
        /// Position in [`crate::Surroundings::contacts`].
        point: usize,
        /// 0 to 2.
        axis: usize,
    },
    /// A number of a touched plane: 0 and 1 its tilts, 2 its offset.
    Plane {
        /// Position in [`crate::Surroundings::planes`].
        plane: usize,
        /// Which number.
        index: usize,
    },
}

const AXES: [&str; 3] = ["x", "y", "z"];
const PLACEMENT: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];
const PLANE: [&str; 3] = ["tilt1", "tilt2", "offset"];

/// Plausible error of a place that nobody measured: a hand's breadth, \[m\] \[rad\].
const PLAUSIBLE_PLACE: f64 = 0.1;
/// Plausible error of a cable's anchor, zero and guide \[m\].
const PLAUSIBLE_CABLE_M: f64 = 1e-2;
/// Plausible error of a cable drum's circumference.
const PLAUSIBLE_SCALE: f64 = 1e-2;

impl SurroundingParameter {
    /// Unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::CableScale { .. } | Self::Plane { index: 0 | 1, .. } => "1",
            Self::TrackerBase { index: 3.. } | Self::TrackerTool { index: 3.. } => "rad",
            _ => "m",
        }
    }

    /// Short name: `cable2_anchor_x`, `tracker_base_rx`, `contact.socket.z`, `plane.table.offset`.
    pub fn name(self, device: &Device) -> String {
        let cable = |index: usize| match index {
            0 => "cable".to_owned(),
            _ => format!("cable{}", index + 1),
        };
        let part = |names: &[&'static str], index: usize| names.get(index).copied().unwrap_or("?");
        let surroundings = &device.surroundings;
        match self {
            Self::CableAnchor { cable: of, axis } => {
                format!("{}_anchor_{}", cable(of), part(&AXES, axis))
            }
            Self::CableZero { cable: of } => format!("{}_zero", cable(of)),
            Self::CableScale { cable: of } => format!("{}_scale", cable(of)),
            Self::CableExitRadius { cable: of } => format!("{}_exit_radius", cable(of)),
            Self::TrackerBase { index } => format!("tracker_base_{}", part(&PLACEMENT, index)),
            Self::TrackerTool { index } => format!("tracker_tool_{}", part(&PLACEMENT, index)),
            Self::Contact { point, axis } => {
                let id = surroundings
                    .contacts
                    .get(point)
                    .map_or("?", |point| &point.id);
                format!("contact.{id}.{}", part(&AXES, axis))
            }
            Self::Plane { plane, index } => {
                let id = surroundings
                    .planes
                    .get(plane)
                    .map_or("?", |plane| &plane.id);
                format!("plane.{id}.{}", part(&PLANE, index))
            }
        }
    }

    /// Key in the device file: `cable[2].anchor_m[0]`, `tracker.base_xyz_m[1]`, `contact_point.socket`.
    pub fn key(self, device: &Device) -> String {
        let cable = |index: usize| match index {
            0 => "cable_encoder".to_owned(),
            _ => format!("cable[{}]", index + 1),
        };
        let placed = |place: &str, index: usize| match index {
            0..3 => format!("tracker.{place}_xyz_m[{index}]"),
            _ => format!("tracker.{place}_wxyz"),
        };
        let surroundings = &device.surroundings;
        match self {
            Self::CableAnchor { cable: of, axis } => format!("{}.anchor_m[{axis}]", cable(of)),
            Self::CableZero { cable: of } => format!("{}.zero_m", cable(of)),
            Self::CableScale { cable: of } => format!("{}.scale", cable(of)),
            Self::CableExitRadius { cable: of } => format!("{}.exit_radius_m", cable(of)),
            Self::TrackerBase { index } => placed("base", index),
            Self::TrackerTool { index } => placed("tool", index),
            Self::Contact { point, axis } => {
                let id = surroundings
                    .contacts
                    .get(point)
                    .map_or("?", |point| &point.id);
                format!("contact_point[{id}].position_m[{axis}]")
            }
            Self::Plane { plane, index } => {
                let id = surroundings
                    .planes
                    .get(plane)
                    .map_or("?", |plane| &plane.id);
                let key = if index == 2 { "offset_m" } else { "normal" };
                format!("touched_plane[{id}].{key}")
            }
        }
    }

    /// Size that a deviation may plausibly have, in its unit (docs/assumptions.md, "Plausible sizes").
    pub fn plausible_size(self) -> f64 {
        match self {
            Self::CableAnchor { .. } | Self::CableZero { .. } | Self::CableExitRadius { .. } => {
                PLAUSIBLE_CABLE_M
            }
            Self::CableScale { .. } => PLAUSIBLE_SCALE,
            _ => PLAUSIBLE_PLACE,
        }
    }

    /// Value in a device; NaN where the device does not have the parameter.
    pub fn value(self, device: &Device) -> f64 {
        let surroundings = &device.surroundings;
        let found = match self {
            Self::CableAnchor { cable, axis } => {
                let cable = device.cables.get(cable);
                cable.and_then(|cable| cable.anchor_m.get(axis).copied())
            }
            Self::CableZero { cable } => device.cables.get(cable).map(|cable| cable.zero_m),
            Self::CableScale { cable } => device.cables.get(cable).map(|cable| cable.scale),
            Self::CableExitRadius { cable } => {
                device.cables.get(cable).map(|cable| cable.exit_radius_m)
            }
            Self::TrackerBase { index } => placed(surroundings.tracker_base.as_ref(), index),
            Self::TrackerTool { index } => placed(surroundings.tracker_tool.as_ref(), index),
            Self::Contact { point, axis } => {
                let point = surroundings.contacts.get(point);
                point.and_then(|point| point.position_m.get(axis).copied())
            }
            Self::Plane { plane, index } => {
                let plane = surroundings.planes.get(plane);
                plane.and_then(|plane| match index {
                    2 => Some(plane.offset_m),
                    _ => plane.tilt.get(index).copied(),
                })
            }
        };
        found.unwrap_or(f64::NAN)
    }

    /// Sets the value in a device.
    pub fn set(self, device: &mut Device, value: f64) {
        let surroundings = &mut device.surroundings;
        let place = match self {
            Self::CableAnchor { cable, axis } => {
                let cable = device.cables.get_mut(cable);
                cable.and_then(|cable| cable.anchor_m.get_mut(axis))
            }
            Self::CableZero { cable } => {
                device.cables.get_mut(cable).map(|cable| &mut cable.zero_m)
            }
            Self::CableScale { cable } => {
                device.cables.get_mut(cable).map(|cable| &mut cable.scale)
            }
            Self::CableExitRadius { cable } => {
                let cable = device.cables.get_mut(cable);
                cable.map(|cable| &mut cable.exit_radius_m)
            }
            Self::TrackerBase { index } => place_of(surroundings.tracker_base.as_mut(), index),
            Self::TrackerTool { index } => place_of(surroundings.tracker_tool.as_mut(), index),
            Self::Contact { point, axis } => {
                let point = surroundings.contacts.get_mut(point);
                point.and_then(|point| point.position_m.get_mut(axis))
            }
            Self::Plane { plane, index } => {
                let plane = surroundings.planes.get_mut(plane);
                plane.and_then(|plane| match index {
                    2 => Some(&mut plane.offset_m),
                    _ => plane.tilt.get_mut(index),
                })
            }
        };
        if let Some(place) = place {
            *place = value;
        }
    }
}

fn placed(placement: Option<&Placement>, index: usize) -> Option<f64> {
    let placement = placement?;
    match index.checked_sub(3) {
        None => placement.start.position_m.get(index).copied(),
        Some(turn) => placement.turn_rad.get(turn).copied(),
    }
}

fn place_of(placement: Option<&mut Placement>, index: usize) -> Option<&mut f64> {
    let placement = placement?;
    match index.checked_sub(3) {
        None => placement.start.position_m.get_mut(index),
        Some(turn) => placement.turn_rad.get_mut(turn),
    }
}

impl Device {
    /// All parameters of cables, tracker, touched points and planes that are unknown: a cable's where its
    /// `fit` says so, the tracker's where its base or tool is unknown and has been given a place.
    pub fn surrounding_parameters(&self) -> Vec<SurroundingParameter> {
        use SurroundingParameter as P;
        let mut parameters = Vec::new();
        let surroundings = &self.surroundings;
        if surroundings.tracker_base.is_some() {
            parameters.extend((0..6).map(|index| P::TrackerBase { index }));
        }
        if surroundings.tracker_tool.is_some() {
            parameters.extend((0..6).map(|index| P::TrackerTool { index }));
        }
        for point in 0..surroundings.contacts.len() {
            parameters.extend((0..3).map(|axis| P::Contact { point, axis }));
        }
        for plane in 0..surroundings.planes.len() {
            parameters.extend((0..3).map(|index| P::Plane { plane, index }));
        }
        for (cable, described) in self.cables.iter().enumerate() {
            let fit = described.fit;
            if fit.anchor {
                parameters.extend((0..3).map(|axis| P::CableAnchor { cable, axis }));
            }
            parameters.extend(fit.zero.then_some(P::CableZero { cable }));
            parameters.extend(fit.scale.then_some(P::CableScale { cable }));
            parameters.extend(fit.exit_radius.then_some(P::CableExitRadius { cable }));
        }
        parameters
    }
}
