//! The part of the Python package `raywarp` that touches memory: a private module of it, whose public face is written in Python,
//! in `python/raywarp`.

mod closest_point;
mod cuda;
mod errors;
mod normals;
mod program;
mod query;
mod rays;
mod scene;
mod work;

use pyo3::prelude::*;

/// What the package's own modules use; nothing here is for others.
#[pymodule]
fn _raywarp(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("DeviceError", module.py().get_type::<errors::DeviceError>())?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<cuda::DeviceArray>()?;
    module.add_class::<cuda::DeviceRays>()?;
    module.add_function(wrap_pyfunction!(cuda::enqueue_closest, module)?)?;
    module.add_function(wrap_pyfunction!(cuda::enqueue_any, module)?)?;
    module.add_function(wrap_pyfunction!(cuda::enqueue_count, module)?)?;
    module.add_function(wrap_pyfunction!(cuda::enqueue_all, module)?)?;
    module.add_function(wrap_pyfunction!(cuda::enqueue_nearest, module)?)?;
    module.add_function(wrap_pyfunction!(closest_point::nearest, module)?)?;
    module.add_function(wrap_pyfunction!(closest_point::surface_points, module)?)?;
    module.add_function(wrap_pyfunction!(cuda::fetch, module)?)?;
    module.add_function(wrap_pyfunction!(query::closest, module)?)?;
    module.add_function(wrap_pyfunction!(query::any, module)?)?;
    module.add_function(wrap_pyfunction!(query::count, module)?)?;
    module.add_function(wrap_pyfunction!(query::all, module)?)?;
    module.add_function(wrap_pyfunction!(normals::normals, module)?)?;
    module.add_function(wrap_pyfunction!(program::run, module)?)
}
