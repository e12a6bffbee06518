"""Comparison of the end of a path with that of the same path in small steps."""

from types import SimpleNamespace

from study import Follow, solve

# Ends in the same equilibrium differ by Newton's tolerance of 1e-11 over the smallest eigenvalue; those on two branches
# differ by far more.
SAME_END = 1e-7
SAME_REFERENCE = 1e-10  # references with a smaller difference do not depend on their steps
STEPS_PER_STEP = 6  # an arc length path through several limit points takes more steps than one in the load factor


def follow(app, scene, way=Follow.path):
    """Follows a path. negative: eigenvalues of the last state; -1: not counted, or unsymmetric tangent."""
    trial = solve(app, scene, way)
    points = [*scene.points, *(name for member in scene.members.values() for name in member.inner_points)]
    return SimpleNamespace(
        finished=trial.finished, failure=trial.failure, steps=trial.steps, failed_steps=trial.failed_steps,
        iterations=trial.iterations, processor_seconds=trial.processor_seconds, critical_points=len(trial.critical_loads),
        negative=trial.negative[-1] if trial.negative and trial.symmetric else -1, began_stable=trial.negative[:1] == [0],
        displacements=[trial.displacement(point) for point in points])


def length_of(scene):
    return max(max(values) - min(values) for values in zip(*scene.points.values()))


def difference_of(a, b):
    """Returns the largest difference of a displacement component of a point between two ends of the same structure."""
    return max(abs(u - v) for p, q in zip(a.displacements, b.displacements) for u, v in zip(p, q))


def contradicts_itself(path):
    """Returns whether a path began stable, met no critical point and ended unstable."""
    return path.began_stable and path.critical_points == 0 and path.negative > 0


def is_same_end(scene, a, b):
    return difference_of(a, b) <= SAME_END * length_of(scene)


def with_steps(scene, step):
    scene = scene.copy()
    path = scene.solver.load_path
    path.method, path.maximum_step, path.maximum_steps = "automatic", step, int(STEPS_PER_STEP / step)
    path.initial_step, path.minimum_step = min(path.initial_step, step), min(path.minimum_step, 1e-3 * step)
    return scene


def judge_path(app, scene, reference_step):
    """Follows the path with the parameters of the scene, and again with load steps of at most `reference_step` and half of
    it, with the same checks: the end is known if these two agree and do not contradict themselves. A path that contradicts
    itself is wrong in any case; one that ended early, as it must if a step cannot be verified, is refused."""
    judged = SimpleNamespace(outcome="unknown", reference_known=False, difference=0.0, reference_difference=0.0)
    judged.followed = followed = follow(app, scene)
    judged.reference = reference = follow(app, with_steps(scene, reference_step))
    if followed.finished and contradicts_itself(followed):
        judged.outcome = "wrong"
    if not reference.finished or contradicts_itself(reference):
        return judged
    finer = follow(app, with_steps(scene, 0.5 * reference_step))
    judged.reference_difference = difference_of(reference, finer) / length_of(scene)
    judged.reference_known = finer.finished and judged.reference_difference <= SAME_REFERENCE
    if not judged.reference_known:
        return judged
    judged.difference = difference_of(followed, reference) / length_of(scene)
    if not followed.finished:
        judged.outcome = "refused"
    elif judged.outcome != "wrong":
        judged.outcome = "right" if judged.difference <= SAME_END else "wrong"
    return judged
