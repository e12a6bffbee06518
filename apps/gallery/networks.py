#!/usr/bin/env python3
"""Writes the networks of the gallery as tables: KIND_points.csv and KIND_members.csv in FOLDER.

networks.py KIND FOLDER [--size N] [--thickness T] [--seed S]

honeycomb_crushed   N x N hexagonal cells of walls of length 1, their points shifted at random by up to 0.5 % of the
                    thickness T of the walls; low_*, high_*: the points of the lower and the upper edge
octet               N x N x N cells of an octet truss, struts of length sqrt(2) / 2; low_*, high_*: below and on top
fibres              straight fibres at random in a square of side 1, N * N of them of length 0.4, joined where they cross
                    and cut off where they leave the square; left_*, right_*: on its edges. Points lie on a grid of 0.01
"""
import argparse
import csv
import itertools
import math
import pathlib
import random


class Network:
    """Points, unique by position, and members between two of them."""

    def __init__(self):
        self.names, self.places, self.members = {}, [], []

    def point(self, place, kind="p"):
        key = tuple(round(x, 9) for x in place)
        if key not in self.names:
            self.names[key] = f"{kind}_{len(self.names)}"
            self.places.append(list(place))
        return self.names[key]

    def member(self, a, b):
        if a != b and (a, b) not in self.members and (b, a) not in self.members:
            self.members.append((a, b))

    def write(self, folder, kind):
        used = {name for member in self.members for name in member}
        with open(folder / f"{kind}_points.csv", "w", newline="") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow(("name", "x", "y", "z"))
            for name, place in zip(self.names.values(), self.places):
                if name in used:
                    rows.writerow((name, *(f"{x:.12g}" for x in place)))
        with open(folder / f"{kind}_members.csv", "w", newline="") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow(("name", "start", "end"))
            rows.writerows((f"m{i}", *member) for i, member in enumerate(self.members))
        print(f"{len(used)} points, {len(self.members)} members")


def honeycomb(size, thickness, numbers):
    network, shift = Network(), 0.005 * thickness
    width, height, top = math.sqrt(3), 1.5, 1.5 * (size - 1) + 2.0
    for row, column in itertools.product(range(size), range(size)):
        x, y = width * (column + 0.5 * (row % 2)), height * row + 1.0
        corners = []
        for k in range(6):
            angle = math.pi / 2 + k * math.pi / 3
            place = (x + math.cos(angle), y + math.sin(angle), 0.0)
            edge = "low" if place[1] < 1e-6 else "high" if place[1] > top - 1e-6 else "p"
            corners.append(network.point(place, edge))
        for a, b in zip(corners, corners[1:] + corners[:1]):
            network.member(a, b)
    for name, place in zip(network.names.values(), network.places):
        if name.startswith("p"):
            place[0] += numbers.uniform(-shift, shift)
            place[1] += numbers.uniform(-shift, shift)
    return network


def octet(size):
    network = Network()

    def point(place):
        return network.point(place, "low" if place[2] == 0 else "high" if place[2] == size else "p")

    halves = range(2 * size + 1)
    places = [tuple(c / 2 for c in p) for p in itertools.product(halves, halves, halves) if sum(p) % 2 == 0]
    inside = set(places)
    for p in places:
        for i, j in ((0, 1), (0, 2), (1, 2)):
            for sign in (1, -1):
                q = list(p)
                q[i] += 0.5
                q[j] += 0.5 * sign
                if tuple(q) in inside and not (p[2] == q[2] and p[2] in (0, size)):
                    network.member(point(p), point(tuple(q)))
    return network


def crossing(a, b):
    """Returns the crossing of two lines as shares of their lengths; None if they do not cross."""
    (x0, y0, x1, y1), (u0, v0, u1, v1) = a, b
    determinant = (x1 - x0) * (v1 - v0) - (y1 - y0) * (u1 - u0)
    if abs(determinant) < 1e-12:
        return None
    s = ((u0 - x0) * (v1 - v0) - (v0 - y0) * (u1 - u0)) / determinant
    t = ((u0 - x0) * (y1 - y0) - (v0 - y0) * (x1 - x0)) / determinant
    return (s, t) if 0 <= s <= 1 and 0 <= t <= 1 else None


def fibres(size, numbers, length=0.4):
    edges = ((0, 0, 0, 1), (1, 0, 1, 1))
    lines = []
    for _ in range(size * size):
        x, y, angle = numbers.random(), numbers.random(), math.pi * numbers.random()
        dx, dy = 0.5 * length * math.cos(angle), 0.5 * length * math.sin(angle)
        lines.append((x - dx, y - dy, x + dx, y + dy))
    stops = [[] for _ in lines]  # shares of each line
    for i, j in itertools.combinations(range(len(lines)), 2):
        found = crossing(lines[i], lines[j])
        if found:
            stops[i].append(found[0])
            stops[j].append(found[1])
    for line, own in zip(lines, stops):
        own += [found[0] for edge in edges if (found := crossing(line, edge))]
    network = Network()
    for (x0, y0, x1, y1), own in zip(lines, stops):
        names = []
        for share in sorted(own):
            place = (round(x0 + share * (x1 - x0), 2), round(y0 + share * (y1 - y0), 2), 0.0)
            if 0.0 <= place[0] <= 1.0 and 0.0 <= place[1] <= 1.0:
                names.append(network.point(place, {0.0: "left", 1.0: "right"}.get(place[0], "p")))
        for a, b in zip(names, names[1:]):
            network.member(a, b)
    return without_islands(network)


def without_islands(network):
    """Removes members that are not connected to the left edge."""
    neighbours = {}
    for a, b in network.members:
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    reached, ahead = set(), [name for name in neighbours if name.startswith("left")]
    while ahead:
        name = ahead.pop()
        if name not in reached:
            reached.add(name)
            ahead += neighbours[name]
    network.members = [member for member in network.members if member[0] in reached]
    return network


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=("honeycomb_crushed", "octet", "fibres"))
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--size", type=int, default=20)
    parser.add_argument("--thickness", type=float, default=0.1)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    numbers = random.Random(asked.seed)
    made = {"honeycomb_crushed": lambda: honeycomb(asked.size, asked.thickness, numbers),
            "octet": lambda: octet(asked.size), "fibres": lambda: fibres(asked.size, numbers)}[asked.kind]()
    made.write(asked.folder, asked.kind)


if __name__ == "__main__":
    main()
