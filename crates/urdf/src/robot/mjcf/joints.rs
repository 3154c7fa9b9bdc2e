//! The joints of a body of an MJCF, one behind the other, and what its drive yields.

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Rotation3, Unit, Vector3};

use crate::numbers::{ONE_NUMBER, number};
use crate::robot::mjcf::Attributes;
use crate::robot::mjcf::bodies::{Bodies, Part, bare, name_of};
use crate::robot::mjcf::frames::direction;
use crate::robot::mjcf::unread::{is_curved, is_some};
use crate::robot::xml::Result;
use crate::robot::{Coordinates, PlacedBy, RobotJoint, RobotJointType};
use haptical_model::rigid::{then, turn};

/// How far the axes and places of two joints along one line may differ.
const SAME: f64 = 1e-9;

/// A hinge or slide in its body's frame.
struct Own {
    name: Option<String>,
    is_slide: bool,
    /// A place on the axis \[m\].
    place_m: Vector3<f64>,
    axis: Unit<Vector3<f64>>,
    /// Its value where the body is as the file places it \[rad\] or \[m\].
    reference: f64,
    limits: Option<(f64, f64)>,
    stiffness: f64,
    armature: Option<f64>,
    friction: [f64; 2],
    effort: Option<f64>,
}

impl Own {
    fn is_along(&self, other: &Self) -> bool {
        let gap = (self.axis.into_inner() - other.axis.into_inner()).amax();
        self.is_slide == other.is_slide
            && gap <= SAME
            && (self.place_m - other.place_m).amax() <= SAME
    }
}

fn moved(by_m: Vector3<f64>) -> Pose {
    Pose {
        position_m: by_m,
        ..Pose::default()
    }
}

impl<'d, 'input> Bodies<'_, 'd, 'input> {
    /// Adds a body's joints and its link behind them; gives the link.
    pub(crate) fn behind_joints(
        &mut self,
        body: &str,
        parts: &[Part<'d, 'input>],
        (parent, pose, placed_by): (usize, Pose, PlacedBy),
    ) -> Result<usize> {
        let is_joint = |part: &&Part<'d, 'input>| {
            matches!(part.own.node.tag_name().name(), "joint" | "freejoint")
        };
        let joints: Vec<&Part<'d, 'input>> = parts.iter().filter(is_joint).collect();
        if joints.is_empty() {
            return self.fixed(body, (parent, pose, Some(placed_by)), placed_by.place);
        }
        let own_place = placed_by.place;
        let (mut at, mut before, mut placed_by) = (parent, pose, Some(placed_by));
        let mut last: Option<(Own, usize)> = None;
        let count = joints.len();
        for (number, part) in joints.into_iter().enumerate() {
            let own = self.own_joint(part)?;
            let is_ball = self.mjcf.attribute(&part.own, "type") == Some("ball");
            let [positions, velocities] = match (&own, is_ball) {
                (Some(_), _) => [1, 1],
                (None, true) => [4, 3],
                (None, false) => [7, 6],
            };
            self.robot.coordinates.push(Coordinates {
                place: part.own.node.range().start,
                positions,
                velocities,
            });
            if let (Some((first, joint)), Some(own)) = (&last, &own)
                && self.is_yield(first, own)
            {
                self.joint_name(part, own.name.clone())?;
                self.take_yield(part, own, *joint);
                continue;
            }
            let (axis, behind) = match &own {
                Some(own) => (own.axis, own.behind()),
                None => (Vector3::z_axis(), Pose::default()),
            };
            let name = self.joint_name(part, own.as_ref().and_then(|own| own.name.clone()))?;
            self.note_forces(part, &name);
            let link = match number + 1 == count && own.as_ref().is_none_or(Own::is_at_body) {
                true => body.to_owned(),
                false => self.free_link(format!("{body}/{name}")),
            };
            let place = part.own.node.range().start;
            let child = self.link(link, own_place)?;
            let placed = placed_by.take().map(|placed| PlacedBy { behind, ..placed });
            let joint = self.joint(RobotJoint {
                joint_type: self.joint_type(part, own.as_ref()),
                axis: axis.into_inner().into(),
                limits: own.as_ref().and_then(|own| own.limits),
                armature: own.as_ref().and_then(|own| own.armature),
                friction: own.as_ref().map_or([0.0; 2], |own| own.friction),
                effort: own.as_ref().and_then(|own| own.effort),
                name: name.clone(),
                ..bare(place, (at, child), then(&before, &behind), placed)
            })?;
            at = child;
            before = moved(-own.as_ref().map_or(Vector3::zeros(), |own| own.place_m));
            let reference = own.as_ref().map_or(0.0, |own| own.reference);
            self.references.insert(name, reference);
            last = own.map(|own| (own, joint));
        }
        // the frame behind the last joint is the body's, or is moved into it
        if self.robot.links[at].name == body {
            return Ok(at);
        }
        self.fixed(body, (at, before, None), own_place)
    }

    fn joint_type(&self, part: &Part<'d, 'input>, own: Option<&Own>) -> RobotJointType {
        match own {
            Some(own) if own.is_slide => RobotJointType::Prismatic,
            Some(own) if own.limits.is_some() => RobotJointType::Revolute,
            Some(_) => RobotJointType::Continuous,
            None if self.mjcf.attribute(&part.own, "type") == Some("ball") => {
                RobotJointType::Other("a ball joint")
            }
            None => RobotJointType::Other("free (name a body behind it with --base)"),
        }
    }

    fn joint_name(&mut self, part: &Part<'d, 'input>, stated: Option<String>) -> Result<String> {
        let place = part.own.node.range().start;
        let stated = stated.or_else(|| name_of(part.own.node).map(str::to_owned));
        let name = stated.unwrap_or_else(|| {
            let mut name = format!("joint{}", self.joint_names.len() + 1);
            while self.stated_joints.contains(name.as_str()) || self.joint_names.contains(&name) {
                name.push('_');
            }
            name
        });
        if self.joint_names.insert(name.clone()) {
            return Ok(name);
        }
        let message = format!("there are two joints `{name}`: rename one");
        Err(self.mjcf.reader.tree(place, message))
    }

    /// A hinge or slide; none for a ball or a free joint.
    fn own_joint(&self, part: &Part<'d, 'input>) -> Result<Option<Own>> {
        let (mjcf, own) = (self.mjcf, &part.own);
        let reader = &mjcf.reader;
        let name = name_of(own.node).map(str::to_owned);
        let place = format!("joint `{}`", name.as_deref().unwrap_or("without a name"));
        if own.node.has_tag_name("freejoint") {
            return Ok(None);
        }
        let is_slide = match mjcf.attribute(own, "type").unwrap_or("hinge") {
            "hinge" => false,
            "slide" => true,
            "ball" | "free" => return Ok(None),
            other => {
                let found = format!("\"{other}\"");
                let allowed = "hinge, slide, ball or free is expected";
                return Err(reader.refuse(own.node, &place, "the type", &found, allowed));
            }
        };
        let unit = if is_slide {
            1.0
        } else {
            mjcf.compiler.angle_rad
        };
        let axis = mjcf.three(own, &place, "axis")?.unwrap_or([0.0, 0.0, 1.0]);
        let axis = direction(part.frame.rotation * Vector3::from(axis));
        let axis = axis.ok_or_else(|| {
            let found = format!("\"{}\"", mjcf.attribute(own, "axis").unwrap_or_default());
            reader.refuse(
                own.node,
                &place,
                "the axis",
                &found,
                "it must have a direction",
            )
        })?;
        let position_m = mjcf.three(own, &place, "pos")?.unwrap_or([0.0; 3]);
        let stiffness = mjcf.attribute(own, "stiffness");
        // MuJoCo takes further coefficients of a spring that hardens
        let stiffness = stiffness.and_then(|text| text.split_ascii_whitespace().next());
        Ok(Some(Own {
            armature: self.armature(part, &place)?,
            friction: [self.first(own, "frictionloss"), self.first(own, "damping")],
            effort: mjcf.effort(own),
            name,
            is_slide,
            place_m: part.frame.position_m + part.frame.rotation * Vector3::from(position_m),
            axis,
            reference: mjcf.one(own, &place, "ref")?.unwrap_or(0.0) * unit,
            limits: self.limits(part, &place, unit)?,
            stiffness: stiffness.and_then(|word| word.parse().ok()).unwrap_or(0.0),
        }))
    }

    /// Notes a joint whose spring is left out, or whose damping is more than one number.
    fn note_forces(&mut self, part: &Part<'d, 'input>, name: &str) {
        let text = |key| self.mjcf.attribute(&part.own, key);
        let [is_sprung, is_tuned, is_bent] = [
            text("stiffness").is_some_and(is_some),
            text("springdamper").is_some_and(is_some),
            text("damping").is_some_and(is_curved),
        ];
        let name = format!("`{name}`");
        if is_tuned {
            self.tuned.push(name.clone());
        } else if is_sprung {
            self.sprung.push(name.clone());
        }
        if is_bent {
            self.curved.push(name);
        }
    }

    /// The first number of an attribute; MuJoCo takes further coefficients of a damping that grows.
    fn first(&self, own: &Attributes<'d, 'input>, key: &str) -> f64 {
        let text = self.mjcf.attribute(own, key);
        let word = text.and_then(|text| text.split_ascii_whitespace().next());
        word.and_then(number).unwrap_or(0.0).max(0.0)
    }

    /// What the file or the joint's class says of its armature.
    fn armature(&self, part: &Part<'d, 'input>, place: &str) -> Result<Option<f64>> {
        let armature = self.mjcf.one(&part.own, place, "armature")?;
        if let Some(found) = armature.filter(|own| *own < 0.0) {
            let (reader, allowed) = (&self.mjcf.reader, "an inertia is not negative");
            let found = found.to_string();
            return Err(reader.refuse(part.own.node, place, "armature", &found, allowed));
        }
        Ok(armature)
    }

    fn limits(
        &self,
        part: &Part<'d, 'input>,
        place: &str,
        unit: f64,
    ) -> Result<Option<(f64, f64)>> {
        let Some(text) = self.mjcf.attribute(&part.own, "range") else {
            return Ok(None);
        };
        let is_limited = match self.mjcf.attribute(&part.own, "limited").unwrap_or("auto") {
            "true" => true,
            "false" => false,
            _ => self.mjcf.compiler.has_automatic_limits,
        };
        if !is_limited {
            return Ok(None);
        }
        // a limit beyond any size is none
        let words: Vec<Option<f64>> = text
            .split_ascii_whitespace()
            .map(|word| word.parse().ok().filter(|end: &f64| !end.is_nan()))
            .collect();
        match words[..] {
            [Some(lower), Some(upper)] => Ok(Some((lower * unit, upper * unit))),
            _ => {
                let found = format!("\"{text}\"");
                let refuse = |allowed| {
                    let reader = &self.mjcf.reader;
                    reader.refuse(part.own.node, place, "range", &found, allowed)
                };
                Err(match words.len() {
                    2 => refuse(ONE_NUMBER),
                    _ => refuse("two numbers are expected, separated by a blank"),
                })
            }
        }
    }

    /// Whether a joint is what the drive of the one before it yields: along the same axis, and nobody moves it.
    fn is_yield(&self, first: &Own, own: &Own) -> bool {
        let is_driven = |name: &Option<String>| {
            name.as_deref().is_some_and(|name| {
                self.mjcf.actuated.contains(name) || self.mjcf.bound.contains(name)
            })
        };
        own.is_along(first) && own.reference == 0.0 && !is_driven(&own.name)
    }

    /// A spring's compliance goes to its joint; a play is left out.
    fn take_yield(&mut self, part: &Part<'d, 'input>, own: &Own, joint: usize) {
        let joint = &mut self.robot.joints[joint];
        if own.stiffness > 0.0 && (1.0 / own.stiffness).is_finite() {
            joint.compliance += 1.0 / own.stiffness;
            joint.springs.push(part.own.node.range().start);
            return;
        }
        let at = self.mjcf.reader.position_at(part.own.node.range().start);
        let name = own.name.as_deref().unwrap_or("without a name");
        let note = format!(
            "{at}: joint `{name}` moves along the axis of `{}` without an actuator and without a spring: it is left out as a \
             play",
            joint.name
        );
        self.robot.notes.push(note);
    }
}

impl Own {
    /// What leads from the body's frame to the joint's, at whose value 0 it is less its reference.
    fn behind(&self) -> Pose {
        let place = moved(self.place_m);
        if self.reference == 0.0 {
            return place;
        }
        let back = -self.reference;
        let motion = match self.is_slide {
            true => moved(self.axis.into_inner() * back),
            false => turn(Rotation3::from_axis_angle(&self.axis, back).into_inner()),
        };
        then(&place, &motion)
    }

    fn is_at_body(&self) -> bool {
        self.place_m == Vector3::zeros()
    }
}
