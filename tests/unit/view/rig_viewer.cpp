// A page with a character: it has the surface and the skeleton of the rig, and motions on them.
#include <doctest/doctest.h>

#include <numbers>

#include <motionlang/geometry/so3.hpp>
#include <motionlang/view/rig_viewer.hpp>

#include "../../support/page_data.hpp"
#include "../../support/rigs.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

TEST_CASE("a character on a page") {
  const auto character = [](double facing) {
    ml::Skeleton s = rigs::skeleton_of(ml::skeleton_table("Unreal 4"), facing);
    s.offsets.back() = {};  // of the thumb, which does not turn along
    return rigs::glb_of(s);
  };
  const auto bytes = character(0);
  const ml::GlbRig rig(bytes, "rig.glb");
  const ml::Motion walk = synthetic::walk({.frames = 5});
  const std::string page = ml::rig_viewer_html(rig, std::span(&walk, 1), {.title = "on a rig"});
  const auto has = [&](const auto& values) {
    return page.find(ml::detail::to_base64(std::as_bytes(std::span(values)))) != page.npos;
  };
  const auto mesh = rig.mesh();
  CHECK(has(mesh.positions));
  CHECK(has(mesh.joints));
  CHECK(has(mesh.weights));
  CHECK(has(mesh.triangles));
  CHECK(page.find("on a rig") != page.npos);
  const ml::Motion on_rig = ml::motions_on_rig(rig, std::span(&walk, 1)).motions.front();
  CHECK(ml::rig_viewer_html(rig, std::span(&on_rig, 1), {.title = "on a rig"}) == page);
  const auto data = nlohmann::json::parse(ml::rig_viewer_data(rig, walk)), in_page = data_of(page);
  CHECK(data["body"] == in_page["body"]);
  CHECK(data["motion"] == in_page["motions"][0]);

  // a character that faces -Z is the same on a page
  const auto back = character(std::numbers::pi);
  const ml::GlbRig turned(back, "back.glb");
  const auto seen = ml::detail::turn_to_front(turned);
  CHECK(ml::distance(seen, ml::from_axis_angle(ml::Vec3<double>{0, 1, 0}, std::numbers::pi)) < 1e-9);
  CHECK(ml::distance(ml::detail::turn_to_front(rig), ml::Quaternion<double>::identity()) < 1e-9);
  const ml::Motion on_turned = ml::motions_on_rig(turned, std::span(&walk, 1)).motions.front(),
                   shown = ml::detail::with_turned_rest(on_turned, seen);
  CHECK(synthetic::largest_distance(on_turned, shown) < 1e-9);
  CHECK(synthetic::largest_distance(on_rig, shown) < 1e-6);
  for (std::size_t j = 0; j < shown.skeleton.offsets.size(); ++j)
    CHECK(norm(shown.skeleton.offsets[j] - on_rig.skeleton.offsets[j]) < 1e-9);

  const TemporaryFolder folder;
  ml::write_rig_viewer(folder / "walk.html", rig, std::span(&walk, 1), {.title = "on a rig"});
  CHECK(ml::read_file(folder / "walk.html") == page);
  CHECK_THROWS_AS(ml::rig_viewer_html(rig, {}), ml::config_error);
}
