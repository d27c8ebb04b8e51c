"""The page's formulas, run by an engine of JavaScript, against our functions run by NumPy."""

import re

import numpy as np
import pytest

from explore_people import bodies_of, in_numpy, one_free_joint, people, person_of
from javascript import run
from standfast.explore.formulas import SLOTS, formulas_module
from standfast.parameters import COUPLINGS, OWN_BODY, STIFFNESSES
from standfast.quantities import QUANTITIES
from standfast.quantities.of_feedback import joint_of
from standfast.stability.delay import one_joint

PEOPLE = 5000  # of each kind
# Both sides do the same operations; what differs by a rounding is NumPy's power of 3, which JAX and
# the page multiply, and hypot. Vectors differ by that much, and so do their small entries.
SAME = 1e-12
# On the threshold itself springs and gravity cancel to the last of 79 bits: of 1e3 N·m/rad, 1e-20.
NOTHING = {
    "stiffness_reserve": 1e-20,
    "eigenvalue_1": 1e-20,
    "frequency": 1e-14,
    "growth_rate": 1e-14,
}
TO_THE_BIT = {
    "stable", "stability_determinant",
    *(f"critical_{joint}_stiffness" for joint in ("ankle", "knee", "hip")),
}  # fmt: skip
MOSTLY = 0.85  # of persons are the others the same to the bit too: 0.87 to 0.9998
# A fast way is promised to 5e-13 and to 2e-13 for what its estimate leaves out.
FAST = 1e-12
AT = """
const n = given.rows.length / F.slotCount, answer = { body: [], modes: [] };
const sets = { ...F.springs };
for (const name in F.oneJoint) sets["one_joint_" + name] = F.oneJoint[name];
for (const name in sets) answer[name] = [];
for (let k = 0; k < n; k++) {
  const p = given.rows.slice(k * F.slotCount, (k + 1) * F.slotCount);
  for (const name in sets) answer[name].push(sets[name].at(p));
  answer.body.push(...F.bodyAt(p));
  answer.modes.push(...F.modesAt(p));
}
return answer;
"""


@pytest.fixture(scope="module")
def module():
    return formulas_module()


def off_by(name, found, right):
    """The largest difference, of rotations as an angle; and the share that is the same."""
    same = (found == right) | (np.isnan(found) & np.isnan(right))
    with np.errstate(invalid="ignore"):
        if name == "modes" or name.endswith("_ratio"):
            off = abs(np.arctan(found) - np.arctan(right))
        else:
            off = abs(found - right) / np.maximum(abs(found), abs(right))
        off[abs(found - right) <= NOTHING.get(name, 0.0)] = 0.0
    off[same] = 0.0
    return np.where(np.isnan(off), np.inf, off).max(), same.mean()


@pytest.mark.parametrize("coupled", [False, True])
def test_what_the_page_computes_is_what_we_compute(module, tmp_path, coupled):
    rows = people(PEOPLE, coupled=coupled, seed=14)
    found = run(tmp_path, module, AT, rows=rows)
    right = in_numpy(rows, coupled=coupled)
    assert (found["body"] == bodies_of(rows).T.ravel()).all()
    assert (found["stable"] == right["stable"]).all()
    assert 0.1 < right["stable"].mean() < 0.9
    for name, values in right.items():
        off, same = off_by(name, found[name], values)
        assert off < SAME, name
        assert same == 1.0 if name in TO_THE_BIT else same > MOSTLY, name


def test_one_free_joint_is_as_in_closed_form(module, tmp_path):
    rows = one_free_joint(2000, seed=5)
    found = run(tmp_path, module, AT, rows=rows)
    person = person_of(rows, coupled=False)
    delay = rows[:, SLOTS["feedback_delay"]]
    right = {n: q.of_one_joint(person) for n, q in QUANTITIES.items() if q.of_one_joint}
    right["stable"] = one_joint.stands(joint_of(person), delay)
    assert 0.1 < right["stable"].mean() < 0.9
    for name in ("stable", "unstable_roots"):
        assert (found[f"one_joint_{name}"] == right[name]).all(), name
    for name in ("critical_delay", "delay_margin"):
        both = found[f"one_joint_{name}"], right[name]
        np.testing.assert_allclose(*both, rtol=SAME, atol=SAME, err_msg=name)


@pytest.mark.parametrize(
    "edit", [("/ (1 - ", "/ (1.000000001 - "), ("(words[0] & ~low)", "0")], ids=["a load", "pairs"]
)
def test_another_formula_would_be_noticed(module, tmp_path, edit):
    broken = module.replace(*edit)
    assert broken != module
    rows = people(300, coupled=False, seed=3)
    found = run(tmp_path, broken, AT, rows=rows)
    right = in_numpy(rows, coupled=False)
    assert max(off_by(name, found[name], values)[0] for name, values in right.items()) > SAME


PLANES = """
const answer = {}, { p, values, slots } = given, out = new Float64Array(13 * 8);
for (let k = 0; k < slots.length / 2; k++) {
  const [xSlot, ySlot] = slots.slice(2 * k);
  const xs = values.slice(21 * k, 21 * k + 13), ys = values.slice(21 * k + 13, 21 * k + 21);
  for (const name in F.springs) {
    const before = p.slice(), at = [];
    F.springs[name].plane(p, xSlot, xs, ySlot, ys, out);
    if (p.some((v, n) => !Object.is(v, before[n]))) throw new Error("p has changed");
    for (const y of ys) for (const x of xs) {
      const q = p.slice();
      q[xSlot] = x;
      q[ySlot] = y;
      at.push(F.springs[name].at(q));
    }
    answer[`${name} ${k} plane`] = out.slice();
    answer[`${name} ${k} at`] = at;
  }
}
return answer;
"""
SPANS = {
    "height": (1.3, 2.1), "bmi": (15.0, 40.0), "gravity": (1.0, 15.0),
    "reference_shank_mass": (3.0, 9.0),
    **dict.fromkeys(STIFFNESSES, (0.0, 3000.0)), **dict.fromkeys(COUPLINGS, (-200.0, 200.0)),
}  # fmt: skip
AXES = [
    ("ankle_stiffness", "knee_stiffness"), ("hip_stiffness", "ankle_stiffness"),
    ("knee_stiffness", "hip_stiffness"), ("height", "hip_stiffness"),
    ("ankle_stiffness", "gravity"), ("height", "gravity"), ("knee_stiffness", "bmi"),
    ("bmi", "reference_shank_mass"), ("ankle_hip_stiffness", "ankle_stiffness"),
    ("gravity", "knee_hip_stiffness"), ("feedback_delay", "hip_stiffness"),
    ("feedback_delay", "ankle_damping"),
]  # fmt: skip


def values_on(name, count):
    """Values of an axis; one of stiffness ends rigid."""
    values = np.linspace(*SPANS.get(name, (0.0, 1.0)), count)
    if name in STIFFNESSES:
        values[-1] = np.inf
    return values


@pytest.mark.parametrize("kind", ["springs", "a rigid knee", "coupled"])
def test_a_plane_is_its_points(module, tmp_path, kind):
    p = people(60, coupled=kind == "coupled", seed=8)[7]
    p[[SLOTS[name] for name in STIFFNESSES]] = 1100.0, 2000.0, 700.0
    p[[SLOTS["by_bmi"], SLOTS["bmi"]]] = 1.0, 24.0
    if kind == "a rigid knee":
        p[SLOTS["knee_stiffness"]] = np.inf
    slots = np.array([SLOTS[name] for axes in AXES for name in axes], float)
    values = np.concatenate([[*values_on(x, 13), *values_on(y, 8)] for x, y in AXES])
    found = run(tmp_path, module, PLANES, p=p, values=values, slots=slots)
    stable = np.array([found[f"stable {k} plane"] for k in range(len(AXES))])
    assert 0.1 < stable.mean() < 0.9
    for k, axes in enumerate(AXES):
        coupling = set(axes) & set(COUPLINGS)  # where it is 0 a point has the other functions
        for name in (name for name, row in QUANTITIES.items() if row.reference is not None):
            allowed = FAST if QUANTITIES[name].fast else SAME if coupling else 0.0
            off, _ = off_by(name, found[f"{name} {k} plane"], found[f"{name} {k} at"])
            assert off <= allowed, (name, axes)


def test_the_module_names_all_slots_and_quantities(module, tmp_path):
    script = """
    return { count: [F.slotCount], places: Object.values(F.slots),
             springs: Object.keys(F.springs).map((n) => given.names.length && n.length) };"""
    found = run(tmp_path, module, script, names=np.zeros(1))
    assert found["count"] == len(SLOTS)
    assert list(found["places"]) == list(range(len(SLOTS)))
    rows = [n for n, row in QUANTITIES.items() if row.reference is not None and not row.own]
    assert list(found["springs"]) == [len(name) for name in rows]
    assert {f"reference_{name}" for name in OWN_BODY} < set(SLOTS)
    assert len(module.encode()) < 400_000


def test_what_functions_share_finds_room():
    text = formulas_module()
    size = int(re.search(r"const found = new Float64Array\((\d+)\);", text)[1])
    places = [int(place) for place in re.findall(r"\bfound\[(\d+)\]", text)]
    assert size == max(places) + 1
