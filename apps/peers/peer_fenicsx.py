"""FEniCSx: a mixed rod element written in UFL.

Displacement and the rotation vector of the load step are continuous of degree k, forces and moments discontinuous of degree k - 1;
k Gauss points. Rotation and curvature of the previous step are stored at Gauss points and updated by Cayley's map. The mesh
coordinate is the arc length, so that the geometry is exact."""

import time

import basix
import dolfinx
import numpy as np
import ufl
from dolfinx import fem, mesh, nls
from mpi4py import MPI
from petsc4py import PETSc

MOST_ITERATIONS = 30
MORE_WORKSPACE = 400  # percent, of MUMPS: delayed pivots of the mixed form need it


def version():
    return dolfinx.__version__


def skew(a):
    return ufl.as_matrix(((0, -a[2], a[1]), (a[2], 0, -a[0]), (-a[1], a[0], 0)))


def keep(function, values):
    """Stores values at the Gauss points of all elements in a function."""
    numbers, size = function.function_space.dofmap, function.function_space.dofmap.index_map_bs
    function.x.array[(numbers.list.array[:, None] * size + np.arange(size)).ravel()] = values.ravel()


class Rod:
    def __init__(self, problem, order, elements, solver):
        self.domain = domain = mesh.create_interval(MPI.COMM_WORLD, elements, [0.0, problem.length])
        self.cells = np.arange(elements, dtype=np.int32)
        cell, degree = domain.ufl_cell(), 2 * order - 1
        smooth, jumping = ufl.VectorElement("CG", cell, order, dim=3), ufl.VectorElement("DG", cell, order - 1, dim=3)
        self.space = fem.FunctionSpace(domain, ufl.MixedElement(smooth, smooth, jumping, jumping))
        self.state, self.load = fem.Function(self.space), fem.Constant(domain, 0.0)
        self.rotations = np.asarray(self.space.sub(1).collapse()[1])
        points, kept = basix.make_quadrature(basix.CellType.interval, degree)[0], {"degree": degree, "quad_scheme": "default"}
        self.turned = fem.Function(fem.FunctionSpace(domain, ufl.TensorElement("Quadrature", cell, shape=(3, 3), **kept)))
        self.bent = fem.Function(fem.FunctionSpace(domain, ufl.VectorElement("Quadrature", cell, dim=3, **kept)))
        angle = ufl.SpatialCoordinate(domain)[0] * self.constant(1 / problem.radius if problem.radius else 0)
        triad = ufl.as_matrix(((ufl.cos(angle), ufl.sin(angle), 0), (-ufl.sin(angle), ufl.cos(angle), 0), (0, 0, 1)))
        keep(self.turned, fem.Expression(triad, points).eval(self.cells))
        residual, *reached = self.equations(problem, degree, triad[:, 0])
        self.reached = [fem.Expression(one, points) for one in reached]
        self.newton = nls.petsc.NewtonSolver(domain.comm, fem.petsc.NonlinearProblem(residual, self.state, self.clamp()))
        self.newton.convergence_criterion, self.newton.max_it = "residual", MOST_ITERATIONS
        if solver:
            self.newton.rtol, self.newton.atol = 1e-10, 1e-13 * max(map(abs, problem.force + problem.moment))
            krylov, options = self.newton.krylov_solver, PETSc.Options()
            options[krylov.getOptionsPrefix() + "pc_factor_mat_solver_type"] = solver
            options[krylov.getOptionsPrefix() + "mat_mumps_icntl_14"] = MORE_WORKSPACE
            krylov.setFromOptions()

    def constant(self, *values):
        """Returns constants that may change without recompiling the forms."""
        return fem.Constant(self.domain, tuple(map(float, values)) if len(values) > 1 else float(values[0]))

    def equations(self, problem, degree, tangent):
        dx, test = ufl.Measure("dx", self.domain, metadata={"quadrature_degree": degree}), ufl.TestFunction(self.space)
        (u, a, n, m), (v, w) = ufl.split(self.state), ufl.split(test)[:2]
        map_of_step = (ufl.Identity(3) + skew(a) / 2) / (1 + ufl.dot(a, a) / 4)
        turned = (ufl.Identity(3) + skew(a) * map_of_step) * self.turned
        bent = self.bent + self.turned.T * map_of_step.T * a.dx(0)
        strain = turned.T * (u.dx(0) + tangent) - ufl.as_vector((1, 0, 0))
        for_n, for_m = self.constant(1 / problem.EA, 1 / problem.GA, 1 / problem.GA), self.constant(1 / problem.EI)
        energy = ufl.dot(n, strain) + ufl.dot(m, bent) - sum(for_n[i] * n[i]**2 for i in range(3)) / 2 - for_m * ufl.dot(m, m) / 2
        tip = mesh.locate_entities_boundary(self.domain, 0, lambda x: np.isclose(x[0], problem.length))
        ends = ufl.Measure("ds", self.domain, subdomain_data=mesh.meshtags(self.domain, 0, tip, np.ones(len(tip), np.int32)))
        force, moment = self.constant(*problem.force), self.constant(*problem.moment)
        work = self.load * (ufl.dot(force, v) + ufl.dot(moment, map_of_step * w)) * ends(1)
        return ufl.derivative(energy * dx, self.state, test) - work, turned, bent

    def clamp(self):
        start = mesh.locate_entities_boundary(self.domain, 0, lambda x: np.isclose(x[0], 0.0))
        parts = [(part, part.collapse()[0]) for part in (self.space.sub(0), self.space.sub(1))]
        return [fem.dirichletbc(fem.Function(alone), fem.locate_dofs_topological((part, alone), 0, start), part)
                for part, alone in parts]

    def step(self, load):
        self.load.value = load
        self.state.x.array[self.rotations] = 0.0
        iterations, _ = self.newton.solve(self.state)
        for function, values in zip((self.turned, self.bent), [one.eval(self.cells) for one in self.reached], strict=True):
            keep(function, values)
        return iterations


def solve(problem, order, elements, steps, solver=None):
    rod = Rod(problem, order, elements, solver)
    start = time.process_time()
    iterations = sum(rod.step((i + 1) / steps) for i in range(steps))
    stepping, part = time.process_time() - start, rod.space.sub(0)
    tip = fem.locate_dofs_geometrical((part, part.collapse()[0]), lambda x: np.isclose(x[0], problem.length))[0]
    return {"tip": [float(rod.state.x.array[i]) for i in tip], "iterations": iterations, "steps": steps, "stepping": stepping}
