"""Benchmark `peers`: what installs from the package index on the same work in the same run, at equal error.

Each peer runs at several resolutions; power laws of its error and its CPU time through them give its time at
an error and its error in a time. Errors are largest distances along the rays, from our removal road at 1e-9 mm.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from importlib.metadata import version
from statistics import median
from time import process_time
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.bench.peer_drop import drop
from gearsim.bench.peer_hulls import cast, hull_sweep
from gearsim.bench.peer_instants import instants
from gearsim.bench.peer_law import Level, fit_laws
from gearsim.bench.peer_work import Work, compare, dexel_work, normal_work, ours, raster_work
from gearsim.simulation.removal import prepare

PEERS = ("manifold3d", "opencamlib")
TARGET, COARSE, FINE = 1e-4, 1e-2, 1e-6
_TWIST = 5  # facets² by steps of the hulls in five axes: both errors are then of one size
_CONVERGES = -0.3  # an error that falls more slowly with the resolution does not
_BLANK = "-"
_COLUMNS = ("case", "method", "resolutions", "error ~ n^", "time ~ n^", "seconds", "from", "ratio",
            "ratio at 1e-2", "ratio at 1e-6", "mm in our time", "lost rays")  # fmt: skip


class Size(NamedTuple):
    """How much of everything: dexel pitch [mm], grid of normals, CL points, and each peer's resolutions."""

    pitch: float
    normals: tuple[int, int]
    points: tuple[int, int]
    poses: tuple[int, ...]
    twisting: tuple[int, ...]
    straight: tuple[int, ...]


SIZES = {
    "small": Size(0.4, (160, 40), (100, 1000), (1000, 2000, 4000, 8000), (12, 17, 24, 34), (24, 48, 96)),
    "large": Size(0.2, (320, 80), (100, 10000), (1000, 2000, 4000, 8000, 16000), (12, 17, 24, 34, 48),
                  (24, 48, 96, 192)),
}  # fmt: skip


class Peer(NamedTuple):
    """A method to race: ``run(resolution)`` is timed, ``surface`` of what it returns is not.

    ``package`` is what must be installed, if anything.
    """

    name: str
    run: Callable[[int], Any]
    resolutions: Sequence[int] = (1,)
    surface: Callable[[Any], NDArray] = lambda found: found
    repeats: int = 3
    package: str = ""


def peers(device: str, size: str = "small") -> dict[str, Any]:
    """NumPy, manifold3d and opencamlib against our road on one thread: time at equal error, error in equal time."""
    prepare("cpu")
    s = SIZES[size]
    found = {name: package(name) for name in PEERS}
    dexels, few, many = dexel_work(s.pitch), *(raster_work(n, s.pitch) for n in s.points)
    rows = [
        *race(dexels, _numpy(dexels, s), found),
        *_normals(s, found),
        *race(few, [_dropper(few, found), _hulls(few, found, s.straight, lambda n: 1)], found),
        *race(many, [_dropper(many, found)], found),
    ]
    return {"columns": list(_COLUMNS), "rows": rows, "notes": _notes(found)}


def package(name: str) -> Any:
    """An optional package, None where it is not installed."""
    try:
        return import_module(name)
    except ImportError:
        return None


def _numpy(work: Work, s: Size) -> list[Peer]:
    return [
        Peer("NumPy instants, every pose", lambda n: instants(work, n, culled=False), s.poses, repeats=1),
        Peer("NumPy instants, near poses", lambda n: instants(work, n), s.poses),
    ]


def _normals(s: Size, found: dict[str, Any]) -> list[dict[str, Any]]:
    work = normal_work(*s.normals)
    return race(work, [*_numpy(work, s), _hulls(work, found, s.twisting, lambda n: max(1, n * n // _TWIST))], found)


def _hulls(work: Work, found: dict[str, Any], facets: Sequence[int], steps: Callable[[int], int]) -> Peer:
    def run(n: int) -> Any:
        return hull_sweep(found["manifold3d"], work, n, steps(n))

    return Peer("manifold3d hulls", run, facets, lambda machined: cast(machined, work), 1, "manifold3d")


def _dropper(work: Work, found: dict[str, Any]) -> Peer:
    return Peer("opencamlib drop cutter", lambda n: drop(found["opencamlib"], work), package="opencamlib")


def race(work: Work, methods: Sequence[Peer], found: dict[str, Any]) -> list[dict[str, Any]]:
    """A row for our road and one for each peer; a peer that is not installed says how to get it."""
    truth = ours(work, repeats=1).surface
    times = {tolerance: ours(work, tolerance) for tolerance in (COARSE, TARGET, FINE)}
    error, lost = compare(times[TARGET].surface, truth)
    mine = {t: o.seconds for t, o in times.items()}
    rows = [
        _row(work, "gearsim, one thread", {
            "seconds": mine[TARGET], "from": "measured", "ratio": 1.0, "ratio at 1e-2": 1.0, "ratio at 1e-6": 1.0,
            "mm in our time": error, "lost rays": lost,
            "rays": len(work.rays), "pieces": work.source.pieces, "seconds by tolerance": mine,
        })
    ]  # fmt: skip
    for peer in methods:
        if peer.package and found[peer.package] is None:
            rows.append(_row(work, peer.name, {"from": f"not installed: pip install {peer.package}"}))
        else:
            rows.append(_peer_row(work, peer, _levels(peer, truth), mine))
    return rows


def _levels(peer: Peer, truth: NDArray) -> list[Level]:
    levels = []
    for n in peer.resolutions:
        seconds = []
        for _ in range(peer.repeats):
            started = process_time()
            result = peer.run(n)
            seconds.append(process_time() - started)
        levels.append(Level(n, median(seconds), *compare(peer.surface(result), truth)))
    return levels


def _peer_row(work: Work, peer: Peer, levels: list[Level], mine: dict[float, float]) -> dict[str, Any]:
    last = levels[-1]
    if len(levels) > 1:
        figures = fitted(levels, mine)
    else:
        figures = {"seconds": last.seconds, "from": f"measured, exact to {last.error:.1g} mm"}
        figures |= _ratios({t: last.seconds / s for t, s in mine.items()})
    return _row(work, peer.name, {"lost rays": last.lost, "levels": [x._asdict() for x in levels], **figures})


def fitted(levels: Sequence[Level], mine: dict[float, float]) -> dict[str, Any]:
    """What a peer's levels say of its time at an error; ``mine``: our CPU times [s] by tolerance [mm]."""
    laws = fit_laws(levels)
    runs = f"{levels[0].resolution} to {levels[-1].resolution}"
    figures = {"resolutions": runs, "error ~ n^": laws.error.order, "time ~ n^": laws.time.order}
    if laws.error.order > _CONVERGES:
        return {**figures, "from": "does not converge"}
    return {
        **figures,
        "seconds": laws.seconds_at(TARGET),
        "from": laws.origin(TARGET),
        "mm in our time": laws.error_in(mine[TARGET]),
        **_ratios({t: laws.seconds_at(t) / s for t, s in mine.items()}),
    }


def _ratios(ratios: dict[float, float]) -> dict[str, float]:
    return {"ratio": ratios[TARGET], "ratio at 1e-2": ratios[COARSE], "ratio at 1e-6": ratios[FINE]}


def _row(work: Work, method: str, figures: dict[str, Any]) -> dict[str, Any]:
    return {**dict.fromkeys(_COLUMNS, _BLANK), "case": work.name, "method": method, **figures}


def _notes(found: dict[str, Any]) -> list[str]:
    versions = [f"{name} {version(name) if found[name] else 'not installed'}" for name in PEERS]
    return [
        "CPU seconds, all on one thread, to 1e-4 mm, set-up included (ours: compiling the motion); ratio: over ours, "
        "below 1 the peer wins. mm in our time: the peer's error after our seconds. interpolated, extrapolated: by its "
        "laws from the resolutions n that were run (poses; facets around). lost rays: off by over 1 mm, left out.",
        "Five axes: one trough by a tapered ball end mill that leans over by 20 degrees. Dexels: error along vertical "
        "rays, which amplify it on walls of 5 degrees and more; normals: distance between surfaces.",
        "NumPy keeps only the first surface of each ray, ours all intervals. The hulls' error in five axes is of first "
        "order in the step (the hull of a twisting tool is fatter than its sweep), in three axes it is the facets'.",
        "manifold3d makes a closed mesh, whatever the number of rays. opencamlib has no cutting simulation: its drop "
        "cutter gets tool and path exchanged, exact for vertical dexels and straight lines in three axes alone.",
        f"NumPy {np.__version__}, {', '.join(versions)}.",
    ]
