//! The pictures of the book, drawn by the program: `cargo xtask screenshots` runs this.

use crate::common::{Window, root};
use eframe::egui::vec2;

#[test]
#[ignore = "writes the pictures of the book"]
fn pictures_of_the_book() {
    let save = |w: &mut Window, name: &str| {
        let picture = w.picture(name);
        picture.save(root().join(format!("docs/{name}.png"))).unwrap();
    };
    let mut w = Window::sized(Some(&root().join("graphs/shell-256")), vec2(1440.0, 860.0));
    w.app().model.selection = ["thicken".to_owned()].into();
    w.app().canvas.show_all();
    w.steps(3);
    w.app().model.selection.clear();
    w.steps(2);
    save(&mut w, "editor");
}
