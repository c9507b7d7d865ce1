"""The stiff and extreme cases of the stability atlas: one motion or setting far out each, for every method that it has a meaning for."""
import math
from dataclasses import dataclass
from typing import Callable, Optional

import laws

GRID = ("fem", "mpm")
RESET = ("fem", "mpm", "mpm reset")
ABOVE = ("MPM/Margin above = 0, 6*L",)  # where grids that are reset need room
AROUND = ("MPM/Margin below = 2*L, 2*L", "MPM/Margin above = 2*L, 2*L")
PARTICLES = ("nsph", "sph")
ALL = GRID + PARTICLES
SETTINGS = {"fem": ["Method = fem"], "mpm": ["Method = mpm"], "mpm reset": ["Method = mpm", "MPM/Grid reset = always", "MPM/Shape functions = quadratic B-spline"],
            "nsph": ["Method = nsph"], "sph": ["Method = sph", "SPH/Energy balance = true"]}
TOLD = ["Output/Results by body = J"]  # for the least change of volume
FINE = {"n": 16, "T": .5, "steps": 20}  # of particles; explicit steps of twice the time take a minute and say no more
E, NU, LIMIT = 1000., .3, 1e-6  # of the scenes; error of an exact answer with the tolerance of Newton's method

# Reference of a case: from the results of a run and its method to the relative error.
Reference = Callable[[dict, str], float]


@dataclass(frozen=True)
class OtherRun:
    """A run of the same scene that a case is held against."""
    result: str
    constants: tuple  # pairs of names and values
    size: float = 1.  # of the result in the units of the case
    method: Optional[str] = None  # None: that of the case
    more: tuple = ()  # other settings
    scene: Optional[str] = None  # None: that of the case


def finest(result, n, **constants):
    """Biquadratic finite elements on a fine mesh, taken for right: twice as fine they differ by far less than the bounds."""
    return OtherRun(result, (*constants.items(), ("n", n)), method="fem", more=("FEM/Degree = 2",))


@dataclass
class Case:
    group: str
    name: str
    scene: str
    constants: dict
    methods: tuple = ALL
    error: Optional[Reference] = None
    bounds: tuple = (LIMIT, .03, .05)  # of the error: of grids that stay, of grids that are reset, of particles
    more: tuple = ()  # other settings
    is_quick: bool = False
    against: Optional[OtherRun] = None

    def sets(self, method):
        law = [f"Materials/{material}/Law = hypoelastic" for material in materials(self.scene) if method in PARTICLES]
        return SETTINGS[method] + TOLD + law + [f"Constants/{k} = {v!r}" for k, v in self.constants.items()] + list(self.more)

    def bound(self, method):
        return self.bounds[2 if method in PARTICLES else 1 if method == "mpm reset" else 0]


def materials(scene):
    return ("gel", "inside") if scene in ("inclusion", "islands") else ("gel",)


def force(stretch, nu=NU, aspect=1.):
    """Error of the force on the moved side of column.prm."""
    def error(results, method):
        right = laws.stretched(False, E, nu, stretch)[1] * aspect
        return abs(results["reaction_top_y_N"] / right - 1)
    return error


def von_mises(motion, size, nu=NU):
    """Error of the median of von Mises stress of affine.prm."""
    def error(results, method):
        right = laws.von_mises(motion(method in PARTICLES, E, nu, size))
        return abs(results["von_mises_p50_Pa"] / right - 1)
    return error


def pulled(results, method):
    """Error of the median of von Mises stress of free.prm."""
    return abs(results["von_mises_p50_Pa"] / (1e-4 * E) - 1)


def no_stress(results, method):
    return results["max_von_mises_Pa"] / E


def no_force(results, method):
    return max(abs(value) for name, value in results.items() if name.startswith("reaction_") and name.endswith("_N")) / E


def affine_cases():
    for nu in (0., .45, .49, .499, .4999):  # explicit steps of sound in nearly incompressible matter take too long for the last
        yield Case("Poisson's ratio", f"{nu:g}", "column", {"nu": nu, "stretch": 1.01}, RESET, force(1.01, nu), more=ABOVE,
                   is_quick=nu == .4999)
        yield Case("Poisson's ratio", f"{nu:g}, sheared", "affine", {"nu": nu, "shear": .1}, ALL if nu < .499 else ALL[:-1],
                   von_mises(laws.sheared, .1, nu), is_quick=nu == .4999)
    for stretch in (.8, .5, .2, 2., 6.):
        yield Case("stretch", f"{stretch:g}", "column", {"stretch": stretch}, RESET, force(stretch), more=ABOVE, is_quick=stretch in (.2, 6.))
        yield Case("stretch", f"{stretch:g}, four sides", "affine", {"stretch": stretch}, ALL, von_mises(laws.stretched, stretch),
                   is_quick=stretch in (.5, 2.))
    for steps in (40, 400):  # nothing but the elastic stress holds back what resets leave
        for stretch in (.5, 1.3, 2., 6.):
            yield Case("without viscosity", f"{stretch:g} in {steps} steps", "column", {"stretch": stretch, "steps": steps, "mu": 0.}, RESET,
                       force(stretch), (LIMIT, 1e-2, 0.), more=ABOVE, is_quick=stretch == 2. and steps == 40)
    for shear in (1., 5.):
        yield Case("shear", f"{shear:g}", "affine", {"shear": shear}, ALL, von_mises(laws.sheared, shear))
    for turns in (1, 10):
        yield Case("turns", f"{turns}", "affine", {"turns": turns, "steps": 40 * turns}, RESET + PARTICLES, no_stress, (LIMIT, .03, 1e-2), AROUND,
                   is_quick=turns == 1)
    for aspect in (.01, 100.):
        yield Case("aspect of cells", f"{aspect:g}", "column", {"aspect": aspect}, RESET, force(1.01, aspect=aspect), more=ABOVE)
    for mu in (1e-6, 1e-3, 1e3, 1e6):
        yield Case("viscosity over modulus and step", f"{mu:g}", "column", {"mu": mu * E / 40}, GRID, force(1.01))
        yield Case("viscosity over modulus and step", f"{mu:g}, sheared", "affine", {"mu": mu * E / 40, "shear": .1},
                   ALL[:-1] if mu == 1e3 else ALL,  # explicit steps, of 1e-7 s, take hours there; ten thousand times as many are refused
                   von_mises(laws.sheared, .1))
    for steps in (1, 4, 400):
        still = {"mu": 1e-6 * E / 40} if steps == 1 else {}  # a single step is not held afterwards
        yield Case("steps", f"{steps}", "affine", {"steps": steps, "shear": .1, **still}, ALL, von_mises(laws.sheared, .1))


def unit_cases():
    """Powers of two, so that round-off is the same: results must be those of other units to the last digits."""
    for name, L, modulus, T in (("nanometres", 2.**-30, 1., 1.), ("kilometres", 2.**10, 1., 1.), ("mPa", 1., 2.**-20, 1.),
                                ("TPa", 1., 2.**30, 1.), ("microseconds", 1., 1., 2.**-20), ("weeks", 1., 1., 2.**20)):
        constants = {"L": L, "E": modulus * E, "mu": 5 * modulus * T, "rho": modulus * T**2 / L**2, "T": T}
        for scene, result in (("affine", "von_mises_p50_Pa"), ("inclusion", "reaction_top_y_N"), ("indentation", "reaction_drive_y_N")):
            size = modulus * (1. if result.endswith("Pa") else L)
            shear = {"shear": .1} if scene == "affine" else {}
            yield Case("units", f"{name}, {scene}", scene, {**constants, **shear}, ALL, bounds=(1e-10, 1e-10, 1e-10),
                       against=OtherRun(result, tuple(shear.items()), size), is_quick=name == "nanometres" and scene != "indentation")


def composed_cases():
    for contrast in (1e-8, 1e-4, 1e-2, 1., 1e2, 1e4, 1e8):
        yield Case("contrast", f"{contrast:g}", "inclusion", {"contrast": contrast},
                   ALL if contrast < 1e8 else ALL[:-1], bounds=(.05, .1, .1),  # explicit steps of the stiff sound take hours there
                   against=finest("reaction_top_y_N", 64, contrast=contrast))
    for nu in (.49, .499, .4999):  # explicit steps of sound take minutes
        yield Case("contrast and incompressibility", f"{nu:g}", "inclusion", {"contrast": 1e4, "nu": nu}, ALL[:-1],
                   bounds=(math.inf, math.inf, math.inf))
    for strain in (.2, .4):
        yield Case("compression of an inclusion", f"{strain:g}", "inclusion", {"strain": strain}, ALL, bounds=(math.inf, math.inf, math.inf))
    yield Case("zero load", "held", "inclusion", {"strain": 0.}, ALL, no_force, (1e-12, 1e-12, 1e-12), is_quick=True)
    for depth, T in ((.1, 1.), (.1, .1), (.3, 1.), (.5, 1.)):  # deep ones of rate forms differ from those of finite elements by the law
        for methods, right in [(ALL, "fem")] if depth < .3 else [(GRID, "fem"), (PARTICLES, "nsph")]:
            yield Case("contact", f"depth {depth:g} in {T:g} s", "indentation", {"depth": depth, "T": T}, methods,
                       bounds=(.15, .15, .15) if depth < .3 else (.15, .15, .3),
                       against=OtherRun("reaction_drive_y_N", (("depth", depth), ("T", T), ("n", 32)), method=right))
    for n_cycles in (10, 1000):
        cycles = f"strain*L*sin(2*pi*{n_cycles}*t/T)"
        yield Case("cycles", f"{n_cycles}", "inclusion", {"n": 4, "steps": 8 * n_cycles, "T": float(n_cycles), "mu": .005}, ALL, no_force,
                   (1e-5, 1e-2, 5e-3), (f"Supports/top/Displacement = {cycles}; -{cycles}",), is_quick=n_cycles == 10)
    for jitter in (.1, .3):
        yield Case("disorder", f"{jitter:g} of the spacing", "affine", {**FINE, "shear": .1}, PARTICLES,
                   von_mises(laws.sheared, .1), (0., 0., .05), (f"NSPH/Jitter = {jitter}", f"SPH/Jitter = {jitter}"))
    for length in (1., 2.):
        yield Case("smoothing length over spacing", f"{length:g}", "affine", {**FINE, "shear": .1}, PARTICLES,
                   von_mises(laws.sheared, .1), (0., 0., .05), (f"NSPH/Smoothing length = {length}", f"SPH/Smoothing length = {length}"))


def odd_cases():
    """What grids, particles and bodies may meet that no one plans: cells that hold next to nothing, places filled twice, pieces that nothing holds."""
    for cut in (.5, .1, .01, 1e-4):  # a fifth of the cells at 8 a side; in those at corners the square of it
        yield Case("cells filled to a part", f"{cut:g}", "cut_cells", {"cut": cut, "shear": .1}, ("mpm", "mpm reset"), von_mises(laws.sheared, .1),
                   (.05, .05, 0.), AROUND, is_quick=cut == .1)  # of the strip beyond the outermost points: 3 % at 8 cells, of first order
    for n_points in (1, 4):
        yield Case("points a cell", f"{n_points}^2", "column", {}, ("mpm", "mpm reset"), force(1.01),
                   more=(*ABOVE, f"MPM/Points per cell = {n_points}, {n_points}"))
    yield Case("points leave the grid", "stretch 2 without a margin", "column", {"stretch": 2.}, ("mpm", "mpm reset"), force(2.))
    for jitter in (.4, .5):
        yield Case("clusters", f"{jitter:g} of the spacing", "affine", {**FINE, "shear": .1}, PARTICLES,
                   von_mises(laws.sheared, .1), (0., 0., .05), (f"NSPH/Jitter = {jitter}", f"SPH/Jitter = {jitter}"))
    twice = ("Bodies/twice/Shape = box", "Bodies/twice/Lower corner = L/4, 0", "Bodies/twice/Upper corner = L, L", "Bodies/twice/Material = gel", "Bodies/block/Material = gel")
    yield Case("duplicates", "three quarters filled twice", "affine", {"shear": .1}, ALL, von_mises(laws.sheared, .1), more=twice, is_quick=True)
    yield Case("free body", "pulled", "free", {}, ALL, pulled, (1e-4, .03, .05), is_quick=True)
    yield Case("free body", "pulled, held at two points", "free", {}, RESET, pulled, (1e-4, .03, .05),  # strains of 1e-4 are not nothing
               (*AROUND, "Supports/one/Where = nearest 0, 0", "Supports/one/Displacement = 0; 0",
                "Supports/other/Where = nearest L, 0", "Supports/other/Displacement = free; 0"))
    yield Case("islands", "beside the body", "islands", {"contrast": 10.}, ALL, bounds=(LIMIT, .03, 1e-3),
               against=OtherRun("reaction_top_y_N", (("contrast", 10.),), scene="inclusion"), is_quick=True)
    yield Case("islands", "with a load", "islands", {"contrast": 10.}, ALL, bounds=(math.inf, math.inf, math.inf),
               more=("Loads/drive/Where = box 1.4*L, 0 : 2.1*L, L", "Loads/drive/Total force = 1e-3*E*L; 0"))
    yield Case("hold", "40,000 relaxation times", "affine", {"shear": .1, "T": 1000., "steps": 40}, ALL[:-1], von_mises(laws.sheared, .1))


def all_cases():
    return [*affine_cases(), *unit_cases(), *composed_cases(), *odd_cases()]
