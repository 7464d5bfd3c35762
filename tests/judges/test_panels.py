"""trimesh on every panel."""

import pytest
from conftest import RUNS


@pytest.mark.parametrize("graph", RUNS)
def test_panels_are_closed_and_as_large_as_listed(outputs, graph):
    made = outputs(graph)
    assert set(made.panels) == set(made.piece_of)
    for address, panel in made.panels.items():
        mesh = panel.mesh()
        assert mesh.is_watertight and mesh.is_winding_consistent, f"{address} is not closed"
        assert mesh.volume == pytest.approx(made.piece_of[address]["volume"], rel=1e-9), address
    total = made.pieces["total"]
    assert total["volume"] == pytest.approx(sum(p.mesh().volume for p in made.panels.values()), rel=1e-9)
    assert total["pieces"] == len(made.panels)
