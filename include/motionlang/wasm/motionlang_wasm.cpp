// SPDX-License-Identifier: MIT
// Functions of motionlang_wasm beside those of motionlang_c.h, for what JavaScript cannot pass itself: 64-bit numbers,
// structs and functions. After every step the module calls its member `progress(done, total)`, if it has one; a falsy
// result stops the work.
#include <emscripten.h>

#include <motionlang/c/motionlang_c.h>

EM_JS(int, motionlang_wasm_progress, (int done, int total),
      { return Module["progress"] && !Module["progress"](done, total) ? 0 : 1; });

extern "C" {

/// seed_low, seed_high     the halves of the seed
/// steps, sampler          as in motionlang_options; 0 and NULL: the model's defaults
/// record, reuse           files, and how far from an edit the reused motion stays as it is; NULL and 0: none
/// keep, keep_from, keep_to, keep_parts   a motion to keep in these seconds; NULL: none
EMSCRIPTEN_KEEPALIVE int motionlang_wasm_generate(const motionlang_model* model, const char* timeline,
                                                  uint32_t seed_low, uint32_t seed_high, int32_t steps,
                                                  const char* sampler, const char* record, const char* reuse,
                                                  double keep_beyond, const motionlang_motion* keep, double keep_from,
                                                  double keep_to, const char* keep_parts, motionlang_motion** motion) {
  const double stretch[] = {keep_from, keep_to};
  motionlang_options options = motionlang_default_options();
  options.seed = uint64_t{seed_high} << 32 | seed_low;
  options.steps = steps;
  options.sampler = sampler;
  options.record = record;
  options.reuse = reuse;
  options.keep_beyond = keep_beyond;
  if (keep != nullptr) {
    options.keep = keep;
    options.keep_seconds = stretch;
    options.keep_stretches = 1;
    options.keep_parts = keep_parts;
  }
  options.progress = [](void*, int64_t done, int64_t total) -> int32_t {
    return motionlang_wasm_progress(static_cast<int>(done), static_cast<int>(total));
  };
  return motionlang_generate(model, timeline, &options, motion);
}

/// Writes frames, kept, work, whole_work and exact of motionlang_motion_reuse.
EMSCRIPTEN_KEEPALIVE void motionlang_wasm_reuse(const motionlang_motion* motion, double* numbers) {
  const motionlang_reuse r = motionlang_motion_reuse(motion);
  const int64_t all[] = {r.frames, r.kept, r.work, r.whole_work, r.exact};
  for (int i = 0; i < 5; ++i) numbers[i] = static_cast<double>(all[i]);
}

EMSCRIPTEN_KEEPALIVE uint32_t motionlang_wasm_size(const motionlang_bytes* bytes) {
  return static_cast<uint32_t>(motionlang_bytes_size(bytes));
}
/// The functions of these names with numbers that JavaScript can pass.
EMSCRIPTEN_KEEPALIVE int motionlang_wasm_known_texts(const motionlang_model* model, const char* begun, int32_t count,
                                                     motionlang_bytes** json) {
  return motionlang_known_texts(model, begun, count, json);
}
EMSCRIPTEN_KEEPALIVE int motionlang_wasm_parse(const void* bytes, uint32_t size, const char* name,
                                               motionlang_motions** motions) {
  return motionlang_parse_motions(bytes, size, name, nullptr, motions);
}
EMSCRIPTEN_KEEPALIVE const motionlang_motion* motionlang_wasm_at(const motionlang_motions* motions, int32_t i) {
  return motionlang_motions_at(motions, i);
}
EMSCRIPTEN_KEEPALIVE int motionlang_wasm_write_on_character(const motionlang_motion* const* motion,
                                                            const char* character, const char* file) {
  return motionlang_write_on_character(motion, 1, character, nullptr, file);
}
EMSCRIPTEN_KEEPALIVE int motionlang_wasm_viewer_data_on(const motionlang_motion* motion, const void* character,
                                                        uint32_t size, const char* name, motionlang_bytes** json) {
  return motionlang_viewer_data_on(motion, character, size, name, json);
}

/// Makes the index of a folder, or updates it. Writes the numbers of clips and of files that could not be read.
EMSCRIPTEN_KEEPALIVE int motionlang_wasm_update_index(const char* index, const char* folder, const char* model,
                                                      double* numbers) {
  motionlang_index_options options = motionlang_default_index_options();
  options.model = model;
  options.progress = [](void*, int64_t done, int64_t total) -> int32_t {
    return motionlang_wasm_progress(static_cast<int>(done), static_cast<int>(total));
  };
  motionlang_index_report report{};
  const int error = motionlang_update_index(index, folder, &options, &report);
  numbers[0] = static_cast<double>(report.clips);
  numbers[1] = static_cast<double>(report.skipped);
  return error;
}
/// The moments that are nearest to words.
EMSCRIPTEN_KEEPALIVE int motionlang_wasm_search(const motionlang_index* index, const char* words, int32_t count,
                                                motionlang_hits** hits) {
  motionlang_search_options options = motionlang_default_search_options();
  options.top = count;
  options.what = MOTIONLANG_SEARCH_MOMENTS;
  return motionlang_search_text(index, words, &options, hits);
}
EMSCRIPTEN_KEEPALIVE int32_t motionlang_wasm_hits_count(const motionlang_hits* hits) {
  return static_cast<int32_t>(motionlang_hits_count(hits));
}
/// Writes start, end and score of motionlang_hit, and its path and name.
EMSCRIPTEN_KEEPALIVE int motionlang_wasm_hit(const motionlang_hits* hits, int32_t i, double* numbers,
                                             const char** texts) {
  motionlang_hit hit{};
  const int error = motionlang_hits_at(hits, i, &hit);
  numbers[0] = hit.start, numbers[1] = hit.end, numbers[2] = hit.score;
  texts[0] = hit.path, texts[1] = hit.name;
  return error;
}
EMSCRIPTEN_KEEPALIVE int motionlang_wasm_hit_motion(const motionlang_hits* hits, int32_t i, double margin,
                                                    double* stretch, motionlang_motion** motion) {
  return motionlang_hits_motion(hits, i, margin, stretch, motion);
}

}  // extern "C"
