"""ezdxf on every layout drawing, an XML parser on its SVG, a CSV reader on the list."""

import csv
from xml.etree import ElementTree

import ezdxf
import pytest
from conftest import RUNS


@pytest.mark.parametrize("graph", RUNS)
def test_dxf_reads_strictly_and_holds_every_piece(outputs, graph):
    made = outputs(graph)
    drawing = ezdxf.readfile(made.folder / "layout.dxf")
    audit = drawing.audit()
    assert not audit.errors and not audit.fixes
    assert drawing.dxfversion >= "AC1015" and drawing.units == ezdxf.units.MM
    space = drawing.modelspace()
    pieces = len(made.layout["pieces"])
    for layer in ("UPPER", "LOWER", "CLEARED"):
        assert len(space.query(f'LWPOLYLINE[layer=="{layer}"]')) == pieces
    assert len(space.query('LWPOLYLINE[layer=="BOARD"]')) == made.layout["boards"]
    holes = sum(not h["by_hand"] for p in made.pieces["pieces"] for h in p["holes"] if p["board"] is not None)
    assert len(space.query("CIRCLE")) == holes
    texts = {t.dxf.text for t in space.query("TEXT")}
    assert {p["address"] for p in made.layout["pieces"]} <= texts


@pytest.mark.parametrize("graph", RUNS)
def test_svg_holds_every_piece(outputs, graph):
    made = outputs(graph)
    root = ElementTree.parse(made.folder / "layout.svg").getroot()
    svg = "{http://www.w3.org/2000/svg}"
    upper = [e for e in root.iter(svg + "polygon") if e.get("class") == "upper"]
    assert len(upper) == len(made.layout["pieces"])
    texts = {e.text for e in root.iter(svg + "text")}
    assert {p["address"] for p in made.layout["pieces"]} <= texts


@pytest.mark.parametrize("graph", RUNS)
def test_csv_agrees_with_json(outputs, graph):
    made = outputs(graph)
    with open(made.folder / "pieces.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [r["address"] for r in rows] == [p["address"] for p in made.pieces["pieces"]]
    for row, piece in zip(rows, made.pieces["pieces"]):
        assert int(row["board"]) == piece["board"] + 1
        assert float(row["volume"]) == pytest.approx(piece["volume"], abs=0.051)
        assert [float(x) for x in row["lengths"].split()] == pytest.approx([e["length"] for e in piece["edges"]], abs=5.1e-4)
