#!/usr/bin/python3
"""The study of peers with mixbeam alone: its errors, what is left out, its page and figure.

usage: peers_test.py MIXBEAM PACKAGES     the program, and the folder in which the package mixbeam lies
"""

import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

from support import PROGRAM, ROOT, InFolder

BIN, PACKAGES = Path(PROGRAM).parent, Path(sys.argv.pop(1)).resolve()
FAILED = 1  # exit code of a check that failed
TOO_SOFT = 1e-3  # one element of order 2 is farther from the elastica than this

STUDY = {"Programs": ("string", "{mixbeam, EXUDYN}"), "Problems": ("string", "{arc_100, elastica}"), "Orders": ("int", "{2, 8}"),
         "Elements": ("int", "{1, 8}"), "Chain": ("int", "{100}")}


class Peers(InFolder):
    def setUp(self):
        super().setUp()
        self.folder = self.folder / "peers"
        self.folder.mkdir()

    def study(self, program=BIN / "peers", **changes):
        """The program on a scene with a small study."""
        entries = [f'<Parameter name="{name}" type="Array({kind})" value="{value}"/>'
                   for name, (kind, value) in {**STUDY, **changes}.items()]
        scene = (ROOT / "apps/peers/peers.xml").read_text().rstrip().removesuffix("</ParameterList>")
        (self.folder / "peers.xml").write_text(f'{scene}<ParameterList name="Study"><Parameter name="Rounds" type="int" value="1"/>'
                                               f'{"".join(entries)}</ParameterList></ParameterList>')
        return subprocess.run([program, self.folder / "peers.xml", "--output", self.folder, "--summary",
                               self.folder / "summary.json"], text=True, capture_output=True, check=False, cwd=self.folder)

    def test_measures_mixbeam_and_leaves_out_what_is_not_there(self):
        ended = self.study()
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
        self.assertIn("EXUDYN is left out", ended.stdout)
        self.assertEqual([row["version"] == "not importable" for row in self.rows("programs.csv")], [False, True])
        rows = {(row["setting"], row["problem"], row["order"], row["elements"]): row for row in self.rows("peers.csv")}
        self.assertLess(float(rows["mixbeam", "arc_100", "8", "8"]["error"]), 1e-12)
        self.assertGreater(float(rows["mixbeam", "elastica", "2", "1"]["error"]), TOO_SOFT)
        self.assertEqual({row["elements"] for row in self.rows("growth.csv")}, {"100"})
        subprocess.run([sys.executable, ROOT / "apps/plots/plot_all.py", self.folder.parent, "--only", "peers"], check=True,
                       capture_output=True, env={**os.environ, "MPLBACKEND": "Agg"})
        self.assertTrue((self.folder / "peers.png").exists())
        page = (self.folder / "peers.md").read_text()
        for part in ("# Beside other programs", "| EXUDYN | not importable | not in Debian | - |"):
            self.assertIn(part, page)
        for problem in "arc_100", "elastica":  # which mesh is the cheapest is a matter of time
            self.assertRegex(page, rf"\| {problem} \| mixbeam( \| [\d.]+ ms \(\d x \d, 1, \d+\)){{4}} \|")

    def test_a_wrong_truth_is_noticed(self):
        """Twin: a copy of the program that believes another tip of the arc, by a millionth."""
        copy = self.folder / "bin"
        copy.mkdir()
        shutil.copy(BIN / "peers", copy)
        shutil.copytree(BIN / "studies", copy / "studies")
        (self.folder / "python").symlink_to(PACKAGES)
        problems = copy / "studies/peer_problems.py"
        text = problems.read_text()
        self.assertIn("53.4748587", text)
        problems.write_text(text.replace("53.4748587", "53.4749187"))
        ended = self.study(copy / "peers", Programs=("string", "{mixbeam}"))
        self.assertEqual(ended.returncode, FAILED, ended.stdout + ended.stderr)
        self.assertIn("FAIL  Accuracy 1e-06, arc_100", ended.stdout)
        self.assertNotIn("FAIL  Accuracy 1e-06, elastica", ended.stdout)

    def test_unknown_problems_are_refused(self):
        ended = self.study(Problems=("string", "{roll_up}"))
        self.assertEqual(ended.returncode, 2)
        self.assertIn("roll_up_100", ended.stderr)


if __name__ == "__main__":
    unittest.main()
