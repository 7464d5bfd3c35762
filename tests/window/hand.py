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
        """Folds a node's inputs again, and sees that they are."""
        w, row = self.w, f"inputs of {id}"
        # Clicks with Ctrl have taken it out of what is selected, and so from above the others.
        w.click(w.middle(f"node {id}"))
        was = w.rect(row)
        w.click(w.middle(row))
        # Where all inputs have values of their own, nothing is left to be unfolded.
        w.until(lambda: [there["at"] for there in w.widgets(row)] != [was], f"{id} is folded")

    def steady(self, name, before):
        """Where the first widget of a name stands that was not there before, once it moves no more; none if there is none."""
        w = self.w
        while True:
            w.calm()
            new = [there["at"] for there in w.widgets(name) if there["at"] not in before]
            w.calm()
            if not new or new[0] in [there["at"] for there in w.widgets(name)]:
                return new[0] if new else None

    def set(self, id, port, value):
        """Chooses a value from a list where it is offered, and types it otherwise."""
        w = self.w
        unfolded = self.show_input(id, port)
        at = w.middle(f"input {id}.{port}")
        offered = None
        if isinstance(value, str):
            before = [there["at"] for there in w.widgets(value)]
            w.click(at)
            offered = self.steady(value, before)
        if offered:
            x0, y0, x1, y1 = offered
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

    def mend(self, graph, saved):
        """Does again what a saved graph shows to have missed its aim, as people do who look at what they have done. How many
        things that were."""
        count = 0
        for id, node in graph["nodes"].items():
            there = saved["nodes"].get(id, {})
            for port in there.get("params", {}).keys() - node.get("params", {}).keys():
                # Nothing typed is the default again.
                self.set(id, port, "")
                count += 1
            for port, value in node.get("params", {}).items():
                if there.get("params", {}).get(port, value) != value:
                    self.set(id, port, value)
                    count += 1
            for port, wires in node.get("inputs", {}).items():
                drawn = there.get("inputs", {}).get(port, {"from": []})["from"]
                for source in wires["from"]:
                    if source not in drawn:
                        self.wire(source, id, port)
                        count += 1
        return count

    def save_as(self, path):
        """Saves by the keyboard alone."""
        w = self.w
        w.key("ctrl+s")
        w.until(lambda: w.has("Save the graph"), "a name is asked for")
        w.type(str(path))
        w.key("Return")
        w.until(path.exists, f"{path} is written")
