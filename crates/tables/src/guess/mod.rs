//! A mapping file proposed from what the files look like, with the reason for each line: a person reads and edits it.

mod groups;
mod layout;
mod letters;
mod limbs;
mod lists;
mod named_lists;
mod names;
mod one_value;
mod rivals;
pub(crate) mod units;
mod write;

use self::layout::Arrangement;
use self::names::Meaning;
use self::units::Scale;
use crate::table::Table;

/// A joint of the device: its name, and whether it slides.
pub type Joint = (String, bool);

/// What a column of a file is taken for.
#[derive(Debug, Clone, PartialEq)]
struct Proposal {
    /// File among those side by side, and column in it, from 0.
    file: usize,
    column: usize,
    meaning: Meaning,
    scale: Scale,
    why: String,
}

/// Proposes a mapping file for these files, in the order in which they will be given. `joints` are those of a device, in its order;
/// none where no device is given.
///
/// ```
/// use haptical_tables::{Mapping, Reading, guess, table_from_bytes};
///
/// let text = "time [ms];axis_1 [deg];axis_2 [deg];X [mm];Y [mm];Z [mm]\n0;10;20;300,5;0;100\n10;11;21;301;1;101\n";
/// let table = table_from_bytes(text.into(), "log.txt", &Reading::default())?;
/// let proposal = guess(&[table], &[]);
/// let mapping = Mapping::from_toml(&proposal, "columns.toml")?;
/// let names: Vec<&str> = mapping.column.iter().flat_map(|rule| rule.log.names()).map(String::as_str).collect();
/// assert_eq!(names, ["t_s", "theta1_rad", "theta2_rad", "x_m", "y_m", "z_m"]);
/// # Ok::<(), haptical_tables::TableError>(())
/// ```
pub fn guess(tables: &[Table], joints: &[Joint]) -> String {
    let arrangement = Arrangement::of(tables);
    let run = &tables[..arrangement.files_per_run.min(tables.len())];
    let mut found: Vec<Proposal> = Vec::new();
    let mut unknown = Vec::new();
    for (file, table) in run.iter().enumerate() {
        let meanings = names::of(table, run.len(), joints);
        for (column, (meaning, why)) in meanings.into_iter().enumerate() {
            let Some(meaning) = meaning else {
                unknown.push((file, column, why));
                continue;
            };
            found.push(Proposal {
                file,
                column,
                meaning,
                scale: Scale::default(),
                why,
            });
        }
    }
    unknown.append(&mut rivals::resolve(&mut found, run, joints));
    names::renumber(&mut found);
    names::slides(&mut found, joints);
    let mut dropped = names::incomplete(&mut found);
    unknown.append(&mut dropped);
    units::scales(&mut found, run);
    unknown.sort_unstable();
    write::toml(run, &arrangement, &found, &unknown)
}
