// Pictures that move: each figure with data becomes a plot by uPlot; its still picture stays for
// print and for readers without script. Every word is set as text.
const POINT = 4 / 3, NEAR = 48, SMALL = 520;
const THEME = {"": "--ink", "#22303c": "--ink", "#66727d": "--quiet", "#d5dbe0": "--line",
  "white": "--paper"};
const dark = matchMedia("(prefers-color-scheme: dark)");
let found = {};
const variable = (name) => found[name] ??=
  getComputedStyle(document.documentElement).getPropertyValue(name).trim();
// on a dark page a dark colour is mixed with white until one can see it
const BRIGHT = 0.26;
const light = ([r, g, b]) => [0.2126 * r, 0.7152 * g, 0.0722 * b]
  .reduce((sum, part) => sum + part, 0);
const parts16 = (said) => [1, 3, 5].map((i) => parseInt(said.slice(i, i + 2), 16) / 255);
const linear = (part) => part ** 2.2;
const lifted = (said) => {
  const own = parts16(said);
  for (let mix = 0; mix < 1; mix += 0.05) {
    const mixed = own.map((part) => part + mix * (1 - part));
    if (light(mixed.map(linear)) >= BRIGHT)
      return `rgb(${mixed.map((part) => Math.round(255 * part))})`;
  }
  return "#fff";
};
const colour = (said) => {
  if (said in THEME) return variable(THEME[said]);
  return dark.matches ? found[said] ??= lifted(said) : said;
};
const FONT = 'system-ui,"Segoe UI",Roboto,"Helvetica Neue",Arial,"DejaVu Sans",sans-serif';

// --- words ------------------------------------------------------------------------------------

const element = (name, parent, said = {}) => {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(said))
    if (key === "text") made.textContent = value; else made.setAttribute(key, value);
  parent?.append(made);
  return made;
};
// "T$_{f}$, $K_{v}$ at 5 \$": pieces of [text, whether it is an index]
const pieces = (words) => {
  const parts = [];
  let rest = 0;
  for (const one of words.matchAll(/\$([^$_\\]*)_\{([^}]*)\}\$/g)) {
    parts.push([words.slice(rest, one.index) + one[1], false], [one[2], true]);
    rest = one.index + one[0].length;
  }
  parts.push([words.slice(rest), false]);
  return parts.filter(([text]) => text).map(([text, low]) => [text.replaceAll("\\$", "$"), low]);
};
const say = (parent, words) => {
  for (const [text, low] of pieces(words))
    if (low) element("sub", parent, {text}); else parent.append(text);
  return parent;
};
const number = (value) => {
  if (value === null || !Number.isFinite(value)) return "none";
  const size = Math.abs(value);
  const text = size !== 0 && (size >= 1e6 || size < 1e-3)
    ? value.toExponential(3) : String(Number(value.toPrecision(4)));
  return text.replaceAll("-", "\u2212");
};
// "half backlash b' [um]" -> its words and its unit
const named = (axis) => [axis.words.replace(/\s*\[[^\]]*\]\s*/g, " ").trim(), axis.unit ?? ""];
const measured = (axis, value) => {
  if (axis.names?.length && axis.ticks) {
    const place = axis.ticks.indexOf(value);
    if (place >= 0) return axis.names[place];
  }
  const unit = named(axis)[1];
  return number(value) + (unit && unit !== "-" ? `\u00a0${unit}` : "");
};

// --- extents ----------------------------------------------------------------------------------

const CURVES = new Set(["curve", "points", "stems"]);
const extent = (marks, key, axis) => {
  const seen = [];
  const add = (v) => { if (v !== null && Number.isFinite(v) && (!axis.log || v > 0)) seen.push(v); };
  for (const m of marks) {
    if (CURVES.has(m.kind)) m[key].forEach((v, i) => { if (m.x[i] !== null && m.y[i] !== null) add(v); });
    if (m.kind === "stems" && key === "y") add(m.low);
    if (m.kind === "band" && key === "x") m.x.forEach(add);
    if (m.kind === "band" && key === "y" && m.at !== "x") [...m.low, ...m.high].forEach(add);
    if ((m.kind === "span" || m.kind === "line") && m[key] != null) [m[key]].flat().forEach(add);
    if (m.kind === "bars") {
      if (key === "y") { add(0); m.y.forEach((v) => add(v * 1.05)); }
      else m.x.forEach((v) => { add(v - m.width / 2); add(v + m.width / 2); });
    }
    if (m.kind === "field") m[key].forEach(add);
  }
  let low = Infinity, high = -Infinity;
  for (const v of seen) { low = Math.min(low, v); high = Math.max(high, v); }
  if (low > high) [low, high] = [axis.log ? 1 : 0, axis.log ? 10 : 1];
  return [low, high];
};
const ends = (marks, key, axis) => {
  let [low, high] = extent(marks, key, axis);
  const margin = marks.some((m) => m.kind === "field") ? 0 : axis.margin ?? 0.05;
  if (axis.log) {
    const room = margin * Math.log(high / low) || 0.1;
    [low, high] = [low * Math.exp(-room), high * Math.exp(room)];
  } else {
    if (low === high) { const room = 0.05 * Math.abs(low) || 0.05; low -= room; high += room; }
    const room = margin * (high - low);
    low -= room; high += room;
  }
  return [axis.low ?? low, axis.high ?? high];
};

// --- marks ------------------------------------------------------------------------------------

const places = (u, panel) => {
  const {left, top, width, height} = u.bbox, ratio = devicePixelRatio || 1;
  const along = (key, start, size, turned) => {
    const f = panel[key].log ? Math.log : (v) => v;
    const low = f(u.scales[key].min), per = size / (f(u.scales[key].max) - low);
    return turned ? (v) => start + size - (f(v) - low) * per : (v) => start + (f(v) - low) * per;
  };
  return {X: along("x", left, width), Y: along("y", top, height, true), ratio, left, top, width,
    height, pt: POINT * ratio};
};
const SHAPES = {
  circle: (c, r) => c.arc(0, 0, r, 0, 2 * Math.PI),
  dot: (c, r) => c.arc(0, 0, r / 2, 0, 2 * Math.PI),
  square: (c, r) => c.rect(-r, -r, 2 * r, 2 * r),
  diamond: (c, r) => polygon(c, [[0, -1.4 * r], [1.4 * r, 0], [0, 1.4 * r], [-1.4 * r, 0]]),
  "thin diamond": (c, r) => polygon(c, [[0, -1.4 * r], [0.8 * r, 0], [0, 1.4 * r], [-0.8 * r, 0]]),
  up: (c, r) => polygon(c, [[0, -r], [r, r], [-r, r]]),
  down: (c, r) => polygon(c, [[0, r], [r, -r], [-r, -r]]),
  cross: (c, r) => strokes(c, [[-r, -r, r, r], [-r, r, r, -r]]),
  plus: (c, r) => strokes(c, [[-r, 0, r, 0], [0, -r, 0, r]]),
  upright: (c, r) => strokes(c, [[0, -r, 0, r]]),
  level: (c, r) => strokes(c, [[-r, 0, r, 0]]),
};
const polygon = (c, corners) => {
  corners.forEach(([x, y], i) => i ? c.lineTo(x, y) : c.moveTo(x, y));
  c.closePath();
};
const strokes = (c, lines) => lines.forEach(([a, b, d, e]) => { c.moveTo(a, b); c.lineTo(d, e); });
const marker = (c, p, m, x, y, shape, {open = false, edge = "", edgeWidth = 1} = {}) => {
  c.save();
  c.translate(x, y);
  c.beginPath();
  SHAPES[shape](c, m.size * p.pt / 2);
  if (!open) c.fill();
  // nothing but its strokes: an edge would be all of it
  const bare = shape === "cross" || shape === "plus";
  c.strokeStyle = edge && !bare ? colour(edge) : c.fillStyle;
  c.lineWidth = p.pt * (bare ? 0.3 * m.size : edgeWidth);
  c.stroke();
  c.restore();
};
const path = (c, p, m) => {
  let on = false;
  c.beginPath();
  for (let i = 0; i < m.x.length; i++) {
    if (m.x[i] === null || m.y[i] === null) { on = false; continue; }
    const x = p.X(m.x[i]), y = p.Y(m.y[i]);
    if (on) c.lineTo(x, y); else c.moveTo(x, y);
    on = true;
  }
  c.stroke();
};
const each = (m, draw) => m.x.forEach((x, i) => {
  if (x !== null && m.y[i] !== null) draw(x, m.y[i], i);
});
const rows = (c, m, size, room) => {
  c.font = `${size}px ${FONT}`;
  const found = [""];
  for (const word of m.words.split(" ")) {
    const longer = `${found.at(-1)} ${word}`.trim();
    if (c.measureText(longer).width > room && found.at(-1)) found.push(word);
    else found[found.length - 1] = longer;
  }
  return found;
};
const words = (c, p, m, x, y) => {
  if (m.wrap) {
    const size = (m.size ?? 8.5) * p.pt, all = rows(c, m, size, 0.92 * p.width);
    all.forEach((row, i) => words(c, p, {...m, wrap: false, words: row}, x,
      y + (i - (all.length - 1) / 2) * 1.35 * size));
    return;
  }
  const parts = pieces(m.words), size = (m.size ?? 8.5) * p.pt;
  const font = (low) => `${m.bold ? "600 " : ""}${low ? 0.75 * size : size}px ${FONT}`;
  const widths = parts.map(([text, low]) => { c.font = font(low); return c.measureText(text).width; });
  const width = widths.reduce((a, b) => a + b, 0), [dx, dy] = m.offset ?? [0, 0];
  const across = {left: 0, center: 0.5, right: 1}[m.across ?? "center"];
  let at = x + dx * p.pt - across * width;
  // words stay inside the picture
  at = Math.max(2, Math.min(at, c.canvas.width - width - 2));
  const base = {top: 0.8, center: 0.35, bottom: -0.2, baseline: 0}[m.up ?? "center"] ?? 0.35;
  const line = y - dy * p.pt + base * size;
  if (m.box) {
    c.save();
    c.globalAlpha = 0.75;
    c.fillStyle = variable("--paper");
    c.fillRect(at - 2, line - size, width + 4, 1.3 * size);
    c.restore();
  }
  c.fillStyle = colour(m.colour ?? "");
  c.textAlign = "left";
  c.textBaseline = "alphabetic";
  parts.forEach(([text, low], i) => {
    c.font = font(low);
    c.fillText(text, at, line + (low ? 0.2 * size : 0));
    at += widths[i];
  });
};
const mixed = (colours, part) => {
  const at = Math.max(0, Math.min(1, part)) * (colours.length - 1), low = Math.floor(at);
  const one = colours[low], two = colours[Math.min(low + 1, colours.length - 1)], f = at - low;
  const at16 = (said, i) => parseInt(said.slice(1 + 2 * i, 3 + 2 * i), 16);
  return `rgb(${[0, 1, 2].map((i) => Math.round(at16(one, i) * (1 - f) + at16(two, i) * f))})`;
};
const bounds = (m) => {
  const all = m.values.flat().filter((v) => v !== null);
  return [m.low ?? Math.min(...all), m.high ?? Math.max(...all)];
};
const MARKS = {
  curve: (c, p, m) => {
    c.lineWidth = (m.width ?? 1.7) * p.pt;
    c.setLineDash((m.dash ?? []).map((v) => v * c.lineWidth));
    path(c, p, m);
    c.setLineDash([]);
    if (m.marker) each({...m}, (x, y) => marker(c, p, {size: m.size ?? 6}, p.X(x), p.Y(y), m.marker));
  },
  points: (c, p, m) => each(m, (x, y) => marker(c, p, {size: m.size ?? 6}, p.X(x), p.Y(y),
    m.marker ?? "circle", {open: m.open, edge: m.edge, edgeWidth: m.edge_width})),
  stems: (c, p, m) => {
    c.lineWidth = 1.3 * p.pt;
    each(m, (x, y) => {
      c.beginPath();
      c.moveTo(p.X(x), p.Y(m.low));
      c.lineTo(p.X(x), p.Y(y));
      c.stroke();
      marker(c, p, m, p.X(x), p.Y(y), "circle", {open: m.open});
    });
  },
  band: (c, p, m) => {
    const Y = m.at === "x" ? (v) => p.top + p.height * (1 - v) : p.Y;
    const half = (i, side) => {
      const j = i + side;
      return j < 0 || j >= m.x.length ? m.x[i] : (m.x[i] + m.x[j]) / 2;
    };
    let run = [];
    const fill = () => {
      if (run.length) {
        c.beginPath();
        const top = [], low = [];
        for (const i of run) for (const side of m.step ? [-1, 1] : [0]) {
          const x = p.X(side ? half(i, side) : m.x[i]);
          top.push([x, Y(m.high[i])]);
          low.unshift([x, Y(m.low[i])]);
        }
        polygon(c, [...top, ...low]);
        c.fill();
      }
      run = [];
    };
    m.x.forEach((x, i) => x === null || m.low[i] === null || m.high[i] === null ? fill() : run.push(i));
    fill();
  },
  span: (c, p, m) => {
    const [x0, x1] = m.x ? m.x.map(p.X) : [p.left, p.left + p.width];
    const [y0, y1] = m.y ? m.y.map(p.Y) : [p.top, p.top + p.height];
    c.fillRect(Math.min(x0, x1), Math.min(y0, y1), Math.abs(x1 - x0), Math.abs(y1 - y0));
  },
  line: (c, p, m) => {
    c.lineWidth = m.width * p.pt;
    c.setLineDash((m.dash ?? []).map((v) => v * c.lineWidth));
    c.beginPath();
    if (m.x != null) strokes(c, [[p.X(m.x), p.top, p.X(m.x), p.top + p.height]]);
    if (m.y != null) strokes(c, [[p.left, p.Y(m.y), p.left + p.width, p.Y(m.y)]]);
    c.stroke();
    c.setLineDash([]);
  },
  bars: (c, p, m) => each(m, (x, y, i) => {
    const left = p.X(x - m.width / 2), right = p.X(x + m.width / 2), top = p.Y(y), foot = p.Y(0);
    c.fillRect(left, Math.min(top, foot), right - left, Math.abs(foot - top));
    if (m.words?.[i]) words(c, p, {words: m.words[i], up: "bottom", size: 8}, (left + right) / 2, top - 2);
    c.fillStyle = colour(m.colour);
  }),
  field: (c, p, m) => {
    const [low, high] = bounds(m), f = m.log ? Math.log : (v) => v;
    m.values.forEach((row, j) => row.forEach((v, i) => {
      if (v === null) return;
      c.fillStyle = m.classes?.length ? m.colours[v]
        : mixed(m.colours, (f(v) - f(low)) / (f(high) - f(low) || 1));
      const x = p.X(m.x[i]), y = p.Y(m.y[j + 1]);
      c.fillRect(x, y, p.X(m.x[i + 1]) - x + 0.5, p.Y(m.y[j]) - y + 0.5);
    }));
  },
};
const paint = (u, panel, off) => {
  const c = u.ctx, p = places(u, panel);
  const seen = panel.marks.filter((m) => !off.has(m.label));
  seen.sort((a, b) => (a.order ?? 0) - (b.order ?? 0));
  c.save();
  c.beginPath();
  c.rect(p.left, p.top, p.width, p.height);
  c.clip();
  for (const m of seen) {
    if (!MARKS[m.kind]) continue;
    c.globalAlpha = m.opacity ?? 1;
    c.strokeStyle = c.fillStyle = colour(m.colour ?? "");
    MARKS[m.kind](c, p, m);
  }
  c.restore();
  c.save();
  for (const m of seen) {
    if (m.kind !== "text" || !m.words) continue;
    const inside = (key) => m[key] >= u.scales[key].min && m[key] <= u.scales[key].max;
    const free = {x: m.at === "panel" || m.at === "y", y: m.at === "panel" || m.at === "x"};
    if ((!free.x && !inside("x")) || (!free.y && !inside("y"))) continue;
    const x = free.x ? p.left + m.x * p.width : p.X(m.x);
    const y = free.y ? p.top + (1 - m.y) * p.height : p.Y(m.y);
    words(c, p, m, x, y);
  }
  c.restore();
};

