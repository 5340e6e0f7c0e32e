// Faces of closed bodies where a plane cuts them. A body may consist of several meshes that meet in common points.

const CUT = "#b4d8a8"; // of cut faces
const BANDS = 600; // across a cut face
const BEFORE = 2e-4; // of the diagonal: before the ends of what is cut, which would show through

// Where a plane across an axis meets a mesh: ends of lines along the two axes after it, four numbers a line.
function met({ points, triangles }, { axis, at }, lines) {
  const along = [(axis + 1) % 3, (axis + 2) % 3];
  const height = (i) => points[3 * i + axis] - at;
  for (let t = 0; t < triangles.length; t += 3)
    for (let k = 0; k < 3; k++) {
      const [i, j] = [triangles[t + k], triangles[t + ((k + 1) % 3)]];
      if (height(i) >= 0 === height(j) >= 0) continue;
      const [low, high] = i < j ? [i, j] : [j, i]; // in the same order in both triangles
      const share = height(low) / (height(low) - height(high));
      for (const c of along) lines.push(points[3 * low + c] + share * (points[3 * high + c] - points[3 * low + c]));
    }
  return lines;
}

// Of every band across the second axis, the lines that cross its middle: where along the first, and at its two sides.
function bands(lines) {
  let [first, last] = [Infinity, -Infinity];
  for (let n = 1; n < lines.length; n += 2) [first, last] = [Math.min(first, lines[n]), Math.max(last, lines[n])];
  const width = (last - first) / BANDS, found = Array.from({ length: BANDS }, () => []);
  for (let n = 0; n < lines.length; n += 4) {
    const [a, b, c, d] = lines.slice(n, n + 4), [low, high] = [Math.min(b, d), Math.max(b, d)];
    const place = (v) => a + ((c - a) * (Math.min(Math.max(v, low), high) - b)) / (d - b);
    const begin = Math.ceil((low - first) / width - 0.5), end = Math.ceil((high - first) / width - 0.5);
    for (let k = Math.max(begin, 0); k < Math.min(end, BANDS); k++)
      found[k].push([0.5, 0, 1].map((share) => place(first + (k + share) * width)));
  }
  return { first, width, found };
}

// The material of a body in a plane: between every other line along a band. A band in which a line is missing, where
// the body is not closed, stays empty.
function cap(meshes, plane) {
  const lines = meshes.reduce((all, mesh) => met(mesh, plane, all), []);
  const { first, width, found } = bands(lines), points = [], triangles = [];
  const add = (u, v) => {
    const at = [];
    [at[plane.axis], at[(plane.axis + 1) % 3], at[(plane.axis + 2) % 3]] = [plane.seen, u, v];
    return points.push(...at) / 3 - 1;
  };
  found.forEach((crossings, k) => {
    if (crossings.length % 2) return;
    crossings.sort((p, q) => p[0] - q[0]);
    for (let n = 0; n < crossings.length; n += 2) {
      const [low, high] = [first + k * width, first + (k + 1) * width], [from, to] = crossings.slice(n, n + 2);
      const [a, b, c, d] = [add(from[1], low), add(to[1], low), add(to[2], high), add(from[2], high)];
      triangles.push(a, b, c, a, c, d);
    }
  });
  return { points, triangles };
}

// What plotly.js is to draw of the faces in which a plane cuts the bodies of which anything is shown.
function capTraces(shapes, shown, { axis, at, side }, diagonal) {
  const plane = { axis, at, seen: at + side * BEFORE * diagonal };
  const bodies = [...new Set(shown.map((shape) => shape.body))].filter(Boolean);
  return bodies.flatMap((body, number) => {
    const { points, triangles } = cap(shapes.filter((shape) => shape.body === body), plane);
    if (!triangles.length) return [];
    const corners = {};
    AXES.forEach((axis, k) => (corners[axis] = every(points, k, 3)));
    "ijk".split("").forEach((corner, k) => (corners[corner] = every(triangles, k, 3)));
    return [{
      type: "mesh3d", ...corners, color: CUT, lighting: { ...LIGHT, ambient: 1, diffuse: 0 }, name: "cut face",
      hovertemplate: `cut face of ${body}<br>${AXES[axis]} = ${at.toFixed(3)} mm<extra></extra>`,
      uid: `cut_face_${number}`,
    }];
  });
}
