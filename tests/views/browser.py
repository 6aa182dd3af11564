"""A page in a real browser: its width, its labels, its references, its pictures.

Chromium is spoken to through a pipe with its own protocol, so that nothing is installed for it
and the width of a phone is the width of a phone.
"""

from __future__ import annotations

import base64
import json
import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome")
WIDTHS = {1400: 1.0, 390: 2.0}
"""Width of a page [CSS px] and how many pixels of the picture one of them gets."""
SLICE = 3000
"""A long page is taken in pictures of at most so many CSS px height."""
SMALLEST = 7.0
"""Labels of a picture are not smaller than this [CSS px]."""

SETTLE = """(async () => {
  for (const fold of document.querySelectorAll("details")) fold.open = true;
  const frame = () => new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)));
  for (let top = 0; top < document.documentElement.scrollHeight; top += 600) {
    scrollTo({top, behavior: "instant"});
    await frame();
  }
  scrollTo({top: 0, behavior: "instant"});
  await frame();
})()"""

FLAGS = (
    "--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--hide-scrollbars",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--disable-extensions", "--mute-audio", "--remote-debugging-pipe",
)  # fmt: skip

CHECK = r"""
(() => {
  const page = document.documentElement, width = page.clientWidth;
  const name = (e) => e.tagName.toLowerCase() + (e.id ? "#" + e.id : "") +
    (e.classList.length ? "." + e.classList[0] : "");
  const held = (e) => {
    for (let up = e.parentElement; up && up !== document.body; up = up.parentElement) {
      const s = getComputedStyle(up);
      if (s.overflowX !== "visible" || s.position === "fixed") return true;
    }
    return false;
  };
  const said = (t) => t.textContent.replace(/\s+/g, " ").trim().slice(0, 30);
  // of a label made of pieces, its pieces: the white space between them takes no room
  const extent = (t) => {
    const rects = [...t.querySelectorAll("tspan")].filter((s) => s.textContent.trim())
      .map((s) => s.getBoundingClientRect());
    if (!rects.length) return t.getBoundingClientRect();
    const low = (side) => Math.min(...rects.map((r) => r[side]));
    const high = (side) => Math.max(...rects.map((r) => r[side]));
    const left = low("left"), right = high("right"), top = low("top"), bottom = high("bottom");
    return {left, right, top, bottom, width: right - left, height: bottom - top};
  };
  const wide = [], broken = [], dead = [], small = [], cut = [], over = [], links = [];
  for (const e of document.body.querySelectorAll("*")) {
    const r = e.getBoundingClientRect();
    if (r.width && r.right > width + 1 && r.left < width && !e.closest("svg svg, svg *") &&
        getComputedStyle(e).position !== "fixed" && !held(e))
      wide.push(`${name(e)} to ${Math.round(r.right)}`);
  }
  for (const e of document.images)
    if (!e.complete || (e.naturalWidth === 0 && !/\.svg$/.test(e.src)))
      broken.push(e.getAttribute("src").slice(0, 80));
  for (const e of document.querySelectorAll("a[href]")) {
    const to = e.getAttribute("href");
    if (!to.startsWith("#")) links.push(to);
    else if (to.length > 1 && !document.getElementById(decodeURIComponent(to.slice(1))))
      dead.push(to);
  }
  for (const e of document.querySelectorAll("svg[viewBox]")) {
    const box = e.getBoundingClientRect();
    if (!box.width) continue;
    // level labels alone: the box of a turned one says little about its letters
    const texts = [...e.querySelectorAll("text")].filter((t) => {
      const m = t.getScreenCTM(), turn = Math.abs(m.b) / Math.hypot(m.a, m.b);
      return t.textContent.trim() && (turn < 0.02 || turn > 0.98);
    }).map((t) => [t, extent(t)]);
    const where = e.closest("figure") ? name(e.closest("figure")) : name(e);
    for (const [t, r] of texts) {
      const words = said(t);
      const m = t.getScreenCTM();
      const size = parseFloat(getComputedStyle(t).fontSize) * Math.hypot(m.c, m.d);
      if (size < SMALLEST) small.push(`${where} "${words}" ${size.toFixed(1)} px`);
      if (r.left < box.left - 1 || r.right > box.right + 1 || r.top < box.top - 1 ||
          r.bottom > box.bottom + 1) cut.push(`${where} "${words}"`);
    }
    for (let i = 0; i < texts.length; i++) for (let j = i + 1; j < texts.length; j++) {
      const [a, p] = texts[i], [b, q] = texts[j];
      const w = Math.min(p.right, q.right) - Math.max(p.left, q.left);
      const h = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
      const low = Math.min(p.height, q.height);
      if (w > 1 && h > 0.45 * low) over.push(`${where} "${said(a)}" on "${said(b)}"`);
    }
  }
  return {width, scroll: page.scrollWidth, height: page.scrollHeight, wide, broken, dead, small,
    cut, over, links};
})()
""".replace("SMALLEST", str(SMALLEST))


def find() -> str | None:
    """The browser of this machine, or None."""
    return next((path for path in map(shutil.which, NAMES) if path), None)


@dataclass
class Sight:
    """What one page shows at one width."""

    page: Path
    width: int
    height: int
    scroll: int
    seconds: float
    faults: dict[str, list[str]]
    pictures: list[Path] = field(default_factory=list)

    @property
    def sound(self) -> bool:
        """No fault of any kind."""
        return not any(self.faults.values())


class Browser:
    """One running browser with one page."""

    def __init__(self, read: int, write: int) -> None:
        self._read, self._write = read, write
        self._number = 0
        self._rest = b""
        self._events: list[dict[str, Any]] = []
        self._session: str | None = None
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        found = self.ask("Target.attachToTarget", targetId=target, flatten=True)
        self._session = found["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.ask(f"{domain}.enable")

    def ask(self, method: str, **parameters: Any) -> Any:
        """The answer to one request."""
        self._number += 1
        request = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            request["sessionId"] = self._session
        os.write(self._write, json.dumps(request).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") != self._number:
                self._events.append(answer)
            elif "error" in answer:
                raise RuntimeError(f"{method}: {answer['error']['message']}")
            else:
                return answer["result"]

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self._rest:
            got = os.read(self._read, 1 << 16)
            if not got:
                raise RuntimeError("the browser ended")
            self._rest += got
        one, _, self._rest = self._rest.partition(b"\0")
        return json.loads(one)  # type: ignore[no-any-return]

    def look(self, page: Path, width: int, folder: Path | None = None) -> Sight:
        """Open ``page`` at ``width``, check it, and take its pictures into ``folder``."""
        start = time.perf_counter()
        self._events.clear()
        scale = WIDTHS.get(width, 1.0)
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=900,
                 deviceScaleFactor=scale, mobile=width < 600)  # fmt: skip
        self.ask("Page.navigate", url=page.resolve().as_uri())
        self._wait("Page.loadEventFired")
        # two frames, so that scripts and fonts have had their turn
        self.value("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)))"
                    ".then(() => document.fonts.ready).then(() => 1)")  # fmt: skip
        self.settle()
        found = self.value(CHECK)
        faults = {
            "wide": found["wide"] or (["page"] if found["scroll"] > found["width"] else []),
            "broken": found["broken"],
            "dead": found["dead"] + [one for one in found["links"] if _dead(page, one)],
            "small": found["small"],
            "cut": found["cut"],
            "over": found["over"],
            "errors": list(_errors(self._events)),
        }
        sight = Sight(page, width, found["height"], found["scroll"], 0.0, faults)
        if folder is not None:
            sight.pictures = self._shoot(folder, page.stem, width, found["height"])
        sight.seconds = time.perf_counter() - start
        return sight

    def go(self, address: str, width: int = 1400, height: int = 900) -> None:
        """Open an address and wait until it is loaded."""
        self._events.clear()
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height,
                 deviceScaleFactor=1.0, mobile=width < 600)  # fmt: skip
        self.ask("Page.navigate", url=address)
        self._wait("Page.loadEventFired")

    def until(self, script: str, seconds: float = 60.0) -> float:
        """Wait until ``script`` is true; the seconds it took. A page's policy forbids predicates
        as texts, so it is asked again and again."""
        start = time.perf_counter()
        while not self.value(script):
            if time.perf_counter() - start > seconds:
                raise TimeoutError(f"{script} is not true after {seconds:g} s")
            time.sleep(0.03)
        return time.perf_counter() - start

    def press(self, key: str, times: int = 1) -> None:
        """Press a key of the keyboard: "Tab", "Enter", "ArrowRight", " " or a character."""
        code = {"Tab": 9, "Enter": 13, " ": 32, "ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39,
                "ArrowDown": 40, "Escape": 27}.get(key, ord(key[0].upper()))  # fmt: skip
        text = {"Enter": "\r", "Tab": "", " ": " "}.get(key, key if len(key) == 1 else "")
        for _ in range(times):
            said = {"key": key, "windowsVirtualKeyCode": code, "code": key}
            self.ask("Input.dispatchKeyEvent", type="keyDown", text=text, **said)
            self.ask("Input.dispatchKeyEvent", type="keyUp", **said)

    def write(self, words: str) -> None:
        """Write text into what has the focus, in place of what is selected."""
        self.ask("Input.insertText", text=words)

    def click(self, x: float, y: float) -> None:
        """Press and let go the mouse at a place of the window [CSS px]."""
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    @property
    def errors(self) -> list[str]:
        """What went wrong on the page since it was opened."""
        return list(_errors(self._events))

    def shot(self, path: Path, width: int, height: int | None = None) -> Path:
        """The page as a picture."""
        tall = height or int(self.value("document.documentElement.scrollHeight"))
        clip = {"x": 0, "y": 0, "width": width, "height": min(tall, 8000), "scale": 1}
        shot = self.ask("Page.captureScreenshot", clip=clip, captureBeyondViewport=True)
        path.write_bytes(base64.b64decode(shot["data"]))
        return path

    def settle(self) -> None:
        """Scroll through the page with every fold open, so that all its pictures move."""
        self.value(SETTLE)

    def scheme(self, colours: str) -> None:
        """Whether the reader asked for a "light" or a "dark" page."""
        features = [{"name": "prefers-color-scheme", "value": colours}]
        self.ask("Emulation.setEmulatedMedia", features=features)

    def asked(self) -> list[str]:
        """Every address that was asked for since the last page was opened."""
        return [
            str(one["params"]["request"]["url"])
            for one in self._events
            if one.get("method") == "Network.requestWillBeSent"
        ]

    def _wait(self, method: str) -> None:
        while not any(one.get("method") == method for one in self._events):
            self._events.append(self._next())

    def value(self, script: str) -> Any:
        found = self.ask(
            "Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True
        )
        if "exceptionDetails" in found:
            raise RuntimeError(found["exceptionDetails"]["exception"]["description"])
        return found["result"].get("value")

    def _shoot(self, folder: Path, stem: str, width: int, height: int) -> list[Path]:
        folder.mkdir(parents=True, exist_ok=True)
        taken = []
        for place, top in enumerate(range(0, height, SLICE), start=1):
            part = min(SLICE, height - top)
            clip = {"x": 0, "y": top, "width": width, "height": part, "scale": 1}
            shot = self.ask("Page.captureScreenshot", clip=clip, captureBeyondViewport=True)
            path = folder / f"{stem}-{width}-{place:02d}.png"
            path.write_bytes(base64.b64decode(shot["data"]))
            taken.append(path)
        return taken


def _dead(page: Path, link: str) -> bool:
    """Whether a link to a file beside the page leads nowhere."""
    parts = urlsplit(link)
    if parts.scheme or parts.netloc or not parts.path:
        return False
    return not (page.parent / unquote(parts.path)).exists()


def _errors(events: list[dict[str, Any]]) -> Iterator[str]:
    for one in events:
        what, said = one.get("method"), one.get("params", {})
        if what == "Runtime.exceptionThrown":
            details = said["exceptionDetails"]
            yield str(details.get("exception", {}).get("description") or details.get("text"))
        elif what == "Runtime.consoleAPICalled" and said["type"] in {"error", "assert"}:
            yield " ".join(str(arg.get("value", "")) for arg in said["args"])
        elif what == "Log.entryAdded" and said["entry"]["level"] == "error":
            yield str(said["entry"]["text"])
        elif what == "Network.loadingFailed" and not said.get("canceled"):
            yield f"not loaded: {said['errorText']}"


@contextmanager
def maybe() -> Iterator[Browser | None]:
    """A browser where this machine has one, else None."""
    program = find()
    if program is None:
        yield None
        return
    with opened(program) as one:
        yield one


def there(one: Browser | None, capsys: pytest.CaptureFixture[str]) -> Browser:
    """The browser; without one the test says so aloud and is left out."""
    if one is None:
        with capsys.disabled():
            print("\nno browser (package chromium; `make chromium`): its tests are not run")
        pytest.skip("no browser: make chromium")
    return one


@contextmanager
def opened(program: str) -> Iterator[Browser]:
    """A browser without a window, with a profile of its own that goes with it."""
    child_reads, we_write = os.pipe()
    we_read, child_writes = os.pipe()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        command = f'exec "$@" 3</dev/fd/{child_reads} 4>/dev/fd/{child_writes}'
        process = subprocess.Popen(
            ["sh", "-c", command, "sh", program, *FLAGS, f"--user-data-dir={profile}"],
            pass_fds=(child_reads, child_writes),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(child_reads)
        os.close(child_writes)
        try:
            yield Browser(we_read, we_write)
        finally:
            os.close(we_write)
            os.close(we_read)
            process.terminate()
            process.wait(timeout=20)
