//! Triangles into meshes: one for each object or group name, its vertices unified, its normals completed.

use std::collections::HashMap;

use super::corner::Corner;
use super::points::Points;
use crate::load::hash::FoldState;
use crate::normals::NormalSums;
use crate::Mesh;

/// Some programs name every face: names beyond these share the last mesh.
const MAX_MESHES: usize = 65_536;

/// Of a triangle and its material, and of a vertex with all that it may have and its entry in the table.
const TRIANGLE_BYTES: usize = 16;
const VERTEX_BYTES: usize = 12 + 12 + 8 + 16 + 24;

/// The meshes of a file under construction.
pub(super) struct Meshes<'a> {
    /// The file's points.
    pub points: &'a Points,
    /// Names that found no mesh of their own.
    pub merged: usize,
    fallback_name: &'a str,
    object: String,
    group: String,
    builders: Vec<Builder>,
    by_name: HashMap<String, usize>,
    /// The mesh of the names above, once they have a triangle.
    current: Option<usize>,
    /// Vertices of the current mesh. One that is taken up again starts anew: at worst, it holds a vertex twice.
    vertices: HashMap<Vertex, u32, FoldState>,
    /// What shares a smooth normal, in all meshes: position and smoothing group.
    classes: HashMap<Class, u32, FoldState>,
    /// Triangles and vertices.
    counts: [usize; 2],
}

#[derive(Default)]
struct Builder {
    mesh: Mesh,
    /// Smoothing class of each vertex; empty or short where those beyond have none.
    classes: Vec<u32>,
}

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Vertex {
    /// Position and texture coordinate.
    point: u64,
    normal: u64,
}

#[derive(PartialEq, Eq, Hash)]
struct Class(u64);

/// Where a vertex has its normal from.
#[derive(Clone, Copy)]
enum Normal {
    Given(u32),
    Smooth(u32),
    Flat,
}

impl<'a> Meshes<'a> {
    /// No triangle yet. The fallback names what comes before any name.
    pub fn new(points: &'a Points, fallback_name: &'a str) -> Self {
        Self {
            points,
            merged: 0,
            fallback_name,
            object: String::new(),
            group: String::new(),
            builders: Vec::new(),
            by_name: HashMap::new(),
            current: None,
            vertices: HashMap::default(),
            classes: HashMap::default(),
            counts: [0; 2],
        }
    }

    /// About what triangles and vertices take so far, and what finds vertices again.
    #[inline]
    pub fn bytes(&self) -> usize {
        let [triangles, vertices] = self.counts;
        triangles * TRIANGLE_BYTES + vertices * VERTEX_BYTES
    }

    /// An object begins; it has no group yet.
    pub fn start_object(&mut self, name: String) {
        self.object = name;
        self.start_group(String::new());
    }

    /// A group begins.
    pub fn start_group(&mut self, name: String) {
        self.group = name;
        self.current = None;
    }

    /// Adds a triangle. `smoothing` is its group, 0 for none: what its corners without a normal do.
    #[inline]
    pub fn add(&mut self, corners: [Corner; 3], smoothing: u32, material: u32) {
        let current = match self.current {
            Some(current) => current,
            None => self.open(),
        };
        let triangle = corners.map(|corner| self.vertex(current, corner, smoothing));
        let mesh = &mut self.builders[current].mesh;
        mesh.triangles.push(triangle);
        mesh.materials.push(material);
        self.counts[0] += 1;
    }

    /// The mesh of the present names.
    fn open(&mut self) -> usize {
        let name = match (self.object.as_str(), self.group.as_str()) {
            ("", "") => self.fallback_name.to_owned(),
            (object, "") => object.to_owned(),
            ("", group) => group.to_owned(),
            (object, group) if object == group => object.to_owned(),
            (object, group) => format!("{object}/{group}"),
        };
        let current = self.find_or_create(name);
        self.current = Some(current);
        // Not cleared: that would cost the size of the largest mesh for each of the small ones.
        self.vertices = HashMap::default();
        current
    }

    fn find_or_create(&mut self, name: String) -> usize {
        if let Some(&index) = self.by_name.get(&name) {
            return index;
        }
        if self.builders.len() == MAX_MESHES {
            self.merged += 1;
            return MAX_MESHES - 1;
        }
        let mesh = Mesh { name: name.clone(), ..Mesh::default() };
        self.builders.push(Builder { mesh, classes: Vec::new() });
        self.by_name.insert(name, self.builders.len() - 1);
        self.builders.len() - 1
    }

    #[inline]
    fn vertex(&mut self, current: usize, corner: Corner, smoothing: u32) -> u32 {
        let normal = match (corner.normal, smoothing) {
            (Some(normal), _) => Normal::Given(normal),
            (None, 0) => Normal::Flat,
            (None, group) => Normal::Smooth(self.class(corner.position, group)),
        };
        let (points, builder, vertices) = (self.points, &mut self.builders[current], &mut self.counts[1]);
        *self.vertices.entry(Vertex::new(corner, normal)).or_insert_with(|| {
            *vertices += 1;
            builder.push(points, corner, normal)
        })
    }

    fn class(&mut self, position: u32, group: u32) -> u32 {
        let next = self.classes.len() as u32;
        *self.classes.entry(Class(u64::from(position) | (u64::from(group) << 32))).or_insert(next)
    }

    /// The meshes, in the order of their first triangles.
    pub fn finish(mut self) -> Vec<Mesh> {
        drop(std::mem::take(&mut self.vertices));
        if !self.classes.is_empty() {
            self.smooth();
        }
        self.builders.into_iter().map(|builder| builder.mesh).collect()
    }

    /// Smoothing groups reach over objects and groups: the sums are the file's, not a mesh's.
    fn smooth(&mut self) {
        let mut sums = NormalSums::new(self.classes.len());
        for builder in self.builders.iter().filter(|builder| !builder.classes.is_empty()) {
            let class = |vertex: u32| builder.classes.get(vertex as usize).copied().unwrap_or(NormalSums::NONE);
            for &triangle in &builder.mesh.triangles {
                sums.add(triangle.map(|vertex| builder.mesh.positions[vertex as usize]), triangle.map(class));
            }
        }
        let normals = sums.normals();
        for builder in &mut self.builders {
            builder.take_normals(&normals);
        }
    }
}

impl Vertex {
    fn new(corner: Corner, normal: Normal) -> Self {
        let uv = corner.uv.map_or(0, |uv| u64::from(uv) + 1);
        let normal = match normal {
            Normal::Given(normal) => u64::from(normal),
            Normal::Smooth(class) => u64::from(class) | (1 << 32),
            Normal::Flat => u64::MAX,
        };
        Self { point: u64::from(corner.position) | (uv << 32), normal }
    }
}

impl Builder {
    /// Adds a vertex. Attributes that no vertex had before are filled up for the earlier ones.
    fn push(&mut self, points: &Points, corner: Corner, normal: Normal) -> u32 {
        let mesh = &mut self.mesh;
        let index = mesh.positions.len();
        mesh.positions.push(points.positions[corner.position as usize]);
        let uv = corner.uv.map(|uv| points.uvs[uv as usize]);
        push_optional(&mut mesh.uvs, index, uv, [0.0; 2]);
        let given = match normal {
            Normal::Given(normal) => Some(points.normals[normal as usize]),
            Normal::Smooth(_) | Normal::Flat => None,
        };
        push_optional(&mut mesh.normals, index, given, [0.0; 3]);
        if !points.colors.is_empty() {
            mesh.colors.push(points.colors.get(corner.position as usize).copied().unwrap_or([1.0; 4]));
        }
        if let Normal::Smooth(class) = normal {
            push_optional(&mut self.classes, index, Some(class), NormalSums::NONE);
        }
        index as u32
    }

    fn take_normals(&mut self, normals: &[[f32; 3]]) {
        if self.classes.is_empty() {
            return;
        }
        self.mesh.normals.resize(self.mesh.positions.len(), [0.0; 3]);
        for (normal, &class) in self.mesh.normals.iter_mut().zip(&self.classes) {
            if class != NormalSums::NONE {
                *normal = normals[class as usize];
            }
        }
    }
}

/// Appends the value of vertex `index` to a list that stays empty as long as no vertex has one.
#[inline]
fn push_optional<T: Copy>(list: &mut Vec<T>, index: usize, value: Option<T>, without: T) {
    if value.is_some() || !list.is_empty() {
        list.resize(index, without);
        list.push(value.unwrap_or(without));
    }
}
