"use strict";
const COLOURS = ["#0072b2", "#e69f00", "#009e73", "#d55e00", "#56b4e9", "#cc79a7", "#8a8f00"];
const byId = (id) => document.getElementById(id);
const svgElement = (name, attributes, parent) => {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (parent) parent.append(element);
  return element;
};
const element = (name, text, parent) => {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (parent) parent.append(made);
  return made;
};
const short = (value) => {
  if (value === undefined || value === null) return "";
  if (value === 0) return "0";
  return Math.abs(value) >= 1e-3 && Math.abs(value) < 1e5 ? String(Number(value.toPrecision(3))) : value.toExponential(1);
};

const all = [];
DATA.curves.forEach((curve, c) => curve.points.forEach((point, p) => all.push({ curve, c, point, p })));
const done = all.filter(({ point }) => point.error !== undefined);
const trusted = done.filter(({ curve, point }) => !curve.lanes && !curve.peer && (point.verdict === "right" || point.verdict === "hollow"));
const shown = new Set();
let asked = DATA.asked;
/* The name of a curve without the feature of its sines. */
const base = (curve) => curve.name.replace(/, feature \w+$/, "");
const isOnFront = (curve) => curve.peer || curve.points.some((point) => point.front) || (curve.lanes && (curve.kernel ?? "own") === "own");
const showFront = () => {
  shown.clear();
  /* Sines of a feature stand beside the same setting with the runtime's own. */
  const names = new Set(DATA.curves.filter(isOnFront).map(base));
  DATA.curves.forEach((curve, c) => { if (names.has(base(curve))) shown.add(c); });
  if (shown.size === 0) DATA.curves.forEach((_, c) => shown.add(c));
};
showFront();

/* The cheapest trusted point that reaches the error, for perturbed parameters too. Where these were not run: with a margin of 2, as the next
   finer one of its curve does. */
const hasRuns = trusted.some(({ point }) => point.perturbed !== undefined);
const bound = (point) => point.error + (point.width ?? 0);
const reaches = ({ curve, point, p }, error) => {
  if (!curve.advised || error < 100 * curve.epsilon) return false;
  if (hasRuns) return bound(point) <= error && point.perturbed <= error;
  const finer = curve.points[p + 1];
  return 2 * bound(point) <= error && (finer?.error === undefined || 2 * bound(finer) <= error);
};
const cheapest = (error) => trusted.filter((entry) => reaches(entry, error)).sort((a, b) => a.point.time - b.point.time)[0];

const MARKS = [
  (x, y, r) => `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`,
  (x, y, r) => `M${x - r} ${y - r}h${2 * r}v${2 * r}h${-2 * r}z`,
  (x, y, r) => `M${x} ${y - 1.3 * r}L${x + 1.2 * r} ${y + r}H${x - 1.2 * r}z`,
  (x, y, r) => `M${x} ${y - 1.4 * r}L${x + 1.4 * r} ${y}L${x} ${y + 1.4 * r}L${x - 1.4 * r} ${y}z`,
  (x, y, r) => `M${x} ${y + 1.3 * r}L${x + 1.2 * r} ${y - r}H${x - 1.2 * r}z`,
  (x, y, r) => `M${x - r} ${y - r}L${x + r} ${y + r}M${x - r} ${y + r}L${x + r} ${y - r}`,
];
/* Lines of single precision, and of the sines of a feature. */
const DASHES = { own: ["", "6 4"], fma: ["9 3 2 3", "6 3 2 3 2 3"], libm: ["2 2.5", "4 2.5 1.5 2.5"] };
const dashes = (curve) => {
  const pattern = curve.peer ? "2 3" : DASHES[curve.kernel ?? "own"][Number(curve.dashed)];
  return pattern === "" ? {} : { "stroke-dasharray": pattern };
};
const mark = (curve, x, y, r) => MARKS[curve.mark % MARKS.length](x, y, r);

/* A chart of the error over a quantity of the points; both axes are logarithmic. `look` has another error than the judged one, with its
   name, and the curves to show with their colours; its chart has no front and nothing to drag. */
const chart = (place, value, words, look) => {
  const errorOf = look ? look.error : (point) => point.error;
  const colourOf = look ? look.colour : (curve) => curve.colour;
  const isShown = (curve, c) => shown.has(c) && (!look || look.shows(curve));
  const [width, height] = innerWidth < 600 ? [360, 330] : [640, 440];
  const [left, right, top, bottom] = [64, 18, 14, 52];
  const svg = svgElement("svg", { viewBox: `0 0 ${width} ${height}`, role: "img" });
  svgElement("title", {}, svg).textContent = `error over ${words}`;
  const usable = done.filter(({ curve, point }) => value(point) > 0 && errorOf(point) !== null && (!look || look.shows(curve)));
  const ends = (numbers) => [Math.floor(Math.min(...numbers) - 0.08), Math.ceil(Math.max(...numbers) + 0.08)];
  const size = (point) => Math.log10(Math.min(Math.max(errorOf(point), 1e-17), 10));
  const [x0, x1] = usable.length ? ends(usable.map((entry) => Math.log10(value(entry.point)))) : [0, 1];
  const [y0, y1] = ends([...usable.map((entry) => size(entry.point)), ...(look && usable.length ? [] : [Math.log10(asked)])]);
  const atX = (number) => left + (Math.log10(number) - x0) / (x1 - x0) * (width - left - right);
  const atLog = (number) => height - bottom - (number - y0) / (y1 - y0) * (height - top - bottom);
  const power = (x, y, exponent, anchor) => {
    const text = svgElement("text", { x, y, "text-anchor": anchor }, svg);
    text.append("10");
    const raised = svgElement("tspan", { dy: -5, "font-size": 9 }, text);
    raised.textContent = exponent;
  };
  for (let k = x0; k <= x1; k += Math.max(1, Math.ceil((x1 - x0) / 8))) {
    svgElement("path", { class: "grid", d: `M${atX(10 ** k)} ${top}V${height - bottom}` }, svg);
    power(atX(10 ** k), height - bottom + 18, k, "middle");
  }
  for (let k = y0; k <= y1; k += Math.max(1, Math.ceil((y1 - y0) / 9))) {
    svgElement("path", { class: "grid", d: `M${left} ${atLog(k)}H${width - right}` }, svg);
    power(left - 8, atLog(k) + 4, k, "end");
  }
  svgElement("text", { x: (left + width - right) / 2, y: height - 10, "text-anchor": "middle" }, svg).textContent = words;
  const label = svgElement("text", { x: 14, y: height / 2, "text-anchor": "middle", transform: `rotate(-90 14 ${height / 2})` }, svg);
  label.textContent = `error of the ${look ? look.words : DATA.judged}`;
  const best = look ? [] : usable.filter((entry) => trusted.includes(entry) && entry.point.error <= 0.1)
    .sort((a, b) => value(a.point) - value(b.point) || a.point.error - b.point.error);
  let lowest = Infinity;
  const front = best.filter(({ point }) => (point.error < 0.7 * lowest ? ((lowest = point.error), true) : false));
  if (front.length) {
    svgElement("path", { class: "frontier", d: "M" + front.map(({ point }) => `${atX(value(point))} ${atLog(size(point))}`).join("L") }, svg);
  }
  DATA.curves.forEach((curve, c) => {
    if (!isShown(curve, c)) return;
    const colour = COLOURS[colourOf(curve) % COLOURS.length];
    const points = curve.points.filter((point) => point.error !== undefined && value(point) > 0 && errorOf(point) !== null);
    const dash = dashes(curve);
    if (points.length > 1) {
      const d = "M" + points.map((point) => `${atX(value(point))} ${atLog(size(point))}`).join("L");
      svgElement("path", { d, fill: "none", stroke: colour, "stroke-width": 1.6, ...dash }, svg);
    }
    for (const point of points) {
      const [x, y] = [atX(value(point)), atLog(size(point))];
      const filled = point.verdict === "right";
      const spot = svgElement("path", {
        d: mark(curve, x, y, 4.2), stroke: point.verdict === "wrong" ? "#d0021b" : colour,
        fill: filled ? colour : "var(--panel)", "stroke-width": point.verdict === "wrong" ? 3 : 1.6,
        ...(point.verdict === "untrusted" ? { "stroke-dasharray": "2 1.5" } : {}), "data-curve": curve.name, class: "spot",
      }, svg);
      if (point.verdict === "hollow" && DATA.width && !look) {
        const ends = [point.error + DATA.width, Math.max(point.error - DATA.width, 1e-17)].map((end) => atLog(Math.log10(end)));
        svgElement("path", { d: `M${x} ${ends[0]}V${ends[1]}`, stroke: colour }, svg);
      }
      const area = svgElement("circle", { cx: x, cy: y, r: 10, fill: "transparent", class: "area" }, svg);
      const tell = (event) => tip(event, curve, point);
      area.addEventListener("pointerenter", tell);
      area.addEventListener("pointermove", tell);
      area.addEventListener("pointerleave", () => { byId("tip").hidden = true; });
      area.addEventListener("click", () => choose({ curve, point }));
    }
  });
  if (look) {
    byId(place).replaceChildren(svg);
    return;
  }
  const y = atLog(Math.log10(asked));
  svgElement("path", { class: "asked", d: `M${left} ${y}H${width - right}` }, svg);
  svgElement("text", { class: "word", x: width - right - 4, y: y - 6, "text-anchor": "end" }, svg).textContent = `asked ${short(asked)}`;
  const handle = svgElement("path", { class: "handle", d: `M${left} ${y}H${width - right}` }, svg);
  handle.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    const move = (moved) => {
      const box = byId(place).querySelector("svg").getBoundingClientRect();
      const inside = (moved.clientY - box.top) / box.height * height;
      const exponent = y0 + (height - bottom - inside) / (height - top - bottom) * (y1 - y0);
      asked = Number((10 ** Math.min(Math.max(exponent, y0), y1)).toPrecision(2));
      draw();
    };
    const end = () => { removeEventListener("pointermove", move); removeEventListener("pointerup", end); };
    addEventListener("pointermove", move);
    addEventListener("pointerup", end);
  });
  byId(place).replaceChildren(svg);
};

const figures = (point) => [
  ["error", short(point.error)], ["median", short(point.median)], ...(point.rate === null ? [] : [["velocity", short(point.rate)]]),
  ...(point.second === null ? [] : [[DATA.second, short(point.second)]]),
  ...(point.multiplier === null ? [] : [["multipliers", short(point.multiplier)]]),
  ...(point.contact === undefined ? [] : [["event times", point.contact]]), ...(point.energy ? [["energy", short(point.energy)]] : []),
  ...(point.violation ? [["violation", short(point.violation)]] : []),
  ...(point.expected !== undefined ? [["expected", short(point.expected) + (point.doubted ? ", untrusted" : "")]] : []),
  ...(point.perturbed !== undefined ? [["other parameters", short(point.perturbed)]] : []),
  ["time", `${short(point.time)} ${DATA.unit}`], ["evaluations", point.evaluations || "not told"],
  ...(point.steps ? [["steps", point.steps]] : []), ["verdict", point.verdict],
];
const tip = (event, curve, point) => {
  const box = byId("tip");
  box.replaceChildren();
  element("b", `${curve.name}, ${point.label}`, box);
  const table = element("table", undefined, box);
  for (const [name, value] of figures(point)) {
    const row = element("tr", undefined, table);
    element("td", name, row);
    element("td", String(value), row);
  }
  box.hidden = false;
  const [w, h] = [box.offsetWidth, box.offsetHeight];
  box.style.left = `${Math.max(4, Math.min(event.clientX + 14, innerWidth - w - 4))}px`;
  box.style.top = `${event.clientY + 14 + h > innerHeight ? Math.max(4, event.clientY - h - 14) : event.clientY + 14}px`;
};
const choose = (entry) => {
  byId("chosen").textContent = entry
    ? `${entry.curve.name}, ${entry.point.label}: error ${short(entry.point.error)}, ${short(entry.point.time)} ${DATA.unit}`
    : `no setting reaches ${short(asked)}`;
  byId("rust").textContent = entry ? entry.point.rust : "";
};
const legend = () => {
  const place = byId("legend");
  place.replaceChildren();
  DATA.curves.forEach((curve, c) => {
    const button = element("button", undefined, place);
    const colour = COLOURS[curve.colour % COLOURS.length];
    const svg = svgElement("svg", { viewBox: "0 0 40 14" }, button);
    svgElement("path", { d: "M1 7H39", stroke: colour, "stroke-width": 2, ...dashes(curve) }, svg);
    svgElement("path", { d: mark(curve, 20, 7, 4.2), fill: colour, stroke: colour }, svg);
    element("span", curve.name, button);
    button.className = shown.has(c) ? "" : "off";
    button.setAttribute("aria-pressed", String(shown.has(c)));
    button.addEventListener("click", () => { if (!shown.delete(c)) shown.add(c); draw(); });
  });
};
const table = () => {
  const place = byId("table");
  place.replaceChildren();
  const head = element("tr", undefined, place);
  const rows = trusted.filter((entry) => entry.point.front).sort((a, b) => a.point.time - b.point.time);
  const columns = [
    ["error", (point) => short(point.error)], ["median", (point) => short(point.median)], ["velocity", (point) => short(point.rate)],
    [DATA.second, (point) => short(point.second)], ["multipliers", (point) => short(point.multiplier)], ["event times", (point) => point.contact ?? ""],
    ["energy", (point) => (point.energy ? short(point.energy) : "")], ["violation", (point) => (point.violation ? short(point.violation) : "")],
  ].filter(([, of]) => rows.some(({ point }) => of(point) !== ""));
  ["setting", ...columns.map(([name]) => name), DATA.unit, "evaluations", "steps"].forEach((name) => element("th", name, head));
  const chosen = cheapest(asked);
  for (const { curve, point } of rows) {
    const row = element("tr", undefined, place);
    if (chosen && chosen.point === point) row.className = "chosen";
    [`${curve.name}, ${point.label}`, ...columns.map(([, of]) => of(point)), short(point.time), point.evaluations, point.steps]
      .forEach((text) => element("td", String(text), row));
  }
};
const refused = () => {
  const place = byId("refused");
  const lost = all.filter(({ point }) => point.refused !== undefined || point.verdict === "wrong" || point.verdict === "untrusted" || point.error === undefined);
  byId("refused-panel").hidden = lost.length === 0;
  const groups = new Map();
  for (const { curve, point } of lost) {
    const reason = point.refused ?? (curve.peer ? "the states are not finite" : null) ?? `${point.verdict}: error ${short(point.error)}, expected ${short(point.expected)}`;
    // Reasons that differ by their numbers alone are one.
    const key = `${curve.name}\u0000${reason.replace(/\d+(\.\d+)?(e-?\d+)?/g, "#")}`;
    const group = groups.get(key) ?? { name: curve.name, reason, points: [] };
    group.points.push(point);
    groups.set(key, group);
  }
  for (const { name, reason: told, points } of groups.values()) {
    const reason = told.replace(/\d+\.\d{6,}(e-?\d+)?/g, (number) => short(Number(number)));
    const labels = points.map((point) => point.label).filter((label) => label !== "").join("; ");
    const line = element("p", `${name}${labels && ", "}${labels}: ${reason}`, place);
    if (points[0].verdict === "wrong") line.className = "wrong";
  }
};
const peers = () => {
  const curves = DATA.curves.filter((curve) => curve.peer);
  byId("peers-panel").hidden = curves.length === 0;
  const place = byId("peers");
  place.replaceChildren();
  const head = element("tr", undefined, place);
  ["program", "setting", "error", DATA.unit, "times ours"].forEach((name) => element("th", name, head));
  const own = cheapest(asked);
  for (const curve of curves) {
    const reached = curve.points.filter((point) => point.error !== undefined && point.error <= asked);
    const best = reached.sort((a, b) => a.time - b.time)[0];
    const row = element("tr", undefined, place);
    const lost = curve.points.every((point) => point.refused) ? "refused, see below" : "not reached";
    (best ? [curve.name, best.label, short(best.error), short(best.time), own ? short(best.time / own.time) : ""] : [curve.name, lost, "", "", ""])
      .forEach((text) => element("td", String(text), row));
  }
};
/* Motions from drives: errors of positions, velocities and accelerations, with a colour for each source of sines. */
const KERNELS = [["own", "the runtime's own"], ["fma", "feature fma: fused products"], ["libm", "feature libm"]];
const kinematics = () => {
  const own = DATA.curves.filter((curve) => curve.kernel !== undefined);
  byId("kinematics-panel").hidden = own.length === 0;
  if (own.length === 0) return;
  const quantity = byId("kinematic-error");
  const isSingle = byId("kinematic-numbers").value === "f32";
  const over = byId("kinematic-over");
  const words = over.value === "time" ? `time (${DATA.unit})` : "steps over the span";
  chart("kinematics", (point) => point[over.value], words, {
    error: (point) => point[quantity.value],
    words: quantity.selectedOptions[0].textContent,
    colour: (curve) => KERNELS.findIndex(([kernel]) => kernel === curve.kernel),
    shows: (curve) => curve.kernel !== undefined && curve.dashed === isSingle,
  });
  const legend = byId("kernel-legend");
  legend.replaceChildren();
  const known = KERNELS.filter(([kernel]) => own.some((curve) => curve.kernel === kernel));
  known.forEach(([kernel, name]) => {
    const entry = element("span", undefined, legend);
    const sample = svgElement("svg", { viewBox: "0 0 40 14" }, entry);
    const colour = COLOURS[KERNELS.findIndex(([other]) => other === kernel)];
    svgElement("path", { d: "M1 7H39", stroke: colour, "stroke-width": 2, ...dashes({ kernel, dashed: isSingle }) }, sample);
    element("span", name, entry);
  });
  /* Times over those with the runtime's own sines, at the same settings: the median. */
  const times = new Map();
  const add = (curve, point) => {
    const key = `${base(curve)}\u0000${point.label}`;
    times.set(key, { ...times.get(key), [curve.kernel]: point.time });
  };
  own.filter((curve) => curve.dashed === isSingle).forEach((curve) => curve.points.filter((point) => point.time > 0).forEach((point) => add(curve, point)));
  const ratio = (kernel) => {
    const ratios = [...times.values()].filter((of) => of.own && of[kernel]).map((of) => of[kernel] / of.own).sort((a, b) => a - b);
    return ratios[Math.floor(ratios.length / 2)];
  };
  const told = known.slice(1).map(([kernel]) => [kernel, ratio(kernel)]).filter(([, median]) => median !== undefined);
  byId("kernel-words").textContent = known.length === 1
    ? "`mbs cost --kernels` adds the sines of the features `fma` and `libm`."
    : told.map(([kernel, median]) => `A step with the feature ${kernel} takes ${short(median)} times as long as with the runtime's own sines (median of all settings).`).join(" ");
};
/* Errors of splines along tables of a function over the number of points, for one rounding and one derivative. */
const splines = () => {
  byId("splines-panel").hidden = DATA.splines.length === 0;
  if (DATA.splines.length === 0) return;
  const of = DATA.splines[Number(byId("spline-function").value)];
  const rounding = Number(byId("spline-rounding").value);
  const order = Number(byId("spline-order").value);
  const points = of.points.filter((point) => point.rounding === rounding);
  const [width, height] = innerWidth < 600 ? [360, 300] : [640, 340];
  const [left, right, top, bottom] = [64, 18, 14, 52];
  const svg = svgElement("svg", { viewBox: `0 0 ${width} ${height}`, role: "img" });
  svgElement("title", {}, svg).textContent = `error of the ${["value", "first derivative", "second derivative"][order]} over points`;
  const sizes = [...new Set(of.points.map((point) => point.points))].sort((a, b) => a - b);
  const [x0, x1] = [Math.log10(sizes[0]), Math.log10(sizes[sizes.length - 1])];
  const log = (point) => Math.log10(Math.max(point.errors[order], 1e-17));
  const all = of.points.map(log);
  const [y0, y1] = [Math.floor(Math.min(...all)), Math.ceil(Math.max(...all))];
  const atX = (number) => left + (Math.log10(number) - x0) / (x1 - x0) * (width - left - right);
  const atY = (value) => height - bottom - (value - y0) / (y1 - y0) * (height - top - bottom);
  for (const number of sizes) {
    svgElement("path", { class: "grid", d: `M${atX(number)} ${top}V${height - bottom}` }, svg);
    svgElement("text", { x: atX(number), y: height - bottom + 18, "text-anchor": "middle" }, svg).textContent = number;
  }
  for (let k = y0; k <= y1; k += Math.max(1, Math.ceil((y1 - y0) / 8))) {
    svgElement("path", { class: "grid", d: `M${left} ${atY(k)}H${width - right}` }, svg);
    const text = svgElement("text", { x: left - 8, y: atY(k) + 4, "text-anchor": "end" }, svg);
    text.append("10");
    svgElement("tspan", { dy: -5, "font-size": 9 }, text).textContent = k;
  }
  svgElement("text", { x: (left + width - right) / 2, y: height - 10, "text-anchor": "middle" }, svg).textContent = "points a period";
  const legend = byId("spline-legend");
  legend.replaceChildren();
  of.forms.forEach((form, f) => {
    const own = points.filter((point) => point.form === f).sort((a, b) => a.points - b.points);
    const colour = COLOURS[f % COLOURS.length];
    const line = "M" + own.map((point) => `${atX(point.points)} ${atY(log(point))}`).join("L");
    if (own.length) svgElement("path", { d: line, fill: "none", stroke: colour, "stroke-width": 1.6 }, svg);
    for (const point of own) {
      const spot = svgElement("circle", { cx: atX(point.points), cy: atY(log(point)), r: 4, fill: colour }, svg);
      svgElement("title", {}, spot).textContent = `${form}: ${point.points} points, ${point.knots} knots, ${short(point.errors[order])}`;
    }
    const entry = element("span", undefined, legend);
    const sample = svgElement("svg", { viewBox: "0 0 40 14" }, entry);
    svgElement("path", { d: "M1 7H39", stroke: colour, "stroke-width": 2 }, sample);
    element("span", form, entry);
  });
  const least = points.reduce((a, b) => (log(b) < log(a) ? b : a), points[0]);
  if (least) svgElement("circle", { cx: atX(least.points), cy: atY(log(least)), r: 8, class: "least" }, svg);
  byId("spline-sentence").textContent = of.sentences[rounding] ?? "";
  byId("splines").replaceChildren(svg);
};
const draw = () => {
  chart("time", (point) => point.time, `time (${DATA.unit})`);
  const count = byId("count").value;
  const of = { evaluations: (point) => point.evaluations, steps: (point) => point.steps, work: (point) => point.evaluations + point.corrections };
  chart("counts", of[count], byId("count").selectedOptions[0].textContent);
  legend();
  table();
  peers();
  kinematics();
  splines();
  choose(cheapest(asked));
};
byId("title").textContent = `${DATA.title}: cost of accuracy`;
byId("sentence").textContent = DATA.sentence;
byId("command").textContent = DATA.command;
for (const [name, value] of DATA.facts) { element("dt", name, byId("facts")); element("dd", value, byId("facts")); }
DATA.splines.forEach((of, k) => { element("option", of.name, byId("spline-function")).value = k; });
(DATA.splines[0]?.roundings ?? []).forEach((rounding, k) => {
  const words = rounding === 0 ? "exact points" : `rounded to ${rounding.toExponential(0)} ${DATA.splines[0].unit}`;
  element("option", words, byId("spline-rounding")).value = k;
});
byId("spline-rounding").value = 4;
for (const name of ["spline-function", "spline-rounding", "spline-order"]) byId(name).addEventListener("change", splines);
byId("front").addEventListener("click", () => { showFront(); draw(); });
byId("all").addEventListener("click", () => { DATA.curves.forEach((_, c) => shown.add(c)); draw(); });
byId("none").addEventListener("click", () => { shown.clear(); draw(); });
byId("count").addEventListener("change", draw);
for (const name of ["kinematic-error", "kinematic-numbers", "kinematic-over"]) byId(name).addEventListener("change", kinematics);
addEventListener("resize", draw);
refused();
draw();
