//! Which colour stands for what, the same in all plots of a report.

use plotters::style::RGBColor;

/// Told apart by people of most kinds of colour vision, the strong ones first, then a paler one of each.
const COLOURS: [RGBColor; 16] = [
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

/// The strong one that has no hue.
const GREY: usize = 7;

/// A name and its colour: what a legend says.
#[derive(Clone, Debug)]
pub struct Series {
    /// For people.
    pub name: String,
    /// In every plot.
    pub colour: RGBColor,
}

/// Names in the order of their colours.
#[derive(Clone, Debug, Default)]
pub struct Palette {
    names: Vec<String>,
}

impl Palette {
    /// A colour for each name, in the order in which they first come.
    pub fn of<'a>(names: impl IntoIterator<Item = &'a str>) -> Self {
        let mut palette = Self::default();
        for name in names {
            if !palette.names.iter().any(|known| known == name) {
                palette.names.push(name.to_owned());
            }
        }
        palette
    }

    /// The colour of what guides the eye.
    pub fn guide() -> RGBColor {
        COLOURS[GREY]
    }

    /// Every name, once.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The colour of a name; of one that is unknown, the last.
    pub fn series(&self, name: &str) -> Series {
        let index = self.names.iter().position(|known| known == name);
        let colour = COLOURS[index.map_or(COLOURS.len() - 1, |index| index % COLOURS.len())];
        Series { name: name.to_owned(), colour }
    }
}
