// SPDX-License-Identifier: MIT
// Bodies of the headers in formats/ that need nlohmann/json.hpp, compiled once for motionlang::instantiated.
#include <motionlang/formats/detail/gltf_animation.ipp>
#include <motionlang/formats/detail/gltf_skeleton.ipp>
#include <motionlang/formats/glb_reader.ipp>
#include <motionlang/formats/glb_rig.ipp>
#include <motionlang/formats/glb_writer.ipp>
#include <motionlang/formats/motion_file.ipp>
#include <motionlang/formats/motion_folder.ipp>
#include <motionlang/formats/vrma.ipp>
