#!/usr/bin/python3
"""Parameters as data for programs, and the schemas of scenes: every parameter is in them, and the language server of VS Code's
YAML extension completes, explains and marks by them.

usage: schema_test.py MIXBEAM
"""

import json
import os
import re
import shutil
import subprocess
import unittest
from pathlib import Path
from xml.etree import ElementTree

from support import PROGRAM, InFolder

LEAST_PARAMETERS = 200
SERVER = Path(PROGRAM).parents[1] / "yaml-language-server/node_modules/yaml-language-server/bin/yaml-language-server"
SCENE = """\
Scene:
  Points: {wall: [0, 0, 0], tip: [1, 0, 0]}
  Members:
    beam: {Start: wall, End: tip, Elments: 4}
  Point Loads:
    weight:
      Point: tip
      FRAME
"""


class Server:
    def __init__(self, program):
        self.process = subprocess.Popen(["node", program, "--stdio"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.requests = 0

    def send(self, **message):
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        self.process.stdin.flush()

    def receive(self):
        length = 0
        while line := self.process.stdout.readline().strip():
            name, value = line.split(b":", 1)
            if name.lower() == b"content-length":
                length = int(value)
        assert length, "the language server has ended"
        return json.loads(self.process.stdout.read(length))

    def wait_for(self, is_wanted):
        while True:
            message = self.receive()
            if "method" in message and "id" in message:
                self.send(id=message["id"], result=None)
            elif is_wanted(message):
                return message

    def ask(self, method, params):
        self.requests += 1
        number = self.requests
        self.send(id=number, method=method, params=params)
        return self.wait_for(lambda message: message.get("id") == number)["result"]


def count_of(listed, place, step):
    """Of the parameters in what `mixbeam parameters --json` says of a list, each of which step(place, name, is_list) has found in
    a schema; names that the user gives are empty."""
    free = listed.get("free_names", {})
    names = [one["name"] for one in listed["parameters"]] + [""] * ("parameter" in free)
    for name in names:
        step(place, name, False)
    inner = [(one, one["name"]) for one in listed["lists"]] + [(one, "") for one in [free.get("list")] if one]
    return len(names) + sum(count_of(one, step(place, name, True), step) for one, name in inner)


class Schema(InFolder):
    def setUp(self):
        super().setUp()
        self.parameters = json.loads(self.mixbeam("parameters", "--json"))

    def test_parameters_as_json(self):
        named = lambda entries, name: next(one for one in entries if one["name"] == name)
        loads = named(named(self.parameters["lists"], "Scene")["lists"], "Point Loads")
        self.assertEqual((loads["path"], loads["program_name"]), (["Scene", "Point Loads"], "point_loads"))
        self.assertEqual(named(loads["free_names"]["list"]["parameters"], "Force"), {
            "name": "Force", "type": "Array(double)", "presence": "default", "length": 3, "program_name": "force",
            "default": [0.0, 0.0, 0.0], "unit": "force", "meaning": "Force [force]."})
        self.mixbeam("parameters", "--json", "--markdown", code=2)

    def test_every_parameter_of_the_text_is_in_the_json(self):
        """All of the text has it, so a parameter that one of the schemas leaves out is noticed."""
        lines = re.findall(r"^ +[A-Za-z<][A-Za-z0-9 <>]*: (?:bool|int|double|string|Array\()", self.mixbeam("parameters"), re.M)
        count = count_of(self.parameters, None, lambda *_: None)
        self.assertEqual(count, len(lines))
        self.assertGreater(count, LEAST_PARAMETERS)

    def test_every_parameter_is_in_the_json_schema(self):
        def step(listed, name, _):
            place = listed["properties"][name] if name else listed["additionalProperties"]
            self.assertTrue(place["description"], name)
            return place

        count_of(self.parameters, json.loads(self.mixbeam("schema", "--json")), step)
        with self.assertRaises(KeyError):
            step({"properties": {}}, "Scene", True)

    def test_every_parameter_is_in_the_relax_ng_schema(self):
        tree = ElementTree.fromstring(re.sub(' xmlns="[^"]*"', "", self.mixbeam("schema"), count=1))

        def step(listed, name, is_list):
            for one in listed.findall("./zeroOrMore/choice/element"):
                called = one.find("./attribute[@name='name']")
                if one.get("name") == ("ParameterList" if is_list else "Parameter") and called.findtext("value", "") == name:
                    return one
            raise AssertionError(f'"{name}" is not in the schema')

        count_of(self.parameters, tree.find("./start/element"), step)
        with self.assertRaises(AssertionError):
            step(tree.find("./start/element"), "Scenes", True)

    def test_the_language_server_completes_explains_and_marks(self):
        if not SERVER.exists() or not shutil.which("node"):
            self.assertFalse(os.environ.get("CI") and not os.environ.get("MIXBEAM_TOOLS_MISSING"))
            self.skipTest("no language server or node (./test.sh gets both)")
        (self.folder / "schema.json").write_text(self.mixbeam("schema", "--json"))
        server, document = Server(str(SERVER)), {"uri": "file:///scene.yaml"}
        server.ask("initialize", {"processId": None, "rootUri": None, "capabilities": {}})
        server.send(method="initialized", params={})
        settings = {"yaml": {"completion": True, "hover": True, "validate": True}}
        server.send(method="workspace/didChangeConfiguration", params={"settings": settings})

        def shown(line):
            return f"# yaml-language-server: $schema={self.folder / 'schema.json'}\n" + SCENE.replace("FRAME", line)

        def labels_at(line):
            """Of what is offered at the end of this line."""
            server.send(method="textDocument/didChange", params={
                "textDocument": {**document, "version": len(line)}, "contentChanges": [{"text": shown(line)}]})
            position = {"line": 8, "character": 6 + len(line)}
            return [item["label"] for item in
                    server.ask("textDocument/completion", {"textDocument": document, "position": position})["items"]]

        server.send(method="textDocument/didOpen", params={
            "textDocument": {**document, "languageId": "yaml", "version": 1, "text": shown("Frame: dead")}})
        marked = server.wait_for(lambda message: message.get("method") == "textDocument/publishDiagnostics")["params"]["diagnostics"]
        self.assertEqual([(mark["range"]["start"]["line"], mark["message"]) for mark in marked], [(4, "Property Elments is not allowed.")])
        hover = server.ask("textDocument/hover", {"textDocument": document, "position": {"line": 4, "character": 12}})
        self.assertIn("Name of the point where the member starts", json.dumps(hover["contents"]))
        names = labels_at("F")
        for name in ("Frame", "Force", "Moment", "Amplitude"):
            self.assertEqual(names.count(name), 1, name)
        self.assertEqual(labels_at("Frame: "), ["dead", "follower"])
        server.ask("shutdown", None)
        server.send(method="exit")
        server.process.communicate()


if __name__ == "__main__":
    unittest.main()
