// SPDX-License-Identifier: MIT
/// VRM animations (.vrma): motions for the avatars of VRM. VRM viewers, VRoid's tools and Blender's add-on load them. A
/// GLB file of the bones of VRM's humanoid in a T-pose, without a mesh, with one animation.
///
/// Reading is glb_reader.hpp's: bones have VRM's names, expressions and gaze are left out.
///
/// Source   github.com/vrm-c/vrm-specification, VRMC_vrm_animation-1.0
#pragma once

#include <cstddef>  // byte
#include <vector>   // bytes

#include <motionlang/file/file_path.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The bones of VRM's humanoid in a T-pose, as long as those of a skeleton, with its fingers. The hips stand as high as
/// the legs are long. Bones of the spine that the skeleton lacks are left out.
/// Throws config_error 103 if no table fits the skeleton, or if a bone is missing that VRM requires
Skeleton vrm_skeleton(const Skeleton& skeleton);

/// The bytes of a VRM animation: the motion on vrm_skeleton of its skeleton, which its own becomes by retargeting.
/// Throws  config_error 101 without a frame or for an impossible frame rate; what vrm_skeleton and retarget throw
std::vector<std::byte> vrma_bytes(const Motion& motion);

/// Throws io_error 401, and what vrma_bytes throws.
void write_vrma(const FilePath& path, const Motion& motion);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/vrma.ipp>
#endif
