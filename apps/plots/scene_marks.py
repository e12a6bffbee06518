"""Places of supports and loads, as far as the scene text inside a result file and the member ends tell them."""

import re
from xml.etree import ElementTree

import numpy as np


class Marks:
    """Sample numbers at which a picture shows supports, and (sample number, direction) of point forces."""

    def __init__(self, run, load_factor):
        self.supports, self.forces = [], []
        try:
            scene = _child(ElementTree.fromstring(run.scene_text() or "<none/>"), "Scene")
        except ElementTree.ParseError:
            return
        if scene is None:
            return
        places = _point_samples(scene, run)
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


def _point_samples(scene, run):
    """First or last sample of a member that starts or ends at the point."""
    members = {member.name: member for member in run.members}
    places = {}
    for member in _lists(_child(scene, "Members")):
        samples = members.get(member.get("name"))
        if samples is None:
            continue
        places.setdefault(_value(member, "Start", ""), samples.samples.start)
        places.setdefault(_value(member, "End", ""), samples.samples.stop - 1)
    places.pop("", None)
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
    try:
        values = [float(number) for number in _value(node, name, "").strip("{} ").split(",")]
    except ValueError:
        return None
    return np.array(values) if len(values) == 3 else None
