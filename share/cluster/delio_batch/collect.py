"""What a batch has come to: table.tsv, failed.tsv, one page of delio-eval, a chart for each swept option."""
import os
import shutil

from . import chart, slurm
from .base import last_line, plain, read_json, remove_file, replace_file, run_tool, say, say_some, say_table
from .batch import Batch, Task

SCORES = ("length_m", "segments", "t_percent", "r_deg_per_100m", "ape_m", "rpe_m", "rpe_deg")
MOST_ON_A_PAGE = 200  # results that delio-eval draws: share/doc/scale.md


def outcome(batch: Batch, task: Task, running: set, waiting: set) -> tuple:
    """A word (done, running, waiting, failed or lost) and what is known. `running` and `waiting`: what the queue
    has; for a run on this machine all that may run."""
    if batch.is_done(task):
        return "done", read_json(batch.record(task))
    state = batch.state(task)
    word = state.get("state", "waiting")
    if word in ("failed", "killed"):
        return "failed", state
    if task.number in running:
        return ("running" if word == "running" else "waiting"), state
    if task.number in waiting or word == "waiting":
        return "waiting", state
    if word == "running":
        return "lost", {**state, "line": f"stopped without a message on {state.get('host', '?')} "
                                         "(killed with all its processes: limits of time or memory, or the node)"}
    return "failed", state  # stopped, and not in the queue again


def in_queue(batch: Batch) -> tuple:
    """Tasks that may run, and tasks that wait."""
    everything = {task.number for task in batch.tasks}
    if batch.is_locked():
        return everything, set()
    found = slurm.queued(batch)
    return (everything, set()) if found is None else (found[0], found[1])


def _columns(batch: Batch) -> list:
    return (["variant", "drive", "profile"] + list(batch.settings.get("swept", {})) +
            ["state", "scans", "predicted"] + list(SCORES) +
            ["cpu_hours", "hours", "peak_mb", "attempts", "host", "remark", "input"])


def _row(batch: Batch, task: Task, word: str, known: dict) -> dict:
    row = {"variant": task.variant, "drive": task.drive, "profile": task.profile, **task.values, "state": word,
           "host": known.get("host", ""), "attempts": str(known.get("attempts", 0)), "input": task.input,
           "remark": known.get("line", known.get("unscored", ""))}
    if word == "done":
        row.update({name: str(known.get(name, "")) for name in ("scans", "predicted", "peak_mb")})
        row.update({name: known.get("scores", {}).get(name, "-") for name in SCORES})
        row["cpu_hours"] = f"{known.get('cpu_s', 0) / 3600:.6f}"
    if word in ("done", "failed"):
        row["hours"] = f"{known.get('seconds', 0) / 3600:.6f}"
    return row


def _tsv(columns: list, rows: list) -> str:
    lines = ["\t".join(columns)]
    lines += ["\t".join(plain(str(row.get(name, ""))) for name in columns) for row in rows]
    return "\n".join(lines) + "\n"


def _draw_page(batch: Batch, scored: list) -> str:
    """The page of all results with scores; what was wrong with it, if anything. delio-eval's table goes to stdout."""
    shutil.rmtree(batch.path("report"), ignore_errors=True)
    drives: dict = {}
    for task, known in scored:
        drives.setdefault(task.drive, []).append((task, "scores" in known))
    # What delio-eval refuses of one variant would cost the page.
    usable = {drive: tasks for drive, tasks in drives.items() if all(good for _, good in tasks)}
    if len(scored) > MOST_ON_A_PAGE:
        say(f"{len(scored)} results are too many for a report; see {batch.path('table.tsv')}")
        return ""
    compare = batch.settings.get("compare", [])
    variants = list(dict.fromkeys(task.variant for tasks in usable.values() for task, _ in tasks))
    if not variants:
        say("no result has ground truth: no report is written")
        return ""
    truths = batch.work(f"truth.{os.getpid()}")
    os.makedirs(truths)
    try:
        for drive, tasks in usable.items():
            os.symlink(tasks[0][0].truth, os.path.join(truths, drive + ".txt"))
        words = ["delio-eval", "--ref", truths, "-o", batch.path("report"), "--force"]
        if batch.settings.get("lengths"):
            words += ["--lengths", batch.settings["lengths"]]
        for variant in variants:
            words += ["--est", f"DeLiO {variant.replace('=', ' ')}={batch.path(variant)}"]
        for other in compare:
            words += ["--est", other]
        done = run_tool(words)
    finally:
        shutil.rmtree(truths, ignore_errors=True)
    if done.returncode != 0:
        return last_line(done.stderr) or "delio-eval said nothing"
    for line in done.stderr.splitlines():
        if ": warning: " in line:
            say(line.partition(": ")[2])
    say_table(done.stdout)
    return ""


def collect(batch: Batch, running: set = frozenset(), waiting: set = frozenset()) -> int:
    """0 if all is done, else 1."""
    rows, failures, scored, counts = [], [], [], {}
    for task in batch.tasks:
        word, known = outcome(batch, task, running, waiting)
        counts[word] = counts.get(word, 0) + 1
        rows.append(_row(batch, task, word, known))
        if word in ("failed", "lost"):
            failures.append({"variant": task.variant, "drive": task.drive, "exit": known.get("exit", "-"),
                             "line": known.get("line", ""), "log": batch.log(task), "input": task.input})
        if word == "done" and ("scores" in known or "unscored" in known):
            scored.append((task, known))
    try:
        os.rmdir(batch.work("scratch"))
    except OSError:
        pass  # there is none, or tasks work in it
    replace_file(batch.path("table.tsv"), _tsv(_columns(batch), rows))
    if failures:
        replace_file(batch.path("failed.tsv"),
                     _tsv(["variant", "drive", "exit", "line", "log", "input"], failures))
    else:
        remove_file(batch.path("failed.tsv"))
    fault = _draw_page(batch, scored)
    charts = chart.draw(batch, rows)
    say_some([f"{failure['drive']}, {failure['variant']}: failed: {failure['line']}" for failure in failures])
    _summarise(batch, rows, counts, fault, charts)
    return 0 if counts.get("done", 0) == len(batch.tasks) and not fault else 1


def _summarise(batch: Batch, rows: list, counts: dict, fault: str, charts: list) -> None:
    total = sum(float(row.get("cpu_hours") or 0) for row in rows)
    peak = max((float(row.get("peak_mb") or 0) for row in rows), default=0)
    say(f"{counts.get('done', 0)} of {len(rows)} tasks done" +
        "".join(f", {counts[word]} {word}" for word in ("failed", "lost", "running", "waiting") if counts.get(word)) +
        f"; {total:.3f} CPU hours, {peak:.0f} MB peak memory")
    if fault:
        say(f"the report failed: {fault}")
    elif os.path.exists(batch.path("report", "report.html")):
        say(f"report: {batch.path('report', 'report.html')}")
    say("table: " + ", ".join([batch.path("table.tsv")] + charts))
    if counts.get("failed") or counts.get("lost"):
        say(f"failed tasks are listed in {batch.path('failed.tsv')}; --retry repeats them")

