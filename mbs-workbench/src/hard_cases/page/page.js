"use strict";
const MARKS = { right: "✓", late: "◷", refused: "–", wrong: "✗" };
const WORDS = {
  right: "the error is within its bound, all checks hold",
  late: "right, with ten times the median's work",
  refused: "a failure that says why, or no digits claimed",
  wrong: "an answer that is not right",
};
const by = (id) => document.getElementById(id);
function element(tag, text, classes) {
  const made = document.createElement(tag);
  if (text !== undefined) made.textContent = text;
  if (classes) made.className = classes;
  return made;
}
const short = (value) => (value === null ? "" : value === 0 ? "0" : value.toExponential(1).replace(".0e", "e"));

function words(cell) {
  if (cell.worst !== "right") return `${cell.worst} ${cell.of_worst}/${cell.variants}`;
  return cell.closest === null ? "right" : `right ${short(cell.closest)}`;
}

const again = (outcome) => `${DATA.replay.replace("CASE", outcome.case)}${outcome.seed}`;

function sparkline(course, name) {
  const figure = element("figure");
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  const seen = course.filter((value) => value !== null);
  if (seen.length < 2) return figure;
  const [low, high] = [Math.min(...seen), Math.max(...seen)];
  const y = (value) => (high > low ? 31 - (28 * (value - low)) / (high - low) : 17);
  const points = seen.map((value, index) => `${((150 * index) / (seen.length - 1)).toFixed(1)},${y(value).toFixed(1)}`);
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  svg.setAttribute("viewBox", "0 0 150 34");
  path.setAttribute("d", `M${points.join("L")}`);
  svg.append(path);
  figure.append(svg);
  if (name) figure.append(element("figcaption", `${name} ${short(low)} to ${short(high)}`));
  return figure;
}

function open(cell, button) {
  document.querySelectorAll("#matrix .chosen").forEach((other) => other.classList.remove("chosen"));
  button.classList.add("chosen");
  by("opened").hidden = false;
  by("opened-title").textContent = `${cell.row}, ${cell.column}`;
  const table = by("variants");
  table.replaceChildren();
  const head = element("tr");
  for (const name of ["seed", "verdict", "error", "bound", "variant and reason", "course", "replay"]) head.append(element("th", name));
  table.append(head);
  const rank = ["wrong", "refused", "late", "right"];
  const own = DATA.outcomes.filter((outcome) => outcome.place[0] === cell.row && outcome.place[1] === cell.column);
  own.sort((a, b) => rank.indexOf(a.verdict) - rank.indexOf(b.verdict) || a.seed - b.seed);
  for (const outcome of own) {
    const row = element("tr", undefined, outcome.verdict);
    row.append(element("td", outcome.seed));
    const verdict = element("td");
    verdict.append(element("span", `${MARKS[outcome.verdict]} ${outcome.verdict}`, "tag"));
    row.append(verdict, element("td", short(outcome.error)), element("td", short(outcome.bound)));
    const why = element("td", `${outcome.kind}: ${outcome.variant}`);
    if (outcome.reason) why.append(element("br"), element("b", outcome.reason));
    row.append(why);
    const picture = element("td");
    const { place, energy = [], violation = [] } = outcome.course;
    picture.append(sparkline(place));
    if (energy.length) picture.append(sparkline(energy, "energy (J)"));
    if (violation.length) picture.append(sparkline(violation, "violation"));
    row.append(picture);
    const replay = element("td");
    replay.append(element("code", again(outcome)));
    row.append(replay);
    table.append(row);
  }
}

by("title").textContent = `${DATA.title}: hard cases`;
by("sentence").textContent = DATA.sentence;
for (const verdict of Object.keys(MARKS)) {
  const entry = element("span");
  entry.append(element("span", `${MARKS[verdict]} `, `tag ${verdict}`), element("b", ` ${verdict} `), WORDS[verdict]);
  by("legend").append(entry);
}
const head = element("tr");
head.append(element("th", DATA.heads[0]), ...DATA.columns.map((column) => element("th", column)));
const thead = element("thead");
thead.append(head);
const body = element("tbody");
let worst = null;
for (const name of DATA.rows) {
  const row = element("tr");
  row.append(element("th", name));
  for (const column of DATA.columns) {
    const cell = DATA.cells.find((cell) => cell.row === name && cell.column === column);
    const place = element("td");
    if (cell) {
      const button = element("button", undefined, cell.worst === "refused" && !cell.is_expected ? "refused odd" : cell.worst);
      button.append(element("span", MARKS[cell.worst], "mark"), words(cell));
      button.addEventListener("click", () => open(cell, button));
      if (cell.worst === "wrong" && !worst) worst = () => open(cell, button);
      place.append(button);
    } else {
      place.className = "none";
      place.textContent = "·";
    }
    row.append(place);
  }
  body.append(row);
}
by("matrix").append(thead, body);
if (worst) worst();

const reasons = new Map();
for (const outcome of DATA.outcomes.filter((outcome) => outcome.verdict !== "right" && !outcome.is_expected)) {
  const key = [outcome.verdict, outcome.case, outcome.method, outcome.kind, outcome.reason.replace(/[-\d.e]+/g, "")].join("\n");
  const known = reasons.get(key);
  if (known) known.count += 1;
  else reasons.set(key, { ...outcome, count: 1 });
}
const rank = { wrong: 0, refused: 1, late: 2 };
const sorted = [...reasons.values()].sort((a, b) => rank[a.verdict] - rank[b.verdict] || b.count - a.count);
for (const found of sorted.slice(0, 60)) {
  const line = element("p", undefined, found.verdict);
  line.append(element("span", `${MARKS[found.verdict]} ${found.count}`, "tag"), ` ${found.case ? `${found.case}, ` : ""}${found.method}, ${found.kind}: ${found.reason} `);
  line.append(element("code", again(found)));
  by("reasons").append(line);
}
if (sorted.length === 0) by("reasons-panel").hidden = true;
const gaps = [...new Set([...DATA.outcomes.flatMap((outcome) => outcome.not_made), ...DATA.left_out])];
if (DATA.not_run > 0) gaps.push(`${DATA.not_run} variants: there was no time for them`);
gaps.push("the elimination of the text in variants of rows and frame: adapters take all entries of a matrix");
for (const gap of gaps) by("gaps").append(element("li", gap));
for (const [name, value] of DATA.facts) by("facts").append(element("dt", name), element("dd", value));
by("command").textContent = DATA.command;
