// SPDX-License-Identifier: MIT
/// The source of the studio's page: style, elements, program. studio_page.hpp puts the parts between them. The program
/// continues that of viewer_page.hpp: its player shows the motion.
#pragma once

#include <string_view>  // source

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// It follows viewer_style.
inline constexpr std::string_view studio_style = R"page(
[hidden] { display: none !important; }
body { overflow: hidden; }
header { align-items: center; padding: 7px 16px; background: var(--panel); border-bottom: 1px solid var(--line); }
nav { display: flex; flex-wrap: wrap; gap: 6px; align-items: center; margin-left: auto; }
button { cursor: pointer; }
button:disabled { cursor: default; }
input, textarea {
  font: inherit; color: inherit; background: var(--back); border: 1px solid var(--line); border-radius: 7px;
  padding: 4px 8px; min-height: 32px;
}
#work { flex: 1 1 auto; display: grid; grid-template-columns: minmax(0, 1fr) 372px; min-height: 0; }
#stage { min-height: 0; }
#says { position: absolute; left: 14px; top: 10px; right: 14px; pointer-events: none; font-weight: 600; }
#panel { background: var(--panel); border-left: 1px solid var(--line); padding: 4px 14px 10px; overflow-y: auto; }
h2 { font-size: 14px; margin: 2px 0; flex: 1; }
.line { display: flex; flex-wrap: wrap; gap: 4px 8px; align-items: center; margin: 5px 0; }
.line input[type=number] { width: 78px; }
#words { width: 100%; }
fieldset { border: 0; padding: 0; margin: 5px 0; display: flex; flex-wrap: wrap; gap: 0 12px; }
legend { padding: 0; color: var(--faint); }
fieldset label { white-space: nowrap; min-height: 24px; display: inline-flex; align-items: center; gap: 4px; }
fieldset input { min-height: 0; width: 16px; height: 16px; accent-color: var(--accent); }
.main { background: var(--accent); border-color: var(--accent); color: #fff; font-weight: 600; }
@media (prefers-color-scheme: dark) { .main { color: #10141a; } }
#generate { min-width: 110px; }
progress { width: 100%; height: 10px; accent-color: var(--accent); }
#status { margin: 2px 0; color: var(--faint); }
#status.wrong { color: var(--warn); }
#warnings { margin: 2px 0 0; padding-left: 18px; color: var(--warn); font-size: 13px; }
:root { --warn: #9a4a00; }
@media (prefers-color-scheme: dark) { :root { --warn: #f0b060; } }
footer { padding: 6px 16px 8px; }
#scrub { margin: 4px 0 2px; }
#timeline {
  display: grid; grid-template-columns: 126px minmax(0, 1fr); max-height: 36vh; cursor: default; padding-right: 18px;
  overflow-x: clip;
}
#axis { margin: 0; cursor: pointer; min-height: 20px; touch-action: none; }
#names div {
  display: flex; align-items: center; gap: 4px; border-top: 1px solid var(--line); white-space: nowrap;
  padding-right: 8px;
}
#names button, #add { min-height: 22px; padding: 0 7px; line-height: 1; }
#names span { flex: 1; overflow: hidden; text-overflow: ellipsis; }
#lanes { position: relative; touch-action: pan-y; }
.lane { position: relative; border-top: 1px solid var(--line); }
.lane .bar {
  display: flex; align-items: center; overflow: hidden; padding: 0 9px 0 5px; touch-action: none; cursor: grab;
  user-select: none;
}
.lane .bar > span { flex: 1 1 auto; min-width: 0; }
.bar.chosen {
  outline: 2px solid var(--accent); outline-offset: -1px; background: color-mix(in srgb, var(--hue) 40%, transparent);
}
.bar.warned > span::before { content: "\26a0\a0"; color: var(--warn); }
.grip { position: absolute; top: 0; bottom: 0; width: 9px; cursor: ew-resize; }
.grip.from { left: 0; }
.grip.to { right: 0; border-right: 3px solid var(--hue); }
dialog {
  width: min(640px, 94vw); background: var(--panel); color: var(--text); border: 1px solid var(--line);
  border-radius: 10px;
}
dialog textarea { width: 100%; height: 220px; font: 13px/1.5 ui-monospace, monospace; }
dialog::backdrop { background: rgb(0 0 0 / 0.4); }
@media (max-width: 760px) {
  html, body { height: auto; }
  body { overflow: auto; }
  #work { display: contents; }
  #stage { flex: none; height: 40vh; }
  #panel { order: 1; border-left: 0; border-top: 1px solid var(--line); }
  #timeline { grid-template-columns: 112px minmax(0, 1fr); max-height: none; }
  #names { font-size: 13px; }
  #names button { padding: 0 5px; }
  #hint { display: none; }
  nav { margin-left: 0; }
}
)page";

inline constexpr std::string_view studio_header = R"page(
<header><h1 id="title"></h1><span id="info"></span>
  <nav aria-label="Project">
    <button id="undo" type="button" title="Ctrl+Z">Undo</button>
    <button id="redo" type="button" title="Ctrl+Shift+Z">Redo</button>
    <button id="fresh" type="button">New</button>
    <button id="write" type="button">Timeline text</button>
    <button id="link" type="button">Copy link</button>
    <select id="kind" aria-label="Kind of file">
      <option value=".bvh">BVH</option><option value=".glb">GLB</option><option value=".vrma">VRMA</option>
      <option value=".npz">AMASS .npz</option><option value=".npy">joints .npy</option>
      <option value=".html">viewer page</option><option value=".svg">film strip</option>
    </select>
    <button id="save" type="button" disabled>Save motion</button>
  </nav>
</header>
)page";

inline constexpr std::string_view studio_panel = R"page(
<aside id="panel" aria-label="Text and motion">
  <section aria-labelledby="aboutText">
    <div class="line"><h2 id="aboutText">Text</h2>
      <button id="duplicate" type="button" title="Ctrl+D">Duplicate</button>
      <button id="remove" type="button" title="Delete">Delete</button></div>
    <p id="nothing">Choose a bar, or add a text.</p>
    <div id="chosen">
      <input id="words" list="prompts" autocomplete="off" maxlength="200" aria-label="What the person does">
      <datalist id="prompts"></datalist>
      <div class="line"><label>From <input id="from" type="number" min="0" step="0.05"></label>
        <label>to <input id="to" type="number" min="0" step="0.05"></label> s</div>
      <fieldset id="parts"><legend>Body parts</legend></fieldset>
    </div>
  </section>
  <section aria-labelledby="aboutMotion">
    <div class="line"><h2 id="aboutMotion">Motion</h2>
      <label>Steps <select id="steps"><option value="usual">20</option><option value="fast">10, fast</option></select>
      </label> <button id="dice" type="button">Next seed</button></div>
    <div class="line"><label>Length <input id="length" type="number" min="0.5" max="60" step="0.5"></label> s
      <label>Seed <input id="seed" type="number" min="0" max="9007199254740991" step="1"></label></div>
    <div class="line"><button id="generate" class="main" type="button" title="Ctrl+Enter">Generate</button>
      <button id="cancel" type="button" hidden>Cancel</button> <span id="left"></span></div>
    <progress id="progress" max="1" value="0" aria-label="Steps that are done" hidden></progress>
    <p id="status" role="status"></p>
    <ul id="warnings" aria-label="Warnings"></ul>
  </section>
</aside>
)page";

inline constexpr std::string_view studio_timeline = R"page(
<div id="timeline">
  <div><button id="add" type="button">Add text</button></div><div id="axis" aria-hidden="true"></div>
  <div id="names"></div><div id="lanes" role="group" aria-label="Texts by body part"><div id="cursor"></div></div>
</div>
<p id="help" hidden>Left and right move the text, with Shift its end, with Control its start. Up and down change the
body part. Enter edits the words, Delete deletes, Control D duplicates.</p>
)page";

inline constexpr std::string_view studio_dialog = R"page(
<dialog id="dialog" aria-labelledby="aboutDialog">
  <h2 id="aboutDialog">Timeline text</h2>
  <p>Each line is one text: text # start # end # body parts. <code>motionlang generate</code> reads it as well.</p>
  <textarea id="lines" aria-label="Timeline text" spellcheck="false"></textarea>
  <p id="fault" role="alert"></p>
  <div class="line"><button id="apply" class="main" type="button">Apply</button>
    <button id="openText" type="button">Open file</button><button id="saveText" type="button">Save file</button>
    <button id="close" type="button">Close</button><input id="file" type="file" accept=".txt" hidden></div>
</dialog>
)page";

/// The worker, behind the program of emscripten: loads the model and makes motions.
inline constexpr std::string_view studio_worker = R"page(
;"use strict";
let wasm = null, loaded = 0, latest = 0;  // the module, and pointers to a model and a motion

/** The bytes of a text with seven bits a character, unpacked. */
const unpacked = (text) => {
  const bytes = new Uint8Array(Math.floor(text.length / 8) * 7 + (text.length % 8 * 7 >> 3));
  let held = 0, bits = 0, count = 0;
  for (let i = 0; i < text.length; ++i) {
    held = (held << 7 | text.charCodeAt(i) & 127) & 0x7fff;
    bits += 7;
    if (bits >= 8) bytes[count++] = held >> (bits -= 8);
  }
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
};
/** Calls use(pointer) with a C string. */
const withText = (words, use) => {
  const size = wasm.lengthBytesUTF8(words) + 1, at = wasm._malloc(size);
  try {
    wasm.stringToUTF8(words, at, size);
    return use(at);
  } finally {
    wasm._free(at);
  }
};
/** The pointer that call(place) puts into a place. Throws the message of the library. */
const made = (call) => {
  const place = wasm._malloc(4);
  try {
    wasm.HEAP32[place >> 2] = 0;
    if (call(place)) throw new Error(wasm.UTF8ToString(wasm._motionlang_message()));
    return wasm.HEAP32[place >> 2];
  } finally {
    wasm._free(place);
  }
};
/** A copy of the bytes, which are freed. */
const taken = (bytes) => {
  const at = wasm._motionlang_bytes_data(bytes), copy = wasm.HEAPU8.slice(at, at + wasm._motionlang_wasm_size(bytes));
  wasm._motionlang_free_bytes(bytes);
  return copy;
};
const takenJson = (bytes) => JSON.parse(new TextDecoder().decode(taken(bytes)));

const answers = {
  async load({ code, model }) {
    wasm = await motionlangModule({
      wasmBinary: await unpacked(code),
      progress: (done, total) => {
        postMessage({ done, total });
        return true;
      } });
    wasm.FS.writeFile("/model.safetensors", new Uint8Array(await unpacked(model)));
    wasm._motionlang_set_threads(1);
    loaded = withText("/model.safetensors", (file) => made((place) => wasm._motionlang_load_model(file, place)));
    return { fps: wasm._motionlang_model_fps(loaded) };
  },
  check: ({ timeline }) => takenJson(withText(timeline, (words) =>
    made((place) => wasm._motionlang_check_timeline(loaded, words, place)))),
  generate({ timeline, seed, fast }) {
    const motion = withText(timeline, (words) => withText("ddim", (ddim) => made((place) =>
      wasm._motionlang_wasm_generate(loaded, words, seed >>> 0, Math.floor(seed / 2 ** 32), fast ? 10 : 0,
                                     fast ? ddim : 0, place))));
    wasm._motionlang_free_motion(latest);
    latest = motion;
    return takenJson(made((place) => wasm._motionlang_viewer_data(latest, place)));
  },
  save: ({ format }) => taken(withText(format, (words) =>
    made((place) => wasm._motionlang_motion_bytes(latest, words, place)))) };

let turnOf = Promise.resolve();  // one request after the other
onmessage = ({ data }) => {
  turnOf = turnOf.then(async () => {
    try {
      postMessage({ id: data.id, value: await answers[data.kind](data) });
    } catch (reason) {
      postMessage({ id: data.id, error: String(reason && reason.message || reason) });
    }
  });
};
)page";

/// The project: texts with their times and parts, undo and redo, storage, links.
inline constexpr std::string_view studio_script_project = R"page(
const parts = ["left arm", "right arm", "legs", "spine", "head"];  // as motionlang_check_timeline names them
const rows = ["whole body", ...parts];
const shortest = 0.25, longest = 60;  // seconds of a text, of a project
const example = {
  bars: [{ text: "walk forward", start: 0, end: 6, parts: ["legs"] },
         { text: "raise both arms", start: 2, end: 5, parts: ["left arm", "right arm"] }],
  seconds: 6, seed: 7, fast: false };

let project = structuredClone(example), chosen = 0;
const past = [], future = [];
let lastKey = null;  // the key of the latest edit: edits with the same key are undone together

const rounded = (seconds) => Math.round(1000 * seconds) / 1000;
/** Keeps times in their limits and in order. */
function tidied(p) {
  p.seconds = clamp(rounded(+p.seconds) || 0.5, 0.5, longest);
  p.seed = clamp(Math.floor(+p.seed) || 0, 0, Number.MAX_SAFE_INTEGER);
  for (const bar of p.bars) {
    bar.start = clamp(rounded(+bar.start) || 0, 0, p.seconds - shortest);
    bar.end = clamp(rounded(+bar.end) || 0, bar.start + shortest, p.seconds);
    bar.text = bar.text.replace(/[#\r\n]+/g, " ");
    bar.parts = parts.filter((name) => bar.parts.includes(name));
    if (bar.parts.length === parts.length) bar.parts = [];  // all: the whole body
  }
  return p;
}
/** Changes the project by a function. A key joins it with the edit before, if that has the same key. */
function edit(change, key = null) {
  const old = JSON.stringify({ project, chosen });
  change(project);
  tidied(project);
  if (JSON.stringify({ project, chosen }) === old) return;
  if (key === null || key !== lastKey) past.push(old);
  lastKey = key;
  future.length = 0;
  edited();
}
function goBack(from, to) {
  if (from.length === 0) return;
  to.push(JSON.stringify({ project, chosen }));
  ({ project, chosen } = JSON.parse(from.pop()));
  lastKey = unfinished = null;
  edited();
}
const undo = () => goBack(past, future), redo = () => goBack(future, past);

/** The timeline of a project as text, and for each line the number of its bar, or -1. Somebody stands where no text is
    at the start and at the end, because a timeline begins and ends with its texts. */
function timelineOf(p) {
  const lines = [], bars = [];
  const line = (words, start, end, names, bar) => {
    lines.push([words, rounded(start), rounded(end), ...names].join(" # "));
    bars.push(bar);
  };
  const told = p.bars.map((bar, i) => [bar, i]).filter(([bar]) => bar.text.trim());
  const first = Math.min(p.seconds, ...told.map(([bar]) => bar.start));
  const last = Math.max(first, ...told.map(([bar]) => bar.end));
  if (first > 0) line("stand still", 0, first, [], -1);
  for (const [bar, i] of told) line(bar.text.trim(), bar.start, bar.end, bar.parts, i);
  if (last < p.seconds) line("stand still", last, p.seconds, [], -1);
  return { lines: lines.join("\n") + "\n", bars };
}
/** The bars and the length of what motionlang_check_timeline read. */
const projectOf = ({ texts, seconds }, { seed, fast }) => {
  if (seconds > longest) throw new Error(`it has ${seconds} s, and the studio makes at most ${longest}`);
  return tidied({
    bars: texts.map((t) => ({ ...t, parts: t.parts.filter((name) => parts.includes(name)) })), seconds, seed, fast });
};

const linkOf = (p) =>
  "#" + new URLSearchParams({ timeline: timelineOf(p).lines, seed: p.seed, ...(p.fast && { fast: 1 }) });
const place = "motionlang studio";  // in the browser's storage
function store() {
  const link = linkOf(project);
  try {
    history.replaceState(null, "", link);
    localStorage.setItem(place, JSON.stringify({ project, link }));
  } catch (reason) {
    console.info("the browser keeps no project:", reason.message);
  }
}
/** The project of the last visit, and the link that it had; nothing if there is none. */
function stored() {
  try {
    const { project: kept, link } = JSON.parse(localStorage.getItem(place)) || {};
    return kept && Array.isArray(kept.bars) ? { project: tidied(kept), link } : null;
  } catch (reason) {
    console.info("the browser has no project:", reason.message);
    return null;
  }
}
)page";

/// The worker's side in the page.
inline constexpr std::string_view studio_script_engine = R"page(
class Engine {
  constructor(onprogress) {
    this.onprogress = onprogress;
    this.source = URL.createObjectURL(new Blob([page.program], { type: "text/javascript" }));
    this.start();
  }
  start() {
    this.waiting = new Map();
    this.count = 0;
    this.worker = new Worker(this.source);
    this.worker.onmessage = ({ data }) => {
      if (!("id" in data)) return this.onprogress(data);
      const asked = this.waiting.get(data.id);
      this.waiting.delete(data.id);
      if (asked) "error" in data ? asked.reject(new Error(data.error)) : asked.resolve(data.value);
    };
    this.worker.onerror = (event) => this.fail(new Error(event.message || "the worker did not start"));
    const packed = (id) => element(id).textContent;
    this.ready = this.ask("load", { code: packed("code"), model: packed("model") });
    this.ready.catch(() => {});  // whoever asks for something hears it
  }
  ask(kind, about = {}) {
    return new Promise((resolve, reject) => {
      const id = ++this.count;
      this.waiting.set(id, { resolve, reject });
      this.worker.postMessage({ id, kind, ...about });
    });
  }
  fail(reason) {
    for (const { reject } of this.waiting.values()) reject(reason);
    this.waiting.clear();
  }
  /** Ends all work at once, and begins anew with another worker. */
  cancel() {
    this.worker.terminate();
    const stopped = new Error("cancelled");
    stopped.cancelled = true;
    this.fail(stopped);
    this.start();
  }
}
)page";

/// Bars, fields, buttons.
inline constexpr std::string_view studio_script_editor = R"page(
let making = null;  // what is generated now: { key, began }
let shownKey = null, motions = 0, warned = [];  // of the motion that is shown; number of motions so far
let opened = 0, took = 0;  // seconds from opening to the first motion, and of the latest one
const keyOf = (p) => linkOf(p);
const bar = () => project.bars[chosen];
const number = (id) => +element(id).value;
const nameOf = (b) => b.parts.length ? b.parts.join(", ") : "whole body";

function say(words, wrong = false) {
  element("status").textContent = words;
  element("status").classList.toggle("wrong", wrong);
}
const engine = new Engine(({ done, total }) => {
  if (!making) return;
  const spent = (performance.now() - making.began) / 1000, left = spent / done * (total - done);
  element("progress").value = done / total;
  element("left").textContent = `step ${done} of ${total}, ${left < 1 ? "less than 1" : Math.ceil(left)} s left`;
});

// ---- What the project looks like.

/** Bars of a row that overlap lie below each other: the number of the line of each, and of lines. */
function stacked(numbers) {
  const ends = [], lineOf = new Map();
  for (const i of [...numbers].sort((a, b) => project.bars[a].start - project.bars[b].start)) {
    let line = ends.findIndex((end) => end <= project.bars[i].start + 1e-9);
    if (line < 0) line = ends.length;
    ends[line] = project.bars[i].end;
    lineOf.set(i, line);
  }
  return { lineOf, lines: Math.max(1, ends.length) };
}
const isInRow = (b, row) => b.parts.length ? b.parts.includes(row) : row === rows[0];
function drawBars() {
  const names = element("names"), lanes = element("lanes"), held = lanes.contains(document.activeElement);
  names.replaceChildren();
  lanes.replaceChildren(element("cursor"));
  const drawn = new Set();  // a bar of several rows is reached by the keyboard once
  for (const row of rows) {
    const numbers = project.bars.map((b, i) => i).filter((i) => isInRow(project.bars[i], row));
    const { lineOf, lines } = stacked(numbers), name = text("div", "", names), lane = text("div", "", lanes);
    text("span", row[0].toUpperCase() + row.slice(1), name);
    const plus = text("button", "+", name);
    plus.type = "button";
    plus.setAttribute("aria-label", `Add a text: ${row}`);
    plus.addEventListener("click", () => addBar(row, time));
    name.style.height = lane.style.height = 27 * lines + 1 + "px";
    lane.className = "lane";
    lane.dataset.row = row;
    for (const i of numbers) {
      const b = project.bars[i], e = text("div", "", lane), words = b.text.trim() || "(no text)";
      const warnings = warned.filter((w) => w.bars.includes(i)).map((w) => w.message);
      e.className = "bar";
      e.classList.toggle("chosen", i === chosen);
      e.classList.toggle("warned", warnings.length > 0 || !b.text.trim());
      e.dataset.bar = i;
      text("span", words, e);
      for (const side of ["from", "to"]) text("i", "", e).className = "grip " + side;
      Object.assign(e.style, { left: 100 * b.start / project.seconds + "%", top: 2 + 27 * lineOf.get(i) + "px",
                               width: 100 * (b.end - b.start) / project.seconds + "%" });
      e.style.setProperty("--hue", hues[i % hues.length]);
      e.title = [`${words}: ${shown(b.start)} to ${shown(b.end)}, ${nameOf(b)}`, ...warnings].join("\n");
      if (drawn.has(i)) {
        e.setAttribute("aria-hidden", "true");
        continue;
      }
      drawn.add(i);
      e.tabIndex = 0;
      e.setAttribute("role", "button");
      e.setAttribute("aria-pressed", i === chosen);
      e.setAttribute("aria-label", e.title);
      e.setAttribute("aria-describedby", "help");
      if (held && i === chosen) e.focus({ preventScroll: true });
    }
  }
  drawAxis(element("axis"), project.seconds);
}
let unfinished = null;  // the field in which a person writes a number
function fill(id, value) {
  const field = element(id);
  if (field !== unfinished && field.value !== String(value)) field.value = value;
}
function drawFields() {
  const b = bar();
  element("chosen").hidden = !b;
  element("nothing").hidden = !!b;
  element("duplicate").disabled = element("remove").disabled = !b;
  if (b) {
    fill("words", b.text);
    fill("from", b.start);
    fill("to", b.end);
    for (const box of document.querySelectorAll("#parts input"))
      box.checked = b.parts.length === 0 || b.parts.includes(box.value);
  }
  fill("length", project.seconds);
  fill("seed", project.seed);
  element("steps").value = project.fast ? "fast" : "usual";
  element("undo").disabled = past.length === 0;
  element("redo").disabled = future.length === 0;
  const stale = keyOf(project) !== shownKey;
  element("generate").disabled = making !== null;
  element("cancel").hidden = element("progress").hidden = making === null;
  element("left").textContent = making ? element("left").textContent
    : motions && stale ? "The timeline has changed." : "";
  element("save").disabled = motions === 0;
}
function drawWarnings() {
  const list = element("warnings");
  list.replaceChildren();
  for (const { message } of warned) text("li", message, list);
}
function draw() {
  chosen = clamp(chosen, -1, project.bars.length - 1);
  drawBars();
  drawFields();
  refresh();
}
let checking = 0;
function edited() {
  draw();
  clearTimeout(checking);
  checking = setTimeout(() => {
    store();
    check();
  }, 250);
}
addEventListener("pagehide", store);
/** Asks for warnings. While a motion is made they come after it. */
async function check() {
  const { lines, bars } = timelineOf(project);
  let found;
  try {
    found = (await engine.ask("check", { timeline: lines })).warnings;
  } catch (reason) {
    if (reason.cancelled) return;
    found = [{ texts: [], message: reason.message }];
  }
  if (lines !== timelineOf(project).lines) return;  // of a timeline that has changed
  warned = found.map(({ texts, message }) => ({ message, bars: texts.map((i) => bars[i]) }));
  drawWarnings();
  draw();
}

// ---- The motion.

function showMoment() {
  element("cursor").style.left = 100 * Math.min(time, project.seconds) / project.seconds + "%";
  const now = project.bars.filter((b) => b.start <= time && time < b.end && motions);
  const words = now.map((b) => b.text.trim()).filter(Boolean).join(" \u00b7 ");
  if (element("says").textContent !== words) element("says").textContent = words;
  for (const e of document.querySelectorAll(".bar"))
    e.classList.toggle("now", now.includes(project.bars[e.dataset.bar]));
}
async function generate() {
  if (making) return;
  const began = performance.now(), key = keyOf(project), { seed, fast } = project;
  making = { key, began };
  element("progress").value = 0;
  element("left").textContent = "";
  say("Generating.");
  draw();
  try {
    const data = await engine.ask("generate", { timeline: timelineOf(project).lines, seed, fast });
    const first = motions++ === 0;
    showClip(new Clip(data));
    shownKey = key;
    if (first) camera.reset(clip);
    seek(Math.min(time, clip.seconds));
    if (first) play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
    took = (performance.now() - began) / 1000;
    opened ||= performance.now() / 1000;
    say(`${clip.frames} frames in ${took.toFixed(1)} s, seed ${seed}.`);
  } catch (reason) {
    if (reason.cancelled) motions = 0;  // the worker that had the motion is gone
    say(reason.cancelled ? "Cancelled. Generate again before you save." : reason.message, !reason.cancelled);
  }
  making = null;
  draw();
}
function offer(name, bytes, type) {
  const link = document.createElement("a"), address = URL.createObjectURL(new Blob([bytes], { type }));
  Object.assign(link, { href: address, download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}
function fileName() {
  const words = project.bars.map((b) => b.text.trim()).filter(Boolean)[0] || "motion";
  return words.replace(/[^a-z0-9]+/gi, "_");
}

// ---- Edits.

function choose(i) {
  if (i === chosen) return;
  chosen = i;
  lastKey = null;
  draw();
}
function addBar(row, from) {
  edit((p) => {
    const start = Math.min(from, p.seconds - shortest);
    const added = { text: "stand still", start, end: Math.min(start + 2, p.seconds), parts: [] };
    setParts(added, row);
    chosen = p.bars.push(added) - 1;
  });
  element("words").focus();
  element("words").select();
}
function removeBar() {
  if (!bar()) return;
  edit((p) => {
    p.bars.splice(chosen, 1);
    chosen = Math.min(chosen, p.bars.length - 1);
  });
}
function duplicateBar() {
  if (!bar()) return;
  edit((p) => {
    const copy = structuredClone(bar()), length = copy.end - copy.start;
    copy.start = Math.min(copy.end, p.seconds - length);
    copy.end = copy.start + length;
    p.bars.splice(++chosen, 0, copy);
  });
}
/** Moves a bar without changing its length. */
function moveTo(b, start) {
  const length = b.end - b.start;
  b.start = clamp(rounded(start), 0, project.seconds - length);
  b.end = b.start + length;
}
/** A time near an edge of another bar, near the cursor or near the ends is that time; else a frame's. */
function snapped(seconds, own) {
  const reach = 7 * project.seconds / element("lanes").clientWidth;
  const edges = [0, project.seconds, time, ...project.bars.flatMap((b, i) => i === own ? [] : [b.start, b.end])];
  const near = edges.sort((a, b) => Math.abs(a - seconds) - Math.abs(b - seconds))[0];
  return Math.abs(near - seconds) <= reach ? near : Math.round(20 * seconds) / 20;
}
function setParts(b, row) { b.parts = row === rows[0] ? [] : [row]; }

const lanes = element("lanes");
lanes.addEventListener("pointerdown", (event) => {
  const e = event.target.closest(".bar");
  if (!e) return;
  event.preventDefault();
  const i = +e.dataset.bar, from = structuredClone(project.bars[i]), side = event.target.classList;
  const mode = side.contains("from") ? "from" : side.contains("to") ? "to" : "move", key = `drag ${performance.now()}`;
  const firstRow = e.parentElement.dataset.row;
  choose(i);
  lanes.querySelector(`[data-bar="${i}"][tabindex]`).focus({ preventScroll: true });
  lanes.setPointerCapture(event.pointerId);
  const drag = (moved) => {
    const way = (moved.clientX - event.clientX) * project.seconds / lanes.clientWidth;
    if (Math.hypot(moved.clientX - event.clientX, moved.clientY - event.clientY) < 4 && lastKey !== key) return;
    const row = [...lanes.querySelectorAll(".lane")].find((lane) => {
      const place = lane.getBoundingClientRect();
      return place.top <= moved.clientY && moved.clientY < place.bottom;
    })?.dataset.row;
    edit((p) => {
      const b = p.bars[i] = structuredClone(from);
      if (mode === "from") b.start = Math.min(snapped(from.start + way, i), from.end - shortest);
      if (mode === "to") b.end = Math.max(snapped(from.end + way, i), from.start + shortest);
      if (mode !== "move") return;
      const start = snapped(from.start + way, i), end = snapped(from.end + way, i);
      const plain = Math.round(20 * (from.start + way)) / 20;  // the end snaps if the start does not
      moveTo(b, Math.abs(start - plain) > 1e-9 || Math.abs(end - (plain + from.end - from.start)) < 1e-9
        ? start : end - (from.end - from.start));
      if (row && row !== firstRow) setParts(b, row);
    }, key);
  };
  const stop = () => {
    lanes.removeEventListener("pointermove", drag);
    lastKey = null;
  };
  lanes.addEventListener("pointermove", drag);
  for (const end of ["pointerup", "pointercancel"]) lanes.addEventListener(end, stop, { once: true });
});
lanes.addEventListener("mousedown", (event) => {  // the focus stays where pointerdown put it
  if (event.target.closest(".bar")) event.preventDefault();
});
lanes.addEventListener("click", (event) => {
  if (event.target.closest(".lane") && !event.target.closest(".bar")) choose(-1);
});
lanes.addEventListener("dblclick", (event) => {
  const lane = event.target.closest(".lane"), area = lanes.getBoundingClientRect();
  if (lane && !event.target.closest(".bar")) {
    addBar(lane.dataset.row, Math.round(20 * project.seconds * (event.clientX - area.left) / area.width) / 20);
  } else if (bar()) {  // a bar captures the mouse
    element("words").focus();
    element("words").select();
  }
});
lanes.addEventListener("focusin", (event) => {
  const e = event.target.closest(".bar");
  if (e) choose(+e.dataset.bar);
});
lanes.addEventListener("keydown", (event) => {
  const e = event.target.closest(".bar");
  if (!e || event.altKey || event.metaKey) return;
  const i = +e.dataset.bar, way = { ArrowLeft: -0.1, ArrowRight: 0.1 }[event.key];
  const turnRow = { ArrowUp: -1, ArrowDown: 1 }[event.key];
  const actions = { Delete: removeBar, Backspace: removeBar, Enter: () => element("words").focus() };
  if (way) {
    edit((p) => {
      const b = p.bars[i];
      if (event.shiftKey) b.end = Math.max(b.end + way, b.start + shortest);
      else if (event.ctrlKey) b.start = Math.min(b.start + way, b.end - shortest);
      else moveTo(b, b.start + way);
    }, `nudge ${i} ${event.shiftKey} ${event.ctrlKey}`);
  } else if (turnRow && !event.ctrlKey) {
    edit((p) => setParts(p.bars[i], rows[clamp(rows.findIndex((row) => isInRow(p.bars[i], row)) + turnRow, 0, 5)]));
  } else if (actions[event.key] && !event.ctrlKey) {
    actions[event.key]();
  } else {
    return;
  }
  event.preventDefault();
});

element("words").addEventListener("input", (event) => edit(() => { bar().text = event.target.value; }, "words"));
element("words").addEventListener("keydown", (event) => {
  if (event.key === "Enter" && !event.ctrlKey) generate();
});
/** A field of a number: takes effect when it is left or Enter is pressed. */
function field(id, change) {
  element(id).addEventListener("input", () => { unfinished = element(id); });
  element(id).addEventListener("change", () => {
    unfinished = null;
    if (element(id).value !== "") edit(change);
    lastKey = null;
    draw();
  });
}
field("from", () => { bar().start = Math.min(number("from"), bar().end - shortest); });
field("to", () => { bar().end = Math.max(number("to"), bar().start + shortest); });
field("length", (p) => { p.seconds = number("length"); });
field("seed", (p) => { p.seed = number("seed"); });
element("words").addEventListener("change", () => { lastKey = null; });
element("steps").addEventListener("change", (event) => edit((p) => { p.fast = event.target.value === "fast"; }));
for (const name of parts) {
  const label = text("label", "", element("parts")), box = document.createElement("input");
  Object.assign(box, { type: "checkbox", value: name });
  label.append(box, name);
  box.addEventListener("change", () => {
    const on = [...document.querySelectorAll("#parts input:checked")].map((e) => e.value);
    if (on.length) edit(() => { bar().parts = on; });
    draw();  // a text moves at least one part
  });
}
for (const { text: words } of page.prompts) element("prompts").append(new Option(words, words));

const press = (id, action) => element(id).addEventListener("click", action);
press("undo", undo);
press("redo", redo);
press("duplicate", duplicateBar);
press("remove", removeBar);
press("add", () => addBar(rows[0], time));
press("generate", generate);
press("cancel", () => {
  engine.cancel();
  check();
});
press("dice", () => { edit((p) => { ++p.seed; }); generate(); });
press("fresh", () => edit((p) => {
  Object.assign(p, { bars: [{ text: "walk forward", start: 0, end: 4, parts: [] }], seconds: 4 });
  chosen = 0;
}));
press("save", async () => {
  const format = element("kind").value;
  try {
    offer(fileName() + format, await engine.ask("save", { format }), "application/octet-stream");
  } catch (reason) {
    say(reason.message, true);
  }
});
press("link", async () => {
  try {
    await navigator.clipboard.writeText(location.href);
    say("The link is copied.");
  } catch (reason) {
    say("The link is in the address line.");
  }
});

// ---- The timeline as text.

async function readTimeline(lines) {
  const read = projectOf(await engine.ask("check", { timeline: lines }), project);
  edit((p) => {
    Object.assign(p, read);
    chosen = 0;
  });
}
press("write", () => {
  element("lines").value = timelineOf(project).lines;
  element("fault").textContent = "";
  element("dialog").showModal();
});
press("close", () => element("dialog").close());
press("apply", async () => {
  try {
    await readTimeline(element("lines").value);
    element("dialog").close();
  } catch (reason) {
    element("fault").textContent = reason.message;
  }
});
press("saveText", () => offer(fileName() + ".txt", element("lines").value, "text/plain"));
press("openText", () => element("file").click());
element("file").addEventListener("change", async ({ target }) => {
  if (target.files.length) element("lines").value = await target.files[0].text();
  target.value = "";
});

addEventListener("dragover", (event) => {
  if (event.dataTransfer.types.includes("Files")) event.preventDefault();
});
addEventListener("drop", async (event) => {
  const file = event.dataTransfer.files[0];
  if (!file) return;
  event.preventDefault();  // the page stays
  try {
    if (file.size > 100000) throw new Error("it is too large for a timeline");
    await readTimeline(await file.text());
  } catch (reason) {
    say(`${file.name}: ${reason.message}`, true);
  }
});

addEventListener("keydown", (event) => {
  if (!(event.ctrlKey || event.metaKey) || element("dialog").open) return;
  const key = event.key.toLowerCase();
  const action = key === "z" ? (event.shiftKey ? redo : undo) : { y: redo, d: duplicateBar, enter: generate }[key];
  if (!action) return;
  event.preventDefault();
  action();
});
seekByDragging(element("axis"), lanes, () => project.seconds);
new ResizeObserver(() => {
  drawAxis(element("axis"), project.seconds);
  refresh();
}).observe(element("stage"));

// ---- The start: a link, or the project of the last visit, or the example.

async function openLink() {
  const link = new URLSearchParams(location.hash.slice(1));
  if (!link.has("timeline") || location.hash === linkOf(project)) return;
  try {
    const read = await engine.ask("check", { timeline: link.get("timeline") });
    edit((p) => {
      Object.assign(p, projectOf(read, { seed: link.get("seed"), fast: link.has("fast") }));
      chosen = 0;
    });
  } catch (reason) {
    say(`The link has no timeline that can be read: ${reason.message}`, true);
  }
}
addEventListener("hashchange", async () => { await openLink(); generate(); });

/** For scripts that look at the page: what it shows and has, as a copy. */
window.motionlang = Object.freeze({ state: () => ({
  ...playerState(), project: structuredClone(project), chosen, timeline: timelineOf(project).lines, motions,
  opened, took, making: making !== null, stale: keyOf(project) !== shownKey, warnings: structuredClone(warned),
  undos: past.length, redos: future.length }) });

async function begin() {
  element("title").textContent = page.title;
  element("info").textContent = `motionlang ${page.version}`;
  const says = text("span", "", element("stage"));
  says.id = "says";
  const kept = stored(), linked = location.hash.length > 1 && !(kept && kept.link === location.hash);
  if (kept) project = kept.project;
  showClip(new Clip(page.rest));
  camera.reset(clip);
  draw();
  say("Loading the model.");
  try {
    await engine.ready;
  } catch (reason) {
    say(reason.message, true);
    return;
  }
  if (!making) say("");
  if (linked) await openLink();
  store();
  await generate();
  check();
}
begin();
)page";

}  // namespace detail

MOTIONLANG_NAMESPACE_END
