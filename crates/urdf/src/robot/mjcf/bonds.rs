//! Equalities of an MJCF that bind a joint to another one: it follows, as by a URDF's `<mimic>`.

use crate::numbers::number;
use crate::robot::mjcf::{Mjcf, References};
use crate::robot::xml::{Element, Result, elements};
use crate::robot::{Mimic, Robot};

/// Coefficients of MuJoCo's polynomial.
const MOST_COEFFICIENTS: usize = 5;

impl Mjcf<'_, '_> {
    /// Lets joints follow those that they are bound to.
    ///
    /// MuJoCo's y - y0 = a0 + a1 (x - x0), from the initial values y0 and x0.
    pub(crate) fn bind(&self, robot: &mut Robot, references: &References) -> Result<()> {
        let root = self.reader.document.root_element();
        let bonds = elements(root, "equality").flat_map(|section| elements(section, "joint"));
        for node in bonds {
            if node.attribute("active") == Some("false") {
                continue;
            }
            let place = "an <equality> of joints";
            let first = self.reader.required(node, place, "joint1")?;
            let index = self.find(robot, references, node, first)?;
            let coefficients = self.coefficients(node, place)?;
            let (straight, rest) = coefficients.split_at(2);
            let second = node.attribute("joint2");
            let (Some(second), true) = (second, rest.iter().all(|own| *own == 0.0)) else {
                let at = self.reader.position_at(node.range().start);
                robot.notes.push(format!(
                    "{at}: joint `{first}` is bound by more than a multiple of another joint: it is taken as free to move"
                ));
                continue;
            };
            self.find(robot, references, node, second)?;
            let value = |name: &str| references.get(name).copied().unwrap_or(0.0);
            robot.joints[index].mimic = Some(Mimic {
                joint: second.to_owned(),
                multiplier: straight[1],
                offset: value(first) + straight[0] - straight[1] * value(second),
                place: node.range().start,
            });
        }
        Ok(())
    }

    fn find(
        &self,
        robot: &Robot,
        references: &References,
        node: Element<'_, '_>,
        name: &str,
    ) -> Result<usize> {
        let known = references.contains_key(name);
        let found = robot.joints.iter().position(|joint| joint.name == name);
        found.filter(|_| known).ok_or_else(|| {
            let name: String = name.chars().take(60).collect();
            let message = format!("an <equality> of joints: there is no joint `{name}`");
            self.reader.tree(node.range().start, message)
        })
    }

    fn coefficients(&self, node: Element<'_, '_>, place: &str) -> Result<Vec<f64>> {
        let mut coefficients = vec![0.0, 1.0, 0.0, 0.0, 0.0];
        let Some(text) = node.attribute("polycoef") else {
            return Ok(coefficients);
        };
        let words: Vec<Option<f64>> = text.split_ascii_whitespace().map(number).collect();
        if words.len() > MOST_COEFFICIENTS || words.iter().any(Option::is_none) {
            let found = format!("\"{text}\"");
            let allowed = "at most five finite numbers are expected, separated by blanks";
            return Err(self.reader.refuse(node, place, "polycoef", &found, allowed));
        }
        for (own, word) in coefficients.iter_mut().zip(words) {
            *own = word.unwrap_or(*own);
        }
        Ok(coefficients)
    }
}
