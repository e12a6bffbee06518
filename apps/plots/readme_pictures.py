#!/usr/bin/python3 -Es
"""Draws the pictures of the README (six scenes, accuracy, speed), of the first hour and of the page of verification.

    readme_pictures.py RESULTS DOCS [--only scenes accuracy speed first_hour benchmarks]

scenes:   RESULTS/gallery/<scene>/ as written by run.sh, drawn by the pages of `mixbeam view` in Debian's
          chromium-headless-shell: true sections, coloured by von Mises stress, each scene from none (dark) to its own largest
          (yellow); grey: undeformed
accuracy: RESULTS/helix/convergence.csv
speed:    the table of DOCS/performance.md
first_hour: the scenes of DOCS/first_hour.md, solved by the program beside this folder
benchmarks: four figures RESULTS/<benchmark>/*.png, two in a row
"""

import argparse
import base64
import io
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import yaml
from PIL import Image, ImageDraw, ImageFont

import helix
import style
from command import InputError

# result file: elevation and azimuth of the camera [degrees], and whether the undeformed structure is shown
SCENES = {
    "coil_spring/coil_spring": ((15, -60), True),
    "gridshell/gridshell-drift": ((32, -55), False),
    "honeycomb/honeycomb": ((50, -80), False),
    "robot_finger/robot_finger": ((20, -60), True),
    "spoked_wheel/spoked_wheel": ((20, -45), False),
    "star_dome/star_dome": ((30, -50), True),
}
BENCHMARKS = (
    (("superimposed_rotation/snapshots.png", "objectivity: a bent rod turned ten times"),
     ("helix/shapes.png", "helix: exact tip with 5 and 3 elements")),
    (("slope_discontinuity/configurations.png", "kinked frame under growing load"),
     ("fork/shapes.png", "fork under one force and under a couple")))
BENCHMARKS_WIDTH, BENCHMARKS_TITLE = 14.0, 0.5  # inches
COLUMNS, WIDTH, HEIGHT, TITLE, FINENESS = 3, 400, 270, 32, 2  # panels in a row, sizes of one [pixels], supersampling
FIGURE_WIDTH = 1200  # pixels
FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"
BROWSER = ("chromium-headless-shell", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
SECONDS = 120
PROGRAM = Path(__file__).resolve().parents[1] / "mixbeam"
# The browser dumps a document when it is loaded; an open document in a frame holds that back until the picture is drawn.
DRAW = """const hold = document.createElement("iframe");
document.body.append(hold);
hold.contentDocument.open();
mixbeamStart.then(() => {{
  const {{ mixbeamView: app }} = window;
  Object.assign(document.getElementById("stage").style, {{ position: "fixed", left: 0, top: 0, width: "{width}px", height: "{height}px" }});
  app.look("light");
  app.resize();
  const draw = () => {{
    app.painter.draw(app.shape, app.view());
    return app.painter.canvas.toDataURL("image/png");
  }};
  document.body.append(({show})());
  hold.contentDocument.close();
  hold.remove();
}});"""


# The structure alone, seen from a given direction.
PANEL = """() => {{
  document.getElementById("ghost").checked = {ghost};
  app.camera.look({elevation}, {azimuth});
  app.camera.fit([...app.result.hull], [40, 40, 30, 30]);
  return draw();
}}"""


def drawn(path, width, height, show, folder, fineness=1):
    """Returns the picture that `show`, JavaScript returning a data URL, makes of the page of a result, supersampled."""
    page = folder / "page.html"
    page.unlink(missing_ok=True)
    subprocess.run([PROGRAM, "view", path, "-o", page], check=True, stdout=subprocess.DEVNULL)
    script = DRAW.format(width=width * fineness, height=height * fineness, show=show)
    page.write_text(page.read_text(encoding="utf-8").replace("</body>", f"<script>{script}</script></body>"), encoding="utf-8")
    shown = browse("--dump-dom", page.as_uri()).stdout
    found = re.search(r"data:image/png;base64,([\w+/=]+)", shown)
    if not found:
        raise InputError(f"{path}: the browser drew nothing")
    return Image.open(io.BytesIO(base64.b64decode(found[1]))).resize((width, height), Image.LANCZOS)


def browse(*options):
    return subprocess.run([*BROWSER, *options], capture_output=True, text=True, timeout=SECONDS, check=True)


def scenes(results, docs):
    rows = -(-len(SCENES) // COLUMNS)
    whole = Image.new("RGB", (COLUMNS * WIDTH, rows * (HEIGHT + TITLE)), "white")
    pen, font = ImageDraw.Draw(whole), ImageFont.truetype(FONT, 17)
    with tempfile.TemporaryDirectory() as folder:
        for i, (name, (camera, ghost)) in enumerate(SCENES.items()):
            x, y = i % COLUMNS * WIDTH, i // COLUMNS * (HEIGHT + TITLE)
            show = PANEL.format(ghost=str(ghost).lower(), elevation=camera[0], azimuth=camera[1])
            whole.paste(drawn(results / "gallery" / f"{name}.h5", WIDTH, HEIGHT, show, Path(folder), FINENESS), (x, y + TITLE))
            pen.text((x + WIDTH / 2, y + TITLE / 2), name.split("/")[0].replace("_", " "), "#444", font, "mm")
    save(whole, docs / "readme_scenes.png")


def save(picture, path):
    """Writes a picture with few colours, which takes a third of the bytes."""
    picture.convert("RGB").quantize(128, dither=Image.Dither.NONE).save(path, optimize=True)


def save_figure(canvas, path):
    picture = Image.open(style.save(canvas, path))
    save(picture.resize((FIGURE_WIDTH, round(picture.height * FIGURE_WIDTH / picture.width)), Image.LANCZOS), path)


def accuracy(results, docs):
    save_figure(helix.convergence_figure(results / "helix"), docs / "readme_accuracy.png")


def speed(_, docs):
    text = (docs / "performance.md").read_text(encoding="utf-8")
    rows = {cells[1].strip().strip("*"): cells[2:-1] for cells in (line.split("|") for line in text.splitlines() if line.startswith("| "))}
    numbers = {name: np.array(cells, dtype=float).reshape(-1, 3)[:, 0] for name, cells in rows.items() if "ms" not in "".join(cells)}
    speed_up = np.array(rows["whole iteration"], dtype=float).reshape(-1, 3)[:, 2]
    whole, planar = numbers["whole iteration"], numbers["whole iteration, planar chain"]
    orders = np.arange(1, len(whole) + 1)
    parts = {"elements: residual, tangent, interior": sum(numbers[name] for name in (
        "residual of the elements", "condensed tangent of the elements", "interior of the elements")),
             "linear solver and its check": numbers["linear solver, all of it"]}
    parts["rest"] = whole - sum(parts.values())
    unit = int(re.search(r"(\d+) ms, measured", text)[1])
    canvas, ((axes,),) = style.figure(11, 3.2, squeeze=False)
    bottom = np.zeros(len(whole))
    for (label, height), color in zip(parts.items(), (style.BLUE, style.SKY, style.GREY)):
        axes.bar(orders - 0.27, height, 0.25, bottom, color=color, label=f"1 thread: {label}")
        bottom += height
    axes.bar(orders, whole / speed_up, 0.25, color=style.GREEN, label="2 threads")
    axes.bar(orders + 0.27, planar, 0.25, color=style.ORANGE, label="1 thread, in a plane")
    axes.axhline(unit, color=style.BLACK, linestyle="--", label="LAPACK's band solver, same size")
    axes.set_xticks(orders, [f"k = {k}" for k in orders])
    axes.set_ylabel("milliseconds")
    axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
    save_figure(canvas, docs / "readme_speed.png")


def merge(whole, more):
    """Adds the entries of lists to the lists of the same names; an entry replaces an existing one."""
    for name, value in more.items():
        if isinstance(value, dict) and isinstance(whole.get(name), dict) and "Point" not in value:
            merge(whole[name], value)
        else:
            whole[name] = value


def first_hour(_, docs):
    """Draws a picture of each step, by its commands."""
    scene, pictures = {}, docs / "first_hour"
    steps = re.findall("```yaml\n(.*?)```", (docs / "first_hour.md").read_text(encoding="utf-8"), re.S)
    deformed = """() => { app.camera.look(0, -90); app.setScale(20); app.fit(); return app.picture(); }"""
    mode = """() => { app.camera.look(20, -60); app.fit(); app.showMode(0); app.camera.look(20, -60); app.fit(); return app.picture(); }"""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)

        def mixbeam(*words):
            subprocess.run([PROGRAM, *words], cwd=folder, check=True, stdout=subprocess.DEVNULL)

        for number, step in enumerate(steps, 1):
            merge(scene, yaml.safe_load(step))
            (folder / "frame.yaml").write_text(yaml.safe_dump(scene, sort_keys=False), encoding="utf-8")
            mixbeam("run", "frame.yaml", "--quiet")
            results = folder / "results/frame"
            leads = results / "frame-snow leads.h5"
            if number <= 2:
                picture = drawn(results / "frame.h5", 800, 400, deformed, folder)
            elif number == 3:
                mixbeam("plot", leads, "--picture", "diagrams", "--format", "png", "--dots", "90", "-o", ".")
                picture = Image.open(folder / "frame-snow leads-diagrams.png")
            elif number == 4:
                mixbeam("plot", results / "frame.h5", "--format", "png", "--dots", "90", "-o", ".")
                picture = Image.open(folder / "frame-envelope.png")
            elif number == 5:
                picture = drawn(leads, 800, 440, mode, folder)
            else:
                mixbeam("report", results / "frame.h5", "-o", "report.html")
                browse(f"--screenshot={folder / 'report.png'}", "--window-size=900,760", "--hide-scrollbars", (folder / "report.html").as_uri())
                picture = Image.open(folder / "report.png")
            save(picture, pictures / f"{number}.png")


def benchmarks(results, docs):
    """Joins figures in rows; those of a row have the same height and fill the width."""
    rows = [[(style.plt.imread(results / name), title) for name, title in row] for row in BENCHMARKS]
    aspects = [[image.shape[1] / image.shape[0] for image, _ in row] for row in rows]
    heights = [BENCHMARKS_WIDTH / sum(row) + BENCHMARKS_TITLE for row in aspects]
    with style.plt.style.context("default"):
        canvas = style.plt.figure(figsize=(BENCHMARKS_WIDTH, sum(heights)))
        bottom = 1.0
        for row, widths, height in zip(rows, aspects, heights):
            bottom -= height / sum(heights)
            left = 0.0
            for (image, title), width in zip(row, widths):
                share = width / sum(widths)
                panel = canvas.add_axes([left, bottom, share, (height - BENCHMARKS_TITLE) / sum(heights)])
                panel.imshow(image, interpolation="lanczos")
                panel.set_title(title, fontsize=13)
                panel.axis("off")
                left += share
        canvas.savefig(docs / "benchmarks.png", dpi=80)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", type=Path)
    parser.add_argument("docs", type=Path)
    pictures = {"scenes": scenes, "accuracy": accuracy, "speed": speed, "first_hour": first_hour, "benchmarks": benchmarks}
    parser.add_argument("--only", nargs="+", choices=pictures, default=list(pictures))
    arguments = parser.parse_args()
    for name in arguments.only:
        try:
            pictures[name](arguments.results, arguments.docs)
        except (InputError, OSError) as error:
            sys.exit(f"readme_pictures.py: {error}")


if __name__ == "__main__":
    main()
