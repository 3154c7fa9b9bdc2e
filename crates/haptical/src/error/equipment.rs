//! Names in a refusal the equipment that the device was read with: a URDF's base and tip, a rig file.

use std::path::Path;

use haptical_model::read_toml_text;
use haptical_urdf::{chain_ends, read_urdf_text};
use toml_edit::DocumentMut;

use super::Error;
use crate::device::{Device, Equipment, is_description, read_chain};

/// Most joints, and most links, that a sentence names.
const MOST_NAMES: usize = 8;

impl Error {
    /// Says what the equipment of `device` has to do with it: which chain of a URDF was taken and which would
    /// fit the log, or that a section is in the rig file.
    pub fn with_equipment(mut self, device: &Device) -> Self {
        let equipment = device.equipment();
        if let (Some(section), Some(rig)) = (&self.place.section, &equipment.rig)
            && has_section(&rig.path, section)
        {
            self.place.file = rig.path.display().to_string();
        }
        let path = &device.source().path;
        let columns = self.place.joint_columns.take();
        if let Some(columns) = columns.filter(|_| is_description(path)) {
            // the device was read from it just now; if it cannot be read again, the log's error remains
            let _ = self.name_chains(path, equipment, columns);
        }
        self
    }

    fn name_chains(&mut self, urdf: &Path, chain: &Equipment, columns: usize) -> Option<()> {
        let text = read_urdf_text(urdf).ok()?;
        let file = urdf.display().to_string();
        let taken = read_chain(&text, &file, urdf, chain).ok()?.tip;
        let from = chain.base.as_ref();
        let from = from.map_or(String::new(), |base| format!(" from `{base}`"));
        self.what += &match chain.tip {
            Some(_) => format!(": the chain{from} ends at `{taken}`, as --tip says"),
            None => format!(
                ": the chain ends at `{taken}`, as the longest one does, and no --tip names another"
            ),
        };
        let ends = chain_ends(&text, &file, chain.base.as_deref()).ok()?;
        let fits = ends.into_iter().filter(|end| end.joints == columns);
        let fits: Vec<String> = fits.map(|end| end.tip).collect();
        // a base has a tip already
        let add = match chain.base {
            Some(_) => "give",
            None => "add",
        };
        let joints = match columns {
            1 => "1 joint".to_owned(),
            _ => format!("{columns} joints"),
        };
        self.next = match fits.as_slice() {
            [] => format!(
                "add the columns, or name the link at which the chain ends with --tip; no chain{from} has \
                 {columns} joints, as the log has"
            ),
            [only] => format!(
                "the chain{from} to `{only}` has {joints}, as the log has: {add} --tip {only}"
            ),
            _ => format!(
                "the chains{from} to {} have {joints}, as the log has: {add} --tip with the one that was measured",
                listed(&fits)
            ),
        };
        Some(())
    }
}

fn has_section(rig: &Path, section: &str) -> bool {
    let text = read_toml_text(rig).unwrap_or_default();
    let document = text.parse::<DocumentMut>();
    document.is_ok_and(|document| document.contains_key(section))
}

/// Names in backticks, the first few of them.
pub(super) fn listed(names: &[String]) -> String {
    let first = names.iter().take(MOST_NAMES);
    let quoted: Vec<String> = first.map(|name| format!("`{name}`")).collect();
    match names.len() - quoted.len() {
        0 => quoted.join(", "),
        more => format!("{} and {more} more", quoted.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Source;
    use crate::{Identify, Log, identify};

    /// What is said where a device with this equipment is read and identified from a log.
    fn refused(files: &[(&str, &str)]) -> Error {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for (name, content) in files {
            std::fs::write(path(name), content).unwrap();
        }
        let (device, log) = (files[0].0, files[1].0);
        let rig = files.get(2).map(|(name, _)| Source::given(&path(name)));
        let equipment = Equipment {
            rig,
            ..Equipment::default()
        };
        let found = Device::open(&Source::given(&path(device)), &equipment).and_then(|device| {
            let log = Log::read(path(log), &device)?;
            identify(&device, &log, &Identify::default())
        });
        let mut said = found.unwrap_err();
        let own = format!("{}/", folder.path().display());
        for text in [&mut said.what, &mut said.place.file, &mut said.next] {
            *text = text.replace(&own, "");
        }
        said
    }

    const ARM: &str = r#"<robot name="arm"><link name="a"/><link name="b"/><link name="c"/>
        <joint name="turn" type="continuous"><parent link="a"/><child link="b"/></joint>
        <joint name="finger" type="continuous"><parent link="b"/><child link="c"/><origin xyz="0 1 0"/></joint>
        </robot>"#;

    #[test]
    fn a_pair_of_a_rig_file_is_refused_there() {
        let pair = "[[contact_pair]]\na = \"s0\"\nb = \"s9\"\ndistance_m = 0.2\nsd_m = 1e-4\n";
        let log = "theta1_rad,theta2_rad,contact\n0.1,0.2,s0\n0.3,0.1,s1\n0.2,-0.4,s0\n";
        let check = |device: &str, rig: &str| {
            refused(&[("arm.toml", device), ("log.csv", log), ("rig.toml", rig)])
        };
        let device = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\
            [[link]]\na_m = 0.4\nalpha_rad = 1.0\nd_m = 0.0\n[[link]]\na_m = 0.3\nalpha_rad = 0.0\n\
            d_m = 0.0\n[[joint]]\n[[joint]]\n";
        let said = check(device, pair);
        assert_eq!(
            said.what,
            "[[contact_pair]]: it names `s9`, which the log's column `contact` does not have (it has \
             `s0`, `s1`)"
        );
        assert_eq!(said.place.to_string(), "rig.toml");
        assert_eq!(said.next, "correct the name or remove the pair");
        // the device file's own pair is there
        let said = check(&format!("{device}{pair}"), "[contact]\nsd_m = 1e-4\n");
        assert_eq!(said.place.to_string(), "arm.toml");
    }

    #[test]
    fn a_plane_of_too_few_touches_is_refused_in_the_log() {
        let log = "theta1_rad,theta2_rad,plane\n0.1,0.2,p\n0.3,0.1,p\n0.2,-0.4,\n";
        let said = refused(&[("arm.urdf", ARM), ("log.csv", log)]);
        assert!(
            said.what
                .starts_with("column `plane`: the plane `p` is touched in 2 rows; three lie")
        );
        assert_eq!(said.place.to_string(), "log.csv");
        assert!(said.next.starts_with("record at least "), "{}", said.next);
    }

    #[test]
    fn a_log_of_another_chain_is_told_the_one_that_fits() {
        let log = "theta1_rad,x_m,y_m,z_m\n0.1,0.2,0.3,0.4\n";
        let said = refused(&[("arm.urdf", ARM), ("log.csv", log)]);
        assert_eq!(
            said.what,
            "missing `theta2_rad` (joint `finger`): the chain ends at `c`, as the longest one does, and no \
             --tip names another"
        );
        assert_eq!(said.place.to_string(), "log.csv:1, column `theta2_rad`");
        assert_eq!(
            said.next,
            "the chain to `b` has 1 joint, as the log has: add --tip b"
        );
    }
}
