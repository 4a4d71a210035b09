// SPDX-License-Identifier: MIT
/// The source of the studio's page, continued: search by words, in the folder of a server or in files that were dropped
/// on the page. studio_page.hpp puts it between the parts of studio_page_source.hpp.
#pragma once

#include <string_view>  // source

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr std::string_view studio_script_search = R"page(
// ---- Search by words. A server searches the project's folder; without one the worker searches files of this page.

/** The files that the worker searches, by their paths. The bounds keep them in its memory. */
const searched = new Map(), room = { files: 2000, bytes: 400e6 };
const isMotionFile = (name) => /\.(bvh|amc|npz|npy|glb|gltf|vrma)$/i.test(name);
const many = (number, noun) => `${number} ${noun}${number === 1 ? "" : "s"}`;
const canSearch = () => engine.folder ? engine.search : engine.searches;
let sought = 0;        // searches so far
let halted = false;    // the person stops the reading of files
let readSoFar = null;  // { done, total } of the files that the worker reads in several shares

function showIndexed(done, total) {
  const all = readSoFar ? { done: readSoFar.done + done, total: readSoFar.total } : { done, total };
  element("findSays").textContent = `Reading the motions: ${all.done} of ${all.total} files.`;
}
function drawSearched() {
  const inPage = !engine.folder && engine.searches;
  element("findHelp").hidden = canSearch();
  element("findForm").hidden = !canSearch();
  element("findFrom").hidden = !inPage;
  if (!inPage) return;
  element("findWhere").textContent = searched.size ? `${many(searched.size, "file")} to search.`
    : clips.size ? "The motions that this project keeps are searched, and others that you choose."
    : "Drop a folder of motions on the page, or choose one.";
}
function openFind() {
  drawSearched();
  if (!element("findDialog").open) element("findDialog").showModal();
  if (canSearch()) element("sought").select();
}
/** Files to search, as [path, file]. Files of other kinds are left out. */
function searchIn(files) {
  if (!canSearch() || engine.folder) {
    return say("The program searches the folder that it was started with: motionlang studio --project FOLDER.", true);
  }
  const found = files.filter(([path, file]) => isMotionFile(path) && file.size <= 64e6);
  let bytes = [...searched.values()].reduce((sum, file) => sum + file.size, 0), left = 0;
  for (const [path, file] of found) {
    if (searched.size >= room.files || bytes + file.size > room.bytes) ++left;
    else searched.set(path, file), bytes += file.size;
  }
  openFind();
  element("findSays").textContent = found.length === 0
    ? "There is no motion in it. The studio reads .bvh, .amc, .npz, .npy, .glb, .gltf and .vrma."
    : left ? `${many(left, "file")} did not fit: at most ${room.files} files and ${room.bytes / 1e6} MB.` : "";
}
/** What was dropped, as handles, or as entries where a browser has no handles. Chromium reads entries in no page that
    was opened from the disk. Asks for them at once, since the event forgets them. */
function droppedThings(items) {
  return Promise.all([...items].filter((item) => item.kind === "file").map((item) => {
    const entry = item.webkitGetAsEntry?.();
    return entry?.isDirectory && item.getAsFileSystemHandle ? item.getAsFileSystemHandle() : entry;
  }));
}
/** All files of folders and files that were dropped, as [path, file]. */
async function filesIn(things, before = "") {
  const out = [];
  for await (const entry of things) {
    const path = before + entry.name;
    if (entry.kind === "file") {
      out.push([path, await entry.getFile()]);
    } else if (entry.kind === "directory") {
      out.push(...await filesIn(entry.values(), path + "/"));
    } else if (entry.isFile) {
      out.push([path, await new Promise((resolve, reject) => entry.file(resolve, reject))]);
    } else {
      const reader = entry.createReader();
      for (;;) {  // a folder gives its entries in shares
        const share = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
        if (share.length === 0) break;
        out.push(...await filesIn(share, path + "/"));
      }
    }
    if (out.length > 20 * room.files) throw new Error("the folder has too many files");
  }
  return out;
}
/** The worker reads the files that it still lacks, some at a time, so that somebody can stop it. */
async function readSearched() {
  const kept = [...clips.values()].filter(({ name }) => !searched.has(name))
    .map(({ name, bytes }) => [name, new File([bytes], name, { lastModified: 0 })]);
  const files = [...kept, ...searched];
  const mark = ([path, file]) => `to search: ${path} ${file.size} ${file.lastModified}`;
  const fresh = files.filter((one) => !engine.has.has(mark(one)));
  halted = false;
  element("findStop").hidden = fresh.length < 2;
  try {
    for (let at = 0; at < fresh.length && !halted;) {
      const share = [];
      for (let bytes = 0; at + share.length < fresh.length && share.length < 8 && bytes < 4e6;) {
        const one = fresh[at + share.length];
        share.push({ path: one[0], bytes: await one[1].arrayBuffer() });
        bytes += one[1].size;
      }
      readSoFar = { done: at, total: fresh.length };
      showIndexed(0, fresh.length);
      await engine.ask("index", { files: share });
      for (const one of fresh.slice(at, at + share.length)) engine.has.add(mark(one));
      at += share.length;
    }
  } finally {
    readSoFar = null;
    element("findStop").hidden = true;
  }
}
press("find", openFind);
press("findClose", () => element("findDialog").close());
press("findStop", () => { halted = true; });
press("findFolder", () => element("searchFolder").click());
press("findFiles", () => element("searchFiles").click());
for (const id of ["searchFolder", "searchFiles"]) {
  element(id).addEventListener("change", ({ target }) => {
    searchIn([...target.files].map((file) => [file.webkitRelativePath || file.name, file]));
    target.value = "";
  });
}
element("findForm").addEventListener("submit", async (event) => {
  event.preventDefault();
  const words = element("sought").value.trim(), mine = ++sought;
  if (!words) return;
  const answer = (line) => { if (mine === sought) element("findSays").textContent = line; };
  answer(making && !engine.folder ? "After the motion that is made now." : "Searching.");
  try {
    if (!engine.folder) await readSearched();
    const { moments, shows, unknown, clips: count, skipped } = await engine.ask("search", { words, count: 12 });
    if (mine !== sought) return;
    answer((count === 0 ? "There is no motion that can be searched."
      : shows ? `The nearest moments of ${many(count, "clip")}.` : "Nothing shows this. The nearest moments:") +
      (unknown.length ? ` The model does not know: ${unknown.join(", ")}.` : "") +
      (skipped ? ` ${many(skipped, "file")} could not be read.` : "") + (halted ? " Other files were not read." : ""));
    element("found").replaceChildren();
    for (const moment of moments) {
      const item = text("li", "", element("found")), button = text("button", "Keep", item);
      const about = `${moment.name}, ${moment.start.toFixed(1)} to ${moment.end.toFixed(1)}\u00a0s`;
      button.type = "button";
      button.setAttribute("aria-label", `Keep ${about}`);
      item.append(" ", about);
      text("small", `${Math.round(100 * moment.score)} %`, item);
      button.addEventListener("click", () => keepFound(moment));
    }
  } catch (reason) {
    if (!reason.cancelled) answer(reason.message);
  }
});
/** Puts a moment on the timeline, with some time before and after it to which its bar can be drawn out. */
async function keepFound({ number }) {
  try {
    const { name, bytes, from, seconds } = await engine.ask("moment", { motion: number });
    const file = new File([typeof bytes === "string" ? unpackedBytes(bytes) : bytes], name);
    await keepMotion(file, { from, seconds });
    element("findDialog").close();
  } catch (reason) {
    if (!reason.cancelled) element("findSays").textContent = reason.message;
  }
}
)page";

}  // namespace detail

MOTIONLANG_NAMESPACE_END
