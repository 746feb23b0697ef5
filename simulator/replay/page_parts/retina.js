// The retina: what 160 fields observe, what was predicted for them, and the difference.

const ZONES = [[4, 1], [8, 2], [16, 4]]; // how far a zone reaches, and the side of its fields, in squares
const FIELDS = retinaFields();
const STATUS = { p: "predicted", e: "explained", n: "noise" };
const ALL_FIELDS = "-16 -16 32 32", INNER_FIELDS = "-8 -8 16 16";

// East, north and side of each field, in squares from the robot's own square; zone by zone, from north to south and from
// west to east.
function retinaFields() {
  const fields = [];
  let inner = 0;
  for (const [reach, side] of ZONES) {
    for (let north = reach - side; north >= -reach; north -= side) {
      for (let east = -reach; east < reach; east += side) {
        if (!(east >= -inner && east < inner && north >= -inner && north < inner)) fields.push({ east, north, side });
      }
    }
    inner = reach;
  }
  return fields;
}

// A picture of the retina. A field shows the least level, its north-east half the greatest one, and a mark.
function retinaPicture(name, onField) {
  const parts = FIELDS.map(({ east, north, side }) => {
    const [x, y] = [east, -north - side], [right, bottom] = [x + side, y + side], [cx, cy] = [x + side / 2, y + side / 2];
    const size = side * 0.22, far = side * 0.3;
    return {
      least: svg("rect", { class: "level", x, y, width: side, height: side }),
      most: svg("path", { class: "level", d: `M${x} ${y}H${right}V${bottom}Z` }),
      frame: svg("rect", { class: "field", x, y, width: side, height: side }),
      dot: svg("circle", { class: "dot", cx, cy, r: size }),
      cross: svg("path", { class: "cross", d: `M${cx - far} ${cy - far}L${cx + far} ${cy + far}M${cx - far} ${cy + far}L${cx + far} ${cy - far}` }),
      digit: svg("text", { class: "digit", x: cx, y: cy }),
      // In the north-west corner, where a number takes the middle.
      corner: `translate(${x + side * 0.22 - cx * 0.5} ${y + side * 0.22 - cy * 0.5}) scale(0.5)`, side,
    };
  });
  const own = svg("rect", { class: "own", x: 0, y: -1, width: 1, height: 1 });
  const picture = svg("svg", { viewBox: ALL_FIELDS, role: "img", "aria-label": name });
  for (const part of parts) picture.append(part.least, part.most);
  for (const part of parts) picture.append(part.frame, part.dot, part.cross, part.digit);
  picture.append(own);
  picture.addEventListener("pointerdown", (event) => {
    const box = picture.getBoundingClientRect(), [west, , width] = picture.getAttribute("viewBox").split(" ").map(Number);
    const x = west + ((event.clientX - box.left) / box.width) * width, y = west + ((event.clientY - box.top) / box.height) * width;
    const field = FIELDS.findIndex(({ east, north, side }) => x >= east && x < east + side && -y >= north && -y < north + side);
    if (field >= 0) onField(field);
  });
  return { picture, parts, name };
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
function fillRetina({ picture, parts, name }, values, summary, { marks, digits, inner }) {
  picture.setAttribute("viewBox", inner ? INNER_FIELDS : ALL_FIELDS);
  picture.setAttribute("aria-label", `${name}: ${summary}`);
  values.forEach(([least, most, status, text], field) => {
    const part = parts[field], key = [least, most, status, text, marks, digits].join();
    if (part.key === key) return; // as it is drawn already
    part.key = key;
    part.least.style.fillOpacity = least === null ? 0 : least / 7;
    part.most.style.fillOpacity = most === least ? 0 : (most - least) / (7 - least); // over the least level
    part.frame.setAttribute("class", marks && status ? `field ${status}` : "field");
    part.dot.style.display = marks && status === "explained" ? "" : "none";
    part.cross.style.display = marks && status === "noise" ? "" : "none";
    part.digit.textContent = digits ? text : "";
    part.digit.setAttribute("font-size", (text.length > 2 ? 0.42 : 0.7) * Math.min(part.side, 2));
    for (const mark of [part.dot, part.cross]) mark.setAttribute("transform", digits && text ? part.corner : "");
    part.digit.setAttribute("class", Math.max(least, most) > 3 ? "digit light" : "digit");
  });
}

// Fills the three pictures; returns what is known of the fields.
function drawRetinas({ observed, predicted, difference }, line, options) {
  const fields = fieldsOf(line), count = (status) => fields.filter((field) => field.status === status).length;
  const recorded = fields[0].low !== null, states = `${count("predicted")} predicted, ${count("explained")} explained, ${count("noise")} noise`;
  const occupied = fields.filter((field) => field.level > 0).length, exact = fields.filter((field) => field.low === field.high).length;
  fillRetina(observed, fields.map(({ level, status }) => [level, level, status, String(level)]),
    `${occupied} of 160 fields show something`, options);
  fillRetina(predicted, fields.map(({ low, high, status }) => [low, high, status, low === null ? "" : low === high ? String(low) : `${low}-${high}`]),
    recorded ? `${exact} of 160 fields predicted exactly` : "not recorded in this episode", options);
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
