// A slider for the magnification of each circle, and the deviation under the pointer. The radius of a point is that of the circle and its
// deviation, in divisions of data-division µm. Without scripts, the pictures stay as they are.
for (const svg of document.querySelectorAll("svg[data-division]")) {
  const BASE = 80, DIVISION = 15, MIDDLE = 155, HALF_WIDTH_RAD = 0.03;
  const NAMES = { cw: "clockwise", ccw: "counter-clockwise", pale: "with all," };
  const division = Number(svg.dataset.division);
  const { curves } = figuresOf(svg);
  const polar = (points) => points.map(([degrees, um]) => ({ angle: degrees * Math.PI / 180, um }));
  const own = [...svg.querySelectorAll("polyline")].map((line, i) => ({ line, points: polar(curves[i].points) }));
  let lines = own;
  const edges = [...svg.querySelectorAll(".edge")].map((label) => ({ label, um: Number(label.dataset.um) }));
  const rounded = (um) => Number(um.toPrecision(3)).toString().replace("-", "−");

  const slider = Object.assign(document.createElement("input"), { type: "range", min: -2, max: 3, step: 0.1, value: 0 });
  slider.setAttribute("aria-label", `magnification: ${svg.querySelector("title").textContent}`);
  const said = document.createElement("output");
  const draw = () => {
    const times = 2 ** slider.valueAsNumber;
    for (const { line, points } of lines) {
      line.setAttribute("points", points.map(({ angle, um }) => {
        const radius = Math.max(BASE + DIVISION * times * um / division, 0);
        return `${(MIDDLE + radius * Math.cos(angle)).toFixed(1)},${(MIDDLE - radius * Math.sin(angle)).toFixed(1)}`;
      }).join(" "));
    }
    for (const { label, um } of edges) {
      label.textContent = `${um > 0 ? "+" : ""}${rounded(um / times)}${um > 0 ? " µm" : ""}`;
    }
    said.textContent = `division ${rounded(division / times)} µm`;
  };
  slider.addEventListener("input", draw);
  const controls = Object.assign(document.createElement("p"), { className: "magnification" });
  controls.append("magnification ", slider, " ", said);
  svg.after(controls);

  svg.addEventListener("pointermove", (event) => {
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const angle = Math.atan2(MIDDLE - at.y, at.x - MIDDLE);
    const away = (point) => Math.abs(Math.atan2(Math.sin(point.angle - angle), Math.cos(point.angle - angle)));
    const near = lines.flatMap(({ line, points }) => {
      const best = points.reduce((best, point) => (away(best) > away(point) ? point : best), points[0]);
      const name = line.getAttribute("class").split(" ").map((word) => NAMES[word] ?? word).reverse().join(" ");
      return best && HALF_WIDTH_RAD > away(best) ? [`${name} ${rounded(best.um)} µm`] : [];
    });
    const degrees = ((angle * 180 / Math.PI) + 360) % 360;
    said.textContent = [`${degrees.toFixed(1)}°`, ...near].join(", ");
  });
  svg.addEventListener("pointerleave", draw);

  // Other curves in front of its own (see choice.js), or none.
  svg.addEventListener("curves", ({ detail }) => {
    for (const { line } of lines.slice(own.length)) line.remove();
    for (const { line } of own) line.classList.toggle("pale", detail !== null);
    lines = own.concat((detail ?? []).map(({ name, points }) => {
      const line = document.createElementNS(svg.namespaceURI, "polyline");
      line.setAttribute("class", name);
      svg.append(line);
      return { line, points: polar(points) };
    }));
    draw();
  });
}
