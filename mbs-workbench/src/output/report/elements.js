// ---------------------------------------------------------------- elements, numbers

const byId = id => document.getElementById(id);

/** An element with properties and children; strings become text nodes, so that no text of the data is ever markup. */
function el(tag, properties = {}, ...children) {
  const node = Object.assign(document.createElement(tag), properties);
  node.append(...children);
  return node;
}

function svg(tag, attributes = {}, ...children) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
const finite = x => typeof x === "number" && Number.isFinite(x); // JSON spells what is not finite as null

/** [smallest, largest] of the finite numbers in some arrays, without spreading them over the stack. */
function extent(arrays) {
  let low = Infinity, high = -Infinity;
  for (const array of arrays) for (const x of array || []) if (finite(x)) {
    if (x < low) low = x;
    if (x > high) high = x;
  }
  return low <= high ? [low, high] : [0, 0];
}

const largest = arrays => { const [low, high] = extent(arrays); return Math.max(-low, high); };

const superscript = n => String(n).replace(/./g, c => c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c]);
const minus = text => text.replace("-", "−");

/** Part of the largest value of its kind below which a value is what rounding leaves of 0. */
const NOISE = 1e-12;

/** A formatter with as many decimals as a quantity up to `max` needs: digits do not dance while it changes. */
function formatter(max, digits = 5) {
  if (max > 0 && (max < 1e-3 || max >= 1e6)) return x => {
    if (!finite(x)) return "–";
    if (Math.abs(x) < NOISE * max) return "0";
    const [mantissa, exponent] = x.toExponential(digits - 2).split("e");
    return `${minus(mantissa)}×10${superscript(Number(exponent))}`;
  };
  const decimals = clamp(digits - 1 - Math.floor(Math.log10(max || 1)), 0, 7);
  return x => {
    if (!finite(x)) return "–";
    const text = x.toFixed(decimals);
    return Number(text) === 0 ? text.replace("-", "") : minus(text);
  };
}

/** Pixels that the widest of some labels of an axis takes. */
const widest = texts => 6.7 * texts.reduce((most, text) => Math.max(most, text.length), 0);

/** 1, 2 or 5 times a power of ten, at least `x`. */
function niceStep(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  return power * ([1, 2, 5].find(m => m * power >= x * (1 - 1e-9)) || 10);
}

/** Ticks of a linear axis about `step` apart; very large or small numbers share a power of ten, named in `factor`. */
function linearTicks(low, high, step) {
  step = niceStep(step);
  const magnitude = Math.floor(Math.log10(Math.max(Math.abs(low), Math.abs(high))) + 1e-9);
  const exponent = magnitude >= 4 || magnitude < -2 ? 3 * Math.floor(magnitude / 3) : 0;
  const decimals = clamp(exponent - Math.floor(Math.log10(step) + 1e-9), 0, 9);
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) {
    ticks.push([i * step, minus((i * step / 10 ** exponent).toFixed(decimals))]);
  }
  return { ticks, factor: exponent ? `10${superscript(exponent)} ` : "" };
}

/** A unit in one spelling, as `m/s²` and `N·m`. */
const unitText = unit => (unit || "1").replace(/\((\w+\/\w+)\)\/s/, "$1/s").replace(/\*/g, "·").replace(/\^(-?\d+)/g, (_, n) => n.replace(/./g, c => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] || "⁻"))
  .replace(/\/s\/s$/, "/s²").replace(/\/s²\/s$/, "/s³");

/** Units of a sentence in that spelling; what is no unit stays. */
const unitsIn = text => text.replace(/(^|[\d∞. ])((?:kg|m|s|A|K|mol|cd|rad|N|J|W|Pa|Hz|V|C|F|H|T)(?:[*\/^](?:\d|-\d|kg|mol|rad|Pa|Hz|[msAKNJWVCFHT]))+)(?![\w(])/g,
  (_, before, unit) => before + unitText(unit));

/** The unit of the first or second derivative. */
function derived(unit, order) {
  const base = unitText(unit);
  if (order === 0) return base;
  const [, rest, power] = /^(.*?)(?:\/s([²³]?))?$/.exec(base);
  const before = base.includes("/s") ? { "": 1, "²": 2, "³": 3 }[power || ""] : 0;
  return `${rest}/s${["", "", "²", "³", "⁴", "⁵"][before + order]}`;
}

/** `true` of angles and their rates. */
const isAngle = unit => /^rad(\/s[²³]?)?$/.test(unitText(unit));

/** Beyond so many lines a list shows only its first ones, and the others where asked. */
const MANY = 24, FIRST = 8;

/** Hides all but the first of many `nodes` behind a button that `place` puts somewhere; `shown` is told whether all are there. */
function fold(nodes, noun, place, shown = () => {}) {
  if (nodes.length <= MANY) return;
  const button = el("button", { type: "button", className: "more" });
  const show = open => {
    nodes.slice(FIRST).forEach(node => { node.hidden = !open; });
    button.textContent = open ? `only the first ${FIRST} ${noun}` : `all ${nodes.length} ${noun}`;
    button.setAttribute("aria-expanded", String(open));
    shown(open);
  };
  button.addEventListener("click", () => show(button.getAttribute("aria-expanded") !== "true"));
  show(false);
  place(button);
}
