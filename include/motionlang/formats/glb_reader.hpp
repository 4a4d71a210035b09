// SPDX-License-Identifier: MIT
/// GLB files, and .gltf files with their data in base64, as motions: skins and animations of glTF 2.0. Meshes,
/// materials and morph targets are left out. The bones of a VRM avatar (.vrm, .vrma) have the names of VRM's humanoid.
///
/// The skeleton's rest pose is that of the file, with all rotations the identity as everywhere in this library: with B
/// the world rotation of a node at rest and r its local rotation, L_j = B_parent r_j B_j^-1, and the offset of a joint
/// is its rest translation turned by B_parent. Bones keep their length: only the root moves; animated scales and
/// translations of other joints are dropped (stretched_joints names these).
///
/// Two keys of a small file can be years apart. What is sampled has at most 10 million rotations (frames x joints;
/// nearly four hours at 30 per second with 24 joints: 320 MB), or 16 for each key of a channel in the file, which is
/// enough for any recording with keys at its frames. motions() counts all animations together, and for each of them the
/// rotations that would fill the memory of its skeleton, of which every motion has its own.
#pragma once

#include <cstddef>      // byte
#include <optional>     // frame rates
#include <span>         // bytes
#include <string>       // names
#include <string_view>  // names
#include <vector>       // motions

#include <motionlang/file/file_path.hpp>
#include <motionlang/formats/detail/gltf_skeleton.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A GLB file in memory, from which several motions can be taken.
class GlbFile {
 public:
  /// skin    which of the file's skins; a file without any gives a skeleton of all animated nodes
  /// Throws  io_error 401 to 405; config_error 107 where the JSON has a value of the wrong kind
  static GlbFile open(const FilePath& path, Index skin = 0);
  GlbFile(std::span<const std::byte> bytes, std::string name, Index skin = 0);

  const Skeleton& skeleton() const { return joints_.skeleton; }
  std::vector<std::string> animation_names() const;

  /// Seconds from time 0 to the last key of an animation. Throws config_error 103 if there is no such animation.
  double duration(Index animation) const;

  /// Names of the joints below the root that an animation moves away from their place at rest, by more than a hundredth
  /// of the bone, or by the scale of the joint before: motion() leaves this out. Throws config_error 103 if there is no
  /// such animation.
  std::vector<std::string> stretched_joints(Index animation) const;

  /// Frames per second at which motion() takes an animation: those of its keys, where all are at whole frames of one
  /// rate of 10 to 1000; 30 for others. Throws config_error 103 if there is no such animation.
  double rate(Index animation) const;

  /// The animation from time 0 to its last key, at `wanted` frames per second or as rate() says.
  /// Throws  config_error 103 if there is no such animation, 101 for an impossible frame rate, io_error 405 if the
  ///         motion would be too long
  Motion motion(Index animation, std::optional<double> wanted = {}) const;
  /// All animations. Throws what motion(number) throws; io_error 405 if they would be too long together.
  std::vector<Motion> motions(std::optional<double> wanted = {}) const;
  /// The animation of that name. Throws config_error 103, and what motion(number) throws.
  Motion motion(std::string_view animation, std::optional<double> fps = {}) const;

 private:
  GlbFile(const detail::GltfDocument& document, Index skin);

  static std::vector<detail::GltfAnimation> load(const detail::GltfDocument& document);

  const detail::GltfAnimation& at(Index animation) const;

  double frames_of(const detail::GltfAnimation& a, double fps) const;
  static double most_rotations(std::size_t keys);
  /// How many rotations take as much memory as the skeleton of a motion.
  double skeleton_rotations() const;

  detail::GltfTransform transform(const detail::GltfAnimation& a, int node, double time) const;

  /// The root with all that stands above it in the file.
  detail::GltfTransform root_in_world(const detail::GltfAnimation& a, double time) const;

  void append_pose(Motion& motion, const detail::GltfAnimation& a, double time) const;

  std::string file_;
  std::vector<detail::GltfNode> nodes_;
  std::vector<detail::GltfAnimation> animations_;
  detail::GltfSkeleton joints_;
};

struct GlbReadOptions {
  std::string animation{};      // by name; "": the first
  std::optional<double> fps{};  // none: GlbFile::rate
  Index skin = 0;
};

/// Throws what GlbFile::open and GlbFile::motion throw.
Motion read_glb(const FilePath& path, const GlbReadOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/glb_reader.ipp>
#endif
