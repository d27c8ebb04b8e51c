"""The page where it is pressed: ends of its axes, what springs alone cannot say, all sliders."""

import numpy as np
import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

from explore_content import embedded_content
from explore_page import rest, slide, table, taken, typed
from standfast.explore.page import page_html
from standfast.parameters import COUPLINGS, PARAMETERS, STIFFNESSES

RIGID = "knee_stiffness=inf&hip_stiffness=inf&ankle_stiffness=400"
GAINS = "ankle_proportional_gain=900&ankle_derivative_gain=250"
# A column of a source of Bokeh, whichever document it is of.
COLUMN = """(name, key) => {
  const { data } = Bokeh.documents.map((one) => one.get_model_by_name(name)).find(Boolean);
  return data instanceof Map ? data.get(key) : data[key];
}"""
PLANE = "x=feedback_delay&y=ankle_proportional_gain"


def test_feedback_of_one_joint_is_live_and_of_several_needs_the_program(springs_file, opened):
    gains = f"{GAINS}&feedback_delay=0.1"
    page = opened(springs_file, f"{gains}&{RIGID}&{PLANE}&quantity=critical_delay")
    assert page.inner_text("#verdict").startswith("Stands with feedback.")
    assert "Critical delay" in page.inner_text("#margins")
    assert page.inner_text("#word") == ""
    page.goto(f"{springs_file.as_uri()}#{gains}")
    rest(page)
    assert "needs the program" in page.inner_text("#word")


def test_no_movement_of_springs_alone_is_shown_of_who_has_feedback(springs_file, opened):
    page = opened(springs_file, f"{GAINS}&feedback_delay=0.05&{RIGID}&{PLANE}")
    assert page.inner_text("#verdict").startswith("Stands with feedback.")
    assert "falls" not in (page.get_attribute("#figure-of-person", "class") or "")
    assert "needs the program" in page.inner_text("#unmoved")
    assert "growing" not in page.get_attribute("#roots", "aria-label")
    rows = [row.strip() for row in page.locator("#margins tr").all_inner_texts()]
    heads = [row for row in rows if "\t" not in row]
    assert heads == ["By springs alone", "With feedback"]
    assert rows.index(heads[0]) < rows.index(heads[1])
    assert "Growth rate of the fall" in table(page)


def test_damping_that_the_page_does_not_know_is_said(springs_file, opened):
    page = opened(springs_file, "ankle_damping=100&knee_damping=100&hip_damping=100")
    assert "damping" in page.inner_text("#word")
    assert "needs the program" in page.inner_text("#word")
    assert page.inner_text("#verdict").startswith("Stands by springs alone.")
    page = opened(springs_file, "ankle_damping=100&quantity=decay_rate")
    assert "needs the program" in page.inner_text("#word")


def test_a_window_is_never_too_narrow_to_draw(springs_file, opened):
    page = opened(springs_file, "window=1000,1000.0000000000001,0,1500")
    assert "window=" in page.evaluate("location.hash")
    page.click("#whole")
    page.evaluate("for (let i = 0; i < 70; i++) document.getElementById('nearer').click()")
    rest(page)
    low, high = map(float, page.evaluate("location.hash").split("window=")[1].split(",")[:2])
    assert 1e-9 < (high - low) / 3000.0 < 1e-5


def test_a_window_stays_within_what_its_axes_can_have(springs_file, opened):
    page = opened(springs_file, "x=mass&window=-200,100,-500,1000")
    low = PARAMETERS["mass"].lowest
    ends = page.evaluate("location.hash").split("window=")[1]
    assert list(map(float, ends.split(","))) == [low, low + 300.0, 0.0, 1500.0]
    box = page.locator("#map").bounding_box()
    x, y = box["x"] + 0.4 * box["width"], box["y"] + 0.4 * box["height"]
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 300, y - 200, steps=3)
    page.mouse.up()
    rest(page)
    masses, hips = zip(
        *(map(float, line.split(",")[:2]) for line in taken(page) if line[0].isdigit()), strict=True
    )
    assert min(masses) >= low
    assert min(hips) >= 0.0


def test_a_field_shows_what_the_person_has(atlas_file, springs_file, opened):
    page = opened(atlas_file, "knee_stiffness=1200")
    typed(page, "knee_stiffness", "1220")
    expect(page.locator("#n-knee_stiffness")).to_have_value("1200")
    assert page.inner_text("#e-knee_stiffness").startswith("1220 is not a value of the atlas")
    typed(page, "knee_stiffness", "600")
    assert page.inner_text("#e-knee_stiffness") == ""
    typed(page, "hip_stiffness", "many")
    assert "100 to 3200 N·m/rad" in page.inner_text("#e-hip_stiffness")
    page = opened(springs_file)
    typed(page, "ankle_stiffness", "-1")
    assert page.inner_text("#e-ankle_stiffness") != ""
    slide(page, "mass", 80)
    rest(page)
    # what is refused stays where it is marked, whatever else changes
    expect(page.locator("#n-ankle_stiffness")).to_have_value("-1")
    typed(page, "ankle_stiffness", "1400")
    assert page.get_attribute("#n-ankle_stiffness", "aria-invalid") is None
    assert page.inner_text("#e-ankle_stiffness") == ""


def test_the_limit_of_an_atlas_is_its_verdict(tmp_path, opened):
    # beyond the critical delay the person falls, and stands again in a later window
    margin = np.broadcast_to(np.linspace(2.0, -2.0, 6), (5, 3, 6)).copy()
    stable = np.broadcast_to(np.array([1, 1, 1, 0, 1, 1], np.uint8), (5, 3, 6)).copy()
    gains = {"proportional": {"ankle": 100.0}, "derivative": {"ankle": 10.0}, "delay": 0.1}
    content = embedded_content(delay_margin=margin, stable=stable, feedback=gains)
    (tmp_path / "windows.html").write_text(page_html(content), encoding="utf-8")
    page = opened(tmp_path / "windows.html", "x=ankle_stiffness&y=hip_stiffness")
    assert page.evaluate(f"({COLUMN})('limit', 'ys').length") == 2


def test_what_is_hatched_is_said_only_where_something_is(springs_file, opened):
    page = opened(springs_file, "window=2000,3000,2000,3000")
    assert "hatched" not in page.get_attribute("#bar", "aria-label")
    page.click("#whole")
    rest(page)
    assert "hatched" in page.get_attribute("#bar", "aria-label")


@pytest.mark.parametrize(("size", "parts"), [
    ((390, 844), ["#verdict-box", "#map"]),
    ((360, 640), ["#verdict-box"]),  # not high enough for the map beside the sliders
])  # fmt: skip
def test_on_a_phone_verdict_and_map_are_in_sight_of_the_sliders(springs_file, opened, size, parts):
    page = opened(springs_file, size=size)
    tops = [
        page.locator(f"#{name}").bounding_box()["y"]
        for name in ("map", "bar", "controls-box", "person-box")
    ]
    assert tops == sorted(tops)
    page.evaluate("for (const box of document.querySelectorAll('details')) box.open = true")
    for name in ("hip_stiffness", "mass", "ankle_noise"):
        page.locator(f"#p-{name}").evaluate("it => it.scrollIntoView({ block: 'start' })")
        boxes = [page.locator(part).bounding_box() for part in (*parts, f"#p-{name}")]
        ends = [0.0]
        for box in boxes:
            assert box["y"] >= ends[-1] - 1.0
            ends.append(box["y"] + box["height"])
        assert ends[-1] <= size[1]
    # beside what comes after the sliders the map is in nobody's way
    page.locator("#roots-box").scroll_into_view_if_needed()
    assert page.locator("#map").bounding_box()["y"] < 0.0


# Move a slider by a seventh of its length from a state; return what has changed.
MOVED = """async ([name, state]) => {
  const painted = () => new Promise((done) => requestAnimationFrame(() => setTimeout(done, 30)));
  const heard = new Promise((done) => addEventListener("hashchange", done, { once: true }));
  if (location.hash.slice(1) !== state) {
    location.hash = state;
    await heard;
  }
  await painted();
  await painted();
  const column = COLUMN;
  const look = () => ({
    map: Uint32Array.from(column("image", "image")[0]),
    figure: document.getElementById("figure-of-person").innerHTML,
    numbers: document.getElementById("margins").innerText,
  });
  const before = look();
  const slider = document.getElementById(`p-${name}`);
  slider.value = Number(slider.value) + (slider.max - slider.min) / 7;
  slider.dispatchEvent(new Event("input"));
  await painted();
  await painted();
  const after = look();
  const differ = (one, other) =>
    typeof one === "string" ? one !== other : one.some((pixel, i) => pixel !== other[i]);
  return {
    moved: Object.keys(before).filter((part) => differ(before[part], after[part])),
    word: document.getElementById("word").innerText,
  };
}""".replace("COLUMN", COLUMN)


def test_every_slider_moves_what_is_seen_or_the_page_says_why_not(springs_file, opened):
    page = opened(springs_file)
    springs = {*STIFFNESSES, *COUPLINGS, "gravity", "height", "mass"}
    sliders = "[...document.querySelectorAll('#controls input[type=range]')]"
    names = page.evaluate(f"{sliders}.map((one) => one.id.slice(2))")
    assert springs < {*names}
    for name in names:
        if name in springs:
            # seen from an axis that is another parameter's
            state = "x=gravity&y=mass" if name not in ("gravity", "mass") else ""
            moved = page.evaluate(MOVED, [name, state])["moved"]
            assert {*moved} == {"map", "figure", "numbers"}, name
            continue
        joint = name.partition("_")[0] if name != "feedback_delay" else "ankle"
        others = "&".join(f"{one}=inf" for one in STIFFNESSES if not one.startswith(joint))
        gains = f"{joint}_proportional_gain=900&{joint}_derivative_gain=250&feedback_delay=0.02"
        state = f"{others}&{joint}_stiffness=400&{gains}&quantity=delay_margin&x=gravity&y=mass"
        found = page.evaluate(MOVED, [name, state])
        if {"map", "numbers"} <= {*found["moved"]}:
            continue
        if name.endswith("_noise"):
            page.evaluate(MOVED, [name, f"{joint}_damping=10"])
            assert "needs the program" in page.inner_text("#sway-words"), name
            continue
        # a gain from one joint to another, of which only one is free here
        assert name.split("_")[0] != name.split("_")[1], name
        found = page.evaluate(MOVED, [name, ""])
        assert "needs the program" in found["word"], name


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("size", [(1400, 900), (360, 800)])
def test_no_barrier_is_found_by_axe(springs_file, opened, dark, size):
    page = opened(springs_file, "ankle_stiffness=500", dark=dark, size=size)
    page.evaluate("for (const box of document.querySelectorAll('details')) box.open = true")
    found = Axe().run(page)
    assert found.violations_count == 0, found.generate_report()
    assert page.evaluate("document.documentElement.scrollWidth") <= size[0]


@pytest.mark.parametrize("state", ["atlas", f"{GAINS}&{RIGID}&{PLANE}", GAINS])
def test_no_barrier_is_found_on_an_atlas_or_with_feedback(atlas_file, springs_file, opened, state):
    page = opened(*((atlas_file,) if state == "atlas" else (springs_file, state)))
    page.evaluate("for (const box of document.querySelectorAll('details')) box.open = true")
    found = Axe().run(page)
    assert found.violations_count == 0, found.generate_report()


# The slider's move has been taken up, and its frame not yet come.
MOVED_AND_TAKEN = """async () => {
  const slider = document.getElementById("p-knee_stiffness");
  slider.value = 900;
  slider.dispatchEvent(new Event("input"));
  await new Promise((done) => { queueMicrotask(() => queueMicrotask(done)); });
  document.getElementById("numbers").click();
}"""


def test_until_a_new_map_is_painted_the_numbers_are_those_of_the_old_one(springs_file, opened):
    page = opened(springs_file, "quantity=critical_ankle_stiffness")
    before = taken(page)
    with page.expect_download() as numbers:
        page.evaluate(MOVED_AND_TAKEN)
    assert numbers.value.path().read_text(encoding="utf-8").splitlines() == before
    rest(page)
    assert taken(page) != before
