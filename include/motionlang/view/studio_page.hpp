// SPDX-License-Identifier: MIT
/// The studio: one self-contained HTML page in which motion is made from texts on a timeline. It holds motionlang as
/// WebAssembly (wasm/wasm.cmake) and the weights of a model, and it asks for nothing.
///
///     const auto code = MappedFile::open("motionlang_wasm.wasm.gz");
///     const auto model = MappedFile::open("stmc_free.safetensors.gz");
///     write_file("studio.html", studio_html({.program = read_file("motionlang_wasm.js"),
///                                            .code = code->bytes(), .model = model->bytes()}));
#pragma once

#include <cstddef>  // code and weights
#include <span>     // code and weights
#include <string>   // texts
#include <vector>   // prompts

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A text that the model knows, which the page offers while somebody writes.
struct StudioPrompt {
  std::string text;
  double seconds = 0;  // that its action takes
};

struct StudioParts {
  std::string program;               // motionlang_wasm.js
  std::span<const std::byte> code;   // motionlang_wasm.wasm, packed by gzip
  std::span<const std::byte> model;  // weights of STMC, .safetensors, packed by gzip
  // TMR, with which the page searches: config.json and weights.safetensors of its folder, packed by gzip; empty: it
  // does not search. Its text.known_captions is "" or "../stmc_free.safetensors", which is `model`
  std::span<const std::byte> search_config{}, search_weights{};
  std::vector<StudioPrompt> prompts{};
  std::string title = "motionlang studio";
  bool asks_server = false;  // the page asks the server that it comes from; it has no program, code and model then
};

namespace detail {
std::string seven_bit_text(std::span<const std::byte> bytes);
}  // namespace detail

/// Throws config_error 101 without program, code or model, unless the page asks a server.
std::string studio_html(const StudioParts& parts);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/studio_page.ipp>
#endif
