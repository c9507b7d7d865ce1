"""Every case in cases.txt ends with exit code 1 and exactly the one line that stands there, on 1 and on 2 ranks.

cases.txt: blocks of `name`, then lines `--set` entries, then `=> message`. Each runs tests/scenes/small.prm with those
entries, or the scene there that a line `scene: name.prm` names; {tmp} is a scratch folder with the bad images that this
script makes, {scene} the scene's path.
"""
import concurrent.futures
import os
import struct
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "scenes"))
from program import Folder, HERE, check, command, run, settings  # noqa: E402
from server import Server  # noqa: E402

import subprocess  # noqa: E402


def tiff(path, components=1):
    """A little-endian 8 x 8 TIFF of 8 bits, uncompressed."""
    pixels = bytes((i * 7) % 256 for i in range(64 * components))
    tags = [(256, 3, 1, 8), (257, 3, 1, 8), (258, 3, 1, 8), (259, 3, 1, 1), (262, 3, 1, 2 if components == 3 else 1),
            (273, 4, 1, 8), (277, 3, 1, components), (278, 3, 1, 8), (279, 4, 1, len(pixels))]
    if components == 3:
        tags[2] = (258, 3, 3, 8 + len(pixels))
    data = b"II*\0" + struct.pack("<I", 8 + len(pixels) + (6 if components == 3 else 0)) + pixels
    if components == 3:
        data += struct.pack("<HHH", 8, 8, 8)
    data += struct.pack("<H", len(tags)) + b"".join(struct.pack("<HHII", *t) for t in tags) + struct.pack("<I", 0)
    with open(path, "wb") as file:
        file.write(data)


def surfaces(folder):
    """STL files that are none, or bound no body: a corner of a cube."""
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    outward = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]

    def stl(triangles):
        data = bytes(80) + struct.pack("<I", len(triangles))
        return data + b"".join(struct.pack("<12fH", 0, 0, 0, *sum((corners[v] for v in t), ()), 0) for t in triangles)

    for name, data in (("short", stl(outward)[:200]), ("open", stl(outward[1:])), ("words", b"solid x\n facets\n"),
                       ("inside_out", stl([t[::-1] for t in outward]))):
        with open(os.path.join(folder, name + ".stl"), "wb") as file:
            file.write(data)


def polylines(folder):
    """Files of corners that bound nothing."""
    for name, corners in (("open", "0 0\n1 0\n1 1\n0 1\n"), ("crossing", "0, 0\n1, 1\n1, 0\n0, 1\n0, 0\n"),
                          ("clockwise", "0 0\n1 1\n1 0\n0 0\n"), ("square", "# um\n0 0\n1 0\n1 1\n0 1\n0 0\n"),
                          ("space", "0 0 0\n1 0 0\n"), ("comma", "0,5 0\n1 0\n")):
        with open(os.path.join(folder, name + ".txt"), "w") as file:
            file.write(corners)


def cases():
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "cases.txt")) as file:
        blocks = file.read().strip().split("\n\n")
    for block in blocks:
        lines = [line for line in block.splitlines() if not line.startswith("#")]
        scene = "small.prm"
        if lines[1].startswith("scene: "):
            scene = lines.pop(1).removeprefix("scene: ")
        yield lines[0], os.path.join(HERE, scene), lines[1:-1], lines[-1].removeprefix("=> ")


def started(arguments, ranks):
    """The same by a start of its own."""
    return subprocess.run(command(arguments, ranks), capture_output=True, text=True)


def fault(folder, number, case, ranks, run_case):
    """Runs a case on this many ranks; says what is wrong, or None."""
    name, scene, entries, message = case
    output = os.path.join(folder, f"output{number}_{ranks}")
    arguments = ["run", scene, "--output", output] + settings(e.replace("{tmp}", folder) for e in entries)
    done = run_case(arguments)
    code, text = done.returncode, done.stderr
    # mpirun adds its own words about the exit code; the program's are those before them.
    # A warning may come before the line that refuses.
    said = [line for line in text.splitlines() if line.startswith("stroma:") and not line.startswith("stroma: warning:")]
    wanted = "stroma: " + message.replace("{tmp}", folder).replace("{scene}", scene)
    if code == 1 and said == [wanted] and not os.path.exists(os.path.join(output, "summary.json")):
        return None
    return f"FAILED {name} on {ranks} rank(s): exit code {code}\n  wanted: {wanted}\n  said:   " + \
        "\n          ".join(said or [text[-500:]])


def faults(folder, ranks):
    """Those of all cases on this many ranks: the first with starts of their own, all by one server."""
    all_cases = list(cases())
    found = [fault(folder, f"{number}_started", case, ranks, lambda arguments: started(arguments, ranks))
             for number, case in enumerate(all_cases[:2])]
    server = Server(ranks)
    for number, case in enumerate(all_cases):
        found.append(fault(folder, number, case, ranks, server.run))
    server.stop()
    return found


with Folder() as folder:
    tiff(os.path.join(folder, "grey.tif"))
    tiff(os.path.join(folder, "colour.tif"), 3)
    surfaces(folder)
    polylines(folder)
    run(["phantom", os.path.join(folder, "image.nrrd"), "--size", "32,32,1", "--fraction", "0.2"])
    whole = open(os.path.join(folder, "image.nrrd"), "rb").read()
    with open(os.path.join(folder, "truncated.nrrd"), "wb") as file:
        file.write(whole[: len(whole) // 2])
    with concurrent.futures.ThreadPoolExecutor() as pool:
        said = [text for found in pool.map(lambda ranks: faults(folder, ranks), (1, 2)) for text in found]
    failures = [text for text in said if text]
    print("\n".join(failures))
    print(f"{len(said)} runs, {len(failures)} failures")
    check(not failures, "bad input")

    # The template of a good scene is a file that `check` reads.
    for scene in ("small", "solid", "particles", "surface", "disc_in_ring"):
        template = os.path.join(HERE, scene + "_template_of_test.prm")  # beside the files that the scene names
        try:
            with open(template, "w") as file:
                file.write(run(["template", os.path.join(HERE, scene + ".prm")]).stdout)
            run(["check", template])
        finally:
            os.remove(template)
