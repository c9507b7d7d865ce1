"""Mutated input of every kind: no crash, no hang, no memory exhausted, no file outside the folder, no silent change.

    run.py [--cases N | --seconds S] [--seed K] [--kind NAME]...

Standard library only. Without options: what `contrib/test` runs. A case is repeated by its kind, seed and number: `--kind images
--seed K --only N`. What a fault was made from is kept in a folder that the last line names.
"""
import argparse
import collections
import os
import random
import shutil
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from commands import Commands  # noqa: E402
from images import Images  # noqa: E402
from parameters import Parameters  # noqa: E402
from sandbox import Sandbox  # noqa: E402
from stops import Checkpoints, Disks, Stops  # noqa: E402

KINDS = {"parameters": (Parameters, 600), "images": (Images, 500), "commands": (Commands, 60), "stops": (Stops, 16), "checkpoints": (Checkpoints, 25),
         "disks": (Disks, 4)}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, help="cases of each kind")
    parser.add_argument("--seconds", type=float, help="time for each kind, instead of a number of cases")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, help="this case alone")
    parser.add_argument("--kind", action="append", choices=sorted(KINDS), help="default: all")
    return parser.parse_args()


def keep(sandbox, kept, name, number, outcome):
    """Copies what a fault was made from."""
    folder = os.path.join(kept, f"{name}_{number}")
    shutil.copytree(sandbox.work, folder, symlinks=True, ignore=shutil.ignore_patterns("a", "b", "keep", "pipe"))
    for stream in ("stdout", "stderr"):
        with open(os.path.join(folder, stream), "wb") as file:
            file.write(getattr(outcome, stream))


def numbers(options, default):
    if options.only is not None:
        return [options.only]
    if options.seconds is None:
        return range(options.cases or default)
    end = time.monotonic() + options.seconds
    return iter(lambda count=iter(range(10**9)): next(count) if time.monotonic() < end else None, None)


def run_kind(name, options, server, kept):
    """Runs the cases of a kind; returns what became of them and its faults."""
    make, default = KINDS[name]
    kind, counts, faults = make(), collections.Counter(), []
    with tempfile.TemporaryDirectory(prefix="stroma-fuzz-") as root:
        sandbox = Sandbox(root, server)
        os.mkfifo(os.path.join(sandbox.work, "pipe"))
        sandbox.start()
        getattr(kind, "prepare", lambda _: None)(sandbox)
        for number in numbers(options, default):
            sandbox.clean()
            what, outcome, judge = kind.case(random.Random(f"{name} {options.seed} {number}"), sandbox)
            fault = outcome.fault() or judge(what, outcome, sandbox)
            counts["fault" if fault else outcome.kind()] += 1
            if fault:
                faults.append(f"{name} {number} ({what}): {fault}")
                print("FAULT", faults[-1], flush=True)
                keep(sandbox, kept, name, number, outcome)
        sandbox.stop()
    return counts, faults


def main():
    options = arguments()
    server = os.environ.get("FUZZ_SERVER", os.path.join(os.path.dirname(os.environ.get("STROMA", "build/stroma")), "tests", "fuzz_server"))
    kept, faults = tempfile.mkdtemp(prefix="stroma-fuzz-faults-"), []
    for name in options.kind or KINDS:
        start = time.monotonic()
        counts, found = run_kind(name, options, server, kept)
        faults += found
        said = ", ".join(f"{count} {outcome}" for outcome, count in sorted(counts.items()))
        print(f"{name}: {sum(counts.values())} tried, {said}; {time.monotonic() - start:.0f} s", flush=True)
    if faults:
        print(f"{len(faults)} faults; what they were made from is in {kept}")
        return 1
    os.rmdir(kept)
    return 0


if __name__ == "__main__":
    sys.exit(main())
