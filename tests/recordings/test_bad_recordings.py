"""What is no recording of quiet standing is refused in a sentence, or told; nothing crashes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import standfast as sf
from recordings import plate, sway, table

TIME, AP, ML = sway()
MM = 1e3
NAMES = ["t (s)", "ap (mm)", "ml (mm)"]
GOOD = table(NAMES, [TIME, MM * AP, MM * ML])
LINES = GOOD.splitlines()
_, FORCES, _ = plate()
STEPPED = np.where((TIME > 20.0) & (TIME < 21.0), 4.0, FORCES[2])
PLATE = ["t (s)", "Fz (N)", "Mx (Nm)", "My (Nm)"]


def of(names=NAMES, time=TIME, ap=MM * AP, ml=MM * ML, kept=slice(None), **how):
    return table(names, [time[kept], ap[kept], ml[kept]], **how)


def without(first, last):
    return "\n".join([*LINES[:first], *LINES[last:]])


def emptied(*where):
    lines = list(LINES)
    for line in where:
        lines[line] = lines[line].split(",")[0] + ",,"
    return "\n".join(lines)


SECONDS = slice(0, 400)


def clocked(form):
    """GOOD with times by hours and seconds in a form, truncated to its digits."""
    rows = [line.split(",", 1)[1] for line in LINES[1:] if line]
    times = [form.format(0, int(1e3 * t) / 1e3 if ".3f" in form else int(t)) for t in TIME]
    return "\n".join([LINES[0], *(f"{t},{row}" for t, row in zip(times, rows, strict=True))]) + "\n"


# A clock whose date stays at midnight: half a minute of the evening, then of the morning before.
SET_BACK = "\n".join([LINES[0], *(
    f"2024-02-29 {'23:59' if t < 30.0 else '00:00'}:{t % 30.0 + (30.0 if t < 30.0 else 0.0):06.3f},"
    + line.split(",", 1)[1]
    for t, line in zip(TIME, LINES[1:], strict=False)
)])  # fmt: skip

REFUSED = {
    "empty": ("", {}, "it is empty; give a line of names"),
    "blank": ("\n \n\t\n", {}, "it is empty"),
    "binary": ("a\0b" * 400, {}, "it is no text; export the recording as CSV"),
    "C3D": ("\x02P" + "\0" * 600, {}, "it is a C3D file"),
    "zipped": ("PK\x03\x04....", {}, "it is a spreadsheet or an archive; save the table as CSV"),
    "prose": ("Dear all,\nthe plate broke.\nBest", {}, "it holds no table of numbers in two or"),
    "names alone": (",".join(NAMES), {}, "it holds no table of numbers"),
    "one column": ("ap (mm)\n" + "1.5\n" * 600, {}, "it holds no table of numbers in two or more"),
    "one direction": (table(NAMES[:2], [TIME, MM * AP]), {}, "'ap (mm)' is alone; name columns"),
    "no direction": (of(["t (s)", "left", "right"]), {}, "no centre of pressure is there; name c"),
    "no names": (table(None, [TIME, MM * AP, MM * ML]), {}, "or say by ap=… and ml=… which columns"),
    "moments without load": (table(["t", "Mx (Nm)", "My (Nm)"], [TIME, AP, ML]), {}, "Fz is missing"),
    "surface without forces": (table(PLATE, [TIME, *FORCES[2:5]]), {"surface": 0.04}, "Fx and Fy are missing"),
    "surface in mm": (GOOD, {"surface": 40}, "surface = 40 is not a height of -0.3 to 0.3 m, is it in mm?"),
    "surface a text": (GOOD, {"surface": "high"}, "surface = 'high' is not a height"),
    "two plates": (table(["t", "Fz1", "Mx1 (Nm)", "My1 (Nm)", "Fz2"], [TIME, *FORCES[2:5], FORCES[2]]), {}, "Mx and My of plate 2 are missing; name columns"),
    "one sample": ("time (s),COP_AP (mm),COP_ML (mm)\n0.01,2.5,3.5\n", {}, "it holds one sample; sway needs 5 s of samples at the least, and its frequencies 60 s"),
    "one sample of forces": ("Rate: 100\nFz (N);Mx (Nm);My (Nm)\n700;2,5;3,5\n", {}, "it holds one sample; sway needs 5 s"),
    "two samples": ("time (s),COP_AP (mm),COP_ML (mm)\n0.01,2.5,3.5\n0.02,2.6,3.4\n", {}, "it is 0.02 s long (2 samples at 100 Hz); sway needs 5 s at the least"),
    "no unit": (of(["t (s)", "ap", "ml"]), {}, "the column 'ap' says no unit; write unit=m, unit=cm or unit=mm"),
    "no unit of moments": (table(["t", "Fz", "Mx", "My"], [TIME, *FORCES[2:5]]), {}, "the column 'Mx' says no unit; write unit=Nm or unit=Nmm"),
    "unit of another kind": (of(["t (s)", "ap", "ml"]), {"unit": "kg"}, "unit = 'kg' is not one of m, cm, mm"),
    "unit against the name": (GOOD, {"unit": "cm"}, "unit=cm is not what the column 'ap (mm)' says"),
    "unit in the line below": ("t,ap,ml\ns,mm,V\n" + table(None, [TIME, AP, ML]), {}, "the column 'ml' is in 'V', and m, cm, mm are known"),
    "metres for millimetres": (of(["t (s)", "ap (m)", "ml (m)"]), {}, "moves by 6.91 m about its mean"),
    "micrometres for millimetres": (of(["t (s)", "ap (um)", "ml (um)"]), {}, "moves by 6.91 micrometres about its mean"),
    "no time": (table(NAMES[1:], [MM * AP, MM * ML]), {}, "there is no column of time; name one time (s), or say the samples a second as rate=100"),
    "wrong rate": (GOOD, {"rate": 1000}, "the column of time says 100 Hz, and rate=1000 is given"),
    "slow": (of(kept=slice(None, None, 10)), {}, "is outside of 20 to 10,000 Hz; velocities need 20 Hz or more"),
    "slow by option": (GOOD, {"rate": 10}, "rate = 10 Hz is outside of 20 to 10,000 Hz; velocities"),
    "rate above is slow": ("Rate: 10 Hz\n" + table(NAMES[1:], [MM * AP, MM * ML]), {}, "the rate in the lines before the table = 10 Hz is outside"),
    "rate a text": (GOOD, {"rate": "fast"}, "rate = 'fast' is not a number of Hz"),
    "rate of nothing": (GOOD, {"rate": float("nan")}, "rate = nan Hz is outside"),
    "too short": (of(kept=SECONDS), {}, "it is 4 s long (400 samples at 100 Hz); sway needs 5 s at the least"),
    "time goes back": (of(time=np.where(TIME == 30.0, 10.0, TIME)), {}, "time goes back in line 3002, from 29.99 to 10 s"),
    "time stands still": (of(time=np.where((TIME > 30) & (TIME < 40), 30.0, TIME)), {}, "time stands still in line 3003, at 30 s"),
    "always the same time": (of(time=0 * TIME), {}, "the time is 0 s in all samples"),
    "a clock that is none": (clocked("{:02.0f}:75:{:06.3f}"), {}, "line 2, column 't (s)': '00:75:00.000' is no time of a clock as the others are, hh:mm:ss"),
    "a clock of whole seconds": (clocked("{:02.0f}:30:{:02.0f}"), {}, "the clock in 't (s)' has whole seconds, in which the rate does not show; say the samples a second as rate=100"),
    "a date that is none": (clocked("2024-02-30 {:02.0f}:30:{:06.3f}"), {}, "'2024-02-30 00:30:00.000' is no time of a clock"),
    "a time without the date of the others": (clocked("2024-02-29 {:02.0f}:30:{:06.3f}").replace("2024-02-29 00:30:10.000", "00:30:10.000"), {}, "line 1002, column 't (s)': '00:30:10.000' is no time of a clock as the others are"),
    "a date that does not change at midnight": (SET_BACK, {}, "time goes back in line 3002, from 86400 to 0 s"),
    "a number among times of a clock": (clocked("{:02.0f}:30:{:06.3f}").replace("00:30:10.000", "10.5"), {}, "line 1002, column 't (s)': '10.5' is no time of a clock"),
    "rows missing": (without(2001, 2051), {}, "50 samples (0.5 s) are missing after 19.99 s, line 2001; up to 0.1 s is filled"),
    "cells missing": (emptied(*range(2001, 2031)), {}, "30 samples (0.3 s) are missing after 19.99 s, line 2001"),
    "many cells missing": (emptied(*range(7, 5990, 12)), {}, "499 of 6,000 samples are missing (the first after 0.05 s, line 7)"),
    "all missing": (of(ap=np.nan * AP), {}, "it holds no samples of the centre of pressure"),
    "zeros where no one stands": (of(ap=MM * AP * (STEPPED > 10), ml=MM * ML * (STEPPED > 10)), {}, "99 samples (0.99 s) are missing after 20 s, line 2002"),
    "a word among numbers": (GOOD.replace(LINES[900], "8.99,oops,1.5"), {}, "line 901, column 'ap (mm)': 'oops' is no number"),
    "too many entries": (GOOD.replace(LINES[900], LINES[900] + ",7"), {}, "line 901 has 4 entries, and the others 3"),
    "decimal commas not in quotes": (of(comma=True), {}, "rows have 6 entries under 3 names; are decimal commas not in quotes?"),
    "either number": ("ap (mm),ml (mm)\n" + '"1,234",2.5\n"3,456",2.6\n' * 400, {"rate": 100}, "line 2, column 'ap (mm)': '1,234' may be 1234 or 1.234; write decimals with a point"),
    "a marker in space": (table(["t", "x (mm)", "y (mm)", "z (mm)"], [TIME, MM * AP, MM * ML, TIME]), {}, "no centre of pressure is there"),
    "the last time far away": (GOOD + "9e29,1,2\n", {}, "samples (9e+29 s) are missing after 59.99 s, line 6001"),
    "a time beyond all": (GOOD.replace(LINES[900], "-1e308,1.5,1.5") + "1e308,1,2\n", {}, "time goes back in line 901"),
    "a motion beyond all": (GOOD.replace(LINES[900], "8.99,1e308,-1e308"), {}, "the centre of pressure moves by"),
    "flat": (of(ap=0 * AP + 3.2), {}, "the anterior-posterior centre of pressure is the same in all samples"),
    "twice the same": (of(ml=MM * AP), {}, "both directions are the same motion"),
    "one column twice": (GOOD, {"ap": "2", "ml": "2"}, "both directions are the column 'ap (mm)'; give two"),
    "stepping off": (table(PLATE, [TIME, STEPPED, *FORCES[3:5]]), {}, "Fz falls from 699.9 to 4 N in line 2003: the person is not on the plate all the time"),
    "nobody there": (table(PLATE, [TIME, 0.01 * FORCES[2], *FORCES[3:5]]), {}, "N in the median, so nobody stands on the plate, or it is not in N"),
    "unknown column": (GOOD, {"ap": "cop", "ml": "3"}, "ap = 'cop' names no column; give a name or a number from 1 to 3"),
    "axes twice": (GOOD, {"ap": "x", "ml": "x"}, "ap=x and ml=x are the same; give one"),
    "axis and column": (GOOD, {"ap": "y", "ml": "ml (mm)"}, "give two columns, or an axis of the plate alone"),
    "option no text": (GOOD, {"ap": 2}, "ap = 2 is not a text"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_it_is_refused_in_a_sentence(tmp_path, name):
    text, options, sentence = REFUSED[name]
    path = tmp_path / "a.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(sf.InputError) as told:
        sf.read_recording(path, **options)
    assert sentence in str(told.value)


REMARKS = {
    "ten seconds": (of(kept=slice(0, 1000)), "it is 10 s long; frequencies need 60 s (windows of 5 s instead of 30 s)"),
    "cm for mm": (of(["t (s)", "ap (mm)", "ml (mm)"], ap=100 * AP, ml=100 * ML), "moves by 0.691 mm about its mean, which is little; is the unit right?"),
    "mm for cm": (of(["t (s)", "ap (cm)", "ml (cm)"]), "which is much; is the unit right?"),
    "a jump": (of(ap=MM * AP + 40 * (TIME > 30)), "mm at 30 s, which path and velocity hold"),
    "stuck": (of(ap=np.where((TIME > 10) & (TIME < 13), 3, MM * AP), ml=np.where((TIME > 10) & (TIME < 13), 3, MM * ML)), "does not change for 2.98 s from 10.01 s on"),
    "cut off": (GOOD[:-12], "line 6001, the last, is cut off and left out"),
    "followed": (GOOD + "\nEnd of data\n1,2,3\n", "what follows from line 6003 on is not read"),
}  # fmt: skip


@pytest.mark.parametrize("name", REMARKS)
def test_it_is_read_and_told(tmp_path, name):
    text, sentence = REMARKS[name]
    path = tmp_path / "a.csv"
    path.write_text(text, encoding="utf-8")
    (told,) = [each for each in sf.read_recording(path).remarks if sentence in each]
    assert told


def test_a_fast_plate_is_told_of_its_noise():
    _, ap, ml = sway(rate=500.0)
    (told,) = sf.Recording(ap, ml, 500.0).remarks
    assert "unless a low-pass is used" in told


def test_what_is_no_file_is_said(tmp_path):
    for path, sentence in (
        (tmp_path / "no.csv", "there is no such file of a recording"),
        (tmp_path, "is a folder; give a CSV file of a recording"),
        (3, "path = 3 is not the name of a file"),
    ):
        with pytest.raises(sf.InputError, match=sentence):
            sf.read_recording(path)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"ap": [[1.0, 2.0]]}, "ap has the shape"),
        ({"ap": "abc"}, "ap = 'abc' is not a row of numbers"),
        ({"ml": ML[:-1]}, "ap has 6000 samples and ml 5999"),
        ({"ml": np.where(TIME == 3, np.nan, ML)}, "ml has 1 samples that are no numbers"),
        ({"ap": 1e200 * AP}, "about its mean"),
        ({"rate": None}, "rate = None is not a number"),
    ],
)
def test_arrays_are_checked_too(change, sentence):
    with pytest.raises(sf.InputError, match=sentence):
        sf.Recording(**{"ap": AP, "ml": ML, "rate": 100.0, **change})


SHORT = {
    "names": of(kept=slice(0, 600)),
    "forces": "Rate: 100\n" + table(PLATE[1:], [each[:600] for each in FORCES[2:5]], "\t"),
    "commas": of(kept=slice(0, 600), separator=";", comma=True),
    "plates": table(
        [
            "t",
            *(
                f"{name}{k} ({unit})"
                for k in (1, 2)
                for name, unit in (("Fz", "N"), ("Mx", "Nm"), ("My", "Nm"))
            ),
        ],
        [each[:600] for each in (TIME, *FORCES[2:5], *FORCES[2:5])],
    ),
}


@settings(max_examples=150, deadline=None, derandomize=True)
@given(
    st.sampled_from(sorted(SHORT)),
    st.lists(
        st.tuples(
            st.floats(0.0, 1.0),
            st.integers(0, 12),
            st.sampled_from(
                [b"", b"\0", b"\n", b",", b";", b"\t", b'"', b"nan", b"1e999", b"1e308", b"-1e300", b"-", b"\xff\xfe",
                 b"\xe2\x80\xa8", b"0", b"9" * 30, b"x", b".", b"mm", b" "]
            ),
        ),
        min_size=1,
        max_size=6,
    ),
    st.sampled_from([{}, {"ap": "y"}, {"rate": 100}, {"unit": "mm"}, {"ap": "2", "ml": "3"}, {"plate": {"2": (0, 0.6)}}]),
)  # fmt: skip
def test_an_altered_file_gives_a_recording_or_a_sentence(tmp_path_factory, which, cuts, options):
    raw = SHORT[which].encode()
    for place, cut, put in cuts:
        # half of the cuts in the first lines, where names and units are
        at = int(place * len(raw)) if cut % 2 else int(place * 60)
        raw = raw[:at] + put + raw[at + cut :]
    path = tmp_path_factory.mktemp("fuzz") / "a.csv"
    path.write_bytes(raw)
    try:
        found = sf.sway_measures(sf.read_recording(path, **options))
    except sf.InputError as error:
        assert "\n" not in str(error)
        assert len(str(error)) < 1000
    else:
        assert np.isfinite(found).all()
