"""The problems of contrib/evidence work-precision. The first word of a case of a study is its method."""
from dataclasses import dataclass


@dataclass(frozen=True)
class Problem:
    name: str
    title: str
    study: str  # file under parameters
    defaults: tuple  # cases that are what a method does unless it is told otherwise
    why: str  # what decides which method wins
    sets: tuple = ()  # entries that make it small
    reference: tuple = ()  # entries of the reference, where the study has none
    coarser: tuple = ()  # entries of runs coarser than the reference, each twice as coarse as the one before; none if the solution is exact
    grid: tuple = ()  # cells of the grid on which fields are compared
    field: str = "displacement_m"
    result: str = ""  # what is compared instead of a field


SLICE = ("Method = fem", "FEM/Material at = cell")
FEM_CONTACT = ("Method = fem", "FEM/Degree = 2", "Constants/cells = 20")
STOKES = ("Method = fem", "Constants/levels = 3")
PROBLEMS = (
    Problem("manufactured", "Manufactured solution of finite strain in 3D", "evidence/work_manufactured.prm", ("MPM", "FEM Q2"),
            "The solution is smooth, so that order decides: the error of quadratic elements falls with the third power of the cell, that of linear functions "
            "with the second. B-splines are of second order too, since points on a lattice are no Gauss rule, but with an eighth of the error."),
    Problem("slice", "Slice of two materials, contrast 10", "evidence/work_slice.prm", ("MPM", "FEM Q2"),
            "The solution has kinks along interfaces that no cell fits: errors fall with about the first power of the cell. What counts is how well the mixture "
            "in a cell is represented: composite cells (MPM as it comes), whose gradient jumps there, have a quarter to a third of the error of bonded points; "
            "with two-moment points they cost no more. Grids that are reset have bonded points; 16 resets cost 16 steps, and change the error little.",
            coarser=((*SLICE, "Constants/cells = 128", "FEM/Degree = 2"), (*SLICE, "Constants/cells = 64", "FEM/Degree = 2")), grid=("101", "101")),
    Problem("construct", "Construct of two materials in 3D, contrast 10", "evidence/work_construct.prm", ("MPM", "FEM Q2"),
            "As in the slice; in 3D the matrix of quadratic functions is dearer still.",
            coarser=((*SLICE, "Constants/cells = 16", "FEM/Degree = 2"), ("Method = fem", "Constants/cells = 8", "FEM/Degree = 2")), grid=("33", "33", "17")),
    Problem("tractions", "Tractions on a Kelvin-Voigt solid (Heck 2017, 3.1)", "evidence/work_tractions.prm", ("NSPH SDIRK 2", "MPM linear", "FEM Q2"),
            "Space and step are refined together, with the same steps of all grids of a number of unknowns. Particles and biquadratic elements of the "
            "same number of unknowns have errors of a size here; bilinear cells need four times as many for it. Stresses of first order in time (backward Euler, explicit) hold NSPH back. SPH follows waves. B-splines are ahead of linear functions because the "
            "solution is smooth but at the rims; linear ones are what MPM takes because that is lost where materials meet (slice, construct), where "
            "B-splines cost more and are no better, and because only they have geometric multigrid.",
            coarser=(("Constants/cells = 50", "Constants/dt = 4", "FEM/Degree = 2", "FEM/Scheme = SDIRK 3"),
                     ("Constants/cells = 25", "Constants/dt = 8", "FEM/Degree = 2", "FEM/Scheme = SDIRK 3")), grid=("101", "101")),
    Problem("indentation", "Indentation with a rigid circle (Heck 2017, 3.3)", "evidence/work_indentation.prm", ("FEM Q2", "MPM linear", "NSPH"),
            "The edge of the contact moves over cells, which bounds the order; particles see the surface only to a part of their spacing. Where nodes stick "
            "depends on the grid, however fine: no reference of these steps tells errors below 2e-3 apart, so that B-splines end at 20 cells.",
            coarser=((*FEM_CONTACT, "Constants/levels = 5"), (*FEM_CONTACT, "Constants/levels = 4")), grid=("101", "101")),
    Problem("pillars", "Flow past square pillars (Heck 2017, 3.2)", "evidence/work_pillars.prm", ("NSPH as it comes", "FEM"),
            "The velocity gradient is infinite at the pillar's corners. Elements are split there, and their error falls with the power 2.6 of the cell; "
            "particles are all of a size, and theirs falls with the first: for the same time it is 6 to 17 times that of elements. The stabilisation that NSPH "
            "has unless it is told otherwise makes the error 1.6 to 1.8 times as large here; walls of facets take a sixth off it, for a quarter more time.",
            coarser=((*STOKES, "Constants/cells = 40"), (*STOKES, "Constants/cells = 20")), grid=("100", "100"), field="velocity_m_per_s"),
    Problem("migration", "Way of a migrating cell (Heck 2017, 3.4), by spacing and step", "evidence/work_migration.prm", ("NSPH steps of 2 s",),
            "Only NSPH solves it. The spacing counts: of the fluid that the cell makes before it a rim of a quarter of its radius drags at it, which 20 um "
            "do not see. Steps do not: a particle moves by a fifth of the spacing in each, at most.",
            result="cell_displacement_y_m", reference=("Constants/dp = 1.25", "Constants/step = 0.5"),
            coarser=(("Constants/dp = 2.5", "Constants/step = 1"), ("Constants/dp = 5", "Constants/step = 2"))),
)
