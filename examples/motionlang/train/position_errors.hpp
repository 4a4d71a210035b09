// Prints the errors of joint positions for evaluate of TEMOS, TEACH and SINC.
#pragma once

#include <cstdio>
#include <vector>

#include <motionlang/metrics/sampled_errors.hpp>

namespace program {

inline void print_errors(const std::vector<motionlang::NamedErrors>& rows) {
  std::printf("  %-22s   %-31s   %s\n  %22s      root   traj.   local  global      root   traj.   local  global\n", "",
              "APE (m)", "AVE (m^2)", "");
  for (const auto& [name, errors] : rows) {
    std::printf("  %-22s", name.c_str());
    for (const motionlang::PositionErrors* p : {&errors.ape, &errors.ave})
      std::printf("   %7.3f %7.3f %7.3f %7.3f", p->root, p->trajectory, p->mean_local(), p->mean_joints());
    std::printf("\n");
  }
}

}  // namespace program
