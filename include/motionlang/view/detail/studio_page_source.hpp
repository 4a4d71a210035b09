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
nav { display: flex; flex-wrap: wrap; gap: 4px; align-items: center; margin-left: auto; }
nav button, nav select { padding: 4px 7px; }
#info { display: none; }
button { cursor: pointer; }
button:disabled { cursor: default; }
input, textarea {
  font: inherit; color: inherit; background: var(--back); border: 1px solid var(--line); border-radius: 7px;
  padding: 4px 8px; min-height: 32px;
}
#work { flex: 1 1 auto; display: grid; grid-template-columns: minmax(0, 1fr) 372px; min-height: 0; }
#stage { min-height: 0; }
#says { position: absolute; left: 14px; top: 10px; right: 150px; pointer-events: none; font-weight: 600; }
#panel { background: var(--panel); border-left: 1px solid var(--line); padding: 4px 14px 10px; overflow-y: auto; }
h2 { font-size: 14px; margin: 2px 0; flex: 1; }
.line { display: flex; flex-wrap: wrap; gap: 4px 8px; align-items: center; margin: 5px 0; }
.line input[type=number] { width: 78px; }
#words { width: 100%; }
#panel > section { display: contents; }
#go { position: sticky; bottom: -10px; margin: 0; padding: 4px 0 5px; background: var(--panel); }
fieldset { border: 0; padding: 0; margin: 5px 0; display: flex; flex-wrap: wrap; gap: 0 12px; }
legend { padding: 0; color: var(--faint); }
fieldset label { white-space: nowrap; min-height: 24px; display: inline-flex; align-items: center; gap: 4px; }
fieldset input { min-height: 0; width: 16px; height: 16px; accent-color: var(--accent); }
.main { background: var(--accent); border-color: var(--accent); color: #fff; font-weight: 600; }
@media (prefers-color-scheme: dark) { .main { color: #10141a; } }
#generate { min-width: 110px; }
progress { width: 100%; height: 10px; accent-color: var(--accent); }
#left:not(:empty), #status { flex-basis: 100%; }
#status { margin: 0; color: var(--faint); }
#status.wrong { color: var(--warn); }
#warnings { margin: 2px 0 0; padding-left: 18px; color: var(--warn); font-size: 13px; }
:root { --warn: #9a4a00; }
@media (prefers-color-scheme: dark) { :root { --warn: #f0b060; } }
footer { padding: 6px 16px 8px; }
#scrub { margin: 4px 0 2px; }
#timeline {
  display: grid; grid-template-columns: 196px minmax(0, 1fr); max-height: 36vh; cursor: default; overflow-x: clip;
}
#tools { display: flex; gap: 4px; align-items: center; height: 28px; }
#scroller { overflow-x: auto; overflow-y: hidden; padding-right: 18px; }
#wide { min-width: 100%; }
#axis { margin: 0; cursor: pointer; height: 28px; padding-top: 8px; touch-action: none; }
#axis span:first-child { transform: none; }
#names div {
  display: flex; align-items: center; gap: 4px; border-top: 1px solid var(--line); white-space: nowrap;
  padding-right: 8px;
}
#names button, #tools button { min-height: 24px; min-width: 24px; padding: 0 6px; line-height: 1; font-size: 13px; }
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
.lane .bar.clip {
  background: repeating-linear-gradient(135deg, color-mix(in srgb, var(--hue) 40%, transparent) 0 6px,
                                        color-mix(in srgb, var(--hue) 14%, transparent) 6px 12px);
}
.bar.warned > span::before { content: "\26a0\a0"; color: var(--warn); }
.grip { position: absolute; top: 0; bottom: 0; width: 9px; cursor: ew-resize; }
.grip.from { left: 0; }
.grip.to { right: 0; border-right: 3px solid var(--hue); }
#graph { display: block; width: 100%; height: 52px; border-top: 1px solid var(--line); }
#timeline:has(#graph:not([hidden])) #names { margin-top: 52px; }
#aids { position: absolute; right: 12px; top: 10px; display: flex; flex-direction: column; gap: 4px; align-items: end; }
#aids button { min-height: 26px; padding: 2px 8px; font-size: 12px; }
#takes { position: absolute; left: 12px; bottom: 12px; display: flex; gap: 8px; }
#takes > div { position: relative; }
#takes > div > button:first-child {
  display: grid; padding: 2px; background: var(--panel); font-size: 12px; cursor: pointer;
}
#takes canvas { width: 92px; height: 112px; display: block; border-radius: 5px; }
#takes > div > button:last-child {
  position: absolute; right: 4px; top: 4px; min-height: 24px; padding: 0 6px; font-size: 12px;
}
#takes .old canvas { opacity: 0.45; }
#sheet { max-width: 120px; }
#examples { width: 110px; }
#kind, #folder { width: 98px; }
#found { margin: 0 0 10px; padding-left: 26px; max-height: 44vh; overflow-y: auto; }
#found li { margin: 4px 0; }
#found small { color: var(--faint); margin-left: 8px; }
#sought, #findWhere { flex: 1; }
#findWhere { min-width: 200px; margin: 0; }
#findSays { margin: 4px 0; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 3px 16px; }
dt { font-weight: 600; }
dd { margin: 0; }
dialog {
  width: min(640px, 94vw); background: var(--panel); color: var(--text); border: 1px solid var(--line);
  border-radius: 10px;
}
dialog textarea { width: 100%; height: 220px; font: 13px/1.5 ui-monospace, monospace; }
dialog::backdrop { background: rgb(0 0 0 / 0.4); }
#menu, #tabs { display: none; }
#more { display: contents; }
@media (max-width: 1180px) {
  header { position: relative; z-index: 2; }
  #menu { display: block; }
  #more { display: none; }
  #more.open {
    position: absolute; left: 8px; right: 8px; top: 100%; display: flex; flex-wrap: wrap; gap: 8px; padding: 10px;
    background: var(--panel); border: 1px solid var(--line); border-radius: 0 0 10px 10px;
    box-shadow: 0 8px 20px rgb(0 0 0 / 0.25);
  }
}
@media (max-width: 760px) {
  body { overflow: hidden auto; }
  header { padding: 6px 8px; }
  header h1 { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); }
  nav { margin: 0; width: 100%; justify-content: space-between; gap: 3px; font-size: 13px; }
  nav button, nav select { padding: 3px 6px; }
  #examples { width: 98px; }
  #kind { width: 68px; }
  #keysHelp { display: none; }
  #work { display: contents; }
  #stage { flex: 1 0 130px; }
  #says { right: 14px; font-size: 13px; white-space: nowrap; overflow: hidden; text-overflow: ellipsis; }
  #aids { flex-flow: row wrap-reverse; justify-content: center; left: 4px; right: 4px; top: auto; bottom: 6px; }
  #aids button { padding: 2px 6px; white-space: nowrap; }
  #takes { bottom: 40px; }
  #takes canvas { width: 50px; height: 56px; }
  #hint, #clock { display: none; }
  footer { padding: 4px 8px; flex: none; }
  #controls { gap: 4px; }
  #controls label { font-size: 0; }  /* there is room for the fields */
  #controls :is(button, select) { padding: 3px 7px; font-size: 13px; }
  #play { min-width: 66px; }
  #timeline { grid-template-columns: 112px minmax(0, 1fr); max-height: 30vh; }
  #tools { flex-wrap: wrap; height: 56px; }
  #axis { height: 56px; padding-top: 36px; }
  #scroller { padding-right: 6px; }
  #names { font-size: 13px; }
  #names button { padding: 0 5px; }
  #panel {
    order: 1; flex: 0 1 252px; min-height: 120px; display: flex; flex-direction: column; padding: 2px 10px 6px;
    border-left: 0; border-top: 1px solid var(--line);
  }
  #panel > section > * { flex: none; }
  #tabs { display: flex; gap: 4px; }
  #go { top: -2px; bottom: auto; z-index: 1; }
  #go, #plain { order: -1; }
  #panel .line { margin: 3px 0; }
  #panel[data-shown="text"] .setting, #panel[data-shown="motion"] > section:first-child { display: none; }
  #generate { min-width: 96px; margin-left: auto; }
}
)page";

inline constexpr std::string_view studio_header = R"page(
<header><h1 id="title"></h1><span id="info"></span>
  <nav aria-label="Project">
    <button id="menu" type="button" aria-expanded="false" aria-controls="more">Menu</button>
    <select id="examples" aria-label="Examples to start from"><option value="">Examples</option></select>
    <button id="undo" type="button" title="Ctrl+Z">Undo</button>
    <button id="redo" type="button" title="Ctrl+Shift+Z">Redo</button>
    <div id="more">
    <select id="sheet" aria-label="Timeline of the project"></select>
    <button id="fresh" type="button">New</button>
    <button id="drop" type="button" aria-label="Remove this timeline">Remove</button>
    <button id="open" type="button" title="A project, a timeline, a motion to keep or a character">Open</button>
    <select id="folder" aria-label="File in the project's folder" hidden></select>
    <input id="file" type="file" accept=".txt,.json,.bvh,.glb,.gltf,.vrm,.vrma,.npz,.npy" hidden>
    <button id="find" type="button" title="Find a motion by words">Find</button>
    <button id="write" type="button">Text</button>
    <button id="link" type="button" title="Copy a link to this timeline">Link</button>
    <button id="saveProject" type="button" title="All timelines and settings in one file">Save project</button>
    </div>
    <select id="kind" aria-label="Kind of file">
      <option value=".bvh">BVH</option><option value=".glb">GLB</option><option value=".vrma">VRMA</option>
      <option value=".npz">AMASS .npz</option><option value=".npy">joints .npy</option>
      <option value=".html">viewer page</option><option value=".svg">film strip</option>
      <option value=".png">picture PNG</option><option value=".gif">moving GIF</option>
      <option value=".webm">video WebM</option>
    </select>
    <button id="save" type="button" disabled>Save</button>
    <button id="keysHelp" type="button" aria-label="Keys" title="?">?</button>
  </nav>
</header>
)page";

inline constexpr std::string_view studio_panel = R"page(
<aside id="panel" aria-label="Text and motion" data-shown="text">
  <section aria-labelledby="aboutText">
    <div class="line"><h2 id="aboutText">Text</h2>
      <button id="split" type="button" title="X">Split</button>
      <button id="duplicate" type="button" title="Ctrl+D">Duplicate</button>
      <button id="remove" type="button" title="Delete">Delete</button></div>
    <p id="nothing">Choose a bar, or add a text.</p>
    <div id="chosen">
      <input id="words" list="prompts" autocomplete="off" maxlength="200" aria-label="What the person does">
      <datalist id="prompts"></datalist>
      <div class="line"><label>From <input id="from" type="number" min="0" step="0.05"></label>
        <label>to <input id="to" type="number" min="0" step="0.05"></label> s
        <button id="usual" type="button" hidden></button></div>
      <fieldset id="parts"><legend>Body parts</legend></fieldset>
    </div>
  </section>
  <section aria-labelledby="aboutMotion">
    <div class="line setting"><h2 id="aboutMotion">Motion</h2>
      <label>Steps <select id="steps"><option value="usual">20</option><option value="fast">10, fast</option></select>
      </label></div>
    <div class="line setting"><label>Length <input id="length" type="number" min="0.5" max="60" step="0.5"></label> s
      <label>Seed <input id="seed" type="number" min="0" max="9007199254740991" step="1"></label></div>
    <div class="line" id="go">
      <span id="tabs" role="group" aria-label="What is below">
        <button id="showText" type="button" aria-pressed="true">Text</button>
        <button id="showMotion" type="button" aria-pressed="false">Motion</button></span>
      <button id="generate" class="main" type="button" title="Ctrl+Enter">Generate</button>
      <button id="cancel" type="button" hidden>Cancel</button>
      <button id="dice" class="setting" type="button">Next seed</button>
      <button id="vary" class="setting" type="button" title="V">Variations</button>
      <span id="left"></span>
      <progress id="progress" max="1" value="0" aria-label="Steps that are done" hidden></progress>
      <p id="status" role="status"></p></div>
    <div class="line setting">
      <button id="keep" type="button" title="An edit changes only what is within a second of it">Keep the rest</button>
      <button id="whole" type="button" title="Ctrl+Shift+Enter">Make all anew</button>
      <button id="live" type="button" title="Generate after every edit">Live</button></div>
    <button id="plain" type="button" hidden>Without the character</button>
    <ul id="warnings" aria-label="Warnings"></ul>
  </section>
</aside>
)page";

inline constexpr std::string_view studio_timeline = R"page(
<div id="timeline">
  <div id="left-side">
    <div id="tools"><button id="add" type="button" title="N">Add text</button>
      <button id="snap" type="button" title="G">Snap</button>
      <button id="zoomOut" type="button" aria-label="Zoom out" title="-">&minus;</button>
      <button id="zoomIn" type="button" aria-label="Zoom in" title="+">+</button></div>
    <div id="names"></div>
  </div>
  <div id="scroller"><div id="wide"><div id="axis" aria-hidden="true"></div>
    <canvas id="graph" role="img" aria-label="Speed over the floor and height of the pelvis" hidden></canvas>
    <div id="lanes" role="group" aria-label="Texts by body part"><div id="cursor"></div></div></div></div>
</div>
<p id="help" hidden>Left and right move the text, with Shift its end, with Control its start. Up and down change the
body part. Enter edits the words, Delete deletes, Control D duplicates, X splits, S adds it to those that are
chosen.</p>
)page";

inline constexpr std::string_view studio_dialog = R"page(
<dialog id="dialog" aria-labelledby="aboutDialog">
  <h2 id="aboutDialog">Timeline text</h2>
  <p>Each line is one text: text # start # end # body parts. <code>motionlang generate</code> reads it as well.</p>
  <textarea id="lines" aria-label="Timeline text" spellcheck="false"></textarea>
  <p id="fault" role="alert"></p>
  <div class="line"><button id="apply" class="main" type="button">Apply</button>
    <button id="saveText" type="button">Save file</button><button id="close" type="button">Close</button></div>
</dialog>
<dialog id="findDialog" closedby="any" aria-labelledby="aboutFind">
  <h2 id="aboutFind">Find a motion</h2>
  <p id="findHelp">This page has no model for searches. Start <code>motionlang studio --project FOLDER</code> and open
    its link. Then words find moments in the motions of that folder.</p>
  <div id="findFrom" class="line" hidden>
    <p id="findWhere"></p>
    <button id="findFolder" type="button">Choose a folder</button>
    <button id="findFiles" type="button">Choose files</button>
    <input id="searchFolder" type="file" webkitdirectory hidden>
    <input id="searchFiles" type="file" multiple accept=".bvh,.amc,.npz,.npy,.glb,.gltf,.vrma" hidden></div>
  <form id="findForm" class="line" hidden>
    <input id="sought" maxlength="200" autocomplete="off" aria-label="What the person does">
    <button class="main">Find</button></form>
  <div class="line"><p id="findSays" role="status"></p>
    <button id="findStop" type="button" hidden>Stop reading</button></div>
  <ol id="found" aria-label="What was found"></ol>
  <button id="findClose" type="button">Close</button>
</dialog>
<dialog id="keysDialog" closedby="any" aria-labelledby="aboutKeys">
  <h2 id="aboutKeys">Keys</h2>
  <dl>
    <dt>Left, right</dt><dd>move the chosen bars; with Shift the end of one, with Ctrl its start</dd>
    <dt>Up, down</dt><dd>move a bar to another body part</dd>
    <dt>N, Enter, Delete</dt><dd>add a text behind the chosen one, edit its words, delete</dd>
    <dt>Ctrl+D, X</dt><dd>duplicate; split at the cursor</dd>
    <dt>S, Ctrl+A, Escape</dt><dd>choose a bar as well, all bars, one bar</dd>
    <dt>+, &minus;, 0, G</dt><dd>zoom in, out, show all; snap</dd>
    <dt>Ctrl+Enter</dt><dd>generate; with Shift everything anew</dd>
    <dt>V, 1 to 4, K</dt><dd>make variations, choose one, lock it</dd>
    <dt>Ctrl+Z, Ctrl+Shift+Z</dt><dd>undo, redo</dd>
    <dt>Space, comma, full stop</dt><dd>play, one frame back, one frame on</dd>
  </dl>
  <button id="keysClose" type="button">Close</button>
</dialog>
)page";

/// The worker, behind the program of emscripten: loads the model and makes motions.
inline constexpr std::string_view studio_worker = R"page(
;"use strict";
let wasm = null, loaded = 0, count = 0;  // the module, a pointer to the model, the number of motions so far
const made = new Map(), read = new Map();  // pointers to motions that were made, by number, and that were read, by name
let doing = "";  // the kind of the question that is answered now
const searches = { folder: "/searched/", model: "/search_model", file: "/searched.index", index: 0, hits: 0,
                   clips: 0, skipped: 0 };

/** The bytes of a text with seven bits a character, unpacked. */
const unpacked = (text) => {
  const bytes = new Uint8Array(Math.floor(text.length / 8) * 7 + (text.length % 8 * 7 >> 3));
  let held = 0, bits = 0, size = 0;
  for (let i = 0; i < text.length; ++i) {
    held = (held << 7 | text.charCodeAt(i) & 127) & 0x7fff;
    bits += 7;
    if (bits >= 8) bytes[size++] = held >> (bits -= 8);
  }
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
};
/** Calls use(pointer) with memory of this size. */
const withMemory = (size, use) => {
  const at = wasm._malloc(Math.max(size, 8));
  try {
    return use(at);
  } finally {
    wasm._free(at);
  }
};
/** Calls use(pointer) with a C string, or with 0 for nothing. */
const withText = (words, use) => {
  if (!words) return use(0);
  const size = wasm.lengthBytesUTF8(words) + 1;
  return withMemory(size, (at) => {
    wasm.stringToUTF8(words, at, size);
    return use(at);
  });
};
const withBytes = (bytes, use) => withMemory(bytes.byteLength, (at) => {
  wasm.HEAPU8.set(new Uint8Array(bytes), at);
  return use(at);
});
/** Throws the message of the library unless a call returns 0. */
const ask = (error) => {
  if (error) throw new Error(wasm.UTF8ToString(wasm._motionlang_message()));
};
/** The pointer that call(place) puts into a place. */
const result = (call) => withMemory(4, (place) => {
  wasm.HEAP32[place >> 2] = 0;
  ask(call(place));
  return wasm.HEAP32[place >> 2];
});
/** A copy of the bytes, which are freed. */
const taken = (bytes) => {
  const at = wasm._motionlang_bytes_data(bytes), copy = wasm.HEAPU8.slice(at, at + wasm._motionlang_wasm_size(bytes));
  wasm._motionlang_free_bytes(bytes);
  return copy;
};
const takenJson = (bytes) => JSON.parse(new TextDecoder().decode(taken(bytes)));
const dataOf = (motion) => takenJson(result((place) => wasm._motionlang_viewer_data(motion, place)));
const known = (motions, which) => {
  if (!motions.has(which)) throw new Error("this motion is gone");
  return motions.get(which);
};
/** What motionlang_motion_reuse says; nothing if nothing was reused. */
const reuseOf = (motion) => withMemory(40, (at) => {
  wasm._motionlang_wasm_reuse(motion, at);
  const [frames, kept, work, whole, exact] = wasm.HEAPF64.subarray(at >> 3, (at >> 3) + 5);
  return frames ? { frames, kept, work: whole ? work / whole : 0, exact: exact === 1 } : null;
});
/** Calls use(pointer, from, to, parts) with the stretch of a motion that is kept, or with 0. */
const withClip = (clip, use) => {
  if (!clip) return use(0, 0, 0, 0);
  const { id, from, start, end, parts } = clip;
  const cut = result((place) =>
    wasm._motionlang_cut_motion(known(read, id), from, from + end - start, start, place));
  try {
    return withText(parts, (names) => use(cut, start, end, names));
  } finally {
    wasm._motionlang_free_motion(cut);
  }
};

const answers = {
  async load({ code, model, search }) {
    wasm = await motionlangModule({
      wasmBinary: await unpacked(code),
      progress: (done, total) => {
        postMessage({ done, total, kind: doing });
        return true;
      } });
    const weights = "/stmc_free.safetensors";  // the search model reads captions from this file
    wasm.FS.writeFile(weights, new Uint8Array(await unpacked(model)));
    wasm._motionlang_set_threads(1);
    loaded = withText(weights, (file) => result((place) => wasm._motionlang_load_model(file, place)));
    searches.packed = search;
    return { fps: wasm._motionlang_model_fps(loaded) };
  },
  check: ({ timeline }) => takenJson(withText(timeline, (words) =>
    result((place) => wasm._motionlang_check_timeline(loaded, words, place)))),
  known: ({ begun, count: most }) => takenJson(withText(begun, (words) =>
    result((place) => wasm._motionlang_wasm_known_texts(loaded, words, most, place)))),
  /** record: of an earlier motion of this seed, which is reused. beyond: seconds from an edit after which its frames
      stay; 0: only where the result is the same. */
  generate({ timeline, seed, fast, record, beyond, clip }) {
    const files = { old: "/reuse.safetensors", fresh: "/record.safetensors" }, reuse = record && !clip;
    if (reuse) wasm.FS.writeFile(files.old, new Uint8Array(record));
    const motion = withText(timeline, (words) => withText(fast && !reuse && "ddim", (sampler) =>
      withText(!clip && files.fresh, (fresh) => withText(reuse && files.old, (old) =>
        withClip(clip, (keep, from, to, parts) => result((place) =>
          wasm._motionlang_wasm_generate(loaded, words, seed >>> 0, Math.floor(seed / 2 ** 32),
                                         sampler ? 10 : 0, sampler, fresh, old, reuse ? beyond : 0, keep, from, to,
                                         parts, place)))))));
    made.set(++count, motion);
    const [[oldest, pointer]] = made;
    if (made.size > 12) wasm._motionlang_free_motion(pointer), made.delete(oldest);
    return { motion: count, data: dataOf(motion), reuse: reuseOf(motion),
             record: clip ? null : wasm.FS.readFile(files.fresh).buffer };
  },
  /** A motion of a file, to be kept. */
  read({ id, name, bytes }) {
    const motions = withBytes(bytes, (at) => withText(name, (file) =>
      result((place) => wasm._motionlang_wasm_parse(at, bytes.byteLength, file, place))));
    try {
      const whole = wasm._motionlang_wasm_at(motions, 0), fps = wasm._motionlang_fps(whole);
      const data = dataOf(whole);
      read.set(id, result((place) => wasm._motionlang_cut_motion(whole, 0, data.frames / fps, 0, place)));
      return { seconds: data.frames / fps, notes: wasm.UTF8ToString(wasm._motionlang_motions_notes(motions)) };
    } finally {
      wasm._motionlang_free_motions(motions);
    }
  },
  /** Files to search, { path, bytes }, of which an index is made, or to which one is extended. */
  async index({ files }) {
    if (searches.packed) {
      wasm.FS.mkdirTree(searches.model);
      for (const [name, text] of Object.entries(searches.packed))
        wasm.FS.writeFile(`${searches.model}/${name}`, new Uint8Array(await unpacked(text)));
      searches.packed = null;
    }
    for (const { path, bytes } of files) {
      const parts = path.split("/").filter((part) => part && part !== "." && part !== "..");
      const file = searches.folder + parts.join("/");
      wasm.FS.mkdirTree(file.slice(0, file.lastIndexOf("/")));
      wasm.FS.writeFile(file, new Uint8Array(bytes));
    }
    withMemory(16, (at) => withText(searches.file, (file) => withText(searches.folder, (folder) =>
      withText(searches.model, (model) => {
        ask(wasm._motionlang_wasm_update_index(file, folder, model, at));
        [searches.clips, searches.skipped] = wasm.HEAPF64.subarray(at >> 3, (at >> 3) + 2);
      }))));
    wasm._motionlang_free_index(searches.index);
    searches.index = 0;
  },
  /** The moments of those files that are nearest to words. */
  search({ words, count: most }) {
    const { clips, skipped, file } = searches, answer = { moments: [], shows: true, unknown: [], clips, skipped };
    if (clips === 0) return answer;
    searches.index ||= withText(file, (name) => result((place) => wasm._motionlang_open_index(name, 0, 0, place)));
    wasm._motionlang_free_hits(searches.hits);
    searches.hits = 0;
    const hits = searches.hits = withText(words, (text) =>
      result((place) => wasm._motionlang_wasm_search(searches.index, text, most, place)));
    for (let number = 0; number < wasm._motionlang_wasm_hits_count(hits); ++number) {
      withMemory(32, (at) => {
        ask(wasm._motionlang_wasm_hit(hits, number, at, at + 24));
        const [start, end, score] = wasm.HEAPF64.subarray(at >> 3, (at >> 3) + 3);
        const [path, motion] = [24, 28].map((behind) => wasm.UTF8ToString(wasm.HEAP32[at + behind >> 2]));
        const name = path.slice(searches.folder.length) + (motion && ` (${motion})`);
        answer.moments.push({ number, name, start, end, score });
      });
    }
    answer.shows = wasm._motionlang_hits_shown(hits) === 1;
    answer.unknown = wasm.UTF8ToString(wasm._motionlang_hits_unknown_words(hits)).split(" ").filter(Boolean);
    return answer;
  },
  /** A moment as a file, with two seconds before and after it, and where it is in there. */
  moment: ({ motion: number }) => withMemory(32, (at) => {
    if (number >= wasm._motionlang_wasm_hits_count(searches.hits))
      throw new Error("this moment is gone; search again");
    ask(wasm._motionlang_wasm_hit(searches.hits, number, at, at + 24));
    const path = wasm.UTF8ToString(wasm.HEAP32[at + 24 >> 2]), stem = path.slice(path.lastIndexOf("/") + 1);
    const name = `${stem.replace(/\.[^.]*$/, "")}_${wasm.HEAPF64[at >> 3].toFixed(1)}s.glb`;
    const motion = result((place) => wasm._motionlang_wasm_hit_motion(searches.hits, number, 2, at, place));
    const [from, to] = wasm.HEAPF64.subarray(at >> 3, (at >> 3) + 2);
    try {
      const bytes = taken(withText(".glb", (kind) =>
        result((place) => wasm._motionlang_motion_bytes(motion, kind, place))));
      return { name, from, seconds: to - from, bytes };
    } finally {
      wasm._motionlang_free_motion(motion);
    }
  }),
  /** A motion on the character of a file. */
  show: ({ motion, name, bytes }) => takenJson(withBytes(bytes, (at) => withText(name, (file) => result((place) =>
    wasm._motionlang_wasm_viewer_data_on(known(made, motion), at, bytes.byteLength, file, place))))),
  save({ motion, format, character }) {
    if (!character || ![".glb", ".html"].includes(format))
      return taken(withText(format, (kind) =>
        result((place) => wasm._motionlang_motion_bytes(known(made, motion), kind, place))));
    const file = "/saved" + format, rig = "/character" + character.name.slice(character.name.lastIndexOf("."));
    wasm.FS.writeFile(rig, new Uint8Array(character.bytes));
    withMemory(4, (list) => withText(rig, (from) => withText(file, (to) => {
      wasm.HEAP32[list >> 2] = known(made, motion);
      ask(wasm._motionlang_wasm_write_on_character(list, from, to));
    })));
    return wasm.FS.readFile(file);
  } };

let turnOf = Promise.resolve();  // one request after the other
onmessage = ({ data }) => {
  turnOf = turnOf.then(async () => {
    try {
      doing = data.kind;
      postMessage({ id: data.id, value: await answers[data.kind](data.about) });
    } catch (reason) {
      postMessage({ id: data.id, error: String(reason && reason.message || reason) });
    }
  });
};
)page";

/// The project: timelines of texts with their times and parts, undo and redo, storage, links.
inline constexpr std::string_view studio_script_project = R"page(
const parts = ["left arm", "right arm", "legs", "spine", "head"];  // as motionlang_check_timeline names them
const rows = ["whole body", ...parts];
const shortest = 0.25, longest = 60;  // seconds of a text, of a project
const example = {
  id: 1,
  bars: [{ text: "walk forward", start: 0, end: 6, parts: ["legs"] },
         { text: "raise both arms", start: 2, end: 5, parts: ["left arm", "right arm"] }],
  seconds: 6, seed: 7, fast: false };
let zoom = 1, snapping = true, live = false, keeping = true;

// The timelines of the project, and the one that is edited. A bar with `clip` is a stretch of a motion to keep: it
// begins `from` seconds after the start of that motion.
let book = [structuredClone(example)], sheet = 0, project = book[0], chosen = 0;
const marked = new Set();  // bars that are chosen besides `chosen`
const past = [], future = [];
let lastId = 1;  // of the timelines that there were
let lastKey = null;  // the key of the latest edit: edits with the same key are undone together

const rounded = (seconds) => Math.round(1000 * seconds) / 1000;
/** Keeps times in their limits and in order. */
function tidied(p) {
  p.seconds = clamp(rounded(+p.seconds) || 0.5, 0.5, longest);
  p.seed = clamp(Math.floor(+p.seed) || 0, 0, Number.MAX_SAFE_INTEGER);
  for (const bar of p.bars) {
    bar.start = clamp(rounded(+bar.start) || 0, 0, rounded(p.seconds - shortest));
    bar.end = clamp(rounded(+bar.end) || 0, rounded(bar.start + shortest), p.seconds);
    if (bar.clip) bar.from = clamp(bar.from, 0, Math.max(bar.whole - shortest, 0));  // rounded ends lie beyond it
    bar.text = String(bar.text).replace(/[#\r\n]+/g, " ").slice(0, bounds.words);
    bar.parts = parts.filter((name) => bar.parts.includes(name));
    if (bar.parts.length === parts.length) bar.parts = [];  // all: the whole body
  }
  return p;
}
const snapshot = () => JSON.stringify({ book, sheet, chosen });
/** Changes the project by a function. A key joins it with the edit before, if that has the same key. */
function edit(change, key = null) {
  const old = snapshot();
  change(project);
  tidied(project);
  book[sheet] = project;
  if (snapshot() === old) return;
  if (book.length > bounds.timelines || project.bars.length > bounds.bars) {
    ({ book, sheet, chosen } = JSON.parse(old));
    project = book[sheet];
    marked.clear();
    return say(`A project has at most ${bounds.timelines} timelines, and each at most ${bounds.bars} texts.`, true);
  }
  if (key === null || key !== lastKey) past.push(old);
  lastKey = key;
  future.length = 0;
  edited();
}
function goBack(from, to) {
  if (from.length === 0) return;
  to.push(snapshot());
  ({ book, sheet, chosen } = JSON.parse(from.pop()));
  project = book[sheet];
  marked.clear();
  lastKey = unfinished = null;
  edited();
}
const undo = () => goBack(past, future), redo = () => goBack(future, past);
/** Goes to another timeline of the project. Undo does not come back from there. */
function turnTo(number) {
  sheet = clamp(number, 0, book.length - 1);
  project = book[sheet];
  chosen = project.bars.length ? 0 : -1;
  marked.clear();
  lastKey = unfinished = null;
  edited();
}

/** The timeline of a project as text, and for each line the number of its bar, or -1. Somebody stands where no text is
    at the start and at the end, because a timeline begins and ends with its texts. */
function timelineOf(p) {
  const lines = [], bars = [];
  const line = (words, start, end, names, bar) => {
    lines.push([words, rounded(start), rounded(end), ...names].join(" # "));
    bars.push(bar);
  };
  const told = p.bars.map((bar, i) => [bar, i]).filter(([bar]) => bar.text.trim() && !bar.clip);
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
const clipOf = (p) => p.bars.find((bar) => bar.clip);

const linkOf = (p) =>
  "#" + new URLSearchParams({ timeline: timelineOf(p).lines, seed: p.seed, ...(p.fast && { fast: 1 }) });
/** All that decides which motion a timeline has. */
const keyOf = (p) => linkOf(p) + (clipOf(p) ? JSON.stringify(clipOf(p)) : "");
const place = "motionlang studio";  // in the browser's storage
function store(leaving = false) {
  const link = linkOf(project), links = [link];
  if (leaving) links.push(location.hash);  // a reload comes with the address before the latest edit
  try {
    history.replaceState(null, "", link);
    localStorage.setItem(place, JSON.stringify({ ...wholeProject(), links, file: fileOfProject() }));
  } catch (reason) {
    console.info("the browser keeps no project:", reason.message);
  }
}
/** Takes the project of the last visit, and returns the links that it had. */
function restore() {
  try {
    const words = localStorage.getItem(place);
    if (!words) return [];
    try {
      const kept = JSON.parse(words), marks = { motionlang: "studio project", version: 1 };
      const { book: older, sheet: number, project: only } = kept;  // as earlier studios stored it
      const all = older || (only && [only]);
      const read = checkedProject(all ? { ...marks, timelines: all, shown: number } : kept);
      lastId = 0;
      takeProject(read);
      if (kept.file) ownFile(kept.file, idsOf(book));
      return kept.links || [kept.link];
    } catch (reason) {
      localStorage.setItem(place + ", not read", words);
      throw reason;
    }
  } catch (reason) {
    console.info("the browser has no project:", reason.message);
    return [];
  }
}

/** Large things in the browser's storage: records of motions, and files. Without a storage everything is only here. */
const shelf = {
  open() {
    return this.opened ||= new Promise((resolve, reject) => {
      const asked = indexedDB.open(place, 1);
      asked.onupgradeneeded = () => asked.result.createObjectStore("things");
      asked.onsuccess = () => resolve(asked.result);
      asked.onerror = () => reject(asked.error);
    });
  },
  async use(mode, call) {
    try {
      const things = (await this.open()).transaction("things", mode).objectStore("things");
      return await new Promise((resolve, reject) => {
        const asked = call(things);
        asked.onsuccess = () => resolve(asked.result);
        asked.onerror = () => reject(asked.error);
      });
    } catch (reason) {
      console.info("the browser keeps no files:", reason.message);
      return undefined;
    }
  },
  get(name) { return this.use("readonly", (things) => things.get(name)); },
  put(name, value) { return this.use("readwrite", (things) => things.put(value, name)); },
  async keep(names) {  // only these
    for (const name of await this.use("readonly", (things) => things.getAllKeys()) || [])
      if (!names.includes(name)) await this.use("readwrite", (things) => things.delete(name));
  } };
)page";

/// The worker's side in the page.
inline constexpr std::string_view studio_script_engine = R"page(
/** The worker in the page. */
class WorkerEngine {
  constructor(onprogress) {
    this.onprogress = onprogress;
    this.source = URL.createObjectURL(new Blob([page.program], { type: "text/javascript" }));
    this.start();
  }
  start() {
    this.waiting = new Map();
    this.count = 0;
    this.has = new Set();  // names of files that it read
    this.life = {};        // motions of another life are gone
    this.worker = new Worker(this.source);
    this.worker.onmessage = ({ data }) => {
      if (!("id" in data)) return this.onprogress(data);
      const asked = this.waiting.get(data.id);
      this.waiting.delete(data.id);
      if (asked) "error" in data ? asked.reject(new Error(data.error)) : asked.resolve(data.value);
    };
    this.worker.onerror = (event) => this.fail(new Error(event.message || "the worker did not start"));
    const packed = (id) => element(id).textContent;
    const search = { "config.json": "searchConfig", "weights.safetensors": "searchWeights" };
    this.searches = Object.values(search).every((id) => element(id));
    for (const name in search) if (this.searches) search[name] = packed(search[name]);
    this.ready = this.ask("load", { code: packed("code"), model: packed("model"), search: this.searches && search });
    this.ready.catch(() => {});  // whoever asks for something hears it
  }
  ask(kind, about = {}) {
    return new Promise((resolve, reject) => {
      const id = ++this.count;
      this.waiting.set(id, { resolve, reject });
      this.worker.postMessage({ id, kind, about });
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
/** Bytes as base64. */
const packed = (bytes) => {
  let out = "";
  const all = new Uint8Array(bytes);
  for (let i = 0; i < all.length; i += 0x8000) out += String.fromCharCode(...all.subarray(i, i + 0x8000));
  return btoa(out);
};
const unpackedBytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));

/** Words as a name of a file that every system and the program take. */
const plain = (words) => words.replace(/[^\w-]+/g, "_").slice(0, 80) || "_";
const plainFile = (name) => {
  const dot = name.lastIndexOf(".");
  return plain(name.slice(0, dot)) + name.slice(dot).toLowerCase();
};
/** The program motionlang, which sent this page. The link has a token after "#token=", which every question repeats. */
class ServerEngine {
  constructor(onprogress) {
    this.onprogress = onprogress;
    const [, token] = /^#token=([0-9a-f]+)/.exec(location.hash) || [];
    if (token) history.replaceState(null, "", location.pathname);
    try {
      if (token) sessionStorage.setItem("token", token);
      this.token = token || sessionStorage.getItem("token") || "";
    } catch (reason) {
      this.token = token || "";
    }
    const numbers = crypto.getRandomValues(new Uint8Array(16));
    this.client = Array.from(numbers, (n) => n.toString(16).padStart(2, "0")).join("");
    this.has = new Set();
    this.life = {};
    this.stop = new AbortController();
    this.ready = this.ask("load").then(({ folder, search, steps }) => {
      this.folder = folder;
      this.search = search;
      const list = element("steps"), [usual, fast] = list.options;
      usual.text = "as the model asks";
      fast.disabled = steps < 10;
      list.parentNode.hidden = !steps;
    });
    this.ready.catch(() => {});
  }
  async ask(kind, about = {}) {
    const { signal } = this.stop;
    const inText = (key, value) => value instanceof ArrayBuffer || value instanceof Uint8Array ? packed(value)
      : value?.bytes && value.name ? { ...value, name: plainFile(value.name) } : value;
    try {
      const response = await fetch("ask", {
        method: "POST", signal, headers: { "Content-Type": "application/json", "X-Motionlang-Token": this.token },
        body: JSON.stringify({ ...about, kind, client: this.client }, inText) });
      if (!response.ok) throw new Error(await response.text());
      const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
      let text = "";
      for (;;) {
        const { done, value } = await reader.read();
        if (done) throw new Error("the program ended its answer");
        text += value;
        for (let end; (end = text.indexOf("\n")) >= 0; text = text.slice(end + 1)) {
          const line = JSON.parse(text.slice(0, end));
          if ("error" in line) throw new Error(line.error);
          if ("value" in line) return kind === "save" && !about.id ? unpackedBytes(line.value) : line.value;
          if ("done" in line) this.onprogress({ ...line, kind });
        }
      }
    } catch (reason) {
      if (signal.aborted) throw Object.assign(new Error("cancelled"), { cancelled: true });
      throw reason instanceof TypeError ? new Error("the program motionlang does not answer") : reason;
    }
  }
  /** The program sees that nobody listens, and stops. What it made stays. */
  cancel() {
    this.stop.abort();
    this.stop = new AbortController();
  }
}
const Engine = page.program ? WorkerEngine : ServerEngine;
)page";

/// How the project looks: bars, fields, warnings.
inline constexpr std::string_view studio_script_look = R"page(
let making = null;  // what is generated now: { began }
let motions = 0, warned = [];  // number of motions so far, warnings
let opened = 0, took = 0;  // seconds from opening to the first motion, and of the latest one
const bar = () => project.bars[chosen];
/** The numbers of the bars that are chosen, in their order. */
const selected = () => [...new Set([...marked, chosen])].filter((i) => project.bars[i]).sort((a, b) => a - b);
const number = (id) => +element(id).value;
const nameOf = (b) => b.parts.length ? b.parts.join(", ") : "whole body";

function say(words, wrong = false) {
  element("status").textContent = words;
  element("status").classList.toggle("wrong", wrong);
}
const engine = new Engine(({ done, total, kind }) => {
  if (kind === "search" || kind === "index") return showIndexed(done, total);
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
  const drawn = new Set(), on = selected();  // a bar of several rows is reached by the keyboard once
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
      e.classList.toggle("chosen", on.includes(i));
      e.classList.toggle("warned", warnings.length > 0 || !b.text.trim());
      e.classList.toggle("clip", !!b.clip);
      e.dataset.bar = i;
      text("span", words, e);
      for (const side of ["from", "to"]) text("i", "", e).className = "grip " + side;
      Object.assign(e.style, { left: 100 * b.start / project.seconds + "%", top: 2 + 27 * lineOf.get(i) + "px",
                               width: 100 * (b.end - b.start) / project.seconds + "%" });
      e.style.setProperty("--hue", hues[i % hues.length]);
      e.title = [`${b.clip ? "Kept: " : ""}${words}: ${shown(b.start)} to ${shown(b.end)}, ${nameOf(b)}`, ...warnings]
        .join("\n");
      if (drawn.has(i)) {
        e.setAttribute("aria-hidden", "true");
        continue;
      }
      drawn.add(i);
      e.tabIndex = 0;
      e.setAttribute("role", "button");
      e.setAttribute("aria-pressed", on.includes(i));
      e.setAttribute("aria-label", e.title);
      e.setAttribute("aria-describedby", "help");
      if (held && i === chosen) e.focus({ preventScroll: true });
    }
  }
  element("wide").style.width = 100 * zoom + "%";
  drawCurves();
  drawAxis(element("axis"), project.seconds, 12 * zoom);
}
let unfinished = null;  // the field in which a person writes a number
function fill(id, value) {
  const field = element(id);
  if (field !== unfinished && field.value !== String(value)) field.value = value;
}
const press = (id, action) => element(id).addEventListener("click", action);
const showPressed = (id, on) => element(id).setAttribute("aria-pressed", on);
function drawFields() {
  const b = bar(), count = selected().length;
  element("chosen").hidden = !b;
  element("nothing").hidden = !!b;
  element("aboutText").textContent = count > 1 ? `${count} texts` : b?.clip ? "Kept motion" : "Text";
  for (const id of ["duplicate", "remove", "split"]) element(id).disabled = !b;
  if (b) {
    element("words").disabled = !!b.clip;
    fill("words", b.text);
    fill("from", b.start);
    fill("to", b.end);
    for (const box of document.querySelectorAll("#parts input"))
      box.checked = b.parts.length === 0 || b.parts.includes(box.value);
    const usual = b.clip ? null : lengths.get(b.text.trim());
    element("usual").hidden = !usual || Math.abs(b.end - b.start - usual) < 0.01;
    element("usual").textContent = `Usual length, ${usual} s`;
  }
  fill("length", project.seconds);
  fill("seed", project.seed);
  element("steps").value = project.fast ? "fast" : "usual";
  const sheets = element("sheet");
  sheets.replaceChildren(...book.map((p, i) =>
    new Option(`${i + 1}: ${p.bars.find((one) => one.text.trim())?.text.trim() || "empty"}`, i)));
  sheets.value = sheet;
  element("drop").disabled = book.length < 2;
  element("undo").disabled = past.length === 0;
  element("redo").disabled = future.length === 0;
  showPressed("snap", snapping);
  showPressed("live", live);
  showPressed("keep", keeping);
  element("whole").disabled = element("generate").disabled = element("vary").disabled = making !== null;
  element("cancel").hidden = element("progress").hidden = making === null;
  element("left").textContent = making ? element("left").textContent
    : shownTake && isStale() ? "The timeline has changed." : "";
  element("save").disabled = !shownTake;
  element("plain").hidden = !character;
  const file = engine.folder && fileOfProject(), where = file ? `Save all timelines and settings to ${file.name}` : "";
  element("saveProject").title = where || "All timelines and settings in one file";
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
  drawTakes();
  refresh();
}
let checking = 0, beginning = 0;
function edited() {
  draw();
  clearTimeout(checking);
  checking = setTimeout(() => {
    store();
    showKnownTake();
    check();
  }, 250);
  clearTimeout(beginning);
  if (live) beginning = setTimeout(() => { if (isStale()) generate(); }, 600);
}
addEventListener("pagehide", () => {
  clearTimeout(checking);
  store(true);
});
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
function setZoom(factor) {
  zoom = clamp(factor, 1, 16);
  drawBars();
  const scroller = element("scroller");
  scroller.scrollLeft = time / project.seconds * scroller.scrollWidth - scroller.clientWidth / 2;
}
function showMoment() {
  const at = Math.min(time, project.seconds) / project.seconds, scroller = element("scroller");
  element("cursor").style.left = 100 * at + "%";
  if (zoom > 1 && playing) {
    const x = at * scroller.scrollWidth - scroller.scrollLeft;
    if (x < 0 || x > scroller.clientWidth) scroller.scrollLeft += x - 0.1 * scroller.clientWidth;
  }
  const now = project.bars.filter((b) => b.start <= time && time < b.end && shownTake);
  const words = now.map((b) => b.text.trim()).filter(Boolean).join(" \u00b7 ");
  if (element("says").textContent !== words) element("says").textContent = words;
  for (const e of document.querySelectorAll(".bar"))
    e.classList.toggle("now", now.includes(project.bars[e.dataset.bar]));
  for (const take of takes) take.draw?.();
}
)page";

/// Motions: generation, what is kept of them, variations, the character.
inline constexpr std::string_view studio_script_takes = R"page(
// ---- Motions: one for each seed that was tried. A take has the seed, the key of its project, what the page draws, and
// the record by which an edit reuses it.

let takes = [], shownTake = null, character = null, takeCount = 0;
Object.assign(text("div", "", element("stage")), { id: "takes", role: "group", ariaLabel: "Variations", hidden: true });
const takesOf = new Map();  // those of the timelines that are not edited now, by their ids
let takesId = 1;
const clips = new Map();  // files with motions to keep, by name: { name, bytes, seconds }
const isStale = () => !shownTake || shownTake.key !== keyOf(project);
const beyondEdit = 1;  // seconds from an edit after which a motion stays

/** Shows a take, on the character if there is one. */
async function show(take) {
  shownTake = take;
  let body = null, data = take.data;
  if (character) {
    try {
      ({ motion: data, body } = await engine.ask("show", { motion: await held(take), ...character }));
    } catch (reason) {
      say(`${character.name}: ${reason.message}`, true);
      character = null;
    }
    if (shownTake !== take) return;
  }
  if (renderer.makeMesh) body ? renderer.makeMesh(new Mesh(body)) : renderer.mesh = null;
  const first = clip.frames === 1 || clip.parents.length !== data.parents.length;
  showClip(new Clip(data));
  if (first) camera.reset(clip);
  seek(Math.min(time, clip.seconds));
  draw();
}
/** The number of a take's motion in the engine, which makes it again from its record if it is gone. */
async function held(take) {
  if (take.life !== engine.life) {
    const life = engine.life, { motion } = await engine.ask("generate", await orderOf(take.project, take, 0));
    Object.assign(take, { life, motion });
  }
  return take.motion;
}
/** What the engine needs to make a motion of a project. from: a take that is reused. */
async function orderOf(p, from, beyond) {
  const kept = clipOf(p), { seed, fast } = p;
  let stretch = null;
  if (kept) {
    const file = clips.get(kept.clip) || await shelf.get(kept.clip);
    if (!file) throw new Error(`Drop ${nameOfClip(kept.clip)} on the page again: this timeline keeps its motion.`);
    clips.set(kept.clip, file);
    if (!engine.has.has(kept.clip)) await engine.ask("read", { id: kept.clip, name: file.name, bytes: file.bytes });
    engine.has.add(kept.clip);
    stretch = { id: kept.clip, from: kept.from, start: kept.start, end: kept.end, parts: kept.parts.join(", ") };
  }
  return { timeline: timelineOf(p).lines, seed, fast, record: from && from.record, beyond, clip: stretch };
}
/** A take of a project. Reuses one of the same seed and steps: where an edit is near, or where it changes nothing. */
async function makeTake(p, whole) {
  const reusable = (t) => t.record && t.seed === p.seed && t.project.fast === p.fast && t.project.id === p.id;
  let old = whole ? null : [shownTake, ...takes, ...spare].filter(Boolean).find(reusable);
  if (old && !keeping && !old.exact) old = null;  // its frames differ from those of a whole motion
  const life = engine.life;
  const made = async () =>
    engine.ask("generate", await orderOf(p, old, old && keeping && old.key !== keyOf(p) ? beyondEdit : 0));
  const { motion, data, reuse, record } = await made().catch((reason) => {
    if (!old || !/ is gone$/.test(reason.message)) throw reason;
    old = null;  // a server forgets the oldest
    return made();
  });
  return { number: ++takeCount, seed: p.seed, key: keyOf(p), project: structuredClone(p), data, record, reuse, life,
           motion, locked: false, exact: reuse ? reuse.exact && old.exact : true };
}
let spare = [];  // takes of other timelines and seeds, the newest first, for those who come back
function put(take) {
  const locks = wanted.get(take.project.id) || [];
  if (locks.includes(take.seed)) {
    take.locked = true;
    wanted.set(take.project.id, locks.filter((seed) => seed !== take.seed));
  }
  const at = takes.findIndex((t) => t.seed === take.seed && !t.locked);
  if (at >= 0) spare.unshift(takes[at]), takes[at] = take;
  else if (takes.length < 4) takes.push(take);
  else {
    const free = takes.findIndex((t) => !t.locked && t !== shownTake);
    if (free < 0) spare.unshift(take);
    else spare.unshift(takes[free]), takes[free] = take;
  }
  spare.length = Math.min(spare.length, 6);
}
/** Does work that makes motions, with its progress, and says how it ended. */
async function work(words, task) {
  if (making) return;
  making = { began: performance.now() };
  element("progress").value = 0;
  element("left").textContent = "";
  say(words);
  draw();
  try {
    say(await task());
  } catch (reason) {
    say(reason.cancelled ? "Cancelled." : reason.message, !reason.cancelled);
  }
  making = null;
  draw();
  if (live && isStale() && !element("status").classList.contains("wrong")) edited();
}
const generate = (whole = false) => work("Generating.", async () => {
  const began = performance.now(), first = motions === 0, asked = structuredClone(project);
  turnTakes();
  const take = await makeTake(asked, whole);
  put(take);
  ++motions;
  await show(take);
  if (first) play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
  took = (performance.now() - began) / 1000;
  opened ||= performance.now() / 1000;
  shelve();
  const { frames } = take.data, { reuse } = take;
  return `${frames} frames in ${took.toFixed(1)} s, seed ${take.seed}.` +
    (reuse ? ` ${reuse.kept} frames stayed; ${Math.round(100 * reuse.work)} % of the work.` : "");
});
/** Three motions beside the shown one, with other seeds. Locked ones stay. */
const vary = () => work("Making variations.", async () => {
  const base = structuredClone(project);
  let seed = base.seed, made = 0;
  const kept = takes.filter((t) => t.locked || t === shownTake);
  spare.unshift(...takes.filter((t) => !kept.includes(t)));
  takes = kept;
  const isNew = (s) => takes.every((t) => t.seed !== s);
  while (takes.length < 4) {
    let next = (wanted.get(base.id) || []).find(isNew);  // locked when the project was saved
    if (next === undefined) {
      do seed = seed < Number.MAX_SAFE_INTEGER ? seed + 1 : 0; while (!isNew(seed));
      next = seed;
    }
    making.began = performance.now();
    put(await makeTake({ ...base, seed: next }, false));
    ++motions;
    say(`${++made} made.`);
    drawTakes();
    refresh();
  }
  return `${takes.length} variations. Choose one with its picture.`;
});
/** Stores what the next visit needs to have the same motions. */
async function shelve() {
  const names = [...new Set(book.flatMap((p) => [keyOf(p), clipOf(p)?.clip]).filter(Boolean))];
  const { key, record, exact, project: of } = shownTake;
  if (record instanceof ArrayBuffer) await shelf.put(key, { record, exact, project: of });
  const there = await shelf.use("readonly", (things) => things.getAllKeys()) || [];
  for (const name of names) if (clips.has(name) && !there.includes(name)) await shelf.put(name, clips.get(name));
  await shelf.keep(names);
}
/** The takes become those of the timeline that is edited. Returns whether it was another one. */
function turnTakes() {
  if (takesId === project.id) return false;
  takesOf.set(takesId, takes);
  takes = takesOf.get(takesId = project.id) || [];
  return true;
}
/** After an undo or on another timeline: the take that was made of it, if it is still here. */
function showKnownTake() {
  const other = turnTakes();
  if (making) return;
  const key = keyOf(project), take = [...takes, ...spare].find((t) => t.key === key && t.data);
  if (take && take !== shownTake) show(take);
  else if (!take && other) generate();
}

const takeCamera = new Camera();
function drawTakes() {
  const list = element("takes");
  list.hidden = takes.length < 2;
  const numbers = takes.map((t) => t.number).join();
  if (list.hidden || list.dataset.numbers === numbers) return markTakes();
  list.dataset.numbers = numbers;
  list.replaceChildren();
  takes.forEach((take, i) => {
    const box = text("div", "", list), button = text("button", "", box), canvas = document.createElement("canvas");
    const motion = new Clip(take.data), lock = text("button", "Lock", box);
    button.type = lock.type = "button";
    button.append(canvas);
    text("span", `Seed ${take.seed}`, button);
    button.title = `Variation ${i + 1}, key ${i + 1}`;
    let painter = null;
    take.draw = () => {
      const width = canvas.clientWidth, height = canvas.clientHeight, pose = motion.pose(time);
      if (!width) return;
      if (canvas.width !== width) Object.assign(canvas, { width, height });
      painter ||= new FlatRenderer(canvas);
      Object.assign(takeCamera, { yaw: camera.yaw, pitch: camera.pitch, distance: 2.6 * motion.size,
                                  shift: [0, 0, 0] });
      const root = pose.positions[0];
      takeCamera.goal = [root[0], motion.floor + 0.52 * motion.size, root[2]];
      const palette = palettes[dark.matches ? "dark" : "light"];
      const shapes = motion.shapes(pose);
      painter.draw({ shapes, pose, camera: takeCamera, palette, clip: motion, root, width, height });
    };
    button.addEventListener("click", () => chooseTake(take));
    lock.addEventListener("click", () => lockTake(take));
  });
  markTakes();
}
function markTakes() {
  [...element("takes").children].forEach((box, i) => {
    const take = takes[i], [button, lock] = box.children;
    if (!take) return;
    button.setAttribute("aria-pressed", take === shownTake);
    button.setAttribute("aria-label", `Variation ${i + 1}, seed ${take.seed}` + (take.locked ? ", locked" : ""));
    box.classList.toggle("old", keyOf({ ...project, seed: take.seed }) !== take.key);
    lock.textContent = take.locked ? "Locked" : "Lock";
    lock.setAttribute("aria-pressed", take.locked);
    lock.setAttribute("aria-label", `Lock variation ${i + 1}`);
  });
}
function lockTake(take) {
  if (!take) return;
  take.locked = !take.locked;
  draw();
}
function chooseTake(take) {
  if (!take) return;
  if (take.seed !== project.seed) edit((p) => { p.seed = take.seed; });
  show(take);
}
)page";

/// Aids to look at a motion: parts coloured by their texts, path and footprints, other moments, curves.
inline constexpr std::string_view studio_script_aids = R"page(
const aids = { colours: false, path: false, onion: false, curves: false };
{
  const list = text("div", "", element("stage"));
  Object.assign(list, { id: "aids", role: "group", ariaLabel: "What is shown" });
  for (const [name, label] of [["colours", "Colours of texts"], ["path", "Path and feet"], ["onion", "Other moments"],
                               ["curves", "Curves"]]) {
    const button = Object.assign(text("button", label, list), { id: name, type: "button" });
    button.setAttribute("aria-pressed", false);
    toggle(name, (on) => {
      aids[name] = on;
      element("graph").hidden = !aids.curves;
      drawCurves();
    });
  }
}
const onSmpl = () => clip.parents.length === 24 && !renderer.mesh;
/** The body parts of SMPL's 24 joints. */
const partOf = ["legs", "legs", "legs", "spine", "legs", "legs", "spine", "legs", "legs", "spine", "legs", "legs",
                "head", "left arm", "right arm", "head", "left arm", "right arm", "left arm", "right arm", "left arm",
                "right arm", "left arm", "right arm"];
const colourOf = (hue) => [1, 3, 5].map((at) => parseInt(hue.slice(at, at + 2), 16) / 255);
/** The bar that moves a part at a time: one for fewer parts goes before one for more. */
function barOf(part, seconds) {
  let found = -1, least = 9;
  project.bars.forEach((b, i) => {
    const count = b.parts.length || 6;
    if (b.start <= seconds && seconds < b.end && (count === 6 || b.parts.includes(part)) && count <= least)
      [found, least] = [i, count];
  });
  return found;
}
/** Frames in which the feet stand: for each frame the joints of the toes that are low and slow. */
function standing(motion) {
  if (motion.standing) return motion.standing;
  const out = [], low = 0.055 * motion.size, slow = 0.3;
  let before = null;
  for (let f = 0; f < motion.frames; ++f) {
    const { positions } = motion.pose(f / motion.fps);
    out.push([10, 11].filter((toe) => before && positions[toe][1] - motion.floor < low &&
      Math.hypot(...sub(positions[toe], before[toe])) * motion.fps < slow)
      .map((toe) => [toe, [positions[toe][0], motion.floor, positions[toe][2]]]));
    before = positions;
  }
  return motion.standing = out;
}
let cones = 0, tints = 0;  // that are drawn; different colours that texts gave
decorate = (shapes, palette) => {
  cones = shapes.length, tints = 0;
  if (!onSmpl()) return;
  const faint = (colour, share) => colour.map((x, i) => mix(x, palette.back[i], share)), size = clip.size;
  if (aids.colours) {
    for (const s of shapes) {
      const i = barOf(partOf[s.joint], time);
      s.colour = i < 0 ? palette.sides[0] : colourOf(hues[i % hues.length]);
    }
    tints = new Set(shapes.map((s) => String(s.colour))).size;
  }

  if (aids.onion) {
    for (const way of [-1, -0.5, 0.5, 1]) {
      const at = time + way;
      if (at < 0 || at > clip.seconds) continue;
      for (const s of clip.shapes(clip.pose(at)))
        shapes.push({ ...s, colour: faint(palette.sides[s.side], 0.5 + 0.3 * Math.abs(way)) });
    }
  }
  if (aids.path) {
    const every = Math.max(1, Math.round(clip.frames / 200)), colour = colourOf("#2676ba");
    const flat = (f) => [clip.roots[3 * f], clip.floor, clip.roots[3 * f + 2]];
    for (let f = 0; f + every < clip.frames; f += every) {
      const radius = 0.006 * size;
      shapes.push({ from: flat(f), to: flat(f + every), radiusFrom: radius, radiusTo: radius, side: 0, colour });
    }
    const all = standing(clip), now = Math.round(time * clip.fps);
    all.forEach((feet, f) => {
      for (const [toe, place] of feet) {
        const again = f > 0 && all[f - 1].some(([other]) => other === toe);
        if (again && f !== now) continue;  // where it begins to stand, and now
        const radius = (f === now ? 0.03 : 0.014) * size, tint = palette.sides[toe === 10 ? 2 : 1];
        shapes.push({ from: place, to: place, radiusFrom: radius, radiusTo: radius, side: 0, colour: tint });
      }
    });
  }

  cones = shapes.length;
};
/** Speed over the floor and height of the pelvis, as lines above the texts. */
function drawCurves() {
  const canvas = element("graph");
  if (canvas.hidden || !clip) return;
  const ratio = devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight, { fps, frames } = clip;
  Object.assign(canvas, { width: width * ratio, height: height * ratio });
  const context = canvas.getContext("2d"), heights = [], speeds = [];
  for (let f = 0; f < frames; ++f) {
    const [x, y, z] = clip.rootAt(f), [a, , c] = clip.rootAt(Math.max(f - 1, 0));
    heights.push(y - clip.floor);
    speeds.push(f ? Math.hypot(x - a, z - c) * fps : 0);
  }
  speeds[0] = speeds[1] || 0;
  context.scale(ratio, ratio);
  context.lineWidth = 1.5;
  context.font = "11px system-ui";
  [[heights, hues[0], "height", "m"], [speeds, hues[1], "speed", "m/s"]].forEach(([values, hue, name, unit], i) => {
    const most = Math.max(...values, 0.1);
    context.strokeStyle = hue;
    context.fillStyle = getComputedStyle(canvas).color;
    context.beginPath();
    values.forEach((v, f) =>
      context.lineTo(width * f / fps / project.seconds, height - 3 - (height - 16) * v / most));
    context.moveTo(4 + 170 * i, 7);
    context.lineTo(18 + 170 * i, 7);
    context.stroke();
    context.fillText(`${name}, at most ${most.toFixed(1)} ${unit}`, 22 + 170 * i, 11);
  });
}
)page";

/// Edits by mouse, keys and fields.
inline constexpr std::string_view studio_script_edits = R"page(
// ---- Edits.

const lengths = new Map();  // seconds that the actions of known texts take, if they end
function choose(i, also = false) {
  if (also) marked.has(i) ? marked.delete(i) : marked.add(i).add(chosen);
  else if (i === chosen && marked.size === 0) return;
  else if (!selected().includes(i)) marked.clear();
  chosen = i;
  lastKey = null;
  draw();
}
function chooseAll() {
  project.bars.forEach((b, i) => marked.add(i));
  draw();
}
function chooseOne() {
  marked.clear();
  draw();
}
function addBar(row, from) {
  edit((p) => {
    const start = Math.min(from, p.seconds - shortest);
    const added = { text: "stand still", start, end: Math.min(start + 2, p.seconds), parts: [] };
    setParts(added, row);
    marked.clear();
    chosen = p.bars.push(added) - 1;
  });
  element("words").focus();
  element("words").select();
}
/** A text behind the chosen bar, of the same body parts; without one, at the cursor. The timeline becomes longer if it
    has to. */
function addNext() {
  const last = bar();
  if (!last || last.end + shortest > longest) return addBar(rows[0], time);
  edit((p) => {
    const start = last.end, end = Math.min(start + 2, longest);
    p.seconds = Math.max(p.seconds, end);
    marked.clear();
    chosen = p.bars.push({ text: "stand still", start, end, parts: [...last.parts] }) - 1;
  });
  seek(last.end);
  element("words").focus();
  element("words").select();
}
function removeBars() {
  if (!bar()) return;
  edit((p) => {
    const gone = selected();
    p.bars = p.bars.filter((b, i) => !gone.includes(i));
    marked.clear();
    chosen = Math.min(chosen, p.bars.length - 1);
  });
}
/** Copies of the chosen bars, behind them, as a group. */
function duplicateBars() {
  if (!bar()) return;
  edit((p) => {
    const copies = selected().map((i) => p.bars[i]).filter((b) => !b.clip).map((b) => structuredClone(b));
    if (copies.length === 0) return;
    const first = Math.min(...copies.map((b) => b.start)), last = Math.max(...copies.map((b) => b.end));
    const way = Math.min(last - first, p.seconds - last);
    for (const copy of copies) copy.start += way, copy.end += way;
    marked.clear();
    const at = chosen + 1;
    p.bars.splice(at, 0, ...copies);
    copies.forEach((copy, i) => marked.add(at + i));
    chosen = at;
  });
}
/** Splits the chosen bars at the cursor, or in the middle if it is not in them. */
function splitBars() {
  edit((p) => {
    const old = selected();
    marked.clear();
    const all = p.bars.flatMap((b, i) => {
      const inside = b.start + shortest <= time && time <= b.end - shortest;
      const at = inside ? Math.round(20 * time) / 20 : rounded((b.start + b.end) / 2);
      if (!old.includes(i) || b.clip || at - b.start < shortest || b.end - at < shortest) return [b];
      return [{ ...b, end: at }, { ...structuredClone(b), start: at }];
    });
    p.bars = all;
  });
}
/** Moves bars without changing their lengths. */
function moveAll(bars, way) {
  const first = Math.min(...bars.map((b) => b.start)), last = Math.max(...bars.map((b) => b.end));
  const kept = clamp(rounded(way), -first, project.seconds - last);
  for (const b of bars) b.start += kept, b.end += kept;
}
/** A time near an edge of another bar, near the cursor or near the ends is that time; else a frame's. */
function snapped(seconds, own) {
  const grid = Math.round(20 * seconds) / 20;
  if (!snapping) return grid;
  const reach = 7 * project.seconds / element("lanes").clientWidth;
  const edges = [0, project.seconds, time,
                 ...project.bars.flatMap((b, i) => own.includes(i) ? [] : [b.start, b.end])];
  const near = edges.sort((a, b) => Math.abs(a - seconds) - Math.abs(b - seconds))[0];
  return Math.abs(near - seconds) <= reach ? near : grid;
}
function setParts(b, row) { b.parts = row === rows[0] ? [] : [row]; }

const lanes = element("lanes");
lanes.addEventListener("pointerdown", (event) => {
  const e = event.target.closest(".bar");
  if (!e) return;
  event.preventDefault();
  const i = +e.dataset.bar, side = event.target.classList;
  const mode = side.contains("from") ? "from" : side.contains("to") ? "to" : "move", key = `drag ${performance.now()}`;
  const firstRow = e.parentElement.dataset.row;
  const gap = e.getBoundingClientRect().right - event.clientX;  // from the mouse to the end of the bar
  if (event.ctrlKey || event.metaKey || event.shiftKey) {
    choose(i, true);
    return;
  }
  choose(i);
  const group = mode === "move" ? selected() : [i], before = structuredClone(project.bars), from = before[i];
  lanes.querySelector(`[data-bar="${i}"][tabindex]`).focus({ preventScroll: true });
  lanes.setPointerCapture(event.pointerId);
  let dragged = false, latest = event;
  const drag = (moved) => {
    latest = moved;
    const way = (moved.clientX - event.clientX) * project.seconds / lanes.clientWidth;
    if (Math.hypot(moved.clientX - event.clientX, moved.clientY - event.clientY) < 4 && !dragged) return;
    dragged = true;
    const row = [...lanes.querySelectorAll(".lane")].find((lane) => {
      const place = lane.getBoundingClientRect();
      return place.top <= moved.clientY && moved.clientY < place.bottom;
    })?.dataset.row;
    edit((p) => {
      for (const n of group) p.bars[n] = structuredClone(before[n]);
      const b = p.bars[i];
      if (mode === "from") {
        b.start = clamp(snapped(from.start + way, group), b.clip ? from.start - from.from : 0, from.end - shortest);
        if (b.clip) b.from = from.from + b.start - from.start;
      }
      if (mode === "to") {
        const area = lanes.getBoundingClientRect(), at = (moved.clientX + gap - area.left) / area.width * p.seconds;
        b.end = Math.max(snapped(at, group), from.start + shortest);
      }
      if (b.clip) b.end = Math.min(b.end, b.start + b.whole - b.from);
      if (mode !== "move") return;
      const start = snapped(from.start + way, group), end = snapped(from.end + way, group);
      const plain = Math.round(20 * (from.start + way)) / 20;  // the end snaps if the start does not
      const byStart = Math.abs(start - plain) > 1e-9 || Math.abs(end - (plain + from.end - from.start)) < 1e-9;
      moveAll(group.map((n) => p.bars[n]), byStart ? start - from.start : end - from.end);
      if (row && row !== firstRow && group.length === 1) setParts(b, row);
    }, key);
  };
  /** An end that is held beyond the right edge makes the timeline longer. */
  const growth = setInterval(() => {
    if (mode !== "to" || !dragged || latest.clientX + gap < lanes.getBoundingClientRect().right + 4) return;
    edit((p) => {
      const b = p.bars[i];
      if (b.clip && b.end + 0.1 > b.start + b.whole - b.from) return;
      p.seconds = Math.max(p.seconds, Math.min(b.end + 0.1, longest));
      b.end = Math.min(b.end + 0.1, longest);
    }, key);
  }, 50);
  const stop = () => {
    clearInterval(growth);
    lanes.removeEventListener("pointermove", drag);
    if (!dragged && marked.size) chooseOne();
    lastKey = null;
  };
  lanes.addEventListener("pointermove", drag);
  for (const end of ["pointerup", "pointercancel"]) lanes.addEventListener(end, stop, { once: true });
});
lanes.addEventListener("mousedown", (event) => {  // the focus stays where pointerdown put it
  if (event.target.closest(".bar")) event.preventDefault();
});
lanes.addEventListener("click", (event) => {
  if (event.target.closest(".lane") && !event.target.closest(".bar")) marked.clear(), choose(-1);
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
  if (!e || +e.dataset.bar === chosen) return;
  const kept = [...marked];
  choose(+e.dataset.bar);
  for (const i of kept) marked.add(i);
  if (kept.length) draw();
});
lanes.addEventListener("keydown", (event) => {
  const e = event.target.closest(".bar");
  if (!e || event.altKey || event.metaKey) return;
  const i = +e.dataset.bar, way = { ArrowLeft: -0.1, ArrowRight: 0.1 }[event.key];
  const turnRow = { ArrowUp: -1, ArrowDown: 1 }[event.key];
  const actions = { Delete: removeBars, Backspace: removeBars, Enter: () => element("words").focus(), x: splitBars,
                    s: () => { marked.has(i) ? marked.delete(i) : marked.add(i); draw(); } };
  if (way) {
    edit((p) => {
      const b = p.bars[i];
      if (event.shiftKey) {
        b.end = Math.max(b.end + way, b.start + shortest);
        p.seconds = Math.max(p.seconds, Math.min(b.end, longest));
        if (b.clip) b.end = Math.min(b.end, b.start + b.whole - b.from);
      } else if (event.ctrlKey) {
        const start = Math.min(Math.max(b.start + way, b.clip ? b.start - b.from : 0), b.end - shortest);
        if (b.clip) b.from += start - b.start;
        b.start = start;
      } else {
        moveAll(selected().map((n) => p.bars[n]), way);
      }
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

// ---- The words, with what the model knows.

/** Offers texts that the model knows, before those that came with the page. */
let offering = 0;
function offerTexts() {
  clearTimeout(offering);
  offering = setTimeout(async () => {
    const begun = element("words").value;
    let found = [];
    try {
      if (!making) found = await engine.ask("known", { begun, count: 12 });
    } catch (reason) {
      if (!reason.cancelled) console.info("no texts to offer:", reason.message);
    }
    for (const { text: words, seconds, repeats } of found) if (!repeats) lengths.set(words, rounded(seconds));
    const texts = new Set([...found.map((t) => t.text), ...page.prompts.map((t) => t.text)]);
    element("prompts").replaceChildren(...[...texts].map((words) => new Option(words, words)));
    drawFields();
  }, 120);
}
for (const { text: words } of page.prompts) element("prompts").append(new Option(words, words));
element("words").addEventListener("input", (event) => {
  edit(() => { bar().text = event.target.value; }, "words");
  offerTexts();
});
element("words").addEventListener("focus", offerTexts);
element("words").addEventListener("keydown", (event) => {
  if (event.key === "Enter" && !event.ctrlKey) generate();
});
element("words").addEventListener("change", () => { lastKey = null; });
press("usual", () => edit((p) => {
  const b = bar(), end = b.start + lengths.get(b.text.trim());
  p.seconds = Math.max(p.seconds, Math.min(end, longest));
  b.end = end;
}));
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
field("from", () => {
  const b = bar(), start = Math.min(Math.max(number("from"), b.clip ? b.start - b.from : 0), b.end - shortest);
  if (b.clip) b.from += start - b.start;
  b.start = start;
});
field("to", (p) => {
  const b = bar();
  b.end = Math.max(number("to"), b.start + shortest);
  if (b.clip) b.end = Math.min(b.end, b.start + b.whole - b.from);
  p.seconds = Math.max(p.seconds, Math.min(b.end, longest));
});
field("length", (p) => { p.seconds = number("length"); });
field("seed", (p) => { p.seed = number("seed"); });
element("steps").addEventListener("change", (event) => edit((p) => { p.fast = event.target.value === "fast"; }));
for (const name of parts) {
  const label = text("label", "", element("parts")), box = document.createElement("input");
  Object.assign(box, { type: "checkbox", value: name });
  label.append(box, name);
  box.addEventListener("change", () => {
    const on = [...document.querySelectorAll("#parts input:checked")].map((e) => e.value);
    if (on.length) edit((p) => { for (const i of selected()) p.bars[i].parts = on; });
    draw();  // a text moves at least one part
  });
}

press("undo", undo);
press("redo", redo);
press("duplicate", duplicateBars);
press("remove", removeBars);
press("split", splitBars);
press("add", addNext);
press("generate", () => generate());
press("whole", () => generate(true));
press("vary", vary);
press("cancel", () => {
  if (making?.cancel) return making.cancel();
  engine.cancel();
  check();
});
press("dice", () => { edit((p) => { ++p.seed; }); generate(); });
press("snap", () => { snapping = !snapping; drawFields(); });
press("keep", () => { keeping = !keeping; drawFields(); });
press("live", () => {
  live = !live;
  drawFields();
  if (live && isStale()) generate();
});
press("zoomIn", () => setZoom(2 * zoom));
press("zoomOut", () => setZoom(zoom / 2));
/** Another timeline in the project. */
function addSheet(made) {
  edit((p) => {
    book.push(tidied({ ...made, id: ++lastId }));
    sheet = book.length - 1;
    project = book[sheet];
    marked.clear();
    chosen = 0;
  });
}
press("fresh", () => addSheet({
  bars: [{ text: "walk forward", start: 0, end: 4, parts: [] }], seconds: 4, seed: project.seed, fast: project.fast }));
press("drop", () => {
  if (book.length > 1) edit(() => {
    book.splice(sheet, 1);
    sheet = Math.min(sheet, book.length - 1);
    project = book[sheet];
    marked.clear();
    chosen = 0;
  });
});
element("sheet").addEventListener("change", (event) => turnTo(+event.target.value));
)page";

/// Files, links, keys, and the start.
inline constexpr std::string_view studio_script_files = R"page(
// ---- Files.

function offer(name, bytes, type) {
  const link = document.createElement("a"), address = URL.createObjectURL(new Blob([bytes], { type }));
  Object.assign(link, { href: address, download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}
function fileName() {
  return plain(project.bars.map((b) => b.text.trim()).filter(Boolean)[0] || "motion");
}
/** A file in the project's folder of the server, or among the person's downloads. */
async function keepFile(name, bytes, type) {
  if (!engine.folder) return offer(name, bytes, type);
  await engine.ask("store", { name, bytes });
  await listFolder();
  say(`${name} is in the project's folder.`);
}
press("save", async () => {
  const format = element("kind").value;
  if (making) return say("Wait until the motion is made, then save.");
  if (format === ".webm") return saveVideo();
  if (format === ".gif") return saveGif();
  try {
    if (format === ".png") return await savePicture();
    const motion = await held(shownTake), name = fileName() + format;
    if (engine.folder) {
      await engine.ask("save", { motion, format, character, id: name });
      await listFolder();
      say(`${name} is in the project's folder.`);
    } else {
      offer(name, await engine.ask("save", { motion, format, character }), "application/octet-stream");
    }
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

async function readTimeline(lines) {
  const read = projectOf(await engine.ask("check", { timeline: lines }), project);
  edit((p) => {
    Object.assign(p, read);
    marked.clear();
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
press("saveText", async () => {
  const name = fileName() + ".txt", words = element("lines").value;
  if (!engine.folder) return offer(name, words, "text/plain");
  try {
    await engine.ask("store", { name, bytes: new TextEncoder().encode(words) });
    await listFolder();
    element("fault").textContent = `${name} is in the project's folder.`;
  } catch (reason) {
    element("fault").textContent = reason.message;
  }
});

// A narrow page has a menu, and shows the fields of the text or those of the motion.
function openMenu(on) {
  const menu = element("menu"), more = element("more");
  if (!on && menu.offsetWidth > 0 && more.contains(document.activeElement)) menu.focus();
  more.classList.toggle("open", on);
  menu.setAttribute("aria-expanded", on);
}
press("menu", () => openMenu(!element("more").classList.contains("open")));
element("more").addEventListener("change", () => openMenu(false));
element("more").addEventListener("click", ({ target }) => { if (target.closest("button")) openMenu(false); });
addEventListener("pointerdown", ({ target }) => { if (!target.closest("nav")) openMenu(false); });
function showFields(name) {
  element("panel").dataset.shown = name;
  showPressed("showText", name === "text");
  showPressed("showMotion", name === "motion");
}
press("showText", () => showFields("text"));
press("showMotion", () => showFields("motion"));

press("keysHelp", () => element("keysDialog").showModal());
press("keysClose", () => element("keysDialog").close());

/** A motion of a file is kept in the timeline, at the cursor or from the start, in place of one that was kept. With
    `part`, { from, seconds }, only that is kept. A file that the project lacked is only given back to it. */
async function keepMotion(file, part = null) {
  const bytes = await file.arrayBuffer(), name = file.name;
  const sum = new Uint8Array(bytes).reduce((all, b) => Math.imul(all ^ b, 16777619), 2166136261) >>> 0;
  const id = `clip ${name} ${bytes.byteLength} ${sum}`;
  const { seconds, notes } = await engine.ask("read", { id, name, bytes });
  engine.has.add(id);
  const missing = book.some((p) => clipOf(p)?.clip === id) && !clips.has(id) && !await shelf.get(id);
  clips.set(id, { name, bytes, seconds });
  await shelf.put(id, { name, bytes, seconds });
  if (missing) {
    say(`${name} is here again.`);
    if (isStale() && clipOf(project)?.clip === id) await generate();
    return;
  }
  const taken = part || { from: 0, seconds };
  edit((p) => {
    const start = time + shortest < p.seconds && shownTake && time > 0.3 ? Math.round(20 * time) / 20 : 0;
    const end = Math.min(start + taken.seconds, longest), text = name.replace(/\.[^.]*$/, "");
    p.seconds = Math.max(p.seconds, rounded(end));
    p.bars = p.bars.filter((b) => !b.clip);
    marked.clear();
    chosen = p.bars.push({ text, start, end, parts: [], clip: id, from: taken.from, whole: seconds }) - 1;
  });
  say([`${name}: ${taken.seconds.toFixed(1)} s are kept.`, notes].filter(Boolean).join(" "));
}
/** The character of a file shows the motion. */
async function showOn(file) {
  if (!shownTake) throw new Error("there is no motion to show yet");
  const old = character;
  character = { name: file.name, bytes: await file.arrayBuffer() };
  await show(shownTake);
  if (!character) character = old;
  else say(`${file.name} shows the motion.`);
  draw();
}
press("plain", () => {
  character = null;
  show(shownTake);
});
/** A GLB file without an animation and a VRM file are characters; with Shift every GLB file is one.
    stored: the file's name and mark in the folder of the server, if it is there */
async function take(file, asCharacter, stored = null) {
  try {
    const kind = file.name.slice(file.name.lastIndexOf(".")).toLowerCase();
    if (file.size > 64e6) throw new Error("it is larger than 64 MB");
    if (kind === ".json") {
      if (file.size > bounds.bytes) throw new Error("it is too large for a project");
      await openProject(await file.text(), stored);
    } else if (kind === ".vrm" || (asCharacter && [".glb", ".gltf"].includes(kind))) {
      await showOn(file);
    } else if ([".bvh", ".glb", ".gltf", ".vrma", ".npz", ".npy"].includes(kind)) {
      try {
        await keepMotion(file);
      } catch (reason) {
        if (![".glb", ".gltf"].includes(kind) || !/animation/.test(reason.message)) throw reason;
        await showOn(file);
      }
    } else if (kind === ".txt") {
      if (file.size > 100000) throw new Error("it is too large for a timeline");
      await readTimeline(await file.text());
    } else {
      throw new Error("the studio reads .bvh, .glb, .gltf, .vrma, .vrm, .npz, .npy, timelines .txt, projects .json");
    }
  } catch (reason) {
    if (!reason.cancelled) say(`${file.name}: ${reason.message}`, true);
  }
}
press("open", () => element("file").click());
/** The files in the folder of the program `motionlang studio --project`. */
async function listFolder() {
  element("folder").hidden = false;
  const names = await engine.ask("files");
  element("folder").replaceChildren(new Option("Folder", ""), ...names.map((name) => new Option(name)));
}
element("folder").addEventListener("change", async ({ target }) => {
  const name = target.value;
  target.value = "";
  try {
    const { bytes, mark } = await engine.ask("open", { name });
    await take(new File([unpackedBytes(bytes)], name), false, { name, mark });
  } catch (reason) {
    say(`${name}: ${reason.message}`, true);
  }
});
element("file").addEventListener("change", async ({ target }) => {
  const [file] = target.files;
  if (file) await take(file, false);
  target.value = "";
});
addEventListener("dragover", (event) => {
  if (event.dataTransfer.types.includes("Files")) event.preventDefault();
});
/** A folder is searched; so are motions that come together, except those that the project lacks. */
addEventListener("drop", async (event) => {
  const files = [...event.dataTransfer.files], asCharacter = event.shiftKey;
  const { items } = event.dataTransfer, folder = [...items].some((i) => i.webkitGetAsEntry?.()?.isDirectory);
  if (files.length === 0) return;
  event.preventDefault();  // the page stays
  if (folder) {
    const things = droppedThings(items);
    try {
      searchIn(await filesIn(await things));
    } catch (reason) {
      say(`The folder cannot be read: ${reason.message}`, true);
    }
    return;
  }
  const lacked = new Set(book.map(clipOf).filter((b) => b && !clips.has(b.clip)).map((b) => nameOfClip(b.clip)));
  const others = files.filter((file) => !asCharacter && isMotionFile(file.name) && !lacked.has(file.name));
  const finding = element("findDialog").open, together = engine.searches && (others.length > 1 || finding);
  for (const file of files) if (!together || !others.includes(file)) await take(file, asCharacter);
  if (together && others.length) searchIn(others.map((file) => [file.name, file]));
});

addEventListener("keydown", (event) => {
  if (document.querySelector("dialog[open]")) return;
  const key = event.key.toLowerCase(), held = event.ctrlKey || event.metaKey;
  const writes = takesText(event.target);
  const action = held
    ? { z: event.shiftKey ? redo : undo, y: redo, d: duplicateBars, enter: () => generate(event.shiftKey),
        ...(!writes && { a: chooseAll }) }[key]
    : writes || event.altKey || event.target.tagName === "SELECT" ? null
    : { escape: () => { openMenu(false); chooseOne(); }, n: addNext, g: () => element("snap").click(), v: vary,
        k: () => lockTake(shownTake), x: event.defaultPrevented ? null : splitBars,
        "?": () => element("keysHelp").click(), 0: () => setZoom(1),
        ...(event.target !== view && { "+": () => setZoom(2 * zoom), "-": () => setZoom(zoom / 2) }),
        ...Object.fromEntries([1, 2, 3, 4].map((n) => [n, takes[n - 1] && (() => chooseTake(takes[n - 1]))])) }[key];
  if (!action) return;
  event.preventDefault();
  action();
});
element("lanes").addEventListener("wheel", (event) => {
  if (!event.ctrlKey) return;
  event.preventDefault();
  setZoom(zoom * (event.deltaY < 0 ? 1.25 : 0.8));
}, { passive: false });
seekByDragging(element("axis"), lanes, () => project.seconds);
new ResizeObserver(() => {
  drawAxis(element("axis"), project.seconds, 12 * zoom);
  drawCurves();
  refresh();
}).observe(element("stage"));

// ---- The start: a link, or the project of the last visit, or the example.

async function openLink() {
  const link = new URLSearchParams(location.hash.slice(1));
  if (!link.has("timeline") || location.hash === linkOf(project)) return;
  try {
    const read = projectOf(await engine.ask("check", { timeline: link.get("timeline") }),
                           { seed: link.get("seed"), fast: link.has("fast") });
    if (linkOf(project) === linkOf(tidied(structuredClone(example)))) {
      edit((p) => {
        Object.assign(p, read);
        chosen = 0;
      });
    } else {
      addSheet(read);  // beside what is there
    }
  } catch (reason) {
    say(`The link has no timeline that can be read: ${reason.message}`, true);
  }
}
addEventListener("hashchange", async () => {
  if (location.hash.startsWith("#token=")) return location.reload();
  await openLink();
  generate();
});

/** For scripts that look at the page: what it shows and has, as a copy. */
window.motionlang = Object.freeze({
  state: () => ({
    ...playerState(), project: structuredClone(project), chosen, selected: selected(),
    timeline: timelineOf(project).lines, sheet, timelines: book.length, motions, opened, took, whole: wholeProject(),
    making: making !== null, stale: isStale(), zoom, snapping,
    warnings: structuredClone(warned), undos: past.length, redos: future.length, character: character && character.name,
    takes: takes.map(({ seed, locked, key, reuse, exact }) => ({ seed, locked, key, reuse, exact })),
    shown: takes.indexOf(shownTake), aids: { ...aids }, cones, tints,
    mesh: renderer.mesh ? renderer.mesh.positions.length / 3 : 0 }),
  /** The rotations of the motion that is shown, as the page received them. */
  turns: () => Array.from(clip.turns) });

async function begin() {
  element("title").textContent = page.title;
  element("title").title = `motionlang ${page.version}`;
  const says = text("span", "", element("stage"));
  says.id = "says";
  const kept = restore(), linked = location.hash.length > 1 && !kept.includes(location.hash);
  takesId = project.id;
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
  if (engine.folder) await listFolder();
  if (linked) await openLink();
  store();
  takesId = project.id;
  const shelved = await shelf.get(keyOf(project));
  if (shelved) spare.push({ ...shelved, seed: project.seed, key: keyOf(project), project: structuredClone(project) });
  await generate();
  check();
}
begin();
)page";

}  // namespace detail

MOTIONLANG_NAMESPACE_END
