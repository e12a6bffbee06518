#!/usr/bin/python3
"""Mistakes as engineers make them, in YAML, XML, CSV and Python: each message names the place and the remedy, several are
told at once, and none twice.

usage: mistakes_test.py MIXBEAM FOLDER_OF_MODULE [CLASS]...
"""

import re
import subprocess
import sys
import unittest

from support import PROGRAM, InFolder

MODULE = sys.argv.pop(1)
BAD_INPUT = 2

SCENE = """\
Scene:
  Sections:
    tube:
      Shape: tube
      Diameter: 0.06
      Wall: 0.004
      Material: {E: 210e9, nu: 0.3}
    bar: {EA: 1e8, GA2: 4e7, GA3: 4e7, GIt: 1e4, EI2: 1e4, EI3: 1e4}
  Points:
    foot: [0, 0, 0]
    knee: [0, 0, 3]
    tip: [2, 0, 3]
  Members:
    column: {Start: foot, End: knee, Section: tube, Order: 3}
    arm: {Start: knee, End: tip, Section: bar}
  Supports:
    base: {Point: foot}
  Point Loads:
    weight: {Point: tip, Force: [0, 0, -500]}
  Distributed Loads:
    wind: {Member: column, Force: [20, 0, 0]}
Analysis:
  Stability: true
Quantities:
  sag: {Quantity: displacement, Point: tip, Component: z}
"""

# What stands in the scene, what is written in its place, line, column of the mark (0: anywhere), what the message says.
IN_YAML = (
    ("  Points:\n    foot", "  Points:\n\tfoot", 10, 0, "a tab in the indentation; allowed: spaces"),
    ("  Supports:\n    base: {Point: foot}\n", "", 1, 0, 'no support.*needed: in "Scene".*Supports: {base: {Point: foot}}'),
    ("Diameter: 0.06", "Diameter: 0,06", 5, 17, "did you mean 0.06"),
    ("E: 210e9", "E: 210 GPa", 7, 21, "numbers stand without units"),
    ("E: 210e9", "E: pi", 7, 21, 'did you mean "=pi", a formula'),
    ("E: 210e9", "E: 2pi", 7, 21, r'did you mean "=2\*pi", a formula'),
    ("E: 210e9", "E: 30 deg", 7, 21, 'did you mean "=30 deg", a formula'),
    ("[2, 0, 3]", "[2,0, 0, 3,0]", 12, 10, "5 entries; allowed.* 3 values.*a comma separates entries"),
    ("Wall: 0.004", "Radius: 0.03", 6, 7, 'allowed: "Profile", "Shape", "Diameter", "Wall", "Shear Correction", "Inextensible", "Shear '
     'Rigid", "Largest Strain", "Material", "Damping"; did you mean "Diameter", twice the radius'),
    ("Analysis:\n  Stability: true\n", "  Analysis:\n    Stability: true\n", 22, 3, 'belongs beside "Scene", not inside it'),
    ("Shape: tube\n", "Shape: tube\n      E: 210e9\n", 5, 7, 'belongs in the list "Material"'),
    ("End: tip", "End: Tip", 15, 29, 'not a point of the scene; allowed: "foot", "knee", "tip"; did you mean "tip"'),
    ("Force: [0, 0, -500]", "Force: -500", 19, 33, r"3 values.*, like \[0, 0, 1\]"),
    ("knee: [0, 0, 3]", "knee: {x: 0, y: 0, z: 3}", 11, 5, r"a map; allowed.*, like \[0, 0, 1\]"),
    ("foot: [0, 0, 0]", "foot: {0, 0, 0}", 10, 0, r"did you mean a sequence, like \[1, 2, 3\]"),
    ("Order: 3", "Order: 12", 14, 60, "value 12; allowed: int, 1 <= value <= 8"),
    ("    base: {Point: foot}", "   base: {Point: foot}\n     other: {Point: knee}", 18, 6, "the same indentation"),
    ("Point: tip, Force", "Point: tip Force", 19, 0, "a comma or a closing bracket is missing"),
    ("column: {Start: foot", "column: {begin: foot", 14, 14, 'did you mean "Start"'),
    ("nu: 0.3", "Poisson: 0.3", 7, 28, 'did you mean "nu"'),
    ("Points:\n    foot", "Nodes:\n    foot", 9, 3, 'did you mean "Points"'),
    ("Point Loads:", "Loads:", 18, 3, 'did you mean "Point Loads"'),
    ("Quantity: displacement", "Type: displacement", 25, 9, 'did you mean "Quantity"'),
    ("Quantity: displacement", "Quantity: deflection", 25, 19, 'did you mean "displacement"'),
    ("Quantity: displacement", "Quantity: section force", 25, 19, 'did you mean "material force"'),
    ("Quantity: displacement", "Quantity: reaction farce", 25, 19, 'did you mean "reaction force"'),
    ("Stability: true", "Stability: yes", 23, 14, "did you mean true"),
    ("{Point: foot}", "{Point: foot, Fixed Rotation: none}", 17, 41, r"did you mean \[\]"),
    ("Force: [20, 0, 0]", "Force: [20*x, 0, 0]", 21, 35, 'did you mean "Force Formula"'),
    ("  Supports:\n", "  Variables: {theta: 25°}\n  Supports:\n", 16, 22, "degrees are written deg, as in 25 deg"),
    ("knee: [0, 0, 3]", 'knee: ["=3*sin(90)", 0, 3]', 11, 11, r"did you mean sin\(90 deg\)"),
    ("Diameter: 0.06", 'Diameter: "=0.06**2"', 5, 17, r"powers are written \^"),
    ("foot: [0, 0, 0]", "foot: [0, 2*3, 0]", 10, 11, r'did you mean "=2\*3", a formula'),
    ("Component: z}", "Component: z, Limit: L/300}", 25, 66, 'did you mean "=L/300", a formula'),
    ("Wall: 0.004", "Wall: 4D-3", 6, 13, "did you mean 4e-3"),
    ("E: 210e9", 'E: "210 000"', 7, 21, "no blank inside of one"),
    ("{Quantity: displacement, Point", '{Quantity: "displacement, Point', 25, 19,
     "a quote that is not closed in this line; nothing after this line was read"),
    ("Shape: tube", "Shape: 'tube", 4, 14, "a quote that is not closed in this line; nothing after"),
    ("Material: {E: 210e9, nu: 0.3}", "Material: steel", 7, 0, 'a map of this name, with "E", "nu"'),
    ("arm: {Start: knee, End: tip, Section: bar}", "arm: [knee, tip, bar]", 15, 0, 'one map per member, with "Start", "End"'),
    ("Force: [0, 0, -500]", "Fz: -500", 19, 26, 'did you mean "Force"'),
)
IN_XML = (
    ('"Wall" type="double" value="0.004"', '"Wall" type="double" value="0,004"', 8, 0, "did you mean 0.004"),
    ('"Wall" type="double"', '"Wall" type="float"', 8, 0, 'unknown type "float".*did you mean "double"'),
    ('"Diameter" type="double"', '"Diameter"', 7, 0, 'without the attribute "type"; allowed: .*"double"'),
    ('value="{0, 0, -500}"', 'value="0, 0, -500"', 49, 0, "values between braces, like {1, 2, 3}"),
    ('"Order" type="int" value="3"', '"Order" type="int" value="3.0"', 33, 0, '"3.0" is not a whole number'),
    ('    </ParameterList>\n    <ParameterList name="Members">', '    <ParameterList name="Members">', 0, 0,
     '"Scene / Points" seems to have no </ParameterList>: "Members" in line 27'),
    ('    <ParameterList name="Supports">\n      <ParameterList name="base">\n        <Parameter name="Point" type="string" '
     'value="foot"/>\n      </ParameterList>\n    </ParameterList>\n', "", 3, 0, 'no support.*<ParameterList name="Supports">'),
    ('name="tip" type', 'name="tip type', 26, 0, "a quote of an attribute is missing; nothing after this line was read"),
    ('<ParameterList name="weight">', '<ParameterList name="weight & snow">', 47, 0, "& in a text is written &amp;"),
)
TABLES = {"points.csv": "name,x,y,z\nfoot,0,0,0\nknee,0,0,3\ntip,2,0,3\n",
          "members.csv": "name,start,end,section\ncolumn,foot,knee,tube\narm,knee,tip,tube\n",
          "loads.csv": 'name,point,force\nweight,tip,"{0, 0, -500}"\n'}
IMPORT = """\
Scene:
  Sections: {tube: {Shape: tube, Diameter: 0.06, Wall: 0.004, Material: {E: 210e9, nu: 0.3}}}
  Import: {Points File: points.csv, Members File: members.csv, Point Loads File: loads.csv}
  Supports: {base: {Point: foot}}
"""
IN_CSV = (
    ("members.csv", "name,start,end", "name,start,ende", 1, 12, 'did you mean "end"'),
    ("points.csv", "name,x,y,z", "nr,x,y,z", 1, 1, '"nr" is not a column.*did you mean "name"'),
    ("loads.csv", "name,point,force", "name,node,force", 1, 6, 'did you mean "point"'),
    ("points.csv", "tip,2,0,3", 'tip,"2,0",0,3', 4, 5, "did you mean 2.0"),
    ("members.csv", "arm,knee,tip", "arm,knee,top", 3, 10, 'not a point of the scene.*did you mean "tip"'),
)
IN_PYTHON = (
    ("scene.members['a'] = dict(begin='foot', end='tip', section='tube')", "Scene / Members / a: .*did you mean 'start'"),
    ("scene.members['a'] = dict(start='foot', end='tipp', section='tube')",
     '^scene mast: "Scene / Members / a / End": value "tipp" is not a point.*did you mean "tip"'),
    ("scene.sections['tube'] = mixbeam.Circle(radius=0.03, E=210e9, nu=0.3)", "did you mean 'diameter', twice the radius"),
    ("scene.supports.clear()", r'no support.*scene.supports\["base"\] = dict\(point="foot"\)'),
    ("scene.loads['w'] = dict(point='tip', force=(0, 0, 1))", "did you mean 'point_loads'"),
    ("scene.point_loads['w'] = dict(point='tip', force=-500)", r'"Scene / Point Loads / w / Force".*, like \[0, 0, 1\]'),
    ("scene.members['column'].order = 12", '"Scene / Members / column / Order": value 12; allowed: int, 1 <= value <= 8'),
    ("scene.sections['tube'].diameter = '0,06'", "Scene / Sections / tube / Diameter: '0,06'.*did you mean 0.06"),
    ("scene.members['a'] = ['foot', 'tip', 'tube']", "Scene / Members / a: .*an object or a dict, with start, end"),
    ("mixbeam.Tube(0.06, 0.004)", r"^Tube: 0.06 without a name.*help\(mixbeam.Tube\)"),
)
MAST = """\
import sys; sys.path.insert(0, sys.argv[1])
import mixbeam
scene = mixbeam.Scene("mast")
scene.sections["tube"] = mixbeam.Tube(diameter=0.06, wall=0.004, E=210e9, nu=0.3)
scene.points.update(foot=(0, 0, 0), tip=(2, 0, 3))
scene.members["column"] = dict(start="foot", end="tip", section="tube")
scene.supports["base"] = dict(point="foot")
"""


class Mistakes(InFolder):
    def write(self, file, text):
        (self.folder / file).write_text(text)
        return file

    def refusal(self, file, text):
        """Of a scene file, without the name of the program; empty: the scene is in order."""
        ended = subprocess.run([PROGRAM, "check", self.write(file, text)], cwd=self.folder, capture_output=True, text=True)
        self.assertIn(ended.returncode, (0, BAD_INPUT), ended.stderr)
        return ended.stderr.removeprefix("mixbeam: bad input: ")

    def python(self, code):
        """What the code raises."""
        code = MAST + f"try:\n  {code}\n  mixbeam.check(scene)\nexcept mixbeam.InputError as error: print(error)\n"
        return subprocess.run(["/usr/bin/python3", "-c", code, MODULE], capture_output=True, text=True, check=True).stdout

    def in_xml(self):
        self.write("scene.yaml", SCENE)
        self.mixbeam("convert", "scene.yaml", "scene.xml", "--force")
        return (self.folder / "scene.xml").read_text()

    def expect(self, message, file, line, column, said):
        """One mistake, in this line, which follows with a mark below the place."""
        text = (self.folder / file).read_text()
        first, *marked = message.rstrip("\n").split("\n")
        self.assertRegex(first, said)
        self.assertNotRegex(first, r"\d mistakes")
        if line:
            self.assertRegex(first, rf"^{file}:{line}:")
            self.assertEqual(marked[0].strip(), text.split("\n")[line - 1].strip(), message)
            self.assertRegex(marked[1], r"^ *\^$")
        if column:
            whole = text.split("\n")[line - 1]
            self.assertEqual(marked[1].index("^") - 4 + len(whole) - len(whole.lstrip(" \t")) , column - 1, message)


class OneByOne(Mistakes):
    def test_the_scene_itself_is_in_order(self):
        self.assertEqual(self.refusal("scene.yaml", SCENE), "")
        self.assertEqual(self.refusal("scene.xml", self.in_xml()), "")
        self.assertEqual(self.python("pass"), "")
        for table in TABLES:
            self.write(table, TABLES[table])
        self.assertEqual(self.refusal("scene.yaml", IMPORT), "")

    def test_in_yaml(self):
        for right, wrong, line, column, said in IN_YAML:
            with self.subTest(wrong):
                self.assertIn(right, SCENE)
                self.expect(self.refusal("scene.yaml", SCENE.replace(right, wrong, 1)), "scene.yaml", line, column, said)

    def test_one_of_a_member_without_what_follows_from_it(self):
        scene = SCENE.replace("End: tip", "End: top").replace("-500]", "-500], Frame: follower, Member: arm")
        expected = ("Expected:\n  sag: {Quantity: displacement, Point: tip, Component: z, Value: 0, "
                    "Absolute Tolerance: 1, Source: hand}\n")
        self.assertNotIn("tip, Section", scene)
        message = self.refusal("scene.yaml", scene + expected)
        self.assertTrue(message.startswith("scene.yaml:15:24: "), message)
        self.assertEqual(message.count("^"), 1, message)

    def test_in_xml(self):
        scene = self.in_xml()
        for right, wrong, line, column, said in IN_XML:
            with self.subTest(wrong):
                self.assertIn(right, scene)
                self.expect(self.refusal("wrong.xml", scene.replace(right, wrong, 1)), "wrong.xml", line, column, said)

    def test_in_csv(self):
        for table, right, wrong, line, column, said in IN_CSV:
            with self.subTest(wrong):
                for other in TABLES:
                    self.write(other, TABLES[other])
                self.write(table, TABLES[table].replace(right, wrong, 1))
                self.expect(self.refusal("scene.yaml", IMPORT), table, line, column, said)

    def test_in_python(self):
        for code, said in IN_PYTHON:
            with self.subTest(code):
                message = self.python(code)
                self.assertRegex(message, said)
                self.assertNotRegex(message, "XML|YAML|:[0-9]+:|\\^")

    def test_results_are_wanted_where_a_scene_or_a_batch_is_given(self):
        self.assertRegex(self.mixbeam("report", self.write("mast-batch.h5", ""), code=BAD_INPUT), "the table of a batch.*allowed: .*mast-batch.csv")


class Several(Mistakes):
    WRONG = (("Diameter: 0.06", "Diameter: 0,06"), ("knee: [0, 0, 3]", "knee: [0, 3]"), ("Start: foot", "begin: foot"),
             ("End: tip", "End: top"), ("{Point: foot}", "{Point: foott}"), ("Member: column", "Member: colunm"),
             ("Stability: true", "Stability: yes"), ("Component: z", "Component: w"))
    LINES = [5, 11, 14, 15, 17, 21, 23, 25]

    def test_in_yaml_in_the_order_of_the_file(self):
        scene = SCENE
        for right, wrong in self.WRONG:
            scene = scene.replace(right, wrong, 1)
        message = self.refusal("scene.yaml", scene)
        self.assertTrue(message.startswith(f"{len(self.LINES)} mistakes:\n"), message)
        self.assertEqual([int(line) for line in re.findall(r"^scene.yaml:(\d+):", message, re.M)], self.LINES)
        self.assertEqual(message.count("^"), len(self.LINES))

    def test_in_xml(self):
        scene = self.in_xml()
        for right, wrong in (('value="0.06"', 'value="0,06"'), ('"Start"', '"begin"'), ('type="int"', 'type="integer"'),
                             ('<Parameter name="Point" type="string" value="tip"/>',
                              '<Parameter name="Point" type="string" value="tpi"/>')):
            self.assertIn(right, scene)
            scene = scene.replace(right, wrong, 1)
        message = self.refusal("wrong.xml", scene)
        self.assertTrue(message.startswith("4 mistakes:\n"), message)
        self.assertEqual(message.count("^"), 4)

    def test_in_csv(self):
        wrong = {"points.csv": TABLES["points.csv"].replace("2,0,3", "2,O,3").replace("0,0,0", "0,0,x"),
                 "members.csv": TABLES["members.csv"].replace("column,foot", "column,fot").replace("tip,tube", "tip,tub"),
                 "loads.csv": TABLES["loads.csv"].replace("tip", "tpi")}
        for table, text in wrong.items():
            self.write(table, text)
        message = self.refusal("scene.yaml", IMPORT)
        self.assertTrue(message.startswith("5 mistakes:\n"), message)
        for place in ("points.csv:2:10", "points.csv:4:7", "members.csv:2:8", "members.csv:3:14", "loads.csv:2:8"):
            self.assertIn(f"\n{place}: ", message)
        self.assertEqual(message.count("^"), 5)

    def test_in_python(self):
        message = self.python("scene.members['column'].order = 12; scene.supports['base'].point = 'fot'; "
                              "scene.point_loads['w'] = dict(point='tip', force=(0, 1))")
        self.assertTrue(message.startswith('3 mistakes:\nscene mast: "Scene / '), message)

    def test_twenty_in_full(self):
        loads = "".join(f"    w{i}: {{Point: nowhere, Force: [0, 0, 1]}}\n" for i in range(25))
        message = self.refusal("scene.yaml", SCENE.replace("  Distributed Loads", loads + "  Distributed Loads"))
        self.assertTrue(message.startswith("25 mistakes:\n"), message)
        self.assertEqual(message.count("^"), 20)
        self.assertTrue(message.endswith("\nand 5 more\n"), message)

    def test_a_hundred_thousand_end_soon(self):
        loads = "".join(f"    w{i}: {{Point: nowhere, Force: [0, 0, 1]}}\n" for i in range(100_000))
        message = self.refusal("scene.yaml", SCENE.replace("  Distributed Loads", loads + "  Distributed Loads"))
        self.assertTrue(message.startswith("40 or more mistakes:\n"), message)
        self.assertTrue(message.endswith("\nand others\n"), message)


if __name__ == "__main__":
    unittest.main()
