"""One task: delio-slam into a scratch folder, which is renamed to its place when it is whole.

A task may be begun again at any time, on another node, while an instance of it that was thought dead still
works: each has a scratch folder of its own, and of two that end, the rename lets one win."""
import errno
import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
import time

from .base import Problem, create, last_line, reason, run_tool, say
from .batch import Batch, Task


class Stopped(Exception):
    """By a signal: a limit of time, preemption, scancel, Ctrl-C."""


def _host() -> str:
    return os.environ.get("SLURMD_NODENAME") or os.uname().nodename


def _owner() -> str:
    """Of a scratch folder: the job, which keeps its number when it is requeued, or this process."""
    job = os.environ.get("SLURM_ARRAY_JOB_ID") or os.environ.get("SLURM_JOB_ID")
    if job:
        return f"{job}_{os.environ.get('SLURM_ARRAY_TASK_ID', '0')}"
    return f"{_host()}-{os.getpid()}"


class Attempt:
    """Of a task, to do it."""

    def __init__(self, batch: Batch, task: Task):
        self.batch, self.task = batch, task
        self.began = time.time()
        # The folder that scratch folders are in stays: another task may be about to make its own in it.
        self.base = batch.settings.get("scratch") or batch.work("scratch")
        self.own = f"delio-batch.{batch.settings['id']}.{task.number}.{_owner()}."
        self.scratch = ""  # nobody can guess its name, or look into it
        self.child = None

    def run(self) -> int:
        batch, task = self.batch, self.task
        if batch.is_done(task):
            say(f"{task.label}: done before")
            return 0
        before = batch.state(task)
        self.attempts = before.get("attempts", 0) + 1
        try:
            self._forget_own_past()
            for folder in (self.base, os.path.dirname(batch.log(task))):
                os.makedirs(folder, exist_ok=True)
            self.scratch = tempfile.mkdtemp(prefix=self.own, dir=self.base)
            batch.set_state(task, state="running", **self._about())
            say(f"{task.label}: begins")
            code, used = self._slam()
            return self._end(code, used)
        except Stopped as stopped:
            self._kill()
            return self._fail(f"stopped by {stopped} (limit of time, preemption, or cancelled)", 143, state="stopped")
        except OSError as error:
            self._kill()
            return self._fail(f"cannot write {reason(error)}", 1)
        finally:
            if self.scratch:
                shutil.rmtree(self.scratch, ignore_errors=True)

    def _results(self) -> str:
        """Of delio-slam, with the permissions that the umask gives."""
        return os.path.join(self.scratch, "results")

    def _about(self) -> dict:
        return {"attempts": self.attempts, "host": _host(), "began": int(self.began)}

    def _forget_own_past(self) -> None:
        """The scratch of this very job before it was requeued, and nobody else's."""
        for name in os.listdir(self.base) if os.path.isdir(self.base) else []:
            if name.startswith(self.own):
                shutil.rmtree(os.path.join(self.base, name), ignore_errors=True)

    def _slam(self) -> tuple:
        """Exit code of delio-slam, and what it used."""
        task, settings = self.task, self.batch.settings
        words = ["delio-slam", "-i", task.input, "-o", self._results(), "--profile", task.profile,
                 "--threads", str(settings["threads"])] + task.options
        where = settings.get("cwd", "/")
        with create(self.batch.log(task)) as log:
            # Python ignores SIGXFSZ; left so, a file that is too large is an error that delio-slam names.
            self.child = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                                          restore_signals=False, cwd=where if os.path.isdir(where) else "/")
            _, status, used = os.wait4(self.child.pid, 0)
            self.child.returncode = os.waitstatus_to_exitcode(status)
        return self.child.returncode, used

    def _kill(self) -> None:
        if self.child is not None and self.child.returncode is None:
            self.child.kill()
            self.child.wait()

    def _end(self, code: int, used) -> int:
        task, log = self.task, self.batch.log(self.task)
        said = self._said(log)
        if code in (-signal.SIGTERM, -signal.SIGINT, -signal.SIGHUP, 130):
            raise Stopped("a signal to delio-slam")  # the same that is on its way to this process
        if code < 0:
            name = signal.Signals(-code).name
            memory = " (too little memory?)" if code == -signal.SIGKILL else ""
            return self._fail(f"killed by {name}{memory}; its last line: {said}", 128 - code, state="killed")
        summary = _summary(self._results())
        if code != 0 or not re.search(r"^complete: true", summary, re.M):
            return self._fail(said or "delio-slam said nothing", code or 1)
        record = {"work": task.work(), **self._about(), "seconds": round(time.time() - self.began, 3),
                  "cpu_s": round(used.ru_utime + used.ru_stime, 3), "peak_mb": round(used.ru_maxrss / 1024, 1),
                  "scans": _number(summary, "scans"), "predicted": _number(summary, "predicted")}
        record.update(self._scores())
        with open(os.path.join(self._results(), "task.json"), "w", encoding="ascii") as file:
            file.write(json.dumps(record) + "\n")
        self._put_in_place()
        self.batch.clear_state(task)
        say(f"{task.label}: done")
        return 0

    def _scores(self) -> dict:
        """Errors against the ground truth, or the reason why they are missing."""
        if not self.task.truth:
            return {}
        lengths = self.batch.settings.get("lengths")
        result = run_tool(["delio-eval", "--ref", self.task.truth, "--est", f"it={self._results()}",
                           "--format", "tsv"] + (["--lengths", lengths] if lengths else []))
        rows = [line.split("\t") for line in result.stdout.split("\n")]
        if result.returncode != 0 or len(rows) < 2:
            return {"unscored": last_line(result.stderr)}
        return {"scores": dict(zip(rows[0][2:], rows[1][2:]))}

    def _put_in_place(self) -> None:
        """By a rename; from another file system over a copy beside the place. Where another instance of this task
        was faster, its result stays."""
        place = self.batch.result(self.task)
        os.makedirs(os.path.dirname(place), exist_ok=True)
        try:
            os.rename(self._results(), place)
        except OSError as error:
            if error.errno in (errno.ENOTEMPTY, errno.EEXIST):
                return
            if error.errno != errno.EXDEV:
                raise
            self._copy_in_place(place)

    def _copy_in_place(self, place: str) -> None:
        near = self.batch.work("scratch")
        os.makedirs(near, exist_ok=True)
        folder = tempfile.mkdtemp(prefix=self.own, dir=near)
        try:
            copy = os.path.join(folder, "results")
            shutil.copytree(self._results(), copy)
            os.rename(copy, place)
        except shutil.Error as error:
            raise OSError(errno.EIO, f"the copy of the results: {error.args[0][0][2]}") from None
        except OSError as error:
            if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
                raise
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    @staticmethod
    def _said(log: str) -> str:
        try:
            with open(log, "rb") as file:
                file.seek(max(0, os.path.getsize(log) - 65536))
                return last_line(file.read().decode(errors="replace"))
        except OSError:
            return ""

    def _fail(self, line: str, code: int, state: str = "failed") -> int:
        log = self.batch.log(self.task)
        try:
            self.batch.set_state(self.task, state=state, exit=code, line=line,
                                 seconds=round(time.time() - self.began, 3), **self._about())
        except OSError as error:
            line += f" (and its state cannot be written: {reason(error)})"
        say(f"{self.task.label}: failed: {line} (see {log})")
        return code


def _summary(folder: str) -> str:
    try:
        with open(os.path.join(folder, "summary.yaml"), encoding="utf-8", errors="replace") as file:
            return file.read()
    except OSError:
        return ""


def _number(summary: str, key: str) -> int:
    found = re.search(rf"^{key}: (\d+)$", summary, re.M)
    return int(found.group(1)) if found else 0


def run_task(out: str, number: int) -> int:
    """What jobs and GNU parallel call."""
    def stop(sign, _):
        raise Stopped(signal.Signals(sign).name)

    for sign in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(sign, stop)
    batch = Batch(out).load(only=number)
    if not batch.tasks:
        raise Problem(f"'{out}' has no task {number}")
    try:
        return Attempt(batch, batch.tasks[0]).run()
    except Stopped as stopped:
        say(f"{batch.tasks[0].label}: stopped by {stopped}")
        return 143
