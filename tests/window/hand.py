"""Builds a graph in a window as a person does: finds nodes, names them, types values, draws wires. What is to be built is
read from a graph's file, as a person would read it from a drawing."""

import json

# Nodes stand in columns and rows of this size, canvas points; wide and high enough for unfolded ones.
CELL = (250, 300)
WIDTH = 190


class Hand:
    def __init__(self, window):
        self.w = window
        self.zoom = 1.0

    def begin(self):
        """Puts the examples away that newcomers see, and makes room by going further away."""
        w = self.w
        if w.has("shell-256"):
            w.key("Escape")
            w.until(lambda: not w.has("shell-256"), "the examples are gone")
        x0, y0, x1, y1 = w.rect("canvas")
        w.wheel(((x0 + x1) / 2, (y0 + y1) / 2), -2)
        self.canvas = (x0, y0, x1, y1)

    def place(self, index):
        """The upper left corner of a node's cell, on screen."""
        x0, y0, x1, _ = self.canvas
        step = (CELL[0] * self.zoom, CELL[1] * self.zoom)
        columns = max(1, int((x1 - x0 - 20) / step[0]))
        return x0 + 20 + (index % columns) * step[0], y0 + 20 + (index // columns) * step[1]

    def add(self, index, id, type_name):
        """Adds a node by the finder and gives it its name."""
        w = self.w
        before = w.names("node ")
        w.double_click(self.place(index))
        w.type(type_name)
        w.key("Return")
        new = w.until(lambda: w.names("node ") - before, f"a node for {id}").pop()
        x0, _, x1, _ = w.rect(f"node {new}")
        if index == 0:
            self.zoom = (x1 - x0) / WIDTH
            assert 0.46 < self.zoom < 0.62, f"names and room want another scale than {self.zoom}"
        if new != id:
            w.double_click(w.middle(f"node {new}"))
            w.type(id)
            w.key("Return")
            w.until(lambda: w.has(f"node {id}"), f"node {new} is called {id}")

    def show_input(self, id, port):
        """Brings a node above the others, and unfolds its inputs if this one is not seen."""
        w = self.w
        w.click(w.middle(f"node {id}"))
        if not w.has(f"input {id}.{port}"):
            w.click(w.middle(f"inputs of {id}"))
            w.until(lambda: w.has(f"input {id}.{port}"), f"{id} shows {port}")
            return True
        return False

    def fold(self, id):
        w = self.w
        if w.has(f"inputs of {id}"):
            w.click(w.middle(f"inputs of {id}"))

    def set(self, id, port, value):
        """Chooses a value from a list where it is offered, and types it otherwise."""
        w = self.w
        unfolded = self.show_input(id, port)
        at = w.middle(f"input {id}.{port}")
        offered = []
        if isinstance(value, str):
            before = [there["at"] for there in w.widgets(value)]
            w.click(at)
            w.calm()
            offered = [there["at"] for there in w.widgets(value) if there["at"] not in before]
        if offered:
            x0, y0, x1, y1 = offered[0]
            w.click(((x0 + x1) / 2, (y0 + y1) / 2))
            w.calm()
        else:
            w.double_click(at, held="ctrl")
            w.type(value if isinstance(value, str) else json.dumps(value))
            w.key("Return")
            w.until(lambda: w.typed() is None, "the field is closed")
        if unfolded:
            self.fold(id)

    def wire(self, source, id, port):
        """Draws a wire from an output's dot to an input's."""
        w = self.w
        unfolded = self.show_input(id, port)
        _, y0, x1, y1 = w.rect(f"output {source}")
        x0, v0, _, v1 = w.rect(f"input {id}.{port}")
        w.drag((x1, (y0 + y1) / 2), (x0, (v0 + v1) / 2))
        if unfolded:
            self.fold(id)

    def build(self, graph):
        nodes = graph["nodes"]
        # Those that are to be unfolded stand above, where there is room below them.
        order = sorted(nodes, key=lambda id: (not nodes[id].get("params"), id))
        for index, id in enumerate(order):
            self.add(index, id, nodes[id]["type"])
        for id, node in nodes.items():
            for port, value in node.get("params", {}).items():
                self.set(id, port, value)
        for id, node in nodes.items():
            for port, wires in node.get("inputs", {}).items():
                for source in wires["from"]:
                    self.wire(source, id, port)

    def save_as(self, path):
        """Saves by the keyboard alone."""
        w = self.w
        w.key("ctrl+s")
        w.until(lambda: w.has("Save the graph"), "a name is asked for")
        w.type(str(path))
        w.key("Return")
        w.until(path.exists, f"{path} is written")
