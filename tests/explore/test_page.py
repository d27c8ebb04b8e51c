"""The page in a browser: it shows what the package computes, to everyone, without network."""

import io
import json
import re
from importlib.resources import files

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import expect

import standfast as sf
from explore_content import STARTS, springs_content
from explore_page import picture, rest, slide, table
from standfast.anthropometry.body import REFERENCE_PEOPLE
from standfast.cli.app import main
from standfast.explore import page as pages
from standfast.quantities import QUANTITIES
from standfast.quantities.row import Person

SHOWN_DIGITS = 2e-3  # four digits are shown


def adult(**changes):
    given = {**STARTS, **changes}
    return Person.of({**given, "body_model": REFERENCE_PEOPLE[given["body_model"]]})


def expected(name, **changes):
    row = QUANTITIES[name]
    person = adult(**changes)
    return float(row.pick(person, row.reference(person)))


def test_it_is_one_file_below_three_megabytes_and_asks_for_nothing(springs_file, opened):
    assert springs_file.stat().st_size < 3e6
    assert opened(springs_file).title() == "Standing of the nominal adult"


@pytest.mark.parametrize("served", [False, True])
def test_the_page_says_what_it_may_do(served):
    text = pages.page_html(
        {**springs_content(), "served": served, "token": "t" if served else None}
    )
    (policy,) = re.findall(r'<meta http-equiv="Content-Security-Policy" content="([^"]*)">', text)
    rules = dict(rule.split(" ", 1) for rule in policy.split("; "))
    assert rules["default-src"] == rules["base-uri"] == rules["form-action"] == "'none'"
    assert rules["connect-src"] == ("'self'" if served else "'none'")
    assert len(re.findall(r"'sha256-[\w+/=]{44}'", rules["script-src"])) == 2
    assert "unsafe" not in rules["script-src"]


def test_a_script_that_is_not_the_page_s_own_is_not_run(springs_file, opened, browser_page):
    page = opened(springs_file)
    added = "const s = document.createElement('script'); s.textContent = 'globalThis.ran = 1';"
    page.evaluate(f"() => {{ {added} document.body.append(s); }}")
    assert page.evaluate("globalThis.ran") is None
    (error,) = browser_page.console_errors
    assert "Content Security Policy" in error
    browser_page.console_errors.clear()


def test_modules_are_put_in_order_and_their_names_differ():
    modules = pages.scripts()
    names = [
        name
        for text in modules.values()
        for name in re.findall(
            r"^(?:export )?(?:async )?(?:function|class|const|let) (\w+)", text, re.MULTILINE
        )
    ]
    assert sorted(names) == sorted(set(names))
    text = pages.script(modules)
    assert not re.search(r"^(import|export) ", text, re.MULTILINE)
    assert text.index("function contourLines") < text.index("class StandingMap")


def test_a_circle_of_modules_is_named():
    with pytest.raises(ValueError, match=r"main\.js imports a\.js imports main\.js"):
        pages.script(
            {
                "main.js": 'import { a } from "./a.js";\n',
                "a.js": 'import { b } from "./main.js";\n',
            }
        )


def test_modules_are_small():
    for file in (files("standfast.explore") / "page").iterdir():
        if file.name.endswith(".js"):
            assert len(file.read_text(encoding="utf-8").splitlines()) <= 250, file.name


def test_texts_of_the_content_are_never_markup(tmp_path, opened):
    nasty = "</script><script>throw 1</script><!--<b>{script}"
    content = springs_content(title=nasty)
    content["subjects"] = [{"label": nasty, "values": {"ankle_stiffness": 900}}]
    path = tmp_path / "nasty.html"
    path.write_text(pages.page_html(content), encoding="utf-8")
    page = opened(path)
    assert page.inner_text("h1") == nasty
    assert page.locator("#subject option").all_inner_texts()[1] == nasty


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"ankle_stiffness": 600.0},
        {"knee_stiffness": float("inf"), "ankle_stiffness": 900.0},
        {"height": 1.5, "mass": 110.0, "gravity": 3.7, "body_model": "de-leva-female"},
    ],
)
def test_numbers_on_the_page_are_those_of_the_package(springs_file, opened, changes):
    state = "&".join(f"{name}={value}" for name, value in changes.items())
    page = opened(springs_file, state)
    shown = table(page)
    assert shown["Safety factor"] == pytest.approx(
        expected("safety_factor", **changes), rel=SHOWN_DIGITS
    )
    assert shown["Stiffness reserve"] == pytest.approx(
        expected("stiffness_reserve", **changes), rel=SHOWN_DIGITS
    )
    stands = expected("stable", **changes) == 1.0
    assert page.inner_text("#verdict").startswith("Stands." if stands else "Falls.")
    needed = page.locator("#bars li").first.inner_text()
    wanted = expected("critical_ankle_stiffness", **changes)
    assert float(re.search(r"needs ([\d.]+)", needed)[1]) == pytest.approx(wanted, rel=SHOWN_DIGITS)


@pytest.mark.parametrize(
    "state", ["mass=120", "quantity=frequency", "x=height&y=mass", "window=500,1500,200,900"]
)
def test_the_colours_of_the_map_are_those_of_a_page_opened_so(springs_file, opened, state):
    fresh = np.array(Image.open(io.BytesIO(picture(opened(springs_file, state)))), int)
    page = opened(springs_file)
    before = np.array(Image.open(io.BytesIO(picture(page))), int)
    page.evaluate("state => { location.hash = state; }", state)
    rest(page)
    after = np.array(Image.open(io.BytesIO(picture(page))), int)
    assert np.mean(abs(after - before).max(axis=2) > 8) > 0.1
    assert np.mean(abs(after - fresh).max(axis=2) > 8) < 0.002  # lines lie the same, too


def test_the_state_is_in_the_address_and_comes_back(springs_file, opened):
    page = opened(springs_file)
    slide(page, "ankle_stiffness", 700)
    page.select_option("#quantity", "frequency")
    page.click("#nearer")
    rest(page)
    address, shown = page.evaluate("location.hash"), picture(page)
    assert "ankle_stiffness=700" in address
    assert "quantity=frequency" in address
    assert "window=750,2250,750,2250" in address
    again = opened(springs_file, address[1:])
    assert again.evaluate("location.hash") == address
    assert picture(again) == shown
    again.click("#reset")
    rest(again)
    assert again.evaluate("location.hash") == ""


@pytest.mark.parametrize(
    "part", ["nonsense", "ankle_stiffness=many", "x=mass_of_moon", "window=3,2,1,0", "gravity=%E0"]
)
def test_a_malformed_part_of_an_address_is_left_out_and_named(springs_file, opened, part):
    page = opened(springs_file, f"{part}&hip_stiffness=700")
    assert part in page.inner_text("#status")
    expect(page.locator("#n-hip_stiffness")).to_have_value("700")


def test_a_number_beyond_the_slider_is_taken_and_one_beyond_all_is_refused(springs_file, opened):
    page = opened(springs_file)
    page.fill("#n-ankle_stiffness", "50000")
    page.press("#n-ankle_stiffness", "Enter")
    rest(page)
    assert "50000" in page.locator("#bars li").first.inner_text().replace(" ", "")
    page.fill("#n-ankle_stiffness", "-1")
    page.press("#n-ankle_stiffness", "Enter")
    rest(page)
    expect(page.locator("#n-ankle_stiffness")).to_have_value("-1")
    assert page.get_attribute("#n-ankle_stiffness", "aria-invalid") == "true"
    said = page.get_attribute("#n-ankle_stiffness", "aria-describedby")
    assert page.inner_text(f"#{said}") == "Cannot be -1: 0 to 1·10^12 N·m/rad."
    assert page.get_attribute(f"#{said}", "role") == "alert"
    page.click("#reset")
    rest(page)
    expect(page.locator("#n-ankle_stiffness")).to_have_value("1400")
    assert page.inner_text(f"#{said}") == ""


def test_the_keyboard_alone_suffices(springs_file, opened):
    page = opened(springs_file)
    page.focus("#map")
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Shift+ArrowUp")
    page.keyboard.press("+")
    rest(page)
    expect(page.locator("#n-ankle_stiffness")).to_have_value("1415")
    expect(page.locator("#n-hip_stiffness")).to_have_value("750")
    assert "window=" in page.evaluate("location.hash")
    label = page.get_attribute("#map", "aria-label")
    assert "ankle stiffness 1415 N·m/rad" in label
    assert "Stands." in label
    page.focus("#r-knee_stiffness")
    page.keyboard.press("Space")
    rest(page)
    assert page.get_attribute("#p-knee_stiffness", "aria-valuetext") == "rigid"
    assert page.locator(".figure .joint.rigid").count() == 1


def test_everything_can_be_reached_by_tab(springs_file, opened):
    page = opened(springs_file)
    reached = set()
    for _ in range(60):
        page.keyboard.press("Tab")
        reached.add(page.evaluate("document.activeElement.id"))
    wanted = {"map", "x", "y", "quantity", "subject", "play", "speed", "amplitude", "figure"}
    assert wanted | {"p-ankle_stiffness", "r-hip_stiffness", "reset", "link", "nearer"} <= reached


def test_a_click_moves_the_person_and_a_subject_is_taken_whole(springs_file, opened):
    page = opened(springs_file)
    box = page.locator("#map").bounding_box()
    page.mouse.click(box["x"] + 0.6 * box["width"], box["y"] + 0.3 * box["height"])
    rest(page)
    assert 1400 < float(page.input_value("#n-ankle_stiffness")) < 2000
    assert 1500 < float(page.input_value("#n-hip_stiffness")) < 2500
    page.select_option("#subject", label="Anna")
    rest(page)
    expect(page.locator("#n-ankle_stiffness")).to_have_value("700")
    expect(page.locator("#n-hip_stiffness")).to_have_value("350")


def test_dragging_and_the_wheel_move_the_window(springs_file, opened):
    page = opened(springs_file)
    box = page.locator("#map").bounding_box()
    x, y = box["x"] + 0.6 * box["width"], box["y"] + 0.4 * box["height"]
    page.mouse.move(x, y)
    page.mouse.wheel(0, -240)
    rest(page)
    wheeled = page.evaluate("location.hash")
    page.mouse.down()
    page.mouse.move(x - 60, y, steps=5)
    page.mouse.up()
    rest(page)
    assert "window=" in wheeled
    assert page.evaluate("location.hash") not in ("", wheeled)
    page.click("#whole")
    rest(page)
    assert page.evaluate("location.hash") == ""


def test_the_figure_moves_falls_and_stands_still_where_motion_is_unwanted(springs_file, opened):
    page = opened(springs_file, "ankle_stiffness=500", still=False)
    assert page.inner_text("#play") == "Pause"
    first = page.inner_html("#figure-of-person")
    page.wait_for_timeout(200)
    assert page.inner_html("#figure-of-person") != first
    assert "falls" in page.get_attribute("#figure-of-person", "class")
    page.click("#play")
    first = page.inner_html("#figure-of-person")
    page.wait_for_timeout(200)
    assert page.inner_html("#figure-of-person") == first
    still = opened(springs_file, "ankle_stiffness=501")
    assert still.inner_text("#play") == "Play"
    assert still.locator(".ghost").count() == 2


def test_what_is_taken_home(springs_file, opened):
    page = opened(springs_file, "quantity=critical_hip_stiffness&knee_stiffness=inf")
    with page.expect_download() as numbers:
        page.click("#numbers")
    lines = numbers.value.path().read_text(encoding="utf-8").splitlines()
    assert "# knee_stiffness = rigid" in lines
    assert "# gravity = 9.80665 m/s²" in lines
    heads = next(line for line in lines if not line.startswith("#"))
    assert heads.startswith("ankle_stiffness (N·m/rad),hip_stiffness (N·m/rad),critical_hip_stiff")
    at = lines.index(heads)
    assert len(lines) - at - 1 == 401 * 401
    ankle, hip, value = map(float, lines[at + 1 + 40_000].split(","))
    given = {"ankle_stiffness": ankle, "hip_stiffness": hip, "knee_stiffness": float("inf")}
    assert value == pytest.approx(expected("critical_hip_stiffness", **given), rel=1e-12)
    with page.expect_download() as person:
        page.click("#person")
    found = json.loads(person.value.path().read_text(encoding="utf-8"))
    assert found["given"]["knee_stiffness"] == "inf"
    assert found["found"]["safety_factor"] == pytest.approx(
        expected("safety_factor", knee_stiffness=float("inf")), rel=1e-12
    )
    names = [one.value.suggested_filename for one in (numbers, person)]
    assert names == [
        "standing-of-the-nominal-adult-critical-hip-stiffness.csv",
        "standing-of-the-nominal-adult-person.json",
    ]


def test_an_embedded_atlas_is_shown_and_its_sliders_snap(atlas_file, opened):
    page = opened(atlas_file)
    before = picture(page)
    slide(page, "knee_stiffness", 0)
    rest(page)
    expect(page.locator("#n-knee_stiffness")).to_have_value("600")
    assert picture(page) != before
    page.fill("#n-hip_stiffness", "530")
    page.press("#n-hip_stiffness", "Enter")
    expect(page.locator("#n-hip_stiffness")).to_have_value("400")
    assert "Height: 1.753 m (fixed)" in page.inner_text("#controls")
    page.select_option("#y", "knee_stiffness")
    rest(page)
    with page.expect_download() as numbers:
        page.click("#numbers")
    lines = numbers.value.path().read_text(encoding="utf-8").splitlines()
    kept = [line for line in lines if not line.startswith("#")][1:]
    # the rigid knee is not on the map
    assert len(kept) == 5 * 2
    assert kept[-1] == "3000,1200,1.3333333333333333"


MEASURED = {
    "gravity": 9.81,
    "body": {
        "segment_mass": {"shank": 6.5, "thigh": 15.0, "upper_body": [40.0, 55.0, 65.0]},
        "segment_inertia": [0.12, 0.29, 3.0],
        "segment_length": [0.43, 0.43],
        "segment_com": [0.245, 0.244, 0.356],
    },
    "stiffness": {"ankle": [800.0, 1000.0, 1400.0], "knee": 2000.0, "hip": [300.0, 500.0]},
    "output": {"quantities": ["safety_factor"]},
}


def test_sway_is_hidden_without_noise_and_an_exported_page_says_what_it_needs(springs_file, opened):
    page = opened(springs_file)
    assert not page.is_visible("#sway-box")
    page = opened(springs_file, "ankle_noise=1&quantity=cop_sway")
    assert "Nothing damps the person" in page.inner_text("#sway-words")
    assert "has no bounds" in page.inner_text("#word")
    page = opened(springs_file, "ankle_noise=1&ankle_damping=10&quantity=cop_sway")
    needs = "needs the program (standfast explore)."
    assert page.inner_text("#sway-words") == f"Sway {needs}"
    assert page.inner_text("#word") == f"The CoP sway {needs}"
    page = opened(springs_file, "hip_noise=1&hip_stiffness=inf&y=knee_stiffness&quantity=cop_sway")
    assert not page.is_visible("#sway-box")
    assert page.inner_text("#word") == "The CoP sway is of noise: set a noise of the torques."


def test_segments_of_ones_own_may_be_axes_of_an_atlas(tmp_path, opened):
    atlas = sf.sweep(MEASURED, tmp_path / "own.h5")
    assert main(["explore", str(atlas.path), "--export", str(tmp_path / "own.html")]) == 0
    page = opened(
        tmp_path / "own.html", "upper_body_mass=65&ankle_stiffness=1000&hip_stiffness=500"
    )
    stored = float(atlas["safety_factor"][2, 1, 1])
    assert atlas["safety_factor"].dims[0] == "upper_body_mass"
    assert table(page)["Safety factor"] == pytest.approx(stored, rel=SHOWN_DIGITS)
