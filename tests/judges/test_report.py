"""Reports are what their documented schema says, for graphs that are well and for graphs that are not: judged by jsonschema."""

import json
import subprocess

import pytest
from conftest import ROOT
from jsonschema import Draft202012Validator

FILES = sorted(ROOT.glob("graphs/*/*.tenon.json"))


@pytest.fixture(scope="module")
def schema(tenon):
    printed = subprocess.run([tenon, "schema", "--report"], capture_output=True, text=True, check=True).stdout
    assert printed == (ROOT / "docs/report.schema.json").read_text()
    schema = json.loads(printed)
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


def report(tenon, folder, graph, *arguments):
    subprocess.run([tenon, "run", graph, "--report", folder / "report.json", *arguments], capture_output=True)
    return json.loads((folder / "report.json").read_text())


def errors(schema, report):
    return [f"{e.json_path}: {e.message}" for e in schema.iter_errors(report)]


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.stem)
def test_the_report_of_every_graph(schema, tenon, tmp_path, file):
    made = report(tenon, tmp_path, file, "--out", tmp_path / "out")
    assert errors(schema, made) == []
    # In equal instances of a cluster, what one has computed the others remember.
    happened = {"executed", "memo"} if "cluster:" in file.read_text() else {"executed"}
    assert {n["happened"] for n in made["nodes"]} == happened
    for written in made["files"]:
        assert written["bytes"] == (tmp_path / "out" / written["name"]).stat().st_size


def test_the_report_of_a_graph_with_errors(schema, tenon, tmp_path):
    graph = json.loads((ROOT / "graphs/shell-256/shell-256.tenon.json").read_text())
    graph["nodes"]["thicken"]["params"]["thickness"] = 4000
    graph["nodes"]["screws"]["type"] = "detial"
    graph["nodes"]["solids"]["state"] = "disabled"
    file = tmp_path / "wrong.tenon.json"
    file.write_text(json.dumps(graph))
    made = report(tenon, tmp_path, file)
    assert errors(schema, made) == []
    assert made["ok"] is False and made["files"] == []
    codes = {d["code"] for d in made["diagnostics"]}
    assert {"unknown-node", "blocked"} <= codes and len(codes) > 2
    assert {"executed", "failed", "blocked"} <= {n["happened"] for n in made["nodes"]}
    assert any(d["item"] is not None for d in made["diagnostics"])


def test_values_stand_in_what_json_prints(schema, tenon):
    done = subprocess.run(
        [tenon, "run", ROOT / "graphs/shell-256", "--json", "--get", "boards"], capture_output=True, text=True, check=True
    )
    made = json.loads(done.stdout)
    assert errors(schema, made) == [] and list(made["values"]) == ["boards"]


@pytest.mark.parametrize("key, value", [("happened", "slept"), ("digest", "7"), ("bytes", -1), ("mood", "good")])
def test_a_wrong_report_is_refused(schema, tenon, tmp_path, key, value):
    made = report(tenon, tmp_path, ROOT / "graphs/shell-256", "--get", "boards")
    made["nodes"][0][key] = value
    assert errors(schema, made) != []
