// SPDX-License-Identifier: MIT
// Bodies of precision.hpp.
#pragma once

#include <motionlang/backend/detail/kernels.hpp>
#include <motionlang/backend/precision.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {
MOTIONLANG_BODY void use_all_precisions() {
  use_bf16_products();
  tile_products.store(&float_tiles_of, std::memory_order_relaxed);
}
}  // namespace detail

MOTIONLANG_BODY void set_product_precision(Precision p) {
  detail::use_all_precisions();
  detail::current_product_precision().store(p, std::memory_order_release);
}

MOTIONLANG_NAMESPACE_END
