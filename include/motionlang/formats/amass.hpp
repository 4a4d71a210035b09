// SPDX-License-Identifier: MIT
/// AMASS-style .npz files (poses as rotation vectors, Z up), which SMPL tools and the Blender add-ons read, and joint
/// positions as .npy. No body model is needed. Hands and faces are neither written nor kept; amass_body.hpp keeps them.
///
/// AMASS stores tau, not the pelvis. A body model puts the pelvis at J_0(beta) + tau, where J_0 is its rest position in
/// the model's own frame, some 20 cm off the origin. We do not have the model, so J_0 is an argument, 0 by default.
/// `trans` is then the pelvis itself, and a viewer with a real body shows the same motion shifted by J_0.
#pragma once

#include <cstddef>  // byte
#include <string>   // names
#include <vector>   // shapes

#include <motionlang/formats/amass_sequence.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Y up (this library) to Z up (AMASS) and back: a quarter turn about x.
inline Vec3<double> y_up_to_z_up(const Vec3<double>& v) { return {v.x, -v.z, v.y}; }
inline Vec3<double> z_up_to_y_up(const Vec3<double>& v) { return {v.x, v.z, -v.y}; }

/// The person of the motion. It is only passed on.
struct AmassBody {
  std::string gender = "neutral";
  std::vector<double> betas = std::vector<double>(16, 0.0);
};

struct AmassClip {
  Motion motion;
  AmassBody body;
};

namespace detail {

inline constexpr std::size_t amass_joints = 22;  // SMPL's without the hands: the first 66 values of a pose

}  // namespace detail

/// Writes trans (N, 3), poses (N, 156; fingers 0), betas, gender and the frame rate under both of its spellings.
/// motion       on a skeleton whose first 22 joints are SMPL's; further joints (the hands) are left out
/// rest_pelvis  J_0 of the body that will be shown, in the model's own frame; see the top of this file
/// Throws       config_error 106 for another skeleton, numeric_error 301 if a value is not finite, io_error 401
void write_amass(const FilePath& path, const Motion& motion, const AmassBody& body = {},
                 const Vec3<double>& rest_pelvis = {});
/// The contents of such a file. Messages contain `name`. Throws what write_amass throws, except io_error 401.
std::vector<std::byte> amass_bytes(const Motion& motion, const AmassBody& body = {},
                                   const Vec3<double>& rest_pelvis = {}, const std::string& name = "AMASS file");

namespace detail {

/// Joint `joint` of a sequence in one frame, as in the file.
Quaternion<double> amass_rotation(const AmassSequence& sequence, Index frame, Index joint);

}  // namespace detail

/// The body joints of a sequence: SMPL (72 columns), SMPL-H (156) or SMPL-X (165). Fingers and face are dropped, and
/// the two hand joints stay at rest. Bones are those of smpl24_skeleton(), whatever betas say. Throws numeric_error 301
/// if a value is not finite
Motion amass_motion(const AmassSequence& sequence, std::string name, const Vec3<double>& rest_pelvis = {});

/// Reads the body joints of an AMASS file. fps: as in read_amass_sequence. Throws what that throws, and numeric_error
/// 301 if a value is not finite.
AmassClip read_amass(const FilePath& path, const Vec3<double>& rest_pelvis = {}, double fps = 0);

/// Joint positions as (frames, joints, 3) in float32, Z up, as STMC saves them and its evaluation reads them. Joints
/// have the order of the skeleton; readers assume that 22 or 24 are SMPL's. Throws io_error 401, and numeric_error 301
/// for a position that float32 cannot hold.
void write_joints_npy(const FilePath& path, const Motion& motion);
/// The contents of such a file. Throws numeric_error 301.
std::vector<std::byte> joints_npy_bytes(const Motion& motion);

/// Joint positions as write_joints_npy wrote them, turned to Y up: (frames, joints), joint fastest.
struct JointPositions {
  Index frames = 0, joints = 0;
  std::vector<Vec3<double>> positions;
};
/// Throws io_error 401 to 405, 407 if the array is not (frames, joints, 3).
JointPositions read_joints_npy(const FilePath& path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/amass.ipp>
#endif
