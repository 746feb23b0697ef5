// The two maps: the table as it is, and what the robot believes of it.

const RETINA_REACH = RETINA_ZONES.at(-1)[0]; // squares: the retina covers 32 x 32 squares about the robot's own square
const MARGIN = 2; // squares about what is believed to be floor or a thing
const OUTSIDE_SHARE = 0.25; // of the table's greater side: how far beyond the table is shown at most
const LABEL_SIZE = 11; // pixels
const CERTAIN = 0.95; // what is held with less is drawn as doubtful: 1 of 20, a convention
const MIN_WITHIN = 0.1; // squares: where the robot is known better than that, no area is drawn
const MIN_SQUARE = 6; // pixels of a square's side: a table that has no room for them is scrolled

// The area that both maps show, in squares of the picture: the table, and what is believed a little beyond it.
function areaOf(episode, places) {
  const [width, height] = episode.header.world.table;
  let [west, north, east, south] = [0, 0, width, height];
  const outside = OUTSIDE_SHARE * Math.max(width, height);
  if (episode.bounds) {
    const [w, s, e, n] = episode.bounds.map((value) => value / 100);
    for (const corner of [[w, s], [w, n], [e, s], [e, n]]) {
      const [x, y] = places.robot(corner);
      west = Math.max(Math.min(west, x - MARGIN), -outside);
      north = Math.max(Math.min(north, y - MARGIN), -outside);
      east = Math.min(Math.max(east, x + MARGIN), width + outside);
      south = Math.min(Math.max(south, y + MARGIN), height + outside);
    }
  }
  return { west, north, width: east - west, height: south - north };
}

// The table: verge, fixed and movable things, the robot, what it holds and its way up to the step.
function drawTruth(at) {
  const { episode, step, line, places } = at, world = episode.header.world, group = svg("g", { class: "truth" });
  const [width, height] = world.table;
  group.append(svg("rect", { class: "floor", width, height }));
  for (const rings of world.verge) group.append(svg("path", { class: "verge", "fill-rule": "evenodd", d: pathOf(rings, places.table, true) }));
  for (const [name, thing] of Object.entries(world.fixed)) {
    group.append(svg("path", { class: "fixed", "fill-rule": "evenodd", d: pathOf(thing.rings, places.table, true) }));
    group.append(label(at, thing.rings[0], places.table, `${name} (fixed)`));
  }
  for (const [name, ring] of Object.entries(line.objects)) {
    const held = name === line.held;
    group.append(svg("path", { class: held ? "thing held" : "thing", d: pathOf([ring], places.table, true) }));
    group.append(label(at, ring, places.table, held ? `${name} held` : name));
  }
  if (at.layers.has("track")) {
    group.append(svg("path", { class: "track", d: trackOf(episode.utak.slice(0, step + 1), places.table) }));
  }
  return group;
}

// The robot: a disc with a line to its own north.
function drawRobot(at) {
  const [x, y] = at.places.table(at.line.utak), size = 6 * at.unit, angle = (-at.episode.header.world.heading * Math.PI) / 180;
  const tip = [x + 2 * size * Math.sin(angle), y - 2 * size * Math.cos(angle)];
  return svg("g", { class: "robot" },
    svg("circle", { cx: x, cy: y, r: size }),
    svg("line", { x1: x, y1: y, x2: tip[0], y2: tip[1] }));
}

// A name above a ring of points.
function label(at, ring, place, text) {
  const points = ring.map(place), easts = points.map(([x]) => x), top = Math.min(...points.map(([, y]) => y));
  const half = 0.3 * LABEL_SIZE * text.length * at.unit, middle = (Math.min(...easts) + Math.max(...easts)) / 2;
  const x = Math.min(Math.max(middle, at.area.west + half), at.area.west + at.area.width - half);
  return svg("text", { x: rounded(x), y: rounded(Math.max(top - 0.7 * LABEL_SIZE * at.unit, at.area.north + 0.7 * LABEL_SIZE * at.unit)), "font-size": rounded(LABEL_SIZE * at.unit), class: "label" }, shown(text));
}

// The fields of the retina over the table, the darker the fuller.
function drawImpression(at) {
  const group = svg("g", { class: "impression" }), [x, y] = at.line.utak.map((value) => Math.floor(value) + 0.5);
  const { places } = placedAt(at, [x, y]);
  FIELDS.forEach(({ east, north, side }, field) => {
    const level = at.line.retina[field];
    if (!level) return;
    const ring = squareOf(east - 0.5, north - 0.5, side);
    group.append(svg("path", { d: pathOf([ring], places.robot, true), "fill-opacity": rounded((level / 7) * 0.55) }));
  });
  group.append(svg("path", { class: "reach", d: pathOf([squareOf(-RETINA_REACH - 0.5, -RETINA_REACH - 0.5, 2 * RETINA_REACH)], places.robot, true) }));
  return group;
}

const placedAt = (at, origin) => ({ places: placing(at.episode.header, origin) });
const squareOf = (west, south, side) => [[west, south], [west + side, south], [west + side, south + side], [west, south + side]];

// What is believed: floor, verge, objects, doors, corners, rooms; the surer, the stronger.
function drawBelief(at) {
  const { said, outlines, places } = at, group = svg("g", { class: "belief" }), place = places.robot;
  if (at.layers.has("unseen")) group.append(drawUnseen(at));
  const kinds = kindsOf(said), floor = outlines.get("floor") || [];
  group.append(svg("path", { class: "floor", "fill-rule": "evenodd", d: pathOf(ringsOf(floor), place, true) }));
  group.append(...drawWithin(at), ...drawUnfelt(at));
  for (const [name, edges] of outlines) {
    const kind = kinds.get(name) || NO_KIND, rings = pathOf(ringsOf(edges), place, true);
    if (kind.word === "object") {
      group.append(svg("path", { class: "thing", "fill-rule": "evenodd", d: rings, "fill-opacity": rounded(0.1 + 0.5 * kind.sure) }));
      if (kind.sure < CERTAIN) group.append(svg("path", { class: "doubt", "fill-rule": "evenodd", d: rings }));
      group.append(...drawOtherShapes(at, name));
    }
    const bySure = new Map();
    for (const edge of edges) {
      if (!bySure.has(edge.sure)) bySure.set(edge.sure, []);
      bySure.get(edge.sure).push([edge.from, edge.to]);
    }
    for (const [sure, lines] of bySure) {
      group.append(svg("path", { class: `edge ${kind.word}${likeliestIsAnother(at, name) ? " other" : ""}`, d: pathOf(lines, place, false), "stroke-opacity": rounded(0.15 + 0.85 * sure) }));
    }
  }
  const doors = doorsOf(said);
  for (const [name, ends] of Object.entries(at.line.belief.necks || {})) {
    if (!Array.isArray(ends) || ends.length !== 2 || !ends.every(isPoint)) continue;
    const sure = doors.get(name) ?? 1;
    group.append(svg("path", { class: sure < CERTAIN ? "door open" : "door", d: pathOf([ends], place, false) }), label(at, ends, place, sure < 1 ? `${name} ${share(sure)}` : name));
  }
  for (const [name, east, north] of said("corner", 4).concat(said("corner", 3).filter(([name]) => !said("corner", 4).some(([other]) => other === name)))) {
    const point = [hundredths(east), hundredths(north)];
    if (point.some(Number.isNaN)) continue;
    const [x, y] = place(point), size = 4 * at.unit;
    group.append(svg("rect", { class: "corner", x: x - size, y: y - size, width: 2 * size, height: 2 * size }, svg("title", {}, shown(`corner ${name}`))));
  }
  if (at.layers.has("pathgraph")) group.append(drawPathgraph(at));
  if (at.layers.has("routes")) group.append(drawWeighed(at));
  if (at.layers.has("track")) {
    const track = at.episode.seen(at.step).filter(isPoint);
    group.append(svg("path", { class: "track", d: trackOf(track, place) }));
  }
  for (const [name, edges] of outlines) {
    if (!["floor", "verge"].includes(name)) group.append(label(at, edges.map((edge) => edge.from), place, nameOf(said, name, kinds.get(name) || NO_KIND)));
  }
  group.append(...drawPlace(at));
  return group;
}

// Hatched: parts of the verge that may be things, since they were never felt.
function drawUnfelt(at) {
  const { unfelt } = at.line.belief, rings = Array.isArray(unfelt) ? unfelt.filter(isRing) : [];
  if (!rings.length) return [];
  return [svg("path", { class: "doubt wall", "fill-rule": "evenodd", d: pathOf(rings, at.places.robot, true) }, svg("title", {}, "never felt: this may be a thing"))];
}

// The outline that a thing would have if it were of the next class that may well be, with its percent.
function drawOtherShapes(at, name) {
  const shares = sharesOfShapes(at.said, name), best = bestOf(shares), drawn = [];
  for (const [shape, ring] of Object.entries(otherOutlines(at, name))) {
    if (!isRing(ring) || !shares.has(shape)) continue;
    const title = svg("title", {}, shown(`${name}: ${shape} ${share(shares.get(shape))}`));
    drawn.push(svg("path", { class: shape === best ? "edge object" : "edge object other", d: pathOf([ring], at.places.robot, true) }, title));
  }
  return drawn;
}
const isRing = (ring) => Array.isArray(ring) && ring.length > 2 && ring.every(isPoint);
function otherOutlines(at, name) {
  const all = at.line.belief.outlines, found = all !== null && typeof all === "object" && Object.hasOwn(all, name) ? all[name] : null;
  return found !== null && typeof found === "object" ? found : {};
}
// Whether rules make another class the likeliest than the one whose outline the facts have.
const likeliestIsAnother = (at, name) => Object.hasOwn(otherOutlines(at, name), bestOf(sharesOfShapes(at.said, name)));

// Where the robot may be, if that is more than a place.
function drawWithin(at) {
  const within = at.line.belief.place_within;
  if (!isRing(within) || Math.hypot(within[2][0] - within[0][0], within[2][1] - within[0][1]) <= MIN_WITHIN) return [];
  return [svg("path", { class: "within", d: pathOf([within], at.places.robot, true) }, svg("title", {}, "the robot is somewhere in here"))];
}

// Where the robot believes it is: the place, and its rooms where none of them is almost certain.
function drawPlace(at) {
  const { place, place_within: within } = at.line.belief, drawn = [];
  if (!isPoint(place)) return drawn;
  const [x, y] = at.places.robot(place), size = 8 * at.unit, isLost = Array.isArray(within) && !within.length;
  const tip = isLost ? "the robot is lost: it may be anywhere" : "where the robot believes it is";
  drawn.push(svg("path", { class: isLost ? "place lost" : "place", d: `M${x} ${y - size}L${x + size} ${y}L${x} ${y + size}L${x - size} ${y}Z` }, svg("title", {}, tip)));
  const doubt = isLost ? "lost" : roomsInDoubt(at.said, "org");
  if (doubt) drawn.push(label(at, [[place[0], place[1] + 8 * at.unit]], at.places.robot, doubt));
  return drawn;
}

// The rooms of a node with their percent, where none of them is almost certain; else "".
function roomsInDoubt(said, name) {
  const rooms = (roomsOf(said).get(name) || []).sort((a, b) => b.sure - a.sure);
  return rooms.length && rooms[0].sure < CERTAIN ? `in ${rooms.map(({ room, sure }) => `${room} ${share(sure)}`).join(", ")}` : "";
}
const share = (sure) => `${Math.round(100 * sure)} %`;

// What each node is drawn as, with all that it may be: { word, sure, all: [[word, sure]] }. A node that may be a thing is
// one with an outline of its own, so it is drawn as a thing, however likely it is verge.
const NO_KIND = { word: "object", sure: 0, all: [] };
function kindsOf(said) {
  const kinds = new Map();
  for (const [name, word, sure] of said("kind", 3)) {
    const all = [...(kinds.get(name)?.all || []), [word, percent(sure)]].sort((a, b) => b[1] - a[1]);
    const thing = all.find(([one]) => one === "object") || all[0], known = ["floor", "verge", "object"].includes(thing[0]);
    kinds.set(name, { word: known ? thing[0] : "object", sure: thing[1], all });
  }
  return kinds;
}

// How sure each door is, from 0 to 1; older episodes state sure doors alone.
function doorsOf(said) {
  return new Map([...said("door", 1).map(([name]) => [name, 1]), ...said("door", 2).map(([name, sure]) => [name, percent(sure)])]);
}

// The rooms in which the middle of each node may lie: [{ room, sure }]; older episodes state one room alone.
function roomsOf(said) {
  const rooms = new Map(said("in", 2).map(([name, room]) => [name, [{ room, sure: 1 }]]));
  for (const [name, room, sure] of said("in", 3)) {
    const others = (rooms.get(name) || []).filter((where) => where.room !== room);
    rooms.set(name, [...others, { room, sure: percent(sure) }]);
  }
  return rooms;
}

// A node with its likeliest shape: "o2 l_shape 98", and with its kinds if these are in doubt: "o2 object 46 %, verge 54 %".
function nameOf(said, name, kind) {
  const shares = sharesOfShapes(said, name), best = bestOf(shares);
  const held = said("held", 1).some((args) => args[0] === name) ? " held" : "";
  if (kind.sure < CERTAIN && kind.all.length) {
    return `${name} ${kind.all.filter(([, sure]) => sure >= 1 - CERTAIN).map(([word, sure]) => `${word} ${share(sure)}`).join(", ")}${held}`;
  }
  return best ? `${name} ${best} ${Math.round(100 * shares.get(best))}${held}` : name + held;
}

// How sure each class of shapes is for a node, from 0 to 1, and the likeliest one ("" for none).
const WHOLE_GROUPS = ["rectangle", "polygon"]; // of classes
const sharesOfShapes = (said, name) => new Map(said("shape", 3).filter((args) => args[0] === name && !WHOLE_GROUPS.includes(args[1])).map(([, shape, sure]) => [shape, percent(sure)]));
const bestOf = (shares) => [...shares].reduce((best, [shape, sure]) => (sure > (shares.get(best) || 0) ? shape : best), "");

// Hatching where no impression reached, as far as the places of impressions are known.
function drawUnseen(at) {
  const { west, north, width, height } = at.area, { belief } = at.line, windows = new Map();
  const angle = ((isNumber(belief.lattice) ? belief.lattice : 0) * Math.PI) / 180, origin = isPoint(belief.origin) ? belief.origin : [0.5, 0.5];
  const windowOf = windowsSeen(at.places.robot, angle, origin);
  for (const place of at.episode.seen(at.step).slice(isNumber(belief.map_from) ? belief.map_from : 0).filter(isPoint)) {
    const { square, path } = windowOf(place);
    windows.set(square, path);
  }
  const all = { x: rounded(west), y: rounded(north), width: rounded(width), height: rounded(height) };
  return svg("g", {},
    svg("mask", { id: "never-seen", maskUnits: "userSpaceOnUse", ...all },
      svg("rect", { ...all, fill: "white" }), svg("path", { d: [...windows.values()].join(""), fill: "black" })),
    svg("rect", { class: "unseen", ...all, fill: "url(#hatch)", mask: "url(#never-seen)" }));
}

// What an impression covers that was received at a place: a function of the place, to the square in which that lies and
// path data. What it found is kept as long as the frame of squares stays the same.
const windowsKept = { frame: "", found: new WeakMap() };
function windowsSeen(place, angle, origin) {
  const frame = [angle, ...origin].join(), cosine = Math.cos(angle), sine = Math.sin(angle);
  if (windowsKept.frame !== frame) Object.assign(windowsKept, { frame, found: new WeakMap() });
  const { found } = windowsKept;
  return (point) => {
    if (!found.has(point)) {
      const x = Math.floor(point[0] * cosine - point[1] * sine + origin[0] + 1e-6) + 0.5 - origin[0];
      const y = Math.floor(point[0] * sine + point[1] * cosine + origin[1] + 1e-6) + 0.5 - origin[1];
      const middle = [x * cosine + y * sine, y * cosine - x * sine];
      const ring = squareOf(middle[0] - RETINA_REACH - 0.5, middle[1] - RETINA_REACH - 0.5, 2 * RETINA_REACH);
      found.set(point, { square: `${x},${y}`, path: pathOf([ring], place, true) });
    }
    return found.get(point);
  };
}

// The pathgraph of the believed floor. Facts name the ends of a link, not its way: links are drawn straight.
function drawPathgraph(at) {
  const { said, places } = at, group = svg("g", { class: "pathgraph" }), junctions = new Map();
  for (const [name, east, north, clearance] of said("junction", 4)) {
    const point = [hundredths(east), hundredths(north)];
    if (!point.some(Number.isNaN)) junctions.set(name, { point, clearance });
  }
  for (const [name, first, last, length, clearance] of said("link", 5)) {
    const ends = [junctions.get(first), junctions.get(last)];
    if (!ends[0] || !ends[1]) continue;
    const title = svg("title", {}, shown(`${name}: length ${length / 100}, clearance ${clearance / 100}`));
    if (first === last) {
      const [x, y] = places.robot(ends[0].point);
      group.append(svg("circle", { class: "link", cx: x, cy: y - 1, r: 1 }, title));
    } else group.append(svg("path", { class: "link", d: pathOf([ends.map((end) => end.point)], places.robot, false) }, title));
  }
  for (const [name, { point, clearance }] of junctions) {
    const [cx, cy] = places.robot(point);
    group.append(svg("circle", { class: "junction", cx, cy, r: 3 * at.unit }, svg("title", {}, shown(`${name}: clearance ${clearance / 100}`))));
  }
  return group;
}

// What was weighed for the decisions of the step, as far as it has a place: routes, and lines at which there may be a door.
// What was chosen is drawn solid.
function drawWeighed(at) {
  const group = svg("g", { class: "routes" }), { routes } = at.line.belief, lines = Array.isArray(routes) ? routes.map((route) => [route.points, route.chosen]) : [];
  for (const entry of at.episode.solved(at.step) || []) {
    const [name, , answer, about] = wholeDecision(at, entry);
    if (name === "routes" || !Array.isArray(answer) || !Array.isArray(about)) continue;
    const chosen = new Set(answer.map((atom) => (/^\w+\((\d{1,9})[,)]/.exec(atom) || [])[1]));
    about.forEach((points, number) => lines.push([points, chosen.has(String(number))]));
  }
  for (const [points, chosen] of lines.sort((a, b) => Boolean(a[1]) - Boolean(b[1]))) {
    if (!Array.isArray(points) || points.length < 2 || !points.every(isPoint)) continue;
    group.append(svg("path", { class: chosen ? "route chosen" : "route", d: pathOf([points], at.places.robot, false) }));
  }
  return group;
}
