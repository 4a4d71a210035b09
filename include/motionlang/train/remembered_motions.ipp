// SPDX-License-Identifier: MIT
// Bodies of remembered_motions.hpp.
#pragma once

#include <map>  // segments of captions

#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/train/learned_captions.hpp>
#include <motionlang/train/remembered_motions.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY MotionMemory remembered_motions(const KnownCaptions& known, const TrainingSet& data,
                                                std::span<const std::string> words) {
  if (known.empty())
    raise<config_error>(102, "remembered_motions: the model knows no captions, so no text would find a motion");
  const std::vector<std::size_t> chosen = data.saying(words);
  const auto actions = segment_actions(data.segments());
  std::vector<Motion> motions;
  std::map<std::string, std::vector<std::size_t>> of_caption;  // places in `chosen`
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const CaptionedSegment& s = data.segments()[chosen[i]];
    motions.push_back(crop(s.motion, 0, s.action));
    for (const std::string& caption : s.captions) of_caption[caption].push_back(i);
  }
  std::vector<std::string> captions;
  std::vector<KnownAction> of_captions;
  for (const auto& [caption, places] : of_caption) {
    KnownAction action = actions[chosen[places.front()]];
    action.seconds = 0;
    for (const std::size_t i : places) action.seconds += motions[i].seconds() / static_cast<double>(places.size());
    captions.push_back(caption);
    of_captions.push_back(std::move(action));
  }
  KnownCaptions with = known.with_captions(captions, of_captions);
  std::vector<RememberedMotion> remembered;
  const auto& texts = with.table().texts();
  for (std::size_t row = 0; row < with.actions().size(); ++row) {
    const auto found = of_caption.find(texts[row]);
    if (found == of_caption.end()) continue;
    for (const std::size_t i : found->second) remembered.push_back({static_cast<Index>(row), static_cast<Index>(i)});
  }
  return {std::move(with), std::move(motions), std::move(remembered)};
}

MOTIONLANG_NAMESPACE_END
