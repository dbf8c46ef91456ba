// The page: files in, requests to the worker, answers shown. What the tracer does is in the worker alone.
"use strict";
const $ = (id) => document.getElementById(id);
const CHANNELS = ["command_mm", "motor_mm", "table_mm", "tool_mm", "force_n", "command_deg", "motor_deg", "table_deg", "tool_deg", "force_nm"];
const AXES = ["x", "y", "z", "a", "b", "c"];

/* Files */

let files = []; // { name, bytes, heldOut, map, unit, rate_hz, seen }

const element = (name, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
};

async function add(dropped, isHeldOut = () => false) {
  for (const file of dropped) {
    const bytes = new Uint8Array(await file.arrayBuffer());
    if (file.name.endsWith(".toml")) {
      $("machine").value = new TextDecoder().decode(bytes);
      $("machine-file").open = true;
    } else {
      files = files.filter((other) => other.name !== file.name);
      files.push({ name: file.name, bytes, heldOut: isHeldOut(file.name), map: {}, unit: {}, rate_hz: null, seen: null });
    }
  }
  await look();
}

async function look() {
  const seen = await ask({ task: "look" }, files);
  if (!seen) return;
  files.forEach((file, index) => { file.seen = seen[index]; });
  showFiles();
  showMachine();
  if (files.length && files.every(isCircle)) await circle(true);
}

const isRead = (file) => file.seen && file.seen.kind !== "unknown";
const isCircle = (file) => {
  if (file.seen?.kind === "radii") return true;
  const axes = file.seen?.axes ?? [];
  const has = (axis, channel) => axis.columns.some((column) => column.includes(`_${channel}_`));
  return axes.length === 2 && axes.every((axis) => has(axis, "command") && (has(axis, "tool") || has(axis, "table") || has(axis, "motor")));
};

function showFiles() {
  $("list").replaceChildren(...files.map(fileEntry));
  const logs = files.filter((file) => file.seen?.kind === "log"), radii = files.some((file) => file.seen?.kind === "radii");
  const all = files.length > 0 && files.every(isRead);
  $("machine-section").hidden = !all || !logs.length;
  $("run-section").hidden = !all;
  $("trace").hidden = !logs.length || radii;
  $("circle").hidden = !files.every(isCircle);
  $("radius-field").hidden = !radii;
}

function fileEntry(file) {
  const remove = element("button", { type: "button", textContent: "Remove", onclick: () => {
    files = files.filter((other) => other !== file);
    showFiles();
  } });
  const entry = element("li", {}, element("strong", { textContent: file.name }), " ");
  const { seen } = file;
  if (seen.kind === "log") {
    const heldOut = element("input", { type: "checkbox", checked: file.heldOut, onchange: () => { file.heldOut = heldOut.checked; } });
    const axes = seen.axes.map((axis) => `${axis.name}: ${axis.columns.join(", ")}`).join("; ");
    entry.append(`${seen.seconds.toFixed(1)} s at ${seen.rate_hz.toFixed(0)} Hz. ${axes}. `,
      element("label", {}, heldOut, " hold out of the fit, to check it"), " ");
  } else if (seen.kind === "radii") {
    entry.append(`table of radii: ${seen.columns.join(", ")} `);
  } else {
    entry.append(element("span", { className: "problem", textContent: seen.error }), " ");
  }
  entry.append(remove);
  if (seen.notes?.length) entry.append(element("ul", { className: "small" }, ...seen.notes.map((note) => element("li", { textContent: note }))));
  if (seen.kind === "unknown" && seen.columns.length) entry.append(columnForm(file));
  return entry;
}

// Which column is which channel, by a choice beside each.
function columnForm(file) {
  const rate = element("input", { inputMode: "decimal", size: 8, value: file.rate_hz ?? "" });
  const rows = file.seen.columns.map((column) => {
    const choice = element("select", { ariaLabel: `meaning of ${column.name}` }, element("option", { value: "", textContent: "not used" }),
      element("option", { value: "time_s", textContent: "time" }));
    for (const axis of AXES) {
      choice.append(element("optgroup", { label: axis }, ...CHANNELS.map((channel) =>
        element("option", { value: `${axis}_${channel}`, textContent: `${axis} ${channel.replace("_", ", ")}` }))));
    }
    const unit = element("input", { value: column.unit ?? "", ariaLabel: `unit of ${column.name}`, placeholder: "as chosen" });
    return { column, choice, unit };
  });
  const use = element("button", { type: "button", textContent: "Read the file this way", onclick: () => {
    file.map = {}; file.unit = {};
    for (const { column, choice, unit } of rows.filter((row) => row.choice.value)) {
      file.map[choice.value] = column.name;
      if (unit.value.trim() && unit.value !== (column.unit ?? "")) file.unit[choice.value] = unit.value.trim();
    }
    file.rate_hz = rate.value.trim() ? Number(rate.value.replace(",", ".")) : null;
    look();
  } });
  const head = element("tr", {}, ...["column", "first values", "is", "unit"].map((text) => element("th", { scope: "col", textContent: text })));
  const body = rows.map(({ column, choice, unit }) => element("tr", {}, element("th", { scope: "row", textContent: column.name }),
    element("td", { textContent: column.first.map((value) => String(value ?? "–")).join(", ") }), element("td", {}, choice), element("td", {}, unit)));
  return element("div", { className: "scroll columns" }, element("table", {}, element("thead", {}, head), element("tbody", {}, ...body)),
    element("label", {}, "samples per second, if no column has the time ", rate), " ", use);
}

/* Machine */

function showMachine() {
  const axes = new Map(files.flatMap((file) => file.seen?.axes ?? []).map((axis) => [axis.name, axis]));
  const kept = Object.fromEntries([...$("known").querySelectorAll("[data-key]")].map((field) => [field.dataset.key, field.value]));
  $("known").replaceChildren(...[...axes.values()].flatMap((axis) => {
    const lead = axis.unit === "deg" ? ["lead_deg", "degrees per turn of the motor"] : ["lead_mm", "mm per turn of the motor"];
    const field = (key, input) => { input.dataset.key = `${axis.name}.${key}`; input.value = kept[input.dataset.key] ?? ""; return input; };
    const drive = element("select", {}, element("option", { value: "", textContent: "as the logs show" }),
      ...["torque", "velocity", "stepper"].map((value) => element("option", { value, textContent: value })));
    return [
      element("label", {}, `${axis.name}: command of the drive`, field("drive", drive)),
      element("label", {}, `${axis.name}: ${lead[1]}`, field(lead[0], element("input", { inputMode: "decimal" }))),
    ];
  }));
}

const known = () => [...$("known").querySelectorAll("[data-key]")]
  .filter((field) => field.value.trim()).map((field) => `${field.dataset.key}=${field.value.trim().replace(",", ".")}`);

async function init() {
  const found = await ask({ task: "init", machine: $("machine").value, known: known() }, files);
  if (!found) return false;
  $("machine").value = found.machine;
  $("init-summary").textContent = found.summary;
  $("machine-file").open = true;
  return true;
}

/* Results */

const download = (name, text, type) => element("a", { href: URL.createObjectURL(new Blob([text], { type })), download: name, textContent: name });

function showResult(sentences, page, downloads) {
  $("sentences").replaceChildren(...sentences.filter((text) => text.trim()).map((text) => element("li", { textContent: text })));
  $("result-files").replaceChildren(...downloads, download("report.html", page, "text/html"));
  $("report").srcdoc = page;
  $("result-section").hidden = false;
  $("result-section").scrollIntoView();
}

let model = null;

async function trace() {
  if (!$("machine").value.trim() && !(await init())) return;
  const found = await ask({ task: "trace", machine: $("machine").value }, files);
  if (!found) return;
  model = found.model;
  showResult(found.summary, found.page, [
    download("trace.json", JSON.stringify(found.json, null, 2), "application/json"), download("machine.toml", model, "text/plain")]);
  $("remedy-section").hidden = false;
}

async function circle(isQuiet) {
  const radius = Number($("radius").value.replace(",", "."));
  const found = await ask({ task: "circle", radius_mm: radius > 0 ? radius : null }, files, isQuiet);
  if (!found) return;
  showResult(found.summary.split("\n\n")[0].split("\n"), found.page, [download("circle.json", JSON.stringify(found.json, null, 2), "application/json")]);
}

async function compensate() {
  const found = await ask({ task: "compensate", model, control: $("control").value }, []);
  if (!found) return;
  $("remedy").textContent = [found.summary, ...found.remarks].join("\n\n");
  $("remedy-files").replaceChildren(...found.files.map((file) => download(file.name, file.text, "text/plain")),
    download("compensation.toml", found.compensation, "text/plain"));
}

/* The worker */

let worker = null, waiting = null;

const bytesOf = (text) => Uint8Array.from(atob(text.trim()), (character) => character.charCodeAt(0));

const unpacked = (text) =>
  new Response(new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();

async function started() {
  if (worker) return worker;
  const made = new Worker(URL.createObjectURL(new Blob([$("worker").textContent], { type: "text/javascript" })));
  const bytes = await unpacked($("tracer").textContent);
  await new Promise((ready, failed) => {
    made.onmessage = ready;
    made.onerror = (event) => failed(new Error(event.message));
    made.postMessage({ tracer: bytes }, [bytes]);
  });
  made.onmessage = ({ data }) => {
    if (data.progress !== undefined) $("status").textContent = data.progress;
    else waiting?.(data);
  };
  worker = made;
  return made;
}

function stop() {
  worker?.terminate();
  worker = null;
  waiting?.({ stopped: true });
}

function request(task, files) {
  const listed = files.map((file) => ({
    name: file.name, length: file.bytes.length, held_out: file.heldOut, rate_hz: file.rate_hz,
    map: Object.entries(file.map).map((pair) => pair.join("=")), unit: Object.entries(file.unit).map((pair) => pair.join("=")),
  }));
  const text = new TextEncoder().encode(JSON.stringify({ ...task, files: listed }));
  const whole = new Uint8Array(4 + text.length + files.reduce((sum, file) => sum + file.bytes.length, 0));
  new DataView(whole.buffer).setUint32(0, text.length, true);
  whole.set(text, 4);
  let at = 4 + text.length;
  for (const file of files) { whole.set(file.bytes, at); at += file.bytes.length; }
  return whole;
}

// The answer, or nothing after its problem was shown.
async function ask(task, files, isQuiet = false) {
  if (waiting) return null;
  $("problem").hidden = true;
  $("status").textContent = "";
  $("work").hidden = false;
  const buttons = [...document.querySelectorAll("main button:not(#cancel)")];
  buttons.forEach((button) => { button.disabled = true; });
  const whole = request(task, files);
  let done;
  const answered = new Promise((resolve) => { waiting = resolve; });
  try {
    const running = await started();
    running.postMessage({ request: whole }, [whole.buffer]);
    done = await answered;
  } catch (error) {
    done = { failed: error.message };
  }
  waiting = null;
  if (done.failed) stop();
  $("work").hidden = true;
  buttons.forEach((button) => { button.disabled = false; });
  const problem = done.failed ?? done.answer?.error;
  if (problem && !isQuiet) {
    $("problem").textContent = problem;
    $("problem").hidden = false;
  }
  return done.answer?.ok ?? null;
}

/* Events */

async function example() {
  const { fit, held_out, machine } = JSON.parse($("example-files").textContent);
  files = [];
  $("machine").value = machine;
  const packed = Object.entries({ ...fit, ...held_out }).map(([name, text]) => new File([bytesOf(text)], name));
  await add(packed, (name) => name in held_out);
}

$("drop").addEventListener("dragover", (event) => { event.preventDefault(); $("drop").classList.add("over"); });
$("drop").addEventListener("dragleave", () => $("drop").classList.remove("over"));
$("drop").addEventListener("drop", (event) => {
  event.preventDefault();
  $("drop").classList.remove("over");
  add([...event.dataTransfer.files]);
});
$("choose").addEventListener("change", () => add([...$("choose").files]));
$("example").addEventListener("click", example);
$("init").addEventListener("click", init);
$("trace").addEventListener("click", trace);
$("circle").addEventListener("click", () => circle(false));
$("compensate").addEventListener("click", compensate);
$("cancel").addEventListener("click", stop);
