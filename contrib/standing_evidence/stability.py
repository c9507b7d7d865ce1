"""contrib/evidence stability: every case of cases.py with every method, against the outcomes that parameters/evidence/stability.expected says."""
import argparse
import concurrent.futures
import datetime
import functools
import math
import os
import platform
import sys

import cases
from outcome import ROOT, run

EXPECTED = os.path.join(ROOT, "parameters", "evidence", "stability.expected")
PAGE = os.path.join(ROOT, "documentation", "evidence", "stability.md")
KINDS = ("ok", "cut", "refused", "failed", "wrong", "nan", "hang", "crash")  # from the best to the worst


@functools.lru_cache(maxsize=None)
def reference(scene, constants, method):
    """Results of a run that others are held against. @p constants: pairs of names and values"""
    case = cases.Case("", "", scene, dict(constants))
    more = ["FEM/Degree = 2"] if ("n", 64) in constants else []
    return run(scene, case.sets(method) + more).results


def attempt(case, method):
    """The outcome of a case by a method, with its error."""
    done = run(case.scene, case.sets(method))
    if done.kind not in ("ok", "cut"):
        return done
    if case.error:
        done.error = case.error(done.results, method)
    elif case.against:
        name, size, constants, by = case.against
        right = reference(case.scene, tuple(constants.items()), by or method).get(name, math.nan)
        done.error = abs(done.results[name] / (size * right) - 1)
    if (case.error or case.against) and not done.error <= case.bound(method):
        done.kind, done.said = "wrong", f"error {done.error:.2g}, bound {case.bound(method):g}"
    return done


def read_expected():
    if not os.path.exists(EXPECTED):
        return {}
    with open(EXPECTED, encoding="utf-8") as file:
        rows = [line.rstrip("\n").split("\t") for line in file if not line.startswith("#")]
    return {tuple(row[:3]): row[3] for row in rows}


def write_expected(outcomes):
    expected = {**read_expected(), **{key: done.kind for key, done in outcomes.items()}}
    with open(EXPECTED, "w", encoding="utf-8") as file:
        file.write("# group, case, method, outcome; written by contrib/evidence stability --accept\n")
        file.writelines("\t".join([*key, kind]) + "\n" for key, kind in expected.items())


def worse_than_expected(outcomes):
    """Lines on the outcomes that are worse than those expected, or that nobody expects."""
    expected = read_expected()
    for key, done in outcomes.items():
        if key not in expected:
            yield f"{', '.join(key)}: {done.kind}, and no outcome is expected; add it with --accept"
        elif KINDS.index(done.kind) > KINDS.index(expected[key]):
            yield f"{', '.join(key)}: {done.kind} instead of {expected[key]}: {done.said}"


def row(key, done):
    error = "" if math.isnan(done.error) else f"{done.error:.1e}"
    return [*key, done.kind, str(done.steps or ""), str(done.iterations or ""), error, done.said.replace("|", "/")]


def counts(outcomes):
    kinds = [done.kind for done in outcomes.values()]
    return {kind: kinds.count(kind) for kind in KINDS if kind in kinds}


def write_page(outcomes):
    os.makedirs(os.path.dirname(PAGE), exist_ok=True)
    total = ", ".join(f"{n} {kind}" for kind, n in counts(outcomes).items())
    with open(PAGE, "w", encoding="utf-8") as file:
        file.write(f"""# Stability on stiff and extreme cases

Written by `contrib/evidence stability` on {datetime.date.today()}, {platform.machine()}, {os.cpu_count()} cores. {len(outcomes)} runs: {total}.

ok: finished; cut: finished after steps were cut; refused: one line, exit code 1; failed: exit code 2 with the last good state
saved; wrong: finished with an error beyond the case's bound. Scenes: `parameters/evidence`, cases and bounds:
`contrib/standing_evidence/cases.py`.

| group | case | method | outcome | steps | iterations | error | said |
|---|---|---|---|---|---|---|---|
""")
        file.writelines("| " + " | ".join(row(key, done)) + " |\n" for key, done in outcomes.items())


def main(arguments):
    parser = argparse.ArgumentParser(prog="contrib/evidence stability", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="the subset that contrib/test runs; writes no page")
    parser.add_argument("--only", action="append", metavar="GROUP", help="groups by their names; writes no page")
    parser.add_argument("--accept", action="store_true", help="take the outcomes for the expected ones")
    chosen = parser.parse_args(arguments)
    tasks = [(case, method) for case in cases.all_cases() if (case.is_quick or not chosen.quick) and
             (not chosen.only or case.group in chosen.only) for method in case.methods]
    outcomes = {}
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for (case, method), done in zip(tasks, pool.map(lambda task: attempt(*task), tasks)):
            key = (case.group, case.name, method)
            outcomes[key] = done
            print("  ".join(part for part in row(key, done) if part), flush=True)
    print(", ".join(f"{n} {kind}" for kind, n in counts(outcomes).items()))
    if chosen.accept:
        write_expected(outcomes)
    if not chosen.quick and not chosen.only:
        write_page(outcomes)
    worse = list(worse_than_expected(outcomes))
    print("\n".join(worse), file=sys.stderr)
    return 1 if worse else 0
