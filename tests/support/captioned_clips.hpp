// SPDX-License-Identifier: MIT
/// A folder with a few made-up BVH clips and their captions, as training expects them.
#pragma once

#include <motionlang/file/file.hpp>
#include <motionlang/formats/bvh.hpp>

#include "synthetic_motion.hpp"
#include "temporary_folder.hpp"

namespace captioned {

struct Clips {
  TemporaryFolder folder;
  std::filesystem::path captions = folder / "captions.tsv";

  Clips() {
    namespace ml = motionlang;
    ml::write_bvh(folder / "walk.bvh", synthetic::walk({.frames = 60}));
    ml::write_bvh(folder / "turn.bvh", synthetic::walk({.frames = 50, .turn = 0.5}));
    ml::write_bvh(folder / "slow.bvh", synthetic::walk({.frames = 50, .steps_per_second = 1.0}));
    ml::write_file(captions,
                   "# clip\tstart\tend\tparts\tcaptions\n"
                   "walk\t0\t3\tlegs\ta person walks forward | someone walks\n"
                   "turn\t0\t2.5\tlegs\ta person walks in a circle to the left\n"
                   "slow\t0\t2.5\tleft arm,right arm\ta person swings the arms slowly\n");
  }
};

}  // namespace captioned
