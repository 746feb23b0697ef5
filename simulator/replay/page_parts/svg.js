// Small helpers for drawing: elements, and points of the robot's frame on the table.

const SVG = "http://www.w3.org/2000/svg";

// A new element of SVG with attributes and children; text becomes text.
function svg(name, attributes = {}, ...children) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

// A new element of HTML with attributes and children. A child that is a text is shown as text, never read as HTML.
function html(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children.filter((child) => child !== null && child !== undefined && child !== false));
  return element;
}

const byId = (id) => document.getElementById(id);
const rounded = (value) => Math.round(value * 1000) / 1000;

// Path data of rings or lines of points, placed by a function.
function pathOf(lines, place, closed) {
  return lines.map((line) => {
    const points = line.map((point) => place(point).map(rounded).join(" "));
    return points.length ? `M${points.join("L")}${closed ? "Z" : ""}` : "";
  }).join("");
}

// Path data of one line of points that mostly were placed before: what each becomes is kept, by place and point.
const placedTexts = new WeakMap();
function trackOf(points, place) {
  if (!placedTexts.has(place)) placedTexts.set(place, new WeakMap());
  const known = placedTexts.get(place);
  const texts = points.map((point) => {
    const found = known.get(point) || place(point).map(rounded).join(" ");
    known.set(point, found);
    return found;
  });
  return texts.length ? `M${texts.join("L")}` : "";
}

// Converts points of the robot's frame, which has its origin where the robot woke, to the picture of the table, in which
// y runs south.
function placing(header, origin) {
  const [, height] = header.world.table, angle = (header.world.heading * Math.PI) / 180;
  const cosine = Math.cos(angle), sine = Math.sin(angle);
  const table = ([x, y]) => [x, height - y];
  const robot = ([east, north]) => table([origin[0] + east * cosine - north * sine, origin[1] + east * sine + north * cosine]);
  return { table, robot };
}
