// SPDX-License-Identifier: MIT
// Bodies of guo_matching_training.hpp.
#pragma once

#include <motionlang/train/guo_matching_training.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string tagged_text(const DescribedText& t) {
  std::string out;
  for (const TaggedWord& w : t.words) out += (out.empty() ? "" : " ") + w.word + "/" + w.tag;
  return out.empty() ? t.text : out;
}

MOTIONLANG_BODY std::vector<TextEntry> guo_entries(const std::vector<DescribedMotion>& part, Index width) {
  if (part.empty()) return {};
  const auto all = text_entries(part, "data");
  std::vector<Index> lengths;
  lengths.reserve(all.size());
  for (const TextEntry& e : all) lengths.push_back(e.frames.length);
  std::vector<TextEntry> out;
  for (const Index i : guo_kept_clips(lengths, guo_clip_limits(width == 251)))
    out.push_back(all[static_cast<std::size_t>(i)]);
  return out;
}

MOTIONLANG_BODY GuoSample guo_sample(const TextEntry& e, Philox& rng) {
  const DescribedText* const text = e.texts[rng.below(static_cast<std::uint32_t>(e.texts.size()))];
  const Index length = guo_item_frames(e.frames.length, rng.below(3) == 2);
  return {text, {static_cast<Index>(rng.below(static_cast<std::uint32_t>(e.frames.length - length + 1))), length}};
}

namespace detail {

MOTIONLANG_BODY std::vector<TextEntry> guo_training_entries(const DescribedMotions& data) {
  auto out = guo_entries(data.training, data.width);
  const GuoClipLimits limits = guo_clip_limits(data.width == 251);
  if (out.size() < 2)
    raise<config_error>(102, "of the motions to train on, ", counted(out.size(), "text"), " with ", limits.least,
                        " to ", limits.below - 1, " frames: two are needed");
  return out;
}

MOTIONLANG_BODY void require_guo_widths(Index motions, Index encoder, Index statistics) {
  constexpr Index contacts = 4;
  if (encoder != motions - contacts)
    raise<config_error>(102, "the movement encoder reads ", counted(encoder, "number"), ", the motions have ", motions,
                        " and ", contacts, " of them are contacts");
  if (statistics != motions)
    raise<config_error>(102, "the statistics have ", counted(statistics, "number"), ", the motions have ", motions);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
