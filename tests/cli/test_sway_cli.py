"""``standfast sway``: the library's numbers in the field's units: text, JSON, CSV, figures."""

import csv
import io
import json

import numpy as np
import pytest

import standfast as sf
from recordings import sway, table, write_two_plates
from standfast.cli.app import main
from standfast.figures.recording import course, spectra, statokinesigram
from standfast.figures.style import paper_figure
from standfast.recordings.measures import MEASURES, cop_spectrum

MM = 1e3


@pytest.fixture
def files(tmp_path):
    """Two recordings, one of which says no unit and no rate."""
    for name, seed, names in (
        ("a.csv", 1, ["t (s)", "COP_AP (mm)", "COP_ML (mm)"]),
        ("b.csv", 2, ["t (s)", "COPx", "COPy"]),
    ):
        time, ap, ml = sway(seed)
        text = table(names, [time, MM * ap, MM * ml], decimals=9)
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path / "a.csv", tmp_path / "b.csv"


def said(capsys, *command, code=0):
    assert main(["sway", *map(str, command)]) == code
    out, err = capsys.readouterr()
    return err if code else out


def test_one_recording_has_a_line_a_measure(files, capsys):
    found = sf.sway_measures(sf.read_recording(files[0]))
    lines = said(capsys, files[0]).splitlines()
    assert lines[0] == f"{files[0]}: 60 s at 100 Hz, no filter"
    printed = {" ".join(line.split()[:-2]): line.split()[-2:] for line in lines[3:]}
    for name, row in MEASURES.items():
        unit, number = printed[row.meaning]
        assert unit == row.printed
        assert float(number) == pytest.approx(row.factor * getattr(found, name), rel=1e-3)
    assert not any("note:" in line for line in lines)


def test_several_have_a_line_each_and_what_is_to_be_said(files, capsys):
    lines = said(capsys, *files, "--unit", "mm", "--low-pass", "10").splitlines()
    assert lines[0] == "2 recordings, low-pass at 10 Hz"
    rows = [line.split() for line in lines if line.startswith(f"  {files[0].parent}")]
    for path, row in zip(files, rows, strict=True):
        found = sf.sway_measures(sf.read_recording(path, unit="mm"), low_pass=10.0)
        assert float(row[2]) == pytest.approx(1e6 * found.area, rel=1e-3)
        assert float(row[5]) == pytest.approx(1e3 * found.mean_velocity, rel=1e-3)
    assert lines[-1] == (
        f"  note: {files[1]}: x is taken as anterior-posterior and y as mediolateral, as Santos & "
        "Duarte have it; if the plate lies otherwise write --ap y"
    )


def test_json_is_in_si(files, capsys):
    found = json.loads(said(capsys, files[1], "--unit", "mm", "--ap", "y", "--json"))
    measures = sf.sway_measures(sf.read_recording(files[1], unit="mm", ap="y"))
    (one,) = found["recordings"]
    assert one["measures"] == measures._asdict()
    assert (one["samples"], one["rate"], one["remarks"]) == (6000, 100.0, [])
    assert found["units"]["area"] == "m²"
    assert found["low_pass"] is None


def test_the_table_has_the_units_in_its_names_and_replaces_only_its_like(files, capsys):
    path = files[0].parent / "t.csv"
    for _ in range(2):
        assert f"Written: {path}" in said(capsys, *files, "--unit", "mm", "--csv", path)
    rows = list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8"))))
    found = sf.sway_measures(sf.read_recording(files[1], unit="mm"))
    assert [row["recording"] for row in rows] == list(map(str, files))
    assert float(rows[1]["area_mm2"]) == pytest.approx(1e6 * found.area, rel=1e-7)
    assert float(rows[1]["mean_velocity_mm_s"]) == pytest.approx(1e3 * found.mean_velocity)
    other = files[0].read_bytes()
    assert "choose another name" in said(capsys, files[0], "--csv", files[0], code=2)
    assert files[0].read_bytes() == other


def test_all_that_are_refused_are_named_and_nothing_is_written(files, capsys):
    short = files[0].parent / "c.csv"
    short.write_text("ap (mm),ml (mm)\n1,2\n2,1\n", encoding="utf-8")
    path = files[0].parent / "t.csv"
    message = said(capsys, *files, short, "--csv", path, code=2)
    assert message.startswith("standfast: 2 of 3 recordings cannot be used: ")
    assert f"{files[1]}: the column 'COPx' says no unit; write --unit m, --unit cm or" in message
    assert f"{short}: there is no column of time; name one time (s), or say the sam" in message
    assert "--rate 100 (columns there" in message
    assert not path.exists()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (["--rate", "fast"], "--rate = 'fast' is not a number"),
        (["--rate", "5"], "--rate = 5 Hz is outside of 20 to 10,000 Hz"),
        (["--rate", "50"], "the column of time says 100 Hz, and --rate 50 is given"),
        (["--low-pass", "60"], "--low-pass = 60.0 is not between 0 and half of the rate (100 Hz)"),
        (["--surface", "40"], "--surface = 40.0 is not a height of -0.3 to 0.3 m, is it in mm?"),
        (["--ap", "7", "--ml", "2"], "--ap = '7' names no column; give a name or a number from 1"),
        (["--unit", "cm"], "--unit cm is not what the column 'COP_AP (mm)' says"),
        (["-o", "a.jpg"], "a.jpg is not the name of a figure; end it in .png, .svg or .pdf"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_by_its_option(files, capsys, options, sentence):
    assert sentence in said(capsys, files[0], *options, code=2)


def test_the_name_of_a_file_stays_as_it_is(tmp_path, capsys):
    path = tmp_path / "rate=100 unit=mm.csv"
    path.write_text("t,COPx,COPy\n0,1,2\n0.01,1,3\n0.02,2,3\n", encoding="utf-8")
    message = said(capsys, path, code=2)
    assert f"{path}: the column 'COPx' says no unit; write --unit m, --unit cm or" in message


def test_figures_of_one_and_of_several(files, capsys):
    folder = files[0].parent
    said(capsys, files[0], "-o", folder / "one.pdf")
    assert (folder / "one.pdf").read_bytes().startswith(b"%PDF")
    said(capsys, *files, "--unit", "mm", "-o", f"{folder / 'figures'}/")
    drawn = sorted(path.name for path in (folder / "figures").iterdir())
    assert drawn == ["a-sway.png", "b-sway.png"]
    message = said(capsys, *files, "--unit", "mm", "-o", folder / "both.png", code=2)
    assert "2 recordings have a figure each; give a folder, as -o NAME/" in message
    message = said(capsys, files[0], files[0], "-o", folder, code=2)
    assert "two recordings would be drawn into" in message


def test_what_is_drawn_is_the_recording(files):
    recording = sf.read_recording(files[0])
    measures = sf.sway_measures(recording)
    with paper_figure(panels=(1, 3)) as (_, axes):
        statokinesigram(axes[0], recording.ap, recording.ml)
        course(axes[1], recording.time, recording.ap, recording.ml)
        spectra(axes[2], cop_spectrum(recording), measures)
        path, ellipse = (line.get_xydata() for line in axes[0].lines)
        ap, ml, *_ = (line.get_xydata() for line in axes[1].lines)
        density = axes[2].lines[0].get_xydata()
    np.testing.assert_allclose(np.ptp(path[:, 1]), MM * measures.range_ap, rtol=1e-9)
    # the shoelace formula
    area = 0.5 * abs(np.sum(ellipse[:-1, 0] * ellipse[1:, 1] - ellipse[1:, 0] * ellipse[:-1, 1]))
    np.testing.assert_allclose(area, 1e6 * measures.area, rtol=1e-3)  # of a polygon
    np.testing.assert_allclose(np.ptp(ap[:, 1]), MM * measures.range_ap, rtol=0.01)  # thinned
    assert ap[:, 1].min() > ml[:, 1].max()
    assert density[0, 0] == pytest.approx(1.0 / 30.0)


def test_standard_input_is_a_recording(files, capsys, monkeypatch):
    with files[0].open("rb") as stream:
        monkeypatch.setattr("builtins.open", lambda *_, **__: stream)
        text = said(capsys, "-")
    assert text.startswith("standard input: 60 s at 100 Hz")


def test_the_help_has_an_example_that_runs(files, capsys, monkeypatch):
    with pytest.raises(SystemExit):
        main(["sway", "--help"])
    (line,) = [x for x in capsys.readouterr().out.splitlines() if x.startswith("example: ")]
    monkeypatch.chdir(files[0].parent)
    files[1].rename("recording.csv")
    assert main(line.split()[2:]) == 0
    assert (files[0].parent / "recording.png").exists()


@pytest.fixture
def two_plates(tmp_path):
    path = tmp_path / "two.csv"
    write_two_plates(path)
    return path


def test_several_plates_have_their_places_by_options(two_plates, capsys):
    found = json.loads(said(capsys, two_plates, "--plate", "2=0,0.6", "--json"))["recordings"][0]
    measures = sf.sway_measures(sf.read_recording(two_plates, plate={"2": (0, 0.6)}))
    assert found["measures"] == measures._asdict()
    alone = json.loads(said(capsys, two_plates, "--plate", "1", "--json"))["recordings"][0]
    assert alone["measures"] == sf.sway_measures(sf.read_recording(two_plates, plate="1"))._asdict()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ([], "the axes of the plates (m), as --plate 2=0,0.6, or (0, 0) if all columns are in one"),
        ([], "; --plate 1 reads one alone"),
        (["--plate", "3"], "--plate = '3' is not in the file; its plates are 1, 2"),
        (["--plate", "1", "--plate", "2"], "--plate 1: write where its origin lies, m, as --plate"),
        (["--plate", "2=0"], "--plate 2=0: write where its origin lies, m, as --plate 2=0,0.6"),
        (["--plate", "2=0,far"], "--plate 2 = 'far' is not a number"),
        (["--plate", "2=0,600"], "--plate = 2: [0.0, 600.0] is not two numbers of m"),
        (["--plate", "2=0,1", "--plate", "2=0,1"], "--plate 2 is given twice; give it one place"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_plates_is_said(two_plates, capsys, options, sentence):
    assert sentence in said(capsys, two_plates, *options, code=2)
