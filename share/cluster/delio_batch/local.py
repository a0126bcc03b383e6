"""The same tasks on this machine: GNU parallel hands them out."""
import os
import shlex
import shutil
import signal
import subprocess
import sys
import time

from .base import Problem
from .batch import Batch


def check() -> None:
    if not shutil.which("parallel"):
        raise Problem("--local needs GNU parallel; install the package parallel")


def _interrupt(*_) -> None:
    raise KeyboardInterrupt


def run(batch: Batch, tasks: list, jobs: int, program: str) -> None:
    """Tasks that fail stop no others. A SIGINT that reaches this process has reached them, too."""
    batch.expect(tasks)
    command = " ".join(shlex.quote(word) for word in (sys.executable, program, "--run-task", batch.out))
    words = ["parallel", "--will-cite", "--ungroup", "--halt", "never", "--jobs", str(jobs),
             "--joblog", batch.path("logs", "joblog.tsv"), command + " {}"]
    numbers = "".join(f"{task.number}\n" for task in tasks).encode()
    for sign in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(sign, _interrupt)
    with subprocess.Popen(words, stdin=subprocess.PIPE, env={**os.environ, "PARALLEL_SHELL": "/bin/sh"}) as process:
        try:
            process.communicate(numbers)
        except KeyboardInterrupt:
            process.terminate()
            time.sleep(0.2)
            process.terminate()  # the second one is for its tasks
            process.wait()
            raise
    if process.returncode == 255:
        raise Problem("GNU parallel failed; see its message above")
