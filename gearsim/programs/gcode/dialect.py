"""What a control's language knows, as data: which codes, in which groups, and what it does not do here.

Codes of G words are counted in tenths: G43.4 is 434.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from gearsim.errors import InputError
from gearsim.programs.gcode.arc_rules import FANUC_ARCS, LINUXCNC_ARCS, ArcRules


@dataclass(frozen=True)
class Dialect:
    """One control's G-code.

    | field | meaning |
    | --- | --- |
    | ``letters`` | letters that words begin with |
    | ``groups`` | the modal group of every G code that is read; a block has one of each |
    | ``along`` | letters that codes without influence on the path take along |
    | ``own_axes`` | codes that are no motion and whose axis words are their own: these move nothing |
    | ``refused`` | other known G codes: what they are, and what to do instead |
    | ``m_groups``, ``m_harmless``, ``m_refused`` | the same for M codes |
    | ``m_along`` | letters that M codes take along |
    | ``m_count`` | how many M codes a block may have |
    | ``idle_letters`` | letters that say nothing about the path |
    | ``axis_words_once`` | G28 and its like may not stand beside G0 to G3 (else these only become modal) |
    | ``moves_at_code`` | G1, G2 and G3 ask for their words even where a block has no axis |
    | ``start_motion`` | the motion in force at the start (None: none) |
    | ``dwell_unit`` | what P of G4 counts in [s] |
    | ``tool_length_of_tool`` | T is one of the table of lengths, G43 without H or with H0 takes the tool's |
    | ``length_off_letters`` | letters that G49 takes along |
    | ``parameters`` | # parameters, [ ] expressions and O words are part of the language |
    | ``semicolon_ends_block`` | what stands behind ``;`` is the next block (else a comment) |
    | ``one_register`` | G52 and G92 set one and the same offset (else G92 ends G52 for its axes) |
    | ``feed_before_units`` | F counts by the units before, where the units of the program have been stated already |
    | ``feed_mode_clears_feed`` | G94 and G95 forget F even where they are in force already |
    | ``incremental_tables`` | G10 under G91 adds to what the table holds |
    | ``turns`` | P of G2 and G3 counts turns |
    | ``arcs`` | what passes as an arc |
    | ``line_limit`` | how many characters a line may have |
    | ``whole_within``, ``code_within`` | how far whole numbers and tenths of G codes may be off one |

    ``feed_of_all_axes``: what F of G94 and G95 counts. False: the linear axes' way, or, where they stand, the
    rotary axes' turn in degrees. True: the root of the squares of all, a degree as a unit of length; in arcs the
    way in their plane. Under tip control it is the tip's way on the workpiece in both. False has F of G93 as well
    count a way, so that a block that moves nothing takes no time.
    """

    name: str
    letters: str
    groups: Mapping[int, str]
    along: Mapping[int, str]
    own_axes: frozenset[int]
    refused: Mapping[int, str]
    m_groups: Mapping[int, str]
    m_harmless: frozenset[int]
    m_refused: Mapping[int, str]
    m_along: Mapping[int, str]
    m_count: int
    idle_letters: str
    axis_words_once: bool
    moves_at_code: bool
    start_motion: int | None
    dwell_unit: float
    tool_length_of_tool: bool
    length_off_letters: str
    parameters: bool
    semicolon_ends_block: bool
    one_register: bool
    feed_before_units: bool
    feed_mode_clears_feed: bool
    incremental_tables: bool
    turns: bool
    arcs: ArcRules
    feed_of_all_axes: bool
    line_limit: int
    whole_within: float
    code_within: float


_GROUPS = {
    **dict.fromkeys((0, 10, 20, 30), "motion"),
    **dict.fromkeys((40, 100, 280, 520, 530, 920), "one block"),
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
    letters="ABCDFGHIJKLMNOPQRSTUVWXYZ",
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
    along={50: "PQ", 51: "PQR", 80: "P"},
    own_axes=frozenset((50, 51, 100, 280, 501, 520, 920)),
    refused={
        **_REFUSED,
        110: "the end of data input", 121: "polar coordinate interpolation", 131: "polar coordinate interpolation",
        921: "presetting the work coordinates", 401: "normal direction control", 411: "normal direction control",
        421: "normal direction control",
        70: "hypothetical axis interpolation", 71: "cylindrical interpolation", 90: "exact stop for a block; use G61",
        160: "polar coordinates", 270: "the reference point check", 290: "the way back from the reference point",
        **dict.fromkeys((22, 32), "involute interpolation"), **dict.fromkeys((23, 33), "exponential interpolation"),
        **dict.fromkeys((24, 34), "three-dimensional circular interpolation"), 62: "a NURBS block",
        **dict.fromkeys((1070, 1120, 1130), "cylindrical or polar interpolation"),
        **dict.fromkeys((220, 230), "the stored stroke check"), 301: "the floating reference point",
        370: "measuring a tool's length", 431: "a tool length along the tool's axis; use G43.4",
        435: "tool centre point control with tool vectors; use G43.4 with rotary axes",
        **dict.fromkeys((450, 460, 470, 480), "a tool offset of the axes; program the tool's centre"),
        **dict.fromkeys((502, 512), "polygon turning"), 600: "positioning from one side",
        **dict.fromkeys((620, 630), "another feed in corners or for tapping; use G64"),
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
    m_along={},
    m_count=3,
    idle_letters="NOD",
    axis_words_once=False,
    moves_at_code=False,
    start_motion=0,
    dwell_unit=1e-3,
    tool_length_of_tool=False,
    length_off_letters="H",
    parameters=False,
    semicolon_ends_block=True,
    one_register=False,
    feed_before_units=False,
    feed_mode_clears_feed=False,
    incremental_tables=True,
    turns=False,
    arcs=FANUC_ARCS,
    feed_of_all_axes=True,
    line_limit=256,
    whole_within=0.0,
    code_within=1e-6,
)

LINUXCNC = Dialect(
    name="linuxcnc",
    letters="ABCDFGHIJKLMNPQRSTUVWXYZ",
    groups={
        **_GROUPS,
        800: "motion",
        **dict.fromkeys((591, 592, 593), "work offset"),
        **dict.fromkeys((901, 911), "arc distance"),
        **dict.fromkeys((921, 922, 923), "shift kept"),
        **dict.fromkeys((431, 432), "tool length"),
        611: "path control",
        **dict.fromkeys((80,), "diameter mode"),
    },
    along={640: "PQ"},
    own_axes=frozenset((100, 280, 431, 520, 920)),
    refused={
        **_REFUSED,
        50: "a cubic spline", 51: "a quadratic spline", 52: "a NURBS block", 53: "a NURBS block",
        **dict.fromkeys((700, 710, 711, 712, 720, 721, 722), "a turning cycle"),
        70: "lathe diameters", 171: "the UV plane", 181: "the WU plane", 191: "the VW plane",
        281: "setting the home position; put it into the settings", 301: "setting the second reference point",
        **{380 + i: "probing, whose end the program does not state" for i in range(2, 6)},
        331: "rigid tapping", 411: "dynamic cutter compensation on the left; program the tool's centre",
        421: "dynamic cutter compensation on the right; program the tool's centre",
        434: "not of this dialect: LinuxCNC has tool centre point control in its kinematics; use dialect fanuc",
    },
    m_groups={**_M_GROUPS, 19: "spindle", 60: "stop", **dict.fromkeys(range(48, 54), "override")},
    m_harmless=frozenset(),
    m_refused={
        **dict.fromkeys((428, 429, 430), "switchable kinematics; read the program for one kinematics, without it"),
        61: "setting the tool number without a change; use T and M6",
        **dict.fromkeys((62, 63, 64, 65, 66, 67, 68), "input and output of the control"),
        **dict.fromkeys((70, 71, 72, 73), "saving and restoring modes; write the modes out"),
        98: "a subprogram; use O words", 99: "a subprogram; use O words",
        **dict.fromkeys(range(100, 200), "a command of the machine's owner"),
    },
    m_along={19: "PQR", **dict.fromkeys((50, 51, 52, 53), "P")},
    m_count=4,
    idle_letters="NO",
    axis_words_once=True,
    moves_at_code=True,
    start_motion=None,
    dwell_unit=1.0,
    tool_length_of_tool=True,
    length_off_letters="",
    parameters=True,
    semicolon_ends_block=False,
    one_register=True,
    feed_before_units=True,
    feed_mode_clears_feed=True,
    incremental_tables=False,
    turns=True,
    arcs=LINUXCNC_ARCS,
    feed_of_all_axes=False,
    line_limit=252,
    whole_within=1e-4,
    code_within=1e-3,
)
# fmt: on

DIALECTS = {dialect.name: dialect for dialect in (FANUC, LINUXCNC)}


def dialect_named(name: str) -> Dialect:
    """The dialect of that name. Raises InputError for unknown names."""
    if name not in DIALECTS:
        raise InputError(f"no G-code dialect {name!r}; there are {', '.join(DIALECTS)}")
    return DIALECTS[name]
