"""What is released beside the package: man page, recipe, image; and what is to be filled in."""

import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

import standfast
from standfast.cli.app import build_parser

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
# What conda calls otherwise.
CONDA = {"isal": "python-isal", "matplotlib": "matplotlib-base"}
# Where RELEASE.md sends the owners, and where nobody else should leave something open.
OPEN = {
    "CITATION.cff",
    "CODE_OF_CONDUCT.md",
    "RELEASE.md",
    "SUPPORT.md",
    "conda/recipe.yaml",
    "paper/paper.md",
    "pyproject.toml",
}


def commands():
    (action,) = (a for a in build_parser()._actions if isinstance(a.choices, dict))
    return action.choices


@pytest.mark.parametrize("name", commands())
def test_every_command_has_an_example_that_it_would_read(name):
    """The epilog's first line is a line of this command, and the parser takes it."""
    (example,) = re.findall(r"^example: standfast (.*)$", commands()[name].epilog, re.MULTILINE)
    words = example.split(" >")[0].split()
    assert words[0] == name
    assert build_parser().parse_args(words).command == name


@pytest.fixture(scope="module")
def man_page(tmp_path_factory):
    """The page as ``make man`` makes it."""
    lines = (ROOT / "Makefile").read_text("utf-8")
    (recipe,) = re.findall(r"argparse-manpage (.*?)\n\n", lines.replace("\\\n", " "), re.DOTALL)
    page = tmp_path_factory.mktemp("man") / "standfast.1"
    words = recipe.split("--output")[0].split()
    program = "from argparse_manpage.cli import main; main()"
    subprocess.run([sys.executable, "-c", program, *words, "--output", page], check=True)
    return page


def test_the_man_page_is_set_without_a_warning(man_page):
    if (groff := shutil.which("groff")) is None:
        pytest.skip("groff is not at hand")
    command = [groff, "-man", "-Tutf8", "-K", "utf8", "-ww", "-rLL=80n", man_page]
    done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=True)
    assert done.stderr == ""
    text = re.sub(r"\x1b\[[\d;]*m", "", done.stdout)
    for name in commands():
        assert f"standfast {name}" in text
    page = man_page.with_name("wrong.1")
    page.write_text(man_page.read_text("utf-8") + ".NO_SUCH_MACRO\n", encoding="utf-8")
    done = subprocess.run([*command[:-1], page], capture_output=True, text=True, check=True)
    assert "NO_SUCH_MACRO" in done.stderr


def recipe():
    """The conda recipe, with what its context says filled in."""
    text = (ROOT / "conda" / "recipe.yaml").read_text("utf-8")
    for name, value in yaml.safe_load(text)["context"].items():
        text = text.replace(f"${{{{ {name} }}}}", value)
    return yaml.safe_load(text)


def by_condas_names(requirements):
    """Return ``name >=version`` of requirements as pip writes them."""
    pairs = (re.fullmatch(r"([\w-]+)(.*)", each).groups() for each in requirements)
    return {f"{CONDA.get(name, name)} {version}" for name, version in pairs}


def test_the_recipe_needs_what_the_package_needs():
    found = recipe()
    needed = {f"python {PROJECT['requires-python']}"} | by_condas_names(PROJECT["dependencies"])
    on_posix = {"__unix"}  # as a classifier of the project says
    assert set(found["requirements"]["run"]) == needed | on_posix
    assert any("POSIX" in classifier for classifier in PROJECT["classifiers"])
    assert found["package"]["version"] == standfast.__version__
    assert found["about"]["license"] == PROJECT["license"]
    assert found["about"]["summary"] == PROJECT["description"]
    (script,) = found["build"]["python"]["entry_points"]
    assert script == f"standfast = {PROJECT['scripts']['standfast']}"
    assert by_condas_names(["isal>=1.7", "rich>=13"]) == {"python-isal >=1.7", "rich >=13"}


def test_the_recipe_is_read_by_the_tool_that_builds_it(tmp_path):
    """Keys that the format does not have are refused, and variables that nothing gives."""
    rattler_build = pytest.importorskip("rattler_build", reason="py-rattler-build is not at hand")
    reading, variants = rattler_build.Stage0Recipe.from_file, rattler_build.VariantConfig()
    (rendered,) = reading(ROOT / "conda" / "recipe.yaml").render(variants)
    assert rendered.recipe.package.version == standfast.__version__
    text = (ROOT / "conda" / "recipe.yaml").read_text("utf-8")
    for right, wrong in (("entry_points:", "entrypoints:"), ("{ python_min }", "{ python_mn }")):
        path = tmp_path / "recipe.yaml"
        path.write_text(text.replace(right, wrong), encoding="utf-8")
        with pytest.raises(rattler_build.RattlerBuildError):
            reading(path).render(variants)


def test_the_image_is_given_what_it_needs():
    """All that the Dockerfile copies is sent, and nothing else; all of it is there."""
    lines = (ROOT / "Dockerfile").read_text("utf-8").splitlines()
    copied = {name for line in lines if line.startswith("COPY") for name in line.split()[1:-1]}
    ignored = (ROOT / ".dockerignore").read_text("utf-8").splitlines()
    assert {line[1:] for line in ignored if line.startswith("!")} == copied
    assert all((ROOT / name).exists() for name in copied)
    assert {"CITATION.cff", "README.md", "hatch_build.py"} <= copied  # the wheel is made of them


def test_the_version_stands_in_one_place():
    """And in the recipe, which is to be sent alone; its test above compares it."""
    assert PROJECT["dynamic"] == ["version"]
    written = re.compile(rf"\b{re.escape(standfast.__version__)}\b")
    for name in ("pyproject.toml", "CITATION.cff", "Makefile"):
        assert not written.search((ROOT / name).read_text("utf-8")), name


def test_what_only_owners_know_is_marked_and_listed():
    texts = [*ROOT.glob("*.md"), *ROOT.glob("*.toml"), *ROOT.glob("*.cff")]
    texts += [*ROOT.glob("conda/*"), *ROOT.glob("paper/*"), *ROOT.glob("docs/*.md")]
    marked = {p.relative_to(ROOT).as_posix() for p in texts if b"FILL IN" in p.read_bytes()}
    assert marked == OPEN
    listed = (ROOT / "RELEASE.md").read_text("utf-8")
    assert all(f"`{name}`" in listed for name in OPEN - {"RELEASE.md"})
