"use strict";
const byId = (id) => document.getElementById(id);
const svgElement = (name, attributes, parent) => {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (parent) parent.append(element);
  return element;
};
const element = (name, text, parent, kind) => {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (kind) made.className = kind;
  if (parent) parent.append(made);
  return made;
};
const short = (value) => {
  if (value === undefined || value === null) return "–";
  if (value === 0) return "0";
  return Math.abs(value) >= 1e-3 && Math.abs(value) < 1e5 ? String(Number(value.toPrecision(3))) : value.toExponential(1);
};
const percent = (part) => {
  if (part === undefined || part === null) return "–";
  const value = 100 * part;
  if (value === 0) return "0 %";
  if (value > 1000) return "> 1000 %";
  return value < 1e-3 ? `${value.toExponential(0)} %` : `${Number(value.toPrecision(2))} %`;
};
const whole = DATA.scenes.find((scene) => scene.is_whole);
const enough = DATA.scenes.find((scene) => scene.is_enough);
const LEAST = 1e-6;

/* Round numbers between two ends. */
const marks = (low, high, count) => {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((of) => of * power).find((of) => rough <= of) ?? 10 * power;
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high; k += 1) found.push(Number((k * step).toPrecision(12)));
  return found;
};
const size = (tall) => innerWidth < 600 ? [380, tall ? 330 : 220] : [tall ? 760 : 1300, tall ? 430 : 260];

/* Change of the watched outputs over the cost of an effect. */
const plot = () => {
  const [cost, measure] = [byId("cost").value, byId("measure").value];
  const [width, height] = size(true);
  const [left, right, top, bottom] = [70, 24, 18, 46];
  const svg = svgElement("svg", { viewBox: `0 0 ${width} ${height}`, role: "img" });
  svgElement("title", {}, svg).textContent = "change of the watched outputs without an effect, over its cost";
  const points = DATA.effects.flatMap((one) => {
    const changes = one.changes.filter((change) => change.reason === undefined);
    if (changes.length === 0 || one[cost] === null) return [];
    const change = Math.max(...changes.map((change) => change[measure]));
    return [{ name: one.name, cost: cost === "step" ? 1e9 * one.step : one[cost], change: Math.max(change, LEAST) }];
  });
  const logs = [...points.map((point) => Math.log10(point.change)), Math.log10(DATA.within)];
  const [y0, y1] = [Math.floor(Math.min(...logs) - 0.2), Math.ceil(Math.max(...logs) + 0.2)];
  const costs = points.map((point) => point.cost);
  const [low, high] = [Math.min(0, ...costs), Math.max(1, ...costs)];
  const [x0, x1] = [low - 0.04 * (high - low), high + 0.12 * (high - low)];
  const atX = (value) => left + (value - x0) / (x1 - x0) * (width - left - right);
  const atY = (log) => height - bottom - (log - y0) / (y1 - y0) * (height - top - bottom);
  for (let k = y0; k <= y1; k += 1) {
    svgElement("path", { class: "grid", d: `M${left} ${atY(k)}H${width - right}` }, svg);
    svgElement("text", { x: left - 8, y: atY(k) + 4, "text-anchor": "end" }, svg).textContent = percent(10 ** k);
  }
  for (const mark of marks(x0, x1, width < 500 ? 4 : 7)) {
    svgElement("path", { class: "grid", d: `M${atX(mark)} ${top}V${height - bottom}` }, svg);
    svgElement("text", { x: atX(mark), y: height - bottom + 18, "text-anchor": "middle" }, svg).textContent = mark;
  }
  svgElement("text", { x: (left + width - right) / 2, y: height - 8, "text-anchor": "middle" }, svg).textContent = byId("cost").selectedOptions[0].textContent;
  const y = atY(Math.log10(DATA.within));
  svgElement("path", { class: "asked", d: `M${left} ${y}H${width - right}` }, svg);
  svgElement("text", { class: "asked", x: width - right - 4, y: y - 6, "text-anchor": "end" }, svg).textContent = `within ${percent(DATA.within)}`;
  const labels = [];
  for (const point of points.sort((a, b) => b.change - a.change)) {
    const [x, y] = [atX(point.cost), atY(Math.log10(point.change))];
    const kept = enough && enough.effects.includes(point.name);
    const spot = svgElement("circle", { class: kept ? "spot kept" : "spot", cx: x, cy: y, r: 5 }, svg);
    svgElement("title", {}, spot).textContent = `${point.name}: ${percent(point.change)}, ${short(point.cost)}`;
    // Labels of points that lie together stand below one another.
    let line = y + 4;
    while (labels.some(([other, at]) => Math.abs(other - x) < 110 && Math.abs(at - line) < 14)) line += 14;
    labels.push([x, line]);
    const turned = x > width - right - 8 * point.name.length;
    svgElement("text", { class: "name", x: turned ? x - 9 : x + 9, y: line, "text-anchor": turned ? "end" : "start" }, svg).textContent = point.name;
  }
  byId("plot").replaceChildren(svg);
};

/* Curves over the time in one frame. */
const frame = (place, lines, words, guides) => {
  const [width, height] = size(false);
  const [left, right, top, bottom] = [width < 500 ? 58 : 72, 14, 12, 40];
  const svg = svgElement("svg", { viewBox: `0 0 ${width} ${height}`, role: "img" });
  svgElement("title", {}, svg).textContent = words;
  const all = lines.flatMap(([, values]) => values).concat(guides);
  let [y0, y1] = all.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
  if (!(y0 < y1)) [y0, y1] = [y0 - 1, y1 + 1];
  [y0, y1] = [y0 - 0.05 * (y1 - y0), y1 + 0.05 * (y1 - y0)];
  const [t0, t1] = [DATA.times[0], DATA.times[DATA.times.length - 1]];
  const atX = (t) => left + (t - t0) / (t1 - t0) * (width - left - right);
  const atY = (value) => height - bottom - (value - y0) / (y1 - y0) * (height - top - bottom);
  for (const mark of marks(y0, y1, 5)) {
    svgElement("path", { class: mark === 0 ? "axis" : "grid", d: `M${left} ${atY(mark)}H${width - right}` }, svg);
    svgElement("text", { x: left - 8, y: atY(mark) + 4, "text-anchor": "end" }, svg).textContent = short(mark);
  }
  for (const mark of marks(t0, t1, width < 500 ? 4 : 8)) {
    svgElement("path", { class: "grid", d: `M${atX(mark)} ${top}V${height - bottom}` }, svg);
    svgElement("text", { x: atX(mark), y: height - bottom + 18, "text-anchor": "middle" }, svg).textContent = mark;
  }
  svgElement("text", { x: (left + width - right) / 2, y: height - 6, "text-anchor": "middle" }, svg).textContent = "t (s)";
  svgElement("text", { x: 14, y: height / 2, "text-anchor": "middle", transform: `rotate(-90 14 ${height / 2})` }, svg).textContent = words;
  for (const guide of guides) svgElement("path", { class: "asked", d: `M${left} ${atY(guide)}H${width - right}` }, svg);
  for (const [kind, values] of lines) {
    svgElement("path", { class: `line ${kind}`, d: "M" + values.map((value, k) => `${atX(DATA.times[k]).toFixed(1)} ${atY(value).toFixed(1)}`).join("L") }, svg);
  }
  byId(place).replaceChildren(svg);
};
const curves = () => {
  const curve = DATA.curves[Number(byId("output").value)];
  if (!curve) return;
  const lines = [["whole", curve.whole]];
  if (curve.enough) lines.push(["enough", curve.enough]);
  frame("curves", lines, curve.unit === "1" ? curve.name : `${curve.name} (${curve.unit})`, []);
  const difference = (curve.enough ?? curve.whole).map((value, k) => 100 * (value - curve.whole[k]) / curve.range);
  frame("difference", [["plain", difference]], "difference (%)", [-100 * DATA.within, 100 * DATA.within]);
};
const cells = (row, texts) => texts.forEach((text) => element("td", String(text), row));
const tables = () => {
  const effects = byId("effects");
  const head = element("tr", undefined, effects);
  ["effect", "coordinates", "rows", "operations", "bytes", "ns a step", "output", "largest", "at (s)", "RMS"].forEach((name) => element("th", name, head, name === "output" ? "word" : undefined));
  for (const one of DATA.effects) {
    const own = [one.name, one.coordinates, one.rows, one.operations, one.bytes ?? "–", one.step === null ? "–" : (1e9 * one.step).toFixed(0)];
    const kept = enough && enough.effects.includes(one.name);
    if (one.reason !== null) {
      const row = element("tr", undefined, effects, "lead");
      cells(row, own);
      element("td", `cannot be left out: ${one.reason}`, row, "reason").colSpan = 4;
    }
    one.changes.forEach((change, k) => {
      const row = element("tr", undefined, effects, k === 0 ? (kept ? "lead chosen" : "lead") : (kept ? "chosen" : ""));
      cells(row, k === 0 ? own : ["", "", "", "", "", ""]);
      element("td", change.output, row, "word");
      if (change.reason !== undefined) element("td", change.reason, row, "reason").colSpan = 3;
      else cells(row, [percent(change.largest), short(change.at), percent(change.rms)]);
    });
  }
  const scenes = byId("scenes");
  const top = element("tr", undefined, scenes);
  ["effects", "coordinates", "rows", "operations", "bytes", "ns a step", "cost", "steps", "largest", "RMS"].forEach((name) => element("th", name, top));
  const worst = (scene, of) => Math.max(0, ...scene.changes.filter((change) => change.reason === undefined).map((change) => change[of]));
  const order = [...DATA.scenes].sort((a, b) => Number(b.is_within) - Number(a.is_within) || (a.share ?? 9) - (b.share ?? 9));
  for (const scene of order) {
    const row = element("tr", undefined, scenes, scene.is_enough ? "chosen" : undefined);
    const left = whole ? whole.effects.filter((name) => !scene.effects.includes(name)) : [];
    const few = left.length < scene.effects.length ? `all but ${left.join(", ")}` : scene.effects.join(" + ");
    const base = DATA.kept.length === 0 ? "the base alone" : "those of all scenes alone";
    const name = scene.is_whole ? "all" : scene.effects.length === 0 ? base : few;
    const step = scene.step === null ? "–" : (1e9 * scene.step).toFixed(0);
    cells(row, [name, scene.coordinates || "–", scene.rows || "–", scene.operations || "–", scene.bytes ?? "–", step, short(scene.share), scene.steps ?? "–"]);
    const reason = scene.reason ?? scene.changes.find((change) => change.reason !== undefined)?.reason;
    if (reason) element("td", reason, row, "reason").colSpan = 2;
    else cells(row, [percent(worst(scene, "largest")), percent(worst(scene, "rms"))]);
  }
};
byId("title").textContent = `${DATA.title}: effects`;
const sentence = DATA.sentence.replaceAll("`", "");
byId("sentence").textContent = sentence.charAt(0).toUpperCase() + sentence.slice(1) + ".";
byId("command").textContent = DATA.command;
byId("paste").textContent = DATA.paste;
if (enough && whole) {
  const own = [...enough.effects, ...DATA.kept];
  byId("enough").textContent = own.length === 0 ? "the base alone" : own.join(" + ");
  const figure = (name, value) => { element("dt", name, byId("figures")); element("dd", value, byId("figures")); };
  figure("left out", whole.effects.filter((name) => !enough.effects.includes(name)).join(", ") || "nothing");
  figure("time of a step", `${(1e9 * enough.step).toFixed(0)} of ${(1e9 * whole.step).toFixed(0)} ns`);
  figure("operations", `${enough.operations} of ${whole.operations}`);
  if (enough.bytes !== null && whole.bytes !== null) figure("bytes of code", `${enough.bytes} of ${whole.bytes}`);
  for (const change of enough.changes) figure(change.output, change.reason ?? `largest ${percent(change.largest)} at ${short(change.at)} s, RMS ${percent(change.rms)}`);
}
for (const [name, value] of DATA.facts) { element("dt", name, byId("facts")); element("dd", value, byId("facts")); }
DATA.curves.forEach((curve, k) => { element("option", curve.name, byId("output")).value = k; });
byId("curves-panel").hidden = DATA.curves.length === 0;
byId("output").hidden = DATA.curves.length < 2;
for (const name of ["cost", "measure"]) byId(name).addEventListener("change", plot);
byId("output").addEventListener("change", curves);
addEventListener("resize", () => { plot(); curves(); });
tables();
plot();
curves();
