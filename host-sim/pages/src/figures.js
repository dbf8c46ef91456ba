// The figures of a picture as numbers (see data.rs), and the words of its legend. Other scripts of the page use them.
const figuresOf = (svg) => {
  const [abscissa, value, digits, ...packed] = svg.dataset.figures.split("\n");
  const decimals = digits.split(" ").map(Number);
  const number = (whole, decimals) => Number((whole / 10 ** decimals).toFixed(Math.max(decimals, 0)));
  // The curves of a line chart are its paths.
  const drawn = [...svg.querySelectorAll(".plane > g > g")].map((layer) => [layer.getAttribute("class"), layer.firstChild.getAttribute("d")]);
  const curves = drawn.concat(packed.map((line) => line.split(/ (.*)/))).map(([name, steps = ""]) => {
    let [x, y] = [0, 0];
    const points = (steps.match(/-?\d+,-?\d+/g) ?? []).map((step) => {
      const [right, up] = step.split(",").map(Number);
      [x, y] = [x + right, y + up];
      return [number(x, decimals[0]), number(y, decimals[1])];
    });
    return { name, points };
  });
  return { abscissa, value, decimals, curves };
};

const wordsOf = (svg) => {
  const words = {};
  for (const key of (svg.closest("section") ?? document).querySelectorAll(".key")) {
    words[key.querySelector("svg *").getAttribute("class")] = key.textContent.trim();
  }
  return words;
};
