// What is drawn over the members, flat and sharp at any zoom: supports, joints, loads, axes, the scale of colours.

const ARROW = 46; // pixels of an arrow across the line of sight,
const LINE_ARROW = 34; // and of the largest line load
const FACING = 0.2; // of its length: an arrow that appears shorter points at the reader
const MOST_LINE_ARROWS = 150;
const MANY_LINE_LOADS = 10;
const MANY_SUPPORTS = 40; // get small signs,
const NARROW = 560; // pixels of a picture with room for little more than the buttons
const CROWD = 300; // and more of them squares
const INK = {
  light: { text: "#20262e", soft: "#5b6673", support: "#20262e", force: "#c2410c", moment: "#a21caf", motion: "#047857", halo: "#ffffff" },
  dark: { text: "#e6eaf0", soft: "#9aa5b4", support: "#dfe5ee", force: "#fb923c", moment: "#e879f9", motion: "#34d399", halo: "#15181d" },
};
// Signs below the point, which is at the origin; lines through points, in units of the size of a sign.
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

  /** Everything for a picture; `view` as that of the painter, and what of it is shown. */
  draw(shape, view) {
    const { context } = this;
    this.shape = shape;
    this.camera = view.camera;
    this.ink = INK[view.look];
    context.setTransform(view.ratio, 0, 0, view.ratio, 0, 0);
    context.clearRect(0, 0, view.camera.width, view.camera.rows);
    context.lineCap = context.lineJoin = "round";
    if (view.supports) this.drawSupports();
    if (view.loads) this.drawLoads();
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
      context.fillStyle = this.ink.halo;
      context.fill();
      context.strokeStyle = this.ink.support;
      context.lineWidth = 1.6;
      context.stroke();
    }
  }

  /** Whether something that begins to act at a load factor acts in the state that is shown. */
  acts(begins) {
    const { shape, result } = this;
    const factor = shape.modeNumber >= 0 ? result.modes[shape.modeNumber].factor : result.steps[shape.step].factor;
    return begins < Math.abs(factor);
  }

  spatial(vector, follows, sample) {
    return follows ? turned(Array.from(this.shape.triad.subarray(4 * sample, 4 * sample + 4)), vector) : vector;
  }

  drawLoads() {
    const { result, ink } = this;
    if (result.strained.length <= CROWD) for (const number of result.strained) this.drawStrained(number);
    const kinds = [["forces", ink.force, 1], ["moments", ink.moment, 2], ["shifts", ink.motion, 1], ["turns", ink.motion, 2]];
    this.drawLineLoads();
    for (const [name, color, heads] of kinds) {
      for (const [sample, direction, follows, begins] of result[name]) {
        if (!this.acts(begins)) continue;
        const [x, y] = this.at(sample);
        const flat = this.camera.flat(this.spatial(direction, follows, sample)).map((part) => part * ARROW);
        this.arrow([x, y], flat, color, heads, dot(this.spatial(direction, follows, sample), this.camera.toward));
      }
    }
  }

  /** A moment has two heads; what points at the reader is a ring with a dot, away from him one with a cross. */
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
      context.closePath();
      context.fillStyle = color;
      context.fill();
    }
  }

  facing(x, y, color, heads, toward) {
    const { context } = this;
    if (heads === 2) { // a turning arrow, against the clock when it points at the reader
      const way = toward > 0 ? -1 : 1;
      context.beginPath();
      context.arc(x, y, 13, way * 0.6, way * 5.2, way < 0);
      context.strokeStyle = color;
      context.lineWidth = 2.2;
      context.stroke();
      const [ex, ey] = [x + 13 * Math.cos(5.2), y + way * 13 * Math.sin(5.2)];
      const direction = [-Math.sin(5.2), way * Math.cos(5.2)];
      const tip = [ex + 7 * direction[0], ey + 7 * direction[1]];
      this.lines([[[ex - 5 * direction[1], ey + 5 * direction[0]], tip, [ex + 5 * direction[1], ey - 5 * direction[0]]]], color, 2.2);
      return;
    }
    context.beginPath();
    context.arc(x, y, 8, 0, 7);
    context.strokeStyle = color;
    context.lineWidth = 2.2;
    context.stroke();
    if (toward > 0) {
      context.beginPath();
      context.arc(x, y, 2.4, 0, 7);
      context.fillStyle = color;
      context.fill();
    } else this.lines([[[x - 5, y - 5], [x + 5, y + 5]], [[x - 5, y + 5], [x + 5, y - 5]]], color, 2);
  }

  drawLineLoads() {
    const { result, ink } = this;
    const acting = result.line_loads.filter((load) => this.acts(load[3]));
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
    this.context.globalAlpha = acting.length > MANY_LINE_LOADS ? 0.5 : 1; // the members are to be seen through them
    this.lines(paths, ink.force, 1.1);
    this.context.globalAlpha = 1;
  }

  /** A letter at the middle of a member with an eigenstrain. */
  drawStrained(member) {
    const { context, result, ink } = this;
    const [x, y] = this.at((result.first_sample[member] + result.lastSample(member)) >> 1);
    context.font = "italic 600 15px Georgia, serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.lineWidth = 4;
    context.strokeStyle = ink.halo;
    context.strokeText("ε", x + 9, y - 9);
    context.fillStyle = ink.force;
    context.fillText("ε", x + 9, y - 9);
  }

  drawAxes() {
    const { context, camera } = this;
    const [x, y] = [42, camera.rows - 46];
    const axes = ["x", "y", "z"].map((name, i) => ({ name, direction: [0, 1, 2].map((j) => (i === j ? 1 : 0)), color: ["#d9480f", "#2b8a3e", "#1c7ed6"][i] }));
    axes.sort((a, b) => dot(a.direction, camera.toward) - dot(b.direction, camera.toward));
    context.font = "600 12px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    for (const { name, direction, color } of axes) {
      const [dx, dy] = camera.flat(direction).map((part) => 27 * part);
      this.lines([[[x, y], [x + dx, y + dy]]], color, 2.4);
      context.fillStyle = color;
      if (Math.hypot(dx, dy) > 5) context.fillText(name, x + 1.38 * dx, y + 1.38 * dy);
    }
  }

  drawScale({ field, range, colors, camera }) {
    const { context, ink } = this;
    const [x, y, width, height] = [24, 76, 14, clamp(camera.rows - 250, 90, 260)];
    context.textAlign = "left";
    context.textBaseline = "middle";
    context.font = "600 12.5px system-ui, sans-serif";
    const words = field.label + (field.unit ? ` [${field.unit}]` : "");
    this.veil(x - 8, y - 32, context.measureText(words).width + 16, 24);
    this.veil(x - 8, y - 10, 96, height + 20);
    context.fillStyle = ink.text;
    context.fillText(words, x, y - 20);
    for (let i = 0; i < height; ++i) {
      context.fillStyle = `rgb(${colorAt(colors, 1 - i / (height - 1)).join()})`;
      context.fillRect(x, y + i, width, 1.5);
    }
    context.strokeStyle = ink.soft;
    context.lineWidth = 1;
    context.strokeRect(x - 0.5, y - 0.5, width + 1, height + 1);
    context.font = "12px system-ui, sans-serif";
    context.fillStyle = ink.text;
    const [low, high] = range;
    const ticks = high > low ? ticksBetween(low, high, Math.floor(height / 42)) : [low];
    for (const tick of ticks) {
      const at = y + height * (high > low ? 1 - (tick - low) / (high - low) : 1);
      this.lines([[[x + width, at], [x + width + 4, at]]], ink.soft, 1);
      context.fillText(numberText(tick, 4), x + width + 8, at);
    }
  }

  /** Behind words, so that they can be read before a structure. */
  veil(x, y, width, height) {
    const { context } = this;
    context.globalAlpha = 0.72;
    context.fillStyle = this.ink.halo;
    context.fillRect(x, y, width, height);
    context.globalAlpha = 1;
  }

  drawTitle(words) {
    const { context, ink } = this;
    if (this.camera.width < NARROW) return; // the panel says it too
    context.textAlign = "left";
    context.textBaseline = "middle";
    context.font = "600 15px system-ui, sans-serif";
    this.veil(16, 12, context.measureText(words[0]).width + 16, 26);
    context.fillStyle = ink.text;
    context.fillText(words[0], 24, 24);
    const width = context.measureText(words[0]).width;
    context.font = "13px system-ui, sans-serif";
    this.veil(24 + width + 6, 12, context.measureText(words[1]).width + 16, 26);
    context.fillStyle = ink.soft;
    context.fillText(words[1], 24 + width + 14, 25);
  }
}

/** A thin arrow as lines. */
function barbed(from, to) {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(dx, dy);
  if (length < 2) return [];
  const head = Math.min(5, 0.5 * length) / length;
  const barb = (side) => [to[0] - head * (dx + side * 0.5 * dy), to[1] - head * (dy - side * 0.5 * dx)];
  return [[from, [to[0], to[1]]], [barb(1), [to[0], to[1]], barb(-1)]];
}
