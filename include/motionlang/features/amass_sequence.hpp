// SPDX-License-Identifier: MIT
/// A sequence of AMASS in the form of its file: rotation vectors, path and shape of an SMPL body, world Z up.
#pragma once

#include <string>  // gender
#include <vector>  // numbers

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct AmassSequence {
  Index frames = 0, columns = 0;  // columns: 66 or more; SMPL-H 156, SMPL-X 165
  std::vector<double> poses{};    // (frames, columns) rotation vectors: root, 21 body joints, hands or face
  std::vector<double> trans{};    // (frames, 3)
  std::vector<double> betas{};    // shape coefficients, 16 or fewer; none if the file has none
  std::string gender = "neutral";
  double fps = 0;
};

MOTIONLANG_NAMESPACE_END
