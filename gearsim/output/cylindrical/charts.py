"""All flat pictures of a gear that was cut and inspected."""

from __future__ import annotations

from pathlib import Path

from gearsim.output.cylindrical.maps import flank_maps
from gearsim.output.cylindrical.pitch import draw_pitch
from gearsim.output.cylindrical.roughness import draw_roughness
from gearsim.output.cylindrical.section import draw_section
from gearsim.output.cylindrical.sheet import inspection_sheet
from gearsim.output.cylindrical.topography import draw_topography
from gearsim.output.cylindrical.traces import draw_traces
from gearsim.result import GearResult


def draw_charts(result: GearResult, folder: Path) -> None:
    """Draw them into a folder."""
    name, found, gear = result.name, result.inspection, result.gear
    tolerances = found.tolerances_um
    inspection_sheet(found, folder / "inspection.png")
    draw_traces(found.profile, gear, tolerances, f"{name}: profile", folder / "profile.png")
    draw_traces(found.helix, gear, tolerances, f"{name}: helix", folder / "helix.png")
    draw_pitch(found.pitch, found.runout, tolerances, f"{name}: pitch", folder / "pitch.png")
    draw_topography(flank_maps(result), gear, f"{name}: flank topography", folder / "deviation.png")
    draw_roughness(result.roughness, f"{name}: roughness of the path alone", folder / "roughness.png")
    draw_section(result, folder / "section.png")
