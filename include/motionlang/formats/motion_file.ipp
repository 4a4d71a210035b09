// SPDX-License-Identifier: MIT
// Bodies of motion_file.hpp.
#pragma once

#include <algorithm>   // all_of, any_of
#include <cmath>       // round
#include <filesystem>  // the skeleton beside a file
#include <memory>      // mapped files

#include <motionlang/core/text_lines.hpp>
#include <motionlang/features/feature_rows.hpp>
#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/zip.hpp>
#include <motionlang/formats/amc.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/formats/mdm_results.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/formats/skeleton_table_file.hpp>
#include <motionlang/formats/vrma.hpp>
#include <motionlang/kinematics/body_root.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/skeleton_tables.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string file_kind(const FilePath& path) {
  std::string kind = std::filesystem::path(path.string()).extension().string();
  for (char& c : kind) c = detail::lower(c);
  return kind;
}

MOTIONLANG_BODY bool is_gltf(const FilePath& path) {
  const std::string kind = file_kind(path);
  return kind == ".glb" || kind == ".gltf" || kind == ".vrm" || kind == ".vrma";
}

MOTIONLANG_BODY bool is_motion_file(const FilePath& path) {
  const std::string kind = file_kind(path);
  return kind == ".bvh" || kind == ".amc" || kind == ".npz" || kind == ".npy" || kind == ".glb" || kind == ".vrma";
}

MOTIONLANG_BODY bool is_written_motion(const FilePath& path) {
  const std::string kind = file_kind(path);
  return kind == ".bvh" || kind == ".glb" || kind == ".vrma" || kind == ".npz" || kind == ".npy";
}

MOTIONLANG_BODY FilePath asf_beside(const FilePath& amc) {
  const std::filesystem::path path = amc.string();
  const std::string stem = path.stem().string();
  const auto of_subject = path.parent_path() / (stem.substr(0, stem.find('_')) + ".asf");
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  if (std::filesystem::exists(of_subject) || !std::filesystem::is_directory(folder)) return of_subject;
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (file_kind(entry.path()) == ".asf") found.push_back(entry.path());
  }
  return found.size() == 1 ? found.front() : of_subject;
}

MOTIONLANG_BODY std::string unique_name(const std::string& name, std::set<std::string>& taken) {
  const auto numbered = [&](int k) { return k == 1 ? name : name + "_" + std::to_string(k); };
  int next = 1;  // by bisection, because thousands of animations may have one name
  while (taken.contains(numbered(next))) next *= 2;
  for (int last = next / 2; next - last > 1;) {
    const int middle = (last + next) / 2;
    (taken.contains(numbered(middle)) ? last : next) = middle;
  }
  return *taken.insert(numbered(next)).first;
}

namespace detail {

MOTIONLANG_BODY std::string wanted_kind(const FilePath& kind) {
  return file_kind(kind.string().starts_with(".") ? FilePath("motion" + kind.string()) : kind);
}

MOTIONLANG_BODY const char* about_fbx(std::string_view kind) {
  return kind == ".fbx" ? ": Blender makes FBX of GLB and GLB of FBX, the README has the command" : "";
}

/// "arm", "hand" and 3 more
inline std::string listed_joints(const std::vector<std::string>& names) {
  std::string out;
  const std::size_t shown = names.size() > 4 ? 3 : names.size();
  for (std::size_t i = 0; i < shown; ++i)
    out += concat_text(i == 0 ? "" : i + 1 == names.size() ? " and " : ", ", "'", names[i], "'");
  return shown < names.size() ? concat_text(out, " and ", names.size() - shown, " more") : out;
}

/// Adds a line about joints that move along their bones, if there are some.
inline void note_stretched(const std::string& file, const std::vector<std::string>& joints, const char* kept,
                           std::string* notes) {
  if (joints.empty() || notes == nullptr) return;
  *notes += concat_text(file, ": left out: how ", listed_joints(joints), joints.size() == 1 ? " moves" : " move",
                        " away from the joint before: bones keep their ", kept, "\n");
}

/// Notes what the motions of a GLB file lack, and how it was read if it is not valid glTF.
inline void note_animations(const GlbFile& file, const std::string& name, std::span<const GlbLoss> losses,
                            std::string* notes) {
  if (notes == nullptr) return;
  for (const std::string& repair : file.repairs()) *notes += concat_text(name, ": ", repair, "\n");
  if (const auto others = file.moving_others(); !others.empty())
    *notes +=
        concat_text(name, ": left out: how ", listed_joints(others),
                    others.size() == 1 ? " moves: it is not a joint" : " move: they are not joints", " of the body\n");
  std::vector<std::string> stretched, still;  // each joint once, even if several animations stretch it
  std::set<std::string> known;
  bool any = false;
  const std::vector<std::string> animations = file.animation_names();
  for (Index i = 0; i < std::ssize(animations); ++i) {
    bool moved = false;
    for (Index figure = 0; figure < file.figures(); ++figure) {
      moved = moved || file.moves(i, figure);
      for (std::string& joint : file.stretched_joints(i, figure)) {
        if (known.insert(joint).second) stretched.push_back(std::move(joint));
      }
    }
    any = any || moved;
    if (!moved) still.push_back(animations[static_cast<std::size_t>(i)]);
  }
  if (!still.empty())
    *notes += concat_text(name, ": ", still.size() == 1 ? "animation " : "animations ", listed_joints(still),
                          still.size() == 1 ? " moves" : " move",
                          " no joint: ", any ? "left out" : "the motion is the rest pose", "\n");
  note_stretched(name, stretched, "length at rest", notes);
  const GlbLoss* worst = nullptr;
  for (const GlbLoss& loss : losses) {
    if (worst == nullptr || loss.distance > worst->distance) worst = &loss;
  }
  const auto rounded = [](double x) { return std::round(x * 1000) / 1000; };
  constexpr double visible = 0.005;  // metres
  if (worst != nullptr && worst->distance > visible)
    *notes += concat_text(name, ": joints are up to ", rounded(worst->distance), " m from where the file has them: '",
                          worst->joint, "' at ", rounded(worst->seconds), " s\n");
  if (std::any_of(losses.begin(), losses.end(), [](const GlbLoss& loss) { return loss.walk_lost; }))
    *notes += concat_text(name, ": the walk is lost: joints that are left out carry the body\n");
}

/// The table of joints that the options name, for skeletons that have these joints; without one the built-in tables.
inline GlbFile::FindTable find_table_of(const MotionReadOptions& options) {
  if (options.joints.empty()) return {};
  return [text = read_file(options.joints), name = options.joints](const Skeleton& s) {
    std::optional<SkeletonTable> table;
    guard<error>([&] { table = parse_skeleton_table(text, s, name); }, [](const error& e) { return e.id() == 103; });
    return table;
  };
}

inline std::vector<Motion> every_animation(std::span<const std::byte> bytes, const std::string& name,
                                           const MotionReadOptions& options, std::string* notes) {
  const GlbFile file(bytes, name, {}, find_table_of(options));
  std::vector<GlbLoss> losses;
  std::vector<Motion> motions = file.motions(options.fps, &losses);
  if (motions.empty()) raise<config_error>(103, name, ": no animation");
  note_animations(file, name, losses, notes);
  return motions;
}

/// One motion of each ROOT, with its name. Beside a body, a ROOT with a few joints is a prop or a camera.
inline std::vector<Motion> every_root(std::span<const std::byte> bytes, const std::string& name,
                                      const MotionReadOptions& options, std::string* notes) {
  constexpr int few = 8;
  const Bvh file = parse_bvh(as_text(bytes), name);
  const auto tell = [&](const auto&... text) {
    if (notes != nullptr) *notes += concat_text(name, ": ", text..., "\n");
  };
  for (const std::string& note : file.notes) tell(note);
  std::vector<Motion> motions;
  motions.reserve(static_cast<std::size_t>(bvh_roots(file)));
  BvhReadOptions read{.scale = options.scale, .find_table = find_table_of(options)};
  for (read.root = 0; read.root < bvh_roots(file); ++read.root) motions.push_back(to_motion(file, read));
  const auto is_body = [&](const Motion& m) {
    return read.find_table ? read.find_table(m.skeleton).has_value() : find_skeleton_table(m.skeleton) != nullptr;
  };
  const bool has_body = motions.size() > 1 && std::any_of(motions.begin(), motions.end(), is_body);
  std::vector<Motion> kept;
  for (int root = 0; root < std::ssize(motions); ++root) {
    Motion& m = motions[static_cast<std::size_t>(root)];
    read.root = root;
    m.name = m.skeleton.name(0);
    if (has_body && m.skeleton.size() < few && !is_body(m)) {
      tell("left out: ROOT '", m.name, "' with ", counted(m.skeleton.size(), "joint"), ", which is not a body");
      continue;
    }
    if (const auto beside = joints_beside_body(file, read); !beside.empty())
      tell("left out: ", listed_joints(beside), " beside '", m.name, "', the root of the body");
    const std::vector<std::string> stretched = stretched_joints(file, read);
    note_stretched(name, stretched, "mean length", notes);
    for (const std::string& joint : stretched) {
      const int j = m.skeleton.find(joint);
      const auto below = j < 0 ? 0 : std::ssize(joints_from(m.skeleton, j)) - 1;
      if (2 * below >= m.skeleton.size())
        tell("with that the walk is lost: '", joint, "' carries ", below, " of the ",
             counted(m.skeleton.size(), "joint"));
    }
    kept.push_back(std::move(m));
  }
  return kept;
}

/// The skeleton of an AMC file.
inline AsfSkeleton asf_of(const std::string& amc, const MotionReadOptions& options) {
  const FilePath asf = options.asf.empty() ? asf_beside(amc) : FilePath(options.asf);
  if (options.asf.empty() && !std::filesystem::exists(asf.string()))
    raise<io_error>(401, amc, ": there is no skeleton ", asf.string(),
                    ", and not exactly one other .asf file beside it; set `asf`");
  return read_asf(asf);
}

inline void require_read_kind(const std::string& name) {
  const std::string kind = file_kind(name);
  if (!is_motion_file(name) && !is_gltf(name))
    raise<config_error>(103, name, ": motions are read from .bvh, .amc, .npz, .npy, .glb, .gltf, .vrm and .vrma, not '",
                        kind, "'", about_fbx(kind));
}

/// Refuses a file that another program or a server wrote instead of a motion.
inline void refuse_other_content(std::span<const std::byte> bytes, const std::string& name) {
  if (bytes.empty()) raise<io_error>(402, name, ": the file is empty");
  const std::string_view text = as_text(bytes.first(std::min<std::size_t>(bytes.size(), 64)));
  std::string start(trim(text));
  for (char& c : start) c = lower(c);
  if (start.starts_with("<!doctype html") || start.starts_with("<html"))
    raise<io_error>(403, name, " is not a motion but a page (HTML), as servers send for a missing file");
  if (start.starts_with("<?xml") || start.starts_with("<error>"))
    raise<io_error>(403, name, " is not a motion but XML, as servers send for a missing file");
  constexpr std::size_t looked_at = 4096;
  const auto head = bytes.first(std::min(bytes.size(), looked_at));
  if (std::all_of(head.begin(), head.end(), [](std::byte b) { return b == std::byte{}; }))
    raise<io_error>(403, name, ": the file begins with zeros, as after a copy that was broken off");
  struct Mark {
    std::string_view begin, what, of;  // of: the kinds that begin with it
  };
  constexpr Mark marks[] = {{"PK\3\4", "a ZIP archive: unpack it first", ".npz"},
                            {"\x1F\x8B", "compressed by gzip: unpack it first", ""},
                            {"7z\xBC\xAF", "a 7z archive: unpack it first", ""},
                            {"Rar!", "a RAR archive: unpack it first", ""},
                            {"\x93NUMPY", "an .npy file: name it so", ".npy"},
                            {"glTF", "a GLB file: name it .glb", ".glb .vrm .vrma .gltf"},
                            {"HIERARCHY", "a BVH file: name it .bvh", ".bvh"}};
  const std::string kind = file_kind(name);
  for (const Mark& mark : marks) {
    if (text.starts_with(mark.begin) && mark.of.find(kind) == mark.of.npos)
      raise<io_error>(403, name, " is ", mark.what);
  }
  if (text.starts_with("Kaydara FBX")) raise<io_error>(403, name, " is an FBX file", about_fbx(".fbx"));
}

/// load_bytes()  reads the bytes of the file, after all checks that do not need them
template <class Load>
std::vector<Motion> motions_of_file(const std::string& name, const MotionReadOptions& options, std::string* notes,
                                    Load load_bytes) {
  require_read_kind(name);
  const std::string kind = file_kind(name);
  const auto load = [&] {
    const std::span<const std::byte> bytes = load_bytes();
    refuse_lfs_pointer(bytes, name);
    refuse_other_content(bytes, name);
    return bytes;
  };
  if (kind == ".amc") {
    const AsfSkeleton asf = asf_of(name, options);
    std::vector<std::string> told;
    const AmcReadOptions amc = options.rate > 0 ? AmcReadOptions{.fps = options.rate} : AmcReadOptions{};
    std::vector<Motion> motions{parse_amc(as_text(load()), asf, amc, name, &told)};
    for (const std::string& note : told) {
      if (notes != nullptr) *notes += concat_text(name, ": ", note, "\n");
    }
    return motions;
  }
  const std::span<const std::byte> bytes = load();
  if (kind == ".bvh") return every_root(bytes, name, options, notes);
  if (kind == ".npz")
    return {amass_motion(amass_sequence(ZipArchive(bytes, name), options.rate), FilePath(name).stem())};
  if (kind == ".npy") return motions_of_npy(bytes, name, {options.rate, options.up});
  return every_animation(bytes, name, options, notes);
}

inline void note_lead_in(const std::string& file, Index frames, const std::string& whose, std::string* notes) {
  if (notes == nullptr) return;
  *notes +=
      concat_text(file, ": left out: ", counted(frames, "frame"), " of an inserted T-pose at the start", whose, "\n");
}

/// Names, joints and start of the motions as the options say.
inline std::vector<Motion> finished_motions(std::vector<Motion> motions, const std::string& file,
                                            const MotionReadOptions& options, std::string* notes) {
  std::set<std::string> taken;
  const std::string kind = file_kind(file);
  const bool turn = options.up > UpAxis::y && kind != ".npy" && kind != ".npz";
  for (Motion& m : motions) {
    if (m.name.empty() || motions.size() == 1) m.name = std::filesystem::path(file).stem().string();
    m.name = unique_name(m.name, taken);
    if (turn) m = turned_upright(m, options.up);
    if (!options.joints.empty())
      m = retarget(m, SkeletonMap(m.skeleton, smpl24_skeleton(), read_skeleton_table(options.joints, m.skeleton)));
  }
  if (!options.drop_lead_in) return motions;
  for (Motion& m : motions) {
    const Index frames = detect_t_pose_lead_in(m);
    if (frames == 0) continue;
    m = crop(m, frames, m.frames());
    note_lead_in(file, frames, motions.size() == 1 ? "" : " of " + m.name, notes);
  }
  return motions;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<Motion> parse_motions(std::span<const std::byte> bytes, const FilePath& name,
                                                  const MotionReadOptions& options, std::string* notes) {
  return detail::finished_motions(detail::motions_of_file(name.string(), options, notes, [&] { return bytes; }),
                                  name.string(), options, notes);
}

MOTIONLANG_BODY std::vector<Motion> read_motions(const FilePath& path, const MotionReadOptions& options,
                                                 std::string* notes) {
  std::shared_ptr<const MappedFile> file;
  const auto load = [&] {
    file = MappedFile::open(path);
    return file->bytes();
  };
  return detail::finished_motions(detail::motions_of_file(path.string(), options, notes, load), path.string(), options,
                                  notes);
}

MOTIONLANG_BODY Motion read_motion(const FilePath& path, const MotionReadOptions& options, std::string* notes) {
  std::vector<Motion> motions = read_motions(path, options, notes);
  if (motions.size() == 1) return std::move(motions.front());
  std::vector<std::string> names;
  names.reserve(motions.size());
  for (const Motion& m : motions) names.push_back(m.name);
  raise<config_error>(102, path.string(), ": expected one motion, found ", motions.size(), " (", join_text(names),
                      "); convert writes each to a file of its own");
}

MOTIONLANG_BODY std::vector<std::byte> motion_bytes(const FilePath& kind, const Motion& motion,
                                                    const MotionWriteOptions& options) {
  const std::string wanted = detail::wanted_kind(kind);
  if (wanted == ".bvh") {
    const std::string text = format_bvh(to_bvh(motion, {.scale = options.scale}));
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
  }
  if (wanted == ".glb") return glb_bytes(std::span(&motion, 1));
  if (wanted == ".vrma") return vrma_bytes(motion);
  if (wanted == ".npz") return amass_bytes(on_smpl(motion), options.body, {}, kind.string());
  if (wanted == ".npy") return joints_npy_bytes(has_joints_of_arrays(motion) ? motion : on_smpl(motion));
  raise<config_error>(103, kind.string(), ": motions are written to .bvh, .glb, .vrma, .npz and .npy, not '", wanted,
                      "'", detail::about_fbx(wanted));
}

MOTIONLANG_BODY void write_motion(const FilePath& path, const Motion& motion, const MotionWriteOptions& options) {
  write_file(path, motion_bytes(path, motion, options));
}

MOTIONLANG_NAMESPACE_END
