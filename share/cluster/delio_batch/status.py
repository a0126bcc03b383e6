"""How far a batch is, from its folders and the queue."""

from . import slurm
from .base import plain, say, say_table
from .batch import Batch
from .collect import in_queue, outcome


def _duration(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.0f} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"


def _left(batch: Batch, found: dict) -> str:
    """Time to go, by what a byte took so far and how many tasks run now."""
    done = [(task, known) for task, known in found.get("done", []) if task.bytes and known.get("seconds")]
    left = [task for word in ("running", "waiting") for task, _ in found.get(word, [])]
    if not left:
        return ""
    if not done or not found.get("running"):
        return "ends: not known yet, " + ("no task is done" if not done else "no task runs")
    rate = sum(known["seconds"] for _, known in done) / sum(task.bytes for task, _ in done)
    work = rate * (sum(task.bytes for task in left) - 0.5 * sum(task.bytes for task, _ in found["running"]))
    return f"ends in about {_duration(work / len(found['running']))}, as it runs now"


def show(batch: Batch) -> int:
    queue = slurm.queued(batch)
    if queue is None:
        say("the queue does not answer; showing the state of the result folders")
    running, waiting = in_queue(batch)
    found: dict = {}
    for task in batch.tasks:
        word, known = outcome(batch, task, running, waiting)
        found.setdefault(word, []).append((task, known))
    lines = [f"{batch.out}: {len(batch.tasks)} tasks"]
    words = ["done", "running", "waiting", "failed", "lost"]
    lines.append("  " + ", ".join(f"{len(found.get(word, []))} {word}" for word in words
                                  if word != "lost" or word in found))
    left = _left(batch, found)
    if left:
        lines.append("  " + left)
    if queue and queue[2] and not running and not waiting:
        lines.append("  the collecting job is at work, or waits")
    if found.get("waiting") and not running and not waiting:
        lines.append("  nothing is in the queue: run the same command to continue")
    failures = found.get("failed", []) + found.get("lost", [])
    for task, known in failures[:50]:
        lines.append(plain(f"  {task.label}: failed: {known.get('line', '')} ({batch.log(task)})"))
    if len(failures) > 50:
        lines.append(f"  and {len(failures) - 50} more failed")
    say_table("\n".join(lines) + "\n")
    return 0
