#include "search_model.hpp"

namespace program {

SearchModel search_model(const std::filesystem::path& folder, const std::filesystem::path& text_encoder) {
  return SearchModel(ml::load_tmr<ml::EigenBackend<float>>(folder, {.text_encoder = text_encoder}));
}

}  // namespace program
