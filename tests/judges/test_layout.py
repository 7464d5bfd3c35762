"""shapely on every layout."""

import pytest
from conftest import GRAPHS
from layout import faults


@pytest.mark.parametrize("graph", GRAPHS)
def test_layout_is_valid(outputs, graph):
    assert faults(outputs(graph)) == []


def test_prototype_three_fits_on_four_boards(outputs):
    layout = outputs("shell-256").layout
    assert len(layout["pieces"]) == 256 and layout["boards"] <= 4
    assert layout["size"] == [1500, 3000] and layout["thickness"] == 10
