"""Which parameter matters, in words and tables, as Markdown."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from gearsim.output.markdown import table, um
from gearsim.studies.importance import Effect, Importance
from gearsim.studies.records import Study
from gearsim.studies.regression import Estimate
from gearsim.studies.summary_figures import label, micro

_MOST = 12  # parameters in a figure's table
_MOST_PAIRS = 3
_PAIR = 0.01
_BY = {
    "expansion": "Shares of the variance are Sobol indices, from a polynomial chaos expansion fitted to the jobs",
    "grid": "Shares of the variance over the grid (analysis of variance, exact: nothing was drawn)",
}


def overview(found: Sequence[Importance]) -> str:
    """A row a parameter, a column a figure: the total share of variance, or else the standardised coefficient."""
    names = list(dict.fromkeys(e.name for one in found for e in one.effects))
    cells = [{e.name: _cell(one, e.total, e.standardised) for e in one.effects} for one in found]
    rows = [[f"`{name}`", *(column.get(name, "–") for column in cells)] for name in names]
    if not rows:
        return ""
    return table(["Parameter", *(label(one.figure) for one in found)], rows) + (
        "\nIn %: the share of the figure's variance that the parameter makes, alone and with others; without %: the "
        "standardised regression coefficient, from −1 to 1, where there are no shares.\n"
    )


def _cell(one: Importance, total: Estimate, standardised: Estimate) -> str:
    if one.shares_by:
        return _percent(total)
    return "–" if np.isnan(standardised.value) else f"{standardised.value:+.2f}".replace("-", "−")


def effects(found: Importance, study: Study) -> str:
    """One figure: how it was reckoned, what limits that, and a row a parameter."""
    units = {p.key: p.unit for p in study.parameters}
    rows = [_row(e, found.deviation, units) for e in found.effects[:_MOST]]
    heads = ["Parameter", "alone", "with others", "alone [µm]", "standardised", "slope"]
    kept = [k for k in range(6) if k == 0 or any(row[k] != "–" for row in rows)]
    shown = table([heads[k] for k in kept], [[row[k] for k in kept] for row in rows]) if len(kept) > 1 else ""
    return f"{_how(found)}\n\n{_limits(found)}{shown}{_pairs(found)}"


def _row(e: Effect, deviation: float, units: dict[str, str]) -> list[str]:
    shares = [_interval(e.first, _percent), _interval(e.total, _percent), _spread(e.first, deviation)]
    slope = _interval(e.slope, _slope) + _per(e.name, units, e.slope)
    return [f"`{e.name}`", *shares, _interval(e.standardised, _signed), slope]


def _how(found: Importance) -> str:
    said = [f"Standard deviation {um(found.deviation)} µm over {found.used:,} jobs."]
    if found.shares_by:
        fit = f" (Q² {found.explained:.3f})" if found.shares_by == "expansion" else ""
        said.append(f"{_BY[found.shares_by]}{fit}.")
    if np.isfinite(found.r2):
        said.append(f"Linear regression: R² {max(found.r2, 0.0):.3f}.")
    return " ".join(said)


def _limits(found: Importance) -> str:
    return "".join(f"- {_begun(text)}.\n" for text in found.told) + "\n" * bool(found.told)


def _begun(text: str) -> str:
    """As a sentence begins; a key, which has a dot, stays as it is spelt."""
    return text if "." in text.partition(" ")[0] else text[0].upper() + text[1:]


def _pairs(found: Importance) -> str:
    if not found.together:
        return ""
    large = [f"{name} {100.0 * share:.0f} %" for name, share in found.together if share >= _PAIR][:_MOST_PAIRS]
    whole = max(0.0, sum(share for _, share in found.together))  # rounding leaves less than nothing
    most = f", most: {'; '.join(large)}" if large else ""
    return f"\nParameters make {100.0 * whole:.0f} % of the variance together{most}.\n"


def _interval(e: Estimate, text: Callable[[Estimate], str]) -> str:
    if np.isnan(e.value):
        return "–"
    if np.isnan(e.low):
        return text(e)
    ends = f"{text(Estimate(e.low))} to {text(Estimate(e.high))}".replace("\u00a0%", "")
    return f"{text(e)} ({ends})".replace(" ", "\u00a0")


def _percent(e: Estimate) -> str:
    if np.isnan(e.value):
        return "–"
    share = 100.0 * e.value
    return (f"{share:.0f}" if share >= 1.0 or share < 5e-4 else f"{share:.1g}") + "\u00a0%"


def _signed(e: Estimate) -> str:
    return f"{e.value:+.2f}".replace("-", "−")


def _slope(e: Estimate) -> str:
    return f"{e.value:.3g}".replace("-", "−")


def _per(name: str, units: dict[str, str], slope: Estimate) -> str:
    if np.isnan(slope.value):
        return ""
    unit = units.get(name.split(" and ")[0], "1")
    return " µm" if unit == "1" else f" µm per {micro(unit)}"


def _spread(first: Estimate, deviation: float) -> str:
    """The standard deviation [um] that the figure would have if this parameter alone varied."""
    return "–" if np.isnan(first.value) else um(float(np.sqrt(first.value)) * deviation)
