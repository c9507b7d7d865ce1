"""The commands of documentation/tutorials.md, one block after the other in an empty folder, as a reader would type them; then those of
documentation/gallery.md, in one shell."""
import json
import os
import re
import subprocess

from program import Folder, HERE, STROMA, check

ROOT = os.path.dirname(os.path.dirname(HERE))


def blocks(page):
    """(heading above it, text) of each block of commands."""
    heading = ""
    with open(page) as file:
        for part in re.split(r"^(## .*)$", file.read(), flags=re.M):
            if part.startswith("## "):
                heading = part
            for text in re.findall(r"^```sh\n(.*?)^```$", part, flags=re.M | re.S):
                yield heading, text


def results(folder):
    with open(os.path.join(folder, "summary.json")) as file:
        return json.load(file)["results"]


with Folder() as folder:
    environment = {**os.environ, "STROMA_ROOT": ROOT, "PATH": os.path.dirname(STROMA) + ":" + os.environ["PATH"],
                   "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    n = 0
    for heading, text in blocks(os.path.join(ROOT, "documentation", "tutorials.md")):
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", text], cwd=folder, env=environment, capture_output=True,
                              text=True)
        check(done.returncode == 0, f"{heading}: exit code {done.returncode}\n{text}\n{done.stdout[-1500:]}{done.stderr[-1500:]}")
        n += 1
    check(n == 7, f"{n} blocks found")
    gallery = os.path.join(ROOT, "documentation", "gallery.md")
    done = subprocess.run(["bash", "-euo", "pipefail", "-c", "".join(text for _, text in blocks(gallery))], cwd=folder, env=environment,
                          capture_output=True, text=True)
    check(done.returncode == 0, f"gallery: {done.stdout[-1500:]}{done.stderr[-1500:]}")
    with open(gallery) as file:
        pictures = re.findall(r"\]\(gallery/(\w+)\.png\)", file.read())
    check(len(pictures) >= 19, f"{len(pictures)} pictures in the gallery")
    for name in (name for name in pictures if not name.startswith("paraview")):
        places = [os.path.join(folder, "pictures", *place) for place in ((name + ".png",), (name, "von_mises_Pa.png"),
                                                                         (name, "von_mises_Pa_z.png"), ("by_material", name + ".png"))]
        check(any(os.path.exists(place) for place in places), f"the gallery's commands make no {name}.png")
    inside = lambda name: os.path.join(folder, name)  # noqa: E731

    # What the text says of them.
    scan = results(inside("stretched"))
    check({"apparent_modulus_y_Pa", "von_mises_mean_vessel_Pa", "principal_stretch_1_p99_collagen"} <= scan.keys(), "results of the scan")
    check(os.path.exists(inside("segmented/planes.png")), "no picture of the segmentation")
    methods = {name: results(inside("by_" + name)) for name in ("mpm", "fem", "nsph", "sph")}
    for key in ("von_mises_mean_gel_Pa", "von_mises_mean_cell_Pa", "apparent_modulus_y_Pa"):
        values = {name: of[key] for name, of in methods.items()}
        print(key, values)
        check(max(values.values()) < 1.1 * min(values.values()), f"{key} differs between methods: {values}")
    with open(inside("fitted/fit.json")) as file:
        found = json.load(file)["parameters"][0]
    print("fitted", found["value"], found["confidence_95"])
    check(found["confidence_95"][0] < found["value"] < found["confidence_95"][1], "no interval")
    job = results(inside("results/stretched"))
    check(abs(job["reaction_force_y_N"] / scan["reaction_force_y_N"] - 1) < 1e-3, "the job differs from the run")
