"""The tasks as job arrays of Slurm, and the collecting job after them."""
import math
import os
import re
import shlex
import shutil
import sys
import time
from dataclasses import dataclass

from .base import Problem, last_line, plain, replace_file, run_tool, say
from .batch import Batch, Task

# Measured: share/doc/scale.md, "What a scan costs". Of a MB of the input (packets hold four times the scans of
# a MB of points) on one thread, with the map.
SECONDS_PER_MB = {"points": 0.08, "packets": 0.4}
MEMORY_PER_MB = {"points": 0.6, "packets": 3.0}
MEMORY_MB = 500  # whatever the input
MEMORY_SAFETY = 1.5
TIME_SAFETY = 4  # hard drives, other processors, busy file systems
LEAST_MINUTES = 5
COLLECT_MINUTES = 60
COLLECT_MB = 2000


@dataclass
class Limits:
    """What the user sets; 0: by the size of the input."""
    minutes: int = 0
    memory_mb: int = 0
    running: int = 0
    options: list = None


def _rounded(value: float) -> int:
    """Up to a power of two: few kinds of tasks, an array a kind."""
    return 2 ** max(0, math.ceil(math.log2(max(value, 1))))


def needs(task: Task, state: dict, limits: Limits, threads: int) -> tuple:
    """Minutes and MB. What was ended by a signal gets more with each attempt."""
    ending = state.get("was", state.get("state"))
    more = 2 ** min(state.get("attempts", 1), 5) if ending in ("stopped", "killed", "running") else 1
    kind = "packets" if task.input.endswith((".pcap", ".pcapng", ".bag", ".mcap", ".db3")) else "points"
    size = task.bytes / 1e6
    seconds = TIME_SAFETY * SECONDS_PER_MB[kind] * size / min(threads, 2)
    growing = 0 if "--no-map" in task.options else MEMORY_SAFETY * MEMORY_PER_MB[kind] * size
    return (limits.minutes or LEAST_MINUTES * _rounded(more * seconds / 60 / LEAST_MINUTES),
            limits.memory_mb or 256 * _rounded(more * (MEMORY_MB + growing) / 256))


def _tool(words: list, **more):
    return run_tool(words, timeout=600, **more)


def check() -> None:
    for tool in ("sbatch", "squeue", "scontrol", "scancel"):
        if not shutil.which(tool):
            raise Problem(f"Slurm not found ({tool} is not in the PATH): log in to a machine with Slurm "
                          "or give --local N")


def _largest_array(tasks: int) -> int:
    """How many tasks an array may have at most. sbatch would wait for minutes for a queue that cannot take all."""
    shown = _tool(["scontrol", "show", "config"])
    found = dict(re.findall(r"^(MaxArraySize|MaxJobCount)\s*=\s*(\d+)", shown.stdout, re.M))
    if shown.returncode != 0 or len(found) < 2:
        raise Problem(f"the queue does not answer: {last_line(shown.stderr)}")
    most = int(found["MaxJobCount"])
    if tasks >= most:
        raise Problem(f"the queue refuses the batch: it allows {most} jobs (MaxJobCount), but these are {tasks} "
                      "tasks and a collecting job; split the list")
    return max(1, int(found["MaxArraySize"]))


def spans(numbers: list) -> str:
    """1,2,3,7 as 1-3,7."""
    parts: list = []
    for number in numbers:
        if parts and parts[-1][1] == number - 1:
            parts[-1][1] = number
        else:
            parts.append([number, number])
    return ",".join(str(a) if a == b else f"{a}-{b}" for a, b in parts)


def _script(arguments: list, program: str, offset: int = -1) -> str:
    """Runs where the tools of this shell are, whatever a node's PATH is; of an array, task `offset` and on."""
    tools = os.path.dirname(shutil.which("delio-slam") or "")
    words = " ".join(shlex.quote(word) for word in [sys.executable, program] + arguments)
    task = f' "$((SLURM_ARRAY_TASK_ID + {offset}))"' if offset >= 0 else ""
    return f"#!/bin/sh\nPATH={shlex.quote(tools)}:$PATH\nexport PATH\nexec {words}{task}\n"


def _submit(words: list, script: str) -> str:
    """The job's number."""
    done = _tool(["sbatch", "--parsable"] + words, input=script)
    number = done.stdout.strip().split(";")[0]
    if done.returncode != 0 or not number.isdigit():
        said = re.sub(r"^sbatch: (error: )?", "", last_line(done.stderr))
        raise Problem(f"the queue refuses the batch: {said or 'sbatch printed nothing'}")
    return number


def _arrays(batch: Batch, tasks: list, limits: Limits) -> list:
    """(minutes, MB, offset, indices) of each: alike in what they need, as large as the queue takes."""
    largest = _largest_array(len(tasks))
    kinds: dict = {}
    for task in tasks:
        need = needs(task, batch.state(task), limits, batch.settings["threads"])
        kinds.setdefault(need + (task.number // largest * largest,), []).append(task.number)
    return [(*kind, [number - kind[2] for number in numbers]) for kind, numbers in sorted(kinds.items())]


def submit(batch: Batch, tasks: list, limits: Limits, program: str) -> list:
    """All is accepted, or nothing is begun: arrays are held until the collecting job is accepted, too."""
    name = plain(os.path.basename(batch.out))[:40]
    common = (limits.options or []) + ["--chdir", batch.out]  # of two options that are alike the last one counts
    jobs, rows = [], []
    try:
        arrays = _arrays(batch, tasks, limits)
        most = f"%{max(1, limits.running // len(arrays))}" if limits.running else ""
        for minutes, memory, offset, indices in arrays:
            script = _script(["--run-task", batch.out], program, offset)
            job = _submit(common + ["--hold", "--requeue", f"--array={spans(indices)}{most}",
                                    f"--job-name={name}", f"--time={minutes}", f"--mem={memory}M",
                                    f"--cpus-per-task={batch.settings['threads']}",
                                    "--open-mode=append", "--output=logs/slurm-%A.out"], script)
            jobs.append(job)
            rows.append(f"{job}\t{offset}\n")
            say(f"job {job}: {len(indices)} tasks, {minutes} min and {memory} MB each")
        collecting = _submit(common + ["--dependency=afterany:" + ":".join(jobs), f"--job-name={name}-collect",
                                       f"--time={COLLECT_MINUTES}",
                                       f"--mem={min(COLLECT_MB, limits.memory_mb or COLLECT_MB)}M",
                                       "--open-mode=truncate", "--output=logs/collect.out"], _script(["--collect", batch.out], program))
        jobs.append(collecting)
        replace_file(batch.work("jobs"), "".join(rows) + f"{collecting}\tcollect\n")
        batch.expect(tasks)
        for job in jobs[:-1]:
            released = _tool(["scontrol", "release", job])
            if released.returncode != 0:
                raise Problem(f"the queue does not release job {job}: {last_line(released.stderr)}")
    except BaseException:
        if jobs:
            _tool(["scancel"] + jobs)
        raise
    say(f"job {collecting} collects the results; show the progress with: delio-batch --status {shlex.quote(batch.out)}")
    return jobs


def jobs_of(batch: Batch) -> dict:
    """Of the latest submission: offset, or -1 for the collecting job, by number."""
    try:
        with open(batch.work("jobs"), encoding="ascii") as file:
            rows = [line.split() for line in file]
    except OSError:
        return {}
    return {row[0]: -1 if row[1] == "collect" else int(row[1]) for row in rows if len(row) == 2}


def queued(batch: Batch) -> tuple:
    """Tasks that run, tasks that wait, and whether the collecting job is in the queue; None where the queue does
    not answer."""
    jobs = jobs_of(batch)
    if not jobs or not shutil.which("squeue"):
        return (set(), set(), False)
    shown = _tool(["squeue", "--noheader", "--array", "--format=%F %K %T", "--jobs=" + ",".join(jobs)])
    if shown.returncode != 0:
        return (set(), set(), False) if "Invalid job id" in shown.stderr else None
    running, waiting, collecting = set(), set(), False
    for line in shown.stdout.splitlines():
        job, index, state = (line.split() + ["", "", ""])[:3]
        if jobs.get(job, -1) < 0:
            collecting = True
        elif index.isdigit():
            (waiting if state in ("PENDING", "REQUEUED", "REQUEUE_HOLD", "SUSPENDED") else running).add(
                jobs[job] + int(index))
    return running, waiting, collecting


def wait(batch: Batch) -> None:
    """Until the collecting job has ended."""
    pause = 1.0
    while True:
        found = queued(batch)
        if found is not None and not any(found):
            return
        time.sleep(pause)
        pause = min(15.0, pause * 1.3)
