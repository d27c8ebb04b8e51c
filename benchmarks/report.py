"""One page and two figures from all benchmark results: ``results/benchmarks/README.md``.

Run as ``python benchmarks/report.py`` after the others; ``make bench`` does all.
"""

import json
from typing import Any

from harness import RESULTS, ROOT
from standfast.figures import style

ORDER = (
    "verdicts", "storing", "peers", "feedback", "sway", "population", "workers", "growth",
    "startup", "explore", "tricks", "cost",
)  # fmt: skip
HEAD = """# Benchmarks

Made by `make bench` (about twenty minutes on two cores), but for the page of `standfast explore`,
whose script needs a browser; each script of `benchmarks/` answers one
question and writes one JSON file here, from which this page is made. Compare rows of one table:
all of it was measured in one run, job after job, and medians are told. Machines differ and are
noisy; the ratios are what counts.
"""
# Rows of the figure beside peers: words in the report, words in the figure.
BESIDE = {
    "standfast: three eigenvalues a point": "standfast",
    "numpy.linalg.eigvalsh, batched, matrices already reduced": "NumPy, batched",
    "jax.vmap(jnp.linalg.eigvalsh), matrices already reduced": "JAX, vmap",
    "loop over scipy.linalg.eigh(C, A)": "SciPy, loop",
    "standfast: verdicts, certified": "standfast",
    "numba, parallel, the same closed form": "numba",
    "xyzpy, a call a point": "xyzpy",
    "pipefunc, a call a point": "pipefunc",
}


def main() -> None:
    """Write the page and the figures."""
    reports = [
        json.loads(path.read_text(encoding="utf-8"))
        for name in ORDER
        if (path := RESULTS / f"{name}.json").exists()
    ]
    text = [HEAD]
    text += _demands(reports)
    for report in reports:
        text += _section(report)
    _draw_peers(next(report for report in reports if report["name"] == "peers"))
    _draw_growth(next(report for report in reports if report["name"] == "growth"))
    _draw_sway(next(report for report in reports if report["name"] == "sway"))
    (RESULTS / "README.md").write_text("\n".join(text) + "\n", encoding="utf-8")
    print((RESULTS / "README.md").relative_to(ROOT))


def _demands(reports: list[dict[str, Any]]) -> list[str]:
    """Return the table of what is asked of standfast, and whether it holds."""
    rows = ["| what | wanted | found | |", "|---|---|---|---|"]
    for report in reports:
        for each in report["demands"]:
            sign = "at most" if each["most"] else "at least"
            mark = "met" if each["met"] else "**not met**"
            rows.append(
                f"| {each['what']} | {sign} {each['wanted']:g} | {each['found']:.3g} | {mark} |"
            )
    figure = "![Points a second beside peers, logarithmic](peers.png)"
    return ["## What was asked for, as ratios within one run\n", *rows, "", figure, ""]


def _section(report: dict[str, Any]) -> list[str]:
    """Return one report as a table."""
    machine, versions = report["machine"], report["versions"]
    packages = ", ".join(f"{name} {version}" for name, version in versions.items())
    device = f", computing on {machine['computes_on']}" if machine["computes_on"] else ""
    lines = [
        f"## {report['question']}\n",
        f"`python benchmarks/{report['name']}.py`: {report['settings']}.",
        f"{machine['processor']}, {machine['cores']} cores, {machine['system']}{device}, Python "
        f"{machine['python']}; {packages}.\n",
    ]
    if report["rows"]:
        lines += ["| what | rate | seconds, median (range) | |", "|---|---|---|---|"]
    for row in report["rows"]:
        seconds = sorted(row["seconds"])
        middle = seconds[len(seconds) // 2]
        lines.append(
            f"| {row['what'].strip()} | {row['work'] / middle:.3g} {row['unit']}/s | {middle:.3g} "
            f"({seconds[0]:.3g} … {seconds[-1]:.3g}) | {row['accuracy']} |"
        )
    lines += ["", *(f"- {each}" for each in report["limitations"]), ""]
    if report["name"] == "growth":
        lines += ["![Seconds over points](growth.png)", ""]
    if report["name"] == "sway":
        lines += _near_the_threshold(report)
    return lines


def _near_the_threshold(report: dict[str, Any]) -> list[str]:
    """Return the table of what sway costs near the critical delay, and its figure."""
    lines = [
        "Near the threshold, the CoP's variance of the same persons at a delay below the critical "
        "one by a part d of it; left open are those whose integral did not come out:\n",
        "| d | persons | intervals a person | SD of the CoP, median (mm) | worst error | of 99 % | "
        "left open |",
        "|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {row['distance']:g} | {row['persons']} | {row['intervals']:.0f} | "
        f"{1e3 * row['deviation']:.3g} | {row['worst']:.0e} | {row['of 99 %']:.0e} | "
        f"{row['left open']} |"
        for row in report["extra"]["near"]
    ]
    return [*lines, "", "![Intervals and errors near the critical delay](sway.png)", ""]


def _draw_peers(report: dict[str, Any]) -> None:
    """Draw rates beside peers, on a logarithmic axis."""
    rows = [row for row in report["rows"] if row["what"] in BESIDE]
    kinds = (("eigen", "three eigenvalues a point"), ("verdict", "verdicts"))
    groups = [[row for row in rows if _kind(row) == kind] for kind, _ in kinds]
    with style.paper_figure(height=2.6, panels=(2, 1)) as (figure, axes):
        for ax, (_, title), group in zip(axes, kinds, groups, strict=True):
            runs = [[row["work"] / seconds for seconds in sorted(row["seconds"])] for row in group]
            names = [BESIDE[row["what"]] for row in group]
            ours = [name == "standfast" for name in names]
            colors = [style.BLUE if mine else "white" for mine in ours]
            places = range(len(group))[::-1]
            # dots, and a line through all runs: bars have no zero to start from on such an axis
            for place, each, color in zip(places, runs, colors, strict=True):
                rate = each[len(each) // 2]
                ax.plot([each[0], each[-1]], [place, place], color=style.BLUE, linewidth=2.5)
                ax.plot(
                    [rate], [place], "o", markerfacecolor=color, color=style.BLUE, markersize=4.5
                )
                ax.text(rate * 1.7, place, _short(rate), va="center", fontsize=6.5)
                ax.axhline(place, color="0.9", linewidth=0.5, zorder=0)
            ax.set_ylim(-0.6, len(group) - 0.4)
            ax.set_yticks(places, names)
            ax.set_xscale("log")
            ax.set_xlim(1e3, 2e11)
            ax.set_title(title, loc="left")
        axes[-1].set_xlabel("Points a second")
        style.save(figure, RESULTS / "peers", ("png",))


def _kind(row: dict[str, Any]) -> str:
    return "eigen" if "eig" in row["what"] else "verdict"


def _short(rate: float) -> str:
    for size, word in ((1e9, "billion"), (1e6, "million"), (1e3, "thousand")):
        if rate >= size:
            return f"{rate / size:.3g} {word}"
    return f"{rate:.3g}"


def _draw_growth(report: dict[str, Any]) -> None:
    """Draw the seconds of a whole command over the number of points."""
    rows = [row for row in report["rows"] if "verdicts" in row["what"]]
    with style.paper_figure(height=2.3) as (figure, (ax,)):
        points = [row["work"] for row in rows]
        seconds = [sorted(row["seconds"])[len(row["seconds"]) // 2] for row in rows]
        ax.plot(points, seconds, "o-", color=style.BLUE, label="time")
        for x, y, row in zip(points, seconds, rows, strict=True):
            ax.annotate(
                row["accuracy"],
                (x, y),
                (0, 6),
                textcoords="offset points",
                ha="center",
                fontsize=6.5,
            )
        ax.set_xscale("log")
        ax.set_ylim(0.0, 1.35 * max(seconds))
        ax.set_xlim(4e3, 3e9)
        ax.set_xlabel("Verdicts computed and stored")
        ax.set_ylabel("Whole command (s)")
        ax.text(0.02, 0.04, "beside the points: peak memory", transform=ax.transAxes, fontsize=7)
        style.save(figure, RESULTS / "growth", ("png",))


def _draw_sway(report: dict[str, Any]) -> None:
    """Draw what sway costs near the critical delay, and how large its errors are."""
    near = report["extra"]["near"]
    distance = [row["distance"] for row in near]
    with style.paper_figure(height=2.3, width=style.PAGE * 0.75, panels=(1, 2)) as (figure, axes):
        cost, error = axes
        cost.plot(distance, [row["intervals"] for row in near], "o-", color=style.BLUE)
        cost.set_ylim(0.0, 1.1 * max(row["intervals"] for row in near))
        cost.set_ylabel("Intervals of ω a person")
        for name, line, label in (("worst", "o-", "worst"), ("of 99 %", "s--", "of 99 %")):
            values = [row[name] for row in near]
            error.plot(distance, values, line, color=style.BLUE, markersize=4.0, label=label)
        error.axhline(1e-6, color="black", linewidth=0.8)
        error.text(distance[-1], 1.2e-6, "promised", ha="right", va="bottom", fontsize=7)
        error.set(yscale="log", ylim=(1e-9, 1e-5), ylabel="Relative error of a variance")
        error.legend(frameon=False, loc="upper left")
        for ax in axes:
            ax.set(xscale="log", xlabel="Delay left, part of the critical delay")
            ax.invert_xaxis()
        style.save(figure, RESULTS / "sway", ("png",))


if __name__ == "__main__":
    main()
