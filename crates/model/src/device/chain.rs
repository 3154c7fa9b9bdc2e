//! The chain of a device with everything that belongs to it, made once and evaluated at many outputs.

use haptical_kinematics::{Chain, Convention, KinematicsError, Link, Motion, Pose};

use crate::{Device, Drive, ModelError};

/// Rows with their homes, motions, origins and drives. It owns them, so that a [`Chain`] can borrow.
///
/// Whoever needs the chain of a device, or a part of it, takes it from here: a chain that is built from
/// the table alone is wrong for a device with origins or with rows that follow another's joint.
///
/// ```
/// use haptical_model::{Device, DeviceChain};
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
/// let device = Device::load(path.as_ref())?.device;
/// let chain = DeviceChain::new(&device);
/// let handle = chain.pose(&[0.0; 7])?;
/// // the robot's base: rows up to and with row 0
/// let base = chain.part(1)?.pose(&[])?;
/// assert_ne!(handle.position_m, base.position_m);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct DeviceChain {
    convention: Convention,
    /// Rows, homes added. What they hold may be changed; their number not.
    pub links: Vec<Link>,
    motions: Vec<Motion>,
    origins: Vec<Option<Pose>>,
    drives: Vec<Drive>,
    /// Rows of the device that the chain is of, in its order.
    rows: Vec<usize>,
    /// Where each row of the device is in the chain.
    places: Vec<Option<usize>>,
    joints: usize,
}

impl DeviceChain {
    /// The chain of a device; of its first hand, where it has several ([`DeviceChain::of_hand`]).
    pub fn new(device: &Device) -> Self {
        Self::of_hand(device, 0)
    }

    /// The chain that ends at a hand (from 0) of a device that branches; the device's only chain otherwise.
    ///
    /// ```
    /// use haptical_model::{Device, DeviceChain};
    /// let link = |a_m: f64, more: &str| format!("[[link]]\na_m = {a_m}\nalpha_rad = 0.0\nd_m = 0.0\n{more}");
    /// let rows = [link(0.0, ""), link(1.0, ""), link(0.2, ""), link(0.5, "parent = 1\n")].concat();
    /// let hands = "[[hand]]\nname = \"left\"\nrow = 2\n[[hand]]\nname = \"right\"\nrow = 3\n";
    /// let text = format!("{rows}[[joint]]\n[[joint]]\n[[joint]]\n{hands}");
    /// let device = Device::from_toml(&text, "y.toml")?.device;
    /// let reach_m = |hand| DeviceChain::of_hand(&device, hand).pose(&[0.0; 3]).map(|pose| pose.position_m.x);
    /// assert_eq!([reach_m(0)?, reach_m(1)?], [1.2, 1.5]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of_hand(device: &Device, hand: usize) -> Self {
        let handle = device.handle_of(hand);
        let last = match device.hands.get(hand) {
            Some(hand) => hand.row,
            None => device.links.len().saturating_sub(1),
        };
        let mut chain = Self::to_row(device, last);
        if handle.is_some() {
            chain.origins.resize(chain.links.len(), None);
            chain.origins.push(handle);
        }
        chain
    }

    /// The rows from row 0 to `row`, without what is behind them.
    pub fn to_row(device: &Device, row: usize) -> Self {
        let count = device.links.len();
        let rows = match count {
            0 => Vec::new(),
            _ => device.path_to(row),
        };
        let mut places = vec![None; count];
        for (place, row) in rows.iter().enumerate() {
            places[*row] = Some(place);
        }
        let (links, motions) = (device.chain_links(), device.motions());
        let origins = device.chain_origins();
        let origin = |row: &usize| origins.get(*row).copied().flatten();
        let mut own: Vec<Option<Pose>> = rows.iter().map(origin).collect();
        if own.iter().all(Option::is_none) {
            own.clear();
        }
        Self {
            convention: device.convention,
            links: rows.iter().map(|row| links[*row]).collect(),
            motions: rows.iter().map(|row| motions[*row]).collect(),
            origins: own,
            drives: rows.iter().filter_map(|row| device.drive(*row)).collect(),
            rows,
            places,
            joints: if count == 0 { 0 } else { device.joints.len() },
        }
    }

    /// The device's rows that the chain is of, in its order.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Where a row of the device is in the chain; none where it is on another branch.
    pub fn place(&self, row: usize) -> Option<usize> {
        self.places.get(row).copied().flatten()
    }

    /// Number of rows, row 0 included.
    pub fn row_count(&self) -> usize {
        self.links.len()
    }

    /// What each row's variable does.
    pub fn motions(&self) -> &[Motion] {
        &self.motions
    }

    /// What moves the chain's rows behind row 0, in their order.
    pub fn drives(&self) -> &[Drive] {
        &self.drives
    }

    /// The constant transforms before the rows and before the handle; may be shorter.
    pub fn origins(&self) -> &[Option<Pose>] {
        &self.origins
    }

    /// The whole chain, up to the handle.
    ///
    /// # Errors
    /// [`KinematicsError`] as [`Chain::with_origins`].
    pub fn chain(&self) -> Result<Chain<'_>, KinematicsError> {
        Chain::with_origins(self.convention, &self.links, &self.motions, &self.origins)
    }

    /// The first `rows` rows, without what is behind them; all where there are not so many.
    ///
    /// # Errors
    /// [`KinematicsError`] as [`Chain::with_origins`]; no rows are no chain.
    pub fn part(&self, rows: usize) -> Result<Chain<'_>, KinematicsError> {
        let rows = rows.min(self.links.len());
        let origins = &self.origins[..rows.min(self.origins.len())];
        let (links, motions) = (&self.links[..rows], &self.motions[..rows]);
        Chain::with_origins(self.convention, links, motions, origins)
    }

    /// Variables of the moving rows at output angles (one per joint): `multiplier output`, since home
    /// and offset are in the rows. `variables` has one entry for each row but row 0, or for the first of
    /// them. An output that is missing makes its rows' variables NaN, which every chain refuses.
    pub fn variables(&self, outputs: &[f64], variables: &mut [f64]) {
        for (variable, drive) in variables.iter_mut().zip(&self.drives) {
            let output = outputs.get(drive.joint).copied().unwrap_or(f64::NAN);
            *variable = drive.multiplier * output;
        }
    }

    /// Handle pose at output angles (one per joint), in frame (-1).
    ///
    /// # Errors
    /// [`KinematicsError::JointCount`] and as [`Chain::pose`].
    pub fn pose(&self, outputs: &[f64]) -> Result<Pose, KinematicsError> {
        let (expected, got) = (self.joints, outputs.len());
        if expected != got {
            return Err(KinematicsError::JointCount { expected, got });
        }
        let mut variables = vec![0.0; self.drives.len()];
        self.variables(outputs, &mut variables);
        self.chain()?.pose(&variables)
    }
}

/// The chains of a device, one for each hand.
#[derive(Debug, Clone)]
pub(crate) struct Chains {
    all: Vec<DeviceChain>,
    /// The hand that is looked at; none where nobody has said which.
    pub(crate) hand: Option<usize>,
    device: String,
}

impl Chains {
    pub(crate) fn new(device: &Device) -> Self {
        let hands = 0..device.chain_count();
        Self {
            all: hands
                .map(|hand| DeviceChain::of_hand(device, hand))
                .collect(),
            hand: (!device.has_hands()).then_some(0),
            device: device.name.clone(),
        }
    }

    pub(crate) fn chosen(&self) -> Result<&DeviceChain, ModelError> {
        let chain = self.hand.and_then(|hand| self.all.get(hand));
        chain.ok_or_else(|| ModelError::NoHand {
            device: self.device.clone(),
        })
    }
}
