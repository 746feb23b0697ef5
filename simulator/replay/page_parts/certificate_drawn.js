// A certificate that came with the episode: checked here (certificate.js), and drawn over the table.

const MIDDLE_OF_SQUARE = 0.5;

// The case that is drawn: the one in which the grid lies as it does on the table, if there is one.
function drawnCase({ shown }, header) {
  return shown.find(({ degrees }) => (header.world.heading - degrees) % 90 === 0) || shown[0];
}

// What a checked certificate settles: squares that are occupied (crossed) or free (dotted), those felt as verge (framed), a door
// and the rooms that it joins, where the robot stands at the step, and squares that the things of the goals cover for sure; all at the last step of the cases where the step is later.
function drawCertificate(at, checked) {
  const group = svg("g", { class: "certificate" }), { header, utak } = at.episode, one = drawnCase(checked, header);
  const middle = (step) => utak[step].map((value) => Math.floor(value) + MIDDLE_OF_SQUARE), heading = header.world.heading;
  const squares = (list, place) => pathOf(list.map(([i, j]) => squareOf(i - MIDDLE_OF_SQUARE, j - MIDDLE_OF_SQUARE, 1)), place, true);
  const add = (name, d, title) => group.append(svg("path", { class: name, d }, svg("title", {}, title)));
  if (one) { // the square of waking is (0, 0) of the map frame, whose axes lie along the grid
    const place = placing({ ...header, world: { ...header.world, heading: heading - one.degrees } }, middle(0)).robot;
    const step = Math.min(at.step, one.places.length - 1), settled = (occupied) => one.settled(step, occupied);
    add("settled-free", settled(false).map((square) => dotOf(place(square))).join(""), "settled: free");
    add("settled-occupied", squares(settled(true), place), "settled: occupied");
    add("settled-verge", squares(one.verge, place), "felt: verge");
    const [[west, east], [south, north]] = one.places[step].map((bounds) => bounds.map((value) => value - MIDDLE_OF_SQUARE));
    const corners = ([w, s, e, n]) => [[w, s], [e + 1, s], [e + 1, n + 1], [w, n + 1]].map((corner) => corner.map((number) => number - MIDDLE_OF_SQUARE));
    if (one.door.length) add("settled-door", pathOf(one.door.map(corners), place, true), "a door, and the rooms that it joins");
    for (const { name, touch } of checked.touches) add("settled-thing", squares(one.covered(touch, step), place), shown(`${name} covers this for sure`));
    add("settled-place", pathOf([[[west, south], [east, south], [east, north], [west, north]]], place, true), "the robot stands in here for sure");
  } else for (const { name, touch: [step], offset } of checked.touches) {
    const [west, north] = placing(header, middle(step)).robot(offset).map(Math.floor);
    if (step <= at.step) add("settled-thing", `M${west} ${north}h1v1h-1Z`, shown(`${name}: felt at step ${step}`));
  }
  return group;
}

const dotOf = ([x, y]) => `M${rounded(x - 0.12)} ${rounded(y)}h0.24`;

// What the second checker says.
function certificatePanel(checked, header) {
  if (!checked) return [html("p", { class: "quiet" }, "It is being checked.")];
  const { accepted, shown: cases } = checked, one = drawnCase(checked, header), parts = [];
  parts.push(html("p", { class: accepted ? "accepted" : "refused" }, html("strong", {}, accepted ? "✓ accepted" : "✗ refused"), `: ${shown(checked.says)}`));
  if (one) {
    const count = (occupied) => one.settled(one.places.length - 1, occupied).length;
    parts.push(html("p", {}, `Drawn on the table is the case in which the robot's axes are turned by ${one.degrees} degrees against the squares: `
      + `${count(true)} squares are settled as occupied at the end, ${count(false)} as free.${cases.length > 1 ? ` In all, ${cases.length} cases agree with the episode, and each shows the goals.` : ""}`));
  }
  parts.push(html("p", { class: "quiet" }, "Checked in this page, by what was seen, felt and commanded alone; this checker shares nothing with the robot, nor with utak verify."));
  return parts;
}
