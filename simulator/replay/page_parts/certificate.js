// The second checker of certificates, written from docs/certificates.md alone, whose words it uses. It shares nothing with
// the first one, which is in Python. In a page: checkCertificate(texts of episode and certificate). Without one:
// node certificate.js EPISODE CERTIFICATE..., one line for each; exit 0 where all are accepted, 1 where one is not.

const checkCertificate = (() => {
  // Numbers of the episode are decimals, and turned vectors are irrational. Both stand as integers of one unit, a part of a
  // square, so sums and comparisons are exact; cosines are rounded after their last digit, below 1e-60.
  const ONE = 10n ** 60n, GUARD = 10n ** 4n, FINE = ONE * GUARD, MAX_DECIMALS = 400, MAX_SQUARES = 1e5;
  const PI = 31415926535897932384626433832795028841971693993751058209749445923n; // in units of 1 / FINE
  const TOUCHES = [[0, 1], [1, 1], [1, 0], [1, -1], [0, -1], [-1, -1], [-1, 0], [-1, 1]];
  const DIRECTIONS = ["north", "northeast", "east", "southeast", "south", "southwest", "west", "northwest"];
  const CORNERS = { northeast: [1, 1], northwest: [-1, 1], southwest: [-1, -1], southeast: [1, -1] };
  const COMMANDS = ["move", "push", "turn", "grasp", "release"], AXES = [0, 1];

  class Refused extends Error {}
  const need = (holds, why) => { if (!holds) throw new Refused(why); };
  const same = (one, other) => JSON.stringify(one) === JSON.stringify(other);
  const isObject = (value) => value !== null && typeof value === "object" && !Array.isArray(value) && !(value instanceof Decimal);

  // ---- JSON, with numbers as they are written, and no key twice

  class Decimal {
    constructor(text) { this.text = text; }
  }
  const TOKEN = /[ \t\n\r]*(?:([{}[\],:])|("(?:[^"\\\u0000-\u001f]+|\\(?:["\\/bfnrt]|u[0-9a-fA-F]{4}))*")|(-?(?:0|[1-9]\d*)(?:\.\d+)?(?:[eE][+-]?\d+)?)|(true|false|null)|$)/y;

  function parsed(text) {
    let at = 0, token = null;
    const next = () => {
      TOKEN.lastIndex = at;
      token = TOKEN.exec(text);
      if (!token) throw new SyntaxError(`no JSON at character ${at}`);
      at = TOKEN.lastIndex;
      return token;
    };
    const sign = (...signs) => {
      if (!signs.includes(next()[1])) throw new SyntaxError(`no ${signs.join(" or ")} before character ${at}`);
      return token[1];
    };
    const items = (end, read) => {
      const before = at;
      if (next()[1] === end) return;
      at = before;
      do read(); while (sign(",", end) === ",");
    };
    function value() {
      const [, mark, string, number, word] = next();
      if (string !== undefined) return JSON.parse(string);
      if (word !== undefined) return JSON.parse(word);
      if (number !== undefined) return /^-?\d+$/.test(number) && Number.isSafeInteger(Number(number)) ? Number(number) : new Decimal(number);
      if (mark === "[") {
        const list = [];
        items("]", () => list.push(value()));
        return list;
      }
      if (mark !== "{") throw new SyntaxError(`no value before character ${at}`);
      const object = Object.create(null);
      items("}", () => {
        const key = next()[2];
        if (key === undefined) throw new SyntaxError(`no key before character ${at}`);
        const name = JSON.parse(key);
        if (name in object) throw new SyntaxError(`the key ${name} stands twice`);
        sign(":");
        object[name] = value();
      });
      return object;
    }
    const whole = value();
    if (next()[0].trim() !== "" || at < text.length) throw new SyntaxError("more than one value");
    return whole;
  }

  // A number as [digits, how many of them stand after the point].
  function decimal(number) {
    need(typeof number === "number" || number instanceof Decimal, "a number is missing");
    const [, mantissa, part = "", tens = "0"] = /^(-?\d+)(?:\.(\d+))?(?:[eE]([+-]?\d+))?$/.exec(number instanceof Decimal ? number.text : String(number));
    const places = part.length - Number(tens);
    need(Math.abs(places) <= MAX_DECIMALS, "a number has too many digits");
    return places < 0 ? [BigInt(mantissa + part) * 10n ** BigInt(-places), 0] : [BigInt(mantissa + part), places];
  }

  // A whole number of any size.
  function whole(value) {
    const text = value instanceof Decimal ? value.text : String(value);
    need((typeof value === "number" || value instanceof Decimal) && /^-?\d+$/.test(text), "a number is not whole");
    return BigInt(text);
  }

  // ---- intervals and boxes, in units

  const least = (a, b) => (a < b ? a : b), most = (a, b) => (a > b ? a : b);
  const plus = ([a, b], [c, d]) => [a + c, b + d], minus = ([a, b], [c, d]) => [a - d, b - c];
  const grown = ([a, b], by) => [a - by, b + by], moved = ([a, b], by) => [a + by, b + by];
  const cut = ([a, b], [c, d]) => [most(a, c), least(b, d)], hull = ([a, b], [c, d]) => [least(a, c), most(b, d)];
  const times = ([a, b], by) => (by < 0n ? [b * by, a * by] : [a * by, b * by]);
  const both = (of) => AXES.map(of), isEmpty = (box) => box.some(([a, b]) => a > b);
  const floor = (a, unit) => (a >= 0n ? a / unit : -((unit - 1n - a) / unit));
  const keyOf = ([i, j]) => `${i},${j}`;

  // Squares in whose inside a box has a part.
  function squaresUnder(box, unit) {
    const [[west, east], [south, north]] = both((k) => [Number(floor(box[k][0], unit)), Number(-floor(-box[k][1], unit)) - 1]);
    need((east - west + 1) * (north - south + 1) <= MAX_SQUARES, "a command leads further than is looked");
    const found = [];
    for (let i = west; i <= east; i += 1) for (let j = south; j <= north; j += 1) found.push([i, j]);
    return found;
  }

  // ---- the senses

  const FIELDS = [];
  [[4, 1], [8, 2], [16, 4]].forEach(([reach, side], zone, zones) => {
    const inner = zone ? zones[zone - 1][0] : 0;
    for (let north = reach - side; north >= -reach; north -= side) {
      for (let east = -reach; east < reach; east += side) {
        if (east >= -inner && east < inner && north >= -inner && north < inner) continue;
        const offsets = [];
        for (let e = east; e < east + side; e += 1) for (let n = north; n < north + side; n += 1) offsets.push([e, n]);
        FIELDS.push(offsets);
      }
    }
  });
  const OWN = FIELDS.findIndex((offsets) => offsets.length === 1 && same(offsets[0], [0, 0]));

  // The least and the greatest count that a field of so many squares shows as a level; null where none does.
  function countsOf(level, size) {
    const counts = [];
    for (let n = 0; n <= size; n += 1) if (Math.floor((14 * n + size) / (2 * size)) === level) counts.push(n);
    return counts.length ? [counts[0], counts.at(-1)] : null;
  }

  function cosine(degrees) {
    const x = (PI * BigInt(degrees)) / 180n;
    let sum = 0n, term = FINE;
    for (let n = 1n; term !== 0n; n += 2n) {
      sum += term;
      term = -(((term * x) / FINE) * x) / FINE / (n * (n + 1n));
    }
    return (sum + GUARD / 2n) / GUARD; // so those of 60 and 90 degrees are exact
  }
  const turns = new Map();
  // Cosine and sine of an angle, and what each offset samples for sure: a square beside that of the robot, or null.
  function turned(degrees) {
    if (!turns.has(degrees)) {
      const [c, s] = [cosine(degrees), cosine(90 - degrees)];
      const nearest = (value) => {
        const up = value + ONE / 2n, number = floor(up, ONE), rest = up - number * ONE, near = ONE / 10n ** 9n;
        return rest <= near || rest >= ONE - near ? null : Number(number);
      };
      const sample = ([e, n]) => {
        const [x, y] = [nearest(BigInt(e) * c - BigInt(n) * s), nearest(BigInt(e) * s + BigInt(n) * c)];
        return x === null || y === null ? null : [x, y];
      };
      turns.set(degrees, { c, s, fields: FIELDS.map((offsets) => offsets.map(sample)), touches: TOUCHES.map(sample) });
    }
    return turns.get(degrees);
  }
  const from = ([i, j], [x, y]) => [i + x, j + y];

  // ---- the episode

  function readEpisode(text) {
    const [header, ...lines] = text.split("\n").slice(0, -1).map(parsed);
    need(isObject(header) && header.utak === "episode" && header.version === 1 && isObject(header.task), "this is no episode");
    const steps = lines.filter((line) => !("result" in line));
    need(steps.length > 0 && lines.length - steps.length <= 1 && lines.slice(0, steps.length).every((line) => !("result" in line)), "the episode has no steps, or goes on after its result");
    steps.forEach((line, k) => {
      need(line.step === k && (k === 0 ? line.action === null : isObject(line.action) && COMMANDS.includes(line.action.do)), `step ${k} is no step`);
      need(Array.isArray(line.retina) && line.retina.length === FIELDS.length && line.retina.every((level, f) => f === OWN || countsOf(level, FIELDS[f].length)), `the retina of step ${k} shows no counts`);
      need(Array.isArray(line.touch) && line.touch.length === TOUCHES.length && line.touch.every((colour) => colour === null || /^[a-z]$/.test(colour)), `the touches of step ${k} are none`);
    });
    return { header, steps };
  }

  // Why cases say nothing of an episode; null where they do.
  function foreign({ header, steps }) {
    const { options } = header;
    if (decimal(options.noise)[0] !== 0n) return "the run is noisy";
    if ("forked" in header || "changes" in header || !same(options.kb, [])) return "the run was forked, changed or had rules of its own";
    if (steps.some((line) => "disturbed" in line)) return "others moved things";
    const takes = ({ action }, k) => action && action.do === "grasp" && steps[k - 1].touch[DIRECTIONS.indexOf(action.direction)] !== null;
    return steps.some(takes) ? "a grasp may have taken something" : null;
  }

  // ---- cases

  class World {
    constructor(episode) {
      this.steps = episode.steps;
      const moves = episode.steps.map(({ action }) => (action && action.do === "move" ? [decimal(action.east), decimal(action.north)] : [[0n, 0], [0n, 0]]));
      const places = Math.max(...moves.flat().map(([, count]) => count)); // of all moves: one unit for all
      this.moves = moves.map((move) => move.map(([digits, count]) => digits * 10n ** BigInt(places - count)));
      this.unit = ONE * 10n ** BigInt(places);
      this.tiny = this.unit / 10n ** 6n;
    }
    side(number) { return [BigInt(number) * this.unit, BigInt(number + 1) * this.unit]; }
    begin(degrees) {
      return { degrees, squares: [[0, 0]], waking: both(() => this.side(0)), ways: [both(() => [0n, 0n])], swept: [[]], settled: new Map() };
    }

    // Where a command may have ended: the squares that are swept, and new squares, way and waking boxes by square.
    ends(degrees, k, square, waking, way, settled) {
      const [e, n] = this.moves[k], { c, s } = turned(degrees), v = [e * c - n * s, e * s + n * c], { unit, tiny } = this;
      if (v[0] === 0n && v[1] === 0n) return { swept: [], found: new Map([[keyOf(square), { square, waking, way }]]) };
      const box = both((a) => cut(grown(plus(waking[a], way[a]), 2n * tiny), this.side(square[a])));
      const lines = both((a) => hull(box[a], moved(box[a], v[a])));
      const across = ([x, y]) => plus(times(x, -v[1]), times(y, v[0])), [low, high] = across(box); // how far to the side of v
      const swept = squaresUnder(lines, unit).filter((one) => {
        const [right, left] = across(both((a) => this.side(one[a])));
        return right < high && left > low;
      });
      const barred = new Set(swept.map(keyOf).filter((key) => settled.get(key) !== false));
      const ways = new Map();
      const ended = (reach, itsWay) => {
        for (const one of squaresUnder(reach, unit)) {
          const key = keyOf(one), known = ways.get(key);
          ways.set(key, { square: one, way: known ? both((a) => hull(known.way[a], itsWay[a])) : itsWay });
        }
      };
      ended(both((a) => grown(moved(box[a], v[a]), tiny)), both((a) => moved(way[a], v[a])));
      const leads = both((a) => (v[a] > 0n ? [0, 1] : v[a] < 0n ? [0, -1] : [0]));
      for (const one of swept) {
        if (!leads[0].some((i) => leads[1].some((j) => barred.has(keyOf(from(one, [i, j])))))) continue;
        const part = both((a) => cut(this.side(one[a]), lines[a]));
        const itsWay = both((a) => cut(hull(way[a], moved(way[a], v[a])), grown(minus(part[a], waking[a]), tiny)));
        if (!isEmpty(itsWay)) ended(both((a) => (v[a] === 0n ? grown(part[a], tiny) : part[a])), itsWay);
      }
      const found = new Map();
      for (const [key, { square: one, way: its }] of ways) {
        const sides = both((a) => grown(this.side(one[a]), tiny)), kept = both((a) => cut(its[a], minus(sides[a], waking[a])));
        const left = both((a) => cut(waking[a], minus(sides[a], kept[a])));
        if (!isEmpty(kept) && !isEmpty(left)) found.set(key, { square: one, way: kept, waking: left });
      }
      return { swept: swept.map(keyOf), found };
    }

    // The cases after a case's next command, by square.
    following(one) {
      const k = one.squares.length;
      need(k < this.steps.length, "no command is left");
      const { swept, found } = this.ends(one.degrees, k, one.squares.at(-1), one.waking, one.ways.at(-1), one.settled);
      return new Map([...found].map(([key, { square, waking, way }]) => [key, { ...one, waking, settled: new Map(one.settled), squares: [...one.squares, square], ways: [...one.ways, way], swept: [...one.swept, swept] }]));
    }

    // Works a case's ways out again; whether it still stands.
    replay(one) {
      for (let k = 1; k < one.squares.length; k += 1) {
        const { swept, found } = this.ends(one.degrees, k, one.squares[k - 1], one.waking, one.ways[k - 1], one.settled);
        const end = found.get(keyOf(one.squares[k]));
        if (!end) return false;
        one.waking = end.waking;
        one.ways[k] = end.way;
        one.swept[k] = swept;
      }
      return true;
    }

    // Adds counts up and settles squares; whether the case still stands.
    count(one, terms) {
      const weights = new Map();
      let [low, high] = [0n, 0n];
      for (const term of terms) {
        need(Array.isArray(term) && term.length === 3, "a term of a count is [step, field, multiplier]");
        const [k, f] = term, m = whole(term[2]);
        need(Number.isInteger(k) && k >= 0 && k < one.squares.length && Number.isInteger(f) && f >= 0 && f < FIELDS.length && f !== OWN, "a count is of no field seen so far");
        const samples = turned(one.degrees).fields[f], [least, most] = countsOf(this.steps[k].retina[f], samples.length).map(BigInt);
        const sure = samples.filter((sample) => sample !== null), doubtful = BigInt(samples.length - sure.length);
        for (const sample of sure) {
          const key = keyOf(from(one.squares[k], sample));
          weights.set(key, (weights.get(key) || 0n) + m);
        }
        low += m > 0n ? m * (least - doubtful) : m * most;
        high += m > 0n ? m * most : m * (least - doubtful);
      }
      let fixed = 0n, negative = 0n, positive = 0n;
      for (const [key, weight] of weights) {
        const occupied = one.settled.get(key);
        if (occupied) fixed += weight;
        if (occupied === undefined && weight < 0n) negative += weight;
        if (occupied === undefined && weight > 0n) positive += weight;
      }
      if (fixed + negative > high || fixed + positive < low) return false;
      for (const [key, weight] of weights) {
        if (weight === 0n || one.settled.has(key)) continue;
        const size = weight > 0n ? weight : -weight, free = fixed + negative + size > high, needed = fixed + positive - size < low;
        if (free || needed) one.settled.set(key, free ? weight < 0n : weight > 0n);
      }
      return true;
    }

    // What a case settles, for whoever draws it: the angle, the squares by key, where the robot stands at each step (bounds in
    // each axis), and the squares that were felt as verge.
    drawn(one) {
      const inSquares = (interval) => interval.map((value) => Number((value * 1000000n) / this.unit) / 1e6);
      return {
        degrees: one.degrees, settled: one.settled,
        places: one.ways.map((way, k) => both((a) => inSquares(cut(plus(one.waking[a], way[a]), this.side(one.squares[k][a]))))),
        verge: [...this.felt(one).values()].filter(({ colours }) => colours.has("b")).map(({ at }) => at),
      };
    }

    // ---- what a case shows

    // Squares that were felt for sure up to the last step of a case, with the colours.
    felt(one) {
      const found = new Map();
      one.squares.forEach((square, k) => turned(one.degrees).touches.forEach((sample, t) => {
        if (sample === null) return;
        const at = from(square, sample), key = keyOf(at);
        if (!found.has(key)) found.set(key, { at, colours: new Set() });
        found.get(key).colours.add(this.steps[k].touch[t]);
      }));
      return found;
    }

    atCorner(one, step, [a, b]) {
      const { c, s } = turned(one.degrees), u = BigInt(a) * c - BigInt(b) * s, v = BigInt(a) * s + BigInt(b) * c;
      if (u === 0n || v === 0n) return false;
      const reach = ([i, j]) => u * BigInt(i + (u > 0n)) + v * BigInt(j + (v > 0n)), [i, j] = one.squares[step], limit = reach([i, j]);
      const settled = (x, y) => one.settled.get(keyOf([x, y]));
      if (settled(i, j) !== false || settled(i + (u > 0n ? 1 : -1), j) !== true || settled(i, j + (v > 0n ? 1 : -1)) !== true) return false;
      return one.squares.slice(0, step + 1).every((square, k) => reach(square) <= limit && turned(one.degrees).fields.every((samples, f) => {
        if (f === OWN) return true;
        const further = samples.filter((sample) => sample !== null && reach(from(square, sample)) > limit).length;
        return further <= countsOf(this.steps[k].retina[f], samples.length)[1];
      }));
    }

    atStart(one, step) {
      return same(one.squares[step], [0, 0]) || one.ways[step].every(([low, high]) => low >= -this.unit && high <= this.unit);
    }

    circled(one, step, [k, t]) {
      const track = one.ways.slice(0, step + 1), sample = turned(one.degrees).touches[t];
      if (sample === null || !track.every((way) => way.every(([low, high]) => low === high)) || track.at(-1).some(([low]) => low !== 0n)) return false;
      const square = from(one.squares[k], sample), key = keyOf(square);
      if (one.swept.slice(0, step + 1).some((keys) => keys.includes(key)) || one.squares.slice(0, step + 1).some((other) => keyOf(other) === key)) return false;
      const [x, y] = both((a) => { // twice: middles are whole units then
        const [low, high] = this.side(square[a]), [first, last] = one.waking[a];
        return low + high - first - last;
      });
      const points = track.map(([[east], [north]]) => [2n * east - x, 2n * north - y]);
      let winds = 0;
      for (let n = 0; n < points.length; n += 1) {
        const [[x0, y0], [x1, y1]] = [points[n], points[(n + 1) % points.length]], side = x0 * y1 - x1 * y0;
        if (side === 0n && x0 * x1 <= 0n && y0 * y1 <= 0n) return false; // the way leads over the point
        if (y0 <= 0n && y1 > 0n && side > 0n) winds += 1;
        if (y0 > 0n && y1 <= 0n && side < 0n) winds -= 1;
      }
      return winds !== 0;
    }

    shutIn(one) {
      const felt = this.felt(one), verge = [...felt.values()].filter(({ colours }) => colours.has("b")).map(({ at }) => at);
      const [[west, east], [south, north]] = both((a) => [Math.min(...verge.map((at) => at[a])), Math.max(...verge.map((at) => at[a]))]);
      if (!(verge.length && west < 0 && east > 0 && south < 0 && north > 0)) return false;
      const isVerge = new Set(verge.map(keyOf)), onFrame = (i, j) => i === west || i === east || j === south || j === north;
      if (!verge.every(([i, j]) => onFrame(i, j))) return false;
      for (let i = west; i <= east; i += 1) {
        for (let j = south; j <= north; j += 1) {
          const key = keyOf([i, j]), ends = (i === west || i === east) && (j === south || j === north);
          const inside = !onFrame(i, j) && (i === west + 1 || i === east - 1 || j === south + 1 || j === north - 1);
          if (onFrame(i, j) && !ends && !isVerge.has(key)) return false;
          if (inside && one.settled.get(key) !== false && !felt.has(key)) return false;
        }
      }
      return true;
    }
  }

  // ---- goals

  // What a goal asks for: { word, kind, of }; kind is null where certificates show nothing of it.
  function goalOf(text) {
    const [, word, goal] = /^(first|then|prefer)\((.*)\)$/.exec(text) || [null, "", text];
    const corner = /^at\(utak,corner\((\w+)\)\)$/.exec(goal), thing = /^(at|beside|circled)\(utak,([a-z]\w*)\)$/.exec(goal);
    if (corner && corner[1] in CORNERS) return { text, word, kind: "corner", of: corner[1] };
    if (goal === "at(utak,start)") return { text, word, kind: "start" };
    if (thing) return { text, word, kind: thing[1] === "circled" ? "circled" : "felt", of: thing[2] };
    return { text, word, kind: null, leaves: goal === "in(utak,room(next))" || /^through\(utak,\w+\)$/.test(goal) };
  }

  // What stands for granted besides, for things that were felt.
  function claimsOf(task, colours) {
    const found = [];
    for (const [name, colour] of colours) {
      for (const [fact] of task.claims) {
        if (!new RegExp(`\\b${name}\\b`).test(fact)) continue;
        const own = new RegExp(`^colour\\(${name},(\\w+)\\)$`).exec(fact);
        need(!own || own[1] === colour, `${name} is said to have another colour than what was felt`);
        if (!own && !found.includes(fact)) found.push(fact);
      }
    }
    return found;
  }

  function checkDone(certificate, episode, goals) {
    const last = episode.steps.length - 1, { steps, meaning } = certificate, counted = goals.filter(({ word }) => word !== "prefer");
    const unknown = counted.find(({ kind, of }) => kind === null || (of && kind !== "corner" && episode.header.task.parameters[of] !== "object"));
    need(counted.length > 0, "there is no goal to be shown");
    need(!unknown, `certificates show nothing of ${unknown && unknown.text}`);
    need(Array.isArray(steps) && steps.length === counted.length, "there is not one step for each goal");
    let before = 0;
    counted.forEach((goal, n) => {
      const step = steps[n], staged = goal.word === "first" || goal.word === "then";
      need(Number.isInteger(step) && (staged ? step >= before && step <= last : step === last), `${goal.text} is not shown of a step at which it must hold`);
      if (staged) before = step;
      goal.step = step;
    });
    const named = counted.filter(({ kind }) => kind === "felt" || kind === "circled"), names = [...new Set(named.map(({ of }) => of))];
    need(isObject(meaning) && same(Object.keys(meaning), names), "it is not said what each object of the goals means");
    const colours = new Map(Object.entries(meaning).map(([name, touch]) => {
      need(Array.isArray(touch) && touch.length === 2 && touch.every(Number.isInteger) && episode.steps[touch[0]] && touch[1] in TOUCHES, `${name} means no touch`);
      const colour = episode.steps[touch[0]].touch[touch[1]];
      need(colour !== null && colour !== "b", `${name} means a touch that felt no thing`);
      return [name, colour];
    }));
    need(new Set(colours.values()).size === colours.size, "two objects mean one letter");
    for (const { kind, of, step, text } of named) need(kind !== "felt" || meaning[of][0] === step, `${text} is not felt at its step`);
    return { given: claimsOf(episode.header.task, colours), counted, says: counted.map(({ text }) => text).join(", ") };
  }

  function checkImpossible({ steps, meaning }, episode, goals) {
    need(same(steps, [episode.steps.length - 1]), "impossible is shown of the last step");
    need(isObject(meaning) && Object.keys(meaning).length === 0, "impossible means nothing");
    const barred = goals.find(({ word, leaves }) => word !== "prefer" && leaves);
    need(barred, "certificates show of none of these goals that it is impossible");
    return { given: ["whole(squares)", "isolated(things)"], counted: null, says: barred.text };
  }

  // Whether a case shows what is claimed.
  function shows(world, one, counted, meaning) {
    if (counted === null) return world.shutIn(one);
    return counted.every(({ kind, of, step }) => kind === "felt" || (kind === "start" ? world.atStart(one, step)
      : kind === "corner" ? world.atCorner(one, step, CORNERS[of]) : world.circled(one, step, meaning[of])));
  }

  // Reads the lines of cases; returns the cases that show the goals.
  function readCases(lines, world, angles, holds) {
    const open = [], shown = [];
    let one = null, angle = 0;
    const done = () => {
      one = null;
      while (open.length && open.at(-1).size === 0) open.pop();
    };
    lines.forEach((line, number) => {
      const [word, ...values] = Array.isArray(line) ? line : [], at = `line ${number} of the cases: `, wholes = values.every(Number.isInteger);
      if (word === "angle") {
        need(one === null && open.length === 0 && same(values, [angle]) && angle < angles, `${at}a case is left, or this is not the next angle`);
        one = world.begin(angle);
        angle += 1;
      } else if (word === "end") {
        need(values.length === 2 && wholes && (one || open.length), `${at}no case is there`);
        if (one) open.push(world.following(one));
        const key = keyOf(values);
        need(open.at(-1).has(key), `${at}no command ends there, or it was treated`);
        one = open.at(-1).get(key);
        open.at(-1).delete(key);
      } else {
        need(one, `${at}no case is there`);
        if (word === "count") {
          if (!world.count(one, values)) done();
        } else if (word === "replay" && values.length === 0) {
          if (!world.replay(one)) done();
        } else {
          need(word === "holds" && values.length === 0, `${at}there is no such line`);
          need(one.squares.length === world.steps.length, `${at}commands are left`);
          need(holds(one), `${at}this case does not show the goals`);
          shown.push(world.drawn(one));
          done();
        }
      }
    });
    need(one === null && open.length === 0 && angle === angles, "a case is left");
    need(shown.length > 0, "the episode agrees with no world");
    return shown;
  }

  const KEYS = ["cases", "claim", "given", "goals", "meaning", "steps", "utak", "version"];

  function checked(episodeText, certificateText) {
    const certificate = parsed(certificateText), episode = readEpisode(episodeText), { task } = episode.header;
    need(isObject(certificate) && same(Object.keys(certificate).sort(), KEYS), "these are not the keys of a certificate");
    const { claim, given, cases, meaning } = certificate;
    need(certificate.utak === "certificate" && certificate.version === 1, "this is no certificate of version 1");
    need(claim === "done" || claim === "impossible", "done and impossible can be claimed");
    need(Array.isArray(certificate.goals) && same(certificate.goals, task.goals), "the goals are not those of the episode");
    const goals = task.goals.map(goalOf), wanted = (claim === "done" ? checkDone : checkImpossible)(certificate, episode, goals);
    const along = Array.isArray(given) && given.at(-1) === "along(grid)";
    need(same(along ? given.slice(0, -1) : given, wanted.given), "what is taken for granted is not what the task says");
    const simple = wanted.counted !== null && wanted.counted.every(({ kind }) => kind === "felt");
    need(Array.isArray(cases) && (cases.length === 0) === simple, simple ? "touches show these goals, and no cases" : "cases are missing");
    let shown = [];
    if (!simple) {
      const why = foreign(episode), world = new World(episode);
      need(why === null, why);
      shown = readCases(cases, world, along ? 1 : 90, (one) => shows(world, one, wanted.counted, meaning));
    }
    const touches = Object.entries(meaning).map(([name, [step, touch]]) => ({ name, step, offset: TOUCHES[touch] }));
    return { accepted: true, says: `${claim}: ${wanted.says}` + (given.length ? `, given ${given.join(", ")}` : ""), shown, touches };
  }

  // Returns { accepted, says: what is shown, or why it is refused; shown: the cases that show it, as `drawn` has them; touches:
  // what was felt of the objects of the goals }.
  return (episodeText, certificateText) => {
    try {
      return checked(episodeText, certificateText);
    } catch (error) {
      if (error instanceof Refused) return { accepted: false, says: error.message, shown: [], touches: [] };
      return { accepted: false, says: `the episode or the certificate is damaged: ${error.message}`, shown: [], touches: [] };
    }
  };
})();

if (typeof module !== "undefined") {
  const read = (path) => require("fs").readFileSync(path, "utf8"), [, , episode, ...certificates] = process.argv;
  for (const path of certificates) {
    const { accepted, says } = checkCertificate(read(episode), read(path));
    console.log(`${accepted ? "accepted" : "refused"}: ${says}`);
    if (!accepted) process.exitCode = 1;
  }
}
