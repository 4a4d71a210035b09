// SPDX-License-Identifier: MIT
/// The meaning of TM2T's motion tokens: a clip of four frames for every code, and the codes of a motion.
///
///     const Tm2t<B> tokenizer = load_tm2t_tokenizer<B>(find_run("tokenizer/model"));
///     for (const TokenClip& clip : token_clips(tokenizer, codes)) write_film_strip("code.svg", clip.motion);
///
/// Source  TM2T (Guo et al., ECCV 2022), figures 3 and 9
#pragma once

#include <algorithm>  // sort
#include <map>        // counts
#include <span>       // codes
#include <string>     // pages
#include <utility>    // codes and counts
#include <vector>     // clips

#include <motionlang/features/feature_rows.hpp>
#include <motionlang/generate/finish_motion.hpp>
#include <motionlang/systems/tm2t.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct TokenClip {
  Index code = 0;
  Motion motion{};  // of the code alone
  Index uses = 0;   // in the motions that were counted
};

/// The codes of a motion on any joints. Throws shape_error 205 for fewer than four frames, and what rows_of_motion
/// throws.
template <Backend B>
std::vector<Index> tokens_of(const Tm2t<B>& model, const Motion& motion) {
  const Index width = model.statistics.mean.size(0);
  const MotionFeatures& features = motion_features(width == 251 ? "kit" : "guoh3d");
  const auto rows = rows_of_motion(features, motion, features.fps);
  const std::vector<typename B::scalar> values(rows.begin(), rows.end());
  const Index frames = std::ssize(rows) / width;
  const auto codes = model.tokens({Tensor<B, 2>::from(values, {frames, width}), Offsets{frames}});
  return codes.ids;
}

/// A clip for each code. Throws shape_error 203 for a code that the model lacks.
template <Backend B>
std::vector<TokenClip> token_clips(const Tm2t<B>& model, std::span<const Index> codes) {
  const Index width = model.statistics.mean.size(0), known = model.vocabulary().codes;
  std::vector<TokenClip> out;
  for (const Index code : codes) {
    if (code < 0 || code >= known) raise<shape_error>(203, "token_clips: code ", code, " of ", known);
    const auto rows = model.motions(IdSequences::from(std::vector<std::vector<Index>>{{code}})).rows;
    const std::vector<double> numbers(rows.span().begin(), rows.span().end());
    out.push_back({code, motion_of_features("guoh3dfeats", numbers, width, width == 251 ? 12.5 : 20), 0});
  }
  return out;
}

/// The codes by how often they occur, the commonest first; equally frequent ones by number.
std::vector<std::pair<Index, Index>> counted_codes(std::span<const std::vector<Index>> motions);

/// The codes to show, with how often they occur in the motions. They are those that are named, else the commonest of
/// the motions, else the first.
/// most   without names: not more than this many;   known  codes of the tokenizer
std::vector<std::pair<Index, Index>> codes_to_show(std::span<const Index> named,
                                                   std::span<const std::vector<Index>> motions, Index most,
                                                   Index known);
/// The clips of such codes. Throws as above.
template <Backend B>
std::vector<TokenClip> token_clips(const Tm2t<B>& model, std::span<const std::pair<Index, Index>> codes) {
  std::vector<Index> numbers;
  for (const auto& [code, uses] : codes) numbers.push_back(code);
  auto out = token_clips(model, std::span<const Index>(numbers));
  for (std::size_t i = 0; i < out.size(); ++i) out[i].uses = codes[i].second;
  return out;
}

/// A self-contained page with a film strip of every clip.
std::string token_page(std::span<const TokenClip> clips, const std::string& title);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/token_clips.ipp>
#endif
