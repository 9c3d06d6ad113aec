//! The body, table by table in the header's order.

use std::path::Path;

use ply_rs_bw::ply::{Encoding, PropertyType, ScalarType};

use super::super::{LoadError, Place};
use super::color::{self, ColorFormat};
use super::faces::{Attributes, Corners, Faces};
use super::header::{Element, Header};
use super::values::{Bytes, Fault, Surplus, Text, Values};
use super::vertices::Vertices;
use crate::memory::{Budget, Growth};

/// Reads the body that a header describes.
pub(super) struct Reader<'a> {
    pub path: &'a Path,
    pub header: &'a Header,
    pub bytes: &'a [u8],
    pub budget: &'a Budget,
}

/// Of a vertex with all that it may have; of a triangle with its material, and with what its face may say.
const VERTEX_BYTES: u64 = 12 + 12 + 16 + 8;
const TRIANGLE_BYTES: usize = 12 + 4;
const FACE_BYTES: usize = TRIANGLE_BYTES + 28 + 16 + 4;

/// What the tables hold.
pub(super) struct Body {
    /// `None` where there is no vertex.
    pub vertices: Option<Vertices>,
    pub faces: Faces,
    /// Colours that are cut off at 1.
    pub bright_colors: usize,
    pub surplus: Surplus,
}

/// What a property of a face is for.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    Corners,
    /// u and v of each corner, as MeshLab writes them.
    Uvs,
    /// Which of the pictures.
    Texture,
    Color(usize),
    Other,
}

impl Role {
    fn of(name: &str, kind: &PropertyType) -> Self {
        match (name, kind) {
            (name, PropertyType::List(..)) if is_vertex_list(name) => Self::Corners,
            ("texcoord", PropertyType::List(..)) => Self::Uvs,
            ("texnumber", PropertyType::Scalar(_)) => Self::Texture,
            (name, PropertyType::Scalar(_)) => color::channel(name).map_or(Self::Other, Self::Color),
            _ => Self::Other,
        }
    }
}

/// Whether a property of this name connects vertices.
pub(super) fn is_vertex_list(name: &str) -> bool {
    matches!(name, "vertex_indices" | "vertex_index")
}

impl Reader<'_> {
    /// The vertices and what connects them.
    pub fn read(&self) -> Result<Body, LoadError> {
        let body = self.header.body;
        match self.header.encoding {
            Encoding::Ascii => self.read_from(&mut Text::new(&self.bytes[body..], self.header.body_line)),
            Encoding::BinaryBigEndian => self.read_from(&mut Bytes::<true>::new(self.bytes, body)),
            Encoding::BinaryLittleEndian => self.read_from(&mut Bytes::<false>::new(self.bytes, body)),
        }
    }

    fn read_from(&self, values: &mut impl Values) -> Result<Body, LoadError> {
        let mut vertices: Option<Vertices> = None;
        let mut faces = Faces::new(self.header.count("vertex"), self.bytes.len());
        let mut bright_colors = 0;
        // Rows without properties take no room, so there is nothing to read.
        let is_there = |element: &&Element| !element.properties.is_empty() && element.count > 0;
        for element in self.header.elements.iter().filter(is_there) {
            match element.name.as_str() {
                "vertex" => {
                    let read = vertices.insert(self.vertices(element, values)?);
                    bright_colors += read.finish_colors();
                }
                "face" => {
                    let positions = vertices.as_ref().map_or(&[][..], |vertices| &vertices.positions);
                    self.faces(element, values, positions, &mut faces)?;
                    bright_colors += ColorFormat::of(element).map_or(0, |format| format.finish(&mut faces.colors));
                }
                "tristrips" => self.corners(element, values, |corners| faces.add_strips(corners))?,
                _ => self.skip(element, values)?,
            }
        }
        Ok(Body { vertices, faces, bright_colors, surplus: values.surplus() })
    }

    fn vertices(&self, element: &Element, values: &mut impl Values) -> Result<Vertices, LoadError> {
        let bytes = VERTEX_BYTES * element.count as u64;
        self.budget.take(bytes).map_err(LoadError::memory(self.path, "its vertices"))?;
        let (mut vertices, slots) = Vertices::new(element).map_err(|axis| {
            let read = format!("element 'vertex' has no property '{axis}'");
            self.broken(Place::File, read, "scalar properties x, y and z")
        })?;
        for row in 0..element.count {
            let mut vertex = vertices.blank();
            values.start_row().map_err(|fault| self.fault(element, row, fault))?;
            for (property, slot) in element.properties.iter().zip(&slots) {
                match (&property.kind, slot) {
                    (PropertyType::Scalar(kind), Some(slot)) => values.next(kind).map(|value| vertex[*slot] = value),
                    (kind, _) => skip_property(kind, values),
                }
                .map_err(|fault| self.fault(element, row, fault))?;
            }
            values.end_row();
            vertices.push(&vertex);
        }
        Ok(vertices)
    }

    /// Adds the polygon of each row.
    fn faces(
        &self,
        element: &Element,
        values: &mut impl Values,
        positions: &[[f32; 3]],
        faces: &mut Faces,
    ) -> Result<(), LoadError> {
        self.vertex_list(element)?;
        let mut roles: Vec<Role> =
            element.properties.iter().map(|property| Role::of(&property.name, &property.kind)).collect();
        keep_first(&mut roles, Role::Corners);
        let has = |role: Role| roles.contains(&role);
        let format = ColorFormat::of(element);
        let mut attributes = Attributes { uvs: has(Role::Uvs).then(Vec::new), ..Attributes::default() };
        let (mut corners, mut growth) = (Vec::new(), Growth::new(self.budget));
        let triangle = if attributes.uvs.is_some() || format.is_some() { FACE_BYTES } else { TRIANGLE_BYTES };
        for row in 0..element.count {
            let fault = |fault| self.fault(element, row, fault);
            values.start_row().map_err(fault)?;
            let (mut color, mut place) = ([0.0, 0.0, 0.0, format.map_or(1.0, ColorFormat::full_alpha)], Place::File);
            for (property, role) in element.properties.iter().zip(&roles) {
                match (role, &property.kind) {
                    (Role::Corners, PropertyType::List(count_kind, kind)) => {
                        place = values.place();
                        read_list(count_kind, kind, values, &mut corners)
                    }
                    (Role::Uvs, PropertyType::List(count_kind, kind)) => {
                        read_list(count_kind, kind, values, attributes.uvs.get_or_insert_default())
                    }
                    (Role::Texture, PropertyType::Scalar(kind)) => {
                        values.next(kind).map(|number| attributes.texture = Some(number))
                    }
                    (Role::Color(channel), PropertyType::Scalar(kind)) => {
                        values.next(kind).map(|value| color[*channel] = value)
                    }
                    (_, kind) => skip_property(kind, values),
                }
                .map_err(fault)?;
            }
            values.end_row();
            attributes.color = format.map(|format| format.color(color));
            let triangles = faces.triangles.len() + corners.len();
            growth.reach(triangles, triangle).map_err(LoadError::memory(self.path, "its faces"))?;
            faces.add_polygon(&corners, &attributes, positions).map_err(|wrong| fault(wrong.at(place)))?;
        }
        Ok(())
    }

    /// Hands the vertex list of each row to `add`, which says what is wrong with it.
    fn corners(
        &self,
        element: &Element,
        values: &mut impl Values,
        mut add: impl FnMut(&[f64]) -> Result<(), Corners>,
    ) -> Result<(), LoadError> {
        let (column, count_kind, index_kind) = self.vertex_list(element)?;
        let (mut list, mut growth, mut triangles) = (Vec::new(), Growth::new(self.budget), 0);
        for row in 0..element.count {
            let fault = |fault| self.fault(element, row, fault);
            values.start_row().map_err(fault)?;
            for property in &element.properties[..column] {
                skip_property(&property.kind, values).map_err(fault)?;
            }
            let place = values.place();
            read_list(count_kind, index_kind, values, &mut list).map_err(fault)?;
            triangles += list.len();
            growth.reach(triangles, TRIANGLE_BYTES).map_err(LoadError::memory(self.path, "its strips"))?;
            add(&list).map_err(|wrong| fault(wrong.at(place)))?;
            for property in &element.properties[column + 1..] {
                skip_property(&property.kind, values).map_err(fault)?;
            }
            values.end_row();
        }
        Ok(())
    }

    /// The column of the list that connects vertices, and its types.
    fn vertex_list<'e>(&self, element: &'e Element) -> Result<(usize, &'e ScalarType, &'e ScalarType), LoadError> {
        let is_list = |(column, property): (usize, &'e super::header::Property)| match &property.kind {
            PropertyType::List(count, index) if is_vertex_list(&property.name) => Some((column, count, index)),
            _ => None,
        };
        element.properties.iter().enumerate().find_map(is_list).ok_or_else(|| {
            let read = format!("element '{}' has no vertex list", element.name);
            self.broken(Place::File, read, "a list property 'vertex_indices' or 'vertex_index'")
        })
    }

    fn skip(&self, element: &Element, values: &mut impl Values) -> Result<(), LoadError> {
        for row in 0..element.count {
            let fault = |fault| self.fault(element, row, fault);
            values.start_row().map_err(fault)?;
            for property in &element.properties {
                skip_property(&property.kind, values).map_err(fault)?;
            }
            values.end_row();
        }
        Ok(())
    }

    #[cold]
    fn fault(&self, element: &Element, row: usize, fault: Fault) -> LoadError {
        let read = format!("{} {row} of {}: {}", element.name, element.count, fault.read);
        self.broken(fault.place, read, &fault.expected)
    }

    fn broken(&self, place: Place, read: String, expected: &str) -> LoadError {
        LoadError::Syntax {
            path: self.path.to_owned(),
            place,
            read,
            expected: expected.to_owned(),
            help: "Write the file again, or correct it there.".to_owned(),
        }
    }
}

/// Leaves a role to the first property that has it: a file may have both names of a list.
fn keep_first(roles: &mut [Role], role: Role) {
    for other in roles.iter_mut().filter(|other| **other == role).skip(1) {
        *other = Role::Other;
    }
}

/// Passes over a value or a list.
fn skip_property(kind: &PropertyType, values: &mut impl Values) -> Result<(), Fault> {
    match kind {
        PropertyType::Scalar(kind) => values.next(kind).map(drop),
        PropertyType::List(count_kind, kind) => {
            for _ in 0..list_length(count_kind, kind, values)? {
                values.next(kind)?;
            }
            Ok(())
        }
    }
}

fn read_list(
    count_kind: &ScalarType,
    kind: &ScalarType,
    values: &mut impl Values,
    list: &mut Vec<f64>,
) -> Result<(), Fault> {
    list.clear();
    for _ in 0..list_length(count_kind, kind, values)? {
        list.push(values.next(kind)?);
    }
    Ok(())
}

/// The number at the head of a list, no more than what can follow it.
fn list_length(count_kind: &ScalarType, kind: &ScalarType, values: &mut impl Values) -> Result<usize, Fault> {
    let place = values.place();
    let length = values.next(count_kind)?;
    let room = values.room_for(kind);
    // Not so for NaN either.
    if length >= 0.0 && length <= room as f64 && length.fract() == 0.0 {
        return Ok(length as usize);
    }
    let expected = format!("a whole number, at most the {room} values that can follow");
    Err(Fault { place, read: format!("a list of {length} values"), expected })
}
