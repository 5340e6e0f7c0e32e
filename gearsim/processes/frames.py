"""What the frames of coordinates are called, in words."""

GEAR_FRAME = "gear frame: z along the gear axis, origin at the apex of the pitch cone"
PINION_FRAME = "pinion frame: z along the pinion axis, origin at the apex of its pitch cone"
PROGRAM_FRAME = "workpiece frame of the NC program"
FACE_FRAME = "face frame: z along the gear axis, z = 0 at the top face, space 0 on +x there"
NET_FRAME = "part frame of the control net: the tool axis is +z"
