"""What every part needs: errors of one line, plain text, files that are whole."""
import contextlib
import json
import os
import shutil
import subprocess
import sys
import tempfile


class Problem(Exception):
    """One line that says what, where and what to do; the exit code."""

    def __init__(self, text: str, code: int = 1):
        super().__init__(text)
        self.code = code


def plain(text: str) -> str:
    """Without control characters: names and logs reach terminals, tables and pages."""
    return "".join(c if c.isprintable() else "?" for c in text)


def say(text: str) -> None:
    """One line, in one write: tasks speak at the same time."""
    line = f"delio-batch: {plain(text)}\n".encode(errors="replace")
    try:
        os.write(2, line)
    except OSError:
        pass


def say_some(lines: list, most: int = 50) -> None:
    """Of thousands of lines the first ones."""
    for line in lines[:most]:
        say(line)
    if len(lines) > most:
        say(f"and {len(lines) - most} more")


def reason(error: OSError) -> str:
    """What the system says, with the file that it is about."""
    name = f"'{error.filename}': " if error.filename else ""
    return f"{name}{error.strerror or error}"


def replace_file(path: str, text: str) -> None:
    """The old file, or the new one whole."""
    with partial_folder(path) as folder:
        partial = os.path.join(folder, os.path.basename(path))
        with open(partial, "w", encoding="utf-8", errors="surrogateescape") as file:
            file.write(text)
        os.replace(partial, path)


@contextlib.contextmanager
def partial_folder(path: str):
    """A private folder beside `path` for what is to be renamed to it. Nobody can guess its name and lay a link there;
    files in it have the permissions that the umask gives."""
    folder = tempfile.mkdtemp(prefix=".partial-", dir=os.path.dirname(path) or ".")
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def create(path: str):
    """A new or emptied file for bytes. A link is not followed: it could lead to any file of the user's."""
    flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_NOFOLLOW | os.O_CLOEXEC
    return os.fdopen(os.open(path, flags, 0o666), "wb")


def remove_file(path: str) -> None:
    try:
        os.unlink(path)
    except OSError:
        pass


def read_json(path: str) -> dict:
    """Empty where there is no such file; damaged ones count as none."""
    try:
        with open(path, encoding="utf-8") as file:
            value = json.load(file)
    except (OSError, ValueError):
        return {}
    return value if isinstance(value, dict) else {}


def run_tool(words: list, **more) -> subprocess.CompletedProcess:
    """Of another program: exit code and what it said, as text. `more`: input, timeout."""
    try:
        return subprocess.run(words, stdin=None if "input" in more else subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, encoding="utf-8", errors="surrogateescape", check=False, **more)
    except subprocess.TimeoutExpired:
        raise Problem(f"{words[0]} does not answer") from None
    except OSError as error:
        raise Problem(f"cannot run {words[0]}: {reason(error)}") from None


def last_line(text: str) -> str:
    """What a program said last: its error."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return plain(lines[-1])[:500] if lines else ""


def say_table(text: str) -> None:
    sys.stdout.write(text)
    sys.stdout.flush()
