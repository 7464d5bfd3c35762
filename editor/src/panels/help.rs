//! The keys, by what one wants to do (F1).

use eframe::egui::{Grid, Key, ScrollArea, Ui, Window};

const KEYS: &[(&str, &str)] = &[
    ("double-click on the canvas, F4, Ctrl+Space", "find a node and add it; 0<5<10 or 5 is a slider, \"words a text"),
    ("F3", "find a node of the graph by its name, type, text or remark, and go there"),
    ("drag from a port", "draw a wire; let go on the canvas: find a node for it"),
    ("Ctrl and drag from an input", "take the last wire off it"),
    ("Ctrl+Shift and drag from a port", "lead all its wires to another port"),
    ("click, Shift and click, drag a frame", "select nodes; with Alt: draw a line around them"),
    ("double-click a wire", "put a point into it; right-click: remove it"),
    ("drag the title of a group", "move its nodes; double-click: name it; right-click: its colour"),
    ("double-click an instance, or Enter", "enter its cluster; Alt and the left arrow: leave it"),
    ("Ctrl+Q, Ctrl+E, Ctrl+Shift+E", "show or hide, enable or disable, freeze or thaw what is selected"),
    ("drag a node, arrow keys", "move what is selected; with Alt: copy it; arrows with Shift: by 1 instead of 10"),
    ("Ctrl and the left or right arrow", "select all that it is made of, or all that follows from it"),
    ("drag a value", "slide it; double-click: type it, or open its table; with Ctrl: type it as the file has it"),
    ("double-click a node's title, F2", "rename it, or the group that is selected"),
    ("wheel over a text panel", "turn its lines"),
    ("right-click the canvas", "add a node, write a note"),
    ("right-click a port", "make it one of the graph, put a slider before it …"),
    ("click or drag on the small map", "go there"),
    ("right-click a node", "enable, freeze, bypass, disable, show, group …"),
    ("right or middle drag, Space and drag", "move the canvas"),
    ("wheel", "zoom to the pointer, on the canvas and in the viewport"),
    ("Ctrl+Z, Ctrl+Y or Ctrl+Shift+Z", "undo, redo"),
    ("Ctrl+C, Ctrl+X, Ctrl+V, Ctrl+D", "copy, cut, paste at the pointer, duplicate"),
    ("Delete, Backspace", "delete what is selected"),
    ("Ctrl+A, Ctrl+G, Ctrl+Shift+G", "select all, group, ungroup"),
    ("Ctrl+K, Ctrl+Shift+K", "make a cluster of what is selected, take clusters apart"),
    ("Ctrl+N, Ctrl+O, Ctrl+S, Ctrl+Shift+S", "new, open, save, save as"),
    ("Esc", "give up what is dragged or typed, close what is open; else stop the evaluation; else select nothing"),
    ("F5", "evaluate again"),
    ("Alt+1, 2, 3, 4", "problems, profile, data, pieces below the canvas"),
    ("Alt+5, Alt+6", "space, boards"),
    ("Space, comma, full stop over the boards", "play or pause; one move back; one move on"),
    ("drag in the viewport", "turn; with Shift or the middle button: move"),
    ("drag a point in the viewport", "move it in a plane; with X, Y or Z held along that axis, with Shift on a grid"),
    ("drag, double-click, right-click in the drawing of a table", "move a point, put one in, take one away"),
    ("click a panel", "select it and its node"),
    ("drag or type the ends of the legend", "other colours; double-click its bar: all figures again"),
    ("F over the canvas or the viewport", "show all, or what is selected; Home: all of the canvas"),
    (
        "7, 1, 3 over the viewport",
        "from above, in front, on the right; with Ctrl: from the other side; 0: from a corner",
    ),
    ("5 over the viewport", "perspective or parallel lines"),
];

/// Shows the keys in a window while `open`.
pub fn help(ui: &Ui, open: &mut bool) {
    *open &= !ui.input(|i| i.key_pressed(Key::Escape));
    Window::new("Keys").open(open).default_width(560.0).show(ui.ctx(), |ui| {
        ScrollArea::vertical().show(ui, |ui| {
            Grid::new("keys").striped(true).num_columns(2).show(ui, |ui| {
                for (keys, what) in KEYS {
                    ui.strong(*keys);
                    ui.label(*what);
                    ui.end_row();
                }
            });
        });
    });
}
