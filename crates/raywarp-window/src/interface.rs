//! What is drawn over the picture: lines of text, the panel, the help.
//!
//! Everything is laid out anew for each drawing by egui, from the core's [`Status`] and [`Panel`]. egui needs no window
//! and no graphics card for that: it takes input and gives triangles, which [`paint`](crate::paint) draws.

use egui::{ClippedPrimitive, Context, FullOutput, LayerId, Order, Pos2, RawInput, Rect};

use crate::paint::{Area, Overlay};
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
    /// What the panel leaves to the picture, in points.
    free: Rect,
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
        let (panel, free) = (Rect::NOTHING, Rect::EVERYTHING);
        Self { context, textures: Textures::default(), primitives: Vec::new(), scale: 1.0, panel, free }
    }

    /// egui's memory.
    pub fn context(&self) -> &Context {
        &self.context
    }

    /// Lays everything out; returns what is left to do for egui, and what people did to the panel.
    pub fn lay_out(&mut self, input: RawInput, content: &Content) -> (FullOutput, Vec<Event>) {
        let mut events = Vec::new();
        let (panel, free) = (&mut self.panel, &mut self.free);
        let mut output = self.context.run(input, |context| {
            // egui may lay out twice to find sizes: what is clicked is then told in the last round.
            events.clear();
            *panel = content.panel.map_or(Rect::NOTHING, |panel| side::show(context, panel, &mut events));
            *free = context.available_rect();
            overlay::show(context, content);
        });
        self.scale = output.pixels_per_point;
        self.textures.set(&output.textures_delta);
        self.primitives = self.context.tessellate(std::mem::take(&mut output.shapes), output.pixels_per_point);
        (output, events)
    }

    /// Where the picture is in a window of so many pixels: at least one of them.
    pub fn picture_area(&self, size: [usize; 2]) -> Area {
        let inside = |points: f32, side: usize| (points * self.scale).round().clamp(0.0, side as f32) as usize;
        let first = [0, 1].map(|i| inside(self.free.min[i], size[i]).min(size[i].saturating_sub(1)));
        let end = [0, 1].map(|i| inside(self.free.max[i], size[i]));
        Area { first, size: [0, 1].map(|i| end[i].saturating_sub(first[i]).max(1)) }
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
