// Put into a page of `mixbeam view` by viewer_test.py: uses it as a reader would, and writes what is seen into the document.
const probe = {
  app: window.mixbeamView,

  /** Red, green, blue of the picture at css pixels. */
  color(x, y) {
    this.app.draw();
    return this.read(x, y);
  },

  /** The same of what was drawn last. */
  read(x, y) {
    const { gl, canvas } = this.app.painter;
    const { ratio } = this.app;
    const texel = new Uint8Array(4);
    gl.readPixels(Math.round(x * ratio), canvas.height - 1 - Math.round(y * ratio), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, texel);
    return [...texel.slice(0, 3)];
  },

  /** Where a sample lies in the picture. */
  pixel(sample) {
    return this.app.camera.project(this.app.shape.position(sample)).slice(0, 2);
  },

  set(id, value, event) {
    const element = document.getElementById(id);
    if (element.type === "checkbox") element.checked = value;
    else element.value = value;
    element.dispatchEvent(new Event(event, { bubbles: true }));
  },

  click(selector) {
    document.querySelector(selector).dispatchEvent(new MouseEvent("click", { bubbles: true }));
  },

  /** What the page says at a place of the picture; empty where it says nothing. */
  hover(x, y) {
    const stage = document.getElementById("stage");
    const box = stage.getBoundingClientRect();
    stage.dispatchEvent(new PointerEvent("pointermove", { clientX: box.left + x, clientY: box.top + y, bubbles: true }));
    const hover = document.getElementById("hover");
    return hover.hidden ? "" : hover.innerText;
  },

  /** Mouse or finger: presses, moves along places [x, y] and lets go, unless it `stays`. */
  pointer(places, { id = 1, kind = "mouse", stays = false, ...more } = {}) {
    const stage = document.getElementById("stage");
    const box = stage.getBoundingClientRect();
    stage.setPointerCapture = () => {}; // no pointer of these events exists
    const send = (name, [x, y]) => stage.dispatchEvent(new PointerEvent(name, { pointerId: id, pointerType: kind, clientX: box.left + x,
      clientY: box.top + y, bubbles: true, ...more }));
    send("pointerdown", places[0]);
    places.slice(1).forEach((place) => send("pointermove", place));
    if (!stays) send("pointerup", places[places.length - 1]);
    return () => send("pointerup", places[places.length - 1]);
  },

  wheel([x, y], turn) {
    const box = document.getElementById("stage").getBoundingClientRect();
    const event = new WheelEvent("wheel", { clientX: box.left + x, clientY: box.top + y, deltaY: turn, bubbles: true, cancelable: true });
    return !document.getElementById("stage").dispatchEvent(event); // whether the page keeps it from scrolling
  },

  key(key) {
    document.body.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
    return this.app.shape.step;
  },

  /** { name, width, height } of the file that a button saves. */
  saved(selector) {
    let link = null;
    const { click } = HTMLAnchorElement.prototype;
    HTMLAnchorElement.prototype.click = function keep() { link = this; };
    this.click(selector);
    HTMLAnchorElement.prototype.click = click;
    const bytes = Uint8Array.from(atob(link.href.split("data:image/png;base64,")[1]), (letter) => letter.charCodeAt(0));
    const header = new DataView(bytes.buffer); // of a PNG: signature, length and name of IHDR, then its numbers
    return { name: link.download, width: header.getUint32(16), height: header.getUint32(20), color: this.color(5, 600) };
  },

  /** Share of the picture that is not background. */
  covered() {
    const { gl, canvas } = this.app.painter;
    this.app.draw();
    const texels = new Uint8Array(4 * canvas.width * canvas.height);
    gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, texels);
    let count = 0;
    for (let i = 0; i < texels.length; i += 4) if (texels[i] < 250 || texels[i + 1] < 250 || texels[i + 2] < 250) count += 1;
    return count / (canvas.width * canvas.height);
  },
};
