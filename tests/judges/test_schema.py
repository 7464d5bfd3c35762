"""The schemas are schemas, and every file under graphs/ is what they say: judged by jsonschema."""

import copy
import json
import subprocess

import pytest
from conftest import ROOT
from jsonschema import Draft202012Validator

FILES = sorted(ROOT.glob("graphs/**/*.tenon.json"))


@pytest.fixture(scope="module", params=[[], ["--nodes"]], ids=["any nodes", "installed nodes"])
def schema(request, tenon):
    printed = subprocess.run([tenon, "schema", *request.param], capture_output=True, text=True, check=True)
    schema = json.loads(printed.stdout)
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


def errors(schema, graph):
    return [f"{e.json_path}: {e.message}" for e in schema.iter_errors(graph)]


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.stem)
def test_every_graph_is_what_the_schema_says(schema, file):
    assert errors(schema, json.loads(file.read_text())) == []


def change(graph, path, value):
    changed = copy.deepcopy(graph)
    at = changed
    for key in path[:-1]:
        at = at.setdefault(key, {})
    at[path[-1]] = value
    return changed


@pytest.mark.parametrize(
    "path, value",
    [
        (["format"], "dxf"),
        (["version"], 2),
        (["nodes", "map", "state"], "asleep"),
        (["nodes", "map", "v"], 0),
        (["nodes", "map", "type"], 7),
        (["nodes", "map", "inputs", "panels"], {"tree": ["graft"]}),
        (["nodes", "map", "inputs", "panels", "from"], ["thicken"]),
        (["nodes", "map", "inputs", "panels", "tree"], ["prune"]),
        (["nodes", "a.b"], {"type": "map"}),
        (["interface", "outputs", "boards"], {"doc": "without a port"}),
        (["interface", "version"], 0),
        (["clusters", "strip"], {"file": 3}),
        (["clusters", "strip"], {"file": "strip.tenon.json", "version": 0}),
        (["clusters", "strip"], {"file": "strip.tenon.json", "nodes": {}}),
        (["clusters", "strip"], {"clusters": {}}),
        (["clusters", "strip", "nodes", "a.b"], {"type": "map"}),
    ],
    ids=lambda v: ".".join(v) if isinstance(v, list) else None,
)
def test_what_the_program_refuses_the_schema_refuses(schema, tenon, tmp_path, path, value):
    graph = change(json.loads((ROOT / "graphs/shell-256/shell-256.tenon.json").read_text()), path, value)
    assert errors(schema, graph) != []
    file = tmp_path / "wrong.tenon.json"
    file.write_text(json.dumps(graph))
    assert subprocess.run([tenon, "check", file], capture_output=True).returncode != 0


@pytest.mark.parametrize(
    "path, value",
    [
        (["nodes", "map", "type"], "mapp"),
        (["nodes", "map", "params", "adress_height"], 30),
        (["nodes", "map", "params", "address_height"], True),
        (["nodes", "map", "params", "address_height"], -1),
        (["nodes", "map", "inputs", "pannels"], {"from": ["thicken.panels"]}),
        (["nodes", "screws", "params", "kind"], "nail"),
    ],
    ids=lambda v: ".".join(v) if isinstance(v, list) else None,
)
def test_what_the_installed_nodes_do_not_know(schema, tenon, tmp_path, path, value):
    graph = change(json.loads((ROOT / "graphs/shell-256/shell-256.tenon.json").read_text()), path, value)
    narrow = "anyOf" in schema.schema["$defs"]["node"]["properties"]["type"]
    assert (errors(schema, graph) != []) == narrow
    file = tmp_path / "wrong.tenon.json"
    file.write_text(json.dumps(graph))
    assert subprocess.run([tenon, "check", file], capture_output=True).returncode == 1


EXPECTATIONS = sorted(ROOT.glob("graphs/**/*.expect.json"))


@pytest.fixture(scope="module")
def expectations(tenon):
    printed = subprocess.run([tenon, "schema", "--expect"], capture_output=True, text=True, check=True).stdout
    assert printed == (ROOT / "docs/expect.schema.json").read_text()
    Draft202012Validator.check_schema(json.loads(printed))
    return Draft202012Validator(json.loads(printed))


@pytest.mark.parametrize("file", EXPECTATIONS, ids=lambda f: f.stem)
def test_every_expectation_is_what_its_schema_says(expectations, file):
    assert errors(expectations, json.loads(file.read_text())) == []


def test_nothing_else_under_graphs_is_json_of_ours():
    others = {f for f in ROOT.glob("graphs/**/*.json")} - set(FILES) - set(EXPECTATIONS)
    assert others == set()


@pytest.mark.parametrize(
    "path, value",
    [
        (["format"], "tenon"),
        (["version"], 2),
        (["tolerance", "abs"], -1),
        (["diagnostics", "gap"], "two"),
        (["outputs", "boards"], 3),
        (["outputs", "boards", "tolerance", "rel"], "small"),
        (["set"], "all"),
    ],
    ids=lambda v: ".".join(v) if isinstance(v, list) else None,
)
def test_expectations_that_the_program_refuses_the_schema_refuses(expectations, tenon, tmp_path, path, value):
    folder = ROOT / "graphs/shell-256"
    wrong = change(json.loads((folder / "shell-256.expect.json").read_text()), path, value)
    assert errors(expectations, wrong) != []
    (tmp_path / "g.tenon.json").write_text((folder / "shell-256.tenon.json").read_text())
    (tmp_path / "g.expect.json").write_text(json.dumps(wrong))
    refused = subprocess.run([tenon, "test", tmp_path / "g.tenon.json"], capture_output=True, text=True)
    assert refused.returncode != 0 and "bad-expectations" in refused.stderr + refused.stdout
