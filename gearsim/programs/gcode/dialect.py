"""What a control's language knows, as data: which codes, in which groups, and what it does not do here.

Codes of G words are counted in tenths: G43.4 is 434.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from gearsim.errors import InputError


@dataclass(frozen=True)
class Dialect:
    """One control's G-code.

    | field | meaning |
    | --- | --- |
    | ``letters`` | letters that words begin with |
    | ``groups`` | the modal group of every G code that is read; a block has one of each |
    | ``along`` | letters that codes without influence on the path take along |
    | ``refused`` | other known G codes: what they are, and what to do instead |
    | ``m_groups``, ``m_harmless``, ``m_refused`` | the same for M codes |
    | ``m_count`` | how many M codes a block may have |
    | ``axis_words_once`` | G28 and its like may not stand beside G0 to G3 (else these only become modal) |
    | ``start_motion`` | the motion in force at the start (None: none) |
    | ``dwell_unit`` | what P of G4 counts in [s] |
    | ``tool_length_of_tool`` | G43 without H takes the length of the tool in the spindle |
    | ``parameters`` | # parameters, [ ] expressions and O words are part of the language |

    ``feed_of_all_axes``: what F of G94 and G95 counts. False: the linear axes' way, or, where they stand, the
    rotary axes' turn in degrees. True: the root of the squares of all, a degree as a unit of length; in arcs the
    way in their plane. Under tip control it is the tip's way on the workpiece in both.
    """

    name: str
    letters: str
    groups: Mapping[int, str]
    along: Mapping[int, str]
    refused: Mapping[int, str]
    m_groups: Mapping[int, str]
    m_harmless: frozenset[int]
    m_refused: Mapping[int, str]
    m_count: int
    axis_words_once: bool
    start_motion: int | None
    dwell_unit: float
    tool_length_of_tool: bool
    parameters: bool
    feed_of_all_axes: bool


_GROUPS = {
    **dict.fromkeys((0, 10, 20, 30), "motion"),
    **dict.fromkeys((40, 280, 520, 530, 920), "one block"),
    **dict.fromkeys((170, 180, 190), "plane"),
    **dict.fromkeys((200, 210), "units"),
    **dict.fromkeys((400,), "cutter radius"),
    **dict.fromkeys((430, 490), "tool length"),
    **dict.fromkeys((540, 550, 560, 570, 580, 590), "work offset"),
    **dict.fromkeys((610, 640), "path control"),
    **dict.fromkeys((900, 910), "distance"),
    **dict.fromkeys((930, 940, 950), "feed"),
    **dict.fromkeys((980, 990), "return level"),
    970: "spindle mode",
}
_CYCLES = {
    code: "a canned cycle; write its moves out" for code in (730, 740, 760, 810, 820, 830, 840, 850, 860, 870, 880, 890)
}
_REFUSED = {
    **_CYCLES,
    100: "programmable data input; put offsets and tool lengths into the settings",
    300: "the second reference point; use G28",
    310: "a skip or probing move, whose end the program does not state",
    330: "thread cutting with the spindle's position",
    410: "cutter radius compensation on the left; program the tool's centre",
    420: "cutter radius compensation on the right; program the tool's centre",
    960: "constant cutting speed; a mill's spindle turns at G97",
}
_M_GROUPS = {**dict.fromkeys((0, 1, 2, 30), "stop"), **dict.fromkeys((3, 4, 5), "spindle"), 6: "tool change",
             **dict.fromkeys((7, 8, 9), "coolant")}  # fmt: skip

# fmt: off
FANUC = Dialect(
    name="fanuc",
    letters="ABCDFGHIJKMNOPQRSTUVWXYZ",
    groups={
        **_GROUPS,
        800: "canned cycle",
        434: "tool length",
        541: "work offset",
        690: "tilted plane",
        **dict.fromkeys((50, 51, 80), "look-ahead"),
        150: "polar coordinates",
        500: "scaling",
        501: "mirror",
        670: "macro",
    },
    along={50: "PQ", 51: "PQ", 80: "P"},
    refused={
        **_REFUSED,
        70: "hypothetical axis interpolation", 71: "cylindrical interpolation", 90: "exact stop for a block; use G61",
        160: "polar coordinates", 270: "the reference point check", 290: "the way back from the reference point",
        435: "tool centre point control with tool vectors; use G43.4 with rotary axes",
        440: "negative tool length compensation; use G43", 510: "scaling", 511: "mirror",
        531: "tool axis direction control of a tilted plane", 542: "dynamic fixture offset",
        544: "workpiece setting error compensation", 650: "a macro call; expand the macro",
        660: "a modal macro call; expand the macro", 680: "coordinate rotation",
        682: "a tilted working plane; write the moves in machine axes or with G43.4",
        683: "a tilted working plane by the tool's axis; write the moves in machine axes or with G43.4",
    },
    m_groups=_M_GROUPS,
    m_harmless=frozenset((10, 11, 19, 48, 49, 68, 69)),
    m_refused=dict.fromkeys((96, 97, 98, 99), "a subprogram; put its lines in its place"),
    m_count=3,
    axis_words_once=False,
    start_motion=0,
    dwell_unit=1e-3,
    tool_length_of_tool=False,
    parameters=False,
    feed_of_all_axes=True,
)

LINUXCNC = Dialect(
    name="linuxcnc",
    letters="ABCDFGHIJKLMNPQRSTUVWXYZ",
    groups={
        **_GROUPS,
        800: "motion",
        **dict.fromkeys((591, 592, 593), "work offset"),
        **dict.fromkeys((901, 911), "arc distance"),
        921: "one block",
        611: "path control",
        **dict.fromkeys((80,), "diameter mode"),
    },
    along={640: "PQ"},
    refused={
        **_REFUSED,
        50: "a cubic spline", 51: "a quadratic spline", 52: "a NURBS block", 53: "a NURBS block",
        70: "lathe diameters", 171: "the UV plane", 181: "the WU plane", 191: "the VW plane",
        281: "setting the home position; put it into the settings", 301: "setting the second reference point",
        **{380 + i: "probing, whose end the program does not state" for i in range(2, 6)},
        331: "rigid tapping", 411: "dynamic cutter compensation on the left; program the tool's centre",
        421: "dynamic cutter compensation on the right; program the tool's centre",
        431: "a tool length from words; put it into the settings", 432: "a second tool length",
        434: "not of this dialect: LinuxCNC has tool centre point control in its kinematics; use dialect fanuc",
        922: "suspending G92", 923: "restoring G92",
    },
    m_groups={**_M_GROUPS, 60: "stop"},
    m_harmless=frozenset((48, 49, 50, 51, 52, 53)),
    m_refused={
        **dict.fromkeys((428, 429, 430), "switchable kinematics; read the program for one kinematics, without it"),
        61: "setting the tool number without a change; use T and M6",
        **dict.fromkeys((62, 63, 64, 65, 66, 67, 68), "input and output of the control"),
        **dict.fromkeys((70, 71, 72, 73), "saving and restoring modes; write the modes out"),
        98: "a subprogram; use O words", 99: "a subprogram; use O words",
        **dict.fromkeys(range(100, 200), "a command of the machine's owner"),
    },
    m_count=4,
    axis_words_once=True,
    start_motion=None,
    dwell_unit=1.0,
    tool_length_of_tool=True,
    parameters=True,
    feed_of_all_axes=False,
)
# fmt: on

DIALECTS = {dialect.name: dialect for dialect in (FANUC, LINUXCNC)}


def dialect_named(name: str) -> Dialect:
    """The dialect of that name. Raises InputError for unknown names."""
    if name not in DIALECTS:
        raise InputError(f"no G-code dialect {name!r}; there are {', '.join(DIALECTS)}")
    return DIALECTS[name]
