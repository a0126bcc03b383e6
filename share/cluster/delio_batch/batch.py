"""The folder of a batch.

OUT/batch.jsonl            the frozen list: a line of settings, then a line a task. All lines are of the
                           same width, so that a task reads its own one only, of 100 000, too
OUT/VARIANT/DRIVE/         results of delio-slam, and task.json: what was done, time, memory, scores
OUT/logs/VARIANT/DRIVE.log what delio-slam said
OUT/.work/                 scratch folders, states of tasks that are not done, jobs of Slurm, the lock
"""
import errno
import fcntl
import json
import os
import secrets
import shutil
from dataclasses import asdict, dataclass

from .base import Problem, read_json, reason, remove_file, replace_file


@dataclass
class Task:
    number: int
    variant: str
    drive: str
    profile: str
    values: dict
    input: str
    truth: str
    options: list  # of delio-slam
    bytes: int

    @property
    def label(self) -> str:
        return f"{self.drive}, {self.variant}"

    def identity(self) -> tuple:
        """What makes it the same task. Recordings may grow, truths appear."""
        return self.variant, self.drive, self.values, self.work()

    def work(self) -> dict:
        """What makes its result what it is."""
        return {"input": self.input, "profile": self.profile, "options": self.options}


class Batch:
    def __init__(self, out: str):
        self.out = os.path.abspath(out)
        if not self.out.isprintable():
            raise Problem("the name of the output folder has control characters; choose another name")
        self.settings: dict = {}
        self.tasks: list = []
        self._made: list = []  # by this run
        self._replaced = None  # the batch with the list that was there
        self._lock = -1

    # ---- where everything is
    def path(self, *names: str) -> str:
        return os.path.join(self.out, *names)

    def work(self, *names: str) -> str:
        return self.path(".work", *names)

    def result(self, task: Task) -> str:
        return self.path(task.variant, task.drive)

    def record(self, task: Task) -> str:
        return os.path.join(self.result(task), "task.json")

    def log(self, task: Task) -> str:
        return self.path("logs", task.variant, task.drive + ".log")

    def state_file(self, task: Task) -> str:
        return self.work("state", task.variant, task.drive + ".json")

    # ---- what is known of tasks
    def is_done(self, task: Task) -> bool:
        return os.path.isdir(self.result(task))

    def state(self, task: Task) -> dict:
        """Of a task that is not done: `state` is running, failed or stopped; empty: it never began."""
        return read_json(self.state_file(task))

    def set_state(self, task: Task, **state) -> None:
        os.makedirs(os.path.dirname(self.state_file(task)), exist_ok=True)
        replace_file(self.state_file(task), json.dumps(state) + "\n")

    def clear_state(self, task: Task) -> None:
        remove_file(self.state_file(task))

    def expect(self, tasks: list) -> None:
        """Forgets the earlier results of tasks that will be repeated."""
        for task in tasks:
            state = self.state(task)
            if state.get("state", "waiting") != "waiting":
                self.set_state(task, state="waiting", was=state["state"], attempts=state.get("attempts", 1))

    # ---- the frozen list
    @property
    def list_file(self) -> str:
        return self.path("batch.jsonl")

    def exists(self) -> bool:
        return os.path.exists(self.list_file)

    def load(self, only: int = -1) -> "Batch":
        """All tasks, or one."""
        try:
            with open(self.list_file, encoding="ascii") as file:
                first = file.readline()
                self.settings = json.loads(first)
                if only >= 0:
                    file.seek((only + 1) * len(first))
                rows = [file.readline()] if only >= 0 else file.readlines()
            self.tasks = [Task(**json.loads(row)) for row in rows]
        except FileNotFoundError:
            raise Problem(f"'{self.out}' is not the folder of a batch: no batch.jsonl") from None
        except OSError as error:
            raise Problem(f"cannot read {reason(error)}") from None
        except (ValueError, TypeError, KeyError):
            raise Problem(f"'{self.list_file}' is damaged; start again in another folder") from None
        return self

    def _save(self) -> None:
        rows = [json.dumps(self.settings)] + [json.dumps(asdict(task)) for task in self.tasks]
        width = max(len(row) for row in rows)
        replace_file(self.list_file, "".join(row.ljust(width) + "\n" for row in rows))

    def freeze(self, tasks: list, settings: dict, update: bool) -> None:
        """Makes these the tasks. Another list than the one that is there is refused, unless it is to
        be taken; results that are there have to be those of the same work."""
        if self.exists():
            old = Batch(self.out).load()
            if [task.identity() for task in old.tasks] == [task.identity() for task in tasks]:
                settings = {**old.settings, **settings}
            elif not update:
                raise Problem(f"'{self.out}' contains another batch ({len(old.tasks)} tasks); choose another folder "
                              "or replace its list with --update (finished tasks are kept)")
            self._replaced = old
        for task in tasks:
            if self.is_done(task) and read_json(self.record(task)).get("work") != task.work():
                raise Problem(f"'{self.result(task)}' was made from another input or with other options; "
                              "remove it or choose another folder")
        self.tasks, self.settings = tasks, {"id": secrets.token_hex(4), **settings}
        if not self._replaced:
            self._made.append(self.list_file)
        self._save()

    def discard(self) -> None:
        """Takes back what this run has made: a queue refused it."""
        if self._lock < 0:
            return
        if self._replaced:
            self._replaced._save()
        for path in reversed(self._made):
            if os.path.isdir(path):
                shutil.rmtree(path, ignore_errors=True)
            else:
                remove_file(path)

    # ---- one at a time
    def lock(self) -> None:
        """Creates the folder and locks it until this process ends."""
        try:
            for folder in (self.out, self.work(), self.path("logs")):
                above = folder
                while not os.path.isdir(os.path.dirname(above)):
                    above = os.path.dirname(above)
                if not os.path.isdir(folder):
                    os.makedirs(folder, exist_ok=True)
                    self._made.append(above)
            handle = os.open(self.work("lock"), os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                if error.errno not in (errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS):
                    raise
            self._lock = handle
        except BlockingIOError:
            raise Problem(f"another delio-batch is running in '{self.out}': wait for it (--status says how far it "
                          "is)") from None
        except OSError as error:
            raise Problem(f"cannot write '{self.out}': {reason(error)}") from None

    def is_locked(self) -> bool:
        """A run on this machine goes on."""
        try:
            handle = os.open(self.work("lock"), os.O_RDWR)
        except OSError:
            return False
        try:
            fcntl.flock(handle, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except OSError as error:
            return isinstance(error, BlockingIOError)
        finally:
            os.close(handle)
        return False

    def sweep_scratch(self) -> None:
        """What ended runs have left. Only for who holds the lock while no job is in the queue."""
        for name in ("scratch", "truth"):
            shutil.rmtree(self.work(name), ignore_errors=True)
