#!/usr/bin/python3 -Es
"""Study of the trade-off between accuracy and cost: every order on every mesh of many benchmarks, and runs with `Accuracy`
on these and on the scenes of the gallery. apps/plots/trade_page.py evaluates which order is best for what."""

import math
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import NamedTuple

BIN = Path(__file__).resolve().parent
sys.path[:0] = [str(BIN / "studies"), str(BIN.parent / "python")]

import study  # noqa: E402
from mixbeam._core import JudgedProblem, JudgedReference  # noqa: E402
from mixbeam.errors import InputError  # noqa: E402

MOST_ELEMENTS, HIGHEST_ORDER = 100000, 8

# Largest difference of the references: a tenth of the smallest accuracy by which every benchmark is judged.
REFERENCES_AGREE = 1e-10
# Errors are judged if they are this many times the difference of the references, which is an error of both.
ABOVE_REFERENCE = 10.0
# Order that confirms the references of the gallery, with one and a half times as many elements.
CONFIRMING_ORDER = 6

# Theory: polynomials of degree k. Higher orders reach round-off on meshes too coarse for a rate.
HIGHEST_RATED_ORDER, RATE_TOLERANCE, RATE_ROUND_OFF = 4, 0.2, 1e-10

# Estimates are judged if the true error is neither that of a very coarse mesh nor rounding, and is known to a tenth
# from the references.
LARGEST_ERROR, SMALLEST_ERROR = 1e-2, 1e-10
FACTOR, SHARE_BEYOND, MOST_BELOW = 5.0, 0.05, 10.0

# A mesh is at round-off if all errors are this small, or as small as those of the reference, on two consecutive meshes,
# so that one error that is small by chance does not end a row.
ROUND_OFF, ROUNDED_MESHES = 1e-12, 2
GROWTH = 2.0  # least growth of the time for twice as many elements, by which the time of a finer mesh is estimated
NO_SOLUTION = 0.01  # no time is estimated from a mesh with a larger error: it has followed another path
CLEARLY_DEARER = 1.3  # a cell that costs more than this many times a better one is no candidate, despite scatter
MOST_HALVINGS = 4  # of the elements of a member of the file

LEAST_ROUNDS = 3  # for a median
PRICE_BUDGET = 0.3  # seconds for the runs of one accuracy with one number of threads, beyond LEAST_ROUNDS
CANDIDATES = 3  # timed again: the cheapest of a matrix is one of them despite the scatter of times

DISPLACEMENT, CENTERLINE, MOMENT, ENERGY = range(4)  # see ErrorOf in apps/python/judged_problem.hpp
ERRORS = ("displacement", "centerline", "moment", "energy")
WALL, SETUP, PROCESSOR = range(3)  # seconds
TIMES = ("seconds_", "setup_seconds_", "processor_seconds_")
UNKNOWN = (math.nan,) * 4


class Benchmark(NamedTuple):
    name: str  # in tables and files
    file: str  # in the folder trade_benchmarks beside the program; empty: the study's own scene
    kind: str  # a few words: plane or space, smooth or kinked, slender or thick
    point: str = ""  # the displacement of this point is judged; empty: the first loaded point
    load_case: str = ""
    load_share: float = 1.0  # share of the loads of the file, below the first limit point
    branch: str = ""  # for loads beyond a bifurcation; empty: as in the file
    integrations: bool = False  # measured with full integration of force strains too
    rates: bool = False  # smooth: rates of convergence are checked against theory
    refinement: int = 0  # of a scene of the gallery, solved as given: elements of the reference per element of the file

    @property
    def in_gallery(self):
        return self.refinement > 0

    @property
    def set(self):
        return "gallery" if self.in_gallery else "matrix"


SMOOTH, LAYERS = 4, 64  # smooth bending needs few elements of order 8, thin layers of bending many


def scene(name, kind, refinement=SMOOTH):
    return Benchmark(name, f"gallery/{name}.xml", kind, refinement=refinement)


MATRIX = (
    Benchmark("thick_cantilever", "", "plane, smooth, thick", rates=True),
    Benchmark("elastica", "elastica.xml", "plane, smooth, rigid in force strains", "tip", "alpha 10"),
    Benchmark("rollup", "rollup.xml", "plane, two full circles, slender", "tip", integrations=True),
    Benchmark("follower_force", "follower_force.xml", "plane, smooth, unsymmetric tangent", "tip", "alpha 10"),
    Benchmark("euler_column", "euler_column.xml", "plane, smooth, behind a bifurcation", "tip", "100 degrees",
              branch="positive"),
    Benchmark("lee_frame", "lee_frame.xml", "plane, kinked", "loaded", load_share=0.5),  # first limit point at 0.6186
    Benchmark("deep_arch", "deep_arch.xml", "plane, arch of 215 degrees", "crown", load_share=0.5),  # at 0.8973
    Benchmark("arc_45_slender", "arc_45_slender.xml", "space, curved, slenderness 10,000", "tip", integrations=True),
    Benchmark("arc_45_thick", "arc_45_thick.xml", "space, curved, slenderness 10", "tip", rates=True),
    Benchmark("helix", "helix.xml", "space, two coils, constant strains", "tip"),
    Benchmark("helical_rod", "helical_rod.xml", "space, ten turns, many load steps", "tip"),
    Benchmark("composite_cantilever", "gallery/composite_cantilever.xml", "space, smooth, coupled section", "tip"),
    Benchmark("slope_discontinuity", "slope_discontinuity.xml", "space, kinked", "tip"),
    Benchmark("fork", "fork.xml", "space, branched, two stages", "P1"),
    Benchmark("lateral_buckling", "lateral_buckling_positive.xml", "space, kinked strip, behind a bifurcation", "tip",
              branch="positive"),
    Benchmark("narrow_cantilever", "narrow_cantilever.xml", "space, strip, behind a bifurcation", "tip",
              branch="positive"))
GALLERY = (
    scene("elastica", "plane, smooth, rigid in force strains"),
    scene("follower_cantilever", "plane, a force that turns with the section"),
    scene("composite_cantilever", "space, coupled section"),
    scene("deployable_ring", "space, closed loop, turned by its support"),
    scene("coil_spring", "space, helix of six turns, guided"),
    scene("shallow_arch", "plane, two arcs, hinged"),
    scene("bistable_strip", "plane, two arcs, through a snap"),
    scene("lees_frame", "plane, kinked, close to its limit load"),
    scene("snap_back", "plane, kinked, two limit points"),
    scene("lateral_buckling", "space, kinked strip, behind a bifurcation"),
    scene("catenary", "plane, cable, layers at the hooks", LAYERS),
    scene("gripper", "space, branched, eigencurvature"),
    scene("parallel_linkage", "plane, hinges, free of stress"),
    scene("cable_net", "space, 60 ropes, prestressed, two stages", LAYERS),
    scene("tree", "space, branched, two stages"),
    scene("twisted_blade", "space, pre-twist, coupled section, two stages"),
    scene("honeycomb", "plane, lattice"))

# The finest row of the paper's table, to half a unit of the last digit; the values in the file of the helical rod are
# those of a coarse mesh.
HELICAL_ROD = (("x", 4.803e-3, 5.1e-7), ("y", 7.250e-5, 5.1e-9), ("z", -7.644e-2, 5.1e-6))
HELICAL_ROD_SOURCE = "Humer, Steinbrecher, Pechstein, table of the rod bent to helical shape, k = 4"


def largest(errors):
    return math.nan if any(map(math.isnan, errors)) else max(errors)


def of_motion(errors):
    """Returns the larger error of tip and centerline."""
    return largest(errors[:2])


def cost(times, threads):
    """Returns processor time for one thread, which is independent of other work on the machine, else wall time."""
    return times[PROCESSOR if threads == 1 else WALL]


def medians(runs):
    return tuple(median(values) for values in zip(*runs, strict=True))


class Plan:
    """Parameters of the study: cells, references, timing."""

    def __init__(self, app):
        self.benchmarks, self.gallery = app.words("Benchmarks"), app.words("Gallery")
        self.orders, self.elements = sorted(app.numbers("Orders")), sorted(app.numbers("Elements"))
        self.reference, self.confirmation = tuple(app.numbers("Reference")), tuple(app.numbers("Confirmation"))
        self.accuracies, self.threads = app.reals("Accuracies"), app.numbers("Threads")
        self.repetitions, self.budget = app.number("Repetitions"), app.real("Seconds")
        self.most_seconds = app.real("Most Seconds")


@dataclass
class Cell:
    """A benchmark on one mesh, solved, judged, timed."""
    order: int
    elements: int
    is_full: bool = False  # full integration of force strains, else reduced
    status: str = "failed"  # no equilibrium was found
    errors: tuple = UNKNOWN
    estimated: tuple = UNKNOWN  # by the run itself; none in the gallery
    estimate_seconds: float = 0.0  # processor time for that
    sizes: tuple = (0, 0, 0.0)  # global unknowns, interior unknowns, floating-point operations
    work: tuple = (0, 0, 0)  # load steps, failed ones, Newton iterations
    times: dict = field(default_factory=dict)  # {threads: medians}

    @property
    def converged(self):
        return self.status == "converged"

    def cost(self, threads):
        known = threads if threads in self.times else min(self.times)
        return cost(self.times[known], known)


@dataclass
class AccurateCell:
    """Result of a run with a wanted accuracy."""
    wanted: float
    end: str
    meshes: list  # (order, elements, whether the path was followed)
    estimate: float
    errors: tuple
    path_error: float
    prices: dict  # {threads: (seconds, cheapest cell or None, its seconds)}


class Study:
    """All cells of one benchmark."""

    def __init__(self, app, about, plan):
        self.about, self.plan = about, plan
        self.problem = problem = JudgedProblem(app, str(BIN / "trade_benchmarks" / about.file) if about.file else "",
                                               about.load_case, about.load_share, about.branch, about.point,
                                               about.in_gallery)
        finest = problem.own_elements * about.refinement
        gallery = (HIGHEST_ORDER, finest), (CONFIRMING_ORDER, finest * 3 // 2)
        self.meshes = gallery if about.in_gallery else (plan.reference, plan.confirmation)
        self.finest_run = self.reference_run(*self.meshes[0])
        self.reference = JudgedReference(problem, self.finest_run)
        self.difference = self.reference.errors_of(self.reference_run(*self.meshes[1]))
        self.cells, self.accurate = [], []

    def reference_run(self, order, elements):
        run = self.problem.solve(order, elements, follows=True)
        if not run.finished:
            raise study.ConvergenceError(f"no reference for {self.about.name}, order {order}, {elements} elements for each "
                                         f"member: {run.failure}")
        return run

    def judged(self, errors):
        """Returns the largest of the judged errors: in the gallery those of displacements only."""
        return of_motion(errors) if self.about.in_gallery else largest(errors)

    @property
    def floor(self):
        """Smallest accuracy that is judged; errors below are those of the reference and rounding."""
        return ABOVE_REFERENCE * self.judged(self.difference)

    @property
    def expected_values(self):
        return len(HELICAL_ROD) if self.about.name == "helical_rod" else self.problem.expected_values

    def cheapest(self, accuracy, threads):
        """Returns the cells with both force parts reduced and errors of motion within the accuracy, cheapest first; none
        if so small an error is not judged."""
        if accuracy < self.floor:
            return []
        good = [c for c in self.cells if c.converged and not c.is_full and of_motion(c.errors) <= accuracy]
        return sorted(good, key=lambda cell: cell.cost(threads))

    def run_once(self, cell, threads):
        return self.problem.solve(cell.order, cell.elements, cell.is_full, threads, self.plan.most_seconds)

    def time_cell(self, cell, first, threads):
        """Times a cell with all numbers of threads in turn, so that a temporary slowdown of the machine affects all alike.
        The first run with each is a warm-up; it counts only if the budget allows no other."""
        affordable = int(min(self.plan.repetitions, self.plan.budget / (first[WALL] * len(threads))))
        runs = {}
        for turn in range(1 + (affordable if affordable >= LEAST_ROUNDS else 0)):
            for n in threads:
                is_first = turn == 0 and n == threads[0]
                times = first if is_first else self.run_once(cell, n).times
                runs[n] = [times] if turn <= 1 else [*runs[n], times]
        return {n: medians(of_threads) for n, of_threads in runs.items()}

    def measured(self, cell, threads):
        try:
            run = self.run_once(cell, threads[0])
            cell.sizes, cell.work = run.sizes, (run.steps, run.failed_steps, run.iterations)
            cell.times = {threads[0]: run.times}
            if run.interrupted:
                cell.status = "too long"
            if not run.finished:
                return cell
            cell.status = "converged"
            cell.errors = self.reference.errors_of(run)
            if not self.about.in_gallery:
                cell.estimated, cell.estimate_seconds = self.problem.estimated(run)
            cell.times = self.time_cell(cell, run.times, threads)
        except InputError:  # a mesh that is too coarse for its curve
            cell.status = "failed"
        return cell

    def measure_row(self, order, is_full):
        """Measures the cells of an order; those that are not computed are added with the reason."""
        plan, rounded, rounded_meshes, last_seconds = self.plan, max(ROUND_OFF, largest(self.difference)), 0, 0.0
        for elements in plan.elements:
            cell = Cell(order, elements, is_full)
            if rounded_meshes >= ROUNDED_MESHES:
                cell.status = "past round-off"
            elif GROWTH * last_seconds > plan.most_seconds:
                cell.status = "too long"
            else:
                self.measured(cell, plan.threads)
                error = largest(cell.errors)
                last_seconds = cell.times[plan.threads[0]][PROCESSOR] if error < NO_SOLUTION else 0.0
                rounded_meshes = rounded_meshes + 1 if error <= rounded else 0
            self.cells.append(cell)

    def meshes_of_file(self):
        """Returns the elements of the finest member: those of the file, halved and doubled."""
        own = self.problem.own_elements
        parts = [2**halvings for halvings in range(MOST_HALVINGS, -1, -1)]
        factors = [2**doublings for doublings in range(1, self.about.refinement.bit_length())]
        return [-(-own // part) for part in parts if own >= part] + [own * factor for factor in factors]

    def measure_front(self):
        """Measures only cells that may be the cheapest for one of the accuracies, from the highest order down."""
        threads = self.plan.threads[:1]  # other numbers of threads are measured with the accuracies
        smallest = min(self.plan.accuracies)
        for order in reversed(self.plan.orders):
            for elements in self.meshes_of_file():
                cell = self.measured(Cell(order, elements), threads)
                self.cells.append(cell)
                error = of_motion(cell.errors)
                if cell.status == "too long" or error <= smallest:
                    break
                best = self.cheapest(smallest, threads[0])
                if error < NO_SOLUTION and best and \
                        cell.times[threads[0]][PROCESSOR] > CLEARLY_DEARER * best[0].times[threads[0]][PROCESSOR]:
                    break

    def measure(self):
        if self.about.in_gallery:
            self.measure_front()
        else:
            for is_full in (False, True) if self.about.integrations else (False,):
                for order in self.plan.orders:
                    self.measure_row(order, is_full)
        self.accurate = [self.accurate_cell(wanted) for wanted in self.plan.accuracies]

    def accurate_cell(self, wanted):
        run = self.problem.solve_accurately(wanted, self.plan.threads[0])
        return AccurateCell(wanted, run.end, run.meshes, run.last_estimate,
                            self.reference.errors_of(run) if run.finished else UNKNOWN, self.reference.path_error_of(run),
                            {n: self.price(wanted, n) for n in sorted(set(self.plan.threads))})

    def price(self, wanted, threads):
        """Times runs with `Accuracy` and the cheapest cells in turn, so that a temporary slowdown affects all alike."""
        cells = self.cheapest(wanted, threads)[:CANDIDATES]
        own, others = [], [[] for _ in cells]
        begin = time.monotonic()  # determines the number of rounds only; times come from the solver
        while len(own) < min(self.plan.repetitions, LEAST_ROUNDS) or \
                (len(own) < self.plan.repetitions and time.monotonic() - begin < PRICE_BUDGET):
            own.append(cost(self.problem.solve_accurately(wanted, threads).times, threads))
            for cell, times in zip(cells, others, strict=True):
                times.append(cost(self.run_once(cell, threads).times, threads))
        candidates = [(median(times), cell) for cell, times in zip(cells, others, strict=True)]
        best_seconds, best = min(candidates, key=lambda c: c[0], default=(math.nan, None))
        return median(own), best, best_seconds

    def check_reference(self, app):
        """Compares the two references, and the finer one with closed forms and values from the literature."""
        name = self.about.name
        app.check_upper_bound(f"{name}: difference of the references", self.judged(self.difference), REFERENCES_AGREE,
                              "another order on another mesh")
        if name != "helical_rod":
            self.problem.check_expected(self.finest_run, name)
            return
        for own, (component, value, tolerance) in zip(self.finest_run.position("tip"), HELICAL_ROD, strict=True):
            app.check_absolute(f"{name}: tip, {component}", own, value, tolerance, HELICAL_ROD_SOURCE)

    def check_rates(self, app):
        """Checks that the error of the centerline falls with the power k + 1 of the element length, between the finest two
        meshes before the error first falls below rounding."""
        for order in self.plan.orders:
            above = []
            for cell in self.cells:
                if cell.order != order or cell.is_full or not cell.converged:
                    continue
                if not cell.errors[CENTERLINE] > RATE_ROUND_OFF:
                    break
                above.append(cell)
            if order > HIGHEST_RATED_ORDER or len(above) < 2:
                continue
            coarse, fine = above[-2:]
            rate = math.log(coarse.errors[CENTERLINE] / fine.errors[CENTERLINE]) / math.log(fine.elements / coarse.elements)
            app.check_absolute(f"{self.about.name} k={order}: rate of the centerline", rate, order + 1, RATE_TOLERANCE,
                               "Humer, Steinbrecher, Pechstein: polynomials of degree k, optimal rate k + 1")

    def check(self, app):
        """Checks rates and wanted accuracies."""
        if self.about.rates:
            self.check_rates(app)
        for cell in self.accurate:
            if cell.wanted >= self.floor:
                app.check_upper_bound(f"{self.about.name}: error for a wanted accuracy of {cell.wanted:.0e}",
                                      of_motion(cell.errors), cell.wanted, "the accuracy that was asked for")
        for cell in self.cells:
            app.count_work(cell.work[0], cell.work[2])


def check_estimates(app, studies):
    """Checks estimates of displacements and moments; those of the energy are recorded only."""
    for quantity in (DISPLACEMENT, CENTERLINE, MOMENT):
        ratios = [cell.estimated[quantity] / cell.errors[quantity] for one in studies for cell in one.cells
                  if cell.converged and not cell.is_full and SMALLEST_ERROR <= cell.errors[quantity] <= LARGEST_ERROR
                  and cell.errors[quantity] >= ABOVE_REFERENCE * one.difference[quantity]]
        if not ratios:
            continue
        within = sum(1.0 / FACTOR <= ratio <= FACTOR for ratio in ratios)
        least = min((ratio for ratio in ratios if not math.isnan(ratio)), default=math.inf)
        name = f"estimate of the {ERRORS[quantity]}"
        app.check_upper_bound(f"{name}: cells beyond a factor of 5", 1.0 - within / len(ratios), SHARE_BEYOND,
                              "goal of mixbeam: 95 % of all cells within a factor of 5")
        app.check_upper_bound(f"{name}: largest true error over estimate", 1.0 / least if least else math.inf, MOST_BELOW,
                              "goal of mixbeam: never less than a tenth")


def meshes_text(meshes):
    """Returns the sequence of meshes, "5 x 4, 7 x 6"; a star: the solution was carried over."""
    return ", ".join(f"{order} x {elements}" + ("" if followed or i == 0 else "*")
                     for i, (order, elements, followed) in enumerate(meshes))


class Tables:
    def __init__(self, app, threads):
        self.threads = threads
        self.benchmarks = app.table(
            "benchmarks.csv", "benchmark,set,kind,members,point,floor,displacement_difference,centerline_difference,"
            "moment_difference,energy_difference,values_checked,reference,confirmation", 0)
        self.cells = app.table(
            "trade.csv", ",".join(
                ["benchmark,integration,order,elements,status,set,flops,global_unknowns,interior_unknowns,load_steps,"
                 "failed_steps,newton_iterations,largest_error", *(e + "_error" for e in ERRORS),
                 *(e + "_estimate" for e in ERRORS), "estimate_seconds", *(t + str(n) for n in threads for t in TIMES)]), 0)
        self.accuracies = app.table(
            "accuracy.csv", "benchmark,wanted,outcome,meshes,estimated_error,displacement_error,centerline_error,"
            "path_error,threads,seconds,best_order,best_elements,best_seconds,ratio,set,rounds", 14)

    def add(self, one):
        about, problem = one.about, one.problem
        self.benchmarks.add_row([about.name, about.set, about.kind, problem.members, problem.point, one.floor,
                                 *one.difference, one.expected_values, *(f"{k} x {n}" for k, n in one.meshes)])
        for cell in one.cells:
            *unknowns, flops = cell.sizes
            times = (cell.times.get(n, (math.nan,) * len(TIMES)) for n in self.threads)
            self.cells.add_row([about.name, "full" if cell.is_full else "both reduced", cell.order, cell.elements,
                                cell.status, about.set, flops, *unknowns, *cell.work, largest(cell.errors), *cell.errors,
                                *cell.estimated, cell.estimate_seconds, *(value for of in times for value in of)])
        for cell in one.accurate:
            for threads, (seconds, best, best_seconds) in cell.prices.items():
                self.accuracies.add_row([about.name, cell.wanted, cell.end, meshes_text(cell.meshes), cell.estimate,
                                         cell.errors[DISPLACEMENT], cell.errors[CENTERLINE], cell.path_error, threads,
                                         seconds, best.order if best else 0, best.elements if best else 0, best_seconds,
                                         seconds / best_seconds, about.set, len(cell.meshes)])


def run(app):
    plan = Plan(app)
    tables = Tables(app, plan.threads)

    def compute(about):
        one = Study(app, about, plan)
        one.check_reference(app)
        one.measure()
        one.check(app)
        tables.add(one)
        return one

    check_estimates(app, [compute(about) for about in MATRIX if about.name in plan.benchmarks])
    for about in GALLERY:
        if about.name in plan.gallery:
            compute(about)
    app.write_machine()


study.main(
    __file__, "what each digit costs: error against time for every element order and mesh, on many scenes.",
    "Which benchmarks and which cells; a single cell can be measured again by naming it alone.",
    [("Benchmarks", [one.name for one in MATRIX], None, None,
      "Those that are measured; thick_cantilever is the scene of this file, whatever it is."),
     ("Gallery", [one.name for one in GALLERY], None, None,
      "Scenes of the gallery on which the program is asked for the accuracies."),
     ("Orders", [1, 2, 3, 4, 5, 6, 7, 8], 1, HIGHEST_ORDER, "Element orders k."),
     ("Elements", [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024], 1, MOST_ELEMENTS, "Numbers of elements of each member."),
     ("Reference", (8, 64), 1, MOST_ELEMENTS, "Order and elements of each member of the reference."),
     ("Confirmation", (6, 96), 1, MOST_ELEMENTS, "The same of the solution that confirms it."),
     ("Accuracies", [1e-3, 1e-6, 1e-9], 0.0, 1.0,
      "Errors of displacements that the program is asked for, to choose meshes itself."),
     ("Threads", [1, 2], 1, MOST_ELEMENTS, "Numbers of threads; recommendations are those of the first."),
     ("Repetitions", 7, 1, 1000,
      "Timed runs of a cell with each number of threads, at most; at least three if Seconds allow."),
     ("Seconds", 0.06, 0, math.inf, "For the repetitions of a cell; else one run counts."),
     ("Most Seconds", 0.5, 0.0, math.inf,
      "Processor time: a cell that takes longer is stopped after its load step, finer meshes are left out.")], run)
