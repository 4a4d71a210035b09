// Writes the pages that tests/browser/run.sh opens, with the figure and with a body, and into a folder the gallery and
// the studies: browser_page <figure.html> <body.html> <folder>
#include <filesystem>
#include <string>
#include <vector>

#include <motionlang/backend/reference.hpp>
#include <motionlang/formats/figure_body.hpp>
#include <motionlang/view/body_viewer.hpp>
#include <motionlang/view/gallery_page.hpp>
#include <motionlang/view/study_page.hpp>

#include "../support/synthetic_motion.hpp"

namespace ml = motionlang;

namespace {

void write_study(const ml::FilePath& path, const char* table, ml::StudyKind kind) {
  const ml::StudyFiles files{
      .motion =
          [](const std::string& file) { return synthetic::walk({.frames = 30, .turn = file == "a" ? 0.0 : 1.0}); },
      .timeline =
          [](const std::string& file) {
            return std::vector<ml::Track>{{file, 0, 1, {"legs"}}};
          }};
  ml::write_file(path, ml::study_html(ml::parse_study(table, kind), files, {.seed = 3, .no_preference = true}));
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 4) return 2;
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

  const std::filesystem::path folder = arguments[3];
  const std::vector<ml::GalleryCard> cards{{motions[0].motion, "walk", "walk </script> forward"},
                                           {turning, "turn", "turn"}};
  ml::write_file(folder / "gallery.html", ml::gallery_html(cards, {.title = "All <verbs>"}));
  const char* const table = "text\ttimeline\tours\ttheirs\nwalk\twalking\ta\tb\nturn\t\tb\ta\nstand\t\ta\tb\n";
  write_study(folder / "pairs.html", table, ml::StudyKind::pairs);
  write_study(folder / "rating.html", table, ml::StudyKind::rating);
  write_study(folder / "ranking.html", "motion\tx\ty\tz\na\ta man walks\ta man <runs>\ta man sits\n",
              ml::StudyKind::ranking);
}
