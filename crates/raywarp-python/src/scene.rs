//! A scene: meshes, where they stand, and the structure over them on a device.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use numpy::{PyReadonlyArray2, PyReadonlyArray3};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use raywarp::accel::Build;
use raywarp::device::{Device, DeviceChoice};
use raywarp::device_scene::{DeviceScene, Levels};
use raywarp::query::enqueue::Enqueuer;
use raywarp::query::{ClosestPoints, QueryError, RayCaster};
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
    /// Whether instances are to move.
    moving: bool,
    /// What is asked; none before the first commit.
    enqueuer: Option<Arc<Enqueuer>>,
    /// Where its instances are; none where other vertices were given since.
    placed: Option<Vec<Instance>>,
    /// For closest points; none until someone asks.
    points: Option<Arc<ClosestPoints>>,
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (device, build))]
    fn new(py: Python<'_>, device: &str, build: Option<&str>) -> PyResult<Self> {
        let choice: DeviceChoice = device.parse().map_err(value_error)?;
        let quality = build.map(str::parse).transpose().map_err(value_error)?;
        // By another thread: it makes the device's context current.
        let device = work::run(py, None, |_| Device::open(choice))?.map_err(|error| errors::of_device(&error))?;
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
        *self.state(py) = State { of_file: scene.instances.len(), scene, ..State::default() };
        Ok(loaded.warnings.iter().map(ToString::to_string).collect())
    }

    /// `cpu` or `cuda:N`.
    #[getter(device)]
    fn device_name(&self) -> String {
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
        state.placed = None;
        state.scene.meshes.get_mut(mesh).ok_or_else(|| no_mesh(mesh))?.positions = positions;
        Ok(())
    }

    /// Lets meshes stand where rows of 3 x 4 numbers put them, beside what the file holds and nothing else. Where they `move`, each mesh is
    /// kept once, in a space of its own.
    fn place(&self, py: Python<'_>, placements: Vec<(usize, PyReadonlyArray3<'_, f32>)>, moving: bool) -> PyResult<()> {
        let mut state = self.state(py);
        let of_file = state.of_file;
        state.scene.instances.truncate(of_file);
        state.moving = moving;
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

    /// Brings what is new or changed to the device.
    fn commit(&self, py: Python<'_>, threads: Option<usize>) -> PyResult<()> {
        let commit = || {
            let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            match state.move_instances() {
                true => Ok(()),
                false => state.build(self.quality, &self.device),
            }
        };
        work::run(py, threads, |_| commit())?.map_err(|error| errors::of_query(&error))
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        let state = std::mem::take(self.state.get_mut().unwrap_or_else(PoisonError::into_inner));
        // Freeing memory makes the device's context current. Of a device that fails nothing can be learned here.
        let _ = self.device.restoring_context(|| drop(state));
    }
}

impl State {
    /// Moves instances on the device. Returns whether that is all that changed, and could be done.
    fn move_instances(&mut self) -> bool {
        let (Some(enqueuer), Some(placed)) = (&mut self.enqueuer, &self.placed) else { return false };
        let now = &self.scene.instances;
        if now.len() != placed.len() || now.iter().zip(placed).any(|(now, placed)| now.mesh != placed.mesh) {
            return false;
        }
        let changed = now.iter().zip(placed).enumerate().filter(|(_, (now, placed))| now.transform != placed.transform);
        let moved: Vec<_> = changed.map(|(index, (now, _))| (index, &now.transform)).collect();
        // Where others ask meanwhile, or the device cannot, the scene is built anew: that tells what is wrong.
        let done = moved.is_empty()
            || Arc::get_mut(enqueuer).is_some_and(|enqueuer| enqueuer.set_transforms(&moved).unwrap_or(false));
        if done && !moved.is_empty() {
            (self.placed, self.points) = (Some(now.clone()), None);
        }
        done
    }

    /// Brings all of the scene to the device.
    fn build(&mut self, quality: Option<Quality>, device: &Device) -> Result<(), QueryError> {
        let wished = Build::wished(&self.scene.render, device, false);
        let what = Build { quality: quality.unwrap_or(wished.quality), ..wished };
        let levels = if self.moving { Levels::Two } else { Levels::Auto };
        // What was, is freed first, once no stream reads it.
        (self.enqueuer, self.points, self.placed) = (None, None, None);
        let scene = DeviceScene::geometry(&self.scene, levels, what, device)?;
        self.enqueuer = Some(Arc::new(Enqueuer::new(RayCaster::of_scene(Arc::new(scene)))?));
        self.placed = Some(self.scene.instances.clone());
        Ok(())
    }
}

impl Scene {
    /// What is to be asked.
    ///
    /// # Errors
    /// The package commits before it asks, so this tells of a mistake in it.
    pub fn enqueuer(&self, py: Python<'_>) -> PyResult<Arc<Enqueuer>> {
        let enqueuer = self.state(py).enqueuer.clone();
        enqueuer.ok_or_else(|| PyValueError::new_err("the scene was not committed"))
    }

    pub fn device(&self) -> &Device {
        &self.device
    }

    /// What finds closest points, built where nobody has asked yet.
    ///
    /// # Errors
    /// Those of building it.
    pub fn closest_points(&self, py: Python<'_>, threads: Option<usize>) -> PyResult<Arc<ClosestPoints>> {
        if let Some(points) = &self.state(py).points {
            return Ok(Arc::clone(points));
        }
        let build = || {
            let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            let quality = self.quality.unwrap_or(state.scene.render.tree.unwrap_or_default());
            let points = Arc::new(ClosestPoints::from_scene(&state.scene, quality, &self.device)?);
            state.points = Some(Arc::clone(&points));
            Ok(points)
        };
        work::run(py, threads, |_| build())?.map_err(|error| errors::of_query(&error))
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
