//! A ray tracer for CUDA that needs nothing but the driver, and runs on the CPU without one.
//!
//! The way of a picture: [`scene::load`] reads files into a [`Scene`], a [`DeviceScene`] builds a structure
//! ([`accel`]) over it and holds both on a [`Device`]. What a [`Tracer`] [renders](Tracer::render) of that goes to [`image`]; a
//! [`RayCaster`] answers rays. Whatever these take and give can be named from here; the folder `examples` shows how they are used.
//!
//! ```
//! use raywarp::accel::AccelKind;
//! use raywarp::device::DeviceChoice;
//! use raywarp::render::RenderOptions;
//! use raywarp::{Device, Tracer};
//!
//! let loaded = raywarp::scene::load::builtin()?;
//! let device = Device::open(DeviceChoice::Auto)?;
//! let tracer = Tracer::new(&loaded.scene, AccelKind::Bvh, &device)?;
//! let options = RenderOptions { size: [64, 36], ..RenderOptions::default() };
//! let rendering = tracer.render(tracer.default_camera(), &options, &mut |_| ())?;
//! assert_eq!(rendering.picture.pixels.len(), 64 * 36);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod accel;
pub mod device;
pub mod device_scene;
pub mod image;
pub mod query;
pub mod render;

pub use raywarp_scene as scene;
pub use raywarp_scene::write;

pub use device::Device;
pub use device_scene::DeviceScene;
pub use query::RayCaster;
pub use raywarp_core::math::Vec3;
pub use raywarp_core::ray::{Hit, Ray, MISS};
pub use raywarp_core::triangle::Triangle;
pub use render::Tracer;
pub use scene::Scene;
