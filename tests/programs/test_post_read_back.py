"""What the post writes, the reader reads: the same blocks, to the printed decimals."""

from dataclasses import replace

import numpy as np
import pytest

from gearsim.machines.catalogue import MACHINES, table_table_bc
from gearsim.motion.program import ProgramMotion
from gearsim.programs.gcode import read_program
from gearsim.programs.operation import Operation
from gearsim.programs.post import write_program
from gearsim.programs.post_options import Header, PostOptions
from tests.programs.test_post import FIVE_AXES, MILL, block_table, wandering

HALF = 0.5000001e-4


def read_back(blocks, **options):
    """The program, and the blocks of its motion: from behind the tool's length to coolant off."""
    text = write_program([Operation("finish", MILL, 3000.0, blocks)], Header(7, "back"), PostOptions(**options))
    lines = text.splitlines()
    first = next(i for i, line in enumerate(lines, 1) if line.startswith("G43"))
    program = read_program(text, blocks.machine)
    found = program.blocks
    rows = (found.line > first) & (found.line < lines.index("M09") + 1)
    columns = ("values", "rapid", "tip_control", "seconds", "line", "tool", "operation", "sweep", "centre", "normal")
    start = found.before[np.argmax(rows)]
    return program, replace(found, start=start, **{name: getattr(found, name)[rows] for name in columns})


def stated(blocks, held):
    """Axis values before and after every block, or tips and rotary values, in mm and degrees."""
    values = np.concatenate([blocks.start[None], blocks.values])
    slides = blocks.machine.forward(values)[0] if held else values[:, :3]
    return np.hstack([slides, np.degrees(values[:, 3:])])


@pytest.mark.parametrize("mode", ["inverse-time", "per-minute"])
@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("name", FIVE_AXES)
def test_straight_blocks_come_back(name, held, mode, rng):
    machine = MACHINES[name]()
    values = wandering(machine, rng, 60)
    values = values[np.concatenate([[True], (np.diff(values, axis=0) != 0.0).any(axis=1)])]
    n = len(values) - 1
    seconds, rapid = rng.uniform(2.0, 20.0, n), rng.random(n) < 0.2
    blocks = block_table(machine, values, seconds=seconds, rapid=rapid, tip_control=np.full(n, held))
    program, back = read_back(blocks, feed_mode=mode)
    assert (program.number, program.title, program.operations, program.tools) == (7, "BACK", ("FINISH",), (3,))
    assert np.abs(stated(back, held) - stated(blocks, held)).max() <= HALF
    assert (back.rapid == rapid).all()
    assert (back.tip_control == held).all()
    assert (back.tool == MILL.number).all()
    slower = (back.seconds / seconds)[~rapid] - 1.0
    assert slower.min() > -1e-9
    assert slower.max() < 1e-3


@pytest.mark.parametrize("held", [False, True])
def test_the_motion_read_is_the_motion_written(held, rng):
    """Between the blocks, too: a tip 60 mm from the table's axes moves by a few units of the last decimal."""
    values = wandering(table_table_bc(), rng, 20)
    values = values[np.concatenate([[True], (np.diff(values, axis=0) != 0.0).any(axis=1)])]
    blocks = block_table(table_table_bc(), values, tip_control=np.full(len(values) - 1, held))
    _, back = read_back(blocks, linear_decimals=6, rotary_decimals=6)
    t = np.tile(np.linspace(0.0, 1.0, 5), len(blocks))
    piece = np.repeat(np.arange(len(blocks)), 5)
    ours, theirs = (ProgramMotion(b).pose(piece, t, 0) for b in (blocks, back))
    assert np.abs(ours.axis.value - theirs.axis.value).max() < 4e-8
    assert np.abs(ours.tip.value - theirs.tip.value).max() < 1e-5


@pytest.mark.parametrize("normal", [0, 1, 2])
def test_arcs_come_back(normal):
    u, v = (normal + 1) % 3, (normal + 2) % 3
    angle = np.cumsum([0.3, 1.0, -2.0, 2.0 * np.pi, 4.0, -5.5])
    centre = np.array([3.0, -4.0, 5.0])
    values = np.zeros((6, 5))
    values[:, u], values[:, v] = centre[u] + 6.0 * np.cos(angle), centre[v] + 6.0 * np.sin(angle)
    values[:, normal] = np.arange(6.0)
    values[3, [u, v]] = values[2, [u, v]]
    values[:, 4] = 0.1 * np.arange(6.0)
    blocks = block_table(
        table_table_bc(), values, sweep=np.diff(angle), centre=np.tile(centre, (5, 1)), normal=np.full(5, normal),
        seconds=[1.0, 2.0, 3.0, 4.0, 5.0],
    )  # fmt: skip
    _, back = read_back(blocks)
    assert np.abs(stated(back, False) - stated(blocks, False)).max() <= HALF
    assert np.allclose(back.sweep, blocks.sweep, atol=5e-5)
    assert np.allclose(back.centre[:, [u, v]], centre[[u, v]], atol=HALF)
    assert (back.normal == normal).all()
    assert np.allclose(back.seconds, blocks.seconds, rtol=1e-4)


def test_operations_and_tools_come_back():
    values = np.array([[10.0, 0, 5, 0.1, 0], [1, 0, 0, 0.1, 1]])
    blocks = block_table(table_table_bc(), values)
    held = replace(blocks, tip_control=np.array([True]))
    other = replace(MILL, number=5)
    program = read_program(
        write_program([Operation("rough", MILL, 100.0, blocks), Operation("finish", other, 100.0, held)], Header(1)),
        blocks.machine,
    )
    cuts = ~program.blocks.rapid
    assert program.operations == ("ROUGH", "FINISH")
    assert program.tools == (3, 5)
    assert list(program.blocks.operation[cuts]) == [0, 1]
    assert list(program.blocks.tool[cuts]) == [3, 5]
    assert list(program.blocks.tip_control[cuts]) == [False, True]
    assert np.allclose(program.blocks.values[cuts], values[1], atol=2e-4)
