// Files of motion, by their extensions: what `convert`, `strip`, `view` and `info` read and write.
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <motionlang/kinematics/motion.hpp>

namespace program {

namespace ml = motionlang;

struct MotionReadOptions {
  double scale = 0.01;  // metres per unit of a BVH file
  double fps = 30;      // of a GLB file, whose keys have times of their own
  double npy_fps = 0;   // of an .npy file, which has none; 0: as published
  std::string up{};     // axis of an .npy file with positions, "y" or "z"; "": found
  std::string asf{};    // skeleton of an AMC file; "": the file of its subject beside it, 01.asf for 01_02.amc
};

/// Extension of a file, in lower case: ".bvh".
std::string kind_of(const std::filesystem::path& path);

/// Whether read_motions knows the extension.
bool is_motion_file(const std::filesystem::path& path);

/// The motion files in a folder and in those below it, in order.
std::vector<std::filesystem::path> motion_files_below(const std::filesystem::path& folder);

/// The name of a motion as a part of a file's name that no other has: characters that some system does not allow there
/// become "_", and a second "walk" becomes "walk_2".
std::string unique_file_name(std::string name, std::set<std::string>& taken);

/// CMU keeps one skeleton for each subject: 01.asf beside 01_02.amc.
inline std::filesystem::path asf_beside(const std::filesystem::path& amc) {
  const std::string stem = amc.stem().string();
  return amc.parent_path() / (stem.substr(0, stem.find('_')) + ".asf");
}

/// The motions of a file: .bvh, .amc, .npz (AMASS), .npy (joints or features), .glb, .vrm, .vrma (every animation). Each has a name.
/// Throws config_error 103 for another extension and for a GLB file without animation, and what the reader throws.
std::vector<ml::Motion> read_motions(const std::filesystem::path& path, const MotionReadOptions& options = {});

/// .bvh, .glb, .npz (AMASS), .npy (joint positions), .html (page to watch), .svg and .png (film strip).
/// AMASS needs SMPL's skeleton: another motion is retargeted first. Throws config_error 103 for another extension.
void write_motion(const std::filesystem::path& path, const ml::Motion& motion, double bvh_units_per_metre = 100);

/// The motion's features as the systems have them, one row for each frame, to an .npy file: on SMPL's joints, at the rate of the
/// features. Throws config_error 103 for a name that is none (motion_features) and for another extension.
void write_features(const std::filesystem::path& path, const ml::Motion& motion, const std::string& features);

/// A character's GLB file to put motions on: --rig.
struct RigOptions {
  std::string file{};
  bool drop_animations = false;  // of the character's file
};
/// Writes a GLB file: the character with one animation for every motion; says how its skeleton follows. The character
/// is read at once. Throws what GlbRig throws; writing: config_error 103 for another extension than .glb.
using RigWriter = std::function<void(const std::filesystem::path&, std::span<const ml::Motion>)>;
RigWriter rig_writer(const RigOptions& options);

/// A body to show motions on: --body.
struct BodyOptions {
  std::string file{};           // SMPL, SMPL-H or SMPL-X, the user's own: .npz or .pkl; "free": capsules along the bones
  std::vector<double> betas{};  // its shape; the others are 0
};
/// Motions on a body: .glb (all motions, with a skin), .html (all motions), .obj (a file for each frame; one motion). Motions on other
/// joints than SMPL's are retargeted. Throws config_error 103 for another extension, and what the readers and writers throw.
void write_on_body(const std::filesystem::path& path, std::span<const ml::Motion> motions, const BodyOptions& options);

/// The motion on SMPL's 24 joints. If it has them already, in whatever order (a BVH file goes depth first), they are
/// only put in SMPL's order and bones keep their length.
ml::Motion on_smpl(const ml::Motion& motion);

}  // namespace program
