// SPDX-License-Identifier: MIT
// Bodies of searched_folder.hpp.
#pragma once

#include <algorithm>     // clamp, max, min
#include <system_error>  // error_code
#include <utility>       // move

#include <motionlang/file/project_folder.hpp>
#include <motionlang/kinematics/edit_motion.hpp>
#include <motionlang/search/motion_index_file.hpp>
#include <motionlang/search/searched_folder.hpp>
#include <motionlang/search/text_answer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline std::filesystem::path searched_place(const FilePath& folder) {
  std::error_code failed;
  if (!std::filesystem::is_directory(folder.string(), failed))
    raise<io_error>(401, folder.string(), ": there is no such folder");
  return indexed_path(folder);
}
inline std::shared_ptr<const SearchEncoder> given_encoder(std::shared_ptr<const SearchEncoder> encoder) {
  if (!encoder) raise<config_error>(101, "SearchedFolder: no encoder");
  return encoder;
}

}  // namespace detail

MOTIONLANG_BODY FolderPiece piece_of_file(const std::filesystem::path& file, const std::string& animation, double start,
                                          double end, double margin) {
  for (Motion& whole : read_motions(file, options_for_file({}, file))) {
    if (!animation.empty() && whole.name != animation) continue;
    const double from = std::max(start - margin, 0.0), to = std::min(end + margin, whole.seconds());
    const auto first = static_cast<double>(frames_between(whole, from, to).first);
    FolderPiece out{.motion = edit_time(whole, {.from = from, .to = to})};
    const double before = first / whole.fps, length = out.motion.seconds();
    out.start = std::clamp(start - before, 0.0, length);
    out.end = std::clamp(end - before, out.start, length);
    return out;
  }
  raise<io_error>(401, file.filename().string(), ": there is no motion '", animation, "' in it any more");
}

MOTIONLANG_BODY SearchedFolder::SearchedFolder(const FilePath& folder, std::shared_ptr<const SearchEncoder> encoder,
                                               SearchedFolderOptions options)
    : folder_(detail::searched_place(folder)),
      encoder_(detail::given_encoder(std::move(encoder))),
      o_(std::move(options)),
      index_(taken_up()) {}

MOTIONLANG_BODY MotionIndex SearchedFolder::taken_up() const {
  MotionIndex out(index_model(*encoder_, o_.moments));
  if (o_.index.empty() || !is_own_file(o_.index)) return out;
  const auto take = [&] {
    MotionIndex old = read_motion_index(o_.index);
    old.require_model(out.model().id, out.model().path);
    if (old.model().windows != out.model().windows || old.model().stride != out.model().stride) return;
    old.remove_if([&](const IndexedClip& c) { return !is_below(c.path, folder_); });
    out = std::move(old);
  };
  detail::guard<error>(take, [](const error&) { return true; });  // another model's, or damaged
  return out;
}

MOTIONLANG_BODY void SearchedFolder::keep(const IndexReport& report) const {
  if (o_.index.empty() || !report.changed()) return;
  if (!is_own_place(o_.index)) return;  // a write would follow a link
  detail::guard<io_error>([&] { write_motion_index(o_.index, index_); }, [](const io_error&) { return true; });
}

MOTIONLANG_BODY FolderAnswer SearchedFolder::find(const std::string& text, Index top, Progress progress) {
  IndexUpdate update(index_, folder_, *encoder_, {.skip_links = true});
  detail::guard<cancelled>([&] { update.run(progress); },
                           [&](const cancelled&) {
                             keep(update.report());
                             return false;
                           });
  keep(update.report());

  FolderAnswer out{.clips = index_.count(), .skipped = std::ssize(update.report().skipped)};
  if (index_.moments().empty()) return out;
  const TextAnswer answer =
      answer_text(MotionSearch(index_), *encoder_, text, {.top = top, .what = SearchFor::moments});
  out.shown = answer.shown;
  for (const UnknownWord& w : answer.unheard) out.unknown.push_back(w.word);
  for (std::size_t i = 0; i < answer.hits.size(); ++i) {
    const MotionHit& hit = answer.hits[i];
    const IndexedClip& clip = clip_of(index_, hit);
    out.moments.push_back({.file = std::filesystem::path(clip.path).lexically_relative(folder_).generic_string(),
                           .animation = clip.name,
                           .start = hit.start,
                           .end = hit.end,
                           .score = answer.scores[i]});
  }
  return out;
}

MOTIONLANG_BODY FolderPiece SearchedFolder::piece(const FolderMoment& moment, double margin) const {
  std::error_code failed;
  const auto path = (folder_ / moment.file).lexically_normal();
  if (moment.file.empty() || !is_below(path, folder_) || !is_own_file(path) ||
      std::filesystem::weakly_canonical(path, failed) != path || is_linked_motion(path))
    raise<io_error>(401, moment.file, ": there is no such motion in the folder");
  return piece_of_file(path, moment.animation, moment.start, moment.end, margin);
}

MOTIONLANG_NAMESPACE_END
