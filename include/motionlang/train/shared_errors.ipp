// SPDX-License-Identifier: MIT
// Bodies of shared_errors.hpp.
#pragma once

#include <cstdint>  // sizes

#include <motionlang/train/shared_errors.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void put_clips(MessageWriter& out, std::span<const JointErrors::Clip> clips) {
  out.value(std::uint64_t{clips.size()});
  for (const JointErrors::Clip& c : clips) {
    out.value(std::int64_t{c.frames});
    for (const PositionErrors* e : {&c.errors.ape, &c.errors.ave}) {
      out.value(e->root), out.value(e->trajectory);
      out.list(std::span<const double>(e->local)), out.list(std::span<const double>(e->joints));
    }
  }
}
MOTIONLANG_BODY std::vector<JointErrors::Clip> take_clips(MessageReader& in) {
  std::vector<JointErrors::Clip> out;
  for (auto left = in.value<std::uint64_t>(); left > 0; --left) {
    JointErrors::Clip& c = out.emplace_back();
    c.frames = static_cast<Index>(in.value<std::int64_t>());
    for (PositionErrors* e : {&c.errors.ape, &c.errors.ave}) {
      e->root = in.value<double>(), e->trajectory = in.value<double>();
      e->local = in.list<double>(), e->joints = in.list<double>();
    }
  }
  return out;
}

MOTIONLANG_BODY std::vector<bool> shown_items(bool wanted, Index count, const ShownTexts& shows,
                                              const std::function<std::string(Index)>& text_of) {
  std::vector<bool> out;
  for (Index i = 0; i < count; ++i) out.push_back(wanted && (!shows || shows(text_of(i))));
  return out;
}

MOTIONLANG_NAMESPACE_END
