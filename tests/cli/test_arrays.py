"""Array jobs: the share of a task from a scheduler's variables, the script, workers by option."""

import subprocess

import pytest

import standfast as sf
from standfast.cli.app import main
from standfast.cli.arrays import share_of_array
from studies import GOOD, several_shards, toml_of

SLURM = ("SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_MAX",
         "SLURM_ARRAY_TASK_STEP", "SLURM_ARRAY_TASK_COUNT")  # fmt: skip
SGE = ("SGE_TASK_ID", "SGE_TASK_FIRST", "SGE_TASK_LAST", "SGE_TASK_STEPSIZE")
LSF = ("LSB_JOBINDEX", "LSB_JOBINDEX_END", "LSB_JOBINDEX_STEP")


def task(names, *values):
    return dict(zip(names, map(str, values), strict=True))


@pytest.mark.parametrize(("variables", "share"), [
    (task(SLURM, 1, 1, 8, 1, 8), (1, 8)),
    (task(SLURM, 0, 0, 7, 1, 8), (1, 8)),  # from zero
    (task(SLURM, 7, 0, 7, 1, 8), (8, 8)),
    (task(SLURM, 9, 1, 13, 4, 4), (3, 4)),  # stepped: 1, 5, 9, 13
    (task(SLURM[:4], 3, 1, 4, 1), (3, 4)),  # without the count
    (task(SGE, 5, 1, 9, 2), (3, 5)),
    (task(LSF, 4, 6, 1), (4, 6)),
])  # fmt: skip
def test_the_share_of_a_task(variables, share):
    assert share_of_array(variables) == share


@pytest.mark.parametrize("names", [("PBS_ARRAY_INDEX",), ("PBS_ARRAYID",)])
@pytest.mark.parametrize("first", [0, 1])
def test_with_the_number_of_tasks_every_share_comes_once(names, first):
    shares = [share_of_array(task(names, first + n), 5) for n in range(5)]
    assert sorted(shares) == [(n, 5) for n in range(1, 6)]
    with pytest.raises(sf.InputError, match=r"task 6 of .+ is none of 5 shares"):
        share_of_array(task(names, 6), 5)


@pytest.mark.parametrize(("variables", "sentence"), [
    ({}, "none of their variables is set"),
    (task(("PBS_ARRAY_INDEX",), 3), "PBS does not say how many tasks the array has"),
    (task(SLURM, 3, 1, 7, 1, 3), "not evenly numbered"),  # --array=1,3,7
    (task(SLURM, 3, 1, 7, 4, 2), "not evenly numbered"),
    (task(SGE, "undefined", 1, 9, 2), "none of their variables is set"),  # a job that is no array
    (task(LSF, 0, 0, 0), "none of their variables is set"),
])  # fmt: skip
def test_what_is_no_even_array_is_refused(variables, sentence):
    with pytest.raises(sf.InputError, match=sentence):
        share_of_array(variables)


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "study.toml").write_text(toml_of(several_shards()))
    for name in (*SLURM, *SGE, *LSF, "PBS_ARRAY_INDEX", "PBS_ARRAYID"):
        monkeypatch.delenv(name, raising=False)
    return tmp_path


def test_part_auto_is_the_share_of_the_array(place, whole, monkeypatch, capsys):
    for number in (0, 1):
        for name, value in task(SLURM, number, 0, 1, 1, 2).items():
            monkeypatch.setenv(name, value)
        assert main(["sweep", "study.toml", "--part", "auto"]) == 0
        out, err = capsys.readouterr()
        assert f"Share {number + 1}/2 of study.h5 is done" in out
        assert ("resumes" in err) == (number == 1)
    assert main(["sweep", "study.toml"]) == 0
    count = sf.Study.from_toml("study.toml").shard_count
    words = f"standfast: resumes from study.h5.parts: {count} of {count} shards (100%) are there\n"
    assert words in capsys.readouterr().err
    assert (place / "study.h5").read_bytes() == whole[1]


def test_part_auto_outside_an_array_says_so(place, capsys):
    with pytest.raises(SystemExit) as stop:
        main(["sweep", "study.toml", "--part", "auto"])
    assert stop.value.code == 2
    assert "none of their variables is set; give i/N" in capsys.readouterr().err


def test_a_share_without_work_says_so(place, capsys):
    assert main(["sweep", "study.toml", "--part", "1000/1000"]) == 0
    assert "has no work: " in capsys.readouterr().out
    assert [path.name for path in place.iterdir()] == ["study.toml"]


def test_the_job_script_is_a_script_that_shares_and_finishes(place, study, capsys):
    assert main(["sweep", "--job-script", "slurm", "study.toml", "-o", "my file.h5"]) == 0
    script = capsys.readouterr().out
    # a shell that has an sbatch of its own runs what would run on the cluster
    fake = 'sbatch() { cat > "job$1"; echo "7;cluster"; echo "$@" >&2; }\n'
    done = subprocess.run(["bash", "-c", fake + script], capture_output=True, text=True, check=True)
    array, finish = done.stderr.splitlines()
    assert f"--array=1-{study.shard_count}" in array
    assert "--dependency=afterany:7" in finish
    jobs = sorted(path.read_text() for path in place.glob("job*"))
    command = "standfast sweep study.toml -o 'my file.h5'"
    assert jobs == [f"#!/bin/bash\n{command}\n", f"#!/bin/bash\n{command} --part auto\n"]
    assert not (place / "my file.h5").exists()


def test_a_script_for_one_shard_is_refused(place, capsys):
    (place / "small.toml").write_text(toml_of(GOOD))
    assert main(["sweep", "--job-script", "slurm", "small.toml"]) == 2
    assert "is one shard of work" in capsys.readouterr().err


@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("options", [
    ["--workers", "2"], ["--executor", "processes", "--workers", "1"],
    ["--executor", "dask", "--workers", "2"],
])  # fmt: skip
def test_workers_by_option_make_the_same_file(options, place, monkeypatch):
    (place / "small.toml").write_text(toml_of(GOOD))
    assert main(["sweep", "small.toml", "-o", "here.h5"]) == 0
    assert main(["sweep", "small.toml", "-o", "there.h5", *options]) == 0
    assert (place / "here.h5").read_bytes() == (place / "there.h5").read_bytes()


@pytest.mark.parametrize(("options", "sentence"), [
    (["--scheduler", "tcp://127.0.0.1:1", "--executor", "processes"], "a Dask cluster that runs"),
    (["--scheduler", "tcp://127.0.0.1:1", "--workers", "2"], "a Dask cluster that runs"),
    (["--scheduler", "nonsense://x"], "no Dask scheduler answers at nonsense://x"),
])  # fmt: skip
@pytest.mark.filterwarnings("default")
def test_workers_that_cannot_be_are_refused(options, sentence, place, capsys):
    assert main(["sweep", "study.toml", *options]) == 2
    assert sentence in capsys.readouterr().err


def test_info_of_an_unfinished_file_says_what_is_missing_and_who_writes(place, study, capsys):
    def ask(found):
        assert main(["info", "study.h5"]) == 0

    sf.sweep(study, place / "study.h5", part=(2, 2))
    sf.sweep(study, place / "study.h5", part=(1, 3), estimate=ask)
    text = capsys.readouterr().out
    missing = list(range(0, study.shard_count, 2))
    assert f"missing: {', '.join(map(str, missing))}" in text
    assert "written by a run: process" in text
    assert main(["info", "study.h5"]) == 0
    assert "written by" not in capsys.readouterr().out
