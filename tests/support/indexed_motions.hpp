// SPDX-License-Identifier: MIT
/// Collections of made-up clips under a hand-made encoder, for tests of searches: a frame is one of a few actions, and
/// a window of frames is encoded as how often each of them occurs in it, and a constant, so that of two windows with
/// one action alone the longer one is nearer to it.
#pragma once

#include <motionlang/search/motion_search.hpp>

namespace synthetic {

namespace ml = motionlang;
using ml::Index;

inline constexpr Index actions = 8, vector_width = actions + 1;

inline ml::IndexModel action_model(std::vector<Index> windows = {20, 40, 60}, Index stride = 5) {
  return {.id = "0123456789abcdef",
          .path = "models/actions",
          .width = vector_width,
          .fps = 20,
          .windows = std::move(windows),
          .stride = stride};
}
/// An action alone.
inline std::vector<float> action_vector(Index action) {
  std::vector<float> out(vector_width);
  out[static_cast<std::size_t>(action)] = 1;
  return out;
}
inline std::vector<float> encode_actions(std::span<const Index> frames) {
  std::vector<float> out(vector_width);
  out.back() = 6;
  for (const Index action : frames) ++out[static_cast<std::size_t>(action)];
  return out;
}

/// A clip in which one action follows another: pairs of an action and its number of frames.
inline ml::EncodedClip acted_clip(const std::string& path, std::initializer_list<std::pair<Index, Index>> parts,
                                  const ml::IndexModel& model, std::vector<Index> captions = {}) {
  std::vector<Index> frames;
  for (const auto& [action, count] : parts) frames.insert(frames.end(), static_cast<std::size_t>(count), action);
  const Index n = std::ssize(frames);
  ml::EncodedClip out{.clip = {.path = path,
                               .modified = 1'000'000'007,
                               .bytes = 10 * n,
                               .end = static_cast<double>(n) / model.fps,
                               .fps = 2 * model.fps,
                               .frames = 2 * n},
                      .vector = encode_actions(frames)};
  out.moments = ml::indexed_moments(n, model);
  for (const ml::FrameSlice& m : out.moments) {
    const auto v = encode_actions(
        std::span(frames).subspan(static_cast<std::size_t>(m.first), static_cast<std::size_t>(m.length)));
    out.moment_vectors.insert(out.moment_vectors.end(), v.begin(), v.end());
  }
  for (const Index c : captions) {
    out.clip.captions.push_back("action " + std::to_string(c));
    const auto v = action_vector(c);
    out.caption_vectors.insert(out.caption_vectors.end(), v.begin(), v.end());
  }
  return out;
}

}  // namespace synthetic
