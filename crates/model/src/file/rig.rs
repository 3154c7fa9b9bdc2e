//! Puts the sensors of a rig file into a device file: one device, many rigs.

use toml::de::DeTable;
use toml_edit::{Item, RawString, Table};

use crate::file::reader::{Section, Source};
use crate::file::sensors::{read_cables, read_contact_pairs, read_gravity, read_tracker};
use crate::file::syntax::syntax_error;
use crate::{Device, DeviceFileError};

/// What a rig file holds.
const SECTIONS: [&str; 12] = [
    "cable_encoder",
    "cable",
    "tracker",
    "tool",
    "contact_pair",
    "contact",
    "contact_point",
    "plane",
    "plane_pair",
    "touched_plane",
    "fixture",
    "gravity",
];

/// What stays with the device file.
const OF_A_DEVICE: [&str; 5] = ["device", "link", "joint", "hand", "nominal"];

impl Device {
    /// The text of a device file with the sections of a rig file (`[cable_encoder]`, `[[cable]]`,
    /// `[tracker]`, `[[tool]]`, `[contact]`, `[[contact_pair]]`, `[plane]`, `[[plane_pair]]`, `[fixture]`, `[gravity]`) in
    /// the place of its own; those that the rig file does not have stay. A rig with cables replaces all cables. Returns the text, and what is odd about the
    /// rig file. `file` and `rig_file` name the two in errors.
    ///
    /// ```
    /// use haptical_model::Device;
    /// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
    /// let text = haptical_model::read_toml_text(path.as_ref())?;
    /// let rig = "[tracker]\nbase = \"unknown\"\nposition_sd_m = 1e-4\n";
    /// let (text, warnings) = Device::with_rig(&text, "haptic7.toml", rig, "rig.toml")?;
    /// assert!(warnings.is_empty());
    /// let tracker = Device::from_toml(&text, "haptic7.toml")?.device.tracker;
    /// assert!(tracker.is_some_and(|tracker| !tracker.base_known));
    /// # Ok::<(), haptical_model::DeviceFileError>(())
    /// ```
    ///
    /// # Errors
    /// [`DeviceFileError`] with line and column; a rig file with parts of a device is refused.
    pub fn with_rig(
        text: &str,
        file: &str,
        rig_text: &str,
        rig_file: &str,
    ) -> Result<(String, Vec<String>), DeviceFileError> {
        let source = Source {
            file: rig_file,
            text: rig_text,
        };
        let document = DeTable::parse(rig_text)
            .map_err(|error| syntax_error(&source, error.span(), error.message()))?;
        let root = Section::root(source, document.get_ref());
        for key in OF_A_DEVICE {
            if root.has(key) {
                let found = format!("part of a device, [{key}]");
                let allowed = "a rig file holds sensors alone: leave it in the device file";
                return Err(root.refuse(key, found, allowed));
            }
        }
        let mut warnings = Vec::new();
        read_cables(&root, &mut warnings)?;
        let tracker = read_tracker(&root, &mut warnings)?;
        crate::file::surroundings::read_surroundings(
            &root,
            tracker.as_ref(),
            Vec::new(),
            &mut warnings,
        )?;
        read_contact_pairs(&root, &mut warnings)?;
        read_gravity(&root, &mut warnings)?;
        root.unknown_keys(&mut warnings);
        let rig = source.editable()?;
        let mut device = Source { file, text }.editable()?;
        if ["cable_encoder", "cable"]
            .iter()
            .any(|key| rig.contains_key(key))
        {
            device.remove("cable_encoder");
            device.remove("cable");
        }
        for (key, item) in rig.iter().filter(|(key, _)| SECTIONS.contains(key)) {
            let mut item = item.clone();
            place_anew(&mut item);
            device.insert(key, item);
        }
        Ok((device.to_string(), warnings))
    }
}

/// Forgets where tables stood in their own file, which would mix them with those of another one; a blank line
/// parts them.
fn place_anew(item: &mut Item) {
    let forget = |table: &mut Table| {
        table.set_position(None);
        let prefix = table.decor().prefix().and_then(RawString::as_str);
        if let Some(prefix) = prefix.filter(|prefix| !prefix.starts_with(['\n', '\r'])) {
            let prefix = format!("\n{prefix}");
            table.decor_mut().set_prefix(prefix);
        }
        table.iter_mut().for_each(|(_, item)| place_anew(item));
    };
    match item {
        Item::Table(table) => forget(table),
        Item::ArrayOfTables(tables) => tables.iter_mut().for_each(forget),
        Item::None | Item::Value(_) => {}
    }
}
