"""The package against the library: values are views, errors have places, nothing leaks."""

import ctypes as c
import gc
import os
import platform
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


if os.environ.get("TENON_TEST_PLUGIN"):

    def test_plugins_bring_node_types():
        engine = tenon.Engine(plugins=[os.environ["TENON_TEST_PLUGIN"]])
        assert engine.describe("hinges.butt_hinge")["category"] == "Joint"


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
    assert structs >= 15
