//! The whole interface without a window: laid out, drawn, clicked on. With RAYWARP_TEST_PICTURES=FOLDER its pictures
//! are kept there for people to look at.

use egui::{pos2, vec2, Event as Input, Modifiers, PointerButton, Pos2, RawInput, Rect};
use raywarp::image::{png, Rgb8};

use crate::interface::{Content, Interface};
use crate::{overlay, paint};
use raywarp_viewer::live::{Control, Event, Legend, Notice, Panel, Picture, Row, Section, Status, Value};

const SIZE: [usize; 2] = [900, 640];

/// A window that is not there.
struct Window {
    interface: Interface,
    status: Status,
    panel: Panel,
    notice: Option<Notice>,
    scale: f32,
}

impl Window {
    fn new(status: Status, panel: Panel) -> Self {
        Self { interface: Interface::new(), status, panel, notice: None, scale: 1.0 }
    }

    /// Until everything is in its place: egui needs the sizes of the last layout for that of the next.
    fn settle(&mut self) {
        (0..4).for_each(|_| drop(self.lay_out(Vec::new())));
    }

    fn lay_out(&mut self, input: Vec<Input>) -> Vec<Event> {
        let mut raw = RawInput { events: input, focused: true, ..RawInput::default() };
        let size = vec2(SIZE[0] as f32, SIZE[1] as f32) / self.scale;
        raw.screen_rect = Some(Rect::from_min_size(Pos2::ZERO, size));
        raw.viewports.entry(raw.viewport_id).or_default().native_pixels_per_point = Some(self.scale);
        let content = Content {
            status: &self.status,
            lines: &overlay::lines(&self.status),
            panel: self.status.panel.then_some(&self.panel),
            notice: self.notice.as_ref(),
            empty: false,
        };
        self.interface.lay_out(raw, &content).1
    }

    fn click(&mut self, at: Pos2) -> Vec<Event> {
        let button = |pressed| {
            let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
            Input::PointerButton { pos: at, button, pressed, modifiers }
        };
        self.lay_out(vec![Input::PointerMoved(at)]);
        self.lay_out(vec![button(true)]);
        self.lay_out(vec![button(false)])
    }

    fn pixels(&self, name: &str) -> Vec<u32> {
        let [width, height] = SIZE;
        let mut pixels = vec![0; width * height];
        let area = self.interface.picture_area(SIZE);
        paint::paint(&mut pixels, width, Some((&ramp([45, 32]), area)), &self.interface.overlay());
        if let Some(folder) = std::env::var_os("RAYWARP_TEST_PICTURES") {
            let rgb = pixels.iter().map(|pixel| [(pixel >> 16) as u8, (pixel >> 8) as u8, *pixel as u8]).collect();
            let bytes = png::encode(&Rgb8 { width: width as u32, height: height as u32, pixels: rgb }).unwrap();
            std::fs::write(std::path::Path::new(&folder).join(name), bytes).unwrap();
        }
        pixels
    }
}

/// Blue to the right, green downwards, so that every part of the window has its own colour.
fn ramp([width, height]: [u32; 2]) -> Picture {
    let pixel = |i: u32| [60, (255 * (i / width) / height) as u8, (255 * (i % width) / width) as u8, 255];
    Picture { size: [width, height], rgba: (0..width * height).flat_map(pixel).collect(), settled: false }
}

fn row(id: &str, value: Value, control: Control) -> Row {
    Row { id: id.to_owned(), label: id.replace('_', " "), value, control, changed: false }
}

/// A row of each kind, and values that do not fit their control.
fn panel() -> Panel {
    let text = |text: &str| Value::Text(text.to_owned());
    let options = ["picture", "normals", "depth"].map(str::to_owned).to_vec();
    let number = |min, max, step| Control::Number { min, max, step };
    let camera = vec![
        row("eye", Value::Triple([1.25, -3.5, 1234.5]), Control::Vector { step: 0.1 }),
        row("field_of_view", Value::Number(45.0), number(1.0, 170.0, 1.0)),
        row("a_label_that_is_far_too_long_for_its_column", Value::Number(1e-3), number(1e-4, 1e4, 0.0)),
        row("view", text("normals"), Control::Choice { options }),
        row("fit", Value::Flag(false), Control::Action),
    ];
    let light = vec![
        row("shadows", Value::Flag(true), Control::Flag),
        row("color", Value::Triple([4.0, 2.0, 0.5]), Control::Color { max: 10.0 }),
        row("diffuse", Value::Triple([0.1, 0.2, 0.9]), Control::Color { max: 1.0 }),
        row("file", text("a name of some length that has to be broken.glb"), Control::Text),
        row("wrong", text("no number"), number(0.0, 1.0, 0.1)),
        row("empty_range", Value::Number(3.0), number(f32::NAN, f32::INFINITY, 0.0)),
        row("not_finite", Value::Triple([f32::NAN, f32::INFINITY, 0.0]), Control::Color { max: 1.0 }),
    ];
    let section = |id: &str, title: &str, rows| Section { id: id.to_owned(), title: title.to_owned(), rows };
    Panel { sections: vec![section("camera", "Camera", camera), section("light", "Light and shading", light)] }
}

fn status() -> Status {
    Status {
        scene: "scene.glb".to_owned(),
        device: "NVIDIA H200 (CUDA 0)".to_owned(),
        accel: "bvh8, medium".to_owned(),
        triangles: 262_267,
        size: [900, 640],
        traced: [450, 320],
        frame_ms: 12.5,
        kernel_ms: 10.1,
        mrays_per_s: Some(3400.0),
        samples: 7,
        spp: 64,
        view: "normals".to_owned(),
        ..Status::default()
    }
}

/// A place where a pixel is not as without the interface.
fn differs(pixels: &[u32], plain: &[u32], within: Rect) -> bool {
    let inside = |i: usize| within.contains(pos2((i % SIZE[0]) as f32, (i / SIZE[0]) as f32));
    pixels.iter().zip(plain).enumerate().any(|(i, (a, b))| a != b && inside(i))
}

fn without_interface() -> Vec<u32> {
    let mut pixels = vec![0; SIZE[0] * SIZE[1]];
    let interface = Interface::new();
    let ramp = ramp([45, 32]);
    let picture = Some((&ramp, interface.picture_area(SIZE)));
    paint::paint(&mut pixels, SIZE[0], picture, &interface.overlay());
    pixels
}

#[test]
fn the_lines_say_what_is_measured() {
    let expected = [
        "12.5 ms  kernels 10.1 ms  3400 Mrays/s",
        "7/64 samples  900x640  traced 450x320",
        "262267 triangles  bvh8, medium  showing normals",
        "NVIDIA H200 (CUDA 0)",
    ];
    assert_eq!(overlay::lines(&status()), expected);
    let moving = Status { samples: 1, ..status() };
    assert_eq!(overlay::lines(&moving)[0], "12.5 ms  80 FPS  kernels 10.1 ms  3400 Mrays/s");
    assert_eq!(overlay::lines(&Status::default())[0], "0.0 ms");
}

#[test]
fn each_part_is_where_it_belongs_and_nothing_else_is_touched() {
    let colors = (0..=255u8).step_by(17).map(|i| [i, 0, 255 - i]).collect();
    let legend = Legend { title: "tests a pixel".to_owned(), low: "0".to_owned(), high: "300".to_owned(), colors };
    let notice = Some(Notice { text: "cannot read scene.glb: it is gone".to_owned(), error: true });
    let pick = vec![("triangle".to_owned(), "17".to_owned()), ("distance".to_owned(), "2.5".to_owned())];
    let told = Status { legend: Some(legend), notice, pick, busy: Some("building".to_owned()), ..status() };
    let mut window = Window::new(told, panel());
    window.notice = Some(Notice { text: "kept as view.png".to_owned(), error: false });
    window.settle();
    let (pixels, plain) = (window.pixels("overlay.png"), without_interface());
    let part = |x: f32, y: f32, w: f32, h: f32| differs(&pixels, &plain, Rect::from_min_size(pos2(x, y), vec2(w, h)));
    assert!(part(8.0, 8.0, 300.0, 120.0), "status and pick");
    assert!(part(8.0, 560.0, 250.0, 70.0), "legend");
    assert!(part(350.0, 560.0, 200.0, 70.0), "notices");
    assert!(!part(500.0, 0.0, 399.0, 540.0) && !part(0.0, 200.0, 300.0, 300.0), "the picture is free");
    // The bar ends in the last colour of its scale.
    assert!(pixels.contains(&0xff0000) && pixels.contains(&0x0000ff), "the bar of colours");
}

#[test]
fn help_and_panel_are_shown_when_asked_for() {
    let mut window = Window::new(Status { panel: true, help: true, ..status() }, panel());
    window.panel.sections[0].rows[1].changed = true;
    window.panel.sections[1].rows[1].changed = true;
    for (scale, name) in [(1.0, "panel.png"), (1.5, "panel-150.png")] {
        window.scale = scale;
        window.settle();
        let pixels = window.pixels(name);
        let centre = Rect::from_center_size(pos2(400.0, 320.0), vec2(100.0, 50.0));
        assert!(differs(&pixels, &without_interface(), centre), "help");
        assert!(window.interface.is_over([880.0, 300.0]) && !window.interface.is_over([100.0, 300.0]), "panel");
    }
}

#[test]
fn the_panel_is_beside_the_picture_and_below_it_where_the_window_is_narrow() {
    let mut window = Window::new(Status { panel: true, ..status() }, panel());
    window.settle();
    let whole = Interface::new().picture_area(SIZE);
    assert_eq!((whole.first, whole.size), ([0, 0], SIZE));
    let beside = window.interface.picture_area(SIZE);
    assert!(beside.size[0] < 640 && beside.size[0] > 440 && beside.size[1] == SIZE[1], "{beside:?}");
    assert!(!window.interface.is_over([beside.size[0] as f64 - 2.0, 300.0]));
    assert!(window.interface.is_over([beside.size[0] as f64 + 8.0, 300.0]));
    // The ramp ends where the panel begins.
    let (pixels, last) = (window.pixels("panel-beside.png"), 320 * SIZE[0] + beside.size[0] - 1);
    assert!(pixels[last] & 255 > 240, "{:x}", pixels[last]);

    window.scale = 2.0;
    window.settle();
    let above = window.interface.picture_area(SIZE);
    assert!(above.size[0] == SIZE[0] && (320..600).contains(&above.size[1]), "{above:?}");
    window.pixels("panel-below.png");
}

#[test]
fn the_pointer_goes_through_lines_and_help() {
    let mut window = Window::new(Status { help: true, ..status() }, panel());
    window.settle();
    assert!(!window.interface.is_over([20.0, 20.0]) && !window.interface.is_over([450.0, 320.0]));
}

/// Clicks on a grid all over a panel, and collects what comes of it.
fn events_of(rows: Vec<Row>) -> Vec<Event> {
    let section = Section { id: "section".to_owned(), title: "Section".to_owned(), rows };
    let mut window = Window::new(Status { panel: true, ..status() }, Panel { sections: vec![section] });
    window.settle();
    let mut events = Vec::new();
    for y in (0..24).map(|i| 6.0 + 6.0 * i as f32) {
        for x in (0..52).map(|i| 588.0 + 6.0 * i as f32) {
            for event in window.click(pos2(x, y)) {
                if !events.contains(&event) {
                    events.push(event);
                }
            }
        }
    }
    events
}

#[test]
fn what_is_clicked_is_told() {
    let mut flag = row("flag", Value::Flag(true), Control::Flag);
    flag.changed = true;
    let events = events_of(vec![flag, row("fit", Value::Flag(false), Control::Action)]);
    let reset = |id: &str| Event::Reset { id: id.to_owned() };
    let set = |id: &str, value| Event::Set { id: id.to_owned(), value };
    for expected in
        [set("flag", Value::Flag(false)), set("fit", Value::Flag(true)), reset("flag"), reset("section"), reset("")]
    {
        assert!(events.contains(&expected), "{expected:?} is not in {events:?}");
    }
    assert_eq!(events.len(), 5, "{events:?}");
}

#[test]
fn sliders_stay_in_their_range() {
    let number = Control::Number { min: 2.0, max: 10.0, step: 2.0 };
    let events = events_of(vec![row("depth", Value::Number(6.0), number)]);
    assert!(events.len() >= 3, "{events:?}");
    for event in events {
        let Event::Set { value: Value::Number(value), .. } = event else { panic!("{event:?}") };
        assert!([2.0, 4.0, 6.0, 8.0, 10.0].contains(&value), "{value}");
    }
}

#[test]
fn nothing_changes_by_itself() {
    let mut window = Window::new(Status { panel: true, ..status() }, panel());
    for _ in 0..5 {
        assert_eq!(window.lay_out(vec![Input::PointerMoved(pos2(800.0, 200.0))]), []);
    }
}
