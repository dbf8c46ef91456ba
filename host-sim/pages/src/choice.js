// A circle with other curves in place of its own, one choice at a time; its own curves then stay as pale lines behind them. polar.js draws.
document.querySelectorAll(".choices").forEach((group, index) => {
  const svg = group.parentElement.querySelector("svg[data-division]"), output = group.querySelector("output");
  for (const input of group.querySelectorAll("input")) {
    // One of a group is chosen: they have the name of their group.
    input.name = `choice-${index}`;
    input.addEventListener("change", () => {
      const curves = input.dataset.figures ? figuresOf(input).curves : null;
      svg.dispatchEvent(new CustomEvent("curves", { detail: curves }));
      output.textContent = input.dataset.said;
    });
  }
  group.querySelector("input").checked = true;
  group.hidden = false;
});
