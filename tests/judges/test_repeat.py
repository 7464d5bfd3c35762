"""The same bytes for one thread and two, twice."""

import pytest
from conftest import GRAPHS


@pytest.mark.parametrize("graph", GRAPHS)
def test_same_bytes_for_any_number_of_threads(run, deep, graph):
    runs = [run(graph, "--threads", str(n)) for n in ([1, 2, 1, 2] + ([3, 8] if deep else []))]
    contents = [{f.name: f.read_bytes() for f in sorted(folder.iterdir())} for folder in runs]
    assert len(contents[0]) >= 8
    for other in contents[1:]:
        assert other.keys() == contents[0].keys()
        for name, data in other.items():
            assert data == contents[0][name], f"{graph}: {name} differs"
