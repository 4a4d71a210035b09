// Writes the pages that tests/browser/run.sh opens, with the figure and with a body: browser_page <figure.html>
// <body.html>
#include <string>
#include <vector>

#include <motionlang/backend/reference.hpp>
#include <motionlang/formats/figure_body.hpp>
#include <motionlang/view/body_viewer.hpp>

#include "../support/synthetic_motion.hpp"

namespace ml = motionlang;

int main(int count, char** arguments) {
  if (count != 3) return 2;
  ml::Motion turning = synthetic::walk({.frames = 41, .fps = 30, .turn = 1.0}, ml::humanml3d22_skeleton());
  turning.name = "turning";
  const std::vector<ml::ViewerMotion> motions{
      {synthetic::walk({.frames = 81}),
       {{"walking", 0, 4, {"legs"}},
        {"</script><script>throw 1</script> & \"waving\"", 1, 3, {"left arm", "right arm"}}},
       "seed 1"},
      {turning}};
  const ml::ViewerOptions options{.title = "browser <test>", .info = "no model"};
  ml::write_viewer(arguments[1], motions, options);
  auto body = ml::figure_body<ml::ReferenceBackend<float>>(ml::smpl24_skeleton());
  body.kind = ml::BodyKind::smpl;
  ml::write_body_viewer(arguments[2], body, std::span<const ml::ViewerMotion>(motions), {}, options);
}
