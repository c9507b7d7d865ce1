"""contrib/evidence lean: what runs keep and do, scene by scene; with --count the instructions of builds without the other methods beside those of one with all."""
import argparse
import json
import os
import re
import resource
import shutil
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from outcome import ROOT, STROMA
from page import heading, table, write

PAGE = "lean.md"
LIMIT = .01  # by how much instructions of two builds may differ
MARK = "Collected : "  # where callgrind says how many instructions it has seen


@dataclass
class Scene:
    name: str
    file: str  # under parameters
    sets: tuple = ()
    small: tuple = ()  # more settings, for callgrind


AT_END = "Output/Fields at="
SMALL_TRACTIONS = ("Constants/dp=0.2", "Time/End=20")
SCENES = (
    Scene("quickstart (MPM, 3D)", "quickstart.prm", small=("Bodies/construct/Phantom/Size=16, 16, 8", "MPM/Cells=4, 4, 2", "Bodies/construct/Phantom/Radius=2")),
    Scene("slice (MPM)", "guilkey2006/slice.prm", small=("Constants/cells=8", "Bodies/construct/Phantom/Size=64, 64, 1", "Supports/middle/Where=nearest 33.6, 0")),
    Scene("slice (MPM, reset)", "guilkey2006/slice.prm", ("MPM/Grid reset=always", "Constants/steps=4"),
          ("Constants/cells=8", "Bodies/construct/Phantom/Size=64, 64, 1", "Supports/middle/Where=nearest 33.6, 0")),
    Scene("slice (FEM)", "guilkey2006/slice.prm", ("Method=fem",),
          ("Constants/cells=8", "Bodies/construct/Phantom/Size=64, 64, 1", "Supports/middle/Where=nearest 33.6, 0")),
    Scene("tractions (NSPH)", "heck2017/tractions.prm", ("Method=nsph", "Constants/dp=0.05", "Time/End=100", AT_END), SMALL_TRACTIONS),
    Scene("tractions (SPH)", "heck2017/tractions.prm", ("Method=sph", "Constants/dp=0.1", "Time/End=1", AT_END), ("Constants/dp=0.2", "Time/End=0.1")),
    Scene("tractions (FEM)", "heck2017/tractions.prm", ("Method=fem", "Constants/cells=20", "Time/End=100", AT_END), ("Constants/cells=4", "Time/End=20")),
    Scene("pillars (NSPH)", "heck2017/pillars.prm", ("Method=nsph", "NSPH/Spacing=4e-4"), ("NSPH/Spacing=1e-3",)),
    Scene("indentation (NSPH)", "heck2017/indentation_particles.prm", ("Time/End=100",), ("Constants/cells=10", "Time/End=20")),
    Scene("migration (NSPH)", "heck2017/migration.prm", ("Constants/dp=20", "Constants/end=20"), ("Constants/dp=40", "Constants/end=4")),
)


def run(binary, scene, sets, folder, before=()):
    """The finished process and its summary."""
    output = os.path.join(folder, "run")
    command = [*before, binary, "run", os.path.join(ROOT, "parameters", scene.file), "--overwrite", "--output", output]
    for entry in sets:
        command += ["--set", entry]
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
    if done.returncode != 0:
        raise SystemExit(f"{scene.name}: exit code {done.returncode}: {(done.stderr.strip() or 'nothing said').splitlines()[-1]}")
    with open(os.path.join(output, "summary.json"), encoding="utf-8") as file:
        return done, json.load(file)


def start(binary):
    """Processor time of a program that only says its version [s], and the libraries that it loads."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([binary, "--version"], capture_output=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    loaded = subprocess.run(["ldd", binary], capture_output=True, text=True, check=True).stdout
    files = re.findall(r"=> (/\S+)", loaded)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, files


def row(scene, summary):
    """What a run keeps and does, from its summary."""
    steps, cells = max(summary["n_steps"], 1), summary["n_cells"]
    parts = summary["used"]
    counts = [sum(part.startswith(kind) for part in parts) for kind in ("point field:", "matrix:", "vector:")]
    return [scene.name, str(summary["n_points"]), str(cells), str(summary["n_dofs"]), str(counts[0]), f"{summary['bytes_per_point'] or 0:.0f}",
            str(counts[1]), str(counts[2]), "ghosts" if "ghost particles" in parts or "ghost points" in parts else "none",
            *(f"{value:.3g}" for value in ((summary["residual_evaluations"] + summary["newton_iterations"]) / steps,
                                           summary["linear_iterations"] / steps, summary["peak_memory_bytes"] / 2**20,
                                           summary["phases"].get("reading", 0.), summary["wall_time_s"]))]


def build(method):
    """The program with one method, or by an empty word with all, for any processor, since callgrind does not know all instructions of this one;
    made unless it stands."""
    folder = os.path.join(ROOT, "build", f"count-{method or 'all'}")
    only = [f"-DSTROMA_METHODS={method}"] if method else []
    for command in (["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DSTROMA_UNITY=ON", "-DSTROMA_TESTS=OFF", *only],
                    ["cmake", "--build", folder, "--target", "stroma"]):
        if subprocess.run(command, stdout=subprocess.DEVNULL).returncode != 0:
            raise SystemExit(f"no build of {method or 'all methods'}: {' '.join(command)}")
    return os.path.join(folder, "stroma")


def instructions(binary, scene):
    tool = ("valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null")
    with tempfile.TemporaryDirectory() as folder:
        said = run(binary, scene, (*scene.sets, *scene.small), folder, tool)[0].stderr
    return int(said.split(MARK)[1].split()[0])


def compare(scenes):
    """Rows of instructions in a build of all methods and in one of the scene's own, and those scenes that differ by more than LIMIT."""
    own = {scene.name: re.search(r"\((\w+)", scene.name)[1].lower() for scene in scenes}
    binaries = {method: build(method) for method in {"", *own.values()}}
    rows, apart = [], []
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        counts = [[pool.submit(instructions, binaries[method], scene) for method in ("", own[scene.name])] for scene in scenes]
        for scene, pair in zip(scenes, counts):
            mine, theirs = (count.result() for count in pair)
            rows.append([scene.name, f"{mine:.4e}", f"{theirs:.4e}", f"{100 * (mine / theirs - 1):+.2f} %"])
            print("  ".join(rows[-1]), flush=True)
            apart += [scene.name] if abs(mine / theirs - 1) > LIMIT else []
    return rows, apart


def main(arguments):
    parser = argparse.ArgumentParser(prog="contrib/evidence lean", description=__doc__)
    parser.add_argument("--count", action="store_true", help="makes a build of all methods and one of each alone, and compares instructions by callgrind (valgrind)")
    parser.add_argument("--only", action="append", metavar="WORD", help="scenes whose names hold the word; writes no page")
    chosen = parser.parse_args(arguments)
    if chosen.count and not shutil.which("valgrind"):
        raise SystemExit("--count needs valgrind (apt-get install valgrind)")
    scenes = [scene for scene in SCENES if not chosen.only or any(word in scene.name for word in chosen.only)]
    if not scenes:
        parser.error("no scene's name holds " + " or ".join(chosen.only) + "; there are " + ", ".join(scene.name for scene in SCENES))
    seconds, libraries = start(STROMA)
    print(f"start: {seconds:.2f} s of processor time, {len(libraries)} libraries")
    with tempfile.TemporaryDirectory() as folder:
        rows = []
        for scene in scenes:
            rows.append(row(scene, run(STROMA, scene, scene.sets, folder)[1]))
            print("  ".join(rows[-1]), flush=True)
    compared, apart = compare(scenes) if chosen.count else ([], [])
    if not chosen.only:
        write_page(seconds, libraries, rows, compared)
    if apart:
        print(f"instructions differ by more than {LIMIT:.0%}: " + ", ".join(apart))
    return 1 if apart else 0


def write_page(seconds, libraries, rows, compared):
    own = [os.path.basename(name) for name in libraries if "stroma" in name]
    write(PAGE, heading("Nothing that a scene does not need", "lean") + f"""
Start: {seconds:.2f} s of processor time for `stroma --version`; {len(libraries)} libraries are loaded, of Stroma {', '.join(own)}.

Passes: residuals and tangents a step, each of which goes over all points once; linear: iterations a step, of which particle methods sum over
all pairs once. Fields, matrices and vectors are those that the run's summary counts as used, bytes those of a point; memory is the peak of the
process, start included.

""" + table(["scene", "points", "cells", "unknowns", "fields", "bytes a point", "matrices", "vectors", "ghost layers", "passes a step",
             "linear a step", "memory [MB]", "reading [s]", "all [s]"], rows) + (
        "\nInstructions of small sizes by callgrind, start included, of a build of all methods and of one of the scene's own alone:\n\n" +
        table(["scene", "all methods", "its own", "difference"], compared) if compared else ""))
