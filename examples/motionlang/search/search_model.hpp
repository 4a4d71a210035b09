// The search model: TMR, from train-tmr or published.
#pragma once

#include <filesystem>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/search/tmr_search_encoder.hpp>

namespace program {

namespace ml = motionlang;

using SearchModel = ml::TmrSearchEncoder<ml::EigenBackend<float>>;

/// folder        of train-tmr, or the run folder of a published TMR
/// text_encoder  folder of the language model whose states it reads, or a cache of them (.npy); "": it has its own word
///               pieces, or no texts are encoded
/// Throws what load_tmr throws.
SearchModel search_model(const std::filesystem::path& folder, const std::filesystem::path& text_encoder);

}  // namespace program
