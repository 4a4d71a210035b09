// Runs inside the viewer's page (as the body of a function that viewer_test.py calls): uses it like a person and reports
// what is wrong.
"use strict";
const done = arguments[arguments.length - 1];
const problems = [];
const expect = (what, holds) => { if (!holds) problems.push(what); };

const wait = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));
// Looks every tenth of a second, for ten seconds: a loaded machine draws few frames.
const until = async (holds) => {
  for (let i = 0; i < 100; ++i) {
    if (holds()) return true;
    await wait(100);
  }
  return false;
};
const state = () => window.motionlang.state();
const largestMove = (a, b) => Math.max(...a.joints.map((p, j) => Math.hypot(...p.map((x, i) => x - b.joints[j][i]))));
const press = (key, target = document.body) => target.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
const find = (id) => document.getElementById(id);

// Number of different colours in the picture of the next frame.
const coloursShown = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => {
  const copy = document.createElement("canvas"), source = find("view");
  [copy.width, copy.height] = [source.width, source.height];
  const context = copy.getContext("2d");
  context.drawImage(source, 0, 0);
  const pixels = new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer);
  done(new Set(pixels).size);
})));

async function use() {
  const first = state();
  expect("starts at the first frame, still", !first.playing && first.frame === 0 && first.frames === 81);
  expect("24 joints", first.joints.length === 24);
  expect("title and note are shown", find("title").textContent === "browser <test>" &&
    find("info").textContent.startsWith("no model \u00b7 seed 1"));
  expect("one row for each text", document.querySelectorAll(".track").length === 2);
  expect("texts are shown as they are", document.querySelectorAll(".bar")[1].textContent.includes("<" + "/script>"));

  const pressed = performance.now();
  find("play").click();
  await wait(800);
  const second = state(), passed = (performance.now() - pressed) / 1000;
  expect("plays after the button was pressed", second.playing && find("play").textContent === "Pause");
  expect(`${passed} s later it is ${second.time} s later`, second.time > 0.25 && second.time < passed + 0.05);
  expect("the pose changes", largestMove(first, second) > 0.2);
  expect("the picture has colours: " + await coloursShown(), await coloursShown() > 6);
  expect("the bar of the current text is marked", document.querySelector(".bar").classList.contains("now"));

  find("play").click();
  const third = state();
  await wait(300);
  expect("stands still after the second press", !third.playing && state().time === third.time);
  press(" ");
  expect("the space key plays", state().playing);
  find("speed").value = "2";
  find("speed").dispatchEvent(new Event("change"));
  let latest = state().time;
  const wentBack = () => { const before = latest; latest = state().time; return latest < before; };
  expect("starts again at the end: " + state().time, await until(wentBack) && state().playing);
  find("loop").click();
  await until(() => !state().playing);
  expect("without loop it stops at the end", !state().playing && state().time === state().seconds);
  press("Home");
  expect("Home goes to the first frame", state().frame === 0);
  press("ArrowRight");
  expect("an arrow steps one frame", state().frame === 1);

  find("scrub").value = 2.5;
  find("scrub").dispatchEvent(new Event("input"));
  expect("the slider seeks", Math.abs(state().time - 2.5) < 1e-6);
  const area = find("tracks").getBoundingClientRect();
  find("timeline").dispatchEvent(new PointerEvent("pointerdown", { clientX: area.left + area.width / 4, bubbles: true }));
  dispatchEvent(new PointerEvent("pointerup"));
  expect("a click on the timeline seeks: " + state().time, Math.abs(state().time - 1) < 0.05);
  const follows = await until(() => Math.abs(parseFloat(find("cursor").style.left) - 25) < 1);
  expect("the cursor follows: " + find("cursor").style.left, follows);

  find("speed").value = "0.5";
  find("speed").dispatchEvent(new Event("change"));
  find("follow").click();
  const before = state().time, start = performance.now();
  find("play").click();
  await wait(1000);
  const ratio = (state().time - before) / ((performance.now() - start) / 1000);
  expect("half speed: " + ratio, ratio > 0.15 && ratio < 0.6);  // less where drawing is slow
  expect("the camera does not follow any more", !state().following);
  const camera = state().camera;
  press("ArrowLeft", find("view"));
  press("+", find("view"));
  expect("keys turn and zoom", state().camera.yaw > camera.yaw && state().camera.distance < camera.distance);
  expect("every button and field has a name", [...document.querySelectorAll("button, select, input")].every((e) =>
    e.textContent.trim() || e.getAttribute("aria-label") || e.closest("label")));

  find("motion").value = "1";
  find("motion").dispatchEvent(new Event("change"));
  const other = state();
  expect("the second motion", other.name === "turning" && other.joints.length === (page.body ? 24 : 22) && other.time === 0);
  expect("without texts there is no timeline", find("timeline").hidden);
  expect("state is a copy", (() => { state().joints[0][0] = 1e9; return state().joints[0][0] < 1e3; })());
}

use().catch((reason) => problems.push(String(reason))).finally(() => done(problems));
