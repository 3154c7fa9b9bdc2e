//! What `<compiler>` and `<option>` of an MJCF say: units of angles, the order of Euler's, limits, gravity.

use crate::numbers::number;
use crate::robot::Robot;
use crate::robot::mjcf::masses::MassRules;
use crate::robot::xml::{Element, Reader, Result, elements};

/// Time step of an MJCF that says none \[s\].
const STEP_S: f64 = 0.002;

/// Settings that the reading of elements depends on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Compiler {
    /// Angle of 1 in the file \[rad\].
    pub(crate) angle_rad: f64,
    /// Axes of Euler's angles: small letters about the turned axes, capitals about the fixed ones.
    pub(crate) euler: [char; 3],
    /// Whether a range is a limit where the file does not say so.
    pub(crate) has_automatic_limits: bool,
    pub(crate) masses: MassRules,
}

impl Compiler {
    pub(crate) fn read(reader: &Reader<'_, '_>, robot: &mut Robot) -> Result<Self> {
        let mut compiler = Self {
            angle_rad: std::f64::consts::PI / 180.0,
            euler: ['x', 'y', 'z'],
            has_automatic_limits: true,
            masses: MassRules::default(),
        };
        let root = reader.document.root_element();
        for node in elements(root, "compiler") {
            compiler.add(reader, node, robot)?;
        }
        robot.angle_rad = compiler.angle_rad;
        robot.step_s = STEP_S;
        for node in elements(root, "option") {
            let step_s = node.attribute("timestep").and_then(number);
            robot.step_s = step_s
                .filter(|step_s| *step_s > 0.0)
                .unwrap_or(robot.step_s);
            if let Some(gravity) = reader.vector(node, "<option>", "gravity")? {
                robot.stated_gravity_mps2 = Some(gravity);
            }
            let mut flags = elements(node, "flag");
            if flags.any(|flag| flag.attribute("gravity") == Some("disable")) {
                robot.stated_gravity_mps2 = Some([0.0; 3]);
            }
        }
        Ok(compiler)
    }

    fn add(
        &mut self,
        reader: &Reader<'_, '_>,
        node: Element<'_, '_>,
        robot: &mut Robot,
    ) -> Result<()> {
        let refuse = |what, found: &str, allowed| {
            Err(reader.refuse(node, "<compiler>", what, &format!("\"{found}\""), allowed))
        };
        self.masses.add(reader, node)?;
        match node.attribute("angle") {
            None => {}
            Some("radian") => self.angle_rad = 1.0,
            Some("degree") => self.angle_rad = std::f64::consts::PI / 180.0,
            Some(other) => return refuse("the angle", other, "radian or degree is expected"),
        }
        if let Some(text) = node.attribute("eulerseq") {
            let axes: Vec<char> = text.chars().collect();
            match <[char; 3]>::try_from(axes) {
                Ok(axes) if axes.iter().all(|axis| "xyzXYZ".contains(*axis)) => self.euler = axes,
                _ => {
                    return refuse(
                        "the eulerseq",
                        text,
                        "three of x, y, z, X, Y, Z are expected",
                    );
                }
            }
        }
        if let Some(text) = node.attribute("autolimits") {
            self.has_automatic_limits = text == "true";
        }
        if node.attribute("coordinate") == Some("global") {
            let allowed = "positions in the world's frame are not read: local is expected";
            return refuse("the coordinate", "global", allowed);
        }
        if node.attribute("inertiafromgeom") == Some("true") {
            robot.notes.push(format!(
                "{}: inertiafromgeom=\"true\" has MuJoCo work out masses from geoms; those of <inertial> are read",
                reader.position_at(node.range().start)
            ));
        }
        Ok(())
    }
}
