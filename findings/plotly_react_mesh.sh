#!/bin/sh
# plotly.js (plotly 7.1.0), mesh3d in Debian's headless chromium: what Plotly.react leaves of the trace before.
#
# 1. A body coloured by values is exchanged by react for one in a plain colour. Guessed: the plain colour is
#    seen. Seen: traces without uid go by their place, and the body comes out black; with uids of their own it is green.
# 2. A uid is text. Seen: with a colour bar it goes into a CSS selector, so that a name such as "flank|left" ends in an
#    error as soon as that trace is exchanged.
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
const lighting = { ambient: 1, diffuse: 0, specular: 0, fresnel: 0 }, hide = { visible: false };
const scene = { camera: { eye: { x: 0, y: 0, z: 2 }, up: { x: 0, y: 1, z: 0 } }, aspectmode: "data",
  xaxis: hide, yaxis: hide, zaxis: hide };
const layout = { scene, width: 400, height: 200, margin: { l: 0, r: 0, t: 0, b: 0 } };
const square = { type: "mesh3d", x: [0, 1, 1, 0], y: [0, 0, 1, 1], z: [0, 0, 0, 0], i: [0, 0], j: [1, 2], k: [2, 3],
  lighting };
const scaled = { ...square, intensity: [1, 1, 1, 1], cmin: 0, cmax: 1, showscale: false,
  colorscale: [[0, "#0000ff"], [1, "#ff0000"]] };
const plain = { ...square, color: "#00ff00" };
async function exchanged(before, after) {
  const page = document.body.appendChild(document.createElement("div"));
  try {
    await Plotly.newPlot(page, [{ ...scaled, ...before }], layout);
    await Plotly.react(page, [{ ...plain, ...after }], layout);
    return await seen(page);
  } catch (error) { return "error " + error.message.slice(0, 80); }
}
async function seen(page) { // red, green, blue in the picture's middle
  const image = new Image();
  image.src = await page._fullLayout.scene._scene.toImage("png");
  await image.decode();
  const canvas = Object.assign(document.createElement("canvas"), { width: image.width, height: image.height });
  const drawn = canvas.getContext("2d");
  drawn.drawImage(image, 0, 0);
  return [...drawn.getImageData(image.width / 2, image.height / 2, 1, 1).data].slice(0, 3).join(" ");
}
(async () => {
  const out = [];
  out.push("place: " + await exchanged({}, {}));
  out.push("uids: " + await exchanged({ uid: "a" }, { uid: "b" }));
  out.push("odd: " + await exchanged({ uid: "flank|left", showscale: true }, { uid: "b" }));
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
cat seen.txt
if grep -q '^uids: 0 255 0$' seen.txt && ! grep -q '^place: 0 255 0$' seen.txt && grep -q '^odd: error .*querySelector' seen.txt; then
    echo "as before"
else
    echo "CHANGED"
    exit 1
fi
