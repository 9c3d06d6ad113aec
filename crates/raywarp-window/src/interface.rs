//! What is drawn over the picture: lines of text, the panel, the help.
//!
//! Everything is laid out anew for each drawing by egui, from the core's [`Status`] and [`Panel`]. egui needs no window
//! and no graphics card for that: it takes input and gives triangles, which [`paint`](crate::paint) draws.

use egui::{ClippedPrimitive, Context, FullOutput, LayerId, Order, Pos2, RawInput, Rect};

use crate::paint::Overlay;
use crate::texture::Textures;
use crate::{overlay, side};
use raywarp_viewer::live::{Event, Notice, Panel, Status};

/// What is to be said and shown.
pub struct Content<'a> {
    /// Of the core.
    pub status: &'a Status,
    /// Lines about the speed, and so on: apart, as they change less often than the status.
    pub lines: &'a [String],
    /// Of the core; none if it is not shown.
    pub panel: Option<&'a Panel>,
    /// Of the window.
    pub notice: Option<&'a Notice>,
    /// Whether there is no picture yet.
    pub empty: bool,
}

/// egui's memory and what is drawn of it.
pub struct Interface {
    context: Context,
    textures: Textures,
    primitives: Vec<ClippedPrimitive>,
    scale: f32,
    panel: Rect,
}

impl Interface {
    /// Nothing laid out yet.
    pub fn new() -> Self {
        let context = Context::default();
        context.set_theme(egui::Theme::Dark);
        context.options_mut(|options| {
            // Keys belong to the core.
            options.zoom_with_keyboard = false;
            // Discs made of texels would have to be filtered; triangles need not.
            options.tessellation_options.prerasterized_discs = false;
        });
        context.all_styles_mut(|style| {
            // Nothing is drawn but what something happened to.
            style.animation_time = 0.0;
            style.interaction.selectable_labels = false;
            style.visuals.widgets.noninteractive.fg_stroke.color = egui::Color32::from_gray(190);
        });
        Self { context, textures: Textures::default(), primitives: Vec::new(), scale: 1.0, panel: Rect::NOTHING }
    }

    /// egui's memory.
    pub fn context(&self) -> &Context {
        &self.context
    }

    /// Lays everything out; returns what is left to do for egui, and what people did to the panel.
    pub fn lay_out(&mut self, input: RawInput, content: &Content) -> (FullOutput, Vec<Event>) {
        let mut events = Vec::new();
        let panel = &mut self.panel;
        let mut output = self.context.run(input, |context| {
            // egui may lay out twice to find sizes: what is clicked is then told in the last round.
            events.clear();
            *panel = content.panel.map_or(Rect::NOTHING, |panel| side::show(context, panel, &mut events));
            overlay::show(context, content);
        });
        self.scale = output.pixels_per_point;
        self.textures.set(&output.textures_delta);
        self.primitives = self.context.tessellate(std::mem::take(&mut output.shapes), output.pixels_per_point);
        (output, events)
    }

    /// What to draw.
    pub fn overlay(&self) -> Overlay<'_> {
        Overlay { primitives: &self.primitives, textures: &self.textures, scale: self.scale }
    }

    /// To be called when it is drawn.
    pub fn drawn(&mut self, output: &FullOutput) {
        self.textures.free(&output.textures_delta);
    }

    /// Whether keys belong to the interface: something is typed into, or a list is open.
    pub fn has_keyboard(&self) -> bool {
        self.context.wants_keyboard_input() || egui::Popup::is_any_open(&self.context)
    }

    /// Whether a place, in pixels, is over a part that people can click on.
    pub fn is_over(&self, [x, y]: [f64; 2]) -> bool {
        let scale = f64::from(self.scale);
        let place = Pos2::new((x / scale) as f32, (y / scale) as f32);
        // The whole window is a layer of its own, at the bottom.
        let floats = |layer: LayerId| layer.order != Order::Background;
        self.panel.contains(place) || self.context.layer_id_at(place).is_some_and(floats)
    }
}
