"use strict";

/* Both gears in mesh, to be turned through a mesh period.
 *
 * drawGears(element, data): data is what GearDrawing.to_json() told, or a list of such, one for
 * each operating point. Lengths in mm, gaps in µm, angles in rad. Nothing is computed here but
 * places: small things times a factor, and turns. Colours: --gear-cold, --gear-hot, --gear-line.
 */
function drawGears(element, data) {
  const SVG = "http://www.w3.org/2000/svg";
  const STATES = { undeformed: ["cold, as drawn", "var(--gear-cold, #0072B2)", 3],
                   hot: ["hot", "var(--gear-hot, #D55E00)", 1.6] };
  const LINE = "var(--gear-line, #009E73)";
  const SHARES = ["#482878", "#3e4a89", "#31688e", "#26838f", "#1f9d8a", "#6cce5a", "#b6de2b"];
  const FACTORS = [1, 2, 5, 10, 20, 50, 100];
  const MOST = 300;
  const drawings = Array.isArray(data) ? data : [data];
  let now = drawings[0], factor = now.factor, phase = nearest(now, 0.25);
  const shown = {};
  const id = "gears-" + (element.id || Math.random().toString(36).slice(2, 8));

  // --- pieces ------------------------------------------------------------------------------
  function html(name, parent, words) {
    const made = document.createElement(name);
    if (words !== undefined) made.textContent = words;
    if (parent) parent.append(made);
    return made;
  }
  function svg(name, parent, attributes, look) {
    const made = document.createElementNS(SVG, name);
    for (const key in attributes || {}) made.setAttribute(key, attributes[key]);
    for (const key in look || {}) made.style.setProperty(key, look[key]);
    if (parent) parent.append(made);
    return made;
  }
  function line(colour, width, dash) {
    const look = { fill: "none", stroke: colour, "stroke-width": width + "px",
                   "vector-effect": "non-scaling-stroke", "stroke-linejoin": "round" };
    if (dash) look["stroke-dasharray"] = dash;
    return look;
  }
  function round(value) { return Math.round(value * 1e5) / 1e5; }
  function nearest(one, wanted) {
    let best = 0;
    one.phase.forEach((p, k) => {
      if (Math.abs(p - wanted) < Math.abs(one.phase[best] - wanted)) best = k;
    });
    return best;
  }
  function colourOf(share) {
    const place = Math.round(Math.min(Math.max(share, 0), 1) * (SHARES.length - 1));
    return SHARES[place];
  }

  // --- places: the same as GearDrawing's ---------------------------------------------------
  function centre(state, gear, times) {
    const a = now.centre_distance;
    return gear === 0 ? 0 : a + times * (state.centre_distance - a);
  }
  function axis(state, gear, place, times) {
    const one = now.gears[gear], behind = gear === 0 ? 0 : state.lag[place];
    const turn = 2 * Math.PI * now.phase[place] / one.teeth;
    const moved = times * (state.set_back + behind) / one.circles.base;
    return one.start + moved + (gear === 0 ? turn : -turn);
  }
  function shape(state, gear, times) {
    const tight = now.gears[gear].tight, own = state.outlines[gear];
    return tight.map((value, k) => value + times * (own[k] - value));
  }
  function pathOf(flat, step) {
    let words = "";
    for (let k = 0; k < flat.length; k += 2 * step) {
      words += (k ? "L" : "M") + round(flat[k]) + " " + round(flat[k + 1]);
    }
    return words;
  }
  function wholePath(state, gear) {
    const flat = shape(state, gear, 1), teeth = now.gears[gear].teeth;
    let words = "";
    for (let n = 0; n < teeth; n += 1) {
      const c = Math.cos(2 * Math.PI * n / teeth), s = Math.sin(2 * Math.PI * n / teeth);
      for (let k = 0; k < flat.length - 2; k += 4) {
        const x = flat[k] * c - flat[k + 1] * s, y = flat[k] * s + flat[k + 1] * c;
        words += (words ? "L" : "M") + round(x) + " " + round(y);
      }
    }
    return words + "Z";
  }
  function turned(state, gear, angle, times) {
    return "translate(" + round(centre(state, gear, times)) + " 0) rotate(" +
      (angle * 180 / Math.PI) + ")";
  }

  // --- what stands on the page ---------------------------------------------------------------
  element.textContent = "";
  const group = html("div", element);
  group.setAttribute("role", "group");
  group.setAttribute("aria-label", "The gears in mesh");
  group.className = "gears";
  const controls = html("div", group), pictures = html("div", group), told = html("p", group);
  controls.className = "gears-controls";
  pictures.className = "gears-pictures";
  told.className = "gears-told";
  told.setAttribute("aria-live", "polite");
  for (const [node, look] of [[controls, { display: "flex", "flex-wrap": "wrap",
        gap: ".5rem 1.2rem", "align-items": "center" }],
      [pictures, { display: "flex", "flex-wrap": "wrap", gap: "1rem" }]]) {
    for (const key in look) node.style.setProperty(key, look[key]);
  }

  function labelled(words, control) {
    const label = html("label", controls, words + " ");
    label.append(control);
    control.style.setProperty("vertical-align", "middle");
    return control;
  }
  const points = drawings.length > 1 ? labelled("operating point", html("select")) : null;
  if (points) {
    drawings.forEach((one, k) => { html("option", points, one.words).value = String(k); });
    points.addEventListener("change", () => {
      now = drawings[Number(points.value)];
      factor = now.factor;
      enlarge.value = String(factor);
      build();
    });
  }
  const slider = labelled("mesh phase", html("input"));
  slider.type = "range";
  slider.id = id + "-phase";
  slider.min = "0";
  slider.step = "1";
  slider.addEventListener("input", () => { phase = Number(slider.value); turn(); });
  const enlarge = labelled("gaps, growth and deviations ×", html("select"));
  Array.from(new Set(FACTORS.concat(drawings.map((one) => one.factor))))
    .sort((a, b) => a - b)
    .forEach((one) => { html("option", enlarge, String(one)).value = String(one); });
  enlarge.value = String(factor);
  enlarge.addEventListener("change", () => { factor = Number(enlarge.value); build(); });
  for (const state of now.states) {
    const [words, colour] = STATES[state.name] || STATES.hot;
    const label = html("label", controls), box = html("input", label);
    box.type = "checkbox";
    box.checked = shown[state.name] = true;
    const name = html("span", label, words);
    name.style.setProperty("border-bottom", "3px solid " + colour);
    box.addEventListener("change", () => { shown[state.name] = box.checked; turn(); });
  }
  const bar = html("span", controls, "share of the load 0 % ");
  for (const colour of SHARES) {
    const patch = html("span", bar);
    for (const [key, value] of [["display", "inline-block"], ["width", ".8em"],
        ["height", ".8em"], ["background", colour]]) patch.style.setProperty(key, value);
  }
  bar.append(" 100 %");

  function canvas(name, box) {
    const made = svg("svg", pictures, { role: "img", "aria-label": name, viewBox: box.join(" ") },
      { flex: "1 1 18rem", "min-width": "0", "max-width": "100%", height: "auto",
        overflow: "hidden", color: "inherit" });
    return made;
  }
  let mesh, whole, teeth, dots, figures;

  function build() {
    pictures.textContent = "";
    slider.max = String(now.phase.length - 1);
    phase = Math.min(phase, now.phase.length - 1);
    slider.value = String(phase);
    const m = now.module, c = now.pitch_point, a = now.path.A, e = now.path.E;
    const high = Math.max(Math.abs(a[1]), Math.abs(e[1])) + 0.8 * m, wide = 0.9 * high;
    mesh = canvas("The teeth in mesh, small things enlarged",
      [c - wide, -high, 2 * wide, 2 * high].map(round));
    mesh.style.setProperty("order", "1");  // to the right of the whole gears
    const up = svg("g", mesh, { transform: "scale(1 -1)" });
    now.gears.forEach((one, gear) => {
      const at = gear === 0 ? 0 : now.centre_distance, rolling = Math.abs(c - at);
      svg("circle", up, { cx: at, cy: 0, r: rolling }, line("currentColor", 0.8, "8 3 2 3"));
      svg("circle", up, { cx: at, cy: 0, r: one.circles.base }, line("currentColor", 0.8, "2 2"));
    });
    teeth = [];
    for (const state of now.states) {
      const [, colour, width] = STATES[state.name] || STATES.hot;
      now.gears.forEach((one, gear) => {
        const path = pathOf(shape(state, gear, factor), 1), pool = [];
        const reach = 1.5 * high / one.circles.root, step = 2 * Math.PI / one.teeth;
        const count = Math.min(one.teeth, 2 * Math.ceil(reach / step) + 1);
        for (let k = 0; k < count; k += 1) {
          const made = svg("g", up, { class: one.name + " " + state.name });
          if (state === now.states[0]) {
            svg("path", made, { d: path + "L0 0Z" },
              { fill: "currentColor", "fill-opacity": "0.07", stroke: "none" });
          }
          svg("path", made, { d: path }, line(colour, width));
          pool.push(made);
        }
        teeth.push({ state, gear, pool, step });
      });
    }
    svg("path", up, { d: "M" + a.join(" ") + "L" + e.join(" ") }, line(LINE, 1.6));
    for (const [name, place, side] of [["A", a, -1], ["E", e, 1]]) {
      svg("circle", up, { cx: place[0], cy: place[1], r: 0.06 * m }, { fill: LINE });
      const words = svg("text", mesh, { x: place[0] + side * 0.18 * m, y: -place[1] - side * 0.12 * m,
        "font-size": 0.28 * m, "text-anchor": side < 0 ? "end" : "start" }, { fill: LINE });
      words.textContent = name;
    }
    dots = now.contact[0].map(() => ({
      dot: svg("circle", up, { r: 0.14 * m },
        { stroke: "currentColor", "stroke-width": "1.2px", "vector-effect": "non-scaling-stroke" }),
      words: svg("text", mesh, { "font-size": 0.28 * m },
        { fill: "currentColor", stroke: "var(--paper, none)", "stroke-width": 0.08 * m + "px",
          "paint-order": "stroke" }),
    }));
    const far = now.gears.map((one) => one.circles.tip + 0.5 * m);
    const left = -far[0], right = now.centre_distance + far[1], tall = Math.max(far[0], far[1]);
    whole = canvas("Both gears to scale, as drawn",
      [left, -tall, right - left, 2 * tall].map(round));
    const plane = svg("g", whole, { transform: "scale(1 -1)" });
    figures = now.gears.map((one, gear) => {
      const g = svg("g", plane);
      if (one.teeth <= MOST) {
        svg("path", g, { d: wholePath(now.states[0], gear) }, line("currentColor", 0.8));
      } else {
        svg("circle", g, { r: one.circles.tip }, line("currentColor", 0.8));
        svg("circle", g, { r: one.circles.root }, line("currentColor", 0.8));
      }
      svg("circle", g, { r: one.circles.bore }, line("currentColor", 0.8));
      svg("path", g, { d: "M0 0L" + one.circles.bore + " 0" }, line("currentColor", 0.8));
      return g;
    });
    const ends = now.line_of_action;
    svg("path", plane, { d: "M" + ends[0].join(" ") + "L" + ends[1].join(" ") }, line(LINE, 1.2));
    svg("rect", plane, { x: c - wide, y: -high, width: 2 * wide, height: 2 * high },
      line("var(--gear-hot, #D55E00)", 1, "4 3"));
    turn();
  }

  function turn() {
    for (const { state, gear, pool, step } of teeth) {
      const angle = axis(state, gear, phase, factor), facing = gear === 0 ? 0 : Math.PI;
      const first = Math.round((facing - angle) / step) - (pool.length >> 1);
      pool.forEach((path, k) => {
        path.setAttribute("transform", turned(state, gear, angle + (first + k) * step, factor));
        path.style.setProperty("display", shown[state.name] ? "inline" : "none");
      });
    }
    figures.forEach((g, gear) => {
      const state = now.states[0];
      g.setAttribute("transform", turned(state, gear, axis(state, gear, phase, 1), 1));
    });
    const last = now.states[now.states.length - 1];
    const loaded = shown[last.name] ? last : now.states[0], carried = [];
    dots.forEach(({ dot, words }, k) => {
      const place = now.contact[phase][k], share = loaded.share[phase][k];
      const there = place !== null && share > 0;
      dot.style.setProperty("display", there ? "inline" : "none");
      words.textContent = "";
      if (!there) return;
      const percent = Math.round(100 * share) + " %";
      dot.setAttribute("cx", place[0]);
      dot.setAttribute("cy", place[1]);
      dot.style.setProperty("fill", colourOf(share));
      words.setAttribute("x", place[0] + 0.28 * now.module);
      words.setAttribute("y", -place[1] + 0.1 * now.module);
      words.textContent = percent;
      carried.push(percent);
    });
    const gaps = now.states.filter((state) => shown[state.name]).map((state) => {
      const left = state.back_gap[phase].filter((gap) => gap !== null);
      const words = (STATES[state.name] || STATES.hot)[0].split(",")[0];
      return Math.min(...left).toFixed(1) + " µm " + words;
    });
    const at = now.phase[phase].toFixed(2);
    slider.setAttribute("aria-valuetext", at + " of a mesh period");
    told.textContent = now.words + ". Phase " + at + ": " +
      (carried.length === 1 ? "one pair carries all of the load" :
        "the pairs carry " + carried.join(" and ")) +
      (gaps.length ? "; least gap between the back flanks " + gaps.join(", ") : "") +
      ". Gaps, growth and deviations × " + factor + " on the teeth in mesh.";
  }

  build();
}
