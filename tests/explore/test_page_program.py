"""The page and a program that is held back or refuses: what is shown, asked, and taken home."""

import json

import numpy as np
import pytest
from playwright.sync_api import expect

from explore_content import springs_content
from explore_page import ready, slide, taken
from standfast.explore.page import page_html, script, scripts

ADDRESS = "http://127.0.0.1:9/"
GAINS = "ankle_proportional_gain=900&ankle_derivative_gain=250"
DECAY = f"{GAINS}&quantity=decay_rate"
PERSON = {
    "stands": True,
    "critical_delay": 0.2,
    "delay_margin": 0.1,
    "unstable_roots": 0,
    "rightmost_root": [-1.0, 2.0],
    "roots": [[-1.0, 2.0]],
    "shape": [[1.0, 0.0], [0.0, 0.0], [0.0, 0.0]],
}


class Program:
    """Stands in for the program: answers planes of one value, the mass, when it is let."""

    def __init__(self):
        self.asked, self.held, self.person = [], None, PERSON
        self.refused = lambda side: None

    def sides(self):
        return [len(body["x"]["values"]) for body in self.asked]

    def answer(self, route):
        path = route.request.url.removeprefix(ADDRESS)
        if path == "":
            html = page_html(springs_content(served=True, token="t"))  # noqa: S106 - of the test
            route.fulfill(body=html, content_type="text/html")
        elif path == "person":
            route.fulfill(body=json.dumps(self.person), content_type="application/json")
        else:
            self.asked.append(route.request.post_data_json)
            if self.held is None:
                self.plane(route)
            else:
                self.held.append(route)

    def plane(self, route):
        body = route.request.post_data_json
        size = len(body["x"]["values"]) * len(body["y"]["values"])
        if sentence := self.refused(len(body["x"]["values"])):
            route.fulfill(status=400, body=sentence, content_type="text/plain")
            return
        planes = {
            name: np.full(size, 1.0 if name == "stable" else body["parameters"].get("mass", 0.0))
            for name in body["quantities"]
        }
        route.fulfill(body=np.concatenate([*planes.values()]).tobytes())

    def let_go(self):
        held, self.held = self.held, None
        for route in held:
            self.plane(route)


@pytest.fixture
def program():
    return Program()


@pytest.fixture
def asking(browser_page, program):
    """Open the page that the program serves; what it refuses is no error of the page."""

    def open_page(state):
        page = browser_page.page
        page.emulate_media(reduced_motion="reduce")
        page.route(f"{ADDRESS}**", program.answer)
        page.goto(f"{ADDRESS}#{state}")
        ready(page)
        return page

    yield open_page
    assert [said for said in browser_page.console_errors if "status of 400" not in said] == []


def complete(page):
    # not by wait_for_function, whose code the page's rules refuse
    page.evaluate(
        "new Promise((done) => { const look = () =>"
        " standfastDrawn.side === 401 ? done() : setTimeout(look, 20); look(); })"
    )


def values_in(lines):
    return {line.rsplit(",", 1)[1] for line in lines if line[0].isdigit()}


def test_a_coarse_plane_comes_first_and_then_the_whole_one(asking, program):
    page = asking(DECAY)
    complete(page)
    assert program.sides() == [41, 401]
    assert page.is_hidden("#computing")
    assert len(taken(page)) > 401 * 401


def test_numbers_taken_home_are_of_the_state_that_is_written_above_them(asking, program):
    page = asking(DECAY)
    complete(page)
    program.held = []
    slide(page, "mass", 120)
    expect(page.locator("#computing")).to_be_visible()
    assert page.is_disabled("#numbers")
    assert page.is_disabled("#figure")
    # even if they were asked for: what is drawn is the old state's
    lines = taken(page, forced=True)
    assert "# mass = 75.3 kg" in lines
    assert values_in(lines) == {"75.3"}
    program.let_go()
    expect(page.locator("#numbers")).to_be_enabled()
    lines = taken(page)
    assert "# mass = 120 kg" in lines
    assert values_in(lines) == {"120"}


def test_a_refused_plane_clears_the_map_and_ends(asking, program):
    program.refused = lambda side: "so light a person cannot be"
    page = asking(DECAY)
    expect(page.locator("#word")).to_have_text("so light a person cannot be")
    page.wait_for_timeout(300)
    assert program.sides() == [41]
    assert page.is_hidden("#computing")
    assert page.is_hidden("#bar")
    program.refused = lambda side: None
    slide(page, "mass", 120)
    complete(page)
    assert page.inner_text("#word") == ""


def test_of_a_plane_that_is_refused_in_full_the_coarse_one_stays(asking, program):
    program.refused = lambda side: "too fine" if side == 401 else None
    page = asking(DECAY)
    expect(page.locator("#word")).to_have_text("too fine")
    page.wait_for_timeout(300)
    assert program.sides() == [41, 401]
    assert page.is_hidden("#computing")
    assert page.evaluate("standfastDrawn.side") == 41


def test_a_verdict_is_announced_once_it_has_come_and_an_open_one_is_not_a_fall(asking, program):
    page = asking(GAINS)
    expect(page.locator("#said")).to_contain_text("Stands with feedback")
    page.route(f"{ADDRESS}person", lambda route: None)
    slide(page, "mass", 120)
    page.wait_for_timeout(350)
    assert page.inner_text("#said") == ""
    assert "being computed" in page.get_attribute("#map", "aria-label")
    page.unroute(f"{ADDRESS}person")
    program.person = {**PERSON, "stands": None, "rightmost_root": None, "shape": None}
    page.goto("about:blank")
    page.goto(f"{ADDRESS}#{GAINS}")
    expect(page.locator("#verdict")).to_contain_text("open within rounding")
    assert "falls" not in page.get_attribute("#verdict", "class")
    assert "open within rounding" in page.inner_text("#unmoved")


# Two planes of 128 MB fit, and of three that which was looked at last stays.
KEEPING = """
const side = 4096;
const row = (name) => ({ name, stops: Array.from({ length: side }, (_, i) => i) });
const parameter = { x: row("x"), y: row("y"), z: { stops: [0, 1, 2] } };
const quantity = { q: { axes: ["x", "y", "z"], dtype: "float64", limit: 1 } };
const asked = [];
const ask = async (_, { at }) => {
  asked.push(at.z);
  return { arrayBuffer: async () => new ArrayBuffer(8 * side * side) };
};
const cells = new Cells({ parameter, quantity }, { ask, arrived: () => {} });
const settled = () => new Promise((done) => setTimeout(done, 20));
for (const z of [0, 1, 0, 2, 0, 1]) {
  cells.sample({ values: { z }, x: "x", y: "y" }, "q");
  await settled();
}
globalThis.asked = asked;
"""


def test_planes_of_an_atlas_are_kept_by_their_size_those_looked_at_last(browser_page, tmp_path):
    modules = {**scripts(), "main.js": f'import {{ Cells }} from "./cells.js";\n{KEEPING}'}
    path = tmp_path / "cells.html"
    path.write_text(f'<script type="module">{script(modules)}</script>', encoding="utf-8")
    browser_page.page.goto(path.as_uri())
    browser_page.page.wait_for_function("globalThis.asked")
    assert browser_page.page.evaluate("asked") == [0, 1, 2, 1]
    assert browser_page.console_errors == []
