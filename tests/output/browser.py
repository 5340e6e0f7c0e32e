"""Opens a page in Debian's headless chromium, drawn by software, with no way to any network."""

import re
import shutil
import subprocess

import pytest
from matplotlib.image import imread

CHROMIUM = shutil.which("chromium")
needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="no chromium here (apt-get install chromium)")
_HINT = "willReadFrequently"  # advice of chromium's about the speed of plotly.js's texts
_OPTIONS = (
    "--headless", "--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--hide-scrollbars", "--enable-logging=stderr", "--virtual-time-budget=8000",
    "--proxy-server=http://127.0.0.1:9",
)  # fmt: skip


def opened(page, size):
    """The page as it looks at a size [pixels], shape (height, width, 3), and what its console says, line by line."""
    picture = page.with_suffix(".png")
    own = (f"--user-data-dir={page.with_suffix('.profile')}", f"--window-size={size[0]},{size[1]}",
           f"--screenshot={picture}")  # fmt: skip
    run = subprocess.run([CHROMIUM, *_OPTIONS, *own, page.as_uri()], capture_output=True, text=True, timeout=240)
    assert picture.exists(), run.stderr[-2000:]
    said = re.findall(r"CONSOLE:\d+\] (.*)", run.stderr)
    return imread(picture)[..., :3], [line for line in said if _HINT not in line]


def share_in_hue(picture, colour):
    """The share of pixels that have a colour (#rrggbb) in any light but next to none."""
    wanted = [int(colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5)]
    length = (picture**2).sum(axis=-1) ** 0.5
    along = picture @ wanted / (sum(x * x for x in wanted) ** 0.5)
    return float(((along > 0.996 * length) & (length > 0.1)).mean())
