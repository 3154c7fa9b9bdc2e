//! The chain of a device with everything that belongs to it, made once and evaluated at many outputs.

use haptical_kinematics::{Chain, Convention, KinematicsError, Link, Motion, Pose};

use crate::{Device, Drive};

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
}

impl DeviceChain {
    /// The chain of a device.
    pub fn new(device: &Device) -> Self {
        Self {
            convention: device.convention,
            links: device.chain_links(),
            motions: device.motions(),
            origins: device.chain_origins(),
            drives: (1..device.links.len())
                .filter_map(|row| device.drive(row))
                .collect(),
        }
    }

    /// Number of rows, row 0 included.
    pub fn row_count(&self) -> usize {
        self.links.len()
    }

    /// What each row's variable does.
    pub fn motions(&self) -> &[Motion] {
        &self.motions
    }

    /// What moves rows 1 to n, in their order.
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
        let joints = self.drives.iter().map(|drive| drive.joint + 1).max();
        let (expected, got) = (joints.unwrap_or(0), outputs.len());
        if expected != got {
            return Err(KinematicsError::JointCount { expected, got });
        }
        let mut variables = vec![0.0; self.drives.len()];
        self.variables(outputs, &mut variables);
        self.chain()?.pose(&variables)
    }
}
