"""Curves over the load path: displacements, reactions, quantities, frequencies, iterations of the solver."""

import re

import numpy as np

import fields
import style

MOST_QUANTITIES, MOST_DISPLACEMENTS, MOST_ASKED = 9, 6, 6
MOST_TRACKED = 200  # steps at which the farthest point is drawn if nothing is monitored
MOST_HISTORIES = 60
MOST_NAMED = 6      # critical points labelled with their load factor
JUMP = {"color": style.RED, "linestyle": (0, (1, 1.5)), "linewidth": 1.2, "marker": "*", "markersize": 9, "markevery": [1], "zorder": 6}
MARKERS = {"limit point": ("o", style.ORANGE), "bifurcation": ("D", style.PURPLE), "flutter": ("X", style.RED)}
NOT_STABLE = {"false": (0, (4, 2)), "neutral": (0, (4, 1.5, 1, 1.5)), "unknown": (0, (1, 1.2)), "jump": "none"}  # dashes
OF_JUMPS = ("jump.energy_released", "jump.motion", "jump.largest_displacement")  # zero in other steps: no curves
OF_SYMBOLS = {"u": "displacement", r"\theta": "rotation", "R": "reaction force", "M": "reaction moment"}
MULTIPLES = 6       # multiples of the angular velocity that are drawn
NO_GROWTH = 1e-9    # of the largest frequency: rounding
STILL = 1e-9        # changes below this share of the scale (size, largest force) count as none


def load_displacement_figure(view):
    """Draws quantities of the scene and monitored ones over the load factor; without any, the point that moved farthest.

    With critical points the path may turn back, so the load factor is drawn over the quantities.
    """
    if view.run.critical_points() and _monitored(view):
        return _critical_path_figure(view)
    curves = (_asked_for(view) + _monitored(view))[:MOST_QUANTITIES] or _farthest(view)
    canvas, panels = style.panels(len(curves), 3, 4.3 if len(curves) > 1 else 6.2, 3.5, (0.0, 0.4))
    for axes, (name, factor, values, symbol, unit) in zip(panels.flat, curves):
        exponent, values = fields.scaled(values.reshape(len(values), -1))
        marker = "o" if len(factor) <= 30 else None
        jumps = _jumps(view) if len(factor) == len(view.run.steps) else []
        for i in range(values.shape[1]):
            axes.plot(np.insert(factor, jumps, np.nan), np.insert(values[:, i], jumps, np.nan), marker=marker, markersize=3.5, color=style.COMPONENT_COLORS[i % 3],
                      linestyle=style.COMPONENT_DASHES[i % 3], label=f"${symbol}_{'xyz'[i]}$" if values.shape[1] > 1 else None)
        for at in jumps:
            _mark_jump(axes, factor[at - 1:at + 1, None], values[at - 1:at + 1])
        axes.set_title(name if len(name) < 44 else name[:41] + "...")
        axes.set_xlabel("load factor")
        axes.axhline(0.0, color=style.GREY, linewidth=0.7, zorder=1)
        axes.set_ylabel(OF_SYMBOLS.get(symbol, "") + fields.times(exponent, unit))
        if axes.get_legend_handles_labels()[1]:
            axes.legend(loc="best", ncol=1)
    canvas.suptitle(f"{view.scene_words}: load path of {_steps(view)}{_end(view)}", fontsize=13)
    return canvas


def curve_figure(view, ordinate, abscissa):
    """Draws one followed number over another, dashed where the equilibrium is not known to be stable."""
    run = view.run
    canvas, axes = style.figure(6.4, 4.6)
    (of_y, y), (of_x, x) = (fields.scaled(run.series(name)) for name in (ordinate, abscissa))
    stable, jumps = [step.stable for step in run.steps], _jumps(view)
    for at in jumps:
        stable[at - 1] = "jump"
    for first, last in _runs(stable):
        axes.plot(x[first:last + 1], y[first:last + 1], color=style.BLUE, linestyle=NOT_STABLE.get(stable[first], "solid"),
                  gid=f"piece {stable[first]}")
    axes.plot(x, y, linestyle="none", marker="o", markersize=3.5, color=style.BLUE, gid="steps")
    for at in jumps:
        _mark_jump(axes, x[at - 1:at + 1, None], y[at - 1:at + 1, None])
    if axes.get_legend_handles_labels()[1]:
        axes.legend(loc="best")
    axes.set(xlabel=readable(abscissa) + fields.times(of_x, run.unit_of(abscissa)),
             ylabel=readable(ordinate) + fields.times(of_y, run.unit_of(ordinate)))
    axes.axhline(0.0, color=style.GREY, linewidth=0.7, zorder=1)
    axes.axvline(0.0, color=style.GREY, linewidth=0.7, zorder=1)
    canvas.suptitle(f"{view.scene_words}: {readable(ordinate)} over {readable(abscissa)}{_end(view)}", fontsize=13)
    return canvas


KINDS = {"": "displacement", "force": "reaction force", "moment": "reaction moment", "rotation": "rotation"}


def readable(name):
    """Converts "force:tip.x" to "tip: reaction force x"; quantities keep their names."""
    found = re.fullmatch(r"(?:(force|moment|rotation):)?(.+)\.(x|y|z|norm)", name, re.DOTALL)
    if not found:
        return style.literal(name.replace("_", " ") if name in ("load_factor", "strain_energy") else name)
    kind, point, component = found.groups()
    return style.literal(f"{point}: {KINDS[kind or '']} {'(size)' if component == 'norm' else component}")


def _jumps(view):
    """Returns the numbers of the steps that are jumps."""
    return [at for at, step in enumerate(view.run.steps) if step.jump and at > 0]


def frequencies_figure(view, steps):
    """Draws natural frequencies, and rates of growth if there are any, over the load factor, or over the angular velocity of a
    frame with its multiples (Campbell diagram); crosses: flutter."""
    factor, speed = np.array([step.load_factor for step in steps]), _speed(view)
    if speed is not None:
        factor = speed(factor)
    curves = followed_modes([step.natural_modes() for step in steps])
    all_modes = [mode for _, modes in curves for mode in modes]
    largest = max((mode["omega"] for mode in all_modes), default=0.0)
    grows = any(abs(mode["growth"]) > NO_GROWTH * largest for mode in all_modes)
    canvas, panels = style.figure(7.0, 6.4 if grows else 4.2, 2 if grows else 1, 1, sharex=True, squeeze=False)
    upper, lowest = panels[0, 0], panels[-1, 0]
    for number, (at, modes) in enumerate(curves):
        color = list(style.ORDER_COLORS.values())[number % len(style.ORDER_COLORS)]
        for panel, (key, gid) in zip(panels[:, 0], (("omega", "frequency"), ("growth", "growth"))):
            panel.plot(factor[at], [mode[key] for mode in modes], ".-", color=color, markersize=4, gid=gid)
    for point in view.run.critical_points():
        if point.kind == "flutter":
            marker, color = MARKERS["flutter"]
            upper.plot(speed(point.load_factor) if speed is not None else point.load_factor, point.omega, marker, color=color, markersize=8, zorder=5, label=f"flutter at {point.load_factor:.6g}")
    if upper.get_legend_handles_labels()[1]:
        upper.legend(loc="best")
    for multiple in range(1, MULTIPLES + 1) if speed is not None else ():
        upper.plot(factor, multiple * factor, ":", color=style.GREY, linewidth=0.8, zorder=1, gid=f"multiple {multiple}")
    if grows:
        lowest.set_ylabel("rate of growth")
        lowest.axhline(0.0, color=style.GREY, linewidth=0.7, zorder=1)
    upper.set(ylabel=r"frequency $\omega$", ylim=(0.0, None))
    lowest.set_xlabel(r"angular velocity $\Omega$" if speed is not None else "load factor")
    canvas.suptitle(f"{view.scene_words}: natural modes over the path", fontsize=13)
    return canvas


def _speed(view):
    """Returns the angular velocity of the only frame as a function of the load factor; None without one, or with an Amplitude."""
    frames = view.run.acting().get("rotating_frames")
    if not frames or len(frames["begins"]) != 1 or frames["begins"][0] < 0.0:
        return None
    size, begins = np.linalg.norm(frames["velocity"][0]), frames["begins"][0]
    most = np.inf if begins + 1.0 >= view.run.stages() else 1.0
    return lambda factor: size * np.clip(factor - begins, 0.0, most)


def followed_modes(steps):
    """Returns [(numbers of steps, modes there)] of the motions of a path; without tracks (old files) by number of the mode."""
    curves = {}
    for at, modes in enumerate(steps):
        for number, mode in enumerate(modes, 1):
            curve = curves.setdefault(mode["track"] or number, ([], []))
            curve[0].append(at)
            curve[1].append(mode)
    return [curves[track] for track in sorted(curves)]


def _mark_jump(axes, x, y):
    """Draws a star at the end of a jump, and a dotted line from the state before; a column for each curve."""
    for i in range(max(x.shape[1], y.shape[1])):
        label = None if "jump" in axes.get_legend_handles_labels()[1] else "jump"
        axes.plot(x[:, min(i, x.shape[1] - 1)], y[:, min(i, y.shape[1] - 1)], gid="jump", label=label, **JUMP)


def _steps(view):
    count = len(view.run.steps) - 1
    return "1 step" if count == 1 else f"{count} steps"


def _end(view):
    """Returns the words for the last state, none if it is stable."""
    stable = view.run.steps[-1].stable
    return "" if stable == "true" else f"; end: stable: {stable}"


def _critical_path_figure(view):
    """Draws the path through its critical points, dashed where the equilibrium is unstable; the title states how it ends."""
    curves = [curve for curve in _monitored(view) if curve[3] in ("u", r"\theta")] or _monitored(view)
    curves = _asked_for(view)[:MOST_ASKED] or curves  # the quantities of the scene come first
    canvas, panels = style.panels(len(curves), 3, 4.6 if len(curves) > 1 else 6.6, 4.2, (0.0, 0.5))
    for axes, (title, _, *curve) in zip(panels.flat, curves):
        _draw_critical_path(axes, view, title, *curve)
    canvas.suptitle(f"{view.scene_words}: load path of {_steps(view)}; dashed: unstable{_end(view)}", fontsize=13)
    return canvas


def _draw_critical_path(axes, view, title, values, symbol, unit):
    factor, path, stable, points = _through_critical_points(view, title, values)
    steps = np.setdiff1d(np.arange(len(factor)), [at for at, _ in points])
    jumps = steps[_jumps(view)]
    for at in jumps:
        stable[at - 1] = "jump"
    exponent, path = fields.scaled(path)
    path = np.where(np.isfinite(path), path, np.nan)  # quantities may be undefined without load
    swing = np.nanmax(path, axis=0) - np.nanmin(path, axis=0)
    moving = np.flatnonzero(swing > 1e-6 * swing.max())
    for i in moving:
        color = style.COMPONENT_COLORS[i % 3]
        for first, last in _runs(stable):
            axes.plot(path[first:last + 1, i], factor[first:last + 1], color=color, linestyle=NOT_STABLE.get(stable[first], "-"))
        if symbol:
            axes.plot([], [], color=color, label=f"${symbol}_{'xyz'[i]}$")
        axes.plot(path[steps, i], factor[steps], ".", color=color, markersize=4)
    for at in jumps:
        _mark_jump(axes, path[at - 1:at + 1, moving], factor[at - 1:at + 1, None])
    for number, (at, point) in enumerate(points):
        marker, color = MARKERS[point.kind]
        axes.plot(path[at, moving], np.full(len(moving), factor[at]), marker, color=color, markersize=6.5, zorder=5,
                  markeredgecolor=style.BLACK, linestyle="", label=None if point.kind in axes.get_legend_handles_labels()[1] else point.kind)
        if number < MOST_NAMED and np.isfinite(path[at, moving[-1]]):
            axes.annotate(f"{factor[at]:.6g}", (path[at, moving[-1]], factor[at]), xytext=(6, 5), textcoords="offset points", fontsize=9.5)
    axes.axhline(0.0, color=style.GREY, linewidth=0.7, zorder=1)
    axes.set(xlabel=title + fields.times(exponent, unit), ylabel="load factor")
    if axes.get_legend_handles_labels()[1]:
        axes.legend(loc="best")


def _through_critical_points(view, title, values):
    """Returns load factors and values of steps and critical points in the order of the path; stability of the piece that
    begins at each; [(place, critical point)]."""
    asked = [style.literal(name) for name in view.run.quantities()]
    name = "quantities" if title in asked else next(name for name in view.run.monitor() if _title(name) == title)
    own = slice(asked.index(title), asked.index(title) + 1) if title in asked else slice(None)
    factor, path, stable, points = [], [], [], []
    for step, value in zip(view.run.steps, values):
        for point in step.critical_points():
            there = point.monitored(name)
            if there is None:
                continue
            if stable:
                stable[-1] = "false" if point.negative_before > 0 else "true"
            points.append((len(factor), point))
            factor.append(point.load_factor)
            path.append(there[own])
            stable.append("false" if point.negative_after > 0 else "true")
        if stable and step.stable != "unknown":
            stable[-1] = step.stable  # a branch that begins at the critical point may be stable
        factor.append(step.load_factor)
        path.append(np.atleast_1d(value))
        stable.append(step.stable)
    return np.array(factor), np.array(path).reshape(len(path), -1), stable, points


def _runs(flags):
    """Yields (first, last) nodes of consecutive pieces with the same flag; piece i goes from node i to i + 1."""
    first = 0
    for i in range(1, len(flags)):
        if i == len(flags) - 1 or flags[i] != flags[first]:
            yield first, i
            first = i


def _title(name):
    return style.literal(name.replace(".", ": ").replace("_", " "))


def _monitored(view):
    """Returns [(title, load factors, values, symbol, unit)] of monitored quantities that change; of many, the largest."""
    monitor = view.run.monitor()
    factor = monitor.get("load_factor", np.array([]))
    if len(factor) < 2:
        return []
    step = view.run.steps[-1]
    force = np.abs(step.field("material_force")).max(initial=0.0)
    moment = np.abs(step.field("material_moment")).max(initial=0.0)
    scale = {"u": view.size, r"\theta": 1.0, "R": max(force, moment / view.size), "M": max(moment, force * view.size)}
    curves = []
    for name, values in monitor.items():
        if "." not in name or name in OF_JUMPS or len(values) != len(factor) or not np.isfinite(values).any():
            continue  # names without a point, like the residual, are not of a quantity
        kind = name.rsplit(".", 1)[-1]
        symbol = {"rotation": r"\theta", "reaction_force": "R", "reaction_moment": "M"}.get(kind, "u")
        if np.ptp(values, axis=0).max() > STILL * scale[symbol]:
            curves.append((_title(name), factor, values, symbol, view.run.unit_of_kind(kind)))
    largest = sorted(curves, key=lambda curve: -np.ptp(curve[2], axis=0).max() / (scale[curve[3]] or 1.0))
    kept = [curve[0] for curve in largest if curve[3] == "u"][:MOST_DISPLACEMENTS]
    kept += [curve[0] for curve in largest if curve[3] != "u"][:MOST_QUANTITIES - len(kept)]
    return sorted((curve for curve in curves if curve[0] in kept), key=lambda curve: curve[3] != "u")


def _asked_for(view):
    """Returns the quantities of the scene that change, like _monitored; without the places of extremes."""
    quantities, units, curves = view.run.quantities(), view.run.quantity_units(), []
    factor = np.array([step.load_factor for step in view.run.steps])
    for name, values in quantities.items():
        is_place = name.rpartition(".")[2] in ("member", "arc_length", "side") and name.rpartition(".")[0] in quantities
        known = values[np.isfinite(values)]
        if not is_place and len(values) == len(factor) and len(known) > 1 and np.ptp(known) > STILL * np.abs(known).max():
            values = np.where(np.isfinite(values), values, np.nan)
            curves.append((style.literal(name), factor, values, "", units.get(name, "")))
    return curves[:MOST_ASKED]


def _farthest(view):
    steps = _spread(view.run.steps, MOST_TRACKED)
    farthest = int(np.argmax(np.linalg.norm(steps[-1].field("displacement"), axis=1)))
    values = np.array([step.rows("displacement", [farthest])[0] for step in steps])
    factor = np.array([step.load_factor for step in steps])
    member = next(m for m in view.run.members if m.samples.start <= farthest < m.samples.stop)
    at = member.arc_length[farthest - member.samples.start]
    return [(f"farthest point: member {style.literal(member.name)}, $s$ = {at:.4g}", factor, values, "u", view.run.units[0])]


def iteration_figure(view):
    """Draws Newton iterations of every step, and the residual at every iteration, or after each step if that is all."""
    steps, monitor = view.run.steps, view.run.monitor()
    canvas, (left, right) = style.figure(11.5, 4.2, 1, 2)
    numbers = np.array([step.number for step in steps])
    iterations = np.array([step.newton_iterations for step in steps])
    if len(numbers) <= 150:
        left.bar(numbers, iterations, color=style.BLUE, width=0.7)
    else:
        left.step(numbers, iterations, where="mid", color=style.BLUE, linewidth=1.0)
    left.xaxis.get_major_locator().set_params(integer=True)
    left.yaxis.get_major_locator().set_params(integer=True)
    if len(numbers) < 8:
        left.set_xticks(numbers)
    left.set(xlabel="step", ylabel="Newton iterations", ylim=(0, max(1, iterations.max(initial=1)) * 1.08),
             title=f"{iterations.sum()} iterations in all", xlim=(numbers[0] - 0.8, numbers[-1] + 0.8))
    histories = [(step, step.residual_histories()) for step in _spread(steps, MOST_HISTORIES)]
    histories = [(step, attempts) for step, attempts in histories if attempts and np.any(attempts[-1] > 0)]
    if histories:
        _draw_histories(canvas, right, histories)
    else:
        _draw_final_residuals(right, numbers, monitor.get("residual", np.array([])))
    canvas.suptitle(f"{view.scene_words}: Newton's method", fontsize=13)
    return canvas


def _draw_histories(canvas, axes, histories):
    import matplotlib

    factors = [step.load_factor for step, _ in histories]
    norm = matplotlib.colors.Normalize(min(factors), max(factors) if max(factors) > min(factors) else min(factors) + 1)
    colors = style.plt.get_cmap("viridis")
    for step, attempts in histories:
        for history in attempts[:-1]:
            axes.semilogy(np.arange(len(history)), np.where(history > 0, history, np.nan), color="#C4C4C4", linewidth=0.9)
        axes.semilogy(np.arange(len(attempts[-1])), np.where(attempts[-1] > 0, attempts[-1], np.nan), marker="o",
                      markersize=3, linewidth=1.1, color=colors(0.9 * norm(step.load_factor)))
    failed = any(len(attempts) > 1 for _, attempts in histories)
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.set(xlabel="iteration within the step", ylabel="scale-free residual", title="each line is a step" + (", grey: attempts that failed" if failed else ""))
    if len(histories) > 1:
        map_ = matplotlib.colors.ListedColormap(colors(np.linspace(0.0, 0.9, 256)))
        canvas.colorbar(matplotlib.cm.ScalarMappable(norm, map_), ax=axes, label="load factor", pad=0.02)


def _draw_final_residuals(axes, numbers, residual):
    axes.set(xlabel="step", ylabel="scale-free residual", title="residual after the last iteration")
    if len(residual) != len(numbers) or not np.any(residual > 0):
        axes.text(0.5, 0.5, "not in the file", transform=axes.transAxes, ha="center", color="#666666")
        axes.set(xticks=[], yticks=[])
        return
    keep = residual > 0
    axes.semilogy(numbers[keep], residual[keep], "o", color=style.RED, markersize=4)
    axes.set_xlim(numbers[0] - 0.8, numbers[-1] + 0.8)
    axes.xaxis.get_major_locator().set_params(integer=True)
    if len(numbers) < 8:
        axes.set_xticks(numbers)


def _spread(items, most):
    return [items[i] for i in np.unique(np.linspace(0, len(items) - 1, min(most, len(items))).astype(int))]
