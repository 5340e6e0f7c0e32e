"""One change at a time to a scene's tables: deleted, misspelled, of another type, zero, negative, huge, no number."""

from copy import deepcopy
from dataclasses import dataclass
from math import inf, nan

FREE_TEXT = {"name", "summary", "source", "note", "stations"}  # where any word is right
FREE_NAMES = {("reference", "roughness_um"), ("machine", "phoenix"), ("machine", "star")}  # keys of the user's own
DELETE = object()


@dataclass(frozen=True)
class Mutation:
    """A change of the key at ``place``; ``refused``: it makes no sense anywhere, so that only exit code 2 is right."""

    scene: str
    place: tuple
    kind: str
    value: object
    refused: bool

    def __str__(self) -> str:
        return f"{self.scene}: {'.'.join(map(str, self.place))}: {self.kind}"

    def apply(self, tables):
        """The changed tables; those given are left as they are."""
        tables = table = deepcopy(tables)
        *above, key = self.place
        for part in above:
            table = table[part]
        if self.kind == "misspelled":
            table[self.value] = table.pop(key)
        elif self.value is DELETE:
            del table[key]
        else:
            table[key] = self.value
        return tables


def mutations(scene, tables):
    """All changes of all keys, in the order of the file."""
    for place, value in _keys(tables, ()):
        free = place[-2:-1] in [n[-1:] for n in FREE_NAMES] or place in FREE_NAMES
        yield Mutation(scene, place, "deleted", DELETE, False)
        if isinstance(place[-1], str):
            yield Mutation(scene, place, "misspelled", place[-1] + "x", not free)
        for kind, changed, refused in _values(place[-1], value):
            if repr(changed) != repr(value):
                yield Mutation(scene, place, kind, changed, refused)


def _keys(table, above):
    """Every key with its value: tables themselves, then what is in them; entries of lists of tables by number."""
    entries = table.items() if isinstance(table, dict) else enumerate(table)
    for key, value in entries:
        yield (*above, key), value
        if isinstance(value, dict) or (isinstance(value, list) and value and isinstance(value[0], dict)):
            yield from _keys(value, (*above, key))


def _values(key, value):
    """Other values of a key, what they are, and whether they are wrong anywhere."""
    if isinstance(value, bool):
        yield from [("a number for a truth", 1, True), ("text for a truth", "true", True)]
        yield "the other", not value, False
    elif isinstance(value, int | float):
        yield from _numbers(value)
    elif isinstance(value, str):
        yield from [("a number for text", 7, True), ("a list for text", [value], True)]
        yield from [("empty", "", False), ("unknown word", "nosuch", key not in FREE_TEXT)]
    elif isinstance(value, dict):
        yield from [("a number for a table", 7, True), ("empty", {}, False), ("a list for a table", [value], True)]
    else:
        yield from _lists(key, value)


def _numbers(value):
    yield from [("text", repr(value), True), ("true", True, True), ("a list", [value], True)]
    yield from [("nan", nan, True), ("inf", inf, True), ("-inf", -inf, True)]
    yield from [("huge", 1e300, True), ("huge negative", -1e300, True), ("huge whole", 10**18, True)]
    yield from [("zero", 0 * value, False), ("negative", -value if value else -1.0, False), ("tiny", 1e-300, False)]
    yield from [("a billionth", 1e-9 * value, False), ("a thousandfold", 1000 * value, False)]


def _lists(key, value):
    yield from [("a number for a list", 7, True), ("empty", [], False)]
    yield from [("one more", [*value, *value[-1:]], False), ("one less", value[:-1], False)]
    if value and isinstance(value[0], str):
        yield "unknown word inside", [*value[:-1], "nosuch"], key not in FREE_TEXT
        yield "a number inside", [*value[:-1], 7], True
    if value and isinstance(value[0], int | float):
        for kind, number in (("nan", nan), ("inf", inf), ("huge", 1e300), ("text", "9"), ("true", True)):
            yield f"{kind} inside", [*value[:-1], number], True
        yield from [("zero inside", [*value[:-1], 0], False), ("negative inside", [*value[:-1], -1.0], False)]
    yield "a list inside", [*value[:-1], [value[-1:]]], bool(value)
