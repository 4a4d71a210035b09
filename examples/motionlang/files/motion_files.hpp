// Files of motion, by their extensions: what `convert`, `strip`, `view` and `info` read and write.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <motionlang/features/motion_features.hpp>
#include <motionlang/kinematics/retarget.hpp>

#include "../usage_error.hpp"
#include "data_set_form.hpp"

namespace CLI {
class App;
}

namespace program {

namespace ml = motionlang;

/// What --joints is about.
inline constexpr const char* joints_help =
    "Which joint is which, for skeletons of other names or axes: lines 'joint of SMPL<TAB>joint[<TAB>axes]', "
    "'left_hip' "
    "and 'LeftThigh' for instance; axes are those of the joint that point left and up in a T-pose, +x+y unless given. "
    "Of the character with --rig; else motions are put on SMPL's joints by it";

struct MotionReadOptions {
  double scale = 0.01;          // metres per unit of a BVH file
  std::optional<double> fps{};  // of a GLB file, whose keys have times of their own; none: their rate, or 30
  double rate = 0;              // of an .npy, .amc or .npz file that has none; 0: as published, 120 for AMC
  std::string up{};             // axis of an .npy file with positions, "y" or "z"; "": found
  std::string asf{};            // skeleton of an AMC file; "": asf_beside
  std::string joints{};         // table by which motions are put on SMPL's joints; "": they stay on their own

  /// --scale, --rate, --up, --asf, --joints
  void add_to(CLI::App& command);
  /// Throws usage_error 102 for an option that says nothing about files of this kind.
  void require_for(const std::filesystem::path& file) const;
};
/// The same for one of many files: an AMC file with a skeleton beside it is read with that one, an .npz file that says
/// its rate at that one.
MotionReadOptions options_in_folder(MotionReadOptions options, const std::filesystem::path& file);

/// Extension of a file, in lower case: ".bvh".
std::string kind_of(const std::filesystem::path& path);

/// Whether a file holds glTF, with any number of animations: .glb, .gltf, .vrm, .vrma.
bool is_gltf(const std::filesystem::path& path);
/// Whether files of this kind are made to hold motions: .bvh, .amc, .npz, .npy, .glb, .vrma. (read_motions knows .vrm
/// and .gltf as well.)
bool is_motion_file(const std::filesystem::path& path);

/// The motion files in a folder and in those below it, in order, but not .npy files with one axis, which are mean and
/// deviation of a data set. Folders below it that cannot be read and links that lead in a circle are skipped, and named
/// on stderr.
/// results  a folder for results: if it is below the other one, its files are no inputs, and stderr says so
/// Throws   io_error 401 if the folder itself cannot be read
std::vector<std::filesystem::path> motion_files_below(const std::filesystem::path& folder,
                                                      const std::filesystem::path& results = {});
/// Whether two paths lead to one place.
bool is_same_place(const std::filesystem::path& a, const std::filesystem::path& b);
/// Whether an .npy file may hold a motion: it has more than one axis, or it cannot be read, and its reader says why.
bool has_frames(const std::filesystem::path& npy);

/// Throws io_error 401 unless the folder is there in which a file is to be written: before long work rather than after
/// it.
void require_folder_of(const std::filesystem::path& file);
/// Makes the folder that an option names, unless it is there: as early. Throws io_error 401 if it cannot be written in.
void make_output_folder(const std::string& option, const std::filesystem::path& folder);
/// The same; what it made is removed in the end if nothing has been written there.
class OutputFolder {
 public:
  OutputFolder(const std::string& option, const std::filesystem::path& folder);

 private:
  struct Made {                                  // of its own, so that it goes as well where the constructor throws
    std::vector<std::filesystem::path> paths{};  // the innermost last

    Made() = default;
    Made(const Made&) = delete;
    Made& operator=(const Made&) = delete;
    ~Made();
  } made_;
};

/// The name of a motion as a part of a file's name: characters that some system does not allow there become "_".
std::string file_name(std::string name);
/// A name that no other has: a second "walk" becomes "walk_2".
std::string unique(const std::string& name, std::set<std::string>& taken);

/// The skeleton beside an AMC file: its subject's, as CMU has them (01.asf beside 01_02.amc), or else the only one in
/// the folder.
std::filesystem::path asf_beside(const std::filesystem::path& amc);

/// The motions of a file: .bvh (every ROOT), .amc, .npz (AMASS), .npy (joints, features, or all of MDM's results),
/// .glb, .gltf, .vrm, .vrma (every animation). Each has a name, and no two the same.
/// told    gets lines about what a file has and the motions do not: bones that stretch
/// Throws  config_error 103 for another extension and for a GLB file without animation, io_error 401 for an AMC file
///         whose skeleton is not found, and what the reader throws
std::vector<ml::Motion> read_motions(const std::filesystem::path& path, const MotionReadOptions& options = {},
                                     std::string* told = nullptr);

/// The motions of a file without T-poses that were put in front of them (detect_t_pose_lead_in): for what puts motions
/// together. Prints what is left out.
std::vector<ml::Motion> read_performed_motions(const std::filesystem::path& path,
                                               const MotionReadOptions& options = {});

/// The only one of them. Throws config_error 102 if there are several, and as read_motions.
ml::Motion read_only_performed_motion(const std::filesystem::path& path, const MotionReadOptions& options = {});

/// .bvh, .glb, .npz (AMASS), .npy (joint positions), .html (page to watch), .svg and .png (film strip).
/// AMASS needs SMPL's skeleton: another motion is retargeted first. Returns a line about it. Throws usage_error 103 for
/// another extension.
std::string write_motion(const std::filesystem::path& path, const ml::Motion& motion, double bvh_units_per_metre = 100);
/// The line: frames, rate, seconds and joints of a motion that is in a file now.
std::string line_about(const std::filesystem::path& path, const ml::Motion& motion);

/// Whether one file of this kind holds several motions: .glb, .html.
bool holds_several(const std::filesystem::path& path);
/// Whether one file of this kind holds these motions: those in GLB are on one skeleton.
bool holds_together(const std::filesystem::path& path, std::span<const ml::Motion> motions);
/// Such a file.
void write_motions(const std::filesystem::path& path, std::span<const ml::Motion> motions);

/// The features of a motion on SMPL's joints or on theirs, as the systems have them, one row for each frame, to an .npy
/// file: at `fps` frames per second (0: the rate of the features). Returns a line about what it wrote. Throws
/// config_error 103 for an unknown name (motion_features) and for other joints, usage_error 103 for another
/// extension.
std::string write_features(const std::filesystem::path& path, const ml::Motion& motion, const std::string& features,
                           double fps = 0);

/// A clip of a data set in HumanML3D's or KIT-ML's form (data_set_form.hpp): features, joints, its captions if there
/// are any already, its id in all.txt. Returns a line about it.
/// replace  another motion of this id gives way to it
/// Throws   what write_humanml3d_clip throws; config_error 102 if the clips of the data set are of the other form, or
///          if another motion has this id and does not give way
std::string write_humanml3d(const std::filesystem::path& folder, const std::string& id, const ml::Motion& motion,
                            const DataSetForm& form, double fps = 0, bool replace = false);

/// A character's GLB file to put motions on: --rig.
struct RigOptions {
  std::string file{};            // "": none, and no writer
  std::string joints{};          // table of the character's joints; "": one of the known ones
  bool drop_animations = false;  // of the character's file
};
/// Writes a GLB file: the character with one animation for every motion; returns lines about how its skeleton follows.
/// The character is read at once. Throws what GlbRig throws; writing: usage_error 103 for another extension than .glb.
using RigWriter = std::function<std::string(const std::filesystem::path&, std::span<const ml::Motion>)>;
RigWriter rig_writer(const RigOptions& options);

/// A body to show motions on: --body.
struct BodyOptions {
  std::string file{};  // SMPL, SMPL-H or SMPL-X, the user's own: .npz or .pkl; "free": capsules along the bones
  std::vector<double> betas{};  // its shape, the others are 0; none: that of an AMASS file, or 0
};
/// The motion of an AMASS file on a body.
struct BodyClip {
  ml::Motion motion;           // on the joints of the body
  std::vector<float> betas{};  // the file's shape
  std::string told{};          // a line: what it has besides the 22 joints of the body, and what is left out
  bool has_more = false;       // hands or a face, which move
};
/// A body that is read once for all motions that are shown on it.
class ShownBody {
 public:
  virtual ~ShownBody() = default;
  /// Whether a motion is on the body's own joints, or the body takes any. Others are retargeted to SMPL's.
  virtual bool has_joints_of(const ml::Motion& motion) const = 0;
  /// fps: of a file that does not say it, or 0. Throws what read_amass_sequence throws.
  virtual BodyClip read(const std::filesystem::path& npz, double fps) const = 0;
  /// Motions on the body: .glb (all motions, with a skin), .html (all motions), .obj (a file for each frame; one
  /// motion). betas: their shape unless the user gave one; none: 0. Returns a line about what it wrote. Throws
  /// config_error 103 for another extension, and what the writers throw.
  virtual std::string write(const std::filesystem::path& path, std::vector<ml::Motion> motions,
                            const std::vector<float>& betas) const = 0;
};
/// Null if the options name none. Throws what read_body throws.
std::unique_ptr<const ShownBody> shown_body(const BodyOptions& options);

/// The motion on SMPL's 24 joints. If it has them already, in whatever order (a BVH file goes depth first), they are
/// only put in SMPL's order and bones keep their length; otherwise `report`, if there is one, is set.
ml::Motion on_smpl(const ml::Motion& motion, ml::RetargetReport* report = nullptr);
/// Whether a motion has the joints of these features, which are then made of it as it is; SMPL's or MMM's.
bool on_joints_of(const ml::MotionFeatures& features, const ml::Motion& motion);
/// Whether joints stand as a reader of a .npy without names expects them: SMPL's 22 or 24, or MMM's.
bool on_joints_of_arrays(const ml::Motion& motion);
/// The motion as it is if it has the joints of these features, else on SMPL's.
ml::Motion on_joints_for(const ml::MotionFeatures& features, const ml::Motion& motion);
/// The features of a motion on any joints, at `fps` frames per second: those of on_joints_for.
std::vector<double> rows_of_motion(const ml::MotionFeatures& features, const ml::Motion& motion, double fps);

}  // namespace program
