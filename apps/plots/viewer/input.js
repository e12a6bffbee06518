// Mouse, fingers, keys and controls.

function listenToPointers(app) {
  const stage = byId("stage");
  const down = new Map(); // pointers that are pressed
  const place = (event) => {
    const box = stage.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  stage.addEventListener("pointerdown", (event) => {
    if (event.target.closest("button")) return;
    down.set(event.pointerId, place(event));
    stage.setPointerCapture(event.pointerId);
    stage.classList.add("dragging");
    if (event.pointerType === "touch") app.hover(...place(event));
    else byId("hover").hidden = true;
  });
  stage.addEventListener("pointermove", (event) => {
    const now = place(event);
    const before = down.get(event.pointerId);
    if (!before) {
      if (event.target.closest("button")) byId("hover").hidden = true;
      else app.hover(...now);
      return;
    }
    const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
    if (down.size === 2) pinch(app, down, event.pointerId, now);
    else if (event.shiftKey || event.buttons & 6) app.camera.pan(dx, dy);
    else app.camera.orbit(dx, dy);
    down.set(event.pointerId, now);
    app.isTurned = true;
    app.moved();
  });
  for (const name of ["pointerup", "pointercancel"]) {
    stage.addEventListener(name, (event) => {
      down.delete(event.pointerId);
      if (down.size === 0) stage.classList.remove("dragging");
    });
  }
  stage.addEventListener("pointerleave", () => app.hover(-1e6, -1e6));
  stage.addEventListener("contextmenu", (event) => event.preventDefault());
  stage.addEventListener("dblclick", () => app.fit());
  stage.addEventListener("wheel", (event) => {
    event.preventDefault();
    app.camera.zoom(Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.0015)), ...place(event));
    app.isTurned = true;
    app.moved();
  }, { passive: false });
}

/** Handles two fingers: their midpoint pans, their distance zooms. */
function pinch(app, down, moved, now) {
  const [, other] = [...down.entries()].find(([id]) => id !== moved);
  const before = down.get(moved);
  const distance = (point) => Math.max(1, Math.hypot(point[0] - other[0], point[1] - other[1]));
  app.camera.pan((now[0] - before[0]) / 2, (now[1] - before[1]) / 2);
  app.camera.zoom(distance(now) / distance(before), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
}

function listenToControls(app) {
  const on = (id, name, act) => byId(id).addEventListener(name, act);
  on("step", "input", (event) => app.showStep(Number(event.target.value)));
  on("back", "click", () => app.showStep(app.shape.step - 1));
  on("forward", "click", () => app.showStep(app.shape.step + 1));
  on("play", "click", () => app.play());
  on("case", "change", (event) => app.open(Number(event.target.value)));
  for (const id of ["field", "range"]) on(id, "change", () => app.showColors());
  for (const id of ["ghost", "supports", "loads", "thickness", "diagram"]) on(id, "change", () => app.moved());
  for (const id of ["ordinate", "abscissa", "whole"]) on(id, "change", () => app.drawCurve());
  on("scale", "change", (event) => app.setScale(Number(event.target.value)));
  on("true-scale", "click", () => app.setScale(1));
  on("auto-scale", "click", () => app.setScale(app.visibleScale()));
  on("modes", "click", (event) => {
    const button = event.target.closest("button");
    if (button) app.showMode(Number(button.dataset.mode));
  });
  on("amplitude", "input", (event) => {
    app.stopSwing();
    app.shape.amplitude = event.target.value * MODE_SHARE * app.result.size;
    app.moved();
  });
  on("swing", "click", () => app.swing());
  on("leave-mode", "click", () => app.showStep(app.shape.step));
  on("save", "click", () => app.save());
  on("film", "click", () => app.film());
  on("theme", "click", () => {
    app.look(app.theme === "dark" ? "light" : "dark");
    app.redraw();
  });
  on("views", "click", (event) => {
    const { view } = event.target.dataset;
    if (VIEWS[view]) app.camera.look(...VIEWS[view]);
    if (view) app.fit();
  });
}

function listenToKeys(app) {
  window.addEventListener("keydown", (event) => {
    if (event.target.closest("input, select, button")) return;
    const acts = { ArrowLeft: () => app.showStep(app.shape.step - 1), ArrowRight: () => app.showStep(app.shape.step + 1), " ": () => app.play() };
    if (!acts[event.key]) return;
    event.preventDefault();
    acts[event.key]();
  });
}

function start() {
  const app = new App();
  window.mixbeamView = app;
  listenToPointers(app);
  listenToControls(app);
  listenToKeys(app);
  if (jsonOf("pages").renew) renew(app, jsonOf("pages").renew);
  new ResizeObserver(() => {
    app.resize();
    if (!app.isTurned) app.fit();
    app.drawCurve();
  }).observe(byId("stage"));
  byId("scene").addEventListener("webglcontextlost", (event) => event.preventDefault());
  byId("scene").addEventListener("webglcontextrestored", () => {
    app.painter.prepare();
    app.showState();
  });
  app.painter.finish();
  document.documentElement.dataset.firstPicture = Math.round(performance.now()); // milliseconds since the page was opened
}

/** Reloads a watched page regularly while it has no focus, and keeps its camera. */
function renew(app, seconds) {
  const kept = sessionStorage.getItem("camera");
  if (kept) {
    Object.assign(app.camera, JSON.parse(kept));
    app.isTurned = true;
  }
  app.resize();
  setInterval(() => {
    if (document.hasFocus()) return;
    sessionStorage.setItem("camera", JSON.stringify(app.camera));
    location.reload();
  }, 1000 * seconds);
}

/** Shows errors of scripts and of unhandled promises. */
function showError(message) {
  byId("error").hidden = false;
  byId("error").textContent = message.replace(/^Uncaught (Error: )?/, "");
}

window.addEventListener("error", (event) => showError(event.message));
window.addEventListener("unhandledrejection", (event) => showError(event.reason.message));
window.mixbeamStart = inflateAll().then(start);
