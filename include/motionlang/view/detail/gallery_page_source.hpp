// SPDX-License-Identifier: MIT
/// The source of the gallery's page: style, elements, program. gallery_page.hpp puts title and data between them. The
/// program continues that of viewer_page.hpp.
#pragma once

#include <string_view>  // source

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr std::string_view gallery_style = R"page(
* { box-sizing: border-box; }
body {
  margin: 0; background: var(--back); color: var(--text);
  font: 14px/1.4 system-ui, -apple-system, "Segoe UI", sans-serif;
}
header {
  position: sticky; top: 0; z-index: 1; display: flex; flex-wrap: wrap; gap: 4px 16px; align-items: center;
  padding: 10px 18px; background: var(--panel); border-bottom: 1px solid var(--line);
}
h1 { font-size: 18px; margin: 0; }
#info, #count { color: var(--faint); }
#search { margin-left: auto; }
input, button {
  font: inherit; color: inherit; background: var(--back); border: 1px solid var(--line); border-radius: 7px;
  padding: 5px 10px; min-height: 32px;
}
#play { min-width: 84px; background: var(--accent); border-color: var(--accent); color: #fff; font-weight: 600; }
@media (prefers-color-scheme: dark) { #play { color: #10141a; } }
:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
#cards {
  display: grid; grid-template-columns: repeat(auto-fill, minmax(170px, 1fr)); grid-auto-flow: dense; gap: 12px;
  padding: 16px 18px 40px; list-style: none; margin: 0;
}
.card { background: var(--panel); border: 1px solid var(--line); border-radius: 10px; overflow: hidden; }
.card[hidden] { display: none; }
.card canvas { display: block; width: 100%; height: 190px; touch-action: pan-y; cursor: pointer; }
.card.big { grid-column: span 2; grid-row: span 2; }
.card.big canvas { height: 452px; }
.card p { margin: 0; padding: 8px 12px 10px; }
.card b { display: block; font-size: 15px; }
.card span { color: var(--faint); overflow-wrap: anywhere; }
)page";

inline constexpr std::string_view gallery_body = R"page(
<header>
  <h1 id="title"></h1><span id="info"></span><span id="count" role="status"></span>
  <label id="search">Find <input id="find" type="search" placeholder="a word" autocomplete="off"></label>
  <button id="play" type="button" aria-pressed="true">Pause</button>
</header>
<ul id="cards"></ul>
)page";

inline constexpr std::string_view gallery_script = R"page(
const clips = sharedClips(), shared = new SharedRenderer(), pause = 0.7;  // seconds in the last pose
const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
let playing = !still, hovered = null, scheduled = false, before = 0, next = 0;

const text = (tag, content, parent) => {
  const e = document.createElement(tag);
  e.textContent = content;
  parent.append(e);
  return e;
};
const cards = clips.map((clip) => {
  const element_ = text("li", "", element("cards")), canvas = text("canvas", "", element_);
  const words = text("p", "", element_), camera = new Camera();
  element_.className = "card";
  text("b", clip.name, words);
  if (clip.note !== clip.name) text("span", clip.note, words);
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", `A figure moves: ${clip.note}`);
  camera.reset(clip);
  const card = { clip, element: element_, canvas, camera, time: 0, visible: false, stale: true, drawn: false };
  let travelled = 0;
  turnByDragging(canvas, camera, () => { travelled += 1; card.stale = true; refresh(); });
  canvas.addEventListener("pointerdown", () => { travelled = 0; });
  canvas.addEventListener("click", () => { if (travelled < 3) enlarge(card); });
  canvas.addEventListener("keydown", (event) => { if (event.key === "Enter") enlarge(card); });
  canvas.addEventListener("pointerenter", () => { hovered = card; refresh(); });
  canvas.addEventListener("pointerleave", () => { hovered = null; });
  return card;
});
function enlarge(card) {
  card.element.classList.toggle("big");
  card.stale = true;
  refresh();
}
const moves = (card) => (playing || card === hovered) && card.clip.seconds > 0;

function refresh() {
  if (!scheduled) requestAnimationFrame(frame);
  scheduled = true;
}
/** Draws cards in view, in turn, as many as fit into a few milliseconds; the others follow in the next frame. */
function frame(now) {
  scheduled = false;
  const passed = Math.min(0.1, Math.max(0, now - before) / 1000), start = performance.now();
  before = now;
  const shown = cards.filter((c) => c.visible && !c.element.hidden);
  for (const card of shown) {
    if (!moves(card)) continue;
    card.time = (card.time + passed) % (card.clip.seconds + pause);
    card.stale = true;
  }
  for (let i = 0; i < shown.length && performance.now() - start < 14; ++i) {
    const card = shown[next++ % shown.length];
    if (!card.stale) continue;
    shared.draw(card.canvas, card.clip, card.camera, Math.min(card.time, card.clip.seconds));
    card.stale = false;
    card.drawn = true;
  }
  if (shown.some((c) => c.stale || moves(c))) refresh();
}

const watcher = new IntersectionObserver((entries) => {
  for (const entry of entries) {
    const card = cards.find((c) => c.element === entry.target);
    card.visible = entry.isIntersecting;
    card.stale = true;
  }
  refresh();
}, { rootMargin: "60px" });
for (const card of cards) watcher.observe(card.element);

function find() {
  const words = element("find").value.toLowerCase().split(/\s+/).filter(Boolean);
  let found = 0;
  for (const card of cards) {
    const about = `${card.clip.name} ${card.clip.note}`.toLowerCase();
    card.element.hidden = !words.every((w) => about.includes(w));
    found += card.element.hidden ? 0 : 1;
  }
  element("count").textContent = words.length ? `${found} of ${cards.length}` : `${cards.length} motions`;
  refresh();
}
function play(on) {
  playing = on;
  element("play").textContent = playing ? "Pause" : "Play";
  element("play").setAttribute("aria-pressed", playing);
  before = performance.now();
  refresh();
}
element("find").addEventListener("input", find);
element("play").addEventListener("click", () => play(!playing));
const redraw = () => { for (const card of cards) card.stale = true; refresh(); };
dark.addEventListener("change", redraw);
addEventListener("resize", redraw);

/** For scripts that look at the page. */
window.motionlang = Object.freeze({
  state: () => ({
    cards: cards.length, playing, renderer: shared.kind, drawn: cards.filter((c) => c.drawn).length,
    shown: cards.filter((c) => !c.element.hidden).map((c) => c.clip.name), times: cards.map((c) => c.time) }) });

element("title").textContent = page.title;
element("info").textContent = page.info;
find();
play(playing);
)page";

}  // namespace detail

MOTIONLANG_NAMESPACE_END
