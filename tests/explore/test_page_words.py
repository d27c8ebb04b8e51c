"""What the page says of what it shows otherwise, or cannot show; and what is taken home of it."""

import io
import re

import numpy as np
import pytest
from axe_playwright_python.sync_playwright import Axe
from PIL import Image

from explore_content import embedded_content, springs_content
from explore_page import picture, rest, slide, table, taken, typed
from standfast.explore.page import page_html
from standfast.quantities import QUANTITIES

COLUMN_OF_A_PAPER = 3.5  # inches
RESOLUTION = 300  # pixels to an inch
FALLS = (233, 167, 131)  # the colour of who falls


@pytest.fixture
def page_of(tmp_path, opened):
    """Open a page of some content."""

    def open_page(content, state="", **more):
        (tmp_path / "page.html").write_text(page_html(content), encoding="utf-8")
        return opened(tmp_path / "page.html", state, **more)

    return open_page


def subject(label, **stiffness):
    return {"label": label, "values": {f"{k}_stiffness": v for k, v in stiffness.items()}}


def test_who_is_not_on_the_map_is_said(page_of):
    subjects = [
        subject("Anna", ankle=700.0, hip=350.0), subject("Bo", ankle=5000.0, hip=350.0),
        subject("Cy", ankle=900.0, hip="inf"), subject("", ankle=900.0),
    ]  # fmt: skip
    page = page_of(springs_content(subjects=subjects))
    said = page.inner_text("#marks")
    assert page.get_attribute("#marks", "role") == "status"
    assert "Bo (ankle stiffness 5000 N·m/rad, outside)" in said
    assert "Cy (hip stiffness rigid)" in said
    assert "subject 4 (hip stiffness not given)" in said
    assert "Anna" not in said
    page.evaluate("location.hash = 'window=1000,2000,0,3000'")
    rest(page)
    assert "Anna (ankle stiffness 700 N·m/rad, outside)" in page.inner_text("#marks")


def test_a_subject_on_the_map_of_another_body_is_named(page_of):
    subjects = [{"label": "Anna", "values": {
        "ankle_stiffness": 700.0, "hip_stiffness": 350.0, "knee_stiffness": "inf",
        "height": 1.6, "mass": 75.3,
    }}]  # fmt: skip
    page = page_of(springs_content(subjects=subjects))
    assert "Anna (height 1.6 m, knee stiffness rigid)" in page.inner_text("#marks")
    slide(page, "height", 1.6)
    page.check("#r-knee_stiffness")
    rest(page)
    assert page.inner_text("#marks") == ""


def test_a_person_who_is_not_on_the_map_is_said(page_of):
    page = page_of(springs_content(), "knee_stiffness=inf&y=knee_stiffness")
    assert page.inner_text("#marks").startswith(
        "The person is not on the map: knee stiffness rigid."
    )


def test_a_subject_between_the_values_of_an_atlas_is_said_to_be_shown_at_the_nearest(page_of):
    values = {
        "ankle_stiffness": 1400.0, "knee_stiffness": "inf", "mass": 60.0, "bmi": 19.5,
        "height": 1.753, "feedback_delay": 0.1, "ankle_noise": 0.0,
    }  # fmt: skip
    content = embedded_content()
    page = page_of({**content, "subjects": [{"label": "Anna", "values": values}]})
    page.select_option("#subject", label="Anna")
    rest(page)
    said = page.inner_text("#marks")
    assert said.startswith(
        "Anna: ankle stiffness 1400 N·m/rad is shown at 1500 N·m/rad; mass 60 kg"
    )
    assert "mass 60 kg is shown at 75.3 kg" in said
    assert "feedback_delay 0.1 is not part of this page" in said
    assert "noise" not in said  # of nothing
    assert "height" not in said
    # beside the words about its mark
    assert "knee" not in said
    assert page.input_value("#n-knee_stiffness") == "∞"
    assert "bmi" not in page.inner_text("#marks")
    slide(page, "knee_stiffness", 0)
    rest(page)
    assert "shown at" not in page.inner_text("#marks")
    assert page.input_value("#subject") == ""


def test_an_address_of_values_that_an_atlas_has_not_is_said_to_be_shown_at_the_nearest(page_of):
    page = page_of(embedded_content(), "knee_stiffness=1100&hip_stiffness=400")
    said = page.inner_text("#status")
    assert "knee stiffness 1100 is shown at 1200 N·m/rad" in said
    assert "hip" not in said


def test_what_a_page_leaves_out_stands_at_its_top(page_of):
    page = page_of(springs_content(notes=["It holds <b>less</b>."]))
    assert page.inner_text("header #notes") == "It holds <b>less</b>."


def figure_of(page):
    with page.expect_download() as figure:
        page.click("#figure")
    rest(page)
    return figure.value.suggested_filename, Image.open(figure.value.path()).convert("RGB")


def test_the_figure_is_for_a_paper_whatever_the_window(springs_file, opened):
    page = opened(springs_file, "quantity=frequency")
    name, wide = figure_of(page)
    assert name == "standing-of-the-nominal-adult-frequency.png"
    assert wide.width >= COLUMN_OF_A_PAPER * RESOLUTION
    assert wide.getpixel((2, 2)) == (255, 255, 255)
    assert "Not on" not in page.inner_text("#marks")
    _, narrow = figure_of(opened(springs_file, "quantity=frequency", size=(390, 844), dark=True))
    difference = np.abs(np.asarray(wide, int) - np.asarray(narrow, int)).max(axis=2)
    assert np.mean(difference > 8) < 0.002
    # the map is in it: the colours of who stands and who falls, and the line between
    colours = np.asarray(wide)[400:800, 300:1200].reshape(-1, 3)
    assert (np.abs(colours.astype(int) - (213, 94, 0)).max(axis=1) < 3).sum() > 500
    again = page.evaluate("document.querySelectorAll('[tabindex]').length")
    assert again == 1


def test_quantities_that_cannot_be_shown_are_not_offered_and_say_why(springs_file, opened):
    page = opened(springs_file)
    options = page.locator("#quantity option")

    def offered():
        rows = options.evaluate_all("all => all.map(it => [it.value, it.disabled, it.text])")
        return {name: text for name, disabled, text in rows if disabled}

    disabled = offered()
    springs = {name for name, row in QUANTITIES.items() if row.reference is not None}
    assert not disabled.keys() & springs
    assert disabled["critical_delay"] == "critical delay – needs a gain"
    assert disabled["cop_sway"] == "CoP sway – needs noise"
    title = page.get_attribute("#quantity option[value=cop_sway]", "title")
    assert title == "The CoP sway is of noise: set a noise of the torques."
    gain = "ankle_proportional_gain"
    rigid = "knee_stiffness=inf&hip_stiffness=inf&ankle_stiffness=400"
    page.evaluate(f"location.hash = '{rigid}&{gain}=900&y={gain}'")
    rest(page)
    assert "critical_delay" not in offered()
    assert offered()["decay_rate"] == "decay rate – needs the program"
    # what an address asks for stays chosen, and the map says what it lacks
    page.evaluate("location.hash = 'quantity=decay_rate'")
    rest(page)
    assert "decay_rate" not in offered()
    assert page.input_value("#quantity") == "decay_rate"
    assert "set a gain" in page.inner_text("#word")


@pytest.mark.parametrize("size", [(1400, 900), (1120, 900), (800, 900), (390, 844)])
def test_no_select_cuts_a_name(springs_file, opened, size):
    page = opened(springs_file, size=size)
    # as wide as its longest name needs, if it could
    cut = page.evaluate("""() => ["quantity", "x", "y"].filter((id) => {
      const select = document.getElementById(id);
      const free = select.cloneNode(true);
      for (const option of free.options) option.text = option.dataset.words ?? option.text;
      free.style.cssText = "position: absolute; width: max-content; max-width: none;";
      document.body.append(free);
      const wanted = free.offsetWidth;
      free.remove();
      return select.offsetWidth < wanted;
    })""")
    assert cut == []


def test_computed_numbers_have_as_many_digits_as_others(springs_file, opened):
    page = opened(springs_file, "ankle_stiffness=1200&knee_stiffness=2000&hip_stiffness=500")
    cells = page.locator("#margins td").all_inner_texts()
    assert cells[0] == "1.100"
    digits = [len(re.sub(r"[^0-9]", "", cell.split()[0]).lstrip("0")) for cell in cells]
    assert set(digits) == {4}
    assert "divided by 1.10." in page.inner_text("#verdict")
    assert table(page)["Safety factor"] == pytest.approx(1.1, rel=1e-3)


def test_roots_are_named_with_their_unit(springs_file, opened):
    page = opened(springs_file, "ankle_stiffness=50000&knee_stiffness=50000&hip_stiffness=50000")
    assert re.search(r"Outside of the frame: .* up to [\d.]+ rad/s\.", page.inner_text("#outside"))


def noisy_content(sway):
    sections = {"damping": {"ankle": 20.0}, "noise": {"ankle": 1.0}}
    return embedded_content(cop_sway=sway, **sections)


def test_sway_on_the_map_is_in_the_units_of_the_field_and_who_falls_is_hatched(page_of):
    sway = np.broadcast_to(np.linspace(0.002, 0.008, 6), (5, 3, 6)).copy()
    sway[:2] = np.inf
    page = page_of(noisy_content(sway), "x=ankle_stiffness&y=hip_stiffness")
    label = page.get_attribute("#bar", "aria-label")
    assert label == "CoP sway (mm): colours from 2 to 8, hatched: falls"
    assert "cop_sway (m)" in next(line for line in taken(page) if not line.startswith("#"))
    colours = np.array(Image.open(io.BytesIO(picture(page))).convert("RGB"), int)
    left = colours[colours.shape[0] // 3, colours.shape[1] // 5 : colours.shape[1] // 4]
    near = np.abs(left - FALLS).max(axis=1) < 3
    assert 0.5 < near.mean() < 1.0  # the rest is hatched
    yellow = np.abs(left - (254, 232, 56)).max(axis=1) < 20
    assert not yellow.any()


def test_where_no_stiffness_suffices_the_colour_is_that_of_who_falls(springs_file, opened):
    # above the limit of the scale there is a colour of its own, which infinite has not
    page = opened(springs_file, "quantity=critical_ankle_stiffness&window=0,3000,0,150")
    colours = np.array(Image.open(io.BytesIO(picture(page))).convert("RGB"), int)
    inside = colours[::4, colours.shape[1] // 4 : -colours.shape[1] // 8].reshape(-1, 3)
    assert (np.abs(inside - FALLS).max(axis=1) < 3).mean() > 0.4
    assert "hatched" in page.get_attribute("#bar", "aria-label")


@pytest.mark.parametrize("dark", [False, True])
def test_no_barrier_is_found_by_axe_in_what_is_said(page_of, dark):
    subjects = [subject("Anna", ankle=700.0, hip=350.0), subject("Bo", ankle=5000.0, hip=1.0)]
    content = springs_content(notes=["Something is left out."], subjects=subjects)
    page = page_of(content, size=(390, 844), dark=dark)
    typed(page, "mass", "-1")
    rest(page)
    assert page.inner_text("#e-mass") != ""
    found = Axe().run(page)
    assert found.violations_count == 0, found.generate_report()
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_an_atlas_without_the_verdict_is_hatched_where_its_values_are_below_the_limit(page_of):
    factor = np.broadcast_to(np.linspace(0.5, 1.6, 6), (5, 3, 6)).copy()
    page = page_of(embedded_content(safety_factor=factor), "x=ankle_stiffness&y=hip_stiffness")
    assert page.get_attribute("#bar", "aria-label").endswith("hatched: falls")
    gains = {"proportional": {"ankle": 600.0}, "derivative": {"ankle": 250.0}, "delay": 0.1}
    page = page_of(embedded_content(decay_rate=factor - 1.0, feedback=gains))
    assert page.get_attribute("#bar", "aria-label").endswith("hatched: falls")
    # beyond the critical delay a person may stand again, and with feedback whom springs do not hold
    for values in ({"delay_margin": factor - 1.0}, {"safety_factor": factor}):
        page = page_of(embedded_content(**values, feedback=gains))
        assert "hatched" not in page.get_attribute("#bar", "aria-label")


def test_a_file_is_named_after_the_page_and_what_is_in_it(page_of):
    page = page_of(springs_content(title="Größe & Gewicht: " + "viele Worte " * 9))
    name, _ = figure_of(page)
    assert name == "größe-gewicht-viele-worte-viele-worte-viele-wor-safety-factor.png"


NAME = """() => {
  let it = document.activeElement;
  while (it?.shadowRoot?.activeElement) it = it.shadowRoot.activeElement;
  const label = it.labels?.[0]?.innerText;
  return it === document.body ? "body" : it.getAttribute("aria-label") || label || it.innerText;
}"""


def test_every_stop_of_the_keyboard_has_a_name(springs_file, opened):
    page = opened(springs_file)
    page.evaluate("for (const box of document.querySelectorAll('details')) box.open = true")
    names = []
    while not names or names[-1] != "body":
        page.keyboard.press("Tab")
        names.append(page.evaluate(NAME).strip())
        assert len(names) < 200
    assert "" not in names
    assert len(names) > 80
