// The free body: the figure of a skeleton as a body model, posed by motions, written as OBJ.
#include <motionlang/backend/reference.hpp>
#include <motionlang/formats/figure_body.hpp>
#include <motionlang/formats/obj.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::ReferenceBackend<double>;

namespace {

/// Random poses of a skeleton, the root far from where it rests.
ml::Motion motion_of(const ml::Skeleton& skeleton, Index frames) {
  ml::Motion m{skeleton, 20, {}, {}, "random"};
  ml::Philox rng{.seed = 5};
  std::vector<float> n(static_cast<std::size_t>(frames * (3 + 3 * skeleton.size())));
  rng.normal(std::span<float>(n));
  auto next = [&, at = std::size_t{0}]() mutable { return static_cast<double>(n[at++]); };
  for (Index f = 0; f < frames; ++f) {
    m.root.push_back({next(), next(), next()});
    for (int j = 0; j < skeleton.size(); ++j)
      m.local.push_back(ml::to_quaternion(ml::AxisAngle<double>{{next(), next(), next()}}));
  }
  return m;
}

}  // namespace

TEST_CASE("joints of the body are those of the motion, in every frame") {
  const auto lonely = ml::Skeleton::from_joints({{"only", "", {1, 2, 3}}});
  for (const ml::Skeleton& skeleton : {ml::smpl24_skeleton(), ml::kit21_skeleton(), lonely}) {
    const auto body = ml::figure_body<B>(skeleton);
    body.model.validate();
    const ml::Motion motion = motion_of(skeleton, 3);
    const auto joints = ml::pose_body(body.model, motion).joints;
    const auto expected = motion.positions();
    double worst = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const ml::Vec3<double> p{joints.span()[3 * i], joints.span()[3 * i + 1], joints.span()[3 * i + 2]};
      worst = std::max(worst, norm(p - expected[i]));
    }
    CHECK(worst < 1e-12);
  }
}

TEST_CASE("its surface is closed: every edge of two triangles, once in each direction") {
  const auto body = ml::figure_body<B>(ml::smpl24_skeleton());
  const auto points = body.model.v_template.span();
  auto place = [&](Index v) { return points.data() + 3 * v; };
  auto same = [&](Index a, Index b) {
    return std::equal(place(a), place(a) + 3, place(b), [](double x, double y) { return std::abs(x - y) < 1e-7; });
  };
  std::vector<std::pair<Index, Index>> open;
  auto pole = [&](Index v) {  // the first vertex at the same place in a ring of 16
    const Index ring = v / 16 * 16;
    return same(ring, ring + 1) ? ring : v;
  };
  for (const auto& f : body.faces) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::pair edge{pole(f[c]), pole(f[(c + 1) % 3])};
      const auto back = std::find(open.begin(), open.end(), std::pair{edge.second, edge.first});
      if (back != open.end())
        open.erase(back);
      else
        open.push_back(edge);
    }
  }
  CHECK(open.empty());
}

TEST_CASE("vertices keep their distance to the joint that they follow") {
  const auto body = ml::figure_body<B>(ml::humanml3d22_skeleton());
  const ml::Motion motion = motion_of(ml::humanml3d22_skeleton(), 2);
  ml::Motion rest = motion;
  for (auto& q : rest.local) q = ml::Quaternion<double>::identity();
  const auto moved = ml::pose_body(body.model, motion), still = ml::pose_body(body.model, rest);
  const Index vertices = body.model.vertices(), joints = body.model.joints();
  double worst = 0;
  for (Index f = 0; f < 2; ++f) {
    for (Index v = 0; v < vertices; ++v) {
      const auto weights =
          body.model.weights.span().subspan(static_cast<std::size_t>(v * joints), static_cast<std::size_t>(joints));
      const Index j = std::max_element(weights.begin(), weights.end()) - weights.begin();
      auto reach = [&](const ml::PosedBody<B>& p) {
        auto at = [&](const auto& t, Index i) {
          const double* x = t.span().data() + 3 * i;
          return ml::Vec3<double>{x[0], x[1], x[2]};
        };
        return norm(at(p.vertices, f * vertices + v) - at(p.joints, f * joints + j));
      };
      worst = std::max(worst, std::abs(reach(moved) - reach(still)));
    }
  }
  CHECK(worst < 1e-12);
}

TEST_CASE("a motion poses a larger body that begins with its joints; others are refused") {
  const auto body = ml::figure_body<B>(ml::smpl24_skeleton());
  const ml::Motion motion = motion_of(ml::humanml3d22_skeleton(), 1);
  CHECK(ml::pose_body(body.model, motion).joints.shape() == ml::Shape{1, 24, 3});
  CHECK_ERROR(ml::pose_body(ml::figure_body<B>(ml::humanml3d22_skeleton()).model, motion_of(ml::smpl24_skeleton(), 1)),
              "[motionlang.config.106] pose_body: the 24 joints");
  CHECK_ERROR(ml::pose_body(body.model, motion_of(ml::kit21_skeleton(), 1)), "[motionlang.config.106]");
  const double one[] = {1};
  CHECK_ERROR(ml::pose_body(body.model, motion, one), "[motionlang.shape.204] pose_body");
}

TEST_CASE("OBJ: a triangle as text, and what cannot be one") {
  const std::vector<double> points{0, 0, 0, 1, 0.5, 0, 0, 1, -2};
  const std::vector<std::array<Index, 3>> faces{{0, 1, 2}};
  const TemporaryFolder folder;
  ml::write_obj(folder / "t.obj", std::span<const double>(points), faces);
  CHECK(ml::read_file(folder / "t.obj") == "v 0 0 0\nv 1 0.5 0\nv 0 1 -2\nf 1 2 3\n");
  auto text = [](std::vector<double> v, std::array<Index, 3> f) {
    return ml::obj_text(std::span<const double>(v), std::span(&f, 1));
  };
  CHECK_ERROR(text({0, 0}, {0, 0, 0}), "[motionlang.shape.205]");
  CHECK_ERROR(text({0, 0, 0}, {0, 0, 1}), "OBJ: face 0 has vertex 1 of 1");
  CHECK_ERROR(text({0, std::nan(""), 0}, {0, 0, 0}), "[motionlang.numeric.301]");
}
