"""`stroma compare`: a run with itself, with the exact solution, with a finer run and with a stored reference of it; regions,
lines and a common grid; the same on 1 and 3 ranks; bad input with the exact line."""
import csv
import json
import os
import shutil

from program import Folder, HERE, check, manufactured, settings, summary
from server import run

KEPT = ["Output/Keep states=true", "Output/Fields every=4"]


def compare(a, b, output, arguments=(), ranks=1):
    run(["compare", a, b, "--output", output, "--quiet", *arguments], ranks)
    with open(os.path.join(output, "compare.json")) as file:
        return json.load(file)


def norms(comparison):
    """{(field, time, region, norm): relative}"""
    return {(f["field"], f["time_s"], r["region"], n): r[n]["relative"]
            for f in comparison["fields"] for r in f["regions"] for n in ("L2", "H1", "max")}


def close(a, b, tolerance, what):
    a, b = norms(a), norms(b)
    check(a.keys() == b.keys(), f"{what}: other fields, times or regions")
    for key, value in a.items():
        other = b[key]
        check((value is None) == (other is None) and (value is None or abs(value - other) <= tolerance * (1 + abs(value))),
              f"{what}: {key} is {value} and {other}")


with Folder() as folder:
    path = lambda name: os.path.join(folder, name)  # noqa: E731
    small = os.path.join(HERE, "small.prm")

    def scene(name, entries):
        run(["run", small, "--output", path(name), "--quiet"] + settings(KEPT + entries))
        return path(name)

    coarse = scene("coarse", [])
    fine = scene("fine", ["MPM/Cells=32, 32"])
    reset = scene("reset", ["MPM/Grid reset=always"])

    # With itself: nothing, at all times and with all fields.
    for a in (coarse, reset):
        same = compare(a, a, path("same"))
        check(same["times_s"] == [.5, 1.], f"times {same['times_s']}")
        check(same["uncovered_by_a"] == same["uncovered_by_b"] == 0, "places that are not covered")
        check({f["field"] for f in same["fields"]} == {"displacement_m", "von_mises_Pa", "pressure_Pa", "cauchy_stress_Pa"},
              "fields")
        largest = max(value or 0. for value in norms(same).values())
        print(f"{os.path.basename(a)} with itself: {largest:.1e}")
        check(largest < 1e-10, f"a run differs from itself by {largest}")
    grid = compare(coarse, coarse, path("same-grid"), ["--points", "grid", "--grid", "20,30"])
    check(abs(grid["fields"][0]["regions"][0]["volume_m3"] / (64e-6 ** 2 * 1e-6) - 1) < 1e-9, "volume of the common grid")
    check(grid["places"] == 600 and max(value or 0. for value in norms(grid).values()) == 0., "common grid")

    # With the exact solution: the errors that the run itself reports.
    exact_scene = manufactured(folder)
    for cells in (8, 16):
        output = path(f"exact-{cells}")
        run(["run", exact_scene, "--output", output, "--quiet"] + settings([f"Constants/cells={cells}", KEPT[0]]))
        found = norms(compare(output, "exact", path("exact")))
        for norm in ("L2", "H1"):
            wanted = summary(output)["results"][f"displacement_error_{norm}_relative"]
            value = found["displacement_m", 1., "all", norm]
            print(f"{cells} cells, {norm}: {value:.10e}, summary {wanted:.10e}")
            check(abs(value / wanted - 1) < 1e-6, f"{norm} error {value} instead of {wanted}")

    # A stored reference gives the numbers of the run that it was made of; ranks do not matter.
    line = ["--line", "0, 32e-6 : 64e-6, 32e-6", "--samples", "9"]
    region = ["--region", "ball 32e-6, 32e-6 : 10e-6"]
    direct = compare(coarse, fine, path("direct"), line + region + ["--save", path("reference.h5")])
    close(direct, compare(coarse, path("reference.h5"), path("stored"), line + region), 1e-9, "stored reference")
    close(direct, compare(coarse, fine, path("three"), line + region, 3), 1e-10, "3 ranks")
    with open(path("direct/profiles.csv")) as a, open(path("stored/profiles.csv")) as b:
        a, b = list(csv.DictReader(a)), list(csv.DictReader(b))
    check(len(a) == len(b) == 2 * 9, f"{len(a)} and {len(b)} places along the line")
    for one, other in zip(a, b):
        check(one["displacement_m_y_b"] and abs(float(one["displacement_m_y_b"]) - float(other["displacement_m_y_b"])) < 1e-15,
              "profile of the stored reference")
    values = norms(direct)
    print(f"coarse against fine: L2 {values['displacement_m', 1., 'all', 'L2']:.3e}, "
          f"H1 {values['displacement_m', 1., 'all', 'H1']:.3e}")
    check(1e-4 < values["displacement_m", 1., "all", "L2"] < .05, "difference of two grids")
    parts = {r["region"]: r for r in direct["fields"][0]["regions"]}
    check(set(parts) == {"all", "material collagen", "material vessel", region[1]}, f"regions {set(parts)}")
    check(parts["all"]["places"] == parts["material collagen"]["places"] + parts["material vessel"]["places"], "places")
    check(abs(parts["all"]["volume_m3"] / (64e-6 ** 2 * 1e-6) - 1) < 1e-9, f"volume {parts['all']['volume_m3']}")
    whole, split = parts["all"]["L2"], [parts[f"material {m}"]["L2"] for m in ("collagen", "vessel")]
    check(abs(whole["difference"] ** 2 / sum(s["difference"] ** 2 for s in split) - 1) < 1e-9, "norms of the parts")
    only = compare(coarse, fine, path("only"), ["--fields", "pressure_Pa", "--times", "0.5"])
    check({(f["field"], f["time_s"]) for f in only["fields"]} == {("pressure_Pa", .5)}, "--fields, --times")

    # States of another scene, a file that is no reference, half a parameter file.
    def refused(arguments, wanted):
        done = run(["compare", *arguments, "--output", path("bad"), "--quiet"], expect=1)
        check(wanted in done.stderr and len(done.stderr.splitlines()) == 1, f"said {done.stderr}\nwanted {wanted}")

    mixed = shutil.copytree(fine, path("mixed"))
    state = "states/state_00000004.h5"
    shutil.copy(os.path.join(coarse, state), os.path.join(mixed, state))
    refused([mixed, coarse], "this is of another scene: 'MPM/Cells' was 16, 16 and is now 32, 32")
    refused([coarse, fine, "--save", os.path.join(coarse, "series.csv")], "is no reference, so it is not replaced")
    half = shutil.copytree(coarse, path("half"))
    with open(os.path.join(half, "parameters.prm"), "r+") as file:
        file.truncate(os.path.getsize(file.name) // 2)
    done = run(["compare", half, fine, "--output", path("bad")], expect=1)
    check(len(done.stderr.splitlines()) == 1, f"half a parameter file: {done.stderr}")
    close(compare(coarse, fine, path("short"), ["--fields", "displacement"]), only := compare(
        coarse, fine, path("long"), ["--fields", "displacement_m"]), 0., "a field without its unit")
    check({f["field"] for f in only["fields"]} == {"displacement_m"}, "--fields displacement")

    # Bad input: one line, the same on 1 and 2 ranks.
    without = path("without")
    run(["run", small, "--output", without, "--quiet"])
    sooner = scene("sooner", ["Time/End=0.25"])
    larger = scene("larger", ["Bodies/construct/Phantom/Voxel size=2, 1, 1"])
    bad = [
        ([coarse, path("nowhere")], f"{path('nowhere')}: there is no such folder or file; give the folder of a run, a "
                                    "reference stored by --save, or the word exact"),
        ([coarse, small], f"{small}: this is not a reference that 'stroma compare --save' wrote"),
        ([coarse, "exact"], f"{coarse}: the scene of this run has no exact solution; give section 'Exact solution' an entry, "
                            "or compare with a run or a stored reference"),
        ([coarse, larger], f"{larger}: this is of another scene than run {coarse}: it has bodies from (0, 0) to (0.000128, "
                           "6.4e-05) m instead of (0, 0) to (6.4e-05, 6.4e-05) m"),
        ([path("exact-8"), path("reference.h5")],
         f"{path('reference.h5')}: this is of another scene than run {path('exact-8')}: it has the materials collagen, vessel "
         "instead of gel"),
        ([coarse, fine, "--fields", "velocity_m_per_s"],
         f"run {coarse} has no field 'velocity_m_per_s'; both have: displacement_m, von_mises_Pa, pressure_Pa, "
         "cauchy_stress_Pa"),
        ([coarse, sooner], f"the two have no time in common: run {coarse} has 0.5, 1 s, run {sooner} has 0.25 s; set "
                           "'Output/Fields every' so that both keep states at the same times"),
        ([coarse, fine, "--times", "0.5,0.75"],
         f"there is no state at 0.75 s in both: run {coarse} has 0.5, 1 s, run {fine} has 0.5, 1 s; choose times that both "
         "have"),
        ([coarse, fine, "--region", "disc 1, 2"],
         "--region: 'Where' was given as 'disc 1, 2'; it must be one of "),
        ([coarse, fine, "--region", "ball 1, 1 : 0.1"],
         "--region: 'ball 1, 1 : 0.1' holds none of the places of comparison; its lengths are in m, enlarge it or move it into the bodies"),
        ([coarse, fine, "--region", "side y-min"],
         "--region: 'side y-min' holds no material; give a layer, box, ball, material or all"),
        ([coarse, fine, "--line", "0, 0 : 1"],
         "--line: '0, 0 : 1' was given with 101 places; it must be 'x, y : x, y', two different places in m, with at least "
         "2 samples"),
        ([coarse, path("reference.h5"), "--line", "0, 0 : 1e-5, 0"],
         f"--line: reference {path('reference.h5')} has no values along '0, 0 : 1e-5, 0'; it has '0, 32e-6 : 64e-6, 32e-6'"),
        ([coarse, path("reference.h5"), "--points", "grid"],
         f"--points: reference {path('reference.h5')} has places of its own; leave --points out"),
        ([coarse, fine, "--grid", "8,8"], "--grid: it goes with --points grid; give that too or leave it out"),
    ]
    for arguments, wanted in bad:
        for ranks in (1, 2):
            done = run(["compare", *arguments, "--output", path("bad")], ranks, expect=1)
            said = [one for one in done.stderr.splitlines() if one.startswith("stroma:")]
            check(len(said) == 1 and (said[0] == "stroma: " + wanted or wanted.endswith(" of ") and
                                      said[0].startswith("stroma: " + wanted)), f"said {said}\nwanted stroma: {wanted}")
            check(not os.path.exists(path("bad")), "a refused comparison leaves files")
    for arguments in ([without, fine], [fine, without], [path("nowhere"), fine]):
        done = run(["compare", *arguments, "--output", path("bad")], expect=1)
        said = [one for one in done.stderr.splitlines() if one.startswith("stroma:")]
        check(len(said) == 1 and ("Keep states" in said[0] or "nowhere" in said[0]), f"said {said}")
        print(said[0])
