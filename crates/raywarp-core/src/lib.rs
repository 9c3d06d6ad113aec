//! Everything that raywarp does per ray, written once.
//!
//! This crate is compiled twice: for the host as an ordinary crate, and for `nvptx64-nvidia-cuda` as PTX, through the
//! crate of entry points `raywarp-ptx`. What a test shows of it on the CPU holds on the GPU: both machines round every
//! operation alike (fused multiply-add only where [`arch::fma`] says so, transcendental functions only from
//! [`math`]), so both give the same bits.
//!
//! The modules in the order in which a ray meets them: [`camera`] and [`sample`] make it, [`traversal`] finds the
//! [`triangle`] it hits, [`surface`], [`material`] and [`texture`] say what is there, [`light`] and [`shade`] what it
//! sends back, [`film`] keeps the sum, which [`display`] and [`screen`] show. [`refit`] moves triangles
//! within a tree, [`build`] makes one. [`persistent`] answers batches whose rays go different ways. [`kernels`] lists what can be launched. What is only
//! measured is in `lab`.
#![cfg_attr(target_arch = "nvptx64", no_std)]
#![cfg_attr(target_arch = "nvptx64", feature(stdarch_nvptx, core_intrinsics, core_float_math, asm_experimental_arch))]
#![cfg_attr(target_arch = "nvptx64", allow(internal_features))]

pub mod arch;
pub mod background;
pub mod bsdf;
pub mod build;
pub mod camera;
pub mod closest_point;
pub mod display;
pub mod false_color;
pub mod film;
pub mod gather;
pub mod kernels;
pub mod light;
pub mod lights;
pub mod material;
pub mod math;
mod name;
pub mod packet;
pub mod persistent;
pub mod queue;
pub mod ray;
pub mod refit;
pub mod sample;
pub mod sampling;
pub mod screen;
pub mod shade;
pub mod stack;
pub mod surface;
pub mod texture;
pub mod traversal;
pub mod triangle;
pub mod view;
pub mod warp_counter;
pub mod wavefront;
