"""Inspections: what is asked of the two roads, round by round, and what is read from the answers.

An inspection is frozen data with one generator, ``steps``: it yields lists of questions and is sent their answers, in
their order, until it returns its Reading. So whoever drives them joins the questions of all inspections of a job into
one launch, and counts them without asking any.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, TypeVar

import numpy as np

from gearsim.envelope import EnvelopeRoad, machined_along
from gearsim.geometry.rays import RayBundle, join_rays
from gearsim.metrology.findings import Finding
from gearsim.simulation.operation import Variant

if TYPE_CHECKING:
    from gearsim.metrology.job import Job
    from gearsim.simulation.sequence import Machined, Machining
    from gearsim.simulation.workshop import Workshop

T = TypeVar("T")


class Cut(NamedTuple):
    """What does a variant remove from rays? Answer: an IntervalSet, segments numbered through its operations."""

    rays: RayBundle
    variant: Variant


class Solve(NamedTuple):
    """Where do rays meet the envelope of a variant's one operation? Answer: an EnvelopeRoad."""

    rays: RayBundle
    variant: Variant


class Machine(NamedTuple):
    """What do operations, one after the other, leave of a whole blank? Answer: a Machined."""

    machining: Machining


Question = Cut | Solve | Machine
Steps = Generator[list[Question], list[Any], T]


class Measurement(Protocol):
    """What was measured of a surface under a variant by an inspection; figures, charts, tables go by its class."""

    @property
    def surface(self) -> str: ...

    @property
    def variant(self) -> str: ...

    @property
    def inspection(self) -> str: ...


@dataclass(frozen=True)
class Reading:
    """What an inspection found; ``doubts`` say why a verdict must not rest on it, ``judged`` the surfaces it judged.

    ``remarks`` must be said wherever the verdict is, whatever it is.
    """

    measurements: tuple[Any, ...] = ()
    findings: tuple[Finding, ...] = ()
    doubts: tuple[str, ...] = ()
    judged: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()


class Inspection(Protocol):
    """Data that says which rays a job's part is asked for, under which variants, and reads the answers."""

    @property
    def name(self) -> str: ...

    def steps(self, job: Job) -> Steps[Reading]:
        """Questions, round by round; returns what was found. Variants and surfaces are the job's, by their names."""
        ...


def together(parts: Sequence[Steps[T]]) -> Steps[list[T]]:
    """Several courses of questions as one, round by round; what they return, in their order."""
    done: dict[int, T] = {}
    answers: dict[int, list[Any] | None] = dict.fromkeys(range(len(parts)))
    while len(done) < len(parts):
        asked: dict[int, list[Question]] = {}
        for i, answer in answers.items():
            try:
                asked[i] = next(parts[i]) if answer is None else parts[i].send(answer)
            except StopIteration as stop:
                done[i] = stop.value
        if not asked:
            break
        found = iter((yield [question for questions in asked.values() for question in questions]))
        answers = {i: [next(found) for _ in questions] for i, questions in asked.items()}
    return [done[i] for i in range(len(parts))]


def perform(
    steps: Steps[T], workshop: Workshop, begin: Callable[[list[Question]], None] = lambda questions: None
) -> T:  # fmt: skip
    """Answer all questions, those of a round in one launch, and give what the steps return.

    ``begin`` is told the first round's questions before anything is cut.
    """
    answers: list[Any] | None = None
    while True:
        try:
            questions = next(steps) if answers is None else steps.send(answers)
        except StopIteration as stop:
            result: T = stop.value
            return result
        if answers is None:
            begin(questions)
        answers = answer(questions, workshop)


def answer(questions: Sequence[Question], workshop: Workshop) -> list[Any]:
    """The answers to questions, in their order."""
    cuts = [(q.rays, q.variant.operations) for q in questions if isinstance(q, Cut)]
    removed = iter(workshop.cut(cuts) if cuts else [])
    solved = iter(_solved([q for q in questions if isinstance(q, Solve)], workshop))
    machined = (_machined(q, workshop) for q in questions if isinstance(q, Machine))
    found = {Cut: removed, Solve: solved, Machine: machined}
    return [next(found[type(q)]) for q in questions]


def _machined(question: Machine, workshop: Workshop) -> Machined:
    from gearsim.simulation.sequence import machine  # much comes with it, and few jobs have whole parts

    return machine(question.machining, workshop)


def _solved(questions: Sequence[Solve], workshop: Workshop) -> list[EnvelopeRoad]:
    """The envelope road's answers; questions about the same operation are solved as one."""
    alike: dict[int, list[int]] = {}
    for i, q in enumerate(questions):
        alike.setdefault(id(q.variant.operations[0]), []).append(i)
    found: dict[int, EnvelopeRoad] = {}
    for members in alike.values():
        rays, variant = join_rays([questions[i].rays for i in members]), questions[members[0]].variant
        road = machined_along(rays, variant.motions(), variant.cutter, workshop.device)
        ends = np.cumsum([0, *(len(questions[i].rays) for i in members)])
        found |= {i: road.part(slice(a, b)) for i, (a, b) in zip(members, pairwise(ends), strict=True)}
        workshop.progress(len(rays))
    return [found[i] for i in range(len(questions))]
