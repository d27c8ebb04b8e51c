"""The page as the program serves it: planes of an atlas and feedback of several joints arrive."""

import math
import re
import subprocess
import sys

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

import standfast as sf

ATLAS = {
    "body": {"model": "edwards2007", "height": 1.753, "mass": 75.3},
    "stiffness": {
        "ankle": {"start": 200.0, "stop": 3000.0, "num": 29},
        "knee": [800.0, 1500.0],
        "hip": {"start": 100.0, "stop": 1600.0, "num": 16},
    },
    "output": {"quantities": ["safety_factor", "stable"]},
}
COMPILED = 60_000  # ms, until a plane of feedback that is compiled for the first time has come
COMPILED_ROUNDING = 1e-13  # the atlas is computed by a compiled program
GAINS = "knee_stiffness=inf&ankle_proportional_gain=900&ankle_derivative_gain=250"


@pytest.fixture
def served(tmp_path, browser_page):
    """Open the page of ``standfast explore`` with some arguments; it must be quiet."""
    running = []

    def open_page(*arguments, state=""):
        command = [sys.executable, "-m", "standfast", "explore", "--no-browser", *arguments]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        running.append(process)
        address = re.search(r"http://\S+", process.stdout.readline())[0]
        page = browser_page.page
        page.emulate_media(reduced_motion="reduce")
        page.goto(f"{address}#{state}")
        page.wait_for_selector("html[data-ready]", state="attached")
        page.wait_for_timeout(400)
        return page

    yield open_page
    for process in running:
        process.terminate()
        process.wait(timeout=20)
        process.stdout.close()
    assert browser_page.console_errors == []
    origins = {address.split("?")[0] for address in browser_page.requests}
    assert all(re.match(r"(http://127\.0\.0\.1:|data:|blob:)", origin) for origin in origins)


def test_planes_of_an_atlas_arrive_and_a_slider_changes_them(served, browser_page, tmp_path):
    sf.sweep(sf.Study.from_dict(ATLAS), tmp_path / "small.h5")
    page = served(str(tmp_path / "small.h5"))
    page.wait_for_selector("#computing", state="hidden")
    before = page.locator("#map").screenshot()
    page.focus("#p-knee_stiffness")
    page.keyboard.press("Home")
    page.wait_for_timeout(600)
    assert page.locator("#map").screenshot() != before
    with page.expect_download() as numbers:
        page.click("#numbers")
    lines = numbers.value.path().read_text(encoding="utf-8").splitlines()
    assert "# knee_stiffness = 800 N·m/rad" in lines
    ankle, hip, factor = map(float, lines[-1].split(","))
    body = sf.Body.from_height_mass(1.753, 75.3, "edwards2007")
    alone = float(sf.safety_factor(body, sf.Stiffness(ankle, 800.0, hip)))
    assert factor == pytest.approx(alone, rel=COMPILED_ROUNDING)
    page.evaluate("for (const box of document.querySelectorAll('details')) box.open = true")
    found = Axe().run(page)
    assert found.violations_count == 0, found.generate_report()
    refuses_others(page, browser_page)


ASKED = """async ([address, token]) => {
  const headers = { "Content-Type": "application/json", "X-Standfast-Token": token };
  const body = JSON.stringify({ quantity: "safety_factor", x: "ankle_stiffness",
    y: "hip_stiffness", at: { knee_stiffness: 0 } });
  try {
    return (await fetch(`${address}/atlas`, { method: "POST", headers, body })).status;
  } catch (error) {
    return error.name;
  }
}"""


def refuses_others(page, browser_page):
    """A wrong token is refused, and a page from elsewhere with the right one."""
    address, token = re.match(r"(http://[^/]+)/\?token=([^#]+)", page.url).groups()
    assert browser_page.console_errors == []
    assert page.evaluate(ASKED, [address, token]) == 200
    assert page.evaluate(ASKED, [address, "wrong"]) == 403
    page.goto("data:text/html,<p>from elsewhere</p>")
    assert page.evaluate(ASKED, [address, token]) == "TypeError"
    # the browser says so, too
    said = [re.search(r"403|CORS|ERR_FAILED", error) for error in browser_page.console_errors]
    assert said
    assert all(said)
    browser_page.console_errors.clear()


def test_feedback_of_two_joints_is_computed_by_the_program(served):
    state = f"{GAINS}&feedback_delay=0.05&quantity=decay_rate"
    page = served("--person", "ankle=700", state=state)
    expect(page.locator("#verdict")).to_contain_text("with feedback", timeout=COMPILED)
    page.wait_for_selector("#bar:not([hidden])", timeout=COMPILED)
    assert "Decay rate" in page.inner_text("#margins")
    assert page.inner_text("#word") == ""


def test_sway_is_shown_in_the_units_of_the_field(served):
    state = "ankle_noise=1&hip_noise=0.3&knee_stiffness=inf&ankle_damping=30&hip_damping=10"
    page = served(state=state)
    cells = page.locator("#sway td")
    expect(cells).to_have_count(6, timeout=COMPILED)
    body = sf.Body.from_height_mass(1.753, 75.3, "edwards2007")
    covariance = sf.sway_covariance(
        body, sf.Stiffness(1200, math.inf, 500), damping=(30, 0, 10), noise=(1.0, 0.0, 0.3)
    )
    ankle, _, hip = (math.degrees(math.sqrt(covariance[i, i])) for i in range(3))
    shown = cells.all_inner_texts()
    assert [text.split()[1] for text in shown] == ["°", "°", "mm", "mm", "mm/s", "Hz"]
    assert [float(text.split()[0]) for text in shown[:2]] == pytest.approx([ankle, hip], rel=5e-3)
    points = page.get_attribute("#sway-picture polygon.sway", "points").split()
    sides = [[float(point.split(",")[side]) for point in points] for side in (0, 1)]
    across, up = (max(side) - min(side) for side in sides)
    assert up / across == pytest.approx(hip / ankle, rel=5e-3)  # a degree is as long both ways
    within = math.sqrt(5.991)  # chi-squared of two, 95 %
    words = page.get_attribute("#sway-picture", "aria-label")
    found = [float(number) for number in re.findall(r"±([\d.]+)°", words)]
    assert found == pytest.approx([within * ankle, within * hip], rel=5e-3)
    found = Axe().run(page)
    assert found.violations_count == 0, found.generate_report()
    page.uncheck("#r-knee_stiffness")
    page.check("#r-hip_stiffness")
    page.check("#r-knee_stiffness")
    expect(page.locator("#sway-picture .bell")).to_have_count(1, timeout=COMPILED)
    page.fill("#n-ankle_stiffness", "100")
    page.press("#n-ankle_stiffness", "Enter")
    expect(page.locator("#sway-words")).to_have_text("The person falls, and so has no sway.")


def test_a_plane_that_a_newer_one_ended_is_asked_again_in_silence(served, browser_page):
    ended = []

    def refuse_once(route):
        ended.append(route.request.headers["x-standfast-page"])
        if len(ended) == 1:
            route.fulfill(status=409, content_type="text/plain", body="a newer plane")
        else:
            route.continue_()

    browser_page.page.route("**/live", refuse_once)
    state = f"{GAINS}&feedback_delay=0.05&quantity=decay_rate"
    page = served("--person", "ankle=700", state=state)
    page.wait_for_selector("#bar:not([hidden])", timeout=COMPILED)
    assert len(ended) > 1
    assert len(set(ended)) == 1
    assert page.inner_text("#status") == ""
    # the browser itself writes down every answer that is no success
    browser_page.console_errors[:] = [e for e in browser_page.console_errors if "409" not in e]
