//! The Python module `haptical._haptical`: devices and recordings in, NumPy arrays out.

mod candidates;
mod device;
mod diagnose;
mod failure;
mod identify;
mod kinematics;
mod log;
mod options;
mod plain;
mod plan;
mod plan_options;
mod replay;
mod residuals;
mod serialised;

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
    module.add_function(wrap_pyfunction!(identify::identify, module)?)?;
    module.add_function(wrap_pyfunction!(diagnose::diagnose, module)?)?;
    module.add_function(wrap_pyfunction!(plan::plan, module)?)?;
    module.add_function(wrap_pyfunction!(replay::replay, module)?)?;
    module.add_function(wrap_pyfunction!(kinematics::forward_kinematics, module)?)?;
    Ok(())
}
