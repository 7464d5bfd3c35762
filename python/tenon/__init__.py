"""Tenon's graphs in Python, over libtenon.

    import tenon
    graph = tenon.Graph.load("graphs/shell-256")
    panels = graph.set(thickness=12).evaluate("panels")["panels"]
    panels.front            # numpy array of all front corners, a view of the engine's memory

Lengths are mm, angles degrees at inputs and radians inside values. Arrays are read-only views: nothing is copied, and what
they belong to stays alive as long as they do.
"""

from __future__ import annotations

from ._graph import Diagnostic, Engine, Graph, Job, NodeReport, Result, TenonError, handle_count, version
from ._values import Curve, Feature, Features, File, Mesh, Opaque, Panels, Planes, Preview, Table, Value, Vectors

__all__ = [
    "Curve", "Diagnostic", "Engine", "Feature", "Features", "File", "Graph", "Job", "Mesh", "NodeReport", "Opaque", "Panels",
    "Planes", "Preview", "Result", "Table", "TenonError", "Value", "Vectors", "handle_count", "version",
]
