"""Symbols write down what is computed; an engine of JavaScript finds the bits that NumPy finds."""

import numpy as np
import pytest

from javascript import run
from standfast.explore.javascript import HELPERS, Lines, apart, literal
from standfast.explore.recording import ON_NUMBERS, TO_TRUTH, Record
from standfast.numerics.arrays import namespace
from standfast.numerics.pairs import product

MASK = -(1 << 27)
SPECIAL = [0.0, -0.0, 1.0, -1.0, np.inf, -np.inf, np.nan, 5e-324, 1e308, -1e308, 1e-160, 0.1]
NUMBERS = np.array([*SPECIAL, *np.random.default_rng(2).uniform(-9.0, 9.0, 40)])
X, Y = (each.ravel() for each in np.meshgrid(NUMBERS, NUMBERS))
# The C library's and the engine's own, each good to a unit or so of the last digit.
WITHIN = {"cos": 4e-16, "sin": 4e-16, "arctan2": 4e-16, "hypot": 2.3e-16}
FORMULAS = {
    **{
        name: (lambda xp, x, y, name=name, f=function: xp.apply(name, *(x, y)[: f.nin]), function)
        for name, function in {**ON_NUMBERS, **TO_TRUTH}.items()
        if name != "masked"
    },
    "masked": (
        lambda xp, x, y: (x.view(xp.int64) & np.int64(MASK)).view(xp.float64),
        lambda x: (x.view(np.int64) & np.int64(MASK)).view(np.float64),
    ),
    "square": (lambda xp, x, y: x**2, lambda x: x * x),
    "cube": (lambda xp, x, y: x**3, lambda x: x * (x * x)),
    "mixed": (lambda xp, x, y: 3.0 - -x * (y - 2.0) / 0.7, lambda x, y: 3.0 - -x * (y - 2.0) / 0.7),
    "where": (
        lambda xp, x, y: xp.where((x > y) & ~(y == 1.0) | xp.isnan(x), x - y, -0.0),
        lambda x, y: np.where((x > y) & ~(y == 1.0) | np.isnan(x), x - y, -0.0),
    ),
    "of truths": (
        lambda xp, x, y: 1 * (x > 0.0) + 1 * (y > 0.0) == 1,
        lambda x, y: 1 * (x > 0.0) + 1 * (y > 0.0) == 1,
    ),
    "clip": (lambda xp, x, y: xp.clip(x, -1.0, 2.0), lambda x: np.clip(x, -1.0, 2.0)),
    "signed by a constant": (
        lambda xp, x, y: xp.copysign(xp.inf, x),
        lambda x: np.copysign(np.inf, x),
    ),
}
SCRIPT = """
const answer = {};
for (const [name, formula] of Object.entries(F.formulas))
  answer[name] = given.x.map((x, k) => Number(formula(x, given.y[k])));
return answer;
"""


def printed(formula):
    record = Record()
    lines = Lines(lambda name: name)
    (text,) = lines.compute([formula(record, record.slot("x"), record.slot("y"))])
    body = "\n".join(lines.lines)
    return f"(x, y) => {{\n{body}\n  return {text};\n}}"


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    texts = ",\n".join(f'"{name}": {printed(formula)}' for name, (formula, _) in FORMULAS.items())
    module = f"{HELPERS}\nexport const formulas = {{\n{texts}\n}};\n"
    return run(tmp_path_factory.mktemp("symbols"), module, SCRIPT, x=X, y=Y)


@pytest.mark.parametrize("name", FORMULAS)
def test_javascript_has_the_bits_of_numpy(found, name):
    function = FORMULAS[name][1]
    count = getattr(function, "nin", None) or function.__code__.co_argcount
    with np.errstate(all="ignore"):
        right = np.asarray(function(*(X, Y)[:count]), float)
    if name in WITHIN:
        np.testing.assert_allclose(found[name], right, rtol=WITHIN[name], atol=0.0)
        return
    both_nan = np.isnan(found[name]) & np.isnan(right)
    # which zero is the smaller one NumPy leaves open; the sign of NaN JavaScript does
    free = both_nan | np.isnan(Y) if name == "copysign" else both_nan
    if name in ("minimum", "maximum", "clip"):
        free |= (found[name] == 0.0) & (right == 0.0)
    same = found[name].view(np.int64) == right.view(np.int64)
    assert (same | free).all(), (X[~same & ~free], Y[~same & ~free])


def test_what_is_known_is_computed_at_once():
    record = Record()
    for name in {**ON_NUMBERS, **TO_TRUTH}.keys() - {"masked"}:
        function = {**ON_NUMBERS, **TO_TRUTH}[name]
        for x, y in zip(X[:300], Y[:300], strict=True):
            args = (x, y)[: function.nin]
            folded = record.apply(name, *map(float, args))
            with np.errstate(all="ignore"):
                right = function(*args)
            assert folded.op == "constant"
            assert literal(folded.value.item()) == literal(right.item()), (name, x, y)


def test_what_is_written_twice_is_computed_once():
    record = Record()
    x, y = record.slot("x"), record.slot("y")
    assert (x + y) * 2.0 is 2.0 * (y + x)
    assert x - y is not y - x
    assert record.constant(0.0) is not record.constant(-0.0)
    assert product(x, y)[0] is product(x, y)[0]


def test_only_what_changes_no_bit_is_left_out():
    record = Record()
    x = record.slot("x")
    assert x * 1.0 is x
    assert x / 1.0 is x
    assert x - 0.0 is x
    assert x + 0.0 is not x  # −0 becomes 0
    assert (x * 0.0).op == "*"  # inf and NaN
    assert record.where(True, x, 1.0) is x


def test_arrays_of_symbols_are_taken_apart_as_numpy_does():
    record = Record()
    rows = [[record.slot(f"m{i}{j}") for j in range(2)] for i in range(3)]
    matrix = namespace(rows[0][0]).stack([record.stack(row) for row in rows], axis=-1)
    assert matrix.shape == (2, 3)
    assert matrix[1, 2] is rows[2][1]
    assert [symbol.name for row in matrix.T for symbol in row] == [
        f"m{i}{j}" for i in range(3) for j in range(2)
    ]
    assert (2.0 * matrix)[0, 1] is rows[1][0] * 2.0


def test_a_symbol_does_not_decide():
    record = Record()
    x = record.slot("x")
    with pytest.raises(TypeError, match="no value yet"):
        bool(x > 0.0)
    with pytest.raises(TypeError, match="whole numbers"):
        x**0.5
    with pytest.raises(TypeError, match="truth values"):
        x & (x > 0.0)


def test_what_hangs_on_no_axis_stands_apart():
    record = Record()
    x, y = record.slot("x"), record.slot("y")
    before = y * y + 1.0
    assert apart([before * x - before], x.depends) == [before]
