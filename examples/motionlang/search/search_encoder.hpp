// The search model behind its interface, for commands that need no more of it.
#pragma once

#include <filesystem>
#include <memory>

#include <motionlang/search/search_encoder.hpp>

namespace program {

namespace ml = motionlang;

/// As search_model of search_model.hpp.
std::shared_ptr<const ml::SearchEncoder> search_encoder(const std::filesystem::path& folder,
                                                        const std::filesystem::path& text_encoder = "");

}  // namespace program
