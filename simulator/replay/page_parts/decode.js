// Reads the packed episode (simulator/replay/packed/packing.py): the lines of its steps, one at a time.

const CHECKPOINT = 25; // steps between states that are kept once they were read
const MAX_LINES_KEPT = 50; // lines that are kept once they were read
const DIGITS = 1e6; // places are rounded to so many parts of a square

// The value to which a difference leads (simulator/replay/packed/delta.py).
function patched(old, how) {
  if (Array.isArray(how)) {
    if (how.length === 1) return how[0];
    const result = [];
    let at = 0;
    for (const edit of how) {
      if (Array.isArray(edit)) for (const item of edit) result.push(item);
      else if (edit > 0) for (const end = at + edit; at < end; at += 1) result.push(old[at]);
      else at -= edit;
    }
    for (; at < old.length; at += 1) result.push(old[at]);
    return result;
  }
  if (how === null || typeof how !== "object") return old;
  const found = new Map(Object.entries(old));
  for (const [key, part] of Object.entries(how)) {
    if (part === -1) found.delete(key);
    else found.set(key, patched(found.get(key), part));
  }
  return Object.fromEntries(found);
}

// The edges of an outline: [east, north, east, north], from corners as simulator/replay/packed/outlines.py writes them.
function edgesOf(corners) {
  const edges = [];
  let ring = [];
  for (const text of corners) {
    const [east, north] = text.replace(/[@;]/g, "").split(",").map(Number), last = ring[ring.length - 1];
    ring.push(last ? [last[0] + east, last[1] + north] : [east, north]);
    if (text.endsWith(";")) {
      ring.forEach((start, i) => edges.push([...start, ...ring[(i + 1) % ring.length]]));
      ring = [];
    }
  }
  return edges;
}

// The facts of a step, from its facts without outlines, and its outlines.
function joinedFacts(others, corners, confidences) {
  const facts = others.slice(), known = new Map();
  for (const name of Object.keys(corners).sort()) {
    const edges = edgesOf(corners[name]);
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    edges.forEach(([east, north, toEast, toNorth], number) => {
      const stated = confidences[name][number], here = `${east},${north},${toEast},${toNorth}`;
      const confidence = stated === -1 ? known.get(`${toEast},${toNorth},${east},${north}`) || 0 : stated;
      if (!known.has(here)) known.set(here, confidence);
      facts.push(`segment(${name},${number},${here},${confidence}).`);
      box[0] = Math.min(box[0], east);
      box[1] = Math.min(box[1], north);
      box[2] = Math.max(box[2], east);
      box[3] = Math.max(box[3], north);
    });
    if (edges.length) facts.push(`rect(${name},${box}).`);
  }
  return facts.sort();
}

// Digits, each by so much above that of another text, modulo 8.
const raised = (digits, below) => Array.from(digits, (digit, i) => (Number(digit) + Number(below[i])) % 8).join("");
const isDigits = (text) => typeof text === "string" && /^[0-7]{160}$/.test(text);

// The status of each field: as levels and bounds tell it, but for exceptions such as "12p40e"
// (simulator/replay/packed/impressions.py).
function statusOf({ retina, belief: { least, most } }, exceptions) {
  const recorded = isDigits(least) && isDigits(most);
  const letters = retina.map((level, field) => {
    if (!recorded) return "p";
    const low = Number(least[field]), high = Number(most[field]);
    return level < low || level > high ? "n" : low === high ? "p" : "e";
  });
  for (const [, field, letter] of exceptions.matchAll(/(\d+)([pen])/g)) letters[field] = letter;
  return letters.join("");
}

// How many fields have each status.
function countsOf(status) {
  const counts = {};
  for (const letter of status) counts[STATUS[letter]] = (counts[STATUS[letter]] || 0) + 1;
  return counts;
}

// The facts that say where the robot and, from there, the floor have their origins.
function offsetFacts(place) {
  const [east, north] = place.map((v) => Math.floor(100 * v + 0.5));
  return [`offset(org,${east},${north}).`, `offset(floor,${0 - east},${0 - north}).`];
}

// A line of an episode from its columns by path, and what the index tells of it.
function lineOf(columns, step, index, movable) {
  const line = { step, action: index.action[step], motion: index.motion[step], utak: index.utak[step] }, belief = {};
  line.belief = belief;
  const get = (...path) => columns.get(JSON.stringify(path));
  for (const [path, value] of columns) {
    const [first, second] = JSON.parse(path);
    if (value === undefined) continue;
    if (second === undefined) line[first] = value;
    else if (first === "belief") belief[second] = value;
  }
  line.objects = Object.fromEntries(Object.entries(line.objects).map(([name, pose]) => [name, isNumber(pose[0]) ? placed(pose, movable[name].rings[0]) : pose]));
  if (index.place[step] !== null) belief.place = index.place[step];
  if (index.seen_from[step] !== 0) belief.seen_from = index.seen(step);
  if (get("facts", "others") !== undefined) {
    belief.facts = joinedFacts([...get("facts", "others"), ...(get("facts", "offsets") ? offsetFacts(belief.place) : [])], get("facts", "corners"), get("facts", "confidences"));
  }
  let below = "";
  for (const name of ["least", "most", "retina"]) {
    let text = get("packed", name);
    if (isDigits(text)) below = text = below ? raised(text, below) : text;
    else below = "";
    if (name === "retina") line.retina = Array.from(text, Number);
    else if (text !== undefined) belief[name] = text;
  }
  if (get("packed", "status") !== undefined) {
    belief.status = statusOf(line, get("packed", "status"));
    if (belief.cells === undefined) belief.cells = countsOf(belief.status);
  }
  if (get("packed", "explained") !== undefined) {
    const [facts, letters] = get("packed", "explained"), found = new Map(facts.map((fact) => [fact, []]));
    let at = 0;
    Array.from(belief.status).forEach((status, field) => {
      if (status === "e") found.get(facts[letters.charCodeAt(at++) - 97]).push(field);
    });
    belief.explained = Object.fromEntries(found);
  }
  const solved = get("packed", "solved");
  if (solved) belief.solved = solved.order.map((key) => (Array.isArray(key) ? key[0] : solved.last[key]));
  return line;
}

// Where the robot was, how it moved, and where it believed to be, at every step: what is told otherwise is filled in
// (simulator/replay/packed/tracks.py).
function filledIn(columns) {
  const { action, motion, utak, place } = columns;
  for (let step = 1; step < utak.length; step += 1) {
    if (motion[step] === 0) motion[step] = { translate: utak[step].map((v, i) => round(v - utak[step - 1][i])) };
    else if (motion[step] && motion[step].rotate !== undefined && !motion[step].about) motion[step].about = utak[step];
    if (place[step] === 0) {
      const way = action[step] || {}, told = [way.east || 0, way.north || 0];
      place[step] = place[step - 1].map((v, i) => round(v + told[i]));
    }
  }
  return columns;
}

const round = (value) => Math.floor(value * DIGITS + 0.5) / DIGITS;

// The outline of a thing with a pose [x, y, degrees]; first is its outline in the header.
function placed([x, y, degrees], first) {
  const cosine = Math.cos((degrees * Math.PI) / 180), sine = Math.sin((degrees * Math.PI) / 180);
  return first.map(([a, b]) => [a - first[0][0], b - first[0][1]]).map(([dx, dy]) => [x + dx * cosine - dy * sine, y + dx * sine + dy * cosine]);
}

// Where all impressions up to a step were received, as believed at that step: a function of the step. What was believed
// anew at a step is told as a difference from the places before and the place of the step.
function placesSeen(place, anew) {
  let at = -1, places = [];
  return (step) => {
    if (step < at) [at, places] = [-1, []];
    while (at < step) {
      at += 1;
      if (anew[at] === 0) places.push(place[at]);
      else places = patched([...places, place[at]], anew[at]).slice();
    }
    return places.slice();
  };
}

// An episode, from the texts of its index and of its blocks: what the index has; line(step), the line of a step as
// the episode has it; trees(step), the explanations that were given with it; and seen(step), see placesSeen.
function openEpisode([packedIndex, ...packedBlocks]) {
  const index = unpacked(packedIndex), columns = filledIn(index.columns), blocks = [], lines = new Map();
  const seen = (columns.seen = placesSeen(columns.place, columns.seen_from));

  function block(number) {
    if (!blocks[number]) {
      const parts = unpacked(packedBlocks[number]).map(([path, how]) => [JSON.stringify(path), how]);
      blocks[number] = { parts, states: [] };
    }
    return blocks[number];
  }
  // The state of all columns at a step: from the nearest state before it that is kept.
  function state(step) {
    const { parts, states } = block(Math.floor(step / index.block)), local = step % index.block;
    let at = Math.floor(local / CHECKPOINT) * CHECKPOINT;
    while (at > 0 && !states[at]) at -= CHECKPOINT;
    let found = states[at] || null;
    if (!found) {
      found = parts.map(([, how]) => (how[0] === -1 ? undefined : how[0][0]));
      at = 0;
      states[0] = found;
    }
    while (at < local) {
      at += 1;
      found = parts.map(([, how], i) => (how[at] === -1 ? undefined : patched(found[i], how[at])));
      if (at % CHECKPOINT === 0) states[at] = found;
    }
    return new Map(parts.map(([path], i) => [path, found[i]]));
  }
  function read(step) {
    if (!lines.has(step)) {
      if (lines.size >= MAX_LINES_KEPT) lines.delete(lines.keys().next().value);
      const found = state(step);
      lines.set(step, { line: lineOf(found, step, columns, index.header.world.movable), trees: found.get('["replay","trees"]') || [] });
    }
    return lines.get(step);
  }
  return { ...index, columns, seen, line: (step) => read(step).line, trees: (step) => read(step).trees };
}
