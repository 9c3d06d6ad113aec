//! A scene: meshes, where they stand, and the structure over them on a device.

use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

use numpy::{PyReadonlyArray2, PyReadonlyArray3};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use raywarp::accel::Build;
use raywarp::device::{Device, DeviceChoice};
use raywarp::query::RayCaster;
use raywarp::scene::load::{self, LoadOptions};
use raywarp::scene::settings::Quality;
use raywarp::scene::{Instance, Material, Mesh, Transform};

use crate::errors;
use crate::work;

/// See `raywarp.Scene`, which is what people use.
#[pyclass(frozen, module = "raywarp._raywarp")]
pub struct Scene {
    device: Device,
    quality: Option<Quality>,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    scene: raywarp::Scene,
    /// Instances of the file that it was read from: the first ones.
    of_file: usize,
    /// None before the first commit.
    caster: Option<RayCaster>,
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (device, build))]
    fn new(device: &str, build: Option<&str>) -> PyResult<Self> {
        let choice: DeviceChoice = device.parse().map_err(value_error)?;
        let quality = build.map(str::parse).transpose().map_err(value_error)?;
        let device = Device::open(choice).map_err(|error| errors::of_device(&error))?;
        let scene = raywarp::Scene { materials: vec![Material::default()], ..raywarp::Scene::default() };
        Ok(Self { device, quality, state: Mutex::new(State { scene, ..State::default() }) })
    }

    /// Takes over what a file holds; returns the sentences of warnings.
    fn read(&self, py: Python<'_>, path: PathBuf) -> PyResult<Vec<String>> {
        let loaded = work::run(py, None, |_| load::load(&path, &LoadOptions::default()))?;
        let loaded = loaded.map_err(|error| errors::of_load(&error))?;
        let mut scene = loaded.scene;
        if scene.materials.is_empty() {
            scene.materials.push(Material::default());
        }
        *self.state(py) = State { of_file: scene.instances.len(), scene, caster: None };
        Ok(loaded.warnings.iter().map(ToString::to_string).collect())
    }

    /// `cpu` or `cuda:N`.
    #[getter]
    fn device(&self) -> String {
        self.device.cuda_index().map_or("cpu".to_owned(), |index| format!("cuda:{index}"))
    }

    /// The device in words.
    #[getter]
    fn description(&self) -> String {
        self.device.description()
    }

    /// Why there is a CPU where `auto` might have taken a GPU.
    #[getter]
    fn fallback(&self) -> Option<String> {
        self.device.fallback().map(ToString::to_string)
    }

    /// Names of what stands in the scene, those of `place` empty.
    #[getter]
    fn names(&self, py: Python<'_>) -> Vec<String> {
        self.state(py).scene.instances.iter().map(|instance| instance.name.clone()).collect()
    }

    /// How many instances the file placed.
    #[getter]
    fn of_file(&self, py: Python<'_>) -> usize {
        self.state(py).of_file
    }

    /// Adds a mesh, which stands nowhere yet; returns its number.
    fn add_mesh(
        &self,
        py: Python<'_>,
        vertices: PyReadonlyArray2<'_, f32>,
        faces: PyReadonlyArray2<'_, u32>,
    ) -> PyResult<usize> {
        let positions = bytemuck::cast_slice(vertices.as_slice()?).to_vec();
        let triangles: Vec<[u32; 3]> = bytemuck::cast_slice(faces.as_slice()?).to_vec();
        let materials = vec![0; triangles.len()];
        let mut state = self.state(py);
        state.scene.meshes.push(Mesh { positions, triangles, materials, ..Mesh::default() });
        Ok(state.scene.meshes.len() - 1)
    }

    /// Puts other positions in the place of a mesh's.
    fn move_vertices(&self, py: Python<'_>, mesh: usize, vertices: PyReadonlyArray2<'_, f32>) -> PyResult<()> {
        let positions = bytemuck::cast_slice(vertices.as_slice()?).to_vec();
        let mut state = self.state(py);
        state.scene.meshes.get_mut(mesh).ok_or_else(|| no_mesh(mesh))?.positions = positions;
        Ok(())
    }

    /// Lets meshes stand where rows of 3 x 4 numbers put them, beside what the file holds and nothing else.
    fn place(&self, py: Python<'_>, placements: Vec<(usize, PyReadonlyArray3<'_, f32>)>) -> PyResult<()> {
        let mut state = self.state(py);
        let of_file = state.of_file;
        state.scene.instances.truncate(of_file);
        for (mesh, transforms) in &placements {
            let instance = |rows: &[f32]| Instance {
                name: String::new(),
                mesh: *mesh,
                transform: transform(rows),
                material: None,
            };
            state.scene.instances.extend(transforms.as_slice()?.chunks_exact(12).map(instance));
        }
        Ok(())
    }

    /// Builds the structure; returns how many triangles can be hit, and how many cannot.
    fn commit(&self, py: Python<'_>, threads: Option<usize>) -> PyResult<(usize, usize)> {
        let build = || {
            let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            let wished = Build::wished(&state.scene.render, &self.device, false);
            let what = Build { quality: self.quality.unwrap_or(wished.quality), ..wished };
            let caster = RayCaster::from_scene(&state.scene, what, &self.device)?;
            let report = caster.report();
            let counts = (report.triangles, report.dropped.count());
            state.caster = Some(caster);
            Ok(counts)
        };
        work::run(py, threads, |_| build())?.map_err(|error| errors::of_query(&error))
    }
}

impl Scene {
    /// What is to be asked.
    ///
    /// # Errors
    /// The package commits before it asks, so this tells of a mistake in it.
    pub fn caster(&self, py: Python<'_>) -> PyResult<RayCaster> {
        let caster = self.state(py).caster.clone();
        caster.ok_or_else(|| PyValueError::new_err("the scene was not committed"))
    }

    /// Does something with the meshes and where they stand; not for a thread that keeps others from Python.
    pub fn with_geometry<T>(&self, work: impl FnOnce(&[Mesh], &[Instance]) -> T) -> T {
        let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        work(&state.scene.meshes, &state.scene.instances)
    }

    /// Locked without keeping others from Python meanwhile: whoever holds it may be waiting for Python.
    fn state(&self, py: Python<'_>) -> MutexGuard<'_, State> {
        self.state.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
    }
}

fn value_error(error: impl std::error::Error) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn no_mesh(mesh: usize) -> PyErr {
    PyIndexError::new_err(format!("there is no mesh {mesh}"))
}

/// Of the rows of a 3 x 4 matrix.
fn transform(rows: &[f32]) -> Transform {
    let column = |column: usize| [rows[column], rows[4 + column], rows[8 + column]];
    Transform { columns: [column(0), column(1), column(2)], translation: column(3) }
}
