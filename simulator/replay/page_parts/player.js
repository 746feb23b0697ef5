// The player: which step is shown, and how one gets to another one.

const SPEEDS = [0.5, 1, 2, 5, 10, 30]; // steps a second
const LAYERS = { unseen: "unseen", track: "tracks", pathgraph: "pathgraph", routes: "what was weighed", impression: "retina on the table", certificate: "what the certificate settles" };
const CHECKED_AFTER = 50; // milliseconds: the page is shown before its certificate is checked
const VIEWS = { side: "side by side", overlay: "overlay", truth: "table alone", belief: "belief alone" };

function startPlayer(episode) {
  const last = episode.utak.length - 1, places = placing(episode.header, episode.utak[0]), area = areaOf(episode, places);
  const events = eventsOf(episode), state = { step: -1, timer: null, view: "side", layers: new Set(["unseen", "track", "routes", "certificate"]), checked: null };
  const options = { marks: false, digits: false, inner: false };
  const output = byId("field-text"), fieldNumber = byId("field");
  const retina = Object.fromEntries(["observed", "predicted", "difference"].map((name) => [name, retinaPicture(name, (field) => {
    fieldNumber.value = field;
    showField();
  })]));
  for (const [name, { picture }] of Object.entries(retina)) byId(name).append(picture);
  let fields = [];

  // Shows a step. Errors in a panel are shown there, and the other panels are still drawn.
  function show(step) {
    state.step = Math.min(Math.max(step, 0), last);
    let line = null;
    try {
      line = episode.line(state.step);
    } catch (error) {
      if (!state.at) throw error;
      byId("status").textContent = `Step ${state.step} cannot be read, as this page is damaged: ${error.message}`;
      return;
    }
    const said = byPredicate(line.belief.facts);
    const at = { episode, step: state.step, line, said, outlines: outlinesOf(said), places, area, layers: state.layers };
    state.at = at;
    draw();
    panel("step-panel", () => stepPanel(at));
    panel("plan-panel", () => planPanel(at));
    panel("changes-panel", () => changesPanel(at));
    panel("reasons-panel", () => reasonsPanel(at));
    list();
    byId("status").textContent = "";
    byId("slider").value = state.step;
    byId("slider").setAttribute("aria-valuetext", `step ${state.step} of ${last}, ${actionInWords(line.action)}`);
    byId("step").textContent = `${state.step} / ${last}`;
    byId("back").disabled = byId("first").disabled = state.step === 0;
    byId("forward").disabled = byId("last").disabled = state.step === last;
  }
  // Draws the maps and the retina. What was unfolded among the texts stays so.
  function draw() {
    const at = { ...state.at, unit: unit() };
    panel("table-map", () => [mapOf(at, "truth")]);
    panel("belief-map", () => [mapOf(at, "belief")]);
    for (const map of [byId("table-map"), byId("belief-map")]) { // a large map is scrolled to the robot
      const [x, y] = places.table(at.line.utak);
      map.scrollTo((x - area.west) / at.unit - map.clientWidth / 2, (y - area.north) / at.unit - map.clientHeight / 2);
    }
    panel("retina-states", () => {
      const found = drawRetinas(retina, at.line, options);
      fields = found.fields;
      byId("retina-difference").hidden = byId("retina-predicted").hidden = !found.recorded;
      return [found.recorded ? found.states : "This episode does not record what was predicted for each field."];
    });
    showField();
  }
  // Fills the long lists, as far as they are open.
  function list() {
    if (byId("course").open) panel("course-panel", () => coursePanel(state.at, byId("statement").value));
    if (byId("world").open) panel("world-panel", () => worldPanel(state.at));
    if (byId("facts").open) panel("facts-panel", () => factsPanel(state.at, byId("word").value));
  }
  function panel(id, fill) {
    let parts;
    try {
      parts = fill();
    } catch (error) {
      parts = [html("p", { class: "quiet" }, `This cannot be shown: ${shown(error.message)}`)];
    }
    byId(id).replaceChildren(...parts);
  }

  // How many squares a pixel of the maps stands for.
  function unit() {
    const wide = Math.max(byId("table-map").clientWidth, byId("belief-map").clientWidth) || 400;
    return area.width / Math.max(wide, area.width * MIN_SQUARE);
  }
  function mapOf(at, which) {
    const overlay = state.view === "overlay", both = overlay && which === "truth";
    const name = which === "truth" ? "The table as it is" : "What the robot believes";
    const picture = svg("svg", { viewBox: `${rounded(area.west)} ${rounded(area.north)} ${rounded(area.width)} ${rounded(area.height)}`, role: "img", "aria-label": both ? "The table as it is, and what the robot believes" : name });
    if (area.width * MIN_SQUARE > byId("table-map").clientWidth) {
      picture.setAttribute("class", "large");
      picture.style.minWidth = `${area.width * MIN_SQUARE}px`;
    }
    if (which === "truth") picture.append(drawTruth(at));
    if (which === "truth" && at.layers.has("impression")) picture.append(drawImpression(at));
    if (which === "truth" && state.checked && at.layers.has("certificate")) picture.append(drawCertificate(at, state.checked));
    if (which === "belief" || both) picture.append(drawBelief(at));
    if (which === "truth") picture.append(drawRobot(at));
    return picture;
  }
  function showField() {
    const number = fieldNumber.value === "" ? -1 : Number(fieldNumber.value);
    output.textContent = fields[number] ? fieldInWords(number, fields[number]) : "";
    for (const { pick } of Object.values(retina)) pick(number);
  }

  // Goes to a step and writes it into the address, so that the back button leads back.
  function go(step) {
    const target = Math.min(Math.max(step, 0), last);
    if (target !== state.step) show(target);
    if (stepOfAddress() !== target) history.pushState(null, "", `#step=${target}`);
  }
  function stepOfAddress() {
    const found = /^#step=(\d{1,9})$/.exec(location.hash);
    return found ? Math.min(Number(found[1]), last) : null;
  }
  const readAddress = () => {
    const step = stepOfAddress();
    if (step !== null && step !== state.step) { pause(); show(step); }
  };
  function jump(way) {
    const steps = way > 0 ? events.filter((step) => step > state.step) : events.filter((step) => step < state.step).reverse();
    if (steps.length) go(steps[0]);
    else byId("status").textContent = way > 0 ? "There is no later event." : "There is no earlier event.";
  }

  function play() {
    if (state.timer) return pause();
    if (state.step === last) show(0);
    state.timer = setInterval(() => {
      if (state.step === last) return pause();
      show(state.step + 1);
    }, 1000 / Number(byId("speed").value));
    playing(true);
  }
  function pause() {
    if (!state.timer) return;
    clearInterval(state.timer);
    state.timer = null;
    playing(false);
    go(state.step);
  }
  function playing(now) {
    byId("play").textContent = now ? "❚❚" : "▶";
    byId("play").setAttribute("aria-label", now ? "pause" : "play");
    document.body.classList.toggle("playing", now);
  }
  function changeSpeed(way) {
    const select = byId("speed"), index = Math.min(Math.max(select.selectedIndex + way, 0), SPEEDS.length - 1);
    select.selectedIndex = index;
    if (state.timer) { pause(); play(); }
  }

  function setView(view) {
    state.view = view;
    document.body.dataset.view = view;
    byId(`view-${view}`).checked = true;
    draw();
  }
  function toggleHelp() {
    const help = byId("help");
    if (help.open) help.close();
    else help.showModal();
  }
  const keys = {
    " ": play, ArrowRight: () => go(state.step + 1), ArrowLeft: () => go(state.step - 1),
    PageDown: () => go(state.step + 10), PageUp: () => go(state.step - 10), Home: () => go(0), End: () => go(last),
    n: () => jump(1), p: () => jump(-1), "+": () => changeSpeed(1), "-": () => changeSpeed(-1),
    o: () => setView(state.view === "overlay" ? "side" : "overlay"), t: toggleTheme, "?": toggleHelp,
  };
  document.addEventListener("keydown", (event) => {
    const inText = /^(text|search|number)$/.test(event.target.type || "") || event.target.tagName === "SELECT";
    if (event.ctrlKey || event.altKey || event.metaKey || inText || (byId("help").open && event.key !== "?")) return;
    const onControl = event.key === " " && /^(BUTTON|SUMMARY|INPUT|A)$/.test(event.target.tagName) && event.target.type !== "range";
    const own = keys[event.key];
    if (!own || onControl) return;
    event.preventDefault();
    if (state.timer && event.key !== " " && !"+-ot?".includes(event.key)) pause();
    own();
  });

  const on = (id, kind, call) => byId(id).addEventListener(kind, call);
  on("play", "click", play);
  on("back", "click", () => { pause(); go(state.step - 1); });
  on("forward", "click", () => { pause(); go(state.step + 1); });
  on("first", "click", () => { pause(); go(0); });
  on("last", "click", () => { pause(); go(last); });
  on("former-event", "click", () => { pause(); jump(-1); });
  on("next-event", "click", () => { pause(); jump(1); });
  on("slider", "input", () => { pause(); show(Number(byId("slider").value)); });
  on("slider", "change", () => go(Number(byId("slider").value)));
  on("speed", "change", () => changeSpeed(0));
  on("theme", "click", toggleTheme);
  on("help-button", "click", toggleHelp);
  on("help-close", "click", toggleHelp);
  on("field", "input", showField);
  on("facts", "toggle", list);
  on("world", "toggle", list);
  on("word", "input", list);
  on("course", "toggle", list);
  on("statement", "change", list);
  for (const [id, name] of [["marks-shown", "marks"], ["digits", "digits"], ["inner", "inner"]]) {
    on(id, "change", () => { options[name] = byId(id).checked; draw(); });
  }
  window.addEventListener("hashchange", readAddress);
  window.addEventListener("popstate", readAddress);
  window.addEventListener("resize", draw);
  window.addEventListener("beforeprint", () => { byId("changes").open = byId("plan").open = true; });

  byId("slider").max = last;
  for (const speed of SPEEDS) byId("speed").append(html("option", { value: speed }, `${speed} a second`));
  byId("speed").selectedIndex = 1;
  byId("views").append(...choices("radio", "view", VIEWS, (name) => name === state.view, setView));
  const { certificate, ...layers } = LAYERS;
  byId("layers").append(...choices("checkbox", "layer", episode.certificate ? LAYERS : layers, (name) => state.layers.has(name), (name) => {
    if (!state.layers.delete(name)) state.layers.add(name);
    draw();
  }));
  document.body.dataset.view = state.view;
  drawEvents(episode, last);
  const wanted = stepOfAddress();
  show(wanted === null ? 0 : wanted);
  if (episode.certificate) {
    const tell = () => panel("certificate-panel", () => certificatePanel(state.checked, episode.header));
    byId("certificate").hidden = false;
    tell();
    setTimeout(() => {
      state.checked = checkCertificate(episode.file(), episode.certificate);
      tell();
      draw();
    }, CHECKED_AFTER);
  }
  return { state, show, go, jump };
}

// The steps with events, in order.
const eventsOf = (episode) => [...new Set(Object.values(episode.events).flat())].sort((a, b) => a - b);

// Marks of events above the slider, and the list of all of them.
function drawEvents(episode, last) {
  const marks = byId("marks"), list = byId("events-list");
  for (const [kind, steps] of Object.entries(episode.events)) {
    for (const step of steps) {
      marks.append(svg("line", { class: kind, x1: `${(100 * step) / Math.max(last, 1)}%`, x2: `${(100 * step) / Math.max(last, 1)}%`, y1: 0, y2: "100%" }));
    }
    const links = steps.slice(0, MAX_LISTED).map((step) => html("a", { href: `#step=${step}` }, String(step)));
    list.append(html("dt", {}, kind), html("dd", {}, ...links.flatMap((link) => [link, " "]), steps.length > MAX_LISTED ? `and ${steps.length - MAX_LISTED} more` : ""));
  }
  if (!list.children.length) list.append(html("dd", {}, "There are none."));
}

// Buttons or boxes to choose by.
function choices(type, group, words, isOn, call) {
  return Object.entries(words).map(([name, word]) => {
    const input = html("input", { type, name: group, id: `${group}-${name}`, value: name });
    input.checked = isOn(name);
    input.addEventListener("change", () => call(name));
    return html("label", {}, input, ` ${word}`);
  });
}

// The theme: as the system says, until one is chosen. The choice is remembered where the browser allows it.
function currentTheme() {
  return document.documentElement.dataset.theme || (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
}
function toggleTheme() {
  const theme = currentTheme() === "dark" ? "light" : "dark";
  document.documentElement.dataset.theme = theme;
  try { localStorage.setItem("utak-theme", theme); } catch { /* not remembered, then */ }
}
function rememberedTheme() {
  try {
    const theme = localStorage.getItem("utak-theme");
    if (theme === "dark" || theme === "light") document.documentElement.dataset.theme = theme;
  } catch { /* none, then */ }
}
