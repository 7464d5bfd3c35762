"""The C interface of libtenon as ctypes: structs as in tenon_value.h and tenon.h, and the library itself."""

from __future__ import annotations

import ctypes as c
import os
import sys
from pathlib import Path


class Str(c.Structure):
    _fields_ = [("ptr", c.c_void_p), ("len", c.c_uint64)]

    def __str__(self) -> str:
        return c.string_at(self.ptr, self.len).decode() if self.len else ""


class Column(c.Structure):
    _fields_ = [
        ("size", c.c_uint32),
        ("kind", c.c_uint32),
        ("type_name", Str),
        ("items", c.c_void_p),
        ("count", c.c_uint64),
        ("stride", c.c_uint64),
        ("valid", c.c_void_p),
    ]


class Branch(c.Structure):
    _fields_ = [("path", c.c_void_p), ("path_count", c.c_uint64), ("column", Column)]


class Tree(c.Structure):
    _fields_ = [
        ("size", c.c_uint32),
        ("branch_stride", c.c_uint32),
        ("branches", c.c_void_p),
        ("branch_count", c.c_uint64),
    ]


class Curve(c.Structure):
    _fields_ = [
        ("size", c.c_uint32),
        ("closed", c.c_uint32),
        ("points", c.c_void_p),
        ("point_count", c.c_uint64),
        ("strip_start", c.c_void_p),
        ("strip_count", c.c_uint64),
    ]


class Mesh(c.Structure):
    _fields_ = [
        ("size", c.c_uint32),
        ("flags", c.c_uint32),
        ("points", c.c_void_p),
        ("point_count", c.c_uint64),
        ("face_start", c.c_void_p),
        ("face_count", c.c_uint64),
        ("face_vertices", c.c_void_p),
        ("face_vertex_count", c.c_uint64),
        ("addresses", c.c_void_p),
    ]


class Panels(c.Structure):
    _fields_ = [
        ("size", c.c_uint32),
        ("flags", c.c_uint32),
        ("thickness", c.c_double),
        ("panel_count", c.c_uint64),
        ("corner_count", c.c_uint64),
        ("corner_start", c.c_void_p),
        ("address", c.c_void_p),
        ("normal", c.c_void_p),
        ("front", c.c_void_p),
        ("vertex", c.c_void_p),
        ("chamfer", c.c_void_p),
        ("neighbour", c.c_void_p),
        ("side", c.c_void_p),
        ("back_start", c.c_void_p),
        ("back_end", c.c_void_p),
        ("voided", c.c_void_p),
    ]


class Attribute(c.Structure):
    _fields_ = [("name", Str), ("column", Column)]


class Table(c.Structure):
    _fields_ = [
        ("size", c.c_uint32),
        ("attribute_stride", c.c_uint32),
        ("row_count", c.c_uint64),
        ("attributes", c.c_void_p),
        ("attribute_count", c.c_uint64),
    ]


class Vec3(c.Structure):
    _fields_ = [("x", c.c_double), ("y", c.c_double), ("z", c.c_double)]


class Feature(c.Structure):
    _fields_ = [
        ("size", c.c_uint32),
        ("kind", c.c_uint32),
        ("panel", c.c_uint32),
        ("edge", c.c_uint32),
        ("joint", c.c_uint32),
        ("by_hand", c.c_uint32),
        ("at", Vec3),
        ("to", Vec3),
        ("axis", Vec3),
        ("depth", c.c_double),
        ("width", c.c_double),
        ("line", c.c_void_p),
        ("line_count", c.c_uint64),
        ("text", Str),
        ("purpose", Str),
    ]


class Hardware(c.Structure):
    _fields_ = [("name", Str), ("count", c.c_uint64)]


class Features(c.Structure):
    _fields_ = [
        ("size", c.c_uint32),
        ("feature_stride", c.c_uint32),
        ("features", c.c_void_p),
        ("feature_count", c.c_uint64),
        ("hardware", c.c_void_p),
        ("hardware_count", c.c_uint64),
    ]


class File(c.Structure):
    _fields_ = [("name", Str), ("bytes", c.c_void_p), ("byte_count", c.c_uint64), ("withheld", Str)]


class Config(c.Structure):
    _fields_ = [
        ("size", c.c_uint32),
        ("threads", c.c_uint32),
        ("cache_bytes", c.c_uint64),
        ("plugins", c.POINTER(c.c_char_p)),
        ("plugin_count", c.c_uint64),
        ("search", c.c_uint32),
        ("flags", c.c_uint32),
        ("folders", c.POINTER(c.c_char_p)),
        ("folder_count", c.c_uint64),
        ("isolate", c.POINTER(c.c_char_p)),
        ("isolate_count", c.c_uint64),
    ]


PROGRESS = c.CFUNCTYPE(c.c_int32, c.c_void_p, c.c_double, Str)


DONE = c.CFUNCTYPE(None, c.c_void_p, c.c_int32)
RELEASE = c.CFUNCTYPE(None, c.c_void_p)


class Options(c.Structure):
    _fields_ = [
        ("size", c.c_uint32),
        ("flags", c.c_uint32),
        ("context", c.c_void_p),
        ("progress", PROGRESS),
        ("done", DONE),
    ]


class Preview(c.Structure):
    _fields_ = [
        ("size", c.c_uint32),
        ("flags", c.c_uint32),
        ("node", Str),
        ("port", Str),
        ("origin", Vec3),
        ("low", Vec3),
        ("high", Vec3),
        ("positions", c.c_void_p),
        ("normals", c.c_void_p),
        ("vertex_parts", c.c_void_p),
        ("vertex_count", c.c_uint64),
        ("triangles", c.c_void_p),
        ("triangle_count", c.c_uint64),
        ("lines", c.c_void_p),
        ("line_count", c.c_uint64),
        ("points", c.c_void_p),
        ("point_count", c.c_uint64),
        ("parts", c.c_void_p),
        ("part_count", c.c_uint64),
    ]


class Diagnostic(c.Structure):
    _fields_ = [
        ("size", c.c_uint32),
        ("severity", c.c_uint32),
        ("code", Str),
        ("message", Str),
        ("hint", Str),
        ("node", Str),
        ("port", Str),
        ("item", c.c_uint64),
    ]


class NodeReport(c.Structure):
    _fields_ = [
        ("size", c.c_uint32),
        ("flags", c.c_uint32),
        ("happened", Str),
        ("node", Str),
        ("type_name", Str),
        ("nanoseconds", c.c_uint64),
        ("bytes", c.c_uint64),
    ]


def _library() -> c.CDLL:
    """TENON_LIBRARY, else the library beside this file, else the one that the system finds."""
    name = {"win32": "tenon.dll", "darwin": "libtenon.dylib"}.get(sys.platform, "libtenon.so")
    beside = Path(__file__).with_name(name)
    path = os.environ.get("TENON_LIBRARY") or (str(beside) if beside.exists() else name)
    try:
        return c.CDLL(path)
    except OSError as error:
        raise ImportError(f"libtenon is not there ({error}); set TENON_LIBRARY to its path") from error


LIB = _library()
HANDLE = c.c_void_p
OUT = c.POINTER(c.c_void_p)


def _declare() -> None:
    failing = {
        "tenon_engine_new": [c.POINTER(Config), OUT],
        "tenon_engine_describe": [HANDLE, c.c_char_p, OUT],
        "tenon_graph_load": [HANDLE, c.c_char_p, c.c_uint64, c.c_char_p, OUT],
        "tenon_graph_save": [HANDLE, OUT],
        "tenon_graph_set": [HANDLE, c.c_char_p, c.c_char_p],
        "tenon_graph_add_node": [HANDLE, c.c_char_p, c.c_char_p],
        "tenon_graph_remove_node": [HANDLE, c.c_char_p],
        "tenon_graph_connect": [HANDLE, c.c_char_p, c.c_char_p, c.c_char_p],
        "tenon_graph_disconnect": [HANDLE, c.c_char_p, c.c_char_p, c.c_char_p],
        "tenon_graph_interface": [HANDLE, c.c_uint32, OUT],
        "tenon_graph_give": [HANDLE, c.c_char_p, c.POINTER(Tree)],
        "tenon_graph_share": [HANDLE, c.c_char_p, c.POINTER(Tree), RELEASE, c.c_void_p],
        "tenon_graph_start": [HANDLE, c.POINTER(c.c_char_p), c.c_uint64, c.POINTER(Options), OUT],
        "tenon_job_wait": [HANDLE, c.c_uint64, OUT],
        "tenon_sweep_new": [HANDLE, OUT],
        "tenon_sweep_row": [HANDLE, c.c_char_p, c.c_char_p, c.c_char_p, c.POINTER(Options), OUT],
        "tenon_result_preview": [HANDLE, c.c_char_p, c.POINTER(Preview)],
        "tenon_graph_evaluate": [HANDLE, c.POINTER(c.c_char_p), c.c_uint64, c.POINTER(Options), OUT],
        "tenon_result_output": [HANDLE, c.c_char_p, c.POINTER(Tree)],
        "tenon_result_json": [HANDLE, c.c_char_p, OUT],
        "tenon_result_diagnostic": [HANDLE, c.c_uint64, c.POINTER(Diagnostic)],
        "tenon_result_node": [HANDLE, c.c_uint64, c.POINTER(NodeReport)],
    }
    for name, arguments in failing.items():
        function = getattr(LIB, name)
        function.argtypes, function.restype = arguments, HANDLE
    for name in ("engine", "graph", "job", "result", "sweep", "text", "error"):
        function = getattr(LIB, f"tenon_{name}_free")
        function.argtypes, function.restype = [HANDLE], None
    others = {
        "tenon_graph_cancel": None,
        "tenon_job_cancel": None,
        "tenon_job_progress": c.c_double,
        "tenon_error_status": c.c_int32,
        "tenon_error_message": Str,
        "tenon_error_node": Str,
        "tenon_text_get": Str,
        "tenon_result_status": c.c_int32,
        "tenon_result_diagnostic_count": c.c_uint64,
        "tenon_result_node_count": c.c_uint64,
    }
    for name, result in others.items():
        function = getattr(LIB, name)
        function.argtypes, function.restype = [HANDLE], result
    LIB.tenon_version.restype = c.c_uint32
    LIB.tenon_handle_count.restype = c.c_uint64


_declare()
