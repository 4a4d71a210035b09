// SPDX-License-Identifier: MIT
/// The begins of the texts in a batch of ids.
#pragma once

#include <motionlang/core/offsets.hpp>
#include <motionlang/text/tokenizer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Throws shape_error 207 if the lengths do not fit the ids.
inline Offsets token_offsets(const TokenBatch& batch) {
  Offsets offsets(batch.lengths);
  if (offsets.rows() != static_cast<Index>(batch.ids.size()))
    raise<shape_error>(207, "TokenBatch: lengths of ", offsets.rows(), " ids, there are ", batch.ids.size());
  return offsets;
}

MOTIONLANG_NAMESPACE_END
