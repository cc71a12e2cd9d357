// ---------------------------------------------------------------- energies, powers, forces

/** Energies with what forces and drives have supplied, and what of their balance is not accounted for. */
function createEnergy(host) {
  const names = ["kinetic", "potential", "work", "defect"].filter(name => runs.some(run => (forcesOf(run)[name] || []).length));
  const panels = [["energy", name => name !== "defect"], ["balance defect", name => name === "defect"]]
    .filter(([, shows]) => names.some(shows))
    .map(([title, shows]) => ({ title, unit: "J", get: (run, series) => shows(series.name) ? forcesOf(run)[series.name] : null }));
  if (panels.length) createGroup(host, "", names, panels);
}

const titleOf = supply => supply.by === "time" ? supply.name : `${supply.by} ${supply.name}`;

/** A table whose cells change with the time; `head` names its columns. Returns it with a function that adds a line. */
function createTable(head) {
  const body = el("tbody"), updates = [];
  const top = el("thead", {}, el("tr", {}, ...head.map(text => el("th", { scope: "col", textContent: text }))));
  const node = el("div", { className: "scroll" }, el("table", { className: "forces" }, top, body));
  const line = (name, note, values) => {
    const cells = head.slice(1).map(() => el("td"));
    const row = el("tr", {}, el("th", { scope: "row" }, name, ...(note ? [el("small", { textContent: ` ${note}` })] : [])), ...cells);
    body.append(row);
    updates.push((run, k) => values(run, k).forEach((text, i) => { cells[i].textContent = text; }));
    return row;
  };
  views.push({ layout() {}, frame() { const run = runs[state.primary], k = sample(run); for (const update of updates) update(run, k); } });
  return [node, line];
}

/** Powers of forces and drives with the work that they come to, as curves and as a table that adds up to the change of energy. */
function createSupplies(host) {
  const supplies = run => forcesOf(run).supplies || [];
  const names = supplies(runs[0]).map(titleOf);
  if (!names.length) return;
  const of = (run, name) => supplies(run).find(supply => titleOf(supply) === name) || {};
  const panels = [["power", "W"], ["work", "J"]].map(([key, unit]) => ({ title: key, unit, zero: true, get: (run, series) => of(run, series.name)[key] }));
  createGroup(host, "Power and work", names, panels);
  const [table, line] = createTable(["", "power now [W]", "least [W]", "largest [W]", "work to now [J]"]);
  host.append(table);
  const most = key => largest(runs.flatMap(run => supplies(run).map(supply => supply[key])));
  const energy = (run, k) => { const { kinetic, potential } = forcesOf(run); return kinetic[k] + potential[k]; };
  const [watts, joules] = [formatter(most("power"), 5), formatter(Math.max(most("work"), largest(runs.map(run => forcesOf(run).kinetic))), 5)];
  const rows = names.map(name => line(name, "", (run, k) => {
    const { power, work } = of(run, name);
    return [...[power[k], ...extent([power])].map(watts), joules(work[k])];
  }));
  fold(rows, "powers", button => host.append(button));
  const sum = (run, k) => supplies(run).reduce((sum, supply) => sum + supply.work[k], 0);
  line("all together", "", (run, k) => ["", "", "", joules(sum(run, k))]);
  line("change of kinetic and potential energy", "", (run, k) => ["", "", "", joules(energy(run, k) - energy(run, 0))]);
}

const AXES = ["x", "y", "z"];

/** Entries of a kind as vectors of two or three components and scalars: { name, unit, parts }, in the order of the data. */
function gathered(kind) {
  const entries = entriesOf(runs[0], kind), taken = new Set(), found = [];
  const named = name => entries.find(entry => entry.name === name);
  for (const { name, unit } of entries) {
    if (taken.has(name)) continue;
    const [, base] = /^(.*)\.0$/.exec(name) || [];
    const parts = base ? [0, 1, 2, 3].map(i => named(`${base}.${i}`)).filter(entry => entry && entry.unit === unit).map(entry => entry.name) : [];
    // Of two components only the force in a pin is known to be a vector: they may be two tensions.
    const isVector = kind === "loads" && (parts.length === 3 || (parts.length === 2 && (data.forces || []).some(({ of }) => of === base)));
    (isVector ? parts : [name]).forEach(part => taken.add(part));
    found.push(isVector ? { name: base, unit, parts } : { name, unit, parts: [name] });
  }
  return found;
}

const valuesOf = (run, kind, name) => (find(run, kind, name) || {}).value || [];
/** Magnitude of a vector over time, of a scalar its value. */
function magnitude(run, kind, { parts }) {
  const columns = parts.map(part => valuesOf(run, kind, part));
  return parts.length === 1 ? columns[0] : (columns[0] || []).map((_, k) => Math.hypot(...columns.map(column => column[k])));
}

/** A table of forces: now with components, and the range over the run on show; of a rest the direction in its place. */
function createForces(host, kind) {
  const all = gathered(kind);
  if (!all.length) return;
  const vectors = all.some(({ parts }) => parts.length > 1), most = Math.max(...all.map(({ parts }) => parts.length));
  const components = vectors ? AXES.slice(0, most) : [];
  const units = new Map(all.map(({ unit }) => [unit, largest(runs.flatMap(run => all.filter(one => one.unit === unit).map(one => magnitude(run, kind, one))))]));
  const one = units.size === 1 ? ` [${unitText(all[0].unit)}]` : "", now = (vectors ? "|F|" : moves ? "now" : "value") + one;
  const [table, line] = createTable(["", now, ...(moves ? ["largest", "least"] : []), ...components, ...(!moves && vectors && most === 2 ? ["angle"] : [])]);
  host.append(table);
  const rows = all.map(one => {
    const format = formatter(units.get(one.unit), 5), isVector = one.parts.length > 1;
    return line(one.name, (units.size === 1 ? "" : unitText(one.unit)) + markOf(kind, one.parts[0]), (run, k) => {
      const size = magnitude(run, kind, one), parts = isVector ? one.parts.map(part => valuesOf(run, kind, part)[k]) : [];
      const cells = [format(size[k]), ...(moves ? extent([size]).reverse().map(format) : []), ...components.map((_, i) => i < parts.length ? format(parts[i]) : "")];
      if (!moves && vectors && most === 2) cells.push(isVector && size[k] > 0 ? `${formatter(180, 4)(Math.atan2(parts[1], parts[0]) * 180 / Math.PI)}°` : "");
      return cells;
    });
  });
  fold(rows, kind === "multipliers" ? "rows" : "forces", button => host.append(button));
}

/** One small plot a force: its magnitude and its components. Scalars such as torques have one each. */
function createForcePlots(host) {
  const all = gathered("loads");
  if (!all.length) return;
  const row = el("div", { className: "panels small-panels" });
  const most = Math.max(...all.map(({ parts }) => parts.length));
  const names = most > 1 ? ["|F|", ...AXES.slice(0, most)] : [];
  const group = { series: names.map((name, index) => ({ name, index: 0, dash: ["none", "7 3", "2 3", "10 3 2 3"][index],
    colour: index ? colour(index - 1) : "var(--ink)", wide: index === 0, hidden: false })) };
  const made = [], redraw = () => { for (const plot of made) { plot.layout(); plot.frame(); } };
  const single = { series: [{ name: "", index: 0, colour: "var(--ink)", wide: true, hidden: false }] };
  host.append(el("div", { className: "group" }, ...(names.length ? [createLegend("", group, () => "", redraw)] : []), row));
  for (const one of all) {
    const isVector = one.parts.length > 1;
    const get = (run, series) => {
      const i = names.indexOf(series.name);
      return i <= 0 ? magnitude(run, "loads", one) : one.parts[i - 1] && valuesOf(run, "loads", one.parts[i - 1]);
    };
    made.push(createPlot(row, { title: one.name + markOf("loads", one.parts[0]), unit: one.unit, small: true, zero: isVector, get }, isVector ? group : single));
  }
  views.push(...made);
}

/** Multipliers behind forces: folded away, drawn when they are opened. */
function createMultipliers(host) {
  const count = entriesOf(runs[0], "multipliers").length;
  if (!count) return;
  createForces(host, "multipliers");
  if (moves) createSeries(host, "multipliers", ["value"], ["value"]);
  byId("fold-multipliers").firstElementChild.textContent = `Multipliers (${count} ${count === 1 ? "row" : "rows"})`;
  byId("fold-multipliers").addEventListener("toggle", () => layout());
}
