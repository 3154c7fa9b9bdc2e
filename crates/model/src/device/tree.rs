//! A device that branches: rows that hang on an earlier row, and the hands at which its chains end.

use haptical_kinematics::Pose;

use crate::{Device, Origin, Recording};

/// A place of a device that is measured: where one of its chains ends.
///
/// A device without hands has one, behind its last row.
#[derive(Debug, Clone, PartialEq)]
pub struct Hand {
    /// As in the log's column `hand`.
    pub name: String,
    /// Row behind which it is.
    pub row: usize,
    /// From that row's frame to the hand; none where it is that frame.
    pub handle: Option<Origin>,
}

impl Device {
    /// Whether the device has hands with names, so that a row of a log says which of them it is about.
    pub fn has_hands(&self) -> bool {
        !self.hands.is_empty()
    }

    /// The row that a row hangs on; none for row 0.
    pub fn parent(&self, row: usize) -> Option<usize> {
        let before = row.checked_sub(1)?;
        Some(self.parents.get(before).copied().unwrap_or(before))
    }

    /// Whether other rows hang on a row.
    pub fn has_rows_behind(&self, row: usize) -> bool {
        (row + 1..self.links.len()).any(|other| self.parent(other) == Some(row))
    }

    /// The rows from row 0 to `row`, both included: what moves that row's frame.
    ///
    /// ```
    /// use haptical_model::Device;
    /// let link = |more: &str| format!("[[link]]\na_m = 0.1\nalpha_rad = 0.0\nd_m = 0.0\n{more}");
    /// let [base, trunk, left, right] = ["", "", "", "parent = 1\n"].map(link);
    /// let hands = "[[hand]]\nname = \"left\"\nrow = 2\n[[hand]]\nname = \"right\"\nrow = 3\n";
    /// let text = format!("{base}{trunk}{left}{right}[[joint]]\n[[joint]]\n[[joint]]\n{hands}");
    /// let device = Device::from_toml(&text, "y.toml")?.device;
    /// assert_eq!(device.path_to(3), [0, 1, 3]);
    /// # Ok::<(), haptical_model::DeviceFileError>(())
    /// ```
    pub fn path_to(&self, row: usize) -> Vec<usize> {
        let mut path: Vec<usize> =
            std::iter::successors(Some(row), |row| self.parent(*row)).collect();
        path.reverse();
        path
    }

    /// Position of a hand within [`Device::hands`].
    pub fn hand_index(&self, name: &str) -> Option<usize> {
        self.hands.iter().position(|hand| hand.name == name)
    }

    /// Which hand a row of a recording is about: 0 for a device without hands, none where the recording does not say.
    pub fn hand_at(&self, recording: &Recording, row: usize) -> Option<usize> {
        if !self.has_hands() {
            return Some(0);
        }
        let hands = recording.hand.as_ref()?;
        self.hand_index(hands.get(row)?)
    }

    /// Whether each hand has a tracked tool of its own, at an unknown place.
    pub fn has_tool_per_hand(&self) -> bool {
        self.has_hands() && self.tracker.is_some_and(|tracker| !tracker.tool_known)
    }

    /// Number of chains: one for each hand.
    pub(crate) fn chain_count(&self) -> usize {
        self.hands.len().max(1)
    }

    /// From the last row of a hand's chain (from 0) to the hand; of a device without hands from its last row to the
    /// handle. None where the two are one.
    pub fn handle_of(&self, hand: usize) -> Option<Pose> {
        let own = self.hands.get(hand).map(|hand| hand.handle.as_ref());
        let only = || self.origins.get(self.links.len()).and_then(Option::as_ref);
        own.unwrap_or_else(only).map(Origin::pose)
    }
}
