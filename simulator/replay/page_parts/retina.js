// The retina: what its fields observe, what was predicted for them, and the difference. RETINA_ZONES is how far each zone
// reaches, and the side of its fields, in squares; it comes with the page.

const FIELDS = retinaFields();
const isDigits = (text) => typeof text === "string" && text.length === FIELDS.length && /^[0-7]*$/.test(text);
const STATUS = { p: "predicted", e: "explained", n: "noise" }, STATUS_MARKS = { explained: "dot", noise: "cross" };
const [INNER_FIELDS, ALL_FIELDS] = RETINA_ZONES.slice(-2).map(([reach]) => `${-reach} ${-reach} ${2 * reach} ${2 * reach}`);

// East, north and side of each field, in squares from the robot's own square; zone by zone, from north to south and from
// west to east.
function retinaFields() {
  const fields = [];
  let inner = 0;
  for (const [reach, side] of RETINA_ZONES) {
    for (let north = reach - side; north >= -reach; north -= side) {
      for (let east = -reach; east < reach; east += side) {
        if (!(east >= -inner && east < inner && north >= -inner && north < inner)) fields.push({ east, north, side });
      }
    }
    inner = reach;
  }
  return fields;
}

// Path data of each field: its square, its north-east half, and the marks in its middle or, where a number takes that, in
// its north-west corner.
const SHAPES = FIELDS.map(({ east, north, side }) => {
  const [x, y] = [east, -north - side], marks = (cx, cy, size) => {
    const [r, far] = [0.22 * size, 0.3 * size];
    return {
      dot: `M${cx - r} ${cy}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0Z`,
      cross: `M${cx - far} ${cy - far}l${2 * far} ${2 * far}M${cx - far} ${cy + far}l${2 * far} ${-2 * far}`,
    };
  };
  return {
    x, y, side, square: `M${x} ${y}h${side}v${side}h${-side}Z`, half: `M${x} ${y}h${side}v${side}Z`,
    full: marks(x + side / 2, y + side / 2, side), small: marks(x + side * 0.22, y + side * 0.22, side / 2),
  };
});
const GRID = SHAPES.map((shape) => shape.square).join("");

// A picture of the retina. A field shows the least level, its north-east half the greatest one, and a mark. Fields that look
// alike are one path: a browser styles few elements faster than many.
function retinaPicture(name, onField) {
  const levels = svg("g"), marks = svg("g"), picked = svg("path", { class: "field picked" });
  const picture = svg("svg", { viewBox: ALL_FIELDS, role: "img", "aria-label": name },
    levels, svg("path", { class: "field", d: GRID }), marks, picked, svg("rect", { class: "own", x: 0, y: -1, width: 1, height: 1 }));
  picture.addEventListener("pointerdown", (event) => {
    const box = picture.getBoundingClientRect(), [west, , width] = picture.getAttribute("viewBox").split(" ").map(Number);
    const x = west + ((event.clientX - box.left) / box.width) * width, y = west + ((event.clientY - box.top) / box.height) * width;
    const field = FIELDS.findIndex(({ east, north, side }) => x >= east && x < east + side && -y >= north && -y < north + side);
    if (field >= 0) onField(field);
  });
  return { picture, levels, marks, name, drawn: "", pick: (field) => picked.setAttribute("d", SHAPES[field] ? SHAPES[field].square : "") };
}

// What is known of each field at a step: level, least and most (null where not recorded), status, surplus and the fact
// that explains it.
function fieldsOf(line) {
  const { least, most, status, explained } = line.belief, recorded = isDigits(least) && isDigits(most);
  const why = new Map();
  for (const [fact, fields] of Object.entries(explained || {})) {
    if (Array.isArray(fields)) for (const field of fields) why.set(field, fact);
  }
  return line.retina.map((level, field) => {
    const low = recorded ? Number(least[field]) : null, high = recorded ? Number(most[field]) : null;
    return {
      level, low, high, fact: why.get(field), status: STATUS[String(status || "")[field]] || null,
      surplus: recorded ? level - Math.min(Math.max(level, low), high) : 0,
    };
  });
}

// Sets the levels and marks of a picture: of each field [least, most, status, text].
function fillRetina(retina, values, summary, { marks, digits, inner }) {
  const { picture, name } = retina, drawn = JSON.stringify([values, marks, digits]);
  picture.setAttribute("viewBox", inner ? INNER_FIELDS : ALL_FIELDS);
  picture.setAttribute("aria-label", `${name}: ${summary}`);
  if (retina.drawn === drawn) return;
  retina.drawn = drawn;
  const levels = new Map(), marked = new Map(), numbers = [];
  const add = (paths, key, data) => paths.set(key, (paths.get(key) || "") + data);
  values.forEach(([least, most, status, text], field) => {
    const shape = SHAPES[field], size = digits && text ? "small" : "full";
    if (least) add(levels, least / 7, shape.square);
    if (most !== least) add(levels, (most - least) / (7 - least), shape.half); // over the least level
    if (marks && STATUS_MARKS[status]) {
      add(marked, `field ${status}`, shape.square);
      add(marked, `${STATUS_MARKS[status]} ${size}`, shape[size][STATUS_MARKS[status]]);
    }
    if (digits && text) numbers.push([shape, text, Math.max(least, most) > 3]);
  });
  retina.levels.replaceChildren(...[...levels].map(([opacity, d]) => svg("path", { class: "level", d, "fill-opacity": rounded(opacity) })));
  const order = [...marked].sort(([a], [b]) => b.startsWith("field") - a.startsWith("field")); // frames first, marks over them
  retina.marks.replaceChildren(...order.map(([kind, d]) => svg("path", { class: kind, d })), ...numbers.map(([{ x, y, side }, text, dark]) =>
    svg("text", { class: dark ? "digit light" : "digit", x: x + side / 2, y: y + side / 2, "font-size": (text.length > 2 ? 0.42 : 0.7) * Math.min(side, 2) }, text)));
}

// Fills the three pictures; returns what is known of the fields.
function drawRetinas({ observed, predicted, difference }, line, options) {
  const fields = fieldsOf(line), count = (status) => fields.filter((field) => field.status === status).length;
  const recorded = fields[0].low !== null, states = `${count("predicted")} predicted, ${count("explained")} explained, ${count("noise")} noise`;
  const occupied = fields.filter((field) => field.level > 0).length, exact = fields.filter((field) => field.low === field.high).length;
  fillRetina(observed, fields.map(({ level, status }) => [level, level, status, String(level)]),
    `${occupied} of ${FIELDS.length} fields show something`, options);
  fillRetina(predicted, fields.map(({ low, high, status }) => [low, high, status, low === null ? "" : low === high ? String(low) : `${low}-${high}`]),
    recorded ? `${exact} of ${FIELDS.length} fields predicted exactly` : "not recorded in this episode", options);
  fillRetina(difference, fields.map(({ surplus, status }) => {
    const text = surplus ? (surplus > 0 ? "+" : "−") + Math.abs(surplus) : "";
    return [Math.abs(surplus), Math.abs(surplus), status, text];
  }), recorded ? states : "not recorded in this episode", { ...options, marks: true });
  return { fields, recorded, states };
}

// A field in words.
function fieldInWords(number, field) {
  const { east, north, side } = FIELDS[number], size = side === 1 ? "1 square" : `${side} x ${side} squares`;
  const range = field.low === null ? "not recorded" : field.low === field.high ? `${field.low}` : `${field.low} to ${field.high}`;
  const told = field.fact ? `, by ${shown(field.fact)}` : "";
  return `Field ${number}: ${size}, ${east} to ${east + side - 1} east, ${north} to ${north + side - 1} north of the robot's square. `
    + `Observed ${field.level}, predicted ${range}: ${field.status || "status not recorded"}${told}.`;
}
