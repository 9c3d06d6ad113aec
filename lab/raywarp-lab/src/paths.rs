//! Rays over several bounces: in one kernel, or a kernel a bounce with queues between them.

use raywarp_core::kernels::Kernel;
use raywarp_core::traversal;
use raywarp_device::kernels::{Timed, Views};
use raywarp_lab_core::sharing::paths::{Bounce, Paths, Trail, Waiting, Way};
use raywarp_lab_core::sharing::sort::{Begin, Move, Sum, Tell, BINS, CELLS, RUNS};

use raywarp::accel::bvh2::Bvh2;
use raywarp::device::{Buffer, Device, DeviceError};
use raywarp::{Ray, Triangle, Vec3};

/// How paths are followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// One thread a path, from its first ray to its last.
    OneKernel,
    /// A kernel a bounce, over those paths that go on.
    Wavefront,
    /// The same, with the rays of each bounce in an order in which neighbours go the same way.
    SortedWavefront,
}

/// What all surfaces are taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surfaces {
    /// They send rays on as mirrors do.
    Mirrors,
    /// They send rays on in random directions, cosine-weighted.
    Diffuse,
}

/// A tree with the first rays of paths on a device.
pub struct PathBatch {
    device: Device,
    nodes: Buffer<traversal::bvh2::Node>,
    leaves: Buffer<Triangle>,
    reach: Vec3,
    triangles: Buffer<Triangle>,
    rays: Buffer<Ray>,
    trails: Buffer<Trail>,
    queues: [Buffer<Waiting>; 2],
    counts: Buffer<u32>,
    bins: Buffer<u32>,
    sums: Buffer<u32>,
    begins: Buffer<u32>,
    places: Buffer<[u32; 2]>,
    bounds: [Vec3; 2],
    offset: f32,
    bounces: u32,
    surfaces: Surfaces,
}

/// Low and high corner of all triangles; both zero where there are none.
fn bounds(triangles: &[Triangle]) -> [Vec3; 2] {
    let corners = triangles.iter().flat_map(|triangle| [triangle.v0, triangle.v1, triangle.v2]);
    let join = |[low, high]: [Vec3; 2], [a, b]: [Vec3; 2]| [low.min(a), high.max(b)];
    corners.map(|corner| [corner; 2]).reduce(join).unwrap_or([Vec3::ZERO; 2])
}

/// Seconds of all kernels of a run, added up: what passes between them is no part of it. Each bounce is launched with as many
/// threads as there are paths, most of which may find nothing to do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathTime {
    /// Together.
    pub seconds: f64,
    /// Of those that sort.
    pub sorting: f64,
}

impl PathBatch {
    /// Of triangles that are numbered by their place, with a tree over them. At most `bounces` rays follow the first of a
    /// path, and start `offset` above a surface, in scene units.
    ///
    /// # Errors
    /// The device has no room.
    pub fn new(
        device: &Device,
        tree: &Bvh2,
        triangles: &[Triangle],
        rays: &[Ray],
        surfaces: Surfaces,
        bounces: u32,
        offset: f32,
    ) -> Result<Self, DeviceError> {
        let each = size_of::<Ray>() + size_of::<Trail>() + 2 * size_of::<Waiting>() + size_of::<[u32; 2]>();
        device.reserve((each * rays.len()) as u64, "the paths")?;
        Ok(Self {
            device: device.clone(),
            nodes: device.upload(tree.nodes())?,
            leaves: device.upload(tree.triangles())?,
            reach: tree.reach(),
            triangles: device.upload(triangles)?,
            rays: device.upload(rays)?,
            trails: device.zeroed(rays.len())?,
            queues: [device.zeroed(rays.len())?, device.zeroed(rays.len())?],
            counts: device.zeroed(bounces as usize + 2)?,
            bins: device.zeroed(BINS as usize)?,
            sums: device.zeroed(RUNS as usize)?,
            begins: device.zeroed(BINS as usize)?,
            places: device.zeroed(rays.len())?,
            bounds: bounds(triangles),
            offset,
            bounces,
            surfaces,
        })
    }

    /// Follows all paths.
    ///
    /// # Errors
    /// The device fails.
    pub fn follow(&mut self, scheme: Scheme) -> Result<PathTime, DeviceError> {
        // What a scheme does not write must not look as if it had.
        self.trails.clear()?;
        match scheme {
            Scheme::OneKernel => {
                let kernel = Paths { way: self.way(), rays: self.rays.view(), trails: self.trails.view_mut() };
                Ok(PathTime { seconds: self.launch(&kernel, self.rays.len())?, sorting: 0.0 })
            }
            Scheme::Wavefront => self.wavefront(false),
            Scheme::SortedWavefront => self.wavefront(true),
        }
    }

    /// Where each path ended when they were last followed.
    ///
    /// # Errors
    /// The device fails.
    pub fn trails(&self) -> Result<Vec<Trail>, DeviceError> {
        self.trails.to_vec()
    }

    fn way(&self) -> Way {
        let (nodes, triangles) = (self.nodes.view(), self.leaves.view());
        Way {
            tree: traversal::Bvh2 { nodes, triangles, reach: self.reach },
            triangles: self.triangles.view(),
            offset: self.offset,
            diffuse: u32::from(self.surfaces == Surfaces::Diffuse),
            bounces: self.bounces,
        }
    }

    fn wavefront(&mut self, sorted: bool) -> Result<PathTime, DeviceError> {
        let mut time = PathTime::default();
        self.counts.clear()?;
        for bounce in 0..=self.bounces {
            if bounce > 0 && sorted {
                let seconds = self.sort(bounce)?;
                time.sorting += seconds;
                time.seconds += seconds;
            }
            // What is read is in the first queue, what is written goes to the second, and then they change places.
            let way = self.way();
            let rays = self.rays.view();
            let [queue, next] = &mut self.queues;
            let (queue, next) = (queue.view(), next.view_mut());
            let (counts, trails) = (self.counts.view_mut(), self.trails.view_mut());
            let kernel = Bounce { way, bounce, rays, queue, next, counts, trails };
            time.seconds += self.launch(&kernel, self.rays.len())?;
            self.queues.swap(0, 1);
        }
        Ok(time)
    }

    fn sort(&mut self, bounce: u32) -> Result<f64, DeviceError> {
        let [low, high] = self.bounds;
        let cells = |i: u32| CELLS as f32 / (high[i] - low[i]).max(f32::MIN_POSITIVE);
        let scale = Vec3::new(cells(0), cells(1), cells(2));
        let [queue, other] = &mut self.queues;
        let (queue, sorted) = (queue.view(), other.view_mut());
        let tell = Tell {
            queue,
            counts: self.counts.view(),
            bounce,
            low,
            scale,
            bins: self.bins.view_mut(),
            places: self.places.view_mut(),
        };
        let sum = Sum { bins: self.bins.view(), sums: self.sums.view_mut() };
        let begin = Begin { bins: self.bins.view(), sums: self.sums.view(), begins: self.begins.view_mut() };
        let (places, begins, bins) = (self.places.view(), self.begins.view(), self.bins.view_mut());
        let arrange = Move { queue, counts: self.counts.view(), bounce, places, begins, bins, sorted };
        let threads = self.rays.len();
        let seconds = self.launch(&tell, threads)?
            + self.launch(&sum, RUNS)?
            + self.launch(&begin, BINS)?
            + self.launch(&arrange, threads.max(BINS))?;
        self.queues.swap(0, 1);
        Ok(seconds)
    }

    fn launch<K: Kernel>(&self, kernel: &K, threads: u32) -> Result<f64, DeviceError> {
        // SAFETY: all buffers are the batch's own, of its device, and one launch ends before the next begins. Hits are
        // numbers of `triangles`; counts are below the number of rays, and so are places.
        unsafe { Timed::launch(&self.device, kernel, [threads, 1]) }?.wait()
    }
}
