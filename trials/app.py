"""The app walked through by mouse and by keyboard: actions counted, moves timed, pictures taken.

``python trials/app.py`` (``make trial NAME=app``) starts the app on the rig, answers three
questions by mouse and one by keyboard alone in a real browser, times moves beside the same
answers by commands, and writes trials/records/app.md with the pictures of docs/howto/app.md.
"""

from __future__ import annotations

import base64
import os
import resource
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path += [
    str(ROOT / "tests"),
    str(ROOT / "tests" / "views"),
    str(ROOT / "tests" / "front" / "app"),
]

import browser  # noqa: E402
from served import Served, served  # noqa: E402

DOCS = ROOT / "docs"
PICTURES = DOCS / "pictures"
SPEED = "operating.speed=4500 rpm"
CASE = ("rig", "--set", SPEED)
STATE = "document.getElementById('state').textContent"


@dataclass
class Walk:
    """A person at the page: every press of a key or a button, every word written, is an action."""

    page: browser.Browser
    actions: int = 0
    said: list[str] = field(default_factory=list)

    def begin(self) -> None:
        self.actions, self.said = 0, []

    def place(self, selector: str) -> tuple[float, float]:
        x, y = self.page.value(
            f"(() => {{ const e = document.querySelector({selector!r});"
            "e.scrollIntoView({block: 'center', behavior: 'instant'});"
            "const r = e.getBoundingClientRect();"
            "return [r.left + r.width / 2, r.top + r.height / 2]; })()"
        )
        return float(x), float(y)

    def press(self, selector: str, words: str) -> None:
        """Click an element."""
        self.page.click(*self.place(selector))
        self._did(f"click {words}")

    def write(self, selector: str, text: str, words: str) -> None:
        """Click into a field, write over what is there, Enter: three actions."""
        self.page.click(*self.place(selector))
        self.page.value(f"document.querySelector({selector!r}).select()")
        self.page.write(text)
        self.page.press("Enter")
        self._did(f"write {text} into {words}", 3)

    def key(self, key: str, times: int = 1) -> None:
        self.page.press(key, times)
        self.actions += times

    def _did(self, words: str, count: int = 1) -> None:
        self.actions += count
        self.said.append(words)

    def done(self) -> None:
        frames = "new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)))"
        self.page.value(f"{frames}.then(() => 1)")
        self.page.until("document.body.dataset.done === document.body.dataset.asked", 900)

    def lines(self, part: str) -> list[str]:
        items = f"[...document.querySelectorAll('[data-part=\"{part}\"] .lines li')]"
        return list(self.page.value(f"{items}.map(e => e.textContent)"))

    def shot(self, name: str, selector: str = "") -> None:
        """Take a picture of the window, scrolled to an element."""
        if selector:
            self.page.value(
                f"document.querySelector({selector!r})"
                ".scrollIntoView({block: 'start', behavior: 'instant'}); scrollBy(0, -70)"
            )
        else:
            self.page.value("scrollTo({top: 0, behavior: 'instant'})")
        self.page.value("new Promise(r => setTimeout(r, 200)).then(() => 1)")
        shot = self.page.ask("Page.captureScreenshot")
        (PICTURES / f"app-{name}.png").write_bytes(base64.b64decode(shot["data"]))


def rattle(walk: Walk) -> str:
    """Which speed range rattles at 120 degC?"""
    walk.write("#dial-gears-number", "120", "gear temperature")
    walk.done()
    walk.shot("rattle", "[data-part='run-up']")
    return next(one for one in walk.lines("run-up") if one.startswith("hot, contact is"))


def backlash(walk: Walk) -> str:
    """How much backlash is needed for gears 20 K hotter than their housing?"""
    walk.write("#dial-housing-number", "20", "housing below the gears")
    walk.done()
    walk.shot("backlash")
    return next(one for one in walk.lines("mesh") if one.startswith("hot"))


def relief(walk: Walk) -> str:
    """Does tip relief help at part load?"""
    walk.write("#dial-torque-number", "30", "pinion torque")
    walk.done()
    before = error(walk)
    walk.press("#pin", "Pin")
    walk.press("#every > summary", "Every field")
    for gear in ("pinion", "wheel"):
        field = f"[id='field-gears.{gear}.tip_relief.%s']"
        group = f"#fields details:has({field % 'amount'}) > summary"
        walk.press(group, f"gears, {gear}, tip relief")
        walk.write(field % "amount", "4 um", f"{gear}'s amount")
        walk.write(field % "length", "3 mm", f"{gear}'s length")
    walk.done()
    walk.shot("relief", "[data-part='run-up']")
    return f"{before} without, {error(walk)} with 4 µm at both tips"


def error(walk: Walk) -> str:
    """What the answers say of the static transmission error."""
    rows = walk.page.value(
        "[...document.querySelectorAll('[data-part=answers] tbody tr')]"
        ".map(r => r.children[2].textContent)"
    )
    return str(next(one for one in rows if one.startswith("Static and loaded")))


def by_keys(walk: Walk) -> str:
    """Which speed range rattles at 120 degC? By keyboard alone."""
    walk.page.value("document.body.tabIndex = -1; document.body.focus(); scrollTo(0, 0)")
    while walk.page.value("document.activeElement.id") != "dial-gears-number":
        walk.key("Tab")
        if walk.actions > 60:
            raise SystemExit("the gear temperature is not reached by Tab")
    walk.page.value("document.activeElement.select()")
    walk.page.write("120")
    walk.key("Enter")
    walk.actions += 1
    walk.said.append(f"Tab {walk.actions - 2} times, write 120, Enter")
    walk.done()
    return next(one for one in walk.lines("run-up") if one.startswith("hot, contact is"))


TASKS = (
    ("mouse", rattle),
    ("mouse", backlash),
    ("mouse", relief),
    ("keyboard", by_keys),
)


# --- times --------------------------------------------------------------------------------------


def spent(pid: int) -> float:
    """Processor time of a process so far [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def by_command(*words: str) -> float:
    """Processor time of a command [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([ROOT / ".venv/bin/thermogear", *words], check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def moves(walk: Walk) -> dict[str, list[float]]:
    """Processor time at the server [ms] until a part was there, for five moves of two dials."""
    walk.page.value(
        "window.times = {}; window.addEventListener('part', (e) => {"
        "(window.times[e.detail.name] ??= []).push(e.detail.milliseconds); }); 1"
    )
    found: dict[str, list[float]] = {}
    for dial, name, values in (
        ("gears", "mesh", (121, 122, 123, 124, 125)),
        ("speed", "orbit", (4510, 4520, 4530, 4540, 4550)),
        ("damping", "run-up", (0.071, 0.072, 0.073, 0.074, 0.075)),
    ):
        found[name] = []
        for value in values:
            walk.page.value("window.times = {}; 1")
            walk.page.value(
                f"(() => {{ const e = document.getElementById('dial-{dial}-number');"
                f"e.value = {value}; e.dispatchEvent(new Event('change')); }})()"
            )
            walk.page.until(f"(window.times['{name}'] ?? []).length > 0", 60)
            found[name].append(float(walk.page.value(f"window.times['{name}'][0]")))
        walk.done()
    return found


def memory(pid: int) -> float:
    """Of a process [MB]."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def after_closing(server: Served) -> float:
    """Processor time [s] in the two seconds after a page was closed amid a run-up."""
    program = browser.find()
    assert program is not None
    with browser.opened(program) as other:
        other.go(server.address)
        other.until("!!document.getElementById('count')?.value")
        other.value(
            "(() => { const e = document.getElementById('count'); e.value = 1500;"
            "e.dispatchEvent(new Event('change')); })()"
        )
        other.until(f"{STATE}.includes('run-up')")
        time.sleep(0.5)
        other.ask("Page.navigate", url="about:blank")
        time.sleep(0.3)
    before = spent(server.process.pid)
    time.sleep(2.0)
    return spent(server.process.pid) - before


def median(values: list[float]) -> float:
    return sorted(values)[len(values) // 2]


def page_text(
    rows: list[str],
    times: dict[str, tuple[float, float]],
    commands: dict[str, float],
    memory_: float,
    rest: float,
) -> str:
    """The page of what was seen."""
    shown = {name: f"{middle:.0f} ({worst:.0f})" for name, (middle, worst) in times.items()}
    return "\n".join((
        "# The app walked through", "",
        "Made by `make trial NAME=app`: the app on the rig in a real browser.", "",
        "| question | by | actions | which | what the page says |",
        "|---|---|---:|---|---|",
        *rows, "",
        "An action is a click, a key, or a text written.", "",
        "Processor time at the server from a dial's move to its picture, median of five (worst),",
        "beside that of a command which answers the same from the start, in one run:", "",
        "| move | picture | dial, ms | command, ms |",
        "|---|---|---:|---:|",
        f"| gear temperature | stiffness | {shown['mesh']} | {commands['check']:.0f} (`check`, "
        "without a picture) |",
        f"| speed | orbit with its proof | {shown['orbit']} | {commands['orbit']:.0f} (`orbit`) |",
        f"| damping | first speeds of a run-up of 300 | {shown['run-up']} | |", "",
        f"The server takes {memory_:.0f} MB with one page open; {rest:.2f} s of processor time in",
        "the two seconds after a page was closed amid a run-up of 1500 speeds.", "",
    ))  # fmt: skip


def main() -> int:
    program = browser.find()
    if program is None:
        print("no browser: make chromium")
        return 1
    rows: list[str] = []
    with served(*CASE) as server, browser.opened(program) as page:
        walk = Walk(page)
        for by, task in TASKS:
            page.go(server.address)
            page.until("!!document.getElementById('count')?.value")
            walk.done()
            if task is rattle:
                walk.shot("first")
            walk.begin()
            answer = task(walk)
            assert not page.errors, page.errors
            question = (task.__doc__ or "").strip()
            rows.append(
                f"| {question} | {by} | {walk.actions} | {'; '.join(walk.said)} | {answer} |"
            )
            print(rows[-1], flush=True)
        one = memory(server.process.pid)
        times = moves(walk)
        rest = after_closing(server)
    change = [
        SPEED,
        "temperatures.pinion_addendum=121 degC",
        "temperatures.wheel_addendum=121 degC",
    ]
    set_ = [word for one in change for word in ("--set", one)]
    text = page_text(
        rows,
        {name: (median(values), max(values)) for name, values in times.items()},
        {name: 1e3 * by_command(name, "rig", *set_) for name in ("check", "orbit")},
        one,
        rest,
    )
    (ROOT / "trials" / "records" / "app.md").write_text(text, "utf-8")
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
