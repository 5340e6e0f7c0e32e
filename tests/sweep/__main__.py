"""``python -m tests.sweep [SCENE...] [--cut N] [--every K]``: all changes planned, N of those accepted cut too."""

import argparse
import json
import sys
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

from gearsim.scene import scene_names
from tests.sweep.judge import faults
from tests.sweep.mutations import mutations
from tests.sweep.scenes import small, to_toml
from tests.sweep.worker import Worker

_PLAN_S, _CUT_S = 60.0, 300.0


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.sweep")
    parser.add_argument("scenes", nargs="*", help="built-in scenes (default: all)")
    parser.add_argument("--every", type=int, default=1, help="only every K-th change")
    parser.add_argument("--cut", type=int, default=150, help="how many whole runs (default: %(default)s)")
    parser.add_argument("--log", type=Path, help="write every outcome to this file, a JSON line each")
    options = parser.parse_args()
    cases = [m for name in options.scenes or scene_names() for m in mutations(name, small(name))][:: options.every]
    with TemporaryDirectory() as folder, (options.log or Path("/dev/null")).open("w") as log:
        accepted, bad = _sweep(cases, ["--dry-run"], _PLAN_S, Path(folder), log)
        step = max(1, len(accepted) // max(options.cut, 1))
        chosen = accepted[::step][: options.cut]
        _, worse = _sweep(chosen, ["--no-pictures"], _CUT_S, Path(folder), log)
    return 1 if bad + worse else 0


def _sweep(cases, options, seconds, folder, log):
    """Run the cases; those that were accepted, and how many ended wrongly."""
    accepted, bad, codes = [], 0, Counter()
    with Worker(seconds) as worker:
        for case in cases:
            outcome = run_case(case, options, worker, folder)
            found = faults(outcome, case.refused)
            codes[outcome.code] += 1
            accepted += [case] * (outcome.code == 0)
            bad += bool(found)
            for fault in found:
                print(f"{case} {case.value!r:.40}: {fault}", flush=True)
            record = {"case": str(case), "code": outcome.code, "faults": found, "err": outcome.err[:400]}
            log.write(json.dumps(record | {"out": outcome.out[-400:], "options": options}) + "\n")
            log.flush()
    told = ", ".join(f"exit {code}: {count:,}" for code, count in sorted(codes.items(), key=str))
    print(f"{' '.join(options)}: {len(cases):,} cases, {told}; {bad} ended wrongly", flush=True)
    return accepted, bad


def run_case(case, options, worker, folder):
    """Write a changed scene and run it by the command."""
    file = folder / "case.toml"
    file.write_text(to_toml(case.apply(small(case.scene))), encoding="utf-8")
    return worker.run(["run", str(file), "--out", str(folder / "out"), *options])


if __name__ == "__main__":
    sys.exit(main())
