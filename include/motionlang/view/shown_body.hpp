// SPDX-License-Identifier: MIT
/// The interface of a body that shows motions; load_shown_body makes one.
#pragma once

#include <filesystem>  // files
#include <string>      // what was left out
#include <vector>      // motions

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct ShownBodyOptions {
  std::string file{};  // SMPL, SMPL-H or SMPL-X, the user's own: .npz or .pkl; "free": capsules along the bones
  std::vector<double> betas{};  // its shape, further ones are 0; none: that of an AMASS file, or 0
};
/// The motion of an AMASS file on a body.
struct BodyClip {
  Motion motion;               // on the joints of the body
  std::vector<float> betas{};  // the file's shape
  std::string notes{};         // a line: what the file has besides the 22 joints of the body, and what is left out
  bool has_more = false;       // hands or a face that move
};
/// The files that were written on a body.
struct BodyFiles {
  std::string body;  // "SMPL-H", "the free body"
  Index vertices = 0;
  Index files = 1;  // .obj: one for each frame
};

class ShownBody {
 public:
  virtual ~ShownBody() = default;
  /// True if a motion is on the body's own joints, or the body takes any joints. Other motions are retargeted to
  /// SMPL's.
  virtual bool has_joints_of(const Motion& motion) const = 0;
  /// True if it takes any joints: the free body.
  virtual bool takes_any_joints() const { return false; }
  /// fps: for a file without a frame rate; 0: none. Throws what read_amass_sequence throws.
  virtual BodyClip read(const std::filesystem::path& npz, double fps = 0) const = 0;
  /// Writes motions on the body: .glb (all motions, with a skin), .html (all motions), .obj (one motion, a file for
  /// each frame).
  /// betas   the shape, unless the options gave one; none: 0
  /// Throws  config_error 101 without a motion, option_error 103 for another extension, and what the writers throw
  virtual BodyFiles write(const std::filesystem::path& path, std::vector<Motion> motions,
                          const std::vector<float>& betas = {}) const = 0;
};

MOTIONLANG_NAMESPACE_END
