//! STL as text: `solid`, `facet normal`, `outer loop`, `vertex`, and an end for each.

use std::path::Path;

use super::{Contents, Solid};
use crate::load::precision::Rounding;
use crate::load::text::{parse_f64, unpadded, Field, Statement, Statements, Strays};
use crate::load::triangulate::Triangulator;
use crate::load::LoadError;
use crate::memory::{Budget, Growth};

/// Whether the file begins as text does, and holds no NUL, as no text does.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    const BOM: &[u8] = b"\xef\xbb\xbf";
    const LOOKED_AT: usize = 1024;
    let text = unpadded(bytes.strip_prefix(BOM).unwrap_or(bytes)).trim_ascii_start();
    let begins = text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    begins && !text.iter().take(LOOKED_AT).any(|&byte| byte == 0)
}

/// Reads all solids.
pub(super) fn read(path: &Path, bytes: &[u8], budget: &Budget) -> Result<Contents, LoadError> {
    let mut reader = Reader {
        path,
        solids: Vec::new(),
        facet: None,
        rounding: Rounding::default(),
        triangulator: Triangulator::new(bytes.len()),
        facets: 0,
        too_few_corners: 0,
        foreign: Strays::default(),
    };
    let (mut last, mut growth, mut before) = (None, Growth::new(budget), 0);
    for statement in Statements::new(bytes) {
        let solids = reader.solids.len();
        reader.line(&statement)?;
        if reader.solids.len() > solids {
            before += solids.checked_sub(1).map_or(0, |last| reader.solids[last].bytes());
        }
        let bytes = before + reader.solids.last().map_or(0, Solid::bytes);
        growth.reach(1, bytes).map_err(LoadError::memory(path, "its triangles"))?;
        last = Some(statement);
    }
    if let (Some(_), Some(last)) = (&reader.facet, last) {
        let read = "the file ends within a facet".to_owned();
        return Err(last.error(path, None, read, "'endfacet'", "Check that the file is complete."));
    }
    Ok(reader.finish())
}

struct Reader<'a> {
    path: &'a Path,
    solids: Vec<Solid>,
    /// Corners of the facet that is open.
    facet: Option<Vec<[f32; 3]>>,
    rounding: Rounding,
    triangulator: Triangulator,
    facets: usize,
    too_few_corners: usize,
    /// Lines with words of another format.
    foreign: Strays,
}

impl Reader<'_> {
    /// One statement a line as a rule, but several are as good.
    fn line(&mut self, statement: &Statement) -> Result<(), LoadError> {
        let mut fields = std::iter::once(statement.first()).chain(statement.fields());
        while let Some(field) = fields.next() {
            match field.bytes.to_ascii_lowercase().as_slice() {
                b"solid" => {
                    self.solids.push(Solid::new(statement.text_from(field.end(), statement.end())));
                    return Ok(());
                }
                b"endsolid" => return Ok(()),
                // The normal follows from the corners.
                b"facet" => {
                    self.close();
                    self.facet = Some(Vec::new());
                    fields.by_ref().take(4).for_each(drop);
                }
                b"outer" => fields.by_ref().take(1).for_each(drop),
                b"endloop" => {}
                b"vertex" => {
                    let corner = self.corner(statement, &mut fields)?;
                    self.facet.get_or_insert_default().push(corner);
                }
                b"endfacet" => self.close(),
                _ => {
                    self.foreign.count(statement);
                    return self.check_is_stl(statement);
                }
            }
        }
        Ok(())
    }

    fn corner<'f>(
        &mut self,
        statement: &Statement,
        fields: &mut impl Iterator<Item = Field<'f>>,
    ) -> Result<[f32; 3], LoadError> {
        const EXPECTED: &str = "'vertex x y z'";
        let mut corner = [0.0; 3];
        for coordinate in &mut corner {
            let field = fields.next().ok_or_else(|| {
                let read = format!("{} has too few numbers", statement.quoted());
                statement.error(self.path, None, read, EXPECTED, "Check that the file is complete.")
            })?;
            let number = parse_f64(field.bytes).ok_or_else(|| {
                let read = format!("{} is not a number", field.quoted());
                statement.error(self.path, Some(field), read, EXPECTED, "Write numbers as 1.5 or -2e-3.")
            })?;
            *coordinate = self.rounding.round(number);
        }
        Ok(corner)
    }

    /// Ends the facet: a triangle as a rule, but polygons are written too.
    fn close(&mut self) {
        let Some(corners) = self.facet.take() else { return };
        self.facets += 1;
        if self.solids.is_empty() {
            self.solids.push(Solid::default());
        }
        let Some(solid) = self.solids.last_mut() else { return };
        match corners[..] {
            [a, b, c] => solid.add([a, b, c], None),
            [_, _, _, ..] => {
                for triangle in self.triangulator.cut(&corners) {
                    solid.add(triangle.map(|corner| corners[corner as usize]), None);
                }
            }
            _ => self.too_few_corners += 1,
        }
    }

    /// Lines of other programs are passed over among facets; before any of these the file is of another kind.
    fn check_is_stl(&self, statement: &Statement) -> Result<(), LoadError> {
        const MAX_FOREIGN: usize = 100;
        if self.facets > 0 || self.facet.is_some() || self.foreign.count < MAX_FOREIGN {
            return Ok(());
        }
        let read = format!("{MAX_FOREIGN} lines are no statements, of which {} is the last", statement.quoted());
        Err(statement.error(self.path, None, read, "'facet normal x y z'", "Check that this is an STL file."))
    }

    fn finish(self) -> Contents {
        let mut warnings = Vec::new();
        let (is, are) = ("is not a statement of STL and is skipped", "are not statements of STL and are skipped");
        if let Some(message) = self.foreign.message(is, are) {
            warnings.push((Some(self.foreign.line), message));
        }
        if self.too_few_corners > 0 {
            let count = self.too_few_corners;
            warnings.push((None, format!("{count} facets have fewer than 3 corners and are dropped")));
        }
        if self.triangulator.unfinished > 0 {
            let count = self.triangulator.unfinished;
            warnings.push((
                None,
                format!("{count} facets have too many corners to be cut with care: triangles may overlap"),
            ));
        }
        Contents { solids: self.solids, rounding: self.rounding, warnings }
    }
}
