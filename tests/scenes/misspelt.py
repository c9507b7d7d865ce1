"""What is misspelt is told by its name, place and the nearest known name, before anything that is missing without it: each
entry and each section of scenes, studies and fits of all methods, with its last letter changed."""
import os
import re

from program import Folder, HERE, check
from server import Server, run

SCENES = [os.path.join(HERE, name + ".prm") for name in (
    "small", "solid", "particles", "surface", "disc_in_ring", "drop", "still_water")] + [
    os.path.join(HERE, "..", "..", "parameters", *name) for name in (
        ("quickstart.prm",), ("heck2017", "impact.prm"), ("heck2017", "indentation.prm"), ("heck2017", "migration.prm"),
        ("heck2017", "pillars.prm"), ("heck2017", "tractions.prm"), ("verification", "couette.prm"),
        ("verification", "kelvin_voigt_creep.prm"), ("verification", "particle_poiseuille.prm"))]
# Sections whose subsections are named by the user.
NAMED_BY_USERS = {"Materials", "Bodies", "Supports", "Loads", "Probes", "Contact", "Migration", "Degradation", "Refinement", "Cases",
                  "Parameters", "Data", "Study"}
OF_STUDIES = {"Cases", "Error", "Reference"}

FIT = """
subsection Fit
  set Difference = 0.01
  subsection Parameters
    subsection soft
      set Lower = 100
      set Upper = 1e4
      set Start = 1000
      set Scale = linear
    end
  end
  subsection Data
    subsection pulled
      set File     = {file}
      set Against  = strain_y
      set Quantity = reaction_force_y_N
    end
  end
end
"""
LAWS = """
set Dimension = 2
set Method    = fem
subsection Materials
  subsection series
    set Law              = Prony
    set Young's modulus  = 1
    set Poisson's ratio  = 0.3
    set Relaxation times = 1
    set Shear parts g    = 0.5
    set Bulk parts k     = 0.5
  end
  subsection chains
    set Law             = Ogden
    set Ogden moduli    = 1
    set Ogden exponents = 2
    set Bulk modulus    = 3
  end
end
subsection Bodies
  subsection plate
    set Shape    = polygon
    set Corners  = 0, 0, 1, 0, 1, 1, 0, 1
    set Material = series
  end
  subsection arch
    set Shape        = ring
    set Centre       = 3, 0
    set Inner radius = 1
    set Outer radius = 2
    set Angles       = 0, 90
    set Material     = chains
  end
  subsection disc
    set Shape  = ball
    set Centre = 9, 9
    set Radius = 1
    set Rigid  = true
  end
  subsection cut
    set Shape    = polygon
    set File     = corners.txt
    set Material = series
  end
end
subsection Supports
  subsection bottom
    set Where = side y-min
    set Type  = symmetry
  end
  subsection turned
    set Where        = body disc
    set Displacement = free; free
    set Rotation     = 0
  end
end
subsection Loads
  subsection pull
    set Where    = side y-max
    set Traction = 0; 1
  end
end
subsection Probes
  subsection tip
    set Where = nearest 1, 1
  end
end
"""


def misspelt(name):
    return name[:-1] + ("q" if name[-1] != "q" else "k")


def changes(lines):
    """Number of each line that can be misspelt, the line then, and path and right name of what it names."""
    path = []
    for number, line in enumerate(lines):
        words = line.split("#")[0].strip()
        entry, section = re.match(r"set ([^=]*?)\s*=", words), re.match(r"subsection (.*)", words)
        name = entry[1] if entry else section[1] if section else ""
        if entry and "Constants" not in path or section and (not NAMED_BY_USERS & set(path[-1:]) or name in OF_STUDIES):
            yield number, line.replace(name, misspelt(name), 1), path + [name], bool(entry)
        path = path + [name] if section else path[:-1] if words == "end" else path


def fault(path, text, command):
    """What is wrong with what is said of each misspelt word of a file."""
    lines = text.splitlines()
    found, n = [], 0
    for number, line, name, is_entry in changes(lines):
        with open(path, "w") as file:
            file.write("\n".join(lines[:number] + [line] + lines[number + 1:]))
        done = server.run(command)
        said = (done.stderr.splitlines() or ["nothing"])[-1]
        wrong = misspelt(name[-1])
        what = f"'{wrong}' is not a parameter" if is_entry else "section '" + "/".join(name[:-1] + [wrong]) + "'"
        nearest = "" if name[:1] == ["Study"] and name[-1] in OF_STUDIES else f"known here: {name[-1]}"
        n += 1
        if done.returncode != 1 or not said.startswith(f"stroma: {path}:{number + 1}: {what}") or nearest not in said:
            found.append(f"{'/'.join(name)} as {wrong}, line {number + 1}: {said[:300]}")
    return n, found


def as_absolute(text, scene):
    """The text with paths that are found from anywhere."""
    return re.sub(r"(set File\s*= )(\S+)", lambda m: m[1] + (os.path.join(os.path.dirname(scene), m[2])
                                                            if os.path.exists(os.path.join(os.path.dirname(scene), m[2])) else m[2]), text)


with Folder() as folder:
    path, server = os.path.join(folder, "scene.prm"), Server(1)
    with open(os.path.join(folder, "corners.txt"), "w") as file:
        file.write("5 0\n6 0\n6 1\n5 0\n")
    with open(os.path.join(folder, "data.csv"), "w") as file:
        file.write("strain_y,reaction_force_y_N\n0.05,1\n0.1,2\n")
    fit = open(os.path.join(HERE, "fit.prm")).read() + FIT.format(file=os.path.join(folder, "data.csv"))
    texts = [(scene, as_absolute(open(scene).read(), scene)) for scene in SCENES] + [("fit", fit), ("laws", LAWS)]
    count, faults = 0, []
    for scene, text in texts:
        number, found = fault(path, text, ["check", path])
        count += number
        faults += [f"{os.path.basename(scene)}: {one}" for one in found]
    creep = next(text for scene, text in texts if scene.endswith("kelvin_voigt_creep.prm"))
    for name, text in (("study", creep), ("fit", fit), ("run", LAWS)):  # the other commands say the same
        number, found = fault(path, text, [name, path, "--output", os.path.join(folder, "out")])
        count += number
        faults += [f"stroma {name}: {one}" for one in found]
    # A segmentation's scene is read as a whole.
    run(["phantom", os.path.join(folder, "scan.nrrd"), "--size", "32,32,1", "--fraction", "0.2"])
    small = open(os.path.join(HERE, "small.prm")).read()
    number, found = fault(path, small, ["image", os.path.join(folder, "scan.nrrd"), "--segment", path, "--output",
                                        os.path.join(folder, "image")])
    count += number
    faults += [f"stroma image: {one}" for one in found if "/File as" not in one]
    server.stop()
    print("\n".join(faults))
    print(f"{count} misspelt words, {len(faults)} of them not told")
    check(not faults, "misspelt")
