// ---------------------------------------------------------------- small motions

const COURSES = { stable: "var(--s2)", unstable: "var(--s1)", marginal: "var(--s0)", indifferent: "var(--s6)" };
const powered = text => minus(text.replace(/e([+-]?)(\d+)$/, (_, sign, n) => `×10${superscript((sign === "-" ? "-" : "") + n)}`));
const significant = (x, digits = 6) => powered(String(Number(x.toPrecision(digits))));
/** An eigenvalue of a mode without what rounding leaves of 0. */
const valueOf = (mode, [real, imaginary]) => [["marginal", "indifferent"].includes(mode.course) ? 0 : real, mode.course === "indifferent" ? 0 : imaginary];
const numbersOf = mode => mode.of.map(i => i + 1).join(", ");

/** The eigenvalues of small motions in the complex plane. */
function plane(small, width) {
  const height = Math.round(clamp(width * .75, 220, 330)), area = { left: 62, right: 14, top: 31, bottom: 38 };
  const root = svg("svg", { role: "img", width, height, viewBox: `0 0 ${width} ${height}`, "aria-label": "Eigenvalues in the complex plane" });
  const points = small.modes.flatMap(mode => mode.of.map(index => [mode, index, valueOf(mode, small.eigenvalues[index])]));
  const size = largest(points.map(([, , z]) => z)) || 1;
  const reach = [0, 1].map(i => {
    const [low, high] = extent([points.map(([, , z]) => z[i]).concat(0)]);
    if (high - low < .1 * size) return [low - .5 * size, high + .5 * size];
    return [low - .12 * (high - low), high + .12 * (high - low)];
  });
  const inner = [width - area.left - area.right, height - area.top - area.bottom];
  const X = x => area.left + (x - reach[0][0]) / (reach[0][1] - reach[0][0]) * inner[0];
  const Y = y => area.top + (reach[1][1] - y) / (reach[1][1] - reach[1][0]) * inner[1];
  const bottom = height - area.bottom, right = width - area.right;
  const across = linearTicks(...reach[0], (reach[0][1] - reach[0][0]) / clamp(Math.floor(inner[0] / 64), 2, 6));
  const up = linearTicks(...reach[1], (reach[1][1] - reach[1][0]) / 5);
  root.append(svg("rect", { class: "decaying", x: area.left, y: area.top, width: clamp(X(0), area.left, right) - area.left, height: inner[1] }));
  for (const [x, text] of across.ticks) root.append(svg("path", { class: x === 0 ? "zero" : "gridline", d: `M${X(x)} ${area.top}V${bottom}` }), svg("text", { x: X(x), y: bottom + 15, "text-anchor": "middle" }, text));
  for (const [y, text] of up.ticks) root.append(svg("path", { class: y === 0 ? "zero" : "gridline", d: `M${area.left} ${Y(y)}H${right}` }), svg("text", { x: area.left - 7, y: Y(y) + 4, "text-anchor": "end" }, text));
  root.append(svg("rect", { class: "frame", x: area.left, y: area.top, width: inner[0], height: inner[1] }),
    svg("text", { class: "axis-title", x: 2, y: 15 }, `Im λ [${up.factor}1/s]`),
    svg("text", { class: "axis-title", x: right, y: height - 5, "text-anchor": "end" }, `Re λ [${across.factor}1/s]`));
  for (const [mode, index, [x, y]] of points) {
    root.append(svg("circle", { cx: X(x), cy: Y(y), r: 5, style: `fill: ${COURSES[mode.course]}; fill-opacity: .8; stroke: var(--paper)` },
      svg("title", {}, `eigenvalue ${index + 1}: ${mode.course}`)));
  }
  return root;
}

/** Every eigenvalue with what it means, a pair in one line; columns that no eigenvalue fills are left out. */
function eigenvalues(small) {
  const lines = small.modes.map(mode => {
    const { course } = mode, [real, imaginary] = valueOf(mode, mode.eigenvalue), swings = imaginary > 0;
    const still = course === "marginal" || course === "indifferent", part = still ? "0" : significant(real);
    return { mode, cells: [swings ? `${part} ± ${significant(imaginary)} i` : part, swings ? `${significant(imaginary / 2 / Math.PI)} Hz` : "",
      swings && !still ? significant(-real / Math.hypot(real, imaginary), 4) : "", still ? "" : `${significant(1 / Math.abs(real), 4)} s`] };
  });
  const titles = ["λ [1/s]", "frequency", "damping ratio", "e-fold time"], filled = titles.map((_, i) => i === 0 || lines.some(({ cells }) => cells[i]));
  const head = ["mode", ...(small.modes.some((mode, i) => mode.of.length !== 1 || mode.of[0] !== i) ? ["eigenvalues"] : []), ...titles.filter((_, i) => filled[i]), "course"];
  const body = el("tbody");
  lines.forEach(({ mode, cells }, number) => {
    const dot = svg("svg", { width: 12, height: 12, "aria-hidden": "true" }, svg("circle", { cx: 6, cy: 7, r: 4.5, style: `fill: ${COURSES[mode.course]}` }));
    body.append(el("tr", {}, el("th", { scope: "row", textContent: number + 1 }), ...(head[1] === "eigenvalues" ? [el("td", { className: "numbers", textContent: numbersOf(mode) })] : []),
      ...cells.filter((_, i) => filled[i]).map(textContent => el("td", { textContent: textContent || "–" })),
      el("td", {}, dot, small.frozen ? " at this moment" : ` ${mode.course}`)));
  });
  return el("div", { className: "scroll" }, el("table", { className: "forces" },
    el("thead", {}, el("tr", {}, ...head.map(text => el("th", { scope: "col", textContent: text })))), body));
}

const PHASES = 32; // poses a cycle

/** A run through one cycle of a mode about the last pose of `run`, `amplitude` times its shape; of amplitude 0 the pose itself. */
function cycle(run, mode, amplitude) {
  const phases = [...Array(PHASES + 1).keys()].map(k => 2 * Math.PI * k / PHASES);
  const moved = (base, shape) => phases.map(phase => {
    const [re, im] = (shape || []).every(finite) && shape ? shape : [0, 0];
    return base + amplitude * (re * Math.cos(phase) - im * Math.sin(phase));
  });
  const end = values => values[values.length - 1];
  return { label: "", k: 0, time: phases, coordinates: run.coordinates.map((c, i) => ({ ...c, q: moved(end(c.q), mode.coordinates[i]) })),
    outputs: run.outputs.map((o, i) => ({ name: o.name, unit: o.unit, value: moved(end(o.value), mode.outputs[i]), rate: null, acceleration: null })),
    places: (run.places || []).map(p => ({ name: p.name, value: moved(end(p.value), p.modes[run.small.modes.indexOf(mode)]) })) };
}

/** So many times the shape of a mode that it moves the drawing by a part of its size; 0 where nothing of the drawing moves. */
function amplitude(run, mode) {
  const PART = .13;
  const still = cycle(run, mode, 0), unit = cycle(run, mode, 1);
  const names = [...new Set(drawing.flatMap(pointsOf))].filter(name => vector(still, name));
  const size = Math.max(...[0, 1].map(i => { const [low, high] = extent(names.map(name => vector(still, name)[i])); return high - low; }));
  const most = largest(names.flatMap(name => [0, 1].map(i => vector(unit, name)[i].map((x, k) => x - vector(still, name)[i][k]))));
  return most > 1e-9 * size ? PART * size / most : 0;
}

let swinging = null; // timer of all modes

/** A picture of a mode: one pose, the opposite one and the pose at rest pale; under a pointer it goes through its cycle. */
function modePicture(run, mode, number) {
  const root = svg("svg", { class: "stage", role: "img", "aria-label": `Mode ${number}` }), share = amplitude(run, mode);
  const [there, rest, back] = [cycle(run, mode, share), cycle(run, mode, 0), cycle(run, mode, share)];
  back.k = PHASES / 2;
  const poses = share ? [there, rest, back] : [rest];
  const [real, imaginary] = valueOf(mode, mode.eigenvalue);
  const pace = imaginary > 0 ? `${significant(imaginary / 2 / Math.PI, 4)} Hz` : mode.course === "indifferent" ? "no force answers" : `${real < 0 ? "decays" : "grows"} by e in ${significant(1 / Math.abs(real), 4)} s`;
  const caption = el("figcaption", {}, el("b", { textContent: `Mode ${number}` }), ` ${pace}, ${mode.course}${share ? "" : ": nothing of the drawing moves"}`);
  const picture = el("figure", { className: "mode" }, root, caption);
  const stage = createStage(root, { runs: () => poses, at: pose => pose.k, shows: what => what === "trace", least: width => Math.min(260, width * .7), axes: false });
  /** One phase on, or back to the first. */
  const swing = on => { there.k = on ? (there.k + 1) % PHASES : 0; if (!picture.hidden) stage.frame(); };
  let timer = null;
  picture.addEventListener("pointerenter", () => { timer = swinging ? null : timer || setInterval(() => swing(true), 60); });
  picture.addEventListener("pointerleave", () => { if (timer) { clearInterval(timer); timer = null; swing(false); } });
  return [picture, stage, swing];
}

const MOST_SWINGING = 8; // modes that swing together

/** Eigenvalues and modes of the run on show. */
function createSmall(host) {
  if (!runs.some(run => run.small)) return;
  let made = [];
  const toggle = el("button", { type: "button", id: "swing" });
  const swing = on => {
    clearInterval(swinging);
    swinging = on ? setInterval(() => { for (const [, , swing] of made) swing(true); }, 60) : null;
    if (!on) for (const [, , swing] of made) swing(false);
    toggle.textContent = on ? "Stop the modes" : "Swing the modes";
    toggle.setAttribute("aria-pressed", String(on));
  };
  toggle.addEventListener("click", () => swing(!swinging));
  views.push({
    layout() {
      const run = runs[state.primary], { small } = run;
      if (!small) return host.replaceChildren();
      const left = el("div"), pictures = el("div", { className: "modes" });
      const about = small.frozen ? "About a state that moves: eigenvalues of one moment, which do not decide about stability."
        : "About the position of rest. Where the plane is shaded motions die out. Beside each mode the opposite pose and the rest, pale.";
      made = drawing.length ? small.modes.map((mode, i) => modePicture(run, mode, i + 1)) : [];
      pictures.append(...made.map(([picture]) => picture));
      host.replaceChildren(...(made.length ? [toggle, pictures] : []), el("p", { className: "hint", textContent: about }), el("div", { className: "small" }, left, eigenvalues(small)));
      if (small.eigenvalues.length) left.append(plane(small, Math.max(left.clientWidth, 200)));
      const draw = () => { for (const [picture, stage] of made) if (!picture.hidden) { stage.layout(); stage.frame(); } };
      fold(made.map(([picture]) => picture), "modes", button => { pictures.after(button); button.addEventListener("click", draw); });
      draw();
      swing(Boolean(made.length) && made.length <= MOST_SWINGING && !matchMedia("(prefers-reduced-motion: reduce)").matches);
    },
    frame() {},
  });
}
