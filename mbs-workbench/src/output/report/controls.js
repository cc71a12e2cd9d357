// ---------------------------------------------------------------- controls of time and of the drawing

const LOOPS = { loop: "loop", pingpong: "to and fro", once: "once" };

let last = null;
function tick(now) {
  if (!state.playing) return;
  const step = last === null ? 0 : Math.min((now - last) / 1000, .1) * state.speed; // a hidden tab does not jump ahead
  last = now;
  advance(step);
  requestAnimationFrame(tick);
}

/** Moves the time on; at an end it begins anew, turns back or stops. */
function advance(step) {
  const t = state.t + step * (state.loop === "pingpong" ? state.direction : 1);
  if (t >= start && t < end) return setTime(t);
  if (state.loop === "loop") return setTime(start);
  if (state.loop === "pingpong") state.direction = t >= end ? -1 : 1;
  else play(false);
  setTime(t);
}

function play(on) {
  if (on === state.playing || (on && !moves)) return;
  state.playing = on;
  if (on && state.loop === "once" && state.t >= end) state.t = start;
  last = null;
  byId("play").textContent = on ? "Pause" : "Play";
  if (on) requestAnimationFrame(tick);
}

/** One instant on or back. */
function stepBy(count) {
  play(false);
  const { time } = runs[state.primary];
  setTime(time[clamp(sample(runs[state.primary]) + count, 0, time.length - 1)]);
}

function createTransport() {
  const scrub = byId("scrub"), speed = byId("speed"), loop = byId("loop");
  for (const factor of [10, 5, 2, 1, .5, .25, .1, .05, .02, .01, .001]) speed.append(el("option", { value: factor, textContent: `${factor}×` }));
  // A first round that takes some four seconds, real time for anything longer.
  const first = [...speed.options].find(option => option.value <= clamp((end - start) / 4, .001, 1));
  speed.value = (first || speed.options[3]).value;
  state.speed = Number(speed.value);
  speed.addEventListener("change", () => { state.speed = Number(speed.value); });
  for (const [value, textContent] of Object.entries(LOOPS)) loop.append(el("option", { value, textContent }));
  loop.addEventListener("change", () => setLoop(loop.value));
  byId("play").addEventListener("click", () => play(!state.playing));
  byId("back").addEventListener("click", () => stepBy(-1));
  byId("on").addEventListener("click", () => stepBy(1));
  scrub.addEventListener("input", () => { play(false); setTime(runs[state.primary].time[Number(scrub.value)]); });
  return {
    layout() { scrub.max = runs[state.primary].time.length - 1; },
    frame() {
      scrub.value = sample(runs[state.primary]);
      scrub.setAttribute("aria-valuetext", `${formatTime(state.t)} seconds`);
    },
  };
}

function setLoop(value) {
  [state.loop, state.direction] = [value, 1];
  byId("loop").value = value;
}

/** Keys of the page; a field that has the focus keeps those that it knows. */
function createKeys() {
  const flip = id => { const input = byId(id); if (input) input.click(); };
  const acts = {
    " ": () => play(!state.playing), ",": () => stepBy(-1), ".": () => stepBy(1), ArrowLeft: () => stepBy(-1), ArrowRight: () => stepBy(1),
    Home: () => { play(false); setTime(start); }, End: () => { play(false); setTime(end); },
    l: () => { const names = Object.keys(LOOPS); setLoop(names[(names.indexOf(state.loop) + 1) % names.length]); },
    p: () => flip("show-trace"), v: () => flip("show-velocity"), a: () => flip("show-acceleration"), f: () => flip("show-forces"), n: () => flip("show-labels"),
    d: () => flip("degrees"), r: resetPlots, "[": () => slideBy(-1), "]": () => slideBy(1),
  };
  document.addEventListener("keydown", event => {
    const act = acts[event.key];
    if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
    const { target } = event, field = target.closest && target.closest("button, select, input");
    const own = field && (event.key === " " ? field.type !== "range" : event.key.length > 1 || field.tagName === "SELECT");
    if (own || (event.key === " " && event.repeat) || target.closest("pre")) return;
    event.preventDefault();
    act();
  });
}

function select(index) {
  state.overlay = false;
  state.primary = index;
  const input = document.querySelector(`#assembly input[value="${index}"]`);
  if (input) input.checked = true;
  layout();
}

/** A slider through the range that the text gives a parameter: every stop has motions of its own. */
function createSlider() {
  const host = byId("slider"), { slider } = data;
  host.hidden = !slider || stops.length < 2;
  if (host.hidden) return { layout() {}, frame() {} };
  const unit = shownUnit(slider.unit).replace(/^1$/, ""), format = x => significant(x * scaleOf(slider.unit), 5), first = stop;
  const input = el("input", { type: "range", id: "slide", min: 0, max: stops.length - 1, step: 1, ariaLabel: slider.name, title: "One stop on or back (] and [)" });
  const value = el("output", { id: "stop", htmlFor: "slide" }), reset = el("button", { type: "button", textContent: "reset" }), reason = byId("reason");
  const ends = slider.range.map(x => el("span", { className: "hint", textContent: format(x) }));
  const deviation = slider.tolerance ? ` ± ${format(slider.tolerance)}` : "";
  const go = index => {
    const next = stops[clamp(index, 0, stops.length - 1)];
    input.value = stops.indexOf(next);
    // A stop without all motions says why; the last ones stay on show, pale.
    const whole = next.runs.length === first.runs.length;
    reason.hidden = whole;
    reason.textContent = whole ? "" : `${slider.name} = ${format(next.value)}${unit && ` ${unit}`}: ${next.reason || "not every motion exists"}`;
    document.body.classList.toggle("none", !whole);
    value.textContent = `${format(next.value)}${deviation}${unit && ` ${unit}`}`;
    if (!whole || next === stop) return;
    stop = next;
    runs.splice(0, runs.length, ...next.runs);
    layout();
  };
  input.addEventListener("input", () => go(Number(input.value)));
  reset.addEventListener("click", () => go(stops.indexOf(first)));
  slideBy = count => go(Number(input.value) + count);
  host.append(el("label", {}, el("b", { textContent: slider.name }), value), ends[0], input, ends[1], reset);
  go(stops.indexOf(first));
  return { layout() {}, frame() {} };
}

let slideBy = () => {}; // stops on or back, where there is a slider

function createAssembly() {
  const host = byId("assembly");
  host.hidden = runs.length < 2; // one choice is none
  const choices = runs.map((run, i) => [String(i), run.label]);
  if (runs.length > 1) choices.push(["both", runs.length > 2 ? "all" : "both"]);
  for (const [value, label] of choices) {
    const input = el("input", { type: "radio", name: "assembly", value, checked: value === String(opening) });
    input.addEventListener("change", () => {
      if (value !== "both") return select(Number(value));
      state.overlay = true;
      layout();
    });
    host.append(el("label", {}, input, label));
  }
}

/** What the drawing shows, with the present speed and acceleration of the first traced point. */
function createShow() {
  const host = byId("show"), readouts = [];
  const add = (key, label, colour, ...more) => {
    const input = el("input", { type: "checkbox", id: `show-${key}`, checked: state[key] });
    input.addEventListener("change", () => { state[key] = input.checked; frame(); });
    host.append(el("label", {}, input, ...(colour ? [swatch(colour)] : []), label, ...more));
  };
  if (moves && traces.length) {
    add("trace", "path", null);
    traces.forEach((trace, i) => {
      if (trace.label) host.append(el("span", { className: "key", title: `path of ${trace.of}` }, swatch(`var(--trace${i % 2})`), trace.label));
    });
  }
  for (const [key, name, unit] of moves ? [["rate", "velocity", "m/s"], ["acceleration", "acceleration", "m/s²"]] : []) {
    const with_ = traces.filter(trace => runs.some(run => vector(run, trace.of, key)));
    if (!with_.length) continue;
    const readout = el("output", { title: `of ${with_[0].of}` });
    const norm = (run, k) => { const v = components(run, with_[0].of, key); return v ? Math.hypot(...v.map(c => c[k])) : null; };
    const format = formatter(largest(runs.map(run => run.time.map((_, k) => norm(run, k)))), 4);
    readouts.push(() => { const run = runs[state.primary]; readout.textContent = `${format(norm(run, sample(run)))} ${unit}`; });
    add(name, name, `var(--${name})`, readout);
  }
  if ((data.forces || []).some(({ of }) => runs.some(run => loadOf(run, of)))) add("forces", "forces", "var(--force)");
  add("labels", "names", null);
  return { layout() {}, frame() { for (const update of readouts) update(); } };
}

/** Tools of all plots: what they are over, degrees, what dragging does. */
function createTools() {
  const over = byId("over"), degrees = byId("degrees");
  over.append(el("option", { value: "", textContent: "time" }), ...turning.map(name => el("option", { value: name, textContent: name })));
  over.parentNode.hidden = !turning.length;
  // A torque is asked for over the crank's angle.
  if (data.analysis === "inverse" && turning.length) state.over = turning[0];
  over.value = state.over;
  over.addEventListener("change", () => { state.over = over.value; resetPlots(); });
  degrees.checked = state.degrees;
  degrees.addEventListener("change", () => { state.degrees = degrees.checked; state.window = null; for (const plot of plots) plot.reset(); layout(); });
  degrees.parentNode.hidden = !(runs[0].coordinates || []).concat(moves && runs[0].outputs || []).some(entry => isAngle(entry.unit));
  for (const input of document.querySelectorAll("#drag input")) input.addEventListener("change", () => {
    state.drag = input.value;
    byId("plots").dataset.drag = input.value;
  });
  byId("unzoom").addEventListener("click", resetPlots);
}
