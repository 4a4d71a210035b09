// SPDX-License-Identifier: MIT
// Bodies of tokenizer.hpp.
#pragma once

#include <motionlang/text/tokenizer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<Index> TokenBatch::padded(Index pad, Index width) const {
  if (width == 0) width = longest();
  if (width < longest()) raise<shape_error>(204, "padded: width ", width, ", a text of ", longest(), " ids");
  std::vector<Index> out(static_cast<std::size_t>(count() * width), pad);
  auto from = ids.begin();
  for (std::size_t i = 0; i < lengths.size(); from += lengths[i], ++i)
    std::copy_n(from, lengths[i], out.begin() + static_cast<std::ptrdiff_t>(i) * width);
  return out;
}

namespace detail {

MOTIONLANG_BODY AddedTokenSearch::AddedTokenSearch(std::vector<AddedToken> tokens) : tokens_(std::move(tokens)) {
  std::erase_if(tokens_, [](const AddedToken& t) { return t.content.empty(); });
  std::stable_sort(tokens_.begin(), tokens_.end(),
                   [](const AddedToken& a, const AddedToken& b) { return a.content.size() > b.content.size(); });
  for (const AddedToken& t : tokens_) begins_[static_cast<unsigned char>(t.content.front())] = true;
}

MOTIONLANG_BODY const AddedToken* AddedTokenSearch::match(std::string_view text) const {
  for (const AddedToken& t : tokens_) {
    if (text.starts_with(t.content)) return &t;
  }
  return nullptr;
}

MOTIONLANG_BODY TokenPair framed(std::span<const FramePart> frame, std::span<const Index> a, std::span<const Index> b) {
  TokenPair out;
  for (const FramePart& part : frame) {
    if (part.kind == FramePart::token) {
      out.ids.push_back(part.id);
    } else {
      const auto text = part.kind == FramePart::text_a ? a : b;
      out.ids.insert(out.ids.end(), text.begin(), text.end());
    }
    out.types.resize(out.ids.size(), part.type);
  }
  return out;
}

MOTIONLANG_BODY std::size_t frame_size(std::span<const FramePart> frame) {
  return static_cast<std::size_t>(
      std::count_if(frame.begin(), frame.end(), [](const FramePart& p) { return p.kind == FramePart::token; }));
}

MOTIONLANG_BODY std::vector<Index> framed_text(std::string_view tokenizer, std::span<const FramePart> frame,
                                               std::vector<Index> ids, Index longest, bool truncate) {
  const std::size_t around = frame_size(frame), room = static_cast<std::size_t>(longest) - around;
  if (ids.size() > room) {
    if (!truncate) raise<config_error>(101, tokenizer, ": a text of ", ids.size() + around, " ids, at most ", longest);
    ids.resize(room);
  }
  return framed(frame, ids).ids;
}

MOTIONLANG_BODY TokenPair framed_pair(std::string_view tokenizer, std::span<const FramePart> frame,
                                      std::span<const Index> a, std::span<const Index> b, Index longest) {
  TokenPair out = framed(frame, a, b);
  if (std::ssize(out.ids) > longest)
    raise<config_error>(101, tokenizer, ": a text of ", out.ids.size(), " ids, at most ", longest);
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
