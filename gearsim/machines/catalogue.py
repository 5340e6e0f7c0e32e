"""The machine catalogue: one function a machine; ``MACHINES`` lists them by the names scenes use.

All signs follow gearsim.machines.chain: positive moves the tool relative to the workpiece (ISO 841). Linear
axes count from the work offset: with all axes at zero the tip stands on the workpiece's origin. Points and
pivot lengths are in mm. Travel limits are the machine owner's: add them with ``limited``.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from gearsim.geometry.rigid import Rigid
from gearsim.machines.chain import Joint, Machine, Vector, rotary, slide

_X: Vector = (1.0, 0.0, 0.0)
_Y: Vector = (0.0, 1.0, 0.0)
_Z: Vector = (0.0, 0.0, 1.0)
_MINUS_X: Vector = (-1.0, 0.0, 0.0)
_MINUS_Z: Vector = (0.0, 0.0, -1.0)
_XYZ: tuple[Joint, ...] = (slide("X", _X), slide("Y", _Y), slide("Z", _Z))
_ORIGIN: Vector = (0.0, 0.0, 0.0)

# The gear's axis (z) lies along the machine's x, its x along -z: how bevel generators hold it.
_GEAR_ON_X = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
# A head's z_t points into the work (blades at z_t <= 0, Litvin and Chen 7), a tool's z to its shank.
_HEAD_TO_TOOL = np.diag([1.0, -1.0, -1.0])
# The Star's tool spindle is x_t, the report's cutter axis z_t (errata, STAR_TOOL).
_STAR_TOOL = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def table_table_bc(pivot: Vector = (0.0, 0.0, -120.0), centre: Vector = _ORIGIN) -> Machine:
    """Table C on tilting table B (Groover 2018, section 3.4): tool axis Rz(C) Ry(B) z.

    ``pivot`` is a point of the B axis and ``centre`` one of the C axis, both seen from the workpiece's
    origin with B = C = 0: his L (3.42; the errata read it as the B centre relative to the part origin).
    """
    return Machine("table-table-bc", _XYZ, (rotary("B", _Y, pivot), rotary("C", _Z, centre)))


def table_table_ac(pivot: Vector = (0.0, 0.0, -120.0), centre: Vector = _ORIGIN) -> Machine:
    """Table C on trunnion A (ISO 841 names): tool axis Rz(C) Rx(A) z. ``pivot``, ``centre``: as in B/C."""
    return Machine("table-table-ac", _XYZ, (rotary("A", _X, pivot), rotary("C", _Z, centre)))


def head_head_cb(pivot_length: float = 200.0) -> Machine:
    """Head that turns about C and carries B: tool axis (sin B cos C, sin B sin C, cos B) (Zhou 2015, 4.14).

    ``pivot_length`` from the tip to the B axis along the tool; 200 mm is our choice, the thesis has none.
    """
    pivot = (0.0, 0.0, pivot_length)
    return Machine("head-head-cb", (*_XYZ, rotary("C", _Z), rotary("B", _Y, pivot)), ())


def head_b_table_c(pivot_length: float = 200.0, centre: Vector = _ORIGIN) -> Machine:
    """Swivelling head B over turntable C (ISO 841 names): tool axis Rz(C) Ry(B) z."""
    pivot = (0.0, 0.0, pivot_length)
    return Machine("head-b-table-c", (*_XYZ, rotary("B", _Y, pivot)), (rotary("C", _Z, centre),))


def head_b_table_a(pivot_length: float = 200.0, centre: Vector = (0.0, 0.0, -100.0)) -> Machine:
    """Swivelling head B over a fourth axis A (ISO 841 names): tool axis Rx(A) Ry(B) z."""
    pivot = (0.0, 0.0, pivot_length)
    return Machine("head-b-table-a", (*_XYZ, rotary("B", _Y, pivot)), (rotary("A", _X, centre),))


def phoenix(mounting: float = 120.0) -> Machine:
    """Six-axis Phoenix (Litvin and Chen 1994, sections 1 and 2): L_pt = Rx(-psi) Ry(phi) Rz(mu).

    | axis | in the report | sign (errata, "Phoenix signs") |
    | --- | --- | --- |
    | X, Y, Z | x_m, y_m, z_m of O_h | the head against the B axis |
    | A | -psi | the workpiece turns by -A about its axis x_d |
    | B | phi | the work head turns by -B about y_m |
    | C | mu | the tool turns by C about z_t |

    ``mounting`` is the report's constant x_e of O_d: from the B axis to the workpiece's origin (120 mm
    assumed in the errata; 6 gives the tip as x_m cos phi + z_m sin phi - mounting along x_p). X, Y, Z count
    from the B axis, as x_m, y_m, z_m do. The workpiece frame has z along x_p and x along -z_p.
    """
    place = Rigid(_GEAR_ON_X, np.array([mounting, 0.0, 0.0]))
    work = (rotary("B", _Y), rotary("A", _X))
    return Machine("phoenix", (*_XYZ, rotary("C", _Z)), work, Rigid(_HEAD_TO_TOOL, np.zeros(3)), place)


def star() -> Machine:
    """Six-axis Star (Litvin and Chen 1994, section 1, figure 11); axes chosen in the errata:

    L_pt = Rx(-psi) Ry(phi) Rx(mu), tip Rx(-psi) [(x, 0, 0) + Ry(phi) (0, y, z)] in S_p. The axis A is -psi,
    B is phi and D, a second rotation about x, is mu. The workpiece frame is as in ``phoenix``.
    """
    tool = (slide("X", _X), rotary("B", _Y), slide("Y", _Y), slide("Z", _Z), rotary("D", _X))
    place = Rigid(_GEAR_ON_X, np.zeros(3))
    return Machine("star", tool, (rotary("A", _X),), Rigid(_STAR_TOOL @ _HEAD_TO_TOOL, np.zeros(3)), place)


def cradle() -> Machine:
    """The conventional cradle generator as a chain (Zhou 2015, A.1; Litvin and Chen 1994, (9)).

    Its axes are the settings of gearsim.machines.generator by name, ``cradle_angle`` being the sum of basic
    cradle angle and roll, and ``work_angle`` the gear's rotation. Nine axes: it has no inverse.
    """
    tool = (
        slide("sliding_base", _MINUS_Z),
        rotary("cradle_angle", _Z),
        slide("radial_distance", _X),
        rotary("swivel", _Z),
        rotary("tilt", _MINUS_X),
    )
    work = (
        slide("blank_offset", _Y),
        rotary("machine_root_angle", _Y),
        slide("machine_centre_to_back", _MINUS_X),
        rotary("work_angle", _MINUS_X),
    )
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    head = Rigid(quarter @ _HEAD_TO_TOOL, np.zeros(3))
    return Machine("cradle", tool, work, head, Rigid(_GEAR_ON_X, np.zeros(3)))


MACHINES: dict[str, Callable[..., Machine]] = {
    "table-table-bc": table_table_bc,
    "table-table-ac": table_table_ac,
    "head-head-cb": head_head_cb,
    "head-b-table-c": head_b_table_c,
    "head-b-table-a": head_b_table_a,
    "phoenix": phoenix,
    "star": star,
    "cradle": cradle,
}
