#!/usr/bin/python3
"""Scenes and pages of the repository: those of the gallery and of verification run and reproduce their expected values;
every whole scene in the pages is accepted, every link leads somewhere, and the README quotes runs and pages.

usage: scenes_and_pages_test.py MIXBEAM [CLASS]...
"""

import os
import re
import subprocess
import sys
import unittest
from pathlib import Path

import yaml

from support import PROGRAM, ROOT, InFolder

sys.path.insert(0, str(ROOT / "apps" / "plots"))

from readme_pictures import merge  # noqa: E402

APPS = ROOT / "apps"
LARGEST_PICTURE = 150000  # bytes, so that the pages stay light
LARGEST_PICTURE_OF_README = 250000
MOST_LINES_OF_README, MOST_LINES_OF_YAML = 90, 20
SAME_NUMBER = 1e-3  # of numbers that pages quote: meshes are chosen for 1e-4
ROUNDING = 1e-9     # of displacements of some centimetres and forces of some kN


def pages():
    return [*sorted((APPS / "docs").glob("*.md")), ROOT / "README.md", APPS / "plots/README.md"]


FAILED = 1  # exit code of a check that failed


class WithProgram(InFolder):
    def run_quietly(self, scene, text=None, code=0):
        """What a run of a scene file prints; with a text, of a file of this name that holds it."""
        if text is not None:
            (self.folder / scene).write_text(text)
        return self.mixbeam("run", str(scene), "--quiet", "--threads", "1", "--output", ".", code=code)


def gallery_scenes():
    return sorted(file for ending in ("xml", "yaml") for file in (APPS / "gallery").glob(f"*.{ending}"))


class Gallery(WithProgram):
    def test_scenes_reproduce_their_values(self):
        for scene in gallery_scenes():
            with self.subTest(scene.stem):
                printed = self.run_quietly(scene)
                # one file for each load case, where there are some
                self.assertTrue(list(self.folder.glob(f"{scene.stem}*.h5")))
                if re.search('"Expected"|^Expected:', scene.read_text(), re.M):
                    self.assertIn("checks passed", printed)

    def test_twins_in_yaml_hold_the_same_scene(self):
        def contents(scene):
            self.mixbeam("convert", str(scene), f"{scene.stem}.xml", "--force")
            return re.sub(r"<!--.*?-->|\s", "", (self.folder / f"{scene.stem}.xml").read_text(), flags=re.S)

        for scene in (APPS / "gallery").glob("*.xml"):
            twin = Path(PROGRAM).parent / f"gallery/{scene.stem}.yaml"
            self.assertTrue(contents(twin) == contents(scene), scene.stem)
            for table in re.findall(r"\w+\.csv", scene.read_text()):
                self.assertEqual((twin.parent / table).read_text(), (scene.parent / table).read_text())

    def test_scenes_are_on_the_page_with_a_small_picture(self):
        page = (APPS / "docs/gallery.md").read_text()
        for scene in gallery_scenes():
            self.assertIn(f"gallery/{scene.name}", page)
            self.assertIn(f"gallery/{scene.stem}.png", page)
            self.assertLessEqual((APPS / f"docs/gallery/{scene.stem}.png").stat().st_size, LARGEST_PICTURE)


class Verification(WithProgram):
    """Reference values from outside the paper, each from a plain scene file."""

    def test_scenes_give_their_reference_values_and_notice_others(self):
        value = re.compile(r'(name="Value" type="double" value=")([^"]*)')
        scenes = sorted((APPS / "verification").glob("*.xml"))
        self.assertGreater(len(scenes), 10)
        for scene in scenes:
            with self.subTest(scene.stem):
                self.run_quietly(scene)
                # the first expected value changed in its eighth digit or before
                text = scene.read_text()
                other, changes = value.subn(lambda m: f"{m[1]}{float(m[2]) * (1 + 1e-7):.15g}", text, count=1)
                self.assertEqual(changes, 1)
                self.run_quietly("other.xml", other, FAILED)


def whole_scenes(page, form="xml"):
    """Blocks ```xml or ```yaml of a page that are whole scenes."""
    scene = '<ParameterList name="Scene">' if form == "xml" else "^Scene:\n.*^  Sections:.*^  Members:"
    return [block for block in re.findall(f"```{form}\n(.*?)```", page.read_text(), re.S)
            if re.search(scene, block, re.M | re.S)]


def anchors_of(page):
    """What links call the headings of a page: small letters, hyphens for blanks, no other marks."""
    prose = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.M | re.S)
    return {re.sub(r"[^a-z0-9_-]", "", heading.lower().replace(" ", "-")) for heading in re.findall(r"^#+ (.*)", prose, re.M)}


def dead_links(page, text):
    dead = set()
    pictures = [(file, "") for file in re.findall(r'<img src="([^"]*)"', text)]
    for file, anchor in re.findall(r"\]\(([^)\s#]*)#?([^)\s]*)\)", text) + pictures:
        target = page.parent / file if file else page
        if "://" not in file and (not target.exists() or (anchor and anchor not in anchors_of(target))):
            dead.add(f"{file}#{anchor}")
    return dead


def chapter(page, heading):
    """Text below a heading of a page, up to the next one."""
    return re.search(rf"^#+ {heading}\n(.*?)(?=^#+ |\Z)", page.read_text(), re.M | re.S)[1]


def agree(quoted, printed):
    """Words are the same, numbers to a thousandth; what is as small as rounding may differ."""
    def same(a, b):
        try:
            a, b = float(a), float(b)
        except ValueError:
            return a == b
        return abs(a - b) <= SAME_NUMBER * abs(a) or max(abs(a), abs(b)) < ROUNDING

    quoted, printed = (re.split(r"[\s,]+", line.strip()) for line in (quoted, printed))
    return len(quoted) == len(printed) and all(map(same, quoted, printed))


class FirstHour(WithProgram):
    def test_each_step_runs_and_prints_what_it_says(self):
        page = (APPS / "docs/first_hour.md").read_text()
        steps = re.findall("```yaml\n(.*?)```.*?```sh\n(.*?)```.*?```\n(.*?)```.*?\\((first_hour/.*?)\\)", page, re.S)
        self.assertEqual(len(steps), page.count("```yaml"))
        scene = {}
        for added, commands, quoted, picture in steps:
            self.assertTrue((APPS / "docs" / picture).exists())
            merge(scene, yaml.safe_load(added))
            (self.folder / "frame.yaml").write_text(yaml.safe_dump(scene, sort_keys=False))
            ended = subprocess.run(["bash", "-ec", commands], cwd=self.folder, capture_output=True, text=True,
                                   env={**os.environ, "PATH": f"{Path(PROGRAM).parent}:{os.environ['PATH']}"})
            self.assertEqual(ended.returncode, 0, commands + ended.stdout + ended.stderr)
            self.assertEqual(quoted.count("\n"), 5)
            for line in quoted.splitlines():
                self.assertTrue(any(agree(line, other) for other in ended.stdout.splitlines()), f"{line}\n{ended.stdout}")

    def test_another_number_or_word_would_be_noticed(self):
        self.assertTrue(agree("  ridge   -1.6e-16  0.0481065, 2", "  ridge  3.1e-17  0.04810999, 2"))
        for other in ("ridge 0 0.0482 2", "foot 0 0.0481065 2", "ridge 0 0.0481065"):
            self.assertFalse(agree("ridge 0 0.0481065 2", other))


class Pages(WithProgram):
    def test_their_scenes_are_accepted(self):
        checked = 0
        for page in pages():
            for form in ("xml", "yaml"):
                for scene in whole_scenes(page, form):
                    with self.subTest(f"{page}\n{scene}"):
                        self.assertIn("stable: true", self.run_quietly(f"scene.{form}", scene))
                    checked += 1
        self.assertGreaterEqual(checked, 13)  # of scenes.md

    def test_recipes_are_whole_scenes_that_notice_other_values(self):
        page = APPS / "docs/scenes.md"
        recipes = [scene for scene in whole_scenes(page, "yaml") if "\nExpected:" in scene and " Value: true" not in scene]
        self.assertEqual(len(recipes), re.search(r"^## How to model\n(.*?)^## ", page.read_text(), re.M | re.S)[1].count("\n### "))
        for scene in recipes:  # the last value changed by a twentieth: more than any tolerance there
            head, value, tail = re.fullmatch(r"(.* Value: )([-\d.e]+)(.*)", scene, re.S).groups()
            other = f"{head}{float(value) * 1.05:.15g}{tail}"
            self.run_quietly("other.yaml", other, FAILED)

    def test_the_scene_in_xml_is_the_first_one_in_yaml(self):
        page = APPS / "docs/scenes.md"
        yaml = whole_scenes(page, "yaml")[0]
        self.assertLessEqual(yaml.count("\n"), MOST_LINES_OF_YAML)

        def tip_of(file, text):
            return re.search("  tip .*", self.run_quietly(file, text))[0]

        expected = tip_of("first.xml", whole_scenes(page)[0])
        self.assertEqual(tip_of("first.yaml", yaml), expected)
        self.assertIn("-10", yaml)
        self.assertNotEqual(tip_of("other.yaml", yaml.replace("-10", "-11", 1)), expected)

    def test_a_wrong_scene_would_be_noticed(self):
        scene = whole_scenes(APPS / "docs/scenes.md")[0]
        self.assertIn('"Diameter"', scene)
        (self.folder / "scene.xml").write_text(scene.replace('"Diameter"', '"Diametre"', 1))
        self.mixbeam("check", "scene.xml", code=2)

    def test_every_link_leads_somewhere(self):
        for page in pages():
            self.assertEqual(dead_links(page, page.read_text()), set(), page)

    def test_a_dead_link_would_be_noticed(self):
        text = ('[a](nowhere.md) ![b](gallery/nothing.png) [c](scenes.md#no-such-heading) [d](#state) [e](#estate)'
                '<img src="gallery/none.png"> [f](scenes.md#members-and-their-curves) [g](https://trilinos.github.io) [h](../../README.md)')
        self.assertEqual(dead_links(APPS / "docs/results.md", text),
                         {"nowhere.md#", "gallery/nothing.png#", "gallery/none.png#", "scenes.md#no-such-heading", "#estate"})

    def test_the_readme_quotes_the_run_of_its_scene(self):
        text = chapter(ROOT / "README.md", "A scene, and what it gives")
        scene, quoted = re.search("```yaml\n(.*?)```.*?```\n(.*?)```", text, re.S).groups()
        self.assertLessEqual(scene.count("\n"), 12)
        printed = self.run_quietly("wire.yaml", scene)
        lines = [line.split() for line in printed.splitlines()]
        for line in quoted.splitlines():
            self.assertIn(line.split(), lines)
        self.assertIn("order 5, elements 5: wire", printed)

    def test_the_numbers_of_the_readme_stand_on_the_pages(self):
        text = chapter(ROOT / "README.md", "How accurate, how fast")
        for pattern, page in ((r"\d\.\de-\d+", "verification"), (r"[\d.]+\+\w+|\d+(?= ms)|[\d.]+(?= kB)", "performance")):
            numbers = re.findall(pattern, text)
            self.assertTrue(numbers)
            for number in numbers:
                self.assertRegex((APPS / f"docs/{page}.md").read_text(), rf"\b{re.escape(number)}\b")

    def test_the_ratios_of_the_readme_stand_on_the_page_of_peers(self):
        text = chapter(ROOT / "README.md", "How accurate, how fast").partition("peers.png")[2]
        ratios = re.findall(r"\d[\d.]* to \d+(?:\.\d+)?", text)
        self.assertGreaterEqual(len(ratios), 8)  # of two rows, for four errors
        for ratio in ratios:
            self.assertIn(f"| {ratio} ", (APPS / "docs/peers.md").read_text())

    def test_the_readme_is_short(self):
        self.assertLessEqual((ROOT / "README.md").read_text().count("\n"), MOST_LINES_OF_README)
        self.assertLessEqual((APPS / "docs/readme_scenes.png").stat().st_size, LARGEST_PICTURE_OF_README)

    def test_the_citation_names_this_version(self):
        version = re.search(r"project\(mixbeam VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
        self.assertIn(f"\nversion: {version}\n", (ROOT / "CITATION.cff").read_text())

    def test_run_draws_what_every_benchmark_has(self):
        script, plots = (ROOT / "run.sh").read_text(), (APPS / "plots/plot_all.py").read_text()
        for name in ("default_benchmarks", "when_named"):
            words = re.search(rf"{name}=\((.*?)\)", script, re.S)[1].split()
            self.assertTrue(words)
            for word in words:
                self.assertIn(f'"{word}"', plots)
        self.assertNotIn('"mixbeam"', plots, "a name that is found whatever is looked for")


if __name__ == "__main__":
    unittest.main()
