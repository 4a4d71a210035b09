// SPDX-License-Identifier: MIT
// Bodies of motion_folder.hpp.
#pragma once

#include <algorithm>  // sort

#include <motionlang/core/utf8.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/file/npz.hpp>
#include <motionlang/formats/amass_sequence.hpp>
#include <motionlang/formats/mdm_results.hpp>
#include <motionlang/formats/motion_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY bool is_same_place(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code missing;
  return std::filesystem::weakly_canonical(a, missing) == std::filesystem::weakly_canonical(b, missing) ||
         std::filesystem::equivalent(a, b, missing);
}

MOTIONLANG_BODY MotionReadOptions options_for_file(MotionReadOptions options, const FilePath& file) {
  if (file_kind(file) == ".amc" && std::filesystem::exists(asf_beside(file).string())) options.asf.clear();
  if (file_kind(file) == ".npz" && options.rate > 0 && amass_rate(NpzArchive::open(file))) options.rate = 0;
  return options;
}

namespace detail {

/// True for the joints of a data set in HumanML3D's form that also has features, which are the same clips.
inline bool is_second_form(const std::filesystem::path& file) {
  const auto folder = file.parent_path();
  return folder.filename() == "new_joints" && std::filesystem::exists(folder.parent_path() / "new_joint_vecs");
}

class MotionFolder {
 public:
  MotionFolder(std::filesystem::path results, std::string* notes) : results_(std::move(results)), notes_(notes) {}

  /// The error that ended it before the end of the folder. Links to folders are not followed.
  std::error_code add(const std::filesystem::path& folder) {
    std::error_code problem;
    for (std::filesystem::directory_iterator at(folder, problem), end; !problem && at != end; at.increment(problem)) {
      const auto& path = at->path();
      std::error_code unknown;
      const auto type = at->status(unknown).type();
      if (type == std::filesystem::file_type::none) {
        note_skipped(path, unknown);
      } else if (type == std::filesystem::file_type::directory && !at->is_symlink(unknown)) {
        if (!results_.empty() && is_same_place(path, results_))
          note(concat_text("not read: ", printable(path.string()), ", where results go\n"));
        else if (const auto inside = add(path))
          note_skipped(path, inside);
      } else if (type == std::filesystem::file_type::regular && is_motion_file(path) && !is_second_form(path)) {
        if (file_kind(path) != ".npy" || may_hold_frames(path)) files.push_back(path);
      }
    }
    return problem;
  }

  std::vector<std::filesystem::path> files{};

 private:
  void note(const std::string& line) {
    if (notes_ != nullptr) *notes_ += line;
  }
  void note_skipped(const std::filesystem::path& path, const std::error_code& problem) {
    note(concat_text("skipped: ", printable(path.string()), ": ", problem.message(), "\n"));
  }

  std::filesystem::path results_;
  std::string* notes_;
};

}  // namespace detail

MOTIONLANG_BODY bool may_hold_frames(const FilePath& npy) {
  bool may = true;
  const auto look = [&] {
    const auto shape = detail::npy_parts(MappedFile::open(npy)->bytes(), npy.string()).header.shape;
    may = shape.size() >= 2 || may_be_mdm_motions(npy);
  };
  detail::guard<error>(look, [](const error&) { return true; });
  return may;
}

MOTIONLANG_BODY std::vector<std::filesystem::path> motion_files_below(const FilePath& folder, const FilePath& results,
                                                                      std::string* notes) {
  detail::MotionFolder found(results.string(), notes);
  if (const auto problem = found.add(folder.string()))
    raise<io_error>(401, "cannot read the folder ", folder.string(), ": ", problem.message());
  std::sort(found.files.begin(), found.files.end());
  return std::move(found.files);
}

MOTIONLANG_NAMESPACE_END
