"""What a new user ran into (D1 to D20 of the report): each with its smallest input, and what is said or done now.

D1   laws: particles refuse laws that they do not solve        D11  images: a threshold beyond the values tells their range
D2   drawn_body: finite elements around a drawn ball           D12  studies: fields with and without unit; unknown ones by check
D3   drawn_body: units of the file in parameters.prm           D13  studies: values of several numbers
D4   curves: force and strain of a shear                       D14  sizes_and_stops: a signal in one long step is told
D5   pictures.py: a hold is drawn over time                    D15  words: lengths of regions are in m
D6   pictures.py: components; numbers without unit             D16  images: axes are x, y, z
D7   images: units and directions of headers                   D17  words: supports that hold nothing, unused materials
D8   images: pieces that nothing holds                         D18  curves: the same results by all methods; field_files.py
D9   sizes_and_stops: memory, told at once                     D19  words: no limit of explicit steps; pictures.py: round-off
D10  images: a label that thresholds do not make               D20  laws: what a law is stands in the log
"""
import json
import os
import re
import signal
import subprocess
import time

from program import HERE, Folder, block, check, command, settings, stretched, summary
from server import run

SMALL = os.path.join(HERE, "small.prm")
GEL = "set Law = LAW\n    set Young's modulus = 1\n    set Poisson's ratio = 0.3\n    set Viscosity = 1"
UNITS = "subsection Units\n  set Length = um\n  set Stress = kPa\nend\n"
BOX = "set Shape = box\n    set Lower corner = 0, 0\n    set Upper corner = 100, 100\n    set Material = gel"
GRIDS = "".join(f"subsection {name}\n  set {entry}\nend\n" for name, entry in (
    ("MPM", "Cells = 10, 10"), ("FEM", "Cells = 10, 10"), ("NSPH", "Spacing = 10"), ("SPH", "Spacing = 10")))


def write(name, text, mode="w"):
    with open(os.path.join(folder, name), mode) as file:
        file.write(text)
    return os.path.join(folder, name)


def scene(name, law, more=""):
    """A square of gel, clamped below and pulled by a tenth."""
    return write(name, block(2, GEL.replace("LAW", law), UNITS + stretched("y", "0; 10*min(t, 1)") + GRIDS + more, BOX))


def said(words, arguments, entries=(), expect=1, stream="stderr"):
    done = run(arguments + settings(entries), expect=expect)
    text = getattr(done, stream)
    for one in words:
        check(one in text, f"{arguments} {entries}: said {text}\n  wanted: {one}")
    return text


def results(path, name, entries):
    output = os.path.join(folder, name)
    run(["run", path, "--output", output] + settings(entries))
    return summary(output)["results"]


def laws():
    """D1, D20: particles refuse what they do not solve; what a law is stands in log and template."""
    for law in ("neo-Hookean", "linear elastic"):
        said(["hypoelastic"], ["check", scene("law.prm", law)], ["Method=nsph", "NSPH/Spacing=10"])
    said(["St. Venant-Kirchhoff"], ["run", scene("svk.prm", "linear elastic"), "--output", os.path.join(folder, "svk")],
         ["Time/End=.1"], 0, "stdout")
    said(["kappa/2 (ln J)^2"], ["run", scene("nh.prm", "neo-Hookean"), "--output", os.path.join(folder, "nh")], ["Time/End=.1"], 0,
         "stdout")


def drawn_body():
    """D2: finite elements take a ball in a box where material is looked up at quadrature points. D3: units of the file."""
    ball = scene("ball.prm", "neo-Hookean") + ""
    entries = ["Method=fem", "FEM/Material at=quadrature point", "Bodies/cell/Shape=ball", "Bodies/cell/Centre=50, 50",
               "Bodies/cell/Radius=20", "Bodies/cell/Material=gel", "Time/End=.1"]
    results(ball, "ball", entries)
    with open(os.path.join(folder, "ball", "parameters.prm")) as file:
        text = file.read()
    check("lower corner [um]" in text or re.search(r"corner.*\[um\]", text), "D3: no [um] at a corner")
    check("elastic constants [kPa]" in text, "D3: no [kPa] at a modulus")
    in_si = re.findall(r".*\[(?:m|Pa)\]", text)
    check(not in_si, f"D3: SI in a file with other units: {in_si}")


def curves():
    """D4: a shear has its force and strain. D18: largest displacement by all methods, speed where there is one."""
    one = results(scene("shear.prm", "neo-Hookean"), "shear", ["Supports/top/Displacement=0.1*y*t; 0"])
    check(abs(one["shear_strain_xy"] - .1) < 1e-12 and one["shear_stress_xy_Pa"] > 10 * abs(one.get("nominal_stress_y_Pa", 0)),
          f"D4: {one}")
    for method in ("mpm", "fem", "nsph", "sph"):
        law = "hypoelastic" if method.endswith("sph") else "neo-Hookean"
        found = results(scene("all.prm", law), method, [f"Method={method}", "Materials/gel/Density=1e-12", "Time/End=1e-3"])
        check("max_displacement_m" in found, f"D18: {method} has no max_displacement_m")


def images():
    """D7, D8, D10, D11, D16: headers, loose pieces, labels, ranges and axes of images."""
    body = "Bodies/construct/"
    size = "type: uint8\ndimension: 3\nsizes: 4 4 4\nspace dimension: 3\nspace directions: "
    oblique = write("oblique.nrrd", f"NRRD0004\n{size}(.8,.6,0) (-.6,.8,0) (0,0,1)\nencoding: raw\n\n".encode() + bytes(64), "wb")
    said(["oblique"], ["image", oblique, "--output", os.path.join(folder, "image")])
    mm = write("mm.nrrd", f'NRRD0004\n{size}(1,0,0) (0,1,0) (0,0,1)\nspace units: "mm" "mm" "mm"\nencoding: raw\n\n'.encode() +
               bytes(range(64)), "wb")
    said(["1000 x 1000 x 1000 um"], ["image", mm, "--output", os.path.join(folder, "image")], expect=0, stream="stdout")
    said(["there is 1 piece of material", "held too loosely"], ["check", SMALL], [body + "Materials=0: empty, 255: vessel"], 0)  # D8
    grey = [body + "Interpretation=threshold", body + "Lower threshold=100", body + "Upper threshold=100"]
    said(["labels 0 and 1 only"], ["check", SMALL], grey + [body + "Materials=0: collagen, 1: collagen, 255: vessel"])  # D10
    said(["the image's values are"], ["check", SMALL], grey[:1] + [body + "Lower threshold=1e4", body + "Upper threshold=1e4",
                                                                 body + "Materials=0: collagen, 1: vessel"])  # D11
    axis = said([], ["check", SMALL], [body + "Voxels per point=300, 1, 1"])
    check(" x" in axis and "axis 1" not in axis, f"D16: {axis}")


def sizes_and_stops():
    """D9: what takes more memory than there is, at once. D14: a signal in a run of one long step is told at once."""
    start = time.time()
    said(["GB"], ["check", SMALL], ["MPM/Cells=30000, 30000", "Bodies/construct/Materials=0: collagen, 255: vessel"])
    check(time.time() - start < 30, f"D9: took {time.time() - start:.0f} s")
    process = subprocess.Popen(command(["run", SMALL, "--output", os.path.join(folder, "long"), "--set", "MPM/Cells=500, 500", "--set",
                                        "Time/Initial step=1", "--set", "Time/Largest step=1"]), stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    for line in process.stdout:
        if "unknowns" in line:
            break
    process.send_signal(signal.SIGTERM)
    told = process.communicate()[1]
    check("stopping after this step" in told and process.returncode in (0, 3), f"D14: {process.returncode}, {told}")


def studies():
    """D12: fields with and without their unit, and refused by check. D13: values of several numbers."""
    path = write("study.prm", f"include {SMALL}\nsubsection Study\n  set Results = reaction_force_y_N\n  subsection grid\n"
                 "    set Parameter = MPM/Cells\n    set Values = (8, 8), (16, 16)\n  end\nend\n")
    run(["study", path, "--output", os.path.join(folder, "study")])
    with open(os.path.join(folder, "study", "study.json")) as file:
        check(len(json.load(file)["runs"]) == 2, "D13: runs of vectors")
    more = ("subsection Error\n  set Against = reference\n  set Fields = FIELD\nend\nsubsection Reference\n"
            "  set Set = MPM/Cells=32, 32\nend\n")
    with open(path) as file:
        text = file.read()
    for field, code in (("displacement", 0), ("displacement_m", 0), ("nonsense", 1)):
        with_error = write("error.prm", text.replace("  subsection grid", more.replace("FIELD", field) + "  subsection grid"))
        done = run(["check", with_error], expect=code)
        check(code == 0 or "nonsense" in done.stderr, f"D12: {done.stderr}")


def words():
    """D15: lengths of regions are in m. D17: supports that hold nothing, materials that nothing is made of. D19: no limit of explicit
    stresses where they are implicit."""
    for name in "ab":
        run(["run", SMALL, "--output", os.path.join(folder, name), "--set", "Output/Keep states=true"])
    said(["lengths are in m"], ["compare", os.path.join(folder, "a"), os.path.join(folder, "b"), "--region", "ball 50, 50 : 14"])
    said(["holds nothing"], ["check", SMALL], ["Supports/top/Displacement=free; free"])
    lumen = ["Materials/lumen/Young's modulus=1", "Materials/lumen/Poisson's ratio=0.3"]
    said(["no body is made of material 'lumen'"], ["check", SMALL], lumen, 0)
    image = os.path.join(folder, "there.nrrd")
    run(["phantom", image, "--size", "8,8,1"])
    for arguments, wanted in ((["rum", SMALL], "stroma: 'rum' is no command; known: run, "), ([], "stroma: no command is given; known: run, check, "),
                              (["run", SMALL, "--ouput", "there"], "stroma: '--ouput' is no option of 'stroma run'; known: --output, "),
                              (["run", SMALL, "a.prm", "b.prm"], "stroma: not expected: a.prm b.prm; see stroma --help"),
                              (["phantom", image, "--size", "8,8,1"], f"stroma: {image}: the file exists and is not overwritten; remove it, give "
                               "another name, or --overwrite it")):
        told = run(arguments, expect=1).stderr.splitlines()
        check(len(told) == 1 and told[0].startswith(wanted), f"{arguments}: {told}")
    done = run(["check", scene("implicit.prm", "hypoelastic")] + settings(["Method=nsph"]))
    check("explicit" not in done.stdout + done.stderr, f"D19: {done.stdout}{done.stderr}")


with Folder() as folder:
    for part in (laws, drawn_body, curves, images, sizes_and_stops, studies, words):
        part()
        print(part.__doc__.strip())
