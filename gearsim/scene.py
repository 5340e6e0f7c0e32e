"""Scenes: TOML files turned into the dataclasses of the other rooms, with every mistake told at once."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from difflib import get_close_matches
from importlib.resources import files
from math import degrees, radians
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from gearsim.cutters.catalogue import apt, conical
from gearsim.cutters.profile import Profile
from gearsim.errors import InputError, read_input
from gearsim.surfaces.blank import BevelBlank, outer_cone_distance, pitch_angle
from gearsim.surfaces.ruled_bevel import RuledBevelTooth

Length = Annotated[float, Field(gt=0.0, lt=1e5, allow_inf_nan=False)]
LengthOrZero = Annotated[float, Field(ge=0.0, lt=1e5, allow_inf_nan=False)]
Angle = Annotated[float, Field(ge=5.0, le=45.0, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=2, le=4097)]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=False)


class SceneHeader(_Table):
    """Table [scene]: what the scene is called and shows."""

    name: str = Field(min_length=1)
    summary: str = ""


class RuledBevelTable(_Table):
    """Table [surface] of kind ``ruled-bevel``: blank and tooth of a ruled spiral bevel gear."""

    kind: Literal["ruled-bevel"]
    teeth: int = Field(ge=5, le=1000)
    mate_teeth: int = Field(ge=3, le=1000)
    hand: Literal["left", "right"]
    module_mm: Length
    shaft_angle_deg: float = Field(gt=0.0, lt=180.0, allow_inf_nan=False)
    spiral_angle_deg: float = Field(ge=0.0, lt=60.0, allow_inf_nan=False)
    face_width_mm: Length
    addendum_mm: Length
    dedendum_mm: Length
    face_angle_deg: float = Field(gt=0.0, lt=180.0, allow_inf_nan=False)
    root_angle_deg: float = Field(gt=0.0, lt=180.0, allow_inf_nan=False)
    clearance_mm: LengthOrZero
    rim_mm: Length
    lengthwise_radius_mm: Length
    bottom_half_width_mm: LengthOrZero
    fillet_radius_mm: LengthOrZero
    pressure_angle_deg: Angle
    start_angle_deg: float = Field(default=0.0, allow_inf_nan=False)

    def build(self) -> RuledBevelTooth:
        """The tooth slot on its blank."""
        pitch = pitch_angle(self.teeth, self.mate_teeth, radians(self.shaft_angle_deg))
        blank = BevelBlank(
            self.teeth, pitch, outer_cone_distance(self.module_mm, self.teeth, pitch), self.face_width_mm,
            self.addendum_mm, self.dedendum_mm, radians(self.face_angle_deg), radians(self.root_angle_deg),
            self.clearance_mm, self.rim_mm,
        )  # fmt: skip
        return RuledBevelTooth(
            blank, radians(self.spiral_angle_deg), self.hand, self.lengthwise_radius_mm,
            self.bottom_half_width_mm, self.fillet_radius_mm, radians(self.pressure_angle_deg),
            radians(self.start_angle_deg),
        )  # fmt: skip


class ConicalTable(_Table):
    """Table [cutter] of kind ``conical``: conical end mill with corner fillet."""

    kind: Literal["conical"]
    bottom_radius_mm: LengthOrZero
    fillet_radius_mm: LengthOrZero
    taper_deg: float = Field(gt=-45.0, lt=45.0, allow_inf_nan=False)
    height_mm: Length

    def build(self) -> Profile:
        return conical(self.bottom_radius_mm, self.fillet_radius_mm, radians(self.taper_deg), self.height_mm)


class AptTable(_Table):
    """Table [cutter] of kind ``apt``: the seven APT parameters."""

    kind: Literal["apt"]
    d_mm: Length
    r_mm: LengthOrZero
    e_mm: LengthOrZero
    f_mm: LengthOrZero
    alpha_deg: float = Field(ge=0.0, lt=90.0, allow_inf_nan=False)
    beta_deg: float = Field(gt=-90.0, lt=90.0, allow_inf_nan=False)
    h_mm: Length

    def build(self) -> Profile:
        return apt(
            self.d_mm,
            self.r_mm,
            self.e_mm,
            self.f_mm,
            radians(self.alpha_deg),
            radians(self.beta_deg),
            self.h_mm,
        )


class ToolpathTable(_Table):
    """Table [toolpath]: our planner's values, or ``file``, a CL file to read instead."""

    file: str | None = None
    points: Count = 65
    run_mm: LengthOrZero = 8.0
    retract_mm: Length = 15.0
    feed_mm_min: Length = 600.0
    decimals: int = Field(default=9, ge=3, le=12)

    @model_validator(mode="after")
    def _file_alone(self) -> ToolpathTable:
        planned = sorted(self.model_fields_set - {"file"})
        if self.file is not None and planned:
            raise ValueError(f"'file' replaces our planner; remove {', '.join(planned)}")
        return self


class SimulationTable(_Table):
    """Table [simulation]: numerical settings of the removal road."""

    tolerance_mm: float = Field(default=1e-9, ge=1e-12, le=1e-2)
    compile_tolerance_mm: float = Field(default=1e-9, ge=1e-12, le=1e-2)
    interval_slots: int = Field(default=16, ge=1, le=256)
    dexel_pitch_mm: float = Field(default=0.15, gt=0.0, le=10.0)


class MetrologyTable(_Table):
    """Table [metrology]: what is measured, and the tolerances of the verdict."""

    tolerance_um: Length
    root_tolerance_um: Length
    rows: Count = 21
    columns: Count = 257
    margin: float = Field(default=0.01, gt=0.0, lt=0.5)
    inspection_rows: Count = 5
    inspection_columns: Count = 9
    inspection_margin: float = Field(default=0.1, gt=0.0, lt=0.5)
    window: float = Field(default=1.0, gt=0.0, le=4.0)
    profile_offsets_mm: tuple[float, ...] = (0.0, 0.5, -0.5, 1.5, -1.5, 3.0, -3.0)
    convergence: tuple[Count, ...] = (9, 17, 33, 65, 129, 257)


class ReferenceTable(_Table):
    """Table [reference]: published deviations to print beside ours."""

    source: str
    note: str = ""
    overcut_is_positive: bool
    convex_um: tuple[float, ...]
    concave_um: tuple[float, ...]


class Scene(_Table):
    """A job: the surface wanted, the cutter, the toolpath, and how it is simulated and measured."""

    scene: SceneHeader
    surface: RuledBevelTable
    cutter: Annotated[ConicalTable | AptTable, Field(discriminator="kind")]
    toolpath: ToolpathTable = ToolpathTable()
    simulation: SimulationTable = SimulationTable()
    metrology: MetrologyTable
    reference: ReferenceTable | None = None

    @property
    def name(self) -> str:
        return self.scene.name

    def tooth(self) -> RuledBevelTooth:
        return self.surface.build()

    def tool(self) -> Profile:
        return self.cutter.build()


def scene_names() -> dict[str, str]:
    """Built-in scenes and their one-line summaries."""
    found = {}
    for entry in sorted(files("gearsim.scenes").iterdir(), key=lambda e: e.name.removesuffix(".toml")):
        if entry.name.endswith(".toml"):
            header = tomllib.loads(entry.read_text(encoding="utf-8"))["scene"]
            found[entry.name.removesuffix(".toml")] = header["summary"]
    return found


def scene_text(name_or_path: str) -> tuple[str, str, Path]:
    """TOML text of a built-in scene or file, the name to use in messages, and its folder."""
    path = Path(name_or_path)
    if name_or_path in scene_names():
        return (
            files("gearsim.scenes").joinpath(f"{name_or_path}.toml").read_text("utf-8"),
            name_or_path,
            Path(),
        )
    if path.suffix == ".toml" or path.is_file():
        return read_input(path, "scene"), str(path), path.parent
    near = get_close_matches(name_or_path, scene_names(), n=1, cutoff=0.4)
    hint = f"; did you mean {near[0]!r}?" if near else "."
    raise InputError(
        f"no scene named {name_or_path!r}{hint} Built-in scenes: {', '.join(scene_names())}. "
        "Or give the path of a .toml file."
    )


def load_scene(name_or_path: str | Path, overrides: Sequence[str] = ()) -> tuple[Scene, Path]:
    """A scene by built-in name or path, with ``key=value`` overrides; and the folder its files are in.

    Raises InputError that lists every mistake found.
    """
    text, label, folder = scene_text(str(name_or_path))
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"scene {label}: not valid TOML: {error}") from error
    for override in overrides:
        _override(data, override)
    return check_scene(data, label), folder


def check_scene(data: dict[str, Any], label: str) -> Scene:
    """Validate a scene given as nested tables. Raises InputError that lists every mistake found."""
    try:
        scene = Scene.model_validate(data)
    except ValidationError as error:
        raise _input_error(label, [_explain(e, data) for e in error.errors()]) from None
    problems = []
    for build in (scene.tooth, scene.tool):
        try:
            build()
        except InputError as error:
            problems.append(str(error))
    if problems:
        raise _input_error(label, problems)
    return scene


def _input_error(label: str, problems: list[str]) -> InputError:
    count = "1 mistake" if len(problems) == 1 else f"{len(problems)} mistakes"
    return InputError(f"scene {label}: {count}:" + "".join(f"\n  - {p}" for p in problems))


def _override(data: dict[str, Any], override: str) -> None:
    """Apply one ``table.key=value`` to the tables; the value is read as TOML, else as a string."""
    key, equals, value = override.partition("=")
    parts = key.strip().split(".")
    if not equals or len(parts) < 2:
        raise InputError(f"--set {override}: expected table.key=value, for instance metrology.rows=9")
    try:
        parsed = tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        parsed = value
    table = data
    for part in parts[:-1]:
        table = table.setdefault(part, {})
        if not isinstance(table, dict):
            raise InputError(f"--set {override}: {part!r} is a value, not a table")
    table[parts[-1]] = parsed


def _explain(error: Any, data: dict[str, Any]) -> str:
    """One validation error in words: the field, what came, what would be right."""
    where = [p for p in error["loc"] if p not in ("conical", "apt")]
    field = ".".join(str(p) for p in where)
    kind, got, context = error["type"], error["input"], error.get("ctx", {})
    if kind == "extra_forbidden":
        known = _known_keys(where[:-1], data)
        near = get_close_matches(str(where[-1]), known, n=1, cutoff=0.3)
        return f"{field}: unknown key" + (f"; did you mean {near[0]!r}?" if near else f"; known: {', '.join(known)}")
    if kind == "missing":
        return f"{field}: missing"
    if kind == "union_tag_invalid":
        return f"{field}.kind: got {context['tag']}; expected {context['expected_tags']}"
    if kind == "union_tag_not_found":
        return f"{field}.kind: missing; expected 'conical' or 'apt'"
    if kind == "value_error":
        return f"{field}: {context['error']}"
    return f"{field}: got {got!r}; {error['msg'][0].lower()}{error['msg'][1:]}" + _unit_hint(field, got)


def _known_keys(where: list[Any], data: dict[str, Any]) -> list[str]:
    """The keys a table may have."""
    tables: dict[str, type[_Table]] = {
        "scene": SceneHeader, "surface": RuledBevelTable, "toolpath": ToolpathTable,
        "simulation": SimulationTable, "metrology": MetrologyTable, "reference": ReferenceTable,
        "cutter": AptTable if data.get("cutter", {}).get("kind") == "apt" else ConicalTable,
    }  # fmt: skip
    table = tables.get(str(where[0])) if where else Scene
    return list((table or Scene).model_fields)


def _unit_hint(field: str, got: Any) -> str:
    """A remark where a value looks as if it were in another unit."""
    if not isinstance(got, int | float) or isinstance(got, bool):
        return ""
    if field.endswith("_deg") and 0.0 < got < 1.6:
        return f" (angles are in degrees; {got:g} rad would be {degrees(got):.4g})"
    if field.endswith("_mm") and got >= 1e5:
        return f" (lengths are in mm; {got:g} um would be {got / 1e3:g})"
    return ""


def scene_table(scene: Scene) -> dict[str, Any]:
    """The scene as nested plain tables, defaults filled in, as it goes into the report."""
    return scene.model_dump(exclude_none=True)
