"""The files of real people, ANSUR II and NHANES 2017-2018, which are not part of the project.

They lie in the folder that the environment variable ``STANDFAST_PEOPLE`` names, or in
``shared/data/people`` beside the checkout. Checks that need them skip where they are absent.
"""

import os
from pathlib import Path

import pytest

DATA = Path(os.environ.get("STANDFAST_PEOPLE", Path(__file__).parents[3] / "shared/data/people"))
NHANES = [DATA / "BMX_J.csv", DATA / "DEMO_J.csv"]
needs_people = pytest.mark.skipif(not DATA.is_dir(), reason="the files of real people are absent")
