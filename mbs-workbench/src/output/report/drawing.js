// ---------------------------------------------------------------- the drawing

/** How points in space are seen, where the drawing has a view. */
const space = drawing.find(item => item.kind === "view");

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

/** A coordinate or a scalar output over time, or null where the run has none of this name. */
function scalar(run, name) {
  const coordinate = (run.coordinates || []).find(coordinate => coordinate.name === name);
  return coordinate ? coordinate.q : (columns(run).find(output => output.name === name) || {}).value || null;
}

const pointsOf = item => [...(item.points || []), ...["at", "of", "rim", "contact", "back", "pin", "wheel"].map(key => item[key]).filter(Boolean)];
const coloured = ["link", "plate", "slot", "wheel", "gear", "cam", "face"]; // kinds that take the next colour

/** Runs on show of the large drawing, and what it shows of them. */
const large = { runs: shown, at: run => sample(run), shows: what => state[what], least: width => Math.min(340, width * .75), axes: true };

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

  const speeds = {};
  for (const key of ["rate", "acceleration"]) {
    speeds[key] = Math.hypot(...[0, 1].map(i => largest(runs.flatMap(run => traces.map(trace => (vector(run, trace.of, key) || [])[i])))));
  }
  const LONG = 6; // times as wide as high: over the whole page
  const RING = 3.4; // modules from the pitch circle of a ring gear to its outer edge
  const view = {}; // width, height, scale and the maps X, Y from metres to pixels
  let figures = [];

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
    const drawn = options.runs();
    const covered = i => run => items.flatMap(item => circles(run, item)).flatMap(([name, radius]) =>
      extent([vector(run, name)[i]]).map((x, end) => end ? x + radius : x - radius));
    const reach = [0, 1].map(i => extent(drawn.flatMap(run => [...[...known].map(name => vector(run, name)[i]), covered(i)(run)])));
    const [dx, dy] = reach.map(([low, high]) => high - low);
    const size = Math.max(dx, dy) || 1;
    const long = LONG * dy < dx;
    if (options === large) document.querySelector(".viewer").classList.toggle("long", long);
    view.width = Math.max(root.parentNode.clientWidth - 2, 200);
    const small = { left: 20, right: 20, top: 18, bottom: 24 };
    const pad = !options.axes ? small : view.width < 500 ? { left: 58, right: 34, top: 40, bottom: 60 } : { left: 78, right: 46, top: 46, bottom: 70 };
    const wide = view.width - pad.left - pad.right;
    view.height = Math.round(clamp(dy / (dx || size) * wide + pad.top + pad.bottom, long ? 0 : options.least(view.width), options.axes ? 580 : 260));
    const high = view.height - pad.top - pad.bottom;
    view.scale = Math.min(wide / (dx || size), high / (dy || size));
    const [cx, cy] = reach.map(([low, high]) => (low + high) / 2);
    view.X = x => pad.left + wide / 2 + (x - cx) * view.scale;
    view.Y = y => pad.top + high / 2 - (y - cy) * view.scale;
    // No thicker than a quarter of what bars are long in the middle.
    const lengths = items.filter(item => item.points && item.points.length > 1).map(item => distanceAtStart(drawn[0], ...item.points) * view.scale);
    const middle = lengths.sort((a, b) => a - b)[lengths.length >> 1] || Infinity;
    view.bar = clamp(Math.min(view.width, view.height) * .03, Math.min(options.axes ? 9 : 6, Math.max(middle / 4, 3)), 15);
    view.arrow = Math.min(view.width, view.height) * .22;
    for (const [key, value] of Object.entries({ width: view.width, height: view.height, viewBox: `0 0 ${view.width} ${view.height}` })) root.setAttribute(key, value);
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

  /** Hatching below the line from x0 to x1 at height y. */
  function hatching(x0, x1, y) {
    const n = Math.max(3, Math.round((x1 - x0) / 7)), step = (x1 - x0) / n;
    let d = `M${x0} ${y}H${x1}`;
    for (let i = 0; i < n; i++) d += `M${x0 + (i + 1) * step} ${y}l-6 7`;
    return svg("path", { class: "hatch", d });
  }

  /** Direction of a guide in pixels as an angle in degrees, turned so that its hatching is below or at the right. */
  function inclination(item) {
    const [x, y] = item.along && Math.hypot(...item.along) > 0 ? item.along : [1, 0];
    let angle = Math.atan2(-y, x) * 180 / Math.PI;
    if (angle > 90) angle -= 180;
    if (angle <= -90) angle += 180;
    return angle === 90 ? -90 : angle;
  }

  const blockSize = () => [view.bar * 2.9, view.bar * 1.8];
  const slotWidth = () => view.bar * 1.15;
  const degrees = (a, b) => Math.atan2(b[1] - a[1], b[0] - a[0]) * 180 / Math.PI; // in pixels

  /** A function of the sample that gives the direction of a slide in pixels (degrees). */
  function directionOf(item, f) {
    if (typeof item.along !== "string") { const angle = inclination(item); return () => angle; }
    const pair = vector(f.run, item.along), angle = scalar(f.run, item.along);
    return k => -(pair ? Math.atan2(pair[1][k], pair[0][k]) : angle ? angle[k] : 0) * 180 / Math.PI;
  }

  // One builder a kind: adds nodes to the layers of a figure and returns what moves them to sample k.
  const builders = {
    ground(item, f) {
      const b = view.bar * 1.25, node = svg("g", {}, svg("path", { class: "support", d: `M0 0L${b} ${b * 1.7}H${-b}Z` }), hatching(-b * 1.5, b * 1.5, b * 1.7));
      f.under.append(node);
      const pin = builders.joint(item, f);
      return k => {
        const [x, y] = f.at(item.at, k);
        node.setAttribute("transform", `translate(${x} ${y})`);
        f.obstacles.push([[x, y], [x, y + 2 * b]]);
        pin(k);
      };
    },
    joint(item, f) {
      const node = svg("circle", { class: "pin", r: view.bar * .36 });
      f.pins.append(node);
      return k => node.setAttribute("transform", `translate(${f.at(item.at, k)})`);
    },
    rail(item, f) {
      const angle = directionOf(item, f)(0), [cos, sin] = [Math.cos(angle * Math.PI / 180), Math.sin(angle * Math.PI / 180)];
      const [xs, ys] = vector(f.run, item.at);
      const way = xs.map((x, k) => (view.X(x) - view.X(xs[0])) * cos + (view.Y(ys[k]) - view.Y(ys[0])) * sin);
      const [low, high] = extent([way]), [w, h] = blockSize();
      const node = svg("g", { transform: `translate(${f.at(item.at, 0)}) rotate(${angle})` }, hatching(low - w, high + w, h / 2));
      f.under.append(node);
      return () => {};
    },
    slider(item, f) {
      // On a rail of its own below everything; on a bar or in a slot where it stands in the list.
      const rail = onRail(item), slotted = !rail && items.some(other => other.kind === "slot");
      const [w, h] = slotted ? [view.bar * 2, slotWidth() - 2] : blockSize();
      const node = svg("rect", { class: "block", x: -w / 2, y: -h / 2, width: w, height: h, rx: 2 });
      (rail ? f.under : f.bodies).append(node);
      const pin = builders.joint(item, f), direction = directionOf(item, f);
      return k => {
        const [x, y] = f.at(item.at, k), angle = direction(k);
        const [cos, sin] = [Math.cos(angle * Math.PI / 180) / 2, Math.sin(angle * Math.PI / 180) / 2];
        node.setAttribute("transform", `translate(${x} ${y}) rotate(${angle})`);
        for (const side of [h, 0, -h]) {
          const [cx, cy] = [x - side * sin, y + side * cos];
          f.obstacles.push([[cx - w * cos, cy - w * sin], [cx + w * cos, cy + w * sin]]);
        }
        pin(k);
      };
    },
    wheel(item, f) {
      const radius = distanceAtStart(f.run, item.at, item.rim) * view.scale;
      const mark = svg("path", { class: "mark", d: `M${radius * .45} 0H${radius * .85}` });
      return round(item, f, radius, [svg("circle", { class: "disc", r: radius, style: `fill: ${colourOf(item)}` }), mark]);
    },
    gear(item, f) {
      const radius = distanceAtStart(f.run, item.at, item.rim) * view.scale, m = moduleOf(f.run, item) * view.scale;
      const outline = teeth(radius, item.teeth, m, item.inside);
      const rim = item.inside ? circlePath(radius + RING * m) : circlePath(Math.max(radius * .12, 3));
      const parts = [svg("path", { class: "disc", "fill-rule": "evenodd", d: outline + rim, style: `fill: ${colourOf(item)}` })];
      if (!item.inside) parts.push(svg("circle", { class: "mark", cx: radius - 2.6 * m, r: Math.max(m * .5, 2) }));
      return round(item, f, item.inside ? radius + 2.3 * m : radius, parts);
    },
    cam(item, f) {
      const points = profile(f.run, item).map(([x, y]) => [x * view.scale, -y * view.scale]), turn = scalar(f.run, item.turn);
      const node = svg("polygon", { class: "disc", points: points.map(p => p.map(c => c.toFixed(2))).join(" "), style: `fill: ${colourOf(item)}` });
      const reach = largest([points.map(p => Math.hypot(...p))]);
      return round(item, f, reach, [node, svg("path", { class: "mark", d: `M0 ${-reach * .12}V${-reach * .36}` })], k => turn ? -turn[k] * 180 / Math.PI : 0);
    },
    face(item, f) {
      const node = svg("g"), colour = colourOf(item), thick = view.bar;
      const parts = [["bar-edge", view.bar], ["bar", view.bar - 3]].map(([name, width]) =>
        svg("line", { class: name, "stroke-width": width, style: name === "bar" ? `stroke: ${colour}` : "" }));
      const plate = svg("polygon", { class: "disc", style: `fill: ${colour}` });
      node.append(...parts, plate);
      f.bodies.append(node);
      if (item.label && !f.ghost) label(f, item.label, "label", besideBody(f, item));
      return k => {
        const [a, b] = item.points.map(name => f.at(name, k)), back = f.at(item.back, k);
        const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1, [ux, uy] = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
        const along = (back[0] - a[0]) * ux + (back[1] - a[1]) * uy, foot = [a[0] + along * ux, a[1] + along * uy];
        const away = Math.hypot(back[0] - foot[0], back[1] - foot[1]) || 1;
        const [nx, ny] = [(back[0] - foot[0]) / away * thick, (back[1] - foot[1]) / away * thick];
        plate.setAttribute("points", [a, b, [b[0] + nx, b[1] + ny], [a[0] + nx, a[1] + ny]].join(" "));
        for (const part of parts) {
          for (const [key, value] of [["x1", foot[0] + nx / 2], ["y1", foot[1] + ny / 2], ["x2", back[0]], ["y2", back[1]]]) part.setAttribute(key, value);
        }
        f.obstacles.push([a, b], [foot, back]);
      };
    },
    geneva(item, f) {
      const [d, r1, r2] = [[item.at, item.wheel], [item.at, item.pin], [item.wheel, item.rim]].map(pair => distanceAtStart(f.run, ...pair) * view.scale);
      const step = 180 / item.slots, pin = r1 * .08, lock = r1 * .76;
      const wheel = svg("g", {}, svg("path", { class: "disc", d: maltese(d, r1, r2, item.slots, pin, lock), style: "fill: var(--b1)" }));
      const driver = svg("g", {}, svg("path", { class: "disc", d: lockingDisc(d, r2, lock), style: "fill: var(--b0)" }),
        ...[["bar-edge", 0], ["bar", 3]].map(([name, less]) => svg("path", { class: name, d: `M0 0H${r1}`, "stroke-width": view.bar - less, style: less ? "stroke: var(--b0)" : "" })),
        svg("circle", { class: "disc", cx: r1, r: pin, style: "fill: var(--b3)" }));
      f.bodies.append(wheel, driver);
      return k => {
        const [o, a, c, r] = [item.at, item.pin, item.wheel, item.rim].map(name => f.at(name, k));
        wheel.setAttribute("transform", `translate(${c}) rotate(${degrees(c, r) - step})`);
        driver.setAttribute("transform", `translate(${o}) rotate(${degrees(o, a)})`);
        f.obstacles.push([o, a]);
      };
    },
    slot(item, f) {
      const inside = slotWidth();
      return body(item, f, "polyline", inside + view.bar, [svg("polyline", { class: "bar-edge", "stroke-width": inside }), svg("polyline", { class: "gap", "stroke-width": inside - 2.5 })]);
    },
    spring(item, f) {
      const node = svg("polyline", { class: "coil" });
      f.bodies.append(node);
      if (item.label && !f.ghost) label(f, item.label, "label", besideBody(f, item));
      return k => {
        const [a, b] = item.points.map(name => f.at(name, k)), [dx, dy] = [b[0] - a[0], b[1] - a[1]];
        const length = Math.hypot(dx, dy) || 1, [nx, ny] = [-dy / length * view.bar * .6, dx / length * view.bar * .6];
        // A straight end, eight half coils, a straight end.
        const coils = [...Array(9).keys()].map(i => [.15 + .7 * i / 8, i % 8 ? (i % 2 ? 1 : -1) : 0]);
        const points = [[0, 0], ...coils, [1, 0]].map(([s, side]) => [a[0] + s * dx + side * nx, a[1] + s * dy + side * ny]);
        node.setAttribute("points", points.map(p => p.map(c => c.toFixed(2))).join(" "));
        f.obstacles.push([a, b]);
      };
    },
    link: (item, f) => body(item, f, "polyline"),
    plate: (item, f) => body(item, f, "polygon"),
    road(item, f) {
      const soil = svg("path", { class: "soil" }), line = svg("path", { class: "road" });
      f.under.append(soil, line);
      if (item.label && !f.ghost) label(f, item.label, "label", k => { const [x, y] = f.at(item.at, k); return [[x + 8 * view.bar, y + 2 * view.bar]]; });
      const [xs, ys] = vector(f.run, item.at), time = f.run.time, last = time.length - 1;
      return k => {
        // What is met later lies ahead.
        const along = j => view.X(xs[k] + (time[j] - time[k]) * item.speed), from = options.axes ? 40 : 0, to = view.width;
        const met = [...time.keys()].filter(j => from < along(j) && along(j) < to).map(j => [along(j), view.Y(ys[j])]);
        const points = [[Math.min(from, met.length ? met[0][0] : from), view.Y(ys[met.length && along(0) < from ? sampleAt(time, time[k] + (from - view.X(xs[k])) / view.scale / item.speed) : 0])], ...met,
          [to, view.Y(ys[along(last) < to ? last : sampleAt(time, time[k] + (to - view.X(xs[k])) / view.scale / item.speed)])]];
        const d = `M${points.map(p => p.map(c => c.toFixed(1))).join("L")}`;
        line.setAttribute("d", d);
        soil.setAttribute("d", `${d}V${view.Y(0) + 2.2 * view.bar}H${from}Z`);
      };
    },
    trace(item, f) {
      const [xs, ys] = vector(f.run, item.of);
      const style = `stroke: var(--trace${traces.indexOf(item) % 2})`;
      let all = ""; // a prefix of this text is the part travelled
      const ends = xs.map((x, k) => {
        if (finite(x) && finite(ys[k])) all += `${view.X(x).toFixed(1)},${view.Y(ys[k]).toFixed(1)} `;
        return all.length;
      });
      const travelled = svg("polyline", { class: "trace travelled", style });
      f.traces.append(svg("polyline", { class: "trace", style, points: all }), travelled);
      const dot = svg("circle", { r: view.bar * .36, style: `fill: var(--trace${traces.indexOf(item) % 2}); stroke: var(--halo)` });
      f.pins.append(dot);
      const arrows = ["rate", "acceleration"].map(key => arrow(item, f, key));
      return k => {
        travelled.setAttribute("points", all.slice(0, ends[k]));
        dot.setAttribute("transform", `translate(${f.at(item.of, k)})`);
        for (const update of arrows) update(k);
      };
    },
  };

  function body(item, f, tag, width = view.bar, inner = []) {
    const colour = colourOf(item), solid = tag === "polygon";
    const edge = svg(tag, { class: "bar-edge", "stroke-width": width });
    const bar = svg(tag, { class: "bar", "stroke-width": width - 3, style: `stroke: ${colour}` });
    const parts = [edge, bar, ...inner];
    if (solid) parts.unshift(svg(tag, { style: `fill: ${colour}; fill-opacity: .4; stroke: none` }));
    f.bodies.append(...parts);
    if (item.label && !f.ghost) label(f, item.label, "label", besideBody(f, item));
    return k => {
      const points = item.points.map(name => f.at(name, k));
      for (const part of parts) part.setAttribute("points", points.join(" "));
      points.forEach((point, i) => { if (i || solid) f.obstacles.push([points.at(i - 1), point]); });
    };
  }

  /** A body about `item.at` of a radius in pixels, turned by `angle(k)` in degrees or towards its rim. */
  function round(item, f, radius, parts, angle = k => degrees(f.at(item.at, k), f.at(item.rim, k))) {
    const node = svg("g", {}, ...parts);
    f.bodies.append(node);
    if (item.label && !f.ghost) label(f, item.label, "label", aroundDisc(f, item, radius));
    return k => node.setAttribute("transform", `translate(${f.at(item.at, k)}) rotate(${angle(k)})`);
  }

  /**
   * A label that keeps clear of bars, arrows and other labels: `places(k, width)` lists where its centre
   * may be, each with a penalty in pixels.
   * It moves to another place only where that is clearly better, so that it does not flicker.
   */
  function label(f, text, className, places) {
    const node = svg("text", { class: className, "text-anchor": "middle" }, text), width = 7 * text.length;
    let pick = 0;
    f.text.append(node);
    f.labels.push(k => {
      const candidates = places(k, width);
      const room = ([x, y, penalty = 0]) => -penalty + Math.min(view.bar / 2 + 8, ...f.obstacles.flatMap(([a, b]) => [-.5, -.25, 0, .25, .5].map(s => distance([x + s * (width - 6), y], a, b))));
      const rooms = candidates.map(room), best = rooms.indexOf(Math.max(...rooms));
      if (rooms[best] > rooms[pick] + 4) pick = best;
      const [x, y] = candidates[pick];
      node.setAttribute("x", x.toFixed(1));
      node.setAttribute("y", (y + 4).toFixed(1));
      f.obstacles.push([[x - width / 2, y], [x + width / 2, y]]);
    });
  }

  const aroundPoint = (f, name) => (k, width) => {
    const [x, y] = f.at(name, k), away = view.bar / 2 + 12;
    return [5, 7, 4, 6, 0, 2, 3, 1].map(i => [Math.cos(i * Math.PI / 4), Math.sin(i * Math.PI / 4)])
      .flatMap(([dx, dy]) => [[away, 0], [1.8 * away, 5]].map(([r, penalty]) => [x + dx * (r + width / 2 - 5), y + dy * r, penalty]));
  };

  /** In the middle of a plate, at either side of a bar about its middle. */
  const besideBody = (f, item) => (k, width) => {
    const points = item.points.map(name => f.at(name, k)), [a, b] = [points[0], points[points.length - 1]];
    const [x, y] = [0, 1].map(i => points.reduce((sum, p) => sum + p[i], 0) / points.length);
    if (item.kind === "plate") return [[x, y]];
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1, [nx, ny] = [(a[1] - b[1]) / length, (b[0] - a[0]) / length];
    return [0, -.22, .22].flatMap(s => [1, -1].map(side => [s, side * (view.bar / 2 + 10 + Math.abs(nx) * (width / 2 - 3))]))
      .map(([s, r]) => [x + s * (b[0] - a[0]) + nx * r, y + s * (b[1] - a[1]) + ny * r]);
  };

  /** Inside a disc where it is large, else around it. */
  const aroundDisc = (f, item, radius) => (k, width) => {
    const [x, y] = f.at(item.at, k), inside = radius > width / 2 + 14, place = radius * (item.inside ? 1 : .62); // on a ring's rim
    return [2, 6, 1, 3, 5, 7, 0, 4].map(i => [Math.cos(i * Math.PI / 4), Math.sin(i * Math.PI / 4)])
      .map(([dx, dy]) => inside ? [x + dx * place, y + dy * place] : [x + dx * (radius + width / 2 + 6), y + dy * (radius + 12)]);
  };

  function arrow(item, f, key) {
    const values = vector(f.run, item.of, key), name = key === "rate" ? "velocity" : key;
    const node = svg("path", { class: "arrow", style: `stroke: var(--${name})` });
    f.arrows.append(node);
    return k => {
      const [u, v] = values && options.shows(name) && speeds[key] > 0 ? values.map(c => c[k] / speeds[key] * view.arrow) : [0, 0];
      const length = Math.hypot(u, v);
      if (!(length > 1.5)) return node.setAttribute("d", "");
      const [x, y] = f.at(item.of, k), [tx, ty] = [x + u, y - v], head = Math.min(9, length * .6) / length;
      const wing = side => `${tx - head * (u + side * v * .5)} ${ty + head * (v - side * u * .5)}`;
      f.obstacles.push([[x, y], [tx, ty]]);
      node.setAttribute("d", `M${x} ${y}L${tx} ${ty}M${wing(1)}L${tx} ${ty}L${wing(-1)}`);
    };
  }

  function figure(run, ghost) {
    const f = { run, ghost, labels: [], obstacles: [], node: svg("g", ghost ? { class: "ghost" } : {}) };
    for (const layer of ["under", "traces", "bodies", "pins", "arrows", "text"]) f.node.append(f[layer] = svg("g"));
    const values = new Map([...known].map(name => [name, vector(run, name)]));
    f.at = (name, k) => { const [x, y] = values.get(name); return [+view.X(x[k]).toFixed(2), +view.Y(y[k]).toFixed(2)]; };
    const updates = items.filter(item => builders[item.kind]).map(item => builders[item.kind](item, f));
    if (!ghost) for (const name of [...known].filter(name => !name.includes("_"))) label(f, name, "name", aroundPoint(f, name));
    else if (known.size) label(f, run.label, "label", aroundPoint(f, traces.length ? traces[0].of : names[0]));
    f.labels.reverse(); // names of points settle before those of bodies
    f.update = () => {
      const k = options.at(run);
      f.obstacles = [];
      for (const update of updates) update(k);
      f.text.style.display = options.shows("labels") ? "" : "none";
      if (options.shows("labels")) for (const settle of f.labels) settle(k);
    };
    return f;
  }

  return {
    layout() {
      fit();
      figures = options.runs().map((run, order) => figure(run, order > 0));
      root.replaceChildren(...(options.axes ? [grid()] : []), ...figures.map(f => f.node).reverse());
    },
    frame() { for (const f of figures) f.update(); },
  };
}
