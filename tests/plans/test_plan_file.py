"""Plan files: read back bit for bit, and refused when they are not whole."""

import json

import numpy as np
import pytest

import ffsr_plan as fp


def test_a_saved_plan_loads_bit_for_bit(fig2a_plan, tmp_path):
    fig2a_plan.save(tmp_path / "plan.json")
    loaded = fp.Plan.load(tmp_path / "plan.json")
    assert loaded == fig2a_plan
    assert loaded.seconds == fig2a_plan.seconds
    assert np.array_equal(loaded.configurations, fig2a_plan.configurations)
    assert np.array_equal(loaded.at(0.37), fig2a_plan.at(0.37))
    loaded.save(tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == (tmp_path / "plan.json").read_bytes()


def test_a_plan_without_obstacles_saves_and_loads_too(point, tmp_path):
    start, goal = point.configuration(), point.configuration((4, 0, 0))
    lattice = fp.Lattice(4, fp.Axis(1, 0.5), fp.Axis(2, 0.5))
    plan = fp.plan(fp.Problem(point, fp.Scene(), start, goal, lattice=lattice))
    plan.save(tmp_path / "plan.json")
    assert fp.Plan.load(tmp_path / "plan.json") == plan
    assert plan.verify(10).ok
    assert plan.nodes.shape == (5, 2)


def test_what_obstacles_come_from_is_saved_and_may_be_absent(fig2a_plan):
    data = fig2a_plan.to_dict()
    assert data["problem"]["scene"]["sources"][0] == ["obstacles.0", 1]
    assert fp.Plan.from_dict(data).problem.scene.sources == fig2a_plan.problem.scene.sources
    del data["problem"]["scene"]["sources"]  # as in files of version 0.1
    assert fp.Plan.from_dict(data).problem.scene.sources == ()


def test_a_plan_file_cut_short_is_refused(fig2a_plan, tmp_path):
    path = tmp_path / "plan.json"
    fig2a_plan.save(path)
    path.write_text(path.read_text()[:-2000])
    with pytest.raises(fp.InvalidInput, match="cut short"):
        fp.Plan.load(path)


@pytest.mark.parametrize("key", ["length", "configurations", "problem"])
def test_an_edited_plan_file_is_refused(fig2a_plan, tmp_path, key):
    path = tmp_path / "plan.json"
    fig2a_plan.save(path)
    data = json.loads(path.read_text())
    if key == "length":
        data["length"] += 1e-9
    elif key == "configurations":
        data["configurations"][3][0] += 1e-9
    else:
        data["problem"]["scene"]["radii"][0] *= 0.5
    path.write_text(json.dumps(data))
    with pytest.raises(fp.InvalidInput, match="digest"):
        fp.Plan.load(path)


def resigned(path, change):
    """Change a plan file and give it a digest that fits, as only a forger would."""
    from ffsr_plan.plans.plan_file import digest

    data = json.loads(path.read_text())
    data.pop("sha256")
    change(data)
    path.write_text(json.dumps({"sha256": digest(data), **data}))


@pytest.mark.parametrize(
    "change",
    [
        lambda d: d["configurations"].pop(),
        lambda d: d.update(configurations=[]),
        lambda d: d.update(clearances=d["clearances"][:3]),
        lambda d: d["nodes"].pop(),
        lambda d: d["problem"]["lattice"].update(divisions=41),
        lambda d: d.update(length="a"),
        lambda d: d["planner"].update(name="ants"),
        lambda d: d.pop("history"),
    ],
)
def test_a_malformed_plan_with_a_valid_digest_is_refused(fig2a_plan, tmp_path, change):
    fig2a_plan.save(tmp_path / "plan.json")
    resigned(tmp_path / "plan.json", change)
    with pytest.raises(fp.InvalidInput):
        fp.Plan.load(tmp_path / "plan.json")


FORGED = [
    (lambda d: d.update(seed="x"), "seed: got 'x'"),
    (lambda d: d.update(seed=-1), "seed: got -1"),
    (lambda d: d.update(seed=True), "seed: got True"),
    (lambda d: d.update(interrupted="no"), "plan.json', interrupted"),
    (lambda d: d["certificate"].update(edges_free=-1), "edges_free: got -1"),
    (lambda d: d["certificate"].update(edges_refused=1.5), "edges_refused: got 1.5"),
    (lambda d: d["certificate"].update(node_queries="3"), "node_queries: got '3'"),
    (lambda d: d["certificate"].update(edge_queries=-2), "edge_queries: got -2"),
    (lambda d: d["certificate"].update(least_clearance=-0.5), "least_clearance: got -0.5"),
    (lambda d: d["nodes"].__setitem__(3, 999), "nodes, lateral: got 999"),
    (lambda d: d["certificate"].update(edges_free=39), "edges_free: got 39; allowed: at least 40"),
    (lambda d: d["trails"]["ants"].__setitem__(0, -5), "trails.ants.0: got -5; allowed: at least"),
    (lambda d: d["trails"]["laid"].__setitem__(3, -1.0), "trails.laid.3: got -1.0"),
    (lambda d: d["trails"]["pheromone"].__setitem__(1, -0.1), "trails.pheromone.1: got -0.1"),
    (lambda d: d["trails"]["tail"].__setitem__(1, -1), "trails.tail.1: got -1"),
    (lambda d: d["trails"]["head"].__setitem__(1, 10**6), "trails.head: got 1000000; allowed: 0"),
    (
        lambda d: [column.append(column[0]) for column in d["trails"].values()],
        r"trails: got \(0, .*; allowed: each edge .* once",
    ),
    (lambda d: d["history"]["distinct"].__setitem__(2, -1), "history.distinct.2: got -1"),
    (lambda d: d["history"]["distinct"].__setitem__(2, 31), "distinct.2: got 31; allowed: at most"),
    (
        lambda d: d["history"].update(best=[0.0 for _ in d["history"]["best"]]),
        "history.best.0: got 0.0; allowed: at least lattice_objective",
    ),
    (
        lambda d: d["history"]["best"].__setitem__(-1, 0.999 * d["lattice_objective"]),
        "history.best.[0-9]+: got .*; allowed: at least lattice_objective",
    ),
    (
        lambda d: d["history"]["best"].__setitem__(-1, 2.0 * d["history"]["best"][0]),
        "history.best.[0-9]+: got .*; allowed: at most that of the cycle before",
    ),
    (
        lambda d: d["history"]["best"].__setitem__(-1, None),
        "history.best.[0-9]+: got inf; allowed: at most that of the cycle before",
    ),
    (
        lambda d: d["history"]["iteration_best"].__setitem__(0, 0.5 * d["history"]["best"][0]),
        "history.best.0: got .*; allowed: at most history.iteration_best",
    ),
    (lambda d: d["history"]["mean"].__setitem__(0, -1.0), "history.mean.0: got -1.0"),
    (
        lambda d: d["problem"]["robot"].update(disabled_pairs=[["base", "left_link_2"]]),
        "disabled_pairs: got.*those of its SRDF",
    ),
    (
        lambda d: d["problem"]["robot"]["replacements"].append(
            {"link": "base", "number": 0, "shape": "mesh", "by": "hull", "excess": 0.0}
        ),
        "replacements: got.*those of its URDF",
    ),
]


@pytest.mark.parametrize(("change", "message"), FORGED)
def test_impossible_figures_with_a_valid_digest_are_refused(fig2a_plan, tmp_path, change, message):
    fig2a_plan.save(tmp_path / "plan.json")
    resigned(tmp_path / "plan.json", change)
    with pytest.raises(fp.InvalidInput, match=message):
        fp.Plan.load(tmp_path / "plan.json")


@pytest.mark.parametrize("lattice", [fp.Lattice(4), fp.Lattice(4, postures=[
    fp.PostureAxis({"left_1": 1.0}, 2, 0.1)])])  # fmt: skip
def test_nodes_lie_within_the_lattice(robot, tmp_path, lattice):
    goal = robot.configuration((4, 0, 0))
    plan = fp.plan(fp.Problem(robot, fp.Scene(), robot.neutral(), goal, lattice=lattice))
    path = tmp_path / "plan.json"
    plan.save(path)
    assert fp.Plan.load(path) == plan
    resigned(path, lambda d: d["nodes"].__setitem__(2, 3))
    with pytest.raises(fp.InvalidInput, match=r"nodes, .*got 3"):
        fp.Plan.load(path)


FIELDS = [
    (lambda d: d.update(zz=1), "unknown key: got 'zz'"),
    (lambda d: d["problem"].update(zz=1), "unknown key: got 'problem.zz'"),
    (lambda d: d["problem"]["scene"].update(radius=[]), "unknown key: got 'problem.scene.radius'"),
    (lambda d: d["problem"]["lattice"]["lateral"].update(width=1), "lattice.lateral.width'"),
    (lambda d: d["planner"].update(ant=1), "unknown key: got 'planner.ant'.*did you mean"),
    (
        lambda d: d.update(planner={"name": "lattice-optimum", "ants": 30}),
        "unknown key: got 'planner.ants'; allowed: no key",
    ),
    (lambda d: d["certificate"].pop("edges_free"), "certificate.edges_free: got None"),
    (lambda d: d.update(optimum="1"), "optimum: got '1'; allowed: a finite number"),
    (lambda d: d.update(length=True), "length: got True"),
    (lambda d: d["clearances"].__setitem__(1, "x"), "clearances: got"),
    (lambda d: d["nodes"].__setitem__(1, 0.5), "nodes: got"),
    (lambda d: d["motion"].update(positions=[[0.0]]), "motion.positions: got"),
    (lambda d: d["problem"]["scene"]["radii"].__setitem__(0, 10**400), "scene.radii: got"),
    (lambda d: d["problem"].update(tolerance=0), "problem.tolerance: got 0"),
    (lambda d: d["problem"]["lattice"].update(divisions=10**7), "nodes: got .*10000001"),
    (lambda d: d["problem"]["lattice"]["lateral"].update(half_count=10**8), "problem.lattice"),
    (
        lambda d: d.update(planner={"name": "posture-annealing"}),
        "planner.*: got .*allowed: .*posture ax",
    ),
]


@pytest.mark.parametrize(("change", "message"), FIELDS)
def test_a_refused_field_is_named_with_its_file(fig2a_plan, tmp_path, change, message):
    fig2a_plan.save(tmp_path / "plan.json")
    resigned(tmp_path / "plan.json", change)
    with pytest.raises(fp.InvalidInput, match=rf"^plan file '.*plan.json'.*{message}"):
        fp.Plan.load(tmp_path / "plan.json")


def test_a_key_that_is_there_twice_is_refused(fig2a_plan, tmp_path):
    path = tmp_path / "plan.json"
    fig2a_plan.save(path)
    path.write_text(path.read_text().rstrip()[:-1] + ',"length": 1.0}')
    with pytest.raises(fp.InvalidInput, match="key 'length': got 'two values'"):
        fp.Plan.load(path)


def test_a_plan_file_that_cannot_be_read_is_named_once(tmp_path):
    for path, reason in ((tmp_path / "no.json", "No such file or"), (tmp_path, "Is a directory")):
        message = rf"^plan file: got '{path}'; allowed: a readable UTF-8 file \({reason}"
        with pytest.raises(fp.InvalidInput, match=message):
            fp.Plan.load(path)


def test_a_byte_order_mark_is_no_change(fig2a_plan, tmp_path):
    path = tmp_path / "plan.json"
    fig2a_plan.save(path)
    path.write_text("\ufeff" + path.read_text())
    assert fp.Plan.load(path) == fig2a_plan


@pytest.mark.parametrize(
    "text",
    [
        "\0{}",
        '{"format": "ffsr-plan/3", "a": NaN}',
        "[" * 100_000,
        '{"a":' * 20_000,
        '{"a": ' + "1" * 5001 + "}",
    ],
)
def test_hostile_json_is_refused(tmp_path, text):
    (tmp_path / "plan.json").write_text(text)
    with pytest.raises(fp.InvalidInput):
        fp.Plan.load(tmp_path / "plan.json")
