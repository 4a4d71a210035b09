// SPDX-License-Identifier: MIT
/// Numbers in the metadata of a file of weights.
#pragma once

#include <map>           // metadata
#include <string>        // messages
#include <string_view>   // numbers
#include <system_error>  // errc

#include <motionlang/core/error.hpp>
#include <motionlang/core/standard_library.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

using Metadata = std::map<std::string, std::string>;

/// Throws config_error 107, with the key and the file, if the text is not a number.
template <class N>
N number_in_metadata(std::string_view text, const std::string& key, const std::string& file) {
  N value{};
  const auto [end, error] = detail::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) {
    raise<config_error>(107, file, ": metadata '", key, "' = '", text, "' is not a number");
  }
  return value;
}
/// The same of an entry. Throws config_error 107 also if it is missing.
template <class N>
N metadata_number(const Metadata& metadata, const std::string& key, const std::string& file) {
  const auto found = metadata.find(key);
  if (found == metadata.end()) raise<config_error>(107, file, ": metadata '", key, "' is missing");
  return number_in_metadata<N>(found->second, key, file);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
