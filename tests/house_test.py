"""Rules of the house that no compiler checks: equations cited in the sources stand in apps/docs/theory.md, and includes
keep the order of folders and rooms, comments begin with a verb or a noun."""
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
PRODUCT = ("kernels", "discretization", "nonlinear", "apps")

# Folders and their rooms: includes point to the same room or to what stands before it.
ROOMS = {
    "kernels": "execution math element condensation planar loops vibration chains",
    "discretization": "text parameters geometry scene stresses mesh checks reading constraints linear_system assembly"
                      " state quantities results",
    "nonlinear": "parameters linear multilevel newton stability sensitivity diagnosis path accuracy run",
    "apps/common": "tables session run studies",
}
ORDER = [f"{folder}/{room}/" for folder, rooms in ROOMS.items() for room in rooms.split()]
PLAIN_STRUCTS = "discretization/scene/scene.hpp"  # every room of its folder may include them
GENERATED = "mixbeam/"  # headers that the build writes


def citation_faults(page, sources):
    """What is wrong with the numbers of equations, which begin a line of the page as **(7)**, and their citations."""
    equations = [int(number) for number in re.findall(r"^\*\*\((\d+)\)", page, re.M)]
    faults = [f"equation ({number}) is out of order" for i, number in enumerate(equations) if number != i + 1]
    prose = "".join(page.split("$")[::2])  # without formulas
    faults += [f"the page refers to ({n})" for n in re.findall(r"\((\d+)\)", prose) if int(n) not in equations]
    cited = set()
    for path, text in sources.items():
        joined = " ".join(line.lstrip(" \t/") for line in text.splitlines())  # a citation may be broken anywhere
        for number in map(int, re.findall(r"heory \((\d+)\)", joined)):
            cited.add(number)
            if number not in equations:
                faults.append(f"{path} cites ({number})")
    return faults + [f"nobody cites ({number})" for number in sorted(set(equations) - cited)]


def folder_of(path):
    return next((folder for folder in ROOMS if path.startswith(folder + "/")), None)


def room_of(path):
    return next((i for i, room in enumerate(ORDER) if path.startswith(room)), None)


def may_include(path, include):
    to = room_of(include)
    if include.startswith(GENERATED):
        return True
    return to is not None and (to <= room_of(path) or (
        include == PLAIN_STRUCTS and folder_of(path) == "discretization"))


def room_faults(sources):
    faults = []
    for path, text in sources.items():
        if folder_of(path) is None:  # programs are free
            continue
        if room_of(path) is None:
            faults.append(f"{path} is in no room")
            continue
        faults += [f"{path} includes {include}" for include in re.findall(r'^#include "([^"]*)"', text, re.M)
                   if not may_include(path, include)]
    return faults


def offset_faults(sources):
    """Host code that computes the place of an element's numbers in an array by itself."""
    return [f"{path} uses {offset}" for path, text in sources.items() for offset in ("interior_offset", "increment_offset")
            if not path.startswith("kernels/") and path != "discretization/mesh/structure.cpp" and offset in text]


NO_SUBJECT = re.compile(r"(?:What|Of|As|Those|The same|By what)\b|.*?[.] What (?:is|are|has|have|was|were)\b")


def word_faults(sources):
    """Comments that begin with no verb and no noun, but with `what` or `of`."""
    faults = []
    for path, text in sources.items():
        before = None
        for number, line in enumerate(text.splitlines(), 1):
            comment = re.match(r'(\s*|[^"]*)//[/<]* (.*)', line)
            begins = comment and not (before and comment[1].strip() == "")
            if begins and NO_SUBJECT.match(comment[2]):
                faults.append(f"{path}:{number}: {comment[2]}")
            before = comment
    return faults


def sources_of(folders):
    files = (file for folder in folders for file in sorted((ROOT / folder).rglob("*")))
    return {str(file.relative_to(ROOT)): file.read_text() for file in files
            if file.is_file() and file.name.endswith((".hpp", ".cpp", ".cpp.in"))}


class House(unittest.TestCase):
    maxDiff = None

    def test_equations_cited_stand_on_the_page(self):
        page = (ROOT / "apps/docs/theory.md").read_text()
        self.assertIn("**(1)**", page)
        self.assertEqual(citation_faults(page, sources_of((*PRODUCT, "tests"))), [])

    def test_wrong_citations_are_found(self):
        page = "By (2), not $f(9)$:\n\n**(1)** $a = b$\n\n**(2)** $c = d$\n"
        good = {"good.hpp": "/// Theory (1) and theory\n  /// (2), but no theory of (3)\n"}
        self.assertEqual(citation_faults(page, good), [])
        self.assertEqual(citation_faults(page, {**good, "bad.hpp": "// theory (3)\n"}), ["bad.hpp cites (3)"])
        self.assertEqual(citation_faults(page, {"half.hpp": "// theory (1)\n"}), ["nobody cites (2)"])
        gap = "See (4).\n\n**(1)** $a = b$\n\n**(3)** $c = d$\n"
        self.assertEqual(citation_faults(gap, {"all.hpp": "// theory (1), theory (3)\n"}),
                         ["equation (3) is out of order", "the page refers to (4)"])

    def test_includes_keep_the_order_of_rooms(self):
        sources = sources_of(PRODUCT)
        for room in ORDER:
            self.assertTrue(any(path.startswith(room) for path in sources), f"{room} is empty")
        self.assertEqual(room_faults(sources), [])

    def test_wrong_includes_are_found(self):
        for path, include in (("kernels/planar/a.hpp", "kernels/element/b.hpp"),
                              ("nonlinear/linear/a.cpp", "discretization/results/b.hpp"),
                              ("discretization/text/a.hpp", PLAIN_STRUCTS),
                              ("apps/common/run/a.cpp", "mixbeam/version.hpp"), ("apps/trade/a.cpp", "apps/fork/b.hpp")):
            self.assertEqual(room_faults({path: f'#include <vector>\n#include "{include}"\n'}), [])
        for path, include in (("kernels/element/a.hpp", "kernels/planar/b.hpp"),
                              ("discretization/text/a.hpp", "discretization/scene/names.hpp"),
                              ("discretization/results/a.cpp", "nonlinear/parameters/b.hpp"),
                              ("kernels/math/a.hpp", PLAIN_STRUCTS), ("apps/common/run/a.cpp", "apps/trade/b.hpp"),
                              ("kernels/math/a.hpp", "small_algebra.hpp")):
            self.assertEqual(room_faults({path: f'#include "{include}"\n'}), [f"{path} includes {include}"])
        for path in ("kernels/a.hpp", "nonlinear/attic/a.hpp"):
            self.assertEqual(room_faults({path: '#include "kernels/math/b.hpp"\n'}), [f"{path} is in no room"])

    def test_numbers_of_elements_are_reached_through_the_element_view(self):
        self.assertEqual(offset_faults(sources_of(PRODUCT)), [])
        self.assertEqual(offset_faults({"nonlinear/run/a.cpp": "x = block.interior_offset + e;",
                                        "kernels/a.cpp": "interior_offset"}), ["nonlinear/run/a.cpp uses interior_offset"])

    def test_comments_begin_with_a_verb_or_a_noun(self):
        self.assertEqual(word_faults(sources_of(PRODUCT)), [])
        good = "/// Solves the system.\n/// Of two solutions the smaller one counts.\nint i;  // number\n  /// Number of rows.\n"
        self.assertEqual(word_faults({"kernels/a.hpp": good}), [])
        for bad in ("/// What is left.", "int i;  ///< Of all rows.", "  // As in solve().", "/// Rows. What is zero is left out."):
            self.assertEqual(len(word_faults({"kernels/a.hpp": bad})), 1, bad)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
