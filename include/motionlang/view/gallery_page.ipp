// SPDX-License-Identifier: MIT
// Bodies of gallery_page.hpp.
#pragma once

#include <motionlang/view/detail/gallery_page_source.hpp>
#include <motionlang/view/detail/page_parts.hpp>
#include <motionlang/view/detail/viewer_page.hpp>
#include <motionlang/view/gallery_page.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string gallery_html(std::span<const GalleryCard> cards, const GalleryPageOptions& options) {
  using namespace detail;
  if (cards.empty()) raise<config_error>(101, "gallery: no motion to show");
  SharedMotions motions;
  for (const GalleryCard& c : cards) {
    Motion named = c.motion;
    named.name = c.title;
    motions.add("gallery", named, {}, c.text);
  }
  nlohmann::ordered_json page{{"title", options.title}, {"info", options.info}};
  std::move(motions).put_into(page);
  return self_contained_page(options.title, concat_text(page_colours, gallery_style), gallery_body, page,
                             {viewer_script_pose, viewer_script_draw, viewer_script_shared, gallery_script});
}

MOTIONLANG_NAMESPACE_END
