// The second checker of certificates, written from docs/certificates.md alone, whose words it uses. It shares nothing with
// the first one, which is in Python. In a page: checkCertificate(texts of episode and certificate). Without one:
// node certificate.js EPISODE CERTIFICATE..., one line for each; exit 0 where all are accepted, 1 where one is not.

const checkCertificate = (() => {
  // Numbers of the episode are decimals, and turned vectors are irrational. Both stand as integers of one unit, a part of a
  // square, so sums and comparisons are exact; cosines are rounded after their last digit, below 1e-60.
  const ONE = 10n ** 60n, GUARD = 10n ** 4n, FINE = ONE * GUARD, MAX_DECIMALS = 400, MAX_SQUARES = 20000;
  const PI = 31415926535897932384626433832795028841971693993751058209749445923n; // in units of 1 / FINE
  const TOUCHES = [[0, 1], [1, 1], [1, 0], [1, -1], [0, -1], [-1, -1], [-1, 0], [-1, 1]];
  const DIRECTIONS = ["north", "northeast", "east", "southeast", "south", "southwest", "west", "northwest"];
  const CORNERS = { northeast: [1, 1], northwest: [-1, 1], southwest: [-1, -1], southeast: [1, -1] };
  const COMMANDS = ["move", "push", "turn", "grasp", "release"], AXES = [0, 1];

  class Refused extends Error {}
  const need = (holds, why) => { if (!holds) throw new Refused(why); };
  const same = (one, other) => JSON.stringify(one) === JSON.stringify(other);
  const isObject = (value) => value !== null && typeof value === "object" && !Array.isArray(value) && !(value instanceof Decimal);

  // ---- JSON, with numbers as they are written

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
  const spanOf = (squares, a) => Math.max(...squares.map((square) => square[a])) - Math.min(...squares.map((square) => square[a])) + 1;
  const isWithin = (spells, time) => spells.some(([grasp, end]) => grasp < time && time <= end);

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
    if ("forked" in header || "changes" in header || !same(options.kb, [])) return "the run was forked, changed or had rules of its own";
    return steps.some((line) => "disturbed" in line) ? "others moved things" : null;
  }

  // ---- noise

  const MILLION = 10n ** 6n;
  // The least whole number with at least this square.
  function root(square) {
    let found = 1n;
    while (found * found < square) found *= 2n;
    for (let step = found / 2n; step > 0n; step /= 2n) if ((found - step) ** 2n >= square) found -= step;
    return found;
  }
  // How far noise leads a command of step k, and of a length, beside its end, but for its part of a risk; rounded up.
  function astray([digits, places], k, risk, length) {
    const bits = BigInt(((MILLION * BigInt(k * (k + 1))) / risk).toString(2).length), tens = 10n ** BigInt(2 * places);
    const part = root((digits * digits * bits * 13863n * MILLION * 100n + tens - 1n) / tens); // in millionths
    return (length * part * (5n * MILLION + part)) / (5n * MILLION * MILLION) + 1n;
  }

  // ---- cases

  class World {
    // noise: of the run, as a decimal; risk: in millionths, 0 without noise; isSingle: no two things are of one colour.
    constructor(episode, noise, risk, isSingle) {
      this.steps = episode.steps;
      this.isSingle = isSingle;
      const leads = (action) => action && (action.do === "move" || action.do === "push");
      const vectors = episode.steps.map(({ action }) => (leads(action) ? [decimal(action.east), decimal(action.north)] : [[0n, 0], [0n, 0]]));
      const places = Math.max(...vectors.flat().map(([, count]) => count)); // of all commands: one unit for all
      this.vectors = vectors.map((vector) => vector.map(([digits, count]) => digits * 10n ** BigInt(places - count)));
      this.unit = ONE * 10n ** BigInt(places);
      this.tiny = this.unit / 10n ** 6n;
      this.astray = this.vectors.map(([e, n], k) => (risk && (e || n) ? astray(noise, k, BigInt(risk), root((e * e + n * n) * ONE * ONE)) : 0n));
    }
    side(number) { return [BigInt(number) * this.unit, BigInt(number + 1) * this.unit]; }
    box(square) { return both((a) => this.side(square[a])); }
    begin(degrees) {
      return { degrees, squares: [[0, 0]], places: [this.box([0, 0])], swept: [[]], held: [[]], changes: new Map(), settled: new Map() };
    }

    // ---- what is settled: of a square from one change to the next

    // The steps from which on something is settled of a square by itself: 0, and those at which it was changed, up to a step.
    times(one, square, step = this.steps.length) { return [0, ...(one.changes.get(keyOf(square)) || []).filter((k) => k <= step)]; }
    at(one, square, step) { return one.settled.get(`${keyOf(square)},${this.times(one, square, step).at(-1)}`); }
    settle(one, square, step, occupied) { one.settled.set(`${keyOf(square)},${this.times(one, square, step).at(-1)}`, occupied); }
    wasFree(one, square) { return this.times(one, square).some((k) => one.settled.get(`${keyOf(square)},${k}`) === false); }

    // The square of a touch; null where that is not sure.
    touched(one, [k, t]) {
      const sample = turned(one.degrees).touches[t];
      return sample && from(one.squares[k], sample);
    }

    // Some squares, and all that lead to them by edges over open squares, by key; ends once there are too many.
    spread(squares, isOpen) {
      const found = new Map(squares.map((square) => [keyOf(square), square]));
      for (const square of found.values()) { // grows while it is gone through
        if (found.size > MAX_SQUARES) break;
        for (const offset of [[0, 1], [1, 0], [0, -1], [-1, 0]]) {
          const next = from(square, offset);
          if (!found.has(keyOf(next)) && isOpen(next)) found.set(keyOf(next), next);
        }
      }
      return found;
    }

    // Squares, and all that lead to them by edges over squares that are not settled as free.
    unsettled(one, squares, step) {
      return [...this.spread(squares, (square) => this.at(one, square, step) !== false).values()];
    }

    // Squares in which all lies of what a touch felt, at its step.
    piece(one, [k, t]) {
      if ([null, "b"].includes(this.steps[k].touch[t])) return [];
      const first = this.touched(one, [k, t]);
      need(first, "it is not sure which square was touched");
      let within = null;
      for (let g = 1; g <= k && !within; g += 1) { // what was grasped before is as wide as it was
        const { action } = this.steps[g];
        if (action.do !== "grasp") continue;
        const touch = [g - 1, DIRECTIONS.indexOf(action.direction)];
        if (!this.covered(one, touch, k).some((square) => same(square, first))) continue;
        const { lies } = this.extent(one, touch, k);
        within = lies.length ? new Set(lies.map(keyOf)) : null;
      }
      const found = within ? [...this.spread([first], (square) => within.has(keyOf(square))).values()] : this.unsettled(one, [first], k);
      need(found.length <= MAX_SQUARES, "what was touched may reach too far");
      return found;
    }

    // ---- commands

    // The cases after a case's next command, by square.
    following(one) {
      const k = one.squares.length, square = one.squares.at(-1), place = one.places.at(-1), { unit, tiny } = this;
      need(k < this.steps.length, "no command is left");
      const { action } = this.steps[k], held = one.held.at(-1).filter((other) => this.at(one, other, k - 1) !== false);
      need(held.length === 0 || ["push", "release"].includes(action.do), "what may be held is neither pushed nor released");
      const [e, n] = action.do === (held.length ? "push" : "move") ? this.vectors[k] : [0n, 0n], { c, s } = turned(one.degrees);
      const v = [e * c - n * s, e * s + n * c], isLed = v.some((part) => part !== 0n);
      const after = (end, itsPlace, swept, itsHeld) => {
        const next = {
          degrees: one.degrees, squares: [...one.squares, end], places: [...one.places, itsPlace], swept: [...one.swept, swept],
          held: [...one.held, itsHeld], changes: new Map(one.changes), settled: new Map(one.settled),
        };
        if (!isLed || !held.length) return next;
        const before = new Set(one.held.at(-1).map(keyOf)), changed = new Map([...held, ...itsHeld].map((other) => [keyOf(other), other]));
        for (const [key, other] of changed) next.changes.set(key, [...(one.changes.get(key) || []), k]);
        for (const [key, other] of changed) if (!before.has(key) && this.at(one, other, k - 1)) this.settle(next, other, k, true);
        return next;
      };
      if (!isLed) {
        const taken = action.do === "grasp" ? this.piece(one, [k - 1, DIRECTIONS.indexOf(action.direction)]) : action.do === "release" ? [] : held;
        return new Map([[keyOf(square), after(square, place, [], taken)]]);
      }
      const noise = this.astray[k], about = both((a) => grown(place[a], noise)), lines = both((a) => hull(about[a], moved(about[a], v[a])));
      const across = ([x, y]) => plus(times(x, -v[1]), times(y, v[0])), [low, high] = across(about); // how far to the side of v
      const swept = squaresUnder(lines, unit).filter((one) => {
        const [right, left] = across(this.box(one));
        return right < high && left > low;
      });
      const barred = new Set(swept.filter((other) => this.at(one, other, k - 1) !== false).map(keyOf));
      const ends = new Map();
      const ended = (box) => {
        for (const end of squaresUnder(box, unit)) {
          const known = ends.get(keyOf(end));
          ends.set(keyOf(end), { end, box: known ? both((a) => hull(known.box[a], box[a])) : box });
        }
      };
      ended(both((a) => grown(moved(about[a], v[a]), tiny)));
      const ahead = both((a) => [0, ...(v[a] > -noise ? [1] : []), ...(v[a] < noise ? [-1] : [])]);
      for (const other of swept) {
        if (!held.length && !ahead[0].some((i) => ahead[1].some((j) => barred.has(keyOf(from(other, [i, j])))))) continue;
        ended(both((a) => grown(cut(this.side(other[a]), lines[a]), v[a] === 0n ? tiny : 0n)));
      }
      const sweptKeys = swept.map(keyOf);
      return new Map([...ends].map(([key, { end, box }]) => {
        const itsPlace = both((a) => cut(box[a], this.side(end[a])));
        return [key, after(end, itsPlace, sweptKeys, held.length ? this.carried(one, itsPlace) : [])];
      }));
    }

    // Squares in which all lies of what was taken by the last grasp, once the robot is in a place.
    carried(one, place) {
      const k = this.steps.findLastIndex(({ action }, step) => step < one.squares.length && action && action.do === "grasp");
      const by = both((a) => grown(minus(place[a], one.places[k][a]), this.tiny)), found = new Map();
      for (const square of one.held[k].filter((other) => this.at(one, other, k) !== false)) {
        for (const other of squaresUnder(both((a) => plus(this.side(square[a]), by[a])), this.unit)) found.set(keyOf(other), other);
      }
      return [...found.values()];
    }

    // Works a case's places out again, and what stays occupied beside what is carried; whether it still stands.
    replay(one) {
      let again = { ...this.begin(one.degrees), settled: one.settled };
      for (const square of one.squares.slice(1)) {
        again = this.following(again).get(keyOf(square));
        if (!again) return false;
      }
      Object.assign(one, { places: again.places, swept: again.swept, settled: again.settled });
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
          const square = from(one.squares[k], sample), key = `${keyOf(square)},${this.times(one, square, k).at(-1)}`;
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

    // What a case settles, for whoever draws it: the angle, the squares that are occupied or free at a step, those that the thing of
    // a touch covers at one, where the robot is at each step (bounds in each axis), and the squares that were felt as verge.
    drawn(one) {
      const inSquares = (interval) => interval.map((value) => Number((value * 1000000n) / this.unit) / 1e6);
      const squares = [...new Set([...one.settled.keys()].map((key) => key.replace(/,\d+$/, "")))].map((key) => key.split(",").map(Number));
      return {
        degrees: one.degrees, places: one.places.map((place) => place.map(inSquares)),
        settled: (step, occupied) => squares.filter((square) => this.at(one, square, step) === occupied),
        covered: (touch, step) => this.covered(one, touch, step),
        verge: [...this.felt(one).values()].filter(({ colour }) => colour === "b").map(({ square }) => square),
      };
    }

    // ---- what a case shows

    // Squares that were felt for sure, with the colour of the last touch.
    felt(one) {
      const found = new Map();
      one.squares.forEach((_, k) => TOUCHES.forEach((_, t) => {
        const square = this.touched(one, [k, t]);
        if (square) found.set(keyOf(square), { square, colour: this.steps[k].touch[t] });
      }));
      return found;
    }

    // The grasps after a step, up to another: each with its square, and the last step of its spell.
    grasps(one, after, upTo) {
      const found = [];
      for (let g = after + 1; g <= upTo; g += 1) {
        const { action } = this.steps[g];
        if (action.do !== "grasp") continue;
        let end = g;
        while (end < upTo && one.held[end + 1].length) end += 1;
        found.push({ grasp: g, end, square: this.touched(one, [g - 1, DIRECTIONS.indexOf(action.direction)]) });
      }
      return found;
    }

    // Squares that the thing of a touch, or else the robot, covers at a step for sure.
    covered(one, touch, step) { return this.followed(one, touch, step).covered; }
    // The same, with its spells.
    followed(one, touch, step) {
      if (!touch) return { covered: [one.squares[step]], spells: [] };
      const spells = [];
      for (const { grasp, end, square } of this.grasps(one, touch[0], step)) {
        if (square && this.coveredBy(one, touch, grasp - 1, spells).some((other) => same(other, square))) spells.push([grasp, end]);
      }
      return { covered: this.coveredBy(one, touch, step, spells), spells };
    }

    // The same, by the spells of the thing.
    coveredBy(one, [k, t], step, spells) {
      const found = new Map(), inSpells = (time) => isWithin(spells, time), touches = [[k, t]];
      if (this.isSingle) {
        const colour = this.steps[k].touch[t];
        for (let g = 0; g <= step; g += 1) this.steps[g].touch.forEach((other, n) => { if (other === colour) touches.push([g, n]); });
      }
      for (const [g, n] of touches) {
        const square = g <= step ? this.touched(one, [g, n]) : null;
        if (square && !this.times(one, square, step).some((time) => time > g)) found.set(keyOf(square), square);
      }
      for (const key of one.changes.keys()) {
        const other = key.split(",").map(Number), times = this.times(one, other, step);
        const free = times.findLastIndex((time) => one.settled.get(`${key},${time}`) === false);
        if (free >= 0 && this.at(one, other, step) && times.slice(free + 1).every(inSpells)) found.set(key, other);
      }
      return [...found.values()];
    }

    // Squares in which all of the thing of a touch began, and in which all of it lies at a step; without a touch those of the robot.
    extent(one, touch, step) {
      if (!touch) return { began: [[0, 0]], lies: [one.squares[step]] };
      const began = this.piece(one, touch), [k] = touch;
      if (k > step || one.held[k].length || began.some((square) => this.times(one, square, k).length > 1)) return { began: [], lies: [] };
      let lies = new Map(began.map((square) => [keyOf(square), square]));
      for (const { end, square } of this.grasps(one, k, step)) {
        if (!square || !lies.has(keyOf(square))) continue;
        const isTaken = this.covered(one, touch, end).some((other) => !lies.has(keyOf(other)));
        lies = new Map([...(isTaken ? [] : lies), ...one.held[end].map((other) => [keyOf(other), other])]);
      }
      const covered = this.covered(one, touch, step), part = this.unsettled(one, covered, step), inPart = new Set(part.map(keyOf)), isBounded = part.length > 0 && part.length <= MAX_SQUARES;
      const isNear = (square) => covered.every((other) => AXES.every((a) => Math.abs(square[a] - other[a]) <= spanOf(began, a))); // it is no wider than it was
      return { began, lies: [...lies.values()].filter((square) => this.at(one, square, step) !== false && (!isBounded || inPart.has(keyOf(square))) && isNear(square)) };
    }

    // Whether all of the thing of a touch, or of the robot, began in one of the rooms of a door and is in the other.
    throughDoor(one, frames, touch, step) {
      if (frames.length !== 3 || !frames.every((frame) => Array.isArray(frame) && frame.length === 4 && frame.every(Number.isInteger))) return false;
      const sizes = frames.map(([w, s, e, n]) => [e - w + 1, n - s + 1]);
      if (sizes.some((size) => Math.min(...size) < 1 || size[0] * size[1] > MAX_SQUARES)) return false;
      const { began, lies } = this.extent(one, touch, step);
      const within = ([w, s, e, n]) => ([i, j]) => w <= i && i <= e && s <= j && j <= n;
      const isAllIn = (squares, frame) => squares.length > 0 && squares.every(within(frame));
      const [door, ...rooms] = frames;
      if (![rooms, [...rooms].reverse()].some(([first, last]) => isAllIn(began, first) && isAllIn(lies, last))) return false;
      const squares = new Map();
      for (const [w, s, e, n] of frames) for (let i = w; i <= e; i += 1) for (let j = s; j <= n; j += 1) squares.set(keyOf([i, j]), [i, j]);
      const trodden = new Set([...began, ...one.squares.slice(0, step + 1)].map(keyOf));
      const hidden = [...squares].filter(([key, square]) => !trodden.has(key) && !this.wasFree(one, square)).map(([, square]) => square);
      if (squares.size > MAX_SQUARES || !this.unsettled(one, hidden, step).every((square) => squares.has(keyOf(square)))) return false;
      const beganIn = new Set(began.map(keyOf)), liesIn = new Set(lies.map(keyOf));
      const isWall = (square) => (one.settled.get(`${keyOf(square)},0`) === true && !beganIn.has(keyOf(square)))
        || (this.at(one, square, step) === true && !liesIn.has(keyOf(square)));
      return AXES.some((a) => { // the door leads along this axis
        const b = 1 - a, [before, after] = rooms[0][a] < door[a] ? rooms : [rooms[1], rooms[0]], wide = door[b + 2] - door[b] + 1;
        if (before[a + 2] + 1 !== door[a] || after[a] - 1 !== door[a + 2]) return false;
        if (!rooms.every((room) => room[b] <= door[b] && door[b + 2] <= room[b + 2] && AXES.every((c) => room[c + 2] - room[c] + 1 >= 2 * wide))) return false;
        let walled = 0;
        for (let x = door[a]; x <= door[a + 2]; x += 1) if ([door[b] - 1, door[b + 2] + 1].every((y) => isWall(a === 0 ? [x, y] : [y, x]))) walled += 1;
        return walled > 0 && door[a + 2] - door[a] + 1 - walled < 2 * wide;
      });
    }

    // Whether what the thing of a touch, or the robot, covers ends in the corner.
    atCorner(one, step, [a, b], touch) {
      const { c, s } = turned(one.degrees), u = BigInt(a) * c - BigInt(b) * s, v = BigInt(a) * s + BigInt(b) * c;
      const { covered, spells } = this.followed(one, touch, step), { lies } = this.extent(one, touch, step);
      if (u === 0n || v === 0n || !covered.length || !lies.length) return false;
      const reach = ([i, j]) => u * BigInt(i + (u > 0n)) + v * BigInt(j + (v > 0n)), signs = [u > 0n ? 1 : -1, v > 0n ? 1 : -1];
      const furthest = (squares) => both((x) => signs[x] * squares.map((square) => signs[x] * square[x]).reduce(most)); // column and row
      const [first, last] = [furthest(covered), furthest(lies)], limit = reach(first), counts = both((x) => signs[x] * (last[x] - first[x]) + 1);
      if (counts.some((count) => count < 1) || counts[0] * counts[1] > MAX_SQUARES) return false;
      const held = new Set(touch ? [] : one.held[step].map(keyOf)), isOccupied = (square) => this.at(one, square, step) === true;
      for (let i = 0; i < counts[0]; i += 1) {
        for (let j = 0; j < counts[1]; j += 1) {
          const end = from(first, [signs[0] * i, signs[1] * j]), ahead = [from(end, [signs[0], 0]), from(end, [0, signs[1]])];
          if (touch) ahead.push(from(end, [signs[0], -signs[1]]), from(end, [-signs[0], signs[1]])); // its last row or column may be wall, too
          if (!ahead.every((square) => isOccupied(square) && !held.has(keyOf(square)))) return false;
        }
      }
      if (!touch && !this.wasFree(one, first)) return false;
      const isWall = (other) => !one.changes.has(keyOf(other)) && this.at(one, other, 0);
      return one.squares.slice(0, step + 1).every((passed, k) => {
        const isFilled = (square) => isOccupied(square) && this.times(one, square, step).every((time) => time <= k || isWithin(spells, time));
        return (reach(passed) <= limit || isWall(passed)) && turned(one.degrees).fields.every((samples, f) => {
          if (f === OWN) return true;
          const further = samples.filter((sample) => sample !== null).map((sample) => from(passed, sample)).filter((square) => reach(square) > limit);
          return further.length <= countsOf(this.steps[k].retina[f], samples.length)[1] || further.every(isFilled);
        });
      });
    }

    circled(one, step, touch) {
      const square = this.touched(one, touch), key = square && keyOf(square), start = [0, 0];
      const passed = [...one.swept.slice(0, step + 1).flat(), ...one.squares.slice(0, step + 1).map(keyOf)];
      if (!square || passed.includes(key) || one.changes.has(key) || !same(one.squares[step], start) || this.at(one, start, step) !== false) return false;
      const [x, y] = square.map((number) => BigInt(2 * number + 1) * this.unit); // all twice: middles are whole units then
      const points = one.places.slice(0, step + 1).map(([[west, east], [south, north]]) => [west + east - x, south + north - y]);
      let winds = 0;
      for (let n = 0; n < points.length; n += 1) {
        const [[x0, y0], [x1, y1]] = [points[n], points[(n + 1) % points.length]], side = x0 * y1 - x1 * y0;
        if (side === 0n && x0 * x1 <= 0n && y0 * y1 <= 0n) return false; // the way leads over the point
        if (y0 <= 0n && y1 > 0n && side > 0n) winds += 1;
        if (y0 > 0n && y1 <= 0n && side < 0n) winds -= 1;
      }
      return winds !== 0;
    }

    // The squares of the robot, or those that are all covered by the thing of a touch; [] where that is not settled.
    outline(one, touch) {
      if (!touch) return [[0, 0]];
      if (touch[0] >= one.squares.length || one.held.slice(0, touch[0] + 1).some((held) => held.length)) return [];
      const piece = this.piece(one, touch);
      return piece.every((square) => this.at(one, square, touch[0])) ? piece : [];
    }

    // The squares that the middle of a square of so many squares never leaves which lies in some squares, by key; empty where it may.
    floorOf(one, squares, size) {
      const felt = this.felt(one), verge = new Set([...felt].filter(([, { colour }]) => colour === "b").map(([key]) => key)), walls = new Set(verge);
      for (const key of verge) {
        for (const [x, y] of [[1, 0], [0, 1]]) {
          const line = Array.from({ length: size + 1 }, (_, n) => keyOf(from(felt.get(key).square, [n * x, n * y])));
          line.forEach((end, n) => { if (verge.has(end)) line.slice(0, n).forEach((between) => walls.add(between)); });
        }
      }
      const floor = this.spread(squares, (square) => !walls.has(keyOf(square))), isIn = (square) => floor.has(keyOf(square));
      need(floor.size <= MAX_SQUARES, "the floor reaches too far");
      const about = [-1, 0, 1].flatMap((x) => [-1, 0, 1].map((y) => [x, y]));
      const isNoVerge = (square) => this.wasFree(one, square) || (felt.has(keyOf(square)) && felt.get(keyOf(square)).colour !== "b");
      return [...floor.values()].every((square) => isNoVerge(square) || about.every((offset) => isIn(from(square, offset)))) ? floor : new Map();
    }

    // Of which squares of so many squares all squares are among those of a map: their south-west squares, by key.
    blocks(squares, size) {
      let found = squares;
      for (let side = 1; side < size; side += 1) {
        const smaller = found;
        found = new Map([...smaller].filter(([, square]) => [[1, 0], [0, 1], [1, 1]].every((offset) => smaller.has(keyOf(from(square, offset))))));
      }
      return found;
    }
    widest(squares) {
      let size = 1;
      while (this.blocks(squares, size + 1).size) size += 1;
      return size;
    }

    // Whether no neck of a floor is a door for what is so wide.
    isOneRoom(floor, size) {
      for (let width = size; width < this.widest(floor); width += 1) {
        let side = width + 1;
        while (side * side < 2 * width * width) side += 1;
        const large = this.blocks(floor, side), small = this.blocks(floor, width + 1);
        const joined = this.spread([...large.values()].slice(0, 1), (square) => small.has(keyOf(square)));
        if (![...large.keys()].every((key) => joined.has(key))) return false;
      }
      return true;
    }

    // Whether goals of the robot, or of the thing of a touch, cannot hold at once; isWalled: what is felt as verge is whole.
    barred(one, goals, touch, isWalled) {
      const outline = this.outline(one, touch), own = new Map(outline.map((square) => [keyOf(square), square]));
      if (!outline.length || goals.some(({ what, word }) => what !== goals[0].what || (goals.length > 1 && word))) return false;
      const size = this.widest(own), floor = isWalled ? this.floorOf(one, outline, size) : new Map();
      if (goals.some(({ kind }) => kind === "room")) return goals.length === 1 && floor.size > 0 && this.isOneRoom(floor, size);
      const { c, s } = turned(one.degrees), ways = goals.map(({ of: name }) => CORNERS[name]).map(([a, b]) => [BigInt(a) * c - BigInt(b) * s, BigInt(a) * s + BigInt(b) * c]);
      const furthest = (squares, [u, v]) => squares.map(([i, j]) => u * BigInt(i + (u > 0n)) + v * BigInt(j + (v > 0n))).reduce(most);
      const free = [...one.settled].filter(([, occupied]) => !occupied).map(([key]) => key.split(",").map(Number).slice(0, 2));
      const [columns, rows] = AXES.map((a) => new Set(outline.map((square) => square[a])).size), length = BigInt(columns + rows);
      const places = [...floor.values()];
      const reached = ways.map((way) => (free.length ? furthest(free, way) : 0n)).reduce((a, b) => a + b, 0n);
      const least = reached - (BigInt(ways.length) * (2n + length) + (places.length ? length : 0n)) * ONE;
      const sum = AXES.map((a) => ways.reduce((total, way) => total + way[a], 0n));
      if (!places.length) return sum.every((part) => part === 0n) && least > 0n;
      return least > furthest(places, sum);
    }
  }

  // ---- goals

  const SINGLE = "single(colours)"; // no two things are of one colour: of goals of things that are done, where it is needed
  // What a goal asks for: { word, kind, what, of }; kind is null where certificates show nothing of it.
  function goalOf(text) {
    const [, word, goal] = /^(first|then|prefer)\((.*)\)$/.exec(text) || [null, "", text];
    const corner = /^at\((\w+),corner\((\w+)\)\)$/.exec(goal), thing = /^(at|beside|circled)\((\w+),(\w+)\)$/.exec(goal);
    const [, left, passing, door] = /^in\((\w+),room\(next\)\)$|^through\((\w+),(?!start\)|corner\))(\w+)\)$/.exec(goal) || [];
    const made = (kind, what, of) => ({ text, word, kind, what, of, objects: [what, of].filter((name) => name && !["utak", "start"].includes(name) && kind !== "corner") });
    if (corner) return { ...made("corner", corner[1], corner[2]), objects: corner[1] === "utak" ? [] : [corner[1]] };
    if (left || passing) return { ...made("room", left || passing), door };
    if (!thing || thing[3] === "corner" || (thing[1] !== "at" && thing[3] === "start")) return made(null);
    const [, relation, what, of] = thing;
    return made(of === "start" ? "start" : relation === "circled" ? "circled" : what === "utak" ? "felt" : "near", what, of);
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

  // What each object means, as it must: a touch that felt a thing, no two one letter; returns what is granted.
  function checkMeaning(meaning, episode, names) {
    const unknown = names.find((name) => episode.header.task.parameters[name] !== "object");
    need(unknown === undefined, `${unknown} is no object of the task`);
    need(isObject(meaning) && same(Object.keys(meaning), names), "it is not said what each object of the goals means");
    const colours = new Map(Object.entries(meaning).map(([name, touch]) => {
      need(Array.isArray(touch) && touch.length === 2 && touch.every(Number.isInteger) && episode.steps[touch[0]] && touch[1] in TOUCHES, `${name} means no touch`);
      const colour = episode.steps[touch[0]].touch[touch[1]];
      need(colour !== null && colour !== "b", `${name} means a touch that felt no thing`);
      return [name, colour];
    }));
    need(new Set(colours.values()).size === colours.size, "two objects mean one letter");
    return claimsOf(episode.header.task, colours);
  }

  // The goals that are shown, each with its step; refused where they are not those of the claim.
  function checkDone({ steps, meaning, given: stated }, episode, goals) {
    const last = episode.steps.length - 1, shown = goals.filter(({ word }) => word !== "prefer"), isUnknown = ({ kind, what }) => kind === null || (kind === "circled" && what !== "utak"), unknown = shown.find(isUnknown);
    need(shown.length > 0, "there is no goal to be shown");
    need(!unknown, `certificates show nothing of ${unknown && unknown.text}`);
    need(Array.isArray(steps) && steps.length === shown.length, "there is not one step for each goal");
    let before = 0;
    shown.forEach((goal, n) => {
      const step = steps[n], staged = goal.word === "first" || goal.word === "then";
      need(Number.isInteger(step) && (staged ? step >= before && step <= last : step === last), `${goal.text} is not shown of a step at which it must hold`);
      if (staged) before = step;
      goal.step = step;
    });
    const given = checkMeaning(meaning, episode, [...new Set(shown.flatMap(({ objects }) => objects))]), rooms = shown.filter(({ kind }) => kind === "room");
    for (const { door } of rooms) {
      if (!door) continue;
      need(episode.header.task.parameters[door] === "door", `${door} is no door of the task`);
      for (const fact of claimsOf(episode.header.task, [[door, null]])) if (!given.includes(fact)) given.push(fact);
    }
    if (rooms.length) given.push("verge(walls)", "isolated(things)", "parted(rooms)");
    if (shown.some(({ what }) => what !== "utak") && Array.isArray(stated) && stated.includes(SINGLE)) given.push(SINGLE);
    for (const { kind, of, step, text } of shown) need(kind !== "felt" || meaning[of][0] === step, `${text} is not felt at its step`);
    return { given, shown };
  }

  // The goals of which it is shown that they cannot hold at once, each with the step at which.
  function checkImpossible({ steps, meaning, given }, episode, goals) {
    const last = episode.steps.length - 1, asked = goals.filter(({ word }) => word !== "prefer");
    need(Array.isArray(steps) && steps.length === asked.length, "there is not one step, or null, for each goal");
    const shown = asked.map((goal, n) => ({ ...goal, step: steps[n] })).filter(({ step }) => step !== null);
    need(shown.length > 0, "there is no goal to be shown");
    need(shown.every(({ step }) => Number.isInteger(step) && step >= 0 && step <= last && step === shown[0].step), "this is no step of all goals");
    need(shown.every(({ kind }) => ["corner", "room"].includes(kind)), "certificates show of none of these goals that it is impossible");
    const names = [...new Set(shown.flatMap(({ objects }) => objects))], claims = checkMeaning(meaning, episode, names);
    const walls = ["whole(squares)", "isolated(things)", ...(names.length ? ["apart(things)"] : [])];
    return { given: Array.isArray(given) && given.includes(walls[0]) ? [...claims, ...walls] : claims, shown };
  }

  // Whether a case shows a goal that is done; door: what stands behind the word `holds`.
  function shows(world, one, { kind, what, of, step }, meaning, door) {
    if (kind === "room") return world.throughDoor(one, door, meaning[what], step);
    const covered = (name) => world.covered(one, meaning[name], step);
    if (kind === "start") return (what === "utak" ? [one.squares[step]] : covered(what)).some((square) => same(square, [0, 0]));
    if (kind === "near") return covered(what).some(([i, j]) => covered(of).some(([x, y]) => Math.abs(x - i) <= 1 && Math.abs(y - j) <= 1));
    return kind === "felt" || (kind === "corner" ? world.atCorner(one, step, CORNERS[of], meaning[what]) : world.circled(one, step, meaning[of]));
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
          need(word === "holds", `${at}there is no such line`);
          need(one.squares.length === world.steps.length, `${at}commands are left`);
          need(holds(one, values), `${at}this case does not show the goals`);
          shown.push({ ...world.drawn(one), door: values });
          done();
        }
      }
    });
    need(one === null && open.length === 0 && angle === angles, "a case is left");
    need(shown.length > 0, "the episode agrees with no world");
    return shown;
  }

  const KEYS = ["cases", "claim", "given", "goals", "meaning", "risk", "steps", "utak", "version"];

  function checked(episodeText, certificateText) {
    const certificate = parsed(certificateText), episode = readEpisode(episodeText), { task } = episode.header;
    need(isObject(certificate) && same(Object.keys(certificate).sort(), KEYS), "these are not the keys of a certificate");
    const { claim, given, cases, meaning, risk } = certificate;
    need(certificate.utak === "certificate" && certificate.version === 1, "this is no certificate of version 1");
    need(claim === "done" || claim === "impossible", "done and impossible can be claimed");
    need(Array.isArray(certificate.goals) && same(certificate.goals, task.goals), "the goals are not those of the episode");
    const goals = task.goals.map(goalOf), wanted = (claim === "done" ? checkDone : checkImpossible)(certificate, episode, goals);
    const along = Array.isArray(given) && given.at(-1) === "along(grid)";
    need(same(along ? given.slice(0, -1) : given, wanted.given), "what is taken for granted is not what the task says");
    const simple = wanted.shown.every(({ kind }) => kind === "felt");
    need(Array.isArray(cases) && (cases.length === 0) === simple, simple ? "touches show these goals, and no cases" : "cases are missing");
    const noise = decimal(episode.header.options.noise), isRisky = !simple && noise[0] !== 0n;
    need(noise[0] >= 0n, "its noise is no number from 0 on");
    need(Number.isInteger(risk) && (isRisky ? risk > 0 && risk < 1e6 : risk === 0), isRisky ? "with noise there is a risk, in millionths" : "there is no risk to be taken");
    let shown = [];
    if (!simple) {
      const why = foreign(episode), steps = claim === "done" ? episode.steps : episode.steps.slice(0, wanted.shown[0].step + 1), world = new World({ steps }, noise, risk, given.includes(SINGLE));
      need(why === null, why);
      const hasDoor = wanted.shown.some(({ kind }) => kind === "room");
      const isDone = (one, door) => (door.length > 0) === hasDoor && wanted.shown.every((goal) => shows(world, one, goal, meaning, door));
      const isBarred = (one, door) => door.length === 0 && world.barred(one, wanted.shown, meaning[wanted.shown[0].what], given.includes("whole(squares)"));
      shown = readCases(cases, world, along ? 1 : 90, claim === "done" ? isDone : isBarred);
    }
    const touches = Object.entries(meaning).map(([name, touch]) => ({ name, touch, offset: TOUCHES[touch[1]] }));
    return { accepted: true, says: `${claim}${risk ? `, at a risk of ${risk / 1e4} percent` : ""}: ${wanted.shown.map(({ text }) => text).join(", ")}` + (given.length ? `, given ${given.join(", ")}` : ""), shown, touches };
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
