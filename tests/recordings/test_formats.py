"""The same sway, however a force plate writes it."""

import numpy as np
import pytest

import standfast as sf
from recordings import plate, sway, table

TIME, AP, ML = sway()
MM, CM = 1e3, 1e2
_, FORCES, _ = plate(surface=0.04)
FX, FY, FZ, MX, MY, MZ = FORCES
FRAME = np.arange(1, TIME.size + 1)

VICON = (
    "Devices\n100\n,,Plate 1 - Force,,,Plate 1 - Moment,,,Plate 1 - CoP,,\n"
    "Frame,Sub Frame,Fx,Fy,Fz,Mx,My,Mz,Cx,Cy,Cz\n,,N,N,N,N.mm,N.mm,N.mm,mm,mm,mm\n"
    + table(None, [FRAME, 0 * TIME, *FORCES[:3], MM * MX, MM * MY, MM * MZ, MM * AP, MM * ML, TIME])
)
BIOWARE = (
    "BioWare\tData\nSystem info:\t5.3\nTrial\tA, B\nPlate\t600\t400\n\n"
    "abs time (s)\tFx\tFy\tFz\t|Ft|\tAx\tAy\ns\tN\tN\tN\tN\tm\tm\n"
)
MOTIVE = (
    "Format Version,1.0,\nTake Name,quiet,\nCapture Frame Rate,100.00,\nExport Frame Rate,100.00,\n"
    "Device Name,AMTI 1 1,\nDevice Channel Count,6,\nMocap Rate,100.00,\nMocap Rate Multiple,1.00,\n\n"
    "PlateLength,19.750000,\nOffset_Z,0.000000\n\n\n"
    "MocapFrame, MocapTime, DeviceFrame, Fx, Fy, Fz, Mx, My, Mz, Cx, Cy, Cz\n"
)
OF_MOTIVE = [FRAME, TIME, FRAME, *FORCES, AP, ML, 0 * TIME]
QUALISYS = (
    "NO_OF_SAMPLES\t6000\nFREQUENCY\t100\nTIME_STAMP\t2024-03-05, 10:11:12.123\t1234.5\n"
    "FORCE_PLATE_NAME\tForce-plate 1\nFORCE_PLATE_CORNER_POSX_POSY_X\t400.0\nCOORD_SYSTEM\tGlobal\n"
)
OF_QUALISYS = table(
    None, [*FORCES[:3], MM * MX, MM * MY, MM * MZ, MM * AP, MM * ML, 0 * TIME], "\t", 7
)
AXES_OF_QUALISYS = "\t".join(f"{of}_{axis}" for of in ("Force", "Moment", "COP") for axis in "XYZ")
OLD_VICON = (
    "Analog\n100,Hz\nSample #,FX1,FY1,FZ1,MX1,MY1,MZ1\nUnits:,N,N,N,Nmm,Nmm,Nmm\n\n"
    + table(None, [FRAME, *FORCES[:3], MM * MX, MM * MY, MM * MZ], decimals=6)
)
MOMENTS = ["Time (s)", "Fx (N)", "Fy (N)", "Fz (N)", "Mx (N·m)", "My (N·m)", "Mz (N·m)"]
QUOTED = '"t (s)","ap (mm)","ml (mm)"\n' + "".join(
    ",".join(f'"{n:.4f}"'.replace(".", ",") for n in row) + "\n"
    for row in zip(TIME, MM * AP, MM * ML, strict=True)
)


def clock(form, start=0.0, sep=","):
    """A table whose times are of a clock that begins at some seconds of a day."""
    rows = [form(start + t) for t in TIME]
    lines = [sep.join(["time", "ap (mm)", "ml (mm)"])]
    lines += [
        sep.join([at, f"{x:.5f}", f"{y:.5f}"])
        for at, x, y in zip(rows, MM * AP, MM * ML, strict=True)
    ]
    return "\n".join(lines) + "\n"


def of_day(seconds):
    whole = round(1e3 * seconds) % 86_400_000
    return f"{whole // 3_600_000:02}:{whole // 60_000 % 60:02}:{whole % 60_000 / 1e3:06.3f}"


def of_date(seconds):
    return f"2024-{'02-29' if seconds < 86_399.9995 else '03-01'} {of_day(seconds)}"


FORMATS = {
    "a clock": (clock(of_day, 45_000.0), {}),
    "a clock over midnight": (clock(of_day, 86_370.0), {}),
    "a clock with dates over midnight": (clock(of_date, 86_370.0), {}),
    "minutes and seconds": (clock(lambda t: f"{int(t // 60):02}:{t % 60:06.3f}"), {}),
    "a clock with decimal commas": (clock(lambda t: of_day(t).replace(".", ","), 60.0, ";"), {}),
    "a clock of whole seconds and the rate": (clock(lambda t: of_day(np.floor(t))), {"rate": 100}),
    "units in the names": (table(["time (s)", "COP_AP (mm)", "COP_ML (mm)"], [TIME, MM * AP, MM * ML]), {}),
    "other brackets": (table(["Time[s]", "CoP-X [cm]", "CoP-Y [cm]"], [TIME, CM * AP, CM * ML]), {}),
    "units without brackets": (table(["time_ms", "ap_mm", "ml_mm"], [MM * TIME, MM * AP, MM * ML]), {}),
    "metres": (table(["t", "COPx_m", "COPy_m"], [TIME, AP, ML], decimals=8), {}),
    "time in ms that says no unit": (table(["t", "COPx_m", "COPy_m"], [MM * TIME, AP, ML], decimals=8), {}),
    "columns of other names": (table(["t (s)", "vor (mm)", "seit (mm)"], [TIME, MM * AP, MM * ML]), {"ap": "Vor (mm)", "ml": "seit (mm)"}),
    "columns by number": (table(None, [TIME, MM * AP, MM * ML]), {"time": "1", "ap": "2", "ml": "3", "unit": "mm"}),
    "no time": (table(["COPx", "COPy"], [MM * AP, MM * ML]), {"unit": "mm", "rate": 100}),
    "rate above": ("Sampling rate: 100 Hz\nFilter frequency,10\n" + table(["COPx (mm)", "COPy (mm)"], [MM * AP, MM * ML]), {}),
    "rate and time": (table(["t", "COPx (mm)", "COPy (mm)"], [TIME, MM * AP, MM * ML]), {"rate": 99.9}),
    "y is anterior-posterior": (table(["t", "COPx (mm)", "COPy (mm)"], [TIME, MM * ML, MM * AP]), {"ap": "y"}),
    "x is mediolateral": (table(["t", "COPx (mm)", "COPy (mm)"], [TIME, MM * ML, MM * AP]), {"ml": "X"}),
    "semicolons, decimal commas": (table(["t (s)", "ap (mm)", "ml (mm)"], [TIME, MM * AP, MM * ML], ";", comma=True), {}),
    "tabs, three decimals by commas": (table(["ap (mm)", "ml (mm)"], [MM * AP, MM * ML], "\t", 3, comma=True), {"rate": 100}),
    "decimal commas in quotes": (QUOTED, {}),
    "blanks": ("% a comment\n" + table(["Time[s]", "COPx[mm]", "COPy[mm]"], [TIME, MM * AP, MM * ML], "   "), {}),
    "Windows": (table(["t (s)", "ap (mm)", "ml (mm)"], [TIME, MM * AP, MM * ML]).replace("\n", "\r\n"), {}),
    "forces and moments": (table(MOMENTS, [TIME, *FORCES], decimals=7), {"surface": 0.04}),
    "moments in N·mm of --unit": (table(["t", "Fx", "Fy", "Fz", "Mx", "My"], [TIME, *FORCES[:3], MM * MX, MM * MY]), {"surface": 0.04, "unit": "Nmm"}),
    "forces down, moments with them": (table(MOMENTS, [TIME, *(-each for each in FORCES)], decimals=7), {"surface": 0.04}),
    "Vicon": (VICON, {}),
    "Vicon with more below": (VICON + "\nTrajectories\n100\nFrame,X,Y\n,mm,mm\n1,2,3\n2,2,3\n", {}),
    "OptiTrack": (MOTIVE + table(None, OF_MOTIVE, decimals=8), {"unit": "m"}),
    "Qualisys": (QUALISYS + AXES_OF_QUALISYS + "\n" + OF_QUALISYS, {"unit": "mm"}),
    "Qualisys without names": (QUALISYS + OF_QUALISYS, {"unit": "mm", "ap": "7", "ml": "8"}),
    "Vicon, older": (OLD_VICON, {"surface": 0.04}),
    "Kistler": (BIOWARE + table(None, [TIME, FX, FY, FZ, FZ, AP, ML], "\t", 8), {}),
    "Kistler, decimal commas": (BIOWARE + table(None, [TIME, FX, FY, FZ, FZ, AP, ML], "\t", 8, comma=True), {}),
}  # fmt: skip
ROUNDED = 6e-7  # m: of three decimals of a mm


@pytest.mark.parametrize("name", FORMATS)
def test_the_sway_is_the_same(tmp_path, name):
    text, options = FORMATS[name]
    path = tmp_path / "a.txt"
    path.write_text(text, encoding="utf-8")
    found = sf.read_recording(path, **options)
    assert found.rate == pytest.approx(options.get("rate", 100.0), rel=2e-3)
    np.testing.assert_allclose(found.ap, AP, rtol=0, atol=ROUNDED)
    np.testing.assert_allclose(found.ml, ML, rtol=0, atol=ROUNDED)
    by_axis = any(word in text.lower() for word in ("copx", "cop-x", "cop_x", "cx", "\tax", "mx"))
    said = any("x is taken as anterior-posterior" in remark for remark in found.remarks)
    assert said == (by_axis and not {"ap", "ml"} & {*options})


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_the_encoding_does_not_matter(tmp_path, encoding):
    path = tmp_path / "a.csv"
    path.write_text(table(MOMENTS, [TIME, *FORCES], ";", 7, comma=True), encoding=encoding)
    np.testing.assert_allclose(sf.read_recording(path, surface=0.04).ap, AP, atol=ROUNDED)


def test_the_origin_of_moments_matters(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(table(MOMENTS, [TIME, *FORCES], decimals=7), encoding="utf-8")
    at_origin = sf.read_recording(path)
    np.testing.assert_allclose(at_origin.ap, AP - 0.04 * FX / FZ, rtol=0, atol=ROUNDED)
    np.testing.assert_allclose(at_origin.ml, ML - 0.04 * FY / FZ, rtol=0, atol=ROUNDED)


def test_times_of_few_digits_give_the_rate(tmp_path):
    time, ap, ml = sway(rate=1024.0, seconds=10.0)
    path = tmp_path / "a.csv"
    path.write_text(table(["t (s)", "ap (m)", "ml (m)"], [time, ap, ml], decimals=3))
    path.write_text(
        "t (s),ap (m),ml (m)\n"
        + "".join(f"{t:.3f},{a:.9f},{b:.9f}\n" for t, a, b in zip(time, ap, ml, strict=True))
    )
    found = sf.read_recording(path)
    assert found.rate == pytest.approx(1024.0, rel=1e-4)
    np.testing.assert_allclose(found.ap, ap, rtol=0, atol=1e-9)


def test_short_gaps_are_filled_and_told(tmp_path):
    """Rows without time, empty cells and rows that are not there, alike."""
    path = tmp_path / "a.csv"
    lines = table(["t (s)", "ap (mm)", "ml (mm)"], [TIME, MM * AP, MM * ML]).splitlines()
    lines[1000] = lines[1000].split(",")[0] + ",NaN,"
    lines[1001] = lines[1001].split(",")[0] + ",,3"
    del lines[3000:3005]
    path.write_text("\n".join(lines))
    found = sf.read_recording(path)
    assert found.ap.size == 6000
    wrong = np.flatnonzero(np.abs(found.ap - AP) > ROUNDED)
    assert set(wrong) <= {999, 1000, *range(2999, 3004)}
    np.testing.assert_allclose(found.ap, AP, rtol=0, atol=2e-5)  # of a line through 50 ms
    assert found.remarks == (
        "7 samples are missing in 2 places (the first after 9.98 s, line 1000) and filled along "
        "straight lines",
    )


def test_a_row_of_zeros_in_all_channels_is_a_missing_sample(tmp_path):
    """What OptiTrack writes where the plate sent nothing."""
    lines = (MOTIVE + table(None, OF_MOTIVE, decimals=8)).splitlines()
    for at in (-300, -299):
        lines[at] = ",".join([*lines[at].split(",")[:3], *["0.000000"] * 9])
    path = tmp_path / "a.csv"
    path.write_text("\n".join(lines))
    found = sf.read_recording(path, unit="m")
    np.testing.assert_allclose(found.ap, AP, rtol=0, atol=2e-5)  # of a line through 30 ms
    assert any("2 samples are missing in one place" in remark for remark in found.remarks)


def test_missing_ends_are_left_out(tmp_path):
    path = tmp_path / "a.csv"
    lines = table(["ap (mm)", "ml (mm)"], [MM * AP, MM * ML]).splitlines()
    lines[1:31], lines[-20:] = [","] * 30, ["0.0,0.0"] * 20
    path.write_text("\n".join(lines))
    found = sf.read_recording(path, rate=100)
    np.testing.assert_allclose(found.ap, AP[30:-20], rtol=0, atol=ROUNDED)
    assert "50 samples are missing at the ends and left out" in found.remarks


def test_uneven_samples_are_interpolated_and_told(tmp_path):
    path = tmp_path / "a.csv"
    random = np.random.default_rng(4)
    time = np.cumsum(random.uniform(0.005, 0.014, size=7000))
    ap, ml = (2e-3 * np.sin(2 * np.pi * f * time) for f in (0.4, 0.7))
    path.write_text(table(["t (s)", "ap (mm)", "ml (mm)"], [time, MM * ap, MM * ml]))
    found = sf.read_recording(path)
    again = 2e-3 * np.sin(2 * np.pi * 0.4 * (found.time + time[0]))
    np.testing.assert_allclose(found.ap, again, rtol=0, atol=1e-6)
    assert "samples are not evenly spaced in time" in found.remarks[0]


def test_a_recording_may_be_of_arrays():
    found = sf.Recording(AP.tolist(), ML, 100)
    assert found.duration == pytest.approx(59.99)
    assert found.remarks == ()
    with pytest.raises(ValueError, match="read-only"):
        found.ap[0] = 1.0
