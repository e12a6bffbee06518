#!/usr/bin/python3
"""Scenes in XML and YAML: `mixbeam convert` there and back, and runs of either.

usage: convert_test.py MIXBEAM [CLASS]...
"""

import math
import shutil
import unittest
import xml.etree.ElementTree

from support import BAD_INPUT, ROOT, InFolder, changed, differences

COMMENTED = """<!-- top, of
     two lines -->
<ParameterList name="rod">
  <ParameterList name="Scene">
    <!-- of the sections -->
    <ParameterList name="Sections">
      <ParameterList name="rod"> <!-- inside -->
        <Parameter name="EA" type="double" value="1e300"/>  <!-- stiff -->
        <Parameter name="Shear Rigid" type="bool" value="true"/>
        <Parameter name="GIt" type="int" value="1"/>
        <Parameter name="EI2" type="double" value="0.1"/>
        <Parameter name="EI3" type="double" value="0.30000000000000004"/>
        <!-- last -->
      </ParameterList>
    </ParameterList>
    <ParameterList name="Points">
      <Parameter name="no" type="Array(double)" value="{0, 0, 0}"/>
      <Parameter name="a: #b" type="Array(double)" value="{1, 0, -0.0}"/>
    </ParameterList>
    <ParameterList name="Members"><ParameterList name="1e3">
      <Parameter name="Start" type="string" value="no"/>
      <Parameter name="End" type="string" value="a: #b"/>
    </ParameterList></ParameterList>
    <ParameterList name="Supports"><ParameterList name="&quot;\\&lt;">
      <Parameter name="Point" type="string" value="no"/>
      <Parameter name="Fixed Rotation" type="Array(string)" value="{}"/>
    </ParameterList></ParameterList>
  </ParameterList>
</ParameterList>
<!-- bottom -->
"""
IN_YAML = """# top, of
# two lines
Scene:
  # of the sections
  Sections:
    rod:
      # inside
      EA: 1.0e+300  # stiff
      Shear Rigid: true
      GIt: 1
      EI2: 0.1
      EI3: 0.30000000000000004
      # last
  Points:
    "no": [0, 0, 0]
    "a: #b": [1, 0, -0]
  Members:
    "1e3": {Start: "no", End: "a: #b"}
  Supports:
    "\\"\\\\<": {Point: "no", Fixed Rotation: []}
# bottom
"""
FORMULAS = """Scene:
  Variables: {L: 2, slope: 30 deg, h: "=L*tan(slope)", n: "=5*L", F: "=1/L"}
  Sections: {strip: {EA: "=100*L", Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1}}
  Points: {foot: [0, 0, 0], top: ["=L", 0, "=h"]}
  Members: {rod: {Start: foot, End: top, Section: strip, Order: 3, Elements: "=n"}}
  Supports: {clamp: {Point: foot}}
  Point Loads: {push: {Point: top, Force: [0, "=-F", "=x('top')*0.01"]}}
Quantities: {sag: {Quantity: displacement, Point: top, Component: y, Limit: "=2*L"}}
Solver: {Load Path: {Maximum Step: "=1/4"}}
"""
# EA = 7e9 at (0.3, -0.2), where its principal axes are turned by cos = 0.8, EI = 5e7 and 6e8 about them; the reference point lies in the origin.
OF_VABS = """ Timoshenko Stiffness Matrix (1-extension; 2,3-shear, 4-twist; 5,6-bending)
 ======================================

 7000000000 0 0 0 -1400000000 -2100000000
 0 2360000000 -480000000 328000000 0 0
 0 -480000000 2640000000 696000000 0 0
 0 328000000 696000000 314400000 0 0
 -1400000000 0 0 0 528000000 156000000
 -2100000000 0 0 0 156000000 1032000000
"""


def values(text):
    """Names and values of a scene in XML; a whole number for a real is the same in YAML."""
    def value(entry):
        words = entry.get("value", "").strip("{}").split(",")
        try:
            return [float(word) for word in words]
        except ValueError:
            return [word.strip() for word in words]
    root = xml.etree.ElementTree.fromstring(text)
    return [(entry.get("name"), value(entry)) for entry in root.iter()]


class Convert(InFolder):
    def solved(self, scene, output):
        self.mixbeam("run", scene, "--quiet", "--threads", "1", "--output", output)
        name = str(scene).rsplit("/", 1)[-1].split(".", 1)[0]
        return self.contents(f"{output}/{name}.h5")

    def expect_resumed(self, name, found):
        self.mixbeam("resume", name, "--quiet", "--from", "1", "--threads", "1")
        self.assertEqual(differences(self.contents(name), found), [])

    def test_comments_names_and_digits_survive(self):
        self.write("rod.xml", COMMENTED)
        self.mixbeam("convert", "rod.xml", "rod.yaml")
        self.assertEqual(self.text("rod.yaml"), IN_YAML)
        self.expect(self.mixbeam("convert", "rod.yaml", "back.xml"), "warning: the comments of ", "rod.yaml are not in ")
        self.assertEqual(values(self.text("back.xml")), values(COMMENTED))
        self.assertNotEqual(values(changed(COMMENTED, "0.30000000000000004", "0.3")), values(COMMENTED))

    def test_sections_of_other_programs_bend_about_their_centre(self):
        """A force along a member through the reference point bends it about both axes of its centre: the moments 0.2 and 0.3 of 1 N give
        kappa_2 = 5.32e-9, kappa_3 = 4.24e-9, linear theory to P L^2 / EI = 2e-8."""
        for name in ("root.K", "tip.K"):
            self.write(name, OF_VABS)
        for sections, value, code in ((["root.K"], "-2.66e-9", 0), (["root.K", "tip.K"], "-2.66e-9", 0),
                                      (["root.K"], "-2.12e-9", 1)):  # as if axes 2 and 3 were exchanged
            self.expect(self.mixbeam("convert", *sections, "blade.yaml", "--force"), "note: the length is not in the file: the variable L is 1")
            self.write("loaded.yaml", self.text("blade.yaml") + f"""  Point Loads: {{pull: {{Point: tip, Force: [1, 0, 0]}}}}
Expected:
  up: {{Quantity: displacement, Point: tip, Component: z, Load Factor: 1, Relative Tolerance: 1e-6, Source: closed form, Value: {value}}}
""")
            self.mixbeam("run", "loaded.yaml", "--force", code=code)

    def test_sections_of_other_programs_are_imported(self):
        self.write("root.K", OF_VABS)
        self.write("scene.yaml", """Scene:
  Import: {Sections File: root.K}
  Points: {a: [0, 0, 0], b: [1, 0, 0]}
  Members: {rod: {Start: a, End: b, Section: root, Second Axis: [0, 1, 0]}}
  Supports: {a: {Point: a}}
  Point Loads: {pull: {Point: b, Force: [1, 0, 0]}}
Expected:
  side: {Quantity: displacement, Point: b, Component: y, Load Factor: 1, Relative Tolerance: 1e-6, Source: closed form, Value: 2.12e-9}
""")
        self.mixbeam("run", "scene.yaml")
        self.write("root.K", changed(OF_VABS, "-2100000000 0", "2100000000 0"))
        self.expect(self.mixbeam("check", "scene.yaml", code=BAD_INPUT), "root.K", "stiffness matrix is not symmetric")

    def test_what_it_would_change_is_refused(self):
        self.write("a.xml", COMMENTED)
        self.mixbeam("convert", "a.xml", "a.yaml")
        self.write("b.yaml", changed(self.text("a.yaml"), "Fixed Rotation: []}", "Point Loads: 1}"))
        self.write("c.yaml", changed(self.text("a.yaml"), "# bottom\n", 'Study: {words: ["a, b", c]}\n'))
        for words, *parts in ((("a.xml", "a.yaml"), "is there already", "--force"),
                              (("a.xml",), '1 files given to "convert"; allowed: two'),
                              (("a.xml", "a.json"), "unknown ending; allowed: .xml, .yaml, .yml"),
                              (("a.xml", "nowhere/b.yaml"), "nowhere"),
                              (("b.yaml", "b.xml"), "b.yaml:21:", "Point Loads", "unknown name"),
                              (("c.yaml", "c.xml"), "c.yaml:22:", "Study / words", "cannot be written to")):
            self.expect(self.mixbeam("convert", *words, code=BAD_INPUT), *parts)
        self.mixbeam("convert", "a.xml", "a.yaml", "--force")
        self.assertFalse((self.folder / "c.xml").exists())

    def test_runs_of_either_file_are_the_same_bits(self):
        scene = ROOT / "apps/gallery/snap_back.xml"
        self.mixbeam("convert", scene, "snap_back.yaml")
        found = self.solved("snap_back.yaml", "yaml")
        self.assertEqual(differences(self.solved(scene, "xml"), found), ["scene"])
        self.expect_resumed("yaml/snap_back.h5", found)

    def test_formulas_stay_formulas_and_count_as_their_numbers(self):
        """Those that one would type, in runs of either format, in resumed ones and in what they tell."""
        self.write("rod.yaml", FORMULAS)
        self.mixbeam("convert", "rod.yaml", "rod.xml")
        self.expect(self.text("rod.xml"), 'type="int" value="=n"', """type="Array(double)" value="{0, =-F, =x('top')*0.01}\"""")
        self.mixbeam("convert", "rod.xml", "back.yaml")
        self.expect(self.text("back.yaml"), """Force: [0, "=-F", "=x('top')*0.01"]""")
        typed = FORMULAS
        for formula, number in (('  Variables: {L: 2, slope: 30 deg, h: "=L*tan(slope)", n: "=5*L", F: "=1/L"}\n', ""), ('"=100*L"', "200"),
                                ('"=L"', "2"), ('"=h"', repr(2 * math.tan(30 * (math.pi / 180)))), ('"=n"', "10"), ('"=-F"', "-0.5"),
                                ("\"=x('top')*0.01\"", "0.02"), ('"=2*L"', "4"), ('"=1/4"', "0.25")):
            typed = changed(typed, formula, number)
        self.write("typed.yaml", typed)
        found = self.solved("rod.yaml", "yaml")
        self.assertEqual(differences(found, self.solved("rod.xml", "xml")), ["scene"])
        self.assertEqual(len(differences(found, self.solved("typed.yaml", "typed"))), 2)  # name of the scene, and its text
        self.expect_resumed("yaml/rod.h5", found)
        self.expect(self.mixbeam("check", "rod.yaml"), "variable L = 2\n", 'variable slope = 0.5235987756  ("30 deg")',
                    'variable n = 10  ("=5*L")')
        self.write("wrong.yaml", changed(FORMULAS, "=100*L", "=100*M"))
        self.expect(self.mixbeam("check", "wrong.yaml", code=BAD_INPUT), "wrong.yaml:3:", "Scene / Sections / strip / EA", "=100*M",
                    'unknown name "M"', '"L", "slope"')

    def test_a_batch_reads_yaml_and_its_table_beside_it(self):
        sweep = ROOT / "apps/batch/elastica_sweep.xml"
        shutil.copy(sweep.with_suffix(".csv"), self.folder)
        self.mixbeam("convert", sweep, "elastica_sweep.yaml")
        for scene, output in ((sweep, "xml"), ("elastica_sweep.yaml", "yaml")):
            self.mixbeam("batch", scene, "--quiet", "--threads", "1", "--output", output)
        table = self.text("xml/elastica_sweep-batch.csv")
        self.assertGreater(len(table), 100)
        self.assertEqual(self.text("yaml/elastica_sweep-batch.csv"), table)


if __name__ == "__main__":
    unittest.main()
