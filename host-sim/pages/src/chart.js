// A cursor that shows the values of the curves of a line chart, and its horizontal axis magnified: by dragging over a range, and by keyboard.
// The plane is drawn in units of the figures (see plot.rs), so that its viewBox is what is shown. Without scripts, the charts stay as they are.
for (const svg of document.querySelectorAll("svg.chart")) {
  const SNAP_PX = 6, DRAG_PX = 8, LABEL_PX = 60, MOST_TIMES = 1000, KEY_STEPS = 40, HALF_KEY = 0.25;
  const plane = svg.querySelector(".plane"), ticks = svg.querySelector(".ticks"), below = ticks.parentNode;
  const { abscissa, value, decimals, curves } = figuresOf(svg);
  const words = wordsOf(svg);
  const [left, top, width, height] = plane.getAttribute("viewBox").split(" ").map(Number);
  const unit = 10 ** decimals[0];
  const whole = [left / unit, (left + width) / unit];
  const places = [...new Set(curves.flatMap(({ points }) => points.map(([x]) => x)))].sort((a, b) => a - b);
  let view = whole, at = null, from = null;

  const element = (name, attributes) => {
    const made = document.createElementNS(svg.namespaceURI, name);
    for (const [key, set] of Object.entries(attributes)) made.setAttribute(key, set);
    return made;
  };
  const percent = (x) => `${(100 * (x - view[0]) / (view[1] - view[0])).toFixed(3)}%`;
  const minus = (text) => text.replace("-", "−");
  const cursor = element("line", { class: "cursor", y2: "100%", visibility: "hidden" });
  const range = element("rect", { class: "range", height: "100%", visibility: "hidden" });
  svg.append(range, cursor);

  // Where a curve is at an abscissa: a surface and a curve that turns back have several values there.
  const valuesAt = (points, x) => {
    const values = points.filter((point) => point[0] === x).map((point) => point[1]);
    for (let i = 1; points.length > i; i += 1) {
      const [[x0, y0], [x1, y1]] = [points[i - 1], points[i]];
      if (0 > (x0 - x) * (x1 - x)) values.push(y0 + (x - x0) / (x1 - x0) * (y1 - y0));
    }
    return values;
  };
  const said = () => {
    const [name, ...units] = abscissa.split(", "), unitOf = value.split(", ").at(-1);
    const shown = Math.max(0, Math.min(decimals[0], Math.ceil(4 - Math.log10(view[1] - view[0]))));
    const values = {};
    for (const curve of curves) (values[curve.name] ??= []).push(...valuesAt(curve.points, at));
    const number = (y) => minus(String(Number(y.toFixed(Math.max(decimals[1], 0)))));
    const told = Object.entries(values).filter(([, all]) => all.length > 0).map(([curve, all]) => {
      const ends = [...new Set([Math.min(...all), Math.max(...all)].map(number))];
      return `${words[curve] ?? ""} ${ends.join(" to ")} ${unitOf}`.trim();
    });
    return [`${name} ${minus(at.toFixed(shown))} ${units.join(", ")}`.trim(), ...told].join("; ");
  };

  const output = document.createElement("output");
  const all = Object.assign(document.createElement("button"), { type: "button", textContent: "whole" });
  all.setAttribute("aria-label", `Show all: ${svg.querySelector("title").textContent}`);
  const line = Object.assign(document.createElement("p"), { className: "reading" });
  line.append(output, all);
  svg.after(line);
  // The first chart says for all what can be done.
  const hint = svg === document.querySelector("svg.chart") ? "Drag over a range to magnify it; keys: + − ← → 0." : "";
  svg.setAttribute("tabindex", "0");
  svg.setAttribute("aria-keyshortcuts", "+ - ArrowLeft ArrowRight 0 Escape");

  // Steps of 1, 2 or 5 times a power of ten, as many as there is room for.
  const newTicks = () => {
    const [low, high] = view;
    const most = Math.max(2, Math.floor(plane.parentNode.clientWidth / LABEL_PX) - 1);
    const power = 10 ** Math.floor(Math.log10((high - low) / most));
    const fitting = [1, 2, 5, 10].map((times) => times * power).find((step) => step * most >= (high - low) * (1 - 1e-9));
    // What is counted, such as runs, has nothing between two of them (see plot.rs).
    const isCounted = !abscissa.includes(", ") && places.every(Number.isInteger);
    const step = isCounted ? Math.max(fitting, 1) : fitting;
    const digits = Math.max(0, -Math.floor(Math.log10(step * 1.001)));
    const made = element("g", { class: "ticks" });
    for (let i = Math.ceil(low / step); high / step >= i; i += 1) {
      const x = percent(i * step);
      const label = element("text", { class: "label", x, y: 17, "text-anchor": "middle" });
      label.textContent = minus((i * step).toFixed(digits).replace(/^-(0\.?0*)$/, "$1"));
      made.append(element("line", { class: "axis", x1: x, x2: x, y2: 4 }), label);
    }
    return made;
  };
  const draw = () => {
    const isWhole = view === whole;
    plane.setAttribute("viewBox", `${view[0] * unit} ${top} ${(view[1] - view[0]) * unit} ${height}`);
    plane.classList.toggle("part", !isWhole);
    below.querySelector(".ticks").replaceWith(isWhole ? ticks : newTicks());
    all.hidden = isWhole;
    const isSeen = at !== null && at >= view[0] && view[1] >= at;
    cursor.setAttribute("visibility", isSeen ? "visible" : "hidden");
    if (isSeen) for (const end of ["x1", "x2"]) cursor.setAttribute(end, percent(at));
    output.textContent = isSeen ? said() : hint;
    range.setAttribute("visibility", from !== null && at !== null ? "visible" : "hidden");
    if (from !== null && at !== null) {
      range.setAttribute("x", percent(Math.min(from.x, at)));
      range.setAttribute("width", `${100 * Math.abs(at - from.x) / (view[1] - view[0])}%`);
    }
  };
  // Both ends are within the whole, and not closer than the figures can show.
  const show = (low, high) => {
    const length = Math.max(high - low, (whole[1] - whole[0]) / MOST_TIMES);
    if (length >= (1 - 1e-9) * (whole[1] - whole[0])) view = whole;
    else {
      const start = Math.min(Math.max(0.5 * (low + high - length), whole[0]), whole[1] - length);
      view = [start, start + length];
    }
    draw();
  };

  const pointed = (event) => {
    const box = svg.getBoundingClientRect(), style = getComputedStyle(svg);
    const [before, after] = [style.paddingLeft, style.paddingRight].map(parseFloat);
    const perPx = (view[1] - view[0]) / (box.width - before - after);
    const x = Math.min(Math.max(view[0] + (event.clientX - box.left - before) * perPx, view[0]), view[1]);
    const near = places.reduce((best, place) => (Math.abs(best - x) > Math.abs(place - x) ? place : best), Infinity);
    return Math.abs(near - x) > SNAP_PX * perPx ? x : near;
  };
  svg.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    at = pointed(event);
    from = { x: at, px: event.clientX };
    // A pointer that a program makes cannot be captured.
    try { svg.setPointerCapture(event.pointerId); } catch { /* the drag then ends at the edge */ }
    draw();
  });
  svg.addEventListener("pointermove", (event) => { at = pointed(event); draw(); });
  svg.addEventListener("pointerup", (event) => {
    const start = from;
    from = null;
    if (start && Math.abs(event.clientX - start.px) > DRAG_PX) show(Math.min(start.x, at), Math.max(start.x, at));
    else draw();
  });
  svg.addEventListener("pointercancel", () => { from = null; draw(); });
  svg.addEventListener("pointerleave", () => { if (from === null) { at = null; draw(); } });
  const reset = () => show(...whole);
  svg.addEventListener("dblclick", reset);
  all.addEventListener("click", () => { reset(); svg.focus(); });

  // Arrows move the cursor, and the part with it; + and − magnify about the cursor.
  const keys = {
    "+": () => show(at - HALF_KEY * (view[1] - view[0]), at + HALF_KEY * (view[1] - view[0])),
    "-": () => show(at - (view[1] - view[0]), at + (view[1] - view[0])),
    ArrowLeft: () => step(-1),
    ArrowRight: () => step(1),
    0: reset,
    Escape: reset,
  };
  const step = (way) => {
    const length = view[1] - view[0];
    at = Math.min(Math.max(at + way * length / KEY_STEPS, whole[0]), whole[1]);
    const off = at > view[1] ? at - view[1] : Math.min(at - view[0], 0);
    show(view[0] + off, view[1] + off);
  };
  svg.addEventListener("keydown", (event) => {
    const act = keys[event.key === "=" ? "+" : event.key];
    if (!act || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    if (at === null || view[0] > at || at > view[1]) at = 0.5 * (view[0] + view[1]);
    act();
  });
  draw();
}
