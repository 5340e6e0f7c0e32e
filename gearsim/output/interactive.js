// The views of a page: their controls around plotly.js. Nothing is fetched. interactive_traces.js and
// interactive_caps.js stand before it.

const ARRAYS = { f4: Float32Array, u2: Uint16Array, u4: Uint32Array };
const LAMP = 1e4; // how far off the light is, in plotly's own lengths
const SIZE = 1.6; // of what is shown, across, in plotly's own lengths
const FIELD = Math.PI / 8; // half of plotly's angle of view
const LOOKED_AT = 2000; // points of a shape, to find how far the eye is to be
const ROOM = 1.12; // about what is shown, for the axes' texts

function unpacked(array) {
  const bytes = Uint8Array.from(atob(array.data), (c) => c.charCodeAt(0));
  return new ARRAYS[array.type](bytes.buffer);
}

function add(parent, tag, text, attributes) {
  const made = parent.appendChild(document.createElement(tag));
  if (text) made.textContent = text;
  for (const [name, value] of Object.entries(attributes || {})) made.setAttribute(name, value);
  return made;
}

function mesh(shape, number) {
  const colours = {};
  for (const [name, array] of Object.entries(shape.colours)) colours[name] = unpacked(array);
  return { ...shape, number, points: unpacked(shape.points), triangles: unpacked(shape.triangles), colours };
}

// The corners of the box about all shapes, and its edges as shares of its diagonal.
function box(shapes) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const { points } of shapes)
    for (let i = 0; i < points.length; i++) {
      low[i % 3] = Math.min(low[i % 3], points[i]);
      high[i % 3] = Math.max(high[i % 3], points[i]);
    }
  const room = 2e-3 * Math.hypot(...low.map((x, k) => high[k] - x)); // plotly.js leaves out what lies in its faces
  for (let k = 0; k < 3; k++) [low[k], high[k]] = [low[k] - room, high[k] + room];
  const diagonal = Math.hypot(...low.map((x, k) => high[k] - x));
  return { low, high, diagonal, share: low.map((x, k) => (high[k] - x) / diagonal) };
}

// Some of the points in plotly's own lengths, from the box's middle, along the rows of a frame.
function inFrame(points, { low, high, diagonal }, frame) {
  const out = [], step = 3 * Math.ceil(points.length / 3 / LOOKED_AT);
  for (let i = 0; i < points.length; i += step) {
    const at = [0, 1, 2].map((k) => (SIZE * (points[i + k] - (low[k] + high[k]) / 2)) / diagonal);
    out.push(frame.map((row) => dot(row, at)));
  }
  return out;
}

const largest = (list, of) => list.reduce((most, one) => Math.max(most, of(one)), -Infinity);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((x) => x / Math.sqrt(dot(a, a)));

const digits = (x) => Number(x.toPrecision(3)).toString();

function drawLegend(parent, legend, missing, capped) {
  parent.replaceChildren();
  const swatch = (colour, text) => {
    const entry = add(parent, "span");
    add(entry, "span", "", { class: "swatch", style: `background:${colour}` });
    entry.append(text);
  };
  if (capped) swatch(CUT, "cut face");
  if (!legend) return;
  if (legend.classes) return legend.classes.forEach(([name, colour]) => swatch(colour, name));
  const ramp = add(parent, "div", "", { class: "ramp" });
  add(ramp, "span", `${legend.name} [${legend.unit}]`);
  add(ramp, "i", "", { style: `background:linear-gradient(to right,${legend.scale.join(",")})` });
  const ends = add(ramp, "b");
  for (const share of [0, 0.25, 0.5, 0.75, 1])
    add(ends, "span", digits(legend.low + share * (legend.high - legend.low)));
  swatch(missing, "no value");
}

function live(root) {
  const data = JSON.parse(root.querySelector('script[type="application/json"]').textContent);
  const [controls, page, key] = ["controls", "scene", "legend"].map((name) => root.querySelector(`.${name}`));
  const shapes = data.shapes.map(mesh), extent = box(shapes);
  const legends = [...data.colourings, null];
  const hidden = new Set(shapes.filter((shape) => !shape.shown));
  const state = { legend: legends[0], hidden, axis: -1, share: 1, side: 1 };
  const [x, y, z] = data.way.map((along, k) => LAMP * (along + 0.5 * data.up[k]));
  const fixed = { missing: data.missing, light: { x, y, z } };
  let queue = Promise.resolve(), due = false;

  // Where the eye is when nothing was turned: before the middle of what it sees, just so far that it sees all.
  function camera() {
    const way = data.way, right = unit(cross(data.up, way)), top = cross(way, right);
    const frame = [right, top, way], slope = Math.tan(FIELD) / ROOM, aspect = page.clientWidth / page.clientHeight;
    const seen = shapes.flatMap((shape) => inFrame(shape.points, extent, frame));
    const middle = [0, 1].map((k) => (largest(seen, (p) => p[k]) - largest(seen, (p) => -p[k])) / 2);
    const across = (p) => Math.max(Math.abs(p[1] - middle[1]), Math.abs(p[0] - middle[0]) / aspect);
    const far = largest(seen, (p) => p[2] + across(p) / slope);
    const at = (depth) => AXES.map((_, k) => middle[0] * right[k] + middle[1] * top[k] + depth * way[k]);
    const named = (v) => ({ x: v[0], y: v[1], z: v[2] });
    return { eye: named(at(far)), up: named(data.up), center: named(at(0)) };
  }

  function layout() {
    const ink = getComputedStyle(root).color, scene = { aspectmode: "manual", aspectratio: {}, dragmode: "orbit" };
    AXES.forEach((axis, k) => {
      scene.aspectratio[axis] = SIZE * extent.share[k];
      scene[`${axis}axis`] = {
        title: { text: `${axis} [mm]` }, range: [extent.low[k], extent.high[k]], color: ink,
        gridcolor: "rgba(128,128,128,0.35)", zeroline: false, showspikes: false, showbackground: false,
        nticks: Math.max(2, Math.round(9 * extent.share[k])),
      };
    });
    return {
      scene: { ...scene, camera: page.layout ? page.layout.scene.camera : camera() },
      margin: { l: 0, r: 0, t: 0, b: 0 }, showlegend: false, paper_bgcolor: "rgba(0,0,0,0)", font: { color: ink },
    };
  }

  function plane() {
    if (state.axis < 0) return null;
    const [low, high] = [extent.low[state.axis], extent.high[state.axis]];
    return { axis: state.axis, at: low + state.share * (high - low), side: state.side };
  }

  // One thing after the other: told anew while it works, plotly.js mixes colours of both.
  function draw() {
    if (!due) {
      due = true;
      queue = queue.then(() => ((due = false), render()));
    }
    return queue;
  }

  function look(eyed) {
    queue = queue.then(() => Plotly.relayout(page, { "scene.camera": eyed() }));
  }

  async function render() {
    const shown = shapes.filter((shape) => !state.hidden.has(shape));
    const cut = plane(), caps = cut ? capTraces(shapes, shown, cut, extent.diagonal) : [];
    const skins = shown.flatMap((shape) => traces(shape, state.legend, cut, fixed));
    drawLegend(key, state.legend, data.missing, caps.length);
    await Plotly.react(page, [...skins, ...caps], layout(), { displayModeBar: false, responsive: true });
  }

  const group = (text) => {
    const made = add(controls, "span");
    if (text) add(made, "span", text);
    return made;
  };

  function button(parent, text, does) {
    const made = add(parent, "button", text, { type: "button" });
    made.addEventListener("click", () => does(made));
    return made;
  }

  function nearer(factor) {
    const now = page.layout.scene.camera, eye = {};
    for (const axis of AXES) eye[axis] = now.center[axis] + factor * (now.eye[axis] - now.center[axis]);
    return { ...now, eye };
  }

  function colourButtons() {
    const colours = group("Colours:"), pressed = [];
    for (const legend of legends)
      pressed.push(button(colours, legend ? legend.name : "plain", (self) => {
        state.legend = legend;
        pressed.forEach((one) => one.setAttribute("aria-pressed", one === self));
        draw();
      }));
    pressed.forEach((one, k) => one.setAttribute("aria-pressed", k === 0));
  }

  function shapeBoxes() {
    const list = group("Show:");
    for (const shape of shapes) {
      const label = add(list, "label"), tick = add(label, "input", "", { type: "checkbox" });
      tick.checked = shape.shown;
      label.append(shape.name);
      tick.addEventListener("change", () => {
        if (tick.checked) state.hidden.delete(shape);
        else state.hidden.add(shape);
        draw();
      });
    }
  }

  function sectionPlane() {
    const section = group("Section:"), select = add(section, "select", "", { "aria-label": "section across" });
    ["none", "across x", "across y", "across z"].forEach((text, k) => add(select, "option", text, { value: k - 1 }));
    const range = { type: "range", min: 0, max: 1, step: "any", value: 1, "aria-label": "section at" };
    const slider = add(section, "input", "", range);
    const told = add(section, "span"), turn = button(section, "other side", () => ((state.side *= -1), change()));
    function change() {
      [state.axis, state.share] = [Number(select.value), Number(slider.value)];
      const cut = plane();
      slider.disabled = turn.disabled = !cut;
      told.textContent = cut ? `${AXES[cut.axis]} = ${cut.at.toFixed(2)} mm` : "";
      draw();
    }
    slider.disabled = turn.disabled = true;
    select.addEventListener("change", change);
    slider.addEventListener("input", change);
  }

  function eyeButtons() {
    const eye = group("");
    button(eye, "nearer", () => look(() => nearer(0.8)));
    button(eye, "farther", () => look(() => nearer(1.25)));
    button(eye, "reset view", () => look(camera));
  }

  colourButtons();
  shapeBoxes();
  sectionPlane();
  eyeButtons();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  return draw();
}

for (const root of document.querySelectorAll(".gearsim-view"))
  live(root).catch((error) => {
    console.error(error);
    root.querySelector(".scene").textContent = `The 3D view cannot be drawn here: ${error.message}`;
  });
