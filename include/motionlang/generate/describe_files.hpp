// SPDX-License-Identifier: MIT
/// Files of motions, described one after the other, and the table of captions that an index and trainings read.
///
///     DescribedFiles described;
///     describe_files(describer, files_to_describe(inputs), {}, {}, described);
///     const std::string table = caption_table(described.parts, "TM2T", described.problems);
#pragma once

#include <filesystem>  // motions
#include <span>        // several of them
#include <string>      // clips
#include <vector>      // motions

#include <motionlang/core/progress.hpp>
#include <motionlang/datasets/data_set_form.hpp>
#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/formats/motion_folder.hpp>
#include <motionlang/generate/motion_describer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A motion file and what a table of captions calls it.
struct FileToDescribe {
  std::filesystem::path path{};
  std::string clip{};
  bool in_folder = false;  // that was named, not the file
};

/// The files, and the motion files of the folders and below. A clip is named by its path below the folder, without the
/// extension unless only that tells it from others.
/// notes   gets a line about each folder and file that was skipped
/// Throws  io_error 401 if a folder cannot be read
std::vector<FileToDescribe> files_to_describe(std::span<const std::string> inputs, std::string* notes = nullptr);

/// Throws option_error 102 if a table could not tell two of them apart.
void require_different_clips(std::span<const FileToDescribe> files);

/// A motion, or a part of a long one, and what is said about it.
struct DescribedMotionPart : DescribedPart {
  FileToDescribe file{};
  std::string name{};  // of one motion of several in the file
};

/// All motions of a file go behind `out`; an .npy file of the model's features as it is. Throws what MotionDescriber
/// and the readers throw; motions before the one that fails stay.
template <Backend B>
void describe_file(const MotionDescriber<B>& describer, const FileToDescribe& file, const MotionReadOptions& read,
                   const Philox& rng, const DescribeOptions& options, std::vector<DescribedMotionPart>& out) {
  const auto add = [&](const std::string& name, std::vector<DescribedPart> parts) {
    for (DescribedPart& part : parts) out.push_back({std::move(part), file, name});
  };
  const Index width = describer.features().width;
  if (file_kind(file.path) == ".npy") {
    if (const auto shape = npy_shape(file.path); shape.size() == 2 && shape[1] == width) {
      add("", describer.describe_rows(detail::read_rows(file.path, {width}, /*any_number=*/true), rng, options,
                                      file.path.string()));
      return;
    }
  }
  const auto motions = read_motions(file.path, file.in_folder ? options_for_file(read, file.path) : read);
  for (std::size_t m = 0; m < motions.size(); ++m)
    add(motions.size() > 1 ? motions[m].name : "",
        describer(motions[m], m == 0 ? rng : rng.split(static_cast<std::uint64_t>(m)), options));
}

/// Descriptions of files, as far as the work has come.
struct DescribedFiles {
  std::vector<DescribedMotionPart> parts{};
  std::vector<std::string> problems{};  // a line about each file that cannot be described
  std::size_t done = 0;                 // files
};

/// Describes files one after the other. Each has random numbers of its own. A file that cannot be described becomes a
/// problem, but the only one an error. Progress counts files.
/// Throws  `cancelled` if progress says so; what was described before stays in `out`
template <Backend B>
void describe_files(const MotionDescriber<B>& describer, std::span<const FileToDescribe> files,
                    const MotionReadOptions& read, const DescribeOptions& options, DescribedFiles& out,
                    const Philox& rng = {}, Progress progress = {}) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto describe = [&] {
      describe_file(describer, files[i], read, rng.split(static_cast<std::uint64_t>(i)), options, out.parts);
    };
    detail::guard<error>(describe, [&](const error& e) {
      if (files.size() > 1) out.problems.push_back(files[i].path.string() + ": " + e.what());
      return files.size() > 1;
    });
    ++out.done;
    progress(static_cast<Index>(out.done), std::ssize(files));
  }
}

/// A table of captions. Parts without words are left out, and so are files of several motions, which a table cannot
/// tell apart.
/// by       the model, for the first line
/// Returns  the table; `problems` gets a line about each part that is left out
std::string caption_table(std::span<const DescribedMotionPart> described, const std::string& by,
                          std::vector<std::string>& problems);

/// Each part with its time, its file and its descriptions, as lines, or as a list in JSON.
std::string described_text(std::span<const DescribedMotionPart> described);
std::string described_json(std::span<const DescribedMotionPart> described);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/describe_files.ipp>
#endif
