"""Installs into an empty folder and works from there, in an environment without the build folder: packages_test.py BUILD."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

BUILD = Path(sys.argv.pop()).resolve()
SOURCE = Path(__file__).resolve().parents[2]
EXAMPLE = (SOURCE / "apps/docs/install.md").read_text()


def ended(words, code=0, **options):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, **options)
    if done.returncode != code:
        raise AssertionError(f"{words}: {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def block(page, language):
    return re.search(rf"```{language}\n(.*?)```", page, re.S)[1]


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.held = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.held.name)
        cls.prefix, cls.work = cls.folder / "moved", cls.folder / "work"
        cls.work.mkdir()
        ended(["cmake", "--build", BUILD, "--target", "packaged"])
        for component in ("program", "python", "development"):
            ended(["cmake", "--install", BUILD, "--component", component, "--prefix", cls.folder / "first"])
        (cls.folder / "first").rename(cls.prefix)  # no path of the first place is left
        cls.program = cls.prefix / "bin/mixbeam"
        cls.environment = {"PATH": "/usr/bin:/bin", "OMP_NUM_THREADS": "1"}

    @classmethod
    def tearDownClass(cls):
        cls.held.cleanup()

    def run_here(self, *words, code=0, **environment):
        return ended(words, code, cwd=self.work, env={**self.environment, **environment})

    def test_a_scene_and_its_pages(self):
        scene = self.prefix / "share/mixbeam/gallery/elastica.xml"
        self.assertIn("checks passed", self.run_here(self.program, "run", scene, "-o", "out"))
        self.run_here(self.program, "view", "out/elastica.h5", "-o", "page.html")
        self.assertIn("</html>", (self.work / "page.html").read_text())
        self.run_here(self.program, "plot", scene, "-o", "pictures")
        self.assertTrue(list((self.work / "pictures").glob("*.png")))
        self.run_here(self.program, "resume", "out/elastica.h5")

    def test_packages_that_pictures_lack_are_named(self):
        (self.work / "bin").mkdir()
        python = self.work / "bin/python3"
        python.write_text('#!/bin/sh\ncase "$*" in *h5py*) exit 1 ;; esac\n')
        python.chmod(0o755)
        hidden = ("unshare", "--mount", "--map-root-user", "sh", "-c",
                  'mount --bind "$0" /usr/bin/python3 && exec "$@"', python, self.program)
        scene = self.prefix / "share/mixbeam/gallery/elastica.xml"
        try:
            self.run_here(*hidden, "--version")
        except AssertionError:
            self.skipTest("no namespaces of mounts here")
        self.run_here(*hidden, "view", scene, "-o", "without.html")  # needs no Python
        said = self.run_here(*hidden, "plot", scene, code=2)
        self.assertIn('/usr/bin/python3 lacks "h5py"', said)
        self.assertIn("apt-get install", said)

    def test_results_hold_the_instruction_set(self):
        scene = self.prefix / "share/mixbeam/gallery/elastica.xml"
        self.run_here(self.program, "run", scene, "-o", "held")
        level = self.run_here(self.program, "--version").split(", ", 2)[2].strip()
        self.assertNotIn("instruction set", self.run_here(self.program, "resume", "held/elastica.h5"))
        other = f"""import h5py
with h5py.File("held/elastica.h5") as file:
    held = file["properties"].attrs["instructions"]
    assert (held if isinstance(held, str) else held.decode()) == {level!r}, held"""
        self.run_here("/usr/bin/python3", "-c", other)

    def test_resuming_on_another_instruction_set_says_so(self):
        other = self.folder / "other"
        shutil.copytree(self.prefix, other)
        library, name = other / "lib/mixbeam/libmixbeam.so", self.run_here(self.program, "--version").split(", ")[2].encode()
        library.write_bytes(library.read_bytes().replace(name + b"\0", name.swapcase() + b"\0"))  # its word for the set it was built for
        scene = self.prefix / "share/mixbeam/gallery/elastica.xml"
        self.run_here(other / "bin/mixbeam", "run", scene, "-o", "elsewhere")
        self.assertIn("Written with the instruction set", self.run_here(self.program, "resume", "elsewhere/elastica.h5"))

    def test_the_python_module(self):
        text = f"""import mixbeam
run = mixbeam.run(mixbeam.read({str(self.prefix / 'share/mixbeam/gallery/elastica.xml')!r}))
assert run.passed
run.view().save("run.html")
paths = {{line.split()[-1] for line in open("/proc/self/maps") if "mixbeam" in line}}
assert not any({str(BUILD)!r} in path for path in paths), paths"""
        self.run_here("/usr/bin/python3", "-c", text, PYTHONPATH=str(self.prefix / "lib/python3/dist-packages"))

    def test_a_program_in_cpp(self):
        example = self.folder / "example"
        example.mkdir()
        (example / "main.cpp").write_text(block(EXAMPLE, "cpp"))
        (example / "CMakeLists.txt").write_text(block(EXAMPLE, "cmake"))
        scene = block((SOURCE / "README.md").read_text(), "yaml")
        (self.work / "wire.yaml").write_text(scene)
        ended(["cmake", "-S", example, "-B", example / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}"])
        ended(["cmake", "--build", example / "build"])
        said = self.run_here(example / "build/solve", "wire.yaml")
        self.assertAlmostEqual(float(said.split()[-1]), -662.492, 3)  # README; six digits are printed
        self.assertIn("wire.yaml", self.run_here(example / "build/solve", "missing.yaml", code=1).replace("missing", "wire"))


if __name__ == "__main__":
    unittest.main()
