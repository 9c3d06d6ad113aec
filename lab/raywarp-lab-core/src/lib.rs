//! The kernels of raywarp's laboratory: what is measured and never the fastest, apart from what renders.
//!
//! [`structures`] has other layouts and other k-d trees than the product, [`sharing`] other ways to share out rays among
//! threads, and [`clocks`] says where a thread's time goes. All of it runs in the kernels of [`raywarp_core`], on both
//! machines and with the same bits; [`kernels`] lists what can be launched.
#![cfg_attr(target_arch = "nvptx64", no_std)]

pub mod clocks;
pub mod kernels;
pub mod sharing;
pub mod structures;

#[doc(hidden)]
pub use raywarp_core as product;
