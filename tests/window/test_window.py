"""What only a real window can show: a shell wired by mouse and keyboard alone, and work that outlives a kill."""

import json
import shutil
import subprocess
import time

from conftest import ROOT, program
from hand import Hand

SHELL = ROOT / "graphs" / "shell-256" / "shell-256.tenon.json"


def files(tenon, graph, out):
    """What `tenon run` makes of a graph: bytes by name."""
    done = subprocess.run([tenon, "run", graph, "--out", out], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
    return {p.relative_to(out).as_posix(): p.read_bytes() for p in out.rglob("*") if p.is_file()}


def copy(tmp_path):
    graph = tmp_path / "copy.tenon.json"
    shutil.copy(SHELL, graph)
    return graph


def test_a_shell_is_wired_from_nothing_by_mouse_and_keyboard(window, tenon, tmp_path):
    whole = json.loads(SHELL.read_text())
    w = window()
    hand = Hand(w)
    hand.begin()
    hand.build(whole)
    built = tmp_path / "built.tenon.json"
    hand.save_as(built)
    mended = hand.mend(whole, json.loads(built.read_text()))
    if mended:
        print(f"{mended} clicks missed their aim and were done again")
        w.key("ctrl+s")
        w.calm()

    # First what was wired, which says more than bytes do when something is missing.
    said, meant = json.loads(built.read_text())["nodes"], whole["nodes"]
    parts = lambda node: (node["type"], node.get("inputs", {}))
    assert {id: parts(node) for id, node in said.items()} == {id: parts(node) for id, node in meant.items()}
    for id, node in said.items():
        # The window leaves out what is the default anyway.
        assert node.get("params", {}).items() <= meant[id].get("params", {}).items(), id

    ours, theirs = files(tenon, built, tmp_path / "built"), files(tenon, SHELL, tmp_path / "theirs")
    programs = [name for name in theirs if name.endswith(".ngc")]
    assert programs, sorted(theirs)
    assert sorted(ours) == sorted(theirs)
    for name in theirs:
        assert ours[name] == theirs[name], f"{name} differs"


def drag_point(w):
    """Drags a control point of the shell in the viewport."""
    x, y = w.middle("point arc.points 2")
    w.drag((x, y), (x + 30, y - 40))


def points(graph):
    """The graph without the arc's control points, and these."""
    text = json.loads(graph.read_text())
    return text, text["nodes"]["arc"]["params"].pop("points")


def test_a_control_point_is_dragged_in_space_and_saved(window, tmp_path):
    graph = copy(tmp_path)
    rest, was = points(graph)
    w = window(graph)
    w.settled()
    drag_point(w)
    w.key("ctrl+s")
    w.until(lambda: points(graph)[1] != was, "the file has changed")
    after, now = points(graph)
    assert after == rest, "nothing else has changed"
    assert len(now) == 4 and sum(a != b for a, b in zip(now, was)) == 1, now


def kept(graph):
    """The arc's control points as the window keeps them in case it is killed; none if it keeps nothing."""
    try:
        text = graph.with_name(f".{graph.name}.unsaved").read_text()
        return json.JSONDecoder().raw_decode(text)[0]["nodes"]["arc"]["params"]["points"]
    except (FileNotFoundError, ValueError):
        return None


def keeping(w, graph, key, value):
    """Seconds from a key that was seen until what it makes of the control points is kept."""
    w.key(key)
    start = time.monotonic()
    w.until(lambda: kept(graph) == value, f"{key} is kept")
    return time.monotonic() - start


def test_a_kill_loses_at_most_the_last_second(window, tmp_path):
    graph = copy(tmp_path)
    w = window(graph)
    w.settled()
    values = [points(graph)[1]]
    for _ in range(2):
        drag_point(w)
        w.key("ctrl+s")
        w.until(lambda: points(graph)[1] != values[-1], "the file has changed")
        values.append(points(graph)[1])
    # The last step is taken back: what the window holds now is known, and stands neither in the file nor in the first one.
    text, last = graph.read_bytes(), values[1]
    seconds = keeping(w, graph, "ctrl+z", last)
    assert seconds <= 1.0, seconds
    w.kill()
    assert graph.read_bytes() == text, "the file itself is as it was"
    assert points(graph)[1] != last != values[0]

    w = window(graph)
    w.click(w.middle("Recover it"))
    w.until(lambda: not w.has("Recover it"), "the work is taken")
    w.key("ctrl+s")
    w.until(lambda: graph.read_bytes() != text, "the work is back, and saved")
    assert points(graph)[1] == last, "as it was before the kill"


def test_an_idle_window_rests(window, tmp_path):
    w = window(copy(tmp_path))
    w.settled()
    w.calm()
    before = w.processor_time()
    time.sleep(10)
    # 1 %, which a window that draws nothing stays far below.
    assert w.processor_time() - before < 0.1


def test_without_any_graphics_it_says_what_to_install(screen, tmp_path):
    environment = {"DISPLAY": screen.display, "HOME": str(tmp_path), "VK_ICD_FILENAMES": "/nowhere", "WGPU_BACKEND": "vulkan"}
    done = subprocess.run([program("TENON_EDITOR", "tenon-editor")], env=environment, capture_output=True, text=True, timeout=60)
    assert done.returncode == 1 and "mesa-vulkan-drivers" in done.stderr, done.stderr
