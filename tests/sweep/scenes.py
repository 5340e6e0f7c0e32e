"""The built-in scenes as nested tables, coarse enough that each is planned in a second and cut in a few."""

import tomllib
from functools import cache

from gearsim.scene import scene_text

_GRID = {"metrology.rows": 3, "metrology.columns": 5, "simulation.dexel_pitch_mm": 1.0}
_COARSE = {
    "ruled-bevel": {"toolpath.points": 9, "metrology.inspection_rows": 3, "metrology.inspection_columns": 3,
                    "metrology.convergence": [5, 9]},
    "face-milled": {},
    "hypoid-pinion": {"toolpath.rows": 9, "metrology.convergence": [5, 9]},
    "envelope": {},
    "nurbs": {"toolpath.stepover_mm": 40.0, "toolpath.points": 5, "toolpath.chord_um": 0.9},
    "gouge-example": {},
    "solid-part": {"stock.pitch_mm": 2.0},
    "faced-part": {"stock.pitch_mm": 2.0},
    "cylindrical-gear": {
        "surface.teeth": 9, "surface.face_width_mm": 4.0, "surface.rim_mm": 8.25,
        "toolpath.facing.radius_mm": 31.0, "toolpath.bore.radius_mm": 8.0, "toolpath.root.axial_step_mm": 4.0,
        "toolpath.outside.blank_radius_mm": 30.0, "toolpath.outside.radius_mm": 27.5,
        "stock.pitch_mm": 2.0, "stock.blank.diameter_mm": 60.0, "stock.blank.bottom_mm": -4.0,
        "toolpath.slots.radial_immersion": 1.0, "toolpath.slots.radial_step_mm": 5.0,
        "toolpath.roughing.radial_immersion": 1.0, "toolpath.roughing.axial_step_mm": 4.0,
        "toolpath.roughing.involute_step_mm": 5.0,
        "toolpath.finishing.axial_step_mm": 4.0, "toolpath.finishing.involute_step_mm": 5.0,
        "budget.decimals": [4], "budget.involute_steps_mm": [5.0], "budget.axial_steps_mm": [],
        "metrology.spaces": 1, "metrology.points": 9, "metrology.section_pitch_mm": 0.5,
    },
}  # fmt: skip
_COARSE["face-milled-flank"] = _COARSE["ruled-bevel"]


@cache
def small(name):
    """A built-in scene's tables, coarse; only keys that stand in it are changed. Not to be written to."""
    tables = tomllib.loads(scene_text(name)[0])
    for place, value in (_GRID | _COARSE[tables["surface"]["kind"]]).items():
        *above, key = place.split(".")
        table = tables
        for part in above:
            table = table.get(part, {})
        if key in table:
            table[key] = value
    if tables["surface"].get("teeth", 0) < 0 or name.endswith("internal"):
        tables["surface"]["teeth"] = -20
    return tables


def to_toml(tables) -> str:
    """Nested tables as a TOML file, dictionaries within lists as inline tables."""
    return "".join(f"{_key(key)} = {_value(value)}\n" for key, value in tables.items())


def _value(value) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return _key(value) if isinstance(value, str) else repr(value)


def _key(text) -> str:
    inner = "".join(c if c.isprintable() and c not in '"\\' else f"\\u{ord(c):04x}" for c in text)
    return f'"{inner}"'
