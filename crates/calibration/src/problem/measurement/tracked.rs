//! The frames between which a tracker sees: its own, and the one that is fixed to the handle.

use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::kinematics::{Pose, Twist};
use haptical_model::{Device, Mount, ParameterId, SurroundingParameter};

/// Pose of what is tracked in the tracker's frame, `B T X`: B frame (-1) seen from the tracker, T the
/// handle's pose, X what is tracked seen from the handle. Which base and which tool a row is about says its [`Mount`].
///
/// ```
/// use haptical_calibration::Tracked;
/// use haptical_model::kinematics::nalgebra::Vector3;
/// use haptical_model::kinematics::{Pose, Twist};
/// use haptical_model::{Device, Mount, Origin, Placement};
///
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
/// let mut device = Device::load(path.as_ref())?.device;
/// let handle = Pose::default();
/// assert!(Tracked::new(&device, &handle, Mount::default()).is_none());
/// // a marker 0.1 m off the handle: a turn about z moves it along y
/// let start = Origin { position_m: [0.1, 0.0, 0.0], ..Origin::IDENTITY };
/// device.surroundings.tracker_tool = Some(Placement { start, ..Placement::default() });
/// let tracked = Tracked::new(&device, &handle, Mount::default()).ok_or("a tool")?;
/// let turn = Twist { linear: Vector3::zeros(), angular: Vector3::z() };
/// assert!((tracked.carried(&turn).linear - Vector3::new(0.0, 0.1, 0.0)).norm() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Tracked {
    pose: Pose,
    /// The base's orientation in the tracker's frame.
    base: Matrix3<f64>,
    /// From the handle to what is tracked, in frame (-1).
    arm: Vector3<f64>,
    /// From frame (-1)'s origin to what is tracked, turned into the tracker's frame.
    reach: Vector3<f64>,
    /// The handle's orientation in the tracker's frame.
    turned: Matrix3<f64>,
}

/// Base and tool of a [`Mount`] as a device has them: the same at all its rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mounting {
    base: Pose,
    tool: Pose,
    /// Rotation vectors per unit of the base's turn, in the tracker's frame.
    base_turn: Matrix3<f64>,
    /// Rotation vectors per unit of the tool's turn, in the handle frame.
    tool_turn: Matrix3<f64>,
    mount: Mount,
}

/// The mountings of a problem's rows.
pub(crate) struct Mountings(Vec<(Mount, Option<Mounting>)>);

impl Mountings {
    /// `mounts` are those of the rows; empty where all have the default.
    pub(crate) fn new(device: &Device, mounts: &[Mount]) -> Self {
        let mut own: Vec<(Mount, Option<Mounting>)> = Vec::new();
        for mount in mounts.iter().copied().chain([Mount::default()]) {
            if own.iter().all(|(other, _)| *other != mount) {
                own.push((mount, Mounting::new(device, mount)));
            }
        }
        Self(own)
    }

    /// None where the tracker's base and tool are known.
    pub(crate) fn of(&self, mount: Mount) -> Option<&Mounting> {
        let own = self.0.iter().find(|(other, _)| *other == mount);
        own.and_then(|(_, mounting)| mounting.as_ref())
    }
}

impl Mounting {
    fn new(device: &Device, mount: Mount) -> Option<Self> {
        let (base, tool) = (device.base_of(mount), device.seen_tool_of(mount));
        if base.is_none() && tool.is_none() {
            return None;
        }
        let (base, tool) = (base.unwrap_or_default(), tool.unwrap_or_default());
        Some(Self {
            base: base.pose(),
            tool: tool.pose(),
            base_turn: base.turn_axes(),
            tool_turn: tool.turn_axes(),
            mount,
        })
    }

    /// From the handle to what is tracked, in frame (-1).
    pub(crate) fn arm(&self, handle: &Pose) -> Vector3<f64> {
        handle.rotation * self.tool.position_m
    }

    /// What is tracked where the handle is at a pose.
    pub(crate) fn at(&self, handle: &Pose) -> Tracked {
        let arm = self.arm(handle);
        let reach = self.base.rotation * (handle.position_m + arm);
        let turned = self.base.rotation * handle.rotation;
        Tracked {
            pose: Pose {
                position_m: reach + self.base.position_m,
                rotation: turned * self.tool.rotation,
            },
            base: self.base.rotation,
            arm,
            reach,
            turned,
        }
    }
}

impl Tracked {
    /// None where the tracker's base and tool are known: then it sees the handle itself in frame (-1).
    pub fn new(device: &Device, handle: &Pose, mount: Mount) -> Option<Self> {
        Some(Mounting::new(device, mount)?.at(handle))
    }

    /// What the tracker should see.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// The handle itself, in frame (-1).
    pub(crate) fn itself(handle: &Pose) -> Self {
        Self {
            pose: *handle,
            base: Matrix3::identity(),
            arm: Vector3::zeros(),
            reach: handle.position_m,
            turned: handle.rotation,
        }
    }

    /// How what it sees changes when the handle moves by a twist in frame (-1).
    pub fn carried(&self, twist: &Twist) -> Twist {
        let linear = twist.linear + twist.angular.cross(&self.arm);
        Twist {
            linear: self.base * linear,
            angular: self.base * twist.angular,
        }
    }

    /// How what it sees changes with a number of base or tool, those of `own`; none for another parameter.
    pub(crate) fn derivative(&self, own: &Mounting, parameter: ParameterId) -> Option<Twist> {
        let unit = |index: usize| Vector3::ith(index, 1.0);
        let slide = |linear: Vector3<f64>| Twist {
            linear,
            angular: Vector3::zeros(),
        };
        let ParameterId::Surrounding(parameter) = parameter else {
            return None;
        };
        if own.mount != mount_of(parameter, own.mount)? {
            return Some(Twist::default());
        }
        match parameter {
            SurroundingParameter::TrackerBase { index }
            | SurroundingParameter::RunBase { index, .. } => Some(match index.checked_sub(3) {
                None => slide(unit(index)),
                Some(turn) => {
                    let angular = own.base_turn.column(turn).into_owned();
                    Twist {
                        linear: angular.cross(&self.reach),
                        angular,
                    }
                }
            }),
            SurroundingParameter::TrackerTool { index }
            | SurroundingParameter::Tool { index, .. } => Some(match index.checked_sub(3) {
                None => slide(self.turned * unit(index)),
                Some(turn) => Twist {
                    linear: Vector3::zeros(),
                    angular: self.turned * own.tool_turn.column(turn),
                },
            }),
            _ => None,
        }
    }
}

/// The mount of a row that a number of base or tool is about, the other of the two as it is; none for another number.
fn mount_of(parameter: SurroundingParameter, mount: Mount) -> Option<Mount> {
    let (base, tool) = (mount.base, mount.tool);
    Some(match parameter {
        SurroundingParameter::TrackerBase { .. } => Mount { base: None, tool },
        SurroundingParameter::RunBase { base, .. } => Mount {
            base: Some(base),
            tool,
        },
        SurroundingParameter::TrackerTool { .. } => Mount { base, tool: None },
        SurroundingParameter::Tool { tool, .. } => Mount {
            base,
            tool: Some(tool),
        },
        _ => return None,
    })
}

/// Whether a number of the surroundings is one of the tracker's own.
pub(crate) fn is_of_tracker(parameter: SurroundingParameter) -> bool {
    use SurroundingParameter::{RunBase, Tool, TrackerBase, TrackerScale, TrackerTool};
    matches!(
        parameter,
        TrackerBase { .. } | RunBase { .. } | TrackerTool { .. } | Tool { .. } | TrackerScale
    )
}
