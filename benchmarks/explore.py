"""How soon the page of ``standfast explore`` answers: from a slider's input to the painted map.

Chromium, headless and drawn by the processor, opens the exported and the served page. Run as
``python benchmarks/explore.py`` (four minutes; it writes an atlas of 1 GB to a temporary folder).
"""

import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from playwright.sync_api import Page, sync_playwright

import standfast as sf
from harness import Demand, Report, Row

NAMES = ("chromium", "chromium-browser", "google-chrome")
ARGUMENTS = [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
]  # fmt: skip
MOVES = 60
FULL = 401  # points along a side of the map
STARTS = 5
SPRINGS = {
    "stable": 33.0, "critical_ankle_stiffness": 33.0, "safety_factor": 33.0, "frequency": 33.0,
    "stiffness_reserve": 33.0, "hip_ankle_ratio": 33.0,
}  # fmt: skip
ONE_JOINT = "knee_stiffness=inf&hip_stiffness=inf&ankle_stiffness=400&ankle_damping=20"
GAINS = "ankle_proportional_gain=500&ankle_derivative_gain=25&feedback_delay=0.1"
BIG = {
    "title": "An atlas of 1 GB", "gravity": 9.81,
    "body": {"model": "edwards2007", "height": 1.753, "mass": 75.3},
    "stiffness": {
        "ankle": {"start": 0, "stop": 2000, "num": 500},
        "knee": {"start": 500, "stop": 3000, "num": 510},
        "hip": {"start": 0, "stop": 2000, "num": 520},
    },
    "output": {"quantities": ["safety_factor"]},
}  # fmt: skip

# Move a slider step by step, and return how long each took in ms and how many points a side the
# picture had then. Springs: until the picture is painted, as the page measures it. Others: until
# nothing is under way and a frame was painted.
MOVE = """async ([id, moves, waits]) => {
  const slider = document.getElementById(id);
  const [low, high] = [Number(slider.min), Number(slider.max)];
  const painted = () => new Promise((done) => requestAnimationFrame(() => {
    const channel = new MessageChannel();
    channel.port1.onmessage = () => done(performance.now());
    channel.port2.postMessage(0);
  }));
  const times = [];
  const sides = [];
  for (let i = 0; i < moves; i++) {
    slider.value = String(low + (high - low) * (0.5 + 0.25 * Math.sin(i / 9)));
    const began = performance.now();
    slider.dispatchEvent(new Event("input", { bubbles: true }));
    let end = await painted();
    if (waits) while (!document.getElementById("computing").hidden) end = await painted();
    times.push(end - began);
    sides.push(globalThis.standfastDrawn.side);
    await new Promise((done) => setTimeout(done, 40));
  }
  return { times: waits ? times : globalThis.standfastTimes.slice(-moves), sides };
}"""


def main() -> None:
    """Measure, and write the report."""
    report = Report(
        "explore",
        "How soon does the page answer a slider?",
        f"Chromium without a graphics processor, 1400 × 900 pixels, median of {MOVES} moves",
        limitations=[
            "The picture is painted by the processor, which shares two cores with all the rest; "
            "what the screen adds is not seen.",
            "With three free joints the map that is awaited while dragging has 41 × 41 points.",
        ],
    )
    with TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found_browser(), args=ARGUMENTS)

        def page() -> Page:
            return browser.new_page(viewport={"width": 1400, "height": 900})

        exported = Path(folder) / "page.html"
        ran("--export", str(exported))
        report.extra["exported, bytes"] = exported.stat().st_size
        report.demands.append(
            Demand("exported page, MB", 3.0, exported.stat().st_size / 1e6, most=True)
        )
        for quantity, limit in SPRINGS.items():
            one = opened(page(), exported.as_uri(), f"quantity={quantity}")
            measure(report, one, f"springs: {quantity}", limit, "p-knee_stiffness")
        for quantity in ("stable", "critical_delay", "delay_margin"):
            state = f"quantity={quantity}&{ONE_JOINT}&{GAINS}&x=ankle_stiffness&y=feedback_delay"
            one = opened(page(), exported.as_uri(), state)
            slider = "p-ankle_proportional_gain"
            measure(report, one, f"delayed feedback of one joint: {quantity}", 100.0, slider)
        with served(page) as first:
            one = opened(first, first.url.split("#")[0], f"quantity=stable&{GAINS}")
            what = "delayed feedback, three joints free, while dragging"
            measure(report, one, what, None, "p-knee_stiffness", waits=True)
        big = Path(folder) / "big.h5"
        sf.sweep(sf.Study.from_dict(BIG), big)
        report.extra["atlas, bytes"] = big.stat().st_size
        with served(page, str(big)) as one:
            what = "a plane of an atlas of 1 GB"
            measure(report, one, what, 100.0, "p-knee_stiffness", waits=True)
        starts = [start_of(page) for _ in range(STARTS)]
        report.rows.append(Row("from the command to the page", starts, 1, "starts"))
        report.demands.append(
            Demand("from the command to the page, seconds", 3.0, report.rows[-1].median, most=True)
        )
        browser.close()
    report.write(("bokeh", "tornado", "playwright"))


def found_browser() -> str:
    """Return the path of the browser."""
    found = next((path for name in NAMES if (path := shutil.which(name))), None)
    if found is None:
        sys.exit(f"no browser: none of {', '.join(NAMES)} is on the PATH")
    return found


def measure(
    report: Report, page: Page, what: str, limit: float | None, slider: str, *, waits: bool = False
) -> None:
    """Move a slider; add a row, and a demand where there is a limit in ms."""
    page.evaluate(MOVE, [slider, 15, waits])  # until the browser has compiled what runs often
    found = page.evaluate(MOVE, [slider, MOVES, waits])
    page.close()
    seconds = [time / 1000.0 for time in found["times"]]
    full = sum(side == FULL for side in found["sides"])
    drawn = f"{full} of {MOVES} with {FULL} × {FULL} points, least {min(found['sides'])}"
    report.rows.append(Row(f"{what}, input to painted", seconds, 1, "maps", drawn))
    print(f"  {what}: {1000.0 * report.rows[-1].median:.1f} ms, {drawn}", flush=True)
    if limit is not None:
        median = 1000.0 * report.rows[-1].median
        report.demands.append(Demand(f"{what}, ms", limit, median, most=True))
        if not waits:
            report.demands.append(Demand(f"{what}, share drawn in full", 1.0, full / MOVES))


def opened(page: Page, address: str, state: str) -> Page:
    """Open a page in a state, without its moving figure, which would share the time."""
    page.emulate_media(reduced_motion="reduce")
    page.goto("about:blank")
    page.goto(f"{address}#{state}")
    page.wait_for_selector("html[data-ready]", state="attached")
    page.wait_for_timeout(1500)
    return page


@contextmanager
def served(page: Any, *arguments: str) -> Iterator[Page]:
    """Serve a page, and open it."""
    command = [sys.executable, "-m", "standfast", "explore", "--no-browser", *arguments]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        if process.stdout is None:
            raise RuntimeError("the program has no output")
        found = re.search(r"http://\S+", process.stdout.readline())
        if found is None:
            raise RuntimeError("the program names no address")
        yield opened(page(), found[0], "")
    finally:
        process.terminate()
        process.wait(20)


def start_of(page: Any) -> float:
    """Return the seconds from the start of the command until the page can be used."""
    began = time.perf_counter()
    command = [sys.executable, "-m", "standfast", "explore", "--no-browser"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        found = re.search(r"http://\S+", process.stdout.readline()) if process.stdout else None
        if found is None:
            raise RuntimeError("the program names no address")
        one = page()
        one.goto(found[0])
        one.wait_for_selector("html[data-ready]", state="attached")
        took = time.perf_counter() - began
        one.close()
        return took
    finally:
        process.terminate()
        process.wait(20)


def ran(*arguments: str) -> None:
    """Run the command once."""
    subprocess.run(
        [sys.executable, "-m", "standfast", "explore", *arguments],
        check=True, capture_output=True, env=os.environ,
    )  # fmt: skip


if __name__ == "__main__":
    main()
