// SPDX-License-Identifier: MIT
/// GLB files (glTF 2.0) for viewers, engines and Blender: a skinned figure of round cones with animations. Y up,
/// metres, seconds, facing +Z: the library's own conventions.
#pragma once

#include <cstddef>  // byte
#include <cstdint>  // weights
#include <span>     // motions
#include <vector>   // bytes

#include <motionlang/file/file_path.hpp>
#include <motionlang/formats/detail/skinned_mesh.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct GlbWriteOptions {
  Vec3<double> colour{0.62, 0.66, 0.72};  // of the body: red, green, blue, linear, 0 to 1
  double roughness = 0.85;                // 1: matt
};

namespace detail {

/// Throws  config_error 101 without any motion or frame, 102 if skeletons differ; what Motion::validate throws
void require_glb_motions(std::span<const Motion> motions);

/// The motions, after require_glb_motions, with the mesh that their skeleton moves.
std::vector<std::byte> skinned_glb(std::span<const Motion> motions, const SkinnedMesh<std::uint8_t>& mesh,
                                   const char* name, const GlbWriteOptions& options);
std::vector<std::byte> skinned_glb(std::span<const Motion> motions, const SkinnedMesh<std::uint16_t>& mesh,
                                   const char* name, const GlbWriteOptions& options);

}  // namespace detail

/// The bytes of a GLB file with one animation for every motion, all on the same skeleton. body_glb.hpp shows the user's
/// own body instead of the figure.
/// Throws  config_error 101 without any motion or frame, or for an impossible frame rate; 102 if skeletons differ; what
///         Motion::validate throws
std::vector<std::byte> glb_bytes(std::span<const Motion> motions, const GlbWriteOptions& options = {});

/// Throws io_error 401, and what glb_bytes throws.
void write_glb(const FilePath& path, std::span<const Motion> motions, const GlbWriteOptions& options = {});
void write_glb(const FilePath& path, const Motion& motion, const GlbWriteOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/glb_writer.ipp>
#endif
