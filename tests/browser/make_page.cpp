// Writes the page that tests/browser/run.sh opens: browser_page <file.html>
#include <string>
#include <vector>

#include <motionlang/io/viewer.hpp>

#include "../support/synthetic_motion.hpp"

namespace ml = motionlang;

int main(int count, char** arguments) {
  if (count != 2) return 2;
  ml::Motion turning = synthetic::walk({.frames = 41, .fps = 30, .turn = 1.0}, ml::humanml3d22_skeleton());
  turning.name = "turning";
  const std::vector<ml::ViewerMotion> motions{
      {synthetic::walk({.frames = 81}),
       {{"walking", 0, 4, {"legs"}},
        {"</script><script>throw 1</script> & \"waving\"", 1, 3, {"left arm", "right arm"}}},
       "seed 1"},
      {turning}};
  ml::write_viewer(arguments[1], motions, {.title = "browser <test>", .info = "no model"});
}
