"""contrib/evidence stability: every case of cases.py with every method, against the outcomes that parameters/evidence/stability.expected says."""
import argparse
import concurrent.futures
import dataclasses
import functools
import json
import math
import os
import sys

import cases
import page
from outcome import PATIENCE, ROOT, Outcome, run

EXPECTED = os.path.join(ROOT, "parameters", "evidence", "stability.expected")
FINISHED = ("ok", "cut")
KINDS = ("ok", "cut", "refused", "failed", "wrong", "nan", "hang", "crash")  # from the best to the worst


@functools.lru_cache(maxsize=None)
def reference(scene, other, method):
    """Outcome of the run @p other (cases.OtherRun) of a scene by a method."""
    case = cases.Case("", "", other.scene or scene, dict(other.constants), more=other.more)
    return run(case.scene, case.sets(method))


def attempt(case, method):
    """The outcome of a case by a method, with its error."""
    done = run(case.scene, case.sets(method))
    done.ended = done.kind
    if done.kind in FINISHED and case.error:
        done.error = case.error(done.results, method)
    elif done.kind in FINISHED and case.against:
        other = case.against
        right = reference(case.scene, other, other.method or method)
        if right.kind in FINISHED:
            done.error = abs(done.results[other.result] / (other.size * right.results.get(other.result, math.nan)) - 1)
            done.error = math.inf if math.isnan(done.error) else done.error
        else:
            done.said = f"no reference: it {right.kind}: {right.said}"
    return judged(case, method, done)


def judged(case, method, done):
    """The outcome @p done with the verdict that its error and the bound of its case give, whatever it was before."""
    if done.kind not in FINISHED + ("wrong",) or math.isnan(done.error):
        return done
    is_right = done.error <= case.bound(method)
    said = "" if is_right else f"error {done.error:.2g}, bound {case.bound(method):g}"
    return dataclasses.replace(done, kind=(done.ended or "ok") if is_right else "wrong", said=said)


def is_of_now(case, done):
    """Whether an outcome of a log has the error that its case asks for now."""
    asks = case.error or case.against
    return done.kind not in FINISHED or not asks or not math.isnan(done.error) or done.said.startswith("no reference")


def attempt_all(tasks, log, at_once):
    """Yields the outcomes of the tasks by group, case and method. The file @p log, if any, holds those of earlier runs, and gets
    the others; what is judged by bounds is judged anew."""
    known = {}
    if log and os.path.exists(log):
        with open(log, encoding="utf-8") as file:
            known = {tuple(key): Outcome(**entry) for key, entry in map(json.loads, file)}
    with concurrent.futures.ThreadPoolExecutor(at_once) as pool:
        keys = [(case.group, case.name, method) for case, method in tasks]
        futures = [None if key in known and is_of_now(task[0], known[key]) else pool.submit(attempt, *task) for key, task in zip(keys, tasks)]
        for key, task, future in zip(keys, tasks, futures):
            done = future.result() if future else judged(*task, known[key])
            if log and future:
                with open(log, "a", encoding="utf-8") as file:
                    file.write(json.dumps((key, {**dataclasses.asdict(done), "results": {}})) + "\n")
            yield key, done


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
    error, worst_J, drift = ("" if math.isnan(value) else format(value, how)
                             for value, how in ((done.error, ".1e"), (done.worst_J, ".3g"), (done.drift, ".1e")))
    return [*key, done.kind, str(done.steps or ""), str(done.iterations or ""), error, worst_J, drift, done.said.replace("|", "/")]


def counts(outcomes):
    kinds = [done.kind for done in outcomes.values()]
    return {kind: kinds.count(kind) for kind in KINDS if kind in kinds}


def write_page(outcomes):
    total = ", ".join(f"{n} {kind}" for kind, n in counts(outcomes).items())
    groups = list(dict.fromkeys(key[0] for key in outcomes))
    summary = [[group, *(cell(outcomes, group, method) for method in cases.SETTINGS)] for group in groups]
    page.write("stability.md", page.heading("Stability on stiff and extreme cases", "stability") + f"""
{len(outcomes)} of {sum(len(case.methods) for case in cases.all_cases())} runs: {total}; {100 * sum(done.kind in FINISHED for done in outcomes.values()) / len(outcomes):.0f} % are ok, some after steps were cut.

ok: finished; cut: finished after steps were cut; refused: one line, exit code 1; failed: exit code 2 with the last good state
saved; wrong: finished with an error beyond the case's bound; hang: more than {PATIENCE} s of processor time. Least J: change of
volume that 1 % of a body's points are below. Energy drift, of SPH, which alone sums up work: work less kinetic, strain and dissipated energy, over the work. Scenes: `parameters/evidence`;
cases, references and bounds: `contrib/standing_evidence/cases.py`.

""" + page.table(["group", *cases.SETTINGS], summary) + "\n" + page.table(
        ["group", "case", "method", "outcome", "steps", "iterations", "error", "least J", "energy drift", "said"], [row(key, done) for key, done in outcomes.items()]))


def cell(outcomes, group, method):
    """Outcomes of a group of cases by a method in a few words."""
    return ", ".join(f"{n} {kind}" for kind, n in counts({key: done for key, done in outcomes.items()
                                                          if key[0] == group and key[2] == method}).items())


def main(arguments):
    parser = argparse.ArgumentParser(prog="contrib/evidence stability", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="the subset that contrib/test runs; writes no page")
    groups = sorted({case.group for case in cases.all_cases()})
    parser.add_argument("--only", action="append", metavar="GROUP", choices=groups, help="groups by their names; writes no page")
    parser.add_argument("--at-once", type=int, default=os.cpu_count(), metavar="N", help="runs at a time")
    parser.add_argument("--log", metavar="FILE", help="keeps outcomes and takes those that it holds; a run that was stopped goes on")
    parser.add_argument("--accept", action="store_true", help="take the outcomes for the expected ones")
    chosen = parser.parse_args(arguments)
    tasks = [(case, method) for case in cases.all_cases() if (case.is_quick or not chosen.quick) and
             (not chosen.only or case.group in chosen.only) for method in case.methods]
    outcomes = {}
    for key, done in attempt_all(tasks, chosen.log, chosen.at_once):
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
