"""Programs with O words: branches, loops, subroutines, one within the other."""

from __future__ import annotations

from tests.peers.linuxcnc.control import Control
from tests.peers.linuxcnc.programs.dice import Dice
from tests.peers.linuxcnc.programs.motion import text
from tests.peers.linuxcnc.programs.words import expression

NAMES = ("#1", "#2", "#31")


class Writer:
    """Writes statements; counts moves in #40 so that every loop ends, and labels so that none is taken twice."""

    def __init__(self, dice: Dice):
        self.dice, self.label, self.subs = dice, 100, [str(n) for n in range(1, dice.whole(1, 3))]
        self.named = dice.chance(0.4)

    def fresh(self) -> str:
        """A label, now and then one that is taken."""
        if not self.dice.chance(0.002):
            self.label += 1
        return f"<l {self.label}>" if self.named else str(self.label)

    def condition(self) -> str:
        """Something that is true or false."""
        return expression(self.dice, 1, NAMES)

    def comment(self) -> str:
        """What may stand behind an O word, or seldom may not."""
        return self.dice.pick(("", "", "", " (c)", " ; c", " (a)(b)", " [1]" if self.dice.chance(0.02) else ""))

    def block(self, depth: int, loop: str = "", sub: str = "") -> list[str]:
        """Some statements."""
        lines = []
        for _ in range(self.dice.whole(1, 3)):
            lines += self.statement(depth, loop, sub)
        return lines

    def statement(self, depth: int, loop: str, sub: str) -> list[str]:
        """A statement: a move, an assignment, a branch, a loop, a call, a way out."""
        dice, kind = self.dice, self.dice.whole(0, 13) if depth else 0
        if kind < 4:
            return [dice.pick(("G0 X[#1+#40]", "#1=[#1+1]", "#2=[#1*2] G0 Y#2", "#40=[#40+1]", "#31=[#31-1]"))]
        if kind < 7:
            return self.branch(depth, loop, sub)
        if kind < 10:
            return self.loop(depth, sub)
        if kind < 12 and self.subs:
            told = "".join(f"[{self.condition()}]" + dice.pick(("", " (c) ")) for _ in range(dice.whole(0, 3)))
            names = [name for name in self.subs if not sub or name < sub or dice.chance(0.1)] or self.subs
            return [f"o{dice.pick(names)} call {told}", "G0 Z[#<_value>+#<_value_returned>]"]
        if loop:
            return self.guarded(f"o{loop} {dice.pick(('break', 'continue'))}")
        return self.guarded(f"o{sub} return [{self.condition()}]") if sub else ["G0 X#1 Y[#2+#40]"]

    def guarded(self, line: str) -> list[str]:
        """A way out that is taken now and then."""
        label = self.fresh()
        return [f"o{label} if [{self.condition()}]", line, f"o{label} endif"]

    def branch(self, depth: int, loop: str, sub: str) -> list[str]:
        """IF with branches."""
        label = self.fresh()
        lines = [f"o{label} if [{self.condition()}]{self.comment()}", *self.block(depth - 1, loop, sub)]
        for _ in range(self.dice.whole(0, 2)):
            lines += [f"o{label} elseif [{self.condition()}]", *self.block(depth - 1, loop, sub)]
        if self.dice.chance(0.5):
            lines += [f"o{label} else{self.comment()}", *self.block(depth - 1, loop, sub)]
        return [*lines, f"o{label} endif{self.comment()}"]

    def loop(self, depth: int, sub: str) -> list[str]:
        """A loop of each kind."""
        label, kind = self.fresh(), self.dice.whole(0, 3)
        count = ["#40=[#40+1]"]
        if kind < 2:
            rounds = self.dice.pick(("2", "3", "0", "2.5", "1.6", "-1", "#1 MOD 4", "1.5", "3.4999"))
            return [f"o{label} repeat [{rounds}]", *self.block(depth - 1, "", sub), f"o{label} endrepeat"]
        ends = f"[#40 LT {self.dice.whole(1, 12)}]"
        inner = [*count, *self.block(depth - 1, label, sub)]
        if kind < 3:
            return [f"o{label} while {ends}", *inner, f"o{label} endwhile{self.comment()}"]
        return [f"o{label} do", *inner, f"o{label} while {ends}{self.comment()}"]

    def sub(self, label: str) -> list[str]:
        """A subroutine."""
        result = self.dice.pick(("", "", f" [{self.condition()}]", " [#1+1]"))
        return [f"o{label} sub", *self.block(2, "", label), "G0 X#1 Y#2 Z#31", f"o{label} endsub{result}"]


def flow(dice: Dice) -> tuple[str, Control]:
    """Subroutines before or behind the program that calls them."""
    writer = Writer(dice)
    subs = [line for label in writer.subs for line in writer.sub(label)]
    main = [f"#1={dice.whole(0, 4)} #2={dice.whole(-2, 3)} #31=5 #40=0", *writer.block(3), *writer.block(2), "G0 X#1"]
    if dice.chance(0.2):
        return text([*main, "M2", *subs]), Control()
    return text([*subs, *main]), Control()
