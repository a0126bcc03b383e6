"""What is asked for: inputs, the names of their drives, their truths, and variants."""
import itertools
import os
import sys
from dataclasses import dataclass, field

from .base import Problem, plain, reason


@dataclass
class Drive:
    """An input of delio-slam, by its absolute path."""
    input: str
    truth: str = ""  # poses that delio-eval takes
    options: list = field(default_factory=list)  # of this drive alone
    name: str = ""
    bytes: int = 0


@dataclass
class Variant:
    """A profile with values of swept options."""
    name: str
    profile: str
    values: dict  # swept ones
    sets: list  # all of them, as delio-slam takes them


def read_list(path: str, null: bool) -> list:
    """One line per drive: INPUT, optionally followed by tabs, TRUTH and options of delio-slam."""
    try:
        if path == "-":
            data = sys.stdin.buffer.read()
        else:
            with open(path, "rb") as file:
                data = file.read()
    except OSError as error:
        raise Problem(f"cannot read the list {reason(error)}") from None
    drives = []
    for record in data.split(b"\0" if null else b"\n"):
        if not null:
            record = record.rstrip(b"\r")
            if not record.strip() or record.startswith(b"#"):
                continue
        elif not record:
            continue
        if b"\0" in record:
            raise Problem(f"the list '{path}' contains NUL bytes; use -0")
        words = [os.fsdecode(word) for word in record.split(b"\t")]
        truth = words[1] if len(words) > 1 else ""
        drives.append(Drive(words[0], truth, [word for word in words[2:] if word]))
    if not drives:
        raise Problem(f"the list '{path}' is empty")
    return drives


def _has_scans(folder: str) -> bool:
    try:
        with os.scandir(folder) as entries:
            return any(entry.name.endswith(".bin") for entry in entries)
    except OSError:
        return False


def _expanded(drive: Drive) -> list:
    """A KITTI root stands for those of its sequences that have scans."""
    sequences = os.path.join(drive.input, "sequences")
    if not os.path.isdir(sequences):
        return [drive]
    names = sorted(name for name in os.listdir(sequences)
                   if _has_scans(os.path.join(sequences, name, "velodyne")))
    if not names:
        raise Problem(f"no sequence of '{sequences}' has scans")
    if drive.truth:
        raise Problem(f"'{drive.input}' is a KITTI root, whose ground truth is in 'poses'; leave out '{drive.truth}'")
    return [Drive(os.path.join(sequences, name), options=drive.options) for name in names]


def _truth_beside(path: str) -> str:
    """Where delio-slam looks for poses."""
    candidates = [os.path.splitext(path)[0] + ".poses.txt"]
    if os.path.isdir(path):
        above, name = os.path.split(path)
        candidates = [os.path.join(path, "poses.txt"),
                      os.path.join(os.path.dirname(above), "poses", name + ".txt")] + candidates
    return next((file for file in candidates if os.path.isfile(file)), "")


def _size(path: str) -> int:
    """Bytes of a recording, and of what a rawlog keeps outside itself."""
    paths = [path, os.path.splitext(path)[0] + "_Images"] if os.path.isfile(path) else [path]
    for inner in ("velodyne", "velodyne_points"):
        if os.path.isdir(os.path.join(path, inner)):
            paths = [os.path.join(path, inner)]
    total = 0
    for name in paths:
        if os.path.isfile(name):
            total += os.path.getsize(name)
        for folder, _, files in os.walk(name):
            for file in files:
                try:
                    total += os.stat(os.path.join(folder, file)).st_size
                except OSError:
                    pass  # a link to nothing: delio-slam says so
    return total


def _clean(name: str) -> str:
    """Fit for a folder and a page."""
    name = "".join(c if c.isprintable() else "_" for c in name)
    return "_" + name if name[:1] in ("", ".", "-") else name


def _plain_name(path: str) -> str:
    """Of a drive, as delio-slam names it."""
    name = os.path.basename(path)
    return _clean(name if os.path.isdir(path) else os.path.splitext(name)[0])


def _name(drives: list) -> None:
    """Each drive its own name: where two are called the same, with the folder that they are in."""
    for drive in drives:
        drive.name = _plain_name(drive.input)
    for attempt in range(2):
        counts: dict = {}
        for drive in drives:
            counts.setdefault(drive.name, []).append(drive)
        for name, same in counts.items():
            if len(same) < 2:
                continue
            for number, drive in enumerate(same, 1):
                above = _clean(os.path.basename(os.path.dirname(drive.input)))
                drive.name = f"{above}-{name}" if attempt == 0 else f"{name}-{number}"
    for drive in drives:
        if len(os.fsencode(drive.name)) > 200:
            raise Problem(f"the name of '{drive.input}' is too long for a result folder")


def without_repeated(options: list, others: list) -> list:
    """Options of one drive without the flags that all drives have: delio-slam takes each flag once."""
    def is_flag(place: int) -> bool:
        after = options[place + 1] if place + 1 < len(options) else "-"
        return options[place].startswith("-") and after.startswith("-")

    return [word for place, word in enumerate(options) if not (word in others and is_flag(place))]


def resolve(drives: list, truths: str) -> list:
    """All of them by absolute paths, there, once, named; `truths`: a folder of NAME.txt."""
    for drive in drives:
        if drive.input == "-":
            raise Problem("'-' cannot be an input of a batch; tasks read files", 2)
        if "\0" in drive.input or not os.path.exists(drive.input):
            raise Problem(f"cannot read '{drive.input}': no such file or folder")
        drive.input = os.path.abspath(drive.input)
    drives = [one for drive in drives for one in _expanded(drive)]
    seen: dict = {}
    for drive in drives:
        other = seen.setdefault(os.path.realpath(drive.input), drive)
        if other is not drive:
            same = "twice" if other.input == drive.input else f"and '{other.input}' are the same input"
            raise Problem(f"'{drive.input}' {'is given twice' if same == 'twice' else same}: give each input once")
    _name(drives)
    for drive in drives:
        if drive.truth:
            drive.truth = os.path.abspath(drive.truth)
            if not os.path.isfile(drive.truth):
                raise Problem(f"cannot read the ground truth '{drive.truth}' of '{drive.input}': no such file")
        elif truths and os.path.isfile(os.path.join(truths, drive.name + ".txt")):
            drive.truth = os.path.abspath(os.path.join(truths, drive.name + ".txt"))
        else:
            drive.truth = _truth_beside(drive.input)
        drive.bytes = _size(drive.input)
    return drives


def sweep(profiles: list, settings: list) -> tuple:
    """Variants of all profiles and all values of `key=a,b,c`; and what is swept, by key."""
    fixed, swept = [], {}
    for setting in settings:
        key, equals, text = setting.partition("=")
        values = text.split(",")
        if not equals or not key or "" in values:
            raise Problem(f"--set {plain(setting)} needs section.key=value or section.key=value,value", 2)
        if key in swept or any(key == other.partition("=")[0] for other in fixed):
            raise Problem(f"--set {key} is given twice; write {key}=a,b", 2)
        if len(set(values)) < len(values):
            raise Problem(f"--set {setting} has a duplicate value", 2)
        if len(values) > 1:
            swept[key] = values
        else:
            fixed.append(setting)
    if len(set(profiles)) < len(profiles):
        raise Problem("a --profile is given twice", 2)
    variants = []
    for profile in profiles:
        for chosen in itertools.product(*swept.values()):
            values = dict(zip(swept, chosen))
            words = [f"{key}={value}" for key, value in values.items()]
            name = _clean(",".join([profile] + words)).replace("/", "_")
            if len(os.fsencode(name)) > 200:
                raise Problem(f"the options of '{name[:60]}...' are too long for a folder name", 2)
            variants.append(Variant(name, profile, values, fixed + words))
    return variants, swept
