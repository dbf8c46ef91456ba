// Buttons under each picture and table that save it as SVG or CSV. The figures of a picture are read by figures.js; those of
// a table are its cells. Nothing is fetched or sent: a file is made of what is on the page. Without scripts, the page is complete but for the buttons.
{
  const STYLES = ["fill", "opacity", "stroke", "stroke-width", "stroke-dasharray", "stroke-linejoin", "stroke-linecap", "font-family", "font-size", "overflow", "vector-effect"];
  const save = (name, type, text) => {
    const link = document.createElement("a");
    link.download = name;
    link.href = URL.createObjectURL(new Blob([text], { type }));
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  const fileName = (title, end) => `${title.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "") || "figure"}.${end}`;

  // The labels of a line chart stand in its padding, which a file does not have.
  const framed = (svg, copy) => {
    const { width, height } = svg.getBoundingClientRect(), style = getComputedStyle(svg);
    const [top, right, bottom, left] = ["Top", "Right", "Bottom", "Left"].map((side) => parseFloat(style[`padding${side}`]));
    const place = { x: left, y: top, width: width - left - right, height: height - top - bottom, overflow: "visible" };
    for (const [name, value] of Object.entries(place)) copy.setAttribute(name, value);
    const file = document.createElementNS(svg.namespaceURI, "svg");
    for (const [name, value] of Object.entries({ width, height, viewBox: `0 0 ${width} ${height}` })) file.setAttribute(name, value);
    file.append(copy);
    return file;
  };
  // The stylesheet of the page is not in the file of a picture: each element takes what applies to it along.
  const svgOf = (svg) => {
    const copy = svg.cloneNode(true);
    const copies = [copy, ...copy.querySelectorAll("*")];
    [svg, ...svg.querySelectorAll("*")].forEach((element, i) => {
      const style = getComputedStyle(element);
      copies[i].setAttribute("style", STYLES.map((name) => `${name}:${style.getPropertyValue(name)}`).join(";"));
    });
    for (const name of ["data-figures", "tabindex", "aria-keyshortcuts"]) copy.removeAttribute(name);
    const file = svg.matches(".chart") ? framed(svg, copy) : copy;
    file.style.background = getComputedStyle(document.body).backgroundColor;
    return new XMLSerializer().serializeToString(file);
  };
  const cell = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  const csvOf = (svg) => {
    const { abscissa, value, curves } = figuresOf(svg);
    const words = wordsOf(svg);
    const lines = curves.flatMap(({ name, points }) => points.map(([x, y]) => `${cell(words[name] ?? name)},${x},${y}`));
    return [`curve,${cell(abscissa)},${cell(value)}`, ...lines].join("\n") + "\n";
  };
  const tableOf = (table) => {
    const grid = [];
    [...table.rows].forEach((row, at) => {
      grid[at] ??= [];
      for (const field of row.cells) {
        let column = 0;
        while (grid[at][column] !== undefined) column += 1;
        const text = field.textContent.trim().replaceAll("\u00a0", " ").replaceAll("−", "-");
        for (let down = 0; field.rowSpan > down; down += 1) {
          for (let right = 0; field.colSpan > right; right += 1) (grid[at + down] ??= [])[column + right] = text;
        }
      }
    });
    return grid.map((fields) => Array.from(fields, (text) => cell(text ?? "")).join(",")).join("\n") + "\n";
  };
  const button = (end, title, action) => {
    const made = Object.assign(document.createElement("button"), { type: "button", textContent: end.toUpperCase() });
    made.setAttribute("aria-label", `Save ${end.toUpperCase()}: ${title}`);
    made.addEventListener("click", action);
    return made;
  };
  const line = (...buttons) => {
    const made = Object.assign(document.createElement("p"), { className: "save" });
    made.append(...buttons);
    return made;
  };

  for (const svg of document.querySelectorAll("figure svg[data-figures]")) {
    const title = svg.querySelector("title").textContent;
    svg.closest("figure").append(line(
      button("svg", title, () => save(fileName(title, "svg"), "image/svg+xml", svgOf(svg))),
      button("csv", title, () => save(fileName(title, "csv"), "text/csv", csvOf(svg))),
    ));
  }
  for (const table of document.querySelectorAll(".scroll > table")) {
    if (!table.tHead) continue;
    const title = table.caption?.textContent ?? "table";
    table.parentElement.after(line(button("csv", title, () => save(fileName(title, "csv"), "text/csv", tableOf(table)))));
  }
}
