// SPDX-License-Identifier: MIT
/// A gallery of motions as one self-contained HTML page: a card for each, with a small moving figure and its text.
///
///     write_file("gallery.html", gallery_html(cards, {.title = "What it can do"}));
#pragma once

#include <span>    // cards
#include <string>  // texts

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A card of the page.
struct GalleryCard {
  const Motion& motion;
  std::string title;  // the verb
  std::string text;   // the prompt
};

struct GalleryPageOptions {
  std::string title = "Motions";
  std::string info{};  // a line below it: model, seed, ...
};

/// Cards move while they are in view; for readers who ask for less movement, only under the mouse. A field finds cards
/// by their words, dragging turns a figure, and a click enlarges it. One renderer draws all figures.
/// Throws  config_error 101 without a card or a frame, and what viewer_html throws
std::string gallery_html(std::span<const GalleryCard> cards, const GalleryPageOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/gallery_page.ipp>
#endif
