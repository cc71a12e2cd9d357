// ---------------------------------------------------------------- zoom, pan and orbit of the drawing

const MOST_ZOOM = 60;

/** A unit vector turned about another by an angle (rad). */
function turned(v, axis, angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)], along = dot(v, axis) * (1 - c), side = cross(axis, v);
  return v.map((x, i) => x * c + side[i] * s + axis[i] * along);
}

/** Lets pointers, wheel, keys and buttons move the camera of a stage. Before: its drawing is planar or has a view of space. */
function createCamera(root, stage) {
  const { view, camera } = stage, first = space && { right: space.right, up: space.up };
  // Turntable: the axis of space that is most upright in the view as the text has it.
  const upright = space && [0, 1, 2].map(i => [Math.abs(space.up[i]), i]).sort((a, b) => b[0] - a[0])[0][1];
  const vertical = space && [0, 1, 2].map(i => i === upright ? Math.sign(space.up[i]) : 0);
  let waiting = false;
  const redraw = () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      stage.layout();
      stage.frame();
      root.style.touchAction = camera.zoom > 1 ? "none" : "";
    });
  };

  function zoomBy(factor, [px, py] = [view.width / 2, view.height / 2]) {
    const zoom = clamp(camera.zoom * factor, .2, MOST_ZOOM), by = zoom / camera.zoom;
    camera.dx = px - view.middle[0] - (px - view.middle[0] - camera.dx) * by;
    camera.dy = py - view.middle[1] - (py - view.middle[1] - camera.dy) * by;
    camera.zoom = zoom;
    redraw();
  }
  const panBy = (dx, dy) => { camera.dx += dx; camera.dy += dy; redraw(); };
  function look(right, up) {
    Object.assign(space, { right, up, turned: true });
    seen.clear();
    redraw();
  }
  function orbitBy(dx, dy) {
    const about = v => turned(turned(v, vertical, -dx * .01), space.right, -dy * .01);
    const right = turned(space.right, vertical, -dx * .01);
    look(right, cross(cross(right, about(space.up)), right));
  }
  function reset() {
    Object.assign(camera, { zoom: 1, dx: 0, dy: 0 });
    if (space) { Object.assign(space, first, { turned: false }); seen.clear(); }
    redraw();
  }

  const pointers = new Map();
  const placeOf = event => { const box = root.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
  root.addEventListener("pointerdown", event => {
    if (event.button > 1) return;
    pointers.set(event.pointerId, placeOf(event));
    root.setPointerCapture(event.pointerId);
  });
  root.addEventListener("pointermove", event => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const now = placeOf(event), others = [...pointers].filter(([id]) => id !== event.pointerId);
    pointers.set(event.pointerId, now);
    if (others.length) { // two fingers: their distance zooms, their middle pans
      const [, other] = others[0], apart = p => Math.hypot(p[0] - other[0], p[1] - other[1]);
      panBy((now[0] - before[0]) / 2, (now[1] - before[1]) / 2);
      if (apart(before) > 20) zoomBy(apart(now) / apart(before), other);
    } else if (space && !event.shiftKey && !(event.buttons & 4)) orbitBy(now[0] - before[0], now[1] - before[1]);
    else panBy(now[0] - before[0], now[1] - before[1]);
  });
  for (const type of ["pointerup", "pointercancel"]) root.addEventListener(type, event => pointers.delete(event.pointerId));
  root.addEventListener("wheel", event => {
    // A page scrolls past a drawing that nobody has chosen.
    if (!event.ctrlKey && !event.metaKey && document.activeElement !== root) return;
    event.preventDefault();
    zoomBy(Math.exp(-clamp(event.deltaY, -200, 200) * (event.ctrlKey ? .01 : .002)), placeOf(event));
  }, { passive: false });
  root.addEventListener("dblclick", reset);
  root.addEventListener("keydown", event => {
    const step = { "+": 1.25, "=": 1.25, "-": .8 }[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (step) zoomBy(step); else if (event.key === "0") reset(); else return;
    event.preventDefault();
  });

  const button = (text, title, act) => {
    const made = el("button", { type: "button", textContent: text, title, ariaLabel: title });
    made.addEventListener("click", act);
    return made;
  };
  const bar = byId("camera");
  bar.hidden = !drawing.length;
  bar.append(button("+", "Zoom in", () => zoomBy(1.4)), button("−", "Zoom out", () => zoomBy(1 / 1.4)), button("⤢", "Show all", reset));
  if (!space) return;
  const [x, y, z] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  for (const [name, right, up] of [["xz", x, z], ["yz", y, z], ["xy", x, y]]) bar.append(button(name, `Look at the ${name} plane`, () => look(right, up)));
  bar.append(button("⟲", "Turn by 15°", () => orbitBy(Math.PI / 12 / .01, 0)));
}
