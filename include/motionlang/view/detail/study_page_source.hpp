// SPDX-License-Identifier: MIT
/// The source of a study's page: style, elements, program. study_page.hpp puts title and data between them. The program
/// continues that of viewer_page.hpp.
#pragma once

#include <string_view>  // source

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr std::string_view study_style = R"page(
* { box-sizing: border-box; }
body {
  margin: 0 auto; max-width: 1180px; padding: 12px 18px 30px; background: var(--back); color: var(--text);
  font: 16px/1.45 system-ui, -apple-system, "Segoe UI", sans-serif;
}
[hidden] { display: none !important; }
h1 { font-size: 20px; margin: 6px 0; }
#number { color: var(--faint); }
#question { font-size: 19px; font-weight: 600; margin: 6px 0 2px; }
#text { font-size: 18px; margin: 2px 0 8px; }
button, input, textarea {
  font: inherit; color: inherit; background: var(--panel); border: 1px solid var(--line); border-radius: 8px;
  padding: 8px 14px; min-height: 40px;
}
button { cursor: pointer; }
button:disabled { opacity: 0.45; cursor: default; }
button[aria-pressed="true"], .main:not(:disabled) {
  background: var(--accent); border-color: var(--accent); color: #fff;
}
:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
#figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(300px, 100%), 1fr)); gap: 14px; }
.figure { background: var(--panel); border: 1px solid var(--line); border-radius: 10px; overflow: hidden; }
.figure canvas { display: block; width: 100%; height: 400px; touch-action: none; cursor: grab; }
.figure button { width: calc(100% - 20px); margin: 10px; }
#texts { list-style: none; padding: 0; margin: 12px 0; display: grid; gap: 8px; }
#texts button { width: 100%; text-align: left; }
#choices { display: flex; flex-wrap: wrap; gap: 8px; margin: 12px 0; }
#bars { position: relative; margin: 12px 0; }
.bar { position: relative; height: 26px; }
.bar span {
  position: absolute; top: 2px; height: 22px; padding: 0 8px; border-radius: 4px; white-space: nowrap; font-size: 13px;
  line-height: 22px; background: color-mix(in srgb, var(--accent) 26%, transparent);
}
#cursor { position: absolute; top: 0; bottom: 0; width: 2px; background: var(--accent); }
nav { display: flex; gap: 10px; margin: 14px 0; }
textarea { width: 100%; height: 180px; font: 13px/1.4 ui-monospace, monospace; }
)page";

inline constexpr std::string_view study_body = R"page(
<main>
  <section id="start">
    <h1 id="title"></h1><p id="instructions"></p>
    <p><label>Your name or number <input id="rater" autocomplete="off"></label></p>
    <p><button id="begin" class="main" type="button">Begin</button></p>
  </section>
  <section id="trial" hidden>
    <div id="number" role="status"></div><div id="question"></div><div id="text"></div>
    <div id="figures"></div><ul id="texts"></ul>
    <div id="bars"></div>
    <div id="choices"></div>
    <nav><button id="back" type="button">Back</button><button id="next" class="main" type="button">Next</button></nav>
  </section>
  <section id="end" hidden>
    <h1>Thank you</h1>
    <p>Please save your answers and send the file to the person who gave you this page.</p>
    <nav><button id="save" class="main" type="button">Save answers</button>
    <button id="again" type="button">Back</button></nav>
    <label>Or copy them from here:<textarea id="answers" readonly></textarea></label>
  </section>
</main>
)page";

inline constexpr std::string_view study_script = R"page(
const clips = sharedClips(), shared = new SharedRenderer(), pause = 0.6;  // seconds in the last pose
const agreement = ["Strongly disagree", "Disagree", "Neither agree nor disagree", "Agree", "Strongly agree"];
const answers = page.trials.map(() => ({ places: [], rating: 0, none: false, seconds: 0 }));
let trial = -1, panels = [], time = 0, before = 0, saved = true;

const text = (tag, content, parent) => {
  const e = document.createElement(tag);
  e.textContent = content;
  parent.append(e);
  return e;
};
const show = (name) => { for (const id of ["start", "trial", "end"]) element(id).hidden = id !== name; };
const letter = (i) => String.fromCharCode(65 + i);
const wanted = () => page.trials[trial].texts.length || page.trials[trial].motions.length;
const complete = (a, count) => page.kind === "rating" ? a.rating > 0
  : page.kind === "pairs" ? a.none || a.places.length === 1 : a.places.length === count;

/** A click on a choice: the better one of a pair, or the next rank; a second click takes a rank back. */
function choose(place) {
  const a = answers[trial];
  saved = false;
  if (page.kind === "pairs") {
    a.none = place < 0;
    a.places = place < 0 ? [] : [place];
  } else if (a.places.includes(place)) {
    a.places = a.places.filter((p) => p !== place);
  } else {
    a.places.push(place);
    const count = wanted();
    if (a.places.length === count - 1) {  // only one is left
      a.places.push([...Array(count).keys()].find((p) => !a.places.includes(p)));
    }
  }
  mark();
}
function rate(value) {
  answers[trial].rating = value;
  saved = false;
  mark();
}
/** Shows the answer on the buttons. */
function mark() {
  const a = answers[trial];
  for (const button of document.querySelectorAll("[data-place]")) {
    const place = +button.dataset.place, rank = a.places.indexOf(place);
    button.setAttribute("aria-pressed", place < 0 ? a.none : rank >= 0);
    const shownRank = page.kind === "ranking" && rank >= 0 ? ` \u2014 ${rank + 1}` : "";
    button.textContent = button.dataset.label + shownRank;
  }
  for (const button of document.querySelectorAll("[data-rating]"))
    button.setAttribute("aria-pressed", a.rating === +button.dataset.rating);
  element("next").disabled = !complete(a, wanted());
}
function placeButton(parent, place, label) {
  const button = text("button", label, parent);
  button.type = "button";
  button.dataset.place = place;
  button.dataset.label = label;
  button.addEventListener("click", () => choose(place));
}

function open(number) {
  trial = number;
  const { text: about, motions, texts, tracks } = page.trials[trial];
  show("trial");
  element("number").textContent = `${trial + 1} of ${page.trials.length}`;
  element("question").textContent = page.question;
  element("text").textContent = about ? `\u201c${about}\u201d` : "";
  for (const id of ["figures", "texts", "bars", "choices"]) element(id).replaceChildren();
  panels = motions.map((m, i) => {
    const figure = text("div", "", element("figures")), canvas = text("canvas", "", figure), camera = new Camera();
    figure.className = "figure";
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `Moving figure ${letter(i)}`);
    camera.reset(clips[m]);
    turnByDragging(canvas, camera, () => {});
    if (!texts.length && page.kind !== "rating") placeButton(figure, i, `Motion ${letter(i)}`);
    return { clip: clips[m], canvas, camera };
  });
  texts.forEach((t, i) => placeButton(text("li", "", element("texts")), i, `${letter(i)}. ${t}`));
  if (page.none) placeButton(element("choices"), -1, "No preference");
  if (page.kind === "rating") {
    agreement.forEach((label, i) => {
      const button = text("button", label, element("choices"));
      button.type = "button";
      button.dataset.rating = i + 1;
      button.addEventListener("click", () => rate(i + 1));
    });
  }
  const length = Math.max(0.1, ...panels.map((p) => p.clip.seconds));
  for (const track of tracks) {
    const bar = text("div", "", element("bars"));
    const span = text("span", [track.text, ...track.parts].join(" \u00b7 "), bar);
    bar.className = "bar";
    Object.assign(span.style, { left: 100 * track.start / length + "%",
      width: 100 * Math.max(0, Math.min(track.end, length) - track.start) / length + "%" });
  }
  if (tracks.length) text("div", "", element("bars")).id = "cursor";
  element("back").disabled = trial === 0;
  time = 0;
  mark();
}
function leave(by) {
  if (trial + by < page.trials.length) return open(trial + by);
  trial = -1;
  panels = [];
  show("end");
  element("answers").value = file();
}

/** The answers in the form that motionlang counts. */
function file() {
  const lines = [["study", page.study], ["kind", page.kind], ["seed", page.seed],
                 ["rater", element("rater").value.replace(/\s+/g, " ").trim()], ["trial", "answer", "seconds"]];
  answers.forEach((a, i) => {
    const { texts, motions } = page.trials[i];
    if (!complete(a, texts.length || motions.length)) return;
    const given = page.kind === "rating" ? a.rating : a.none ? "-" : a.places.join(",");
    lines.push([i, given, a.seconds.toFixed(1)]);
  });
  return lines.map((cells) => cells.join("\t") + "\n").join("");
}
function save() {
  const link = document.createElement("a"), url = URL.createObjectURL(new Blob([file()], { type: "text/plain" }));
  const rater = element("rater").value.replace(/[^A-Za-z0-9_-]+/g, "_") || "rater";
  Object.assign(link, { href: url, download: `answers_${rater}.tsv` });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
  saved = true;
}

function frame(now) {
  const passed = Math.min(0.1, Math.max(0, now - before) / 1000);
  before = now;
  if (trial >= 0) {
    const length = Math.max(0.1, ...panels.map((p) => p.clip.seconds));
    time = (time + passed) % (length + pause);
    answers[trial].seconds += passed;
    for (const { clip, canvas, camera } of panels) shared.draw(canvas, clip, camera, Math.min(time, clip.seconds));
    const cursor = element("cursor");
    if (cursor) cursor.style.left = 100 * Math.min(time, length) / length + "%";
  }
  requestAnimationFrame(frame);
}

element("title").textContent = document.title = page.title;
element("instructions").textContent = page.instructions;
element("begin").addEventListener("click", () => open(0));
element("back").addEventListener("click", () => leave(-1));
element("next").addEventListener("click", () => leave(1));
element("again").addEventListener("click", () => open(page.trials.length - 1));
element("save").addEventListener("click", save);
addEventListener("keydown", (event) => {
  if (trial < 0 || event.ctrlKey || event.metaKey || event.altKey || event.target.tagName === "INPUT") return;
  const number = +event.key;
  if (event.key === "Enter" && event.target.tagName !== "BUTTON" && !element("next").disabled) leave(1);
  else if (page.kind === "rating" && number >= 1 && number <= 5) rate(number);
  else if (page.kind !== "rating" && number >= 1 && number <= wanted()) choose(number - 1);
  else if (page.none && event.key === "0") choose(-1);
});
addEventListener("beforeunload", (event) => { if (!saved) event.preventDefault(); });

/** For scripts that look at the page. */
window.motionlang = Object.freeze({
  state: () => ({ trial, trials: page.trials.length, kind: page.kind, time, renderer: shared.kind, file: file() }) });
requestAnimationFrame(frame);
)page";

}  // namespace detail

MOTIONLANG_NAMESPACE_END
