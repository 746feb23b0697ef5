// Facts as values: what a step believes, sorted out for drawing. Texts of episodes may be anything; numbers are checked.

const UNSAFE = /[\u0000-\u0009\u000b-\u001f\u007f-\u009f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff\ud800-\udfff]/g;
const MAX_SHOWN_TEXT = 600; // characters of one text that are shown at once

// A text of an episode as it may be shown: without what turns the direction of text, and not endless.
function shown(text) {
  const clean = String(text).slice(0, MAX_SHOWN_TEXT + 1)
    .replace(UNSAFE, (char, at, all) => (isPair(all, at) ? char : "\\u" + char.charCodeAt(0).toString(16).padStart(4, "0")));
  return clean.length > MAX_SHOWN_TEXT ? clean.slice(0, MAX_SHOWN_TEXT) + " …" : clean;
}

// Whether the character at a place of a text is half of a pair that stands for one sign.
function isPair(text, at) {
  const here = text.charCodeAt(at), high = (code) => code >= 0xd800 && code < 0xdc00, low = (code) => code >= 0xdc00 && code < 0xe000;
  return (high(here) && low(text.charCodeAt(at + 1))) || (low(here) && high(text.charCodeAt(at - 1)));
}

// The name and the arguments of a fact, as texts: "kind(o1,object,95)." gives ["kind", "o1", "object", "95"].
function argumentsOf(fact) {
  const open = fact.indexOf("(");
  if (open < 0) return [fact.replace(/\.$/, "")];
  const parts = [fact.slice(0, open)], end = fact.lastIndexOf(")");
  let depth = 0, quoted = false, from = open + 1;
  for (let i = from; i < end; i += 1) {
    const char = fact[i];
    if (quoted) {
      if (char === "\\") i += 1;
      else if (char === '"') quoted = false;
    } else if (char === '"') quoted = true;
    else if (char === "(") depth += 1;
    else if (char === ")") depth -= 1;
    else if (char === "," && depth === 0) {
      parts.push(fact.slice(from, i));
      from = i + 1;
    }
  }
  return [...parts, fact.slice(from, end)];
}

const isNumber = (value) => typeof value === "number" && Number.isFinite(value);
const isPoint = (value) => Array.isArray(value) && value.length >= 2 && isNumber(value[0]) && isNumber(value[1]);
const hundredths = (text) => (/^-?\d{1,9}$/.test(text) ? Number(text) / 100 : NaN);

// What a step's facts say, by predicate: lists of arguments.
function byPredicate(facts) {
  const found = new Map();
  for (const fact of facts) {
    const [name, ...args] = argumentsOf(fact);
    if (!found.has(name)) found.set(name, []);
    found.get(name).push(args);
  }
  return (name, count) => (found.get(name) || []).filter((args) => count === undefined || args.length === count);
}

// The outlines of nodes: name -> edges { from, to, sure }, in squares of the robot's frame; sure from 0 to 1.
function outlinesOf(said) {
  const outlines = new Map();
  for (const [name, number, ...rest] of said("segment", 7)) {
    const [east, north, toEast, toNorth] = rest.slice(0, 4).map(hundredths);
    if ([east, north, toEast, toNorth].some(Number.isNaN) || !/^\d{1,9}$/.test(number)) continue;
    if (!outlines.has(name)) outlines.set(name, []);
    outlines.get(name).push({ number: Number(number), from: [east, north], to: [toEast, toNorth], sure: percent(rest[4]) });
  }
  for (const edges of outlines.values()) edges.sort((a, b) => a.number - b.number);
  return outlines;
}

const percent = (text) => Math.min(1, Math.max(0, Number(text) / 100 || 0));

// The rings of an outline: lists of points.
function ringsOf(edges) {
  const rings = [];
  let ring = null;
  for (const { from, to } of edges) {
    if (!ring) rings.push((ring = []));
    ring.push(from);
    if (to[0] === ring[0][0] && to[1] === ring[0][1]) ring = null;
  }
  return rings;
}

// What changed between two steps' facts: { added, removed, changed }. Two facts that differ in numbers alone are
// one that changed; outlines are counted by node, not listed.
function changesOf(before, after) {
  const old = new Set(before), now = new Set(after), outlines = new Map();
  const isOutline = (fact) => fact.startsWith("segment(");
  const count = (fact) => {
    const name = argumentsOf(fact)[1];
    outlines.set(name, (outlines.get(name) || 0) + 1);
  };
  const gone = before.filter((fact) => !now.has(fact)), come = after.filter((fact) => !old.has(fact));
  come.filter(isOutline).forEach(count);
  gone.filter(isOutline).forEach((fact) => outlines.has(argumentsOf(fact)[1]) || count(fact));
  const waiting = new Map(), added = [], changed = [];
  for (const fact of gone.filter((one) => !isOutline(one))) {
    const key = keyOf(fact);
    if (!waiting.has(key)) waiting.set(key, []);
    waiting.get(key).push(fact);
  }
  for (const fact of come.filter((one) => !isOutline(one))) {
    const former = (waiting.get(keyOf(fact)) || []).shift();
    if (former === undefined) added.push(fact);
    else changed.push([former, fact]);
  }
  return { added, changed, removed: [...waiting.values()].flat(), outlines };
}

// A fact without its numbers: two that agree in this are one fact that changed (simulator/replay/changes.py).
const keyOf = (fact) => fact.replace(/([(,])-?\d+(?=[,)])/g, "$1#");
