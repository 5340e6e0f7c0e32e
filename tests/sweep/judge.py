"""What is wrong with how a case ended."""

import re

_CODES = (0, 1, 2, 3)


def faults(outcome, refused) -> list[str]:
    """Everything a user should not meet; ``refused``: only bad input is the right answer."""
    if outcome.code not in _CODES:
        return [f"no exit code: {outcome.err.strip()[-300:]}"]
    found = []
    if "Traceback" in outcome.err or "Warning" in outcome.err:
        found.append(f"more than a message: {outcome.err.strip()[:300]}")
    if outcome.code == 2 and (outcome.err.count("gearsim: ") != 1 or not outcome.err.startswith("gearsim: ")):
        found.append(f"not one message: {outcome.err.strip()[:300]}")
    if "out of memory" in outcome.err:
        found.append("memory ran out")
    if refused and outcome.code != 2:
        found.append(f"nonsense ended with {outcome.code}")
    if re.search(r"\b(nan|inf)\b|(^|\s)-\d[\d,.]* (rays|MB|s)\b", outcome.out.split("nothing was cut")[0]):
        found.append(f"an estimate that is none: {outcome.out.strip()[:200]}")
    return found
