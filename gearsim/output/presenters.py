"""How measurements are told and drawn: one module for each of their classes, found here by the class's name.

A presenter module may have any of these functions; ``found`` are a result's measurements of its class:

| function | gives |
| --- | --- |
| ``figures(measurement)`` | plain values for report.json |
| ``sections(result, found)`` | Markdown by the report's slots (``SLOTS``) |
| ``charts(result, found)`` | flat pictures that can be drawn, as ``Chart`` |
| ``layers(result, found)`` | arrays for the 3D pictures, which are listed in ``output.drawer`` |
| ``maps(result, found)`` | parts of EXR files: channels by part, by file name |
| ``rows(result, found)`` | columns of samples.parquet, one table a surface |
| ``columns(result, found)`` | more columns of these tables, by surface |
| ``screen(result, found, console)`` | prints what a user wants first |
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType
from typing import Any

from gearsim.result import Result

SLOTS = ("first", "costs", "trust", "findings", "notes", "beside", "convergence", "details")

_MODULES = {
    "GearMeasurement": "gear.inspection",
    "ReachMeasurement": "gear.reach",
    "SectionMeasurement": "gear.whole",
    "GougingMeasurement": "gouging.cuts",
    "GridMeasurement": "grids",
    "ProfileMeasurement": "mean_profile",
    "ConvergenceMeasurement": "convergence",
    "DexelMeasurement": "dexels",
    "BudgetMeasurement": "gear.budget",
    "RoughnessMeasurement": "gear.rough",
    "ProgramMeasurement": "programs",
    "MillMeasurement": "gouging.mills",
    "ContactMeasurement": "gouging.contact",
    "WorkedMeasurement": "gouging.worked",
}


def presented(result: Result) -> list[tuple[ModuleType, list[Any]]]:
    """The presenters of a result's measurements with what each presents, in the order of the list."""
    by_class: dict[str, list[Any]] = {}
    for measurement in result.measurements.values():
        by_class.setdefault(type(measurement).__name__, []).append(measurement)
    unknown = set(by_class) - set(_MODULES)
    if unknown:
        raise LookupError(f"no presenter for {', '.join(sorted(unknown))}")
    own = [(_module(name), by_class[name]) for name in _MODULES if name in by_class]
    return [*own, (import_module("gearsim.output.motions"), [])]


def presenter(measurement: Any) -> ModuleType:
    """The module that presents a measurement."""
    return _module(type(measurement).__name__)


def flat_figures(measurement: Any) -> dict[str, Any]:
    """A measurement's figures with their names joined by dots."""
    return _flat(presenter(measurement).figures(measurement))


def _flat(values: dict[str, Any], name: str = "") -> dict[str, Any]:
    out: dict[str, Any] = {}
    for key, value in values.items():
        full = f"{name}.{key}" if name else str(key)
        out |= _flat(value, full) if isinstance(value, dict) else {full: value}
    return out


def collected(result: Result, function: str, *arguments: Any) -> list[Any]:
    """What a function of all presenters that have it gives, in their order."""
    return [
        getattr(module, function)(result, found, *arguments)
        for module, found in presented(result)
        if hasattr(module, function)
    ]


def slug(name: str) -> str:
    """A name as it stands in keys, columns and channels: ``own pass`` is ``own_pass``."""
    return "_".join(name.replace("=", " ").split())


def _module(name: str) -> ModuleType:
    return import_module(f"gearsim.output.{_MODULES[name]}")
