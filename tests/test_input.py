"""What a person gets who gives a wrong value: one sentence with name, value and allowed range."""

import inspect
from decimal import Decimal

import numpy as np
import pytest

import standfast as sf
from standfast.mechanics.feedback import checked_damping, checked_feedback

NOMINAL = sf.Body.edwards2007()
STIFF = sf.Stiffness(950.0, 2000.0, 738.0)
NAN = float("nan")
ANY = {"ankle": 900, "knee": 1500, "hip": 400}
MODELS = "(models: edwards2007, winter, de-leva-male, de-leva-female)"

WRONG = [
    (
        lambda: sf.Body.from_height_mass(175, 80),
        "height = 175 is outside the allowed range, 0.5 to 2.8 m; "
        "175 looks like centimetres, write 1.75",
    ),
    (
        lambda: sf.Body.from_height_mass(1753, 80),
        "height = 1753 is outside the allowed range, 0.5 to 2.8 m; "
        "1753 looks like millimetres, write 1.753",
    ),
    (
        lambda: sf.Body.from_height_mass(1.75, 80000),
        "mass = 80000 is outside the allowed range, 2 to 650 kg; 80000 looks like grams, write 80",
    ),
    (
        lambda: sf.Body.from_height_mass(1.75, -80),
        "mass = -80 is outside the allowed range, 2 to 650 kg",
    ),
    (
        lambda: sf.Body.from_height_mass(NAN, 80),
        "height is NaN (not a number); give 0.5 to 2.8 m",
    ),
    (
        lambda: sf.Body.from_height_mass("1.75", 80),
        "height = '1.75' is text; give a number, 0.5 to 2.8 m",
    ),
    (
        lambda: sf.Body.from_height_mass(1.75, None),
        "mass is None; give one number, 2 to 650 kg, or map over many with jax.vmap",
    ),
    (
        lambda: sf.Body.from_height_mass(True, 80),
        "height = True is of type bool; give a number, 0.5 to 2.8 m",
    ),
    (
        lambda: sf.Body.from_height_mass(1.75, 80, "wintr"),
        f"body_model = 'wintr' is not known; did you mean 'winter'? {MODELS}",
    ),
    (
        lambda: sf.Body.from_height_mass(1.75, 80, 7),
        f"body_model = 7 is not known {MODELS}",
    ),
    (
        lambda: sf.Stiffness(-1.0, 2000, 738),
        "ankle_stiffness = -1 is outside the allowed range, "
        "0 to 1e+12 N·m/rad, or inf for a rigid joint",
    ),
    (
        lambda: sf.Stiffness(950, NAN, 738),
        "knee_stiffness is NaN (not a number); give 0 to 1e+12 N·m/rad, or inf for a rigid joint",
    ),
    (
        lambda: sf.Stiffness(950, 2000, "rigid"),
        "hip_stiffness = 'rigid' is text; give a number, "
        "0 to 1e+12 N·m/rad, or inf for a rigid joint",
    ),
    (
        lambda: sf.is_stable(NOMINAL, sf.Stiffness(np.arange(3.0), 2000, 738)),
        "ankle_stiffness is an array of shape (3,); give one number, "
        "0 to 1e+12 N·m/rad, or inf for a rigid joint, or map over many with jax.vmap",
    ),
    (
        lambda: sf.modes(NOMINAL, sf.Stiffness(None, 2000, 738)),
        "ankle_stiffness is None; give one number, "
        "0 to 1e+12 N·m/rad, or inf for a rigid joint, or map over many with jax.vmap",
    ),
    (
        lambda: sf.Stiffness(None, 1, 1),
        "ankle_stiffness is None; give one number, "
        "0 to 1e+12 N·m/rad, or inf for a rigid joint, or map over many with jax.vmap",
    ),
    (
        lambda: sf.Body.from_height_mass(1.7, 680),
        "mass = 680 is outside the allowed range, 2 to 650 kg; is a decimal point missing, 68?",
    ),
    (
        lambda: sf.Body.from_height_mass(1.7, 640),
        "mass = 640 at a height of 1.7 m is a BMI of 221.5, outside the allowed range, "
        "5 to 210 kg/m²",
    ),
    (
        lambda: sf.Study.from_dict({"body": {"height": [1.2, 1.7], "mass": 500}, "stiffness": ANY}),
        "body.mass = 500 at a height of 1.2 m is a BMI of 347.2, outside the allowed range, "
        "5 to 210 kg/m²",
    ),
    (
        lambda: sf.Study.from_dict(
            {"body": NOMINAL, "stiffness": {**ANY, "hip": {"start": 1, "stop": 9, "step": 2}}}
        ),
        "stiffness.hip has a step; a range has the number of its values instead: "
        "{ start = …, stop = …, num = … }",
    ),
    (
        lambda: sf.sweep(None, "a.h5"),
        "study = None is no study of a sweep; give a Study, the path of a study file, or its "
        "content as a dict",
    ),
    (
        lambda: sf.simulate(5, "a.h5"),
        "study = 5 is no study of a population; give a PopulationStudy, the path of a study file, "
        "or its content as a dict",
    ),
    (lambda: sf.sweep("no.toml", "a.h5"), "no.toml: there is no such study file"),
    (lambda: sf.simulate("no.toml", "a.h5"), "no.toml: there is no such study file"),
    (
        lambda: sf.simulate({"title": "x"}, "a.h5"),
        "[population] is missing: say people or builtin, and size",
    ),
    (lambda: sf.sweep("no.toml", None), "output = None is not the name of a file"),
    (lambda: sf.Study.from_toml(None), "study = None is not the name of a file"),
    (lambda: sf.open_atlas(3), "path = 3 is not the name of a file"),
    (
        lambda: sf.sweep({}, "a.h5", threads="two"),
        "threads = 'two' is not a number of threads; give 1 or more",
    ),
    (lambda: sf.sweep({}, "a.h5", part=3), "part = 3 is not a share; give (i, N)"),
    (
        lambda: sf.inertia_matrix(None),
        "body = None is not a Body; make one with Body.from_height_mass or Body.edwards2007, "
        "or of measured segments with Body(segment_mass=…, …)",
    ),
    (
        lambda: sf.frequency(-4.0, STIFF),
        "body = -4.0 is not a Body; make one with Body.from_height_mass or Body.edwards2007, "
        "or of measured segments with Body(segment_mass=…, …)",
    ),
    (
        lambda: sf.kinetic_energy(NOMINAL, (0.1, 0.2), (0, 0, 0)),
        "rotation = (0.1, 0.2) is not three numbers: ankle, knee, hip",
    ),
    (
        lambda: sf.potential_energy(NOMINAL, STIFF, 9.8, (0, 0, 0)),
        "gravity is an array of shape (3,); give one number, 0.001 to 200 m/s², "
        "or map over many with jax.vmap",
    ),
    (
        lambda: STIFF._replace(hip=-1.0),
        "hip_stiffness = -1 is outside the allowed range, "
        "0 to 1e+12 N·m/rad, or inf for a rigid joint",
    ),
    (
        lambda: sf.Stiffness({}, 1, 1),
        "ankle_stiffness = {} is of type dict; give a number, "
        "0 to 1e+12 N·m/rad, or inf for a rigid joint",
    ),
    (
        lambda: sf.Stiffness(Decimal(3), 1, 1),
        "ankle_stiffness = Decimal('3') is of type Decimal; give a number, "
        "0 to 1e+12 N·m/rad, or inf for a rigid joint",
    ),
    (
        lambda: sf.is_stable(NOMINAL, (950, 2000, 738)),
        "stiffness = (950, 2000, 738) is not a Stiffness; write Stiffness(ankle=…, knee=…, hip=…)",
    ),
    (
        lambda: sf.is_stable(NOMINAL, [[950, 30, 0], [30, 2000, 0], [0, 0, 738]]),
        "stiffness is a matrix, not a Stiffness; write Stiffness(ankle=…, knee=…, hip=…, "
        "ankle_knee=…, knee_hip=…, ankle_hip=…)",
    ),
    (
        lambda: sf.is_stable(NOMINAL, np.array([[950, 30, 0], [0, 2000, 0], [0, 0, 738]])),
        "stiffness = [[950, 30, 0], [0, 2000, 0], [0, 0, 738]] is not symmetric, and springs are, "
        "because they store energy; write Stiffness(ankle=…, knee=…, hip=…, ankle_knee=…, "
        "knee_hip=…, ankle_hip=…), and put what is not symmetric into Feedback(proportional=…)",
    ),
    (
        lambda: sf.Stiffness(950, 2000, 738, knee_hip=float("inf")),
        "knee_hip_stiffness = inf is outside the allowed range, -100000 to 100000 N·m/rad",
    ),
    (
        lambda: sf.Feedback((900, 0)),
        "proportional gains = (900, 0) are not three numbers or a 3 × 3 matrix; give ankle, knee, "
        "hip, or three rows of three (row: moment, column: rotation)",
    ),
    (
        lambda: sf.Feedback((900, 0, NAN)),
        "hip_proportional_gain is NaN (not a number); give -100000 to 100000 N·m/rad",
    ),
    (
        lambda: sf.Feedback((900, 0, 0), [[1, 2, "x"], [0, 0, 0], [0, 0, 0]]),
        "ankle_hip_derivative_gain = 'x' is text; give a number, -100000 to 100000 N·m·s/rad",
    ),
    (
        lambda: sf.Feedback((900, 0, 0), delay=100),
        "feedback_delay = 100 is outside the allowed range, 0 to 10 s; "
        "100 looks like milliseconds, write 0.1",
    ),
    (
        lambda: sf.Feedback((900, 0, 0), delay=0.1)._replace(delay=-0.1),
        "feedback_delay = -0.1 is outside the allowed range, 0 to 10 s; "
        "feedback comes after what it senses, write 0.1",
    ),
    (
        lambda: checked_feedback((900, 0, 0)),
        "feedback = (900, 0, 0) is not a Feedback; "
        "write Feedback(proportional=…, derivative=…, delay=…)",
    ),
    (
        lambda: checked_damping((10, -1, 0)),
        "knee_damping = -1 is outside the allowed range, 0 to 100000 N·m·s/rad",
    ),
    (
        lambda: checked_damping([[1, 2, 0], [0, 1, 0], [0, 0, 1]]),
        "damping = [[1.0, 2.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] is not symmetric; "
        "give ankle, knee, hip, or a symmetric matrix "
        "(what is not symmetric is a derivative gain of Feedback)",
    ),
    (
        lambda: checked_damping([[1, 2, 0], [2, 1, 0], [0, 0, 1]]),
        "damping = [[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]] puts energy in for some "
        "motion; give a positive semidefinite matrix",
    ),
    (
        lambda: sf.safety_factor("edwards2007", STIFF),
        "body = 'edwards2007' is not a Body; make one with Body.from_height_mass or "
        "Body.edwards2007, or of measured segments with Body(segment_mass=…, …)",
    ),
    (
        lambda: sf.critical_stiffness(NOMINAL, STIFF, gravity=[9.8, 1.6]),
        "gravity is an array of shape (2,); give one number, 0.001 to 200 m/s², "
        "or map over many with jax.vmap",
    ),
    (
        lambda: sf.Body.from_height_mass(1.75, 80, np.array(["winter", "winter"])),
        f"body_model = array(['winter', 'winter'], dtype='<U6') is not known {MODELS}",
    ),
    (
        lambda: sf.Body({6, 15, 50}, [0.1, 0.3, 3.0], [0.4, 0.4], [0.2, 0.2, 0.4]),
        "segment_mass = {50, 6, 15} is not 3 numbers; give shank, thigh, upper body in kg",
    ),
    (
        lambda: sf.is_stable(NOMINAL, STIFF, gravity=-9.8),
        "gravity = -9.8 is outside the allowed range, 0.001 to 200 m/s²",
    ),
    (
        lambda: sf.modes(NOMINAL, STIFF, gravity="earth"),
        "gravity = 'earth' is text; give a number, 0.001 to 200 m/s²",
    ),
    (
        lambda: sf.equal_rotation(NOMINAL, -5.0),
        "knee_stiffness = -5 is outside the allowed range, "
        "0 to 1e+12 N·m/rad, or inf for a rigid joint",
    ),
    (
        lambda: NOMINAL.__class__([6.0, 15.0], [0.1, 0.3, 3.0], [0.4, 0.4], [0.2, 0.2, 0.4]),
        "segment_mass = [6.0, 15.0] is not 3 numbers; give shank, thigh, upper body in kg",
    ),
    (
        lambda: sf.Body([6, 15, 0], [0.1, 0.3, 3.0], [0.4, 0.4], [0.2, 0.2, 0.4]),
        "segment_mass of the upper body = 0 is outside the allowed range, 0.001 to 700 kg",
    ),
    (
        lambda: sf.Body([6, 15, 50], [0.1, 0.3, 3.0], [40, 40], [0.2, 0.2, 0.4]),
        "segment_length of the shank = 40 is outside the allowed range, 0.01 to 2 m; 40 looks "
        "like centimetres, write 0.4",
    ),
    (
        lambda: sf.Body([6, "15", 50], [0.1, 0.3, 3.0], [0.4, 0.4], [0.2, 0.2, 0.4]),
        "segment_mass of the thigh = '15' is text; give a number, 0.001 to 700 kg",
    ),
]


@pytest.mark.parametrize(("call", "sentence"), WRONG, ids=[text[:50] for _, text in WRONG])
def test_one_sentence(call, sentence):
    with pytest.raises(sf.InputError) as caught:
        call()
    assert str(caught.value) == sentence


def test_numbers_of_numpy_are_numbers():
    assert sf.Stiffness(np.float64(950), np.int64(2000), np.array(738.0)) == STIFF


IT_TAKES = "(it takes segment_mass, segment_inertia, segment_length, segment_com); from height and "


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: sf.Body(mass=68, height=1.66), "Body has no 'mass'; did you mean 'segment_mass'?"
         f" {IT_TAKES}mass it is Body.from_height_mass(height, mass)"),
        (lambda: sf.Body((1, 2, 3), (1, 2, 3), segment_com=(1, 2, 3)), "Body lacks segment_length"
         f" {IT_TAKES}mass it is Body.from_height_mass(height, mass)"),
        (lambda: sf.Body.from_height_mass(1.7), "Body.from_height_mass lacks mass (it takes height"
         ", mass, model)"),
        (lambda: sf.Stiffness(900, 400), "Stiffness lacks hip (it takes ankle, knee, hip, ankle_kn"
         "ee, knee_hip, ankle_hip); a rigid joint is math.inf"),
        (lambda: sf.Stiffness(1, 2, 3, ankle=1), "Stiffness has too many arguments, or one twice ("
         "it takes ankle, knee, hip, ankle_knee, knee_hip, ankle_hip); a rigid joint is math.inf"),
        (lambda: sf.critical_delay(NOMINAL, STIFF), "critical_delay lacks feedback (it takes body,"
         " stiffness, gravity, damping, feedback); of feedback write feedback=Feedback(proportional"
         "=…, derivative=…, delay=…)"),
        (lambda: sf.is_stable(NOMINAL), "is_stable lacks stiffness (it takes body, stiffness, grav"
         "ity, damping, feedback)"),
    ],
)  # fmt: skip
def test_an_argument_that_is_not_there_gets_its_sentence(call, sentence):
    with pytest.raises(sf.InputError) as caught:
        call()
    assert str(caught.value) == sentence


def test_signatures_and_errors_from_within_stay_as_they_are(monkeypatch):
    assert list(inspect.signature(sf.Body).parameters) == list(sf.Body._fields)
    feedback = inspect.signature(sf.critical_delay).parameters["feedback"]
    assert feedback.default is inspect.Parameter.empty

    def fails(*_):
        raise TypeError("of the inside")

    monkeypatch.setattr("standfast.mechanics.joints.checked_leaf", fails)
    with pytest.raises(TypeError, match="of the inside"):
        sf.Stiffness(1.0, 2.0, 3.0)
