'use strict';

// From the text of viewer/pack.h to points. The page inflates by itself instead of through the
// browser's DecompressionStream: that one is younger and answers later, and this one takes a few
// milliseconds a minute of motion.

function unbase64(text) {
  const letters = atob(text), bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i++) bytes[i] = letters.charCodeAt(i);
  return bytes;
}

// Bits of a byte array, the lowest of a byte first.
class Bits {
  constructor(bytes, at) {
    Object.assign(this, {bytes, at, hold: 0, count: 0});
  }

  peek(n) {
    while (this.count < n) {
      if (this.at > this.bytes.length + 4) throw new Error('the motion in this page is cut off');
      this.hold |= (this.bytes[this.at++] || 0) << this.count;
      this.count += 8;
    }
    return this.hold & (1 << n) - 1;
  }

  drop(n) {
    this.hold >>>= n;
    this.count -= n;
  }

  take(n) {
    const value = this.peek(n);
    this.drop(n);
    return value;
  }
}

// A canonical Huffman code as one table over its longest code word: value << 4 | bits.
function codeTable(lengths) {
  const longest = Math.max(1, ...lengths), table = new Uint16Array(1 << longest);
  let code = 0;
  for (let bits = 1; bits <= longest; bits++, code <<= 1) {
    for (let value = 0; value < lengths.length; value++) {
      if (lengths[value] !== bits) continue;
      let start = 0;  // code words arrive with their first bit lowest
      for (let i = 0; i < bits; i++) start |= (code >> i & 1) << bits - 1 - i;
      for (let i = start; i < table.length; i += 1 << bits) table[i] = value << 4 | bits;
      code++;
    }
  }
  return {table, longest};
}

function symbol(bits, {table, longest}) {
  const entry = table[bits.peek(longest)];
  if (!entry) throw new Error('the motion in this page is damaged');
  bits.drop(entry & 15);
  return entry >> 4;
}

const LENGTH_ORDER = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];

function blockCodes(bits, kind) {
  if (kind === 1) {
    const fixed = (i) => i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8;
    return [codeTable(Array.from({length: 288}, (_, i) => fixed(i))), codeTable(Array(30).fill(5))];
  }
  const literals = bits.take(5) + 257, distances = bits.take(5) + 1, count = bits.take(4) + 4;
  const first = Array(19).fill(0), lengths = [];
  for (let i = 0; i < count; i++) first[LENGTH_ORDER[i]] = bits.take(3);
  const code = codeTable(first);
  while (lengths.length < literals + distances) {
    const value = symbol(bits, code);
    if (value < 16) lengths.push(value);
    const [extra, least] = {16: [2, 3], 17: [3, 3], 18: [7, 11]}[value] || [0, 0];
    const repeated = value === 16 ? lengths[lengths.length - 1] : 0;
    for (let i = value < 16 ? 0 : bits.take(extra) + least; i > 0; i--) lengths.push(repeated);
  }
  return [codeTable(lengths.slice(0, literals)), codeTable(lengths.slice(literals))];
}

// How far a copy reaches for its code: the least value and the bits that follow (RFC 1951, 3.2.5).
function reach(code, perStep) {
  const extra = Math.max(0, (code >> perStep) - 1);
  return [code < 2 << perStep ? code : (1 << perStep | code & (1 << perStep) - 1) << extra, extra];
}

// RFC 1950 and 1951; `size` bytes come out.
function inflate(bytes, size) {
  const out = new Uint8Array(size), bits = new Bits(bytes, 2);
  let to = 0;
  for (let last = 0; !last;) {
    last = bits.take(1);
    const kind = bits.take(2);
    if (kind === 0) {
      bits.drop(bits.count & 7);
      const length = bits.take(16);
      bits.take(16);
      for (let i = 0; i < length; i++) out[to++] = bits.take(8);
      continue;
    }
    const [literals, distances] = blockCodes(bits, kind);
    for (let value = symbol(bits, literals); value !== 256; value = symbol(bits, literals)) {
      if (value < 256) {
        out[to++] = value;
        continue;
      }
      const [least, extra] = value === 285 ? [255, 0] : reach(value - 257, 2);
      const length = least + 3 + bits.take(extra);
      const [near, more] = reach(symbol(bits, distances), 1);
      const from = to - near - 1 - bits.take(more);
      for (let i = 0; i < length; i++) out[to++] = out[from + i];
    }
  }
  if (to !== size) throw new Error('the motion in this page is not whole');
  return out;
}

// (frames, channels) 16-bit numbers.
function unpackPoints(text, frames, channels) {
  const count = frames * channels, bytes = inflate(unbase64(text), 2 * count);
  const points = new Int16Array(count);
  for (let c = 0, at = 0; c < channels; c++) {
    for (let f = 0, one = 0, two = 0; f < frames; f++, at++) {
      const folded = bytes[at] | bytes[count + at] << 8;
      const guess = f > 1 ? 2 * one - two : one;
      two = one;
      one = (guess + (folded >>> 1 ^ -(folded & 1))) << 16 >> 16;
      points[f * channels + c] = one;
    }
  }
  return points;
}
