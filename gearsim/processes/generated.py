"""What jobs share whose surfaces a motion generates: its envelope in closed form, and other motions beside it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import lru_cache

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.metrology.convergence import Series
from gearsim.metrology.dexel_check import DexelInspection, slot_box
from gearsim.metrology.grid import GridInspection
from gearsim.metrology.inspection import Inspection
from gearsim.metrology.job import Job
from gearsim.metrology.other_spaces import SpacesInspection
from gearsim.metrology.tooth_check import ToothInspection
from gearsim.motion.sources import MotionSource
from gearsim.processes.settings import settings
from gearsim.scene import scene_table
from gearsim.scene.generated import GeneratedMetrologyTable, GeneratedScene
from gearsim.simulation.operation import Variant, operation
from gearsim.surfaces.blank import BevelBlank
from gearsim.surfaces.part import Intended, Part, Tolerance
from gearsim.surfaces.patch import Patch

OTHERS, NOMINAL = "other cuts", "nominal"
_GENERATES = "generates the surfaces; the others are measured against them"
_CONVENTIONS = {
    "motions": f"the first one {_GENERATES}",
    "missing": "the closed form has no point there",
    "trimmed": "the generating motion itself cuts deeper there with another pose",
    "grids": "rows root (tip of the tool) to tip (its shank), columns along the motion or toe to heel",
}


@dataclass(frozen=True)
class Sweep:
    """One tool, the surfaces it generates, and the motions they are measured under, the generating one first.

    ``sampled`` gives a motion made of N points, for those that converge to the generating one; ``lines`` those of the
    program that the points of a motion stand in, for those that have one. Where the tool and the motions have errors
    the tool and the motion that generate the surfaces stand beside them as ``nominal``.
    """

    cutter: Profile
    patches: tuple[Patch, ...]
    sources: dict[str, MotionSource]
    sampled: dict[str, Callable[[int], MotionSource]] = field(default_factory=dict)
    lines: dict[str, Sequence[int]] = field(default_factory=dict)
    nominal: tuple[Profile, MotionSource] | None = None

    @property
    def surfaces(self) -> tuple[str, ...]:
        return tuple(patch.name for patch in self.patches)

    @property
    def generating(self) -> str:
        """The name of the motion that generates the surfaces."""
        return next(iter(self.sources)) if self.nominal is None else NOMINAL


def generated_job(
    scene: GeneratedScene, sweeps: Sequence[Sweep], texts: dict[str, str], frame: str, *,
    files: dict[str, str] | None = None, blank: BevelBlank | None = None, notes: tuple[str, ...] = (),
    tooth: tuple[ToothInspection, ...] = (),
) -> Job:  # fmt: skip
    """The job of some tools; ``texts`` say what each motion is, ``blank`` is what the surfaces are cut into.

    ``tooth`` holds the surfaces against what their part demands; without it nothing does. Raises InputError where
    ``metrology.judged`` names a motion that there is not.
    """
    conventions, own = dict(_CONVENTIONS), sweeps[0].generating
    if own == NOMINAL:
        texts = {**texts, NOMINAL: "the generating motion, and its tool, without the scene's errors"}
        conventions["motions"] = f"the one called {NOMINAL} {_GENERATES}"
    judged = _judged(scene.metrology.judged, list(texts))
    tolerance = Tolerance.both(scene.metrology.tolerance_um) if judged else None
    patches = [patch for sweep in sweeps for patch in sweep.patches]
    return Job(
        name=scene.name,
        part=Part(frame, blank.stock if blank else None, {p.name: Intended(p, tolerance) for p in patches}),
        variants=(*(v for sweep in sweeps for v in _variants(scene, sweep, texts)), *_other_cuts(scene, sweeps)),
        main=judged[-1] if judged else next(iter(texts)),
        inspections=(*_inspections(scene, sweeps, blank, judged, _remark(texts, own, judged, tooth)), *tooth),
        settings=settings(scene),
        scene=scene_table(scene),
        files=files or {},
        notes=notes,
        conventions=conventions,
    )


def _judged(judged: tuple[str, ...], motions: list[str]) -> tuple[str, ...]:
    for name in judged:
        if name not in motions:
            near = get_close_matches(name, motions, n=1, cutoff=0.4)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            raise InputError(f"metrology.judged: got {name!r}, expected one of {', '.join(motions)}{hint}")
    return judged


def _variants(scene: GeneratedScene, sweep: Sweep, texts: dict[str, str]) -> Iterator[Variant]:
    tolerance = scene.simulation.compile_tolerance_mm
    for name, source in sweep.sources.items():
        lines = [sweep.lines[name]] if name in sweep.lines else ()
        alone = operation(name, sweep.cutter, [source], tolerance, lines=lines)
        yield Variant(name, texts[name], (alone,), sweep.surfaces)
    if sweep.nominal is not None:
        cutter, source = sweep.nominal
        yield Variant(NOMINAL, texts[NOMINAL], (operation(NOMINAL, cutter, [source], tolerance),), sweep.surfaces)
    for name, make in sweep.sampled.items():
        for n in scene.metrology.convergence:
            given = operation(f"{name}, {n} points", sweep.cutter, [make(n)], tolerance)
            yield Variant(_of_points(name, n), f"{texts[name]}; of {n} points", (given,), sweep.surfaces)


def _other_cuts(scene: GeneratedScene, sweeps: Sequence[Sweep]) -> Iterator[Variant]:
    """For the surfaces of each of several cuts, what the generating motions of the others cut."""
    tolerance = scene.simulation.compile_tolerance_mm
    own = [operation(OTHERS, sweep.cutter, [next(iter(sweep.sources.values()))], tolerance) for sweep in sweeps]
    for i, sweep in enumerate(sweeps if len(sweeps) > 1 else ()):
        rest = tuple(o for k, o in enumerate(own) if k != i)
        yield Variant(OTHERS, "the generating motions of the other cuts", rest, sweep.surfaces)


def _of_points(name: str, n: int) -> str:
    return f"{name} N = {n}"


def _inspections(
    scene: GeneratedScene, sweeps: Sequence[Sweep], blank: BevelBlank | None, judged: tuple[str, ...], remark: str
) -> Iterator[Inspection]:
    for sweep in sweeps:
        others = OTHERS if len(sweeps) > 1 else ""
        grids = tuple(_grid(scene.metrology, sweep, surface, judged, remark, others) for surface in sweep.surfaces)
        yield from grids
        gear = sweep.patches[0].blank
        if gear is not None and judged:
            yield SpacesInspection(judged[-1], gear.teeth, grids)
        if blank is not None:
            box = _box(sweep.patches, blank, scene.simulation.dexel_pitch_mm)
            yield DexelInspection(grids[0].variants[0], box, grids)


_box = lru_cache(maxsize=8)(slot_box)  # jobs beside each other share it


def _remark(texts: dict[str, str], own: str, judged: tuple[str, ...], tooth: tuple[ToothInspection, ...]) -> str:
    """That the generating motion, ``own``, is measured against itself; and motions not judged."""
    told = []
    if own in judged:
        alone = "" if tooth else "; no blank says what the part demands"
        told = [f"under {own} the surfaces are measured against themselves, as its own envelope{alone}"]
    others = [name for name in texts if name not in judged]
    return "; ".join(told + [f"not judged: {', '.join(others)}"] * bool(others))


def _grid(
    m: GeneratedMetrologyTable, sweep: Sweep, surface: str, judged: tuple[str, ...], remark: str, others: str
) -> GridInspection:
    names = (*sweep.sources, *[NOMINAL] * (sweep.nominal is not None))
    points = m.convergence
    series = [Series(name, names[0], points, tuple(_of_points(name, n) for n in points)) for name in sweep.sampled]
    return GridInspection(
        surface, names, names, m.rows, m.columns, m.margin, m.window, judged=judged, generating=sweep.generating,
        series=tuple(series) if points else (), remark=remark, strangers=others,
    )  # fmt: skip
