// SPDX-License-Identifier: MIT
/// Sequences of symbols, packed like Sequences<B>, for models that read and write words or motion tokens.
#pragma once

#include <span>    // lists
#include <vector>  // ids

#include <motionlang/core/offsets.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct IdSequences {
  std::vector<Index> ids;
  Offsets offsets;

  IdSequences() = default;
  /// Throws shape_error 207 unless the offsets end at the last id.
  IdSequences(std::vector<Index> list, const Offsets& o);
  static IdSequences from(const std::vector<std::vector<Index>>& lists);
  static IdSequences one(std::span<const Index> list) {
    return {{list.begin(), list.end()}, Offsets{std::ssize(list)}};
  }
  /// Rows of `width` ids, without those that equal `pad`. Throws shape_error 205 unless they are whole rows.
  static IdSequences from_padded(std::span<const Index> padded, Index width, Index pad);

  Index count() const { return offsets.count(); }
  std::span<const Index> operator[](Index i) const {
    return std::span(ids).subspan(static_cast<std::size_t>(offsets.begin(i)),
                                  static_cast<std::size_t>(offsets.length(i)));
  }
  /// Each without its first or last ids, for example the symbols to predict and those before them. Throws shape_error
  /// 207 for a sequence that is shorter.
  IdSequences without_ends(Index first, Index last) const;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/tensor/id_sequences.ipp>
#endif
