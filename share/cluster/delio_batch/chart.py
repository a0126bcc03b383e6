"""A picture for each option that a batch has swept: what it does to the error and to the time."""
import os
import re
import shutil
import subprocess

from .base import partial_folder, remove_file, say


def _mean(values: list) -> str:
    return f"{sum(values) / len(values):.9g}" if values else "NaN"


def _numbers(texts: list) -> list:
    try:
        return [float(text) for text in texts]
    except ValueError:
        return []


def _quoted(text: str) -> str:
    """As a string of gnuplot, which takes '' for '."""
    return "'" + text.replace("'", "''") + "'"


def _error_of(rows: list) -> tuple:
    """Name and column of the error that most drives are long enough for."""
    for column, name in (("t_percent", "translation [%]"), ("rpe_m", "RPE [m]")):
        if any(_numbers([row.get(column, "-")]) for row in rows):
            return column, name
    return "", ""


def _lines(rows: list, key: str, swept: dict, value) -> dict:
    """Of each combination of everything else: mean of `value` over drives at each value of `key`, of those
    drives that were done at all of them."""
    lines: dict = {}
    for row in rows:
        rest = ", ".join([row["profile"]] + [f"{other} {row[other]}" for other in swept if other != key])
        lines.setdefault(rest, {}).setdefault(row["drive"], {})[row[key]] = value(row)
    means = {}
    for rest, drives in lines.items():
        whole = [of for of in drives.values() if all(of.get(at) is not None for at in swept[key])]
        means[rest] = [(at, _mean([of[at] for of in whole])) for at in swept[key]]
    return means


def _panel(title: str, lines: dict, places: dict) -> tuple:
    """Data and the plot command of a panel."""
    data, plots = "", []
    for number, (rest, points) in enumerate(lines.items()):
        block = f"${title[:3]}{number}"
        ordered = sorted((places[at], mean) for at, mean in points)
        data += f"{block} << EOD\n" + "".join(f"{place} {mean}\n" for place, mean in ordered) + "EOD\n"
        plots.append(f"{block} using 1:2 with linespoints pt 7 title {_quoted(rest)}")
    return data, f"set ylabel {_quoted(title)}\nplot " + ", ".join(plots) + "\n"


def _script(rows: list, key: str, swept: dict, picture: str) -> str:
    values = swept[key]
    numbers = _numbers(values)
    places = dict(zip(values, numbers or range(len(values))))
    ticks = ", ".join(f"{_quoted(at)} {place}" for at, place in places.items())
    column, name = _error_of(rows)

    def error(row):
        number = _numbers([row.get(column, "-")])
        return number[0] if number else None

    def time(row):
        scans = int(row.get("scans") or 0)
        return 3.6e6 * float(row["cpu_hours"]) / scans if scans and row.get("cpu_hours") else None

    panels = [_panel("CPU time [ms a scan]", _lines(rows, key, swept, time), places)]
    if column:
        panels.insert(0, _panel(name, _lines(rows, key, swept, error), places))
    return (f"set terminal pngcairo size 1000,{450 * len(panels)} noenhanced font 'sans-serif,11'\n"
            f"set output {_quoted(picture)}\nset datafile missing 'NaN'\nset key outside top\nset grid\n"
            f"set format y '%.10g'\n"  # gnuplot's own has five decimals: neighbouring ticks may read the same
            f"set offsets graph 0.05, graph 0.05, graph 0.1, graph 0.1\n"
            f"set xlabel {_quoted(key)}\nset xtics ({ticks})\n" + "".join(data for data, _ in panels) +
            f"set multiplot layout {len(panels)},1\n" + "".join(plot for _, plot in panels))


def draw(batch, rows: list) -> list:
    """The pictures' names."""
    swept = batch.settings.get("swept", {})
    done = [row for row in rows if row["state"] == "done"]
    pictures = []
    for key in swept:
        picture = batch.path("sweep-" + re.sub(r"[^A-Za-z0-9_.-]", "_", key) + ".png")
        remove_file(picture)
        if not done:
            continue
        if not shutil.which("gnuplot"):
            say("charts of sweeps need gnuplot; install the package gnuplot-nox")
            return []
        with partial_folder(picture) as folder:
            partial = os.path.join(folder, "chart.png")
            drawn = subprocess.run(["gnuplot"], input=_script(done, key, swept, partial), text=True,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False)
            is_drawn = drawn.returncode == 0 and os.path.exists(partial)
            if is_drawn:
                os.replace(partial, picture)
        if is_drawn:
            pictures.append(picture)
        else:
            say(f"the chart of {key} failed: {(drawn.stderr.strip().splitlines() or ['?'])[-1]}")
    return pictures
