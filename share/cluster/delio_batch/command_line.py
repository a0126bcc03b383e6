"""Options of delio-batch, and its --help."""
import argparse
import os
import re
import shutil
import sys
import textwrap

from .base import Problem, plain, run_tool

ABOUT = """\
delio-batch: processes many drives on a Slurm cluster or on this machine

Usage: delio-batch -o OUT --slurm|--local=N [OPTION]... INPUT... [-- SLAM_OPTION...]
  or:  delio-batch -o OUT --slurm|--local=N --retry
  or:  delio-batch --status=OUT

Runs delio-slam on every input, with every profile and every value of the swept
options, one task each, and collects the results. Finished tasks are kept: after
an interruption, the same command continues. Arguments after -- are passed to
delio-slam.
"""

END = """
Writes:
  VARIANT/DRIVE/          results of delio-slam, and task.json: time, memory,
                          errors
  logs/VARIANT/DRIVE.log  messages of delio-slam
  report/                 delio-eval's report of all drives with ground truth
  table.tsv               per task: state, errors, CPU hours, peak memory
  failed.tsv              failed tasks, each with the last line of its log
  sweep-KEY.png           error and time over the values of a swept option
  batch.jsonl             the list of tasks

Examples:
  Process all of KITTI and show the progress:
      $ delio-batch -o out --slurm dataset
      $ delio-batch --status out
  Sweep two options (12 variants of each drive) on four cores:
      $ delio-batch -o out --local 4 --set plane_map.voxel_size=0.4,0.5,0.6 \\
          --set scan.max_range=50,75,100,120 fleet/*.rawlog -- --no-map

Exit status:
  0    success; with --slurm: all tasks are queued or done
  1    tasks failed, or the run failed; stderr says why, in one line
  2    wrong command line
  130  interrupted; the same command continues
"""

OWN = ("-i", "--input", "-o", "--output", "--profile", "--threads", "--force", "--gui",
       "--ground-truth", "--print-config", "-h", "--help", "--version")


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        raise Problem(f"{message}; see --help", 2)

    def format_help(self):
        lines = [ABOUT, "Options:"]
        for action in self._actions:
            if action.help != argparse.SUPPRESS and action.option_strings:
                lines += _lines_of(action)
        return "\n".join(lines) + "\n" + END


def _lines_of(action) -> list:
    """As '  -o, --output=OUT      Text': help2man and completion read this."""
    names = action.option_strings
    head = f"  {names[0]}, {names[1]}" if len(names) > 1 else f"      {names[0]}"
    if action.nargs != 0:
        head += f"={action.metavar}"
    text = textwrap.wrap(action.help, 54)
    if len(head) + 2 > 26:
        return [head] + [" " * 26 + line for line in text]
    return [head.ljust(26) + text[0]] + [" " * 26 + line for line in text[1:]]


def _count(text: str) -> int:
    if not re.fullmatch(r"[0-9]{1,9}", text) or int(text) == 0:
        raise argparse.ArgumentTypeError(f"needs a whole number of at least 1, not '{text}'")
    return int(text)


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="delio-batch", add_help=False, allow_abbrev=False)
    add = parser.add_argument
    add("inputs", nargs="*", default=[], help=argparse.SUPPRESS)
    add("-o", "--output", metavar="OUT", help="Folder of the batch; every node must see it")
    add("-i", "--input", metavar="INPUT", action="append", default=[], dest="more_inputs",
        help="Input of delio-slam, or KITTI's root folder for all its sequences; the same as INPUT without -i; may be repeated")
    add("-l", "--list", metavar="FILE", action="append", default=[], dest="lists",
        help="File with one input per line (\"-\": standard input); optionally, after tabs, its ground-truth file and "
             "options of delio-slam for this input; may be repeated")
    add("-0", "--null", action="store_true", help="List entries end with a NUL byte, as from find -print0")
    add("--profile", metavar="NAME", action="append", default=[], dest="profiles",
        help="Profile of delio-slam; default: accurate; may be repeated")
    add("--set", metavar="section.key=A,B,...", action="append", default=[], dest="sets",
        help="Option of delio-slam; several values make one variant each; may be repeated")
    add("--truth", metavar="DIR",
        help="Ground truth as DIR/DRIVE.txt; default: where delio-slam finds it next to the input")
    add("--lengths", metavar="100,200,...", help="Segment lengths of delio-eval, metres")
    add("--compare", metavar="NAME=DIR", action="append", default=[],
        help="Poses of another program (DRIVE.txt) for the same report; may be repeated")
    add("--slurm", action="store_true", help="Submit job arrays and a job that collects their results")
    add("--local", metavar="N", type=_count, help="Run N tasks at a time on this machine with GNU parallel")
    add("--retry", action="store_true",
        help="Repeat failed tasks; killed tasks get twice the time and memory")
    add("--update", action="store_true",
        help="Replace the list in OUT by this one; finished tasks are kept")
    add("--wait", action="store_true", help="With --slurm: wait until all results are collected")
    add("--threads", metavar="N", type=_count,
        help="Threads per task; default: 1, with --local the machine's cores divided by N")
    add("--scratch", metavar="DIR", help="Temporary folder on a local disk of the node; default: in OUT")
    add("--time", metavar="MIN", type=_count, help="Time limit of a task, minutes; default: from the size of its input")
    add("--mem", metavar="MB", type=_count, help="Memory of a task, MB; default: from the size of its input")
    add("--max-running", metavar="N", type=_count,
        help="With --slurm: maximum number of running tasks; default: the queue's limit")
    add("-p", "--partition", metavar="NAME", help="Slurm partition")
    add("-A", "--account", metavar="NAME", help="Slurm account")
    add("--sbatch", metavar="OPTION", action="append", default=[],
        help="Another option of sbatch, such as --sbatch=--qos=low; may be repeated")
    add("--status", metavar="OUT", help="Show which tasks are done, running or failed, and the expected end")
    add("--collect", metavar="OUT", help="Write report, table and charts of the finished tasks")
    add("-h", "--help", action="store_true", help="Displays usage information and exits.")
    add("--version", action="store_true", help="Displays version information and exits.")
    add("--run-task", nargs=2, help=argparse.SUPPRESS)
    return parser


def parse(words: list) -> argparse.Namespace:
    """Error where it makes no sense."""
    split = words.index("--") if "--" in words else len(words)
    parser = _parser()
    line = parser.parse_args(words[:split])
    line.slam_options = words[split + 1:]
    if line.help:
        sys.stdout.write(parser.format_help())
        raise SystemExit(0)
    if line.version:
        sys.stdout.write(run_tool(["delio-slam", "--version"]).stdout.replace("delio-slam", "delio-batch"))
        raise SystemExit(0)
    line.inputs += line.more_inputs
    if line.status or line.collect or line.run_task:
        return line
    if not line.output:
        parser.error("--output is missing")
    if bool(line.local) == line.slurm:
        parser.error("give --slurm or --local=N")
    if line.wait and not line.slurm:
        parser.error("--wait needs --slurm; a local run ends when all tasks are done")
    if line.compare and any(not re.fullmatch(r"[^=\t\r\n]+=.+", text) for text in line.compare):
        parser.error("--compare needs NAME=DIR")
    for word in line.slam_options:
        name = word.partition("=")[0]
        if name in OWN:
            parser.error(f"{name} after -- is set by delio-batch")
    if (line.lists or line.inputs) and not line.profiles:
        line.profiles = ["accurate"]
    is_new = line.profiles or line.sets or line.slam_options or line.update or line.truth
    if not line.lists and not line.inputs and is_new:
        parser.error("inputs are missing; to continue OUT's own list, give neither inputs nor other options")
    return line


def check_tools() -> None:
    """The tools of the PATH, or of build/bin in this project."""
    if not shutil.which("delio-slam"):
        here = os.path.dirname(os.path.realpath(sys.argv[0]))
        built = os.path.normpath(os.path.join(here, "../../build/bin"))
        os.environ["PATH"] = f"{built}:{os.environ.get('PATH', '')}"
    for tool in ("delio-slam", "delio-eval"):
        if not shutil.which(tool):
            raise Problem(f"{tool} is not in the PATH: install it, or cmake -S . -B build && cmake --build build")


def check_options(variants: list, options: list) -> None:
    """What delio-slam would refuse of every task is refused now."""
    for variant in variants:
        words = ["delio-slam", "--print-config", "--profile", variant.profile]
        for setting in variant.sets:
            words += ["--set", setting]
        done = run_tool(words + options)
        if done.returncode != 0:
            lines = done.stderr.strip().splitlines() or ["delio-slam printed nothing"]
            raise Problem(plain(lines[-1].removeprefix("delio-slam: ")), 2)
