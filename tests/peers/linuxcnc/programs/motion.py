"""Programs of moves: straight ones, arcs, zeros, units, tools."""

from __future__ import annotations

import math

from tests.peers.linuxcnc.control import SYSTEMS, Control
from tests.peers.linuxcnc.programs.dice import Dice

WRONG = ("G93", "G94", "G95 F0.2", "G80", "G53 G1 X2", "G4 P1 X3", "G1 F0 X3", "G53 G0 X1", "G53", "G4", "G0 G1 X1",
         "X1 X2", "G28 G0 X1", "G92", "G1 X1 Q2", "S-1", "F-1", "M3 M4", "G5 X1 Y1", "G81 Z-1 R1",
         "M6", "G0 P1")  # fmt: skip
PLANES = {17: ("X", "Y", "I", "J", "Z"), 18: ("Z", "X", "K", "I", "Y"), 19: ("Y", "Z", "J", "K", "X")}


def text(lines: list[str]) -> str:
    """A program of lines, with its end."""
    return "\n".join([*lines, "M2", ""])


def number(value: float) -> str:
    """A number as programs have it."""
    return f"{value:.6f}".rstrip("0").rstrip(".") if value else "0"


def words(dice: Dice, letters: str = "XYZBC") -> list[str]:
    """Some axis words."""
    return [letter + number(dice.length()) for letter in dice.some(letters, 1)]


def straight(dice: Dice) -> str:
    """One block of a straight move, or of what stands between moves."""
    kind = dice.whole(0, 19)
    if kind < 12:
        code = dice.pick(("G0", "G1", "G1", "", "", "G01", "G00"))
        feed = [f"F{dice.whole(1, 3000)}"] if dice.chance(0.3) else []
        return " ".join(dice.shuffled([*filter(None, [code]), *words(dice), *feed]))
    if dice.chance(0.05):
        return dice.pick(WRONG)
    return dice.pick(
        (
            "G90", "G91", f"G4 P{dice.whole(0, 30) / 10}", "G80\nG1", f"M3 S{dice.whole(1, 9) * 500}", "M5", "(c)", "",
            "G93 G1 X1 Y2 F3\nG94 F100", "G94 F100", f"G90 G53 G0 {words(dice)[0]}", f"G28 {words(dice)[0]}", "G28",
            "G64 P0.01", "M8", "M9", "S900 G95 F0.2", "G95 S2000 F.1\nG94 F90", f"S{dice.whole(1, 4000)}", "G1", "G0",
            "G17 G49", "G90 G53 G1 X2", "G1 G90 G53 Z9", "M1", "M0", "G97 S200", "G91.1", "G90.1 G91", "G40", "G61",
            "G4 P1\nX3",
        )
    )  # fmt: skip


def moves(dice: Dice) -> tuple[str, Control]:
    """Straight moves, feed modes, dwells, home."""
    lines = [dice.pick(("G21 G90 G0 F80", "G90 G94 G1 F500", "G21 G1" if dice.chance(0.2) else "G1 F1", "G0 F100"))]
    home = {letter: dice.length() for letter in dice.some("XYZC")}
    return text(lines + [straight(dice) for _ in range(dice.whole(2, 14))]), Control(home=home)


def arc(dice: Dice, plane: int, at: dict[str, float], inch: bool, absolute: bool, centres: bool) -> str:
    """An arc from ``at``, which goes along to its end: right, or off by about what is allowed."""
    a, b, i, j, c = PLANES[plane]
    digits = dice.pick((4, 5) if inch else (3, 4))
    radius = round(dice.between(0.2, 30.0) / (25.4 if inch else 1.0), digits)
    first, turn = dice.between(0.0, 2.0 * math.pi), dice.between(0.1, 2.0 * math.pi)
    if dice.chance(0.3):
        first, turn = 0.5 * math.pi * dice.whole(0, 3), 0.5 * math.pi * dice.whole(1, 4)
    miss = dice.pick((0.001, 0.003, 0.02, 0.03, 0.1)) / (25.4 if inch else 1.0) if dice.chance(0.15) else 0.0
    di, dj = round(-radius * math.cos(first), digits), round(-radius * math.sin(first), digits)
    da = round(di + (radius + miss) * math.cos(first + turn), digits)
    db = round(dj + (radius + miss) * math.sin(first + turn), digits)
    start_a, start_b = at[a], at[b]
    found = [f"G{dice.whole(2, 3)}"]
    at[a], at[b] = start_a + da, start_b + db
    found += [a + number(at[a] if absolute else da), b + number(at[b] if absolute else db)]
    if dice.chance(0.25):
        dc = round(dice.between(-5.0, 5.0), digits)
        at[c] += dc
        found.append(c + number(at[c] if absolute else dc))
    if dice.chance(0.25):
        chord = 0.5 * math.hypot(da, db)
        size = dice.pick((radius, radius, chord + 0.001, round(chord, digits), chord - dice.pick((1e-3, 1e-4))))
        found.append(f"R{number(round(dice.pick((1, 1, -1)) * size, digits + 1))}")
    else:
        found += [i + number(start_a + di if centres else di), j + number(start_b + dj if centres else dj)]
    if dice.chance(0.15):
        found.append(f"P{dice.whole(1, 4)}")
    if dice.chance(0.05):
        found.pop(dice.whole(1, len(found) - 1))
    return " ".join(dice.shuffled(found))


def circles(dice: Dice) -> tuple[str, Control]:
    """Arcs in all planes by centre and radius, full circles, turns, helices; limits approached."""
    inch, plane, absolute, centres = dice.chance(0.4), 17, True, False
    lines = ["G20" if inch else "G21", "G90 F40"]
    at = dict.fromkeys("XYZ", 0.0)
    control = Control(offsets={"G55": {"X": dice.length(), "Y": dice.length(), "Z": 7.0}})
    shift = {axis: value / (25.4 if inch else 1.0) for axis, value in control.offsets["G55"].items()}
    for _ in range(dice.whole(2, 8)):
        if dice.chance(0.3):
            plane = dice.pick((17, 18, 19))
            lines.append(f"G{plane}")
        if dice.chance(0.2):
            absolute = not absolute
            lines.append("G90" if absolute else "G91")
        if dice.chance(0.2):
            centres = not centres
            lines.append("G90.1" if centres else "G91.1")
        if dice.chance(0.15):
            goes_on = "G54" in lines[-1:] or "G55" not in lines
            lines.append("G55" if goes_on else "G54")
            at = {axis: at[axis] - (1 if goes_on else -1) * shift[axis] for axis in at}
        if dice.chance(0.3):
            at = {axis: round(dice.between(-1.0, 1.0) * (1 if inch else 20), 3) for axis in "XYZ"}
            lines += ["G90", "G0 " + " ".join(axis + number(value) for axis, value in at.items())]
            absolute = True
        if dice.chance(0.25):
            _, _, i, j, _ = PLANES[plane]
            size = f"{i}{number(round(dice.between(0.1, 9.0), 3))}"
            lines.append(f"G{dice.whole(2, 3)} {size}" if not centres else f"G2 {i}1 {j}1")
        else:
            lines.append(arc(dice, plane, at, inch, absolute, centres))
    return text(lines), control


def zeros(dice: Dice) -> tuple[str, Control]:
    """Work offsets, G92 and G52, G53, incremental moves."""
    offsets = {system: {axis: dice.length() for axis in dice.some("XYZBC", 1)} for system in dice.some(SYSTEMS, 2)}
    lines = ["G21 G90 G0 F300"]
    for _ in range(dice.whole(4, 14)):
        kind = dice.whole(0, 11)
        if kind < 3:
            lines.append(dice.pick(SYSTEMS) + dice.pick(("", "", " G0 X1", " G91", " G1 Y2 Z3")))
        elif kind < 5:
            lines.append(dice.pick(("G92", "G92", "G52")) + " " + " ".join(words(dice)))
        elif kind < 6:
            lines.append(dice.pick(("G92.1", "G92.2", "G92.3", "G52 X0 Y0 Z0", "G10 L2 P1 X3", "G10 L20 P2 Y1")))
        elif kind < 7:
            lines.append(dice.pick(("G90", "G91", "G90 G53 G0 X1 Z2", "G90 G53 G1 Y3", "G28", "G28 Z5", "G18", "G17")))
        else:
            lines.append(straight(dice))
    return text(lines), Control(offsets=offsets, home={"Z": 30.0, "X": dice.length()})


def units(dice: Dice) -> tuple[str, Control]:
    """Inches and millimetres in turn; F and the word of the unit never in one block."""
    offsets = {"G54": {"X": 25.4, "Z": dice.length()}, "G56": {"Y": dice.length(), "B": 10.0}}
    lines = ["F200", "G1"] if dice.chance(0.9) else []
    for _ in range(dice.whole(4, 14)):
        kind = dice.whole(0, 9)
        if kind < 3:
            lines.append(dice.pick(("G20", "G21")) + dice.pick(("", " G90", f" G0 X{dice.whole(0, 5)}", " G91 G1 Z1")))
        elif kind < 4:
            lines.append(f"F{dice.whole(1, 200)}")
        elif kind < 5:
            lines.append(dice.pick(("G56", "G54", "G92 X1 Y2", "G92.1", "G52 Z1", "G95 S300 F0.1", "G94 F50")))
        elif kind < 6:
            lines.append(f"G{dice.whole(2, 3)} I{number(round(dice.between(0.1, 3.0), 3))} Z{dice.whole(0, 3)} F60\nG1")
        else:
            lines.append(straight(dice).replace("G28", "G0"))
    return text(lines), Control(offsets=offsets, tools={1: 40.0})


def tools(dice: Dice) -> tuple[str, Control]:
    """Tool changes and lengths; in one unit and without T0.

    The stand-alone peer does not convert lengths in force, and keeps the last tool as T0.
    """
    table = {n: round(dice.between(10.0, 150.0), 2) for n in (1, 2, 3, 5, 20)}
    lines = ["G21 G90 G1 F400"]
    for _ in range(dice.whole(4, 12)):
        n = dice.pick((*table, *table, 7)) if dice.chance(0.3) else dice.pick((1, 2, 20))
        change = dice.pick((f"T{n} M6", f"T{n} M6", f"T{n} M6 G43", f"M6 T{n}", f"T{n} M6 G43 H{n}"))
        other = (
            "", f"T{n}", f"G43 H{n}", "G43", "G49", "G43 H0", f"G43 H{n} G0 Z10", "G49 G0 Z5", f"G43.2 H{n}",
            "G43.1 Z5", "M61 Q2" if dice.chance(0.2) else "G90",
        )  # fmt: skip
        # The stand-alone peer takes its position behind a change back without the tool's length: say where Z is.
        here = f"{change}\nG90 G0 Z{dice.whole(0, 20)}"
        lines.append(dice.pick((here, dice.pick(other), dice.pick(other), straight(dice), straight(dice))))
    return text(lines), Control(tools=table, offsets={"G54": {"Z": dice.length()}}, home={"Z": 200.0})
