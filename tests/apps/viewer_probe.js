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
