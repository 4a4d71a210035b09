// SPDX-License-Identifier: MIT
/// Reads GLB files, and .gltf files with their data in base64, as motions: skins and animations of glTF 2.0. Meshes,
/// materials and morph targets are left out. The bones of a VRM avatar (.vrm, .vrma) have the names of VRM's humanoid.
/// A skeleton table finds a figure among the joints of all skins, or among all nodes of a file without skins. The
/// figure starts at the hips. Nodes above the hips move them; nodes beside them (cameras, props, control bones) are
/// left out. Several figures are several motions. If no table fits, the largest skin is the figure.
///
/// The skeleton's rest pose is that of the nodes or that of the inverse bind matrices, whichever is nearer to a T-pose.
/// All its rotations are the identity, as everywhere in this library. Let A(t) be the matrix of a joint in the world,
/// the product of all matrices above it, and Q its orthogonal polar factor. The joint has turned by D_j = Q_j(t)
/// Q_j(rest)^-1, its local rotation is L_j = D_parent^-1 D_j, and an offset is the difference of two places at rest.
/// This is exact except for uneven scales above joints that turn. Bones keep their length: only the root moves.
/// Constant translations and scales of an animation belong to the rest pose of its motion. GlbLoss reports all other
/// losses.
///
/// Two keys of a small file can be years apart. So samples have at most 10 million rotations (frames x joints; nearly
/// four hours at 30 per second with 24 joints: 320 MB), or 16 for each key of a channel in the file. That is enough for
/// any recording with keys at its frames. A motion has at most a million frames, unless there are more keys. motions()
/// counts all animations together. For each motion it adds the rotations that would take the memory of its skeleton.
#pragma once

#include <cstddef>      // byte
#include <optional>     // frame rates
#include <span>         // bytes
#include <string>       // names
#include <string_view>  // names
#include <utility>      // animations of figures
#include <vector>       // motions

#include <motionlang/file/file_path.hpp>
#include <motionlang/formats/detail/gltf_skeleton.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The distance of the joints of a motion from their places in the file.
struct GlbLoss {
  double distance = 0;     // the largest, metres
  std::string joint{};     // of this joint
  double seconds = 0;      // at this time
  double path = 0;         // the common error of all joints over the floor, metres
  bool walk_lost = false;  // true if that is more than a tenth of the figure's size
};

/// A GLB file in memory, from which several motions can be read.
class GlbFile {
 public:
  /// Says which joint of a skeleton is which; nothing if that is not known.
  using FindTable = detail::GltfFigures::FindTable;

  /// skin    the only one whose joints count; none: the figures of the file
  /// find_table  finds the table of a body by its joints; none: the built-in tables
  /// Throws  io_error 401 to 405; config_error 103 for an unknown skin, 107 if the JSON has a value of the wrong kind
  static GlbFile open(const FilePath& path, std::optional<Index> skin = {}, const FindTable& find_table = {});
  GlbFile(std::span<const std::byte> bytes, std::string name, std::optional<Index> skin = {},
          const FindTable& find_table = {});

  /// The number of figures, at least one. The functions below throw config_error 103 for an unknown number.
  Index figures() const { return std::ssize(figures_); }
  const Skeleton& skeleton(Index figure = 0) const { return of(figure).skeleton; }
  /// The name of a figure: that of the highest node that is above no other figure, its armature or its root.
  std::string figure_name(Index figure = 0) const;
  std::vector<std::string> animation_names() const;

  /// True if an animation has a key of a joint of the figure, or of a node above it. Throws config_error 103 if there
  /// is no such animation.
  bool moves(Index animation, Index figure = 0) const;

  /// Seconds from time 0 to the last key of an animation that moves a figure. Throws config_error 103 if there is no
  /// such animation.
  double duration(Index animation) const;

  /// Names of the joints below the root that an animation moves away from their rest position. The limit is a hundredth
  /// of the bone, or a changed scale of the joint before. motion() leaves this movement out. Throws config_error 103 if
  /// there is no such animation.
  std::vector<std::string> stretched_joints(Index animation, Index figure = 0) const;
  /// Names of nodes outside all figures that animations move: cameras, props, control bones.
  std::vector<std::string> moving_others() const;
  /// Sentences about what glTF does not allow and how it is read: "animation 'walk' begins at -0.2 s: ..."
  std::vector<std::string> repairs() const;

  /// The frames per second at which motion() samples an animation. If its keys are at whole frames of one rate of 10 to
  /// 1000, and some joint has a key at each frame, it is this rate. If no joint has a key at each frame, it is a
  /// multiple of this rate: at least 20, or at least 30 for curves between keys and for slower keys. If the keys have
  /// no common rate, it is 30, or more if they are closer. Throws config_error 103 if there is no such animation.
  double rate(Index animation, Index figure = 0) const;

  /// The animation from time 0 to its last key, at `wanted` frames per second or at rate(). If its keys are not at
  /// whole frames from 0 on, it begins up to a frame later. If the animation does not move the figure, the result is
  /// one frame of the rest pose.
  /// loss    gets what the motion lacks, if not null
  /// Throws  config_error 103 if there is no such animation, 101 for an impossible frame rate, io_error 405 if the
  ///         motion would be too long
  Motion motion(Index animation, std::optional<double> wanted = {}, Index figure = 0, GlbLoss* loss = nullptr) const;
  /// All animations of all figures that they move. If they move no figure, these are the motions of the first figure.
  /// If one animation moves several figures, the names of its motions end with those of the figures.
  /// losses  gets one for each motion, if not null
  /// Throws  what motion(number) throws; io_error 405 if they would be too long together.
  std::vector<Motion> motions(std::optional<double> wanted = {}, std::vector<GlbLoss>* losses = nullptr) const;
  /// The animation of that name. Throws config_error 103, and what motion(number) throws.
  Motion motion(std::string_view animation, std::optional<double> fps = {}) const;

 private:
  GlbFile(const detail::GltfDocument& document, std::optional<Index> skin, const FindTable& find_table);

  static std::vector<detail::GltfAnimation> load(const detail::GltfDocument& document);

  const detail::GltfAnimation& at(Index animation) const;
  const detail::GltfSkeleton& of(Index figure) const;
  const std::vector<int>& moving_of(Index figure) const;
  const detail::GltfTransform& rest_of(int node) const { return nodes_[static_cast<std::size_t>(node)].rest; }

  double frames_of(Index animation, Index figure, double fps) const;
  /// The time of the first frame: part of a frame if keys are at whole frames, but not from 0 on.
  double begin_of(Index animation, Index figure, double fps) const;
  static double most_rotations(std::size_t keys);
  /// The number of rotations that take as much memory as the skeleton of a motion.
  static double skeleton_rotations(const Skeleton& skeleton);
  /// Animations and the figures that they move.
  std::vector<std::pair<Index, Index>> pairs() const;

  std::string file_;
  std::vector<std::string> repairs_;  // of the nodes
  std::vector<detail::GltfNode> nodes_;
  std::vector<detail::GltfAnimation> animations_;
  std::vector<detail::GltfSkeleton> figures_;
  std::vector<std::vector<int>> moving_of_;  // nodes of every figure and above it, ascending
  std::vector<int> moving_;                  // those of all figures
};

struct GlbReadOptions {
  std::string animation{};      // by name; "": the first
  std::optional<double> fps{};  // none: GlbFile::rate
  std::optional<Index> skin{};  // none: the first figure
};

/// Throws what GlbFile::open and GlbFile::motion throw.
Motion read_glb(const FilePath& path, const GlbReadOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/glb_reader.ipp>
#endif
