#!/bin/sh
# plotly.js 4.1.1 (plotly 7.1.0), mesh3d in Debian's headless chromium: two colours that one reads wrong.
#
# The scale runs from -5 (blue) over 0 (green) to 5 (red); light is even, so that a colour is that of the scale.
# 1. Values that are missing (null), between neighbours of 2: expected a gap. Seen: green, the colour of 0, as if
#    nothing deviated.
# 2. Values of 438 and 32 at the ends of a face: expected red, the end's colour. Seen: a mixture with green; the texture
#    of the scale is sampled coarser the faster the values change, beyond its ends too.
#
# Exits 0 while this is so. Needs chromium, whose version it prints.
set -eu
command -v chromium >/dev/null || { echo "no chromium here (apt-get install chromium)"; exit 2; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q plotly==7.1.0 >/dev/null 2>&1 || { echo "the packages cannot be fetched"; exit 2; }
venv/bin/python - <<'END' >page.html
from plotly.offline import get_plotlyjs

print("<!doctype html><meta charset=utf-8><body><script>" + get_plotlyjs() + "</script><script>")
print(r"""
const scale = [[0, "#0000ff"], [0.5, "#00ff00"], [1, "#ff0000"]];
const lighting = { ambient: 1, diffuse: 0, specular: 0, fresnel: 0 };
const hide = { visible: false };
const scene = { camera: { eye: { x: 0, y: 0, z: 2 }, up: { x: 0, y: 1, z: 0 } }, aspectmode: "data",
  xaxis: hide, yaxis: hide, zaxis: hide };
const layout = { scene, width: 400, height: 200, margin: { l: 0, r: 0, t: 0, b: 0 } };
const strip = (values) => { // values at x = 0, 1, 2, ..., the same at y = 0 and 1
  const n = values.length, x = values.map((_, k) => k), i = [], j = [], k = [];
  for (let q = 0; q + 1 < n; q++) { i.push(q, q); j.push(q + 1, q + n + 1); k.push(q + n + 1, q + n); }
  return { type: "mesh3d", x: [...x, ...x], y: [...x.map(() => 0), ...x.map(() => 1)], z: [...x, ...x].map(() => 0),
    i, j, k, lighting, showscale: false, intensity: [...values, ...values], cmin: -5, cmax: 5, colorscale: scale };
};
async function middle(page) { // red, green, blue in the page's middle
  const image = new Image();
  image.src = await Plotly.toImage(page, { format: "png", width: 400, height: 200 });
  await image.decode();
  const canvas = Object.assign(document.createElement("canvas"), { width: 400, height: 200 });
  const drawn = canvas.getContext("2d");
  drawn.drawImage(image, 0, 0);
  return [...drawn.getImageData(200, 100, 1, 1).data].slice(0, 3).join(" ");
}
const pages = [1, 2].map(() => document.body.appendChild(document.createElement("div")));
(async () => {
  const out = [];
  await Plotly.newPlot(pages[0], [strip([2, 2, null, null, 2, 2])], layout);
  out.push(`missing: ${await middle(pages[0])}`);
  await Plotly.newPlot(pages[1], [strip([300, 438, 32, 100])], layout);
  out.push(`beyond: ${await middle(pages[1])}`);
  document.body.replaceChildren(...out.map((line) => Object.assign(document.createElement("p"), { textContent: line })));
})();
</script>""")
END
chromium --version
for try in 1 2 3; do # a slow machine may not have drawn when the page's time is over
    chromium --headless --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader \
        --user-data-dir="profile$try" --virtual-time-budget=60000 --dump-dom "file://$folder/page.html" 2>/dev/null |
        grep -o '<p>[^<]*' | sed 's/<p>//' >seen.txt || true
    [ -s seen.txt ] && break
done
[ -s seen.txt ] || { echo "nothing was drawn in time"; exit 2; }
venv/bin/python - <<'END'
import sys
from pathlib import Path

seen = dict(line.split(": ", 1) for line in Path("seen.txt").read_text().splitlines())
expected = {"missing": "255 255 255", "beyond": "255 0 0"}
for what, wanted in expected.items():
    print(f"{what}: expected {wanted}, seen {seen.get(what)}")
(red, green, _), (mixed, some, _) = (map(int, seen.get(what, "0 0 0").split()) for what in ("missing", "beyond"))
as_before = red < 8 and green > 247 and 100 < mixed < 240 and some > 15
print("as before" if as_before else "CHANGED")
sys.exit(not as_before)
END
