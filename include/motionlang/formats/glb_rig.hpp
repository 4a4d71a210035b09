// SPDX-License-Identifier: MIT
/// The user's character: a GLB file with mesh, skin and textures, to which motions are added.
///
/// The binary data of the file are kept byte for byte, and new data follow them. In the document, only the arrays of
/// animations, accessors and buffer views grow, and the length of the buffer grows with them. (Data of the first buffer
/// in base64 become binary data.) The joint that is the pelvis moves. Nodes above it (armature, root) keep their pose
/// at rest.
#pragma once

#include <cstddef>     // byte
#include <cstdint>     // joints of vertices
#include <functional>  // which joint is which
#include <memory>      // the file
#include <optional>    // report
#include <span>        // motions
#include <string>      // names
#include <vector>      // joints

#include <motionlang/formats/detail/skinned_mesh.hpp>
#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/kinematics/retarget.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct GlbRigOptions {
  bool keep_animations = true;  // of the character's file; otherwise their data are removed, if they come last
};

class GlbRig {
 public:
  /// Finds the joints of a skeleton: one of the known tables, or read_skeleton_table.
  using FindTable = std::function<SkeletonTable(const Skeleton&)>;

  /// The figure is the first one that GlbFile finds in the same file.
  /// Throws  what GlbFile throws; config_error 103 if no table fits, with the missing joint for every skin (for the
  ///         first of many)
  static GlbRig open(const FilePath& path, const FindTable& find_table = detect_skeleton_table);
  GlbRig(std::span<const std::byte> bytes, std::string name, const FindTable& find_table = detect_skeleton_table);

  const std::string& file() const;
  /// The skeleton from the pelvis down. A root position is that of the pelvis in the world.
  const Skeleton& skeleton() const { return skeleton_; }
  /// The table that knows this skeleton.
  const SkeletonTable& table() const { return table_; }
  /// Maps a skeleton of a known kind to this one. Throws what SkeletonMap throws.
  SkeletonMap map_from(const Skeleton& source) const;

  /// The file with one more animation for every motion. A motion is retargeted unless it is on this skeleton. A name
  /// that is already taken gets a number.
  /// Throws  config_error 101 without any motion or frame, or for an impossible frame rate; 103 if a motion's skeleton
  ///         is of no known kind; 107 if the file has a value of the wrong kind; what Motion::validate throws; io_error
  ///         405 from 4 GiB on
  std::vector<std::byte> with(std::span<const Motion> motions, const GlbRigOptions& options = {}) const;

  /// The surface of the character while its skeleton rests: meshes with skins, and what is fixed to joints. Morph
  /// targets and materials are left out. Vertices of packed meshes are missing.
  /// Throws  io_error 402 to 405 for damaged meshes; 404 if there is no triangle, or if all are packed
  detail::SkinnedMesh<std::uint16_t> mesh() const;

 private:
  /// Throws config_error 103 with the reason why no table fits.
  [[noreturn]] void refuse(const FindTable& find_table) const;

  /// The motion of the nodes: r_j = B_parent^-1 L_j B_j with B the axes in the world at rest, and the place of the
  /// pelvis relative to the node above it.
  Motion in_nodes(Motion motion) const;
  /// The nodes of joints that ever leave the pose at rest. -1 for others, such as fingers, which need no keys.
  std::vector<int> moved_nodes(const Motion& motion) const;

  std::shared_ptr<const std::vector<std::byte>> bytes_;
  std::shared_ptr<const detail::GltfDocument> document_;
  SkeletonTable table_;
  Skeleton skeleton_;
  std::vector<int> nodes_;                // of the joints
  std::vector<Quaternion<double>> lean_;  // of the joints, from the rest of the nodes to that of the skeleton
  std::vector<Matrix3<double>> axes_;     // of the joints in the world at rest; left-handed in a mirror image
  detail::GltfPlace above_;               // the pelvis' parent in the world at rest
};

/// Motions on the skeleton of a character. Motions on other skeletons are retargeted to it.
struct MotionsOnRig {
  std::vector<Motion> motions;
  std::optional<RetargetReport> report{};  // of the first motion, unless it is on the character's own skeleton
};
/// Throws what GlbRig::map_from and retarget throw.
MotionsOnRig motions_on_rig(const GlbRig& rig, std::span<const Motion> motions);

/// Throws io_error 401, and what GlbRig::with throws. The file is complete or does not exist.
void write_glb(const FilePath& path, const GlbRig& rig, std::span<const Motion> motions,
               const GlbRigOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/glb_rig.ipp>
#endif
