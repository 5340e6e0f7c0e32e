// What plotly.js is to draw of a mesh under a colouring, cut by a plane. Meshes are flat arrays of numbers.

const AXES = ["x", "y", "z"];
const LIGHT = { ambient: 0.65, diffuse: 0.5, specular: 0.03, roughness: 0.9, fresnel: 0 };

// What of a mesh lies where a height given at its points is at most 0; triangles are cut where it crosses 0.
function below(whole, height) {
  const points = Array.from(whole.points), triangles = [], made = new Map(), count = points.length / 3;
  const values = whole.values && Array.from(whole.values), classes = whole.classes && [];
  const crossing = (i, j) => {
    const key = Math.min(i, j) * count + Math.max(i, j);
    if (!made.has(key)) {
      const share = height(i) / (height(i) - height(j));
      const mix = (a, b) => a + share * (b - a);
      made.set(key, points.length / 3);
      for (let k = 0; k < 3; k++) points.push(mix(points[3 * i + k], points[3 * j + k]));
      if (values) values.push(mix(values[i], values[j]));
    }
    return made.get(key);
  };
  for (let t = 0; t < whole.triangles.length; t += 3) {
    const ring = [];
    for (let k = 0; k < 3; k++) {
      const i = whole.triangles[t + k], j = whole.triangles[t + ((k + 1) % 3)];
      if (height(i) <= 0) ring.push(i);
      if (height(i) <= 0 !== height(j) <= 0) ring.push(crossing(i, j));
    }
    for (let k = 2; k < ring.length; k++) {
      triangles.push(ring[0], ring[k - 1], ring[k]);
      if (classes) classes.push(whole.classes[t / 3]);
    }
  }
  return { points, triangles, values, classes };
}

// Triangles, three point numbers each, parted by a key of each.
function parted(triangles, key) {
  const parts = new Map();
  for (let t = 0; t < triangles.length; t += 3) {
    const of = key(t);
    if (!parts.has(of)) parts.set(of, []);
    parts.get(of).push(triangles[t], triangles[t + 1], triangles[t + 2]);
  }
  return parts;
}

const every = (array, first, step) => {
  const out = new Float64Array(Math.ceil((array.length - first) / step));
  for (let n = 0, k = first; k < array.length; k += step) out[n++] = array[k];
  return out;
};

// A mesh's parts, each in one way of colouring, as [mesh, how, text to read at the pointer].
function parts(mesh, legend, { plain, missing }) {
  const of = (triangles) => ({ ...mesh, triangles });
  if (mesh.classes)
    return [...parted(mesh.triangles, (t) => mesh.classes[t / 3])].map(([number, triangles]) => {
      const [text, color] = legend.classes[number];
      return [of(triangles), { color }, `${text}<br>`];
    });
  if (!mesh.values) return [[mesh, { color: plain }, ""]];
  const { low, high, scale } = legend, value = (i) => mesh.values[i];
  const kind = (t) => {
    const at = [0, 1, 2].map((k) => value(mesh.triangles[t + k]));
    if (at.some(Number.isNaN)) return "missing";
    if (Math.max(...at) < low) return "low";
    if (Math.min(...at) > high) return "high";
    return Math.min(...at) >= low && Math.max(...at) <= high ? "within" : "mixed";
  };
  const ramp = { cmin: low, cmax: high, colorscale: scale.map((colour, k) => [k / (scale.length - 1), colour]) };
  const ways = { missing: { color: missing }, low: { color: scale[0] }, high: { color: scale.at(-1) }, within: ramp };
  const found = [];
  for (const [name, triangles] of parted(mesh.triangles, kind)) {
    if (name !== "mixed") found.push([name, of(triangles)]);
    else {
      const above = below(of(triangles), (i) => low - value(i));
      found.push(["low", below(of(triangles), (i) => value(i) - low)]);
      found.push(["high", below(of(triangles), (i) => high - value(i))]);
      found.push(["within", below(above, (i) => above.values[i] - high)]);
    }
  }
  const read = `%{customdata:.3~f} ${legend.unit}<br>`;
  return found.map(([name, part]) => [part, ways[name], name === "missing" ? "no value<br>" : read]);
}

// A mesh whose triangles share no points, so that each is shaded by itself: plotly.js's own way draws them unlit.
function faceted(mesh) {
  const points = [], values = mesh.values && [];
  for (const i of mesh.triangles) {
    points.push(mesh.points[3 * i], mesh.points[3 * i + 1], mesh.points[3 * i + 2]);
    if (values) values.push(mesh.values[i]);
  }
  return { points, triangles: Uint32Array.from(mesh.triangles, (_, k) => k), values };
}

// plotly.js draws a missing value as 0, and blurs the colours where values run past the scale's ends: each of a mesh's
// parts is a trace of its own. Those of one uid follow each other as one thing of plotly.js's, which keeps a scale that
// it once had: a uid, part of a CSS selector, has one way of colouring.
function traces(shape, legend, plane, { missing, light }) {
  const found = (legend && shape.colours[legend.name]) || null;
  const [values, classes] = [legend && legend.scale ? found : null, legend && legend.classes ? found : null];
  const whole = { points: shape.points, triangles: shape.triangles, values, classes };
  const left = plane ? below(whole, (i) => plane.side * (whole.points[3 * i + plane.axis] - plane.at)) : whole;
  return parts(left, legend, { plain: shape.plain, missing }).map(([part, how, text], number) => {
    const mesh = shape.smooth ? part : faceted(part);
    const corners = {};
    AXES.forEach((axis, k) => (corners[axis] = every(mesh.points, k, 3)));
    "ijk".split("").forEach((corner, k) => (corners[corner] = every(mesh.triangles, k, 3)));
    return {
      type: "mesh3d", ...corners, ...how, lighting: LIGHT, lightposition: light, showscale: false,
      name: shape.name, customdata: mesh.values,
      uid: ["shape", shape.number, legend && legend.name, how.color || "scale", number].join(" ").replace(/\W/g, "_"),
      ...(how.colorscale && { intensity: mesh.values }),
      hovertemplate: `${shape.name}<br>${text}%{x:.3f}, %{y:.3f}, %{z:.3f} mm<extra></extra>`,
    };
  });
}
