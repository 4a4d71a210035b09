#include "motion_files.hpp"

#include <cstdio>
#include <map>

#include <motionlang/view/convert_motions.hpp>

#include <CLI/CLI.hpp>

#include "../formatted.hpp"
#include "../option_checks.hpp"

namespace program {

void MotionReadOptions::add_to(CLI::App& command) {
  checked_option(command, "--scale", scale, positive(), "Metres per unit of BVH files");
  command
      .add_option("--rate", rate,
                  "Frames per second of .npy and .amc files, and of .npz files that do not state it. The default is "
                  "the published rate; for .amc it is 120")
      ->check(positive());
  static const std::map<std::string, ml::UpAxis> axes{{"y", ml::UpAxis::y},           {"z", ml::UpAxis::z},
                                                      {"x", ml::UpAxis::x},           {"y-down", ml::UpAxis::y_down},
                                                      {"z-down", ml::UpAxis::z_down}, {"x-down", ml::UpAxis::x_down}};
  command
      .add_option_function<std::string>(
          "--up", [this](const std::string& axis) { up = axes.at(axis); },
          "Axis that points up. The default is y; in .npy files with joints the program finds it, and MDM's results "
          "have y. In the coordinates of a camera it is y-down. AMASS files have z")
      ->check(CLI::IsMember(axes));
  file_option(command, "--asf", asf,
              "Skeleton of AMC files. The default is the file of the subject beside the clip, or the only one in "
              "the folder");
  file_option(command, "--joints", joints, joints_help);
}

void MotionReadOptions::require_for(const std::filesystem::path& file) const {
  const std::string kind = kind_of(file);
  const auto refuse = [&](bool given, bool fits, const char* option, const char* about) {
    if (given && !fits) ml::raise<usage_error>(102, option, " is for ", about, "; ", file.string(), " is not one");
  };
  refuse(scale != MotionReadOptions{}.scale, kind == ".bvh", "--scale", "BVH files");
  refuse(rate != 0, kind == ".npy" || kind == ".amc" || kind == ".npz", "--rate",
         ".npy, .amc and .npz files (--fps resamples, --speed makes faster)");
  refuse(up != ml::UpAxis::found, kind != ".npz", "--up", "other files than AMASS, which has Z up");
  refuse(!asf.empty(), kind == ".amc", "--asf", "AMC files");
}

std::vector<std::filesystem::path> motion_files_below(const std::filesystem::path& folder,
                                                      const std::filesystem::path& results) {
  std::string skipped;
  auto files = ml::motion_files_below(folder, results, &skipped);
  std::fputs(skipped.c_str(), stderr);
  return files;
}

std::string write_motion(const std::filesystem::path& path, const ml::Motion& motion, double bvh_units_per_metre) {
  ml::write_motion_or_view(path, motion, {.scale = bvh_units_per_metre});
  return ml::line_about_motion(path, motion);
}

namespace {
/// Lines that are printed at the end, even after an error.
struct PrintedNotes {
  std::string lines{};

  PrintedNotes() = default;
  PrintedNotes(const PrintedNotes&) = delete;
  PrintedNotes& operator=(const PrintedNotes&) = delete;
  ~PrintedNotes() { std::fputs(lines.c_str(), stdout); }
};
}  // namespace

std::vector<ml::Motion> read_performed_motions(const std::filesystem::path& path, ml::MotionReadOptions options) {
  options.drop_lead_in = true;
  PrintedNotes notes;
  return ml::read_motions(path, options, &notes.lines);
}

ml::Motion read_only_performed_motion(const std::filesystem::path& path, ml::MotionReadOptions options) {
  options.drop_lead_in = true;
  PrintedNotes notes;
  return ml::read_motion(path, options, &notes.lines);
}

}  // namespace program
