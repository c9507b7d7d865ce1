"""The pages under documentation/evidence/."""
import datetime
import os
import platform
import subprocess

from outcome import ROOT, STROMA


def heading(title, command):
    """Title, and by what, when and where a page was written."""
    version = subprocess.run([STROMA, "--version"], capture_output=True, text=True).stdout.strip().splitlines()[0]
    commit = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
    return f"""# {title}

Written by `contrib/evidence {command}` on {datetime.date.today()}: {version}{', commit ' + commit if commit else ''}; {processor()}, {os.cpu_count()} cores.
"""


def processor():
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next(line.split(":")[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.machine()


def table(columns, rows):
    lines = [columns, ["---"] * len(columns), *rows]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def write(name, text):
    folder = os.path.join(ROOT, "documentation", "evidence")
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
        file.write(text)
