//! A device that was identified with another log, whose numbers are fitted anew here.

use crate::device::Device;
use crate::files::provenance_of;
use crate::log::Log;

/// Said where a device is the result of another log: what moved since is in the numbers that are fitted to this one. Lengths and zeros are
/// fitted to positions alone.
pub(super) fn refitted(device: &Device, logs: &[&Log]) -> Option<String> {
    let mut recordings = logs.iter().map(|log| &log.recording);
    recordings.find(|own| haptical_calibration::channels(&device.model, own).is_ok())?;
    let source = device.source();
    let text = source.read_text().ok()?;
    let mut lines = provenance_of(&text);
    let command = lines.find_map(|line| line.strip_prefix("command line: haptical "))?;
    let mut fits = ["identify", "diagnose"].into_iter();
    fits.find(|own| command.starts_with(own))?;
    let mut of_logs = logs.iter().filter_map(|log| log.input("log"));
    let is_same = of_logs.any(|log| provenance_of(&text).any(|line| line.ends_with(&log.sha256)));
    (!is_same).then(|| {
        let file = source.label.as_str();
        format!(
            "{file} was identified with another log, and its lengths and zeros were fitted anew to this one: what moved since \
             is in them and no gap. `--model {file}` keeps them, and says what moved"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Source;
    use crate::{Diagnose, Equipment, Identify, diagnose, identify};
    use std::path::Path;

    /// The log that it was identified with is no other one, and a device that was never identified has nothing to keep.
    #[test]
    fn an_identified_device_with_another_log_is_said_to_be_fitted_anew() {
        let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures");
        let equipment = Equipment {
            rig: Some(Source::given(&fixtures.join("rigs/camera.toml"))),
            ..Equipment::default()
        };
        let folder = fixtures.join("measured/camera");
        let given = Device::open(&Source::given(&folder.join("panda.urdf")), &equipment).unwrap();
        let log = Log::read(folder.join("log.csv"), &given).unwrap();
        assert_eq!(refitted(&given, &[&log]), None);
        let found = identify(&given, &log, &Identify::default()).unwrap();
        let files = found.files().unwrap();
        let text = String::from_utf8(files[0].1.clone()).unwrap();
        let own = Source::text(text, "identified.toml");
        let own = Device::open(&own, &Equipment::default()).unwrap();
        assert_eq!(refitted(&own, &[&log]), None);
        let all: Vec<usize> = (1..log.recording.len()).collect();
        let other = log.recording.select(&all);
        let other = Log::from_recording(other, "other.csv", &own).unwrap();
        let said = diagnose(&own, &other, &Diagnose::default()).unwrap();
        let warned = said.diagnosis.warnings.iter();
        let warned = warned.filter(|own| own.contains("`--model identified.toml` keeps them"));
        assert_eq!(warned.count(), 1);
    }
}
