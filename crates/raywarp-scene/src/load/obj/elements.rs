//! The second pass: faces, and the statements that say what they belong to.

use std::path::Path;

use super::super::triangulate::Triangulator;
use super::corner::{Context, Corner, Lacking, Seen};
use super::materials::Materials;
use super::meshes::Meshes;
use crate::load::quote::quote;
use crate::load::text::{is_keyword, parse_integer, Kind, SkippedStatements, Statement, Statements, Strays};
use crate::load::{LoadError, Sources};
use crate::memory::{Budget, Growth};
use crate::{Mesh, Scene};

/// The faces of a file, taken in.
pub(super) struct Elements<'a> {
    path: &'a Path,
    meshes: Meshes<'a>,
    materials: Materials,
    triangulator: Triangulator,
    seen: Seen,
    material: u32,
    /// Smoothing group; 0, and what a file starts with, is off.
    smoothing: u32,
    faces: usize,
    not_finite: usize,
    repeated: usize,
    /// Faces of fewer than three corners.
    too_few_corners: Strays,
    /// Faces that name texture coordinates, and normals, which the file lacks.
    without_uvs: Strays,
    without_normals: Strays,
    skipped: SkippedStatements<'a>,
    /// Lines that are no statements.
    foreign: Strays,
    /// Scratch space of a face.
    corners: Vec<Corner>,
    polygon: Vec<[f32; 3]>,
}

impl<'a> Elements<'a> {
    /// All faces of a file.
    pub fn read(
        path: &'a Path,
        bytes: &'a [u8],
        meshes: Meshes<'a>,
        materials: Materials,
        budget: &Budget,
    ) -> Result<Self, LoadError> {
        let mut elements = Self {
            path,
            meshes,
            material: materials.fallback(),
            materials,
            triangulator: Triangulator::new(bytes.len()),
            seen: Seen::default(),
            smoothing: 0,
            faces: 0,
            not_finite: 0,
            repeated: 0,
            too_few_corners: Strays::default(),
            without_uvs: Strays::default(),
            without_normals: Strays::default(),
            skipped: SkippedStatements::default(),
            foreign: Strays::default(),
            corners: Vec::new(),
            polygon: Vec::new(),
        };
        let mut growth = Growth::new(budget);
        for statement in Statements::new(bytes) {
            elements.statement(&statement)?;
            growth.reach(1, elements.meshes.bytes()).map_err(LoadError::memory(path, "its meshes"))?;
        }
        Ok(elements)
    }

    fn statement(&mut self, statement: &Statement<'a>) -> Result<(), LoadError> {
        match statement.keyword {
            b"v" => self.seen.positions += 1,
            b"vt" => self.seen.uvs += 1,
            b"vn" => self.seen.normals += 1,
            b"f" | b"fo" => self.face(statement)?,
            b"g" => self.meshes.start_group(statement.text()),
            b"o" => self.meshes.start_object(statement.text()),
            b"usemtl" => self.material = self.materials.named(statement.text(), statement.line),
            b"s" => self.smoothing = self.smoothing_group(statement)?,
            b"mtllib" => {}
            // How to show or refine what has no triangles: nothing is lost.
            b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"mg" | b"shadow_obj" | b"trace_obj" => {}
            keyword if is_keyword(keyword) => self.skipped.count(statement),
            // Among statements it is a line of another program; where there is no vertex, it is another kind of file.
            _ if self.meshes.points.positions.is_empty() => return Err(self.no_keyword(statement)),
            _ => self.foreign.count(statement),
        }
        Ok(())
    }

    /// `f` and three or more corners.
    fn face(&mut self, statement: &Statement) -> Result<(), LoadError> {
        let context = Context { path: self.path, points: self.meshes.points, seen: self.seen };
        let mut lacking = Lacking::default();
        self.corners.clear();
        for field in statement.fields() {
            self.corners.push(context.corner(statement, field, &mut lacking)?);
        }
        if lacking.uv {
            self.without_uvs.count(statement);
        }
        if lacking.normal {
            self.without_normals.count(statement);
        }
        self.faces += usize::from(self.corners.len() >= 3);
        match self.corners[..] {
            [a, b, c] => self.triangle([a, b, c]),
            [_, _, _, ..] => self.polygon(),
            _ => self.too_few_corners.count(statement),
        }
        Ok(())
    }

    fn polygon(&mut self) {
        let positions = &self.meshes.points.positions;
        self.polygon.clear();
        self.polygon.extend(self.corners.iter().map(|corner| positions[corner.position as usize]));
        let triangles = self.triangulator.cut(&self.polygon).len();
        self.repeated += usize::from(triangles == 0);
        for index in 0..triangles {
            let triangle = self.triangulator.triangle(index);
            self.triangle(triangle.map(|corner| self.corners[corner as usize]));
        }
    }

    /// Keeps a triangle unless a vertex is not finite or stands in it twice. Without an area it may still be kept.
    #[inline]
    fn triangle(&mut self, corners: [Corner; 3]) {
        let [a, b, c] = corners.map(|corner| corner.position);
        let positions = &self.meshes.points.positions;
        if a == b || b == c || c == a {
            self.repeated += 1;
        } else if [a, b, c].iter().any(|&v| !positions[v as usize].iter().all(|x| x.is_finite())) {
            self.not_finite += 1;
        } else {
            self.materials.note(self.material);
            self.meshes.add(corners, self.smoothing, self.material);
        }
    }

    /// `s off`, or a number.
    fn smoothing_group(&self, statement: &Statement) -> Result<u32, LoadError> {
        let Some(field) = statement.fields().next() else { return Ok(0) };
        let group = match field.bytes {
            b"off" => Some(0),
            b"on" => Some(1),
            number => parse_integer(number).and_then(|number| u32::try_from(number).ok()),
        };
        group.ok_or_else(|| {
            let read = format!("{} is not a smoothing group", field.quoted());
            statement.error(self.path, Some(field), read, "'off' or a number from 0", "Correct or remove the line.")
        })
    }

    fn no_keyword(&self, statement: &Statement) -> LoadError {
        let field = statement.first();
        let read = format!("{} is not a statement", field.quoted());
        let expected = "a keyword such as v, vt, vn, f, g, o, s or usemtl";
        statement.error(self.path, Some(field), read, expected, "Check that this is a Wavefront OBJ file, as text.")
    }

    /// Reports what was dropped and skipped.
    pub fn warn(&self, path: &Path, sources: &mut Sources) -> Result<(), LoadError> {
        for kind in &self.skipped.kinds {
            sources.warn(path, Some(kind.line), skipped(kind))?;
        }
        for (lines, is, are) in self.lines() {
            if let Some(message) = lines.message(is, are) {
                sources.warn(path, Some(lines.line), message)?;
            }
        }
        let counts = [
            (self.skipped.more, "statements of more unknown kinds are skipped"),
            (self.not_finite, "triangles have a vertex that is not finite and are dropped"),
            (self.repeated, "triangles have the same vertex twice and are dropped"),
            (self.triangulator.unfinished, "polygons have too many corners to be cut with care: triangles may overlap"),
            (self.meshes.merged, "more object and group names share one mesh"),
        ];
        for (count, what) in counts.into_iter().filter(|(count, _)| *count > 0) {
            sources.warn(path, None, format!("{count} {what}"))?;
        }
        if self.faces == 0 {
            sources.warn(path, None, "the file has no faces: raywarp shows triangles, not points or lines")?;
        }
        Ok(())
    }

    /// Lines that are not read as they stand, and what becomes of one and of several.
    fn lines(&self) -> [(&Strays, &'static str, &'static str); 4] {
        [
            (&self.foreign, "is not a statement of OBJ and is skipped", "are not statements of OBJ and are skipped"),
            (
                &self.too_few_corners,
                "is a face of fewer than 3 corners and is dropped",
                "are faces of fewer than 3 corners and are dropped",
            ),
            (
                &self.without_uvs,
                "names texture coordinates that the file lacks; they are left out",
                "name texture coordinates that the file lacks; they are left out",
            ),
            (
                &self.without_normals,
                "names normals that the file lacks; they are left out",
                "name normals that the file lacks; they are left out",
            ),
        ]
    }

    /// The meshes, and in the scene the default material if they use it.
    pub fn finish(self, path: &Path, scene: &mut Scene, sources: &mut Sources) -> Result<Vec<Mesh>, LoadError> {
        self.materials.finish(path, scene, sources)?;
        Ok(self.meshes.finish())
    }
}

fn skipped(kind: &Kind) -> String {
    let what = match kind.keyword {
        b"l" => "lines",
        b"p" => "points",
        b"call" | b"csh" | b"maplib" | b"usemap" => "not supported",
        keyword if FREE_FORM.contains(&keyword) => "free-form curves and surfaces",
        _ => "unknown",
    };
    let statements = if kind.count == 1 { "statement is" } else { "statements are" };
    format!("{} {} {statements} skipped ({what})", kind.count, quote(kind.keyword))
}

/// The keywords of free-form geometry, with those of version 2.11.
const FREE_FORM: [&[u8]; 20] = [
    b"vp", b"cstype", b"deg", b"bmat", b"step", b"curv", b"curv2", b"surf", b"parm", b"trim", b"hole", b"scrv", b"sp",
    b"end", b"con", b"bsp", b"bzp", b"cdc", b"cdp", b"res",
];
