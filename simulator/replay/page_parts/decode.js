// Reads the packed episode (simulator/replay/packed/packing.py): the lines of its steps, one at a time.

const CHECKPOINT = 20; // steps between states that are kept once they were read
const PLACES_CHECKPOINTS = 100; // lists of places that are kept at most
const PIECE_BYTES = 1 << 15; // of a block that are unpacked at once while nobody waits
const MAX_BLOCKS_AHEAD = 20; // that are read before somebody asks for one of their steps
const MAX_LINES_KEPT = 50; // lines that are kept once they were read
const DIGITS = 1e6; // places are rounded to so many parts of a square

// The value to which a difference leads (simulator/replay/packed/delta.py).
function patched(old, how) {
  if (Array.isArray(how)) return how.length === 1 ? how[0] : edited(old, how);
  if (how === null || typeof how !== "object") return old;
  const found = { ...old };
  for (const key of Object.keys(how)) {
    const part = how[key];
    if (part === -1) delete found[key];
    else if (key === "__proto__") Object.defineProperty(found, key, { value: patched(found[key], part), writable: true, enumerable: true, configurable: true });
    else found[key] = patched(found[key], part);
  }
  return found;
}

// A list after the edits of a difference.
function edited(old, how) {
  let at = typeof how[0] === "number" && how[0] > 0 ? how[0] : 0;
  const result = old.slice(0, at);
  for (let i = at ? 1 : 0; i < how.length; i += 1) {
    const edit = how[i];
    if (Array.isArray(edit)) for (const item of edit) result.push(item);
    else if (edit > 0) for (const end = at + edit; at < end; at += 1) result.push(old[at]);
    else at -= edit;
  }
  for (; at < old.length; at += 1) result.push(old[at]);
  return result;
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

const isDigits = (text) => typeof text === "string" && /^[0-7]{160}$/.test(text);
const LEVEL_SIGNS = "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ!#"; // simulator/replay/packed/impressions.py
const LEVEL_BOUNDS = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((more) => [0, 1, 2, 3, 4, 5, 6, 7].slice(more).map((most) => [most - more, most]));

// The least and the greatest predicted level and the one observed, of each field, as three texts of digits.
function levelsOf(signs) {
  let least = "", most = "", retina = "";
  for (let i = 0; i < signs.length; i += 1) {
    const between = signs[i] === "'", number = LEVEL_SIGNS.indexOf(signs[between ? i + 1 : i]), low = number >= LEVEL_BOUNDS.length;
    const bounds = LEVEL_BOUNDS[low ? number - LEVEL_BOUNDS.length + 8 : number];
    least += bounds[0];
    most += bounds[1];
    retina += between ? signs[i + 2] : bounds[low ? 0 : 1];
    if (between) i += 2;
  }
  return [least, most, retina];
}

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

// Decisions as the episode has them; undefined where no step records any in the usual form. What one was about may be told
// by the routes of the step.
function decisionsOf(solved, routes) {
  return solved && solved.order.map((key) => {
    if (Array.isArray(key)) return key[0];
    const [encoding, facts, answer, about, ...left] = solved.last[key];
    return [encoding, facts, answer, about === "routes" ? routes().map((route) => route.points) : about, ...left];
  });
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
  let retina = get("packed", "retina");
  if (get("packed", "levels") !== undefined) [belief.least, belief.most, retina] = levelsOf(get("packed", "levels"));
  line.retina = Array.from(retina, Number);
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
  const solved = decisionsOf(get("packed", "solved"), () => belief.routes);
  if (solved) belief.solved = solved;
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
  const every = Math.max(CHECKPOINT, Math.ceil(place.length / PLACES_CHECKPOINTS)), kept = new Map();
  let at = -1, places = [];
  return (step) => {
    const before = step - (step % every);
    if (kept.has(before) && (step < at || before > at)) [at, places] = [before, kept.get(before).slice()];
    else if (step < at) [at, places] = [-1, []];
    while (at < step) {
      at += 1;
      places.push(place[at]);
      if (anew[at] !== 0) places = patched(places, anew[at]).slice();
      if (at % every === 0 && !kept.has(at)) kept.set(at, places.slice());
    }
    return places.slice();
  };
}

// The steps of one block, from its text: state(n), the columns by path at its nth step; column(path, n), one of them;
// prepare() does a small part of what later calls would have to do, and returns whether something is left. What is damaged
// throws an Error at each call.
function openBlock(text, steps) {
  const work = unpacking(text), states = new Map();
  let paths = null, parts = null, damage = null, ahead = 0, recent = [];

  // Does a part of the unpacking; returns whether all is done.
  function unpack(bytes) {
    if (damage) throw damage;
    try {
      if (!work.more(bytes)) return false;
      paths = work.values().map(([path]) => JSON.stringify(path));
      parts = work.values().map(([, how]) => how);
      states.set(0, parts.map((how) => (how[0] === -1 ? undefined : how[0][0])));
      return true;
    } catch (error) {
      damage = error;
      throw error;
    }
  }
  const next = (how, at, old) => (how[at] === 0 ? old : how[at] === -1 ? undefined : patched(old, how[at]));
  // The last step, up to a step, at which the values of all columns are kept.
  function keptBefore(local) {
    let at = local - (local % CHECKPOINT);
    while (!states.has(at)) at -= CHECKPOINT;
    return at;
  }
  // The values of all columns at a step. Those asked for last and those before them are kept: they are often asked for next.
  function values(local) {
    let at = keptBefore(local), found = states.get(at), before = null;
    for (const one of recent) if (one.at > at && one.at <= local) ({ at, found } = one);
    while (at < local) {
      before = { at, found };
      at += 1;
      found = parts.map((how, i) => next(how, at, before.found[i]));
      if (at % CHECKPOINT === 0) states.set(at, found);
    }
    if (before) recent = [before, { at, found }];
    return found;
  }
  function whole() {
    while (!parts) unpack(Infinity);
  }
  function state(local) {
    whole();
    const found = values(local);
    return new Map(paths.map((path, i) => [path, found[i]]));
  }
  function column(path, local) {
    whole();
    const number = paths.indexOf(path);
    if (number < 0) return undefined;
    let at = keptBefore(local), found = states.get(at)[number];
    while (at < local) found = next(parts[number], (at += 1), found);
    return found;
  }
  function prepare() {
    if (!parts) return unpack(PIECE_BYTES) || true;
    if (ahead + CHECKPOINT >= steps) return false;
    values((ahead += CHECKPOINT));
    return true;
  }
  return { state, column, prepare };
}

// An episode, from the texts of its index and of its blocks: what the index has; line(step), the line of a step as
// the episode has it; solved(step), its decisions alone, which is faster; trees(step), the explanations that were given with
// it; seen(step), see placesSeen; and prepare(), which does a small part of what later calls would have to do, and returns
// whether something is left.
function openEpisode([packedIndex, ...packedBlocks]) {
  const [index] = unpacked(packedIndex), columns = filledIn(index.columns), blocks = [], lines = new Map();
  const seen = (columns.seen = placesSeen(columns.place, columns.seen_from));
  let ahead = 0;

  function block(number) {
    if (!blocks[number]) blocks[number] = openBlock(packedBlocks[number], Math.min(index.block, index.steps - number * index.block));
    return blocks[number];
  }
  function read(step) {
    if (!lines.has(step)) {
      if (lines.size >= MAX_LINES_KEPT) lines.delete(lines.keys().next().value);
      const found = block(Math.floor(step / index.block)).state(step % index.block);
      lines.set(step, { line: lineOf(found, step, columns, index.header.world.movable), trees: found.get('["replay","trees"]') || [] });
    }
    return lines.get(step);
  }
  function solved(step) {
    if (lines.has(step)) return lines.get(step).line.belief.solved;
    const get = (path) => block(Math.floor(step / index.block)).column(JSON.stringify(path), step % index.block);
    return decisionsOf(get(["packed", "solved"]), () => get(["belief", "routes"])) || get(["belief", "solved"]);
  }
  function prepare() {
    if (ahead === Math.min(packedBlocks.length, MAX_BLOCKS_AHEAD)) {
      seen(index.steps - 1);
      return false;
    }
    try {
      if (!block(ahead).prepare()) ahead += 1;
    } catch { // whoever asks for a step of this block is told
      ahead += 1;
    }
    return true;
  }
  return { ...index, columns, seen, solved, prepare, line: (step) => read(step).line, trees: (step) => read(step).trees };
}
