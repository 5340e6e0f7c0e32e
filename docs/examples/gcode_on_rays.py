"""A G-code program read, run on a machine, and cut through rays: what it removes, and which line made it."""

import numpy as np

from gearsim.cutters.catalogue import flat
from gearsim.geometry.rays import RayBundle
from gearsim.machines.catalogue import MACHINES
from gearsim.programs.gcode import read_program
from gearsim.simulation.program import program_operations
from gearsim.simulation.workshop import Workshop

TEXT = """%
O1 (A SLOT AND A STEP)
T1 M06
G90 G94 G54 G21
G00 X-20. Y0. Z5.
G43 H1 Z5.
G01 Z-2. F300
G01 X20.
G01 Z-3. X10.
M30
%
"""
machine = MACHINES["table-table-bc"]()
blocks = read_program(TEXT, machine).blocks
(slot,) = program_operations(blocks, {1: flat(6.0, 20.0)}, tolerance=1e-9, text=TEXT)

x = np.array([-15.0, 0.0, 12.0])
origin = np.column_stack([x, np.full(3, 1.0), np.full(3, -10.0)])
rays = RayBundle(origin, np.tile([0.0, 0.0, 1.0], (3, 1)), np.zeros(3), np.full(3, 10.0))
(removed,) = Workshop("cpu").cut([(rays, [slot])])
for ray, low, segment in zip(removed.ray, removed.lo, removed.lo_segment, strict=True):
    line = slot.line[segment]
    print(f"x = {x[ray]:5.1f}: cut down to z = {low - 10.0:.6f} mm by line {line}: {TEXT.splitlines()[line - 1]}")
