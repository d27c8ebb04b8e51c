"""Pictures of the page of ``standfast explore``, to be looked at: results/explore/*.png.

Run as ``python benchmarks/screenshots.py`` (a minute).
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from playwright.sync_api import sync_playwright

import standfast as sf
from explore import ARGUMENTS, found_browser, opened, ran
from harness import ROOT

FOLDER = ROOT / "results" / "explore"
SEVEN: dict[str, Any] = {
    "title": "Seven axes",
    "gravity": [1.62, 9.81],
    "body": {
        "model": ["winter", "de-leva-female"],
        "height": [1.5, 1.65, 1.8],
        "mass": [50, 70, 90],
    },
    "stiffness": {
        "ankle": {"start": 0, "stop": 2000, "num": 41},
        "knee": [1000, 2000, float("inf")],
        "hip": {"start": 50, "stop": 2000, "num": 30, "spacing": "log"},
    },
    "output": {"quantities": ["stable", "safety_factor", "critical_ankle_stiffness"]},
}
WIDE, NARROW = (1400, 1180), (390, 844)
# Of each picture: whether of the atlas, the state, the size, whether dark.
PICTURES = {
    "wide": (False, "", WIDE, False),
    "narrow": (False, "", NARROW, False),
    "dark": (False, "", WIDE, True),
    "falls": (False, "ankle_stiffness=600&hip_stiffness=300&quantity=frequency", WIDE, False),
    "rigid-knee": (False, "knee_stiffness=inf&quantity=critical_ankle_stiffness", WIDE, False),
    "seven-axes": (True, "quantity=safety_factor", WIDE, False),
}


def main() -> None:
    """Take the pictures."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as folder, sync_playwright() as playwright:
        adult, seven, atlas = (Path(folder) / name for name in ("a.html", "s.html", "s.h5"))
        ran("--export", str(adult))
        sf.sweep(sf.Study.from_dict(SEVEN), atlas)
        ran(str(atlas), "--export", str(seven))
        browser = playwright.chromium.launch(executable_path=found_browser(), args=ARGUMENTS)
        for name, (of_atlas, state, (width, height), dark) in PICTURES.items():
            page = browser.new_page(
                viewport={"width": width, "height": height},
                color_scheme="dark" if dark else "light",
            )
            opened(page, (seven if of_atlas else adult).as_uri(), state)
            page.screenshot(path=FOLDER / f"{name}.png", full_page=True)
            page.close()
            print(FOLDER / f"{name}.png")
        browser.close()


if __name__ == "__main__":
    main()
