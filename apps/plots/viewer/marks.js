// Marks drawn over the members, with the same size at any zoom: supports, joints, loads, axes, the colour scale.

const ARROW = 46; // pixels of an arrow across the line of sight,
const LINE_ARROW = 34; // and of the largest line load
const FACING = 0.2; // share of its length: an arrow that appears shorter points at the reader
const MOST_LINE_ARROWS = 150;
const MANY_LINE_LOADS = 10;
const MANY_SUPPORTS = 40; // more get small signs
const MOST_MARKS = 20; // of loads: if there are more, one represents all equal ones
const DIAGRAM = 62; // pixels of the largest value
const DIAGRAMS = { axial_force: 0, shear_2: 2, shear_3: 3, torsion: 0, bending_2: 3, bending_3: -2 }; // section axis of positive values; 0: the more visible one
const NARROW = 560; // pixels: a picture up to this width has no title
const CROWD = 300; // more supports are squares, more joints small
const INK = {
  light: { text: "#20262e", soft: "#5b6673", support: "#20262e", force: "#c2410c", moment: "#a21caf", motion: "#047857", named: "#b42318", halo: "#ffffff", positive: "#0072B2", negative: "#D55E00" },
  dark: { text: "#e6eaf0", soft: "#9aa5b4", support: "#dfe5ee", force: "#fb923c", moment: "#e879f9", motion: "#34d399", named: "#ff8a7a", halo: "#15181d", positive: "#56B4E9", negative: "#fb923c" },
};
// Signs below the point at the origin: polylines in units of the sign size.
const SIGNS = {
  clamp: [[[-1, 0], [1, 0]], [[-1, 0], [-1.4, 0.5]], [[-0.3, 0], [-0.7, 0.5]], [[0.4, 0], [0, 0.5]], [[1, 0], [0.6, 0.5]]],
  hinge: [[[0, 0], [-0.8, 1.2], [0.8, 1.2], [0, 0]], [[-1.2, 1.2], [1.2, 1.2]]],
  roller: [[[0, 0], [-0.8, 1.1], [0.8, 1.1], [0, 0]], [[-1.2, 1.5], [1.2, 1.5]]],
  guide: [[[-1.1, 0.2], [1.1, 0.2]], [[-1.1, 0.7], [1.1, 0.7]]],
  spring: [[[0, 0], [0, 0.4], [0.5, 0.6], [-0.5, 0.9], [0.5, 1.2], [-0.5, 1.5], [0, 1.7], [0, 2]]],
};

class Marks {
  constructor(context, result) {
    this.context = context;
    this.result = result;
    this.largestLine = Math.max(...result.line_loads.flatMap((load) => load[1].map(norm)), 1e-300);
  }

  /** Draws all marks; `view` as for the painter, with switches for supports, loads, diagram. */
  draw(shape, view) {
    const { context } = this;
    this.shape = shape;
    this.camera = view.camera;
    this.ink = INK[view.look];
    context.setTransform(view.ratio, 0, 0, view.ratio, 0, 0);
    context.clearRect(0, 0, view.camera.width, view.camera.rows);
    context.lineCap = context.lineJoin = "round";
    if (view.diagram) this.drawDiagram(view.diagram, view.rangeOf(view.diagram)[1]);
    if (view.supports) this.drawSupports();
    if (view.loads) this.drawLoads();
    for (const number of this.result.preview ? this.result.preview.named : []) this.drawNamed(number);
    this.drawAxes();
    if (view.field) this.drawScale(view);
    this.drawTitle(view.words);
  }

  at(sample) {
    return this.camera.project(this.shape.position(sample));
  }

  lines(paths, color, width) {
    const { context } = this;
    context.beginPath();
    for (const path of paths) path.forEach(([x, y], i) => (i === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
    context.strokeStyle = color;
    context.lineWidth = width;
    context.stroke();
  }

  /** Draws a filled or an open circle. */
  circle(x, y, radius, fill, color) {
    const { context } = this;
    context.beginPath();
    context.arc(x, y, radius, 0, 7);
    this.paint(fill, color);
  }

  /** Fills and then strokes the current path, each if there is a colour for it. */
  paint(fill, color, width = 2.2) {
    const { context } = this;
    Object.assign(context, { fillStyle: fill, strokeStyle: color, lineWidth: width });
    if (fill) context.fill();
    if (color) context.stroke();
  }

  /** Sets the style of the next text. */
  letters(font, color, align = "left") {
    Object.assign(this.context, { font, fillStyle: color, textAlign: align, textBaseline: "middle" });
  }

  drawSupports() {
    const { context, result } = this;
    const size = result.supports.length > MANY_SUPPORTS ? 5 : 9;
    for (const [sample, kind] of result.supports) {
      const [x, y] = this.at(sample);
      if (result.supports.length > CROWD) {
        context.fillStyle = this.ink.support;
        context.fillRect(x - 1.5, y - 1.5, 3, 3);
        continue;
      }
      const sign = SIGNS[kind].map((path) => path.map(([a, b]) => [x + size * a, y + 2 + size * b]));
      this.lines(sign, this.ink.halo, 4);
      this.lines(sign, this.ink.support, 1.6);
    }
    for (const [sample, kind] of result.joints) {
      const [x, y] = this.at(sample);
      context.beginPath();
      if (kind === "slider") context.rect(x - 4, y - 4, 8, 8);
      else context.arc(x, y, result.joints.length > CROWD ? 2 : 4.5, 0, 7);
      this.paint(this.ink.halo, this.ink.support, 1.6);
    }
  }

  /** Returns whether a load that begins at a load factor acts in the current state. */
  acts(begins) {
    const { shape, result } = this;
    if (result.preview) return true;
    const factor = shape.modeNumber >= 0 ? result.modes[shape.modeNumber].factor : result.steps[shape.step].factor;
    return begins < Math.abs(factor);
  }

  spatial(vector, follows, sample) {
    return follows ? turned(Array.from(this.shape.triad.subarray(4 * sample, 4 * sample + 4)), vector) : vector;
  }

  /** Groups equal loads, [{ name, loads }]: usually those of one entry of the scene. */
  groups() {
    const found = new Map();
    for (const name of ["forces", "moments", "shifts", "turns", "line_loads"]) {
      for (const load of this.result[name]) {
        const key = JSON.stringify([name, ...load.slice(1)]);
        if (!found.has(key)) found.set(key, { name, loads: [] });
        found.get(key).loads.push(load);
      }
    }
    return [...found.values()];
  }

  drawLoads() {
    const { result, ink } = this;
    if (result.strained.length <= CROWD) for (const number of result.strained) this.drawStrained(number);
    const looks = { forces: [ink.force, 1], moments: [ink.moment, 2], shifts: [ink.motion, 1], turns: [ink.motion, 2] };
    const groups = this.groups();
    const isThinned = groups.reduce((count, { loads }) => count + loads.length, 0) > MOST_MARKS;
    const lines = [];
    for (const { name, loads } of groups) {
      const acting = loads.filter((load) => this.acts(load[load.length - 1]));
      const shown = isThinned && acting.length > 1 ? [acting[acting.length >> 1]] : acting;
      if (name === "line_loads") lines.push(...shown);
      else for (const load of shown) this.drawPointLoad(load, ...looks[name]);
      const sample = shown.length && shown[0][0];
      if (shown.length < acting.length) this.word(`× ${acting.length}`, this.at(Array.isArray(sample) ? sample[sample.length >> 1] : sample), ink.force);
    }
    this.drawLineLoads(lines);
  }

  drawPointLoad([sample, direction, follows], color, heads) {
    const spatial = this.spatial(direction, follows, sample);
    this.arrow(this.at(sample), this.camera.flat(spatial).map((part) => part * ARROW), color, heads, dot(spatial, this.camera.toward));
  }

  /** Draws a section force along all members, in the plane of its section axis, with its largest and smallest value. */
  drawDiagram(field, largest) {
    const { result, ink } = this;
    const extremes = [{ value: 0 }, { value: 0 }]; // largest, smallest
    for (let member = 0; largest > 0 && member < result.first_sample.length; ++member) {
      const points = [];
      for (let i = result.first_sample[member]; i <= result.lastSample(member); ++i) {
        const value = result.valueAt(field, this.shape.step, i);
        const foot = this.at(i);
        const side = this.sideOf(field.name, i).map((part) => (part * DIAGRAM * value) / largest);
        const point = { foot, tip: [foot[0] + side[0], foot[1] + side[1]], value };
        if (value > extremes[0].value) extremes[0] = point;
        if (value < extremes[1].value) extremes[1] = point;
        const last = points[points.length - 1];
        if (last && last.value * value < 0) { // a zero between two samples
          const share = last.value / (last.value - value);
          const zero = last.foot.map((part, axis) => part + share * (foot[axis] - part));
          points.push({ foot: zero, tip: zero, value: 0 });
        }
        points.push(point);
      }
      for (const sign of [1, -1]) this.fillDiagram(points, sign);
    }
    for (const { tip, value } of extremes) {
      if (Math.abs(value) > 1e-6 * largest) this.word(`${numberText(value, 4)}${field.unit ? ` ${field.unit}` : ""}`, tip, value > 0 ? ink.positive : ink.negative);
    }
  }

  /** Returns the projected unit direction of positive values at a sample. */
  sideOf(name, sample) {
    const axes = [2, 3].map((axis) => this.camera.flat(this.shape.axis(axis, sample)));
    const axis = DIAGRAMS[name];
    const flat = axis === 0 ? axes.reduce((best, each) => (Math.hypot(...each) > Math.hypot(...best) + 1e-3 ? each : best)) : axes[Math.abs(axis) - 2];
    return axis < 0 ? flat.map((part) => -part) : flat;
  }

  fillDiagram(points, sign) {
    const { context, ink } = this;
    context.beginPath();
    for (let i = 1; i < points.length; ++i) {
      const [a, b] = [points[i - 1], points[i]];
      if (sign * (a.value + b.value) <= 0) continue;
      [a.foot, a.tip, b.tip, b.foot].forEach(([x, y], corner) => (corner === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
    }
    context.globalAlpha = 0.35;
    context.fillStyle = sign > 0 ? ink.positive : ink.negative;
    context.fill();
    context.globalAlpha = 1;
    this.lines(runsOf(points, sign).map((run) => [run[0].foot, ...run.map(({ tip }) => tip), run[run.length - 1].foot]), context.fillStyle, 1.2);
  }

  /** Draws an arrow; a moment has two heads. An arrow toward the reader is a ring with a dot, away from the reader with a cross. */
  arrow([x, y], [dx, dy], color, heads, toward) {
    const length = Math.hypot(dx, dy);
    if (length < FACING * ARROW) return this.facing(x, y, color, heads, toward);
    const [ux, uy] = [dx / length, dy / length];
    const head = Math.min(9, 0.6 * length);
    const tips = Array.from({ length: heads }, (_, i) => [x + dx - 6 * i * ux, y + dy - 6 * i * uy]);
    const paths = [[[x, y], [x + dx - head * ux * 0.6, y + dy - head * uy * 0.6]]];
    this.lines(paths, this.ink.halo, 5);
    this.lines(paths, color, 2.2);
    const { context } = this;
    for (const [tx, ty] of tips) {
      context.beginPath();
      context.moveTo(tx, ty);
      context.lineTo(tx - head * ux - 0.42 * head * uy, ty - head * uy + 0.42 * head * ux);
      context.lineTo(tx - head * ux + 0.42 * head * uy, ty - head * uy - 0.42 * head * ux);
      this.paint(color);
    }
  }

  facing(x, y, color, heads, toward) {
    const { context } = this;
    if (heads === 2) { // a circular arrow, counter-clockwise if it points at the reader
      const way = toward > 0 ? -1 : 1;
      context.beginPath();
      context.arc(x, y, 13, way * 0.6, way * 5.2, way < 0);
      this.paint("", color);
      const [ex, ey] = [x + 13 * Math.cos(5.2), y + way * 13 * Math.sin(5.2)];
      const direction = [-Math.sin(5.2), way * Math.cos(5.2)];
      const tip = [ex + 7 * direction[0], ey + 7 * direction[1]];
      this.lines([[[ex - 5 * direction[1], ey + 5 * direction[0]], tip, [ex + 5 * direction[1], ey - 5 * direction[0]]]], color, 2.2);
      return;
    }
    this.circle(x, y, 8, "", color);
    if (toward > 0) this.circle(x, y, 2.4, color);
    else this.lines([[[x - 5, y - 5], [x + 5, y + 5]], [[x - 5, y + 5], [x + 5, y - 5]]], color, 2);
  }

  drawLineLoads(acting) {
    const { ink } = this;
    const every = Math.max(1, Math.ceil((acting.length * 9) / MOST_LINE_ARROWS));
    const paths = [];
    for (const [samples, forces, follows] of acting) {
      const comb = samples.map((sample, i) => {
        const head = this.at(sample);
        const flat = this.camera.flat(this.spatial(forces[i], follows, sample));
        return { head, back: head.map((part, axis) => part - (flat[axis] * LINE_ARROW) / this.largestLine) };
      });
      paths.push(comb.map(({ back }) => back));
      comb.forEach(({ head, back }, i) => {
        if (i % every === 0) paths.push(...barbed(back, head));
      });
    }
    this.context.globalAlpha = acting.length > MANY_LINE_LOADS ? 0.5 : 1; // keeps members visible behind the loads
    this.lines(paths, ink.force, 1.1);
    this.context.globalAlpha = 1;
  }

  /** Writes a letter at the middle of a member with an eigenstrain. */
  drawStrained(member) {
    const { result, ink } = this;
    const middle = (result.first_sample[member] + result.lastSample(member)) >> 1;
    this.word("ε", this.at(middle), ink.force, "italic 600 15px Georgia, serif", "center");
  }

  /** Marks a member named in the message by its line and its name. */
  drawNamed(member) {
    const { context, result, ink } = this;
    const [first, last] = [result.first_sample[member], result.lastSample(member)];
    context.globalAlpha = 0.3;
    this.lines([Array.from({ length: last - first + 1 }, (_, i) => this.at(first + i))], ink.named, 12);
    context.globalAlpha = 1;
    this.word(result.members[member], this.at((first + last) >> 1), ink.named);
  }

  word(text, [x, y], color, font = "600 13px system-ui, sans-serif", align = "left") {
    const { context, ink } = this;
    this.letters(font, color, align);
    context.lineWidth = 4;
    context.strokeStyle = ink.halo;
    context.strokeText(text, x + 9, y - 9);
    context.fillText(text, x + 9, y - 9);
  }

  drawAxes() {
    const { context, camera } = this;
    const [x, y] = [42, camera.rows - 46];
    const axes = ["x", "y", "z"].map((name, i) => ({ name, direction: [0, 1, 2].map((j) => (i === j ? 1 : 0)), color: ["#d9480f", "#2b8a3e", "#1c7ed6"][i] }));
    axes.sort((a, b) => dot(a.direction, camera.toward) - dot(b.direction, camera.toward));
    for (const { name, direction, color } of axes) {
      const [dx, dy] = camera.flat(direction).map((part) => 27 * part);
      this.lines([[[x, y], [x + dx, y + dy]]], color, 2.4);
      this.letters("600 12px system-ui, sans-serif", color, "center");
      if (Math.hypot(dx, dy) > 5) context.fillText(name, x + 1.38 * dx, y + 1.38 * dy);
    }
  }

  drawScale({ field, range, colors, camera }) {
    const { context, ink } = this;
    const [x, y, width, height] = [24, 76, 14, clamp(camera.rows - 250, 90, 260)];
    this.letters("600 12.5px system-ui, sans-serif", ink.text);
    const words = field.label + (field.unit ? ` [${field.unit}]` : "");
    this.veil(x - 8, y - 32, context.measureText(words).width + 16, 24);
    if (!field.names) this.veil(x - 8, y - 10, 96, height + 20);
    context.fillStyle = ink.text;
    context.fillText(words, x, y - 20);
    if (field.names) {
      this.drawNames(field.names, x, y);
      return;
    }
    for (let i = 0; i < height; ++i) {
      context.fillStyle = `rgb(${colorAt(colors, 1 - i / (height - 1)).join()})`;
      context.fillRect(x, y + i, width, 1.5);
    }
    context.strokeStyle = ink.soft;
    context.lineWidth = 1;
    context.strokeRect(x - 0.5, y - 0.5, width + 1, height + 1);
    this.letters("12px system-ui, sans-serif", ink.text);
    const [low, high] = range;
    const ticks = high > low ? ticksBetween(low, high, Math.floor(height / 42)) : [low];
    for (const tick of ticks) {
      const at = y + height * (high > low ? 1 - (tick - low) / (high - low) : 1);
      this.lines([[[x + width, at], [x + width + 4, at]]], ink.soft, 1);
      context.fillText(numberText(tick, 4), x + width + 8, at);
    }
  }

  /** Draws the legend of the colours of members. */
  drawNames(names, x, y) {
    const { context, ink } = this;
    const shown = names.slice(0, STOPS.names.length);
    context.font = "12px system-ui, sans-serif";
    shown.forEach((name, i) => {
      this.veil(x - 8, y - 10 + 20 * i, context.measureText(name).width + 36, 20);
      context.fillStyle = STOPS.names[i];
      context.fillRect(x, y - 5 + 20 * i, 14, 10);
      context.fillStyle = ink.text;
      context.fillText(name, x + 22, y + 20 * i);
    });
  }

  /** Draws a background for text, so that it is readable in front of a structure. */
  veil(x, y, width, height) {
    const { context } = this;
    context.globalAlpha = 0.72;
    context.fillStyle = this.ink.halo;
    context.fillRect(x, y, width, height);
    context.globalAlpha = 1;
  }

  drawTitle(words) {
    const { context, ink } = this;
    if (this.camera.width < NARROW) return; // the panel has the title too
    this.letters("600 15px system-ui, sans-serif", ink.text);
    this.veil(16, 12, context.measureText(words[0]).width + 16, 26);
    context.fillStyle = ink.text;
    context.fillText(words[0], 24, 24);
    const width = context.measureText(words[0]).width;
    context.font = "13px system-ui, sans-serif";
    if (24 + width + 22 + context.measureText(words[1]).width > document.getElementById("views").offsetLeft) return; // below the picture too
    this.veil(24 + width + 6, 12, context.measureText(words[1]).width + 16, 26);
    context.fillStyle = ink.soft;
    context.fillText(words[1], 24 + width + 14, 25);
  }
}

/** Returns a thin arrow as lines. */
function barbed(from, to) {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(dx, dy);
  if (length < 2) return [];
  const head = Math.min(5, 0.5 * length) / length;
  const barb = (side) => [to[0] - head * (dx + side * 0.5 * dy), to[1] - head * (dy - side * 0.5 * dx)];
  return [[from, [to[0], to[1]]], [barb(1), [to[0], to[1]], barb(-1)]];
}

/** Returns runs of points whose values do not have the opposite sign. */
function runsOf(points, sign) {
  const runs = [[]];
  for (const point of points) {
    if (sign * point.value >= 0) runs[runs.length - 1].push(point);
    else if (runs[runs.length - 1].length) runs.push([]);
  }
  return runs.filter((run) => run.some(({ value }) => value !== 0));
}
