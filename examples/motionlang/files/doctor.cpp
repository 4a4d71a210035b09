// motionlang doctor: finds faults in the motions of a folder, and writes cleaned copies.
#include <algorithm>
#include <cstdio>

#include <motionlang/core/utf8.hpp>
#include <motionlang/view/inspect_folder.hpp>

#include "../commands.hpp"
#include "../formatted.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"
#include "motion_files.hpp"

namespace program {

namespace {

struct DoctorOptions {
  std::string folder, report, clean;
  MotionReadOptions read;
  int strips = 3;
  bool all = false;
};

void run(const DoctorOptions& o) {
  if (!o.clean.empty() && is_same_place(o.clean, o.folder))
    ml::raise<usage_error>(102, "doctor: --clean '", o.clean, "' is the folder of the originals");
  if (!o.report.empty()) {
    if (const std::string kind = kind_of(o.report); kind != ".html" && kind != ".htm")
      ml::raise<usage_error>(103, "doctor: --report '", o.report, "' is a page: its name ends in .html");
    require_folder_of(o.report);
  }
  const auto files = motion_files_below(o.folder, o.clean);
  ml::InputFiles(files).refuse(o.report);
  if (files.empty())
    ml::raise<ml::config_error>(101, "doctor: no .bvh, .amc, .npz, .npy, .glb or .vrma file below '", o.folder, "'");
  if (!o.clean.empty()) make_output_folder("--clean", o.clean);
  std::string notes;
  auto found = [&] {
    ProgressBar bar("inspecting");
    return ml::inspect_files(
        files, o.folder, {.read = o.read, .clean = o.clean, .strips = o.report.empty() ? 0 : o.strips}, bar, &notes);
  }();
  print(ml::printable(with_options(notes), "\n"));
  for (ml::InspectedMotion& m : found) m.unreadable = with_options(m.unreadable);
  print(with_options(ml::describe_inspection(found, o.all)));
  if (o.report.empty()) return;
  ml::write_file(o.report, ml::inspection_html(found, "motionlang doctor: " + o.folder));
  std::printf("Open %s in a browser to see them.\n", std::filesystem::absolute(o.report).string().c_str());
}

}  // namespace

void add_doctor(CLI::App& app) {
  const auto o = std::make_shared<DoctorOptions>();
  CLI::App* c = app.add_subcommand(
      "doctor",
      "Finds faults of the motions in a folder: scale, up axis, sides, T-poses, frame rate, jumps, feet and others");
  folder_option(*c, "folder", o->folder,
                "Folder with .bvh, .amc, .npz (AMASS), .npy (joints or features), .glb and .vrma files, including its "
                "subfolders")
      ->required();
  c->add_option("--report", o->report, "HTML page for the findings, with film strips");
  c->add_option("--clean", o->clean, "Folder for copies (.bvh) in which the faults are mended as far as possible");
  checked_option(*c, "--strips", o->strips, in_range(0, 100),
                 "Number of film strips on the page for each kind of finding");
  o->read.add_to(*c);
  c->add_flag("--all", o->all, "Also list motions without a finding");
  c->callback([o] { run(*o); });
}

}  // namespace program
