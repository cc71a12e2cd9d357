(() => {
"use strict";

// ---------------------------------------------------------------- elements, numbers

const byId = id => document.getElementById(id);

/** An element with properties and children; strings become text nodes, so that no text of the data is ever markup. */
function el(tag, properties = {}, ...children) {
  const node = Object.assign(document.createElement(tag), properties);
  node.append(...children);
  return node;
}

function svg(tag, attributes = {}, ...children) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
const finite = x => typeof x === "number" && Number.isFinite(x); // JSON spells what is not finite as null

/** [smallest, largest] of the finite numbers in some arrays, without spreading them over the stack. */
function extent(arrays) {
  let low = Infinity, high = -Infinity;
  for (const array of arrays) for (const x of array || []) if (finite(x)) {
    if (x < low) low = x;
    if (x > high) high = x;
  }
  return low <= high ? [low, high] : [0, 0];
}

const largest = arrays => { const [low, high] = extent(arrays); return Math.max(-low, high); };

const superscript = n => String(n).replace(/./g, c => c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c]);
const minus = text => text.replace("-", "−");

/** A formatter with as many decimals as a quantity up to `max` needs: digits do not dance while it changes. */
function formatter(max, digits = 5) {
  if (max > 0 && (max < 1e-3 || max >= 1e6)) return x => {
    if (!finite(x)) return "–";
    if (x === 0) return "0";
    const [mantissa, exponent] = x.toExponential(digits - 2).split("e");
    return `${minus(mantissa)}×10${superscript(Number(exponent))}`;
  };
  const decimals = clamp(digits - 1 - Math.floor(Math.log10(max || 1)), 0, 7);
  return x => {
    if (!finite(x)) return "–";
    const text = x.toFixed(decimals);
    return Number(text) === 0 ? text.replace("-", "") : minus(text);
  };
}

/** 1, 2 or 5 times a power of ten, at least `x`. */
function niceStep(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  return power * ([1, 2, 5].find(m => m * power >= x * (1 - 1e-9)) || 10);
}

/** Ticks of a linear axis about `step` apart; very large or small numbers share a power of ten, named in `factor`. */
function linearTicks(low, high, step) {
  step = niceStep(step);
  const magnitude = Math.floor(Math.log10(Math.max(Math.abs(low), Math.abs(high))) + 1e-9);
  const exponent = magnitude >= 4 || magnitude < -2 ? 3 * Math.floor(magnitude / 3) : 0;
  const decimals = clamp(exponent - Math.floor(Math.log10(step) + 1e-9), 0, 9);
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) {
    ticks.push([i * step, minus((i * step / 10 ** exponent).toFixed(decimals))]);
  }
  return { ticks, factor: exponent ? `10${superscript(exponent)} ` : "" };
}

/** The unit of the first or second derivative. */
function derived(unit, order) {
  if (order === 0) return unit || "1";
  const [, base, power] = /^(.*?)(?:\/s([²³]?))?$/.exec(unit || "1");
  const before = unit && unit.includes("/s") ? { "": 1, "²": 2, "³": 3 }[power || ""] : 0;
  return `${base}/s${["", "", "²", "³", "⁴", "⁵"][before + order]}`;
}

// ---------------------------------------------------------------- data and state

const data = JSON.parse(byId("data").textContent);
const runs = (data.runs || []).filter(run => run.time && run.time.length);
const drawing = data.drawing || [];
const state = { t: 0, primary: 0, overlay: false, playing: false, speed: 1, velocity: true, acceleration: true, labels: true };
const views = []; // each { layout(), frame() }: the former after a change of size or choice, the latter after one of time

if (!runs.length) {
  byId("problem").textContent = "The data hold no run: nothing to draw.";
  byId("problem").hidden = false;
}
const [start, end] = extent(runs.map(run => run.time));
const formatTime = formatter(Math.max(Math.abs(start), Math.abs(end)), 4);
const traces = drawing.filter(item => item.kind === "trace");

/** Runs on show, the primary one first. */
const shown = () => state.overlay ? [runs[state.primary], ...runs.filter((_, i) => i !== state.primary)] : [runs[state.primary]];
const dash = order => ["none", "6 3", "2 3", "9 3 2 3"][order % 4];

/** Index of the sample nearest to `t`: every number on show is one of the solver's, none is interpolated. */
function sample(run, t = state.t) {
  const time = run.time;
  let low = 0, high = time.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (time[middle] <= t) low = middle; else high = middle;
  }
  return t - time[low] <= time[high] - t ? low : high;
}

const layout = () => { if (runs.length) for (const view of views) view.layout(); frame(); };
const frame = () => { if (runs.length) for (const view of views) view.frame(); };
const setTime = t => { state.t = clamp(t, start, end); frame(); };

// ---------------------------------------------------------------- the drawing

/** Components of a vector output over time, or null where the run has no such point. */
function vector(run, name, key = "value") {
  const [x, y] = [0, 1].map(i => (run.outputs || []).find(output => output.name === `${name}.${i}`));
  return x && y && x[key] && y[key] ? [x[key], y[key]] : null;
}

/** A coordinate or a scalar output over time, or null where the run has none of this name. */
function scalar(run, name) {
  const coordinate = (run.coordinates || []).find(coordinate => coordinate.name === name);
  return coordinate ? coordinate.q : ((run.outputs || []).find(output => output.name === name) || {}).value || null;
}

const pointsOf = item => [...(item.points || []), ...["at", "of", "rim", "contact", "back", "pin", "wheel"].map(key => item[key]).filter(Boolean)];
const coloured = ["link", "plate", "slot", "wheel", "gear", "cam", "face"]; // kinds that take the next colour

function createStage() {
  const root = byId("stage");
  const names = [...new Set(drawing.flatMap(pointsOf))];
  const known = new Set(names.filter(name => runs.every(run => vector(run, name))));
  const items = drawing.filter(item => pointsOf(item).every(name => known.has(name)));
  const bodies = items.filter(item => coloured.includes(item.kind));
  // A shape without a label is a further part of the body before it.
  const bodyOf = item => Math.max(0, bodies.slice(0, bodies.indexOf(item) + 1).filter(body => body.label).length - 1);
  const colourOf = item => `var(--b${bodyOf(item) % 5})`;
  const onRail = item => items.some(rail => rail.kind === "rail" && rail.at === item.at);
  const missing = names.filter(name => !known.has(name));
  if (missing.length) byId("caption").textContent = `Not drawn, since no output has this name: ${missing.join(", ")}.`;
  root.setAttribute("aria-label", `Animated drawing: ${data.title}`);

  const speeds = {};
  for (const key of ["rate", "acceleration"]) {
    speeds[key] = Math.hypot(...[0, 1].map(i => largest(runs.flatMap(run => traces.map(trace => (vector(run, trace.of, key) || [])[i])))));
  }
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
    const covered = i => run => items.flatMap(item => circles(run, item)).flatMap(([name, radius]) =>
      extent([vector(run, name)[i]]).map((x, end) => end ? x + radius : x - radius));
    const reach = [0, 1].map(i => extent(shown().flatMap(run => [...[...known].map(name => vector(run, name)[i]), covered(i)(run)])));
    const [dx, dy] = reach.map(([low, high]) => high - low);
    const size = Math.max(dx, dy) || 1;
    view.width = Math.max(root.parentNode.clientWidth - 2, 200);
    const pad = view.width < 500 ? { left: 58, right: 34, top: 40, bottom: 60 } : { left: 78, right: 46, top: 46, bottom: 70 };
    const wide = view.width - pad.left - pad.right;
    view.height = Math.round(clamp(dy / (dx || size) * wide + pad.top + pad.bottom, Math.min(340, view.width * .75), 580));
    const high = view.height - pad.top - pad.bottom;
    view.scale = Math.min(wide / (dx || size), high / (dy || size));
    const [cx, cy] = reach.map(([low, high]) => (low + high) / 2);
    view.X = x => pad.left + wide / 2 + (x - cx) * view.scale;
    view.Y = y => pad.top + high / 2 - (y - cy) * view.scale;
    view.bar = clamp(Math.min(view.width, view.height) * .03, 9, 15);
    view.arrow = Math.min(view.width, view.height) * .22;
    for (const [key, value] of Object.entries({ width: view.width, height: view.height, viewBox: `0 0 ${view.width} ${view.height}` })) root.setAttribute(key, value);
  }

  function grid() {
    const { width, height, scale, X, Y } = view;
    const group = svg("g");
    const [x0, y0] = [-X(0) / scale, (Y(0) - height) / scale];
    const step = niceStep((width < 500 ? 44 : 72) / scale);
    const across = linearTicks(x0, x0 + width / scale, step), up = linearTicks(y0, y0 + height / scale, step);
    for (const [x, text] of across.ticks) {
      group.append(svg("path", { class: "gridline", d: `M${X(x)} 0V${height - 24}` }));
      if (X(x) > 40 && X(x) < width - 60) group.append(svg("text", { x: X(x), y: height - 9, "text-anchor": "middle" }, text));
    }
    for (const [y, text] of up.ticks) {
      if (Y(y) > height - 30) continue;
      group.append(svg("path", { class: "gridline", d: `M40 ${Y(y)}H${width}` }));
      if (Y(y) > 28) group.append(svg("text", { x: 34, y: Y(y) + 4, "text-anchor": "end" }, text));
    }
    group.append(svg("text", { class: "axis-title", x: width - 8, y: height - 9, "text-anchor": "end" }, `x [${across.factor}m]`),
      svg("text", { class: "axis-title", x: 8, y: 17 }, `y [${up.factor}m]`));
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

  const circlePath = r => `M${r} 0A${r} ${r} 0 1 1 ${-r} 0A${r} ${r} 0 1 1 ${r} 0Z`;
  const polar = (r, a) => `${(r * Math.cos(a)).toFixed(2)} ${(r * Math.sin(a)).toFixed(2)}`;

  /** Outline of a gear in pixels with a tooth (a gap, where the teeth point inwards) at the angle 0: straight flanks. */
  function teeth(radius, count, m, inside) {
    const pitch = 2 * Math.PI / count;
    // At the mark and beside it: how far from the pitch circle, in modules, and half the width there, in pitches.
    const [mark, beside] = inside ? [[1.25, .18], [-1, .32]] : [[1, .13], [-1.25, .33]];
    const corners = [[beside, -1], [mark, -1], [mark, 1], [beside, 1]];
    const points = [...Array(count).keys()].flatMap(i => corners.map(([[away, half], side]) => polar(radius + away * m, (i + side * half) * pitch)));
    return `M${points.join("L")}Z`;
  }

  /**
   * Outline of a Geneva wheel in pixels, the middle of a locking arc at the angle 0. `d`: between the centres, `r1`: of the
   * pin's circle, `r2`: of the wheel, `w`: half a slot's width, `lock`: radius of the locking disc.
   */
  function maltese(d, r1, r2, slots, w, lock) {
    const step = Math.PI / slots, arc = Math.acos(clamp((d * d + r2 * r2 - lock * lock) / (2 * d * r2), -1, 1)), edge = Math.asin(w / r2);
    const bottom = d - r1;
    let path = "";
    for (let i = 0; i < slots; i++) {
      const a = 2 * step * i, s = a + step, inner = [Math.hypot(bottom, w), Math.atan2(w, bottom)];
      path += `${i ? "L" : "M"}${polar(r2, a - arc)}A${lock} ${lock} 0 0 0 ${polar(r2, a + arc)}A${r2} ${r2} 0 0 1 ${polar(r2, s - edge)}`
        + `L${polar(inner[0], s - inner[1])}A${w} ${w} 0 0 0 ${polar(inner[0], s + inner[1])}L${polar(r2, s + edge)}A${r2} ${r2} 0 0 1 ${polar(r2, s + step - arc)}`;
    }
    return `${path}Z`;
  }

  /** The driver's disc in pixels: cut out towards the pin (angle 0) as the wheel's arms need it. */
  function lockingDisc(d, r2, lock) {
    const cut = r2 * 1.04, a = Math.acos(clamp((d * d + lock * lock - cut * cut) / (2 * d * lock), -1, 1));
    return `M${polar(lock, a)}A${lock} ${lock} 0 1 1 ${polar(lock, -a)}A${cut} ${cut} 0 0 0 ${polar(lock, a)}Z`;
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
      const room = ([x, y, penalty = 0]) => -penalty + Math.min(view.bar / 2 + 8, ...f.obstacles.flatMap(([a, b]) => [-.5, 0, .5].map(s => distance([x + s * (width - 6), y], a, b))));
      const rooms = candidates.map(room), best = rooms.indexOf(Math.max(...rooms));
      if (rooms[best] > rooms[pick] + 4) pick = best;
      const [x, y] = candidates[pick];
      node.setAttribute("x", x.toFixed(1));
      node.setAttribute("y", (y + 4).toFixed(1));
      f.obstacles.push([[x - width / 2, y], [x + width / 2, y]]);
    });
  }

  /** From a point to a segment. */
  function distance([x, y], [ax, ay], [bx, by]) {
    const [dx, dy] = [bx - ax, by - ay];
    const s = clamp(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1), 0, 1);
    return Math.hypot(x - ax - s * dx, y - ay - s * dy);
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
      const [u, v] = values && state[name] && speeds[key] > 0 ? values.map(c => c[k] / speeds[key] * view.arrow) : [0, 0];
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
      const k = sample(run);
      f.obstacles = [];
      for (const update of updates) update(k);
      f.text.style.display = state.labels ? "" : "none";
      if (state.labels) for (const settle of f.labels) settle(k);
    };
    return f;
  }

  return {
    layout() {
      fit();
      figures = shown().map((run, order) => figure(run, order > 0));
      root.replaceChildren(grid(), ...figures.map(f => f.node).reverse());
    },
    frame() { for (const f of figures) f.update(); },
  };
}

// ---------------------------------------------------------------- plots

const swatch = (colour, pattern = "none") => svg("svg", { width: 20, height: 8, "aria-hidden": "true" },
  svg("path", { d: "M1 4H19", style: `stroke: ${colour}; stroke-width: 2.6; stroke-dasharray: ${pattern}` }));

const LOWEST = 1e-18; // what a logarithmic axis shows for zero

/** Range and ticks of the ordinate, with a map from values to [0, 1]. */
function ordinate(panel, arrays, height) {
  let [low, high] = extent(arrays);
  if (panel.log) {
    low = Math.floor(Math.log10(Math.max(low, LOWEST)) + 1e-9);
    high = Math.ceil(Math.log10(Math.max(high, LOWEST)) - 1e-9);
    if (high - low < 2) [low, high] = [Math.max(low - 1, -18), high + 1];
    const stride = Math.ceil((high - low) / 6), ticks = [];
    for (let e = low; e <= high; e += stride) ticks.push([10 ** e, e === -18 ? "≤ 10" : "10", minus(String(e))]);
    return { ticks, factor: "", map: y => (Math.log10(Math.max(y, LOWEST)) - low) / (high - low) };
  }
  if (panel.zero) [low, high] = [Math.min(low, 0), Math.max(high, 0)];
  const size = Math.max(Math.abs(low), Math.abs(high));
  if (high - low <= size * 1e-4) { // noise on a constant is no shape
    high += size * .05 || (panel.zero ? 1 : .5);
    if (!(panel.zero && low === 0)) low -= size * .05 || .5;
  }
  const pad = (high - low) * .06;
  if (!(panel.zero && low === 0)) low -= pad;
  high += pad;
  const step = Math.max((high - low) / clamp(Math.floor(height / 34), 3, 6), panel.whole ? 1 : 0);
  return { ...linearTicks(low, high, step), map: y => (y - low) / (high - low) };
}

/**
 * A plot over time. `panel`: { title, unit, get(run, series), log, zero, whole }, `group`: { series: [{ name, colour, hidden }] }.
 */
function createPlot(host, panel, group) {
  const root = svg("svg", { role: "img" }), cursor = el("div", { className: "cursor" }), tip = el("div", { className: "tip", hidden: true });
  const box = el("div", { className: "plot" }, root, cursor, tip);
  const dots = svg("g");
  const area = { left: 54, right: 10, top: 31, bottom: 36 };
  let curves = [], axis, width, height, hovered = null;
  host.append(box);
  root.setAttribute("aria-label", `${panel.title} over time, ${group.series.map(s => s.name).join(", ")}`);

  const span = end - start || 1;
  const X = t => area.left + (t - start) / span * (width - area.left - area.right);
  const Y = y => area.top + (1 - axis.map(y)) * (height - area.top - area.bottom);

  function path(curve) {
    let d = "", pen = "M";
    curve.values.forEach((y, k) => {
      if (finite(y)) {
        d += `${pen}${X(curve.run.time[k]).toFixed(1)} ${Y(y).toFixed(1)}${pen === "M" ? "h0" : ""}`; // h0: a dot for a lone sample
        pen = "L";
      } else pen = "M";
    });
    return svg("path", { class: curve.order ? "curve ghost" : "curve", d, style: `stroke: ${curve.colour}; stroke-dasharray: ${dash(curve.order)}` });
  }

  function axes() {
    const nodes = [], bottom = height - area.bottom, right = width - area.right;
    for (const [y, text, power] of axis.ticks) {
      const raised = power ? [svg("tspan", { dy: -5, "font-size": 10 }, power)] : [];
      nodes.push(svg("path", { class: y === 0 ? "zero" : "gridline", d: `M${area.left} ${Y(y)}H${right}` }),
        svg("text", { x: area.left - 7, y: Y(y) + 4, "text-anchor": "end" }, text, ...raised));
    }
    const across = linearTicks(start, start + span, span / clamp(Math.floor(width / 64), 2, 6));
    for (const [t, text] of across.ticks) {
      nodes.push(svg("path", { class: "gridline", d: `M${X(t)} ${area.top}V${bottom}` }),
        svg("text", { x: Math.min(X(t), right - 4), y: bottom + 15, "text-anchor": "middle" }, text));
    }
    nodes.push(svg("rect", { class: "frame", x: area.left, y: area.top, width: right - area.left, height: bottom - area.top }),
      svg("text", { class: "axis-title", x: 2, y: 15 }, `${panel.title} [${axis.factor}${panel.unit}]`),
      svg("text", { class: "axis-title", x: (area.left + right) / 2, y: height - 5, "text-anchor": "middle" }, `t [${across.factor}s]`));
    return nodes;
  }

  function readout() {
    tip.hidden = hovered === null || !curves.length;
    dots.replaceChildren();
    if (tip.hidden) return;
    const rows = curves.map(({ run, order, name, colour, values, format }) => {
      const k = sample(run, hovered), y = values[k];
      if (finite(y)) dots.append(svg("circle", { cx: X(run.time[k]), cy: Y(y), r: 3.5, style: `fill: ${colour}` }));
      const label = state.overlay ? `${name} ${run.label}` : name || panel.title;
      return el("div", {}, swatch(colour, dash(order)), el("span", { textContent: label }), el("span", { textContent: format(y) }));
    });
    tip.replaceChildren(el("div", { textContent: `t = ${formatTime(curves[0].run.time[sample(curves[0].run, hovered)])} s` }), ...rows);
    const x = X(hovered), left = x < width / 2;
    tip.style.left = left ? `${x + 12}px` : "auto";
    tip.style.right = left ? "auto" : `${width - x + 12}px`;
  }

  function pointed(event) {
    const x = event.clientX - box.getBoundingClientRect().left;
    hovered = clamp(start + (x - area.left) / (width - area.left - area.right) * span, start, end);
    if (event.buttons & 1) { play(false); setTime(hovered); }
    readout();
  }
  box.addEventListener("pointermove", pointed);
  box.addEventListener("pointerdown", event => { if (event.button === 0) { box.setPointerCapture(event.pointerId); pointed(event); } });
  for (const type of ["pointerleave", "pointercancel"]) box.addEventListener(type, () => { hovered = null; readout(); });

  return {
    layout() {
      width = Math.max(box.clientWidth, 160);
      height = Math.round(clamp(width * .62, 190, 260));
      root.setAttribute("height", height);
      root.setAttribute("viewBox", `0 0 ${width} ${height}`);
      curves = group.series.filter(series => !series.hidden).flatMap(series => shown().map((run, order) =>
        ({ run, order, name: series.name, colour: series.colour, values: panel.get(run, series) }))).filter(curve => curve.values);
      for (const curve of curves) curve.format = formatter(panel.log ? 0.5 * LOWEST : largest([curve.values]), panel.whole ? 1 : 6);
      axis = ordinate(panel, curves.map(curve => curve.values), height);
      root.replaceChildren(...axes(), ...curves.map(path).reverse(), dots);
      cursor.style.top = `${area.top}px`;
      cursor.style.height = `${height - area.top - area.bottom}px`;
      readout();
    },
    frame() { cursor.style.transform = `translateX(${X(state.t).toFixed(1)}px)`; },
  };
}

/** Panels side by side with one legend; `list` names the series. */
function createGroup(host, title, names, panels, mark = () => "") {
  const group = { series: names.map((name, i) => ({ name, index: i, colour: `var(--s${i % 7})`, hidden: false })) };
  const legend = el("div", { className: "legend" }, ...(title ? [el("h3", { textContent: title })] : []));
  const row = el("div", { className: "panels" }), dashes = el("span", { className: "dashes" });
  host.append(el("div", { className: "group" }, legend, row));
  const plots = panels.map(panel => createPlot(row, panel, group));
  for (const series of group.series.filter(series => series.name)) {
    const button = el("button", { type: "button", title: "Show or hide" }, swatch(series.colour), series.name + mark(series.name));
    button.setAttribute("aria-pressed", "true");
    button.addEventListener("click", () => {
      series.hidden = !series.hidden;
      button.setAttribute("aria-pressed", String(!series.hidden));
      for (const plot of plots) { plot.layout(); plot.frame(); }
    });
    legend.append(button);
  }
  legend.append(dashes);
  views.push({
    layout() { dashes.replaceChildren(...(state.overlay ? shown().map((run, i) => el("span", {}, swatch("currentColor", dash(i)), run.label)) : [])); },
    frame() {},
  }, ...plots);
}

const forcesOf = run => run.dynamics || {};
/** What a name needs beside it: a value that is one choice of many is no fact. */
const markOf = (kind, name) => runs.some(run => entriesOf(run, kind).some(entry => entry.name === name && entry.shared)) ? " (not unique)" : "";
const entriesOf = (run, kind) => run[kind] || forcesOf(run)[kind] || [];

/** A group of plots a unit: values with rates and accelerations where the data have them. */
function createSeries(host, kind, symbols, keys) {
  const units = new Map();
  for (const { name, unit } of entriesOf(runs[0], kind)) units.set(unit, [...(units.get(unit) || []), name]);
  const find = (run, name) => entriesOf(run, kind).find(entry => entry.name === name);
  for (const [unit, all] of units) {
    const names = kind === "outputs" ? all.filter(plotted) : all;
    if (!names.length) continue;
    const panels = keys.map((key, order) => ({ title: symbols[order], unit: derived(unit, order), get: (run, series) => (find(run, series.name) || {})[key] }))
      .filter(panel => runs.some(run => names.some(name => panel.get(run, { name }))));
    const title = { rad: "Angles", m: "Lengths" }[unit] || (unit && unit !== "1" ? `In ${unit}` : "Without unit");
    createGroup(host, title, names, panels, name => markOf(kind, name));
  }
  host.parentNode.hidden = !host.childElementCount;
}

/** Points that only serve the drawing need no plot. */
function plotted(name) {
  const [, point] = /^(.*)\.\d+$/.exec(name) || [];
  return traces.some(trace => trace.of === point) || !drawing.some(item => pointsOf(item).includes(point));
}

function createSolver(host) {
  const integrated = runs.some(run => (forcesOf(run).closure_rate || []).length);
  const quantities = [
    { title: integrated ? "|Φ|" : "closure error", unit: "1", log: true, get: run => run.closure },
    { title: "|Φ̇|", unit: "1/s", log: true, get: run => forcesOf(run).closure_rate },
    { title: integrated ? "evaluations an instant" : "iterations a step", unit: "1", zero: true, whole: true, get: run => run.iterations },
    { title: "margin to singularity", unit: "1", zero: true, get: run => run.margin },
    { title: "rows that follow from others", unit: "1", zero: true, whole: true, get: run => (forcesOf(run).dependent_rows || []).length ? forcesOf(run).dependent : null },
  ].filter(({ get }) => runs.some(run => (get(run) || []).length));
  if (quantities.length) createGroup(host, "", [""], quantities);
  host.parentNode.hidden = !quantities.length;
}

/** Energies with what forces and drives have supplied, and what of their balance is not accounted for. */
function createEnergy(host) {
  const names = ["kinetic", "potential", "work", "defect"].filter(name => runs.some(run => (forcesOf(run)[name] || []).length));
  const panels = [["energy", name => name !== "defect"], ["balance defect", name => name === "defect"]]
    .filter(([, shows]) => names.some(shows))
    .map(([title, shows]) => ({ title, unit: "J", get: (run, series) => shows(series.name) ? forcesOf(run)[series.name] : null }));
  if (panels.length) createGroup(host, "", names, panels);
  host.parentNode.hidden = !host.childElementCount;
}

/** A table of forces over the run on show: now, least and largest. */
function createForces(host, kind) {
  const entries = entriesOf(runs[0], kind);
  if (!entries.length) return;
  const body = el("tbody"), updates = [];
  const head = el("tr", {}, ...["", "now", "least", "largest"].map(text => el("th", { scope: "col", textContent: text })));
  host.append(el("table", { className: "forces" }, el("thead", {}, head), body));
  for (const { name, unit } of entries) {
    const get = run => (entriesOf(run, kind).find(entry => entry.name === name) || {}).value || [];
    const format = formatter(largest(runs.map(get)), 6), cells = [0, 1, 2].map(() => el("td"));
    body.append(el("tr", {}, el("th", { scope: "row" }, name, el("small", { textContent: ` ${unit}${markOf(kind, name)}` })), ...cells));
    updates.push(k => {
      const values = get(runs[state.primary]), texts = [values[k], ...extent([values])].map(format);
      cells.forEach((cell, i) => { cell.textContent = texts[i]; });
    });
  }
  views.push({ layout() {}, frame() { const k = sample(runs[state.primary]); for (const update of updates) update(k); } });
}

// ---------------------------------------------------------------- values at the current time

function createValues() {
  const body = byId("values").tBodies[0], cells = [];
  for (const { name, unit } of runs[0].coordinates || []) {
    const row = el("tr", {}, el("th", { scope: "row", textContent: name, title: name }));
    ["q", "qd", "qdd"].forEach((key, order) => {
      const get = run => ((run.coordinates || []).find(c => c.name === name) || {})[key] || [];
      const max = largest(runs.map(get)), angle = unit === "rad";
      const number = el("span"), degrees = el("span", { className: "degrees" });
      const cell = el("td", {}, number, el("small", { textContent: ` ${derived(unit, order)}` }), ...(angle ? [degrees] : []));
      const format = formatter(max, 5), formatDegrees = formatter(max * 180 / Math.PI, 4);
      cells.push(k => {
        const x = get(runs[state.primary])[k];
        number.textContent = format(x);
        cell.dataset.value = x;
        if (angle) degrees.textContent = formatDegrees(finite(x) ? x * 180 / Math.PI : x) + "°" + ["", "/s", "/s²"][order];
      });
      row.append(cell);
    });
    body.append(row);
  }
  const time = el("span");
  byId("time").append(el("i", { textContent: "t" }), " = ", time, " s");
  return {
    layout() {
      const run = runs[state.primary];
      byId("run").textContent = [run.label, run.description].filter(Boolean).join(": ");
    },
    frame() {
      const k = sample(runs[state.primary]);
      byId("time").dataset.value = runs[state.primary].time[k];
      time.textContent = formatTime(runs[state.primary].time[k]);
      for (const update of cells) update(k);
    },
  };
}

// ---------------------------------------------------------------- controls

let last = null;
function tick(now) {
  if (!state.playing) return;
  const step = last === null ? 0 : Math.min((now - last) / 1000, .1) * state.speed; // a hidden tab does not jump ahead
  last = now;
  const t = state.t + step;
  setTime(t < end ? t : start);
  requestAnimationFrame(tick);
}

function play(on) {
  if (on === state.playing || (on && end <= start)) return;
  state.playing = on;
  last = null;
  byId("play").textContent = on ? "Pause" : "Play";
  if (on) requestAnimationFrame(tick);
}

function createTransport() {
  const scrub = byId("scrub"), speed = byId("speed");
  for (const factor of [10, 5, 2, 1, .5, .25, .1, .05, .02, .01, .001]) speed.append(el("option", { value: factor, textContent: `${factor}×` }));
  // A first round that takes some four seconds, real time for anything longer.
  const first = [...speed.options].find(option => option.value <= clamp((end - start) / 4, .001, 1));
  speed.value = (first || speed.options[3]).value;
  state.speed = Number(speed.value);
  speed.addEventListener("change", () => { state.speed = Number(speed.value); });
  byId("play").addEventListener("click", () => play(!state.playing));
  scrub.addEventListener("input", () => { play(false); setTime(runs[state.primary].time[Number(scrub.value)]); });
  document.addEventListener("keydown", event => {
    if (event.key !== " " || event.repeat || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target.closest("button, select, input:not([type=range])")) return; // these know the key themselves
    event.preventDefault();
    play(!state.playing);
  });
  return {
    layout() { scrub.max = runs[state.primary].time.length - 1; },
    frame() {
      scrub.value = sample(runs[state.primary]);
      scrub.setAttribute("aria-valuetext", `${formatTime(state.t)} seconds`);
    },
  };
}

function createAssembly() {
  const host = byId("assembly");
  const choices = runs.map((run, i) => [String(i), run.label]);
  if (runs.length > 1) choices.push(["both", runs.length > 2 ? "all" : "both"]);
  for (const [value, label] of choices) {
    const input = el("input", { type: "radio", name: "assembly", value, checked: value === "0" });
    input.addEventListener("change", () => {
      state.overlay = value === "both";
      if (!state.overlay) state.primary = Number(value);
      layout();
    });
    host.append(el("label", {}, input, label));
  }
}

/** What the drawing shows, with the present speed and acceleration of the first traced point. */
function createShow() {
  const host = byId("show"), readouts = [];
  traces.forEach((trace, i) => {
    if (trace.label) host.append(el("span", { className: "key", title: `path of ${trace.of}` }, swatch(`var(--trace${i % 2})`), trace.label));
  });
  const add = (key, label, colour, ...more) => {
    const input = el("input", { type: "checkbox", id: `show-${key}`, checked: state[key] });
    input.addEventListener("change", () => { state[key] = input.checked; frame(); });
    host.append(el("label", {}, input, ...(colour ? [swatch(colour)] : []), label, ...more));
  };
  for (const [key, name, unit] of [["rate", "velocity", "m/s"], ["acceleration", "acceleration", "m/s²"]]) {
    const with_ = traces.filter(trace => runs.some(run => vector(run, trace.of, key)));
    if (!with_.length) continue;
    const readout = el("output", { title: `of ${with_[0].of}` });
    const norm = (run, k) => { const v = vector(run, with_[0].of, key); return v ? Math.hypot(v[0][k], v[1][k]) : null; };
    const format = formatter(largest(runs.map(run => run.time.map((_, k) => norm(run, k)))), 4);
    readouts.push(() => { const run = runs[state.primary]; readout.textContent = `${format(norm(run, sample(run)))} ${unit}`; });
    add(name, name, `var(--${name})`, readout);
  }
  add("labels", "names", null);
  return { layout() {}, frame() { for (const update of readouts) update(); } };
}

// ---------------------------------------------------------------- text

/** The source without blank lines at its ends and without the indentation that all its lines share. */
function trimmed(text) {
  const lines = text.replace(/^\s*\n|\s+$/g, "").split("\n");
  const indents = lines.filter(line => line.trim()).map(line => /^\s*/.exec(line)[0].length);
  const indent = indents.reduce((a, b) => Math.min(a, b), Infinity);
  return lines.map(line => line.slice(indent)).join("\n");
}

function createText() {
  byId("kicker").textContent = `mbs · ${data.name}`;
  byId("title").textContent = data.title;
  byId("description").textContent = data.description || "";
  byId("command").textContent = data.command || "";
  byId("command").parentNode.hidden = !data.command;
  for (const [name, value] of data.facts || []) {
    byId("facts").tBodies[0].append(el("tr", {}, el("th", { scope: "row", textContent: name }), el("td", { textContent: value })));
  }
  byId("source").firstChild.textContent = trimmed(data.source || "");
  const samples = runs.map(run => run.time.length), same = new Set(samples).size === 1;
  const count = same ? samples[0] : samples.join(", ");
  byId("footer").textContent = `Every pose and every number on this page is a sample of a run of the solver (samples a run: ${count}), none is `
    + "interpolated. SI units, angles in radians where no other unit is given. The page is self-contained: it loads nothing.";
}

// ---------------------------------------------------------------- start

createText();
if (runs.length) {
  state.t = start;
  createAssembly();
  views.push(createStage(), createTransport(), createShow(), createValues());
  for (const kind of ["loads", "multipliers"]) createForces(byId(kind), kind);
  if (end > start) {
    createSeries(byId("coordinates"), "coordinates", ["q", "q̇", "q̈"], ["q", "qd", "qdd"]);
    createSeries(byId("outputs"), "outputs", ["value", "rate", "acceleration"], ["value", "rate", "acceleration"]);
    createEnergy(byId("energy"));
    for (const kind of ["loads", "multipliers"]) createSeries(byId(kind), kind, ["value"], ["value"]);
    createSolver(byId("solver"));
  }
  // Of a position at rest there is nothing to plot.
  for (const id of ["coordinates", "outputs", "energy", "loads", "multipliers", "solver"]) byId(id).parentNode.hidden = !byId(id).childElementCount;
  document.querySelector("main > .hint").hidden = !(end > start);
  layout();
  let width = document.body.clientWidth;
  const resized = () => { // heights change with the content, only the width asks for a new layout
    if (document.body.clientWidth !== width) { width = document.body.clientWidth; layout(); }
  };
  // Not in the observer's own call: a layout there may bring a scroll bar, which is a further change of size.
  new ResizeObserver(() => requestAnimationFrame(resized)).observe(document.body);
}
})();
