// Draws members by WebGL 2. Samples are stored in float textures; a change of the step uploads only two of them.

const TEXTURE_WIDTH = 1024;
const THINNEST = 2.2; // pixels
const STRIDES = [1, 3, 9, 27]; // samples from end to end of a piece; the largest one
const SHORT_PIECE = 6; // with pieces up to this length [pixels] is used, as their curvature is not visible,
const FEW_SAMPLES = 5000; // if there are more samples than this;
const THIN = 5; // members thinner than this [pixels] are then drawn
const SIMPLE_SIDES = 3; // with so many sides
const LOOKS = { // a picture's colours
  light: { background: [1, 1, 1, 1], ghost: [0.45, 0.5, 0.58, 0.3], unknown: [0.55, 0.55, 0.55] },
  dark: { background: [0.082, 0.094, 0.114, 1], ghost: [0.75, 0.8, 0.9, 0.22], unknown: [0.55, 0.55, 0.55] },
};
const STOPS = {
  signed: ["#0072B2", "#7FB2D6", "#C9C9C9", "#E8A36B", "#D55E00"],
  magnitude: ["#440154", "#482878", "#3E4A89", "#31688E", "#26828E", "#1F9E89", "#35B779", "#6DCD59", "#B4DE2C", "#FDE725"], // viridis
};
STOPS.names = ["#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9", "#8A8A8A", "#7F6000"]; // of members
const hex = (text) => [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16));

/** Returns red, green, blue (0 to 255) at a share of a colour scale. */
function colorAt(scale, share) {
  const stops = STOPS[scale];
  const at = clamp(share, 0, 1) * (stops.length - 1);
  const low = Math.min(Math.floor(at), stops.length - 2);
  const [a, b] = [hex(stops[low]), hex(stops[low + 1])];
  return a.map((channel, i) => Math.round(channel + (b[i] - channel) * (at - low)));
}

/** Number of sides of round sections. */
const sidesFor = (samples) => (samples > 40000 ? 5 : samples > 10000 ? 8 : samples > 3000 ? 12 : 24);

class Painter {
  constructor(canvas, result) {
    this.result = result;
    this.canvas = canvas;
    this.gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true, alpha: false });
    if (!this.gl) throw new Error("This browser has no WebGL 2, which the picture needs.");
    this.prepare();
  }

  /** Creates everything in the WebGL context, also after the context was lost. */
  prepare() {
    const { gl, result } = this;
    this.rows = Math.ceil(result.samples / TEXTURE_WIDTH);
    this.padded = new Float32Array(4 * TEXTURE_WIDTH * this.rows);
    this.program = linkedProgram(gl);
    this.places = new Map();
    this.textures = {};
    ["reference", "dimensions", "displacement", "triad", "restTriad", "mode"].forEach((name, unit) => this.addTexture(name, unit));
    this.addTexture("colors", 6);
    this.upload("reference", result.reference, 4);
    this.upload("dimensions", result.dimensions, 4);
    this.upload("restTriad", result.restTriad, 4);
    this.groups = this.meshes();
    this.hasMode = false;
  }

  addTexture(name, unit) {
    const { gl } = this;
    const texture = gl.createTexture();
    this.textures[name] = unit;
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    const filter = name === "colors" ? gl.LINEAR : gl.NEAREST; // not all devices filter float textures
    for (const which of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, which, filter);
    for (const which of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, which, gl.CLAMP_TO_EDGE);
    if (name !== "colors") gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, TEXTURE_WIDTH, this.rows);
  }

  /** Uploads `columns` numbers for each sample, and the fourth from `last` if given. */
  upload(name, values, columns, last) {
    const { gl, padded, result } = this;
    if (columns === 4) padded.set(values);
    else {
      for (let i = 0; i < result.samples; ++i) {
        for (let j = 0; j < 3; ++j) padded[4 * i + j] = values[3 * i + j];
        padded[4 * i + 3] = last ? last[i] : 0;
      }
    }
    gl.activeTexture(gl.TEXTURE0 + this.textures[name]);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, TEXTURE_WIDTH, this.rows, gl.RGBA, gl.FLOAT, padded);
  }

  setColors(scale) {
    const { gl } = this;
    const texels = new Uint8Array(Array.from({ length: 256 }, (_, i) => [...colorAt(scale, i / 255), 255]).flat());
    gl.activeTexture(gl.TEXTURE0 + this.textures.colors);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, texels);
  }

  /** Sets the state to be drawn, and the values that colour it. */
  setShape(shape, values) {
    this.upload("displacement", shape.displacement, 3, values);
    this.upload("triad", shape.triad, 4);
    if (shape.mode) this.upload("mode", shape.mode, 3);
    this.hasMode = shape.mode !== null;
  }

  /** Makes vertex arrays for each kind of section: the sides of all pieces, and the ends of all members. */
  meshes() {
    const { result } = this;
    const groups = [];
    for (const kind of new Set(result.kinds)) {
      const meshes = meshesOf(kind, sidesFor(result.samples));
      const members = result.kinds.flatMap((each, member) => (each === kind ? [[result.first_sample[member], result.lastSample(member)]] : []));
      const simple = meshesOf("circle", SIMPLE_SIDES);
      for (const stride of result.samples > FEW_SAMPLES ? STRIDES : [1]) {
        const pieces = [];
        for (const [start, last] of members) for (let i = start; i < last; i += stride) pieces.push(i, Math.min(i + stride, last));
        groups.push({ ...this.group(meshes.side, pieces), stride, isSimple: false }, { ...this.group(simple.side, pieces), stride, isSimple: true });
      }
      const ends = members.flatMap(([start, last]) => [start, start, last, last]);
      groups.push({ ...this.group(meshes.end, ends), isSimple: false });
    }
    return groups;
  }

  /** Chooses the level of detail of large structures: details of a few pixels cost time and are not visible. */
  detail({ camera, thickness }) {
    const { result } = this;
    if (result.samples <= FEW_SAMPLES) return { stride: 1, isSimple: false };
    const length = result.kinds.reduce((total, _, member) => total + result.arcLength[result.lastSample(member)], 0);
    const piece = length / result.samples / camera.pixel;
    this.thickest ??= result.dimensions.reduce((a, b) => Math.max(a, b), 0);
    return { stride: STRIDES.reduce((best, stride) => (stride * piece <= SHORT_PIECE ? stride : best), 1),
      isSimple: (thickness * this.thickest) / camera.pixel < THIN };
  }

  /** Makes the vertex array of a mesh and its instances; `pieces`: pairs of samples. */
  group(mesh, pieces) {
    const { gl } = this;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    filledBuffer(gl, gl.ARRAY_BUFFER, new Float32Array(mesh.vertices));
    [["along2", 4, 0], ["along3", 4, 16], ["normal", 3, 32], ["end", 1, 44]].forEach(([name, size, offset]) => {
      const at = gl.getAttribLocation(this.program, name);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, size, gl.FLOAT, false, 48, offset);
    });
    filledBuffer(gl, gl.ARRAY_BUFFER, new Uint32Array(pieces));
    const piece = gl.getAttribLocation(this.program, "piece");
    gl.enableVertexAttribArray(piece);
    gl.vertexAttribIPointer(piece, 2, gl.UNSIGNED_INT, 8, 0);
    gl.vertexAttribDivisor(piece, 1);
    filledBuffer(gl, gl.ELEMENT_ARRAY_BUFFER, new Uint16Array(mesh.indices));
    gl.bindVertexArray(null);
    return { array, indices: mesh.indices.length, count: pieces.length / 2 };
  }

  place(name) {
    if (!this.places.has(name)) this.places.set(name, this.gl.getUniformLocation(this.program, name));
    return this.places.get(name);
  }

  /** Draws the members. `view`: camera, look, range, thickness, ghost, marked [first, last sample], reach. */
  draw(shape, view) {
    const { gl } = this;
    const { background, ghost, unknown } = LOOKS[view.look];
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(...background);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(this.program);
    for (const [name, unit] of Object.entries(this.textures)) gl.uniform1i(this.place(name), unit);
    gl.uniformMatrix4fv(this.place("toClip"), false, view.camera.matrix(view.reach));
    gl.uniformMatrix3fv(this.place("toEye"), false, view.camera.eye());
    gl.uniform1f(this.place("scale"), shape.scale);
    gl.uniform1i(this.place("aligned"), shape.isAligned ? 1 : 0);
    gl.uniform1f(this.place("amplitude"), this.hasMode ? shape.amplitude : 0);
    gl.uniform1f(this.place("thickness"), view.thickness);
    gl.uniform1f(this.place("thinnest"), THINNEST * view.camera.pixel);
    gl.uniform2f(this.place("range"), ...view.range);
    gl.uniform3f(this.place("unknown"), ...unknown);
    gl.uniform2i(this.place("marked"), ...view.marked);
    this.shown = this.detail(view);
    this.drawAll(false, [0, 0, 0, 0]);
    if (view.ghost) {
      gl.enable(gl.POLYGON_OFFSET_FILL); // behind members that have not moved
      gl.polygonOffset(1, 4);
      gl.colorMask(false, false, false, false); // first the depth only, so that each pixel is blended once
      this.drawAll(true, ghost);
      gl.colorMask(true, true, true, true);
      gl.depthFunc(gl.EQUAL);
      gl.enable(gl.BLEND);
      gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
      this.drawAll(true, ghost);
      gl.disable(gl.BLEND);
      gl.depthFunc(gl.LESS);
      gl.disable(gl.POLYGON_OFFSET_FILL);
    }
  }

  /** Waits until everything is drawn. */
  finish() {
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  drawAll(ghost, plain) {
    const { gl } = this;
    gl.uniform1i(this.place("ghost"), ghost ? 1 : 0);
    gl.uniform4f(this.place("plain"), ...plain);
    for (const group of this.groups) {
      if (group.isSimple !== this.shown.isSimple || (group.stride && group.stride !== this.shown.stride)) continue;
      gl.bindVertexArray(group.array);
      gl.drawElementsInstanced(gl.TRIANGLES, group.indices, gl.UNSIGNED_SHORT, 0, group.count);
    }
    gl.bindVertexArray(null);
  }
}

function filledBuffer(gl, target, values) {
  const buffer = gl.createBuffer();
  gl.bindBuffer(target, buffer);
  gl.bufferData(target, values, gl.STATIC_DRAW);
  return buffer;
}

function linkedProgram(gl) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX_SHADER], [gl.FRAGMENT_SHADER, FRAGMENT_SHADER]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(`shader: ${gl.getShaderInfoLog(shader)}`);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(`shaders: ${gl.getProgramInfoLog(program)}`);
  return program;
}
