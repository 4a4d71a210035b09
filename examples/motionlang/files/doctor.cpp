// motionlang doctor: what is wrong with the motions of a folder, and a cleaned copy of them.
#include <cstdio>
#include <set>

#include <motionlang/file/npy.hpp>
#include <motionlang/view/film_strip.hpp>
#include <motionlang/view/inspection_page.hpp>

#include "../commands.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"
#include "input_files.hpp"
#include "motion_files.hpp"

namespace program {

namespace {

namespace fs = std::filesystem;

struct DoctorOptions {
  std::string folder, report, clean;
  MotionReadOptions read;
  int strips = 3;
  bool all = false;
};

class Doctor {
 public:
  explicit Doctor(const DoctorOptions& options) : o_(options), folder_(options.folder) {}

  void run() {
    if (!o_.clean.empty() && is_same_place(o_.clean, folder_))
      ml::raise<usage_error>(102, "doctor: --clean '", o_.clean, "' is the folder of the originals");
    if (!o_.report.empty()) {
      if (const std::string kind = kind_of(o_.report); kind != ".html" && kind != ".htm")
        ml::raise<usage_error>(103, "doctor: --report '", o_.report, "' is a page: its name ends in .html");
      require_folder_of(o_.report);
    }
    const auto files = motion_files_below(folder_, o_.clean);
    inputs_ = InputFiles(files);
    inputs_.refuse(o_.report);
    if (files.empty())
      ml::raise<ml::config_error>(101, "doctor: no .bvh, .amc, .npz, .npy, .glb or .vrma file below '", o_.folder, "'");
    if (!o_.clean.empty()) make_output_folder("--clean", o_.clean);
    {
      ProgressBar bar("inspecting");
      for (std::size_t i = 0; i < files.size(); ++i) {
        look_at(files[i]);
        if (!bar(static_cast<std::ptrdiff_t>(i) + 1, std::ssize(files))) throw ml::cancelled();
      }
    }
    say();
    if (o_.report.empty()) return;
    ml::write_file(o_.report, ml::inspection_html(found_, "motionlang doctor: " + o_.folder));
    std::printf("Open %s in a browser to see them.\n", fs::absolute(o_.report).string().c_str());
  }

 private:
  void look_at(const fs::path& file) {
    const std::string name = file.lexically_relative(folder_).string();
    const auto motions = readable_motions(file, name);
    const bool several = is_gltf(file) || motions.size() > 1;
    for (const ml::Motion& m : motions) {
      ml::Inspection seen = ml::inspect_motion(m);
      char about[96];
      std::snprintf(about, sizeof about, "%.2f s, %g frames per second, %s", m.seconds(), m.fps,
                    ml::counted(m.skeleton.size(), "joint").c_str());
      if (!o_.clean.empty()) clean(m, seen, several ? name + " " + safe_file_name(m.name) + ".bvh" : name);
      found_.push_back({several ? name + " " + m.name : name, about, {}, std::move(seen.findings), {}});
      if (!o_.report.empty() && wants_strip(found_.back()))
        found_.back().strip = ml::film_strip_svg(m, {}, {.title = found_.back().name});
    }
  }

  /// Returns no motions of a file that cannot be read or whose numbers are not finite, and notes the fault.
  std::vector<ml::Motion> readable_motions(const fs::path& file, const std::string& name) {
    try {
      return read_motions(file, ml::options_for_file(o_.read, file));
    } catch (const ml::numeric_error& e) {
      found_.push_back({name, "", {}, {{ml::Fault::not_finite, e.what()}}, {}});
      return {};
    } catch (const ml::error& e) {
      found_.push_back({name, "", e.what(), {}, {}});
      return {};
    }
  }

  /// The first few motions of every fault get a picture.
  bool wants_strip(const ml::InspectedMotion& m) {
    bool wanted = false;
    for (const ml::Finding& f : m.findings) {
      const bool drawable = f.fault != ml::Fault::not_finite && f.fault != ml::Fault::empty;
      if (drawable && drawn_[static_cast<std::size_t>(f.fault)]++ < o_.strips) wanted = true;
    }
    return wanted;
  }

  /// A copy as BVH, a.npz.bvh of a.npz, unless there is nothing that could be written.
  void clean(const ml::Motion& motion, const ml::Inspection& seen, const std::string& name) {
    if (seen.has(ml::Fault::not_finite) || seen.has(ml::Fault::empty)) return;
    const std::string stem = kind_of(name) == ".bvh" ? fs::path(name).replace_extension().string() : name;
    const fs::path path = fs::path(o_.clean) / (unique_name(stem, copies_) + ".bvh");
    inputs_.refuse(path);
    fs::create_directories(path.parent_path());
    write_motion(path, ml::mended(motion, seen.cure));
  }

  void say() const {
    for (const ml::InspectedMotion& m : found_) {
      if (m.good() && !o_.all) continue;
      const std::string text =
          !m.unreadable.empty() ? "unreadable: " + m.unreadable : ml::join_text(m.findings, "; ", [](const auto& f) {
            return ml::concat_text(ml::info(f.fault).name, ": ", f.text);
          });
      std::printf("%s: %s\n", m.name.c_str(), text.empty() ? "good" : text.c_str());
    }
    const auto good = std::count_if(found_.begin(), found_.end(), [](const auto& m) { return m.good(); });
    std::printf("\n%s, %td without a finding\n", ml::counted(found_.size(), "motion").c_str(), good);
    const auto unreadable =
        std::count_if(found_.begin(), found_.end(), [](const auto& m) { return !m.unreadable.empty(); });
    if (unreadable > 0) std::printf("%6td  %-14s the line of the file says why\n", unreadable, "unreadable");
    const auto count = ml::count_faults(found_);
    for (std::size_t i = 0; i < count.size(); ++i) {
      if (count[i] == 0) continue;
      std::printf("%6td  %-14s %s%s\n", count[i], std::string(ml::fault_info[i].name).c_str(),
                  std::string(ml::fault_info[i].meaning).c_str(), ml::fault_info[i].mendable ? " (--clean mends)" : "");
    }
  }

  const DoctorOptions& o_;
  fs::path folder_;
  InputFiles inputs_;
  std::vector<ml::InspectedMotion> found_;
  std::set<std::string> copies_;                    // their names
  std::array<int, ml::fault_info.size()> drawn_{};  // strips so far
};

}  // namespace

void add_doctor(CLI::App& app) {
  const auto o = std::make_shared<DoctorOptions>();
  CLI::App* c = app.add_subcommand(
      "doctor",
      "Finds what is wrong with the motions of a folder: scale, up axis, sides, T-poses, frame rate, jumps, feet, ...");
  c->add_option("folder", o->folder,
                "Folder with .bvh, .amc, .npz (AMASS), .npy (joints or features), .glb and .vrma files, searched to "
                "the bottom")
      ->required()
      ->check(CLI::ExistingDirectory);
  c->add_option("--report", o->report, "A page (HTML) with the findings and film strips");
  c->add_option("--clean", o->clean, "Folder for copies (.bvh) in which is mended what can be mended");
  c->add_option("--strips", o->strips, "Film strips for each kind of finding on the page")
      ->check(in_range(0, 100))
      ->capture_default_str();
  o->read.add_to(*c);
  c->add_flag("--all", o->all, "Lists motions without a finding, too");
  c->callback([o] { Doctor(*o).run(); });
}

}  // namespace program
