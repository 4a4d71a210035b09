// SPDX-License-Identifier: MIT
// Bodies of inspect_folder.hpp.
#pragma once

#include <algorithm>  // count_if
#include <array>      // strips of each fault
#include <cstdio>     // about a motion
#include <set>        // names of copies
#include <utility>    // move

#include <motionlang/core/formatted.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/input_files.hpp>
#include <motionlang/view/film_strip.hpp>
#include <motionlang/view/inspect_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

class FolderInspection {
 public:
  FolderInspection(const std::vector<std::filesystem::path>& files, std::filesystem::path folder,
                   const InspectFolderOptions& options, std::string* notes)
      : o_(options), folder_(std::move(folder)), inputs_(files), notes_(notes) {}

  void add(const std::filesystem::path& file) {
    const std::string name = file.lexically_relative(folder_).string();
    std::vector<Motion> motions;
    const auto read = [&] { motions = read_motions(file, options_for_file(o_.read, file), notes_); };
    const auto note_values = [&](const numeric_error& e) {
      found_.push_back({name, "", {}, {{Fault::not_finite, e.what()}}, {}});
      return true;
    };
    guard<error>([&] { guard<numeric_error>(read, note_values); },
                 [&](const error& e) {
                   found_.push_back({name, "", e.what(), {}, {}});
                   return true;
                 });
    const bool several = is_gltf(file) || motions.size() > 1;
    for (const Motion& m : motions) {
      Inspection seen = inspect_motion(m);
      if (!o_.clean.empty()) clean(m, seen, several ? name + " " + safe_file_name(m.name) + ".bvh" : name);
      found_.push_back({several ? name + " " + m.name : name, about(m), {}, std::move(seen.findings), {}});
      if (wants_strip(found_.back())) found_.back().strip = film_strip_svg(m, {}, {.title = found_.back().name});
    }
  }
  std::vector<InspectedMotion> found() && { return std::move(found_); }

 private:
  static std::string about(const Motion& m) {
    char text[96];
    std::snprintf(text, sizeof text, "%.2f s, %g frames per second, %s", m.seconds(), m.fps,
                  counted(m.skeleton.size(), "joint").c_str());
    return text;
  }
  /// The first few motions of every fault.
  bool wants_strip(const InspectedMotion& m) {
    bool wanted = false;
    for (const Finding& f : m.findings) {
      const bool drawable = f.fault != Fault::not_finite && f.fault != Fault::empty;
      if (drawable && drawn_[static_cast<std::size_t>(f.fault)]++ < o_.strips) wanted = true;
    }
    return wanted;
  }
  /// Writes a copy as BVH, a.npz.bvh for a.npz, unless there is nothing to write.
  void clean(const Motion& motion, const Inspection& seen, const std::string& name) {
    if (seen.has(Fault::not_finite) || seen.has(Fault::empty)) return;
    const std::string stem =
        file_kind(name) == ".bvh" ? std::filesystem::path(name).replace_extension().string() : name;
    const std::filesystem::path path = o_.clean / (unique_name(stem, copies_) + ".bvh");
    inputs_.refuse(path);
    std::filesystem::create_directories(path.parent_path());
    write_motion(path, mended(motion, seen.cure));
  }

  const InspectFolderOptions& o_;
  std::filesystem::path folder_;
  InputFiles inputs_;
  std::string* notes_;
  std::vector<InspectedMotion> found_;
  std::set<std::string> copies_;
  std::array<int, fault_info.size()> drawn_{};
};

}  // namespace detail

MOTIONLANG_BODY std::vector<InspectedMotion> inspect_files(const std::vector<std::filesystem::path>& files,
                                                           const std::filesystem::path& folder,
                                                           const InspectFolderOptions& options, Progress progress,
                                                           std::string* notes) {
  detail::FolderInspection inspection(files, folder, options, notes);
  Index done = 0;
  for (const auto& file : files) {
    inspection.add(file);
    progress(++done, std::ssize(files));
  }
  return std::move(inspection).found();
}

MOTIONLANG_BODY std::vector<InspectedMotion> inspect_folder(const std::filesystem::path& folder,
                                                            const InspectFolderOptions& options, std::string* notes,
                                                            Progress progress) {
  const auto files = motion_files_below(folder, options.clean, notes);
  if (files.empty())
    raise<config_error>(101, "no .bvh, .amc, .npz, .npy, .glb or .vrma file below '", folder.string(), "'");
  return inspect_files(files, folder, options, progress, notes);
}

MOTIONLANG_BODY std::string describe_inspection(const std::vector<InspectedMotion>& found, bool all) {
  std::string out;
  for (const InspectedMotion& m : found) {
    if (m.good() && !all) continue;
    const auto finding = [](const Finding& f) { return concat_text(info(f.fault).name, ": ", f.text); };
    const std::string text =
        m.unreadable.empty() ? join_text(m.findings, "; ", finding) : "unreadable: " + m.unreadable;
    out += m.name + ": " + (text.empty() ? "good" : text) + "\n";
  }
  const auto good = std::count_if(found.begin(), found.end(), [](const InspectedMotion& m) { return m.good(); });
  const auto unreadable =
      std::count_if(found.begin(), found.end(), [](const InspectedMotion& m) { return !m.unreadable.empty(); });
  out += concat_text("\n", counted(found.size(), "motion"), ", ", good, " without a finding\n");
  const auto line = [&](Index count, std::string_view name, std::string_view meaning) {
    if (count > 0) out += formatted("%6td  %-14s ", count, std::string(name).c_str()) + std::string(meaning) + "\n";
  };
  line(unreadable, "unreadable", "the line of the file says why");
  const auto count = count_faults(found);
  for (std::size_t i = 0; i < count.size(); ++i)
    line(count[i], fault_info[i].name,
         std::string(fault_info[i].meaning) + (fault_info[i].mendable ? " (`clean` mends)" : ""));
  return out;
}

MOTIONLANG_NAMESPACE_END
