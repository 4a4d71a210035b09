// SPDX-License-Identifier: MIT
// Functions of motionlang_wasm beside those of motionlang_c.h, for what JavaScript cannot pass itself: 64-bit numbers,
// structs and functions. After every step the module calls its member `progress(done, total)`, if it has one; a falsy
// result stops the work.
#include <emscripten.h>

#include <motionlang/c/motionlang_c.h>

EM_JS(int, motionlang_wasm_progress, (int done, int total),
      { return Module["progress"] && !Module["progress"](done, total) ? 0 : 1; });

extern "C" {

/// seed_low, seed_high  the halves of the seed
/// steps, sampler       as in motionlang_options; 0 and NULL: the model's defaults
EMSCRIPTEN_KEEPALIVE int motionlang_wasm_generate(const motionlang_model* model, const char* timeline,
                                                  uint32_t seed_low, uint32_t seed_high, int32_t steps,
                                                  const char* sampler, motionlang_motion** motion) {
  motionlang_options options = motionlang_default_options();
  options.seed = uint64_t{seed_high} << 32 | seed_low;
  options.steps = steps;
  options.sampler = sampler;
  options.progress = [](void*, int64_t done, int64_t total) -> int32_t {
    return motionlang_wasm_progress(static_cast<int>(done), static_cast<int>(total));
  };
  return motionlang_generate(model, timeline, &options, motion);
}

EMSCRIPTEN_KEEPALIVE uint32_t motionlang_wasm_size(const motionlang_bytes* bytes) {
  return static_cast<uint32_t>(motionlang_bytes_size(bytes));
}

}  // extern "C"
