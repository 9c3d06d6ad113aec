// The side panel, laid out from the server's data.

import { element } from "./words.js";

// What somebody is changing is not overwritten by what the server said a moment ago.
const SETTLING = 500;

/// `on.set(id, value)` and `on.reset(id)` are called for what people do.
export class PanelView {
  constructor(root, on) {
    this.root = root;
    this.on = on;
    this.rows = new Map();
    this.shape = "";
  }

  /// Shows a panel; only values change in place, so that focus and open sections stay.
  show(panel) {
    const shape = JSON.stringify(panel.sections.map((section) =>
      [section.id, section.title, section.rows.map((row) => [row.id, row.label, row.control])]));
    if (shape !== this.shape) {
      this.shape = shape;
      this.build(panel);
    }
    for (const section of panel.sections) {
      let changed = false;
      for (const row of section.rows) {
        this.rows.get(row.id)?.update(row);
        changed ||= row.changed;
      }
      const undo = this.root.querySelector(`.undo[data-reset="${CSS.escape(section.id)}"]`);
      if (undo) undo.dataset.idle = !changed;
    }
  }

  build(panel) {
    const closed = new Set([...this.root.querySelectorAll("details:not([open])")].map((one) => one.dataset.section));
    this.rows.clear();
    const all = element("button", { id: "reset-all", type: "button" }, "Reset all");
    all.onclick = () => this.on.reset("");
    const empty = panel.sections.length === 0 ? [element("p", {}, "There is nothing to change yet.")] : [];
    this.root.replaceChildren(
      element("header", {}, element("h2", {}, "Controls"), all),
      ...empty,
      ...panel.sections.map((section) => this.section(section, !closed.has(section.id))),
    );
  }

  section(section, open) {
    const undo = this.undo(section.id, `Reset ${section.title}`);
    undo.onclick = (event) => {
      event.preventDefault();
      this.on.reset(section.id);
    };
    const details = element("details", { "data-section": section.id },
      element("summary", {}, element("span", {}, section.title), undo),
      ...section.rows.map((row) => this.row(row)));
    details.open = open;
    return details;
  }

  undo(id, words) {
    const undo = element("button", { class: "undo", type: "button", title: words, "aria-label": words }, "↺");
    undo.dataset.reset = id;
    undo.dataset.idle = "true";
    undo.onclick = () => this.on.reset(id);
    return undo;
  }

  row(row) {
    const name = `row-${row.id}`;
    const set = (value) => {
      view.until = performance.now() + SETTLING;
      this.on.set(row.id, value);
    };
    const make = CONTROLS[row.control.kind] ?? CONTROLS.text;
    const control = make({ name, label: row.label, control: row.control, set });
    const undo = this.undo(row.id, `Undo ${row.label}`);
    undo.addEventListener("click", () => (view.until = 0));
    const label = element("label", { class: "label", for: name }, row.control.kind === "action" ? "" : row.label);
    const root = element("div", { class: "row", "data-row": row.id, "data-kind": row.control.kind }, label,
      element("div", { class: `control ${row.control.kind}` }, ...control.parts), undo);
    const view = { until: 0 };
    view.update = (now) => {
      root.dataset.changed = now.changed;
      root.dataset.value = JSON.stringify(now.value);
      undo.dataset.idle = !now.changed;
      if (performance.now() > view.until) return control.show(now.value);
      // What was said meanwhile still holds once the hand is off.
      clearTimeout(view.later);
      view.later = setTimeout(() => view.update(now), SETTLING);
      return undefined;
    };
    this.rows.set(row.id, view);
    return root;
  }
}

/// For each kind of control: its elements, and how to show a value.
const CONTROLS = {
  text({ name }) {
    const output = element("output", { id: name });
    return { parts: [output], show: (value) => (output.textContent = String(value)) };
  },

  flag({ name, set }) {
    const box = element("input", { id: name, type: "checkbox" });
    box.onchange = () => set(box.checked);
    return { parts: [box], show: (value) => (box.checked = value === true) };
  },

  number({ name, label, control, set }) {
    const { min, max } = control;
    const step = control.step > 0 ? control.step : "any";
    const slider = element("input", { id: name, type: "range", min, max, step });
    const number = element("input", { type: "number", min, max, step: "any", "aria-label": label });
    const put = (from, to) => () => {
      const value = Math.min(Math.max(from.valueAsNumber, min), max);
      if (!Number.isFinite(value)) return;
      to.value = shortened(value);
      set(value);
    };
    slider.oninput = put(slider, number);
    number.onchange = put(number, slider);
    return {
      parts: [slider, number],
      show(value) {
        slider.value = value;
        number.value = shortened(value);
      },
    };
  },

  choice({ name, control, set }) {
    const select = element("select", { id: name }, ...control.options.map((text) => element("option", {}, text)));
    select.onchange = () => set(select.value);
    return { parts: [select], show: (value) => (select.value = value) };
  },

  color({ name, label, control, set }) {
    const color = element("input", { id: name, type: "color" });
    const power = element("input",
      { type: "number", min: 0, max: control.max, step: "any", "aria-label": `${label}: brightness` });
    // The brightest channel is 1; kept beside the picker, which rounds.
    let tint = [1, 1, 1];
    const put = () => {
      const brightness = control.max > 1 ? Math.min(Math.max(power.valueAsNumber || 0, 0), control.max) : 1;
      set(tint.map((channel) => channel * brightness));
    };
    color.oninput = () => {
      tint = fromHex(color.value);
      put();
    };
    power.onchange = put;
    return {
      parts: control.max > 1 ? [color, power] : [color],
      show(value) {
        const brightness = control.max > 1 ? Math.max(...value, 0) || 1 : 1;
        tint = value.map((channel) => channel / brightness);
        color.value = toHex(tint);
        power.value = shortened(brightness);
      },
    };
  },

  vector({ name, label, control, set }) {
    const numbers = ["x", "y", "z"].map((axis, index) => element("input", {
      id: index === 0 ? name : `${name}-${axis}`, type: "number", step: control.step > 0 ? control.step : "any",
      "aria-label": `${label} ${axis}`,
    }));
    // As the server has them: what is shown has fewer digits.
    let exact = [0, 0, 0];
    numbers.forEach((number, index) => {
      number.onchange = () => {
        if (!Number.isFinite(number.valueAsNumber)) return;
        exact = exact.with(index, number.valueAsNumber);
        set(exact);
      };
    });
    return {
      parts: numbers,
      show(value) {
        exact = value;
        numbers.forEach((number, index) => (number.value = shortened(value[index])));
      },
    };
  },

  action({ name, label, set }) {
    const button = element("button", { id: name, type: "button", class: "action" }, label);
    button.onclick = () => set(true);
    return { parts: [button], show() {} };
  },
};

/// Single precision has seven digits; fewer are easier to read.
function shortened(value) {
  return String(Number(value.toPrecision(5)));
}

/// From linear channels of 0 to 1 to the browser's sRGB.
function toHex(channels) {
  const byte = (linear) => {
    const x = Math.min(Math.max(linear, 0), 1);
    const encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055;
    return Math.round(255 * encoded).toString(16).padStart(2, "0");
  };
  return `#${channels.map(byte).join("")}`;
}

function fromHex(hex) {
  return [1, 3, 5].map((at) => {
    const x = parseInt(hex.slice(at, at + 2), 16) / 255;
    return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
  });
}
