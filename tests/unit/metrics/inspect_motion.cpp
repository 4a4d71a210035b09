// The data doctor: a clean clip has no finding; a broken copy of it has exactly the one that belongs to it, and the
// mended copy is the clean clip again.
#include <doctest/doctest.h>

#include <limits>

#include <motionlang/geometry/slerp.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/view/film_strip.hpp>
#include <motionlang/view/inspection_page.hpp>

#include "../../support/check_error.hpp"
#include "../../support/markup.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using doctest::Approx, doctest::Contains;
using Vec = ml::Vec3<double>;

namespace {

ml::Motion walk() { return synthetic::walk({.frames = 60, .fps = 30}); }

/// The faults of a clip, each once, in order.
std::vector<ml::Fault> faults(const ml::Motion& motion) {
  std::vector<ml::Fault> out;
  for (const ml::Finding& f : ml::inspect_motion(motion).findings) out.push_back(f.fault);
  return out;
}
std::vector<ml::Fault> only(ml::Fault fault) { return {fault}; }

ml::Motion scaled(ml::Motion m, double factor) {
  for (Vec& o : m.skeleton.offsets) o = factor * o;
  for (Vec& r : m.root) r = factor * r;
  return m;
}
/// The same in a world that is turned; `rest` too, or the root only.
ml::Motion turned(ml::Motion m, const ml::Quaternion<double>& q, bool rest) {
  for (Vec& r : m.root) r = rotate(q, r);
  for (Vec& o : m.skeleton.offsets) o = rest ? rotate(q, o) : o;
  for (std::size_t i = 0; i < m.local.size(); ++i) {
    if (rest)
      m.local[i] = q * m.local[i] * inverse(q);
    else if (i % m.skeleton.parents.size() == 0)
      m.local[i] = q * m.local[i];
  }
  return m;
}

double difference_when_mended(const ml::Motion& broken, const ml::Motion& sound) {
  return synthetic::largest_distance(ml::mended(broken, ml::inspect_motion(broken).cure), sound);
}

}  // namespace

TEST_CASE("sound clips have no finding") {
  CHECK(faults(walk()).empty());
  CHECK(faults(synthetic::walk({.frames = 100, .turn = 1})).empty());
  CHECK(faults(ml::mirror(walk())).empty());
  CHECK(faults(ml::resample(walk(), 120)).empty());
  CHECK(difference_when_mended(walk(), walk()) == 0);
}

TEST_CASE("a scale that is not human: the factor that fits, and its unit") {
  struct Unit {
    double factor;
    const char* text;
  };
  for (const auto& [factor, text] : {Unit{0.01, "in metres"},
                                     {100, "centimetres"},
                                     {10, "millimetres"},
                                     {1 / 2.54, "inches"},
                                     {0.45 / 2.54, "CMU"},
                                     {1000, "millimetres"}}) {
    const auto broken = scaled(walk(), factor);
    REQUIRE(faults(broken) == only(ml::Fault::scale));
    const auto seen = ml::inspect_motion(broken);
    CHECK(seen.cure.scale == Approx(1 / factor));
    CHECK_MESSAGE(seen.findings[0].text.find(text) != std::string::npos, seen.findings[0].text);
    CHECK(difference_when_mended(broken, walk()) < 1e-9);
  }
  const auto point = ml::inspect_motion(scaled(walk(), 0));
  REQUIRE(point.has(ml::Fault::scale));
  CHECK_MESSAGE(point.findings[0].text.find("have no length") != std::string::npos, point.findings[0].text);
  CHECK(ml::inspect_motion(scaled(walk(), 3.9)).cure.scale == Approx(1.7 / (1.728 * 3.9)).epsilon(0.001));
}

TEST_CASE("a root in another unit than the bones") {
  for (const double factor : {100.0, 0.01, 1000.0, 0.001, 39.37, 1 / 39.37, 30.48, 2.54}) {
    CAPTURE(factor);
    auto broken = walk();
    for (Vec& r : broken.root) r = factor * r;
    CHECK(faults(broken) == only(ml::Fault::root_unit));
    CHECK(ml::inspect_motion(broken).cure.root == Approx(1 / factor).epsilon(1e-4));
    CHECK(difference_when_mended(broken, walk()) < 1e-3);
    CHECK(faults(scaled(broken, 0.01)) == std::vector{ml::Fault::scale, ml::Fault::root_unit});
    CHECK(difference_when_mended(scaled(broken, 0.01), walk()) < 1e-3);
  }
  auto in_the_air = walk(), treading = walk(), odd = walk();
  for (Vec& r : in_the_air.root) r.y += 5;
  for (Vec& r : treading.root) r = {0, 0, 0};
  for (Vec& r : odd.root) r = 17.0 * r;  // no unit is so long
  for (const auto& m : {in_the_air, treading, odd}) CHECK(!ml::inspect_motion(m).has(ml::Fault::root_unit));
}

TEST_CASE("a figure that is drawn small, with short legs, is not made a person") {
  auto dwarf = walk();
  for (const char* joint : {"left_knee", "right_knee", "left_ankle", "right_ankle"}) {
    auto& offset = dwarf.skeleton.offsets[static_cast<std::size_t>(dwarf.skeleton[joint])];
    offset = 0.35 * offset;
  }
  for (auto& o : dwarf.skeleton.offsets) o = 0.7 * o;
  for (auto& r : dwarf.root) r = {r.x, 0.35 * r.y, r.z};
  const auto seen = ml::inspect_motion(dwarf);
  REQUIRE(seen.has(ml::Fault::scale));
  CHECK(seen.cure.scale == 1);
  CHECK_MESSAGE(seen.findings[0].text.find("drawn so, and left so") != std::string::npos, seen.findings[0].text);
}

TEST_CASE("a figure that stands along another axis, with its rest pose or without") {
  for (const auto& q : {synthetic::about_x(std::numbers::pi / 2), synthetic::about_x(-std::numbers::pi / 2),
                        synthetic::about_z(std::numbers::pi / 2), synthetic::about_z(std::numbers::pi)}) {
    for (const bool rest : {true, false}) {
      const auto broken = turned(walk(), q, rest);
      REQUIRE(faults(broken) == only(ml::Fault::up_axis));
      const auto better = ml::mended(broken, ml::inspect_motion(broken).cure);
      CHECK(faults(better).empty());
      CHECK(better.skeleton.rest_positions()[15].y > 1.4);  // the head
    }
  }
  const auto z_up = turned(walk(), synthetic::about_x(std::numbers::pi / 2), true);
  CHECK_MESSAGE(ml::inspect_motion(z_up).findings[0].text.find("+Z") != std::string::npos,
                ml::inspect_motion(z_up).findings[0].text);
  CHECK(difference_when_mended(z_up, walk()) < 1e-9);
  CHECK(faults(turned(walk(), synthetic::about_y(2), true)).empty());
}

TEST_CASE("exchanged sides: of the whole body, of the arms, of the legs") {
  const auto partners = ml::mirror_partners(walk().skeleton);
  auto exchanged = [&](auto&& is_meant) {
    auto m = walk();
    const auto names = m.skeleton.names;
    for (std::size_t j = 0; j < partners.size(); ++j) {
      if (is_meant(names[j])) m.skeleton.names[static_cast<std::size_t>(partners[j])] = names[j];
    }
    return m;
  };
  auto is_leg = [](const std::string& n) {
    return n.ends_with("hip") || n.ends_with("knee") || n.ends_with("ankle") || n.ends_with("foot");
  };
  auto text = [](const ml::Motion& m) {
    const auto found = ml::inspect_motion(m).findings;
    REQUIRE(found.size() == 1);
    CHECK(found[0].fault == ml::Fault::swapped_sides);
    return found[0].text;
  };
  CHECK(text(exchanged([](const auto&) { return true; })).starts_with("left and right are"));
  CHECK(text(exchanged(is_leg)).starts_with("the legs are"));
  CHECK(text(exchanged([&](const auto& n) { return !is_leg(n); })).starts_with("the arms are"));
}

TEST_CASE("values that are not finite") {
  auto m = walk();
  m.local[7 * 24 + 4].x = std::numeric_limits<double>::quiet_NaN();
  CHECK(faults(m) == only(ml::Fault::not_finite));
  CHECK(ml::inspect_motion(m).findings[0].text == "frame 7, joint 'left_knee': not a number");
  m = walk();
  m.root[3].y = std::numeric_limits<double>::infinity();
  CHECK(ml::inspect_motion(m).findings[0].text == "frame 3, joint 'pelvis': not a number");
  CHECK(faults(ml::crop(walk(), 0, 1)) == only(ml::Fault::empty));
  m.root.pop_back();
  CHECK_ERROR(ml::inspect_motion(m), "[motionlang.shape.205]");
}

TEST_CASE("an odd frame rate") {
  auto m = walk();
  for (const double good : {12.5, 23.976, 29.97, 60.0, 119.88, 120.0}) {
    m.fps = good;
    CHECK(ml::inspect_motion(m).has(ml::Fault::frame_rate) == false);
  }
  for (const double odd : {1.0, 31.3, 66.0, 5000.0}) {
    m.fps = odd;
    CHECK(ml::inspect_motion(m).has(ml::Fault::frame_rate));
  }
  for (const double none : {0.0, -20.0, std::numeric_limits<double>::infinity()}) {
    m.fps = none;
    CHECK_ERROR(ml::inspect_motion(m), "[motionlang.config.101]");
  }
}

TEST_CASE("a usual but wrong frame rate: jumps tell it, and it is mended") {
  CHECK(faults(synthetic::jump()).empty());
  CHECK(faults(synthetic::jump(24)).empty());
  for (const double times : {0.25, 0.5, 2.0, 4.0}) {
    auto m = synthetic::jump();
    m.fps *= times;
    REQUIRE(faults(m) == only(ml::Fault::fall));
    const auto seen = ml::inspect_motion(m);
    CHECK(seen.cure.fps == Approx(60));
    const auto better = ml::mended(m, seen.cure);
    CHECK(better.fps == seen.cure.fps);
    CHECK(better.frames() == m.frames());
    CHECK(faults(better).empty());
  }
  auto m = synthetic::jump();
  m.fps = 240;
  CHECK(ml::inspect_motion(m).findings[0].text.ends_with("not 9.81: 4 times too fast, 60 frames per second, not 240"));
  m.fps = 30;
  CHECK(ml::inspect_motion(m).findings[0].text.ends_with("not 9.81: 2 times too slow, 60 frames per second, not 30"));
  m.fps = 144;  // 2.4 times: no whole part of it
  const auto about = ml::inspect_motion(m);
  CHECK(about.has(ml::Fault::fall));
  CHECK(about.cure.fps == 0);
}

TEST_CASE("a frame rate at which steps would sink faster than anything falls; a slow walk may be one") {
  auto m = ml::crop(walk(), 0, 1);
  for (int f = 1; f < 120; ++f) {  // up and down by 5 cm in all, as the hips of who walks 1.8 steps a second
    m = ml::concatenate(m, ml::crop(m, 0, 1));
    m.root.back().y += 0.025 * std::sin(2 * std::numbers::pi * 1.8 * f / 30);
  }
  CHECK(faults(m).empty());
  m.fps = 120;
  REQUIRE(faults(m) == only(ml::Fault::fall));
  CHECK_MESSAGE(ml::inspect_motion(m).findings[0].text.starts_with("between steps the body sinks with "),
                ml::inspect_motion(m).findings[0].text);
  CHECK(ml::inspect_motion(m).cure.fps == 0);
  m.fps = 15;
  CHECK(faults(m).empty());
}

TEST_CASE("a T-pose in front") {
  auto m = walk();
  m.root.insert(m.root.begin(), m.root[0]);
  m.local.insert(m.local.begin(), 24, ml::Quaternion<double>::identity());
  REQUIRE(faults(m) == only(ml::Fault::lead_in));
  CHECK(difference_when_mended(m, walk()) == 0);
}

TEST_CASE("spikes of one frame are found and mended") {
  auto m = walk();
  m.root[30].x += 0.5;
  m.rotations(45)[16] = synthetic::about_z(1.5) * m.rotations(45)[16];  // the left arm
  REQUIRE(faults(m) == only(ml::Fault::spike));                         // and the way back is not a jump
  CHECK(ml::inspect_motion(m).cure.spikes == std::vector<ml::Index>{30, 45});
  CHECK(ml::inspect_motion(m).findings[0].moment == Approx(1));
  auto expected = walk();
  for (const ml::Index f : {30, 45}) {
    expected.root[static_cast<std::size_t>(f)] = 0.5 * (walk().root_at(f - 1) + walk().root_at(f + 1));
    for (std::size_t j = 0; j < 24; ++j)
      expected.rotations(f)[j] = ml::slerp(expected.rotations(f - 1)[j], expected.rotations(f + 1)[j], 0.5);
  }
  CHECK(difference_when_mended(m, expected) < 1e-12);
  CHECK_ERROR(ml::mended(ml::crop(m, 0, 9), ml::inspect_motion(m).cure), "[motionlang.shape.203]");
}

TEST_CASE("a jump to another place is found at its moment") {
  auto m = walk();
  for (ml::Index f = 20; f < m.frames(); ++f) m.root[static_cast<std::size_t>(f)].x += 0.6;
  REQUIRE(faults(m) == only(ml::Fault::jump));
  CHECK(ml::inspect_motion(m).findings[0].moment == Approx(20.0 / 30));
  CHECK(ml::inspect_motion(m).findings[0].text.find("1 jump;") == 0);
}

TEST_CASE("jumps that are spread over frames, and flickers, are found") {
  auto slow = walk(), flicker = walk();
  for (ml::Index f = 20; f < slow.frames(); ++f)
    slow.root[static_cast<std::size_t>(f)].x += 0.35 * static_cast<double>(std::min<ml::Index>(f - 19, 3));
  REQUIRE(faults(slow) == only(ml::Fault::jump));
  CHECK(ml::inspect_motion(slow).findings[0].text.find("3 jumps;") == 0);
  flicker = ml::resample(walk(), 60);
  for (const ml::Index f : {40, 41, 43, 44, 46, 48})  // a left arm that does not know where it belongs
    flicker.rotations(f)[16] = synthetic::about_z(f % 2 == 0 ? 1.2 : 2.4) * flicker.rotations(f)[16];
  CHECK(ml::inspect_motion(flicker).has(ml::Fault::jump));
}

TEST_CASE("feet that slide: a walk on the spot, a path that is too long") {
  auto treadmill = walk(), stretched = walk();
  for (Vec& r : treadmill.root) r.x = r.z = 0;
  for (Vec& r : stretched.root) r.z *= 1.5;
  CHECK(faults(treadmill) == only(ml::Fault::sliding_feet));
  CHECK(faults(stretched) == only(ml::Fault::sliding_feet));
}

TEST_CASE("feet that carry nothing do not slide: in water, on the belly") {
  auto swims = walk(), crawls = walk();
  for (Vec& r : swims.root) r.x = r.z = 0, r.y += 0.8;
  CHECK(faults(swims) == only(ml::Fault::floor));
  for (ml::Index f = 0; f < crawls.frames(); ++f) {  // leans forward about the pelvis and moves on along the floor
    auto& pelvis = crawls.rotations(f)[0];
    pelvis = synthetic::about_x(std::numbers::pi / 2) * pelvis;
    crawls.root[static_cast<std::size_t>(f)] = {0, 0.1, 0.05 * static_cast<double>(f)};
  }
  CHECK(!ml::inspect_motion(crawls).has(ml::Fault::sliding_feet));
}

TEST_CASE("feet that hang do not slide: of who treads water on the spot, and one while the other stands") {
  auto treads = walk(), swings = walk();
  for (Vec& r : treads.root) r.x = r.z = 0, r.y -= 0.15;
  CHECK(faults(treads) == only(ml::Fault::floor));
  for (ml::Index f = 0; f < swings.frames(); ++f) {
    std::ranges::copy(walk().rotations(0), swings.rotations(f).begin());
    const double angle = 0.3 * std::sin(0.4 * static_cast<double>(f));
    const auto pose = swings.rotations(f);
    pose[static_cast<std::size_t>(swings.skeleton["left_hip"])] = synthetic::about_x(-0.5 + angle);
    pose[static_cast<std::size_t>(swings.skeleton["left_knee"])] = synthetic::about_x(1.3);
    swings.root[static_cast<std::size_t>(f)] = walk().root[0];
  }
  CHECK(!ml::inspect_motion(swings).has(ml::Fault::sliding_feet));
}

TEST_CASE("ends of feet stand in for toes that a skeleton lacks") {
  const auto whole = walk();
  ml::Motion m{{}, whole.fps, {}, {}, "on the tips of its toes"};
  std::vector<std::size_t> kept;
  std::vector<int> at(24, -1);
  for (int j = 0; j < 24; ++j) {
    if (whole.skeleton.name(j).ends_with("foot")) continue;
    at[static_cast<std::size_t>(j)] = static_cast<int>(kept.size());
    kept.push_back(static_cast<std::size_t>(j));
    m.skeleton.names.push_back(whole.skeleton.name(j));
    const int parent = whole.skeleton.parent(j);
    m.skeleton.parents.push_back(parent < 0 ? -1 : at[static_cast<std::size_t>(parent)]);
    m.skeleton.offsets.push_back(whole.skeleton.offset(j));
  }
  m.root.assign(60, whole.root[0] + Vec{0, 0.15, 0});
  for (ml::Index f = 0; f < m.frames(); ++f)
    for (const std::size_t j : kept) m.local.push_back(whole.rotations(0)[j]);
  CHECK(faults(m) == only(ml::Fault::floor));
  m.skeleton.ends.assign(kept.size(), {});
  for (const char* ankle : {"left_ankle", "right_ankle"})
    m.skeleton.ends[static_cast<std::size_t>(m.skeleton[ankle])] = {0, -0.2, 0.08};
  CHECK(faults(m).empty());
  for (ml::Index f = 0; f < m.frames(); ++f) m.root[static_cast<std::size_t>(f)].z += 0.02 * static_cast<double>(f);
  CHECK(faults(m) == only(ml::Fault::sliding_feet));
}

TEST_CASE("feet that are not on the floor") {
  for (const double lift : {-0.9, -0.1, 0.2, 3.0}) {
    auto m = walk();
    for (Vec& r : m.root) r.y += lift;
    REQUIRE(faults(m) == only(ml::Fault::floor));
    const auto text = ml::inspect_motion(m).findings[0].text;
    CHECK_MESSAGE((text.find(lift < 0 ? "below" : "above") != std::string::npos), text);
    CHECK(difference_when_mended(m, walk()) < 0.02);
  }
}

TEST_CASE("several faults at once are distinguished and mended together") {
  auto m = scaled(turned(walk(), synthetic::about_x(std::numbers::pi / 2), true), 100);
  m.root.insert(m.root.begin(), m.root[0]);
  m.local.insert(m.local.begin(), 24, ml::Quaternion<double>::identity());
  CHECK(faults(m) == std::vector<ml::Fault>{ml::Fault::lead_in, ml::Fault::scale, ml::Fault::up_axis});
  CHECK(difference_when_mended(m, walk()) < 1e-9);
}

TEST_CASE("a skeleton that nobody knows: values, rates, spikes and jumps are still checked") {
  ml::Motion m{ml::Skeleton::from_joints({{"stem", "", {0, 1, 0}}, {"twig", "stem", {0, 50, 0}}}), 31, {}, {}, ""};
  m.root.assign(20, Vec{0.0, 1.0, 0.0});
  m.local.assign(40, ml::Quaternion<double>::identity());
  CHECK(faults(m) == only(ml::Fault::frame_rate));
  m.root[9].z = 4;
  CHECK(faults(m) == std::vector<ml::Fault>{ml::Fault::frame_rate, ml::Fault::spike});
}

TEST_CASE("the page: a row for every kind of finding, a section for every motion that has one") {
  const auto broken = scaled(walk(), 0.01);
  const std::vector<ml::InspectedMotion> motions{
      {"a/<good>.bvh", "2 s"},
      {"b & c.bvh", "2 s", {}, ml::inspect_motion(broken).findings, ml::film_strip_svg(broken)},
      {"d.bvh", "", "line 3: 'nan' is not a number"}};
  const auto page = ml::inspection_html(motions, "walks");
  CHECK(is_well_formed(page.substr(page.find("<body>"), page.find("</html>") - page.find("<body>"))));
  CHECK(page.find("3 motions: 1 without a finding, 1 with findings, 1 unreadable.") != std::string::npos);
  CHECK(occurrences(page, "<h2>") == 2);
  CHECK(occurrences(page, "<svg") == 1);
  CHECK(page.find("b &amp; c.bvh") != std::string::npos);
  CHECK(page.find("good>") == std::string::npos);
  CHECK(page.find("<td>scale</td><td class=\"n\">1</td>") != std::string::npos);
  CHECK(page.find("line 3: &#39;nan&#39;") != std::string::npos);
  CHECK(ml::count_faults(motions)[static_cast<std::size_t>(ml::Fault::scale)] == 1);
}
