//! Vertices: which property goes where, and in what unit.

use ply_rs_bw::ply::{PropertyType, ScalarType};

use super::header::Element;
use crate::srgb::srgb_to_linear_precise;

/// Values of one vertex before conversion, by slot.
pub(super) type Row = [f64; SLOTS];

const SLOTS: usize = 12;
const NORMAL: usize = 3;
const COLOR: usize = 6;
const ALPHA: usize = 9;
const UV: usize = 10;

/// Vertices in the layout of a mesh; a list is empty where the file lacks its properties.
pub(super) struct Vertices {
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub colors: Vec<[f32; 4]>,
    pub uvs: Vec<[f32; 2]>,
    has_normals: bool,
    has_colors: bool,
    has_uvs: bool,
    /// What stands for 1 in each colour channel; `None` for floating point, which is linear.
    color_scale: [Option<f64>; 4],
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
            has_normals: all(NORMAL, 3),
            has_colors: all(COLOR, 3),
            has_uvs: all(UV, 2),
            color_scale: std::array::from_fn(|channel| color_scale(element, &slots, COLOR + channel)),
        };
        Ok((vertices, slots))
    }

    /// What properties that the file lacks are taken to be.
    pub fn blank(&self) -> Row {
        let mut row = [0.0; SLOTS];
        row[ALPHA] = self.color_scale[3].unwrap_or(1.0);
        row
    }

    /// Adds a vertex. Values that do not fit into an `f32` become infinite.
    pub fn push(&mut self, row: &Row) {
        let narrow = |slot: usize| row[slot] as f32;
        self.positions.push([narrow(0), narrow(1), narrow(2)]);
        if self.has_normals {
            self.normals.push(std::array::from_fn(|axis| narrow(NORMAL + axis)));
        }
        if self.has_colors {
            self.colors.push(std::array::from_fn(|channel| self.color(channel, row[COLOR + channel])));
        }
        if self.has_uvs {
            self.uvs.push([narrow(UV), narrow(UV + 1)].map(|value| if value.is_finite() { value } else { 0.0 }));
        }
    }

    fn color(&self, channel: usize, value: f64) -> f32 {
        // `max` turns NaN into 0.
        let linear = match self.color_scale[channel] {
            None => value.max(0.0),
            Some(scale) if channel == 3 => (value / scale).max(0.0),
            Some(scale) => srgb_to_linear_precise((value / scale).clamp(0.0, 1.0)),
        };
        linear.min(if channel == 3 { 1.0 } else { f64::from(f32::MAX) }) as f32
    }
}

fn slot(name: &str) -> Option<usize> {
    Some(match name {
        "x" => 0,
        "y" => 1,
        "z" => 2,
        "nx" => NORMAL,
        "ny" => NORMAL + 1,
        "nz" => NORMAL + 2,
        "red" | "diffuse_red" => COLOR,
        "green" | "diffuse_green" => COLOR + 1,
        "blue" | "diffuse_blue" => COLOR + 2,
        "alpha" | "diffuse_alpha" => ALPHA,
        "s" | "u" | "texture_u" => UV,
        "t" | "v" | "texture_v" => UV + 1,
        _ => return None,
    })
}

fn color_scale(element: &Element, slots: &[Option<usize>], slot: usize) -> Option<f64> {
    let column = slots.iter().position(|&candidate| candidate == Some(slot))?;
    match &element.properties.get(column)?.kind {
        PropertyType::Scalar(ScalarType::Float | ScalarType::Double) | PropertyType::List(..) => None,
        PropertyType::Scalar(ScalarType::Char) => Some(f64::from(i8::MAX)),
        PropertyType::Scalar(ScalarType::Short) => Some(f64::from(i16::MAX)),
        PropertyType::Scalar(ScalarType::UShort) => Some(f64::from(u16::MAX)),
        // Colours declared as int or uint are 0 to 255 all the same.
        PropertyType::Scalar(_) => Some(255.0),
    }
}
