//! A real window with shell-256 on a screen of its own: how soon it is there, what it takes while nobody touches it. Its
//! viewport is drawn by Mesa's software adapter.

use crate::{folder, logic::resident, print, shell};
use std::io::Read as _;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tenon_editor::app::positions::VARIABLE;

/// A process that ends with this.
struct Ends(Child);

impl Drop for Ends {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A screen of its own, and its name.
fn screen() -> Option<(Ends, String)> {
    let mut xvfb = Command::new("Xvfb");
    xvfb.args(["-displayfd", "1", "-screen", "0", "1600x1000x24", "-nolisten", "tcp"]);
    let mut xvfb = Ends(xvfb.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().ok()?);
    let (mut number, mut byte) = (String::new(), [0]);
    let out = xvfb.0.stdout.as_mut()?;
    while out.read(&mut byte).ok()? == 1 && byte[0] != b'\n' {
        number.push(char::from(byte[0]));
    }
    Some((xvfb, format!(":{number}")))
}

/// Processor time of a process so far, in ticks of a hundredth of a second.
fn ticks(process: u32) -> Option<f64> {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    Some(fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?)
}

/// Waits until the window tells of something by that name; when that was.
fn told(positions: &Path, name: &str) -> Option<Instant> {
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(120) {
        let text = std::fs::read_to_string(positions).unwrap_or_default();
        if text.contains(name) {
            return Some(Instant::now());
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    None
}

fn measure(home: &Path) -> Option<()> {
    let (_xvfb, display) = screen()?;
    let positions = home.join("positions.json");
    let graph = shell();
    // A user who has seen all that is told once.
    let told_before = r#"{ "toured": true, "told_of_software": true }"#;
    std::fs::create_dir_all(home.join("tenon")).ok()?;
    std::fs::write(home.join("tenon/preferences.json"), told_before).ok()?;
    let mut window = Command::new(env!("CARGO_BIN_EXE_tenon-editor"));
    window.arg(&graph).env_remove("WAYLAND_DISPLAY").env_remove("DBUS_SESSION_BUS_ADDRESS");
    window.env("DISPLAY", display).env("XDG_STATE_HOME", home).env("XDG_RUNTIME_DIR", home);
    window.env("WGPU_BACKEND", "vulkan").env(VARIABLE, &positions);
    let start = Instant::now();
    let window = Ends(window.stderr(Stdio::null()).spawn().ok()?);
    let first = told(&positions, "\"canvas\"")?;
    print("start to first frame, real window", 256, (first - start).as_secs_f64() * 1e3, "ms", Some(1000.0));
    told(&positions, "\"done in")?;
    std::thread::sleep(Duration::from_secs(3));
    if let Some(mb) = resident(&window.0.id().to_string()) {
        print("memory, real window with a software adapter", 256, mb, "MB", Some(300.0));
    }
    let before = ticks(window.0.id())?;
    std::thread::sleep(Duration::from_secs(10));
    let used = ticks(window.0.id())? - before;
    print("idle for 10 s, real window", 256, used / 10.0, "% CPU", Some(1.0));
    Some(())
}

pub fn figures() {
    if measure(&folder()).is_none() {
        eprintln!("no real window here: it wants Xvfb and a Vulkan adapter");
    }
}
