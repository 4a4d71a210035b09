#include "search_model.hpp"

#include "search_encoder.hpp"

namespace program {

SearchModel search_model(const std::filesystem::path& folder, const std::filesystem::path& text_encoder) {
  return SearchModel(ml::load_tmr<ml::EigenBackend<float>>(folder, {.text_encoder = text_encoder}));
}

std::shared_ptr<const ml::SearchEncoder> search_encoder(const std::filesystem::path& folder,
                                                        const std::filesystem::path& text_encoder) {
  return std::make_shared<SearchModel>(search_model(folder, text_encoder));
}

}  // namespace program
