// SPDX-License-Identifier: MIT
/// Values of a configuration that must lie in a range.
///
///     require_value("lr", lr, lr >= 0, "0 or more");   // [motionlang.config.101] lr is -1, expected 0 or more
#pragma once

#include <utility>  // names and values

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Throws config_error 101 unless `good`: "lr is -1, expected 0 or more".
template <class T>
void require_value(const char* name, T value, bool good, const char* expected) {
  if (!good) raise<config_error>(101, name, " is ", value, ", expected ", expected);
}

/// Checks the sizes that every transformer has: latent_dim, ff_size, num_heads, num_layers and dropout. Throws
/// config_error 101.
template <class Network>
void require_sizes(const Network& n) {
  for (const auto& [name, size] :
       {std::pair("latent_dim", n.latent_dim), {"ff_size", n.ff_size}, {"num_heads", n.num_heads}})
    require_value(name, size, size >= 1 && size <= 65'536, "1 to 65536");
  require_value("num_layers", n.num_layers, n.num_layers >= 1 && n.num_layers <= 256, "1 to 256");
  require_value("dropout", n.dropout, n.dropout >= 0 && n.dropout < 1, "0 or more, and less than 1");
}

MOTIONLANG_NAMESPACE_END
