#!/usr/bin/python3
"""The lists "Gradient", "Identification", "Design" and "Inverse" as a user meets them: terminal, tables, summary, result files, refusals.

usage: searches_test.py MIXBEAM [CLASS]...
"""

import math
import shutil
import unittest

from support import BAD_INPUT, CHECK_FAILED, NO_CONVERGENCE, InFolder, changed, scene_of, with_lists

TIP = "tip: {Quantity: displacement, Point: tip}"
DOWN, OF_FORCE = -0.810609024880296, 0.0105359712168047  # of the tip, and by the force: elliptic integrals, F L^2 / EI = 10
ROUNDING = 1e-11
EULER = 0.25 * math.pi**2  # of a cantilever of length and EI one


class Gradients(InFolder):
    def solve(self, lists, code=0, removed=()):
        return self.run_scene(with_lists(scene_of("apps/gallery/elastica.xml"), lists, removed), "--quiet", code=code)

    def asking(self, gradient, code=0):
        return self.solve(f"Quantities: {{{TIP}, count: {{Quantity: negative eigenvalues}}}}\nGradient: {{{gradient}}}", code)

    def derivatives(self, quantity):
        return [float(row["derivative"]) for row in self.rows("results/scene-gradients.csv") if row["quantity"] == quantity]

    def column(self, gradient, more=""):
        """The strip as a column, P L^2 = pi^2 EI / 4: a force across it is an imperfection."""
        return self.solve(f"""Scene: {{Sections: {{strip: {{EI2: 6}}}}, Point Loads: {{weight: {{Force: [-5, 0, 0]}}}}}}
Gradient: {{Of: [load factor at critical point 1], With Respect To: [{gradient}]}}
{more}""", removed=["Expected"])

    def test_they_stand_in_table_file_and_summary(self):
        self.expect(self.asking("Of: [tip.y], With Respect To: ['Point Loads/*/Force[1]', Sections/*/EI3], By Element: true"),
                    "gradient of tip.y", "by Point Loads/weight/Force[1]")
        self.expect(self.text("summary.json"), '"gradients"', '"Sections/strip/EI3"')
        self.assertEqual(list(self.rows("results/scene-gradients.csv")[0]), ["quantity", "value", "number", "derivative"])
        for found, wanted in zip(self.derivatives("tip.y"), (OF_FORCE, 10 * OF_FORCE), strict=True):  # of F and of EI: one number, F / EI
            self.assertAlmostEqual(found, wanted, delta=10 * ROUNDING)
        self.expect(self.contents(), *(f"steps/000001/gradients/{name}" for name in ("numbers", "0/derivative", "0/stiffness", "0/compliance",
                                                                                    "0/natural")))

    def test_numbers_at_their_bounds_are_left_out(self):
        """They cannot move to both sides: of a pattern they have no derivative, by themselves they are a mistake."""
        def by(number, code):
            return self.solve(f"""Scene: {{Sections: {{strip: {{Mass: 1, Rotary Inertia: [0, 1, 1]}}}}}}
Quantities: {{{TIP}}}
Gradient: {{Of: [tip.y], With Respect To: ['Sections/{number}']}}""", code)
        self.expect(by("*/*", 0), "no derivative  by Sections/strip/Rotary Inertia[0]", "  by Sections/strip/EI3",
                    'no derivative: the gradient with respect to "Sections/strip/Rotary Inertia[0]"', "value >= 0")
        by("strip/Rotary Inertia[0]", CHECK_FAILED)

    def test_they_follow_variables_into_formulas_of_quantities(self):
        self.solve(f"""Scene: {{Variables: {{c: 3}}}}
Quantities: {{{TIP}, f: {{Quantity: formula, Formula: c^2 * tip_y}}}}
Gradient: {{Of: [f], With Respect To: [Variables/c]}}""")
        self.assertAlmostEqual(self.derivatives("f")[0], 2 * 3 * DOWN, delta=ROUNDING)

    def test_what_the_scene_does_not_have_is_refused(self):
        for gradient, message in (("Of: [top], With Respect To: [Sections/*/EI3]", 'value "top" is no number that a quantity has'),
                                  ("Of: [tip.x], With Respect To: ['Points/tip[-1]']", 'value "Points/tip[-1]" is no path'),
                                  ("Of: [tip.x], With Respect To: [Sections/strip/EJ]", 'value "Sections/strip/EJ" is no path'),
                                  ("Of: [tip.x]", "it asks for nothing")):
            self.expect(self.asking(gradient, BAD_INPUT), message, "allowed")

    def test_of_a_critical_load(self):
        self.expect(self.column("Sections/*/EI3, 'Point Loads/*/Force[1]'"), "gradient of load factor at critical point 1",
                    "no derivative  by Point Loads/weight/Force[1]", "gradient of imperfection sensitivity at critical point 1")
        self.assertAlmostEqual(self.derivatives("load factor at critical point 1")[0], EULER / 5, delta=1e-8)
        self.expect(self.contents(), "steps/000001/gradients/1/derivative")

    def test_of_a_critical_load_before_the_stop_of_a_run_that_is_resumed(self):
        self.column("Sections/*/EI3", "Solver: {Load Path: {Maximum Step: 0.2}}")
        table = self.text("results/scene-gradients.csv")
        (self.folder / "results/scene-gradients.csv").unlink()
        self.ended("resume", "results/scene.h5", "--from", "4", "--quiet")
        self.assertEqual(self.text("results/scene-gradients.csv"), table)

    def test_without_answer_is_a_check_that_failed(self):
        """The results stay."""
        for of, *words in (("tip.y, load factor at critical point 2", "gradient of tip.y", "it did not come; critical points on the path: 0"),
                           ("count", "gradients", '"negative eigenvalues" has no derivative')):
            self.expect(self.asking(f"Of: [{of}], With Respect To: [Sections/*/EI3]", CHECK_FAILED), *words)
            self.expect(self.contents(), "steps/000001")

    def test_quantities_that_a_pattern_means_are_left_out(self):
        self.expect(self.solve(f"""Quantities: {{{TIP}, far: {{Quantity: formula, Formula: tip_y / tip_z}},
  none: {{Quantity: formula, Formula: tip_z / tip_z}}, count: {{Quantity: negative eigenvalues}}}}
Gradient: {{Of: ['*'], With Respect To: [Sections/*/EI3]}}"""), "gradient of tip.y", 'no derivative: the gradient of "count": the quantity',
                    'no derivative: the gradient of "far": it has no finite value', "unknown")
        self.assertAlmostEqual(self.derivatives("tip.y")[0], 10 * OF_FORCE, delta=10 * ROUNDING)


# The bend of 45 degrees under 600: EI and GIt from the motion of its tip, which shooting on the equations of the rod gives.
ARC = """Scene:
  Variables: {EI: 1.2e6, GIt: 4.0e5}
  Sections: {rod: {EA: 1.0e7, GA2: 5.0e6, GA3: 5.0e6, GIt: "=GIt", EI2: "=EI", EI3: "=EI"}}
  Points: {clamp: [0, 0, 0]}
  Members:
    arc: {Start: clamp, End: tip, Section: rod, Order: 4, Elements: 8,
          Curve: {Shape: arc, Center: [0, -100, 0], Axis: [0, 0, -1], Angle: "=45 deg"}}
  Supports: {clamp: {Point: clamp}}
  Point Loads: {force: {Point: tip, Force: [0, 0, 600]}}
Quantities: {tip: {Quantity: displacement, Point: tip}}
Identification:
  Parameters: {bending: {Number: Variables/EI, At Least: 1}, torsion: {Number: Variables/GIt, At Least: 1}}
  Measurements:
    x: {Quantity: tip.x, Value: -23.560239545026, Standard Deviation: 0.02}
    y: {Quantity: tip.y, Value: 13.604521347307, Standard Deviation: 0.02}
    z: {Quantity: tip.z, Value: 53.474858791825, Standard Deviation: 0.02}
"""
# A strut whose Euler load bounds what it bears without moving aside.
STRUT = """Scene:
  Variables: {EI: 1.5, P: 2}
  Sections: {rod: {EA: inf, GA2: inf, GA3: inf, GIt: 1, EI2: 1, EI3: "=EI"}}
  Points: {a: [0, 0, 0], b: [1, 0, 0]}
  Members: {rod: {Start: a, End: b, Order: 4, Elements: 8}}
  Supports: {wall: {Point: a}}
  Point Loads: {weight: {Point: b, Force: [0, "=-P", 0]}}
Quantities: {tip: {Quantity: displacement, Point: b}}
Identification:
  Parameters: {EI: {Number: Variables/EI}}
  Measurements: {down: {Quantity: tip.y, Value: -0.301720773799814, Standard Deviation: 0.01}}
"""
# Two halves of a cantilever whose stiffnesses are paid for, by a small load: of the linear theory 7 / EI1 + 1 / EI2 = 24 w / (P L^3), so the
# least sum has EI1 = sqrt(7) EI2.
STEPPED = """Scene:
  Variables: {root: 3, end: 3}
  Sections:
    root: {EA: inf, GA2: inf, GA3: inf, GIt: 1, EI2: 1, EI3: "=root"}
    end: {EA: inf, GA2: inf, GA3: inf, GIt: 1, EI2: 1, EI3: "=end"}
  Points: {a: [0, 0, 0], middle: [0.5, 0, 0], b: [1, 0, 0]}
  Members:
    root: {Start: a, End: middle, Section: root, Order: 3, Elements: 2}
    end: {Start: middle, End: b, Section: end, Order: 3, Elements: 2}
  Supports: {wall: {Point: a}}
  Point Loads: {weight: {Point: b, Force: [0, -1.0e-4, 0]}}
Quantities:
  tip: {Quantity: displacement, Point: b, Component: y}
  price: {Quantity: formula, Formula: "root + end"}
Design:
  Parameters: {root: {Number: Variables/root, At Least: 0.01}, end: {Number: Variables/end, At Least: 0.01}}
  Objective: {Quantity: price}
  Constraints: {sag: {Quantity: tip, At Least: -1.0e-5}}
"""
NEAR = 1e-7  # of the linear theory: squares of rotations are 1e-10


class SearchCase(InFolder):
    def found(self, text, *changes, code=0):
        """Numbers that a scene with these changes is found to have."""
        for old, new in changes:
            text = changed(text, old, new)
        self.said = self.run_scene(text, code=code)
        self.numbers = self.summary()["found_numbers"]
        return [number["value"] for number in self.numbers]


class Identification(SearchCase):
    def test_stiffnesses_of_the_spatial_arc_are_found(self):
        stiffness, exact = 2.5e6 / 3, 1e-8
        for value in self.found(ARC):
            self.assertAlmostEqual(value / stiffness, 1, delta=exact)
        _, torsion = self.found(ARC, ("53.47485", "53.47486"))  # the twin with another measurement
        self.assertGreater(abs(torsion / stiffness - 1), exact)

    def test_what_measurements_do_not_tell_apart_is_told(self):
        bending, load, torsion = self.found(STRUT, (
            "{EI: {Number: Variables/EI}}", "{EI: {Number: Variables/EI}, load: {Number: Variables/P}, torsion: {Number: Sections/rod/GIt}}"))
        self.assertAlmostEqual(load / bending, 1, delta=1e-8)  # P L^2 / EI of the elastica
        self.assertEqual(torsion, 1)
        self.assertEqual([number["standard_deviation"] for number in self.numbers], ["inf"] * 3)
        self.assertEqual(len(self.summary()["warnings"]), 2)
        self.expect(self.said, "do not tell the parameters apart", "EI by", "load by", "torsion by")

    def test_it_stops_at_bounds(self):
        for most, right in (("1.75", 1.75), ("2.5", 2.0)):
            value, = self.found(STRUT, ("Variables/EI}", f"Variables/EI, At Most: {most}}}"))
            self.assertAlmostEqual(value, right, delta=1e-8 * (right == 2))
            self.assertEqual("standard_deviation" in self.numbers[0], right == 2)
            self.assertEqual("at its bound" in self.said, right == 1.75)

    def test_numbers_of_arrays(self):
        """With formulas beside them and without: P L^2 / EI = 1, L = 1."""
        load, place = self.found(STRUT, ('[0, "=-P", 0]', '["=0*P", -2, 0]'), (
            "{EI: {Number: Variables/EI}}", "{load: {Number: 'Point Loads/weight/Force[1]'}, place: {Number: 'Points/b[0]'}}"), (
            "Measurements: {", "Measurements: {along: {Quantity: tip.x, Value: -0.0564332362833769, Standard Deviation: 0.01}, "))
        self.assertAlmostEqual(load, -1.5, delta=1e-8)
        self.assertAlmostEqual(place, 1, delta=1e-8)
        self.expect(self.text("results/scene-identification.xml"), "{=0*P, -1.", 'type="Array(double)"')


class Design(SearchCase):
    def expect_numbers(self, right, *changes):
        for value, one in zip(self.found(STEPPED, *changes), right, strict=True):
            self.assertAlmostEqual(value, one, delta=NEAR * one)

    def test_it_is_the_best_that_constraints_allow(self):
        end = (1 + math.sqrt(7)) / 2.4
        best = math.sqrt(7) * end, end
        self.expect_numbers(best)
        # as an equation, and as the smallest sag that the price allows
        self.expect_numbers(best, ("At Least: -1.0e-5", "At Least: -1.0e-5, At Most: -1.0e-5"))
        self.expect_numbers(best, ("{Quantity: price}", "{Quantity: tip, Goal: largest}"),
                            ("{Quantity: tip, At Least: -1.0e-5}", '{Quantity: price, At Most: "=(8 + 2*sqrt(7))/2.4"}'))

    def test_it_keeps_to_bounds(self):
        self.expect_numbers((3.5, 2.5), ("At Least: 0.01", "At Least: 0.01, At Most: 3.5"))  # 7 / 3.5 + 1 / 2.5 = 2.4
        self.expect(self.said, "Variables/root, at its bound", without=["Variables/end, at its bound"])

    def test_constraints_that_cannot_be_met_are_told(self):
        weak = ("0.01}, end", "0.01, At Most: 3.1}, end"), ("0.01}}", "0.01, At Most: 3.1}}")
        self.found(STEPPED, *weak, code=NO_CONVERGENCE)
        self.expect(self.said, "meet all constraints")

    def test_it_ends_where_a_branch_ends(self):
        """The largest load of a strut: no step leaves the branch on which it stays straight, up to pi^2 EI / (4 L^2) about the weaker axis."""
        strut = changed(changed(STRUT, '[0, "=-P", 0]', '["=-P", 0, 0]'), "{tip: {Quantity: displacement, Point: b}}",
                        "{load: {Quantity: formula, Formula: P}}")
        load, = self.found(strut[:strut.index("Identification:")]
                           + "Design: {Parameters: {P: {Number: Variables/P}}, Objective: {Quantity: load, Goal: largest}}\n", code=NO_CONVERGENCE)
        self.assertAlmostEqual(load, EULER, delta=1e-6)
        self.expect(self.said, "cannot be carried to P = ", "negative eigenvalues changes from 0 to 1")


class Files(SearchCase):
    def test_they_hold_the_numbers_and_the_scene_with_them(self):
        self.expect(self.run_scene(ARC), "Identification: 2 number(s) from 3 measurement(s)", "bending", "Variables/GIt")
        for name in ("-identification.csv", "-identification-steps.csv", "-identification.h5", ".h5"):
            self.assertTrue((self.folder / f"results/scene{name}").exists(), name)
        self.expect(self.text("summary.json"), '"found_numbers"', '"standard_deviation"', "Identification / z")
        shutil.copy(self.folder / "results/scene-identification.xml", self.folder)
        self.expect(self.mixbeam("run", "scene-identification.xml", "--output", "again"), "-23.56023955", "53.47485879")

    def test_they_hold_the_best_numbers_where_a_branch_ends(self):
        """The load of a strut that is to be at rest at a deflection which it has beyond its first bifurcation alone."""
        text = STRUT
        for old, new in (('[0, "=-P", 0]', '["=-P", 0, 0]'), ("{EI: {Number: Variables/EI}}", "{load: {Number: Variables/P}}"),
                         ("EA: inf", "EA: 100"), ("tip.y", "tip.x")):
            text = changed(text, old, new)
        (self.folder / "results").mkdir()
        self.write("results/scene.h5", "of an earlier run")
        self.expect(self.run_scene(text, code=NO_CONVERGENCE), "cannot be carried to load = ", "negative eigenvalues changes from 0 to 1",
                    "best numbers")
        self.expect(self.text("summary.json"), '"failure"', '"found_numbers"')
        self.assertFalse((self.folder / "results/scene.h5").exists())
        table = self.text("results/scene-identification.csv")
        load = float(table.split("Variables/P,2,")[1].split(",")[0])
        # P (1 - P / EA) = pi^2 EI / (4 L^2) about the weaker axis
        self.assertAlmostEqual(load, 50 * (1 - math.sqrt(1 - 4 * EULER / 100)), delta=1e-5)

    def test_what_is_not_offered_is_refused(self):
        for old, new, *parts in (("Variables/EI}", "Variables/EJ}", 'did you mean "Variables/EI"?'),
                                 ("Variables/EI}", "Sections/rod/EA}", "is no path of a finite real number"),
                                 ("Variables/EI}", "'Points/b[-1]'}", "is no path of a finite real number"),
                                 ("Variables/EI}", "Variables/EI, At Least: 2}", "beyond this bound"),
                                 ("Variables/EI}", "Variables/EI, At Least: 2, At Most: 1}", 'above "At Least"'),
                                 ("Number: Variables/EI", "Number: 'Points/a[2]'", "is zero in the scene"),
                                 ("tip.y", "tip.w", 'did you mean "tip.x"'),
                                 ("{Quantity: tip.y", "{Case: wind, Quantity: tip.y", "the scene has no cases"),
                                 ("Identification:", "Inverse: {}\nIdentification:", "one of them"),
                                 ("Order: 4, Elements: 8", "Second Axis: [0, 1, 0]", "names no mesh")):
            self.expect(self.run_scene(changed(STRUT, old, new), code=BAD_INPUT), "scene.yaml:", *parts)
        both = self.run_scene(changed(changed(STRUT, "Variables/EI}", "Variables/EJ}"), "tip.y", "tip.w"), code=BAD_INPUT)
        self.expect(both, "2 mistakes", 'did you mean "Variables/EI"?', 'did you mean "tip.x"')
        # what has no derivative is refused as a gradient refuses it
        count = changed(changed(STRUT, "{tip:", "{count: {Quantity: negative eigenvalues}, tip:"), "tip.y, Value: -0.301720773799814",
                        "count, Value: 0")
        self.expect(self.run_scene(count, code=BAD_INPUT), "has no derivative")
        for old, new, message in (("At Least: -1.0e-5", "At Least: 1, At Most: 0", 'below "At Least"'),
                                  ("{Quantity: tip, At Least: -1.0e-5}", "{Quantity: tip}", "no bound"),
                                  ("{Quantity: price}", "{Quantity: cost}", "is no number that a quantity has")):
            self.expect(self.run_scene(changed(STEPPED, old, new, "Design:"), code=BAD_INPUT), "scene.yaml:", message)
        self.write_scene(STRUT + "Batch: {Vary: {x: {Parameter: Variables/P, First: 1, Last: 2, Count: 2}}}\n")
        self.expect(self.mixbeam("batch", "scene.yaml", code=BAD_INPUT), "mixbeam run")


ROD = """Scene:
  Import: {Points File: points.csv}
  Sections: {rod: {EA: 4000, GA2: 300, GA3: 300, GIt: 1, EI2: 1, EI3: 1}}
  Members: {rod: {Start: a, End: b, Order: 3, Elements: 4}}
  Patterns: {more: {Kind: repeat, Members: [rod], Vector: [0, 0, 1], Count: 2, Copy: all}}
  Supports: {wall: {Point: a, Fixed Displacement: [x, y, z], Fixed Rotation: [x, y, z]}}
  Distributed Loads: {weight: {Member: rod, Force: [0, -2, 0.5]}}
Quantities: {sag: {Quantity: displacement, Point: b, Component: y}}
Expected: {sag: {Quantity: sag, Value: 0, Absolute Tolerance: 1e-10, Source: as drawn}}
Inverse: {}
"""


class RestShapes(InFolder):
    def setUp(self):
        super().setUp()
        self.write("points.csv", "name,x,y,z\na,0,0,0\nb,1,0.2,0\n")

    def test_they_run_forward_to_the_drawn_shape(self):
        self.run_scene(ROD, "--threads", "2")
        self.assertEqual(self.summary()["threads"], 2)
        results = self.folder / "results"
        for name in ("scene-curvature-rod.csv", "scene-strain-rod.csv", "scene-natural-rod.csv", "scene.h5"):
            self.assertTrue((results / name).exists(), name)
        self.expect(self.text("summary.json"), '"negative eigenvalues of the drawn state": 0')
        # by itself, and wrong without its tables
        forward = self.text("results/scene-forward.xml")
        (self.folder / "other").mkdir()
        for table in results.glob("*.csv"):
            shutil.copy(table, self.folder / "other")
        first = '<Parameter name="Curvature Table" type="string" value="scene-curvature-rod.csv"/>'
        for text, code in ((forward, 0), (changed(forward, '"Curvature Table"', '"Strain Table"'), BAD_INPUT),
                           (changed(forward, first, ""), CHECK_FAILED)):
            self.write("other/forward.xml", text)
            self.mixbeam("run", "other/forward.xml", "--output", "twin", code=code)

    def test_refusals_say_what_is_allowed(self):
        clamp = "Fixed Rotation: [x, y, z]}"
        loop = changed(ROD, clamp, clamp + ", far: {Point: b}")
        self.run_scene(changed(loop, "Inverse: {}", "Inverse: {Loops: closed}"))
        for text, words in ((loop, "12 force(s)"), (changed(ROD, "Inverse: {}", "Inverse: {Case: wind}"), "the scene has no cases"),
                            (changed(ROD, "Elements: 4", "Elements: 4, Force Integration: full"), "Force Integration")):
            self.expect(self.run_scene(text, code=BAD_INPUT), words)
        self.write_scene(ROD + "Batch: {Vary: {x: {Parameter: Sections/rod/EA, First: 4000, Last: 5000, Count: 2}}}\n")
        self.expect(self.mixbeam("batch", "scene.yaml", code=BAD_INPUT), "mixbeam run")


if __name__ == "__main__":
    unittest.main()
