// The app: dials on the left, pictures that answer on the right. Every word is set as text.

const by = (id) => document.getElementById(id);
const figures = new Map();
dark.addEventListener("change", () => {
  found = {};
  for (const one of figures.values()) one.recolour();
});

// --- what is set, and what is asked for --------------------------------------------------------

const set = {changes: new Map(), dials: new Map(), heat: null};
let number_ = 0, asked = false, socket = null, ready = false, answered = false, slow = 0;
let knobs = new Map(), fields = new Map(), started = 0;
const finished = [];

const state = () => ({changes: [...set.changes], dials: Object.fromEntries(set.dials), heat: set.heat});
const parts = () => [...document.querySelectorAll(".part")]
  .filter((one) => one.open && !one.hidden).map((one) => one.dataset.part);
const speeds = () => ({low: by("low").valueAsNumber, high: by("high").valueAsNumber,
  count: by("count").valueAsNumber});
const send = (message) => {
  if (socket?.readyState !== WebSocket.OPEN) return false;
  socket.send(JSON.stringify(message));
  return true;
};
const faulty = ({low, high, count}) => {
  if (![low, high, count].every(Number.isFinite)) return "write numbers";
  if (low < 0.1 || high > 500000) return "allowed are 0.1 to 500000 rpm";
  if (low >= high) return "the first must be below the last";
  if (!Number.isInteger(count) || count < 2 || count > 2000) return "a whole number of 2 to 2000 speeds";
  return "";
};
const ask = () => {
  // at most one message a frame: the newest
  if (asked || !ready) return;
  asked = true;
  requestAnimationFrame(() => {
    asked = false;
    const range = speeds(), fault = faulty(range);
    for (const name of ["low", "high", "count"]) by(name).setAttribute("aria-invalid", String(Boolean(fault)));
    if (fault) {
      tell(`speeds of the run-up: ${fault}`, true);
      return;
    }
    number_ += 1;
    started = performance.now();
    answered = false;
    document.body.dataset.asked = String(number_);
    if (!send({kind: "show", number: number_, state: state(), speeds: range, parts: parts()})) return;
    tell("computing");
    by("stop").hidden = false;
    clearTimeout(slow);
    slow = setTimeout(() => {
      if (!answered) tell("computing; the first time after an installation kernels are compiled once, " +
        "which takes about half a minute");
    }, 4000);
  });
};

// --- the line of state -------------------------------------------------------------------------

const tell = (words, refused = false) => {
  const line = by("state");
  line.classList.toggle("refused", refused);
  if (line.textContent !== words) line.textContent = words;
};
const wait = (done, total) => {
  const bar = by("progress");
  bar.hidden = !(total > 1 && done < total);
  if (bar.hidden) return;
  bar.max = total;
  bar.value = done;
};

// --- dials -------------------------------------------------------------------------------------

const UNITS = {degC: "°C", um: "µm"};
const knob = (said) => {
  const host = element("div", by("knobs"), {class: "knob"});
  const id = `dial-${said.name}`;
  const label = element("label", host, {for: id});
  const row = element("div", host);
  const range = element("input", row, {type: "range", id, step: "any"});
  const box = element("input", row, {type: "number", step: "any", id: `${id}-number`});
  element("span", row, {class: "unit", text: UNITS[said.unit] ?? said.unit});
  const wrong = element("p", host, {class: "wrong", id: `${id}-wrong`});
  for (const one of [range, box]) one.setAttribute("aria-describedby", wrong.id);
  const made = {said, label, range, box, wrong};
  const turn = (value) => {
    if (!Number.isFinite(value)) {
      box.value = made.said.value ?? "";
      wrong.textContent = "write a number";
      return;
    }
    wrong.textContent = "";
    set.dials.set(said.name, value);
    ask();
  };
  range.addEventListener("input", () => {
    const value = snapped(range.valueAsNumber, made.said.step);
    box.value = value;
    describe(made, value);
    turn(value);
  });
  // a slider moves by its step with the arrow keys
  range.addEventListener("keydown", (event) => {
    const way = {ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageUp: 10, PageDown: -10}[event.key];
    if (!way || range.disabled) return;
    event.preventDefault();
    const value = snapped(range.valueAsNumber + way * made.said.step, made.said.step);
    range.value = Math.max(Number(range.min), Math.min(Number(range.max), value));
    range.dispatchEvent(new Event("input"));
  });
  box.addEventListener("change", () => { put(made, box.valueAsNumber); turn(box.valueAsNumber); });
  box.addEventListener("keydown", (event) => {
    if (event.key === "Enter") { event.preventDefault(); put(made, box.valueAsNumber); turn(box.valueAsNumber); }
  });
  return made;
};
const snapped = (value, step) => Number((Math.round(value / step) * step).toPrecision(10));
const describe = (one, value) => one.range.setAttribute("aria-valuetext",
  `${value} ${UNITS[one.said.unit] ?? one.said.unit}`.trim());
const put = (one, value) => {
  if (!Number.isFinite(value)) return;
  one.range.value = value;
  describe(one, value);
};
// an accepted value may lie beyond the slider
const reach = (one, value) => {
  if (!Number.isFinite(value)) return;
  one.range.min = Math.min(Number(one.range.min), value);
  one.range.max = Math.max(Number(one.range.max), value);
};
const follow = (one, said) => {
  one.said = said;
  one.label.textContent = said.held ? `${said.title} (${said.held})` : said.title;
  one.box.setAttribute("aria-label", `${said.title} ${UNITS[said.unit] ?? said.unit}`.trim());
  for (const input of [one.range, one.box]) input.disabled = Boolean(said.held);
  if (!one.range.max || !one.ranged) {
    one.range.min = said.low;
    one.range.max = said.high;
    one.ranged = true;
  }
  if (said.value !== null) reach(one, said.value);
  if (said.value !== null && (document.activeElement !== one.range || said.held)) put(one, said.value);
  if (document.activeElement !== one.box || said.held)
    one.box.value = said.value === null ? ""
      : said.held ? Number(said.value.toPrecision(4)) : said.value;
};

// --- fields ------------------------------------------------------------------------------------

const field = (said, host) => {
  const box = element("div", host, {class: "field"}), id = `field-${said.path}`;
  element("label", box, {for: id, text: said.title});
  let input;
  if (said.kind === "choice" || said.kind === "yes/no") {
    input = element("select", box, {id});
    for (const one of ["", ...(said.choices?.length ? said.choices : ["true", "false"])])
      element("option", input, {value: one, text: one || "left out"});
  } else input = element("input", box, {type: "text", id, spellcheck: "false", autocomplete: "off"});
  const range = said.minimum != null && said.maximum != null
    ? `${said.minimum} to ${said.maximum} ${said.unit ?? ""}`.trim() : said.unit ?? "";
  element("p", box, {class: "hint", text: [said.path, range].filter(Boolean).join(": ")});
  const wrong = element("p", box, {class: "wrong", id: `${id}-wrong`});
  input.setAttribute("aria-describedby", wrong.id);
  const made = {said, input, wrong, given: said.given};
  input.value = plain(said.given);
  input.addEventListener("change", () => {
    const text = input.value.trim();
    for (const [name, one] of knobs) if (one.said.fields.includes(said.path)) set.dials.delete(name);
    if (text === plain(said.given)) set.changes.delete(said.path);
    else set.changes.set(said.path, text);
    ask();
  });
  input.addEventListener("keydown", (event) => {
    if (event.key !== "Enter") return;
    event.preventDefault();
    input.dispatchEvent(new Event("change"));
  });
  return made;
};
// a text of one word as one writes it: without its quotes
const plain = (text) => /^"[^"\\]*"$/.test(text) ? text.slice(1, -1) : text;
const form = (entries) => {
  const host = by("fields"), groups = new Map();
  host.replaceChildren();
  fields = new Map();
  for (const said of entries) {
    if (!groups.has(said.group)) {
      const fold = element("details", host);
      element("summary", fold, {text: said.group});
      groups.set(said.group, fold);
    }
    fields.set(said.path, field(said, groups.get(said.group)));
  }
};

// --- pictures ----------------------------------------------------------------------------------

const pins = new Map();
const pinnable = ["mesh", "gap", "run-up", "orbit"];
const GREY = "#66727d";
const withPins = (name, said) => {
  const kept = pins.get(name);
  if (!kept) return said;
  said.panels.flat().forEach((panel, i) => {
    if (kept[i]) panel.marks = [...kept[i], ...panel.marks];
  });
  return said;
};
const show = (host, name, text) => {
  const said = withPins(name, whole(text)), one = figures.get(name);
  if (one?.show(said)) return;
  if (one) {
    one.live.remove();
    figures.delete(name);
  }
  const made = new Figure(host, said);
  figures.set(name, made);
  if (name === "run-up") made.panels.forEach((panel) => clicked(panel));
};
const clicked = (panel) => {
  let from = null;
  const over = panel.u.over;
  over.addEventListener("pointerdown", (event) => { from = [event.clientX, event.clientY]; });
  over.addEventListener("pointerup", (event) => {
    if (!from || Math.hypot(event.clientX - from[0], event.clientY - from[1]) > 4) return;
    const rpm = panel.u.posToVal(event.clientX - over.getBoundingClientRect().left, "x");
    const one = knobs.get("speed");
    const value = Number(rpm.toPrecision(5));
    put(one, value);
    one.box.value = value;
    set.dials.set("speed", value);
    ask();
  });
};
const pin = () => {
  for (const name of pinnable) {
    const one = figures.get(name);
    if (!one) continue;
    pins.set(name, one.said.panels.flat().map((panel) => panel.marks
      .filter((m) => m.kind === "curve" && m.label !== "pinned" && m.x.length)
      .map((m) => ({...m, colour: GREY, width: 1, opacity: 0.8, order: 0.5, label: "pinned"}))));
  }
  const words = [...knobs.values()].map((one) =>
    `${one.said.title} ${one.said.value} ${UNITS[one.said.unit] ?? one.said.unit}`.trim());
  by("pinned").textContent = `Pinned, grey: ${words.join("; ")}`;
  by("pinned").hidden = by("unpin").hidden = false;
  ask();
};


// --- answers of the server ---------------------------------------------------------------------

const list = (host, lines) => host?.replaceChildren(...lines.map((words) => element("li", null, {text: words})));
const part = (message) => {
  const box = document.querySelector(`.part[data-part="${message.name}"]`);
  if (!box) return;
  list(box.querySelector(":scope > .lines"), message.lines);
  const host = box.querySelector(":scope > figure > .canvas");
  if (message.picture && host) show(host, message.name, message.picture);
  // what is refused leaves the last picture, pale
  box.querySelector(":scope > figure")?.classList.toggle("stale",
    !message.picture && !message.gears && message.lines.length > 0);
  if (message.gears) {
    host.previousElementSibling?.classList.contains("live") && host.previousElementSibling.remove();
    const live = element("div", null, {class: "live"});
    host.before(live);
    drawGears(live, JSON.parse(message.gears));
    host.closest("figure").classList.add("moves", "turns");
  }
  const body = box.querySelector(":scope tbody"), text = box.querySelector("pre.rows");
  if (body) body.replaceChildren(...message.rows.map((row) => {
    const made = element("tr");
    row.forEach((cell, i) => element("td", made, {text: cell,
      ...i === 1 && cell === "look here" && {class: "look"}}));
    return made;
  }));
  if (text) text.textContent = message.rows.map((row) => row[0]).join("\n");
  if (message.pairs.length) by("pairs").replaceChildren(...message.pairs.map(([words, place]) => {
    const button = element("button", null, {type: "button", text: words});
    button.addEventListener("click", () => { set.dials.set("part", place); ask(); });
    return button;
  }));
  wait(message.done, message.total);
  dispatchEvent(new CustomEvent("part", {detail: message}));
};
const now = (message) => {
  by("title").textContent = message.title;
  document.title = `${message.title} · thermogear`;
  for (const said of message.dials) {
    if (!knobs.has(said.name)) knobs.set(said.name, knob(said));
    follow(knobs.get(said.name), said);
  }
  // gears whose errors are stated are no drawings of a class
  for (const [name, one] of knobs) {
    const gone = !message.dials.some((said) => said.name === name);
    one.range.closest(".knob").hidden = gone;
    if (gone) set.dials.delete(name);
  }
  by("heat").checked = message.computed;
  for (const [path, one] of fields) {
    one.given = message.fields[path] ?? "";
    if (document.activeElement !== one.input) one.input.value = plain(one.given);
  }
  by("temperatures").tBodies[0].replaceChildren(...message.temperatures.map(([words, value]) => {
    const row = element("tr");
    element("td", row, {text: words});
    element("td", row, {text: value, class: "n"});
    return row;
  }));
  by("command").textContent = message.command;
  by("warned").hidden = !message.warnings.length;
  list(by("warned").querySelector("ul"), message.warnings);
  wrong([]);
};
const wrong = (rows) => {
  const marks = [...knobs.values(), ...fields.values()];
  for (const one of marks) {
    one.wrong.textContent = "";
    for (const input of [one.range, one.box, one.input]) input?.removeAttribute("aria-invalid");
  }
  for (const {field: path, words} of rows) for (const one of marks) {
    const mine = one.said.fields ?? [one.said.path];
    if (!mine.some((own) => own === path || path.startsWith(`${own}.`) || path.startsWith(`${own}[`))) continue;
    one.wrong.textContent = words;
    for (const input of [one.box, one.input]) input?.setAttribute("aria-invalid", "true");
  }
};
const save = ({name, text}) => {
  const address = URL.createObjectURL(new Blob([text], {type: name.endsWith(".html") ? "text/html" : "text/plain"}));
  const link = element("a", null, {href: address, download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
  tell(`saved ${name}`);
};
const heard = (message) => {
  const {kind} = message;
  if (kind === "hello") {
    form(message.form);
    for (const name of ["low", "high", "count"]) if (!by(name).value) by(name).value = message.speeds[name];
    document.querySelector('[data-part="series"]').hidden = !message.series;
    ready = true;
    ask();
    return;
  }
  if (kind === "file") {
    by("stop").hidden = document.body.dataset.done === document.body.dataset.asked;
    wait(1, 1);
    save(message);
    return;
  }
  if (kind === "progress") {
    tell(`computing ${message.name}: ${message.done} of ${message.total}`);
    wait(message.done, message.total);
    return;
  }
  if (kind === "refused") {
    if (message.number !== -1 && message.number !== number_) return;
    answered = true;
    if (message.number === number_) document.body.dataset.done = String(number_);
    wait(1, 1);
    by("stop").hidden = true;
    tell(message.rows.map((one) => one.words).join(" · "), true);
    wrong(message.rows);
    return;
  }
  if (message.number !== number_) return;
  answered = true;
  if (kind === "now") now(message);
  if (kind === "part") {
    part(message);
    tell(message.done < message.total
      ? `computing ${message.name}: ${message.done} of ${message.total}` : `computing; ${message.name} is there`);
  }
  if (kind === "done") {
    wait(1, 1);
    by("stop").hidden = true;
    tell(`done in ${((performance.now() - started) / 1000).toFixed(1)} s`);
    finished.push(message.number);
    document.body.dataset.done = String(message.number);
    document.body.dataset.ends = JSON.stringify(finished);
  }
};

// --- the way to the server ---------------------------------------------------------------------

const connect = () => {
  ready = false;
  socket = new WebSocket(`ws://${location.host}/talk${location.search}`);
  socket.addEventListener("message", (event) => heard(JSON.parse(event.data)));
  socket.addEventListener("open", () => tell("reading the case"));
  socket.addEventListener("close", (event) => {
    ready = false;
    wait(1, 1);
    by("stop").hidden = true;
    tell(event.code === 1013 || event.code === 1008 ? event.reason
      : "the server does not answer; start thermogear app again and open the address it prints", true);
    setTimeout(connect, 2000);
  });
};
by("dials").addEventListener("submit", (event) => event.preventDefault());
by("heat").addEventListener("change", () => {
  set.heat = by("heat").checked;
  if (set.heat) for (const name of ["gears", "housing"]) set.dials.delete(name);
  ask();
});
by("back").addEventListener("click", () => {
  set.changes.clear();
  set.dials.clear();
  set.heat = null;
  for (const one of knobs.values()) { one.ranged = false; one.box.blur(); }
  ask();
});
by("pin").addEventListener("click", pin);
by("unpin").addEventListener("click", () => {
  pins.clear();
  by("pinned").hidden = by("unpin").hidden = true;
  ask();
});
for (const what of ["case", "report"]) by(what).addEventListener("click", () => {
  if (!send({kind: "export", number: number_, what, state: state()})) return;
  tell(`writing the ${what}`);
  by("stop").hidden = false;
});
by("stop").addEventListener("click", () => {
  send({kind: "stop", number: number_});
  number_ += 1;
  wait(1, 1);
  by("stop").hidden = true;
  tell("stopped; turn a dial to go on");
});
for (const name of ["low", "high", "count"]) by(name).addEventListener("change", ask);
for (const one of document.querySelectorAll(".part")) one.addEventListener("toggle", () => {
  // a folded part's work ends, too
  if (one.open || document.body.dataset.done !== document.body.dataset.asked) ask();
});
connect();
