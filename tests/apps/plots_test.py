#!/usr/bin/python3
"""Options of `mixbeam plot`, by what is drawn and not by pixels: artists of figures carry names (gid).

usage: plots_test.py MIXBEAM     runs small scenes, and looks at the figures that apps/plots makes of their results
"""

import json
import re
import subprocess
import sys
import tempfile
import unittest
import warnings
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

from support import CANTILEVER, PROGRAM, ROOT, program, scene, solve

sys.path.insert(0, str(ROOT / "apps" / "plots"))

import matplotlib  # noqa: E402

matplotlib.use("Agg")

import numpy as np  # noqa: E402

import along_figures  # noqa: E402
import envelope_figures  # noqa: E402
import batch_figures  # noqa: E402
import critical_figures  # noqa: E402
import diagram_figures  # noqa: E402
import fields  # noqa: E402
import path_figures  # noqa: E402
import plot_result  # noqa: E402
import scene_marks  # noqa: E402
import shape_figures  # noqa: E402
import solid  # noqa: E402
import thread_scaling  # noqa: E402
from results import InputError, Run  # noqa: E402
from scene_marks import Marks, kind_of_support  # noqa: E402
from tables import NothingToDraw  # noqa: E402
from view import Look, View  # noqa: E402

ROUNDING = 1e-9
LEAST_BYTES = 4000  # an empty picture of that size takes less


# Two posts and a deck of two members in the x-z plane; hinge, roller with a spring, line load, force and moment.
PORTAL = scene("""
    Points: {a: [0, 0, 0], b: [0, 0, 1], c: [1, 0, 1], d: [2, 0, 1], e: [2, 0, 0]}
    Members:
      left: {Start: a, End: b, Elements: 4}
      deck 1: {Start: b, End: c, Elements: 4}
      deck 2: {Start: d, End: c, Elements: 4}
      right: {Start: d, End: e, Elements: 4}
    Supports:
      hinge: {Point: a, Fixed Rotation: [x, z]}
      roller: {Point: e, Fixed Displacement: [y, z], Fixed Rotation: [x, z], Displacement Stiffness: [50, 0, 0]}
    Point Loads: {push: {Point: b, Force: [0.05, 0, 0]}, turn: {Point: d, Moment: [0, 0.01, 0]}}
    Distributed Loads: {snow: {Member: deck *, Force: [0, 0, -0.1]}}
    """)
# Numbers with and without dimension.
ASKED_PORTAL = PORTAL + """Quantities:
  lean: {Quantity: displacement, Point: b, Component: x}
  foot: {Quantity: reaction moment, Point: a, Component: y}
  knee: {Quantity: angle, Point: a, Corner: b, Other Point: c}
  twice: {Quantity: formula, Formula: 2*lean}
"""
# A spoke with its support, 12 times by a pattern.
WHEEL = scene("""
    Points: {hub: [0, 0, 0], rim: [1, 0, 0]}
    Members: {spoke: {Start: hub, End: rim, Elements: 4}}
    Supports: {rim: {Point: rim*}}
    Point Loads: {pull: {Point: hub, Force: [0, 0, 0.01]}}
    Patterns: {turn: {Kind: rotate, Center: [0, 0, 0], Axis: [0, 0, 1], Count: 12}}
    """)
# A support that shifts and turns along axes of its own, and a member with an eigenstrain.
BENT = scene("""
    Points: {a: [0, 0, 0], b: [1, 0, 0], c: [1, 1, 0]}
    Members: {first: {Start: a, End: b, Elements: 4}, second: {Start: b, End: c, Elements: 4}}
    Supports: {moved: {Point: a, Axes: [0, 1, 0, -1, 0, 0], Prescribed Displacement: [0.1, 0, 0], Prescribed Rotation: [0, 0, 0.2]}}
    Eigenstrains: {heat: {Member: second, Curvature: [0, 0, 0.3]}}
    """)
# A console under a case down, one up, and both.
TWO_CASES = scene("""
    Points: {a: [0, 0, 0], b: [1, 0, 0], c: [2, 0, 0]}
    Members: {m: {Start: a, End: b, Elements: 4}, n: {Start: b, End: c, Elements: 4}}
    Supports: {clamp: {Point: a}}
    Load Cases: [down, up]
    Combinations: {both: {down: 1, up: 1.5}}
    Point Loads: {down: {Point: b, Force: [0, 0, -0.1], Case: down}, up: {Point: b, Force: [0, 0, 0.05], Case: up}}
    """, """\
    Quantities:
      sag: {Quantity: displacement, Point: c, Component: z}
      lift: {Quantity: reaction force, Point: a, Component: z}
    """)


def named(figure, gid):
    """All artists of a name."""
    return figure.findobj(lambda artist: artist.get_gid() == gid)


def near_the_clamp(figure):
    """The panel of M3 on a cantilever along x, and the tips of its diagram that stand there."""
    panel = next(axes for axes in figure.axes if "M_3" in axes.get_title())
    tips = np.vstack([path.vertices for areas in named(panel, "positive") + named(panel, "negative") for path in areas.get_paths()])
    return panel, tips[np.abs(tips[:, 0]) < 0.2]


def texts(figure):
    return [text.get_text() for text in figure.findobj(matplotlib.text.Text) if text.get_text()]


class Plots(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        for name, text in (("portal", PORTAL), ("asked", ASKED_PORTAL), ("bare", ASKED_PORTAL.replace('  Units: "m, kN"\n', "")),
                           ("wheel", WHEEL), ("bent", BENT), ("down", CANTILEVER),
                           ("follower", CANTILEVER.replace("[0, -1, 0]", "[0, -3, 0], Frame: follower, Member: m"))):
            solve(cls.folder, name, text)
        program("run", str(ROOT / "apps/gallery/snap_back.xml"), "--output", ".", "--quiet", folder=cls.folder)

    def tearDown(self):
        matplotlib.pyplot.close("all")

    def mixbeam(self, *words, folder=None, code=0):
        return program(*words, folder=folder or self.folder, code=code)

    def run_of(self, name, members=None):
        run = Run(self.folder / f"{name}.h5", members=members)
        self.addCleanup(run.__exit__)
        return run

    def view(self, name, members=None, **look):
        run = self.run_of(name, members)
        return View(run, run.steps[-1:], Look(**look)), run.steps[-1]

    def marks(self, name, step=-1):
        run = self.run_of(name)
        return Marks(run, run.steps[step], run.reference())

    def shape(self, view, step):
        return shape_figures.shape_figure(view, step, fields.FIELDS["bending"])

    # what acts

    def test_supports_of_patterns_are_drawn(self):
        marks = self.marks("wheel")
        self.assertEqual(len({sample for sample, _ in marks.supports}), 12)
        view, step = self.view("wheel")
        for squares in named(self.shape(view, step), "supports"):
            self.assertEqual(len(squares.get_data_3d()[0] if hasattr(squares, "get_data_3d") else squares.get_xdata()), 12)

    def test_kinds_of_supports(self):
        free = np.zeros(6)
        for fixed, kind in (((1, 1, 1, 1, 1, 1), "clamp"), ((1, 1, 1, 0, 0, 0), "hinge"), ((1, 1, 1, 1, 0, 1), "hinge"),
                            ((0, 1, 1, 1, 0, 1), "roller"), ((0, 1, 1, 1, 1, 1), "guide"), ((0, 0, 0, 0, 0, 0), "spring")):
            self.assertEqual(kind_of_support(np.array(fixed), free), kind)
        view, step = self.view("portal")
        figure = self.shape(view, step)
        for kind in ("hinge", "roller", "spring"):
            self.assertEqual(len(named(figure, f"support {kind}")), 1, kind)
        self.assertEqual(named(figure, "support clamp"), [])

    def test_loads_are_drawn_where_they_act(self):
        run, marks = self.run_of("portal"), self.marks("portal")
        reference = run.reference()
        (sample, direction), = marks.forces
        np.testing.assert_allclose(reference[sample], (0, 0, 1), atol=ROUNDING)
        np.testing.assert_allclose(direction, (1, 0, 0), atol=ROUNDING)
        (sample, axis), = marks.moments
        np.testing.assert_allclose(reference[sample], (2, 0, 1), atol=ROUNDING)
        np.testing.assert_allclose(axis, (0, 1, 0), atol=ROUNDING)
        self.assertEqual(len(marks.line_loads), 2)
        for samples, forces in marks.line_loads:
            np.testing.assert_allclose(reference[samples][:, 2], 1.0, atol=ROUNDING)
            np.testing.assert_allclose(forces, [(0, 0, -0.1)] * len(samples), atol=ROUNDING)
        view, step = self.view("portal")
        figure = self.shape(view, step)
        combs = named(figure, "line load")
        self.assertEqual([len(comb.get_paths()) for comb in combs], [2])  # members
        self.assertTrue(named(figure, "force") and named(figure, "moment"))

    def test_follower_loads_turn_with_their_member(self):
        run, marks = self.run_of("follower"), self.marks("follower")
        (sample, direction), = marks.forces
        across = run.steps[-1].field("triad_2")[sample]
        np.testing.assert_allclose(direction, -across, atol=ROUNDING)
        self.assertGreater(abs(direction[0]), 0.1)  # the twin: a dead load would still point along y

    def test_nothing_acts_before_its_stage(self):
        self.assertEqual(self.marks("portal", step=0).forces, [])
        run = self.run_of("portal")
        self.assertEqual(len(Marks(run, SimpleNamespace(load_factor=-0.5), run.reference()).forces), 1)  # loads reversed

    def test_motions_and_eigenstrains_are_drawn(self):
        marks = self.marks("bent")
        (_, shift), = marks.shifts
        (_, turn), = marks.turns
        np.testing.assert_allclose(shift, (0, 1, 0), atol=ROUNDING)  # axis x of the support
        np.testing.assert_allclose(turn, (0, 0, 1), atol=ROUNDING)
        self.assertEqual([member.name for member in marks.strained], ["second"])
        figure = self.shape(*self.view("bent"))
        for gid in ("shift", "turn", "eigenstrain"):
            self.assertEqual(len(named(figure, gid)), 1, gid)
        before = self.marks("bent", step=0)
        self.assertEqual((before.shifts, before.turns, before.strained), ([], [], []))

    # options

    def test_view(self):
        for name, plane in (("xy", (0, 1)), ("xz", (0, 2)), ("yz", (1, 2))):
            view, _ = self.view("portal", view=name)
            np.testing.assert_array_equal(view.plane, np.eye(3)[list(plane)])
            self.assertEqual(view.axis_label(view.plane[0])[:3], f"${'xyz'[plane[0]]}$")
        view, _ = self.view("portal", view="-60/25")
        self.assertEqual(view.camera, (25.0, -60.0))
        np.testing.assert_allclose(view.plane @ view.plane.T, np.eye(2), atol=ROUNDING)
        for wrong in ("front", "1/2/3", "0/91", "nan/0"):
            with self.assertRaisesRegex(InputError, "--view"):
                self.view("portal", view=wrong)

    def test_a_shape_is_seen_from_where_it_is_asked_for(self):
        """The portal lies in the x-z plane: across the picture its 2, upwards its 1; obliquely each side is as long as its shadow."""
        shadow = 1 / np.sqrt(2)  # of a side along x at 45 degrees
        for look, width in (({}, 2.0), ({"view": "xz"}, 2.0), ({"view": "yz"}, 0.0), ({"view": "iso"}, 2 * shadow)):
            view, step = self.view("portal", **look)
            solid, = named(self.shape(view, step), "solid")
            x = np.concatenate([path.vertices[:, 0] for path in solid.get_paths()])
            self.assertAlmostEqual(np.ptp(x), width, delta=0.15, msg=str(look))  # bent, and as thick as its sections

    def test_sections_are_drawn_to_scale(self):
        """Of a box 0.1 by 0.3 along x, seen from both sides; faces turned away are not drawn."""
        dimensions = np.array([0.1, 0.3, 0.01, 0.0])
        for kind, sides in (("box", 4), ("I", 12), ("tube", 24), ("T upright 0 0.1", 8)):
            corners = solid.outline(kind, dimensions[None], 24)[0]
            self.assertEqual(corners.shape, (sides, 2), kind)
            np.testing.assert_allclose(np.ptp(corners, axis=0), (0.1, 0.3), rtol=1e-9, err_msg=kind)
            turned = np.roll(corners, -1, axis=0)
            self.assertGreater(np.sum(corners[:, 0] * turned[:, 1] - turned[:, 0] * corners[:, 1]), 0.0, kind)  # counter-clockwise
        np.testing.assert_allclose(solid.outline("T upright 0 0.1", dimensions[None], 24)[0][:, 1].max(), 0.15 - 0.03)

    def test_round_lengths(self):
        for most, length in ((1.0, 1.0), (0.99, 0.5), (4.9, 2.0), (73.0, 50.0), (2.1e-3, 2e-3)):
            self.assertAlmostEqual(shape_figures.round_length(most), length, delta=1e-12 * length)

    def test_many_loads_alike_have_one_mark(self):
        """24 equal forces: an arrow and its number; 20 of them: every one."""
        for count, arrows in ((24, 1), (20, 20)):
            view, step = self.view("portal")
            marks = Marks(view.run, step, view.structure.reference)
            marks.forces, marks.moments, marks.line_loads = [(i % 5, np.array((1.0, 0.0, 0.0))) for i in range(count)], [], []
            figure, axes = matplotlib.pyplot.subplots()
            scene_marks.draw_marks(axes, marks, step.field("position")[:, :2], np.eye(3)[:2], 0.1)
            self.assertEqual(len(named(figure, "force")), arrows)
            self.assertEqual([text.get_text() for text in named(figure, "count")], ["\u00d7 24"] * (count == 24))

    def test_diagrams_of_structures_in_space(self):
        """A moment M3 < 0 of a cantilever along x with a force down stands above, whatever the camera; the twin in its plane too."""
        view, step = self.view("down", view=None)
        moment = step.field("material_moment")[:, 2]
        directions = diagram_figures._axis_of(view, step, "bending_3")
        at = int(np.argmax(np.abs(moment)))
        self.assertGreater((moment[at] * directions[at])[1], 0.01)  # the side in tension
        axis = diagram_figures._axis_of(view, step, "bending_2")
        np.testing.assert_allclose(axis, step.field("triad_3"), atol=ROUNDING)
        view.is_plane, view.projection = False, np.array([[1, 0, 0], [0, 0.6, 0.8]])
        panel, near = near_the_clamp(diagram_figures.on_structure_figure(view, step))
        self.assertGreater(near[:, 1].max(), 0.01)
        self.assertEqual(panel.get_xticks().tolist(), [])

    def test_a_view_that_is_asked_for_holds_for_all_modes(self):
        mode = np.zeros((3, 3))
        mode[1, 1] = 1.0  # out of the x-z plane
        plane = np.eye(3)[[0, 2]]
        self.assertGreater(np.abs(critical_figures._projection(plane, mode) - plane).max(), 0.1)  # chosen by the program
        run = self.run_of("snap_back")
        points = run.critical_points()
        for look, widths in ((Look("yz"), 1), (Look("xy"), 2)):
            view = View(run, run.steps[-1:], look)
            for axes in critical_figures.modes_figure(view, points).axes:
                lines = np.vstack([path.vertices for collection in axes.collections for path in collection.get_paths()])
                self.assertEqual(int(np.sum(np.ptp(lines, axis=0) > 1e-6)), widths, look)  # a plane frame from its side is a line

    def test_stresses_are_in_megapascals(self):
        field = fields.FIELDS["von_mises"]
        step = SimpleNamespace(units=("m", "kN"), has=lambda name: True, field=lambda name: np.array([[2500.0]]), number=1)
        self.assertEqual((field.values(step, 1.0).tolist(), field.unit(("m", "kN"))), ([2.5], "MPa"))
        step.units = ("ft", "lb")
        self.assertEqual((field.values(step, 1.0).tolist(), field.unit(("ft", "lb"))), ([2500.0], "lb/ft\u00b2"))

    def test_pictures_of_a_batch(self):
        """A cantilever of stiffness 1: the tip sinks by F/3 for small F; over force and stiffness a map of cells."""
        folder, force, stiffness = self.folder, "Point Loads/f/Force[1]", "Sections/s/EI3"
        for name, rows in (("curve", [(f"{-0.01 * i}",) for i in range(1, 5)]),
                           ("map", [(f"{-0.01 * i}", f"{j}") for i in range(1, 4) for j in range(1, 3)])):
            (folder / f"{name}.csv").write_text(",".join((force, stiffness)[:len(rows[0])]) + "\n" + "".join(",".join(row) + "\n" for row in rows))
            (folder / f"{name}.yaml").write_text(CANTILEVER + f"Batch: {{Table: {name}.csv}}\n")
            self.mixbeam("batch", f"{name}.yaml", "--output", ".", "--quiet")
            self.assertEqual(self.mixbeam("plot", f"{name}-batch.h5").strip(), f"{name}-batch.png")
        figure = batch_figures.batch_figure(folder / "curve-batch.csv")
        panel = next(axes for axes in figure.axes if axes.get_ylabel() == "b.displacement.y")
        (line,) = named(panel, "curve")
        np.testing.assert_allclose(line.get_ydata(), line.get_xdata() / 3, rtol=1e-3)  # less by the square of the rotation
        self.assertEqual(panel.get_xlabel(), "f, Force[1]")
        cells = named(batch_figures.batch_figure(folder / "map-batch.csv"), "map")
        self.assertEqual(cells[0].get_array().size, 6)
        with self.assertRaisesRegex(InputError, "--curve nonsense: no column"):
            batch_figures.batch_figure(folder / "map-batch.csv", ["nonsense", force])

    def test_a_scene_that_is_not_solved(self):
        loose = PORTAL.replace("Point: a,", "Point: a, Fixed Displacement: [y, z],").replace(", Displacement Stiffness: [50, 0, 0]", "")
        (self.folder / "loose.yaml").write_text(loose)
        self.assertEqual(self.mixbeam("plot", "loose.yaml", "--format", "svg").strip(), "loose-shape.svg")
        for words in ("not solved", "can move without strain in 1 way", "moves without strain"):
            self.assertIn(words, re.sub(r"<[^>]*>|\s+", " ", (self.folder / "loose-shape.svg").read_text()).replace("  ", " "), words)

    def test_arrows_end_inside_the_picture(self):
        figure = self.shape(*self.view("portal", view="xz"))
        axes = figure.axes[0]
        (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
        for arrow in named(figure, "force") + named(figure, "moment"):
            for x, y in (arrow.xy, arrow.xyann):
                self.assertTrue(left < x < right and low < y < high, (x, y))
        for comb in named(figure, "line load"):
            backs = np.vstack([path.vertices for path in comb.get_paths()])
            self.assertLess(backs[:, 1].max(), high)

    def test_iso_shows_all_axes_equally_short(self):
        view, _ = self.view("portal", view="iso")
        np.testing.assert_allclose(np.linalg.norm(view.plane, axis=0), np.sqrt(2 / 3), atol=1e-4)

    def test_axes_have_names_and_units(self):
        view, step = self.view("portal", view="xz")
        figure = self.shape(view, step)
        self.assertEqual([text.get_text() for text in named(figure, "axis")], ["$x$", "$z$"])
        self.assertTrue(any(re.fullmatch(r"0\.\d m", text) for text in texts(figure)), texts(figure))  # a length to compare with
        self.assertIn("$x$  [m]", texts(diagram_figures.on_structure_figure(view, step)))
        labels = texts(diagram_figures.over_arc_length_figure(view, step))
        self.assertTrue(any(label.startswith("$N$") and "kN" in label for label in labels), labels)
        self.assertTrue(any(label.startswith("$M_3$") and "kN m" in label for label in labels), labels)

    def test_scale(self):
        view, step = self.view("down", scale=10.0)
        np.testing.assert_allclose(view.position(step) - view.structure.reference, 10.0 * step.field("displacement"))
        self.assertTrue(any("displacements times 10" in text for text in texts(self.shape(view, step))))
        view, step = self.view("down")
        np.testing.assert_array_equal(view.position(step), step.field("position"))
        self.assertTrue(any("displacements to scale" in text for text in texts(self.shape(view, step))))

    def test_members(self):
        view, step = self.view("portal", members=["deck *"])
        self.assertEqual([member.name for member in view.run.members], ["deck 1", "deck 2"])
        np.testing.assert_allclose(view.structure.reference[:, 2], 1.0, atol=ROUNDING)
        whole = self.run_of("portal")
        for of_part, of_whole in zip(view.run.members, whole.members[1:3]):
            np.testing.assert_array_equal(step.field("position", of_part), whole.steps[-1].field("position", of_whole))
        marks = Marks(view.run, step, view.structure.reference)
        self.assertEqual((len(marks.supports), len(marks.forces), len(marks.line_loads)), (0, 1, 2))
        with self.assertRaisesRegex(InputError, "--members dek.*deck 1"):
            self.run_of("portal", members=["dek"])

    def test_moments_stand_on_the_side_in_tension(self):
        """A cantilever along x under a force down is stretched above."""
        for side, sign in (("tension", 1), ("compression", -1)):
            view, step = self.view("down", view="xy", moments=side)
            _, near = near_the_clamp(diagram_figures.on_structure_figure(view, step))
            highest = near[np.argmax(np.abs(near[:, 1])), 1]
            self.assertGreater(sign * highest, 0.01, side)

    def test_values_stand_at_the_extremes(self):
        view, step = self.view("down", view="xy")
        panel, _ = near_the_clamp(diagram_figures.on_structure_figure(view, step))
        largest = step.field("material_moment")[:, 2]
        largest = largest[np.argmax(np.abs(largest))]
        value, = named(panel, "value")
        self.assertEqual(value.get_text(), f"{largest:.4g}")
        self.assertLess(abs(value.xy[0]), 0.05)  # at the clamp

    def test_along(self):
        view, step = self.view("portal")
        figure = along_figures.along_figure(view, step, ["deck *"])
        line = next(axes for axes in figure.axes if "$N$" in axes.get_ylabel()).findobj(lambda a: a.get_gid() == "diagram")[0]
        places, values = line.get_data()
        self.assertAlmostEqual(places[-1], 2.0)
        self.assertTrue(np.all(np.diff(places) >= 0.0))
        first, second = view.run.members[1:3]
        np.testing.assert_array_equal(values[:len(first.arc_length)], step.field("material_force", first)[:, 0])
        np.testing.assert_array_equal(values[len(first.arc_length):], step.field("material_force", second)[::-1, 0])
        names = {text.get_text() for text in named(figure, "member")}
        self.assertEqual(names, {"deck 1", "deck 2 (from its end)"})
        whole, _, borders = along_figures.running_length(along_figures.path_of(view.run.members, view.size))
        np.testing.assert_allclose(borders, (0, 1, 2, 3, 4))
        with self.assertRaisesRegex(InputError, "no path.*left"):
            along_figures.along_figure(view, step, ["left", "right"])
        wheel_view, wheel_step = self.view("wheel")
        with self.assertRaisesRegex(InputError, "no path"):
            along_figures.along_figure(wheel_view, wheel_step, ["*"])

    def test_round_off_along_some_members_is_zero(self):
        class Step:
            """A member that bears a shear force, and one that has its round-off."""

            @staticmethod
            def field(name):
                return np.array([[0.0, 1000.0, 0.0], [0.0, 1e-12, 0.0]]) if name == "material_force" else np.ones((2, 3))

        field = fields.SECTION_FORCES["shear_2"]
        np.testing.assert_array_equal(field.values(Step, 1.0), (1000.0, 1e-12))
        np.testing.assert_array_equal(field.values_at(Step, 1.0, [1]), (0.0,))
        np.testing.assert_array_equal(field.values_at(Step, 1.0, [0, 1]), (1000.0, 1e-12))

    def test_curve(self):
        view, _ = self.view("portal")
        figure = path_figures.curve_figure(view, "force:a.x", "b.norm")
        line, = named(figure, "steps")
        monitor = view.run.monitor()
        np.testing.assert_allclose(line.get_ydata() * np.abs(monitor["a.reaction_force"][-1, 0] / line.get_ydata()[-1]),
                                   monitor["a.reaction_force"][:, 0], rtol=1e-12)  # up to a power of ten
        np.testing.assert_array_equal(np.sign(line.get_xdata()), (0.0, 1.0))
        self.assertTrue(figure.axes[0].get_ylabel().startswith("a: reaction force x"))
        self.assertTrue(figure.axes[0].get_ylabel().endswith("kN]"))
        self.assertTrue(figure.axes[0].get_xlabel().endswith("m]"))
        self.assertEqual(path_figures.curve_figure(view, "load_factor", "rotation:b.y").axes[0].get_ylabel(), "load factor")
        self.assertEqual(view.run.unit_of("b.nonsense"), "")
        self.assertEqual(view.run.series("load_factor").tolist(), [0.0, 1.0])
        with self.assertRaisesRegex(InputError, "nothing is followed as bb.x; the nearest are .*b.displacement.x"):
            path_figures.curve_figure(view, "load_factor", "bb.x")

    def test_rates_of_growth_where_there_are_any(self):
        run = SimpleNamespace(critical_points=lambda: [], acting=dict)
        for growth, panels in ((0.0, 1), (1e-15, 1), (-0.1, 2)):
            modes = [{"omega": 2.0, "growth": growth, "track": 1}]
            steps = [SimpleNamespace(load_factor=at, natural_modes=lambda: modes) for at in (0.0, 1.0)]
            figure = path_figures.frequencies_figure(SimpleNamespace(run=run, scene_words="rod"), steps)
            self.assertEqual(len(figure.axes), panels, growth)
            self.assertEqual(len(named(figure, "frequency")), 1)
            self.assertEqual(len(named(figure, "growth")), panels - 1)
            self.assertEqual(figure.axes[-1].get_xlabel(), "load factor")

    def test_units_of_quantities(self):
        view, _ = self.view("asked")
        label = lambda name: path_figures.curve_figure(view, name, "load_factor").axes[0].get_ylabel()
        self.assertTrue(label("lean").startswith("lean  ["), label("lean"))
        self.assertTrue(label("lean").endswith("m]"))
        self.assertTrue(label("foot").endswith("kN m]"))
        self.assertTrue(label("knee").endswith("rad]"))
        self.assertNotIn("m]", label("twice"))
        self.assertTrue(label("rotation:b.y").endswith("rad]"))
        labels = {axes.get_title(): axes.get_ylabel() for axes in path_figures.load_displacement_figure(view).axes}
        self.assertTrue(labels["lean"].endswith("m]"), labels)
        self.assertTrue(labels["knee"].endswith("rad]"), labels)
        self.assertNotIn("m]", labels["twice"])
        self.assertTrue(labels["a: reaction force"].endswith("kN]"), labels)
        self.assertEqual([self.run_of("bare").unit_of(name) for name in ("lean", "knee", "b.x")], ["", "", ""])

    def test_envelope(self):
        folder = self.folder / "cases"
        folder.mkdir()
        mixbeam = partial(self.mixbeam, folder=folder)
        solve(folder, "two", TWO_CASES)
        envelope = envelope_figures.Envelope(folder / "two.h5")
        self.assertEqual([envelope.case(i) for i in range(3)], ["down", "up", "both"])
        runs = [Run(folder / f"two-{case}.h5") for case in ("down", "up", "both")]
        sags = [run.quantities()["sag"][-1] for run in runs]
        self.assertEqual(envelope.rows()[0], ("sag", min(sags), "down", max(sags), "up"))
        np.testing.assert_allclose(envelope.values[:, 1], (0.1, -0.05, 0.025), rtol=1e-9)  # statics: minus the loads
        figure = envelope_figures.ranges_figure(envelope)
        lift = named(figure, "run")
        np.testing.assert_allclose([line.get_xdata()[1] for line in lift], (1.0, -0.5, 0.25), rtol=1e-9)
        self.assertIn("-0.05 (up)  to  0.1 kN (down)", [text.get_text() for text in named(figure, "words")])
        envelope.values[1, 0] = envelope.largest[0] = np.inf
        with warnings.catch_warnings(action="error", category=RuntimeWarning):
            bar, _ = named(envelope_figures.ranges_figure(envelope), "ranges")
        self.assertGreater(bar.get_x() + bar.get_width(), 1.5)  # leaves the panel, which ends at 1.06
        figure = envelope_figures.along_figure(envelope, ["*"], Look())
        moment = next(axes for axes in figure.axes if axes.get_ylabel().startswith("$M_2"))
        ends = [{line.get_gid(): line.get_ydata()[0] for line in moment.lines}[gid] for gid in ("smallest", "largest")]
        power = ends[np.argmax(np.abs(ends))] / 0.1  # the moment at the clamp is force times arm, on an axis in powers of ten
        np.testing.assert_allclose(sorted(np.abs(ends)), np.abs(power) * np.array((0.05, 0.1)), rtol=1e-2)  # arms shorten
        for words in (("plot", "two.h5", "--format", "svg"), ("plot", "two.h5", "--along", "*", "--format", "svg"),
                      ("plot", "two.h5", "--case", "up", "--picture", "shape", "--format", "svg"), ("report", "two.h5"),
                      ("report", "two-up.h5"), ("verify", "two.h5")):
            mixbeam(*words)
        self.assertIn("quantities at the ends of 3 runs", (folder / "two-envelope.svg").read_text())
        for page in ("two", "two-up"):
            self.assertIn(">Envelope</h2>", (folder / f"{page}-report.html").read_text())
        for words, reason in ((("plot", "two.h5", "--picture", "shape"), "--case takes one of them (down, up, both)"),
                              (("plot", "two-up.h5", "--picture", "envelope"), "of one run")):
            self.assertIn(reason, mixbeam(*words, code=2))
        self.assertIsNotNone(envelope_figures.envelope_beside(runs[1]))
        (folder / "two.yaml").write_text(TWO_CASES.replace("0.05", "0.06"))  # a case that changes leaves the envelope behind
        mixbeam("run", "two.yaml", "--output", ".", "--quiet", "--case", "up")
        self.assertIsNone(envelope_figures.envelope_beside(Run(folder / "two-up.h5")))

    def test_an_envelope_of_different_meshes_of_equal_size(self):
        """The same moments on meshes of 35 samples each."""
        small = CANTILEVER.replace("[0, -1, 0]", "[0, -0.01, 0]")
        files = [solve(self.folder, f"mesh {n}", small.replace("Elements: 4, Order: 3", f"Elements: {n}, Order: {k}")) for n, k in ((5, 3), (7, 2))]
        figure = envelope_figures.along_figure(SimpleNamespace(files=lambda: files, path=files[0]), ["*"], Look())
        panel = next(axes for axes in figure.axes if axes.get_ylabel().startswith("$M_3"))
        low, high = (next(line.get_ydata() for line in panel.lines if line.get_gid() == gid) for gid in ("smallest", "largest"))
        self.assertLess(np.ptp(high - low), 0.01 * np.abs(low).max())

    def test_stages_of_texts_and_of_tables(self):
        for text, begins, stages in (("", [], 1), ('<Parameter name="Stage" type="int" value="2"/>', [], 2), ("{Stage: 3}", [], 3),
                                     ('<Parameter value="2" name="Stage" type="int"/>', [], 2), ("", [0.0, 1.0, np.inf], 2)):
            run = SimpleNamespace(scene_text=lambda: text, acting=lambda: {"point_loads": {"begins": begins}})
            self.assertEqual(Run.stages(run), stages, text)

    def test_nothing_foreign_and_nothing_over_an_input(self):
        """Modules of the current folder are not executed, inputs are not replaced, one number of Quantities and dollars are drawn."""
        text = CANTILEVER.replace("m, kN", "$m$x, $$") + "Quantities: {b$a: {Quantity: displacement, Point: b, Component: z}}\n"
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            result = solve(folder, "one", text)
            for module in ("numpy", "h5py", "matplotlib", "results"):
                (folder / f"{module}.py").write_text(f"open({str(folder / 'executed')!r}, 'w')")
            (folder / "matplotlibrc").write_text("savefig.dpi: 7\nno.such.thing: 1\n")
            run = partial(self.mixbeam, folder=folder)
            for words in (("report",), ("view", "-o", "v.html"), ("plot", "-o", "pictures", "--format", "png", "--picture", "shape", "diagrams")):
                ended = subprocess.run([PROGRAM, words[0], "one.h5", *words[1:]], cwd=folder, capture_output=True, text=True, check=False)
                self.assertEqual((ended.returncode, ended.stderr), (0, ""))
            self.assertFalse((folder / "executed").exists())
            subprocess.run(["/usr/bin/python3", "-c", "import numpy"], cwd=folder, check=False)
            self.assertTrue((folder / "executed").exists())  # which Python otherwise does
            self.assertGreater((folder / "pictures" / "one-shape.png").stat().st_size, 20000)  # not of 7 dots per inch
            (folder / "link.html").symlink_to("one.h5")
            before = result.read_bytes()
            for words in (("report", "-o", "one.h5"), ("view", "-o", "one.yaml"), ("view", "--output", "link.html")):
                said = run(words[0], "one.h5", *words[1:], code=2)
                self.assertIn(words[-1], said)
                self.assertIn("one.h5", said)
            self.assertEqual((result.read_bytes(), (folder / "one.yaml").read_text()), (before, text))
            damaged = bytearray(before)
            with Run(result) as intact:
                place = before.index(intact.steps[-1].field("displacement").tobytes())
            damaged[place + 102] ^= 0x55
            (folder / "other.hdf5").write_bytes(damaged)  # whatever its ending
            for words in (("report",), ("view",), ("plot", "--picture", "shape")):
                self.assertIn("damaged", run(words[0], "other.hdf5", *words[1:], code=2))
            self.assertEqual([file for file in folder.rglob(".*")], [])  # nothing half written

    def test_jumps(self):
        self.mixbeam("run", str(ROOT / "apps/gallery/snapping_arch.xml"), "--output", ".", "--quiet")
        self.mixbeam("report", "snapping_arch.h5")
        view, _ = self.view("snapping_arch")
        crown, = [panel for panel in path_figures.load_displacement_figure(view).axes if panel.get_title() == "crown: displacement"]
        at, = [at for at, step in enumerate(view.run.steps) if step.jump]
        down = view.run.series("crown.z")
        self.assertGreater(down[at - 1] - down[at], 5 * np.ptp(down[:at]))  # it snaps
        star, = [line for line in crown.lines if line.get_gid() == "jump" and np.ptp(line.get_ydata()) > 10]
        np.testing.assert_array_equal(star.get_ydata(), down[at - 1:at + 1])
        curve = path_figures.curve_figure(view, "load_factor", "crown.z")
        star, = named(curve, "jump")
        np.testing.assert_array_equal(star.get_xdata(), down[at - 1:at + 1])
        self.assertEqual(len(named(curve, "piece true")), 2)  # the path stops before the jump, and goes on behind it
        self.assertEqual(named(path_figures.curve_figure(self.view("portal")[0], "load_factor", "b.x"), "jump"), [])
        page = (self.folder / "snapping_arch-report.html").read_text()
        jump = view.run.steps[at].jump
        self.assertIn(f"<td>{jump['released']:.4g}</td>", page)
        self.assertIn("point &quot;crown&quot;", page)

    def test_report_tells_units_and_utilisation_above_one(self):
        folder, words = self.folder, "is stressed beyond the strength"
        for strength, beyond in (("1", True), ("1e9", False)):
            section = f"{{s: {{Shape: circle, Diameter: 0.1, Material: {{E: 1e6, nu: 0.3, Strength: {strength}}}}}}}"
            (folder / "strong.yaml").write_text(re.sub("(?<=Sections: ).*", section, ASKED_PORTAL))
            self.mixbeam("run", "strong.yaml", "--output", ".", "--quiet", "--summary", "s.json")
            self.mixbeam("report", "strong.h5")
            page = (folder / "strong-report.html").read_text()
            self.assertEqual(words in page, beyond)
            for one in json.loads((folder / "s.json").read_text())["quantities"]:
                self.assertIn(f"<td>{one['error']:.4g}</td>", page)
            for told in (">unit<", ">kN m<", "circle: diameter 0.1<", "shape [m]", ">reaction at<", "force x [kN]",
                          ">deck 1, deck 2</td><td class=words>(0, 0, -0.1)<", "class=\"bar bad\"" if beyond else "class=\"bar\"",
                          "balance to", "<nav><a href=\"#part1\">Result</a>", ">displacement x y z, rotation x z<", ">displacement y z, rotation x z; spring displacement x: 50<"):
                self.assertTrue(told in page, told)

    def test_report(self):
        evil = "<img src=x onerror=alert(1)>"
        folder = self.folder
        (folder / "evil.yaml").write_text(re.sub(r"\bb\b", f"'{evil}'", CANTILEVER))
        self.mixbeam("run", "evil.yaml", "--output", ".", "--quiet", "--summary", "sum.json")
        self.mixbeam("report", "evil.h5", "--summary", "sum.json")
        page = (folder / "evil-report.html").read_text()
        self.assertNotIn(evil, page)  # names are data
        self.assertIn("&lt;img src=x onerror=alert(1)&gt;", page)
        self.assertNotIn("://", page.split("<details>")[0])  # nothing is fetched
        self.assertLess(len(page), 2e6)
        tip = Run(folder / "evil.h5").monitor()[f"{evil}.displacement"][-1, 1]
        for words in (f"{tip:.4g}", "is stable", "loads and reactions", "data:image/png;base64,", "</html>"):
            self.assertIn(words, page)
        (folder / "pages").mkdir()
        self.mixbeam("report", "evil.h5", "--output", "pages")
        self.assertTrue((folder / "pages" / "evil-report.html").exists())  # a folder takes the page
        self.assertIn("none.h5", self.mixbeam("report", "none.h5", code=2))

    def test_lattices_of_thread_scaling(self):
        def written(folder, kinds):
            names = ["kind", "elements", "order", "threads", "phase", "median_seconds", "speed_up", "ratio_to_unit", "flops_per_element",
                     "bytes_per_element", "flops_per_second"]
            rows = [[kind, size, 2, threads, "whole iteration", 1e-6 * size / threads, threads, 1, "nan", "nan", "nan"]
                    for kind in kinds for size in (2000, 4000) for threads in (1, 2)]
            cases = [[kind, size, 5e3] for kind in kinds for size in (2000, 4000)]
            for name, table in (("thread_scaling", [names, *rows]), ("cases", [["kind", "elements", "memory_bytes_per_element"], *cases])):
                Path(folder, f"{name}.csv").write_text("\n".join(",".join(map(str, row)) for row in table))

        with tempfile.TemporaryDirectory() as folder:
            written(folder, ["spatial", "cubic"])
            times, memory = thread_scaling.lattices_figure(Path(folder)).axes
            one, two = times.get_lines()
            np.testing.assert_allclose(one.get_data(), [[1000, 2000], [2, 2]])  # struts of two elements, microseconds
            np.testing.assert_allclose(two.get_ydata(), [1, 1])
            np.testing.assert_allclose(memory.get_lines()[0].get_ydata(), [10, 10])
            written(folder, ["spatial", "planar"])
            with self.assertRaises(NothingToDraw):
                thread_scaling.lattices_figure(Path(folder))

    # what the program writes

    def pictures(self, file, *words):
        """{name: SVG} of what `mixbeam plot` draws, without its start."""
        options = plot_result.options_of([str(self.folder / file), "--format", "svg", "--output", str(self.folder / "pictures"), *words])
        return {path.stem: path.read_text() for path in plot_result._draw(options)}

    def test_every_kind_is_written_in_both_formats(self):
        kinds = ("shape", "fields", "section_forces", "diagrams", "load_path", "iterations", "steps")
        drawn = self.mixbeam("plot", "down.h5", "--format", "png,svg", "--output", "kinds", "--picture", *kinds).split()
        self.assertEqual(sorted(drawn), sorted(f"kinds/down-{kind.replace('_', '-')}.{form}" for kind in kinds for form in ("png", "svg")))
        for file in drawn:
            self.assertGreater((self.folder / file).stat().st_size, LEAST_BYTES, file)
        for kind, words in (("shape", "portal: step 1, load factor 1"), ("shape", "undeformed"), ("load-path", "b: displacement"),
                            ("section-forces", "zero everywhere")):
            self.assertIn(words, (self.folder / f"kinds/down-{kind}.svg").read_text())

    def test_what_is_asked_for_is_drawn(self):
        self.assertEqual(set(self.pictures("down.h5")), {"down-shape", "down-diagrams", "down-load-path"})
        (name, text), = self.pictures("portal.h5", "--step", "0", "--picture", "shape", "--field", "moment").items()
        self.assertEqual(name, "portal-shape-000000")
        self.assertIn("step 0, load factor 0", text)

    def test_stresses_of_the_steps_that_have_them(self):
        """One section has a shape, the other one none."""
        sections = "{s: {Shape: circle, Diameter: 0.1, Material: {E: 1e6, nu: 0.3}}, plain: {EA: 1e4, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1}}"
        text = re.sub("(?<=Sections: ).*", sections, CANTILEVER).replace("b: [1, 0, 0]", "b: [1, 0, 0], c: [2, 0, 0]")
        solve(self.folder, "stressed", text.replace("Order: 3", "Section: s}, n: {Start: b, End: c, Section: plain, Elements: 4"))
        for field in ("von_mises", "normal_stress", "shear_stress"):
            drawn = self.pictures("stressed.h5", "--field", field, "--picture", "shape", "fields")
        self.assertIn("shear stress", drawn["stressed-shape"])
        self.assertIn("von Mises stress, largest of the section", drawn["stressed-fields"])
        with mock.patch.object(plot_result, "_note") as note:
            self.assertEqual(self.pictures("stressed.h5", "--picture", "steps"), {})
        self.assertIn("nothing to show of the field in every step", note.call_args[0][0])
        with self.assertRaisesRegex(InputError, "step 0 has no stresses.*Stresses"):
            self.pictures("stressed.h5", "--field", "von_mises", "--step", "0", "--picture", "shape")

    def test_path_and_modes_of_critical_points(self):
        drawn = self.pictures("snap_back.h5", "--picture", "load_path", "critical_modes")
        factor = f"{self.run_of('snap_back').critical_points()[0].load_factor:.6g}"
        for words in ("dashed: unstable", "limit point", factor):
            self.assertIn(words, drawn["snap_back-load-path"])
        self.assertIn(f"1: limit point, load factor {factor}", drawn["snap_back-critical-modes"])
        asked = """<ParameterList name="Quantities"><ParameterList name="drop">
              <Parameter name="Quantity" type="string" value="displacement"/><Parameter name="Point" type="string" value="loaded"/>
              <Parameter name="Component" type="string" value="y"/></ParameterList><ParameterList name="inverse">
              <Parameter name="Quantity" type="string" value="formula"/><Parameter name="Formula" type="string" value="1/drop"/>
            </ParameterList></ParameterList></ParameterList>"""  # infinite without load
        text = (ROOT / "apps/gallery/snap_back.xml").read_text()
        (self.folder / "asked_back.xml").write_text(asked.join(text.rsplit("</ParameterList>", 1)))
        self.mixbeam("run", "asked_back.xml", "--output", ".", "--quiet")
        self.assertIn("inverse", self.pictures("asked_back.h5", "--picture", "load_path")["asked_back-load-path"])

    def test_what_cannot_be_drawn_is_refused(self):
        (self.folder / "broken.h5").write_bytes(b"\x89HDF\r\n\x1a\nand no more")
        said = self.mixbeam("plot", "broken.h5", code=2)
        self.assertRegex(said, "broken.h5: .*none of its steps is intact")
        self.assertNotIn("Traceback", said)
        for words, reason in ((("absent.h5",), "absent.h5: no such file"), (("portal.h5", "--step", "7"), "no step 7; it has steps 0 to 1"),
                              (("portal.h5", "--field", "colour"), "--field colour: allowed are moment, bending"),
                              (("portal.h5", "--format", "gif"), "--format gif: allowed are png, svg, pdf"),
                              (("portal.h5", "--case", "wind"), "without load cases, and there is no portal-wind.h5")):
            with self.assertRaisesRegex(InputError, reason):
                self.pictures(*words)

    def test_command_line(self):
        plot = partial(self.mixbeam, "plot", "portal.h5", "--format", "svg")
        plot("--view", "-60/25", "--scale", "3", "--members", "deck *", "left", "--moments", "left", "--picture", "shape", "diagrams")
        self.assertIn("portal-along.svg", plot("--along", "deck *"))
        for options, word in ((("--scale", "-1"), "--scale"), (("--picture", "along"), "--along"), (("--view", "top"), "--view"),
                              (("--moments", "up"), "--moments"), (("--along", "dek"), "deck 1"), (("--picture", "curve"), "--curve")):
            self.assertIn(word, plot(*options, code=2))


if __name__ == "__main__":
    unittest.main()
