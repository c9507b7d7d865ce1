"""The same on two ranks, of all methods; and on another number of ranks than before."""
import os

from program import Folder, check, settings, summary
from particle_scenes import BLOCK, MIGRATION, SCENES as PARTICLE_SCENES
from resuming import SCENES, check_resumes, check_stopped, kill_when, small
from server import run
from solid_scenes import FLUID, SCENES as ELEMENT_SCENES

with Folder() as folder:
    for name in SCENES:
        check_resumes(folder, name, small(name), 2)
    for name, (scene, entries) in ELEMENT_SCENES.items():
        steps = ["Constants/steps=32"] if scene == FLUID else ["Time/Largest step=1/32", "Time/Initial step=1/32"]
        check_resumes(folder, name, ["run", scene] + settings(entries + steps + ["Output/Checkpoint every=3"]), 2)
    for name, (scene, entries) in PARTICLE_SCENES.items():
        steps = {BLOCK: ["Time/Initial step=1/64", "Time/Largest step=1/64"], MIGRATION: ["Constants/step=0.4"]}.get(scene, [])
        check_resumes(folder, name, ["run", scene] + settings(entries + steps + ["Output/Checkpoint every=3"]), 2)
    check_stopped(folder, 2)

    # Another number of ranks continues too, to the solver's accuracy.
    killed = os.path.join(folder, "other-ranks")
    kill_when(killed, small("always") + ["--output", killed], 2, rows=9)
    run(small("always") + ["--output", killed, "--resume"], 3)
    difference = abs(summary(killed)["results"]["reaction_top_y_N"] /
                     summary(os.path.join(folder, "always-2-whole"))["results"]["reaction_top_y_N"] - 1)
    check(difference < 1e-5, f"resumed on 3 ranks: {difference}")
