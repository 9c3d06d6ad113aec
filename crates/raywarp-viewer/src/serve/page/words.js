// The words over the picture: status, help, legend, messages.

/// An element with attributes and children, which are elements or texts.
export function element(name, attributes, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

const byId = (id) => document.getElementById(id);

function put(id, text) {
  const place = byId(id);
  if (place.textContent !== text) place.textContent = text;
}

/// Shows a text, or hides its place where there is none.
export function say(id, text) {
  put(id, text ?? "");
  byId(id).hidden = !text;
}

const count = new Intl.NumberFormat("en");
const times = ([width, height]) => `${width} × ${height}`;

/// What the server says about the viewer.
export function showStatus(status) {
  const rows = [
    ["stat-scene", `${status.scene} · ${count.format(status.triangles)} triangles`],
    ["stat-frame", `${status.frame_ms.toFixed(1)} ms, kernels ${status.kernel_ms.toFixed(1)} ms`],
    ["stat-rays", status.mrays_per_s === null ? "" : `${count.format(Math.round(status.mrays_per_s))} Mrays/s`],
    ["stat-samples", `${status.samples} of ${status.spp}${status.settled ? ", done" : ""}`],
    ["stat-size", `${times(status.size)}${different(status) ? `, traced ${times(status.traced)}` : ""}`],
    ["stat-view", status.view + (status.reference ? ", reference" : "")],
    ["stat-device", [status.device, status.accel].filter(Boolean).join(", ")],
  ];
  for (const [id, text] of rows) {
    put(id, text);
    byId(id).parentElement.hidden = id !== "stat-scene" && text === "";
  }
  say("busy", status.busy);
  say("notice", status.notice?.text);
  byId("notice").classList.toggle("error", status.notice?.error === true);
  showLegend(status.legend);
  showPick(status.pick);
  document.title = `${status.scene} · raywarp`;
}

function different(status) {
  return status.size[0] !== status.traced[0] || status.size[1] !== status.traced[1];
}

/// What the page measures, and how pictures are sent.
export function showStats(stats, link) {
  const { median, p95 } = stats.latency_ms;
  const rate = stats.bits_per_s / 1e6;
  put("stat-fps", `${stats.fps} fps`);
  put("stat-latency", median === null ? "–" : `${median.toFixed(0)} ms, 95 % below ${p95.toFixed(0)} ms`);
  const parts = [`${rate.toFixed(rate < 10 ? 1 : 0)} Mbit/s`];
  if (link) {
    parts.push(`quality ${link.quality}`);
    if (link.scale < 1) parts.push(`${Math.round(100 * link.scale)} % size`);
    if (link.viewers > 1) parts.push(`${link.viewers} viewers`);
  }
  put("stat-stream", parts.join(", "));
}

/// Every key and what it does.
export function showHelp(groups) {
  byId("help-groups").replaceChildren(...groups.map(([title, lines]) =>
    element("section", {}, element("h3", {}, title), element("dl", {}, ...lines.flatMap(([keys, what]) =>
      [element("dt", {}, element("kbd", {}, keys)), element("dd", {}, what)])))));
}

function showLegend(legend) {
  byId("legend").hidden = !legend;
  if (!legend) return;
  put("legend-title", legend.title);
  put("legend-low", legend.low);
  put("legend-high", legend.high);
  const bar = byId("legend-bar");
  const { colors } = legend;
  bar.hidden = colors.length === 0;
  const key = JSON.stringify(colors);
  if (bar.hidden || bar.dataset.colors === key) return;
  bar.dataset.colors = key;
  bar.width = colors.length;
  const context = bar.getContext("2d");
  const pixels = context.createImageData(colors.length, 1);
  pixels.data.set(colors.flatMap((color) => [...color, 255]));
  context.putImageData(pixels, 0, 0);
}

let picked = "";

function showPick(lines) {
  const key = JSON.stringify(lines);
  if (key === picked) return;
  picked = key;
  byId("pick").hidden = lines.length === 0;
  byId("pick").replaceChildren(...lines.flatMap(([what, value]) =>
    [element("dt", {}, what), element("dd", {}, value)]));
}
