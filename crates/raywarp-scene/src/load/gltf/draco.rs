//! KHR_draco_mesh_compression: the attributes and indices of a primitive in one Draco stream.

use std::collections::HashMap;

use ::gltf::json::accessor::ComponentType;
use ::gltf::json::mesh::{Primitive, Semantic};
use ::gltf::json::validation::Checked;
use ::gltf::json::{Index, Root, Value};
use draco_core::draco_types::DataType;
use draco_core::geometry_attribute::PointAttribute;
use draco_core::geometry_indices::PointIndex;
use draco_core::{DecodeLimits, DecoderBuffer, Mesh, MeshDecoder};

use super::super::quote::file_name;
use super::super::LoadError;
use super::budget::Budget;
use super::buffers::Buffers;
use super::decoded::{fenced, Attribute};
use super::origin::Origin;

const NAME: &str = "KHR_draco_mesh_compression";
/// Bytes of a face: three indices.
const FACE_BYTES: usize = 12;

/// Decodes the primitives that are compressed, but for those that the file has uncompressed as well.
pub(super) fn decode_primitives(
    origin: Origin,
    root: &Root,
    buffers: &Buffers,
    budget: &mut Budget,
) -> Result<HashMap<usize, Attribute>, LoadError> {
    let mut decoded = HashMap::new();
    for (index, mesh) in root.meshes.iter().enumerate() {
        for (place, primitive) in mesh.primitives.iter().enumerate() {
            let extension = primitive.extensions.as_ref().and_then(|extensions| extensions.others.get(NAME));
            let Some(extension) = extension.filter(|_| !has_fallback(root, primitive)) else { continue };
            let owner = format!("meshes[{index}].primitives[{place}]");
            Task { origin, primitive, extension, owner: &owner }.decode(buffers, budget, &mut decoded)?;
        }
    }
    Ok(decoded)
}

/// Whether the positions are there uncompressed.
fn has_fallback(root: &Root, primitive: &Primitive) -> bool {
    let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
    let accessor = positions.and_then(|accessor| root.accessors.get(accessor.value()));
    accessor.is_some_and(|accessor| accessor.buffer_view.is_some())
}

/// A primitive to be decoded.
struct Task<'a> {
    origin: Origin<'a>,
    primitive: &'a Primitive,
    extension: &'a Value,
    owner: &'a str,
}

impl Task<'_> {
    fn decode(
        &self,
        buffers: &Buffers,
        budget: &mut Budget,
        decoded: &mut HashMap<usize, Attribute>,
    ) -> Result<(), LoadError> {
        let view = self.index(self.extension.get("bufferView"), "bufferView")?;
        let stream = buffers.view(self.origin, self.owner, Index::new(view))?.bytes;
        let mesh = self.unpack(stream, budget.decoded_left())?;
        budget.take_decoded(self.origin, mesh.num_faces(), FACE_BYTES)?;
        let indices = self.primitive.indices.ok_or_else(|| {
            self.origin
                .broken(format!("{} is compressed by Draco and has no indices", self.owner), "an accessor for them")
        })?;
        decoded.insert(indices.value(), indices_of(&mesh));
        let attributes = self.extension.get("attributes").and_then(Value::as_object);
        for (name, id) in attributes.into_iter().flatten() {
            let id = self.index(Some(id), name)?;
            if let Some(accessor) = self.accessor(name) {
                let attribute = self.attribute(&mesh, name, id)?;
                budget.take_decoded(self.origin, attribute.bytes.len(), 1)?;
                decoded.insert(accessor, attribute);
            }
        }
        Ok(())
    }

    fn index(&self, value: Option<&Value>, key: &str) -> Result<u32, LoadError> {
        let index = value.and_then(Value::as_u64).and_then(|index| u32::try_from(index).ok());
        index.ok_or_else(|| {
            let read = format!("the Draco compression of {} has a wrong {}", self.owner, file_name(key));
            self.origin.broken(read, "a number")
        })
    }

    /// The accessor of an attribute that raywarp reads.
    fn accessor(&self, name: &str) -> Option<usize> {
        let of = |(semantic, accessor): (&Checked<Semantic>, &Index<_>)| match semantic {
            Checked::Valid(semantic) if semantic.to_string() == name => Some(accessor.value()),
            _ => None,
        };
        self.primitive.attributes.iter().find_map(of)
    }

    fn unpack(&self, stream: &[u8], limit: usize) -> Result<Mesh, LoadError> {
        let limits = DecodeLimits::default()
            .with_max_points((limit / FACE_BYTES) as u64)
            .with_max_faces((limit / FACE_BYTES) as u64)
            .with_max_decoded_bytes(limit as u64);
        let decode = || {
            let mut mesh = Mesh::new();
            let mut buffer = DecoderBuffer::new(stream).with_limits(limits);
            MeshDecoder::new().decode(&mut buffer, &mut mesh).map_err(|error| error.to_string())?;
            Ok(mesh)
        };
        fenced(decode).map_err(|reason| {
            let read = format!("the Draco stream of {} cannot be decoded: {}", self.owner, file_name(&reason));
            self.origin.broken(read, "a triangle mesh of Draco 2.2")
        })
    }

    fn attribute(&self, mesh: &Mesh, name: &str, id: u32) -> Result<Attribute, LoadError> {
        let attribute = mesh.attribute_by_unique_id(id).and_then(|attribute| packed(attribute, mesh.num_points()));
        attribute.ok_or_else(|| {
            let read = format!("{} has {} as attribute {id} of its Draco stream", self.owner, file_name(name));
            self.origin.broken(read, "one of the stream, of a type that glTF has")
        })
    }
}

fn indices_of(mesh: &Mesh) -> Attribute {
    let bytes: Vec<u8> = mesh.faces().iter().flatten().flat_map(|point| point.0.to_le_bytes()).collect();
    Attribute { count: 3 * mesh.num_faces(), bytes, lanes: 1, component: ComponentType::U32 }
}

/// The value of each point; `None` for a type that glTF lacks, and for values that are not there.
fn packed(attribute: &PointAttribute, points: usize) -> Option<Attribute> {
    let component = component(attribute.data_type())?;
    let lanes = usize::from(attribute.num_components());
    let (size, stride) = (lanes * component.size(), usize::try_from(attribute.byte_stride()).ok()?);
    let values = attribute.buffer().data();
    let mut bytes = Vec::with_capacity(points.checked_mul(size)?);
    for point in 0..u32::try_from(points).ok()? {
        let start = (attribute.mapped_index(PointIndex(point)).0 as usize).checked_mul(stride)?;
        bytes.extend_from_slice(values.get(start..start.checked_add(size)?)?);
    }
    Some(Attribute { bytes, count: points, lanes, component })
}

fn component(kind: DataType) -> Option<ComponentType> {
    match kind {
        DataType::Int8 => Some(ComponentType::I8),
        DataType::Uint8 => Some(ComponentType::U8),
        DataType::Int16 => Some(ComponentType::I16),
        DataType::Uint16 => Some(ComponentType::U16),
        DataType::Uint32 => Some(ComponentType::U32),
        DataType::Float32 => Some(ComponentType::F32),
        _ => None,
    }
}
