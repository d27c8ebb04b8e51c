"""The documentation: ``make docs`` builds it into ``docs/_build/html``, without a network."""

import os
import sys
from pathlib import Path

from sphinx.application import Sphinx

import standfast as sf

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))
# What notebooks and commands of the pages start is the command of this environment.
os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
os.environ["COLUMNS"] = "80"
# Kernels of notebooks have settings of their own, not those of whoever builds.
SETTINGS = HERE / "_build" / "ipython"
SETTINGS.joinpath("profile_default").mkdir(parents=True, exist_ok=True)
SETTINGS.joinpath("profile_default", "ipython_kernel_config.py").write_text(
    "c.IPKernelApp.log_level = 40\n"  # that it listens on this machine alone goes without saying
)
SETTINGS.joinpath("profile_default", "startup").mkdir(exist_ok=True)
SETTINGS.joinpath("profile_default", "startup", "commands.py").write_text(
    (HERE / "_ext" / "kernel_commands.py").read_text("utf-8"), "utf-8"
)
os.environ["IPYTHONDIR"] = str(SETTINGS)

project = "standfast"
author = "the authors of standfast"
project_copyright = author
version = release = sf.__version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "sphinx_copybutton",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    "cells",
    "command_help",
    "explorer_page",
    "mathml",
    "outside",
    "site_check",
    "tables",
]
exclude_patterns = ["_build", "gallery_source", "gallery/*.ipynb", "gallery/*.py"]
nitpicky = True
# What other projects document is on other hosts; the site is built and read without a network.
OTHERS = "numpy|np|jax|xarray|matplotlib|collections|concurrent|pathlib|typing|os"
BUILT_IN = "array_like|bool|callable|complex|dict|float|int|list|mapping|object|str|tuple|None"
nitpick_ignore_regex = [("py:.*", rf"({OTHERS})\..*"), ("py:.*", rf"({BUILT_IN}|\w+Error)")]
copybutton_prompt_text = r"\$ |>>> |\.\.\. "
copybutton_prompt_is_regexp = True

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
myst_update_mathjax = False
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_in_temp = True
nb_execution_timeout = 120
nb_merge_streams = True

autosummary_generate = True
autodoc_typehints = "none"  # what arguments are, their descriptions say
autodoc_member_order = "bysource"
python_maximum_signature_line_length = 72
numpydoc_show_class_members = False

html_math_renderer = "mathml"

sphinx_gallery_conf = {
    "examples_dirs": "gallery_source",
    "gallery_dirs": "gallery",
    "filename_pattern": r"/draw_",
    "ignore_pattern": r"/_",
    "download_all_examples": False,
    "remove_config_comments": True,
    "capture_repr": (),
    "show_memory": False,
    "show_signature": False,
    "min_reported_time": 1e9,
    "write_computation_times": False,
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "reset_modules": ("matplotlib", "gallery_files.remove"),
    "reset_modules_order": "both",
}

html_theme = "pydata_sphinx_theme"
html_favicon = "_static/favicon.svg"
html_context = {"default_mode": "auto"}
html_title = f"standfast {release}"
templates_path = ["_templates"]
html_static_path = ["_static"]
html_css_files = ["standfast.css"]
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {
    "show_prev_next": True,
    "show_toc_level": 2,
    "navigation_with_keys": False,
    "navbar_align": "left",
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": ["sphinx-version"],
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}
html_sidebars = {"index": [], "live": [], "tutorial": []}


# What runs and files ask of studies; no program of a user calls it.
MACHINERY = {
    "block_persons",
    "block_size",
    "blocks_per_replicate",
    "check_size",
    "from_canonical",
    "grid",
    "has_gains",
    "has_one_joint",
    "per_replicate",
    "replicates",
    "shard_count",
    "shards",
}


def skip(app: Sphinx, what: str, name: str, each: object, skipped: bool, options: object) -> bool:
    """Leave out the fields of named tuples, which the class itself explains, and machinery."""
    return skipped or type(each).__name__ == "_tuplegetter" or name in MACHINERY


def setup(app: Sphinx) -> None:
    """Let the reference leave out what explains nothing."""
    app.connect("autodoc-skip-member", skip)
