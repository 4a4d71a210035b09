#include "motion_files.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>

#include <motionlang/core/text_lines.hpp>
#include <motionlang/features/guoh3d.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/file/npz.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/amc.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_rig.hpp>
#include <motionlang/formats/mdm_results.hpp>
#include <motionlang/formats/skeleton_table_file.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/view/film_strip.hpp>
#include <motionlang/view/viewer.hpp>

#include <CLI/CLI.hpp>

#include "../formatted.hpp"
#include "../option_checks.hpp"

namespace program {

void MotionReadOptions::add_to(CLI::App& command) {
  command.add_option("--scale", scale, "Metres per unit of BVH files")->check(positive())->capture_default_str();
  command
      .add_option("--rate", rate,
                  "Frames per second of .npy and .amc files, and of .npz files that do not say them; as published "
                  "unless given, .amc 120")
      ->check(positive());
  command
      .add_option("--up", up, "Axis that points up in .npy files with joints; found unless given, of MDM's results y")
      ->check(CLI::IsMember({"y", "z"}));
  command
      .add_option("--asf", asf,
                  "Skeleton of an AMC file, in a folder of those without one beside them; unless given, that of its "
                  "subject beside it or the only one there")
      ->check(CLI::ExistingFile);
  command.add_option("--joints", joints, joints_help)->check(CLI::ExistingFile);
}

void MotionReadOptions::require_for(const std::filesystem::path& file) const {
  const std::string kind = kind_of(file);
  const auto refuse = [&](bool given, bool fits, const char* option, const char* about) {
    if (given && !fits) ml::raise<usage_error>(102, option, " is for ", about, "; ", file.string(), " is not one");
  };
  refuse(scale != MotionReadOptions{}.scale, kind == ".bvh", "--scale", "BVH files");
  refuse(rate != 0, kind == ".npy" || kind == ".amc" || kind == ".npz", "--rate",
         ".npy, .amc and .npz files (--fps resamples, --speed makes faster)");
  refuse(!up.empty(), kind == ".npy", "--up", ".npy files with joints (doctor --clean turns others up)");
  refuse(!asf.empty(), kind == ".amc", "--asf", "AMC files");
}

MotionReadOptions options_in_folder(MotionReadOptions options, const std::filesystem::path& file) {
  if (kind_of(file) == ".amc" && std::filesystem::exists(asf_beside(file))) options.asf.clear();
  if (kind_of(file) == ".npz" && options.rate > 0 && ml::amass_rate(ml::NpzArchive::open(file))) options.rate = 0;
  return options;
}

std::string kind_of(const std::filesystem::path& path) {
  std::string kind = path.extension().string();
  for (char& c : kind) c = ml::detail::lower(c);
  return kind;
}

void require_folder_of(const std::filesystem::path& file) {
  const auto folder = file.parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder))
    ml::raise<ml::io_error>(401, file.string(), ": there is no folder ", folder.string());
}

void make_output_folder(const std::string& option, const std::filesystem::path& folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (!problem && ::access(folder.string().c_str(), W_OK) != 0) problem = {errno, std::generic_category()};
  if (problem) ml::raise<ml::io_error>(401, option, " ", folder.string(), ": ", problem.message());
}

OutputFolder::OutputFolder(const std::string& option, const std::filesystem::path& folder) {
  std::filesystem::path path;
  for (const auto& name : std::filesystem::absolute(folder)) {
    std::error_code unknown;  // make_output_folder says it
    path /= name;
    if (!name.empty() && !std::filesystem::exists(path, unknown)) made_.paths.push_back(path);
  }
  make_output_folder(option, folder);
}
OutputFolder::Made::~Made() {
  for (; !paths.empty(); paths.pop_back()) {
    std::error_code not_empty;
    std::filesystem::remove(paths.back(), not_empty);
  }
}

static const char* about_fbx(std::string_view kind) {
  return kind == ".fbx" ? ": Blender makes FBX of GLB and GLB of FBX, the README has the command" : "";
}

bool is_gltf(const std::filesystem::path& path) {
  const std::string kind = kind_of(path);
  return kind == ".glb" || kind == ".gltf" || kind == ".vrm" || kind == ".vrma";
}

bool is_motion_file(const std::filesystem::path& path) {
  const std::string kind = kind_of(path);
  return kind == ".bvh" || kind == ".amc" || kind == ".npz" || kind == ".npy" || kind == ".glb" || kind == ".vrma";
}

bool has_frames(const std::filesystem::path& npy) {
  try {
    return npy_shape(npy).size() >= 2 || ml::may_be_mdm_motions(npy);
  } catch (const ml::error&) {
    return true;
  }
}

bool is_same_place(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code missing;
  return std::filesystem::weakly_canonical(a, missing) == std::filesystem::weakly_canonical(b, missing) ||
         std::filesystem::equivalent(a, b, missing);
}

namespace {
/// The joints of a data set of features: the same clips once more.
bool is_second_form(const std::filesystem::path& file) {
  const auto folder = file.parent_path();
  return folder.filename() == "new_joints" && is_data_set(folder.parent_path());
}
void tell_skipped(const std::filesystem::path& path, const std::error_code& problem) {
  std::fprintf(stderr, "skipped: %s: %s\n", ml::printable(path.string()).c_str(), problem.message().c_str());
}
/// What ended it before the end of the folder. Links to folders are not followed.
std::error_code add_motion_files(const std::filesystem::path& folder, const std::filesystem::path& results,
                                 std::vector<std::filesystem::path>& files) {
  std::error_code problem;
  for (std::filesystem::directory_iterator at(folder, problem), end; !problem && at != end; at.increment(problem)) {
    const auto& path = at->path();
    std::error_code unknown;
    const auto type = at->status(unknown).type();
    if (type == std::filesystem::file_type::none) {
      tell_skipped(path, unknown);
    } else if (type == std::filesystem::file_type::directory && !at->is_symlink(unknown)) {
      if (!results.empty() && is_same_place(path, results))
        std::fprintf(stderr, "not read: %s, where results go\n", ml::printable(path.string()).c_str());
      else if (const auto inside = add_motion_files(path, results, files))
        tell_skipped(path, inside);
    } else if (type == std::filesystem::file_type::regular && is_motion_file(path) && !is_second_form(path)) {
      if (kind_of(path) != ".npy" || has_frames(path)) files.push_back(path);
    }
  }
  return problem;
}
}  // namespace

std::vector<std::filesystem::path> motion_files_below(const std::filesystem::path& folder,
                                                      const std::filesystem::path& results) {
  std::vector<std::filesystem::path> files;
  if (const auto problem = add_motion_files(folder, results, files))
    ml::raise<ml::io_error>(401, "cannot read the folder ", folder.string(), ": ", problem.message());
  std::sort(files.begin(), files.end());
  return files;
}

std::string file_name(std::string name) {
  for (char& c : name) {
    const bool odd =
        static_cast<unsigned char>(c) < ' ' || std::string_view("/\\:*?\"<>|").find(c) != std::string_view::npos;
    if (odd) c = '_';
  }
  return name;
}

std::string unique(const std::string& name, std::set<std::string>& taken) {
  const auto numbered = [&](int k) { return k == 1 ? name : name + "_" + std::to_string(k); };
  int next = 1;  // found by halves: thousands of animations may have one name
  while (taken.contains(numbered(next))) next *= 2;
  for (int last = next / 2; next - last > 1;) {
    const int middle = (last + next) / 2;
    (taken.contains(numbered(middle)) ? last : next) = middle;
  }
  return *taken.insert(numbered(next)).first;
}

std::filesystem::path asf_beside(const std::filesystem::path& amc) {
  const std::string stem = amc.stem().string();
  const auto of_subject = amc.parent_path() / (stem.substr(0, stem.find('_')) + ".asf");
  const auto folder = amc.has_parent_path() ? amc.parent_path() : std::filesystem::path(".");
  if (std::filesystem::exists(of_subject) || !std::filesystem::is_directory(folder)) return of_subject;
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (kind_of(entry.path()) == ".asf") found.push_back(entry.path());
  }
  return found.size() == 1 ? found.front() : of_subject;
}

namespace {

/// "arm", "hand" and 3 more
std::string listed(const std::vector<std::string>& names) {
  std::string out;
  const std::size_t shown = names.size() > 4 ? 3 : names.size();
  for (std::size_t i = 0; i < shown; ++i)
    out += ml::concat_text(i == 0 ? "" : i + 1 == names.size() ? " and " : ", ", "'", names[i], "'");
  return shown < names.size() ? ml::concat_text(out, " and ", names.size() - shown, " more") : out;
}

/// A line about joints that move along their bones; "" if there are none.
std::string left_out(const std::filesystem::path& path, const std::vector<std::string>& joints, const char* kept) {
  if (joints.empty()) return {};
  return ml::concat_text(path.string(), ": left out is how ", listed(joints), joints.size() == 1 ? " moves" : " move",
                         " away from the joint before: bones keep their ", kept, "\n");
}

/// Reports a joint once, however many animations stretch it.
std::vector<ml::Motion> every_animation(const std::filesystem::path& path, std::optional<double> fps,
                                        std::string* told) {
  const auto file = ml::GlbFile::open(path);
  std::vector<ml::Motion> motions = file.motions(fps);
  std::vector<std::string> stretched;
  std::set<std::string> known;
  for (ml::Index i = 0; i < std::ssize(motions); ++i) {
    for (std::string& joint : file.stretched_joints(i)) {
      if (known.insert(joint).second) stretched.push_back(std::move(joint));
    }
  }
  if (motions.empty()) ml::raise<ml::config_error>(103, path.string(), ": no animation");
  if (told != nullptr) *told += left_out(path, stretched, "length at rest");
  return motions;
}

/// One motion of each ROOT, with its name.
std::vector<ml::Motion> every_root(const std::filesystem::path& path, double scale, std::string* told) {
  const ml::Bvh file = ml::read_bvh(path);
  std::vector<ml::Motion> motions;
  for (int root = 0; root < ml::bvh_roots(file); ++root) {
    motions.push_back(ml::to_motion(file, {.scale = scale, .root = root}));
    motions.back().name = motions.back().skeleton.name(0);
    if (told != nullptr) *told += left_out(path, ml::stretched_joints(file, root), "mean length");
  }
  return motions;
}

ml::Motion read_amc(const std::filesystem::path& path, const MotionReadOptions& options) {
  const auto asf = options.asf.empty() ? asf_beside(path) : std::filesystem::path(options.asf);
  if (options.asf.empty() && !std::filesystem::exists(asf))
    ml::raise<ml::io_error>(401, path.string(), ": there is no skeleton ", asf.string(),
                            ", nor just one other .asf file beside it: convert, strip, view, doctor, index, "
                            "search and describe take it by --asf FILE");
  return ml::read_amc(path, ml::read_asf(asf),
                      options.rate > 0 ? ml::AmcReadOptions{.fps = options.rate} : ml::AmcReadOptions{});
}

}  // namespace

static ml::Motion on_smpl_by(const std::string& joints, const ml::Motion& motion) {
  const ml::SkeletonTable table = ml::read_skeleton_table(joints, motion.skeleton);
  return ml::retarget(motion, ml::SkeletonMap(motion.skeleton, ml::smpl24_skeleton(), table));
}

std::vector<ml::Motion> read_motions(const std::filesystem::path& path, const MotionReadOptions& options,
                                     std::string* told) {
  const std::string kind = kind_of(path);
  std::vector<ml::Motion> motions;
  if (kind == ".bvh")
    motions = every_root(path, options.scale, told);
  else if (kind == ".amc")
    motions.push_back(read_amc(path, options));
  else if (kind == ".npz")
    motions.push_back(ml::read_amass(path, {}, options.rate).motion);
  else if (kind == ".npy")
    motions = ml::read_motions_npy(path, {options.rate, options.up == "y"   ? ml::UpAxis::y
                                                        : options.up == "z" ? ml::UpAxis::z
                                                                            : ml::UpAxis::found});
  else if (is_gltf(path))
    motions = every_animation(path, options.fps, told);
  else
    ml::raise<ml::config_error>(103, path.string(),
                                ": motions are read from .bvh, .amc, .npz, .npy, .glb, .gltf, .vrm and .vrma, not '",
                                kind, "'", about_fbx(kind));
  std::set<std::string> taken;
  for (ml::Motion& m : motions) {
    if (m.name.empty() || motions.size() == 1) m.name = path.stem().string();
    m.name = unique(m.name, taken);
    if (!options.joints.empty()) m = on_smpl_by(options.joints, m);
  }
  return motions;
}

std::string write_motion(const std::filesystem::path& path, const ml::Motion& motion, double bvh_units_per_metre) {
  const std::string kind = kind_of(path);
  if (kind == ".bvh")
    ml::write_bvh(path, motion, {.scale = bvh_units_per_metre});
  else if (kind == ".glb")
    ml::write_glb(path, motion);
  else if (kind == ".npz")
    ml::write_amass(path, on_smpl(motion));
  else if (kind == ".npy")
    ml::write_joints_npy(path, on_joints_of_arrays(motion) ? motion : on_smpl(motion));
  else if (kind == ".html")
    ml::write_viewer(path, motion);
  else if (kind == ".svg")
    ml::write_film_strip(path, motion);
  else if (kind == ".png")
    ml::write_png(path, ml::film_strip_picture(motion));
  else
    ml::raise<usage_error>(103, path.string(),
                           ": motions are written to .bvh, .glb, .npz, .npy, .html, .svg and .png, not '", kind, "'",
                           kind == ".obj" ? ": .obj shows a body, --body says which" : about_fbx(kind));
  return line_about(path, motion);
}

std::string line_about(const std::filesystem::path& path, const ml::Motion& motion) {
  return formatted("%s: %s at %g per second, %.2f s, %s\n", path.string().c_str(),
                   counted(motion.frames(), "frame").c_str(), motion.fps, motion.seconds(),
                   counted(motion.skeleton.size(), "joint").c_str());
}

std::vector<ml::Motion> read_performed_motions(const std::filesystem::path& path, const MotionReadOptions& options) {
  std::string told;
  auto motions = read_motions(path, options, &told);
  for (ml::Motion& m : motions) {
    const ml::Index frames = ml::detect_t_pose_lead_in(m);
    if (frames == 0) continue;
    m = ml::crop(m, frames, m.frames());
    told += formatted("%s: left out %s an inserted T-pose at the start%s\n", path.string().c_str(),
                      frames == 1 ? "is 1 frame of" : formatted("are %td frames of", frames).c_str(),
                      motions.size() == 1 ? "" : (" of " + m.name).c_str());
  }
  std::fputs(told.c_str(), stdout);
  return motions;
}

ml::Motion read_only_performed_motion(const std::filesystem::path& path, const MotionReadOptions& options) {
  auto motions = read_performed_motions(path, options);
  if (motions.size() == 1) return std::move(motions.front());
  std::vector<std::string> names;
  for (const ml::Motion& m : motions) names.push_back(m.name);
  ml::raise<ml::config_error>(102, path.string(), ": one motion is wanted, it has ", motions.size(), " (",
                              ml::join_text(names), "): convert writes each to a file of its own");
}

bool holds_several(const std::filesystem::path& path) { return kind_of(path) == ".glb" || kind_of(path) == ".html"; }

bool holds_together(const std::filesystem::path& path, std::span<const ml::Motion> motions) {
  const auto alike = [&](const ml::Motion& m) { return m.skeleton == motions.front().skeleton; };
  return holds_several(path) && (kind_of(path) != ".glb" || std::ranges::all_of(motions, alike));
}

void write_motions(const std::filesystem::path& path, std::span<const ml::Motion> motions) {
  if (kind_of(path) == ".glb") return ml::write_glb(path, motions);
  std::vector<ml::ViewerMotion> shown;
  for (const ml::Motion& m : motions) shown.push_back({m});
  ml::write_viewer(path, shown);
}

namespace {

struct FeatureRows {
  std::vector<float> values{};
  ml::Index rows = 0;
  double fps = 0;
};
FeatureRows feature_rows(const ml::Motion& motion, const ml::MotionFeatures& f, double fps) {
  if (fps == 0) fps = f.fps;
  const std::vector<double> values = f.from_motion(ml::resample(motion, fps));
  return {{values.begin(), values.end()}, std::ssize(values) / f.width, fps};
}

}  // namespace

std::string write_features(const std::filesystem::path& path, const ml::Motion& motion, const std::string& features,
                           double fps) {
  if (kind_of(path) != ".npy")
    ml::raise<usage_error>(103, path.string(), ": features are written to .npy, not '", kind_of(path), "'");
  const ml::MotionFeatures& f = ml::motion_features(features);
  const FeatureRows made = feature_rows(motion, f, fps);
  ml::write_npy(path, ml::NpyArray::of(std::span<const float>(made.values), {made.rows, f.width}));
  return formatted("%s: %s of %td numbers at %g per second, %.2f s\n", path.string().c_str(),
                   counted(made.rows, "row").c_str(), f.width, made.fps, static_cast<double>(made.rows) / made.fps);
}

std::string write_humanml3d(const std::filesystem::path& folder, const std::string& id, const ml::Motion& motion,
                            const DataSetForm& form, double fps, bool replace) {
  const auto list = folder / "all.txt";
  auto ids = std::filesystem::exists(list) ? ml::read_ids(list) : std::vector<std::string>{};
  auto other = ids.empty() ? std::filesystem::path() : rows_file(folder, ids.front());
  if (!std::filesystem::exists(other) && is_data_set(folder)) {
    const std::filesystem::directory_iterator entries(folder / "new_joint_vecs");
    if (entries != std::filesystem::directory_iterator()) other = entries->path();
  }
  if (std::filesystem::exists(other)) {
    if (const DataSetForm& is = data_set_form_of(other); is.features != form.features)
      ml::raise<ml::config_error>(102, other.string(), ": rows of ", ml::counted(is.form.width(), "number"), " (",
                                  is.features, "), the new clip has rows of ", form.form.width(), " (", form.features,
                                  ")");
  }
  FeatureRows made = feature_rows(motion, ml::motion_features(form.features), fps);
  if (const auto there = rows_file(folder, id);
      !replace && std::filesystem::exists(there) && ml::read_npy(there).to<float>() != made.values)
    ml::raise<ml::config_error>(102, there.string(), ": the clip '", id,
                                "' is there already, of another motion: --replace puts this one in its place");
  ml::HumanMl3dClip clip{id, made.rows, std::move(made.values), {}, {}};
  const std::vector<double> rows(clip.features.begin(), clip.features.end());
  for (const auto& p : ml::guoh3d_joints(std::span<const double>(rows), form.form.joints)) {
    for (const double x : {p.x, p.y, p.z}) clip.joints.push_back(static_cast<float>(x));
  }
  if (std::filesystem::exists(folder / "texts" / (id + ".txt")))
    clip.captions = ml::HumanMl3dFolder(folder).captions(id);
  ml::write_humanml3d_clip(folder, clip, form.form);
  if (std::find(ids.begin(), ids.end(), id) == ids.end()) ids.push_back(id);
  ml::write_ids(list, ids);
  return formatted("%s: clip %s, %s at %g per second, %s\n", folder.string().c_str(), id.c_str(),
                   counted(clip.frames, "frame").c_str(), made.fps, counted(clip.captions.size(), "caption").c_str());
}

RigWriter rig_writer(const RigOptions& options) {
  if (options.file.empty()) return {};
  ml::GlbRig::FindTable find_table = ml::detect_skeleton_table;
  if (!options.joints.empty())
    find_table = [&](const ml::Skeleton& s) { return ml::read_skeleton_table(options.joints, s); };
  return [rig = ml::GlbRig::open(options.file, find_table), options](const std::filesystem::path& path,
                                                                     std::span<const ml::Motion> motions) {
    if (kind_of(path) != ".glb")
      ml::raise<usage_error>(103, path.string(), ": a character (--rig) is written to .glb, not '", kind_of(path), "'");
    if (motions.empty()) ml::raise<ml::config_error>(103, path.string(), ": no motion");
    std::optional<ml::SkeletonMap> map;  // from the first motion's skeleton, unless it is the character's own
    if (motions.front().skeleton != rig.skeleton()) map.emplace(rig.map_from(motions.front().skeleton));
    std::vector<ml::Motion> on_rig;
    for (const ml::Motion& m : motions) {
      on_rig.push_back(m.skeleton == rig.skeleton()         ? m
                       : map && m.skeleton == map->source() ? ml::retarget(m, *map)
                                                            : ml::retarget(m, rig.map_from(m.skeleton)));
    }
    ml::write_glb(path, rig, on_rig, {.keep_animations = !options.drop_animations});
    return ml::concat_text(path.string(), " on ", options.file, "\n",
                           map ? to_string(map->report()) : "all joints follow: it is the motion's own skeleton", "\n");
  };
}

ml::Motion on_smpl(const ml::Motion& motion, ml::RetargetReport* report) {
  const ml::Skeleton &own = motion.skeleton, &smpl = ml::smpl24_skeleton();
  std::vector<std::size_t> from;  // our joint for each of SMPL's
  for (int j = 0; j < smpl.size(); ++j) {
    const int k = own.find(smpl.name(j));
    const bool same = k >= 0 && own.size() == smpl.size() && (j == 0) == (own.parent(k) < 0) &&
                      (j == 0 || own.name(own.parent(k)) == smpl.name(smpl.parent(j)));
    if (!same) {
      const ml::SkeletonMap map(own);
      if (report != nullptr) *report = map.report();
      return ml::retarget(motion, map);
    }
    from.push_back(static_cast<std::size_t>(k));
  }
  ml::Motion out{smpl, motion.fps, motion.root, {}, motion.name};
  for (std::size_t j = 0; j < from.size(); ++j) out.skeleton.offsets[j] = own.offsets[from[j]];
  for (ml::Index f = 0; f < motion.frames(); ++f) {
    for (const std::size_t k : from) out.local.push_back(motion.rotations(f)[k]);
  }
  return out;
}

bool on_joints_of(const ml::MotionFeatures& features, const ml::Motion& motion) {
  const ml::Skeleton &own = motion.skeleton, &wanted = features.skeleton();
  return own.names == wanted.names && own.parents == wanted.parents;
}

bool on_joints_of_arrays(const ml::Motion& motion) {
  return std::ranges::any_of(ml::all_motion_features,
                             [&](const auto& features) { return on_joints_of(features, motion); });
}

ml::Motion on_joints_for(const ml::MotionFeatures& features, const ml::Motion& motion) {
  return on_joints_of(features, motion) ? motion : on_smpl(motion);
}

std::vector<double> rows_of_motion(const ml::MotionFeatures& features, const ml::Motion& motion, double fps) {
  return features.from_motion(ml::resample(on_joints_for(features, motion), fps));
}

}  // namespace program
