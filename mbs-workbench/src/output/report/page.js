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
  fold([...body.rows], "coordinates", button => byId("values").after(button));
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
    const norm = (run, k) => { const v = components(run, with_[0].of, key); return v ? Math.hypot(...v.map(c => c[k])) : null; };
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
  fold([...byId("facts").tBodies[0].rows], "facts", button => byId("facts").after(button));
  byId("view").textContent = space ? `Seen ${space.label}: the path and the arrows are projections, lengths along the line of sight do not show; numbers and `
    + "plots are of the vectors in space." : "";
  byId("view").hidden = !space;
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
  views.push(createStage(byId("stage"), large), createTransport(), createShow(), createValues());
  createSmall(byId("small"));
  for (const kind of ["loads", "multipliers"]) createForces(byId(kind), kind);
  if (end > start) {
    createSeries(byId("coordinates"), "coordinates", ["q", "q̇", "q̈"], ["q", "qd", "qdd"]);
    createSeries(byId("outputs"), "outputs", ["value", "rate", "acceleration"], ["value", "rate", "acceleration"]);
    createEnergy(byId("energy"));
    createSupplies(byId("energy"));
    for (const kind of ["loads", "multipliers"]) createSeries(byId(kind), kind, ["value"], ["value"]);
    createSolver(byId("solver"));
  }
  // Of a position at rest there is nothing to plot.
  byId("small").parentNode.hidden = !runs.some(run => run.small);
  for (const id of ["coordinates", "outputs", "energy", "loads", "multipliers", "solver"]) byId(id).parentNode.hidden = !byId(id).childElementCount;
  byId("play").parentNode.hidden = !(end > start);
  document.querySelector("main > .hint").hidden = !(end > start);
  layout();
  let width = document.body.clientWidth;
  const resized = () => { // heights change with the content, only the width asks for a new layout
    if (document.body.clientWidth !== width) { width = document.body.clientWidth; layout(); }
  };
  // Not in the observer's own call: a layout there may bring a scroll bar, which is a further change of size.
  new ResizeObserver(() => requestAnimationFrame(resized)).observe(document.body);
}
