//! Vertices: which property goes where, and in what unit.

use ply_rs_bw::ply::PropertyType;

use super::color::{self, ColorFormat};
use super::header::Element;
use crate::load::precision::Rounding;

/// Values of one vertex before conversion, by slot.
pub(super) type Row = [f64; SLOTS];

const SLOTS: usize = 12;
const NORMAL: usize = 3;
const COLOR: usize = 6;
const ALPHA: usize = COLOR + 3;
const UV: usize = 10;

/// Vertices in the layout of a mesh; a list is empty where the file lacks its properties.
pub(super) struct Vertices {
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub colors: Vec<[f32; 4]>,
    pub uvs: Vec<[f32; 2]>,
    pub rounding: Rounding,
    has_normals: bool,
    has_uvs: bool,
    color_format: Option<ColorFormat>,
}

impl Vertices {
    /// No vertices yet, and the slot of each property of the element. Fails with the name of a missing axis.
    pub fn new(element: &Element) -> Result<(Self, Vec<Option<usize>>), &'static str> {
        let slots: Vec<Option<usize>> = element
            .properties
            .iter()
            .map(|property| matches!(property.kind, PropertyType::Scalar(_)).then(|| slot(&property.name)).flatten())
            .collect();
        let has = |slot: usize| slots.contains(&Some(slot));
        let all = |first: usize, count: usize| (first..first + count).all(has);
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            if !has(axis) {
                return Err(name);
            }
        }
        let vertices = Self {
            positions: Vec::with_capacity(element.count),
            normals: Vec::new(),
            colors: Vec::new(),
            uvs: Vec::new(),
            rounding: Rounding::default(),
            has_normals: all(NORMAL, 3),
            has_uvs: all(UV, 2),
            color_format: ColorFormat::of(element),
        };
        Ok((vertices, slots))
    }

    /// What properties that the file lacks are taken to be.
    pub fn blank(&self) -> Row {
        let mut row = [0.0; SLOTS];
        row[ALPHA] = self.color_format.map_or(1.0, ColorFormat::full_alpha);
        row
    }

    /// Adds a vertex. Values that do not fit into an `f32` become infinite.
    pub fn push(&mut self, row: &Row) {
        let narrow = |slot: usize| row[slot] as f32;
        self.positions.push([row[0], row[1], row[2]].map(|x| self.rounding.round(x)));
        if self.has_normals {
            self.normals.push(std::array::from_fn(|axis| narrow(NORMAL + axis)));
        }
        if let Some(format) = self.color_format {
            self.colors.push(format.color(std::array::from_fn(|channel| row[COLOR + channel])));
        }
        if self.has_uvs {
            self.uvs.push([narrow(UV), narrow(UV + 1)].map(|value| if value.is_finite() { value } else { 0.0 }));
        }
    }

    /// To be called once behind the last vertex; returns how many colours are cut off at 1.
    pub fn finish_colors(&mut self) -> usize {
        self.color_format.map_or(0, |format| format.finish(&mut self.colors))
    }
}

/// Whether a property of a vertex is read.
pub(super) fn is_read(name: &str) -> bool {
    slot(name).is_some()
}

fn slot(name: &str) -> Option<usize> {
    Some(match name {
        "x" => 0,
        "y" => 1,
        "z" => 2,
        "nx" => NORMAL,
        "ny" => NORMAL + 1,
        "nz" => NORMAL + 2,
        "s" | "u" | "texture_u" => UV,
        "t" | "v" | "texture_v" => UV + 1,
        name => COLOR + color::channel(name)?,
    })
}
