//! The body, table by table in the header's order.

use std::path::Path;

use ply_rs_bw::ply::{Encoding, PropertyType, ScalarType};

use super::super::{LoadError, Place};
use super::faces::{Corners, Faces};
use super::header::{Element, Header};
use super::values::{Bytes, Fault, Text, Values};
use super::vertices::Vertices;

/// Reads the body that a header describes.
pub(super) struct Reader<'a> {
    pub path: &'a Path,
    pub header: &'a Header,
    pub bytes: &'a [u8],
}

impl Reader<'_> {
    /// The vertices and what connects them.
    pub fn read(&self) -> Result<(Vertices, Faces), LoadError> {
        let body = self.header.body;
        match self.header.encoding {
            Encoding::Ascii => self.read_from(&mut Text::new(&self.bytes[body..], self.header.body_line)),
            Encoding::BinaryBigEndian => self.read_from(&mut Bytes::<true>::new(self.bytes, body)),
            Encoding::BinaryLittleEndian => self.read_from(&mut Bytes::<false>::new(self.bytes, body)),
        }
    }

    fn read_from(&self, values: &mut impl Values) -> Result<(Vertices, Faces), LoadError> {
        let mut vertices: Option<Vertices> = None;
        let mut faces = Faces::new(self.header.count("vertex"), self.bytes.len());
        // Rows without properties take no room, so there is nothing to read.
        for element in self.header.elements.iter().filter(|element| !element.properties.is_empty()) {
            match element.name.as_str() {
                "vertex" => vertices = Some(self.vertices(element, values)?),
                "face" => {
                    let positions = vertices.as_ref().map_or(&[][..], |vertices| &vertices.positions);
                    self.corners(element, values, |corners| faces.add_polygon(corners, positions))?;
                }
                "tristrips" => self.corners(element, values, |corners| faces.add_strips(corners))?,
                _ => self.skip(element, values)?,
            }
        }
        let vertices = vertices.ok_or_else(|| {
            self.broken(Place::File, "the header has no vertices".to_owned(), "an 'element vertex' with properties")
        })?;
        Ok((vertices, faces))
    }

    fn vertices(&self, element: &Element, values: &mut impl Values) -> Result<Vertices, LoadError> {
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
            values.end_row().map_err(|fault| self.fault(element, row, fault))?;
            vertices.push(&vertex);
        }
        Ok(vertices)
    }

    /// Hands the vertex list of each row to `add`, which says what is wrong with it.
    fn corners(
        &self,
        element: &Element,
        values: &mut impl Values,
        mut add: impl FnMut(&[f64]) -> Result<(), Corners>,
    ) -> Result<(), LoadError> {
        let is_list = |name: &str| matches!(name, "vertex_indices" | "vertex_index");
        let column = element.properties.iter().position(|property| is_list(&property.name)).unwrap_or(usize::MAX);
        let Some(PropertyType::List(count_kind, index_kind)) = element.properties.get(column).map(|p| &p.kind) else {
            let read = format!("element '{}' has no vertex list", element.name);
            return Err(self.broken(Place::File, read, "a list property 'vertex_indices' or 'vertex_index'"));
        };
        let mut list = Vec::new();
        for row in 0..element.count {
            let fault = |fault| self.fault(element, row, fault);
            values.start_row().map_err(fault)?;
            for property in &element.properties[..column] {
                skip_property(&property.kind, values).map_err(fault)?;
            }
            let place = values.place();
            read_list(count_kind, index_kind, values, &mut list).map_err(fault)?;
            add(&list).map_err(|wrong| fault(wrong.at(place)))?;
            for property in &element.properties[column + 1..] {
                skip_property(&property.kind, values).map_err(fault)?;
            }
            values.end_row().map_err(fault)?;
        }
        Ok(())
    }

    fn skip(&self, element: &Element, values: &mut impl Values) -> Result<(), LoadError> {
        for row in 0..element.count {
            let fault = |fault| self.fault(element, row, fault);
            values.start_row().map_err(fault)?;
            for property in &element.properties {
                skip_property(&property.kind, values).map_err(fault)?;
            }
            values.end_row().map_err(fault)?;
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
