// SPDX-License-Identifier: MIT
// Bodies of studio_page.hpp.
#pragma once

#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/view/detail/page_parts.hpp>
#include <motionlang/view/detail/studio_page_gif.hpp>
#include <motionlang/view/detail/studio_page_search.hpp>
#include <motionlang/view/detail/studio_page_sharing.hpp>
#include <motionlang/view/detail/studio_page_source.hpp>
#include <motionlang/view/detail/viewer_page.hpp>
#include <motionlang/view/studio_page.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The rest pose, which the page shows until there is a motion.
inline Motion rest_motion() {
  Motion out{.skeleton = smpl24_skeleton(), .root = {{}}, .local = {}, .name = "rest"};
  out.local.assign(static_cast<std::size_t>(out.skeleton.size()), Quaternion<double>::identity());
  return out;
}

/// Bytes as text of a page in UTF-8: seven bits a character, the first bit first. A page changes NUL and CR, and '<'
/// ends its scripts, so these three are U+0100, U+010D and U+013C. The text is a sixth longer than the bytes; base64
/// would be a third longer.
MOTIONLANG_BODY std::string seven_bit_text(std::span<const std::byte> bytes) {
  std::string out;
  out.reserve(bytes.size() * 8 / 7 * 21 / 20);
  unsigned held = 0;
  int bits = 0;
  const auto put = [&](unsigned value) {
    if (value == 0 || value == '\r' || value == '<') out += static_cast<char>(0xC4), value |= 0x80;
    out += static_cast<char>(value);
  };
  for (const std::byte b : bytes) {
    held = (held << 8 | std::to_integer<unsigned>(b)) & 0x7fff;
    for (bits += 8; bits >= 7; bits -= 7) put(held >> (bits - 7) & 0x7f);
  }
  if (bits > 0) put(held << (7 - bits) & 0x7f);
  return out;
}

}  // namespace detail

MOTIONLANG_BODY std::string studio_html(const StudioParts& parts) {
  using namespace detail;
  if (!parts.asks_server && (parts.program.empty() || parts.code.empty() || parts.model.empty()))
    raise<config_error>(101, "studio: no ", parts.program.empty() ? "program" : parts.code.empty() ? "code" : "model");
  nlohmann::ordered_json prompts = nlohmann::ordered_json::array();
  for (const StudioPrompt& p : parts.prompts) prompts.push_back({{"text", p.text}, {"seconds", p.seconds}});
  nlohmann::ordered_json page{{"title", parts.title},
                              {"version", MOTIONLANG_VERSION},
                              {"rest", viewer_json(rest_motion(), {}, "")},
                              {"prompts", std::move(prompts)}};
  if (!parts.asks_server) page["program"] = concat_text(parts.program, studio_worker);
  const auto packed = [](std::string_view id, std::span<const std::byte> bytes) {
    if (bytes.empty()) return std::string();
    return concat_text("<script type=\"text/plain\" id=\"", id, "\">", seven_bit_text(bytes), "</script>\n");
  };
  return self_contained_page(
      parts.title, concat_text(page_colours, viewer_style, studio_style),
      concat_text(studio_header, "<div id=\"work\">", viewer_stage, studio_panel, "</div>\n<footer>", viewer_controls,
                  studio_timeline, "</footer>\n", studio_dialog, packed("code", parts.code),
                  packed("model", parts.model), packed("searchConfig", parts.search_config),
                  packed("searchWeights", parts.search_weights)),
      page,
      {viewer_script_pose, viewer_script_draw, viewer_script_player, studio_script_project, studio_script_whole,
       studio_script_engine, studio_script_look, studio_script_takes, studio_script_aids, studio_script_edits,
       studio_script_gif, studio_script_sharing, studio_script_search, studio_script_files},
      parts.asks_server ? "; connect-src 'self'" : " 'wasm-unsafe-eval'; worker-src blob:");
}

MOTIONLANG_NAMESPACE_END
