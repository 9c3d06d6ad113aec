//! Arrays of CUDA libraries: where they lie, on the stream of whoever has them, without a wait.

mod array;
mod query;
mod rays;
mod stream;
mod tensor;

pub use array::DeviceArray;
pub use query::{enqueue_all, enqueue_any, enqueue_closest, enqueue_count, enqueue_nearest, fetch};
pub use rays::DeviceRays;
