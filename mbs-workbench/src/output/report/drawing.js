// ---------------------------------------------------------------- the drawing

/** Directions in which points in space are seen, where the drawing has a view; an orbit turns them. */
const space = drawing.find(item => item.kind === "view");
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** Outputs of a run, and what it draws beside them. */
const columns = run => [...(run.outputs || []), ...(run.places || [])];

/** All components of a vector output over time, two or three, or null where the run has no such point or no such derivative. */
function components(run, name, key = "value") {
  const found = [0, 1, 2].map(i => columns(run).find(output => output.name === `${name}.${i}`));
  const [x, y, z] = found;
  return x && y && found.every(output => !output || output[key]) ? (z ? found : [x, y]).map(output => output[key]) : null;
}

/** The two components of a vector output in the picture: of one in space what stands along the view's directions. */
const seen = new Map();
function vector(run, name, key = "value") {
  if (!seen.has(run)) seen.set(run, new Map());
  const known = seen.get(run), id = `${name} ${key}`;
  if (!known.has(id)) {
    const all = components(run, name, key);
    const along = axis => all[0].map((x, k) => all.every(c => finite(c[k])) ? axis[0] * x + axis[1] * all[1][k] + axis[2] * all[2][k] : null);
    known.set(id, space && all && all.length === 3 ? [along(space.right), along(space.up)] : all);
  }
  return known.get(id);
}

/** Components of a vector of the loads over time, or null. */
function loadOf(run, name) {
  const found = [0, 1, 2].map(i => entriesOf(run, "loads").find(load => load.name === `${name}.${i}`));
  return found[0] && found[1] ? found.filter(Boolean).map(load => load.value) : null;
}

/** The largest size of an arrow, but for a few that stand out: those are drawn shorter. */
function usualSize(values) {
  const sorted = [...values].sort((a, b) => a - b), high = sorted[Math.floor(.97 * (sorted.length - 1))];
  return Math.min(sorted[sorted.length - 1] || 0, 1.3 * high || Infinity);
}

/** A coordinate or a scalar output over time, or null where the run has none of this name. */
function scalar(run, name) {
  const coordinate = (run.coordinates || []).find(coordinate => coordinate.name === name);
  return coordinate ? coordinate.q : (columns(run).find(output => output.name === name) || {}).value || null;
}

const pointsOf = item => [...(item.points || []), ...["at", "of", "rim", "contact", "back", "pin", "wheel"].map(key => item[key]).filter(Boolean)];
const coloured = ["link", "plate", "slot", "wheel", "gear", "cam", "face"]; // kinds that take the next colour

/** Runs on show of the large drawing, and what it shows of them. */
const large = { runs: shown, fitted: shownAtAllStops, at: run => sample(run), shows: what => state[what], least: width => Math.min(340, width * .75), axes: true };

/**
 * A drawing in an SVG element. `options`: { runs: the runs on show, at: the sample of a run, shows: whether "velocity", "acceleration",
 * "labels" are, least: the least height at a width, axes: whether it has some }.
 */
function createStage(root, options) {
  const names = [...new Set(drawing.flatMap(pointsOf))];
  const known = new Set(names.filter(name => runs.every(run => vector(run, name))));
  const items = drawing.filter(item => pointsOf(item).every(name => known.has(name)));
  const bodies = items.filter(item => coloured.includes(item.kind));
  // A shape without a label is a further part of the body before it.
  const bodyOf = item => Math.max(0, bodies.slice(0, bodies.indexOf(item) + 1).filter(body => body.label).length - 1);
  const colourOf = item => `var(--b${bodyOf(item) % 5})`;
  const onRail = item => items.some(rail => rail.kind === "rail" && rail.at === item.at);
  const missing = names.filter(name => !known.has(name));
  if (missing.length && options === large) byId("caption").textContent = `Not drawn, since no output has this name: ${missing.join(", ")}.`;
  root.setAttribute("aria-label", `Animated drawing: ${data.title}`);

  const sizes = columns => columns[0].map((_, k) => Math.hypot(...columns.map(c => c[k]))).filter(finite);
  const arrows = {
    rate: run => traces.map(trace => vector(run, trace.of, "rate")), acceleration: run => traces.map(trace => vector(run, trace.of, "acceleration")),
    force: run => (data.forces || []).map(({ of }) => loadOf(run, of)),
  };
  const measures = new Map();
  /** The size that is drawn as a long arrow, of a run by itself or of all that are compared. */
  function measure(key, run) {
    const id = `${stops.indexOf(stop)} ${key} ${state.overlay ? "" : runs.indexOf(run)}`;
    if (!measures.has(id)) measures.set(id, usualSize((state.overlay ? runs : [run]).flatMap(run => arrows[key](run).filter(Boolean).flatMap(sizes))));
    return measures.get(id);
  }
  const LEGIBLE = 26; // pixels of a usual bar
  const LONG = 6; // times as wide as high: over the whole page
  const view = {}; // width, height, scale and the maps X, Y from metres to pixels
  const camera = { zoom: options === large ? 0 : 1, first: 1, dx: 0, dy: 0 }; // times the scale that shows all, and pixels from its middle
  let figures = [], held = null; // scale and middle, which an orbit leaves as they are

  /** Distance (m) of two points at the first instant. */
  function distanceAtStart(run, a, b) {
    const [p, q] = [vector(run, a), vector(run, b)];
    return Math.hypot(p[0][0] - q[0][0], p[1][0] - q[1][0]);
  }

  /** The profile of a cam in its own frame (m): where the contact has been, turned back by the cam's angle. */
  function profile(run, item) {
    const [[cx, cy], [px, py]] = [vector(run, item.at), vector(run, item.contact)], turn = scalar(run, item.turn) || [];
    return [...turn.keys()].filter(k => finite(turn[k]) && finite(px[k])).map(k => {
      const [c, s, x, y] = [Math.cos(turn[k]), Math.sin(turn[k]), px[k] - cx[k], py[k] - cy[k]];
      return [c * x + s * y, c * y - s * x];
    });
  }

  /** Module of a gear (m): pitch diameter by teeth. */
  const moduleOf = (run, item) => 2 * distanceAtStart(run, item.at, item.rim) / item.teeth;

  /** Circles that hold what a shape covers beyond its points: pairs of a centre and a radius (m). */
  function circles(run, item) {
    switch (item.kind) {
      case "wheel": return [[item.at, distanceAtStart(run, item.at, item.rim)]];
      case "gear": return [[item.at, distanceAtStart(run, item.at, item.rim) + moduleOf(run, item) * (item.inside ? RING : 1)]];
      case "cam": return [[item.at, largest([profile(run, item).map(p => Math.hypot(...p))])]];
      case "geneva": return [[item.wheel, distanceAtStart(run, item.wheel, item.rim)]];
      default: return [];
    }
  }

  function fit() {
    const drawn = (options.fitted || options.runs)();
    const covered = i => run => items.flatMap(item => circles(run, item)).flatMap(([name, radius]) =>
      extent([vector(run, name)[i]]).map((x, end) => end ? x + radius : x - radius));
    const reach = [0, 1].map(i => extent(drawn.flatMap(run => [...[...known].map(name => vector(run, name)[i]), covered(i)(run)])));
    const [dx, dy] = reach.map(([low, high]) => high - low);
    const size = Math.max(dx, dy) || 1;
    // An orbit leaves the layout of the page as it is, however thin the picture becomes.
    const long = space && space.turned ? view.long : LONG * dy < dx;
    view.long = long;
    if (options === large) document.querySelector(".viewer").classList.toggle("long", long);
    view.width = Math.max(root.parentNode.clientWidth - 2, 200);
    const small = { left: 26, right: 26, top: 32, bottom: 30 };
    const pad = !options.axes ? small : view.width < 500 ? { left: 58, right: 34, top: 40, bottom: 60 } : { left: 78, right: 46, top: 46, bottom: 70 };
    const wide = view.width - pad.left - pad.right;
    view.height = Math.round(clamp(dy / (dx || size) * wide + pad.top + pad.bottom, long ? 0 : options.least(view.width), options.axes ? 580 : 420));
    view.scale = Math.min(wide / (dx || size), (view.height - pad.top - pad.bottom) / (dy || size));
    // No thicker than a quarter of what bars are long in the middle.
    const lengths = items.filter(item => item.points && item.points.length > 1).map(item => distanceAtStart(drawn[0], ...item.points));
    const usual = lengths.sort((a, b) => a - b)[lengths.length >> 1] || Infinity;
    if (options === large && camera.zoom === 0) { // first a part of what would be too small to see, where its path is
      camera.zoom = clamp(LEGIBLE / (usual * view.scale), 1, 4);
      if (camera.zoom < 1.6) camera.zoom = 1;
      camera.first = camera.zoom;
      camera.dx = -(camera.zoom - 1) * wide / 2;
    }
    if (options === large && camera.first > 1) view.height = Math.max(view.height, Math.round(dy * view.scale * camera.first + pad.top + pad.bottom));
    let [cx, cy] = reach.map(([low, high]) => (low + high) / 2);
    if (space && options === large) {
      const middle = middleInSpace(drawn), seenAt = [dot(space.right, middle), dot(space.up, middle)];
      if (!space.turned || !held) held = { width: view.width, height: view.height, scale: view.scale, from: [cx - seenAt[0], cy - seenAt[1]] };
      [view.scale, view.height] = [held.scale, held.height];
      [cx, cy] = [seenAt[0] + held.from[0], seenAt[1] + held.from[1]];
    }
    view.scale *= camera.zoom;
    const middle = [pad.left + wide / 2, pad.top + (view.height - pad.top - pad.bottom) / 2];
    view.middle = middle;
    view.X = x => middle[0] + camera.dx + (x - cx) * view.scale;
    view.Y = y => middle[1] + camera.dy - (y - cy) * view.scale;
    view.bar = clamp(Math.min(view.width, view.height) * .03, Math.min(options.axes ? 9 : 6, Math.max(usual * view.scale / 4, 2)), 15);
    view.thin = clamp(view.bar / 8, .3, 1); // of lines, where all is small
    root.style.setProperty("--thin", view.thin);
    view.arrow = Math.min(view.width, view.height) * .22;
    for (const [key, value] of Object.entries({ width: view.width, height: view.height, viewBox: `0 0 ${view.width} ${view.height}` })) root.setAttribute(key, value);
  }

  /** Middle of all points in space over all instants. */
  function middleInSpace(drawn) {
    const all = drawn.flatMap(run => [...known].map(name => components(run, name)).filter(c => c && c.length === 3));
    return [0, 1, 2].map(i => { const [low, high] = extent(all.map(c => c[i])); return (low + high) / 2; });
  }

  /** The axes of space in a corner. */
  function triad() {
    const [x, y] = [view.width - 44, 44], axes = ["x", "y", "z"].map((name, i) => [name, 26 * space.right[i], -26 * space.up[i]]);
    return svg("g", { class: "triad" }, ...axes.flatMap(([name, u, v]) => [svg("path", { d: `M${x} ${y}l${u.toFixed(1)} ${v.toFixed(1)}` }),
      svg("text", { x: x + u * 1.35, y: y + v * 1.35 + 4, "text-anchor": "middle" }, name)]));
  }

  function grid() {
    const { width, height, scale, X, Y } = view;
    const group = svg("g");
    const [x0, y0] = [-X(0) / scale, (Y(0) - height) / scale];
    const step = niceStep((width < 500 ? 44 : 72) / scale), rise = niceStep(Math.min(width < 500 ? 44 : 72, height / 4) / scale);
    const across = linearTicks(x0, x0 + width / scale, step), up = linearTicks(y0, y0 + height / scale, rise);
    const left = 12 + widest(up.ticks.map(([, text]) => text));
    const [right, upwards] = space ? ["to the right of the view", "upwards in the view"] : ["x", "y"];
    const title = `${right} [${across.factor}m]`;
    for (const [x, text] of across.ticks) {
      const half = widest([text]) / 2;
      group.append(svg("path", { class: "gridline", d: `M${X(x)} 0V${height - 24}` }));
      if (X(x) > left && X(x) + half < width - 16 - 7.2 * title.length) group.append(svg("text", { x: X(x), y: height - 9, "text-anchor": "middle" }, text));
    }
    for (const [y, text] of up.ticks) {
      if (Y(y) > height - 30) continue;
      group.append(svg("path", { class: "gridline", d: `M${left + 6} ${Y(y)}H${width}` }));
      if (Y(y) > 28) group.append(svg("text", { x: left, y: Y(y) + 4, "text-anchor": "end" }, text));
    }
    group.append(svg("text", { class: "axis-title", x: width - 8, y: height - 9, "text-anchor": "end" }, title),
      svg("text", { class: "axis-title", x: 8, y: 17 }, `${upwards} [${up.factor}m]`));
    return group;
  }

  function figure(run, ghost) {
    const f = { run, ghost, labels: [], obstacles: [], node: svg("g", ghost ? { class: "ghost" } : {}) };
    for (const layer of ["under", "traces", "bodies", "pins", "arrows", "text"]) f.node.append(f[layer] = svg("g"));
    const values = new Map([...known].map(name => [name, vector(run, name)])), parts = [];
    for (const { at } of data.forces || []) if (!values.has(at)) values.set(at, vector(run, at));
    f.at = (name, k) => { const [x, y] = values.get(name); return [+view.X(x[k]).toFixed(2), +view.Y(y[k]).toFixed(2)]; };
    const layer = f.bodies;
    const updates = items.filter(item => builders[item.kind]).map(item => {
      f.bodies = svg("g");
      layer.append(f.bodies);
      parts.push([item, f.bodies]);
      return builders[item.kind](item, f);
    });
    updates.push(...(data.forces || []).filter(({ at }) => values.get(at)).map(item => force(item, f)));
    if (!ghost) for (const name of [...known].filter(name => !name.includes("_"))) if (options.axes || known.size < MANY) label(f, name, "name", aroundPoint(f, name));
    else if (known.size) label(f, run.label, "label", aroundPoint(f, traces.length ? traces[0].of : names[0]));
    f.labels.reverse(); // names of points settle before those of bodies
    f.update = () => {
      const k = options.at(run);
      f.obstacles = [];
      for (const update of updates) update(k);
      if (space) sortByDepth(layer, parts, run, k);
      f.text.toggleAttribute("hidden", !options.shows("labels"));
      if (options.shows("labels")) for (const settle of f.labels) settle(k);
    };
    return f;
  }

  /** Nearer bodies over farther ones. */
  function sortByDepth(layer, parts, run, k) {
    const towards = cross(space.right, space.up);
    const depth = item => {
      const all = pointsOf(item).map(name => components(run, name)).filter(c => c && c.length === 3);
      return all.reduce((sum, c) => sum + dot(towards, c.map(values => values[k])), 0) / (all.length || 1);
    };
    const order = parts.map(([item, node]) => [depth(item), node]).sort((a, b) => a[0] - b[0]).map(([, node]) => node);
    if (order.some((node, i) => layer.children[i] !== node)) layer.append(...order);
  }

  const { builders, label, aroundPoint, force } = createBuilders({ view, items, options, measure, distanceAtStart, profile, moduleOf, colourOf, onRail });

  return {
    view, camera,
    layout() {
      fit();
      figures = options.runs().map((run, order) => figure(run, order > 0));
      root.replaceChildren(...(options.axes ? [grid()] : []), ...figures.map(f => f.node).reverse(), ...(options.axes && space ? [triad()] : []));
    },
    frame() { for (const f of figures) f.update(); },
  };
}
