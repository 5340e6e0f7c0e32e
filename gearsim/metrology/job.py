"""A job: everything that a run measures, and what of it a report tells, nothing cut yet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from gearsim.errors import InputError
from gearsim.metrology.inspection import Cut, Inspection, Machine, Question, Reading, Solve, Steps, together
from gearsim.simulation.operation import Variant
from gearsim.surfaces.part import Part


@dataclass(frozen=True)
class Settings:
    """Numerical settings of the removal road, as of ``simulation.removal.cut``."""

    tolerance_mm: float = 1e-9
    interval_slots: int = 16


@dataclass(frozen=True)
class Job:
    """A part, the variants it is measured under, and the inspections that measure it.

    ``main`` names the variant that is the job's whole program: what the machined part is. ``scene`` is the scene as
    plain tables. ``files`` are programs to be written, text by file name; ``notes`` what a reader must be told of
    how user files were read and machines run; ``conventions`` what words in the data mean.
    """

    name: str
    part: Part
    variants: tuple[Variant, ...]
    main: str
    inspections: tuple[Inspection, ...]
    settings: Settings = Settings()
    scene: dict[str, Any] = field(default_factory=dict)
    files: dict[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    conventions: dict[str, str] = field(default_factory=dict)

    def variant(self, name: str, surface: str = "") -> Variant:
        """The variant of a name that is meant for a surface. Raises InputError where there is none."""
        for variant in self.variants:
            if variant.name == name and (not variant.surfaces or not surface or surface in variant.surfaces):
                return variant
        known = ", ".join(dict.fromkeys(v.name for v in self.variants))
        raise InputError(
            f"job {self.name}: no variant {name!r}{f' for {surface}' if surface else ''}; there are {known}"
        )

    def under(self, variants: Mapping[str, Variant | str]) -> Job:
        """The same job with other variants in the places of those of the given names, for the surfaces they name.

        A name stands for all variants of that name. Raises InputError for a name that there is not.
        """
        for name in [*variants, *(given for given in variants.values() if isinstance(given, str))]:
            self.variant(name)
        new = [replace(v, name=place) for place, given in variants.items() for v in self._given(given)]
        kept = (v for v in self.variants if all(v.name != n.name or _apart(v, n) for n in new))
        return replace(self, variants=(*kept, *new))

    def _given(self, given: Variant | str) -> list[Variant]:
        return [v for v in self.variants if v.name == given] if isinstance(given, str) else [given]

    def steps(self) -> Steps[list[Reading]]:
        """All inspections' questions, round by round; returns their readings in their order."""
        return together([inspection.steps(self) for inspection in self.inspections])

    def rows(self) -> int:
        """Rows of the whole program's tables."""
        return sum(len(v) for v in self.variants if v.name == self.main)


def _apart(a: Variant, b: Variant) -> bool:
    """Whether two variants are meant for different surfaces."""
    return bool(a.surfaces and b.surfaces) and not set(a.surfaces) & set(b.surfaces)


def counted(questions: list[Question]) -> tuple[int, int]:
    """How many rays are cut, once for every operation, and how many are solved for."""
    cut = sum(len(q.rays) * len(q.variant.operations) for q in questions if isinstance(q, Cut))
    cut += sum(q.machining.rays for q in questions if isinstance(q, Machine))
    return cut, sum(len(q.rays) for q in questions if isinstance(q, Solve))


def at_once(questions: list[Question]) -> int:
    """How many rays memory must hold at a time: a whole part's are the same for all its operations."""
    again = sum(q.machining.rays - q.machining.rays // len(q.machining.operations) for q in questions
                if isinstance(q, Machine) and q.machining.operations)  # fmt: skip
    return sum(counted(questions)) - again
