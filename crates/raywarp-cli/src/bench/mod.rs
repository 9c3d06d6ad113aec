//! `raywarp bench`: how many rays a second, by kind of ray, structure and tree, beside other ray tracers.
//!
//! `suite` says which scenes, `contest` makes the rays of each and has every structure and every `peers` answer
//! them, `results` is what came of it and `table` how people read it. `frames` times whole pictures instead, `trees` the
//! building of trees, and `live` the viewer.

use crate::failure::Result;

mod contest;
mod exchange;
mod frames;
mod live;
mod machine;
mod options;
mod peers;
mod rays;
mod results;
mod spread;
mod structures;
mod suite;
mod table;
mod trees;

pub use machine::among;
pub use options::BenchOptions;
pub use spread::{quantile, Spread};
pub use structures::{Built, Own, Structures};
pub use suite::{subjects, Subject, SubjectOptions};

/// Measures what the options ask for.
pub fn run(options: &BenchOptions) -> Result<()> {
    run_with(options, &Own)
}

/// The same over these structures; the viewer has its own.
pub fn run_with(options: &BenchOptions, structures: &dyn Structures) -> Result<()> {
    options.layout.iter().try_for_each(|name| structures.is_hierarchy(name).map(drop))?;
    if options.frames {
        frames::run(options, structures)
    } else if options.trees {
        trees::run(options, structures)
    } else if options.live {
        live::run(options)
    } else {
        rays::run(options, structures)
    }
}
