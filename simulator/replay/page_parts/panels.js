// The panels of text: the step, the plan, the facts that changed, the reasons.

const MAX_LISTED = 200; // facts of one list that are shown
const MAX_TREE_DEPTH = 60; // levels of an explanation that are shown

// An action as text, such as "push(1.5, -2)".
function actionInWords(action) {
  if (!action) return "wake";
  const values = Object.entries(action).filter(([key]) => key !== "do").map(([, value]) => (isNumber(value) ? String(Number(value.toPrecision(6))) : shown(value)));
  return values.length ? `${action.do}(${values.join(", ")})` : action.do;
}

// A list of facts, each with a mark; or a word that there are none.
function factList(mark, word, facts, asParts) {
  const list = html("ul", { class: `facts ${word}` });
  for (const fact of facts.slice(0, MAX_LISTED)) list.append(html("li", {}, html("span", { class: "mark", "aria-label": word }, mark), ...asParts(fact)));
  if (facts.length > MAX_LISTED) list.append(html("li", {}, `and ${facts.length - MAX_LISTED} more`));
  return list;
}

const asCode = (fact) => [html("code", {}, shown(fact))];

// The step: what was done, why, and how the impression was explained.
function stepPanel(at) {
  const { line, episode, step } = at, { belief } = line, rows = [];
  const row = (name, ...values) => rows.push(html("dt", {}, name), html("dd", {}, ...values));
  row("why", shown(line.why));
  const cells = belief.cells && typeof belief.cells === "object" ? Object.entries(belief.cells).map(([word, number]) => `${shown(number)} ${shown(word)}`).join(", ") : "";
  if (belief.pose !== undefined) row("explained as", shown(belief.pose), cells ? `; fields: ${cells}` : "");
  const motion = line.motion, turned = motion && motion.rotate !== undefined;
  row("in truth", !motion ? "nothing moved" : turned ? `turned by ${rounded(motion.rotate)} degrees` : `moved by (${motion.translate.map(rounded).join(", ")})`,
    `; stands at (${line.utak.map(rounded).join(", ")})`, line.held ? `; holds ${shown(line.held)}` : "");
  if (isPoint(belief.place)) row("believes", `it is at (${belief.place.map(rounded).join(", ")})`, belief.lattice ? `; its frame is turned by ${shown(belief.lattice)} degrees against the squares` : "");
  const touched = line.touch.map((colour, i) => (colour ? `${TOUCHED[i]} ${shown(colour)}` : "")).filter(Boolean);
  row("touch", touched.length ? touched.join(", ") : "nothing");
  const kinds = Object.entries(episode.events).filter(([, steps]) => steps.includes(step)).map(([kind]) => kind);
  if (kinds.length) row("events", kinds.join(", "));
  if (episode.result && step === episode.utak.length - 1) row("end", `${episode.result.verdict}: ${shown(episode.result.reason)}`);
  return [html("p", { class: "action" }, html("strong", {}, `step ${step}: ${actionInWords(line.action)}`)), html("dl", {}, ...rows)];
}

const TOUCHED = ["north", "northeast", "east", "southeast", "south", "southwest", "west", "northwest"];

// The plan as far as there is one: goals, what parameters mean, steps, what was verified and refuted.
function planPanel(at) {
  const { said, episode, line } = at, parts = [], { task } = episode.header;
  const bound = new Map(Object.entries(line.belief.bound || {}).concat(said("bound", 2)));
  parts.push(html("p", {}, "wanted: ", ...task.goals.flatMap((goal, i) => [i ? ", " : "", html("code", {}, shown(goal))])));
  parts.push(html("p", {}, bound.size ? "meant: " + [...bound].map(([name, node]) => `${shown(name)} is ${shown(node)}`).join(", ") : "nothing is bound yet"));
  const of = (word, key) => said(word, 2).filter(([number]) => number === key).map(([, value]) => shown(value));
  const goals = said("goal", 1).map(([goal]) => `${shown(goal)} is ${of("means", goal).join(" and ")}`);
  if (goals.length) parts.push(html("p", {}, "goals of the plan: " + goals.join("; ")));
  const verified = new Set(said("verified", 1).map(([number]) => number));
  const steps = said("plan", 2).sort((a, b) => a[0] - b[0]);
  if (steps.length) {
    parts.push(html("ol", { class: "plan", start: 0 }, ...steps.map(([number, step], i) => {
      const [takes] = of("takes", number), told = [of("serves", number).map((goal) => `for ${goal}`).join(" and "), of("passes", number).map((door) => `through ${door}`).join(" and ")];
      told.push(takes === undefined ? "" : `about ${takes} command${takes === "1" ? "" : "s"}`, verified.has(number) ? "✓ verified" : takes === undefined ? "not asked" : "hoped");
      return html("li", i ? {} : { "aria-current": "step" }, i ? "" : html("b", {}, "▶ "), html("code", {}, shown(step)), " ", told.filter(Boolean).join(", "));
    })));
  } else parts.push(html("p", { class: "quiet" }, said("price", 3).length ? "No step of the plan is left." : "The facts of this step have no plan."));
  const unmet = said("unmet", 1).map(([goal]) => shown(goal));
  if (unmet.length) parts.push(html("p", {}, "no plan that was found attains " + unmet.join(", ")));
  for (const [cost, least, end] of said("price", 3).filter(([cost]) => cost !== "0")) parts.push(html("p", {}, `cost ${shown(cost)} commands in all, at least ${shown(least)}; ${end === "proved" ? "the search ended with it" : "best found, not proved"}`));
  const refuted = said("refuted", 2);
  if (refuted.length) parts.push(html("p", {}, "refuted:"), html("ul", {}, ...refuted.map(([step, given]) => html("li", {}, html("code", {}, shown(step)), " given ", html("code", {}, of("given", given).join(", ") || shown(given))))));
  for (const word of ["verdict", "because"]) for (const [value] of said(word, 1)) parts.push(html("p", {}, `${word}: `, html("code", {}, shown(value))));
  const routes = Array.isArray(line.belief.routes) ? line.belief.routes : [];
  if (routes.length) {
    const chosen = routes.filter((route) => route.chosen).length;
    parts.push(html("p", {}, `${routes.length} route${routes.length > 1 ? "s" : ""} weighed for the next command, ${chosen ? "one chosen (solid on the map)" : "none chosen"}`));
  }
  return parts;
}

// Rooms, doors and things in words: what the map cannot show where it knows no place of them.
function worldPanel(at) {
  const { said } = at, kinds = kindsOf(said), list = html("ul", { class: "plain" });
  const rooms = roomsOf(said), doorsSure = doorsOf(said), inPercent = ({ sure }) => (sure < 1 ? ` ${Math.round(100 * sure)}` : "");
  for (const [room] of said("room", 1)) {
    const doors = said("connects", 4).concat(said("connects", 3)).filter(([, from]) => from === room).map(([door, , to]) => `${shown(door)} to ${shown(to)}`).filter((text, at, all) => all.indexOf(text) === at);
    const unseen = said("unseen", 2).filter((args) => args[0] === room).map((args) => args[1])[0];
    list.append(html("li", {}, html("b", {}, shown(room)), (rooms.get("org") || []).some((where) => where.room === room) ? ` (the robot is here${inPercent(rooms.get("org").find((where) => where.room === room))})` : "", unseen ? `: ${shown(unseen)} squares unseen` : "", doors.length ? `; ${doors.join(", ")}` : ""));
  }
  for (const [door, width] of said("width", 2)) list.append(html("li", {}, html("b", {}, shown(door)), `: a door${inPercent({ sure: doorsSure.get(door) ?? 1 })}, ${rounded(hundredths(width))} squares wide`));
  for (const [name, { all }] of kinds) {
    if (["org", "floor", "verge"].includes(name)) continue;
    const shapes = said("shape", 3).filter((args) => args[0] === name && Number(args[2]) > 0).sort((a, b) => b[2] - a[2]).slice(0, 4).map((args) => `${shown(args[1])} ${shown(args[2])}`);
    const colour = said("colour", 3).filter((args) => args[0] === name).map((args) => shown(args[1]));
    list.append(html("li", {}, html("b", {}, shown(name)), ": " + all.map(([word, sure]) => `${shown(word)} ${Math.round(100 * sure)}`).join(" or "), colour.length ? `, colour ${colour.join("/")}` : "", rooms.has(name) ? `, in ${rooms.get(name).map((where) => shown(where.room) + inPercent(where)).join(" or ")}` : "", shapes.length ? `; ${shapes.join(", ")}` : ""));
  }
  return list.children.length ? [list] : [html("p", { class: "quiet" }, "Nothing is believed yet.")];
}

// The facts that changed since the step before.
function changesPanel(at) {
  const before = at.step ? at.episode.line(at.step - 1).belief.facts : [], found = changesOf(before, at.line.belief.facts), parts = [];
  if (at.step === 0) return [html("p", {}, `The first ${at.line.belief.facts.length} facts. `, html("span", { class: "quiet" }, "All facts are listed below."))];
  const { added, changed, removed, outlines } = found;
  const outlined = [...outlines.values()].reduce((a, b) => a + b, 0);
  parts.push(html("p", {}, `${changed.length} changed, ${added.length} added, ${removed.length} removed${outlined ? `; ${outlined} edges of outlines` : ""}`));
  if (changed.length) parts.push(factList("~", "changed", changed, ([old, now]) => [html("code", {}, shown(now)), html("span", { class: "was" }, "was ", html("code", {}, shown(old)))]));
  if (added.length) parts.push(factList("+", "added", added, asCode));
  if (removed.length) parts.push(factList("−", "removed", removed, asCode));
  if (outlines.size) parts.push(html("p", { class: "quiet" }, "outlines: " + [...outlines].map(([name, count]) => `${shown(name)} ${count} edges`).join(", ")));
  return parts;
}

// A list that is filled when it is opened.
function folded(summary, fill) {
  const details = html("details", {}, html("summary", {}, summary));
  details.addEventListener("toggle", () => {
    if (details.open && details.children.length === 1) details.append(...fill());
  });
  return details;
}

// The reasons: explanations that were given with the step, and the decisions of logic programs.
function reasonsPanel(at) {
  const parts = at.episode.trees(at.step).map((tree) => treeOf(tree, 0)), { solved } = at.line.belief;
  if (Array.isArray(solved) && solved.length) {
    for (const [number, entry] of solved.entries()) parts.push(decision(at, number, entry));
  } else if (!parts.length) parts.push(html("p", { class: "quiet" }, "This episode records no decisions at this step."));
  return parts;
}

// An explanation: { text, children }.
function treeOf(tree, depth) {
  const text = shown(tree && tree.text !== undefined ? tree.text : tree), children = (tree && Array.isArray(tree.children) && tree.children) || [];
  if (!children.length || depth > MAX_TREE_DEPTH) return html("p", { class: "leaf" }, text);
  return folded(text, () => children.map((child) => treeOf(child, depth + 1)));
}

// Step and number of the decision that an entry repeats; null where it repeats none.
const formerPlace = (entry) => (entry.length === 2 && Array.isArray(entry[1]) ? entry[1] : null);

// A decision with all that it states, looked up where it was taken before.
function wholeDecision(at, entry) {
  if (!Array.isArray(entry)) return [];
  const again = formerPlace(entry), whole = again && again[0] < at.step ? (at.episode.solved(again[0]) || [])[again[1]] || entry : entry;
  return whole.length > 2 ? whole : [entry[0], [], [], []];
}

// The confidence of a statement at each step as a curve; gaps where it is not believed.
function coursePanel(at, statement) {
  const wanted = statement.replace(/\s/g, "").replace(/\)?\.?$/, ""), steps = at.episode.utak.length, values = [];
  if (!wanted) return [html("p", { class: "quiet" }, "A statement without its confidence, such as shape(o1,square) or kind(o1,object).")];
  for (let step = 0; step < steps; step += 1) {
    const fact = at.episode.line(step).belief.facts.find((one) => one.startsWith(`${wanted},`) && /^\d{1,3}\)\.?$/.test(one.slice(wanted.length + 1)));
    values.push(fact === undefined ? null : parseInt(fact.slice(wanted.length + 1), 10));
  }
  const known = values.filter((value) => value !== null), now = values[at.step];
  if (!known.length) return [html("p", {}, `${shown(statement)} is believed at no step.`)];
  const line = values.map((value, step) => (value === null ? "" : `${step && values[step - 1] !== null ? "L" : "M"}${step} ${100 - value}h0.4`)).join("");
  const picture = svg("svg", { class: "course", viewBox: `0 0 ${steps} 100`, preserveAspectRatio: "none", role: "img", "aria-label": `confidence of ${shown(statement)}: ${Math.min(...known)} to ${Math.max(...known)} percent` },
    svg("path", { class: "grid", d: `M0 0H${steps}M0 50H${steps}M0 100H${steps}` }), svg("path", { class: "now", d: `M${at.step + 0.2} 0V100` }), svg("path", { d: line }));
  return [html("p", {}, `${now === null ? "not believed" : `${now} percent`} at step ${at.step}; ${Math.min(...known)} to ${Math.max(...known)} percent in all. Lines: 0, 50 and 100 percent.`), picture];
}

// A decision: the encoding, what it was given, what it answered. One that was taken before is looked up.
function decision(at, number, entry) {
  if (!Array.isArray(entry)) return html("p", {}, shown(entry));
  const [name] = entry, again = formerPlace(entry), [, facts, answer, about] = wholeDecision(at, entry);
  const named = (atom) => {
    const number = /\((\d{1,9})\)$/.exec(atom), text = number && Array.isArray(about) ? about[Number(number[1])] : undefined;
    return shown(atom) + (typeof text === "string" ? ` (${shown(text)})` : "");
  };
  const told = Array.isArray(answer) ? (answer.length ? answer.slice(0, 3).map(named).join(", ") + (answer.length > 3 ? ", …" : "") : "nothing") : "no answer";
  const summary = html("span", {}, html("b", {}, shown(name)), again ? ` (as at step ${shown(again[0])})` : "", `: ${told}`);
  return folded(summary, () => {
    const inside = [];
    const list = (title, items) => {
      if (Array.isArray(items) && items.length) inside.push(html("p", {}, title), factList("", title, items, asCode));
    };
    if (again) inside.push(html("p", {}, html("a", { href: `#step=${again[0]}` }, `first decided at step ${again[0]}`)));
    list("answer", answer);
    list("given", facts);
    list("candidates", (about || []).map((one, i) => (one === 0 ? null : `${i}: ${typeof one === "string" ? one : JSON.stringify(one)}`)).filter(Boolean));
    return inside;
  });
}

// All facts of the step, those with a word alone where one is given.
function factsPanel(at, word) {
  const facts = at.line.belief.facts.filter((fact) => fact.includes(word));
  return [html("p", {}, `${facts.length} facts`), html("pre", { tabindex: 0, "aria-label": "all facts" }, facts.slice(0, 5000).map(shown).join("\n"))];
}
