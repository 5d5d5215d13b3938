"""Promises about the sweep: certified freedom, and collisions with the way out."""

import math
from itertools import combinations, product

import numpy as np
import pytest
import shapely
from hypothesis import Phase, given, settings, strategies as st
from shapely import affinity

import stepwell as sw
from build import chains
from stepwell.build import layout, load_build_file, sweep
from stepwell.build.bodies import Poses, bodies_of, freedom
from stepwell.build.freeing import collision_findings
from stepwell.build.sweeps import TOUCH

ACRYLIC = load_build_file("acrylic-3mm")


def solids_of(made):
    """Name, body, area, heights of parts and fasteners, each in the frame of its body."""
    # Holes of a part that breaks a limit may cross its outline.
    solids = [
        (p.name, made.body[p.name], shapely.make_valid(p.polygon(4e-6)), p.base, p.top)
        for p in made.parts
    ]
    for one in made.fasteners:
        shape = shapely.Point(one.centre).buffer(one.diameter / 2, quad_segs=32)
        solids.append((f"{one.use} {one.name}", ("block", one.block), shape, one.low, one.high))
    return solids


def overlaps(made, angles, bodies=None):
    """Every overlap of parts and fasteners at one pose, by areas alone: {(names): area}."""
    at = made.positions(angles)
    solids = []
    for name, owner, shape, low, high in bodies or solids_of(made):
        x, y, turn = made.frame(owner, at, angles)
        c, s = math.cos(turn), math.sin(turn)
        solids.append(
            (name, owner, affinity.affine_transform(shape, (c, -s, s, c, x, y)), low, high)
        )
    for path in made.bands:
        line = shapely.LineString([at[path.cell] + path.p, at[path.cell + 1] + path.q])
        shape = line.buffer(path.width / 2, quad_segs=32)
        key = ("band", path.cell, path.number)
        solids.append((f"band {path.cell}", key, shape, path.low, path.high))
    found = {}
    shapes = [one[2] for one in solids]
    meeting = shapely.STRtree(shapes).query(shapes, "intersects").T
    for a, b in ((solids[i], solids[j]) for i, j in meeting if i < j):
        if a[1] == b[1] or min(a[4], b[4]) - max(a[3], b[3]) < 1e-6:
            continue
        if "band" in (a[1][0], b[1][0]) and {a[1][0], b[1][0]} != {"band"}:
            hook = b if a[1][0] == "band" else a
            ring = a if a[1][0] == "band" else b
            path = next(p for p in made.bands if ("band", p.cell, p.number) == ring[1])
            if hook[0].split()[-1] in path.holes and hook[1][1] in (path.cell, path.cell + 1):
                continue
        shared = shapely.intersection(a[2], b[2]).buffer(-TOUCH)
        if not shared.is_empty:
            found[a[0], b[0]] = shared.area
    return found


@pytest.mark.parametrize("name", ["pair", "mixed", "slotted", "crossed"])
def test_chains_of_every_kind_are_free_over_all_angles(name):
    result = sweep(layout(getattr(chains, name)(), ACRYLIC))
    assert result.free
    assert result.collisions == result.undecided == ()


def test_the_papers_pair_is_free_at_every_pose_of_its_cycle_and_on_a_square_of_angles():
    made = layout(chains.pair(), ACRYLIC)
    path = chains.pair().cycle().path
    rows = path.travel[np.linspace(0, len(path.travel) - 1, 124).astype(int)]
    cycle = np.column_stack([c.angle(s) for c, s in zip(chains.pair().levers, rows.T, strict=True)])
    axis = np.linspace(-math.pi / 4, math.pi / 4, 13)
    bodies = solids_of(made)
    for angles in (*cycle, *product(axis, axis)):
        assert not overlaps(made, angles, bodies)


def test_least_clearances_are_those_of_the_swept_study():
    result = sweep(layout(chains.pair(), ACRYLIC))
    least = {tuple(sorted(one.parts)): one.distance for one in result.clearances}
    assert least["block 0", "lever-1a"] == pytest.approx(0.8e-3, abs=1e-5)
    # Blocks of one row, and faces that touch at the stops.
    assert least["block 0", "block 2"] == pytest.approx(1e-3, abs=1e-4)
    assert least["block 0", "block 1"] < TOUCH


def test_two_levers_that_meet_are_reported_with_their_overlap_and_a_change_that_frees_them():
    chain = chains.steep()
    made = layout(chain, ACRYLIC)
    result = sweep(made)
    (one,) = result.collisions
    assert one.parts == ("lever-1a", "lever-1b")
    # Lever width less the distance of the two axes, b cos θc.
    overlap = 8e-3 - 20e-3 * math.cos(math.radians(70.0))
    assert one.overlap == pytest.approx(overlap, abs=1e-5)
    assert one.states == ("0", "1")
    assert one.stroke == pytest.approx((0.0, chain.full_stroke))
    (found,) = collision_findings(made, result)
    assert dict(found.change) == {"lever__width": pytest.approx(6.8e-3)}
    assert sweep(layout(chain, ACRYLIC.with_lengths(**found.change))).free
    # The next smaller change of 0.1 mm is not enough.
    assert not sweep(layout(chain, ACRYLIC.with_lengths(lever__width=6.9e-3))).free


def test_a_collision_of_middle_blocks_is_found_at_the_stroke_where_they_meet():
    # Blocks of one row that come 3 mm closer than their ends allow, in state 00 alone.
    made = layout(chains.pair(), ACRYLIC.with_lengths(block__clearance=1e-3))
    moved = layout(chains.pair(), ACRYLIC)
    cells, offset = moved.blocks[1].seats[1][0], 0.058
    object.__setattr__(moved.blocks[1], "seats", (moved.blocks[1].seats[0], (cells, "p", offset)))
    result = sweep(moved)
    assert sweep(made).free
    assert not result.free
    hit = next(c for c in result.collisions if c.parts == ("block-0-bottom", "block-2-bottom"))
    assert hit.states == ("00",)
    assert hit.overlap == pytest.approx(2e-3, abs=2e-4)
    assert hit.stroke[0] == 0.0


@pytest.mark.parametrize("name", ["pair", "slotted", "crossed"])
def test_the_bound_on_motion_holds_between_random_poses(name):
    # The proof rests on it: a distance changes by no more than reach times the change of angles.
    made = layout(getattr(chains, name)(), ACRYLIC)
    random = np.random.default_rng(0)
    rigid = [one for one in bodies_of(made) if one.kind != "band"]
    for a, b in combinations(rigid, 2):
        moves = freedom(made, a, b)
        first, second = random.uniform(moves.low, moves.high, (2, 20, len(moves.low)))
        gaps = []
        for rows in (first, second):
            poses = Poses(made, moves, rows)
            (at, turn), (to, its) = poses.of(a), poses.of(b)
            shapes = [shapely.convex_hull(one.section(one.pieces)) for one in (a, b)]
            gaps.append(
                [
                    affinity.translate(
                        affinity.rotate(shapes[0], turn[i], (0, 0), use_radians=True), *at[i]
                    ).distance(
                        affinity.translate(
                            affinity.rotate(shapes[1], its[i], (0, 0), use_radians=True), *to[i]
                        )
                    )
                    for i in range(len(rows))
                ]
            )
        change = np.abs(np.subtract(*gaps))
        assert np.all(change <= np.abs(first - second) @ moves.reach + 1e-9)


@st.composite
def any_chains(draw):
    """Chains with other levers, limits, anchors and numbers of bands in each cell."""
    cells = []
    for _ in range(draw(st.integers(1, 3))):
        bands = [
            chains.band(
                (draw(st.floats(-20, 5)), draw(st.floats(-15, 15))),
                (draw(st.floats(-5, 25)), draw(st.floats(-15, 15))),
                stiffness=28.5,
            )
            for _ in range(draw(st.integers(1, 3)))
        ]
        lever, limit = draw(st.floats(13, 35)), draw(st.floats(20, 68))
        cells.append(sw.Cell(bands, lever=1e-3 * lever, limit=math.radians(limit), unusual=True))
    return sw.Chain(cells)


@settings(max_examples=12, phases=[Phase.explicit, Phase.generate])
@given(chain=any_chains(), seed=st.integers(0, 99))
def test_the_sweep_of_any_chain_agrees_with_areas_at_random_poses(chain, seed):
    made = layout(chain, ACRYLIC)
    result = sweep(made)
    assert result.undecided == ()
    bodies = solids_of(made)
    if result.free:
        limits = np.array([one.cell.limit for one in made.cells])
        poses = np.random.default_rng(seed).uniform(-limits, limits, (8, len(limits)))
        corners = [np.array(signs) * limits for signs in product((-1, 1), repeat=len(limits))]
        for angles in (*poses, *corners):
            assert not overlaps(made, angles, bodies)
    for one in result.collisions:
        assert overlaps(made, one.angles, bodies), one


def test_a_hook_on_a_joint_is_a_longer_pin_that_is_free_too():
    # q at the second joint of the outer block.
    made = layout(sw.Chain([chains.cell((-10, 0), (0, 10))]), ACRYLIC)
    assert made.bands[0].holes == ("pD3", "1b")
    pins = [f for f in made.fasteners if f.use == "pin" and f.joint and f.block == 1]
    lengths = {f.name: f.high - f.low for f in pins}
    assert lengths["1b"] > made.bands[0].high > lengths["1a"]
    assert sweep(made).free


def test_random_poses_of_a_free_chain_never_overlap():
    made = layout(chains.slotted(), ACRYLIC)
    limits = np.array([one.cell.limit for one in made.cells])
    for angles in np.random.default_rng(1).uniform(-limits, limits, (40, 2)):
        assert not overlaps(made, angles)
    # The same comparison finds levers that meet.
    steep = layout(chains.steep(), ACRYLIC)
    assert overlaps(steep, steep.angles("0")).keys() == {("lever-1a", "lever-1b")}


def test_the_papers_pair_is_swept_in_fewer_than_ten_thousand_poses():
    result = sweep(layout(chains.pair(), ACRYLIC))
    assert result.pairs == 45
    assert result.poses < 10_000


def test_progress_counts_all_pairs():
    calls = []
    sweep(layout(sw.Chain([chains.cell((-10, 0), (10, 0))]), ACRYLIC), lambda *a: calls.append(a))
    assert calls[0] == (0, 15)
    assert len(calls) == 15


def test_shims_longer_across_than_their_lever_are_swept():
    thick = ACRYLIC.with_lengths(pin__diameter=0.0048, sheet__bridge=0.001)
    made = sweep(layout(sw.Chain([chains.cell((-10, 0), (10, 0), 8.5, 36.0)]), thick))
    assert any(all("shim" in part for part in one.parts) for one in made.collisions)
