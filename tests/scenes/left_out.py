"""A build that leaves methods out (those that it has are the arguments): scenes for the others are refused in a line that says so,
also where a method is not given, and settings for the others are kept unread."""
import os
import sys

from program import Folder, HERE, block, check, run, settings

FOR_ALL = os.path.join(HERE, "..", "..", "parameters", "verification", "turning_body.prm")
PRESENT = sys.argv[1:]

for name in ("mpm", "fem", "nsph", "sph"):
    law = ["Materials/gel/Law=hypoelastic"] if name.endswith("sph") else []
    done = run(["check", FOR_ALL] + settings([f"Method={name}"] + law), expect=0 if name in PRESENT else 1)
    line = f"'Method' was given as '{name}', which is left out of this build (STROMA_METHODS); it has: {', '.join(PRESENT)}\n"
    check(name in PRESENT or done.stderr.endswith(line), f"{name}: {done.stderr}")
    print(f"{name}: {'accepted' if name in PRESENT else 'refused'}")
with Folder() as folder:
    path = os.path.join(folder, "minimal.prm")
    with open(path, "w") as file:
        file.write(block(2, "set Young's modulus = 1\n set Poisson's ratio = 0.3"))
    if "mpm" not in PRESENT:
        line = "'Method' is not given, and its default, mpm, is left out of this build (STROMA_METHODS); it has: "
        check(line in run(["check", path], expect=1).stderr, "the default's line")
