// SPDX-License-Identifier: MIT
// Bodies of diffusion_items.hpp.
#pragma once

#include <algorithm>  // min

#include <motionlang/train/diffusion_items.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// One of 0 ... largest.
inline Index up_to(Philox& rng, Index largest) {
  return static_cast<Index>(rng.below(static_cast<std::uint32_t>(largest + 1)));
}
inline const DescribedText& random_text(const DescribedMotion& motion, Philox& rng) {
  return motion.texts[static_cast<std::size_t>(up_to(rng, std::ssize(motion.texts) - 1))];
}
/// `length` frames of a slice, from a random one on.
inline FrameSlice random_part(const FrameSlice& of, Index length, Philox& rng) {
  return {of.first + up_to(rng, of.length - length), length};
}

}  // namespace detail

MOTIONLANG_BODY DiffusionItem mdm_smpl_item(const DescribedMotion& motion, Index frames, const MdmSmplItemConfig& items,
                                            double drop, Philox rng) {
  const DescribedText& text = detail::random_text(motion, rng);
  const bool dropped = rng.uniform() < drop;
  if (dropped && rng.uniform() < items.transitions) {
    const Index most = std::min(items.longest, frames), least = std::min(items.shortest, most);
    const Index length = least + detail::up_to(rng, most - least);
    return {"", detail::random_part({0, frames}, length, rng)};
  }
  const Index cut = detail::up_to(rng, static_cast<Index>(items.cut * static_cast<double>(text.frames.length)));
  const Index left = detail::up_to(rng, cut);
  return {dropped ? "" : text.text, {text.frames.first + left, text.frames.length - cut}};
}

MOTIONLANG_BODY DiffusionItem mdm_item(const DescribedMotion& motion, Philox rng, Index unit, Index longest) {
  const DescribedText& text = detail::random_text(motion, rng);
  Index length = text.frames.length < unit ? text.frames.length : text.frames.length / unit * unit;
  if (rng.below(3) == 0 && length > unit) length -= unit;
  return {text.text, detail::random_part(text.frames, std::min(length, longest), rng)};
}

MOTIONLANG_BODY DiffusionItem motiondiffuse_item(const DescribedMotion& motion, Philox rng, Index longest) {
  const DescribedText& text = detail::random_text(motion, rng);
  return {text.text, detail::random_part(text.frames, std::min(text.frames.length, longest), rng)};
}

MOTIONLANG_BODY DiffusionItem first_item(const DescribedMotion& motion, Index longest) {
  const DescribedText& text = motion.texts.front();
  const Index length = longest > 0 ? std::min(text.frames.length, longest) : text.frames.length;
  return {text.text, {text.frames.first, length}};
}

MOTIONLANG_NAMESPACE_END
