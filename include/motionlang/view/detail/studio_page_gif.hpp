// SPDX-License-Identifier: MIT
/// The source of the studio's page, continued: a writer of animated GIF files. studio_page.hpp puts it between the
/// parts of studio_page_source.hpp.
/// Source  "Graphics Interchange Format, Version 89a" (CompuServe, 1990); Heckbert, "Color Image Quantization for Frame
///         Buffer Display" (SIGGRAPH 1982), whose boxes are cut here where their colours differ most
#pragma once

#include <string_view>  // source

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr std::string_view studio_script_gif = R"page(
// ---- Animated GIF files.

/** The place of a colour of five bits a channel. */
const placeOf = (data, at) => data[at] >> 3 << 10 | data[at + 1] >> 3 << 5 | data[at + 2] >> 3;
/** At most 255 colours for pictures, which are RGBA: the mean colours of boxes that hold the pictures' colours. */
function colours(pictures) {
  const sums = new Map();  // by place: number, red, green, blue
  for (const data of pictures) {
    for (let at = 0; at < data.length; at += 4) {
      const place = placeOf(data, at);
      let sum = sums.get(place);
      if (!sum) sums.set(place, sum = [0, 0, 0, 0]);
      sum[0] += 1;
      for (let c = 0; c < 3; ++c) sum[c + 1] += data[at + c];
    }
  }
  const boxOf = (all) => {
    const count = all.reduce((n, s) => n + s[0], 0);
    const mean = [1, 2, 3].map((c) => all.reduce((n, s) => n + s[c], 0) / count);
    const spread = mean.map((m, c) => all.reduce((n, s) => n + s[0] * (s[c + 1] / s[0] - m) ** 2, 0));
    const widest = spread.indexOf(Math.max(...spread));
    return { all, mean, widest, error: all.length > 1 ? spread[widest] : 0 };
  };
  const boxes = [boxOf([...sums.values()])];
  while (boxes.length < 255) {
    const at = boxes.reduce((best, box, i) => box.error > boxes[best].error ? i : best, 0);
    const { all, mean, widest, error } = boxes[at];
    if (!(error > 0)) break;
    const below = (s) => s[widest + 1] / s[0] < mean[widest];
    boxes.splice(at, 1, boxOf(all.filter(below)), boxOf(all.filter((s) => !below(s))));
  }
  return boxes.map(({ mean }) => mean.map(Math.round));
}
/** The numbers of colours of eight bits, packed by LZW into blocks of at most 255 bytes. */
function packedPixels(pixels) {
  const out = [8], clear = 256, end = 257;  // eight bits a colour at first
  const codes = new Uint16Array(4096 << 8);  // by the code of what came before and the next pixel; 0: none
  let block = [], held = 0, bits = 0, size = 9, next = 258;
  const flush = () => {
    if (block.length) out.push(block.length, ...block);
    block = [];
  };
  const put = (code) => {
    held |= code << bits;
    for (bits += size; bits >= 8; bits -= 8, held >>>= 8) {
      block.push(held & 255);
      if (block.length === 255) flush();
    }
  };
  put(clear);
  let before = pixels[0];
  for (let i = 1; i < pixels.length; ++i) {
    const key = before << 8 | pixels[i];
    if (codes[key]) {
      before = codes[key];
      continue;
    }
    put(before);
    if (next === 4096) {
      put(clear);
      codes.fill(0);
      [size, next] = [9, 258];
    } else {
      if (next === 1 << size) ++size;
      codes[key] = next++;
    }
    before = pixels[i];
  }
  put(before);
  if (next === 1 << size && size < 12) ++size;  // the reader has one entry more by now
  put(end);
  if (bits > 0) block.push(held & 255);
  flush();
  return new Uint8Array([...out, 0]);
}
/** A GIF that repeats without end. add(data) appends a picture, RGBA of this size; of each but the first only what has
    changed is stored. delay: hundredths of a second */
class GifWriter {
  constructor(width, height, palette, delay) {
    Object.assign(this, { width, height, palette, delay, before: null, frames: 0 });
    this.nearest = new Int16Array(1 << 15).fill(-1);  // by place
    const table = new Uint8Array(768);
    palette.forEach((colour, i) => table.set(colour, 3 * i));
    this.parts = [new TextEncoder().encode("GIF89a"), this.words(width, height), [0xf7, 0, 0], table,
                  [0x21, 0xff, 11], new TextEncoder().encode("NETSCAPE2.0"), [3, 1, 0, 0, 0]];
  }
  words(...numbers) { return numbers.flatMap((n) => [n & 255, n >> 8]); }
  colourAt(data, at) {
    const place = placeOf(data, at);
    if (this.nearest[place] < 0) {
      let least = Infinity;
      this.palette.forEach((colour, i) => {
        const away = colour.reduce((sum, x, c) => sum + (x - data[at + c]) ** 2, 0);
        if (away < least) [least, this.nearest[place]] = [away, i];
      });
    }
    return this.nearest[place];
  }
  add(data) {
    const { width, height, before, delay } = this, now = new Uint8Array(width * height), same = 255;
    for (let i = 0; i < now.length; ++i) now[i] = this.colourAt(data, 4 * i);
    let [left, top, right, bottom] = before ? [width, height, 0, 0] : [0, 0, width, height];
    for (let i = 0; before && i < now.length; ++i) {
      if (now[i] === before[i]) continue;
      const x = i % width, y = (i - x) / width;
      left = Math.min(left, x), right = Math.max(right, x + 1), top = Math.min(top, y), bottom = y + 1;
    }
    if (left >= right) [left, top, right, bottom] = [0, 0, 1, 1];  // nothing has changed
    const pixels = new Uint8Array((right - left) * (bottom - top));
    for (let y = top, to = 0; y < bottom; ++y) {
      for (let x = left; x < right; ++x, ++to) {
        const i = y * width + x;
        pixels[to] = before && before[i] === now[i] ? same : now[i];
      }
    }
    this.parts.push([0x21, 0xf9, 4, before ? 5 : 4], this.words(delay), [same, 0, 0x2c],
                    this.words(left, top, right - left, bottom - top), [0], packedPixels(pixels));
    this.before = now;
    ++this.frames;
  }
  async bytes() {
    const blocks = [...this.parts, [0x3b]].map((part) => part instanceof Uint8Array ? part : new Uint8Array(part));
    return new Uint8Array(await new Blob(blocks).arrayBuffer());
  }
}
/** The view as a GIF while the motion plays once, at most 480 pixels wide. */
const saveGif = () => work("Making the GIF.", async () => {
  const usual = { quality, playing, time }, { seconds, fps } = clip, wide = Math.min(480, view.clientWidth);
  const high = Math.max(1, Math.round(wide * view.clientHeight / view.clientWidth));
  const canvas = Object.assign(document.createElement("canvas"), { width: wide, height: high });
  const context = canvas.getContext("2d", { willReadFrequently: true });
  const delay = Math.max(4, Math.round(100 / fps)), count = Math.round(100 * seconds / delay) + 1;
  let cancelled = false;
  making.cancel = () => { cancelled = true; };
  const pictureAt = (at) => {
    seek(at);
    render();
    context.drawImage(view, 0, 0, wide, high);  // the pixels of the view are gone after this task
    return context.getImageData(0, 0, wide, high).data;
  };
  const pause = () => new Promise((resolve) => setTimeout(resolve));
  let writer = null;
  play(false);
  quality = 1;
  try {
    const samples = Array.from({ length: Math.min(8, count) }, (_, i) => pictureAt(seconds * i / 8));
    writer = new GifWriter(wide, high, colours(samples), delay);
    for (let i = 0; i < count && !cancelled; ++i) {
      writer.add(pictureAt(i * delay / 100));
      element("progress").value = i / count;
      element("left").textContent = `picture ${i + 1} of ${count}`;
      await pause();
    }
  } finally {
    ({ quality } = usual);
    seek(usual.time);
    play(usual.playing);
  }
  if (cancelled) throw Object.assign(new Error("cancelled"), { cancelled: true });
  const bytes = await writer.bytes(), name = fileName() + ".gif";
  await keepFile(name, bytes, "image/gif");
  return `${name}: ${writer.frames} pictures, ${Math.ceil(bytes.length / 1000)} kB.`;
});
)page";

}  // namespace detail

MOTIONLANG_NAMESPACE_END
