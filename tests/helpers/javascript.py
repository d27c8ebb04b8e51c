"""Runs a module of JavaScript with numbers from here, in node or else in Chromium."""

import base64
import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from browser import executable

# A script is the body of a function of the module ``F`` and of ``given``, whose arrays of float64
# are there as Float64Array; it returns an object of them.
COMMON = """
const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
const given = {};
for (const [name, text] of Object.entries(data)) given[name] = new Float64Array(bytes(text).buffer);
const found = new Function("F", "given", script)(F, given);
const answer = {};
for (const [name, values] of Object.entries(found)) {
  let text = "";
  const all = new Uint8Array(Float64Array.from(values).buffer);
  for (const byte of all) text += String.fromCharCode(byte);
  answer[name] = btoa(text);
}
"""
NODE = f"""
import {{ readFileSync }} from "node:fs";
import * as F from "./formulas.mjs";
const {{ script, data }} = JSON.parse(readFileSync(0, "utf8"));
{COMMON}
process.stdout.write(JSON.stringify(answer));
"""
CHROMIUM = f"""
async ([module, script, data]) => {{
  const url = URL.createObjectURL(new Blob([module], {{ type: "text/javascript" }}));
  const F = await import(url);
  {COMMON}
  return answer;
}}
"""


def run(folder: Path, module: str, script: str, **given: np.ndarray) -> dict[str, np.ndarray]:
    """Run a script beside a module; arrays go and come as their bytes."""
    data = {
        name: base64.b64encode(np.ascontiguousarray(values, "<f8").tobytes()).decode()
        for name, values in given.items()
    }
    if node := shutil.which("node"):
        (folder / "formulas.mjs").write_text(module)
        (folder / "run.mjs").write_text(NODE)
        asked = json.dumps({"script": script, "data": data})
        done = subprocess.run(
            [node, "run.mjs"], cwd=folder, input=asked, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        answer = json.loads(done.stdout)
    else:
        answer = _in_chromium(module, script, data)
    return {name: np.frombuffer(base64.b64decode(text)) for name, text in answer.items()}


def _in_chromium(module: str, script: str, data: dict[str, str]) -> Any:
    playwright = pytest.importorskip("playwright.sync_api", reason="neither node nor Playwright")
    browser = executable()
    if browser is None:
        pytest.skip("no engine of JavaScript: neither node nor Chromium")
    with playwright.sync_playwright() as started:
        opened = started.chromium.launch(
            executable_path=browser, args=["--no-sandbox", "--disable-gpu"]
        )
        answer = opened.new_page().evaluate(CHROMIUM, [module, script, data])
        opened.close()
    return answer
