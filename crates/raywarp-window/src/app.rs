//! The window's loop: events in, a frame of the core, pixels out.

use std::sync::Arc;
use std::time::{Duration, Instant};

use raywarp_viewer::live::{Event, Export, LiveScene, Notice, Outcome, Picture, Status, Viewer};
use winit::application::ApplicationHandler;
use winit::event::{ElementState, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::window::WindowId;

use crate::display::WindowOptions;
use crate::error::WindowError;
use crate::input::Input;
use crate::interface::{Content, Interface};
use crate::paint::Area;
use crate::surface::Canvas;
use crate::{overlay, paint};

/// How often to look at what runs beside while nothing happens.
const IDLE: Duration = Duration::from_millis(100);
/// Numbers that change faster cannot be read.
const READABLE: Duration = Duration::from_millis(250);
/// How long the window's own messages stay.
const NOTICE: Duration = Duration::from_secs(6);

/// The viewer and its window.
pub struct App {
    live_scene: LiveScene,
    viewer: Viewer,
    options: WindowOptions,
    start: Instant,
    open: Option<Open>,
    interface: Interface,
    input: Input,
    picture: Option<Arc<Picture>>,
    notice: Option<(Notice, Instant)>,
    lines: Vec<String>,
    lines_at: Option<Instant>,
    shown: Shown,
    leaving: bool,
    error: Option<WindowError>,
}

/// What there is once the window is open.
struct Open {
    canvas: Canvas,
    egui: egui_winit::State,
    title: String,
    pointer: [f64; 2],
    /// Where the picture is.
    area: Area,
}

/// What was drawn last, and whether something newer waits.
#[derive(Default)]
struct Shown {
    status: Status,
    notice: Option<Notice>,
    lines: Vec<String>,
    /// A drawing was asked for that has not happened.
    asked: bool,
    /// egui wants to lay out again then.
    again: Option<Instant>,
}

impl App {
    /// Without a window yet.
    pub fn new(live_scene: LiveScene, viewer: Viewer, options: WindowOptions) -> Self {
        Self {
            live_scene,
            viewer,
            options,
            start: Instant::now(),
            open: None,
            interface: Interface::new(),
            input: Input::default(),
            picture: None,
            notice: None,
            lines: Vec::new(),
            lines_at: None,
            shown: Shown::default(),
            leaving: false,
            error: None,
        }
    }

    /// Whether the first scene has not failed.
    ///
    /// # Errors
    /// [`WindowError::Viewer`] if it has; later failures are shown over the picture that there is.
    pub fn check(&mut self) -> Result<(), WindowError> {
        self.live_scene.take_failure().map_or(Ok(()), |error| Err(error.into()))
    }

    /// Why the loop ended, if not by people.
    pub fn take_error(&mut self) -> Option<WindowError> {
        self.error.take()
    }

    fn title(&self) -> String {
        format!("{} - raywarp", self.live_scene.name())
    }

    fn open(&mut self, events: &ActiveEventLoop) -> Result<(), WindowError> {
        let title = self.title();
        let canvas = Canvas::new(events, &title, self.options.size, self.options.fullscreen)?;
        let scale = canvas.window.scale_factor() as f32;
        let context = self.interface.context().clone();
        let root = egui::ViewportId::ROOT;
        let egui = egui_winit::State::new(context, root, &*canvas.window, Some(scale), None, None);
        let size = canvas.size();
        let area = Area { first: [0; 2], size: size.map(|side| side as usize) };
        self.open = Some(Open { canvas, egui, title, pointer: [0.0; 2], area });
        self.resize(size);
        self.ask();
        Ok(())
    }

    /// Asks for a drawing.
    fn ask(&mut self) {
        if let Some(open) = &self.open {
            self.shown.asked = true;
            open.canvas.window.request_redraw();
        }
    }

    fn resize(&mut self, [width, height]: [u32; 2]) {
        if width > 0 && height > 0 {
            self.tell(&Event::Resize { width, height });
        }
    }

    /// Hands an event to the core and carries out what it asks for.
    fn tell(&mut self, event: &Event) {
        for outcome in self.viewer.handle(&mut self.live_scene, event) {
            self.carry_out(outcome);
        }
    }

    fn carry_out(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::File(export) => self.notice = Some((self.keep(&export), Instant::now())),
            Outcome::Copy(text) => {
                if let Some(open) = &mut self.open {
                    open.egui.set_clipboard_text(text);
                }
            }
            Outcome::Quit => self.leaving = true,
        }
    }

    /// Makes a file and keeps it; what there is to say.
    fn keep(&mut self, export: &Export) -> Notice {
        let content = match export.make() {
            Ok(content) => content,
            Err(error) => return Notice { text: error.to_string(), error: true },
        };
        match (self.options.keep)(&export.name, &content, self.live_scene.files()) {
            Ok(path) => Notice { text: format!("kept as {}", path.display()), error: false },
            Err(error) => Notice { text: error.to_string(), error: true },
        }
    }

    /// The core's event for one of the window's, if it is not for the interface.
    fn translate(&mut self, event: &WindowEvent) -> Option<Event> {
        let open = self.open.as_mut()?;
        if let WindowEvent::CursorMoved { position, .. } = event {
            open.pointer = [position.x, position.y];
        }
        let over = self.interface.is_over(open.pointer);
        let (window, input) = (&open.canvas.window, &mut self.input);
        match event {
            WindowEvent::CursorMoved { .. } => {
                let place = [0, 1].map(|i| open.pointer[i] - open.area.first[i] as f64);
                input.pointer(place, open.area.size.map(|side| side as u32), over)
            }
            WindowEvent::MouseInput { state, button, .. } => {
                input.button(*button, *state == ElementState::Pressed, over)
            }
            WindowEvent::MouseWheel { delta, .. } => input.wheel(*delta, window.scale_factor(), over),
            WindowEvent::KeyboardInput { event, is_synthetic, .. } => {
                let down = event.state == ElementState::Pressed;
                let typing = self.interface.has_keyboard();
                // A key that is held while the window gets the keyboard was not pressed in it.
                let held_before = *is_synthetic && down;
                input.key(&event.logical_key, down, event.repeat || held_before, typing)
            }
            WindowEvent::ModifiersChanged(modifiers) => {
                input.set_modifiers(modifiers.state());
                None
            }
            WindowEvent::Focused(false) => Some(input.blur()),
            _ => None,
        }
    }

    /// Lets the interface have an event, unless it is a key for the core.
    fn show_interface(&mut self, event: &WindowEvent) {
        let Some(open) = &mut self.open else { return };
        let pressed = matches!(event, WindowEvent::KeyboardInput { event, .. } if event.state == ElementState::Pressed);
        if pressed && !self.interface.has_keyboard() {
            return;
        }
        // Where the pointer goes over the picture alone, nothing of the interface changes.
        let moves = matches!(event, WindowEvent::CursorMoved { .. });
        let was_over = self.interface.is_over(open.pointer);
        let response = open.egui.on_window_event(&open.canvas.window, event);
        let is_over = match event {
            WindowEvent::CursorMoved { position, .. } => self.interface.is_over([position.x, position.y]),
            _ => true,
        };
        if response.repaint && (!moves || was_over || is_over || self.interface.context().is_using_pointer()) {
            self.ask();
        }
    }

    fn draw(&mut self) -> Result<(), WindowError> {
        self.shown.asked = false;
        let Some(open) = &mut self.open else { return Ok(()) };
        let status = self.viewer.status(&self.live_scene);
        let panel = status.panel.then(|| self.viewer.panel(&self.live_scene));
        let notice = self.notice.as_ref().map(|(notice, _)| notice.clone());
        let content = Content {
            status: &status,
            lines: &self.lines,
            panel: panel.as_ref(),
            notice: notice.as_ref(),
            empty: self.picture.is_none(),
        };
        let input = open.egui.take_egui_input(&open.canvas.window);
        let (mut output, events) = self.interface.lay_out(input, &content);
        let area = self.interface.picture_area(open.canvas.size().map(|side| side as usize));
        let is_new = std::mem::replace(&mut open.area, area).size != area.size;
        let (picture, overlay) = (self.picture.as_deref().map(|picture| (picture, area)), self.interface.overlay());
        open.canvas.draw(|pixels, [columns, _]| paint::paint(pixels, columns, picture, &overlay))?;
        open.egui.handle_platform_output(&open.canvas.window, std::mem::take(&mut output.platform_output));
        self.interface.drawn(&output);

        let delay = output.viewport_output.values().map(|viewport| viewport.repaint_delay).min();
        self.shown.again = delay.and_then(|delay| Instant::now().checked_add(delay));
        (self.shown.status, self.shown.notice, self.shown.lines) = (status, notice, self.lines.clone());
        if is_new {
            self.resize(area.size.map(|side| side as u32));
        }
        for event in &events {
            self.tell(event);
            self.ask();
        }
        Ok(())
    }

    /// One turn: a frame of the core, and a drawing if anything is new.
    fn turn(&mut self) -> Result<(), WindowError> {
        // What was rendered is shown first: Wayland asks for no more drawings than the screen can show.
        if self.shown.asked {
            self.live_scene.poll();
        } else if let Some(picture) = self.viewer.frame(&mut self.live_scene, self.start.elapsed())? {
            self.picture = Some(picture);
            self.ask();
        }
        self.check()?;
        self.notice.take_if(|(_, since)| since.elapsed() > NOTICE);
        let status = self.viewer.status(&self.live_scene);
        self.refresh_lines(&status);
        let notice = self.notice.as_ref().map(|(notice, _)| notice);
        let due = self.shown.again.is_some_and(|again| again <= Instant::now());
        if !self.shown.asked && (due || self.shown.is_old(&status, notice, &self.lines)) {
            self.ask();
        }
        self.refresh_title();
        Ok(())
    }

    fn refresh_lines(&mut self, status: &Status) {
        let old = self.lines_at.is_none_or(|at| at.elapsed() >= READABLE);
        // The last numbers are the ones that stay.
        if old || status.settled != self.shown.status.settled {
            self.lines = overlay::lines(status);
            self.lines_at = Some(Instant::now());
        }
    }

    fn refresh_title(&mut self) {
        let title = self.title();
        if let Some(open) = self.open.as_mut().filter(|open| open.title != title) {
            open.canvas.window.set_title(&title);
            open.title = title;
        }
    }

    fn wait(&self) -> ControlFlow {
        if !self.shown.asked && self.viewer.wants_frame(&self.live_scene) {
            return ControlFlow::Poll;
        }
        let idle = Instant::now() + IDLE;
        ControlFlow::WaitUntil(self.shown.again.map_or(idle, |again| again.min(idle)))
    }

    fn end_with(&mut self, result: Result<(), WindowError>, events: &ActiveEventLoop) {
        if let Err(error) = result {
            self.error.get_or_insert(error);
            events.exit();
        }
    }
}

impl Shown {
    /// Whether what was drawn is no longer what is.
    fn is_old(&self, status: &Status, notice: Option<&Notice>, lines: &[String]) -> bool {
        // Numbers are in the lines; a picture asks for its drawing itself.
        let apart = |status: &Status| Status {
            frame_ms: 0.0,
            kernel_ms: 0.0,
            mrays_per_s: None,
            samples: 0,
            traced: [0; 2],
            ..status.clone()
        };
        self.lines != lines || self.notice.as_ref() != notice || apart(&self.status) != apart(status)
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_none() {
            let opened = self.open(events);
            self.end_with(opened, events);
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested => return events.exit(),
            WindowEvent::RedrawRequested => {
                let drawn = self.draw();
                return self.end_with(drawn, events);
            }
            // The picture's part of it is known once it is laid out.
            WindowEvent::Resized(_) => self.ask(),
            _ => {}
        }
        self.show_interface(&event);
        if let Some(event) = self.translate(&event) {
            self.tell(&event);
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let turned = self.turn();
        self.end_with(turned, events);
        events.set_control_flow(self.wait());
        if self.leaving {
            events.exit();
        }
    }
}
