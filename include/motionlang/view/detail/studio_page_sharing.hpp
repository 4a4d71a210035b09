// SPDX-License-Identifier: MIT
/// The source of the studio's page, continued: the project as a file, pictures and videos, and examples to start from.
/// studio_page.hpp puts it between the parts of studio_page_source.hpp.
#pragma once

#include <string_view>  // source

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The project as one object, for the storage and for a file.
inline constexpr std::string_view studio_script_whole = R"page(
// ---- The whole project.

/** What a project has at most, and its file in bytes: a thousand letters for each of its texts fit into that. */
const bounds = { timelines: 100, bars: 200, words: 1000, locks: 4, bytes: 32e6 };
/** Seeds whose variations are locked as soon as they are made, by the id of their timeline. */
const wanted = new Map();
const lockedSeeds = (id) => {
  const made = (id === takesId ? takes : takesOf.get(id) || []).filter((t) => t.locked).map((t) => t.seed);
  return [...new Set([...made, ...wanted.get(id) || []])].slice(0, bounds.locks);
};
const nameOfClip = (id) => /^clip (.*) \d+ \d+$/s.exec(id)?.[1] || id;

/** All timelines with their seeds and locks, the settings, and the names of the files whose motions are kept. */
const wholeProject = () => ({
  motionlang: "studio project", version: 1, shown: sheet, settings: { keep: keeping, live, snap: snapping },
  timelines: book.map((p) => ({ bars: p.bars, seconds: p.seconds, seed: p.seed, fast: p.fast,
                                locked: lockedSeeds(p.id) })),
  kept: [...new Set(book.map(clipOf).filter(Boolean).map((b) => nameOfClip(b.clip)))] });

/** A timeline with nothing else in it. Throws an error that names the place. */
function checkedTimeline(p, where) {
  const fail = (words) => { throw new Error(`${where}: ${words}`); };
  const finite = (value, name, most = Number.MAX_SAFE_INTEGER, spare = 0) =>
    Number.isFinite(value) && value >= -spare && value <= most + spare ? clamp(value, 0, most)
      : fail(`${name} is not a number from 0 to ${most}`);
  const moment = (value, name, most) => finite(value, name, most, 0.001);  // the editor rounds to milliseconds
  if (!Array.isArray(p?.bars)) fail("it has no list of texts");
  if (p.bars.length > bounds.bars) fail(`it has ${p.bars.length} texts, and the studio takes at most ${bounds.bars}`);
  const seconds = finite(p.seconds, "its length", longest), locked = p.locked ?? [];
  const bars = p.bars.map((b, i) => {
    const at = `text ${i + 1}`;
    if (typeof b?.text !== "string" || b.text.length > bounds.words) fail(`${at} has no words, or too many`);
    if (!Array.isArray(b.parts) || !b.parts.every((name) => parts.includes(name))) fail(`${at}: unknown body parts`);
    const made = { text: b.text, start: moment(b.start, `${at}: its start`, seconds),
                   end: moment(b.end, `${at}: its end`, seconds), parts: [...b.parts] };
    if (b.clip === undefined) return made;
    if (typeof b.clip !== "string" || b.clip.length > bounds.words) fail(`${at}: its file has no name`);
    const whole = finite(b.whole, `${at}: the length of its file`);
    const from = Math.min(moment(b.from, `${at}: its start in the file`, whole), Math.max(whole - shortest, 0));
    return { ...made, end: Math.min(made.end, made.start + whole - from), clip: b.clip, from, whole };
  });
  if (bars.filter((b) => b.clip).length > 1) fail("it keeps several motions, and the studio keeps one");
  if (!Array.isArray(locked) || locked.length > bounds.locks) fail("its locked seeds are not a list of at most 4");
  return { ...tidied({ bars, seconds, seed: finite(p.seed, "its seed"), fast: p.fast === true }),
           locked: locked.map((seed) => Math.floor(finite(seed, "a locked seed"))) };
}
/** A project of a file or of the storage, with nothing else in it. Throws an error that names the place. */
function checkedProject(found) {
  if (found?.motionlang !== "studio project" || !Array.isArray(found.timelines))
    throw new Error("it is not a project of the studio");
  const { version, timelines, shown: number, settings } = found, count = timelines.length;
  if (version !== 1) throw new Error(`its version is ${version}, and this studio knows version 1`);
  if (count < 1 || count > bounds.timelines)
    throw new Error(`it has ${count} timelines, and the studio takes 1 to ${bounds.timelines}`);
  return { timelines: timelines.map((p, i) => checkedTimeline(p, `timeline ${i + 1}`)),
           number: clamp(Math.floor(+number) || 0, 0, count - 1),
           settings: { keep: settings?.keep !== false, live: settings?.live === true,
                       snap: settings?.snap !== false } };
}
/** The project becomes this one. Its timelines get ids that none had before. */
function takeProject({ timelines, number, settings }) {
  book = timelines.map(({ locked, ...p }) => {
    wanted.set(++lastId, locked);
    return { ...p, id: lastId };
  });
  sheet = number;
  project = book[sheet];
  chosen = project.bars.length ? 0 : -1;
  marked.clear();
  ({ keep: keeping, live, snap: snapping } = settings);
}
/** The project of a file takes the place of the one that is here; undo brings that back.
    stored: the file's name and mark in the folder of the server, if it is there */
async function openProject(words, stored) {
  let found;
  try {
    found = JSON.parse(words);
  } catch (reason) {
    throw new Error(`it is not JSON, or not all of it: ${reason.message}`);
  }
  const read = checkedProject(found), lacks = [];
  for (const p of book) {  // the storage keeps files only of the project that is here
    const id = clipOf(p)?.clip, file = id && !clips.has(id) && await shelf.get(id);
    if (file) clips.set(id, file);
  }
  for (const p of read.timelines) {
    const id = clipOf(p)?.clip;
    if (id && !clips.has(id) && !await shelf.get(id)) lacks.push(nameOfClip(id));
  }
  edit(() => takeProject(read));
  if (stored) ownFile(stored, idsOf(book));
  const count = read.timelines.length;
  say(`${count === 1 ? "A timeline is" : `${count} timelines are`} open. Undo brings back what was here.` +
    (lacks.length ? ` Also drop ${[...new Set(lacks)].join(", ")}, whose motion is kept.` : ""));
}
)page";

/// Pictures, videos and examples.
inline constexpr std::string_view studio_script_sharing = R"page(
// ---- The project as a file.

/** The files of the folder from which this project was opened, or to which it was saved, the latest last: for each name
    the mark of the contents that it had, and the ids of its timelines, which no other project has. */
const ownFiles = new Map();
const idsOf = (timelines) => timelines.map((p) => p.id);
function ownFile({ name, mark }, ids) {
  ownFiles.delete(name);
  ownFiles.set(name, { mark, ids });
}
/** The name and the mark of the file that has this project. */
function fileOfProject() {
  const found = [...ownFiles].reverse().find(([, { ids }]) => book.some((p) => ids.includes(p.id)));
  return found && { name: found[0], mark: found[1].mark };
}
/** Contents of projects, [bytes, ids], that were sent to files without an answer, by name: a save that was cancelled may
    have been done. */
const unanswered = new Map();
const unansweredHere = (name) => (unanswered.get(name) || []).filter(([, ids]) => book.some((p) => ids.includes(p.id)));
const equalBytes = (a, b) => a.length === b.length && a.every((byte, i) => byte === b[i]);
/** The mark of a file if it has contents that were sent without an answer. */
async function markOfSent(name) {
  const sent = unansweredHere(name);
  if (sent.length === 0) return "";
  try {
    const found = await engine.ask("open", { name }), contents = unpackedBytes(found.bytes);
    return sent.some(([bytes]) => equalBytes(bytes, contents)) ? found.mark : "";
  } catch (reason) {
    if (reason.cancelled) throw reason;
    return "";
  }
}
/** Stores the project in its file of the folder. If somebody else has changed that, it gets another one. */
async function storeProject(bytes) {
  const ids = idsOf(book), own = fileOfProject();
  const stores = async (name, over) => {  // only over contents that this page knows
    const earlier = unanswered.get(name) || [];
    unanswered.set(name, [[bytes, ids], ...earlier].slice(0, 4));
    const { mark } = await engine.ask("store", { name, bytes, over });
    if (earlier.length) unanswered.set(name, earlier);  // it is done, or refused
    else unanswered.delete(name);
    if (!mark) {
      const sent = await markOfSent(name);
      return sent !== "" && sent !== over && stores(name, sent);
    }
    unanswered.delete(name);
    ownFile({ name, mark }, ids);
    store();  // a reload finds it
    return true;
  };
  if (own && await stores(own.name, own.mark)) return `${own.name} is in the project's folder.`;
  const start = own ? own.name.replace(/(_\d+)?\.json$/, "").slice(0, 85) : `${fileName()}_project`;
  const taken = (await engine.ask("files")).map((name) => name.toLowerCase());
  for (let i = 1;; ++i) {
    const name = start + (i > 1 ? `_${i}` : "") + ".json";
    if ((unansweredHere(name).length || !taken.includes(name.toLowerCase())) && await stores(name, ""))
      return `${name} is in the project's folder` + (own ? `. Somebody else has changed ${own.name}.` : ".");
  }
}
press("saveProject", async () => {
  const button = element("saveProject");
  try {
    const bytes = new TextEncoder().encode(JSON.stringify(wholeProject(), null, 1));
    if (bytes.length > bounds.bytes) throw new Error(`the project has more than ${bounds.bytes / 1e6} MB of texts`);
    if (!engine.folder) return offer(`${fileName()}_project.json`, bytes, "application/json");
    button.disabled = true;
    say(await storeProject(bytes));
    await listFolder();
  } catch (reason) {
    say(reason.message, true);
  }
  button.disabled = false;
  drawFields();
});

// ---- Pictures and videos of the view.

/** The figure as it is shown, with two pixels for one of the page. */
async function savePicture() {
  const usual = quality;
  quality = 2 / Math.min(devicePixelRatio || 1, 2);
  render();
  const made = new Promise((resolve) => view.toBlob(resolve, "image/png"));  // the pixels are gone after this task
  quality = usual;
  refresh();
  const picture = await made;
  if (!picture) throw new Error("this browser makes no picture of the view");
  await keepFile(fileName() + ".png", new Uint8Array(await picture.arrayBuffer()), "image/png");
}
/** Records the view while the motion plays once. A pause ends the video there. */
const saveVideo = () => work("Recording the video.", async () => {
  const type = ["video/webm", "video/mp4"].find((t) => globalThis.MediaRecorder?.isTypeSupported(t));
  if (!type || !view.captureStream) throw new Error("this browser records no video");
  const usual = { looping, speed, quality, playing, time }, blocks = [], stream = view.captureStream();
  const recorder = new MediaRecorder(stream, { mimeType: type, videoBitsPerSecond: 6e6 });
  const pause = () => new Promise((resolve) => setTimeout(resolve, 50));
  const stand = async (count) => {  // pictures that stand: browsers may lose the first and the last ones
    for (let i = 0; i < count && !cancelled; ++i) render(), await pause();
  };
  let cancelled = false, length = 0;
  const ended = new Promise((resolve, reject) => {
    recorder.onstop = resolve;
    recorder.onerror = ({ error }) => reject(error);
  });
  recorder.ondataavailable = ({ data }) => blocks.push(data);
  making.cancel = () => { cancelled = true; };
  [looping, speed, quality] = [false, 1, Math.max(quality, 1)];
  play(false);
  seek(0);
  render();
  steady = true;
  try {
    const began = performance.now();
    recorder.start();
    await stand(4);
    play(true);
    while (playing && !cancelled) {
      element("progress").value = time / clip.seconds;
      element("left").textContent = `${time.toFixed(1)} of ${clip.seconds.toFixed(1)} s`;
      await pause();
    }
    await stand(4);
    recorder.stop();
    length = performance.now() - began;
    await ended;
  } finally {
    steady = false;
    stream.getTracks().forEach((track) => track.stop());
    ({ looping, speed, quality } = usual);
    seek(usual.time);
    play(usual.playing);
  }
  if (cancelled) throw Object.assign(new Error("cancelled"), { cancelled: true });
  const bytes = new Uint8Array(await new Blob(blocks).arrayBuffer());
  const name = fileName() + type.replace("video/", ".");
  const about = `${(length / 1000).toFixed(1)} s, ${Math.ceil(bytes.length / 1000)} kB`;
  try {
    await keepFile(name, bytes, type);
  } catch (reason) {
    offer(name, bytes, type);
    return `${name} is among the downloads: ${about}. The project's folder did not take it: ${reason.message}`;
  }
  return `${name}${engine.folder ? " in the project's folder" : ""}: ${about}.`;
});

// ---- Examples to start from: a name, a seed, and texts with their times. Alone, the bundled model does each text in
// at least 4 of 5 seeds (`motionlang judge`).

const arms = ["left arm", "right arm"];
const gallery = [
  ["Walk and raise both arms", 7, ["walk forward", 0, 6, "legs"], ["raise both arms", 2, 5, ...arms]],
  ["Sit down, stand up", 7, ["walk forward", 0, 3], ["sit down", 3, 5.5], ["stand up", 5.5, 8]],
  ["There and back", 7, ["walk forward", 0, 3], ["turn left", 3, 5], ["walk forward", 5, 8]],
  ["Run and jump", 7, ["run forward", 0, 3], ["jump forward", 3, 6], ["run forward", 6, 9]],
  ["Bend and step back", 7, ["walk forward", 0, 3], ["bend forward", 3, 5.5], ["walk backwards", 5.5, 8.5]],
  ["Morning exercise", 7, ["raise both arms", 0, 2], ["bend forward", 2, 4.5], ["jog forward", 4.5, 7.5]],
  ["Greet while walking", 7, ["walk slowly", 0, 7, "legs", "spine", "head"],
   ["raise the right arm", 1, 3.5, "right arm"], ["raise the left arm", 3.5, 6, "left arm"]],
  ["Signal and turn", 7, ["walk forward", 0, 3], ["raise the left arm", 3, 6], ["turn right", 6, 8]],
  ["Backflip", 7, ["stand still", 0, 2], ["backflip", 2, 5], ["raise both arms", 5, 7]],
  ["Jog and fall", 7, ["jog forward", 0, 4], ["fall down", 4, 7]]];
const exampleOf = ([, seed, ...texts]) => tidied({
  bars: texts.map(([words, start, end, ...names]) => ({ text: words, start, end, parts: names })),
  seconds: Math.max(...texts.map(([, , end]) => end)), seed, fast: project.fast });
element("examples").append(...gallery.map(([name], i) => new Option(name, i)));
/** Opens beside what is there; an example that nobody has changed gives its place to another. */
element("examples").addEventListener("change", async ({ target }) => {
  const made = exampleOf(gallery[+target.value]);
  const untouched = gallery.some((one) => linkOf(exampleOf(one)) === linkOf(project));
  target.value = "";
  if (untouched) {
    edit((p) => {
      Object.assign(p, made);
      marked.clear();
      chosen = 0;
    });
  } else {
    addSheet(made);
  }
  seek(0);
  if (!making) await generate();
});
)page";

}  // namespace detail

MOTIONLANG_NAMESPACE_END
