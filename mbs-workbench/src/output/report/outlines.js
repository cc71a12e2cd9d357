// ---------------------------------------------------------------- outlines in pixels

const RING = 3.4; // modules from the pitch circle of a ring gear to its outer edge

const circlePath = r => `M${r} 0A${r} ${r} 0 1 1 ${-r} 0A${r} ${r} 0 1 1 ${r} 0Z`;
const polar = (r, a) => `${(r * Math.cos(a)).toFixed(2)} ${(r * Math.sin(a)).toFixed(2)}`;

/** Outline of a gear in pixels with a tooth (a gap, where the teeth point inwards) at the angle 0: straight flanks. */
function teeth(radius, count, m, inside) {
  const pitch = 2 * Math.PI / count;
  // At the mark and beside it: how far from the pitch circle, in modules, and half the width there, in pitches.
  const [mark, beside] = inside ? [[1.25, .18], [-1, .32]] : [[1, .13], [-1.25, .33]];
  const corners = [[beside, -1], [mark, -1], [mark, 1], [beside, 1]];
  const points = [...Array(count).keys()].flatMap(i => corners.map(([[away, half], side]) => polar(radius + away * m, (i + side * half) * pitch)));
  return `M${points.join("L")}Z`;
}

/**
 * Outline of a Geneva wheel in pixels, the middle of a locking arc at the angle 0. `d`: between the centres, `r1`: of the
 * pin's circle, `r2`: of the wheel, `w`: half a slot's width, `lock`: radius of the locking disc.
 */
function maltese(d, r1, r2, slots, w, lock) {
  const step = Math.PI / slots, arc = Math.acos(clamp((d * d + r2 * r2 - lock * lock) / (2 * d * r2), -1, 1)), edge = Math.asin(w / r2);
  const bottom = d - r1;
  let path = "";
  for (let i = 0; i < slots; i++) {
    const a = 2 * step * i, s = a + step, inner = [Math.hypot(bottom, w), Math.atan2(w, bottom)];
    path += `${i ? "L" : "M"}${polar(r2, a - arc)}A${lock} ${lock} 0 0 0 ${polar(r2, a + arc)}A${r2} ${r2} 0 0 1 ${polar(r2, s - edge)}`
      + `L${polar(inner[0], s - inner[1])}A${w} ${w} 0 0 0 ${polar(inner[0], s + inner[1])}L${polar(r2, s + edge)}A${r2} ${r2} 0 0 1 ${polar(r2, s + step - arc)}`;
  }
  return `${path}Z`;
}

/** The driver's disc in pixels: cut out towards the pin (angle 0) as the wheel's arms need it. */
function lockingDisc(d, r2, lock) {
  const cut = r2 * 1.04, a = Math.acos(clamp((d * d + lock * lock - cut * cut) / (2 * d * lock), -1, 1));
  return `M${polar(lock, a)}A${lock} ${lock} 0 1 1 ${polar(lock, -a)}A${cut} ${cut} 0 0 0 ${polar(lock, a)}Z`;
}

/** From a point to a segment. */
function distance([x, y], [ax, ay], [bx, by]) {
  const [dx, dy] = [bx - ax, by - ay];
  const s = clamp(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1), 0, 1);
  return Math.hypot(x - ax - s * dx, y - ay - s * dy);
}
