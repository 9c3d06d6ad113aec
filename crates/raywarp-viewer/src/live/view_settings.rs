//! How a viewer shows the scene: options of the picture, and what is shown over it.

use std::fmt;
use std::str::FromStr;

use raywarp::image::{Development, ToneMap};
use raywarp::render::{RenderOptions, MAX_DEPTH};
use raywarp::scene::RenderDefaults;

use super::keys::Action;

/// What the picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum View {
    /// The scene, lit.
    #[default]
    Picture,
    /// Shading normals as colours.
    Normals,
    /// Distance from the camera.
    Depth,
    /// Diffuse colours without light.
    Albedo,
    /// A colour for each triangle.
    Primitives,
    /// A colour for each material.
    Materials,
    /// Boxes and triangles tested for each pixel.
    Tests,
    /// How evenly the threads of the device are loaded.
    Load,
}

impl View {
    /// Every view, in the order that they are stepped through.
    pub const ALL: [Self; 8] = [
        Self::Picture,
        Self::Normals,
        Self::Depth,
        Self::Albedo,
        Self::Primitives,
        Self::Materials,
        Self::Tests,
        Self::Load,
    ];

    /// The name that [`FromStr`] reads.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Normals => "normals",
            Self::Depth => "depth",
            Self::Albedo => "albedo",
            Self::Primitives => "primitives",
            Self::Materials => "materials",
            Self::Tests => "tests",
            Self::Load => "load",
        }
    }

    /// The one so many further on, round and round.
    fn step(self, by: usize) -> Self {
        let at = Self::ALL.iter().position(|&view| view == self).unwrap_or(0);
        Self::ALL[(at + by) % Self::ALL.len()]
    }
}

impl fmt::Display for View {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that belongs to no view.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is no view; expected picture, normals, depth, albedo, primitives, materials, tests or load")]
pub struct UnknownView(pub String);

impl FromStr for View {
    type Err = UnknownView;

    fn from_str(name: &str) -> Result<Self, UnknownView> {
        Self::ALL.into_iter().find(|view| view.name() == name).ok_or_else(|| UnknownView(name.to_owned()))
    }
}

/// Deepest level of boxes that can be shown.
pub const MAX_LEVEL: u32 = 64;
/// Stops up and down.
pub const MAX_EXPOSURE: f32 = 20.0;
/// Most samples a pixel that a viewer goes on to.
pub const MAX_SAMPLES: u32 = 1 << 16;
/// Frames a second that can be aimed at.
pub const FRAME_RATES: [f32; 2] = [1.0, 240.0];

/// The options of a viewer, with their defaults.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewSettings {
    /// What the picture shows.
    pub view: View,
    /// The boxes of the tree over the picture, down to this level; 0 is the root.
    pub boxes: Option<u32>,
    /// The options of rendering that a viewer can change while it runs, each with a value. The samples are those that a
    /// picture at rest goes up to.
    pub render: RenderDefaults,
    /// Whether the picture keeps its size and all samples while the camera moves.
    pub reference: bool,
    /// Frames a second to aim at while the camera moves.
    pub frame_rate: f32,
    /// Whether the help is shown.
    pub help: bool,
    /// Whether the panel is shown.
    pub panel: bool,
    /// Whether statistics are shown.
    pub statistics: bool,
}

impl Default for ViewSettings {
    fn default() -> Self {
        Self {
            view: View::Picture,
            boxes: None,
            render: complete(&RenderDefaults::default()),
            reference: false,
            frame_rate: 60.0,
            help: false,
            panel: false,
            statistics: true,
        }
    }
}

/// Samples a pixel that a picture at rest goes up to, unless somebody says otherwise.
const USUAL_SAMPLES: u32 = 64;

/// The options of a viewer, with what is said of them.
fn complete(said: &RenderDefaults) -> RenderDefaults {
    let own = RenderDefaults { spp: Some(USUAL_SAMPLES), ..RenderDefaults::default() };
    let all = said.or(&own).or(&RenderDefaults::usual());
    RenderDefaults { size: None, accel: None, tree: None, ..all }
}

/// What a change of options asks of the renderer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Changed {
    /// Not an action of these options.
    No,
    /// Lines beside the picture: nothing to render.
    Overlay,
    /// The same samples, shown otherwise: exposure, tone map, boxes.
    Development,
    /// The picture starts again.
    Picture,
}

impl ViewSettings {
    /// The options that a scene or a command line asks for, and where they are silent the usual ones.
    pub fn of(overrides: &RenderDefaults) -> Self {
        Self { render: complete(overrides), ..Self::default() }
    }

    /// What differs from other options, as a scene file can say it.
    pub fn overrides(&self, others: &Self) -> RenderDefaults {
        self.render.changed_from(&others.render)
    }

    /// Takes over what a scene that was read again asks for `now` instead of `before`, where nobody has changed it.
    pub fn follow(&mut self, before: &Self, now: &Self) {
        self.render = self.overrides(before).or(&now.render);
    }

    /// Stops of exposure, and the curve to the screen.
    pub fn development(&self) -> Development {
        Development::from(&self.render)
    }

    /// Does what a key asks for, if it is about these options.
    pub fn act(&mut self, action: Action) -> Changed {
        match action {
            Action::View(view) => self.show(if self.view == view { View::Picture } else { view }),
            Action::NextView => self.show(self.view.step(1)),
            Action::PreviousView => self.show(self.view.step(View::ALL.len() - 1)),
            Action::Shadows => (self.render.shadows = Some(!self.render.shadows()), Changed::Picture).1,
            Action::Reference => (self.reference = !self.reference, Changed::Overlay).1,
            Action::DeeperBoxes => self.frame(Some(self.boxes.map_or(0, |level| (level + 1).min(MAX_LEVEL)))),
            Action::HigherBoxes => self.frame(self.boxes.and_then(|level| level.checked_sub(1))),
            Action::Brighter => self.expose(self.render.exposure() + 0.5),
            Action::Darker => self.expose(self.render.exposure() - 0.5),
            Action::ResetExposure => self.expose(0.0),
            Action::ToneMap => (self.render.tone_map = Some(next(self.render.tone_map())), Changed::Development).1,
            Action::Help => toggle(&mut self.help),
            Action::Panel => toggle(&mut self.panel),
            Action::Statistics => toggle(&mut self.statistics),
            Action::Escape if self.help => toggle(&mut self.help),
            _ => Changed::No,
        }
    }

    fn show(&mut self, view: View) -> Changed {
        self.view = view;
        Changed::Picture
    }

    fn frame(&mut self, boxes: Option<u32>) -> Changed {
        self.boxes = boxes;
        Changed::Development
    }

    fn expose(&mut self, stops: f32) -> Changed {
        self.render.exposure = Some(stops.clamp(-MAX_EXPOSURE, MAX_EXPOSURE));
        Changed::Development
    }

    /// The picture to ask the renderer for.
    pub fn render_options(&self, size: [u32; 2]) -> RenderOptions {
        RenderOptions {
            size,
            spp: self.render.spp().clamp(1, MAX_SAMPLES),
            max_depth: self.render.max_depth().min(MAX_DEPTH),
            ..RenderOptions::from(&self.render)
        }
    }
}

fn toggle(shown: &mut bool) -> Changed {
    *shown = !*shown;
    Changed::Overlay
}

fn next(curve: ToneMap) -> ToneMap {
    let at = ToneMap::ALL.iter().position(|&other| other == curve).unwrap_or(0);
    ToneMap::ALL[(at + 1) % ToneMap::ALL.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back() {
        for view in View::ALL {
            assert_eq!(view.to_string().parse(), Ok(view));
        }
        assert_eq!("x-ray".parse::<View>(), Err(UnknownView("x-ray".to_owned())));
    }

    #[test]
    fn a_view_is_one_key_away_and_the_same_key_leads_back() {
        let mut view_settings = ViewSettings::default();
        assert_eq!(view_settings.act(Action::View(View::Depth)), Changed::Picture);
        assert_eq!(view_settings.view, View::Depth);
        view_settings.act(Action::View(View::Depth));
        assert_eq!(view_settings.view, View::Picture);
        for _ in View::ALL {
            view_settings.act(Action::NextView);
        }
        assert_eq!(view_settings.view, View::Picture);
        view_settings.act(Action::PreviousView);
        assert_eq!(view_settings.view, View::Load);
    }

    #[test]
    fn boxes_go_down_from_none_and_up_to_none() {
        let mut view_settings = ViewSettings::default();
        view_settings.act(Action::DeeperBoxes);
        view_settings.act(Action::DeeperBoxes);
        assert_eq!(view_settings.boxes, Some(1));
        view_settings.act(Action::HigherBoxes);
        view_settings.act(Action::HigherBoxes);
        view_settings.act(Action::HigherBoxes);
        assert_eq!(view_settings.boxes, None);
    }

    #[test]
    fn exposure_stays_in_its_range_and_goes_back() {
        let mut view_settings = ViewSettings::default();
        for _ in 0..100 {
            assert_eq!(view_settings.act(Action::Brighter), Changed::Development);
        }
        assert_eq!(view_settings.render.exposure(), MAX_EXPOSURE);
        view_settings.act(Action::ResetExposure);
        view_settings.act(Action::Darker);
        assert_eq!(view_settings.render.exposure(), -0.5);
    }

    #[test]
    fn what_nobody_changed_follows_the_file() {
        let asked = |spp, exposure| ViewSettings::of(&RenderDefaults { spp, exposure, ..RenderDefaults::default() });
        let (before, now) = (asked(Some(4), None), asked(Some(9), Some(1.0)));
        let mut view_settings = before.clone();
        (view_settings.render.max_depth, view_settings.view) = (Some(2), View::Depth);
        view_settings.follow(&before, &now);
        assert_eq!(
            (
                view_settings.render.spp(),
                view_settings.render.exposure(),
                view_settings.render.max_depth(),
                view_settings.view
            ),
            (9, 1.0, 2, View::Depth)
        );
        view_settings.render.exposure = Some(-3.0);
        assert_eq!(view_settings.overrides(&now).to_string(), "max depth 2, exposure -3");
        view_settings.follow(&now, &asked(None, None));
        assert_eq!((view_settings.render.spp(), view_settings.render.exposure()), (USUAL_SAMPLES, -3.0));
    }

    #[test]
    fn escape_closes_the_help_and_does_nothing_else() {
        let mut view_settings = ViewSettings::default();
        assert_eq!(view_settings.act(Action::Escape), Changed::No);
        view_settings.act(Action::Help);
        assert_eq!(view_settings.act(Action::Escape), Changed::Overlay);
        assert_eq!(view_settings, ViewSettings::default());
    }
}
