//! The numbers of cables, tracker and touched places that a calibration may change, by a stable name.

use crate::Device;

/// A parameter of a cable, the tracker, what it sees on a hand, a touched point or plane.
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
    /// The same of the tracker in one run.
    RunBase {
        /// Position in [`crate::Surroundings::run_bases`].
        base: usize,
        /// Which number.
        index: usize,
    },
    /// What is tracked, seen from the handle: 0 to 2 its position, 3 to 5 its turn.
    TrackerTool {
        /// Which number.
        index: usize,
    },
    /// The same of a tool that rows name.
    Tool {
        /// Position in [`crate::Surroundings::tools`].
        tool: usize,
        /// Which number.
        index: usize,
    },
    /// The tracker's reading per length. No device file has its value, which is 1: only its uncertainty is known.
    TrackerScale,
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

/// The number of a parameter in a device, to be read or written.
macro_rules! number {
    ($parameter:ident, $device:ident, $get:ident, $as:ident $(, $mut:tt)?) => {{
        let around = &$($mut)? $device.surroundings;
        let cables = &$($mut)? $device.cables;
        match $parameter {
            Self::CableAnchor { cable, axis } => {
                cables.$get(cable).and_then(|cable| cable.anchor_m.$get(axis))
            }
            Self::CableZero { cable } => cables.$get(cable).map(|cable| &$($mut)? cable.zero_m),
            Self::CableScale { cable } => cables.$get(cable).map(|cable| &$($mut)? cable.scale),
            Self::CableExitRadius { cable } => {
                cables.$get(cable).map(|cable| &$($mut)? cable.exit_radius_m)
            }
            Self::TrackerBase { index }
            | Self::RunBase { index, .. }
            | Self::TrackerTool { index }
            | Self::Tool { index, .. } => {
                let placement = match $parameter {
                    Self::TrackerBase { .. } => around.tracker_base.$as(),
                    Self::RunBase { base, .. } => {
                        around.run_bases.$get(base).map(|base| &$($mut)? base.placement)
                    }
                    Self::Tool { tool, .. } => {
                        around.tools.$get(tool).and_then(|tool| tool.placement.$as())
                    }
                    _ => around.tracker_tool.$as(),
                };
                placement.and_then(|placement| match index.checked_sub(3) {
                    None => placement.start.position_m.$get(index),
                    Some(turn) => placement.turn_rad.$get(turn),
                })
            }
            // no number of the device
            Self::TrackerScale => None,
            Self::Contact { point, axis } => {
                around.contacts.$get(point).and_then(|point| point.position_m.$get(axis))
            }
            Self::Plane { plane, index } => around.planes.$get(plane).and_then(|plane| match index {
                2 => Some(&$($mut)? plane.offset_m),
                _ => plane.tilt.$get(index),
            }),
        }
    }};
}

impl SurroundingParameter {
    /// Unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::CableScale { .. } | Self::TrackerScale | Self::Plane { index: 0 | 1, .. } => "1",
            Self::TrackerBase { index: 3.. }
            | Self::RunBase { index: 3.., .. }
            | Self::TrackerTool { index: 3.. }
            | Self::Tool { index: 3.., .. } => "rad",
            _ => "m",
        }
    }

    /// Short name: `cable2_anchor_x`, `tracker_base_rx`, `tracker_base.2.x` of run 2, `tool.ball.x`,
    /// `contact.socket.z`, `plane.table.offset`.
    pub fn name(self, device: &Device) -> String {
        let cable = |index: usize| match index {
            0 => "cable".to_owned(),
            _ => format!("cable{}", index + 1),
        };
        let part = |names: &[&'static str], index: usize| names.get(index).copied().unwrap_or("?");
        match self {
            Self::CableAnchor { cable: of, axis } => {
                format!("{}_anchor_{}", cable(of), part(&AXES, axis))
            }
            Self::CableZero { cable: of } => format!("{}_zero", cable(of)),
            Self::CableScale { cable: of } => format!("{}_scale", cable(of)),
            Self::CableExitRadius { cable: of } => format!("{}_exit_radius", cable(of)),
            Self::TrackerBase { index } => format!("tracker_base_{}", part(&PLACEMENT, index)),
            Self::RunBase { base, index } => {
                let run = run_of(device, base);
                format!("tracker_base.{run}.{}", part(&PLACEMENT, index))
            }
            Self::TrackerTool { index } => format!("tracker_tool_{}", part(&PLACEMENT, index)),
            Self::Tool { tool, index } => {
                let id = tool_id(device, tool);
                format!("tool.{id}.{}", part(&PLACEMENT, index))
            }
            Self::TrackerScale => "tracker_scale".to_owned(),
            Self::Contact { point, axis } => {
                let id = contact_id(device, point);
                format!("contact.{id}.{}", part(&AXES, axis))
            }
            Self::Plane { plane, index } => {
                let id = plane_id(device, plane);
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
            0..3 => format!("{place}xyz_m[{index}]"),
            _ => format!("{place}wxyz"),
        };
        match self {
            Self::CableAnchor { cable: of, axis } => format!("{}.anchor_m[{axis}]", cable(of)),
            Self::CableZero { cable: of } => format!("{}.zero_m", cable(of)),
            Self::CableScale { cable: of } => format!("{}.scale", cable(of)),
            Self::CableExitRadius { cable: of } => format!("{}.exit_radius_m", cable(of)),
            Self::TrackerBase { index } => placed("tracker.base_", index),
            Self::RunBase { base, index } => {
                let run = run_of(device, base);
                placed(&format!("tracker.base_of_run[{run}]."), index)
            }
            Self::TrackerTool { index } => placed("tracker.tool_", index),
            Self::Tool { tool, index } => {
                let id = tool_id(device, tool);
                placed(&format!("tool[{id}]."), index)
            }
            Self::TrackerScale => "tracker.scale_sd".to_owned(),
            Self::Contact { point, axis } => {
                let id = contact_id(device, point);
                format!("contact_point[{id}].position_m[{axis}]")
            }
            Self::Plane { plane, index } => {
                let id = plane_id(device, plane);
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
            Self::CableScale { .. } | Self::TrackerScale => PLAUSIBLE_SCALE,
            _ => PLAUSIBLE_PLACE,
        }
    }

    /// Value in a device; NaN where the device does not have the parameter; 1 of the tracker's scale.
    pub fn value(self, device: &Device) -> f64 {
        if self == Self::TrackerScale {
            return 1.0;
        }
        number!(self, device, get, as_ref)
            .copied()
            .unwrap_or(f64::NAN)
    }

    /// Sets the value in a device; the tracker's scale stays as it is.
    pub fn set(self, device: &mut Device, value: f64) {
        if let Some(number) = number!(self, device, get_mut, as_mut, mut) {
            *number = value;
        }
    }
}

/// The reading per length of an instrument, which no reading of its own shows: every length that it measures, and so
/// every length that a fit gets from it, is wrong by the same share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LengthScale {
    /// The instrument's reading per length.
    pub parameter: SurroundingParameter,
    /// Standard deviation of its error, 1 being the whole length.
    pub sd: f64,
    /// Whether the device file states it; else it is [`UNSTATED_SCALE_SD`].
    pub is_stated: bool,
}

/// What the scale of an instrument is taken to be known to where the device file does not say: a millimetre in a metre
/// (docs/assumptions.md, A88).
pub const UNSTATED_SCALE_SD: f64 = 1e-3;

fn run_of(device: &Device, base: usize) -> String {
    let base = device.surroundings.run_bases.get(base);
    base.map_or_else(|| "?".to_owned(), |base| base.run.to_string())
}

fn tool_id(device: &Device, tool: usize) -> &str {
    let tool = device.surroundings.tools.get(tool);
    tool.map_or("?", |tool| &tool.id)
}

fn contact_id(device: &Device, point: usize) -> &str {
    let point = device.surroundings.contacts.get(point);
    point.map_or("?", |point| &point.id)
}

fn plane_id(device: &Device, plane: usize) -> &str {
    let plane = device.surroundings.planes.get(plane);
    plane.map_or("?", |plane| &plane.id)
}

impl Device {
    /// The scales of the instruments that measure lengths: the cables, and the tracker.
    ///
    /// ```
    /// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
    /// let mut device = haptical_model::Device::load(path.as_ref())?.device;
    /// device.cables[0].scale_sd = Some(2e-4);
    /// assert_eq!(device.length_scales()[0].sd, 2e-4);
    /// # Ok::<(), haptical_model::DeviceFileError>(())
    /// ```
    pub fn length_scales(&self) -> Vec<LengthScale> {
        let scale = |parameter, stated: Option<f64>| LengthScale {
            parameter,
            sd: stated.unwrap_or(UNSTATED_SCALE_SD),
            is_stated: stated.is_some(),
        };
        let cables = self.cables.iter().enumerate().map(|(cable, described)| {
            scale(
                SurroundingParameter::CableScale { cable },
                described.scale_sd,
            )
        });
        let tracker = self.tracker.map(|tracker| tracker.scale_sd);
        let tracker = tracker.map(|stated| scale(SurroundingParameter::TrackerScale, stated));
        cables.chain(tracker).collect()
    }

    /// All parameters of cables, tracker, tools, touched points and planes that are unknown: a cable's where its
    /// `fit` says so, the tracker's where its base or tool is unknown and has been given a place, a tool's where it
    /// has been given one.
    pub fn surrounding_parameters(&self) -> Vec<SurroundingParameter> {
        use SurroundingParameter as P;
        let mut parameters = Vec::new();
        let surroundings = &self.surroundings;
        if surroundings.tracker_base.is_some() {
            parameters.extend((0..6).map(|index| P::TrackerBase { index }));
        }
        for base in 0..surroundings.run_bases.len() {
            parameters.extend((0..6).map(|index| P::RunBase { base, index }));
        }
        if surroundings.tracker_tool.is_some() {
            parameters.extend((0..6).map(|index| P::TrackerTool { index }));
        }
        for (tool, described) in surroundings.tools.iter().enumerate() {
            let count = match described.placement {
                None => 0,
                Some(_) if described.has_turn => 6,
                Some(_) => 3,
            };
            parameters.extend((0..count).map(|index| P::Tool { tool, index }));
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
