// SPDX-License-Identifier: MIT
/// The data in a page of view/, which its program reads.
#pragma once

#include <string>
#include <string_view>

#include <motionlang/file/json.hpp>

inline nlohmann::json data_of(const std::string& page) {
  const std::string_view open = "id=\"data\">";
  const std::size_t from = page.find(open) + open.size();
  return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
}
