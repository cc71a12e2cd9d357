// ---------------------------------------------------------------- one plot

const swatch = (colour, pattern = "none", width = 2.6) => svg("svg", { width: 26, height: 8, "aria-hidden": "true" },
  svg("path", { d: "M1 4H25", style: `stroke: ${colour}; stroke-width: ${width}; stroke-dasharray: ${pattern}` }));

const LOWEST = 1e-18; // what a logarithmic axis shows for zero
const NEAREST = 8; // curves that a tip lists
const plots = [];

/** Range and ticks of the ordinate, with a map from values to [0, 1]; `own` is a range that was chosen. */
function ordinate(panel, arrays, height, own) {
  let [low, high] = own || extent(arrays);
  if (panel.log) {
    low = Math.floor(Math.log10(Math.max(low, LOWEST)) + 1e-9);
    high = Math.ceil(Math.log10(Math.max(high, LOWEST)) - 1e-9);
    if (high - low < 2) [low, high] = [Math.max(low - 1, -18), high + 1];
    const stride = Math.ceil((high - low) / 6), ticks = [];
    for (let e = low; e <= high; e += stride) ticks.push([10 ** e, e === -18 ? "≤ 10" : "10", minus(String(e))]);
    return { ticks, factor: "", map: y => (Math.log10(Math.max(y, LOWEST)) - low) / (high - low), invert: s => 10 ** (low + s * (high - low)) };
  }
  if (!own) {
    if (panel.zero) [low, high] = [Math.min(low, 0), Math.max(high, 0)];
    const size = Math.max(Math.abs(low), Math.abs(high));
    if (high - low <= size * 1e-4) { // noise on a constant is no shape
      high += size * .05 || (panel.zero ? 1 : .5);
      if (!(panel.zero && low === 0)) low -= size * .05 || .5;
    }
    const pad = (high - low) * .06;
    if (!(panel.zero && low === 0)) low -= pad;
    high += pad;
  }
  const step = Math.max((high - low) / clamp(Math.floor(height / 34), 3, 6), panel.whole ? 1 : 0);
  return { ...linearTicks(low, high, step), map: y => (y - low) / (high - low), invert: s => low + s * (high - low) };
}

/** Range of the abscissa of all runs on show. */
const abscissaRange = () => extent(shownAtAllStops().map(abscissae));

/** Steps of whole parts of a turn, where an axis is in degrees. */
function degreeTicks(low, high, count) {
  const step = [1, 2, 5, 10, 15, 30, 45, 60, 90, 180, 360].find(step => (high - low) / step <= count) || 360 * Math.ceil((high - low) / count / 360), ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) ticks.push([i * step, minus(String(i * step))]);
  return { ticks, factor: "" };
}

/**
 * A plot over time or over an angle. `panel`: { title, unit, get(run, series), log, zero, whole, small }, `group`: { series: [{ name, index, colour, wide,
 * hidden }] }.
 */
function createPlot(host, panel, group) {
  const root = svg("svg", { role: "img", class: "chart" }), cursor = el("div", { className: "cursor" }), tip = el("div", { className: "tip", hidden: true });
  const save = saveButtons(root, () => `${data.name}-${panel.title}`.replace(/[^\w.-]+/g, "_"),
    () => curves.filter(curve => curve.name).map(curve => [state.overlay ? `${curve.name} ${curve.run.label}` : curve.name, curve.colour, curve.dash]));
  const box = el("div", { className: "plot" }, root, cursor, tip, save), clip = `clip${plots.length}`;
  const dots = svg("g", { class: "dots" }), chosen = svg("rect", { class: "chosen", visibility: "hidden" });
  const area = { left: 54, right: 12, top: 31, bottom: 36 };
  let curves = [], points = [], axis, width, height, range = [0, 1], own = null, hovered = false, from = null;
  host.append(box);

  const wide = () => width - area.left - area.right, tall = () => height - area.top - area.bottom;
  const X = x => area.left + (x - range[0]) / (range[1] - range[0] || 1) * wide();
  const Y = y => area.top + (1 - axis.map(y)) * tall();
  const inverse = px => range[0] + (px - area.left) / wide() * (range[1] - range[0]);
  const inside = x => x >= range[0] && x <= range[1];

  function path(curve) {
    let d = "", pen = "M";
    curve.values.forEach((y, k) => {
      if (finite(y)) {
        d += `${pen}${X(curve.over[k]).toFixed(1)} ${clamp(Y(y), -9e3, 9e3).toFixed(1)}${pen === "M" ? "h0" : ""}`; // h0: a dot for a lone sample
        pen = "L";
      } else pen = "M";
    });
    const style = `stroke: ${curve.colour}; stroke-dasharray: ${curve.dash}${curve.wide ? "; stroke-width: 2.8" : ""}`;
    return svg("path", { class: curve.order ? "curve ghost" : "curve", d, style });
  }

  /** Measured points of a series, one path of dots. */
  function measured({ colour, places }) {
    const d = places.map(([x, y]) => `M${X(x).toFixed(1)} ${clamp(Y(y), -9e3, 9e3).toFixed(1)}h0`).join("");
    return svg("path", { class: "measured", d, style: `stroke: ${colour}; stroke-width: 4.5; stroke-linecap: round; fill: none; opacity: .75` });
  }

  function axes() {
    const nodes = [], bottom = height - area.bottom, right = width - area.right;
    for (const [y, text, power] of axis.ticks) {
      const raised = power ? [svg("tspan", { dy: -5, "font-size": 10 }, power)] : [];
      nodes.push(svg("path", { class: y === 0 ? "zero" : "gridline", d: `M${area.left} ${Y(y)}H${right}` }),
        svg("text", { x: area.left - 7, y: Y(y) + 4, "text-anchor": "end" }, text, ...raised));
    }
    const count = clamp(Math.floor(width / 64), 2, 6), span = range[1] - range[0];
    const across = state.over && state.degrees ? degreeTicks(...range, count) : linearTicks(...range, span / count);
    for (const [x, text] of across.ticks) {
      nodes.push(svg("path", { class: "gridline", d: `M${X(x)} ${area.top}V${bottom}` }),
        svg("text", { x: Math.min(X(x), width - 1 - widest([text]) / 2), y: bottom + 15, "text-anchor": "middle" }, text));
    }
    for (const run of shown().filter(run => run.ended)) {
      const x = abscissae(run)[run.time.length - 1];
      if (inside(x)) nodes.push(svg("path", { class: "end", d: `M${X(x)} ${area.top}V${bottom}` }), svg("text", { class: "end", x: X(x) - 4, y: area.top - 4, "text-anchor": "end" }, "end"));
    }
    nodes.push(svg("rect", { class: "frame", x: area.left, y: area.top, width: wide(), height: tall() }),
      svg("text", { class: "axis-title", x: 2, y: 15 }, `${panel.title} [${axis.factor}${shownUnit(panel.unit)}]`),
      svg("text", { class: "axis-title", x: (area.left + right) / 2, y: height - 5, "text-anchor": "middle" }, `${overTitle()} [${across.factor}${overUnit()}]`));
    return nodes;
  }

  /** Dots at the instants of the cursor that all plots share, and the tip of the plot under the pointer. */
  function readout() {
    dots.replaceChildren();
    tip.hidden = !hovered || state.hover === null || !curves.length;
    if (state.hover === null || !inside(state.hover)) { tip.hidden = true; return; }
    dots.append(svg("path", { class: "hover", d: `M${X(state.hover)} ${area.top}V${height - area.bottom}` }));
    const now = curves.map(curve => {
      const k = sampleOver(curve.run, state.hover), y = curve.values[k];
      if (finite(y)) dots.append(svg("circle", { cx: X(curve.over[k]), cy: Y(y), r: 3.2, style: `fill: ${curve.colour}` }));
      return { curve, k, y, away: Math.abs(Y(finite(y) ? y : 0) - (hovered || 0)) };
    });
    if (tip.hidden) return;
    const listed = new Set([...now].sort((a, b) => a.away - b.away).slice(0, NEAREST));
    const rows = now.filter(one => listed.has(one)).map(({ curve, y }) => {
      const label = state.overlay ? `${curve.name} ${curve.run.label}` : curve.name || panel.title;
      return el("div", {}, swatch(curve.colour, curve.dash), el("span", { textContent: label }), el("span", { textContent: `${curve.format(y)} ${shownUnit(panel.unit)}`.replace(/ 1$/, "") }));
    });
    const { curve, k } = now[0], t = `t = ${formatTime(curve.run.time[k])} s`;
    const angle = state.over ? `${state.over} = ${formatter(largest([curve.over]), 5)(curve.over[k])}${shownUnit("rad") === "°" ? "°" : " rad"}, ` : "";
    tip.replaceChildren(el("div", { textContent: angle + t }), ...rows, ...(now.length > NEAREST ? [el("div", { textContent: `the ${NEAREST} nearest of ${now.length}` })] : []));
    const x = X(state.hover), left = x < width / 2;
    tip.style.left = left ? `${x + 12}px` : "auto";
    tip.style.right = left ? "auto" : `${width - x + 12}px`;
  }

  const placeOf = event => { const at = box.getBoundingClientRect(); return [event.clientX - at.left, event.clientY - at.top]; };
  /** Chooses the abscissa for all plots and the ordinate for this one. */
  function zoomTo(xs, ys) {
    const [low, high] = abscissaRange();
    const [x0, x1] = [Math.max(Math.min(...xs), low), Math.min(Math.max(...xs), high)];
    if (!(x1 - x0 > (high - low) * 1e-5)) return;
    state.window = x0 <= low && x1 >= high ? null : [x0, x1];
    if (ys && !panel.log) own = [Math.min(...ys), Math.max(...ys)];
    relayoutPlots();
  }
  function moved(event) {
    const [px, py] = placeOf(event);
    hovered = py;
    state.hover = clamp(inverse(px), ...range);
    if (from && state.drag === "zoom") {
      const [x, y, w, h] = [Math.min(px, from[0]), Math.min(py, from[1]), Math.abs(px - from[0]), Math.abs(py - from[1])];
      for (const [key, value] of Object.entries({ x, y, width: w, height: h, visibility: "visible" })) chosen.setAttribute(key, value);
    } else if (from && state.drag === "pan") {
      const by = inverse(from[0]) - inverse(px), [low, high] = abscissaRange(), [x0, x1] = range;
      const shift = clamp(by, low - x0, high - x1), up = axis.invert(1 - (from[1] - area.top) / tall()) - axis.invert(1 - (py - area.top) / tall());
      if (own && !panel.log) own = own.map(y => y + up);
      if (state.window) state.window = [x0 + shift, x1 + shift];
      from = [px, py];
      relayoutPlots();
    } else if (event.buttons & 1) { play(false); setTime(runs[state.primary].time[sampleOver(runs[state.primary], state.hover)]); }
    for (const plot of plots) plot.readout();
  }
  box.addEventListener("pointermove", moved);
  box.addEventListener("pointerdown", event => {
    if (event.button !== 0 || event.target.closest("button")) return;
    box.setPointerCapture(event.pointerId);
    from = placeOf(event);
    moved(event);
  });
  box.addEventListener("pointerup", event => {
    chosen.setAttribute("visibility", "hidden");
    const to = placeOf(event), begin = from;
    from = null;
    if (!begin || state.drag !== "zoom" || Math.hypot(to[0] - begin[0], to[1] - begin[1]) < 6) return;
    const ys = [begin[1], to[1]].map(y => axis.invert(clamp(1 - (y - area.top) / tall(), 0, 1)));
    zoomTo([begin[0], to[0]].map(x => inverse(clamp(x, area.left, width - area.right))), Math.abs(to[1] - begin[1]) > 12 ? ys : null);
  });
  for (const type of ["pointerleave", "pointercancel"]) box.addEventListener(type, () => {
    [hovered, state.hover, from] = [false, null, null];
    chosen.setAttribute("visibility", "hidden");
    for (const plot of plots) plot.readout();
  });
  box.addEventListener("wheel", event => {
    if (!event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    const at = inverse(placeOf(event)[0]), factor = Math.exp(clamp(event.deltaY, -200, 200) * .01);
    zoomTo(range.map(x => at + (x - at) * factor));
  }, { passive: false });
  box.addEventListener("dblclick", () => resetPlots());

  const plot = {
    readout,
    reset() { own = null; },
    layout() {
      width = Math.max(box.clientWidth, 160);
      height = Math.round(clamp(width * .62, panel.small ? 160 : 190, panel.small ? 200 : 260));
      root.setAttribute("height", height);
      root.setAttribute("viewBox", `0 0 ${width} ${height}`);
      root.setAttribute("aria-label", `${panel.title} over ${overTitle()}, ${group.series.map(s => s.name).join(", ")}`);
      range = state.window || abscissaRange();
      const factor = scaleOf(panel.unit), scaled = values => values && (factor === 1 ? values : values.map(y => finite(y) ? y * factor : y));
      const visible = group.series.filter(series => !series.hidden);
      curves = visible.flatMap(series => shown().map((run, order) => ({ run, order, name: series.name, colour: series.colour, wide: series.wide,
        dash: series.dash || dash(order, series.index, group.series.length), over: abscissae(run), values: scaled(panel.get(run, series)) }))).filter(curve => curve.values);
      const most = largest(curves.map(curve => curve.values));
      for (const curve of curves) curve.format = formatter(panel.log ? 0.5 * LOWEST : most, panel.whole ? 1 : 6);
      const placed = ({ time, value }) => time.map((t, k) => [abscissaAt(shown()[0], t), value[k] * factor]).filter(([x]) => x !== null);
      points = (panel.measured ? visible : []).flatMap(({ name, colour }) => panel.measured(name).map(table => ({ colour, places: placed(table) })));
      const inRange = points.map(({ places }) => places.filter(([x]) => inside(x)).map(([, y]) => y));
      // Of all stops of a slider, so that the axis stays while it slides.
      const all = stops.length === 1 ? curves : visible.flatMap(series => shownAtAllStops().map(run => ({ over: abscissae(run), values: scaled(panel.get(run, series)) }))).filter(curve => curve.values);
      axis = ordinate(panel, [...all.map(curve => curve.values.filter((_, k) => inside(curve.over[k]))), ...inRange], height, own);
      area.left = Math.max(54, 12 + widest(axis.ticks.map(([, text, power]) => text + (power || ""))));
      const clipped = svg("g", { "clip-path": `url(#${clip})` }, ...curves.map(path).reverse(), ...points.map(measured), dots);
      const window = svg("clipPath", { id: clip }, svg("rect", { x: area.left - 1, y: area.top - 1, width: wide() + 2, height: tall() + 2 }));
      root.replaceChildren(window, ...axes(), clipped, chosen);
      cursor.style.top = `${area.top}px`;
      cursor.style.height = `${tall()}px`;
      readout();
    },
    frame() {
      const x = abscissaNow();
      cursor.hidden = !inside(x);
      cursor.style.transform = `translateX(${X(x).toFixed(1)}px)`;
    },
  };
  plots.push(plot);
  return plot;
}

function relayoutPlots() {
  for (const plot of plots) { plot.layout(); plot.frame(); }
}

function resetPlots() {
  state.window = null;
  for (const plot of plots) plot.reset();
  relayoutPlots();
}
