"""What the command line shows of a run of local gouging."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from gearsim.output.gouging.summary import summary
from gearsim.output.gouging.write import size_notes
from gearsim.result import GougeExampleResult, SculpturedResult


def print_gouging(result: SculpturedResult | GougeExampleResult, console: Console) -> None:
    """Overcut by tool and cause, the largest mill, printed numbers that do not reproduce."""
    if isinstance(result, SculpturedResult):
        table = Table(title=f"{result.name}: deviation in um, + material left, - overcut; overcut samples by cause")
        for head in ("tool", "min", "max", "contacts gouging", "local", "tie", "global", "not predicted"):
            table.add_column(head, justify="left" if head == "tool" else "right")
        for name, t in summary(result)["tools"].items():
            d, o = t["deviation_um"], t["overcut_samples"]
            ends = ("-" if d[k] is None else f"{d[k]:.1f}" for k in ("min", "max"))
            counts = (t["contacts_gouging"], o["local"], o["tie"], o["global"], o["unpredicted"])
            table.add_row(f"{name}: {t['tool']}", *ends, *(f"{c:,}" for c in counts))
        console.print(table)
        for name, cut in result.cuts.items():
            console.print(
                f"{name}: {len(cut.rings.contact):,} contacts cut alone, {int(cut.rings.disagree.sum())} against "
                f"prediction ({int(cut.rings.near.sum())} too near a tie to tell)"
            )
        for note in size_notes(result.sizes.whole, result.sizes.place):
            console.print(note)
    if result.worked:
        agree = sum(r.agrees for r in result.worked)
        console.print(f"{agree} of {len(result.worked)} printed results reproduce")
        for r in result.worked:
            if not r.agrees:
                console.print(
                    f"  {r.section} {r.quantity}: printed {r.printed}, ours {r.ours}: {r.verdict}", markup=False
                )
