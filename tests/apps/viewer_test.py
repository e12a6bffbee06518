#!/usr/bin/python3
"""Pages of `mixbeam view` in a real browser without a screen: what it draws, says and does.

usage: viewer_test.py MIXBEAM [GALLERY_SCENE.xml ...]     further scenes are opened too
"""

import html
import json
import re
import subprocess
import sys
import tempfile
import time
import unittest
from functools import cache
from pathlib import Path

from support import CANTILEVER, PROGRAM, ROOT, program, scene, solve

FURTHER = [Path(sys.argv.pop(1)) for _ in sys.argv[1:] if sys.argv[1].endswith(".xml")]
sys.path.insert(0, str(ROOT / "apps" / "plots"))

import numpy as np  # noqa: E402

from results import Run  # noqa: E402

BROWSER = ("chromium-headless-shell", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--dump-dom",
           "--window-size=1200,800")
SECONDS = 120             # for a browser that draws on a busy processor
FIRST_PICTURE = 9000      # milliseconds without a graphics card beside other tests: three times what the largest page takes so
LARGEST_PAGE = 1.5e6      # bytes, of a scene of the gallery
BACKGROUND = [255, 255, 255]
SAME_HUE = 0.07           # light changes brightness, and its shine adds a little white
READ_OFF = 2e-4           # four digits are shown
KEPT = 0.51 / 16383       # of the largest of a component in a step: half a unit of 15 bits, and a little for float32
SHEET = 36                # points along the side of a sheet with about 1e5 samples
# Collects errors of scripts before any of them runs.
WATCH = ('<script>window.problems = []; window.addEventListener("error", (e) => problems.push(e.message));'
         'window.alert = (text) => problems.push("alert " + text);</script>')

# The browser writes the document when it is loaded, which it is not while a document inside of it is open.
HOLD = ('const hold = document.createElement("iframe"); document.body.append(hold); hold.contentDocument.open();'
        'const release = () => { hold.contentDocument.close(); hold.remove(); };')


def seen(page, *commands):
    """{"problems", "first" (milliseconds), "values"} of a page: values of JavaScript expressions with the probe at hand."""
    script = ("const values = []; try { " + "".join(f"values.push({command});\n" for command in commands) +
              "} catch (error) { problems.push(String(error.stack)); }")
    told = ('const told = document.createElement("pre"); told.id = "told"; told.textContent = JSON.stringify({ problems, values,'
            ' first: Number(document.documentElement.dataset.firstPicture) }); document.body.append(told);')
    text = page.read_text(encoding="utf-8").replace("<head>", "<head>" + WATCH, 1)
    probe = (ROOT / "tests/apps/viewer_probe.js").read_text(encoding="utf-8")
    use = f"() => {{ {probe}\n{script}\n{told} release(); }}"
    parts = f"<script>{HOLD} mixbeamStart.catch((error) => problems.push(String(error))).then({use});</script></body></html>"
    probed = page.with_name(f"probed {page.name}")
    probed.write_text(text.replace("</body></html>", parts), encoding="utf-8")
    ended = subprocess.run([*BROWSER, probed.as_uri()], capture_output=True, text=True, timeout=SECONDS, check=False)
    found = re.search(r'<pre id="told">(.*?)</pre>', ended.stdout, re.DOTALL)
    assert found, f"the browser showed no page: {ended.stderr[-2000:]}"
    return json.loads(html.unescape(found[1]))


def sheet(folder):
    """Writes a square sheet of struts with 1e5 samples, one side held, the other pushed; the text of its scene."""
    names = {(i, j): f"{'low' if j == 0 else 'high' if j == SHEET - 1 else 'p'} {i} {j}" for i in range(SHEET) for j in range(SHEET)}
    pairs = [(at, (at[0] + di, at[1] + dj)) for at in names for di, dj in ((1, 0), (0, 1))]
    pairs = [(a, b) for a, b in pairs if b in names and not (a[1] == b[1] and a[1] in (0, SHEET - 1))]
    (folder / "points.csv").write_text("name,x,y,z\n" + "".join(f"{name},{i},{j},0\n" for (i, j), name in names.items()))
    (folder / "members.csv").write_text("name,start,end\n" +
                                        "".join(f"m{k},{names[a]},{names[b]}\n" for k, (a, b) in enumerate(pairs)))
    return scene("""
        Import: {Points File: points.csv, Members File: members.csv, Section: s, Order: 2, Elements: 8}
        Supports: {low: {Point: low *}}
        Point Loads: {push: {Point: high *, Force: [0.002, 0, 0]}}
        """)


# A cantilever whose height grows from 0.1 to 0.3, its width from 0.05 to 0.1, along x; height along z.
TAPERED_BOX = """Scene:
  Sections:
    s: {Shape: box, Width: 0.05, Height: 0.1, Wall: 0.01, Material: {E: 1e6, nu: 0.3}}
    thick: {Shape: box, Width: 0.1, Height: 0.3, Wall: 0.01, Material: {E: 1e6, nu: 0.3}}
  Points: {a: [0, 0, 0], b: [1, 0, 0]}
  Members: {m: {Start: a, End: b, Section: s, End Section: thick, Second Axis: [0, 1, 0], Elements: 4}}
  Supports: {clamp: {Point: a}}
"""


class Viewer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(holder.cleanup)
        cls.folder = Path(holder.name)
        cls.bent = solve(cls.folder, "bent", CANTILEVER)
        cls.page = cls.view(cls.bent)

    @classmethod
    def view(cls, result, *options):
        return cls.folder / program("view", str(result), *options, folder=cls.folder).strip()

    def values(self, page, *commands):
        """Of expressions in a page without any problem."""
        told = seen(page, *commands)
        self.assertEqual(told["problems"], [])
        return told["values"]

    def assert_hue(self, color, expected):
        """The same but for brightness."""
        color, expected = (np.array(each, dtype=float) / max(each) for each in (color, expected))
        self.assertLess(np.abs(color - expected).max(), SAME_HUE, f"{color} {expected}")

    # what is drawn

    def test_colours_stand_where_the_structure_is(self):
        samples = (3, 10, 20)
        commands = ["probe.set('ghost', false, 'change')", "probe.set('loads', false, 'change')"]
        for i in samples:
            commands += [f"probe.color(...probe.pixel({i}))", f"probe.color(probe.pixel({i})[0], probe.pixel({i})[1] + 60)"]
        colors = self.values(self.page, *commands)[2:]
        with Run(self.bent) as run:
            moment = np.abs(run.steps[-1].field("material_moment")[:, 2])
        for i, drawn, beside in zip(samples, colors[::2], colors[1::2]):
            self.assert_hue(drawn, viridis(moment[i] / moment.max()))
            self.assertEqual(beside, BACKGROUND)
        with self.assertRaises(AssertionError):  # the colour of another value is told apart
            self.assert_hue(colors[0], viridis(moment[samples[-1]] / moment.max()))

    def test_the_slider_moves_the_structure(self):
        tip = "probe.app.result.samples - 1"
        hide = ["probe.set('ghost', false, 'change')"]
        before = f"(window.bent = probe.pixel({tip}), window.inner = probe.pixel({tip} - 2))"
        told = self.values(self.page, *hide, before, "probe.color(...inner)", "probe.set('step', 0, 'input')", "probe.color(...inner)",
                           f"probe.color(...probe.pixel({tip} - 2))", f"probe.pixel({tip})[1] - bent[1]",
                           "document.getElementById('step-text').textContent", "probe.app.curve.now.getAttribute('cy')",
                           "probe.set('step', 1, 'input')", "probe.app.curve.now.getAttribute('cy')")
        self.assertNotEqual(told[2], BACKGROUND)
        self.assertEqual(told[4], BACKGROUND)
        self.assertNotEqual(told[5], BACKGROUND)
        self.assertLess(told[6], -50)  # pixels, upwards
        self.assertIn("step 0 of 1", told[7])
        self.assertNotEqual(told[8], told[10])  # the mark on the path moves too

    def test_sections_are_drawn_to_scale(self):
        page = self.view(solve(self.folder, "box", TAPERED_BOX))
        column = ("(() => { const { camera } = probe.app; const [x, y] = camera.project([SHARE - 0.5, 0, 0]); let count = 0;"
                  " for (let dy = -150; dy <= 150; ++dy) if (probe.read(x, y + dy)[0] < 250) ++count; return count * camera.pixel; })()")
        look = ["probe.set('supports', false, 'change')", "", "probe.color(5, 5)", "probe.app.camera.pixel"]
        for view, sizes in (("xz", (0.1, 0.3)), ("xy", (0.05, 0.1))):
            look[1] = f"probe.click('[data-view={view}]')"
            *_, pixel, start, middle, end = self.values(page, *look, *(column.replace("SHARE", share) for share in ("0.02", "0.5", "0.98")))
            for drawn, share in ((start, 0.02), (middle, 0.5), (end, 0.98)):
                self.assertAlmostEqual(drawn, sizes[0] + share * (sizes[1] - sizes[0]), delta=2.5 * pixel)

    # what is said

    def test_members_of_extremes_by_name(self):
        """Of 90 cantilevers side by side one is loaded most: numbers of members come back as 19.0000076 from packing."""
        rods = range(90)
        listed = lambda entry: ", ".join(entry.replace("#", str(i)) for i in rods)
        text = scene(f"""
            Points: {{{listed("a#: [0, #, 0], b#: [1, #, 0]")}}}
            Members: {{{listed("rod #: {Start: a#, End: b#, Elements: 4}")}}}
            Supports: {{clamp: {{Point: a*}}}}
            Point Loads: {{{", ".join(f"f{i}: {{Point: b{i}, Force: [0, 0, {z}]}}" for i, z in ((0, -0.5), (19, -1), (89, -0.5)))}}}
            """, 'Quantities: {most: {Quantity: material moment, Member: "*", Component: norm, Take: largest}}\n')
        page = self.view(solve(self.folder, "rods", text))
        words, = self.values(page, "probe.app.panel.placeWords('most', 1)")
        self.assertEqual(words, " (rod 19, s = 0)")  # statics: the clamp of the rod with twice the load

    def test_hover_tells_member_and_values(self):
        text, nothing = self.values(self.page, "probe.hover(...probe.pixel(10))", "probe.hover(20, 700)")
        with Run(self.bent) as run:
            moment = run.steps[-1].field("material_moment")[10, 2]
            arc = run.members[0].arc_length[10]
        self.assertEqual(nothing, "")
        self.assertTrue(text.startswith("m\n"), text)
        numbers = [float(word) for word in re.findall(r"-?[0-9.]+", text.replace("\u2212", "-"))]
        for value in (arc, moment):
            self.assertLess(min(abs(number - value) for number in numbers), READ_OFF * max(abs(value), 0.1), text)

    def test_names_are_data(self):
        evil, point = "<script>alert(1)</script>", "<script>alert(1)"  # names of points and members have no slash
        member_name = r"<img src=x onerror=alert(2)> $\frac$"  # between dollars, no formula of a picture either
        text = re.sub(r"\bb\b", f"'{point}'", CANTILEVER).replace("{m:", f"{{? '{member_name}' :").replace("portal", f"'{evil}'")
        result = solve(self.folder, "evil", text)
        page = self.view(result)
        self.assertNotIn(point, page.read_text(encoding="utf-8"))
        title, hover, options = self.values(page, "document.title", "probe.hover(...probe.pixel(10))",
                                            "document.getElementById('abscissa').textContent")
        self.assertTrue(hover.startswith(member_name), hover)
        self.assertIn(f"{point}: displacement y", options)
        self.assertEqual(title, evil)
        for command in ("report", "plot"):
            program(command, str(result), folder=self.folder)
        for written in (*self.folder.glob("evil*.svg"), self.folder / "evil-report.html", self.folder / "evil.xdmf"):
            for name in (point, member_name):
                self.assertNotIn(name, written.read_text(encoding="utf-8"), written)
        self.assertIn('href="./evil-view.html"', (self.folder / "evil-report.html").read_text(encoding="utf-8"))

    # scenes that are not solved

    @classmethod
    def preview(cls, name, text):
        (cls.folder / f"{name}.yaml").write_text(text, encoding="utf-8")
        return cls.view(f"{name}.yaml")

    def test_a_scene_is_drawn_without_being_solved(self):
        page = self.preview("portal", CANTILEVER)
        self.assertEqual(page.name, "portal-view.html")
        self.assertFalse(page.with_name("portal.h5").exists())
        words, modes, colour, text = self.values(page, "probe.app.words[1]", "probe.app.result.modes.length", "probe.color(...probe.pixel(3))",
                                                 "document.getElementById('check').textContent")
        self.assertEqual((words, modes, text), ("not solved", 0, "A run would take this scene."))
        self.assertNotEqual(colour, BACKGROUND)

    def test_a_watched_scene_is_drawn_anew(self):
        """The page follows the file, and stays as it is while the file is broken."""
        scene_file, text = self.folder / "watched.yaml", CANTILEVER
        page = scene_file.with_name("watched-view.html")
        scene_file.write_text(text, encoding="utf-8")

        def await_that(holds):
            end = time.monotonic() + SECONDS
            while not holds():
                self.assertLess(time.monotonic(), end)
                time.sleep(0.1)

        with open(self.folder / "watched.txt", "w+", encoding="utf-8") as said, \
                subprocess.Popen([PROGRAM, "view", str(scene_file), "--watch"], stdout=subprocess.DEVNULL, stderr=said) as watcher:
            try:
                await_that(page.exists)
                first = page.read_bytes()
                scene_file.write_text(text.replace("{m:", "{renamed:"), encoding="utf-8")
                await_that(lambda: page.read_bytes() != first)
                second = page.read_bytes()
                scene_file.write_text("Scene: {", encoding="utf-8")
                await_that(lambda: said.seek(0) or "watched.yaml" in said.read())
                self.assertEqual(page.read_bytes(), second)
            finally:
                watcher.terminate()
        self.assertEqual(self.values(page, "probe.app.result.members"), [["renamed"]])

    def test_a_mechanism_moves(self):
        """Two bars: one swings about the z axis of its hinge at the origin, one floats; the message names the first."""
        text = scene("""
            Points: {a: [0, 0, 0], b: [1, 0, 0], c: [0, 0, 1], d: [1, 0, 1]}
            Members: {bar: {Start: a, End: b, Elements: 4}, held: {Start: c, End: d, Elements: 4}}
            Supports: {hinge: {Point: a, Fixed Rotation: [x, y]}, clamp: {Point: c}}
            """)
        page = self.preview("mechanism", text)
        mode = "probe.app.result.floats('mode-0')"
        told = self.values(page, "probe.app.result.modes.map((mode) => mode.kind)", f"[...{mode}]", "probe.app.swinging > 0",
                           "probe.app.result.fields[0].of_members", "probe.app.result.preview", "probe.app.result.first_sample")
        self.assertEqual(told[0], ["motion without strain"])
        motion = np.array(told[1]).reshape(-1, 3)
        bar, held = motion[:told[5][1]], motion[told[5][1]:]
        np.testing.assert_allclose(bar[-1], (0, np.copysign(1, bar[-1, 1]), 0), atol=READ_OFF)  # the tip, square to the bar
        np.testing.assert_allclose(bar[0], 0, atol=READ_OFF)
        np.testing.assert_allclose(held, 0, atol=READ_OFF)
        self.assertTrue(told[2])
        self.assertEqual(told[3], [0, 1])
        self.assertEqual(told[4]["named"], [0])
        self.assertIn('member "bar" can move without strain', told[4]["refusal"])

    def test_what_can_be_drawn_of_a_bad_scene(self):
        for name, text, note, members in (("load", CANTILEVER.replace("Point: b", "Point: z"), "leaves out supports", []),
                                          ("section", CANTILEVER.replace("End: b", "End: b, Section: t"), "chords", [0])):
            notes, preview = self.values(self.preview(name, text), "document.getElementById('notes').textContent", "probe.app.result.preview")
            self.assertIn(note, notes)
            self.assertEqual(preview["named"], members, preview)
        (self.folder / "nothing.yaml").write_text(CANTILEVER.replace("Points", "Pints"), encoding="utf-8")
        self.assertIn("Scene / Pints", program("view", "nothing.yaml", folder=self.folder, code=2))

    # load cases

    def test_load_cases_share_a_page(self):
        """One down, one up with half of it: the tip moves by forces of 1 and -0.5 alike."""
        loads = "down: {Point: b, Force: [0, 0, -0.01], Case: down}, up: {Point: b, Force: [0, 0, 0.005], Case: up}"
        text = CANTILEVER.replace("f: {Point: b, Force: [0, -1, 0]}", loads).replace("Scene:\n", "Scene:\n  Load Cases: [down, up]\n")
        result = solve(self.folder, "cases", text + "Quantities: {sag: {Quantity: displacement, Point: b, Component: z}}\n")
        sag = "probe.app.result.series('sag')[1]"
        told = self.values(self.view(result), "document.getElementById('title').textContent", sag, "probe.set('case', 1, 'change')",
                           "document.getElementById('title').textContent", sag, "document.getElementById('abscissa').value", "probe.covered()",
                           "(probe.app.play(), probe.set('case', 0, 'change'), Boolean(probe.app.playing))")
        self.assertEqual((told[0], told[3]), ("portal, load case down", "portal, load case up"))
        self.assertAlmostEqual(told[4] / told[1], -0.5, delta=1e-3)  # nonlinear by the square of the rotation
        self.assertEqual(told[5], "sag")  # the first of Quantities
        self.assertGreater(told[6], 0.001)
        self.assertFalse(told[7])  # another case has other steps
        one = self.view(result, "--case", "up")
        self.assertEqual(one.name, "cases-up-view.html")
        self.assertEqual(self.values(one, "document.getElementById('cases-section').hidden")[0], True)

    # the path

    @classmethod
    @cache
    def snap_back(cls):
        """(page, result) of a path of many steps, with critical points."""
        program("run", str(ROOT / "apps/gallery/snap_back.xml"), "--output", ".", "--quiet", folder=cls.folder)
        return cls.view("snap_back.h5"), cls.folder / "snap_back.h5"

    def test_numbers_of_all_steps_are_those_of_the_result(self):
        names = ("displacement", "material_force", "material_moment", "force_strain", "moment_strain")  # strains: not in the page
        page, result = self.snap_back()
        ask = "probe.app.result.steps.map((step, i) => [step.number, ...NAMES.map((name) => [...probe.app.result.ofStep(name, i)])])"
        steps = self.values(page, ask.replace("NAMES", json.dumps(names)))[0]
        with Run(result) as run:
            self.assertEqual(len(steps), len(run.steps))
            off = lambda read, step, name: self.off(np.array(read).reshape(-1, 3), step.field(name))
            for (number, *arrays), step in zip(steps, run.steps):
                self.assertEqual(number, step.number)
                for name, read in zip(names, arrays):
                    self.assertLess(off(read, step, name), KEPT, (number, name))
            self.assertGreater(off(steps[5][1], run.steps[6], names[0]), KEPT)  # another step is told apart

    @staticmethod
    def off(read, meant):
        """Largest difference over the largest of each component."""
        largest = np.abs(meant).max(axis=0)
        return (np.abs(read - meant)[:, largest > 0].max(axis=0) / largest[largest > 0]).max(initial=0.0)

    def test_critical_points_and_modes(self):
        page, result = self.snap_back()
        half = "Math.floor(probe.app.result.samples / 2)"
        told = self.values(page, "document.getElementById('modes').textContent", "document.querySelectorAll('#curve .critical').length",
                           "probe.click('[data-mode=\"0\"]')", f"window.at = probe.pixel({half})", "document.getElementById('step-text').textContent",
                           "probe.set('amplitude', -1, 'input')", f"Math.hypot(probe.pixel({half})[0] - at[0], probe.pixel({half})[1] - at[1])",
                           f"probe.color(...probe.pixel({half} - 2))", "probe.click('#leave-mode')", "probe.app.shape.modeNumber",
                           "(probe.click('[data-mode=\"0\"]'), probe.app.camera.toward[2])",
                           "(probe.app.shape.mode = probe.app.shape.mode.map((_, i) => Number(i % 3 === 2)), probe.app.turnToMode(),"
                           " probe.app.camera.toward[2])")
        with Run(result) as run:
            points = run.critical_points()
        self.assertEqual(told[0].count("limit point"), len(points))
        self.assertEqual(told[1], len(points))
        self.assertIn(f"{points[0].load_factor:.6g}", told[4])
        self.assertGreater(told[6], 20)  # pixels
        self.assertNotEqual(told[7], BACKGROUND)
        self.assertEqual(told[9], -1)
        self.assertAlmostEqual(told[10], 1, 12)  # it moves in the plane of the view
        self.assertAlmostEqual(told[11], 3**-0.5, 4)  # this one would along the line of sight: the camera turned

    def test_a_click_on_the_path_takes_the_step(self):
        click = ("(() => { const box = document.getElementById('curve').getBoundingClientRect(); const [x, y] = probe.app.curve.at(0);"
                 " document.getElementById('curve').dispatchEvent(new MouseEvent('click', { clientX: box.left + x, clientY: box.top + y }));"
                 " return probe.app.shape.step; })()")
        self.assertEqual(self.values(self.page, "probe.app.shape.step", click), [1, 0])

    def test_picture_scale_and_themes(self):
        picture, light, dark, moved = self.values(
            self.page, "probe.app.picture().slice(0, 22) + probe.app.picture().length", "probe.covered()",
            "(probe.click('#theme'), probe.color(5, 600))",
            "(probe.set('scale', 0, 'change'), Math.abs(probe.pixel(20)[1] - probe.pixel(0)[1]))")
        self.assertTrue(picture.startswith("data:image/png;base64,"))
        self.assertGreater(int(picture[22:]), 10000)
        self.assertTrue(0.001 < light < 0.2, light)
        self.assertLess(max(dark), 60)
        self.assertLess(moved, 1e-3)

    # hands

    def test_the_wheel_enlarges_around_the_pointer(self):
        pointer = (300, 250)
        before, kept, zoomed, height, back = self.values(
            self.page, "(window.height = probe.app.camera.height, probe.pixel(10))", f"probe.wheel({list(pointer)}, -400)", "probe.pixel(10)",
            "height / probe.app.camera.height", f"(probe.wheel({list(pointer)}, 400), probe.pixel(10))")
        self.assertTrue(kept)
        self.assertAlmostEqual(height, np.exp(0.6), places=9)
        np.testing.assert_allclose(np.subtract(zoomed, pointer), height * np.subtract(before, pointer), atol=1e-6)
        np.testing.assert_allclose(back, before, atol=1e-6)

    def test_dragging_turns_and_moves(self):
        angles = "[probe.app.camera.elevation, probe.app.camera.azimuth]"
        before, turned, at, moved, stayed, hovered = self.values(
            self.page, angles, f"(probe.pointer([[300, 300], [310, 300], [320, 295]]), {angles})", "(window.at = probe.pixel(10))",
            "(probe.pointer([[300, 300], [330, 290]], { shiftKey: true }), probe.pixel(10))", angles,
            f"(probe.hover(500, 20), {angles})")
        np.testing.assert_allclose(np.subtract(turned, before), (-2, -8), atol=1e-9)  # 0.4 degrees a pixel
        np.testing.assert_allclose(np.subtract(moved, at), (30, -10), atol=1e-6)
        self.assertEqual(stayed, turned)
        self.assertEqual(hovered, turned)  # a pointer that is not pressed turns nothing

    def test_two_fingers_enlarge_and_move(self):
        height, middle, there = self.values(
            self.page, "(window.height = probe.app.camera.height, window.at = probe.pixel(10), window.up = probe.pointer([[at[0] - 50, at[1]]],"
            " { id: 5, kind: 'touch', stays: true }), probe.pointer([[at[0] + 50, at[1]], [at[0] + 150, at[1]]], { id: 6, kind: 'touch' }),"
            " up(), height / probe.app.camera.height)", "[at[0] + 50, at[1]]", "probe.pixel(10)")
        self.assertAlmostEqual(height, 2.0, places=9)  # twice as far from each other
        np.testing.assert_allclose(there, middle, atol=1e-6)  # what was between them stays there

    def test_the_picture_is_saved(self):
        saved, size = self.values(self.page, "probe.saved('#save')", "[document.getElementById('scene').width, document.getElementById('scene').height]")
        self.assertEqual([saved["width"], saved["height"]], size)
        self.assertGreater(saved["width"], 600)
        self.assertEqual(saved["name"], f"{self.bent.stem.replace('bent', 'portal')}-1.png")

    def test_keys_and_slider_take_steps(self):
        page, _ = self.snap_back()
        last, back, further, first, forward, slid, text, play = self.values(
            page, "probe.app.shape.step", "probe.key('ArrowLeft')", "probe.key('ArrowLeft')", "(probe.set('step', 0, 'input'), probe.key('ArrowLeft'))",
            "probe.key('ArrowRight')", "(document.getElementById('step').stepUp(3), document.getElementById('step').dispatchEvent(new Event('input')),"
            " probe.app.shape.step)", "document.getElementById('step-text').textContent",
            "(probe.key(' '), Boolean(probe.app.playing) && (probe.key(' '), !probe.app.playing))")
        self.assertEqual([back, further, first, forward, slid], [last - 1, last - 2, 0, 1, 4])
        self.assertIn("step 4 of", text)
        self.assertTrue(play)

    def test_a_film_of_steps_ends_with_them(self):
        """Not after a time; 1 frame more is asked for by each."""
        more, = self.values(
            self.page, "(() => { const frames = []; window.requestAnimationFrame = (frame) => frames.push(frame);"
            " window.MediaRecorder = class { start() { this.onstart(); } }; probe.app.film(); performance.now = () => 1e9;"
            " const count = frames.length; frames[count - 1](); probe.app.stopPlay(); return frames.length - count; })()")
        self.assertEqual(more, 1)

    def test_many_steps_are_unpacked(self):
        """1e5 steps of a number each, which is the extrapolation of later ones."""
        number, = self.values(
            self.page, "(() => { const many = Object.create(probe.app.result.constructor.prototype);"
            " Object.assign(many, { units_of: {}, packed: new Map(), bytes: () => new Uint8Array(3) });"
            " for (let i = 0; i < 1e5; ++i) many.units_of[`u-${i}`] = [1]; return many.unpacked('u', 0).whole[0]; })()")
        self.assertEqual(number, 0)

    # pages of all kinds and sizes

    def test_scenes_of_the_gallery_open(self):
        names = ("portal_frame", "star_dome", "honeycomb_crushed")  # I, tubes, rectangles and by far the most numbers
        for path in (*(ROOT / "apps" / "gallery" / f"{name}.xml" for name in names), *FURTHER):
            program("run", str(path.resolve()), "--output", path.stem, "--quiet", folder=self.folder)
            results = sorted((self.folder / path.stem).glob("*.h5"))
            for result in results:
                if len(results) == 1 or result.stem != path.stem:  # else the envelope of its load cases
                    self.opens(self.view(result))

    def opens(self, page):
        told = self.opened(page, "probe.covered()")
        self.assertGreater(told["values"][0], 1e-4, page.name)
        self.assertLess(page.stat().st_size, LARGEST_PAGE, page.name)
        print(f"{page.name}: {page.stat().st_size / 1e3:.0f} kB, first picture after {told['first']} ms", file=sys.stderr)

    def opened(self, page, *commands):
        """As `seen`, of a page without problems that opens in time."""
        told = seen(page, *commands)
        self.assertEqual(told["problems"], [], page.name)
        self.assertLess(told["first"], FIRST_PICTURE, page.name)
        return told

    def test_a_sheet_of_1e5_samples_opens(self):
        page = self.view(solve(self.folder, "sheet", sheet(self.folder)))
        timed = "(() => { const start = performance.now(); STEP; probe.color(5, 5); return performance.now() - start; })()"
        told = self.opened(page, "probe.app.result.samples", "probe.covered()", timed.replace("STEP", "1"), timed.replace("STEP", "probe.set('step', 0, 'input')"),
                    timed.replace("STEP", "probe.hover(...probe.pixel(50000))"))
        samples, covered, *times = told["values"]
        print(f"sheet: {page.stat().st_size / 1e6:.1f} MB, first picture after {told['first']} ms, the same again {times[0]:.0f} ms, a step {times[1]:.0f} ms, "
              f"a look {times[2]:.0f} ms", file=sys.stderr)
        self.assertGreater(samples, 95000)
        self.assertGreater(covered, 0.05)

    def test_a_broken_script_is_a_problem(self):
        broken = self.folder / "broken.html"
        broken.write_text(self.page.read_text(encoding="utf-8").replace("drawScale(", "drawScales(", 1), encoding="utf-8")
        self.assertNotEqual(seen(broken, "1")["problems"], [])

    def test_bad_input(self):
        for words in (["view"], ["view", str(self.folder / "none.h5")], ["view", str(self.bent), "--case", "wind"]):
            self.assertNotEqual(program(*words, folder=self.folder, code=2), "")


def viridis(share):
    from matplotlib import colormaps

    return [255 * channel for channel in colormaps["viridis"](share)[:3]]


if __name__ == "__main__":
    unittest.main()
