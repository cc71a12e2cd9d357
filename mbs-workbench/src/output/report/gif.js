// ---------------------------------------------------------------- animated GIF

const COLOURS_OF_GIF = 255; // the last one of 256 is transparent
const bin = (r, g, b) => (r >> 3) << 10 | (g >> 3) << 5 | b >> 3;

/** The most frequent colours of some pictures (RGBA bytes), each the mean of a cube of 8³, with the map from cubes to them. */
function paletteOf(pictures) {
  const sums = new Float64Array(4 << 15);
  for (const bytes of pictures) for (let i = 0; i < bytes.length; i += 4) {
    const at = 4 * bin(bytes[i], bytes[i + 1], bytes[i + 2]);
    for (let channel = 0; channel < 3; channel++) sums[at + channel] += bytes[i + channel];
    sums[at + 3] += 1;
  }
  const cubes = [...Array(1 << 15).keys()].filter(cube => sums[4 * cube + 3]).sort((a, b) => sums[4 * b + 3] - sums[4 * a + 3]).slice(0, COLOURS_OF_GIF);
  const colours = cubes.map(cube => [0, 1, 2].map(channel => Math.round(sums[4 * cube + channel] / sums[4 * cube + 3])));
  const known = new Int16Array(1 << 15).fill(-1);
  cubes.forEach((cube, index) => { known[cube] = index; });
  return { colours, nearest(r, g, b) {
    const cube = bin(r, g, b);
    if (known[cube] < 0) {
      let least = Infinity;
      colours.forEach(([x, y, z], index) => {
        const away = (r - x) ** 2 + (g - y) ** 2 + (b - z) ** 2;
        if (away < least) [least, known[cube]] = [away, index];
      });
    }
    return known[cube];
  } };
}

/** The code of Lempel, Ziv and Welch for bytes, in blocks of at most 255. */
function compressed(indices) {
  const CLEAR = 256, END = 257, MOST = 4096, codes = new Map(), bytes = [];
  let size = 9, next = 258, bits = 0, count = 0;
  const emit = code => {
    bits |= code << count;
    for (count += size; count >= 8; count -= 8) { bytes.push(bits & 255); bits >>>= 8; }
  };
  emit(CLEAR);
  let prefix = indices[0];
  for (let i = 1; i < indices.length; i++) {
    const key = prefix << 8 | indices[i], code = codes.get(key);
    if (code !== undefined) { prefix = code; continue; }
    emit(prefix);
    if (next === MOST) {
      emit(CLEAR);
      codes.clear();
      [size, next] = [9, 258];
    } else {
      if (next >= 1 << size) size += 1;
      codes.set(key, next++);
    }
    prefix = indices[i];
  }
  emit(prefix);
  emit(END);
  if (count) bytes.push(bits & 255);
  const blocks = [8];
  for (let at = 0; at < bytes.length; at += 255) { const part = bytes.slice(at, at + 255); blocks.push(part.length, ...part); }
  return Uint8Array.from([...blocks, 0]);
}

/** A GIF that repeats itself: `frame` adds a picture (RGBA bytes) shown for `delay` hundredths of a second. */
function createGif(width, height, palette) {
  const word = x => [x & 255, x >> 8], ascii = text => [...text].map(c => c.charCodeAt(0));
  const table = [...palette.colours, ...Array(256 - palette.colours.length).fill([0, 0, 0])].flat();
  const parts = [Uint8Array.from([...ascii("GIF89a"), ...word(width), ...word(height), 0xf7, 0, 0, ...table, 0x21, 0xff, 11, ...ascii("NETSCAPE2.0"), 3, 1, 0, 0, 0])];
  let before = null;
  return {
    frame(bytes, delay) {
      const now = new Uint8Array(width * height), changed = new Uint8Array(width * height);
      for (let i = 0; i < now.length; i++) {
        now[i] = palette.nearest(bytes[4 * i], bytes[4 * i + 1], bytes[4 * i + 2]);
        changed[i] = before && before[i] === now[i] ? COLOURS_OF_GIF : now[i];
      }
      before = now;
      parts.push(Uint8Array.from([0x21, 0xf9, 4, 5, ...word(delay), COLOURS_OF_GIF, 0, 0x2c, 0, 0, 0, 0, ...word(width), ...word(height), 0]), compressed(changed));
    },
    blob: () => new Blob([...parts, Uint8Array.of(0x3b)], { type: "image/gif" }),
  };
}
