//! The Python module `haptical._haptical`: devices and recordings in, NumPy arrays out.

mod candidates;
mod command;
mod correct;
mod device;
mod diagnose;
mod doctor;
mod effects;
mod export;
mod failure;
mod files;
mod identify;
mod log;
mod options;
mod plain;
mod plan;
mod plan_options;
mod postures;
mod replay;
mod residuals;
mod serialised;
mod simulate;
mod watch;

use pyo3::prelude::*;

/// What `haptical/__init__.py` takes from here.
#[pymodule]
fn _haptical(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add(
        "HapticalError",
        module.py().get_type::<failure::HapticalError>(),
    )?;
    module.add_class::<device::Device>()?;
    module.add_function(wrap_pyfunction!(command::command, module)?)?;
    module.add_function(wrap_pyfunction!(identify::identify, module)?)?;
    module.add_function(wrap_pyfunction!(diagnose::diagnose, module)?)?;
    module.add_function(wrap_pyfunction!(doctor::doctor, module)?)?;
    module.add_function(wrap_pyfunction!(plan::plan, module)?)?;
    module.add_function(wrap_pyfunction!(replay::replay, module)?)?;
    module.add_function(wrap_pyfunction!(correct::correct, module)?)?;
    module.add_function(wrap_pyfunction!(effects::effects, module)?)?;
    module.add_function(wrap_pyfunction!(export::export, module)?)?;
    module.add_function(wrap_pyfunction!(simulate::simulate, module)?)?;
    module.add_function(wrap_pyfunction!(postures::forward_kinematics, module)?)?;
    module.add_function(wrap_pyfunction!(postures::joint_values, module)?)?;
    module.add_function(wrap_pyfunction!(postures::jacobian, module)?)?;
    module.add_function(wrap_pyfunction!(postures::torques, module)?)?;
    Ok(())
}
