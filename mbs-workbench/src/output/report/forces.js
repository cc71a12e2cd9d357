// ---------------------------------------------------------------- energies, powers, forces

/** Energies with what forces and drives have supplied, and what of their balance is not accounted for. */
function createEnergy(host) {
  const names = ["kinetic", "potential", "work", "defect"].filter(name => runs.some(run => (forcesOf(run)[name] || []).length));
  const panels = [["energy", name => name !== "defect"], ["balance defect", name => name === "defect"]]
    .filter(([, shows]) => names.some(shows))
    .map(([title, shows]) => ({ title, unit: "J", get: (run, series) => shows(series.name) ? forcesOf(run)[series.name] : null }));
  if (panels.length) createGroup(host, "", names, panels);
  host.parentNode.hidden = !host.childElementCount;
}

const titleOf = supply => supply.by === "time" ? supply.name : `${supply.by} ${supply.name}`;

/** Powers of forces and drives with the work that they come to, as curves and as a table that adds up to the change of energy. */
function createSupplies(host) {
  const supplies = run => forcesOf(run).supplies || [];
  const names = supplies(runs[0]).map(titleOf);
  if (!names.length) return;
  const find = (run, name) => supplies(run).find(supply => titleOf(supply) === name) || {};
  const panels = [["power", "W"], ["work", "J"]].map(([key, unit]) => ({ title: key, unit, zero: true, get: (run, series) => find(run, series.name)[key] }));
  createGroup(host, "Power and work", names, panels);
  const body = el("tbody"), head = ["", "power now", "least", "largest", "work to now"];
  const top = el("thead", {}, el("tr", {}, ...head.map(text => el("th", { scope: "col", textContent: text }))));
  host.append(el("div", { className: "scroll" }, el("table", { className: "forces" }, top, body)));
  const [watts, joules] = ["power", "work"].map(key => formatter(largest(runs.flatMap(run => supplies(run).map(supply => supply[key]))), 6));
  const updates = [];
  const line = (name, values) => {
    const cells = [0, 1, 2, 3].map(() => el("td"));
    const row = el("tr", {}, el("th", { scope: "row", textContent: name }), ...cells);
    body.append(row);
    updates.push((run, k) => values(run, k).forEach((text, i) => { cells[i].textContent = text; }));
    return row;
  };
  const rows = names.map(name => line(name, (run, k) => {
    const { power, work } = find(run, name);
    return [...[power[k], ...extent([power])].map(x => `${watts(x)} W`), `${joules(work[k])} J`];
  }));
  fold(rows, "powers", button => host.append(button));
  const energy = (run, k) => { const { kinetic, potential } = forcesOf(run); return kinetic[k] + potential[k]; };
  const sum = (run, k) => supplies(run).reduce((sum, supply) => sum + supply.work[k], 0);
  line("all together", (run, k) => ["", "", "", `${joules(sum(run, k))} J`]);
  line("change of kinetic and potential energy", (run, k) => ["", "", "", `${joules(energy(run, k) - energy(run, 0))} J`]);
  views.push({ layout() {}, frame() { const run = runs[state.primary], k = sample(run); for (const update of updates) update(run, k); } });
}

/** A table of forces over the run on show: now, least and largest. */
function createForces(host, kind) {
  const entries = entriesOf(runs[0], kind);
  if (!entries.length) return;
  const body = el("tbody"), updates = [];
  const head = el("tr", {}, ...["", "now", "least", "largest"].map(text => el("th", { scope: "col", textContent: text })));
  host.append(el("div", { className: "scroll" }, el("table", { className: "forces" }, el("thead", {}, head), body)));
  for (const { name, unit } of entries) {
    const get = run => (entriesOf(run, kind).find(entry => entry.name === name) || {}).value || [];
    const format = formatter(largest(runs.map(get)), 6), cells = [0, 1, 2].map(() => el("td"));
    body.append(el("tr", {}, el("th", { scope: "row" }, name, el("small", { textContent: ` ${unit}${markOf(kind, name)}` })), ...cells));
    updates.push(k => {
      const values = get(runs[state.primary]), texts = [values[k], ...extent([values])].map(format);
      cells.forEach((cell, i) => { cell.textContent = texts[i]; });
    });
  }
  fold([...body.rows], kind === "multipliers" ? "rows" : kind, button => host.append(button));
  views.push({ layout() {}, frame() { const k = sample(runs[state.primary]); for (const update of updates) update(k); } });
}
