// --- the pointer ------------------------------------------------------------------------------

const nearest = (u, panel, off, left, top) => {
  const p = places(u, panel), x0 = left * p.ratio + p.left, y0 = top * p.ratio + p.top;
  let best = null, least = (NEAR * p.ratio) ** 2;
  for (const m of panel.marks) {
    if (off.has(m.label)) continue;
    if (m.kind === "field") {
      const x = u.posToVal(left, "x"), y = u.posToVal(top, "y");
      const i = m.x.findIndex((v) => v > x) - 1, j = m.y.findIndex((v) => v > y) - 1;
      if (i >= 0 && j >= 0) best = {m, x, y, value: m.values[j][i], px: left, py: top};
    }
    if (!CURVES.has(m.kind) && m.kind !== "bars") continue;
    each(m, (x, y) => {
      const px = p.X(x), py = p.Y(y), far = (px - x0) ** 2 + (py - y0) ** 2;
      if (far < least) {
        least = far;
        best = {m, x, y, px: (px - p.left) / p.ratio, py: (py - p.top) / p.ratio};
      }
    });
  }
  return best;
};
const told = (box, panel, hit) => {
  box.replaceChildren();
  if (hit.m.label) say(element("b", box), hit.m.label);
  const line = (axis, value) => {
    const row = element("span", box);
    const name = named(axis)[0];
    say(row, name ? `${name} ` : "");
    row.append(measured(axis, value));
  };
  line(panel.x, hit.x);
  line(panel.y, hit.y);
  if (hit.value !== undefined) {
    const row = element("span", box);
    if (hit.m.classes?.length) say(row, hit.value === null ? "none" : hit.m.classes[hit.value]);
    else { say(row, `${hit.m.words} `); row.append(number(hit.value)); }
  }
};

// --- one panel --------------------------------------------------------------------------------

const PANEL_SIDE = 48, GAP = 12, LOW = 150, HIGH = 460, MANY = 6;
const tick = (values, step) => {
  let decimals = 0;
  for (let whole = step; decimals < 8 && Math.abs(whole - Math.round(whole)) > 1e-6; whole *= 10)
    decimals += 1;
  return values.map((v) => v === null ? null : (Math.abs(v) >= 1e6 || (v !== 0 && decimals > 5)
    ? v.toExponential(1) : v.toFixed(decimals)).replace("-", "\u2212"));
};
// 1 to 9 times the powers of ten, the powers alone over many decades
const decades = (low, high) => {
  const found = [], most = high / low > 1e6 ? 1 : 9;
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high) && found.length < 500; power++)
    for (let k = 1; k <= most; k++) {
      const value = k * 10 ** power;
      if (value >= low && value <= high) found.push(value);
    }
  return found;
};
const powers = (values) => {
  const wide = values.at(-1) / values[0];
  return values.map((v) => {
    const lead = Math.round(v / 10 ** Math.floor(Math.log10(v) + 1e-9));
    if (lead !== 1 && (wide > 30 || (wide > 4 && lead !== 2 && lead !== 5))) return null;
    return v >= 1e5 || v < 1e-3 ? v.toExponential(0).replace("-", "\u2212") : String(Number(v.toPrecision(2)));
  });
};
class Panel {
  constructor(figure, said, host, frames, row) {
    Object.assign(this, {figure, said});
    this.box = element("div", host, {class: "panel"});
    // panels side by side keep their axes on one level
    const level = (name, words, others) => {
      if (others.some((one) => one)) say(element("p", this.box, {class: name}), words || "\u00a0");
    };
    level("panel-title", said.title, row.map((one) => one.title));
    level("y-words", said.y.words, row.map((one) => one.y.words));
    const above = ({top}) => top && `${top.words}: ${number(top.factor)} \u00d7 the axis below`;
    level("top-words", above(said), row.map(above));
    this.plot = element("div", this.box, {class: "plot"});
    if (said.x.words) say(element("p", this.box, {class: "x-words"}), said.x.words);
    const all = frames.length ? frames.flat() : said.marks;
    this.home = {x: ends(all, "x", said.x), y: ends(all, "y", said.y)};
  }
  axis(key) {
    const said = this.said[key];
    const bare = ![this.said.x, this.said.y].some((one) => one.words || one.names?.length);
    const covered = this.said.marks.some((m) => m.kind === "field");
    const axis = {
      stroke: () => variable("--ink"), font: `12px ${FONT}`, show: !bare,
      grid: {show: said.grid !== false && !covered && !said.names?.length,
        stroke: () => variable("--line"), width: 1},
      ticks: {stroke: () => variable("--quiet"), width: 1, size: 4}, gap: 4,
      space: key === "x" ? 60 : 32, size: key === "x" ? 28 : PANEL_SIDE,
    };
    if (key === "y" && said.names?.length)
      axis.size = Math.min(160, 14 + 7 * Math.max(...said.names.map((one) => one.length)));
    if (said.ticks?.length) {
      axis.splits = () => said.ticks;
      axis.values = (u, at) => at.map((v) => said.names?.[said.ticks.indexOf(v)] ?? number(v));
    } else if (said.log) {
      axis.splits = (u, i, low, high) => decades(low, high);
      axis.filter = (u, at) => at;
      axis.values = (u, at) => powers(at);
    }
    else axis.values = (u, at, i, space, step) => tick(at, step);
    return axis;
  }
  draw(width, height) {
    const {said} = this;
    if (said.equal) {
      this.full ??= {...this.home};
      this.even(width, height);
    }
    // uPlot hands the x it was told; the y would be that of its empty series
    const range = (key) => (u, low, high) => key === "x" && low !== null ? [low, high] : this.now[key];
    const scale = (key) => ({time: false, distr: said[key].log ? 3 : 1, range: range(key)});
    const home = this.home;
    this.now = {...home};
    const above = said.marks.some((m) => m.kind === "text" && m.at === "x" && m.y > 1);
    this.u = new uPlot({
      width, height, legend: {show: false}, padding: [above ? 22 : 8, 12, 0, 0],
      scales: {x: scale("x"), y: scale("y")}, axes: [this.axis("x"), this.axis("y")],
      series: [{}, {paths: () => null, points: {show: false}}],
      cursor: {drag: {x: true, y: true, uni: 24}, points: {show: false}, y: true, x: true},
      hooks: {
        draw: [(u) => paint(u, this.said, this.figure.off)],
        setCursor: [(u) => this.point(u)],
        setScale: [(u, key) => {
          this.now[key] = [u.scales[key].min, u.scales[key].max];
          this.figure.moved(this, key);
        }],
      },
    }, [home.x, home.y], this.plot);
    this.tip = element("div", this.u.over, {class: "tip", hidden: ""});
    this.spot = element("div", this.u.over, {class: "spot", hidden: ""});
  }
  even(width, height) {
    const wide = width - PANEL_SIDE - 20, high = height - 44, {x, y} = this.full;
    const per = Math.max((x[1] - x[0]) / wide, (y[1] - y[0]) / high);
    const grown = ([low, high_], size) => {
      const middle = (low + high_) / 2;
      return [middle - per * size / 2, middle + per * size / 2];
    };
    this.home = {x: grown(x, wide), y: grown(y, high)};
  }
  point(u) {
    const {left, top} = u.cursor;
    const hit = left < 0 ? null : nearest(u, this.said, this.figure.off, left, top);
    this.tip.hidden = this.spot.hidden = !hit;
    if (!hit) return;
    told(this.tip, this.said, hit);
    this.spot.style.transform = `translate(${hit.px}px,${hit.py}px)`;
    const room = this.tip.getBoundingClientRect(), wide = u.over.clientWidth;
    const x = Math.max(0, Math.min(hit.px + 12, wide - room.width));
    const y = hit.py > room.height + 12 ? hit.py - room.height - 10 : hit.py + 14;
    this.tip.style.transform = `translate(${x}px,${y}px)`;
  }
  zoom(factor) {
    const u = this.u, at = u.cursor;
    u.batch(() => {
      for (const key of ["x", "y"]) {
        const log = this.said[key].log, f = log ? Math.log : (v) => v, g = log ? Math.exp : (v) => v;
        const low = f(u.scales[key].min), high = f(u.scales[key].max);
        const pos = key === "x" ? at.left : at.top;
        const middle = pos >= 0 ? f(u.posToVal(pos, key)) : (low + high) / 2;
        u.setScale(key, {min: g(middle - (middle - low) * factor), max: g(middle + (high - middle) * factor)});
      }
    });
  }
  shift(across, up) {
    const u = this.u;
    u.batch(() => {
      for (const [key, steps] of [["x", across], ["y", up]]) {
        const log = this.said[key].log, f = log ? Math.log : (v) => v, g = log ? Math.exp : (v) => v;
        const low = f(u.scales[key].min), high = f(u.scales[key].max), by = 0.15 * steps * (high - low);
        u.setScale(key, {min: g(low + by), max: g(high + by)});
      }
    });
  }
  whole() {
    this.u.batch(() => {
      for (const key of ["x", "y"]) this.u.setScale(key, {min: this.home[key][0], max: this.home[key][1]});
    });
  }
  // other marks on the same axes; who has zoomed stays where he is
  show(said, home) {
    const near = (key) => this.now && [0, 1].every((i) =>
      Math.abs(this.now[key][i] - this.home[key][i]) <= 1e-9 * (this.home[key][1] - this.home[key][0]));
    const free = {x: !this.now || near("x"), y: !this.now || near("y")};
    Object.assign(this, {said, home, full: undefined});
    if (!this.u) return;
    if (said.equal) {
      this.fit(this.u.width, this.u.height);
      return;
    }
    this.u.batch(() => {
      for (const key of ["x", "y"]) {
        const [min, max] = free[key] ? home[key] : this.now[key];
        this.now[key] = [min, max];
        this.u.setScale(key, {min, max});
      }
    });
    this.u.redraw();
  }
  fit(width, height) {
    if (this.u && !this.said.equal) { this.u.setSize({width, height}); return; }
    this.u?.destroy();
    this.draw(width, height);
  }
}

// --- one figure -------------------------------------------------------------------------------

const button = (host, text, label, press) => {
  const made = element("button", host, {type: "button", text, ...label && {"aria-label": label}});
  made.addEventListener("click", press);
  return made;
};
const swatch = (host, m) => {
  const ratio = devicePixelRatio || 1, wide = 28, high = 12;
  const canvas = element("canvas", host, {width: wide * ratio, height: high * ratio});
  const c = canvas.getContext("2d"), pt = POINT * ratio;
  c.globalAlpha = m.opacity ?? 1;
  c.strokeStyle = c.fillStyle = colour(m.colour ?? "");
  const middle = high * ratio / 2;
  if (["curve", "line", "stems"].includes(m.kind)) {
    c.lineWidth = (m.width ?? 1.7) * pt;
    c.setLineDash((m.dash ?? []).map((v) => v * c.lineWidth));
    c.beginPath();
    strokes(c, [[0, middle, wide * ratio, middle]]);
    c.stroke();
    c.setLineDash([]);
  } else if (m.kind !== "points") c.fillRect(0, 0, wide * ratio, high * ratio);
  if (m.marker || m.kind === "points" || m.kind === "stems")
    marker(c, {pt}, {size: Math.max(4, Math.min(m.size ?? 6, 8))}, wide * ratio / 2, middle,
      m.marker || "circle", {open: m.open, edge: m.edge, edgeWidth: m.edge_width});
};

class Figure {
  constructor(host, said) {
    Object.assign(this, {host, said, off: new Set(), still: false});
    const name = host.closest("figure").querySelector("h3").textContent;
    this.live = element("div", null, {class: "live", role: "group", tabindex: "0",
      "aria-label": `${name}. Keys: plus and minus zoom, 0 shows all, arrows move.`});
    host.before(this.live);
    if (said.dial) this.dial(said.dial);
    this.tools();
    this.grid = element("div", this.live, {class: "panels"});
    const frames = said.dial?.frames ?? [];
    this.rows = said.panels.map((row, i) => row.map((one, j) => new Panel(
      this, one, this.grid, frames.map((frame) => frame[i][j]), row)));
    this.panels = this.rows.flat();
    this.level(this.panels.map((one) => one.home)).forEach((home, i) => { this.panels[i].home = home; });
    for (const one of this.panels) this.scale(one);
    this.legend = element("div", this.live, {class: "legend"});
    this.entries();
    this.live.addEventListener("keydown", (event) => this.key(event));
    host.closest("figure").classList.add("moves");
    this.size();
    new ResizeObserver(() => this.size()).observe(this.live);
  }
  // the ends of every panel, one and the same where an axis is shared
  level(homes) {
    return this.panels.map((one) => Object.fromEntries(["x", "y"].map((key) => {
      const beside = this.beside(one, key).map((other) => homes[this.panels.indexOf(other)][key]);
      return [key, [Math.min(...beside.map((e) => e[0])), Math.max(...beside.map((e) => e[1]))]];
    })));
  }
  // the same axes with other marks; false where the axes are others
  show(said) {
    const face = (one) => JSON.stringify([one.title, one.top, one.equal, ...["x", "y"].map((key) =>
      ({...one[key], low: 0, high: 0}))]);
    const faces = (rows) => JSON.stringify(rows.map((row) => row.map(face)));
    if (this.said.dial || said.dial || faces(said.panels) !== faces(this.said.panels)) return false;
    if (said.panels.flat().some((one) => one.marks.some((m) => m.kind === "field" && m.words))) return false;
    this.said = said;
    const news = said.panels.flat();
    const homes = news.map((one) => ({x: ends(one.marks, "x", one.x), y: ends(one.marks, "y", one.y)}));
    const level = this.level(homes);
    this.quietly(() => this.panels.forEach((one, i) => one.show(news[i], level[i])));
    this.entries();
    return true;
  }
  // panels that share an axis with one
  beside(panel, key) {
    const way = this.said[`share_${key}`];
    const row = this.rows.find((one) => one.includes(panel)), place = row.indexOf(panel);
    if (way === "row") return row;
    return way === "column" ? this.rows.map((one) => one[place]) : [panel];
  }
  tools() {
    const bar = element("div", this.live, {class: "tools"});
    button(bar, "+", "zoom in", () => this.zoom(0.6));
    button(bar, "\u2212", "zoom out", () => this.zoom(1 / 0.6));
    button(bar, "all", "show all", () => this.whole());
  }
  zoom(factor) { this.quietly(() => this.panels.forEach((one) => one.zoom(factor))); }
  whole() { this.quietly(() => this.panels.forEach((one) => one.whole())); }
  quietly(act) {
    this.still = true;
    act();
    this.still = false;
  }
  key(event) {
    if (event.target !== this.live || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
    if (event.key === "+" || event.key === "=") this.zoom(0.6);
    else if (event.key === "-") this.zoom(1 / 0.6);
    else if (event.key === "0") this.whole();
    else if (step[event.key])
      this.quietly(() => this.panels.forEach((one) => one.shift(...step[event.key])));
    else return;
    event.preventDefault();
  }
  moved(panel, key) {
    if (this.still || !panel.u) return;
    const {min, max} = panel.u.scales[key];
    this.quietly(() => {
      for (const other of this.beside(panel, key))
        if (other !== panel && other.u) other.u.setScale(key, {min, max});
    });
  }
  // --- what can be switched
  entries() {
    this.legend.replaceChildren();
    const seen = new Map();
    for (const m of this.panels.flatMap((one) => one.said.marks)) {
      if (m.label && !seen.has(m.label)) seen.set(m.label, m);
      if (m.classes?.length) for (const code of [...new Set(m.values.flat())].sort((a, b) => a - b))
        if (code !== null) seen.set(m.classes[code], {kind: "bars", fixed: true, colour: m.colours[code]});
    }
    for (const [label, m] of seen) {
      if (m.fixed) {
        const one = element("span", this.legend, {class: "entry"});
        swatch(one, m);
        say(one, label);
        continue;
      }
      const one = button(this.legend, "", "", () => {
        if (this.off.has(label)) this.off.delete(label); else this.off.add(label);
        one.setAttribute("aria-pressed", String(!this.off.has(label)));
        this.redraw();
      });
      one.setAttribute("aria-pressed", String(!this.off.has(label)));
      swatch(one, m);
      say(one, label);
    }
  }
  // the colours of a field with numbers, from low to high
  scale(panel) {
    const m = panel.said.marks.find((one) => one.kind === "field" && one.words && !one.classes?.length);
    if (!m) return;
    const bar = element("p", panel.box, {class: "scale"}), [low, high] = bounds(m);
    say(bar, m.words);
    const ends = element("span", bar);
    ends.append(`${number(low)} `);
    element("i", ends).style.background = `linear-gradient(to right,${m.colours})`;
    ends.append(` ${number(high)}${m.log ? " (logarithmic)" : ""}`);
  }
  dial({words: name, values, start, told: lines}) {
    const box = element("div", this.live, {class: "dial"}), label = element("label", box);
    say(label, name);
    const range = element("input", label, {type: "range", min: 0, max: values.length - 1, step: 1});
    range.value = start;
    const output = element("output", box);
    const turn = () => {
      const place = Number(range.value), frame = this.said.dial.frames[place];
      output.textContent = lines[place];
      range.setAttribute("aria-valuetext", values[place]);
      if (!this.rows) return;
      this.rows.forEach((row, i) => row.forEach((one, j) => { one.said.marks = frame[i][j]; }));
      this.redraw();
    };
    range.addEventListener("input", turn);
    turn();
  }
  redraw() { for (const one of this.panels) one.u?.redraw(false); }
  recolour() {
    this.entries();
    for (const one of this.panels) one.u?.redraw();
  }
  size() {
    const wide = this.live.clientWidth;
    if (!wide || wide === this.wide) return;
    this.wide = wide;
    const {size, panels, heights} = this.said, across = panels[0].length;
    const columns = wide >= SMALL ? across : this.panels.length > MANY ? Math.min(2, across) : 1;
    this.grid.style.gridTemplateColumns = `repeat(${columns},minmax(0,1fr))`;
    const shares = heights?.length ? heights : panels.map(() => 1);
    const whole = shares.reduce((a, b) => a + b, 0);
    const width = Math.floor((wide - GAP * (columns - 1)) / columns);
    this.rows.forEach((row, i) => {
      const ratio = size[1] * shares[i] / whole / (size[0] / across);
      const height = Math.round(Math.max(LOW, Math.min(HIGH, width * ratio)));
      for (const one of row) one.fit(width, height);
    });
  }
}

// --- a picture as it travels -------------------------------------------------------------------

// arrays stand once in a picture: {"in": place}, those in equal steps as their ends
const whole = (text) => {
  const said = JSON.parse(text), arrays = said.arrays.map((one) => Array.isArray(one) ? one
    : Array.from({length: one.n}, (_, i) => one.from + (one.to - one.from) * i / (one.n - 1)));
  const marks = (list) => {
    for (const m of list) for (const key in m)
      if (m[key]?.in !== undefined) m[key] = arrays[m[key].in];
  };
  for (const panel of said.panels.flat()) marks(panel.marks);
  for (const frame of said.dial?.frames ?? []) frame.flat().forEach(marks);
  return said;
};
