// SPDX-License-Identifier: MIT
/// VRM animations (.vrma): motions for the avatars of VRM. VRM viewers, VRoid's tools and Blender's add-on load them.
/// Such a file is a GLB file of the bones of VRM's humanoid in a T-pose, without a mesh, with one animation.
///
/// glb_reader.hpp reads them. Bones have VRM's names; expressions and gaze are left out.
///
/// Source   github.com/vrm-c/vrm-specification, VRMC_vrm_animation-1.0
#pragma once

#include <cstddef>  // byte
#include <vector>   // bytes

#include <motionlang/file/file_path.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The bones of VRM's humanoid in a T-pose, with the bone lengths and fingers of a skeleton. The hips are as high as
/// the legs are long. Bones of the spine that the skeleton lacks are left out. Throws config_error 103 if no table fits
/// the skeleton, or if a bone is missing that VRM requires
Skeleton vrm_skeleton(const Skeleton& skeleton);

/// The bytes of a VRM animation: the motion, retargeted to the vrm_skeleton of its skeleton.
/// Throws  config_error 101 without a frame or for an impossible frame rate; what vrm_skeleton and retarget throw
std::vector<std::byte> vrma_bytes(const Motion& motion);

/// Throws io_error 401, and what vrma_bytes throws.
void write_vrma(const FilePath& path, const Motion& motion);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/vrma.ipp>
#endif
