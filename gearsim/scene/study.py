"""Tables of a study: the scene, how its jobs' values are found, and the keys that vary."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import isfinite
from typing import Annotated, Any, Literal, cast

from pydantic import Field, ValidationError, model_validator

from gearsim.errors import InputError
from gearsim.scene.keys import plain
from gearsim.scene.mistakes import explained, short
from gearsim.scene.tables import FileName, Table

MOST_JOBS = 10_000_000
RANDOM = ("latin-hypercube", "sobol", "monte-carlo")
FORMS = {  # of what is drawn: the keys that a distribution needs, and those that it takes beside them
    "uniform": (("low", "high"), ("scale",)),
    "normal": (("mean", "deviation"), ("lower", "upper")),
    "triangular": (("low", "mode", "high"), ()),
    "tolerance": (("nominal", "tolerance"), ()),
}
_NUMBERS = ("low", "high", "scale", "mean", "deviation", "lower", "upper", "mode", "nominal", "tolerance")
Finite = Annotated[float, Field(allow_inf_nan=False)]


class StudyHeader(Table):
    """Table [study]: its name, the scene, the method, and what is measured of each job.

    ``set``: values of the scene's keys that all jobs have. ``chunk``: so many jobs are computed and kept together.
    """

    name: FileName
    summary: str = ""
    scene: str = Field(min_length=1)
    method: Literal["grid", "list", "latin-hypercube", "sobol", "monte-carlo"]
    samples: int | None = Field(default=None, ge=1, le=MOST_JOBS)
    seed: int = Field(default=1, ge=0, lt=2**63)
    measure: tuple[Literal["maps", "iso"], ...] = Field(default=("maps",), min_length=1)
    cross_checked: float = Field(default=1.0, ge=0.0, le=1.0)
    chunk: int = Field(default=32, ge=1, le=100_000)
    set: dict[str, Any] = Field(default_factory=dict)

    @property
    def fixed(self) -> dict[str, Any]:
        """The values of ``set`` by dotted keys; tables in it are merged into the scene's."""
        return dict(_leaves("", self.set))

    @model_validator(mode="after")
    def _samples_of_random_ones(self) -> StudyHeader:
        if self.method in RANDOM and self.samples is None:
            raise ValueError(f"samples: missing; a study by {self.method} says how many jobs it has")
        if self.method not in RANDOM and self.samples is not None:
            raise ValueError(f"samples: a {self.method} has as many jobs as its values make; remove it")
        if len(set(self.measure)) < len(self.measure):
            raise ValueError(f"measure: got {list(self.measure)}; each once")
        return self


def _leaves(before: str, table: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from _leaves(f"{before}{key}.", value)
        else:
            yield f"{before}{key}", plain(value)


class VaryTable(Table):
    """Table [[vary]]: a key, or several that move together, with ``values``, even steps or a distribution."""

    key: str | None = None
    keys: tuple[str, ...] | None = None
    values: tuple[Any, ...] | None = None
    count: int | None = Field(default=None, ge=2, le=MOST_JOBS)
    distribution: Literal["uniform", "normal", "triangular", "tolerance"] | None = None
    low: Finite | None = None
    high: Finite | None = None
    scale: Literal["linear", "log"] | None = None
    mean: Finite | None = None
    deviation: Finite | None = None
    lower: Finite | None = None
    upper: Finite | None = None
    mode: Finite | None = None
    nominal: Finite | None = None
    tolerance: Finite | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """The keys that it varies."""
        return self.keys or (cast(str, self.key),)

    @property
    def rows(self) -> tuple[tuple[Any, ...], ...]:
        """Its listed values, one of each key in a row."""
        return tuple(v if self.keys else (v,) for v in self.values or ())

    @property
    def drawn(self) -> str | None:
        """The name of its distribution; none where values are listed or stand in even steps."""
        return None if self.values is not None or self.count is not None else self.distribution or "uniform"

    @model_validator(mode="after")
    def _one_or_several_keys(self) -> VaryTable:
        if (self.key is None) == (self.keys is None):
            raise ValueError('give key = "table.key", or keys = [...] that move together; one of them')
        if self.keys is not None and (len(self.keys) < 2 or self.values is None):
            raise ValueError("keys: two or more that move together, and values = [[...], [...]] with one of each")
        return self

    @model_validator(mode="after")
    def _one_form(self) -> VaryTable:
        given = [name for name in _NUMBERS if getattr(self, name) is not None]
        if self.values is not None:
            others = [*given, *(n for n in ("count", "distribution") if getattr(self, n) is not None)]
            if others:
                raise ValueError(f"values are given; remove {', '.join(others)}")
            return self._checked_values()
        drawn = self.distribution or "uniform"
        needed, allowed = FORMS[drawn]
        if not given and self.distribution is None:
            raise ValueError("nothing says its values: give values = [...], low and high, or a distribution")
        missing = [name for name in needed if name not in given]
        strange = [name for name in given if name not in (*needed, *allowed)]
        if missing:
            raise ValueError(f"{missing[0]}: missing; {_form(drawn)}")
        if strange:
            raise ValueError(f"{strange[0]}: not of this distribution; {_form(drawn)}")
        if self.count is not None and drawn != "uniform":
            raise ValueError(f"count: even steps have low, high and scale, not distribution = {drawn!r}")
        return self._checked_numbers()

    def _checked_values(self) -> VaryTable:
        if not self.values:
            raise ValueError("values: the list is empty; give one value or more")
        for i, row in enumerate(self.values):
            if self.keys is not None and (not isinstance(row, tuple) or len(row) != len(self.keys)):
                raise ValueError(f"values.{i}: got {short(row)}; expected a list of {len(self.keys)}, one of each key")
        for name, column in zip(self.names, zip(*self.rows, strict=True), strict=True):
            _of_one_kind(name, column)
        return self

    def _checked_numbers(self) -> VaryTable:
        bounds: list[tuple[str, str]] = [("low", "high"), ("lower", "upper"), ("low", "mode"), ("mode", "high")]
        for first, second in bounds:
            a, b = getattr(self, first), getattr(self, second)
            between = "mode" in (first, second)  # a triangle may rise or fall at its end
            if a is not None and b is not None and (a > b if between else a >= b):
                raise ValueError(f"{first} {a:g} is not below {second} {b:g}; give the smaller one first")
        for name in ("deviation", "tolerance"):
            if getattr(self, name) is not None and getattr(self, name) <= 0.0:
                raise ValueError(f"{name}: got {getattr(self, name):g}; expected more than 0")
        if self.scale == "log" and cast(float, self.low) <= 0.0:
            raise ValueError(f"low: got {self.low:g}; a logarithmic scale begins above 0")
        return self


def _form(name: str) -> str:
    needed, allowed = FORMS[name]
    more = f", and if you like {' and '.join(allowed)}" if allowed else ""
    return f"distribution = {name!r} has {', '.join(needed)}{more}"


def _of_one_kind(key: str, values: tuple[Any, ...]) -> None:
    """Raises ValueError where values are no numbers, texts or truths, are mixed, or no numbers that count."""
    for value in values:
        if isinstance(value, tuple | dict):
            hint = f"vary its entries, each by its place: {key}.0" if isinstance(value, tuple) else "name its keys"
            raise ValueError(f"values of {key}: got {short(value)}; expected numbers, texts or truths; {hint}")
        if isinstance(value, float) and not isfinite(value):
            raise ValueError(f"values of {key}: got {value}; expected numbers")
    kinds = {"truths" if isinstance(v, bool) else "texts" if isinstance(v, str) else "numbers" for v in values}
    strange = next((v for v in values if not isinstance(v, bool | str | int | float)), None)
    if strange is not None:
        raise ValueError(f"values of {key}: got {strange}; expected numbers, texts or truths")
    if len(kinds) > 1:
        raise ValueError(f"values of {key}: got {' and '.join(sorted(kinds))}; expected one kind")


class StudyTables(Table):
    """A study's file: [study] and its [[vary]]."""

    study: StudyHeader
    vary: tuple[VaryTable, ...] = ()

    @model_validator(mode="after")
    def _something_varies(self) -> StudyTables:
        if not self.vary:
            raise ValueError("vary: missing; a study has one [[vary]] or more (gearsim run does one job)")
        return self

    @model_validator(mode="after")
    def _every_key_once(self) -> StudyTables:
        seen: dict[str, str] = {key: "study.set" for key in self.study.fixed}
        for i, vary in enumerate(self.vary):
            for key in vary.names:
                if key in seen:
                    raise ValueError(f"vary.{i}: {key} stands in {seen[key]}, too; every key once")
                seen[key] = f"vary.{i}"
        return self

    @model_validator(mode="after")
    def _values_by_the_method(self) -> StudyTables:
        method = self.study.method
        for i, vary in enumerate(self.vary):
            if method not in RANDOM and vary.drawn is not None:
                how = "values = [...], or low, high and count"
                raise ValueError(f"vary.{i}: a {method} has {how}; distributions are for {', '.join(RANDOM)}")
            if method in RANDOM and vary.count is not None:
                raise ValueError(f"vary.{i}: count: even steps are for grid and list; {method} draws its values")
        return self


def checked_study(tables: Mapping[str, Any], label: str) -> StudyTables:
    """A study's tables, checked. Raises InputError that lists every mistake found."""
    try:
        return StudyTables.model_validate(dict(tables))
    except ValidationError as error:
        raise mistaken(label, explained(error, dict(tables), StudyTables)) from None


def mistaken(label: str, problems: list[str]) -> InputError:
    """The error that tells a study's mistakes, a line each."""
    count = "1 mistake" if len(problems) == 1 else f"{len(problems)} mistakes"
    return InputError(f"study {label}: {count}:" + "".join(f"\n  - {p}" for p in problems))
