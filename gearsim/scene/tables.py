"""Tables that scenes of every kind share, and the kinds of numbers that stand in them."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

_IN_NO_NAME = frozenset('/\\:*?"<>|')


def file_name(text: str) -> str:
    """The text, where files and folders can be called so in any system. Raises ValueError where they cannot."""
    strange = sorted({c for c in text if c in _IN_NO_NAME or not c.isprintable()})
    if strange:
        raise ValueError(f"got {text!r}; files are called so, and {strange[0]!r} stands in no file's name")
    if not 0 < len(text.encode()) <= _LONGEST_NAME or text != text.strip(" .~-"):
        raise ValueError(
            f"got {text!r}; files are called so: expected 1 to {_LONGEST_NAME} bytes, no blank, dot, ~ or - at the ends"
        )
    return text


FileName = Annotated[str, AfterValidator(file_name)]
_LONGEST_NAME = 200
_MOST_SAMPLES = 1_000_000  # of a grid


def _zero_or_seen(value: float) -> float:
    if 0.0 < value < _LEAST:
        raise ValueError(f"got {value:g}; expected 0, or {_LEAST:g} and more")
    return value


_LEAST = 1e-9  # of a length: below it coordinates are rounded
Length = Annotated[float, Field(ge=_LEAST, lt=1e5, allow_inf_nan=False)]
LengthOrZero = Annotated[float, Field(ge=0.0, lt=1e5, allow_inf_nan=False), AfterValidator(_zero_or_seen)]
Angle = Annotated[float, Field(ge=5.0, le=45.0, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=2, le=4097)]


class Table(BaseModel):
    """Keys of fixed types: ``"9"`` and ``true`` are no numbers, 1 is no truth; a whole number is a number."""

    model_config = ConfigDict(defer_build=True, extra="forbid", frozen=True, strict=True)

    @model_validator(mode="before")
    @classmethod
    def _lists_are_tuples(cls, data: Any) -> Any:
        return {key: _tuples(value) for key, value in data.items()} if isinstance(data, dict) else data


def _tuples(value: Any) -> Any:
    """A value with its lists as tuples, those within tables of free keys too."""
    if isinstance(value, dict):
        return {key: _tuples(v) for key, v in value.items()}
    return tuple(map(_tuples, value)) if isinstance(value, list) else value


class GridTable(Table):
    """What tables [metrology] share: the rows and columns of a dense grid."""

    rows: Count
    columns: Count

    @property
    def samples(self) -> int:
        """How many samples the largest grid has."""
        return self.rows * self.columns

    @model_validator(mode="after")
    def _few_enough(self) -> GridTable:
        if self.samples > _MOST_SAMPLES:
            raise ValueError(
                f"rows {self.rows} and columns {self.columns} make {self.samples:,} samples; expected no more than "
                f"{_MOST_SAMPLES:,}"
            )
        return self
