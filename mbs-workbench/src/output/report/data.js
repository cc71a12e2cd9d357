// ---------------------------------------------------------------- data and state

const data = JSON.parse(byId("data").textContent);
const drawing = data.drawing || [];
const traces = drawing.filter(item => item.kind === "trace");
const forcesOf = run => run.dynamics || {};
const entriesOf = (run, kind) => run[kind] || forcesOf(run)[kind] || [];
const moving = runs => (runs || []).filter(run => run.time && run.time.length);
const given = moving(data.runs);
/** Values of a parameter with the runs of each, where the page has a slider; the page opens with the text's or the command's. */
const stops = data.slider ? [{ value: data.slider.value, runs: given }, ...data.slider.stops.map(stop => ({ ...stop, runs: moving(stop.runs) }))].sort((a, b) => a.value - b.value)
  : [{ runs: given }];
const labels = given.map(run => run.label); // as facts name them
clean(stops.flatMap(stop => stop.runs));
for (const stop of stops) stop.runs = merged(stop.runs);
/** The stop whose runs are on show. */
let stop = stops.find(({ runs }) => given.some(run => runs.includes(run))) || stops[0];
const runs = [...stop.runs];
const everyRun = stops.flatMap(stop => stop.runs);
const [start, end] = extent(everyRun.map(run => run.time));
const moves = end > start; // else a position at rest
/** The run that a page opens with: of several rests the first one that is not unstable. */
const opening = Math.max(0, runs.findIndex(run => !run.verdict || run.verdict.course !== "unstable"));
const state = {
  t: start, primary: opening, overlay: false, playing: false, speed: 1, loop: "loop", direction: 1,
  velocity: true, acceleration: true, forces: true, labels: true, trace: true,
  degrees: true, over: "", window: null, hover: null, drag: "time",
};
const views = []; // each { layout(), frame() }: the former after a change of size or choice, the latter after one of time

if (!runs.length) {
  byId("problem").textContent = "The data hold no run: nothing to draw.";
  byId("problem").hidden = false;
}
const formatTime = formatter(Math.max(Math.abs(start), Math.abs(end)), 4);

/** Rests of one position with the same forces and modes count once, their labels joined: the way there has no part in a rest. */
function merged(all) {
  const kept = [], digits = x => finite(x) ? x.toPrecision(5) : x;
  const at = run => JSON.stringify([(run.coordinates || []).map(c => c.q.map(digits)), [...entriesOf(run, "loads"), ...entriesOf(run, "multipliers")].map(load => load.value.map(digits)),
    run.small && run.small.eigenvalues.map(z => z.map(x => Math.abs(x) < 1e-6 * run.small.norm ? 0 : digits(x))), (run.verdict || {}).course]);
  for (const run of all) {
    const same = run.time.length === 1 ? kept.find(other => at(other) === at(run)) : null;
    if (same) Object.assign(same, { label: `${same.label}, ${run.label}`, description: "" });
    else kept.push(run);
  }
  return kept;
}

/**
 * What is below 1e-12 of the largest value of its kind and unit becomes 0. A position counts as large as the largest drawn one, an angle as large as
 * 1 rad, a rate as large as its quantity over the time of the motion.
 */
function clean(runs) {
  const groups = new Map();
  const add = (key, values) => { if (values) groups.set(key, [...(groups.get(key) || []), values]); };
  for (const run of runs) {
    for (const kind of ["coordinates", "outputs", "loads", "multipliers"]) {
      for (const entry of entriesOf(run, kind)) [["q", "value"], ["qd", "rate"], ["qdd", "acceleration"]].forEach((keys, order) => keys.forEach(key => add(`${order} ${kind} ${entry.unit}`, entry[key])));
    }
    for (const supply of forcesOf(run).supplies || []) for (const key of ["power", "work"]) add(key, supply[key]);
    for (const key of ["kinetic", "potential", "work"]) add("energy", forcesOf(run)[key]);
  }
  const drawn = largest(runs.flatMap(run => [...(run.outputs || []), ...(run.places || [])]).filter(({ unit }) => !unit || unit === "m").map(({ value }) => value));
  const sizes = new Map(), [first, last] = extent(runs.map(run => run.time));
  for (const [key, columns] of [...groups].sort(([a], [b]) => a < b ? -1 : 1)) {
    const [, order, kind] = /^(\d) (.*)$/.exec(key) || [], before = order > 0 && last > first ? sizes.get(`${order - 1} ${kind}`) / (last - first) : 0;
    const known = { "0 coordinates m": drawn, "0 outputs m": drawn, "0 coordinates rad": 1, "0 outputs rad": 1 }[key] || before || 0;
    sizes.set(key, Math.max(largest(columns), known));
    const least = NOISE * sizes.get(key);
    for (const values of columns) values.forEach((x, k) => { if (Math.abs(x) < least) values[k] = 0; });
  }
}

/** Runs on show, the primary one first. */
const shown = () => state.overlay ? [runs[state.primary], ...runs.filter((_, i) => i !== state.primary)] : [runs[state.primary]];
/** The same runs at every stop of the slider: what fits them does not change while it slides. */
const shownAtAllStops = () => stops.length === 1 ? shown() : stops.flatMap(({ runs: others }) => shown().map(run => others[runs.indexOf(run)]).filter(Boolean));

// Series are told apart by colour and dash together: seven colours, each with some of eight dashes.
const COLOURS = 7;
const DASHES = ["none", "7 3", "2 3", "10 3 2 3", "14 4", "10 3 2 3 2 3", "5 2 1 2", "1 4"];
const ALIKE = [3, 4]; // colours that some eyes confuse with those before them
const colour = index => `var(--s${index % COLOURS})`;
/** Number of dashes that one run of a group of `count` series takes. */
const dashesOf = count => count <= ALIKE[0] ? 1 : 2 * Math.ceil(count / COLOURS);
/** Dash of a series in the run of this order, where the group has `count` series. */
const dash = (order, index = 0, count = 1) =>
  DASHES[(2 * Math.floor(index / COLOURS) + Number(ALIKE.includes(index % COLOURS)) + order * dashesOf(count)) % DASHES.length];

/** Index of the entry of a rising list nearest to `x`: every number on show is one of the solver's, none is interpolated. */
function sampleAt(list, x) {
  let low = 0, high = list.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (list[middle] <= x) low = middle; else high = middle;
  }
  return x - list[low] <= list[high] - x ? low : high;
}

const sample = (run, t = state.t) => sampleAt(run.time, t);

// ---------------------------------------------------------------- what plots are over

const isMonotone = values => values.length > 1 && values[0] !== values[values.length - 1]
  && [1, -1].some(sign => values.every((x, k) => finite(x) && (k === 0 || sign * (x - values[k - 1]) > 0)));

/** Angles that rise or fall all the time in every run: a plot may be over them; the most even one first. */
const turning = moves ? (runs[0].coordinates || []).filter(c => isAngle(c.unit) && everyRun.every(run => {
  const found = run.coordinates.find(other => other.name === c.name);
  return found && isMonotone(found.q);
})).sort((a, b) => unevenness(a) - unevenness(b)).map(c => c.name) : [];

function unevenness(coordinate) {
  const [low, high] = extent([coordinate.qd]);
  return (high - low) / (Math.max(Math.abs(low), Math.abs(high)) || 1);
}

/** Measured points of a curve: tables with times and values. */
const measuredOf = name => (data.overlays || []).filter(overlay => overlay.of === name);

const perRadian = () => state.degrees ? 180 / Math.PI : 1;
/** Factor and unit of a quantity on show. */
const scaleOf = unit => isAngle(unit) ? perRadian() : 1;
const shownUnit = unit => isAngle(unit) && state.degrees ? unitText(unit).replace("rad", "°") : unitText(unit);

const angles = new Map();
/** Abscissae of a run's instants. */
function abscissae(run) {
  if (!state.over) return run.time;
  const factor = perRadian(), key = `${everyRun.indexOf(run)} ${state.over} ${factor}`;
  if (!angles.has(key)) angles.set(key, run.coordinates.find(c => c.name === state.over).q.map(x => x * factor));
  return angles.get(key);
}
/** Abscissa of a run at a time, between two of its instants on the line through them; none outside of the motion. */
function abscissaAt(run, t) {
  const times = run.time, over = abscissae(run), k = sampleAt(times, t), last = times.length - 1;
  if (!(t >= times[0] && t <= times[last])) return null;
  const i = Math.min(times[k] > t ? k - 1 : k, last - 1);
  return i < 0 ? over[0] : over[i] + (over[i + 1] - over[i]) * (t - times[i]) / (times[i + 1] - times[i]);
}
const overTitle = () => state.over || "t";
const overUnit = () => state.over ? shownUnit("rad") : "s";
/** Sample of a run nearest to an abscissa. */
function sampleOver(run, x) {
  const list = abscissae(run);
  return list[0] <= list[list.length - 1] ? sampleAt(list, x) : sampleAt(list.map(y => -y), -x);
}
const abscissaNow = () => state.over ? abscissae(runs[state.primary])[sample(runs[state.primary])] : state.t;

let laidOut = 0;
const layout = () => { if (runs.length) for (const view of views) view.layout(); laidOut += 1; frame(); };
const frame = () => { if (runs.length) for (const view of views) view.frame(); };
const setTime = t => { state.t = clamp(t, start, end); frame(); };
