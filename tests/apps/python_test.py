#!/usr/bin/python3
"""The module for Python: the bits of the program, every parameter, the manners of a guest, forks, the examples of its page.

usage: python_test.py MIXBEAM PACKAGES     the program, and the folder in which the package mixbeam lies
"""

import ast
import copy
import doctest
import gc
import importlib.util
import multiprocessing
import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import textwrap
import threading
import time
import unittest
import unittest.mock
from pathlib import Path
from types import SimpleNamespace

if "MIXBEAM_PYTHON_TEST" not in os.environ:  # a process of multiprocessing has the words of its parent
    os.environ["MIXBEAM_PYTHON_TEST"] = os.pathsep.join(str(Path(sys.argv.pop(1)).resolve()) for _ in range(2))
PROGRAM, PACKAGES = os.environ["MIXBEAM_PYTHON_TEST"].split(os.pathsep)
SOURCES = Path(__file__).resolve().parents[2]
sys.path.insert(0, PACKAGES)
os.environ["PYTHONPATH"] = PACKAGES

import numpy as np  # noqa: E402

import mixbeam  # noqa: E402
from mixbeam.parameters import root  # noqa: E402

SCENES = sorted(SOURCES.glob("apps/*/*.xml"))
SECONDS = 120  # for what must not hang; it takes a second
FIELDS_OF_VTK = ("displacement", "spatial_force", "spatial_moment", "triad_1", "triad_2", "triad_3")
# Files hold the solver's own bits; components that are rotated anew round, and so do the arc lengths at which the solver is asked.
ASKED_ANEW = 1e-12


def cantilever(force=-10.0, elements=20):
    scene = mixbeam.Scene("cantilever")
    scene.sections["steel"] = mixbeam.Circle(diameter=4, E=206e3, nu=0.3)
    scene.points["wall"] = 0, 0, 0
    scene.points["tip"] = 1000, 0, 0
    scene.members["rod"] = mixbeam.Member(start="wall", end="tip", section="steel", elements=elements)
    scene.supports["clamp"] = mixbeam.Support(point="wall")
    scene.point_loads["weight"] = mixbeam.PointLoad(point="tip", force=(0, 0, force))
    return scene


def deflection(force):
    return mixbeam.run(cantilever(force)).displacement("tip")[2]


def loaded_frame():
    """A path of several steps, with a bifurcation."""
    scene = mixbeam.read(SOURCES / "apps/gallery/lees_frame.xml")
    scene.analysis.trace = True
    return scene


def large_run():
    """Takes long enough for something to happen meanwhile."""
    scene = cantilever(elements=20000)
    scene.solver.load_path.method = "fixed"
    scene.solver.load_path.steps = 200
    return mixbeam.run(scene, force=True)


def same_state(one, other):
    return list(one) == list(other) and all(np.array_equal(one[name], other[name]) for name in one)


def program(*words, folder):
    return subprocess.run([PROGRAM, *words], cwd=folder, capture_output=True, text=True, timeout=SECONDS)


def in_python(text, *words, helped=False):
    """What another Python prints that runs this text; `helped`: where it has this file at hand."""
    if helped:
        text = f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r}); import mixbeam, python_test\n" + textwrap.dedent(text)
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(text), *words], capture_output=True, text=True, timeout=SECONDS)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return done.stdout.strip()


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        self.folder = Path(folder.name)
        os.chdir(self.folder)


class Scenes(InFolder):
    def test_every_scene_is_the_same_list_when_it_was_written_and_read(self):
        self.assertGreater(len(SCENES), 30)
        for file in SCENES:
            scene = mixbeam.read(file)
            again = mixbeam.Scene.from_text(scene.to_xml(), file)
            self.assertEqual(scene, again, file)
            self.assertEqual(scene.name, again.name)
        again.units = "ell, lbf"
        self.assertNotEqual(scene, again)

    def test_scenes_in_yaml_are_the_same_lists(self):
        cantilever().write("cantilever.yaml")
        self.assertEqual(mixbeam.read("cantilever.yaml"), cantilever())
        self.assertTrue(same_state(mixbeam.run("cantilever.yaml").state(), mixbeam.run(cantilever()).state()))

    def test_messages_of_yaml_speak_of_its_maps_and_values(self):
        wrong = (("Scene: 3\n", r"^wrong.yaml:1:1: YAML path .Scene.: a value; allowed: a map "),
                 ("Analysis: {}\n", "missing map; needed: "),
                 ("Scene:\n  Points:\n    a: {x: 1}\n", "(?m)^wrong.yaml:3:5: .*: a map; allowed: one value per "),
                 ("Scene:\n  Sectoins: {}\n", "(?m)^wrong.yaml:2:.*: unknown name of a map; .*Sections"))
        for text, said in wrong:
            Path("wrong.yaml").write_text(text)
            with self.assertRaisesRegex(mixbeam.InputError, said) as raised:
                mixbeam.check("wrong.yaml")
            self.assertNotIn("Parameter", str(raised.exception))
        with self.assertRaisesRegex(mixbeam.InputError, "XML path .* a Parameter; allowed: a ParameterList"):
            mixbeam.check("<ParameterList name='x'><Parameter name='Scene' type='int' value='3'/></ParameterList>")

    def test_a_list_with_another_type_order_or_bit_differs(self):
        scene = cantilever()
        for change in (lambda s: s.point_loads["weight"].force.__setitem__(2, np.nextafter(-10, 0)),
                       lambda s: s.points.update(wall=s.points.pop("wall")),
                       lambda s: delattr(s.members["rod"], "elements")):
            other = scene.copy()
            self.assertEqual(scene, other)
            change(other)
            self.assertNotEqual(scene, other)

    def test_names_and_texts_of_any_letters(self):
        scene = mixbeam.Scene('<&"> \n\té')
        scene.units = " m\n,\"<é>'&"
        scene.points["a <b> & \"c\""] = 1e-300, -0.0, 5e-324
        again = mixbeam.Scene.from_text(scene.to_xml())
        self.assertEqual((scene.name, scene), (again.name, again))
        self.assertEqual(np.signbit(again.points["a <b> & \"c\""][1]), True)

    def test_every_declared_parameter_can_be_set_by_its_name(self):
        samples = {"bool": True, "int": 3, "double": 0.5, "string": "text", "Array(int)": [1, 2], "Array(double)": [1.5, 2.0, 3.0],
                   "Array(string)": ["a", "b"]}
        count = 0

        def visit(declaration, here):
            nonlocal count
            for name, xml in declaration.xml_names.items():
                if xml in declaration.lists:
                    visit(declaration.lists[xml], getattr(here, name))
                else:
                    value = samples[declaration.parameters[xml]["type"]]
                    setattr(here, name, value)
                    self.assertTrue(np.array_equal(getattr(here, name), value), (declaration.path, name))
                    self.assertTrue(np.array_equal(here[xml], value))
                    count += 1
            if declaration.free_parameter:
                here["own"] = samples[declaration.free_parameter["type"]]
                count += 1
            if declaration.free_list:
                here["own"] = {}
                visit(declaration.free_list, here["own"])

        scene = mixbeam.Scene()
        visit(root(), scene.scene._parent)
        declared = program("parameters", "--json", folder=self.folder).stdout
        self.assertEqual(count, len(re.findall(r'"type": ', declared)))
        stubs = ast.parse((Path(PACKAGES) / "mixbeam/__init__.pyi").read_text())
        typed = {node.target.id for node in ast.walk(stubs) if isinstance(node, ast.AnnAssign)}
        self.assertEqual(set(re.findall(r'"program_name": "(\w+)"', declared)) - typed, set())
        self.assertEqual(scene, mixbeam.Scene.from_text(scene.to_xml()))

    def test_types_are_checked_when_a_value_is_set(self):
        scene = cantilever()
        rod = scene.members["rod"]
        for name, value in (("elements", 2.5), ("elements", "3"), ("elements", True), ("section", 3), ("second_axis", "x"),
                            ("twist", "much"), ("curve", 3)):
            with self.assertRaises(mixbeam.InputError, msg=name):
                setattr(rod, name, value)
        rod.elements = np.int64(7)
        self.assertIs(type(rod.elements), int)
        rod.elements = None
        self.assertEqual(rod.elements, 1)

    def test_what_no_file_can_hold_is_refused_in_the_words_of_python(self):
        scene = cantilever()
        rod = scene.members["rod"]
        for name, value in (("section", "a\0"), ("section", "\ud800"), ("elements", 2**31), ("elements", 10**400)):
            with self.assertRaisesRegex(mixbeam.InputError, f"^Scene / Members / rod / {name.capitalize()}: .*; allowed: "):
                setattr(rod, name, value)
        for name in ("", " ", "a\x01"):
            with self.assertRaisesRegex(mixbeam.InputError, "^Scene / Points: name '.*'; allowed: names"):
                scene.points[name] = 0, 0, 1
        scene.name = "a\x01"
        with self.assertRaisesRegex(mixbeam.InputError, "^name of a scene: "):
            mixbeam.run(scene)

    def test_formulas_are_kept_and_count(self):
        scene = cantilever()
        scene.variables["L"], scene.variables["F"], scene.variables["a"] = 1000, "=L/100", "30 deg"
        scene.points["tip"] = "=L", 0, "=L*0"
        scene.members["rod"].elements = "=L/50"
        scene.point_loads["weight"].force = [0, 0, "=-F"]
        for file in ("formulas.yaml", "formulas.xml"):
            scene.write(file)
            again = mixbeam.read(file)
            self.assertEqual(again, scene)
            self.assertEqual(again.members["rod"].elements, "=L/50")
            self.assertEqual(again.points["tip"], ["=L", 0.0, "=L*0"])
            self.assertEqual(again.variables["a"], "30 deg")
        self.assertEqual(mixbeam.run(scene).displacement("tip")[2], deflection(-10.0))
        self.assertNotEqual(mixbeam.run(scene).displacement("tip")[2], deflection(-10.001))
        table = mixbeam.batch(scene, {"variables/F": [10.0, 20.0]})
        self.assertEqual(len(table), 2)
        with self.assertRaises(mixbeam.InputError):
            scene.point_loads["weight"].force = [0, 0, "F"]
        scene.point_loads["weight"].force = [0, 0, "=-G"]
        with self.assertRaisesRegex(mixbeam.InputError, 'Force.*unknown name "G"'):
            mixbeam.run(scene)

    def test_shapes_are_those_of_sections(self):
        """What Drawn As calls rectangle and ellipse has no material."""
        scene = cantilever()
        for shape, area in (mixbeam.Rectangle, 8.0), (mixbeam.Ellipse, 2 * np.pi):
            scene.sections["steel"] = shape(width=2, height=4, E=206e3, nu=0.3)
            self.assertAlmostEqual(mixbeam.run(scene).sections()["steel"][0, 0] / 206e3, area)
        scene.point_masses["body"] = mixbeam.PointMass(point="tip", mass=1)
        self.assertTrue(mixbeam.check(scene))

    def test_unknown_names_tell_the_nearest(self):
        scene = cantilever()
        run = mixbeam.run(scene)
        for wrong, near in ((lambda: setattr(scene.members["rod"], "elments", 3), "elements"),
                            (lambda: scene.members["rod"].__setitem__("elments", None), "elements"),
                            (lambda: scene.pionts, "points"), (lambda: scene.analysis.stabilty, "stability"),
                            (lambda: mixbeam.Circle(diametr=3), "diameter"), (lambda: mixbeam.Membr, "Member"),
                            (lambda: scene.members["rad"], "rod"), (lambda: run.displacment("tip"), "displacement"),
                            (lambda: run.displacement("tp"), "tip"), (lambda: run.member("rad"), "rod"),
                            (lambda: run.member("rod").moments(0), "moment"), (lambda: run.plot("shap"), "shape"),
                            (lambda: mixbeam.batch(scene, {"point_loads/weigth/force[2]": [1.0]}), "weight")):
            with self.assertRaisesRegex(mixbeam.InputError, f"did you mean .{near}"):
                wrong()
        with self.assertRaisesRegex(mixbeam.InputError, r"mixbeam.run\(scene\)"):
            scene.run()

    def test_nothing_takes_the_place_of_another(self):
        scene, line = cantilever(), np.zeros((2, 3))
        names = scene.add_points("p", line)
        scene.add_points("q", line)
        rods = scene.add_members("r", names[:1], names[1:])
        for again, name in ((lambda: scene.add_points("p", line), "p0"), (lambda: scene.add_members("r", names[1:], names[:1]), rods[0])):
            with self.assertRaisesRegex(mixbeam.InputError, f'"{name}" for the second time'):
                again()
        for wrong in np.nan, None:
            with self.assertRaisesRegex(mixbeam.InputError, 'column "variables/F", row 1 from 0: nan; allowed: a number'):
                mixbeam.batch(scene, {"variables/F": [10.0, wrong]})

    def test_members_from_arrays(self):
        """One hub and three points; vectors for all and for each."""
        scene, axes = cantilever(), np.eye(3)
        spokes = scene.add_points("p", axes)
        scene.add_members("all", "wall", spokes, second_axis=axes[2], elements=[1, 2, 3], section="steel")
        scene.add_members("each", "wall", list(spokes), second_axis=axes)
        for i in range(3):
            one, other = scene.members[f"all{i}"], scene.members[f"each{i}"]
            self.assertEqual((one.start, one.end, one.elements, one.section), ("wall", f"p{i}", i + 1, "steel"))
            self.assertEqual((one.second_axis.tolist(), other.second_axis.tolist()), (axes[2].tolist(), axes[i].tolist()))
        for wrong in dict(end=spokes[:2]), dict(end=spokes, elements=[1, 2]):
            with self.assertRaisesRegex(mixbeam.InputError, "^members m: arrays that do not fit"):
                scene.add_members("m", spokes, **wrong)

    def test_entries_are_copied(self):
        rod = cantilever().members["rod"]
        rod.curve = dict(shape="arc", rise=1)
        for same in copy.copy(rod), copy.deepcopy(rod), pickle.loads(pickle.dumps(rod)):
            self.assertEqual(same, rod)
            same.curve.rise = 2
            self.assertEqual(rod.curve.rise, 1)

    def test_messages_are_those_of_the_program(self):
        scene = cantilever()
        scene.members["rod"].section = "stel"
        scene.write("bad.xml")
        said = program("run", "bad.xml", folder=self.folder)
        self.assertEqual(said.returncode, 2)
        with self.assertRaises(mixbeam.InputError) as raised:
            mixbeam.run("bad.xml")
        self.assertEqual(said.stderr.strip(), f"mixbeam: bad input: {raised.exception}")

    def test_messages_of_scenes_made_here_name_no_lines(self):
        scene = cantilever()
        scene.members["rod"].section = "stel"
        for use in (mixbeam.run, mixbeam.check, lambda s: mixbeam.batch(s, {"point_loads/weight/force[2]": [1.0]})):
            with self.assertRaisesRegex(mixbeam.InputError, '^scene cantilever: "Scene / Members / rod / Section": '):
                use(scene)


class Bits(InFolder):
    def test_runs_have_the_bits_of_the_program(self):
        for file in SOURCES.glob("apps/gallery/*.xml"):
            if file.stem not in ("elastica", "lees_frame", "follower_cantilever", "portal_frame", "twisted_blade", "star_dome", "honeycomb"):
                continue
            scene = mixbeam.read(file)
            case = (scene.load_cases or [None])[0]
            words = [] if case is None else ["--case", case]
            self.assertEqual(program("run", str(file), "--output", "out", "--quiet", *words, folder=self.folder).returncode, 0)
            stored = mixbeam.open(f"out/{file.stem}{'' if case is None else '-' + case}.h5")
            run = mixbeam.run(scene, case)
            self.assertTrue(run.passed, file)
            self.assertTrue(np.array_equal(run.load_factors, stored.load_factors), file)
            for step in range(len(run)):
                self.assertTrue(same_state(run.state(step), stored.state(step)), (file, step))
            self.assertFalse(same_state(run.state(-1), run.state(0)))

    def test_motions_have_the_columns_of_the_program(self):
        import h5py
        run = mixbeam.run(mixbeam.read(SOURCES / "apps/gallery/rotor_blade.yaml"), output="blade.h5")
        with h5py.File("blade.h5", "r") as file:
            load_factors, omega = file["frequencies/load_factor"][:], file["frequencies/omega"][:]
        factors, followed = run.frequencies(run.scene.analysis.modes.number, follow=True)
        at = [list(factors).index(factor) for factor in load_factors]
        self.assertTrue(np.array_equal(followed[at], omega, equal_nan=True))

    def test_a_scene_made_here_has_the_bits_of_its_file(self):
        cantilever().write("cantilever.xml")
        self.assertEqual(program("run", "cantilever.xml", "--output", ".", "--quiet", folder=self.folder).returncode, 0)
        run, stored = mixbeam.run(cantilever()), mixbeam.open("cantilever.h5")
        self.assertTrue(same_state(run.state(), stored.state()))
        self.assertFalse(same_state(run.state(), mixbeam.run(cantilever(-10.000000001)).state()))
        for ask in (lambda r: r.displacement("tip"), lambda r: r.member("rod").moment([0.0, 333.3, 1000.0]),
                    lambda r: r.reaction_moment("wall"), lambda r: r.strain_energy(), lambda r: r.spatial_force("rod@250")):
            self.assertTrue(np.array_equal(ask(run), ask(stored)))

    def test_a_file_written_afterwards_holds_what_the_program_writes(self):
        import h5py
        scene = loaded_frame()
        scene.quantities["at corner"] = dict(quantity="displacement", point="corner")
        scene.write("frame.xml")
        self.assertEqual(program("run", "frame.xml", "--output", ".", "--quiet", folder=self.folder).returncode, 0)
        run = mixbeam.run(mixbeam.read("frame.xml"))
        run.write("afterwards.h5")
        with h5py.File("frame.h5") as one, h5py.File("afterwards.h5") as other:
            names, others = [], []
            one.visit(names.append)
            other.visit(others.append)
            self.assertEqual(names, others)
            for name in names:
                if isinstance(one[name], h5py.Dataset) and name not in ("scene", "version"):
                    self.assertEqual(one[name][()].tobytes(), other[name][()].tobytes(), name)
        self.assertEqual(len(run.critical_points), len(mixbeam.open("afterwards.h5").critical_points))
        self.assertTrue(np.array_equal(run.critical_points[0].mode, mixbeam.open("frame.h5").critical_points[0].mode))

        mixbeam.open("frame.h5").write("again.h5")
        with h5py.File("frame.h5") as one, h5py.File("again.h5") as again:
            for name in ("monitor/residual", "monitor/newton_iterations"):
                self.assertTrue(np.array_equal(one[name], again[name], equal_nan=True), name)
        self.assertEqual([point.load_factor for point in mixbeam.open("again.h5").critical_points],
                         [point.load_factor for point in run.critical_points])

    def test_each_step_counts_its_jumps(self):
        run = mixbeam.run(SOURCES / "apps/gallery/snapping_arch.xml", output="arch.h5")
        for one in (run, mixbeam.open("arch.h5")):
            self.assertEqual((one.jumps(step=0), one.jumps()), (0, 1))

    def test_a_run_that_was_stopped_goes_on_with_the_same_bits(self):
        scene = loaded_frame()
        whole = mixbeam.run(scene)
        part = mixbeam.run(scene, output="part.h5", on_step=lambda run: len(run) == 3)
        self.assertTrue(part.interrupted)
        self.assertLess(len(part), len(whole))
        resumed = mixbeam.resume("part.h5")
        self.assertFalse(resumed.interrupted)
        self.assertTrue(np.array_equal(resumed.load_factors, whole.load_factors))
        self.assertTrue(same_state(resumed.state(), whole.state()))

    def test_tables_of_what_acts_compare_equal_with_themselves(self):
        import h5py
        scene = cantilever()
        scene.point_loads["late"] = dict(point="tip", force=(0, 0, 1), amplitude="max(t - 0.5, 0)")
        mixbeam.run(scene, output="late.h5")
        with h5py.File("late.h5") as file:
            self.assertEqual(list(file["acting/point_loads/begins"][()].ravel()), [0, -1])  # a formula may say anything: not NaN

    def test_a_batch_has_the_bits_of_the_program(self):
        import h5py
        scene = mixbeam.read(SOURCES / "apps/batch/elastica_sweep.xml")
        done = program("batch", str(SOURCES / "apps/batch/elastica_sweep.xml"), "--output", ".", "--quiet", folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        theirs = {}
        with h5py.File("elastica_sweep-batch.h5") as file:
            file["columns"].visititems(lambda name, column: theirs.update({name: column[()]} if hasattr(column, "shape") else {}))
        ours = mixbeam.batch(scene, {name: theirs[name] for name in theirs if "/" in name}, output="expected")
        compared = [name for name in theirs if name not in ("case", "stable")]
        self.assertGreater(len(compared), 9)
        for name in compared:
            self.assertTrue(np.array_equal(theirs[name], ours[name], equal_nan=True), name)
        nudged = {name: theirs[name] * (1 + 1e-15) for name in theirs if "Force" in name}
        self.assertFalse(np.array_equal(mixbeam.batch(scene, nudged, output="expected")["tip turns"], ours["tip turns"]))

    def test_a_batch_of_scenes(self):
        ends = {"elastica": "tip", "follower_cantilever": "nozzle"}
        table = mixbeam.batch(mixbeam.read(SOURCES / f"apps/gallery/{name}.xml") for name in ends)
        self.assertEqual(len(table), 2)
        self.assertTrue(table["converged"].all())
        for row, (name, end) in enumerate(ends.items()):
            run = mixbeam.run(SOURCES / f"apps/gallery/{name}.xml")
            self.assertEqual(table[f"{end}.displacement.x"][row], run.displacement(end)[0])
            self.assertTrue(np.isnan(table[f"{end}.displacement.x"][1 - row]))
        for wrong in (lambda: mixbeam.batch("scene.xml"), lambda: mixbeam.batch([mixbeam.Scene("empty")]), lambda: mixbeam.run(5)):
            self.assertRaises(mixbeam.InputError, wrong)
        with self.assertRaisesRegex(mixbeam.InputError, "^scene 2 of the batch: scene: 5; allowed"):
            mixbeam.batch([cantilever(elements=1), 5])

    def test_workers_of_dask_share_a_batch(self):
        try:
            import distributed
        except ImportError:
            if os.environ.get("CI"):
                raise
            self.skipTest("python3-distributed is not installed")
        table = {"point_loads/weight/force[1]": -np.linspace(1, 10, 23)}
        scene = mixbeam.read(SOURCES / "apps/batch/elastica_sweep.xml")
        with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, \
                distributed.Client(cluster) as client:
            shared = mixbeam.batch(scene, table, output="expected", client=client)
            for wrong, said in (("point_loads/nowhere/force[1]", "nowhere"), ("members/strip/elements", "^case 23: ")):
                with self.assertRaisesRegex(mixbeam.InputError, said):
                    mixbeam.batch(scene, {wrong: [4] * 22 + [4.5]}, client=client)
        alone = mixbeam.batch(scene, table, output="expected")
        self.assertEqual(shared.dtype.names, alone.dtype.names)
        self.assertTrue(shared["converged"].all())
        for name in ("tip moves back", "tip moves down", "tip turns"):  # other groups: rounding, not bits
            np.testing.assert_allclose(shared[name], alone[name], rtol=1e-11)
        self.assertFalse(np.allclose(shared["tip turns"], alone["tip turns"][::-1], rtol=1e-11))

    def test_a_scene_with_an_accuracy_is_opened_on_the_mesh_that_was_chosen(self):
        scene = cantilever()
        scene.members["rod"].elements = None
        scene.accuracy = 1e-8
        run = mixbeam.run(scene, output="accurate.h5")
        stored = mixbeam.open("accurate.h5")
        self.assertGreater(stored.member("rod").order * stored.member("rod").elements, 2)
        self.assertTrue(same_state(stored.state(), run.state()))
        self.assertTrue(same_state(mixbeam.run(scene).state(), run.state()))
        with self.assertRaisesRegex(mixbeam.InputError, "accuracy"):
            mixbeam.resume("accurate.h5")

    def test_a_forged_mesh_is_refused_before_it_is_made(self):
        import h5py
        scene = cantilever()
        scene.members["rod"].elements = None
        scene.accuracy = 1e-4
        mixbeam.run(scene, output="honest.h5")
        huge = 2 ** 31 - 1  # its vertices alone would take 100 GB
        for name, number in (("order", 0), ("order", -1), ("order", huge), ("elements", 0), ("elements", -1), ("elements", huge), (None, 0)):
            shutil.copy("honest.h5", "forged.h5")
            with h5py.File("forged.h5", "r+") as file:
                file.attrs.modify("format_version", np.int32(2))  # of which files have no seal
                if name:
                    file["members"][name][...] = number
            if not name:
                mixbeam.open("forged.h5")
                continue
            with self.assertRaisesRegex(mixbeam.InputError, "forged.h5.*(members are not those|numbers are inconsistent)", msg=(name, number)):
                mixbeam.open("forged.h5")


class Runs(InFolder):
    def test_no_convergence_is_an_exception_with_the_path_so_far(self):
        scene = cantilever()
        scene.point_loads["weight"].force = -20.0, 0, 0  # three times the buckling load: not in one step
        scene.solver.load_path.maximum_steps = 1
        with self.assertRaises(mixbeam.ConvergenceError) as raised:
            mixbeam.run(scene)
        self.assertGreaterEqual(len(raised.exception.run), 1)
        self.assertEqual(os.listdir(), [])

    def test_an_exception_of_the_callback_ends_the_run(self):
        def fail(run):
            raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            mixbeam.run(cantilever(), on_step=fail)

    def test_a_callback_may_solve_another_scene(self):
        inner = []
        run = mixbeam.run(cantilever(), on_step=lambda run: inner.append(deflection(-1.0)))
        self.assertEqual(len(inner), len(run))
        self.assertTrue(same_state(run.state(), mixbeam.run(cantilever()).state()))

    def test_control_c_stops_a_run(self):
        said = in_python("""
            import os, signal, threading, time
            threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT)).start()
            start = time.monotonic()
            try:
                python_test.large_run()
                print("not stopped")
            except KeyboardInterrupt:
                print("stopped" if time.monotonic() - start < 20.0 else "late")
            print(python_test.deflection(-10.0) < 0.0)
            """, helped=True)
        self.assertEqual(said.split(), ["stopped", "True"])

    def test_other_threads_go_on_and_may_drop_runs(self):
        want, found, steps = deflection(-10.0), [], 0

        def work():
            for _ in range(10):
                found.append(deflection(-10.0))
                gc.collect()

        threads = [threading.Thread(target=work) for _ in range(3)]
        for thread in threads:
            thread.start()
        while any(thread.is_alive() for thread in threads):
            steps += 1
            time.sleep(0.001)
        self.assertEqual(found, [want] * 30)
        self.assertGreater(steps, 10)

    def test_quantities_of_a_scene_by_name(self):
        scene = cantilever()
        scene.quantities["drop"] = dict(quantity="displacement", point="tip", component="z")
        scene.quantities["most"] = dict(quantity="material moment", member="rod", component="norm", take="largest")
        run = mixbeam.run(scene)
        values = run.quantities()
        self.assertEqual(values["drop"], run.displacement("tip")[2])
        self.assertEqual((values["most"].member, values["most"].arc_length), ("rod", 0.0))
        self.assertEqual(run.quantities(step=None)["drop"].shape, (len(run),))
        self.assertEqual(run.quantities(step=None)["most"].member[-1], "rod")
        errors = run.value_errors()
        self.assertEqual(errors["drop"][1], values["drop"])
        self.assertIn("largest von Mises stress", errors)
        kept = run.results.steps[-1].errors("quantities")
        self.assertEqual(list(kept), ["drop", "most"])  # values, no places
        for name, (value, error) in kept.items():  # two solutions of the richer space: 1e-4 of what they differ by
            np.testing.assert_allclose((error, value), errors[name], rtol=1e-4)
        self.assertEqual(run.results.steps[0].errors("quantities"), {})  # the end of the path alone, and files without

    def test_names_of_quantities_may_begin_with_others(self):
        scene, drop = cantilever(elements=2), dict(quantity="displacement", point="tip", component="z")
        for name in ("a", "a.b", "a[x]"):
            scene.quantities[name] = drop
        scene.quantities["all"] = dict(quantity="displacement", point="*")
        scene.quantities["all[tip]"] = drop
        values = mixbeam.run(scene).quantities()
        self.assertEqual([values[name] for name in ("a.b", "a[x]", "all[tip]")], [values["a"]] * 3)
        self.assertEqual(values["all"]["tip"].shape, (3,))
        self.assertEqual(values["all"]["tip"][2], values["a"])

    def test_no_places_have_no_values(self):
        rod = mixbeam.run(cantilever(elements=2)).member("rod")
        self.assertEqual((rod.stress([]).shape, rod.moment([]).shape), ((0,), (0, 3)))

    def test_a_scene_of_a_file_in_yaml_is_looked_for(self):
        scene = cantilever()
        scene.quantities["drop"] = dict(quantity="displacement", point="tip", component="z")
        drop = mixbeam.run(scene).quantities()["drop"]
        scene.point_loads["weight"].force = 0, 0, -7
        scene.identification = dict(parameters=dict(force=dict(number="Point Loads/weight/Force[2]")),
                                    measurements=dict(drop=dict(quantity="drop", value=drop, standard_deviation=1.0)))
        scene.write("scene.yaml")
        self.assertAlmostEqual(mixbeam.run(mixbeam.read("scene.yaml")).found["force"].value, -10.0, places=8)
        with self.assertRaisesRegex(mixbeam.InputError, "mixbeam run"):
            mixbeam.batch(scene, {"point_loads/weight/force[2]": [-7, -8]})

    def test_flutter_is_judged_by_modes(self):
        scene = cantilever()
        scene.sections["steel"].material.density = 7.85e-9
        scene.point_loads["weight"] = dict(point="tip", force=(-80, 0, 0), frame="follower", member="rod")  # 31 EI / L^2
        self.assertEqual(list(mixbeam.run(scene).stable), ["true", "unknown"])
        scene.analysis.modes = dict(number=4)
        self.assertEqual(list(mixbeam.run(scene).stable), ["true", "false"])


class Guest(InFolder):
    def test_tables_and_notebooks(self):
        scene = cantilever()
        scene.quantities["sag"] = dict(quantity="displacement", point="tip", component="z")
        scene.quantities["most <b>"] = dict(quantity="von Mises stress", member="*", take="largest")
        run = mixbeam.run(scene)
        with unittest.mock.patch.dict(sys.modules, pandas=None), self.assertRaisesRegex(mixbeam.InputError, "python3-pandas"):
            run.to_dataframe()
        made = []
        frame = SimpleNamespace(DataFrame=lambda columns, index: made.append((columns, index)) or unittest.mock.MagicMock())
        with unittest.mock.patch.dict(sys.modules, pandas=frame):
            run.to_dataframe()
        (columns, index), = made
        self.assertEqual(list(index), list(run.step_numbers))
        np.testing.assert_array_equal(columns["sag"], run.displacement("tip", step=None)[:, 2])
        self.assertEqual(columns["most <b>.member"][-1], run.quantities()["most <b>"].member)
        text = run._repr_html_()
        self.assertIn("most &lt;b&gt;", text)
        self.assertNotIn("most <b>", text)
        self.assertIn("<td>Members</td><td>1</td>", scene._repr_html_())

    def test_without_matplotlib(self):
        run = mixbeam.run(cantilever(), output="run.h5")
        with unittest.mock.patch.dict(sys.modules, {"matplotlib": None, "matplotlib.pyplot": None}):
            self.assertEqual(run.critical_points, [])
            with self.assertRaisesRegex(mixbeam.InputError, "python3-matplotlib"):
                run.plot()

    def test_the_host_stays_as_it_was(self):
        said = in_python("""
            import os, sys, ctypes
            terminate = ctypes.CDLL("libstdc++.so.6")._ZSt13get_terminatev
            terminate.restype = ctypes.c_void_p
            at_first = terminate()
            import mixbeam.scene
            of_the_c_library = 3 << 31  # signals 32 and 33, which it uses for its threads
            def handled():
                lines = [line.split() for line in open("/proc/self/status")]
                return [int(line[1], 16) & ~of_the_c_library for line in lines if line[0] in ("SigCgt:", "SigIgn:", "SigBlk:")]
            libc = ctypes.CDLL(None)
            env = ctypes.POINTER(ctypes.c_char_p).in_dll(libc, "environ")
            def variables():
                found, i = [], 0
                while env[i]:
                    found.append(env[i]); i += 1
                return sorted(found)
            before = handled(), variables(), os.listdir("/dev/shm"), os.listdir()
            exec(open(sys.argv[1]).read().split("def cantilever")[1].join(["def cantilever", ""]).split("def deflection")[0])
            run = mixbeam.run(cantilever())
            assert run.passed and terminate() == at_first
            print(before == (handled(), variables(), os.listdir("/dev/shm"), os.listdir()))
            """, __file__)
        self.assertEqual(said, "True")  # and nothing else was printed

    def test_the_heap_keeps_blocks_during_a_large_run_and_returns_them_after_it(self):
        """No page is fetched twice (0.3 faults for each small page of the peak with large pages; 1.6 if blocks are returned)."""
        said = in_python("""
            import numpy as np, os, resource
            page = os.sysconf("SC_PAGESIZE")
            def resident(): return int(open("/proc/self/statm").read().split()[1]) * page
            def peak(): return [int(line.split()[1]) * 1024 for line in open("/proc/self/status") if line.startswith("VmHWM")][0]
            def faults(): return resource.getrusage(resource.RUSAGE_SELF).ru_minflt
            mixbeam.run(python_test.cantilever())
            before = faults(), peak()
            run = mixbeam.run(python_test.cantilever(elements=20000))
            share = (faults() - before[0]) * page / (peak() - before[1])
            free = resident()
            block = np.ones(10_000_000)
            held = resident()
            del block
            print(share < 1.25, held - free > 7e7, resident() - free < 1e7)
            """, helped=True)
        self.assertEqual(said, "True True True")

    def test_under_mpirun_it_refuses_to_be_several(self):
        with self.assertRaisesRegex(AssertionError, "mpirun"):
            in_python("""
                import os
                os.environ["OMPI_COMM_WORLD_SIZE"] = "2"
                import mixbeam
                mixbeam.check("<ParameterList name='x'/>")
                """)

    def test_h5py_before_and_after(self):
        for order in ("h5py, mixbeam", "mixbeam, h5py"):
            said = in_python(f"""
                import {order}
                import sys
                sys.path.insert(0, {str(Path(__file__).parent)!r})
                import python_test
                with h5py.File("before.h5", "w") as file: file["x"] = [1.0, 2.0]
                run = mixbeam.run(python_test.cantilever(), output="run.h5")
                with h5py.File("before.h5") as file: assert file["x"][1] == 2.0
                with h5py.File("run.h5") as file: assert len(file["steps"]) == len(run)
                print(h5py.version.hdf5_version != "", len(mixbeam.open("run.h5")) == len(run))
                """)
            self.assertEqual(said, "True True")

    def test_a_run_knows_its_file(self):
        """Numbers of another run that has replaced the file are no answer; a file that is touched by nobody is one."""
        said = in_python("""
            run = mixbeam.run(python_test.cantilever(), output="run.h5")
            opened = mixbeam.open("run.h5")
            told = [bool(abs(opened.displacement("tip")[2] - run.displacement("tip")[2]) < 1e-9), len(run.results.steps) == len(run)]
            mixbeam.run(python_test.cantilever(), output="run.h5")
            for ask in (lambda: opened.displacement("tip"), lambda: opened.results, lambda: run.results, lambda: run.plot("shape")):
                try: told.append(bool(ask()))
                except mixbeam.InputError as error: told.append("run.h5" in str(error))
            print(*told, run.displacement("tip").shape)
            """, helped=True)
        self.assertEqual(said, "True True True True True True (3,)")

    def test_a_daemon_thread_in_a_run_at_the_end(self):
        said = in_python("""
            import threading, time
            scene = python_test.cantilever()
            threads = [threading.Thread(target=lambda: [mixbeam.run(scene) for _ in range(100000)], daemon=True) for _ in range(2)]
            [thread.start() for thread in threads]
            time.sleep(0.5)
            print("ends")
            """, helped=True)
        self.assertEqual(said, "ends")  # and with exit code 0, which in_python asserts

    def test_processes_after_a_run_work(self):
        want = [deflection(-force) for force in (1.0, 2.0, 3.0)]
        for method in ("fork", "spawn", "forkserver"):
            with multiprocessing.get_context(method).Pool(2) as pool:
                found = pool.map_async(deflection, (-1.0, -2.0, -3.0)).get(SECONDS)
            self.assertEqual(found, want, method)

    def test_a_child_works_on_one_thread_where_the_parent_had_several(self):
        scene = cantilever(elements=3000)
        scene.solver.threads = 2
        want = mixbeam.run(scene).displacement("tip")
        with multiprocessing.get_context("fork").Pool(1) as pool:
            found = pool.map_async(_solved, [scene]).get(SECONDS)[0]
        self.assertTrue(np.array_equal(found, want))

    def test_a_structure_is_asked_on_as_many_threads_as_it_was_solved_with(self):
        said = in_python(f"""
            import os, sys
            os.environ.pop("OMP_NUM_THREADS", None)
            sys.path.insert(0, {str(Path(__file__).parent)!r})
            import mixbeam, python_test
            def threads(): return len(os.listdir("/proc/self/task"))
            scene, before = python_test.cantilever(), threads()
            mixbeam.run(scene).reaction_force("wall")
            small = threads() - before
            scene.solver.threads = 2
            mixbeam.run(scene).reaction_force("wall")
            print(small, threads() - before)
            """)
        self.assertEqual(said, "0 1")

    def test_a_fork_while_a_thread_is_in_a_run_raises_in_the_child(self):
        inside, leave = threading.Event(), threading.Event()

        def hold(run):
            inside.set()
            leave.wait(SECONDS)

        thread = threading.Thread(target=lambda: mixbeam.run(cantilever(), on_step=hold))
        thread.start()
        inside.wait(SECONDS)
        child = os.fork()
        if child == 0:
            signal.alarm(SECONDS)
            try:
                deflection(-1.0)
                os._exit(1)
            except RuntimeError:
                os._exit(7)
        leave.set()
        thread.join()
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 7)
        self.assertLess(deflection(-1.0), 0.0)

    def test_an_environment_without_network(self):
        subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", "--without-pip", "own"], check=True)
        python = "own/bin/python"
        subprocess.run([python, "-m", "mixbeam.install"], check=True, capture_output=True)
        clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        said = subprocess.run([python, "-c", "import mixbeam; print(mixbeam.__file__, mixbeam.Scene().analysis.stresses)"],
                              env=clean, capture_output=True, text=True)
        self.assertIn(str(self.folder / "own"), said.stdout, said.stderr)
        self.assertIn("auto", said.stdout)


def vtk_readers():
    """VTK's XDMF readers; Debian's python3-vtk9 is built without them, ParaView's VTK and most others have them."""
    found = (("vtkIOXdmf2", "vtkXdmfReader"), ("vtkIOXdmf3", "vtkXdmf3Reader"))
    return [getattr(importlib.import_module(f"vtkmodules.{module}"), name) for module, name in found
            if importlib.util.find_spec("vtkmodules") and importlib.util.find_spec(f"vtkmodules.{module}")]


def read_by_vtk(reader, file):
    """{time: (points, columns)} of a series: the positions, then FIELDS_OF_VTK."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline

    reader.SetFileName(file)
    reader.UpdateInformation()
    series = {}
    for time in reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS()):
        reader.UpdateTimeStep(time)
        grid = reader.GetOutputDataObject(0)
        while grid.IsA("vtkMultiBlockDataSet"):
            grid = grid.GetBlock(0)
        arrays = [grid.GetPoints().GetData(), *map(grid.GetPointData().GetArray, FIELDS_OF_VTK)]
        series[time] = np.hstack([vtk_to_numpy(array) for array in arrays])
    return series


def solver_has(run, step):
    """The same of a step of a run, from its states."""
    parts = []
    for member in run.results.members:
        ends = np.append(np.diff(member.element) > 0, False)[:, None]  # an end of an element, where the next one begins
        at = lambda name: np.where(ends, run.member(member.name).field(name, member.arc_length, step, before_vertex=True),
                                   run.member(member.name).field(name, member.arc_length, step))
        w, vector = at("triad")[:, :1], at("triad")[:, 1:]
        turned = lambda v: v + 2 * np.cross(vector, np.cross(vector, v) + w * v)
        parts.append(np.hstack([at("position"), at("displacement"), turned(at("material_force")), turned(at("material_moment")),
                                *(turned(np.tile(axis, (len(ends), 1))) for axis in np.eye(3))]))
    return np.vstack(parts)


class Vtk(InFolder):
    def test_reads_the_time_series_as_the_solver_has_it(self):
        readers = vtk_readers()
        if not readers:
            self.assertFalse(os.environ.get("CI") and not os.environ.get("MIXBEAM_TOOLS_MISSING"))
            self.skipTest("no VTK with an XDMF reader (Debian: python3-paraview)")
        run = mixbeam.run(SOURCES / "apps/fork/fork.xml", output="fork.h5")
        for reader in readers:
            series = read_by_vtk(reader(), str(self.folder / "fork.xdmf"))
            self.assertEqual(list(series), list(run.step_numbers))
            for step, (_, found) in enumerate(series.items()):
                meant = solver_has(run, step)
                scale = np.maximum(np.abs(meant).max(axis=0), 1.0)
                np.testing.assert_allclose(found / scale, meant / scale, rtol=0, atol=ASKED_ANEW)
            self.assertGreater(np.abs(found - solver_has(run, 1)).max(), 1e-3)  # the twin: another step


class Studies(InFolder):
    def test_a_mirrored_end_is_wrong(self):
        """The judge of random paths: a column beyond its load that has bent to the other side."""
        sys.path[:0] = [str(SOURCES / "apps" / "extremes"), str(SOURCES / "apps" / "common" / "studies")]
        from judged_path import is_same_end
        ends = []
        for across in (0.3, -0.3):
            scene = cantilever(across)
            scene.point_loads["thrust"] = mixbeam.PointLoad(point="tip", force=(-10.0, 0, 0))
            run = mixbeam.run(scene)
            ends.append(SimpleNamespace(displacements=[run.displacement("tip")]))
        self.assertTrue(is_same_end(scene, ends[0], ends[0]))
        self.assertFalse(is_same_end(scene, *ends))


class Pictures(InFolder):
    def test_pages_inline(self):
        """Of a run, of a scene, and of one that check refuses."""
        loose = cantilever()
        del loose.supports["clamp"]
        for page in mixbeam.run(cantilever()).view(), cantilever().view(), loose.view():
            self.assertTrue(page._repr_html_().startswith("<iframe"))
            self.assertIn("srcdoc=\"&lt;!doctype html&gt;", page._repr_html_())
            page.save("page.html")
            self.assertGreater(Path("page.html").stat().st_size, 20000)
        with self.assertRaisesRegex(mixbeam.InputError, "missing ParameterList"):
            mixbeam.Scene("empty").view()

    def test_pictures_leave_matplotlib_as_it_was(self):
        import matplotlib
        before, modules = dict(matplotlib.rcParams), set(sys.modules)
        run = mixbeam.run(loaded_frame())
        for kind in ("shape", "section_forces", "load_path", "critical_modes", "iterations"):
            picture = run.plot(kind)
            picture.save(f"{kind}.png")
            self.assertGreater(Path(f"{kind}.png").stat().st_size, 5000)
        self.assertTrue(picture._repr_png_().startswith(b"\x89PNG"))
        changed = {key for key, value in matplotlib.rcParams.items() if value != before[key]} - {"backend"}
        self.assertEqual(changed, set())
        self.assertEqual({"style", "view", "results", "fields"} & (set(sys.modules) - modules), set())

    def test_options_are_those_of_the_program(self):
        run = mixbeam.run(cantilever())
        figure = run.plot("shape", view="xz", field="axial_force").figure
        self.assertTrue(figure.axes)
        self.assertTrue(run.plot("along", along="rod").figure.axes)
        with self.assertRaises(mixbeam.InputError):
            run.plot("shape", field="axal")
        with self.assertRaises(mixbeam.InputError):
            run.plot("curve", curve=("load_factor", "tp.z"))


class Page(InFolder):
    def test_the_examples_of_the_page(self):
        os.symlink(SOURCES / "apps", "apps")
        page = (SOURCES / "apps/docs/python.md").read_text()
        blocks = re.findall(r"^```python\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
        self.assertEqual(len(blocks), 12)
        names = {}
        for number, block in enumerate(blocks, 1):
            self.assertEqual(failures(block, names), 0, f"example {number}")
        self.assertEqual(failures(">>> run.passed\nFalse\n", names, lambda text: None), 1)


def failures(text, names, say=None):
    """Of the examples of a text, which share their names with those before."""
    test = doctest.DocTestParser().get_doctest(text, {}, "python.md", "python.md", 0)
    test.globs = names
    return doctest.DocTestRunner(optionflags=doctest.IGNORE_EXCEPTION_DETAIL).run(test, out=say, clear_globs=False).failed


def _solved(scene):
    return mixbeam.run(scene).displacement("tip")


if __name__ == "__main__":
    unittest.main()
