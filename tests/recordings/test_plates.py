"""One person on several plates has the centre of pressure that one large plate would have shown."""

import numpy as np
import pytest

import standfast as sf
from recordings import plate, sway, table

TIME, AP, ML = sway()
MM = 1e3
PLACE = (0.05, 0.6)  # m, of the second plate's origin from the first's
ROUNDED = 2e-8  # m: of seven decimals of a N·m over a load that is at its least a tenth of 700 N
# What the person weighs on each foot, and where: the left carries 30 to 70 %.
_, WHOLE, _ = plate(surface=0.04)
SHARE = 0.5 + 0.2 * np.sin(0.9 * TIME)
NAMES = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")


def shifted(forces, place):
    """Forces and moments about another origin: M' = M − r × F, r in the plane of the plate."""
    fx, fy, fz, mx, my, mz = forces
    x, y = place
    return fx, fy, fz, mx - y * fz, my + x * fz, mz - (x * fy - y * fx)


def split(place=PLACE, share=SHARE):
    """Forces and moments of the whole on two plates, each about its own origin.

    The parts are any forces that add up to the whole: the left foot has its share of all, and a
    couple about both axes that the right foot has the other way.
    """
    couple = (0.0, 0.0, 0.0, 30.0 * np.cos(0.5 * TIME), 20.0 * np.sin(0.3 * TIME), 0.0)
    left = [share * each + more for each, more in zip(WHOLE, couple, strict=True)]
    right = [(1.0 - share) * each - more for each, more in zip(WHOLE, couple, strict=True)]
    return left, list(shifted(right, place))


LEFT, RIGHT = split()
ABOVE = "Imported AMTI OR6 Series Force Plate #{0} - Force,,,Imported AMTI OR6 Series Force Plate #{0} - Moment,,"


def named(form, units="", sep=",", first=LEFT, second=RIGHT):
    """A table of both plates whose columns are named by a form, with a line of units if any."""
    names = [form.format(name=name, k=k) for k in (1, 2) for name in NAMES]
    below = sep.join(["s", *units.split()]) + "\n" if units else ""
    numbers = table(None, [TIME, *first, *second], sep, 7)
    return sep.join(["t", *names]) + "\n" + below + numbers


NEWTON = " ".join(2 * ["N N N Nm Nm Nm"])
TWO = {
    "Fz1": named("{name}{k}", NEWTON),
    "F1Z": named("{name[0]}{k}{name[1]}", NEWTON),
    "plate2_Fz": named("plate{k}_{name}", NEWTON),
    "Force Plate 2 - Fz": named("Force Plate {k} - {name}", NEWTON),
    "the same names in the order of the plates": named("{name}", NEWTON),
    "the same names again, numbered by pandas": named("{name}", NEWTON).replace(
        "My,Mz,Fx,Fy,Fz,Mx,My,Mz", "My,Mz," + ",".join(f"{name}.1" for name in NAMES), 1
    ),
    "Vicon": "Devices\n100\n,," + ",".join(ABOVE.format(k) for k in (1, 2)) + "\nFrame,Sub Frame,"
    + ",".join(2 * NAMES) + "\n,," + ",".join(2 * ["N,N,N,N.mm,N.mm,N.mm"]) + "\n"
    + table(None, [np.arange(TIME.size), 0 * TIME, *(
        (MM if k % 6 > 2 else 1.0) * each for k, each in enumerate([*LEFT, *RIGHT])
    )], decimals=7),
    "forces up on one, down on the other": named(
        "{name}{k}", NEWTON, second=[-each for each in RIGHT]
    ),
}  # fmt: skip


def read(folder, text, **options):
    path = folder / "a.csv"
    path.write_text(text, encoding="utf-8")
    return sf.read_recording(path, **options)


def is_the_whole(found):
    np.testing.assert_allclose(found.ap, AP, rtol=0, atol=ROUNDED)
    np.testing.assert_allclose(found.ml, ML, rtol=0, atol=ROUNDED)


@pytest.mark.parametrize("name", TWO)
def test_two_plates_are_one_large_one(tmp_path, name):
    found = read(tmp_path, TWO[name], surface=0.04, plate={"2": PLACE})
    is_the_whole(found)
    (told,) = [remark for remark in found.remarks if "on plates 1" in remark]
    assert "plates 1 (355 N, at 0, 0 m) and 2 (345 N, at 0.05, 0.6 m)" in told


def test_a_wrong_place_would_be_noticed(tmp_path):
    found = read(tmp_path, TWO["Fz1"], surface=0.04, plate={"2": (0.05, 0.601)})
    with pytest.raises(AssertionError):
        is_the_whole(found)


def test_the_first_plate_may_be_the_one_that_is_placed(tmp_path):
    back = {"1": tuple(-each for each in PLACE)}
    found = read(tmp_path, TWO["Fz1"], surface=0.04, plate=back)
    np.testing.assert_allclose(found.ap, AP - PLACE[0], rtol=0, atol=ROUNDED)
    both = {"1": (0, 0), "2": PLACE}
    is_the_whole(read(tmp_path, TWO["Fz1"], surface=0.04, plate=both))


def test_one_plate_alone_is_read_by_its_name(tmp_path):
    found = read(tmp_path, TWO["Fz1"], surface=0.04, plate="2")
    fx, fy, fz, mx, my, _ = RIGHT
    np.testing.assert_allclose(found.ap, (0.04 * fx - my) / fz, rtol=0, atol=ROUNDED)
    np.testing.assert_allclose(found.ml, (0.04 * fy + mx) / fz, rtol=0, atol=ROUNDED)


def centres(surface=0.04):
    """Load and centre of pressure of each plate about its own origin, by their definition."""
    for fx, fy, fz, mx, my, _ in (LEFT, RIGHT):
        yield fz, (surface * fx - my) / fz, (surface * fy + mx) / fz


CENTRES = [each for fz, x, y in centres() for each in (fz, MM * x, MM * y)]
OF_CENTRES = {
    "centres of pressure": ["Fz1 (N)", "COPx1 (mm)", "COPy1 (mm)", "Fz2 (N)", "COPx2 (mm)", "COPy2 (mm)"],
    "directions": [
        "Left Fz (N)", "Left CoP AP (mm)", "Left CoP ML (mm)", "Right Fz (N)", "Right CoP AP (mm)", "Right CoP ML (mm)",
    ],
}  # fmt: skip


@pytest.mark.parametrize("name", OF_CENTRES)
def test_centres_of_pressure_are_weighted_by_their_loads(tmp_path, name):
    second = "right" if name == "directions" else "2"
    text = table(["t (s)", *OF_CENTRES[name]], [TIME, *CENTRES], decimals=8)
    is_the_whole(read(tmp_path, text, plate={second: PLACE}))


def test_vicon_names_plates_in_the_line_above(tmp_path):
    """With centres of pressure, and with plates that have words for names."""
    above = ",,Left Plate - Force,,,Left Plate - CoP,,,Plate B - Force,,,Plate B - CoP"
    names = "Frame,Sub Frame," + ",".join(2 * ["Fx,Fy,Fz,Cx,Cy,Cz"])
    units = ",," + ",".join(2 * ["N,N,N,mm,mm,mm"])
    none = 0 * TIME
    both = [each for fz, x, y in centres() for each in (none, none, -fz, MM * x, MM * y, none)]
    numbers = table(None, [np.arange(TIME.size), none, *both], decimals=8)
    text = f"Devices\n100\n{above}\n{names}\n{units}\n{numbers}"
    is_the_whole(read(tmp_path, text, plate={"plateb": PLACE}))
    with pytest.raises(sf.InputError, match="stands on plates leftplate and plateb"):
        read(tmp_path, text)


def test_kistler_has_the_same_names_for_each_plate(tmp_path):
    both = [each for fz, x, y in centres() for each in (0 * fz, 0 * fz, fz, fz, x, y)]
    names = "abs time (s)\t" + "\t".join(2 * ["Fx\tFy\tFz\t|Ft|\tAx\tAy"])
    text = f"{names}\ns\t" + "\t".join(2 * ["N\tN\tN\tN\tm\tm"]) + "\n"
    is_the_whole(read(tmp_path, text + table(None, [TIME, *both], "\t", 10), plate={"2": PLACE}))


def test_opensim_is_in_one_frame_with_y_up(tmp_path):
    """Force and centre of pressure in the ground's frame, whose floor is x and z."""
    (f1, x1, y1), (f2, x2, y2) = centres()
    parts = [(f1, x1, y1), (f2, x2 + PLACE[0], y2 + PLACE[1])]
    columns = [each for f, x, y in parts for each in (0 * f, f, 0 * f, x, 0 * f, y)]
    for before in ("ground_force_{k}_", "{k}_ground_force_"):
        names = [
            before.format(k=k) + part for k in "lr" for part in ("vx", "vy", "vz", "px", "py", "pz")
        ]
        text = "grf.mot\nversion=1\nnRows=6000\nnColumns=13\ninDegrees=no\nendheader\n" + table(
            ["time", *names], [TIME, *columns], "\t", 10
        )
        found = read(tmp_path, text)
        is_the_whole(found)
        assert any("z as mediolateral, as OpenSim has it" in remark for remark in found.remarks)
        turned = read(tmp_path, text, ap="z")
        np.testing.assert_array_equal(turned.ap, found.ml)
        with pytest.raises(sf.InputError, match="y points up in this file; give x or z"):
            read(tmp_path, text, ap="y")
        with pytest.raises(sf.InputError, match="this file has all of them in one frame; leave"):
            read(tmp_path, text, plate={"left": (0, 0.6)})
        is_the_whole(read(tmp_path, text, plate={"left": (0, 0)}))


@pytest.mark.parametrize("nothing", [0.0, np.nan])
def test_a_foot_that_is_lifted_for_a_time_counts_for_nothing(tmp_path, nothing):
    """Programs write 0, or no centre of pressure, for a plate without a load."""
    alone = (TIME > 20.0) & (TIME < 22.0)
    f1 = np.where(alone, WHOLE[2], SHARE * WHOLE[2])
    f2 = WHOLE[2] - f1
    x2 = np.where(alone, nothing, MM * (AP + 0.02))
    x1 = np.where(alone, MM * AP, MM * (AP * WHOLE[2] - (AP + 0.02) * f2) / f1)
    y1, y2 = MM * ML, np.where(alone, nothing, MM * ML)
    text = table(
        ["t (s)", *OF_CENTRES["centres of pressure"]], [TIME, f1, x1, y1, f2, x2, y2], decimals=8
    )
    is_the_whole(read(tmp_path, text, plate={"2": (0, 0)}))


def test_cortex_has_all_plates_in_one_frame(tmp_path):
    """Those on which nobody stands have a load of 0 in the middle of the plate."""
    centre = [MM * AP, MM * ML, 0 * TIME]
    empty = [*[0 * TIME] * 3, 0 * TIME + 1506.0, 0 * TIME - 203.0, *[0 * TIME] * 2]
    names = "\t".join(
        f"{of}{k}" for k in (1, 2, 3) for of in ("FX", "FY", "FZ", "X", "Y", "Z", "MZ")
    )
    text = "[Force Data]\nNumberOfForcePlates=3\nSampleRate=100.000000\nNumberOfSamples=6000\n#Sample\t"
    feet = [
        [*(share * each for each in WHOLE[:3]), *centre, 0 * TIME] for share in (SHARE, 1 - SHARE)
    ]
    numbers = table(None, [np.arange(TIME.size), *feet[0], *empty, *feet[1]], "\t", 8)
    found = read(tmp_path, f"{text}{names}\n{numbers}", unit="mm", plate={"3": (0, 0)})
    is_the_whole(found)
    assert any("0 N on 2" in remark for remark in found.remarks)


def test_a_plate_on_which_nobody_stands_is_left_out_and_told(tmp_path):
    random = np.random.default_rng(5)
    empty = [random.normal(size=TIME.size) for _ in NAMES]
    found = read(tmp_path, named("{name}{k}", NEWTON, first=WHOLE, second=empty), surface=0.04)
    is_the_whole(found)
    (told,) = [remark for remark in found.remarks if "nobody stands" in remark]
    assert "N on 2 in the median" in told
    nothing = [np.full(TIME.size, np.nan)] * len(NAMES)  # a channel that is not plugged in
    text = named("{name}{k}", NEWTON, first=WHOLE, second=nothing)
    is_the_whole(read(tmp_path, text, surface=0.04))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_plate_that_is_stood_on_for_a_short_time_counts(tmp_path, sign):
    """By its median nobody would stand there, and a part of the load would be lost."""
    first, second = split(share=np.where((TIME > 20) & (TIME < 23), 0.6, 1.0))
    text = named("{name}{k}", NEWTON, first=first, second=[sign * each for each in second])
    is_the_whole(read(tmp_path, text, surface=0.04, plate={"2": PLACE}))
    with pytest.raises(sf.InputError, match="the person stands on plates 1 and 2, and where"):
        read(tmp_path, text, surface=0.04)


def test_the_sum_of_all_plates_is_taken_where_it_is_there(tmp_path):
    names = ["t (s)", "Fz1 (N)", "Fz2 (N)", "COPx1 (mm)", "COPy1 (mm)", "COPx (mm)", "COPy (mm)"]
    columns = [TIME, LEFT[2], RIGHT[2], 0 * TIME, 0 * TIME, MM * AP, MM * ML]
    is_the_whole(read(tmp_path, table(names, columns, decimals=8)))


def test_a_height_of_the_surface_is_said_to_be_of_no_use_to_a_centre_of_pressure(tmp_path):
    names = OF_CENTRES["centres of pressure"]
    text = table(["t (s)", *names], [TIME, *CENTRES], decimals=8)
    for options in ({"plate": {"2": PLACE}}, {"plate": "1"}, {"ap": names[1], "ml": names[2]}):
        for surface, said in ((0.04, True), (0.0, False)):
            found = read(tmp_path, text, surface=surface, **options)
            assert ("surface=0.04 is not used, as the centre" in " ".join(found.remarks)) is said


LEFT_ALONE = table(["t", "Left CoPx (mm)", "Left CoPy (mm)"], [TIME, MM * AP, MM * ML])
NO_LOADS = table(
    ["t", "COPx1 (mm)", "COPy1 (mm)", "COPx2 (mm)", "COPy2 (mm)"], [TIME, *(MM * AP, MM * ML) * 2]
)
ONE_LOAD = table(
    ["t", "COPx (mm)", "COPy (mm)", "Fz1 (N)"],
    [TIME, MM * AP, MM * ML, np.where((TIME > 20) & (TIME < 21), 4.0, 700.0)],
)
STEPS = np.where((TIME > 20) & (TIME < 21), 0.01, 1.0)
OFF = named(
    "{name}{k}",
    NEWTON,
    first=[STEPS * each for each in LEFT],
    second=[STEPS * each for each in RIGHT],
)
MOMENTS_OF_ONE = table(["t", "Fz1", "Mx1 (Nm)", "My1 (Nm)", "Fz2"], [TIME, *LEFT[2:5], RIGHT[2]])
REFUSED = {
    "places": (TWO["Fz1"], {}, 'the person stands on plates 1 and 2, and where they lie to each other is not in the file; write where the origin of 2 lies from that of 1 along the axes of the plates (m), as plate={"2": (0, 0.6)}'),
    "a plate that is not there": (TWO["Fz1"], {"plate": "3"}, "plate = '3' is not in the file; its plates are 1, 2"),
    "a plate in a file without names": (table(["t", "COPx (mm)", "COPy (mm)"], [TIME, MM * AP, MM * ML]), {"plate": "1"}, "plate = '1' is not in the file; it names none"),
    "a place in mm": (TWO["Fz1"], {"plate": {"2": (0, 600)}}, "plate = 2: (0, 600) is not two numbers of m, each up to 5, is it in mm?"),
    "a place of one number": (TWO["Fz1"], {"plate": {"2": (0.6,)}}, "plate = 2: (0.6,) is not two numbers of m"),
    "a plate as a number": (TWO["Fz1"], {"plate": 2}, 'plate = 2; give the name of a plate, as plate="1", or where plates lie'),
    "a plate beside columns": (NO_LOADS, {"plate": "1", "ap": "COPx1 (mm)", "ml": "COPy1 (mm)"}, "plate=… beside ap=… and ml=…, which name the columns"),
    "moments in a wrong unit": (TWO["Fz1"].replace("Nm", "Nmm"), {"plate": {"2": PLACE}}, "on plate 1 alone the centre of pressure moves by"),
    "a centre of pressure of which nothing is there": (table(["t (s)", *OF_CENTRES["centres of pressure"]], [TIME, *CENTRES[:4], np.full(TIME.size, np.nan), CENTRES[5]]), {"plate": {"2": PLACE}}, "it holds no samples of the centre of pressure"),
    "one plate beside what may be another or the sum": (named("{name}{k}", NEWTON).replace("1,", ","), {"plate": {"2": PLACE}}, "columns of plate 2 stand beside such that name no plate, and whether these are of another plate or of all is not clear; number both"),
    "no load": (NO_LOADS, {"plate": {"2": PLACE}}, "Fz of plate 1 is missing"),
    "moments of one of two": (MOMENTS_OF_ONE, {"plate": {"2": PLACE}}, "Mx and My of plate 2 are missing"),
    "a foot": (LEFT_ALONE, {}, "only what is under the left foot is there"),
    "stepping off the only load": (ONE_LOAD, {}, "Fz falls from 700 to 4 N in line 2003: the person is not"),
    "stepping off": (OFF, {"plate": {"2": PLACE}}, "N in line 2004: the person is not on the plate all the time"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_it_is_refused_in_a_sentence(tmp_path, name):
    text, options, sentence = REFUSED[name]
    with pytest.raises(sf.InputError) as told:
        read(tmp_path, text, **options)
    assert sentence in str(told.value)
