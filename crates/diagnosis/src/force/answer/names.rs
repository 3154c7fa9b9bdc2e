//! Names of the effects on torques and forces.

use haptical_effects::spec;

/// Every one, once.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    let is_on_drives = |name: &&str| spec(name).is_some_and(|spec| spec.hook.is_on_drives());
    haptical_effects::names().into_iter().filter(is_on_drives)
}
