// SPDX-License-Identifier: MIT
/// Errors of generated motions as messages between processes that share a list (train/shared_items.hpp), and which of
/// the motions are shown. TEMOS, SINC and TEACH are measured with them.
///
///     const auto measured = [&](Index i, const Progress&) {
///       MessageWriter out;
///       put_clips(out, sampled.clips(samples_of(i), recorded(i)));
///       return out.bytes();
///     };
///     for (const std::string& message : shared_items(all, count, measured)) {
///       MessageReader in(message);
///       sampled.add(take_clips(in));
///     }
#pragma once

#include <functional>  // which motions
#include <string>      // texts
#include <vector>      // errors

#include <motionlang/features/smplvelp.hpp>
#include <motionlang/metrics/sampled_errors.hpp>
#include <motionlang/train/messages.hpp>

MOTIONLANG_NAMESPACE_BEGIN

void put_clips(MessageWriter& out, std::span<const JointErrors::Clip> clips);
std::vector<JointErrors::Clip> take_clips(MessageReader& in);

/// A motion as a message.
template <Scalar S>
void put_smplvelp(MessageWriter& out, const SmplVelpMotion<S>& motion) {
  out.list(std::span<const Matrix3<S>>(motion.rotations)), out.list(std::span<const Vec3<S>>(motion.trans));
}
template <Scalar S>
SmplVelpMotion<S> take_smplvelp(MessageReader& in) {
  auto rotations = in.list<Matrix3<S>>();
  return {std::move(rotations), in.list<Vec3<S>>()};
}

/// True for a text whose motion should be shown. Every process calls it for all items of a list, in their order, so
/// that it may count them.
using ShownTexts = std::function<bool(const std::string& text)>;
/// The answers for all items; without a function all are shown.
/// wanted  false: none is shown, as nobody receives them
std::vector<bool> shown_items(bool wanted, Index count, const ShownTexts& shows,
                              const std::function<std::string(Index)>& text_of);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/shared_errors.ipp>
#endif
