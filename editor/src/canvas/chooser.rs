//! A field with a list below it: letters narrow the list, arrows go through it, Enter takes what is chosen.

use eframe::egui::{Area, Frame, Id, Key, Order, Pos2, Rect, Response, RichText, ScrollArea, TextEdit, Ui, Vec2, vec2};

/// Room that a full list takes.
const ROOM: Vec2 = vec2(320.0, 350.0);

/// Height of the list.
const LIST: f32 = 240.0;

/// What came of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chosen {
    /// It stays open.
    Open,
    /// It was closed.
    Closed,
    /// The entry of this number.
    Entry(usize),
}

/// The field and where in the list one is.
#[derive(Default)]
pub struct Chooser {
    /// What was typed.
    pub typed: String,
    chosen: usize,
    /// How far the list is scrolled.
    scrolled: f32,
    begun: bool,
}

/// What is to be chosen from.
pub trait Entries {
    /// How many entries there are for what was typed.
    fn count(&self) -> usize;
    /// Draws an entry; gives what is clicked to take it.
    fn row(&self, ui: &mut Ui, entry: usize, chosen: bool) -> Response;
    /// More about an entry.
    fn about(&self, entry: usize) -> Option<&str>;
}

impl Chooser {
    /// Shows it at a place on screen; `hint` stands in the empty field. O(rows seen).
    pub fn show(&mut self, ui: &Ui, area: Rect, at: Pos2, hint: &str, entries: &impl Entries) -> Chosen {
        let mut found = Chosen::Open;
        let count = entries.count();
        // Where there is room for a full list, so that it does not jump while it grows and shrinks.
        let at = at.min(area.max - ROOM).max(area.min);
        let popup = Area::new(Id::new("chooser")).order(Order::Foreground).fixed_pos(at).constrain_to(area);
        let shown = popup.show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_width(300.0);
                let field = ui.add_sized(vec2(300.0, 22.0), TextEdit::singleline(&mut self.typed).hint_text(hint));
                if !self.begun {
                    field.request_focus();
                }
                if field.changed() {
                    self.chosen = 0;
                }
                let keys = [Key::ArrowDown, Key::ArrowUp, Key::Enter, Key::Escape];
                let [down, up, enter, escape] = ui.input(|i| keys.map(|key| i.key_pressed(key)));
                self.chosen = (self.chosen + usize::from(down)).saturating_sub(usize::from(up));
                self.chosen = self.chosen.min(count.saturating_sub(1));
                if count == 0 {
                    ui.label("nothing has that name");
                }
                let (height, gap) = (ui.spacing().interact_size.y, ui.spacing().item_spacing.y);
                let mut list = ScrollArea::vertical().max_height(LIST);
                if field.changed() || !self.begun {
                    list = list.vertical_scroll_offset(0.0);
                } else if down || up {
                    let top = self.chosen as f32 * (height + gap);
                    let offset = self.scrolled.clamp((top + height - LIST).max(0.0), top.max(0.0));
                    list = list.vertical_scroll_offset(offset);
                }
                let shown = list.show_rows(ui, height, count, |ui, rows| {
                    ui.set_width(ui.available_width());
                    for i in rows {
                        if entries.row(ui, i, i == self.chosen).clicked() {
                            found = Chosen::Entry(i);
                        }
                    }
                });
                self.scrolled = shown.state.offset.y;
                if let Some(about) = entries.about(self.chosen).filter(|_| count > 0) {
                    ui.separator();
                    ui.label(RichText::new(about).small());
                }
                if enter && count > 0 {
                    found = Chosen::Entry(self.chosen);
                }
                if escape {
                    found = Chosen::Closed;
                }
            });
        });
        if self.begun && shown.response.clicked_elsewhere() && found == Chosen::Open {
            found = Chosen::Closed;
        }
        self.begun = true;
        found
    }
}
