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
        svg("text", { x: Math.min(X(t), width - 1 - widest([text]) / 2), y: bottom + 15, "text-anchor": "middle" }, text));
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
      area.left = Math.max(54, 12 + widest(axis.ticks.map(([, text, power]) => text + (power || ""))));
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
  fold([...legend.querySelectorAll("button")], "curves", button => legend.append(button));
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
