// ---------------------------------------------------------------- groups of plots

/** Panels side by side with one legend. */
function createGroup(host, title, names, panels, mark = () => "") {
  const group = { series: names.map((name, index) => ({ name, index, colour: colour(index), hidden: false })) };
  const row = el("div", { className: "panels" });
  const legend = createLegend(title, group, mark, () => { for (const plot of made) { plot.layout(); plot.frame(); } });
  host.append(el("div", { className: "group" }, legend, row));
  const made = panels.map(panel => createPlot(row, panel, group));
  views.push(...made);
  return made;
}

/** Names with their line styles; a click hides a curve. */
function createLegend(title, group, mark, changed) {
  const legend = el("div", { className: "legend" }, ...(title ? [el("h3", { textContent: title })] : [])), dashes = el("span", { className: "dashes" });
  const count = group.series.length;
  for (const series of group.series.filter(series => series.name)) {
    const style = swatch(series.colour, series.dash || dash(0, series.index, count), series.wide ? 3.4 : 2.6);
    const button = el("button", { type: "button", title: "Show or hide" }, style, series.name + mark(series.name));
    button.setAttribute("aria-pressed", "true");
    button.addEventListener("click", () => {
      series.hidden = !series.hidden;
      button.setAttribute("aria-pressed", String(!series.hidden));
      changed();
    });
    legend.append(button);
  }
  // Of many curves the first ones can be told apart.
  let made = false;
  fold([...legend.querySelectorAll("button")], "curves", button => legend.append(button), open => {
    group.series.slice(FIRST).forEach(series => { series.hidden = !open; });
    if (made) changed();
  });
  made = true;
  legend.append(dashes);
  views.push({
    layout() { dashes.replaceChildren(...(state.overlay && dashesOf(count) * runs.length <= DASHES.length ? shown().map((run, i) => el("span", {}, swatch("currentColor", dash(i, 0, count)), run.label)) : [])); },
    frame() {},
  });
  return legend;
}

/** What a name needs beside it: a value that is one choice of many is no fact. */
const markOf = (kind, name) => runs.some(run => entriesOf(run, kind).some(entry => entry.name === name && entry.shared)) ? " (not unique)" : "";
const find = (run, kind, name) => entriesOf(run, kind).find(entry => entry.name === name);

/** The coordinate that an output is in every run, or none. */
function coordinateOf(output) {
  const equal = (a, b) => { const most = NOISE * 1e3 * largest([a]); return a.every((x, k) => Math.abs(x - b[k]) <= most); };
  return (runs[0].coordinates || []).find(c => c.unit === output.unit && runs.every(run => {
    const [value, q] = [(find(run, "outputs", output.name) || {}).value, (run.coordinates.find(other => other.name === c.name) || {}).q];
    return value && q && value.length === q.length && equal(value, q);
  }));
}

/** A group of plots a unit: values with rates and accelerations where the data have them. */
function createSeries(host, kind, symbols, keys) {
  const units = new Map(), same = [];
  for (const entry of entriesOf(runs[0], kind)) {
    const { name, unit } = entry, twin = kind === "outputs" && plotted(name) && !measuredOf(name).length ? coordinateOf(entry) : null;
    if (twin) same.push(`${name} is ${twin.name}`);
    else units.set(unit, [...(units.get(unit) || []), name]);
  }
  if (same.length) host.append(el("p", { className: "same", textContent: `Plotted with the coordinates: ${same.join(", ")}.` }));
  for (const [unit, all] of units) {
    const names = kind === "outputs" ? all.filter(plotted) : all;
    if (!names.length) continue;
    const panels = keys.map((key, order) => ({ title: symbols[order], unit: derived(unit, order), measured: order ? () => [] : measuredOf, get: (run, series) => (find(run, kind, series.name) || {})[key] }))
      .filter(panel => runs.some(run => names.some(name => panel.get(run, { name }))));
    const title = { rad: "Angles", m: "Lengths" }[unit] || (unit && unit !== "1" ? `In ${unitText(unit)}` : "Without unit");
    createGroup(host, title, names, panels, name => markOf(kind, name) + measuredOf(name).map(({ file }) => `, dots: ${file}`).join(""));
  }
}

/** Points that only serve the drawing need no plot. */
function plotted(name) {
  if (measuredOf(name).length) return true;
  const [, point] = /^(.*)\.\d+$/.exec(name) || [];
  return traces.some(trace => trace.of === point) || !drawing.some(item => pointsOf(item).includes(point));
}

/** Contradictions of rows that yield: their largest values, then curves. */
function createMismatches(host) {
  const keys = ["value", "rate", "acceleration"];
  for (const run of runs) {
    for (const row of run.mismatches || []) {
      const most = keys.map((key, order) => `${powered(largest([row[key]]).toExponential(1))} ${unitText(derived(row.unit, order))}`);
      host.append(el("p", { textContent: `${runs.length > 1 ? `${run.label}, ` : ""}${row.name} (line ${row.line}): at most ${most.join(", ")}; ${powered(row.width.toExponential(1))} ${unitText(row.unit)} is allowed.` }));
    }
  }
  createSeries(host, "mismatches", ["position", "rate", "acceleration"], keys);
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
}
