"""Options of delio-batch, and its --help."""
import argparse
import os
import re
import shutil
import sys
import textwrap

from .base import Problem, plain, run_tool

ABOUT = """\
delio-batch: many drives, on a Slurm cluster or on this machine

Usage: delio-batch -o OUT --slurm|--local=N [OPTION]... INPUT... [-- SLAM_OPTION...]
  or:  delio-batch -o OUT --slurm|--local=N --retry
  or:  delio-batch --status=OUT

Runs delio-slam on every input with every profile and every value of swept
options, each in a task of its own, and collects the results. What is done is
kept: the same command goes on where it was ended. What follows -- goes to
delio-slam.
"""

END = """
Writes:
  VARIANT/DRIVE/          what delio-slam leaves, and task.json: time, memory,
                          errors
  logs/VARIANT/DRIVE.log  what delio-slam said
  report/                 delio-eval's page of all drives whose truth is known
  table.tsv               a row a task: state, errors, CPU hours, peak memory
  failed.tsv              failed tasks, each with the last line of its log
  sweep-KEY.png           error and time over the values of a swept option
  batch.jsonl             the list of tasks, which no later command changes

Examples:
  All of KITTI, and how far it is:
      $ delio-batch -o out --slurm dataset
      $ delio-batch --status out
  A sweep over two options, twelve variants of each drive, on four cores:
      $ delio-batch -o out --local 4 --set plane_map.voxel_size=0.4,0.5,0.6 \\
          --set scan.max_range=50,75,100,120 fleet/*.rawlog -- --no-map

Exit status:
  0    success; with --slurm: all is in the queue, or done
  1    failed tasks, or a failed run; one line on stderr says what, where and
       what to do
  2    bad command line
  130  interrupted; the same command goes on
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
        raise argparse.ArgumentTypeError(f"wants a whole number, 1 or more, not '{text}'")
    return int(text)


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="delio-batch", add_help=False, allow_abbrev=False)
    add = parser.add_argument
    add("inputs", nargs="*", default=[], help=argparse.SUPPRESS)
    add("-o", "--output", metavar="OUT", help="Folder of the batch, where every node sees it")
    add("-i", "--input", metavar="INPUT", action="append", default=[], dest="more_inputs",
        help="What delio-slam reads, or KITTI's root for all its sequences; as INPUT without -i; may be repeated")
    add("-l", "--list", metavar="FILE", action="append", default=[], dest="lists",
        help="Inputs, a line each (\"-\": of standard input); after a tab the file of its true poses, after further "
             "tabs options of delio-slam for it alone; may be repeated")
    add("-0", "--null", action="store_true", help="Entries of lists end with a NUL byte, as of find -print0")
    add("--profile", metavar="NAME", action="append", default=[], dest="profiles",
        help="Profile of delio-slam; default: accurate; may be repeated")
    add("--set", metavar="section.key=A,B,...", action="append", default=[], dest="sets",
        help="An option of delio-slam; with several values a variant each; may be repeated")
    add("--truth", metavar="DIR",
        help="True poses as DIR/DRIVE.txt; default: where delio-slam finds them beside an input")
    add("--lengths", metavar="100,200,...", help="Lengths of delio-eval's segments in metres")
    add("--compare", metavar="NAME=DIR", action="append", default=[],
        help="Poses of another program (DRIVE.txt) on the same page; may be repeated")
    add("--slurm", action="store_true", help="Submit job arrays, and a job that collects after them")
    add("--local", metavar="N", type=_count, help="Run N tasks at a time on this machine, by GNU parallel")
    add("--retry", action="store_true",
        help="Do failed tasks again; those that were killed get twice the time and memory")
    add("--update", action="store_true",
        help="Take this list in the place of the one that OUT has; what is done stays")
    add("--wait", action="store_true", help="With --slurm: end when all has been collected")
    add("--threads", metavar="N", type=_count,
        help="Threads of a task; default: 1, with --local what the machine has for each")
    add("--scratch", metavar="DIR", help="Where tasks work, on a disk of the node; default: in OUT")
    add("--time", metavar="MIN", type=_count, help="Most minutes of a task; default: by the size of its input")
    add("--mem", metavar="MB", type=_count, help="Memory of a task; default: by the size of its input")
    add("--max-running", metavar="N", type=_count,
        help="With --slurm: tasks at a time at most; default: as the queue has it")
    add("-p", "--partition", metavar="NAME", help="Partition of Slurm")
    add("-A", "--account", metavar="NAME", help="Account of Slurm")
    add("--sbatch", metavar="OPTION", action="append", default=[],
        help="Another option of sbatch, as --sbatch=--qos=low; may be repeated")
    add("--status", metavar="OUT", help="Say what of a batch is done, runs, has failed, and when it ends")
    add("--collect", metavar="OUT", help="Make report, table and charts of what is done by now")
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
        parser.error("--output is missing: which folder are the results to go to?")
    if bool(line.local) == line.slurm:
        parser.error("give --slurm, or --local=N for this machine")
    if line.wait and not line.slurm:
        parser.error("--wait is for --slurm: a run on this machine ends when all is done")
    if line.compare and any(not re.fullmatch(r"[^=\t\r\n]+=.+", text) for text in line.compare):
        parser.error("--compare wants NAME=DIR")
    for word in line.slam_options:
        name = word.partition("=")[0]
        if name in OWN:
            parser.error(f"{name} after --: is for delio-batch to set")
    if (line.lists or line.inputs) and not line.profiles:
        line.profiles = ["accurate"]
    is_new = line.profiles or line.sets or line.slam_options or line.update or line.truth
    if not line.lists and not line.inputs and is_new:
        parser.error("inputs are missing; without any, the list that OUT has is gone on with as it is")
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
            lines = done.stderr.strip().splitlines() or ["delio-slam said nothing"]
            raise Problem(plain(lines[-1].removeprefix("delio-slam: ")), 2)
