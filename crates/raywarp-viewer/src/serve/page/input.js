// Pointer, wheel, touch and keys to the server's events.

const BUTTONS = ["left", "middle", "right"];
const PIXELS_A_NOTCH = 100;
const LINES_A_NOTCH = 3;
// A pinch on a touch pad comes as a wheel with Ctrl, in much smaller steps.
const PINCH_A_NOTCH = 10;
// Notches for fingers twice as far apart.
const NOTCHES_A_DOUBLING = 6;
const NAMES = { esc: "escape", space: " ", left: "arrowleft", right: "arrowright", up: "arrowup", down: "arrowdown" };

/// Listens on a canvas and the window. `on.event(event, time, moves)` takes each event; `moves` says that a picture
/// should follow; `on.isBehind()` whether the network is.
export class Input {
  constructor(canvas, on) {
    this.canvas = canvas;
    this.on = on;
    this.used = new Set();
    this.keys = new Map();
    this.buttons = new Map();
    this.fingers = new Map();
    this.pinch = null;
    this.listen();
  }

  /// The keys of the help: for these the browser's own reaction is held back.
  setHelp(groups) {
    this.used = new Set(groups.flatMap(([, lines]) => lines.flatMap(([keys]) => namesIn(keys))));
  }

  listen() {
    const { canvas } = this;
    const also = { passive: false };
    canvas.addEventListener("pointerdown", (event) => this.pointerDown(event));
    canvas.addEventListener("pointermove", (event) => this.pointerMove(event));
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) {
      canvas.addEventListener(name, (event) => this.pointerUp(event));
    }
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => this.wheel(event), also);
    addEventListener("keydown", (event) => this.keyDown(event));
    addEventListener("keyup", (event) => this.keyUp(event));
    addEventListener("blur", () => this.release());
    document.addEventListener("visibilitychange", () => this.release());
  }

  send(event, time, moves = false) {
    this.on.event(event, time, moves);
  }

  /// A place on the picture, in shares of its sides: it may be narrower or lower than the canvas.
  point(x, y) {
    const box = this.canvas.getBoundingClientRect();
    const scale = Math.min(box.width / this.canvas.width, box.height / this.canvas.height);
    const [width, height] = [this.canvas.width * scale, this.canvas.height * scale];
    const [left, top] = [box.left + (box.width - width) / 2, box.top + (box.height - height) / 2];
    return { kind: "pointer", x: (x - left) / width, y: (y - top) / height };
  }

  button(button, down, event) {
    this.send({ kind: "button", button, down, modifiers: modifiers(event) }, event.timeStamp);
  }

  pointerDown(event) {
    this.canvas.focus({ preventScroll: true });
    event.preventDefault();
    this.capture(event.pointerId);
    if (event.pointerType === "touch") return this.fingerDown(event);
    // One event for the first button of several; the others come as moves.
    return this.follow(event);
  }

  capture(id) {
    try {
      this.canvas.setPointerCapture(id);
    } catch {
      // The pointer has gone already.
    }
  }

  pointerMove(event) {
    if (event.pointerType === "touch") return this.fingerMove(event);
    if (this.on.isBehind() && event.buttons === 0) return undefined;
    return this.follow(event);
  }

  /// Sends the place, and each button that has changed.
  follow(event) {
    this.send(this.point(event.clientX, event.clientY), event.timeStamp, event.buttons !== 0);
    // `buttons` counts right as 2 and middle as 4.
    const held = { left: event.buttons & 1, right: event.buttons & 2, middle: event.buttons & 4 };
    for (const button of BUTTONS) {
      const down = held[button] !== 0;
      if (down === this.buttons.has(button)) continue;
      if (down) this.buttons.set(button, true);
      else this.buttons.delete(button);
      this.button(button, down, event);
    }
  }

  pointerUp(event) {
    if (event.pointerType === "touch") return this.fingerUp(event);
    return event.type === "pointerup" ? this.follow(event) : this.releaseButtons(event);
  }

  releaseButtons(event) {
    for (const button of [...this.buttons.keys()]) {
      this.buttons.delete(button);
      this.button(button, false, event);
    }
  }

  /// One finger is the left button, two are the middle one and the wheel.
  fingerDown(event) {
    this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (this.fingers.size === 1) {
      this.send(this.point(event.clientX, event.clientY), event.timeStamp);
      this.press("left", event);
    } else if (this.fingers.size === 2) {
      this.releaseButtons(event);
      const { x, y, apart } = this.pair();
      this.pinch = apart;
      this.send(this.point(x, y), event.timeStamp);
      this.press("middle", event);
    }
  }

  press(button, event) {
    this.buttons.set(button, true);
    this.button(button, true, event);
  }

  fingerMove(event) {
    if (!this.fingers.has(event.pointerId)) return;
    this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (this.pinch === null) {
      if (this.fingers.size === 1) this.send(this.point(event.clientX, event.clientY), event.timeStamp, true);
      return;
    }
    const { x, y, apart } = this.pair();
    this.send(this.point(x, y), event.timeStamp, true);
    const notches = NOTCHES_A_DOUBLING * Math.log2(apart / this.pinch);
    this.pinch = apart;
    if (notches !== 0) this.send({ kind: "wheel", notches }, event.timeStamp, true);
  }

  fingerUp(event) {
    if (!this.fingers.delete(event.pointerId)) return;
    this.releaseButtons(event);
    // The finger that stays after a pinch does nothing until it is lifted.
    if (this.fingers.size < 2) this.pinch = null;
    if (this.fingers.size > 0) this.fingers.clear();
  }

  pair() {
    const [[ax, ay], [bx, by]] = [...this.fingers.values()];
    return { x: (ax + bx) / 2, y: (ay + by) / 2, apart: Math.max(Math.hypot(ax - bx, ay - by), 1) };
  }

  wheel(event) {
    event.preventDefault();
    const unit = event.ctrlKey ? PINCH_A_NOTCH : PIXELS_A_NOTCH;
    const divisor = [unit, LINES_A_NOTCH, 1][event.deltaMode] ?? unit;
    if (event.deltaY !== 0) this.send({ kind: "wheel", notches: -event.deltaY / divisor }, event.timeStamp, true);
  }

  keyDown(event) {
    if (isField(event.target) || event.isComposing) return;
    const uses = this.uses(event);
    const chord = event.ctrlKey || event.metaKey;
    // Without Ctrl any key may be of use; with it only those of the help, for the others are the browser's.
    if (chord && !uses) return;
    if (chord && event.key.toLowerCase() === "c" && String(getSelection()) !== "") return;
    // Enter and Space work the button that has the focus.
    if (event.target instanceof HTMLButtonElement && (event.key === "Enter" || event.key === " ")) return;
    if (uses) event.preventDefault();
    if (event.repeat) return;
    this.keys.set(event.code, event.key);
    this.send({ kind: "key", key: event.key, down: true, modifiers: modifiers(event) }, event.timeStamp, true);
  }

  /// By the name that it went down with: Shift may have been released in between.
  keyUp(event) {
    const key = this.keys.get(event.code);
    if (key === undefined) return;
    this.keys.delete(event.code);
    this.send({ kind: "key", key, down: false, modifiers: modifiers(event) }, event.timeStamp);
  }

  release() {
    this.keys.clear();
    this.buttons.clear();
    this.fingers.clear();
    this.pinch = null;
    this.send({ kind: "blur" }, performance.now());
  }

  uses(event) {
    const key = event.key.toLowerCase();
    return this.used.has(event.ctrlKey || event.metaKey ? `ctrl+${key}` : key);
  }
}

/// The keys that a line of the help names, "Ctrl+C" as "ctrl+c"; of words such as "drag" no key has the name.
function namesIn(keys) {
  return keys.toLowerCase().split(/[\s,/]+/).filter(Boolean).map((name) => {
    if (name.endsWith("+")) return name;
    const parts = name.split("+");
    const key = NAMES[parts.at(-1)] ?? parts.at(-1);
    return parts.includes("ctrl") ? `ctrl+${key}` : key;
  });
}

function modifiers(event) {
  return { shift: event.shiftKey, ctrl: event.ctrlKey || event.metaKey, alt: event.altKey };
}

function isField(target) {
  return target instanceof HTMLElement && target.matches("input, select, textarea, summary, [contenteditable]");
}
