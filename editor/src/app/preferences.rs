//! What the window remembers of its user besides graphs: theme, scale, where plugins run, and what was seen once.

use super::App;
use eframe::egui::{self, ThemePreference, Ui};
use serde_json::{Value, json};
use std::path::PathBuf;

/// The user's preferences.
#[derive(Clone, Debug, PartialEq)]
pub struct Preferences {
    /// Light, dark, or as the desktop has it.
    pub theme: ThemePreference,
    /// Scale of everything in the window.
    pub scale: f32,
    /// The tour or the examples were seen or put away.
    pub toured: bool,
    /// That the processor draws was told.
    pub told_of_software: bool,
    /// Plugins run in processes of their own, so that one that crashes leaves the window.
    pub plugins_apart: bool,
    /// Files are asked for by the desktop's own windows, where there are such.
    pub desktop_dialogs: bool,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            theme: ThemePreference::System,
            scale: 1.0,
            toured: false,
            told_of_software: false,
            plugins_apart: cfg!(target_os = "linux"),
            desktop_dialogs: true,
        }
    }
}

/// Smallest and largest scale.
const SCALES: std::ops::RangeInclusive<f32> = 0.6..=3.0;

impl Preferences {
    /// Reads them; what is not there or makes no sense is as at first.
    #[must_use]
    pub fn read(text: &str) -> Self {
        let file: Value = serde_json::from_str(text).unwrap_or_default();
        let theme = match file.get("theme").and_then(Value::as_str) {
            Some("dark") => ThemePreference::Dark,
            Some("light") => ThemePreference::Light,
            _ => ThemePreference::System,
        };
        let scale = file.get("scale").and_then(Value::as_f64).map_or(1.0, |s| s as f32);
        let scale = if scale.is_finite() { scale.clamp(*SCALES.start(), *SCALES.end()) } else { 1.0 };
        let first = Self::default();
        let is = |key: &str, otherwise: bool| file.get(key).and_then(Value::as_bool).unwrap_or(otherwise);
        Self {
            theme,
            scale,
            toured: is("toured", first.toured),
            told_of_software: is("told_of_software", first.told_of_software),
            plugins_apart: is("plugins_apart", first.plugins_apart),
            desktop_dialogs: is("desktop_dialogs", first.desktop_dialogs),
        }
    }

    /// Their text.
    #[must_use]
    pub fn text(&self) -> String {
        let theme = match self.theme {
            ThemePreference::Dark => "dark",
            ThemePreference::Light => "light",
            ThemePreference::System => "system",
        };
        let scale = f64::from((self.scale * 100.0).round()) / 100.0;
        let all = json!({
            "theme": theme,
            "scale": scale,
            "toured": self.toured,
            "told_of_software": self.told_of_software,
            "plugins_apart": self.plugins_apart,
            "desktop_dialogs": self.desktop_dialogs,
        });
        format!("{all:#}\n")
    }
}

impl App {
    fn preferences_path(&self) -> Option<PathBuf> {
        Some(self.model.state.as_ref()?.join("preferences.json"))
    }

    /// Reads the user's preferences and takes them.
    pub(super) fn take_preferences(&mut self, ctx: &egui::Context) {
        let text = self.preferences_path().and_then(|p| std::fs::read_to_string(p).ok()).unwrap_or_default();
        self.preferences = Preferences::read(&text);
        ctx.set_theme(self.preferences.theme);
        ctx.set_zoom_factor(self.preferences.scale);
        self.model.run_plugins_apart(self.preferences.plugins_apart);
    }

    /// Keeps them.
    pub(super) fn keep_preferences(&mut self) {
        let Some(path) = self.preferences_path() else { return };
        if let Err(e) = tenon_nodes::host::output::write_quickly(&path, self.preferences.text().as_bytes()) {
            self.said = Some(format!("the preferences were not kept: {e}"));
        }
    }

    /// The menu of preferences.
    pub(super) fn preferences_menu(&mut self, ui: &mut Ui) {
        let before = self.preferences.clone();
        for (words, theme) in [
            ("As the desktop", ThemePreference::System),
            ("Light", ThemePreference::Light),
            ("Dark", ThemePreference::Dark),
        ] {
            ui.radio_value(&mut self.preferences.theme, theme, words);
        }
        ui.separator();
        for scale in [0.8, 1.0, 1.25, 1.5, 2.0] {
            ui.radio_value(&mut self.preferences.scale, scale, format!("{:.0} %", scale * 100.0));
        }
        ui.separator();
        if cfg!(target_os = "linux") {
            let words = "Plugins in processes of their own";
            let why = "A plugin that crashes then leaves the window, and its node says so";
            ui.checkbox(&mut self.preferences.plugins_apart, words).on_hover_text(why);
        }
        let why = match self.dialogs.are_there() {
            true => "Off: the window's own browser",
            false => "Here is no desktop that has any: the window's own browser is used",
        };
        let words = "File windows of the desktop";
        ui.add_enabled_ui(self.dialogs.are_there(), |ui| {
            let asks = ui.checkbox(&mut self.preferences.desktop_dialogs, words);
            asks.on_hover_text(why).on_disabled_hover_text(why);
        });
        if self.preferences.plugins_apart != before.plugins_apart {
            self.model.run_plugins_apart(self.preferences.plugins_apart);
            self.model.load_plugins(&[], &[]);
        }
        if self.preferences != before {
            ui.ctx().set_theme(self.preferences.theme);
            ui.ctx().set_zoom_factor(self.preferences.scale);
            self.keep_preferences();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn preferences_are_read_as_they_were_written_and_nonsense_is_left_out() {
        let mut p = Preferences { theme: ThemePreference::Dark, scale: 1.25, toured: true, ..Preferences::default() };
        (p.told_of_software, p.plugins_apart, p.desktop_dialogs) = (true, !p.plugins_apart, false);
        assert_eq!(Preferences::read(&p.text()), p);
        for nonsense in ["", "[]", "{\"scale\": \"large\"}", "{\"theme\": 3}"] {
            assert_eq!(Preferences::read(nonsense), Preferences::default());
        }
        assert_eq!(Preferences::read("{\"scale\": 1e9}").scale, 3.0);
    }
}
