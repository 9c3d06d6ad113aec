// The viewer in a browser: brings its parts together. `window.raywarp` is for tests and for the curious.

import { Input } from "./input.js";
import { Link } from "./link.js";
import { PanelView } from "./panel.js";
import { kindOf, Picture } from "./picture.js";
import { Stats } from "./stats.js";
import { say, showHelp, showStats, showStatus } from "./words.js";

const FILE = 3;
const MOST_PIXELS = 4096 * 2160;
const LONGEST_SIDE = 4096;
const RESIZE_PAUSE = 120;
const STATS_PAUSE = 250;

const byId = (id) => document.getElementById(id);
const canvas = byId("picture");
const stats = new Stats();
const shared = { stats: stats.read(), status: null, panel: null, link: null, connection: "connecting" };
window.raywarp = shared;
shared.resetStats = () => stats.reset();

// What the server wants shown, until somebody says otherwise with a button.
const overlays = { status: true, help: false, panel: false };
const wanted = { status: null, help: false, panel: false };

const small = matchMedia("(max-width: 560px), (max-height: 420px)");

/// Shows an overlay or hides it. A small window has room for one.
function toggle(name, shown = !overlays[name]) {
  if (shown && small.matches) {
    Object.keys(overlays).filter((other) => other !== name && overlays[other]).forEach((other) => put(other, false));
  }
  put(name, shown);
}

function put(name, shown) {
  overlays[name] = shown;
  byId(name).hidden = !shown || (name === "status" && shared.status === null);
  byId(`toggle-${name}`).setAttribute("aria-pressed", String(shown));
}

function follow(name, shown) {
  if (wanted[name] === shown) return;
  // What the server shows by itself stays folded in a small window.
  const folded = wanted[name] === null && small.matches;
  wanted[name] = shown;
  if (folded) put(name, false);
  else toggle(name, shown);
}

/// A window that becomes small folds what was open, and one that grows again unfolds it.
let folded = small.matches ? ["status"] : [];
small.addEventListener("change", () => {
  const open = Object.keys(overlays).filter((name) => overlays[name]);
  if (small.matches) open.forEach((name) => put(name, false));
  else folded.forEach((name) => put(name, true));
  folded = small.matches ? open : [];
});

/// Pixels of the screen under the canvas, within what the server sends.
function size() {
  const box = canvas.getBoundingClientRect();
  const [width, height] = [box.width, box.height].map((side) => Math.max(Math.round(side * devicePixelRatio), 1));
  const scale = Math.min(1, LONGEST_SIDE / Math.max(width, height), Math.sqrt(MOST_PIXELS / (width * height)));
  return [width, height].map((side) => Math.max(Math.floor(side * scale), 1));
}

const picture = new Picture(canvas, {
  shown(head, isNew) {
    link.send({ type: "ack", frame: head.frame });
    shared.first_picture_ms ??= performance.now();
    if (isNew) stats.drawn(head.mark);
  },
  received: (frame, bytes) => link.send({ type: "received", frame, bytes }),
  failed: (error) => say("notice", `A picture cannot be decoded: ${error.message}`),
});

let file = null;
const TEXTS = {
  status(message) {
    shared.status = message.status;
    shared.link = message.link;
    showStatus(message.status);
    follow("status", message.status.statistics);
    follow("help", message.status.help);
    follow("panel", message.status.panel);
  },
  panel(message) {
    shared.panel = message.panel;
    panel.show(message.panel);
  },
  copy: (message) => copy(message.text),
  file: (message) => (file = message),
};

const link = new Link({
  size,
  hello(message) {
    picture.restart();
    stats.reset();
    input.setHelp(message.help);
    showHelp(message.help);
    shared.hello = message;
    byId("token-form").hidden = true;
    if (document.hidden) link.send({ type: "visible", visible: false });
  },
  text: (message) => TEXTS[message.type]?.(message),
  binary(data) {
    stats.received(data.byteLength);
    if (kindOf(data) === FILE) download(data);
    else picture.take(data);
  },
  state(state, words) {
    shared.connection = state;
    document.body.dataset.connection = state;
    say("connection", state === "refused" ? "" : words);
  },
  token(words) {
    byId("token-form").hidden = false;
    byId("token-words").textContent = words;
    byId("token").focus();
  },
});

const input = new Input(canvas, {
  isBehind: () => link.isBehind,
  event(event, time, moves) {
    if (!link.isOpen) return;
    link.send({ type: "event", event });
    if (moves) link.send({ type: "mark", mark: stats.mark(time) });
  },
});

const panel = new PanelView(byId("panel"), {
  set: (id, value) => link.isOpen && link.send({ type: "event", event: { kind: "set", id, value } }),
  reset: (id) => link.isOpen && link.send({ type: "event", event: { kind: "reset", id } }),
});

function download(data) {
  if (!file) return;
  const address = URL.createObjectURL(new Blob([new Uint8Array(data, 1)], { type: file.media_type }));
  const anchor = document.createElement("a");
  anchor.href = address;
  anchor.download = file.name;
  anchor.click();
  shared.downloaded = { name: file.name, bytes: data.byteLength - 1 };
  file = null;
  setTimeout(() => URL.revokeObjectURL(address), 60_000);
}

/// Over plain HTTP from another machine there is no clipboard: the text is shown instead, selected.
async function copy(text) {
  shared.copied = text;
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    byId("copy").hidden = false;
    byId("copy-text").value = text;
    byId("copy-text").focus();
    byId("copy-text").select();
  }
}

for (const name of ["status", "help", "panel"]) byId(`toggle-${name}`).onclick = () => toggle(name);
byId("close-help").onclick = () => toggle("help", false);
byId("close-copy").onclick = () => {
  byId("copy").hidden = true;
  canvas.focus();
};
byId("token-form").onsubmit = (event) => {
  event.preventDefault();
  link.open(byId("token").value.trim());
};
addEventListener("keydown", (event) => {
  if (event.key !== "Escape") return;
  byId("copy").hidden = true;
  toggle("help", false);
  if (event.target !== canvas && event.target instanceof HTMLElement) event.target.blur();
});

let resizing;
new ResizeObserver(() => {
  clearTimeout(resizing);
  resizing = setTimeout(() => {
    const [width, height] = size();
    if (link.isOpen) link.send({ type: "event", event: { kind: "resize", width, height } });
  }, RESIZE_PAUSE);
}).observe(canvas);

document.addEventListener("visibilitychange", () => link.send({ type: "visible", visible: !document.hidden }));

setInterval(() => {
  shared.stats = stats.read();
  showStats(shared.stats, shared.link);
}, STATS_PAUSE);
canvas.focus({ preventScroll: true });
