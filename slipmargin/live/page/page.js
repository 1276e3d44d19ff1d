// The page of `slipmargin explore`: sliders in, pictures out.  It asks its own server and nothing else.
"use strict";
const byId = (id) => document.getElementById(id);
const SVG = "http://www.w3.org/2000/svg";
let about = null;
let csv = null; // { name, file } of measured pulls
const tab = () => document.querySelector("[role=tab][aria-selected=true]").getAttribute("aria-controls");

function settings() {
  const found = new URLSearchParams();
  for (const slider of about.sliders) {
    const input = byId("s-" + slider.key);
    // The file's own value is sent with all its digits: a slider only has those of its step.
    found.set(slider.key, input.dataset.moved ? input.value : String(slider.value));
  }
  return found;
}

async function ask(name, query, file) {
  const options = file ? { method: "POST", body: file } : {};
  const answer = await fetch(`/api/${name}?${query}`, options);
  const data = await answer.json();
  if (!answer.ok) throw new Error(data.error);
  return data;
}

// One question of a kind at a time; the newest waits, those between are skipped.
function newest(work) {
  let busy = false, again = false;
  return async function run() {
    if (busy) { again = true; return; }
    busy = true;
    do { again = false; await work(); } while (again);
    busy = false;
  };
}

function number(value, digits = 3) {
  if (value === null || value === undefined) return "none";
  return String(Number(value.toPrecision(digits)));
}

function node(svg, kind, attributes, text) {
  const made = document.createElementNS(SVG, kind);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (text !== undefined) made.textContent = text;
  svg.append(made);
  return made;
}

function nice(most) { // a round step that makes two to four rings
  const raw = most / 4, power = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].map((k) => k * power).find((k) => k >= raw) || raw;
}

const place = (angle, radius) => [-radius * Math.sin(angle), -radius * Math.cos(angle)];
const points = (list) => list.map((p) => p.map((v) => v.toFixed(2)).join(",")).join(" ");

function rings(svg, most, unit) {
  svg.replaceChildren();
  const step = nice(most), scale = 160 / most;
  for (let r = step; r <= most * 1.0001; r += step) {
    node(svg, "circle", { class: "grid", r: r * scale });
    node(svg, "text", { x: 5, y: -r * scale - 3 }, number(r) + (r + step > most * 1.0001 ? " " + unit : ""));
  }
  node(svg, "line", { class: "grid", x1: -172, x2: 172, y1: 0, y2: 0 });
  node(svg, "line", { class: "grid", y1: -180, y2: 180, x1: 0, x2: 0 });
  const words = [["front", 0, -193, "middle"], ["back", 0, 203, "middle"], ["left", -207, 4, "start"],
    ["right", 207, 4, "end"]];
  for (const [word, x, y, anchor] of words) node(svg, "text", { x, y, "text-anchor": anchor }, word);
  return scale;
}

function polar(data) {
  const svg = byId("polar");
  const all = [...data.starting, ...data.turning, ...data.braking].filter((v) => v !== null);
  const scale = rings(svg, Math.max(...all, 0.01), "m/s²");
  const curve = (values) => points(values.map((v, k) => place(data.angle[k], (v || 0) * scale)));
  node(svg, "polygon", { class: "area safe", points: curve(data.safe) });
  for (const [name, key] of [["braking", "braking"], ["starting", "speeding"], ["turning", "turning"]])
    node(svg, "polygon", { class: "curve " + key, id: "curve-" + name, points: curve(data[name]) });
  const [x, y] = place(data.weakest.angle, Math.max(data.weakest.value || 0, 0) * scale);
  node(svg, "circle", { class: "ring", cx: x, cy: y, r: 5 });
  readable(svg);
}

const readable = (svg) => svg.append(...svg.querySelectorAll("text")); // words stand over the curves

function section(data) {
  const svg = byId("section"), right = data.section.right, forward = data.section.forward;
  const scale = rings(svg, Math.max(...right.map((v, k) => Math.hypot(v, forward[k])), 0.01), "N");
  node(svg, "polygon", { class: "area safe", points: points(right.map((v, k) => [v * scale, -forward[k] * scale])) });
  node(svg, "polygon", { class: "curve speeding", id: "curve-section",
    points: points(right.map((v, k) => [v * scale, -forward[k] * scale])) });
  readable(svg);
}

function robot(data) {
  const svg = byId("robot"), wheels = data.wheels;
  svg.replaceChildren();
  const most = Math.max(...wheels.map((w) => Math.max(Math.abs(w.right) / 1.2, Math.abs(w.forward))), 1e-6);
  const scale = 105 / most;
  const around = [...wheels].sort((a, b) => Math.atan2(a.forward, a.right) - Math.atan2(b.forward, b.right));
  node(svg, "polygon", { class: "body", points: points(around.map((w) => [w.right * scale, -w.forward * scale])) });
  node(svg, "polygon", { class: "front", points: "-9,-38 9,-38 0,-56" });
  for (const w of wheels) {
    const [x, y] = [w.right * scale, -w.forward * scale];
    const turn = (Math.atan2(-w.drive[1], w.drive[0]) * 180) / Math.PI;
    node(svg, "rect", { class: "wheel", x: -16, y: -5, width: 32, height: 10, rx: 2,
      transform: `translate(${x} ${y}) rotate(${turn})` });
    const side = w.right < -1e-9 ? "end" : "start";
    const out = w.right < -1e-9 ? -22 : 22;
    node(svg, "text", { x: x + out, y: y + 4, "text-anchor": side, class: "strong load" },
      `${w.name} ${number(w.load_N)} N`);
  }
  node(svg, "circle", { class: "ring", cx: data.com[0] * scale, cy: -data.com[1] * scale, r: 6 });
}

function facts(data) {
  const tipping = data.tipping;
  const rows = [
    ["Safe in any direction", `${number(data.recommended)} m/s²`, "with the margin"],
    ["Limit in the weakest direction", `${number(data.weakest.value)} m/s²`,
      `${data.weakest.direction}, slips first: ${data.weakest.wheels.join(", ")}`],
    ["Spinning on the spot", `${number(data.spinning)} rad/s²`, "with the margin"],
    ["A wheel lifts at", tipping ? `${number(tipping.m_s2)} m/s²` : "not modelled",
      tipping ? `${tipping.wheel} lifts, speeding up ${tipping.direction}` : "the loads do not follow the acceleration"],
  ];
  byId("facts").replaceChildren(...rows.map(([label, value, note]) => {
    const div = document.createElement("div");
    for (const [kind, text, name] of [["dt", label, ""], ["dd", value, ""], ["dd", note, "note"]]) {
      const one = document.createElement(kind);
      one.textContent = text;
      if (name) one.className = name;
      div.append(one);
    }
    return div;
  }));
}

function fail(fault) {
  const lead = byId("verdict");
  lead.textContent = fault.message;
  lead.classList.add("attention");
}

const drawLimits = newest(async () => {
  const start = performance.now();
  try {
    const data = await ask("limits", settings());
    const lead = byId("verdict");
    lead.textContent = data.verdict;
    lead.classList.toggle("attention", !data.good);
    polar(data); section(data); robot(data); facts(data);
  } catch (fault) { fail(fault); }
  document.body.dataset.drawn = String(Number(document.body.dataset.drawn || 0) + 1);
  document.body.dataset.ms = (performance.now() - start).toFixed(1);
});

const drawExport = newest(async () => {
  byId("stale").textContent = "computing …";
  const asked = settings();
  asked.set("tool", byId("tool").value);
  try {
    const data = await ask("export", asked);
    byId("text").textContent = data.text;
    byId("command").textContent = data.command;
    byId("file").textContent = data.robot;
    byId("stale").textContent = "";
  } catch (fault) {
    for (const id of ["text", "command", "file"]) byId(id).textContent = "";
    byId("stale").textContent = fault.message;
  }
});

const drawPulls = newest(async () => {
  const svg = byId("sweep"), words = byId("pull-words");
  let data;
  try {
    data = await ask("pulls", settings(), csv && csv.file);
  } catch (fault) {
    words.textContent = fault.message.replace("the file:", `${csv ? csv.name : "the file"}:`);
    csv = null;
    return;
  }
  svg.replaceChildren();
  if (!data.force) { words.textContent = data.why; return; }
  const tops = [...data.high, ...data.points.map((p) => p.high)];
  const most = 1.05 * Math.max(...tops), left = 48, low = 320;
  const at = (phi, force) => [left + (phi / (2 * Math.PI)) * 580, low - (force / most) * 305];
  const step = nice(most);
  for (let f = 0; f <= most; f += step) {
    node(svg, "line", { class: "grid", x1: left, x2: 628, y1: at(0, f)[1], y2: at(0, f)[1] });
    node(svg, "text", { x: left - 6, y: at(0, f)[1] + 4, "text-anchor": "end" }, number(f));
  }
  for (let d = 0; d <= 360; d += 60)
    node(svg, "text", { x: at((d * Math.PI) / 180, 0)[0], y: low + 18, "text-anchor": "middle" }, `${d}°`);
  const line = (values) => data.phi.map((phi, k) => at(phi, values[k]));
  node(svg, "polygon", { class: "area safe", points: points([...line(data.high), ...line(data.low).reverse()]) });
  node(svg, "polyline", { class: "curve speeding", id: "curve-pull", points: points(line(data.force)) });
  for (const p of data.points) {
    const [x, y] = at(p.phi, p.mean);
    node(svg, "line", { class: "curve measured", x1: x, x2: x, y1: at(0, p.low)[1], y2: at(0, p.high)[1] });
    node(svg, "circle", { class: "area measured point", cx: x, cy: y, r: 4.5 });
  }
  const weakest = `Weakest: ${number(data.weakest.force)} N at φ = ${data.weakest.phi}.`;
  const gaps = data.points.map((p) => p.mean - p.limit);
  const mean = gaps.reduce((a, b) => a + b, 0) / gaps.length;
  const rms = Math.sqrt(gaps.reduce((a, b) => a + b * b, 0) / gaps.length);
  words.textContent = gaps.length
    ? `${weakest} ${csv.name}: ${gaps.length} orientations; measured minus the model ${mean < 0 ? "−" : "+"}` +
      `${number(Math.abs(mean))} N on average, ${number(rms)} N root mean square.`
    : weakest;
  byId("forget").hidden = !csv;
});

let pause = 0;
function update() {
  drawLimits();
  if (tab() === "pulls") drawPulls();
  if (tab() === "export") {
    byId("stale").textContent = "computing …";
    clearTimeout(pause);
    pause = setTimeout(drawExport, 60);
  }
}

function shown(slider, value) {
  const digits = (String(slider.step).split(".")[1] || "").length;
  const text = slider.key === "yaw_share" || slider.key === "margin"
    ? `${Math.round(100 * value)} %` : `${value.toFixed(digits)} ${slider.unit}`;
  return text.trim();
}

function build() {
  const where = `${about.robot} on ${about.surface}`;
  byId("title").textContent = where;
  document.title = `${where} · slipmargin explore`;
  for (const slider of about.sliders) {
    const row = document.createElement("div"), label = document.createElement("label");
    const out = document.createElement("output"), input = document.createElement("input");
    row.className = "row";
    label.htmlFor = out.htmlFor = input.id = "s-" + slider.key;
    label.append(slider.label, out);
    Object.assign(input, { type: "range", min: slider.low, max: slider.high, step: "any" });
    input.value = slider.value;
    input.step = slider.step;
    out.textContent = shown(slider, slider.value);
    input.addEventListener("input", () => {
      input.dataset.moved = "1";
      out.textContent = shown(slider, Number(input.value));
      update();
    });
    row.append(label, input);
    if (slider.note) {
      const note = document.createElement("div");
      note.className = "soft";
      note.textContent = slider.note;
      row.append(note);
    }
    byId("rows").append(row);
  }
  byId("tool").append(...about.tools.map((t) => new Option(t.name, t.name)));
  byId("warnings").textContent = about.warnings.join(" ");
  byId("reset").addEventListener("click", () => {
    for (const slider of about.sliders) {
      const input = byId("s-" + slider.key);
      input.value = slider.value;
      delete input.dataset.moved;
      input.previousElementSibling.querySelector("output").textContent = shown(slider, slider.value);
    }
    update();
  });
  byId("tool").addEventListener("change", drawExport);
}

function choose(name) {
  for (const one of document.querySelectorAll("[role=tab]")) {
    const mine = one.getAttribute("aria-controls") === name;
    one.setAttribute("aria-selected", String(mine));
    one.tabIndex = mine ? 0 : -1;
    byId(one.getAttribute("aria-controls")).hidden = !mine;
  }
  if (name === "export") drawExport();
  if (name === "pulls") drawPulls();
}

function wire() {
  const tabs = [...document.querySelectorAll("[role=tab]")];
  tabs.forEach((one, k) => {
    one.addEventListener("click", () => choose(one.getAttribute("aria-controls")));
    one.addEventListener("keydown", (event) => {
      const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!by) return;
      const next = tabs[(k + by + tabs.length) % tabs.length];
      choose(next.getAttribute("aria-controls"));
      next.focus();
    });
  });
  for (const button of document.querySelectorAll("[data-copy]")) {
    button.addEventListener("click", async () => {
      const words = button.textContent;
      try {
        await navigator.clipboard.writeText(byId(button.dataset.copy).textContent);
        button.textContent = "Copied";
      } catch { button.textContent = "Not copied: select the text below"; }
      setTimeout(() => { button.textContent = words; }, 1500);
    });
  }
  byId("save").addEventListener("click", () => {
    const tool = about.tools.find((t) => t.name === byId("tool").value), link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([byId("text").textContent]));
    link.download = `limits.${tool.ending}`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  });
  const take = (file) => { if (file) { csv = { name: file.name, file }; drawPulls(); } };
  byId("csv").addEventListener("change", (event) => take(event.target.files[0]));
  byId("forget").addEventListener("click", () => { csv = null; byId("csv").value = ""; drawPulls(); });
  const drop = byId("drop");
  for (const kind of ["dragover", "dragleave", "drop"])
    drop.addEventListener(kind, (event) => {
      event.preventDefault();
      drop.classList.toggle("over", kind === "dragover");
      if (kind === "drop") take(event.dataTransfer.files[0]);
    });
  byId("html").addEventListener("change", async (event) => {
    const file = event.target.files[0];
    if (file) byId("shown").srcdoc = await file.text();
  });
}

(async () => {
  try {
    about = await ask("robot", "");
    build();
    wire();
    if (about.report) byId("shown").srcdoc = (await ask("report", "")).html;
    drawLimits();
  } catch (fault) { fail(fault); }
})();
