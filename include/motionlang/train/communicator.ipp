// SPDX-License-Identifier: MIT
// Bodies of communicator.hpp.
#pragma once

#include <algorithm>  // min
#include <cstdint>    // sizes of texts

#include <motionlang/core/instruction_set.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/train/communicator.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A value as the bytes of a message.
template <class T>
std::span<std::byte> message_of(T& value) {
  return std::as_writable_bytes(std::span(&value, 1));
}

}  // namespace detail

MOTIONLANG_BODY std::string text_of_first(const AnyCommunicator& c, std::string text) {
  std::uint64_t size = text.size();
  c.broadcast(detail::message_of(size), 0);
  text.resize(size);
  c.broadcast(std::as_writable_bytes(std::span(text)), 0);
  return text;
}

MOTIONLANG_BODY std::vector<std::string> lines_of_first(const AnyCommunicator& c,
                                                        const std::vector<std::string>& lines) {
  if (c.size() == 1) return lines;
  std::vector<std::string> out;
  detail::for_each_line(text_of_first(c, join_text(lines, "\n")),
                        [&](std::string_view line, Index) { out.emplace_back(line); });
  return out;
}

MOTIONLANG_BODY bool answer_of_first(const AnyCommunicator& c, bool answer) {
  auto sent = static_cast<unsigned char>(answer);
  c.broadcast(detail::message_of(sent), 0);
  return sent != 0;
}

MOTIONLANG_BODY Index first_other_text(const AnyCommunicator& c, const std::string& text) {
  const std::string first = text_of_first(c, text);
  auto same = static_cast<unsigned char>(text == first);
  std::int64_t other = -1;
  if (c.rank() > 0) c.send(detail::message_of(same), 0);
  for (Index r = 1; c.rank() == 0 && r < c.size(); ++r) {
    c.receive(detail::message_of(same), r);
    if (same == 0 && other < 0) other = r;
  }
  c.broadcast(detail::message_of(other), 0);
  return static_cast<Index>(other);
}

MOTIONLANG_BODY std::string kernels_in_use() {
  using detail::Isa;
  int best = 0;
  for (const Isa isa : {Isa::avx2, Isa::avx512, Isa::avx512_bf16, Isa::amx}) {
    if (detail::processor_has(isa)) best = static_cast<int>(isa);
  }
  constexpr const char* names[] = {"portable", "avx2", "avx512", "avx512_bf16", "amx"};
  return names[std::min(best, static_cast<int>(detail::wanted_isa()))];
}

MOTIONLANG_NAMESPACE_END
