// SPDX-License-Identifier: MIT
/// Prompts that show what a model can do: one for each verb of its captions. And their motions.
///
///     const auto prompts = gallery_prompts(read_captions("captions.tsv", "clips"));   // raise both arms, stand still
///     const auto motions = gallery_motions(*model, prompts, {});
#pragma once

#include <cstddef>      // counts
#include <filesystem>   // lists and pages
#include <span>         // prompts
#include <string>       // texts
#include <string_view>  // files
#include <vector>       // prompts

#include <motionlang/datasets/clip_lines.hpp>
#include <motionlang/generate/motion_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct GalleryPrompt {
  std::string verb, text;
  double seconds = 0;  // 0: as long as the action takes (compose/text_timeline.hpp)
  bool operator==(const GalleryPrompt&) const = default;
};

/// A prompt for each verb with which captions command (datasets/caption_card.hpp), verbs with many segments first. Its
/// text is the caption that most segments with this verb have, of these the one with the fewest words. Its length is
/// the median of the segments with that verb, rounded to half seconds, from 2 to 5 s. Whole clips count as 4 s.
/// Adverbs, "be", "do" and "have" are left out.
/// least   segments that show a verb
std::vector<GalleryPrompt> gallery_prompts(std::span<const ClipLine> captions, std::size_t least = 1);
/// The same from the captions that a model remembers: verbs with many captions first, and of each the caption with the
/// fewest words. It lasts as long as its action takes.
/// least   captions that begin with a verb
std::vector<GalleryPrompt> gallery_prompts(const KnownCaptions& captions, std::size_t least = 1);

/// Lines "text # seconds" (compose/timeline_text.hpp), to a millisecond. The verb is the first word. Throws
/// timeline_error 501 ... 504, 507.
std::vector<GalleryPrompt> parse_gallery_prompts(std::string_view text, std::string_view name = "prompts");
/// The lines that parse_gallery_prompts reads. Prompts without seconds get 4. Throws config_error 101 for a text with
/// '#' or a line end.
std::string write_gallery_prompts(std::span<const GalleryPrompt> prompts);

/// The list of prompts beside weights, in their folder: gallery.txt. "" if there is none.
std::filesystem::path gallery_list_beside(const std::filesystem::path& model);

/// Takes out the prompts with words that the model does not know, and those that are far from all captions that it
/// remembers, and returns them. None if the model has neither words nor captions.
std::vector<GalleryPrompt> take_unknown_prompts(std::vector<GalleryPrompt>& prompts, const MotionModel& model);

/// One motion for each prompt, with the text as its name. Each is the motion that `motionlang generate` makes of the
/// text with the same seed: what ends is made once. The notes of the options have no effect. Progress counts prompts.
/// Throws what generate_motion throws.
std::vector<Motion> gallery_motions(const MotionModel& model, std::span<const GalleryPrompt> prompts,
                                    const GenerateOptions& options);

/// The files of a gallery.
struct GalleryFileOptions {
  std::string title = "Motions", info{};  // of the page
  std::size_t pictured = 64;              // motions in the picture, the first ones
  int columns = 8, poses = 2;             // of the picture
};
inline constexpr const char *gallery_page_name = "gallery.html", *gallery_picture_name = "gallery.svg";
/// Writes the page (view/gallery_page.hpp) and the picture (view/contact_sheet.hpp) of the motions of prompts into a
/// folder. Throws shape_error 204 for another number of motions, and what the writers throw.
void write_gallery(const std::filesystem::path& folder, std::span<const Motion> motions,
                   std::span<const GalleryPrompt> prompts, const GalleryFileOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/gallery_prompts.ipp>
#endif
