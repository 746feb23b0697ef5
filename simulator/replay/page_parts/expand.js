// Expands what LZMA made short (simulator/replay/packed/short_texts.py): from text in base 85 to JSON values, a piece at a
// time. No bits of the place or of the byte before choose among chances (lc, lp and pb are 0).

const FIRST_COPIED = 7; // of twelve states: from this one on, what came last was a copy
const ALL = 2048, SPEED = 5; // a chance is out of ALL; how fast it learns
const MIN_LENGTH = 2, END = 0xffffffff; // of a copy; the way back that marks the end
// Where the chances of each kind begin.
const IS_COPY = 0, IS_AGAIN = 12, IS_OTHER = 24, IS_LONG = 36, IS_LATER = 48, IS_LAST = 60, SLOTS = 72, WAYS = SLOTS + 4 * 64;
const NEAR = WAYS + 115, NEW_LENGTH = NEAR + 16, OLD_LENGTH = NEW_LENGTH + 274, LITERALS = OLD_LENGTH + 274, CHANCES = LITERALS + 768;

// What expands some bytes: more(n) makes about n more bytes and returns whether all are made; bytes() are those made.
// Throws an Error where the bytes are damaged.
function expander(packed) {
  const chances = new Uint16Array(CHANCES).fill(ALL / 2), range = new Uint32Array(2); // the range, and the code in it
  let at = 5, size = 0, state = 0, first = 0, second = 0, third = 0, fourth = 0, done = false;
  let out = new Uint8Array(packed.length * 10 + 4096);
  if (packed.length < 5 || packed[0]) throw new Error("the data do not begin as they must");
  range[0] = 0xffffffff;
  for (let i = 1; i < 5; i += 1) range[1] = (range[1] << 8) | packed[i];

  function refill() {
    if (at >= packed.length) throw new Error("the data end too early");
    range[0] <<= 8;
    range[1] = (range[1] << 8) | packed[at++];
  }
  function bit(index) {
    const chance = chances[index], bound = (range[0] >>> 11) * chance, found = range[1] < bound ? 0 : 1;
    if (found) {
      range[0] -= bound;
      range[1] -= bound;
      chances[index] = chance - (chance >> SPEED);
    } else {
      range[0] = bound;
      chances[index] = chance + ((ALL - chance) >> SPEED);
    }
    if (range[0] < 0x1000000) refill();
    return found;
  }
  // Bits of even chances.
  function evenBits(count) {
    let value = 0;
    for (let i = 0; i < count; i += 1) {
      range[0] >>>= 1;
      const found = range[1] < range[0] ? 0 : 1;
      if (found) range[1] -= range[0];
      if (range[0] < 0x1000000) refill();
      value = (value << 1) | found;
    }
    return value;
  }
  // Bits with the chances of a tree: the highest one first, or the lowest one.
  function highFirst(from, count) {
    let node = 1;
    for (let i = 0; i < count; i += 1) node = (node << 1) | bit(from + node);
    return node - (1 << count);
  }
  function lowFirst(from, count) {
    let node = 1, value = 0;
    for (let i = 0; i < count; i += 1) {
      const found = bit(from + node);
      node = (node << 1) | found;
      value |= found << i;
    }
    return value;
  }
  function lengthOf(from) {
    if (!bit(from)) return MIN_LENGTH + highFirst(from + 2, 3);
    if (!bit(from + 1)) return MIN_LENGTH + 8 + highFirst(from + 10, 3);
    return MIN_LENGTH + 16 + highFirst(from + 18, 8);
  }
  // How far back a copy begins, less one.
  function wayOf(length) {
    const slot = highFirst(SLOTS + 64 * Math.min(length - MIN_LENGTH, 3), 6);
    if (slot < 4) return slot;
    const count = (slot >> 1) - 1, way = (2 | (slot & 1)) * 2 ** count;
    if (slot < 14) return way + lowFirst(WAYS + way - slot, count);
    return way + evenBits(count - 4) * 16 + lowFirst(NEAR, 4);
  }
  function literal() {
    let node = 1;
    if (state < FIRST_COPIED) {
      while (node < 256) node = (node << 1) | bit(LITERALS + node);
    } else { // the byte that a longer copy would have had tells something of this one, as long as they agree
      let other = out[size - first - 1], agree = 256;
      while (node < 256) {
        other <<= 1;
        const there = other & agree, found = bit(LITERALS + agree + there + node);
        node = (node << 1) | found;
        agree &= found ? there : ~there;
      }
    }
    if (size === out.length) grow();
    out[size++] = node;
    state = state < 4 ? 0 : state < 10 ? state - 3 : state - 6;
  }
  function grow() {
    const larger = new Uint8Array(out.length * 2);
    larger.set(out);
    out = larger;
  }
  function copy() {
    const copied = state >= FIRST_COPIED;
    let length = 0;
    if (!bit(IS_AGAIN + state)) {
      length = lengthOf(NEW_LENGTH);
      [fourth, third, second] = [third, second, first];
      first = wayOf(length);
      if (first === END) { done = true; return; }
      state = copied ? 10 : 7;
    } else {
      if (!bit(IS_OTHER + state)) {
        if (!bit(IS_LONG + state)) length = 1;
      } else {
        const found = first;
        if (!bit(IS_LATER + state)) first = second;
        else {
          if (!bit(IS_LAST + state)) first = third;
          else [first, fourth] = [fourth, third];
          third = second;
        }
        second = found;
      }
      state = length ? (copied ? 11 : 9) : copied ? 11 : 8;
      length = length || lengthOf(OLD_LENGTH);
    }
    if (first >= size) throw new Error("a copy from before the beginning");
    while (size + length > out.length) grow();
    for (const end = size + length; size < end; size += 1) out[size] = out[size - first - 1];
  }
  function more(number) {
    const end = size + number;
    while (!done && size < end) {
      if (bit(IS_COPY + state)) copy();
      else literal();
    }
    return done;
  }
  return { more, bytes: () => out.subarray(0, size) };
}

const SIGNS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#$%.()*+-;,=/?@^_:{|}~";

// The bytes that a text in base 85 stands for: four for each five signs, the last of them cut short.
function bytesOf(text) {
  const groups = Math.ceil(text.length / 5), values = new Uint8Array(128), bytes = new Uint8Array(groups * 4);
  for (let i = 0; i < SIGNS.length; i += 1) values[SIGNS.charCodeAt(i)] = i;
  for (let group = 0; group < groups; group += 1) {
    let number = 0;
    for (let i = group * 5; i < group * 5 + 5; i += 1) number = number * 85 + (i < text.length ? values[text.charCodeAt(i)] : 84);
    const whole = number >>> 0;
    for (let i = 0; i < 4; i += 1) bytes[group * 4 + i] = whole >>> (24 - 8 * i);
  }
  return bytes.subarray(0, Math.floor(text.length * 4 / 5));
}

// Unpacks a text a piece at a time: more(n) does a part of the work that is as large as n bytes, and returns whether all
// is done; values() are the JSON values, as soon as that is so.
function unpacking(text) {
  const work = expander(bytesOf(text)), values = [];
  let lines = null;
  function more(number) {
    if (!lines) {
      if (work.more(number)) lines = new TextDecoder().decode(work.bytes()).split("\n").reverse();
      return false;
    }
    for (let left = number; left > 0 && lines.length; ) {
      left -= lines[lines.length - 1].length / PARSED_AT_ONCE;
      values.push(JSON.parse(lines.pop()));
    }
    return lines.length === 0;
  }
  return { more, values: () => values };
}
const PARSED_AT_ONCE = 10; // bytes of JSON that are parsed in the time in which one byte is expanded

// All JSON values of a packed text.
function unpacked(text) {
  const work = unpacking(text);
  while (!work.more(Infinity));
  return work.values();
}
