"""What the frames of coordinates are called, in words, and how a flank-milled gear lies on its machine."""

import numpy as np

from gearsim.geometry.rigid import Rigid

GEAR_FRAME = "gear frame: z along the gear axis, origin at the apex of the pitch cone"
PINION_FRAME = "pinion frame: z along the pinion axis, origin at the apex of its pitch cone"
PROGRAM_FRAME = "workpiece frame of the NC program"
FACE_FRAME = "face frame: z along the gear axis, z = 0 at the top face, space 0 on +x there"
NET_FRAME = "part frame of the control net: the tool axis is +z"
CLAMPED = Rigid(np.diag([1.0, -1.0, -1.0]), np.zeros(3))  # from the gear frame to its program's: it lies on its back
