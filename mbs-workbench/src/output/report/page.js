// ---------------------------------------------------------------- values at the current time

const SYMBOLS = ["q", "q̇", "q̈"];

/** A table of the coordinates: every column has one number of decimals a unit; a rest has no rates. */
function createValues() {
  const table = byId("values"), body = table.tBodies[0], cells = [];
  const keys = moves ? ["q", "qd", "qdd"] : ["q"];
  table.tHead.rows[0].append(...keys.map((_, i) => el("th", { scope: "col", textContent: moves ? SYMBOLS[i] : "at rest" })));
  const get = (run, name, key) => ((run.coordinates || []).find(c => c.name === name) || {})[key] || [];
  for (const { name, unit } of runs[0].coordinates || []) {
    const row = el("tr", {}, el("th", { scope: "row", textContent: name, title: name }));
    keys.forEach((key, order) => {
      const number = el("span"), small = el("small"), cell = el("td", {}, number, small);
      cells.push({ name, unit, key, order, number, small, cell });
      row.append(cell);
    });
    body.append(row);
  }
  fold([...body.rows], "coordinates", button => table.after(button));
  const time = el("span");
  byId("time").append(el("i", { textContent: "t" }), " = ", time, " s");
  byId("time").hidden = !moves;
  return {
    layout() {
      const run = runs[state.primary], formats = new Map();
      byId("run").textContent = [run.label, run.description].filter(Boolean).join(": ");
      byId("ended").textContent = run.ended || "";
      byId("ended").hidden = !run.ended;
      for (const one of cells) {
        const group = `${one.unit} ${one.key}`, alike = cells.filter(other => `${other.unit} ${other.key}` === group);
        if (!formats.has(group)) formats.set(group, formatter(scaleOf(one.unit) * Math.max(one.key === "q" && isAngle(one.unit) ? 1 : 0, largest(runs.flatMap(run => alike.map(other => get(run, other.name, one.key))))), 5));
        one.format = formats.get(group);
        one.small.textContent = ` ${shownUnit(derived(one.unit, one.order))}`.replace(/^ 1$/, "");
      }
    },
    frame() {
      const run = runs[state.primary], k = sample(run);
      byId("time").dataset.value = run.time[k];
      time.textContent = formatTime(run.time[k]);
      for (const { name, unit, key, number, cell, format } of cells) {
        const x = get(run, name, key)[k];
        number.textContent = format(finite(x) ? x * scaleOf(unit) : x);
        cell.dataset.value = x;
        cell.title = String(x);
      }
    },
  };
}

/** The verdict on every rest in words, before all else; a click shows the rest. */
function createVerdicts() {
  const host = byId("verdicts");
  let lines = [];
  const make = judged => judged.map(run => {
    const { course, text } = run.verdict, dot = svg("svg", { width: 14, height: 14, "aria-hidden": "true" }, svg("circle", { cx: 7, cy: 7, r: 6, style: `fill: ${COURSES[course] || "var(--s6)"}` }));
    const line = el("button", { type: "button", className: "verdict" }, dot, el("span", {}, ...(judged.length > 1 ? [el("b", { textContent: `${run.label}: ` })] : []), unitsIn(text).replace(/(^|[ =])-(?=\d)/g, "$1−")));
    line.dataset.course = course;
    line.addEventListener("click", () => select(runs.indexOf(run)));
    return [run, line];
  });
  return {
    layout() {
      if (!lines.length || lines[0][0] !== runs.find(run => run.verdict)) {
        lines = make(runs.filter(run => run.verdict));
        host.replaceChildren(...lines.map(([, line]) => line));
        host.hidden = !lines.length;
      }
      for (const [run, line] of lines) line.setAttribute("aria-pressed", String(runs[state.primary] === run));
    },
    frame() {},
  };
}

// ---------------------------------------------------------------- text

/** The source without blank lines at its ends and without the indentation that all its lines share. */
function trimmed(text) {
  const lines = text.replace(/^\s*\n|\s+$/g, "").split("\n");
  const indents = lines.filter(line => line.trim()).map(line => /^\s*/.exec(line)[0].length);
  const indent = indents.reduce((a, b) => Math.min(a, b), Infinity);
  return lines.map(line => line.slice(indent)).join("\n");
}

const MOST_COLUMNS = 4; // runs whose facts stand side by side

/** Facts, those of several runs in one line with a column a run. */
function createFacts() {
  const table = byId("facts"), side = labels.length > 1 && labels.length <= MOST_COLUMNS, lines = new Map();
  for (const [name, value] of data.facts || []) {
    const label = side && labels.find(label => name.endsWith(`, ${label}`) && !labels.some(longer => longer !== label && longer.endsWith(`, ${label}`) && name.endsWith(`, ${longer}`)));
    const key = label ? name.slice(0, -label.length - 2) : name;
    lines.set(key, { ...lines.get(key), [label || ""]: unitsIn(value) });
  }
  if (side && [...lines.values()].some(values => !("" in values))) {
    table.prepend(el("thead", {}, el("tr", {}, el("th"), ...labels.map(textContent => el("th", { scope: "col", textContent })))));
  }
  for (const [name, values] of lines) {
    const cells = "" in values ? [el("td", { colSpan: side ? labels.length : 1, textContent: values[""] })] : labels.map(label => el("td", { textContent: values[label] || "" }));
    table.tBodies[0].append(el("tr", {}, el("th", { scope: "row", textContent: name }), ...cells));
  }
  fold([...table.tBodies[0].rows], "facts", button => table.after(button));
}

/** Links to the sections that the page has. */
function createContents() {
  const links = [...document.querySelectorAll("main h2")].filter(h => h.offsetParent).map((h, i) => {
    h.id = h.id || `section-${i}`;
    return el("a", { href: `#${h.id}`, textContent: h.textContent });
  });
  byId("contents").replaceChildren(...links);
}

function createText() {
  byId("kicker").textContent = `mbs · ${data.name}`;
  byId("title").textContent = data.title;
  // Words between backticks are code.
  byId("description").replaceChildren(...(data.description || "").split("`").map((part, i) => i % 2 ? el("code", { textContent: part }) : part));
  byId("command").textContent = data.command || "";
  byId("command").parentNode.hidden = !data.command;
  createFacts();
  byId("view").textContent = space ? `Seen ${space.label}, until you turn it: the path and the arrows are projections; numbers and plots are of the vectors in space.` : "";
  byId("view").hidden = !space;
  byId("source").firstChild.textContent = trimmed(data.source || "");
  const samples = runs.map(run => run.time.length), same = new Set(samples).size === 1;
  const count = same ? samples[0] : samples.join(", ");
  byId("footer").textContent = `Every pose and every number on this page is a sample of a run of the solver (samples a run: ${count}), none is `
    + "interpolated. SI units, angles as chosen above. What is below 1e-12 of the largest value of its kind is shown as 0. The page is self-contained: it loads nothing.";
}

// ---------------------------------------------------------------- start

createText();
if (runs.length) {
  const isOfModes = runs.some(run => run.small), stage = createStage(byId("stage"), large);
  document.body.classList.toggle("rest", !moves);
  document.body.classList.toggle("linear", isOfModes);
  if (isOfModes && !moves) {
    document.querySelector("main").prepend(byId("small").parentNode);
    document.querySelector(".viewer").before(el("h2", { textContent: "Position of rest" }));
  }
  createTools();
  createAssembly();
  createKeys();
  createSave();
  views.push(createVerdicts(), createSlider(), stage, createTransport(), createShow(), createValues());
  createCamera(byId("stage"), stage);
  createSmall(byId("small"));
  createForces(byId("loads"), "loads");
  if (moves) {
    createForcePlots(byId("loads"));
    createSeries(byId("coordinates"), "coordinates", SYMBOLS, ["q", "qd", "qdd"]);
    createSeries(byId("outputs"), "outputs", ["value", "rate", "acceleration"], ["value", "rate", "acceleration"]);
    createMismatches(byId("mismatches"));
    createEnergy(byId("energy"));
    createSupplies(byId("energy"));
    createSolver(byId("solver"));
  }
  createMultipliers(byId("multipliers"));
  // Forces are what an inverse analysis is asked for.
  if (data.analysis === "inverse") byId("plots").after(byId("loads").parentNode, byId("fold-multipliers").parentNode);
  byId("small").parentNode.hidden = !isOfModes;
  for (const id of ["coordinates", "outputs", "mismatches", "energy", "loads", "multipliers", "solver"]) byId(id).closest("section").hidden = !byId(id).childElementCount;
  if (!moves && byId("loads").querySelectorAll("tbody tr").length <= FIRST) { // beside the drawing of a rest there is room
    byId("loads").closest("section").hidden = true;
    document.querySelector("aside").append(byId("loads"));
  }
  byId("play").parentNode.hidden = !moves;
  byId("plots").hidden = !moves;
  byId("plots").dataset.drag = state.drag;
  layout();
  createContents();
  let width = document.body.clientWidth;
  const resized = () => { // heights change with the content, only the width asks for a new layout
    if (document.body.clientWidth !== width) { width = document.body.clientWidth; layout(); }
  };
  // Not in the observer's own call: a layout there may bring a scroll bar, which is a further change of size.
  new ResizeObserver(() => requestAnimationFrame(resized)).observe(document.body);
}
