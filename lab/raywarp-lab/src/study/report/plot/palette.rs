//! Which colour stands for what, the same in all plots of a report.

use plotters::style::RGBColor;

/// Of structures. Told apart by people of most kinds of colour vision: the strong ones first, then a paler one of each.
const STRUCTURES: [RGBColor; 16] = [
    RGBColor(0x2f, 0x6f, 0xb5),
    RGBColor(0xe0, 0x7b, 0x1a),
    RGBColor(0x2e, 0x93, 0x6f),
    RGBColor(0xc4, 0x3d, 0x4b),
    RGBColor(0x7d, 0x5b, 0xb5),
    RGBColor(0x9a, 0x6b, 0x4f),
    RGBColor(0xd0, 0x62, 0xa8),
    RGBColor(0x7a, 0x7f, 0x86),
    RGBColor(0x9c, 0xc3, 0xea),
    RGBColor(0xf5, 0xc1, 0x86),
    RGBColor(0x97, 0xd3, 0xb8),
    RGBColor(0xee, 0xa3, 0xa9),
    RGBColor(0xc6, 0xb5, 0xe3),
    RGBColor(0xd3, 0xb8, 0xa5),
    RGBColor(0xf0, 0xb5, 0xda),
    RGBColor(0xc3, 0xc6, 0xca),
];

/// Of everything else, so that nothing is taken for a structure.
const OTHERS: [RGBColor; 8] = [
    RGBColor(0x1c, 0x7c, 0x8c),
    RGBColor(0xef, 0xb8, 0x4a),
    RGBColor(0xb8, 0x57, 0x3a),
    RGBColor(0x8b, 0x98, 0xa8),
    RGBColor(0xd5, 0xdb, 0xe2),
    RGBColor(0x4b, 0x4f, 0x7d),
    RGBColor(0x8f, 0x9c, 0x3f),
    RGBColor(0x7d, 0xc1, 0xc9),
];

/// Of lines that guide the eye.
const GUIDE: RGBColor = RGBColor(0x7a, 0x7f, 0x86);

/// A name and its colour: what a legend says.
#[derive(Clone, Debug)]
pub struct Series {
    /// For people.
    pub name: String,
    /// In every plot.
    pub colour: RGBColor,
}

/// Names in the order of their colours.
#[derive(Clone, Debug)]
pub struct Palette {
    names: Vec<String>,
    colours: &'static [RGBColor],
}

impl Palette {
    /// A colour for each structure, in the order in which they first come.
    pub fn of_structures<'a>(names: impl IntoIterator<Item = &'a str>) -> Self {
        Self::new(names, &STRUCTURES)
    }

    /// A colour for each of something else.
    pub fn of<'a>(names: impl IntoIterator<Item = &'a str>) -> Self {
        Self::new(names, &OTHERS)
    }

    fn new<'a>(names: impl IntoIterator<Item = &'a str>, colours: &'static [RGBColor]) -> Self {
        let mut known: Vec<String> = Vec::new();
        for name in names {
            if !known.iter().any(|one| one == name) {
                known.push(name.to_owned());
            }
        }
        Self { names: known, colours }
    }

    /// The colour of what guides the eye.
    pub fn guide() -> RGBColor {
        GUIDE
    }

    /// Every name, once.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The colour of a name; of one that is unknown, that of the guides.
    pub fn series(&self, name: &str) -> Series {
        let index = self.names.iter().position(|known| known == name);
        let colour = index.and_then(|index| self.colours.get(index % self.colours.len())).copied();
        Series { name: name.to_owned(), colour: colour.unwrap_or(GUIDE) }
    }
}
