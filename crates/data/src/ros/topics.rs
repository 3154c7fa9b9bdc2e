//! The messages of a bag, topic by topic, before one topic is chosen.

use std::collections::{BTreeMap, BTreeSet};

use super::messages::JointState;

/// A pose as a row has it: x, y, z \[m\], then the quaternion w, x, y, z.
pub(super) type PoseCells = [f64; 7];

/// Joint states of one topic that have all of the wanted joints.
#[derive(Debug, Default)]
pub(super) struct JointTopic {
    /// Stamps in the messages \[ns\].
    pub(super) stamps_ns: Vec<i64>,
    /// When the messages were recorded \[ns\].
    pub(super) recorded_ns: Vec<i64>,
    /// Readings \[rad\] or \[m\], joint by joint.
    pub(super) position: Vec<Vec<f64>>,
    /// Efforts \[N m\] or \[N\]; `NaN` where a message has none.
    pub(super) effort: Vec<Vec<f64>>,
    /// The first message that has some of the joints and not others: its number and those that it lacks.
    pub(super) partial: Option<(usize, Vec<String>)>,
    /// Messages without any of the joints, as those of a gripper.
    pub(super) others: usize,
    /// Names of the first message's joints.
    pub(super) names: Vec<String>,
    /// Messages so far.
    pub(super) messages: usize,
}

/// All topics of a bag that count.
#[derive(Debug, Default)]
pub(super) struct Topics {
    pub(super) joints: BTreeMap<String, JointTopic>,
    pub(super) poses: BTreeMap<String, Vec<(i64, PoseCells)>>,
    /// Names of joints in messages, for advice.
    pub(super) names: BTreeSet<String>,
    /// Numbers kept so far.
    pub(super) numbers: u64,
}

/// Most names that advice lists.
const MOST_NAMES: usize = 24;

impl Topics {
    /// Adds a joint state; what does not fit in itself is said in words.
    pub(super) fn add_joints(
        &mut self,
        topic: &str,
        wanted: &[String],
        recorded_ns: i64,
        message: &JointState,
    ) -> Result<(), String> {
        for name in &message.name {
            if self.names.len() < MOST_NAMES && !self.names.contains(name) {
                self.names.insert(name.clone());
            }
        }
        let topic = entry(&mut self.joints, topic);
        topic.messages += 1;
        if topic.messages == 1 {
            topic.names.clone_from(&message.name);
        }
        if topic.position.is_empty() {
            topic.position = vec![Vec::new(); wanted.len()];
            topic.effort = vec![Vec::new(); wanted.len()];
        }
        let n_names = message.name.len();
        if message.position.len() != n_names {
            let (number, got) = (topic.messages, message.position.len());
            return Err(format!(
                "message {number} has {got} positions for {n_names} joints"
            ));
        }
        if ![0, n_names].contains(&message.effort.len()) {
            let (number, got) = (topic.messages, message.effort.len());
            return Err(format!(
                "message {number} has {got} efforts for {n_names} joints"
            ));
        }
        let places: Vec<Option<usize>> = wanted
            .iter()
            .map(|wanted| message.name.iter().position(|name| name == wanted))
            .collect();
        if places.iter().all(Option::is_none) {
            topic.others += 1;
            return Ok(());
        }
        let lacking = wanted.iter().zip(&places).filter(|(_, at)| at.is_none());
        let lacking: Vec<String> = lacking.map(|(name, _)| name.clone()).collect();
        if !lacking.is_empty() {
            topic.partial.get_or_insert((topic.messages, lacking));
            return Ok(());
        }
        for (joint, place) in places.into_iter().flatten().enumerate() {
            topic.position[joint].push(message.position[place]);
            let effort = message.effort.get(place).copied();
            topic.effort[joint].push(effort.unwrap_or(f64::NAN));
        }
        topic.stamps_ns.push(message.header.stamp_ns());
        topic.recorded_ns.push(recorded_ns);
        self.numbers += 2 + 2 * wanted.len() as u64;
        Ok(())
    }

    /// Adds a pose.
    pub(super) fn add_pose(&mut self, topic: &str, stamp_ns: i64, cells: PoseCells) {
        entry(&mut self.poses, topic).push((stamp_ns, cells));
        self.numbers += 1 + cells.len() as u64;
    }
}

/// The entry of a topic, made if it is missing.
fn entry<'m, T: Default>(map: &'m mut BTreeMap<String, T>, topic: &str) -> &'m mut T {
    if !map.contains_key(topic) {
        map.insert(topic.to_owned(), T::default());
    }
    map.entry(topic.to_owned()).or_default()
}
