"""The package against the library: values are views, errors have places, nothing leaks."""

import ctypes as c
import gc
import os
import platform
import shutil
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
import tenon
from tenon import _c

ROOT = Path(__file__).resolve().parents[2]
SHELL = ROOT / "graphs" / "shell-256"


@pytest.fixture(autouse=True)
def everything_is_freed():
    before = tenon.handle_count()
    yield
    gc.collect()
    assert tenon.handle_count() == before


def test_panels_are_views_that_outlive_the_graph():
    panels = tenon.Graph.load(SHELL).set(thickness=12).evaluate("panels").check()["panels"]
    gc.collect()
    assert len(panels) == 256 and panels.thickness == 12
    assert panels.front.shape == (len(panels.vertex), 3) and not panels.front.flags.owndata
    assert np.isfinite(panels.front).all()
    with pytest.raises(ValueError):
        panels.front[0, 0] = 1
    inner = panels.neighbour[:, 0] != 0xFFFFFFFF
    assert inner.sum() == 2 * 2 * 16 * 15
    # A neighbour's neighbour is the edge itself.
    rows = panels.corner_start[panels.neighbour[inner, 0]] + panels.neighbour[inner, 1]
    back = panels.corner_start[panels.neighbour[rows, 0]] + panels.neighbour[rows, 1]
    assert (back == np.flatnonzero(inner)).all()


def volume(points, faces):
    total = 0.0
    for face in faces:
        a = points[face[0]]
        for i, j in zip(face[1:], face[2:]):
            total += np.dot(a, np.cross(points[i], points[j]))
    return total / 6


def test_solids_are_closed_and_hold_the_wood():
    result = tenon.Graph.load(SHELL).evaluate("panels", "thicken.area").check()
    panels, area = result["panels"], result["thicken.area"]
    total = 0.0
    for i in range(len(panels)):
        points, faces = panels.solid(i)
        edges = [(a, b) for face in faces for a, b in zip(face, face[1:] + face[:1])]
        assert sorted(edges) == sorted((b, a) for a, b in edges), f"panel {i} is not closed"
        total += volume(points, faces)
    assert total == pytest.approx(area * panels.thickness, rel=0.1)


def test_only_what_changed_runs_and_old_results_stay():
    graph = tenon.Graph.load(SHELL)
    first = graph.evaluate("panels")["panels"]
    before = first.front.copy()
    second = graph.set({"arc.points": [[0, 0, 0], [900, 0, 1600], [3600, 0, 1500], [4500, 0, 0]]}).evaluate("panels")
    assert second["panels"].front[:, 2].max() > before[:, 2].max()
    assert (first.front == before).all()
    assert "folds" not in [n.node for n in second.nodes if n.happened == "executed"]
    assert graph.evaluate("panels").nodes == []


def test_features_and_files():
    result = tenon.Graph.load(SHELL).set(iterations=2).evaluate("screws.features", "hardware.file").check()
    features = result["screws.features"]
    assert {f.kind for f in features.features} == {"drill"} and features.features[0].purpose == "toe screw"
    assert sum(count for _, count in features.hardware) * 2 == len(features.features)
    files = result["hardware.file"]
    assert files.name == "hardware.csv" and b"Screw" in files.content


def test_numbers_texts_and_trees():
    graph = tenon.Graph.from_text({"format": "tenon", "version": 1, "units": "mm", "nodes": {}})
    graph.add("r", "range").set({"r.end": "1 + 1", "r.steps": 4})
    numbers = graph.evaluate("r.numbers")["r.numbers"]
    assert numbers.tolist() == [0, 0.5, 1, 1.5, 2]
    graph.add("g", "list").connect("r.numbers", "g.items")
    assert graph.evaluate("g.items").tree("g.items")[(0,)].tolist() == numbers.tolist()
    graph.add("t", "text").set({"t.value": "Ägäis"})
    assert graph.evaluate("t.value")["t.value"] == "Ägäis"
    assert graph.disconnect("r.numbers", "g.items").remove("r").evaluate("t.value").ok
    assert '"Ägäis"' in graph.save()


def test_errors_say_what_would_work():
    graph = tenon.Graph.load(SHELL)
    with pytest.raises(tenon.TenonError, match='did you mean "thickness"'):
        graph.set(thicknes=12)
    with pytest.raises(tenon.TenonError, match="4 to 30"):
        graph.set(thickness=500)
    with pytest.raises(tenon.TenonError, match="line 1"):
        tenon.Graph.from_text("{")
    failed = graph.set({"fold_1.x": 1e300}).evaluate("panels")
    assert not failed.ok and failed.diagnostics[0].node
    with pytest.raises(tenon.TenonError) as told:
        failed.check()
    assert told.value.node == failed.diagnostics[0].node
    with pytest.raises(tenon.TenonError, match="cannot be loaded"):
        tenon.Engine(plugins=["nowhere.so"])


def test_progress_and_cancelling():
    graph = tenon.Graph.load(SHELL)
    heard = []
    graph.evaluate("panels", progress=lambda fraction, node: heard.append((fraction, node))).check()
    assert heard and all(0 <= f <= 1 for f, _ in heard)
    cancelled = graph.set(thickness=15).evaluate("panels", progress=lambda *_: False)
    assert cancelled.cancelled and cancelled.diagnostics == []
    assert graph.evaluate("panels")["panels"].thickness == 15


def test_threads_share_an_engine():
    engine, found = tenon.Engine(threads=1), {}

    def work(n):
        found[n] = len(tenon.Graph.load(SHELL, engine).set(iterations=n).evaluate("panels")["panels"])

    threads = [threading.Thread(target=work, args=(n,)) for n in (1, 2, 3)]
    [t.start() for t in threads]
    [t.join() for t in threads]
    assert found == {1: 4, 2: 16, 3: 64}


def test_node_types_are_described():
    engine = tenon.Engine()
    assert engine.describe("thicken")["type"] == "thicken"
    assert len(engine.describe()) > 30
    with pytest.raises(tenon.TenonError, match='did you mean "thicken"'):
        engine.describe("thiken")


def test_jobs_are_of_the_graph_as_it_was():
    graph = tenon.Graph.load(SHELL)
    jobs = []
    for thickness in (11, 12, 13):
        jobs.append(graph.set(thickness=thickness).start("panels"))
    graph.set(thickness=20)
    assert [job.result().check()["panels"].thickness for job in reversed(jobs)] == [13, 12, 11]
    assert all(job.done and job.progress == 1 for job in jobs)
    assert graph.evaluate("panels")["panels"].thickness == 20


def test_jobs_tell_of_progress_and_of_their_end():
    graph = tenon.Graph.load(SHELL)
    heard, ended = [], threading.Event()
    job = graph.start("panels", progress=lambda *told: heard.append(told), done=ended.set)
    assert ended.wait(60) and job.wait(0) is not None and heard
    # Cancelled by progress, by the job, by dropping it.
    assert graph.set(thickness=15).start("panels", progress=lambda *_: False).result().cancelled
    job = graph.set({"arc.points": [[0, 0, 0], [900, 0, 1600], [3600, 0, 1500], [4500, 0, 0]]}).start("panels")
    job.cancel()
    assert job.result().cancelled or job.result().ok
    ended.clear()
    job = graph.set(thickness=16).start(done=ended.set)
    del job
    assert ended.is_set()
    # An evaluation that would wait for itself is refused, in words.
    refused = []

    def wait(*_):
        try:
            graph.evaluate("panels")
        except tenon.TenonError as error:
            refused.append(str(error))

    graph.set(thickness=17).start("panels", progress=wait).result().check()
    assert refused and "tenon_graph_start" in refused[0]


def test_arrays_are_given_and_shared():
    graph = tenon.Graph.from_text({"format": "tenon", "version": 1, "units": "mm", "nodes": {}})
    graph.add("list", "list").add("half", "expression").set({"half.formula": "x / 2"})
    numbers = np.arange(1000.0)
    graph.give("half.x", numbers)
    numbers[0] = 7
    assert graph.evaluate("half.value")["half.value"][:3].tolist() == [0, 0.5, 1]
    # A list that goes through is the caller's own memory, which must not change any more.
    graph.share("list.items", numbers)
    result = graph.evaluate("list.items")
    assert result["list.items"].ctypes.data == numbers.ctypes.data
    with pytest.raises(ValueError):
        numbers[0] = 8
    graph.give("half.x", {(0, 1): [2, 4], (3,): np.array([1.0])})
    assert {path: v.tolist() for path, v in graph.evaluate("half.value").tree("half.value").items()} == {
        (0, 1): [1, 2],
        (3,): [0.5],
    }
    graph.set({"half.x": [1, None, 3]})
    gaps = graph.evaluate("half.value")["half.value"]
    assert np.isnan(gaps[1]) and gaps[2] == 1.5
    assert len(graph.give("list.items", np.eye(3)).evaluate("list.items")["list.items"]) == 3
    assert graph.give("list.items", ["a", "Ä"]).evaluate("list.items")["list.items"] == ["a", "Ä"]
    with pytest.raises(TypeError, match="cannot be given"):
        graph.give("list.items", object())
    with pytest.raises(tenon.TenonError, match="takes number, but text came in"):
        graph.give("half.x", "a")
    with pytest.raises(tenon.TenonError, match="not finite"):
        graph.share("half.x", np.array([1, np.nan]))
    del graph, result
    gc.collect()
    assert tenon._callbacks.lent_count() == 0


def folded():
    points = [[0, 0, 0], [200, 0, 0], [400, 0, 50], [0, 100, 0], [200, 100, 0], [400, 100, 50]]
    return tenon.Mesh.from_faces(points, [[0, 1, 4, 3], [1, 2, 5, 4]])


def thickened():
    graph = tenon.Graph.from_text({"format": "tenon", "version": 1, "units": "mm", "nodes": {}})
    return graph.add("order", "order_faces").add("thicken", "thicken").connect("order.mesh", "thicken.mesh")


def test_meshes_are_given_and_seen():
    result = thickened().give("order.mesh", folded()).evaluate("thicken.panels").check()
    panels, seen = result["thicken.panels"], result.preview("thicken.panels")
    assert (seen.node, seen.port, len(seen.parts)) == ("thicken", "panels", 2)
    assert seen.triangles.max() < len(seen.positions) and not seen.positions.flags.owndata
    corners = (seen.positions.astype(float) + seen.origin)[seen.triangles]
    inside = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert inside == pytest.approx(sum(volume(*panels.solid(i)) for i in range(2)), rel=1e-6)
    assert seen.parts["row"].tolist() == panels.address[:, 1].tolist()


@pytest.fixture(scope="session")
def plugin(tmp_path_factory):
    """Compiles an example of a plugin in C, in a folder of its own."""

    def make(source, name, *extra):
        library = tmp_path_factory.mktemp(name) / f"{name}.so"
        command = ["cc", "-std=c11", "-shared", "-fPIC", "-pthread", *extra, "-I", ROOT / "plugin-sdk" / "include"]
        subprocess.run([*command, ROOT / "plugin-sdk" / "examples" / source, "-o", library, "-lm"], check=True)
        return library

    return make


def test_plugins_bring_node_types(plugin):
    library = plugin("fastener-c/hinge.c", "hinges")
    engine = tenon.Engine(plugins=[library])
    assert engine.describe("hinges.butt_hinge")["category"] == "Joint"
    nodes = {
        "order": {"type": "order_faces"},
        "thicken": {"type": "thicken", "inputs": {"mesh": {"from": ["order.mesh"]}}},
        "hinges": {"type": "hinges.butt_hinge", "inputs": {"panels": {"from": ["thicken.panels"]}}},
    }
    text = {"format": "tenon", "version": 1, "units": "mm", "requires": {"hinges": ">=1"}, "nodes": nodes}
    for engine in (engine, tenon.Engine(folders=[library.parent])):
        graph = tenon.Graph.from_text(text, engine=engine).give("order.mesh", folded())
        features = graph.evaluate("hinges.features").check()["hinges.features"]
        assert features.hardware == [("Butt hinge 40 x 40", 1), ("Screw 3 x 10", 4)] and len(features.features) == 4
    # Without it the graph is loaded all the same, says what it lacks, and is saved as it was.
    without = tenon.Graph.from_text(graph.save()).give("order.mesh", folded())
    assert without.save() == graph.save()
    result = without.evaluate("thicken.panels")
    assert len(result["thicken.panels"]) == 2
    [missing] = [d for d in result.diagnostics if d.code == "missing-plugin"]
    assert "needs the plugin hinges >=1" in missing.message and "put its library into" in missing.hint
    with pytest.raises(tenon.TenonError, match="is NULL"):
        tenon._graph._must(tenon._c.LIB.tenon_engine_new(c.byref(_c.Config(size=72, folder_count=1)), c.byref(c.c_void_p())))


def test_a_plugin_that_crashes_in_its_own_process_is_a_diagnostic(plugin, monkeypatch):
    program = os.environ.get("TENON") or shutil.which("tenon") or ROOT / "target" / "release" / "tenon"
    monkeypatch.setenv("TENON_PLUGIN_HOST", str(Path(program).resolve()))
    library = plugin("misbehaving-c/misbehaving.c", "misbehaving", "-DLOADABLE")
    nodes = {"doomed": {"type": "misbehaving.doomed"}}
    text = {"format": "tenon", "version": 1, "units": "mm", "nodes": nodes}
    for engine, requires in (
        (tenon.Engine(plugins=[library]), {"misbehaving": {"isolation": "process"}}),
        (tenon.Engine(plugins=[library], isolate=["misbehaving"]), {}),
    ):
        graph = tenon.Graph.from_text({**text, "requires": requires}, engine=engine)
        [died] = graph.set({"doomed.x": 101}).evaluate("doomed.y").diagnostics
        assert (died.code, died.node) == ("plugin-died", "doomed") and "signal 11" in died.message
        assert graph.set({"doomed.x": 2}).evaluate("doomed.y").check()["doomed.y"] == 2


def test_tables_cross_both_ways():
    graph = tenon.Graph.from_text({"format": "tenon", "version": 1, "units": "mm", "nodes": {}})
    graph.add("cut", "set_attribute").set({"cut.name": "length", "cut.values": [2.5, 7.5, 10]})
    graph.add("kind", "set_attribute").connect("cut.table", "kind.table")
    graph.set({"kind.name": "kind", "kind.values": ["a", "b", "c"]})
    table = graph.evaluate("kind.table").check()["kind.table"]
    del graph
    gc.collect()
    assert isinstance(table, tenon.Table) and len(table) == 3 and list(table.attributes) == ["length", "kind"]
    assert table["kind"] == ["a", "b", "c"] and table["length"].tolist() == [2.5, 7.5, 10]
    assert not table["length"].flags.owndata and not table["length"].flags.writeable
    with pytest.raises(TypeError):
        table.attributes["length"] = [1]
    # The other way, with every kind of attribute and with gaps; what comes back is the same.
    graph = tenon.Graph.from_text({"format": "tenon", "version": 1, "units": "mm", "nodes": {}}).add("list", "list")
    given = tenon.Table.of(
        length=np.array([1.0, 2.0]),
        number=[7, None],
        name=["Ä", None],
        at=np.eye(3)[:2],
        along=tenon.Vectors(np.eye(3)[1:]),
        cut=tenon.Planes([[1, 0, 0, 5], [0, 0, 1, -2]]),
        good=[True, False],
    )
    table = graph.give("list.items", given).evaluate("list.items").check()["list.items"]
    assert list(table.attributes) == ["length", "number", "name", "at", "along", "cut", "good"]
    assert table["length"].tolist() == [1, 2] and table["number"] == [7, None] and table["name"] == ["Ä", None]
    assert (table["at"] == np.eye(3)[:2]).all() and (table["along"] == np.eye(3)[1:]).all()
    assert table["cut"].tolist() == [[1, 0, 0, 5], [0, 0, 1, -2]] and table["good"].tolist() == [True, False]
    with pytest.raises(ValueError, match="one value per row"):
        tenon.Table.of(a=[1], b=[1, 2])
    with pytest.raises(tenon.TenonError, match="one per row"):
        graph.give("list.items", tenon.Table(3, {"a": [1.0, 2.0]}))
    with pytest.raises(tenon.TenonError, match="normal"):
        graph.give("list.items", tenon.Planes([[1, 1, 0, 5]]))


def test_vectors_planes_and_panels_are_given():
    graph = tenon.Graph.from_text({"format": "tenon", "version": 1, "units": "mm", "nodes": {}}).add("list", "list")
    vectors = graph.give("list.items", tenon.Vectors([[1, 2, 3], [0, 0, 0]])).evaluate("list.items")
    assert vectors["list.items"].tolist() == [[1, 2, 3], [0, 0, 0]] and vectors.json("list.items") != []
    assert graph.give("list.items", tenon.Planes([0, 0, 1, 3])).evaluate("list.items")["list.items"].tolist() == [0, 0, 1, 3]
    made = thickened().give("order.mesh", folded()).evaluate("thicken.panels").check()["thicken.panels"]
    back = graph.give("list.items", made).evaluate("list.items").check()["list.items"]
    assert back.thickness == made.thickness and len(back) == 2
    for name in ("corner_start", "address", "normal", "front", "vertex", "chamfer", "neighbour", "side", "back_end", "voided"):
        assert (getattr(back, name) == getattr(made, name)).all() and not getattr(back, name).flags.owndata, name
    # Gaps and lists of one type, whatever stands first.
    assert graph.give("list.items", [folded(), None]).evaluate("list.items")["list.items"][1] is None
    points = graph.give("list.items", [None, (1, 2, 3)]).evaluate("list.items")["list.items"]
    assert np.isnan(points[0]).all() and points[1].tolist() == [1, 2, 3]
    for mixed in ([1.0, "a"], ["a", 1.0], [True, 2], [2, True], [folded(), 1.0], [[1, 2, 3], 4]):
        with pytest.raises(TypeError, match="item 1 is a .* in a list that begins with a"):
            graph.give("list.items", mixed)
    with pytest.raises(TypeError, match="nothing but gaps"):
        graph.give("list.items", [None])


def test_the_interface_is_described():
    graph = tenon.Graph.load(SHELL)
    inputs = {i["name"]: i for i in graph.inputs}
    thickness = inputs["thickness"]
    assert (thickness["type"], thickness["access"], thickness["unit"]) == ("number", "item", "mm")
    assert (thickness["min"], thickness["max"], thickness["value"], thickness["choices"]) == (4, 30, 10, [])
    assert thickness["default"] is not None and thickness["ports"] and thickness["doc"]
    assert {i["name"]: i["value"] for i in graph.set(thickness=12).inputs}["thickness"] == 12
    outputs = {o["name"]: o for o in graph.outputs}
    assert (outputs["panels"]["type"], outputs["panels"]["access"]) == ("panels", "item")
    assert outputs["net_area"]["type"] == "number" and outputs["net_area"]["unit"]


def test_times_and_sizes_of_nodes_are_told():
    result = tenon.Graph.load(SHELL).evaluate("panels").check()
    nodes = {n.node: n for n in result.nodes}
    thicken = nodes["thicken"]
    assert thicken.happened == "executed" and thicken.type_name == "thicken" and 0 < thicken.seconds < 60
    panels = result["panels"]
    assert thicken.bytes >= panels.front.nbytes + panels.chamfer.nbytes + panels.back_start.nbytes


STRUCTS = {"evaluate_options": "Options", "engine_config": "Config", "vec3": "Vec3"}


def test_structs_lie_as_the_headers_say():
    if sys.platform != "linux" or platform.machine() != "x86_64":
        pytest.skip("the layout is written down for x86_64 Linux")
    lines = []
    for file in ("capi/tests/layout-x86_64-linux.txt", "plugin-sdk/tests/layout-x86_64-linux.txt"):
        lines += (ROOT / file).read_text().splitlines()
    structs, struct = 0, None
    for line in lines:
        name, number = line.split()
        if not line.startswith(" "):
            bare = name.removeprefix("tenon_")
            struct = getattr(_c, STRUCTS.get(bare, "".join(part.title() for part in bare.split("_"))), None)
            structs += struct is not None
            assert struct is None or c.sizeof(struct) == int(number), name
        elif struct is not None:
            assert getattr(struct, name).offset == int(number), f"{struct}.{name}"
    assert structs >= 17
