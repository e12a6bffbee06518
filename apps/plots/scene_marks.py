"""Places of supports and loads, as far as the scene text inside a result file and the member ends tell them."""

import re
from xml.etree import ElementTree

import numpy as np

SAME_PLACE = 1e-6  # of the extent: farther from a point than this, a sample is another place
MOST_POINTS = 500  # looked up by coordinates, each in one pass over all samples


class Marks:
    """Sample numbers at which a picture shows supports, and (sample number, direction) of point forces."""

    def __init__(self, run, load_factor, reference):
        self.supports, self.forces = [], []
        try:
            scene = _child(ElementTree.fromstring(run.scene_text() or "<none/>"), "Scene")
        except ElementTree.ParseError:
            return
        if scene is None:
            return
        places = _point_samples(scene, run, reference)
        for support in _lists(_child(scene, "Supports")):
            self.supports += [sample for _, sample in _matches(places, support)]
        for load in _lists(_child(scene, "Point Loads")):
            if int(_value(load, "Stage", "1")) - 1 >= load_factor:
                continue  # its stage has not begun
            if _value(load, "Frame", "dead").lower() != "dead":
                continue  # its direction is in a triad, which the text does not tell
            for _, sample in _matches(places, load):
                _keep(self.forces, sample, _vector(load, "Force"))


def _keep(marks, sample, vector):
    if vector is not None and np.linalg.norm(vector) > 0:
        marks.append((sample, vector / np.linalg.norm(vector)))


def _point_samples(scene, run, reference):
    """First or last sample of a member that starts or ends at the point; else the sample at the point's coordinates.

    Points that only patterns or tables make are not found: the text does not name them.
    """
    members = {member.name: member for member in run.members}
    places = {}
    for member in _lists(_child(scene, "Members")):
        samples = members.get(member.get("name"))
        if samples is None:
            continue
        places.setdefault(_value(member, "Start", ""), samples.samples.start)
        places.setdefault(_value(member, "End", ""), samples.samples.stop - 1)
    places.pop("", None)
    near = SAME_PLACE * np.ptp(reference, axis=0).max()
    points = _child(scene, "Points")
    for point in ([] if points is None else list(points))[:MOST_POINTS]:
        position = _numbers(point.get("value", ""))
        if position is None or point.get("name") in places:
            continue
        distance = np.linalg.norm(reference - position, axis=1)
        if distance.min() <= near:
            places[point.get("name")] = int(distance.argmin())
    return places


def _child(node, name):
    return None if node is None else next((child for child in node if child.get("name") == name), None)


def _lists(node):
    return [] if node is None else [child for child in node if child.tag == "ParameterList"]


def _value(node, name, default):
    child = _child(node, name)
    return default if child is None else child.get("value", default)


def _matches(places, node):
    """(name, sample) of the points that the "Point" of a support or load means; * stands for any characters."""
    pattern = re.compile(".*".join(re.escape(part) for part in _value(node, "Point", "").split("*")), re.DOTALL)
    return [(name, sample) for name, sample in places.items() if pattern.fullmatch(name)]


def _vector(node, name):
    return _numbers(_value(node, name, ""))


def _numbers(text):
    """The three numbers of "{1, 2, 3}"; None for anything else."""
    try:
        values = [float(number) for number in text.strip("{} ").split(",")]
    except ValueError:
        return None
    return np.array(values) if len(values) == 3 else None
