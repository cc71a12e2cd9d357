// ---------------------------------------------------------------- files that the page writes

const FRAME_RATE = 30, SHORTEST_VIDEO = 2, LONGEST_VIDEO = 30; // frames a second, seconds
const HEADER = 1000; // bytes of a video without a picture, at most

function saveFile(name, blob) {
  const href = URL.createObjectURL(blob), link = el("a", { href, download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(href), 60_000);
}

/** A picture of the page as an SVG text that needs no page: with its styles and the colours of the moment, and a legend of [name, colour, dash]. */
function standalone(root, legend = []) {
  const copy = root.cloneNode(true), css = document.querySelector("style").textContent, now = getComputedStyle(document.documentElement);
  const names = [...new Set(css.match(/--[a-z]+\d*(?=:)/g))];
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  for (const node of copy.querySelectorAll(".dots, .chosen")) node.remove();
  const [width, tall] = root.getAttribute("viewBox").split(" ").slice(2).map(Number);
  let [x, y] = [10, tall + 14];
  for (const [name, stroke, dashes] of legend) {
    const long = 40 + widest([name]);
    if (x > 10 && x + long > width) [x, y] = [10, y + 18];
    copy.append(svg("path", { class: "curve", d: `M${x} ${y - 4}h24`, style: `stroke: ${stroke}; stroke-dasharray: ${dashes}` }), svg("text", { x: x + 29, y }, name));
    x += long;
  }
  const height = legend.length ? y + 8 : tall;
  for (const [key, value] of Object.entries({ width, height, viewBox: `0 0 ${width} ${height}` })) copy.setAttribute(key, value);
  copy.setAttribute("style", [root.getAttribute("style") || "", ...names.map(name => `${name}:${now.getPropertyValue(name).trim()}`)].join(";"));
  const rules = css.replace(/\/\*[^]*?\*\//g, "").replace(/@media[^{]*\{(?:[^{}]*\{[^}]*\})*[^}]*\}/g, "")
    .split("}").filter(rule => /svg|\[hidden\]|\.stage|\.curve|\.frame|\.zero|\.gridline|\.triad|\.end|\.decaying/.test(rule.split("{")[0])).map(rule => `${rule.trim()}}`).join("\n");
  copy.prepend(svg("style", {}, rules), svg("rect", { width: "100%", height: "100%", style: "fill: var(--paper)" }));
  return [new XMLSerializer().serializeToString(copy), width, height];
}

async function rasterised(root, scale, canvas = document.createElement("canvas"), legend = []) {
  const [text, width, height] = standalone(root, legend), image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  await image.decode();
  const size = [width * scale, height * scale].map(x => 2 * Math.ceil(x / 2)); // even, as codecs want it
  if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
  canvas.getContext("2d").drawImage(image, 0, 0, ...size);
  return canvas;
}

const saveSvg = (root, name, legend) => saveFile(`${name}.svg`, new Blob([standalone(root, legend)[0]], { type: "image/svg+xml" }));

async function savePng(root, name, legend) {
  const canvas = await rasterised(root, 2, undefined, legend);
  canvas.toBlob(blob => saveFile(`${name}.png`, blob), "image/png");
}

/** All values on the page, one line an instant: of long motions those that are shown, with seven digits. */
function csv() {
  const columns = run => {
    const found = [["t [s]", run.time]];
    const add = (name, unit, values) => { if (values && values.length) found.push([`${name} [${unitText(unit)}]`, values]); };
    for (const c of run.coordinates || []) ["q", "qd", "qdd"].forEach((key, i) => add(c.name + "'".repeat(i), derived(c.unit, i), c[key]));
    for (const o of run.outputs || []) ["value", "rate", "acceleration"].forEach((key, i) => add(o.name + "'".repeat(i), derived(o.unit, i), o[key]));
    for (const o of run.mismatches || []) ["value", "rate", "acceleration"].forEach((key, i) => add(`mismatch ${o.name}${"'".repeat(i)}`, derived(o.unit, i), o[key]));
    for (const load of entriesOf(run, "loads")) add(load.name, load.unit, load.value);
    for (const row of entriesOf(run, "multipliers")) add(`lambda ${row.name}`, row.unit, row.value);
    for (const key of ["kinetic", "potential", "work"]) add(`${key} energy`.replace("work energy", "work"), "J", forcesOf(run)[key]);
    for (const supply of forcesOf(run).supplies || []) { add(`power of ${titleOf(supply)}`, "W", supply.power); add(`work of ${titleOf(supply)}`, "J", supply.work); }
    return found;
  };
  const cell = text => /[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text;
  const names = [...new Set(runs.flatMap(run => columns(run).map(([name]) => name)))];
  const lines = [["run", ...names].map(cell).join(",")];
  for (const run of runs) {
    const known = new Map(columns(run));
    run.time.forEach((_, k) => lines.push([cell(run.label), ...names.map(name => { const x = (known.get(name) || [])[k]; return finite(x) ? x : ""; })].join(",")));
  }
  return `${lines.join("\n")}\n`;
}

let recording = null;
/** One pass of the drawing at the chosen speed as a video. */
async function saveVideo(root, name, button) {
  if (recording) { recording.ended = true; return; }
  const type = ["video/webm;codecs=vp8", "video/webm", "video/mp4"].find(type => window.MediaRecorder && MediaRecorder.isTypeSupported(type));
  if (!type) { button.textContent = "no video here"; return; }
  const before = state.t, label = button.textContent, chunks = [];
  let written = 0;
  recording = { ended: false };
  play(false);
  setTime(start);
  const canvas = await rasterised(root, 2), recorder = new MediaRecorder(canvas.captureStream(FRAME_RATE), { mimeType: type, videoBitsPerSecond: 8e6 });
  const done = new Promise(resolve => { recorder.onstop = resolve; });
  recorder.ondataavailable = event => { chunks.push(event.data); written += event.data.size; };
  recorder.start(500);
  const begin = performance.now(), length = clamp((end - start) / state.speed, SHORTEST_VIDEO, LONGEST_VIDEO), pace = Math.min(state.speed, (end - start) / length);
  // An encoder that begins late gets its last picture until it has written one.
  for (let now = 0; (now < length || (written < HEADER && now < length + LONGEST_VIDEO)) && !recording.ended; now = (performance.now() - begin) / 1000) {
    setTime(start + Math.min(now, length) * pace);
    button.textContent = `Stop (${Math.min(100, Math.round(100 * now / length))} %)`;
    await rasterised(root, 2, canvas);
    await new Promise(requestAnimationFrame);
  }
  recorder.stop();
  await done;
  saveFile(`${name}.${type.includes("mp4") ? "mp4" : "webm"}`, new Blob(chunks, { type }));
  recording = null;
  button.textContent = label;
  setTime(before);
}

const DELAY = 4, LONGEST_GIF = 12, SAMPLED = 6; // hundredths of a second a picture, seconds, pictures that colours are taken from

/** One pass of the drawing as a GIF, picture by picture: no instant is lost, however slow the machine is. */
async function saveGif(root, name, button) {
  if (recording) { recording.ended = true; return; }
  const before = state.t, label = button.textContent;
  recording = { ended: false };
  play(false);
  const length = clamp((end - start) / state.speed, SHORTEST_VIDEO, LONGEST_GIF), count = Math.round(100 * length / DELAY);
  const canvas = document.createElement("canvas"), context = canvas.getContext("2d", { willReadFrequently: true });
  const picture = async share => {
    setTime(start + share * (end - start));
    await rasterised(root, 1, canvas);
    return context.getImageData(0, 0, canvas.width, canvas.height).data;
  };
  const sampled = [];
  for (let k = 0; k < SAMPLED; k++) sampled.push(await picture(k / SAMPLED));
  const gif = createGif(canvas.width, canvas.height, paletteOf(sampled));
  for (let k = 0; k < count && !recording.ended; k++) {
    gif.frame(await picture(k / count), DELAY);
    button.textContent = `Stop (${Math.round(100 * (k + 1) / count)} %)`;
    await new Promise(requestAnimationFrame);
  }
  saveFile(`${name}.gif`, gif.blob());
  recording = null;
  button.textContent = label;
  setTime(before);
}

/** Buttons that save a plot with its legend as SVG and PNG. */
function saveButtons(root, nameOf, legendOf) {
  const button = (text, act) => {
    const made = el("button", { type: "button", textContent: text, title: `Save as ${text}` });
    made.addEventListener("click", () => act(root, nameOf(), legendOf()));
    return made;
  };
  return el("span", { className: "save" }, button("SVG", saveSvg), button("PNG", savePng));
}

/** Buttons that save the drawing, its motion and the values. */
function createSave() {
  const host = byId("save"), stage = byId("stage"), name = (data.name || "motion").replace(/[^\w.-]+/g, "_");
  const button = (text, title, act) => {
    const made = el("button", { type: "button", textContent: text, title, id: `save-${text.toLowerCase()}` });
    made.addEventListener("click", () => act(made));
    host.append(made);
  };
  button("SVG", "Save the drawing as SVG", () => saveSvg(stage, name));
  button("PNG", "Save the drawing as PNG", () => savePng(stage, name));
  if (moves) button("GIF", "Save one pass as an animated GIF", made => saveGif(stage, name, made));
  if (moves) button("WebM", "Save one pass at the chosen speed as a video", made => saveVideo(stage, name, made));
  button("CSV", "Save the values on this page", () => saveFile(`${name}.csv`, new Blob([csv()], { type: "text/csv" })));
}
