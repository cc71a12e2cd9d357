// ---------------------------------------------------------------- shapes of the drawing

/** Builders of the shapes of a stage: each adds nodes to the layers of a figure and returns what moves them to sample k. */
function createBuilders({ view, items, options, measure, distanceAtStart, profile, moduleOf, colourOf, onRail }) {
  /** Hatching below the line from x0 to x1 at height y. */
  function hatching(x0, x1, y) {
    const n = Math.max(3, Math.round((x1 - x0) / 7)), step = (x1 - x0) / n, deep = Math.min(7, Math.max(step, 2));
    let d = `M${x0} ${y}H${x1}`;
    for (let i = 0; i < n; i++) d += `M${x0 + (i + 1) * step} ${y}l${-.85 * deep} ${deep}`;
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
      const parts = [["bar-edge", view.bar], ["bar", view.bar - 3 * view.thin]].map(([name, width]) =>
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
      return body(item, f, "polyline", inside + view.bar, [svg("polyline", { class: "bar-edge", "stroke-width": inside }), svg("polyline", { class: "gap", "stroke-width": inside - 2.5 * view.thin })]);
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
      const path = svg("g", {}, svg("polyline", { class: "trace", style, points: all }), travelled);
      f.traces.append(path);
      if (f.run.ended && xs.length) path.append(endMark(f.at(item.of, xs.length - 1)));
      const dot = svg("circle", { r: view.bar * .36, style: `fill: var(--trace${traces.indexOf(item) % 2}); stroke: var(--halo)` });
      f.pins.append(dot);
      const arrows = ["rate", "acceleration"].map(key => arrow(item, f, key));
      return k => {
        const show = options.shows("trace");
        path.toggleAttribute("hidden", !show);
        if (show) travelled.setAttribute("points", all.slice(0, ends[k]));
        dot.setAttribute("transform", `translate(${f.at(item.of, k)})`);
        for (const update of arrows) update(k);
      };
    },
  };

  function body(item, f, tag, width = view.bar, inner = []) {
    const colour = colourOf(item), solid = tag === "polygon";
    const edge = svg(tag, { class: "bar-edge", "stroke-width": width });
    const bar = svg(tag, { class: "bar", "stroke-width": width - 3 * view.thin, style: `stroke: ${colour}` });
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
      const beyond = (x, y) => Math.max(0, x + width / 2 - view.width + 4, width / 2 + 4 - x, 10 - y, y - view.height + 10);
      const room = ([x, y, penalty = 0]) => -penalty - 2 * beyond(x, y) + Math.min(view.bar / 2 + 8, ...f.obstacles.flatMap(([a, b]) => [-.5, -.25, 0, .25, .5].map(s => distance([x + s * (width - 6), y], a, b))));
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
    const values = vector(f.run, item.of, key), name = key === "rate" ? "velocity" : key, unit = values ? measure(key, f.run) : 0;
    const node = svg("path", { class: "arrow", style: `stroke: var(--${name})` }), halo = svg("path", { class: "halo" });
    const letter = svg("text", { class: "letter", "text-anchor": "middle", style: `fill: var(--${name})` }, name[0]);
    f.arrows.append(halo, node, letter);
    return k => {
      const [u, v] = values && options.shows(name) && unit > 0 ? bounded(values.map(c => c[k] / unit * view.arrow)) : [0, 0];
      const at = f.at(item.of, k), d = arrowPath(at, [u, v]);
      node.setAttribute("d", d);
      halo.setAttribute("d", d);
      letter.toggleAttribute("hidden", !d || f.ghost || !options.shows("labels"));
      if (!d) return;
      const length = Math.hypot(u, v);
      letter.setAttribute("x", (at[0] + u * (1 + 11 / length)).toFixed(1));
      letter.setAttribute("y", (at[1] - v * (1 + 11 / length) + 4).toFixed(1));
      f.obstacles.push([at, [at[0] + u, at[1] - v]]);
    };
  }

  /** No longer than the picture can take. */
  const bounded = ([u, v]) => { const over = Math.max(Math.hypot(u, v) / (1.4 * view.arrow), 1); return [u / over, v / over]; };

  /** An arrow from a point, its end and its head as a path in pixels; empty where it is too short to be seen. */
  function arrowPath([x, y], [u, v]) {
    const length = Math.hypot(u, v), [tx, ty] = [x + u, y - v], head = Math.min(9, length * .6) / (length || 1);
    const wing = side => `${(tx - head * (u + side * v * .5)).toFixed(1)} ${(ty + head * (v - side * u * .5)).toFixed(1)}`;
    return length > 1.5 ? `M${x} ${y}L${tx.toFixed(1)} ${ty.toFixed(1)}M${wing(1)}L${tx.toFixed(1)} ${ty.toFixed(1)}L${wing(-1)}` : "";
  }

  /** The force of an output at its place, with its magnitude where nothing moves. */
  function force(item, f) {
    const components = loadOf(f.run, item.of), node = svg("path", { class: "arrow force" }), halo = svg("path", { class: "halo" }), text = svg("text", { class: "label value", "text-anchor": "middle" });
    if (!components) return () => {};
    const unit = measure("force", f.run), format = formatter(unit, 4);
    f.arrows.append(halo, node);
    f.text.append(text);
    return k => {
      const [u, v] = options.shows("forces") && unit > 0 ? bounded(components.slice(0, 2).map(c => c[k] / unit * view.arrow * 1.25)) : [0, 0];
      const at = f.at(item.at, k), d = arrowPath(at, [u, v]), length = Math.hypot(u, v);
      node.setAttribute("d", d);
      halo.setAttribute("d", d);
      text.textContent = d && !moves && !f.ghost ? `${format(Math.hypot(...components.map(c => c[k])))} N` : "";
      if (!d) return;
      const [tx, ty] = [at[0] + u, at[1] - v];
      f.obstacles.push([at, [tx, ty]]);
      const half = widest([text.textContent]) / 2;
      text.setAttribute("x", clamp(tx + u / length * (half + 8), half + 4, view.width - half - 4).toFixed(1));
      text.setAttribute("y", clamp(ty - v / length * 12 + 4, 14, view.height - 8).toFixed(1));
      if (text.textContent) f.obstacles.push([[tx + u / length * (half + 8) - half, ty - v / length * 12], [tx + u / length * (half + 8) + half, ty - v / length * 12]]);
    };
  }

  const endMark = ([x, y]) => svg("path", { class: "end", d: `M${x - 6} ${y - 6}l12 12m0 -12l-12 12` });

  return { builders, label, aroundPoint, force };
}
