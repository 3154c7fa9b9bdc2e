//! The frames between which a tracker sees: its own, and the one that is fixed to the handle.

use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::kinematics::{Pose, Twist};
use haptical_model::{Device, ModelError, ParameterId, SurroundingParameter};

use super::kind::Posture;

/// Pose of what is tracked in the tracker's frame, `B T X`: B frame (-1) seen from the tracker, T the
/// handle's pose, X what is tracked seen from the handle.
///
/// ```
/// use haptical_calibration::Tracked;
/// use haptical_model::kinematics::nalgebra::Vector3;
/// use haptical_model::kinematics::{Pose, Twist};
/// use haptical_model::{Device, Origin, Placement};
///
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
/// let mut device = Device::load(path.as_ref())?.device;
/// let handle = Pose::default();
/// assert!(Tracked::new(&device, &handle, None).is_none());
/// // a marker 0.1 m off the handle: a turn about z moves it along y
/// let start = Origin { position_m: [0.1, 0.0, 0.0], ..Origin::IDENTITY };
/// device.surroundings.tracker_tool = Some(Placement { start, ..Placement::default() });
/// let tracked = Tracked::new(&device, &handle, None).ok_or("a tool")?;
/// let turn = Twist { linear: Vector3::zeros(), angular: Vector3::z() };
/// assert!((tracked.carried(&turn).linear - Vector3::new(0.0, 0.1, 0.0)).norm() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Tracked {
    base: Pose,
    tool: Pose,
    /// Rotation vectors per unit of the base's turn, in the tracker's frame.
    base_turn: Matrix3<f64>,
    /// Rotation vectors per unit of the tool's turn, in the handle frame.
    tool_turn: Matrix3<f64>,
    handle: Pose,
    /// Which tool is seen, where each hand has its own.
    own: Option<usize>,
}

impl Tracked {
    /// None where the tracker's base and tool are known: then it sees the handle itself in frame (-1).
    /// `own` is the tool that is seen ([`Device::tool_at`]).
    pub fn new(device: &Device, handle: &Pose, own: Option<usize>) -> Option<Self> {
        let (base, tool) = (device.surroundings.tracker_base, device.seen_tool(own));
        if base.is_none() && tool.is_none() {
            return None;
        }
        let (base, tool) = (base.unwrap_or_default(), tool.unwrap_or_default());
        Some(Self {
            base: base.pose(),
            tool: tool.pose(),
            base_turn: base.turn_axes(),
            tool_turn: tool.turn_axes(),
            handle: *handle,
            own,
        })
    }

    /// From the handle to what is tracked, in frame (-1).
    fn arm(&self) -> Vector3<f64> {
        self.handle.rotation * self.tool.position_m
    }

    /// From frame (-1)'s origin to what is tracked, turned into the tracker's frame.
    fn reach(&self) -> Vector3<f64> {
        self.base.rotation * (self.handle.position_m + self.arm())
    }

    /// What the tracker should see.
    pub fn pose(&self) -> Pose {
        Pose {
            position_m: self.reach() + self.base.position_m,
            rotation: self.base.rotation * self.handle.rotation * self.tool.rotation,
        }
    }

    /// How what it sees changes when the handle moves by a twist in frame (-1).
    pub fn carried(&self, twist: &Twist) -> Twist {
        let linear = twist.linear + twist.angular.cross(&self.arm());
        Twist {
            linear: self.base.rotation * linear,
            angular: self.base.rotation * twist.angular,
        }
    }

    /// How what it sees changes with a number of base or tool; none for another parameter.
    pub(crate) fn derivative(&self, parameter: ParameterId) -> Option<Twist> {
        let unit = |index: usize| Vector3::ith(index, 1.0);
        let slide = |linear: Vector3<f64>| Twist {
            linear,
            angular: Vector3::zeros(),
        };
        match parameter {
            ParameterId::Surrounding(SurroundingParameter::TrackerBase { index }) => {
                Some(match index.checked_sub(3) {
                    None => slide(unit(index)),
                    Some(turn) => {
                        let angular = self.base_turn.column(turn).into_owned();
                        Twist {
                            linear: angular.cross(&self.reach()),
                            angular,
                        }
                    }
                })
            }
            ParameterId::Surrounding(SurroundingParameter::Tool { tool, .. })
                if Some(tool) != self.own =>
            {
                Some(Twist::default())
            }
            ParameterId::Surrounding(
                SurroundingParameter::TrackerTool { index }
                | SurroundingParameter::Tool { index, .. },
            ) => {
                let turned = self.base.rotation * self.handle.rotation;
                Some(match index.checked_sub(3) {
                    None => slide(turned * unit(index)),
                    Some(turn) => Twist {
                        linear: Vector3::zeros(),
                        angular: turned * self.tool_turn.column(turn),
                    },
                })
            }
            _ => None,
        }
    }
}

/// What a tracker sees of the device at a row: the handle itself, or what is tracked.
pub(crate) struct Sight {
    pub(crate) pose: Pose,
    tracked: Option<Tracked>,
}

impl Sight {
    pub(crate) fn new(at: &Posture<'_>) -> Result<Self, ModelError> {
        let handle = at.evaluation.pose()?;
        let own = at.device.tool_at(at.recording, at.row);
        let tracked = Tracked::new(at.device, handle, own);
        Ok(Self {
            pose: tracked.map_or(*handle, |tracked| tracked.pose()),
            tracked,
        })
    }

    /// How the pose changes with a parameter of the chain or the tracker.
    pub(crate) fn derivative(&self, at: &Posture<'_>, parameter: ParameterId) -> Twist {
        if parameter == ParameterId::Surrounding(SurroundingParameter::TrackerScale) {
            return Twist {
                linear: self.pose.position_m,
                angular: Vector3::zeros(),
            };
        }
        let of_handle = || at.evaluation.pose_derivative(parameter);
        self.tracked.as_ref().map_or_else(of_handle, |tracked| {
            let own = tracked.derivative(parameter);
            own.unwrap_or_else(|| tracked.carried(&of_handle()))
        })
    }
}

/// Whether a number of the surroundings is one of the tracker's own.
pub(crate) fn is_of_tracker(parameter: SurroundingParameter) -> bool {
    use SurroundingParameter::{Tool, TrackerBase, TrackerScale, TrackerTool};
    matches!(
        parameter,
        TrackerBase { .. } | TrackerTool { .. } | Tool { .. } | TrackerScale
    )
}
