"use strict";
const byId = (id) => document.getElementById(id);
const make = (name, attributes, parent) => {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (parent) parent.append(element);
  return element;
};
const short = (value) => value === null || value === undefined ? "∞" : String(Number(value.toPrecision(4)));
const DEGREE = 180 / Math.PI;
byId("title").textContent = DATA.title;
byId("sentence").textContent = DATA.sentence;
/* A word of the command is broken where it does not fit alone. */
DATA.command.split(" ").forEach((word) => {
  const part = document.createElement("span");
  part.textContent = word;
  byId("command").append(part, " ");
});

/* Quantities with the factor from SI to what is shown. */
const [lift, per] = DATA.by_angle ? [DEGREE, "°"] : [1000, "mm"];
const UNIT = {
  undercut: [1000, "mm"], "radius of curvature": [1000, "mm"], "grinding wheel": [1000, "mm"], "pressure angle": [DEGREE, "°"],
  "Hertz pressure": [1e-6, "MPa"], "half face width": [1000, "mm"], "outer radius": [1000, "mm"], shaft: [1000, "mm"],
};
/* A pair has two cams on one shaft, with names and colours of their own. */
const CAMS = DATA.cams, isPair = CAMS.length > 1;
const every = (name) => CAMS.map((cam) => cam[name]);
const CHARTS = [
  ["Lift", per, [DATA.lift[0]], lift], ["Velocity", `${per}/rad`, [DATA.lift[1]], lift],
  ["Acceleration", `${per}/rad²`, [DATA.lift[2]], lift], ["Jerk", `${per}/rad³`, [DATA.lift[3]], lift],
  ["Curvature of the contour", "1/mm", every("curvature"), 1e-3, ["undercut", "radius of curvature", "grinding wheel"]],
  ["d²r/dϑ² of the polar contour", "mm/rad²", every("d2r"), 1000],
  ["Pressure angle", "°", every("pressure"), DEGREE, ["pressure angle"]], ["Sliding velocity", "mm/rad", every("sliding"), 1000],
];
if (CAMS[0].hertz) CHARTS.push(["Hertz pressure", "MPa", every("hertz"), 1e-6, ["Hertz pressure"]]);
const degrees = DATA.theta.map((angle) => angle * DEGREE);
const cursors = [];

const ticks = (low, high, count) => {
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((k) => k * power).find((step) => step >= raw);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(Number((k * step).toPrecision(12)));
  return found;
};
for (const [name, unit, series, factor, limits = []] of CHARTS) {
  const panel = document.createElement("section");
  panel.className = "panel";
  panel.innerHTML = "<h2></h2>";
  panel.firstChild.textContent = `${name} (${unit})`;
  if (series.length > 1) CAMS.forEach((cam, k) => {
    const key = document.createElement("span");
    key.className = `key cam${k}`; key.textContent = cam.name;
    panel.firstChild.append(key);
  });
  byId("charts").append(panel);
  const [width, height] = innerWidth < 600 ? [340, 210] : [640, 240];
  const [left, right, top, bottom] = [62, 16, 10, 26];
  const svg = make("svg", { viewBox: `0 0 ${width} ${height}`, role: "img" }, panel);
  make("title", {}, svg).textContent = `${name} over the cam angle`;
  const numbers = series.map((values) => values.map((value) => value === null ? NaN : value * factor));
  /* A cusp has no finite curvature: the axis leaves out the highest fiftieth. */
  const sorted = numbers.flat().filter(Number.isFinite).sort((a, b) => a - b);
  const cut = CAMS.every((cam) => cam.verdicts[0].kept) ? 0 : limits.includes("undercut") || limits.includes("Hertz pressure") || series[0] === CAMS[0].d2r ? Math.floor(sorted.length / 50) : 0;
  let [low, high] = [sorted[cut] ?? 0, sorted[sorted.length - 1 - cut] ?? 1];
  /* A range of rounding is none. */
  if (high - low < 1e-9 * Math.max(Math.abs(high), 1)) [low, high] = [Math.min(low, 0) - 0.5, Math.max(high, 0) + 0.5];
  const pad = 0.06 * (high - low); low -= pad; high += pad;
  const [from, to] = [degrees[0], degrees[0] + 360];
  const x = (angle) => left + (angle - from) / (to - from) * (width - left - right);
  const y = (value) => height - bottom - (Math.min(Math.max(value, low), high) - low) / (high - low) * (height - top - bottom);
  const apart = width < 500 ? 90 : 60;
  for (let angle = Math.ceil(from / apart) * apart; angle <= to; angle += apart) {
    make("path", { class: "grid", d: `M${x(angle)} ${top}V${height - bottom}` }, svg);
    make("text", { x: x(angle), y: height - 9, "text-anchor": x(angle) > width - 28 ? "end" : "middle" }, svg).textContent = `${angle}°`;
  }
  for (const value of ticks(low, high, 5)) {
    make("path", { class: value === 0 ? "zero" : "grid", d: `M${left} ${y(value)}H${width - right}` }, svg);
    make("text", { x: left - 6, y: y(value) + 4, "text-anchor": "end" }, svg).textContent = short(value);
  }
  numbers.forEach((values, which) => {
    let path = "", pen = "M";
    values.forEach((value, k) => {
      if (!Number.isFinite(value)) { pen = "M"; return; }
      path += `${pen}${x(degrees[k]).toFixed(1)} ${y(value).toFixed(2)}`; pen = "L";
    });
    make("path", { class: `curve cam${which}`, d: path }, svg);
  });
  const verdicts = CAMS.flatMap((cam) => cam.verdicts.map((one) => ({ ...one, of: cam.name })));
  verdicts.filter((one) => limits.includes(one.name) && !one.kept).forEach((one, row) => {
    const at = x(one.angle * DEGREE);
    make("path", { class: "bad", d: `M${at} ${top}V${height - bottom}` }, svg);
    const name = `${isPair ? `${one.of}: ` : ""}${one.name} ${(one.angle * DEGREE).toFixed(1)}°`;
    /* On the side with more room, within the picture. */
    const long = 6.6 * name.length, isLate = at > width / 2;
    const from = Math.max(isLate ? at - 5 - long : Math.min(at + 5, width - right - long), left + 2);
    const word = make("text", { class: "word", x: from, y: top + 12 + 14 * row }, svg);
    word.textContent = name;
  });
  const line = make("path", { class: "cursor" }, svg);
  cursors.push((k) => line.setAttribute("d", `M${x(degrees[k])} ${top}V${height - bottom}`));
}

const table = byId("limits");
const row = (cells, tag, into = table) => {
  const line = into.insertRow();
  cells.forEach((cell) => { const made = document.createElement(tag); made.textContent = cell; line.append(made); });
  return line;
};
for (const cam of CAMS) {
  row([isPair ? `${cam.name}: limit` : "limit", "bound", "value", "at", ""], "th");
  for (const one of cam.verdicts) {
    const [factor, unit] = UNIT[one.name];
    const bound = `${one.least ? "≥" : "≤"} ${short(one.bound * factor)}${unit === "°" ? "" : " "}${unit}`;
    const value = one.value === null ? (one.name === "grinding wheel" ? "convex" : "∞") : `${short(one.value * factor)}${unit === "°" ? "" : " "}${unit}`;
    const line = row([one.name, bound, value, one.value === null && one.kept ? "" : `${(one.angle * DEGREE).toFixed(1)}°`, one.kept ? "kept" : "broken"], "td");
    if (!one.kept) line.lastChild.className = "broken";
  }
}

/* The profile to scale, in millimetres, y upwards. */
const mm = (list) => list.map((value) => value * 1000);
const BODIES = CAMS.map((cam) => ({
  contour: cam.contour.map(mm), centre: cam.centre.map(mm), contact: cam.contact.map(mm), normal: cam.normal,
  valve: cam.valve && cam.valve.map(mm), pivot: cam.pivot && mm(cam.pivot), opens: cam.opens,
  pad: (cam.pad ?? 0) * 1000, face: (cam.face ?? 0) * 1000, base: cam.base * 1000,
}));
const reach = Math.max(...BODIES.flatMap(({ contour: [x, y] }) => x.map((value, k) => Math.hypot(value, y[k]))));
const HALF_VALVE = 5, RIM = 1.5;
const span = (axis) => {
  const found = [-reach, reach];
  for (const { centre, pad, face, pivot, valve } of BODIES) {
    const more = axis === 0 ? Math.max(pad, face) : pad;
    centre[axis].forEach((value) => found.push(value - more, value + more));
    if (pivot) found.push(pivot[axis] - 3, pivot[axis] + 3);
    if (valve) valve[axis].forEach((value) => found.push(value - HALF_VALVE, value + HALF_VALVE));
  }
  return [Math.min(...found), Math.max(...found)];
};
const [x0, x1] = span(0);
let [y0, y1] = span(1);
if (!BODIES[0].pivot) y1 += 0.7 * reach;
const edge = 0.06 * (x1 - x0);
const svg = make("svg", { viewBox: `${x0 - edge} ${-y1 - edge} ${x1 - x0 + 2 * edge} ${y1 - y0 + 2 * edge}`, role: "img" }, byId("profile"));
make("title", {}, svg).textContent = "the cam with its follower";
const circle = (x, y, r) => `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`;
const turned = make("g", {}, svg);
BODIES.forEach(({ contour: [cx, cy], base }, k) => {
  make("path", { class: `cam cam${k}${isPair ? " seen" : ""}`, d: `M${cx.map((x, k) => `${x.toFixed(4)} ${(-cy[k]).toFixed(4)}`).join("L")}Z` }, turned);
  make("circle", { class: "base", r: base }, turned);
});
make("path", { class: "part", d: `M${-reach * 0.06} 0H${reach * 0.06}M0 ${-reach * 0.06}V${reach * 0.06}` }, svg);
const drawn = BODIES.map((body) => {
  const { centre: [fx, fy], pivot, pad, face, valve, opens } = body;
  const follower = make("path", { class: "part" }, svg), dot = make("circle", { class: "dot", r: reach * 0.025 }, svg);
  return (k) => {
    const contact = body.contact.map((list) => list[k]), [nx, ny] = body.normal.map((list) => list[k]);
    let path = "";
    if (pad) {
      path += circle(fx[k], -fy[k], pad);
      path += pivot ? `M${pivot[0]} ${-pivot[1]}L${fx[k]} ${-fy[k]}` : `M${fx[k]} ${-fy[k]}V${-y1}`;
    } else {
      /* The face about the foot of the perpendicular from the cam's centre. */
      const p = contact[0] * nx + contact[1] * ny, foot = [p * nx, p * ny];
      path += `M${foot[0] + face * ny} ${-(foot[1] - face * nx)}L${foot[0] - face * ny} ${-(foot[1] + face * nx)}`;
      const away = pivot ? p - pivot[0] * nx - pivot[1] * ny : 0;
      path += pivot ? `M${pivot[0]} ${-pivot[1]}L${pivot[0] + away * nx} ${-(pivot[1] + away * ny)}L${foot[0]} ${-foot[1]}` : `M0 ${-foot[1]}V${-y1}`;
    }
    if (pivot) path += circle(pivot[0], -pivot[1], RIM);
    if (valve) {
      /* The pad's rim is drawn small: its radius moves nothing. An opener lies on the valve's end, a closer under it. */
      const [x, y] = valve.map((list) => list[k]), end = -y + (opens ? RIM : -RIM), middle = valve[0][0];
      path += `M${pivot[0]} ${-pivot[1]}L${x} ${-y}${circle(x, -y, RIM)}M${middle - HALF_VALVE} ${end}h${2 * HALF_VALVE}`;
    }
    follower.setAttribute("d", path);
    dot.setAttribute("cx", contact[0]); dot.setAttribute("cy", -contact[1]);
  };
});
const show = (k) => {
  turned.setAttribute("transform", `rotate(${-DATA.sense * degrees[k]})`);
  drawn.forEach((set) => set(k));
  byId("at").textContent = `${degrees[k].toFixed(1)}°`;
  cursors.forEach((set) => set(k));
};
const slider = byId("angle"), play = byId("play");
slider.max = DATA.theta.length - 1;
let running = false, begun = 0, first = 0;
const frame = (time) => {
  if (!running) return;
  slider.value = Math.round(first + (time - begun) * 0.12) % DATA.theta.length;
  show(Number(slider.value));
  requestAnimationFrame(frame);
};
play.onclick = () => {
  running = !running; play.textContent = running ? "pause" : "play";
  begun = performance.now(); first = Number(slider.value);
  if (running) requestAnimationFrame(frame);
};
slider.oninput = () => { running = false; play.textContent = "play"; show(Number(slider.value)); };
/* The page opens at the largest lift of the flank. */
slider.value = DATA.lift[1].indexOf(Math.max(...DATA.lift[1]));
show(Number(slider.value));

/* Noise of the acceleration of a table of the lift, in double logarithmic scale. */
if (DATA.noise) {
  const N = DATA.noise, unit = `${per}/rad²`;
  const panel = document.createElement("section");
  panel.className = "panel wide";
  panel.innerHTML = "<h2></h2><p></p><div class='pair'><div></div><div class='scroll'><table></table></div></div>";
  panel.children[0].textContent = `Noise of the acceleration of a table of the lift (${unit})`;
  panel.children[1].textContent = `Uniform noise with a width of ${short(N.width * lift)} ${per} in the lift, root mean square over 8 seeds. A cubic spline through all points has √3 q N²/(2π)²; quintic fits with fewer knots keep most of it out.`;
  byId("charts").append(panel);
  const lines = [["through all", N.through, "line0"], ["√3 q N²/(2π)²", N.expected, "line0 dashed"]];
  N.knots.forEach((knots, k) => lines.push([`${knots} knots`, N.fitted[k], `line${k + 1}`]));
  const [width, height, left, right, top, bottom] = [560, 300, 62, 92, 12, 34];
  const holder = panel.children[2];
  const drawing = make("svg", { viewBox: `0 0 ${width} ${height}`, role: "img" }, holder.children[0]);
  make("title", {}, drawing).textContent = "noise of the acceleration over the number of points";
  const known = lines.flatMap(([, values]) => values).filter((value) => value > 0).map((value) => Math.log10(value * lift));
  const [low, high] = [Math.floor(Math.min(...known)), Math.ceil(Math.max(...known))];
  const first = Math.log2(N.points[0]), last = Math.log2(N.points[N.points.length - 1]);
  const x = (points) => left + (Math.log2(points) - first) / (last - first) * (width - left - right);
  const y = (value) => height - bottom - (Math.log10(value * lift) - low) / (high - low) * (height - top - bottom);
  for (const points of N.points) {
    make("path", { class: "grid", d: `M${x(points)} ${top}V${height - bottom}` }, drawing);
    make("text", { x: x(points), y: height - bottom + 16, "text-anchor": "middle" }, drawing).textContent = points;
  }
  make("text", { x: (left + width - right) / 2, y: height - 3, "text-anchor": "middle" }, drawing).textContent = "points a turn";
  for (let power = low; power <= high; power++) {
    const at = y(10 ** power / lift);
    make("path", { class: "grid", d: `M${left} ${at}H${width - right}` }, drawing);
    make("text", { x: left - 6, y: at + 4, "text-anchor": "end" }, drawing).textContent = short(10 ** power);
  }
  let free = Infinity;
  const ends = lines.map(([name, values, style]) => [name, values[values.length - 1], style]).filter(([name]) => !name.startsWith("√"));
  for (const [, values, style] of lines) {
    const known = N.points.map((points, k) => [points, values[k]]).filter(([, value]) => value > 0);
    make("path", { class: `noise ${style}`, d: `M${known.map(([points, value]) => `${x(points).toFixed(1)} ${y(value).toFixed(1)}`).join("L")}` }, drawing);
    if (!style.includes("dashed")) known.forEach(([points, value]) => make("circle", { class: `noise ${style} spot`, cx: x(points), cy: y(value), r: 3 }, drawing));
  }
  /* Names at the ends, the lowest first, one line apart. */
  ends.sort((a, b) => a[1] - b[1]).forEach(([name, value]) => {
    free = Math.min(free - 13, y(value) + 4);
    make("text", { x: width - right + 8, y: free }, drawing).textContent = name;
  });
  const noiseTable = holder.children[1].firstChild;
  row(["points", ...lines.map(([name]) => name)], "th", noiseTable);
  N.points.forEach((points, k) => row([points, ...lines.map(([, values]) => values[k] === null ? "" : short(values[k] * lift))], "td", noiseTable));
}
