// SPDX-License-Identifier: MIT
// Bodies of index_folder.hpp.
#pragma once

#include <algorithm>  // mismatch
#include <chrono>     // times of files
#include <cmath>      // lround

#include <motionlang/core/formatted.hpp>
#include <motionlang/core/parallel.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/file/detail/content_hash.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/search/index_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline std::string checksum_of(std::span<const std::byte> bytes) { return hexadecimal(content_hash(bytes)); }
inline std::string checksum_of_file(const std::filesystem::path& file) {
  return checksum_of(MappedFile::open(file)->bytes());
}
inline std::string checksum_of_lines(const std::vector<ClipLine>& lines) {
  std::string all;
  for (const ClipLine& line : lines) {
    all += concat_text(line.start, "\t", line.end);
    if (!line.animation.empty()) all += "#" + line.animation;
    for (const std::string& text : line.texts) all += "\t" + text;
    all += "\n";
  }
  return checksum_of(std::as_bytes(std::span(all)));
}

/// The first line of the file LICENSE (LICENCE, COPYING, with or without an extension) in a folder, as UTF-8.
inline std::string license_in(const std::filesystem::path& folder, bool skip_links) {
  std::set<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::string name = entry.path().stem().string();
    for (char& c : name) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
    std::error_code none;
    if (skip_links && entry.is_symlink(none)) continue;
    if (entry.is_regular_file(none) && (name == "LICENSE" || name == "LICENCE" || name == "COPYING"))
      found.insert(entry.path());
  }
  if (found.empty()) return {};
  std::string first;
  for_each_line(read_file(*found.begin()), [&](std::string_view line, Index) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t#"), line.size()));
    if (first.empty()) first = printable(utf8_head(line, 200));
  });
  return first;
}

}  // namespace detail

MOTIONLANG_BODY std::filesystem::path indexed_path(const FilePath& path) {
  const std::filesystem::path whole = std::filesystem::weakly_canonical(path.string());
  return whole.has_filename() ? whole : whole.parent_path();
}

MOTIONLANG_BODY bool is_below(const std::filesystem::path& path, const std::filesystem::path& folder) {
  const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return end == folder.end();
}

MOTIONLANG_BODY bool is_linked_motion(const std::filesystem::path& path) {
  std::error_code unknown;
  return std::filesystem::is_symlink(path, unknown) ||
         (file_kind(path) == ".amc" && std::filesystem::is_symlink(asf_beside(path).string(), unknown));
}

MOTIONLANG_BODY Index remove_below(ClipStore& index, const FilePath& path) {
  const std::filesystem::path whole = indexed_path(path);
  return index.remove_if([&](const IndexedClip& c) { return is_below(c.path, whole); });
}

MOTIONLANG_BODY IndexModel index_model(const SearchEncoder& encoder, const MomentOptions& moments) {
  IndexModel out = encoder.model();
  if (moments.windows.empty()) return out;
  for (const double seconds : moments.windows)
    out.windows.push_back(std::max<Index>(1, std::lround(seconds * out.fps)));
  out.stride = std::max<Index>(1, std::lround(moments.stride * out.fps));
  return out;
}

MOTIONLANG_BODY IndexUpdate::IndexUpdate(MotionIndex& index, const FilePath& folder, const SearchEncoder& encoder,
                                         IndexOptions options)
    : IndexUpdate(std::make_shared<StoreOfIndex>(index), folder, encoder, std::move(options)) {}
MOTIONLANG_BODY IndexUpdate::IndexUpdate(ClipStore& index, const FilePath& folder, const SearchEncoder& encoder,
                                         IndexOptions options)
    : IndexUpdate(std::shared_ptr<ClipStore>(std::shared_ptr<void>(), &index), folder, encoder, std::move(options)) {}
MOTIONLANG_BODY IndexUpdate::IndexUpdate(std::shared_ptr<ClipStore> index, const FilePath& folder,
                                         const SearchEncoder& encoder, IndexOptions options)
    : index_(std::move(index)), encoder_(encoder), folder_(indexed_path(folder)), options_(std::move(options)) {
  take_captions();
  look_at_files();
  find_changes();
}

MOTIONLANG_BODY void IndexUpdate::look_at_files() {
  namespace fs = std::filesystem;
  for (const fs::path& path : motion_files_below(folder_, "", &report_.folder_notes)) {
    std::error_code gone;
    if (options_.skip_links && is_linked_motion(path)) continue;
    const auto written = fs::last_write_time(path, gone);
    if (gone) continue;  // since it was listed
    const auto size = fs::file_size(path, gone);
    if (gone) continue;
    const auto time = std::chrono::duration_cast<std::chrono::nanoseconds>(written.time_since_epoch());
    files_.push_back({path.lexically_normal(), time.count(), static_cast<std::int64_t>(size), {}});
  }
}

MOTIONLANG_BODY void IndexUpdate::take_captions() {
  if (options_.captions.empty()) return;
  std::set<std::string> distinct;
  for (ClipLine& line : options_.captions) {
    distinct.insert(line.texts.begin(), line.texts.end());
    const std::filesystem::path path = line.file.empty() ? (folder_ / line.clip).lexically_normal() : line.file;
    lines_of_[path.string()].push_back(std::move(line));
  }
  options_.captions.clear();
  const std::vector<std::string> texts(distinct.begin(), distinct.end());
  const auto vectors = encoder_.encode_texts(texts);
  const auto width = static_cast<std::size_t>(encoder_.model().width);
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const auto row = std::span(vectors).subspan(i * width, width);
    vector_of_[texts[i]].assign(row.begin(), row.end());
  }
}

/// Forgets missing files, renames moved ones, and finds the files to read: new and changed files, and those whose
/// captions have changed.
MOTIONLANG_BODY void IndexUpdate::find_changes() {
  std::map<std::string, IndexedClip> known;  // a clip of each file
  std::set<std::string> now;
  for (const IndexedClip& c : index_->clips()) known.emplace(c.path, c);
  for (const FileToIndex& f : files_) now.insert(f.path.string());
  std::map<std::pair<std::int64_t, std::string>, IndexedClip> moved;  // missing from their old places: time, content
  for (const auto& [path, c] : known) {
    if (!c.content.empty() && is_below(path, folder_) && !now.contains(path)) moved[{c.modified, c.content}] = c;
  }
  std::set<std::string> outdated;
  for (const FileToIndex& f : files_) {
    const std::string path = f.path.string();
    const auto before = known.find(path);
    auto from = moved.end();
    if (!options_.again && before == known.end() && !moved.empty()) {
      const auto look = [&] { from = moved.find({f.modified, detail::checksum_of_file(f.path)}); };
      detail::guard<io_error>(look, [](const io_error&) { return true; });  // reported when it is read
    }
    if (!options_.again && before != known.end() && before->second.modified == f.modified &&
        before->second.bytes == f.bytes && has_lines(before->second, path)) {
      ++report_.unchanged;
      keep(before->second, path);
    } else if (from != moved.end() && has_lines(from->second, path)) {
      index_->rename(from->second.path, path);
      ++report_.renamed;
      keep(from->second, path);
      moved.erase(from);
    } else {
      if (before != known.end()) {
        outdated.insert(path);
        if (!options_.again && before->second.modified == f.modified) license_before_[path] = before->second.license;
      }
      const auto lines = lines_of_.find(path);
      fresh_.push_back(f);
      if (lines != lines_of_.end()) fresh_.back().lines = lines->second;
    }
  }
  report_.removed = index_->remove_if([&](const IndexedClip& c) {
    return outdated.contains(c.path) || (is_below(c.path, folder_) && !now.contains(c.path));
  });
  for (const auto& [clip, lines] : lines_of_) {
    if (!now.contains(clip)) report_.unknown_clips.push_back(clip);
  }
}

/// True if the clips of a file agree with the captions; a file that they do not name stays unchanged.
MOTIONLANG_BODY bool IndexUpdate::has_lines(const IndexedClip& c, const std::string& path) const {
  const auto found = lines_of_.find(path);
  return found == lines_of_.end() || c.lines == detail::checksum_of_lines(found->second);
}

/// A file that is not read again.
MOTIONLANG_BODY void IndexUpdate::keep(const IndexedClip& c, const std::string& path) {
  const std::string license = license_of(path, c.license);
  if (license == c.license) return;
  index_->set_license(path, license);
  ++report_.relicensed;
}

/// The licence from the options, else from the LICENSE file, else from the old index.
MOTIONLANG_BODY std::string IndexUpdate::license_of(const std::filesystem::path& path, const std::string& before) {
  if (!options_.license.empty()) return printable(options_.license);
  const std::string& beside = license_beside(path.parent_path());
  return beside.empty() ? before : beside;
}

/// The license of a folder, or of one above it that is still in the indexed folder.
MOTIONLANG_BODY const std::string& IndexUpdate::license_beside(const std::filesystem::path& folder) {
  const auto [entry, is_new] = licenses_.try_emplace(folder);
  if (!is_new) return entry->second;
  std::string text = detail::license_in(folder, options_.skip_links);
  if (text.empty() && folder != folder_ && is_below(folder, folder_)) text = license_beside(folder.parent_path());
  return licenses_[folder] = std::move(text);
}

MOTIONLANG_BODY void IndexUpdate::run(Progress progress, FileEncoder* others) {
  const auto at_once = static_cast<std::size_t>(others != nullptr ? others->at_once() : 8 * thread_count());
  const std::vector<FileToIndex> fresh = std::exchange(fresh_, {});
  for (std::size_t begin = 0; begin < fresh.size(); begin += at_once) {
    const auto some = std::span(fresh).subspan(begin, std::min(at_once, fresh.size() - begin));
    auto clips =
        others != nullptr ? others->encode(some) : encode_files(some, encoder_, index_->model(), options_.read);
    for (std::size_t f = 0; f < some.size(); ++f) take(some[f], std::move(clips[f]));
    progress(static_cast<Index>(begin + some.size()), std::ssize(fresh));
  }
}

namespace detail {

/// A clip that was read: its rows, or the reason why there are none.
struct ReadClip {
  IndexedClip clip;
  std::vector<float> rows;
  std::string problem;
};

/// The whole motions of a file, or the parts of its motion that the captions name.
inline std::vector<ReadClip> read_clips(const FileToIndex& file, const SearchEncoder& encoder,
                                        const MotionReadOptions& read) {
  std::vector<ReadClip> out;
  if (!is_utf8(file.path.string())) raise<io_error>(404, "the path is not UTF-8; an index keeps only such paths");
  const auto motions = read_motions(file.path, options_for_file(read, file.path));
  const std::string content = checksum_of_file(file.path), lines = file.lines ? checksum_of_lines(*file.lines) : "";
  const auto take = [&](const Motion& m, const ClipLine* line) {
    ReadClip& p = out.emplace_back();
    p.clip.path = file.path.string(), p.clip.modified = file.modified, p.clip.bytes = file.bytes;
    p.clip.content = content, p.clip.lines = lines;
    if (motions.size() > 1) p.clip.name = m.name;
    if (line != nullptr) p.clip.start = line->start, p.clip.captions = line->texts;
    const auto rows = [&] {
      const Motion part = line != nullptr ? segment_of(m, *line, 2) : m;
      part.validate();
      p.clip.end = p.clip.start + part.seconds(), p.clip.fps = part.fps, p.clip.frames = part.frames();
      p.rows = encoder.rows_of(part);
    };
    guard<error>(rows, [&](const error& e) {
      p.problem = e.what();
      return true;
    });
  };
  for (const Motion& m : motions) {
    if (!file.lines)
      take(m, nullptr);
    else
      for (const ClipLine& line : *file.lines) {
        if (line.animation.empty() || line.animation == m.name) take(m, &line);
      }
  }
  return out;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<std::vector<ClipToIndex>> encode_files(std::span<const FileToIndex> files,
                                                                   const SearchEncoder& encoder,
                                                                   const IndexModel& model,
                                                                   const MotionReadOptions& read) {
  std::vector<std::vector<detail::ReadClip>> read_clips(files.size());
  parallel_for(std::ssize(files), [&](Index i) {
    const auto f = static_cast<std::size_t>(i);
    const auto fail = [&](const error& e) {
      read_clips[f] = {{{.path = files[f].path.string()}, {}, e.what()}};
      return true;
    };
    detail::guard<error>([&] { read_clips[f] = detail::read_clips(files[f], encoder, read); }, fail);
  });
  std::vector<std::vector<ClipToIndex>> out(files.size());
  for (std::size_t f = 0; f < files.size(); ++f) {
    for (detail::ReadClip& p : read_clips[f]) {
      ClipToIndex& c = out[f].emplace_back();
      c.clip.clip = std::move(p.clip), c.problem = std::move(p.problem);
      if (!c.problem.empty()) continue;
      const auto encode = [&] {
        c.clip.vector = encode_clip(encoder, p.rows);
        c.clip.moments = indexed_moments(encoder.frames(p.rows), model);
        c.clip.moment_vectors = encoder.encode_windows(p.rows, c.clip.moments);
      };
      detail::guard<numeric_error>(encode, [&](const numeric_error& e) {  // vectors of length 0
        c.problem = e.what();
        return true;
      });
      p.rows = {};
    }
  }
  return out;
}

MOTIONLANG_BODY void IndexUpdate::take(const FileToIndex& file, std::vector<ClipToIndex> clips) {
  const auto before = license_before_.find(file.path.string());
  for (ClipToIndex& c : clips) {
    IndexedClip& clip = c.clip.clip;
    clip.license = license_of(file.path, before != license_before_.end() ? before->second : "");
    const std::string name = clip.path + (clip.name.empty() ? "" : "#" + clip.name);
    const auto put_in = [&] {
      for (const std::string& text : clip.captions) {
        const auto& v = vector_of_.at(text);
        c.clip.caption_vectors.insert(c.clip.caption_vectors.end(), v.begin(), v.end());
      }
      index_->add(std::move(c.clip));
      ++report_.added;
    };
    if (c.problem.empty()) {
      detail::guard<numeric_error>(put_in, [&](const numeric_error& e) {  // vectors of length 0
        c.problem = e.what();
        return true;
      });
    }
    if (!c.problem.empty()) report_.skipped.push_back(name + ": " + c.problem);
  }
}

MOTIONLANG_BODY IndexReport update_index(MotionIndex& index, const FilePath& folder, const SearchEncoder& encoder,
                                         IndexOptions options, Progress progress) {
  IndexUpdate update(index, folder, encoder, std::move(options));
  update.run(progress);
  return update.report();
}

MOTIONLANG_BODY std::string listed_clips(std::span<const IndexedClip> clips) {
  std::string out;
  for (const IndexedClip& c : clips) {
    out += printable(c.path + (c.name.empty() ? "" : "#" + c.name));
    out += formatted("\t%.2f\t%.2f\t%g\t%td\t", c.start, c.end, c.fps, c.frames);
    out += printable(join_text(c.captions, " | ")) + "\t" + printable(c.license) + "\n";
  }
  return out;
}

MOTIONLANG_BODY std::string describe_update(Index clips, Index moments, const IndexReport& report) {
  std::string out = concat_text(counted(clips, "clip"), ", ", counted(moments, "moment"), " (", report.added,
                                " added, ", report.removed, " removed, ", report.renamed, " renamed, ",
                                report.unchanged, " unchanged, ", report.skipped.size(), " skipped)\n");
  if (report.relicensed > 0) out += counted(report.relicensed, "file has", "files have") + " another license now\n";
  return out;
}

MOTIONLANG_NAMESPACE_END
