"""What the language server of VS Code's YAML extension says of a scene: language_server.py SERVER SCHEMA, prints JSON."""
import json
import subprocess
import sys

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
        if length == 0:
            raise SystemExit("the language server has ended")
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


def main():
    server = Server(sys.argv[1])
    document = {"uri": "file:///scene.yaml"}
    server.ask("initialize", {"processId": None, "rootUri": None, "capabilities": {}})
    server.send(method="initialized", params={})
    settings = {"yaml": {"completion": True, "hover": True, "validate": True}}
    server.send(method="workspace/didChangeConfiguration", params={"settings": settings})

    def shown(line):
        return f"# yaml-language-server: $schema={sys.argv[2]}\n" + SCENE.replace("FRAME", line)

    def labels_at(line):
        """Of what is offered at the end of this line."""
        server.send(method="textDocument/didChange", params={
            "textDocument": {**document, "version": len(line)}, "contentChanges": [{"text": shown(line)}]})
        position = {"line": 8, "character": 6 + len(line)}
        return [item["label"] for item in
                server.ask("textDocument/completion", {"textDocument": document, "position": position})["items"]]

    server.send(method="textDocument/didOpen", params={
        "textDocument": {**document, "languageId": "yaml", "version": 1, "text": shown("Frame: dead")}})
    marked = server.wait_for(lambda message: message.get("method") == "textDocument/publishDiagnostics")
    hover = server.ask("textDocument/hover", {"textDocument": document, "position": {"line": 4, "character": 12}})
    print(json.dumps({
        "marks": [[mark["range"]["start"]["line"], mark["message"]] for mark in marked["params"]["diagnostics"]],
        "hover": json.dumps(hover["contents"]), "names": labels_at("F"), "words": labels_at("Frame: ")}))
    server.ask("shutdown", None)
    server.send(method="exit")


if __name__ == "__main__":
    main()
