// Outlines of sections. Their corners are linear in the dimensions (width, height, wall, web) of a sample, so that one mesh
// for each kind is drawn for every piece of a member between two samples.

/** Corner: coordinates along axes 2 and 3, each as factors of width, height, wall, web; normal in the section. */
function corner(along2, along3, normal) {
  return { along2, along3, normal };
}

function round(sides, shrink = 0) {
  return Array.from({ length: sides }, (_, i) => {
    const angle = (2 * Math.PI * i) / sides;
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    return corner([c / 2, 0, -c * shrink, 0], [0, s / 2, -s * shrink, 0], [c, s]);
  });
}

function rectangle(half2, half3) {
  const minus = (values) => values.map((value) => -value);
  return [[half2, half3], [minus(half2), half3], [minus(half2), minus(half3)], [half2, minus(half3)]]
    .map(([a, b]) => corner(a, b, [0, 0]));
}

/** Outlines, counter-clockwise, and rectangles (left, right, lower, upper) that fill them, relative to the middle of width and
 * height. */
const RECTANGULAR = {
  rectangle: { outline: "b+t -b+t -b-t b-t", areas: ["-b b -t t"] },
  I: { outline: "-b+t -b+u -w+u -w-u -b-u -b-t b-t b-u w-u w+u b+u b+t", areas: ["-b b u t", "-b b -t -u", "-w w -u u"] },
  T: { outline: "-b+t -b+u -w+u -w-t w-t w+u b+u b+t", areas: ["-b b u t", "-w w -t u"] },
  U: { outline: "-b+t -b-t b-t b-u i-u i+u b+u b+t", areas: ["-b b u t", "-b b -t -u", "-b i -u u"] },
  L: { outline: "-b+t -b-t b-t b-u k-u k+t", areas: ["-b b -t -u", "-b k -u t"] },
};

function rectangularMeshes(kind) {
  const [word, turn, ...center] = [...kind.split(" "), 0, 0, 0]; // "T upright 0 0.2": offset of the centroid over width and height
  const upwards = turn === "mirrored" ? -1 : 1;
  const along2 = { b: [0.5, 0, 0, 0], w: [0, 0, 0, 0.5], i: [-0.5, 0, 0, 1], k: [-0.5, 0, 1, 0] };
  const along3 = { t: [0, 0.5, 0, 0], u: [0, 0.5, -1, 0] };
  const place = (factors, text, shift) => factors[text.at(-1)].map((value, i) => (text[0] === "-" ? -value : value) - shift[i]);
  const at = (second, third) => corner(place(along2, second, [+center[0], 0, 0, 0]),
    place(along3, third, [0, upwards * center[1], 0, 0]).map((value) => upwards * value), [0, 0]);
  const { outline, areas } = RECTANGULAR[word];
  const corners = outline.split(" ").map((text) => at(...text.match(/^(-?.)([+-].)$/).slice(1)));
  const end = new Mesh();
  for (const [left, right, lower, upper] of areas.map((area) => area.split(" ")))
    end.area([at(left, lower), at(right, lower), at(right, upper), at(left, upper)]);
  return { side: new Mesh().side(upwards < 0 ? corners.reverse() : corners), end };
}

class Mesh {
  constructor() {
    this.vertices = []; // along2 (4), along3 (4), normal along axes 2, 3, 1, end of the piece (0 or 1)
    this.indices = [];
  }

  vertex(from, normal, end) {
    this.vertices.push(...from.along2, ...from.along3, ...normal, end);
    return this.vertices.length / 12 - 1;
  }

  quad(a, b, c, d) {
    this.indices.push(a, b, c, b, d, c);
  }

  /** Adds the lateral surface of a piece; `smooth` outlines share their vertices. */
  side(outline, smooth) {
    if (smooth) {
      const at = outline.map((from) => [0, 1].map((end) => this.vertex(from, [...from.normal, 0], end)));
      at.forEach(([start, end], i) => this.quad(start, end, ...at[(i + 1) % at.length]));
      return this;
    }
    outline.forEach((from, i) => {
      const to = outline[(i + 1) % outline.length];
      const normal = [...flatNormal(from, to), 0];
      this.quad(...[from, to].flatMap((each) => [0, 1].map((end) => this.vertex(each, normal, end))));
    });
    return this;
  }

  /** Adds a plane area that is star-shaped with respect to its first corner. */
  area(outline) {
    return this.ring(outline, outline.map(() => outline[0]));
  }

  /** Adds a plane area between two outlines with the same number of corners. */
  ring(outer, inner) {
    const at = outer.map((from, i) => [from, inner[i]].map((each) => this.vertex(each, [0, 0, 1], 0)));
    at.forEach(([out, into], i) => this.quad(out, into, ...at[(i + 1) % at.length]));
    return this;
  }
}

/** Normal of an edge of a flat section. Edges are along the axes for any dimensions, so typical ones give the direction. */
function flatNormal(from, to) {
  const typical = [1, 1, 0.1, 0.1];
  const along = (factors) => factors.reduce((total, factor, i) => total + factor * typical[i], 0);
  const edge = [along(to.along2) - along(from.along2), along(to.along3) - along(from.along3)];
  const length = Math.hypot(...edge);
  return [edge[1] / length, -edge[0] / length];
}

/** Makes the meshes { side, end } of a kind; `sides`: of round ones. */
function meshesOf(kind, sides) {
  const box = rectangle([0.5, 0, 0, 0], [0, 0.5, 0, 0]);
  if (kind === "box") return { side: new Mesh().side(box), end: new Mesh().ring(box, rectangle([0.5, 0, -1, 0], [0, 0.5, -1, 0])) };
  if (RECTANGULAR[kind.split(" ")[0]]) return rectangularMeshes(kind);
  const outline = round(sides);
  const end = kind === "tube" ? new Mesh().ring(outline, round(sides, 1)) : new Mesh().area(outline);
  return { side: new Mesh().side(outline, true), end };
}
