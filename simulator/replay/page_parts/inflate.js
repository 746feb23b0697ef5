// Inflates deflated data (RFC 1951), from text in base 85 to text.

const LENGTH_BASE = [3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 15, 17, 19, 23, 27, 31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258];
const LENGTH_BITS = [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0];
const WAY_BASE = [1, 2, 3, 4, 5, 7, 9, 13, 17, 25, 33, 49, 65, 97, 129, 193, 257, 385, 513, 769, 1025, 1537, 2049, 3073, 4097,
  6145, 8193, 12289, 16385, 24577];
const WAY_BITS = [0, 0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8, 8, 9, 9, 10, 10, 11, 11, 12, 12, 13, 13];
const CODE_ORDER = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];
const MAX_CODE_BITS = 15;

// A Huffman code by the lengths of its words: how many words have each length, and the symbols in the order of words.
function codeOf(lengths) {
  const count = new Uint16Array(MAX_CODE_BITS + 1), next = new Uint16Array(MAX_CODE_BITS + 2);
  for (const length of lengths) count[length] += 1;
  count[0] = 0;
  for (let bits = 1; bits <= MAX_CODE_BITS; bits += 1) next[bits + 1] = next[bits] + count[bits];
  const symbols = new Uint16Array(lengths.length);
  lengths.forEach((length, symbol) => {
    if (length) symbols[next[length]++] = symbol;
  });
  return { count, symbols };
}

const FIXED_LENGTHS = Array.from({ length: 288 }, (_, i) => (i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8));
const FIXED = [codeOf(FIXED_LENGTHS), codeOf(new Array(30).fill(5))];

// The bytes that some deflated bytes stand for. Throws an Error where they are damaged.
function inflated(packed) {
  let at = 0, bit = 0, size = 0, out = new Uint8Array(packed.length * 6 + 1024);

  function room(more) {
    if (size + more <= out.length) return;
    const larger = new Uint8Array(Math.max(out.length * 2, size + more));
    larger.set(out);
    out = larger;
  }
  function bits(number) {
    let value = 0;
    for (let i = 0; i < number; i += 1) {
      if (at >= packed.length) throw new Error("the data end too early");
      value |= ((packed[at] >> bit) & 1) << i;
      if (++bit === 8) { bit = 0; at += 1; }
    }
    return value;
  }
  function symbol(code) {
    let word = 0, first = 0, index = 0;
    for (let length = 1; length <= MAX_CODE_BITS; length += 1) {
      if (at >= packed.length) throw new Error("the data end too early");
      word |= (packed[at] >> bit) & 1;
      if (++bit === 8) { bit = 0; at += 1; }
      const count = code.count[length];
      if (word - count < first) return code.symbols[index + word - first];
      index += count;
      first = (first + count) << 1;
      word <<= 1;
    }
    throw new Error("a word of no code");
  }
  function stored() {
    if (bit) { bit = 0; at += 1; }
    const length = packed[at] | (packed[at + 1] << 8);
    at += 4;
    if (!(at + length <= packed.length)) throw new Error("the data end too early");
    room(length);
    out.set(packed.subarray(at, at + length), size);
    at += length;
    size += length;
  }
  function readCodes() {
    const literals = bits(5) + 257, ways = bits(5) + 1, codes = bits(4) + 4, order = new Array(19).fill(0), lengths = [];
    for (let i = 0; i < codes; i += 1) order[CODE_ORDER[i]] = bits(3);
    const code = codeOf(order);
    while (lengths.length < literals + ways) {
      const found = symbol(code);
      if (found < 16) lengths.push(found);
      else {
        const value = found === 16 ? lengths[lengths.length - 1] || 0 : 0;
        const times = found === 16 ? 3 + bits(2) : found === 17 ? 3 + bits(3) : 11 + bits(7);
        for (let i = 0; i < times; i += 1) lengths.push(value);
      }
    }
    return [codeOf(lengths.slice(0, literals)), codeOf(lengths.slice(literals, literals + ways))];
  }
  function compressed([literals, ways]) {
    for (;;) {
      const found = symbol(literals);
      if (found === 256) return;
      room(258);
      if (found < 256) { out[size++] = found; continue; }
      const length = LENGTH_BASE[found - 257] + bits(LENGTH_BITS[found - 257]);
      const way = symbol(ways), back = WAY_BASE[way] + bits(WAY_BITS[way]);
      if (back > size) throw new Error("a copy from before the beginning");
      for (let i = 0; i < length; i += 1, size += 1) out[size] = out[size - back];
    }
  }

  for (let last = 0; !last;) {
    last = bits(1);
    const kind = bits(2);
    if (kind === 3) throw new Error("a block of no kind");
    if (kind === 0) stored();
    else compressed(kind === 1 ? FIXED : readCodes());
  }
  return out.subarray(0, size);
}

const SIGNS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#$%.()*+-;,=/?@^_:{|}~";

// The bytes that a text in base 85 stands for: four for each five signs, the last of them cut short.
function bytesOf(text) {
  const groups = Math.ceil(text.length / 5), values = new Uint8Array(128), bytes = new Uint8Array(groups * 4);
  Array.from(SIGNS).forEach((sign, value) => { values[sign.charCodeAt(0)] = value; });
  for (let group = 0; group < groups; group += 1) {
    let number = 0;
    for (let i = group * 5; i < group * 5 + 5; i += 1) number = number * 85 + (i < text.length ? values[text.charCodeAt(i)] : 84);
    for (let i = 3; i >= 0; i -= 1, number = Math.floor(number / 256)) bytes[group * 4 + i] = number % 256;
  }
  return bytes.subarray(0, Math.floor(text.length * 4 / 5));
}

// The JSON value that a text in base 85 of deflated ASCII stands for.
function unpacked(text) {
  const plain = inflated(bytesOf(text)), parts = [];
  for (let i = 0; i < plain.length; i += 8192) parts.push(String.fromCharCode.apply(null, plain.subarray(i, i + 8192)));
  return JSON.parse(parts.join(""));
}
