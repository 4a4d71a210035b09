// Text in, motion out: the bundled model turns a timeline into motion, and the result is written for other programs.
//   usage: 04_text_to_motion [model.safetensors [folder]]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <motionlang/formats/bvh.hpp>
#include <motionlang/stmc.hpp>
#include <motionlang/view/viewer.hpp>

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

int main(int argc, char** argv) try {
  const std::string model = argc > 1 ? argv[1] : MOTIONLANG_DEFAULT_MODEL, folder = argc > 2 ? argv[2] : ".";
  const auto stmc = ml::load_stmc<B>(model);
  const auto timeline = ml::parse_timeline(
      "walk forward    # 0.0 # 4.0 # legs\n"
      "raise both arms # 1.0 # 3.5 # left arm # right arm\n");
  const ml::Motion motion = ml::generate_motion(stmc, timeline, {.seed = 7});

  const auto way = motion.root_at(motion.frames() - 1) - motion.root_at(0);
  const auto joints = motion.positions();  // (frames, joints)
  const auto height = [&](ml::Index frame, const char* joint) {
    return joints[static_cast<std::size_t>(frame * motion.skeleton.size() + motion.skeleton[joint])].y;
  };
  double highest = -9;  // of the lower wrist above its shoulder, metres
  for (ml::Index f = 0; f < motion.frames(); ++f)
    highest = std::max(highest, std::min(height(f, "left_wrist") - height(f, "left_shoulder"),
                                         height(f, "right_wrist") - height(f, "right_shoulder")));
  std::printf("%.1f s, %td frames of %d joints\n", motion.seconds(), motion.frames(), motion.skeleton.size());
  std::printf("walked more than 2 m: %s\n", std::hypot(way.x, way.z) > 2 ? "yes" : "no");
  std::printf("both wrists above the shoulders at some moment: %s\n", highest > 0 ? "yes" : "no");

  ml::write_bvh(folder + "/text_to_motion.bvh", motion);
  ml::write_viewer(folder + "/text_to_motion.html", motion, {}, {.title = "walk forward, raise both arms"});
  std::printf("wrote text_to_motion.bvh and text_to_motion.html\n");
} catch (const ml::error& e) {  // a missing file, ...
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
