//! Names of the effects on torques and forces.

use haptical_effects::{Need, spec};

/// Every one, once, but for those that motors' currents show.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    let is_on_drives = |name: &&str| {
        spec(name).is_some_and(|own| own.hook.is_on_drives() && !own.needs.contains(&Need::Current))
    };
    haptical_effects::names().into_iter().filter(is_on_drives)
}
