"""A real window of tenon-editor on a screen of its own (Xvfb), driven by xdotool's mouse and keyboard. Where to point is read
from the file that the window writes for TENON_EDITOR_POSITIONS, and every step waits for what it should bring about."""

import glob
import json
import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

VARIABLE = "TENON_EDITOR_POSITIONS"


class Screen:
    """An X server of its own."""

    def __init__(self, width=1600, height=1000):
        told, tell = os.pipe()
        size = f"{width}x{height}x24"
        # It stays as it is when the last window is gone: who comes while it begins anew is refused.
        command = ["Xvfb", "-displayfd", str(tell), "-screen", "0", size, "-nolisten", "tcp", "-noreset"]
        self.process = subprocess.Popen(command, pass_fds=[tell], stderr=subprocess.DEVNULL)
        os.close(tell)
        with os.fdopen(told) as number:
            self.display = f":{int(number.readline())}"

    def close(self):
        self.process.terminate()
        self.process.wait()


class Window:
    """The program and its only window. `home` is the user's folder, where it keeps its state."""

    def __init__(self, program, screen, home, graph=None):
        self.positions = Path(home) / "positions.json"
        self.positions.unlink(missing_ok=True)
        runtime = Path(home) / "runtime"
        runtime.mkdir(parents=True, exist_ok=True)
        runtime.chmod(0o700)
        drivers = glob.glob("/usr/share/vulkan/icd.d/lvp_icd.*")
        assert drivers, "the software adapter of Mesa is not installed"
        self.environment = {
            "PATH": os.environ["PATH"],
            "HOME": str(home),
            "DISPLAY": screen.display,
            "XDG_RUNTIME_DIR": str(runtime),
            "XDG_STATE_HOME": str(Path(home) / "state"),
            "VK_ICD_FILENAMES": drivers[0],
            "WGPU_BACKEND": "vulkan",
            VARIABLE: str(self.positions),
        }
        command = [str(program)] + ([str(graph)] if graph else [])
        self.log = open(Path(home) / "window.log", "a")
        self.process = subprocess.Popen(command, env=self.environment, stderr=self.log, cwd=home)
        self.until(lambda: self.has("canvas"), "the window shows its canvas", 60)
        self.id = self.xdotool("search", "--sync", "--onlyvisible", "--pid", str(self.process.pid)).split()[-1]
        # There is no window manager that would do it.
        self.xdotool("windowfocus", "--sync", self.id)
        place = dict(line.split("=") for line in self.xdotool("getwindowgeometry", "--shell", self.id).splitlines())
        self.left, self.top = int(place["X"]), int(place["Y"])
        self.clicked, self.missed = 0.0, 0

    def xdotool(self, *arguments):
        done = subprocess.run(["xdotool", *arguments], env=self.environment, capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, f"xdotool {arguments}: {done.stderr}"
        return done.stdout

    # What is seen.

    def seen(self):
        """What the window tells: number of the frame, place of the pointer, whether a button is held, widgets."""
        code = self.process.poll()
        assert code is None, f"the window has ended with {code}: {Path(self.log.name).read_text()[-2000:]}"
        try:
            return json.loads(self.positions.read_text())
        except FileNotFoundError:
            return {"frame": 0, "pointer": None, "down": False, "focus": None, "widgets": []}

    def widgets(self, name):
        return [w for w in self.seen()["widgets"] if w["name"] == name]

    def has(self, name):
        return bool(self.widgets(name))

    def names(self, start):
        """Names that begin so, without that beginning."""
        return {w["name"].removeprefix(start) for w in self.seen()["widgets"] if w["name"].startswith(start)}

    def rect(self, name):
        return self.until(lambda: self.widgets(name), f"{name} is seen")[0]["at"]

    def middle(self, name):
        x0, y0, x1, y1 = self.rect(name)
        return (x0 + x1) / 2, (y0 + y1) / 2

    def comes(self, so, seconds):
        """Waits so long until something is so, and gives it, or what is false of it."""
        end = time.monotonic() + seconds
        while True:
            it = so()
            if it or time.monotonic() >= end:
                return it
            time.sleep(0.01)

    def until(self, so, what, seconds=60):
        """Waits until something is so, and gives it."""
        it = self.comes(so, seconds)
        assert it, f"not within {seconds} s: {what}"
        return it

    def frame(self):
        return self.seen()["frame"]

    def after(self, act):
        """Does something and waits for the frames that show it: until one was drawn and no other follows at once."""
        before = last = self.frame()
        act()
        end, since = time.monotonic() + 1.0, time.monotonic()
        while time.monotonic() < end and (last == before or time.monotonic() - since < 0.06):
            time.sleep(0.005)
            now = self.frame()
            if now != last:
                last, since = now, time.monotonic()

    def calm(self, seconds=120):
        """Waits until the window draws nothing more."""
        end, last, since = time.monotonic() + seconds, None, time.monotonic()
        while time.monotonic() - since < 0.35:
            now = self.frame()
            if now != last:
                last, since = now, time.monotonic()
            assert time.monotonic() < end, "the window never comes to rest"
            time.sleep(0.02)

    def settled(self, seconds=300):
        """Waits until the evaluation is done, as the status line says."""
        self.calm(seconds)
        self.until(lambda: any(n["name"].startswith("done in") for n in self.seen()["widgets"]), "evaluated", seconds)

    # What a hand does.

    def move(self, at):
        x, y = round(at[0]), round(at[1])
        self.xdotool("mousemove", str(self.left + x), str(self.top + y))

        def there():
            pointer = self.seen()["pointer"]
            return pointer and abs(pointer[0] - x) < 2 and abs(pointer[1] - y) < 2

        self.until(there, f"the pointer is at {x}, {y}")

    def press(self, button=1):
        self.after(lambda: self.xdotool("mousedown", str(button)))
        self.until(lambda: self.seen()["down"], "a button is held")

    def let_go(self, button=1):
        self.after(lambda: self.xdotool("mouseup", str(button)))
        self.until(lambda: not self.seen()["down"], "no button is held")

    def click(self, at, button=1):
        self.move(at)
        self.press(button)
        self.let_go(button)
        self.clicked = time.monotonic()

    def double_click(self, at, held=None):
        """Clicks twice, which is to open a field, apart from clicks before, which would make it three. A key that is held
        is let go once the field has the keyboard. A click that a busy machine swallowed is done again, as people do, but not
        often: most clicks must count at once."""
        self.move(at)
        if held:
            self.after(lambda: self.xdotool("keydown", held))
        try:
            for patience in (3, 6, 20):
                time.sleep(max(0.0, self.clicked + 0.6 - time.monotonic()))
                self.after(lambda: self.xdotool("click", "--repeat", "2", "--delay", "5", "1"))
                self.clicked = time.monotonic()
                if self.comes(lambda: self.typed() is not None, patience):
                    return
                self.missed += 1
                assert self.missed <= 2, "clicks are lost again and again"
            raise AssertionError(f"two clicks with {held or 'no key'} open no field")
        finally:
            if held:
                self.xdotool("keyup", held)

    def drag(self, start, end):
        self.move(start)
        self.press()
        # A few pixels make it a drag; then straight to the end.
        (x0, y0), (x1, y1) = start, end
        length = max(1.0, ((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5)
        self.move((x0 + (x1 - x0) / length * 12, y0 + (y1 - y0) / length * 12))
        self.move(end)
        self.let_go()

    def wheel(self, at, notches):
        """Turns the wheel at a place, away from oneself if positive."""
        self.move(at)
        button = "4" if notches > 0 else "5"
        self.xdotool("click", "--repeat", str(abs(notches)), "--delay", "20", button)
        self.calm()

    def key(self, name):
        self.after(lambda: self.xdotool("key", name))

    def typed(self):
        """What stands in the field that has the keyboard; none if no field has it."""
        focus = self.seen()["focus"]
        return (focus["value"] or "") if focus and "TextInput" in focus["role"] else None

    def type(self, text):
        """Waits for a field that has the keyboard and types over all that stands there, until it stands there."""
        self.until(lambda: self.typed() is not None, f"a field for {text}")
        self.key("ctrl+a")
        if text:
            self.xdotool("type", "--delay", "1", "--", text)
        else:
            self.key("BackSpace")
        self.until(lambda: self.typed() == text, f"{text} stands in the field")

    # How it ends.

    def kill(self):
        """Ends it as a crash would."""
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()
        self.log.close()

    def processor_time(self):
        """Seconds of processor time so far."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def picture(self, path):
        """A picture for people, where ImageMagick is installed."""
        if shutil.which("import"):
            subprocess.run(["import", "-window", "root", str(path)], env=self.environment, check=False)
