"""The drawing processes: one for flat pictures, one for 3D; each loads its library while the kernels still run.

``python -m gearsim.output.painting flat|solid`` waits for a line with a folder, and draws what is wanted of what is
pickled in it: the flat one of the result, the 3D one of arrays alone. A machine without OpenGL ends the 3D process, not
the run.
"""

from __future__ import annotations

import errno
import gc
import json
import os
import pickle
import re
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearsim.output.wanted import EVERYTHING, Wanted

if TYPE_CHECKING:
    from gearsim.result import Result

SOLID = "solid"
KINDS = ("flat", SOLID)
_DISK = 100  # and the number of the error: the exit code of a drawing process that the disk refused
_DISK_ERRORS = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)
_REMEDY = "They need OpenGL without a screen; on Debian or Ubuntu: apt-get install libegl1 libgl1-mesa-dri"


class Painters:
    """The drawing processes, started ahead and waiting for a result; use as a context to be sure they end.

    Those that have nothing to do for what is ``wanted`` are not started, the 3D one not before what may come is known.
    """

    def __init__(self, wanted: Wanted = EVERYTHING) -> None:
        self.wanted = wanted
        self._kinds = kinds(wanted)
        self._processes = {kind: _start(kind) for kind in self._kinds if kind != SOLID}
        self._folder: Path | None = None

    def __enter__(self) -> Painters:
        return self

    def __exit__(self, *_: object) -> None:
        for process in self._processes.values():
            if process.poll() is None:
                process.kill()
            process.communicate()

    def expect(self, files: Sequence[str]) -> None:
        """Start the 3D process, if it was not, where any of the ``files`` that may come is its work."""
        from gearsim.output.drawer import PICTURES
        from gearsim.output.files import MESHES, PART

        solid = {MESHES, PART, *(p.file for p in PICTURES)}
        if SOLID in self._kinds and SOLID not in self._processes and solid.intersection(files):
            self._processes[SOLID] = _start(SOLID)

    def draw(self, result: Result, folder: Path) -> None:
        """Start drawing a result into a folder."""
        from gearsim.output.presenters import promised

        self.expect(promised(result.job))
        self._folder = folder
        for kind, process in self._processes.items():
            drawn = _drawn(kind, result)
            with (folder / _handed(kind)).open("wb") as file:
                pickle.dump((drawn, self.wanted), file, protocol=pickle.HIGHEST_PROTOCOL)
            assert process.stdin is not None
            try:
                process.stdin.write(json.dumps(str(folder)) + "\n")
                process.stdin.flush()
            except BrokenPipeError:  # it has ended; finish() says why
                pass

    def finish(self) -> tuple[dict[str, str], list[str]]:
        """Wait; the captions of all pictures by file name, and what could not be drawn, one line each.

        Raises OSError where the disk took no more.
        """
        assert self._folder is not None
        captions: dict[str, str] = {}
        missing: list[str] = []
        for kind, process in self._processes.items():
            errors = process.communicate()[1]
            told = self._folder / f"_{kind}.json"
            drawn = json.loads(told.read_text(encoding="utf-8")) if told.exists() else {}
            captions |= {name: text for name, text in drawn.items() if (self._folder / name).exists()}
            if process.returncode - _DISK in _DISK_ERRORS:
                raise OSError(process.returncode - _DISK, os.strerror(process.returncode - _DISK))
            if process.returncode:
                missing.append(reason(kind, [n for n in drawn if n not in captions], errors, process.returncode))
            told.unlink(missing_ok=True)
            (self._folder / _handed(kind)).unlink(missing_ok=True)
        return captions, missing


def kinds(wanted: Wanted) -> tuple[str, ...]:
    """The drawing processes that what is wanted needs, or may need."""
    if not wanted.pictures:
        return ()
    if not wanted.only:
        return KINDS
    from gearsim.output.drawer import PICTURES
    from gearsim.output.files import MESHES, VIEW

    solid = (MESHES, VIEW, *(p.file for p in PICTURES))
    needed = {"flat": wanted.may_want_charts(solid), "solid": any(map(wanted.file, solid))}
    return tuple(kind for kind in KINDS if needed[kind])


def _drawn(kind: str, result: Result) -> Any:
    """What a process draws of; what makes arrays is not loaded in the processes that draw them."""
    if kind == "flat":
        return result
    import numpy as np

    from gearsim.output.exr import stated
    from gearsim.output.presenters import arrays

    return arrays(result) | {"stated": np.array(list(stated(result).items()))}


def _handed(kind: str) -> str:
    return f"_{kind}.pickle"


def _start(kind: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-P", "-m", "gearsim.output.painting", kind]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdin=pipe, stdout=subprocess.DEVNULL, stderr=pipe, text=True)


def reason(kind: str, names: list[str], errors: str, code: int) -> str:
    """Why a drawing process ended with a ``code``, by what it said last."""
    said = (errors.strip().splitlines() or [f"the drawing process ended with code {code}"])[-1]
    what = "3D pictures" if kind == "solid" else "charts"
    listed = f" ({', '.join(names)})" if names else ""
    ours = re.match(r"\w*(Error|Exception)\b", said) is not None  # a fault of the drawing, not of the machine
    return f"{what}{listed}: {said}" + (f". {_REMEDY}" if kind == "solid" and not ours else "")


def main(kind: str) -> None:
    """Load the library, wait for a folder, draw."""
    draw = _flat if kind == "flat" else _solid
    paint = draw()
    line = sys.stdin.readline()
    if not line:
        return
    folder = Path(json.loads(line))
    with (folder / _handed(kind)).open("rb") as file:
        drawn, wanted = pickle.load(file)  # our own, written a moment ago
    gc.freeze()  # it stays to the end: no collection need go through it again and again

    def tell(captions: dict[str, str]) -> None:
        (folder / f"_{kind}.json").write_text(json.dumps(captions), encoding="utf-8")

    try:
        paint(drawn, folder, wanted, tell)
    except OSError as error:
        if error.errno in _DISK_ERRORS:
            sys.exit(_DISK + error.errno)
        raise


Paint = Callable[[Any, Path, Wanted, Callable[[dict[str, str]], None]], None]


def _flat() -> Paint:
    from gearsim.output.charts import chart_all
    from gearsim.output.panels import pyplot

    pyplot()
    return chart_all


def _solid() -> Paint:
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 - loaded on demand otherwise, when the arrays are waiting

    from gearsim.output.drawer import draw_all

    return draw_all


if __name__ == "__main__":
    main(sys.argv[1])
