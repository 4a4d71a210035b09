// Errors of the positions of joints as evaluate prints them of TEMOS, TEACH and SINC.
#pragma once

#include <cstdio>
#include <string>

#include <motionlang/metrics/sampled_errors.hpp>

namespace program {

namespace ml = motionlang;

using Joints = ml::JointFrames;
using ml::BlindErrors, ml::JointErrors, ml::SampledErrors;

/// What stands above the columns.
inline void print_error_heads() {
  std::printf("  %-22s   %-31s   %s\n  %22s      root   traj.   local  global      root   traj.   local  global\n", "",
              "APE (m)", "AVE (m^2)", "");
}
/// A row.
inline void print_errors(const std::string& what, const ml::ApeAve& errors) {
  std::printf("  %-22s", what.c_str());
  for (const ml::PositionErrors* p : {&errors.ape, &errors.ave})
    std::printf("   %7.3f %7.3f %7.3f %7.3f", p->root, p->trajectory, p->mean_local(), p->mean_joints());
  std::printf("\n");
}
/// The first motion of each text; of several also their mean, and the best and the worst of each text.
inline void print_errors(const SampledErrors& errors) {
  print_errors("one sample", errors.first());
  const ml::Index n = errors.samples();
  if (n == 1) return;
  print_errors(ml::concat_text("mean of ", ml::counted(n, "sample")), errors.mean());
  print_errors(ml::concat_text("best of ", ml::counted(n, "sample")), errors.best());
  print_errors(ml::concat_text("worst of ", ml::counted(n, "sample")), errors.worst());
}
inline void print_errors(const BlindErrors& errors) {
  print_errors("mean pose", errors.mean_pose());
  print_errors("random clip", errors.random_clip());
}

}  // namespace program
