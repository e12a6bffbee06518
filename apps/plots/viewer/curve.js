// Curve of one followed number over another, with a mark at the current state; a click selects the nearest step.

const SVG = "http://www.w3.org/2000/svg";
const MARGINS = { left: 58, right: 12, top: 10, bottom: 38 };

function svgElement(name, attributes, parent, text) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  parent.append(element);
  return element;
}

class Curve {
  /** `choose(place)` is called with the number of a step of the run; critical points are numbered after all steps. */
  constructor(svg, result, choose) {
    Object.assign(this, { svg, result, choose });
    svg.onclick = (event) => {
      const box = svg.getBoundingClientRect();
      const place = this.nearest(event.clientX - box.left, event.clientY - box.top);
      if (place >= 0) choose(place);
    };
  }

  /** Draws the series with these names; up to the first critical point unless `isWhole`. */
  draw(abscissa, ordinate, isWhole) {
    const { svg, result } = this;
    svg.replaceChildren();
    this.x = result.series(abscissa);
    this.y = result.series(ordinate);
    this.names = [abscissa, ordinate];
    const steps = result.stable.length;
    this.width = svg.clientWidth || 320;
    this.height = svg.clientHeight || 210;
    const known = [...this.x.keys()].filter((i) => Math.abs(this.x[i]) < NO_VALUE && Math.abs(this.y[i]) < NO_VALUE);
    this.known = known;
    const first = result.modes.findIndex((mode) => mode.before !== undefined); // a critical point
    const shown = isWhole || first < 0 ? known : known.filter((i) => i < result.modes[first].step || i === steps + first);
    this.limits = [this.x, this.y].map((values) => paddedLimits((shown.length > 1 ? shown : known).map((i) => values[i])));
    this.drawFrame();
    const clip = svgElement("clipPath", { id: "inside" }, svg);
    svgElement("rect", { x: MARGINS.left, y: MARGINS.top, width: this.width - MARGINS.left - MARGINS.right, height: this.height - MARGINS.top - MARGINS.bottom }, clip);
    this.inside = svgElement("g", { "clip-path": "url(#inside)" }, svg);
    for (let i = 1; i < steps; ++i) {
      const [from, to] = [this.at(i - 1), this.at(i)];
      if (![...from, ...to].every(Number.isFinite)) continue;
      svgElement("line", { x1: from[0], y1: from[1], x2: to[0], y2: to[1], class: result.stable[i] === "true" ? "path" : "path not-stable" }, this.inside);
    }
    if (steps <= 150) for (const i of known) if (i < steps) this.dot(i, 2.4, "step");
    result.modes.forEach((mode, i) => {
      if (mode.before !== undefined && known.includes(steps + i)) this.dot(steps + i, 4.2, mode.kind === "bifurcation" ? "critical bifurcation" : "critical");
    });
    this.now = svgElement("circle", { r: 5.5, class: "now" }, this.inside);
  }

  dot(i, radius, kind) {
    const [x, y] = this.at(i);
    svgElement("circle", { cx: x, cy: y, r: radius, class: kind }, this.inside);
  }

  /** Returns the pixels of a row of the series; NaN if a value is unknown. */
  at(i) {
    const share = [this.x[i], this.y[i]].map((value, axis) =>
      (Math.abs(value) < NO_VALUE ? (value - this.limits[axis][0]) / (this.limits[axis][1] - this.limits[axis][0]) : NaN));
    return [MARGINS.left + share[0] * (this.width - MARGINS.left - MARGINS.right),
      this.height - MARGINS.bottom - share[1] * (this.height - MARGINS.top - MARGINS.bottom)];
  }

  drawFrame() {
    const { svg, width, height } = this;
    const bottom = height - MARGINS.bottom;
    const [xs, ys] = this.limits;
    for (const tick of ticksBetween(...xs, 4)) {
      const x = MARGINS.left + ((tick - xs[0]) / (xs[1] - xs[0])) * (width - MARGINS.left - MARGINS.right);
      svgElement("line", { x1: x, x2: x, y1: MARGINS.top, y2: bottom, class: tick === 0 ? "zero" : "grid" }, svg);
      svgElement("text", { x, y: bottom + 14, "text-anchor": "middle" }, svg, numberText(tick, 4));
    }
    for (const tick of ticksBetween(...ys, 4)) {
      const y = bottom - ((tick - ys[0]) / (ys[1] - ys[0])) * (bottom - MARGINS.top);
      svgElement("line", { x1: MARGINS.left, x2: width - MARGINS.right, y1: y, y2: y, class: tick === 0 ? "zero" : "grid" }, svg);
      svgElement("text", { x: MARGINS.left - 6, y: y + 4, "text-anchor": "end" }, svg, numberText(tick, 4));
    }
  }

  /** Moves the mark to the current state. */
  show(place) {
    const at = this.at(place);
    const known = at.every(Number.isFinite);
    this.now.style.display = known ? "" : "none";
    if (known) {
      this.now.setAttribute("cx", at[0]);
      this.now.setAttribute("cy", at[1]);
    }
  }

  nearest(x, y) {
    const distance = (i) => Math.hypot(this.at(i)[0] - x, this.at(i)[1] - y);
    return this.known.reduce((best, i) => (best < 0 || distance(i) < distance(best) ? i : best), -1);
  }
}

function paddedLimits(values) {
  let [low, high] = values.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [Infinity, -Infinity]);
  if (!(high >= low)) [low, high] = [0, 1];
  const room = 0.06 * (high - low) || 0.5 * Math.abs(high) || 1;
  return [low - room, high + room];
}
