"""shapely on every layout."""

import json

import pytest
from conftest import ROOT, RUNS
from layout import faults


@pytest.mark.parametrize("graph", RUNS)
def test_layout_is_valid(outputs, graph):
    (file,) = (ROOT / "graphs" / graph.partition(" of ")[0]).glob("*.tenon.json")
    (pack,) = [n for n in json.loads(file.read_text())["nodes"].values() if n["type"] == "pack"]
    assert faults(outputs(graph), pack.get("params", {}).get("inside", "cleared")) == []


def test_prototype_three_fits_on_four_boards(outputs):
    layout = outputs("shell-256").layout
    assert len(layout["pieces"]) == 256 and layout["boards"] <= 4
    assert layout["size"] == [1500, 3000] and layout["thickness"] == 10
