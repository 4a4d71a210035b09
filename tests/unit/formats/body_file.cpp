// Bodies from files: the same body in every dialect, and files that are not one.
#include <motionlang/backend/reference.hpp>
#include <motionlang/formats/body_file.hpp>
#include <motionlang/formats/merged_body.hpp>

#include "../../support/body_arrays.hpp"
#include "../../support/check_error.hpp"
#include "../../support/synthetic_body.hpp"
#include "../../support/temporary_folder.hpp"
#include "../../support/tensors.hpp"
#include "../../support/tests_folder.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::ReferenceBackend<double>;
using tensors::distance;

namespace {

using body_arrays::array, body_arrays::chain, body_arrays::numbers;

/// The arrays of the body of tests/support/synthetic_body.hpp.
std::vector<ml::NamedArray> tiny() {
  const std::vector<std::int64_t> kintree{-1, 0, 1, 1, 0, 1, 2, 3}, f{0, 1, 2, 0, 2, 3, 2, 3, 4};
  return {{"v_template", array(synthetic::template_points(), {5, 3})},
          {"shapedirs", array(synthetic::wave(1, 30), {5, 3, 2})},
          {"posedirs", array(synthetic::wave(2, 405), {5, 3, 27})},
          {"J_regressor", array(synthetic::shares(3, 4, 5), {4, 5})},
          {"weights", array(synthetic::shares(4, 5, 4), {5, 4})},
          {"kintree_table", ml::NpyArray::of(std::span<const std::int64_t>(kintree), {2, 4})},
          {"f", ml::NpyArray::of(std::span<const std::int64_t>(f), {3, 3})}};
}
ml::NpyArray& named(std::vector<ml::NamedArray>& arrays, std::string_view name) {
  return std::find_if(arrays.begin(), arrays.end(), [&](const auto& a) { return a.name == name; })->array;
}

struct BodyFolder : TemporaryFolder {
  ml::Body<B> read(const std::vector<ml::NamedArray>& arrays, const ml::BodyFileOptions& options = {.betas = 2}) const {
    ml::write_npz(path / "body.npz", arrays);
    return ml::read_body<B>(path / "body.npz", options);
  }
};

void check_tiny(const ml::Body<B>& body) {
  const auto expected = synthetic::body<B>();
  CHECK(body.kind == ml::BodyKind::other);
  CHECK(distance(body.model.v_template, expected.v_template) < 1e-15);
  CHECK(distance(body.model.shapedirs, expected.shapedirs) < 1e-15);
  CHECK(distance(body.model.posedirs, expected.posedirs) < 1e-15);
  CHECK(distance(body.model.J_regressor, expected.J_regressor) < 1e-15);
  CHECK(distance(body.model.weights, expected.weights) < 1e-15);
  CHECK(body.model.parents == expected.parents);
  CHECK(body.model.extra.empty());
  CHECK(body.faces == synthetic::faces);
  CHECK(!body.left_hand);
}

}  // namespace

TEST_CASE("npz and pickles of all dialects hold the same body") {
  check_tiny(BodyFolder().read(tiny()));
  const auto samples = std::filesystem::path(tests_folder()) / "fuzz/corpus/pickle";
  for (const char* name : {"body_p0.pkl", "body_p2.pkl", "body_p4.pkl", "body_p5.pkl", "body_python2.pkl"}) {
    CAPTURE(name);
    check_tiny(ml::read_body<B>(samples / name, {.betas = 2}));
  }
}

TEST_CASE("fewer coefficients of shape are the first ones") {
  const auto body = BodyFolder().read(tiny(), {.betas = 1});
  CHECK(distance(body.model.shapedirs, ml::slice(synthetic::body<B>().shapedirs, 1, 0, 1)) < 1e-15);
  CHECK(BodyFolder().read(tiny(), {.betas = 0}).model.shapedirs.shape() == ml::Shape{15, 0});
  CHECK_ERROR(BodyFolder().read(tiny(), {.betas = 3}), "[motionlang.config.101]");
  const auto coefficients = [](const ml::BodyFileOptions& o) {
    return BodyFolder().read(tiny(), o).model.shapedirs.size(1);
  };
  CHECK(coefficients({.betas = 0, .most_betas = 1}) == 1);
  CHECK(coefficients({.betas = 1, .most_betas = 16}) == 2);
  CHECK(coefficients({.betas = 2, .most_betas = 1}) == 2);
  CHECK_ERROR(coefficients({.betas = 3, .most_betas = 16}), "[motionlang.config.101]");
}

TEST_CASE("SMPL-X: coefficients of expression follow those of shape, in old and in new files") {
  for (const auto& [directions, first] : {std::pair<Index, Index>{20, 10}, {400, 300}}) {
    const auto body = BodyFolder().read(chain(55, 2, directions), {.betas = 4, .expressions = 3});
    CHECK(body.kind == ml::BodyKind::smplx);
    CHECK(body.expressions == 3);
    const auto all = ml::Tensor<B, 2>::from(numbers(6 * directions), {6, directions});
    CHECK(distance(body.model.shapedirs, ml::concat(1, ml::slice(all, 1, 0, 4), ml::slice(all, 1, first, first + 3))) ==
          0);
  }
  CHECK_ERROR(BodyFolder().read(chain(55, 2, 20), {.betas = 10, .expressions = 11}), "the file has 10 and 10");
  CHECK(BodyFolder().read(chain(55, 2, 400), {.betas = 10}).expressions == 10);
  // of other numbers nothing is known: all are directions of shape, unless somebody says otherwise
  const auto sixteen = BodyFolder().read(chain(55, 2, 16), {.betas = 16});
  CHECK(sixteen.expressions == 0);
  CHECK(sixteen.model.shapedirs.size(1) == 16);
  CHECK_ERROR(BodyFolder().read(chain(55, 2, 16), {.betas = 10, .expressions = 6}), "the file has 16 and 0");
  const auto told = BodyFolder().read(chain(55, 2, 16), {.betas = 4, .shape_directions = 12});
  CHECK(told.expressions == 4);
  const auto all = ml::Tensor<B, 2>::from(numbers(96), {6, 16});
  CHECK(distance(told.model.shapedirs, ml::concat(1, ml::slice(all, 1, 0, 4), ml::slice(all, 1, 12, 16))) == 0);
}

TEST_CASE("hands") {
  auto arrays = chain(52, 2, 10);
  arrays.push_back({"hands_componentsl", array(numbers(90), {2, 45})});
  arrays.push_back({"hands_meanl", array(synthetic::wave(3, 45), {45})});
  const auto body = BodyFolder().read(arrays, {.betas = 10});
  CHECK(body.kind == ml::BodyKind::smplh);
  REQUIRE(body.left_hand.has_value());
  CHECK(!body.right_hand);
  const auto pose = (*body.left_hand)(ml::Tensor<B, 2>::from({2.0}, {1, 1}));
  const auto flat = (*body.left_hand)(ml::Tensor<B, 2>::from({0.0, -1.0}, {1, 2}), true);
  for (std::size_t i = 0; i < 45; ++i) {
    CHECK(pose.span()[i] == doctest::Approx(2 * numbers(90)[i] + synthetic::wave(3, 45)[i]));
    CHECK(flat.span()[i] == doctest::Approx(-numbers(90)[45 + i]));
  }
  CHECK_ERROR((*body.left_hand)(ml::Tensor<B, 2>::zeros({1, 3})), "[motionlang.shape.203]");
}

TEST_CASE("hands from MANO's own files") {
  const BodyFolder folder;
  ml::write_npz(folder / "MANO_LEFT.npz", {{{"hands_components", array(numbers(90), {2, 45})},
                                            {"hands_mean", array(synthetic::wave(3, 45), {45})}}});
  auto body = folder.read(chain(52, 2, 10), {.betas = 10});
  CHECK(!body.left_hand);
  body.left_hand = ml::read_hand<B>(folder / "MANO_LEFT.npz");
  CHECK(body.left_hand->components.shape() == ml::Shape{2, 45});
  CHECK(body.left_hand->mean.span()[7] == synthetic::wave(3, 45)[7]);
  CHECK_ERROR(ml::read_hand<B>(folder / "body.npz"), "[motionlang.io.406]");
}

TEST_CASE("SMPL-H and both hands of MANO in one file") {
  const BodyFolder folder;
  const auto mano = [&](const char* name, int k) {
    ml::write_npz(folder / name, {{{"hands_components", array(synthetic::wave(k, 90), {2, 45})},
                                   {"hands_coeffs", array(synthetic::wave(k, 9), {3, 3})},
                                   {"hands_mean", array(synthetic::wave(k + 1, 45), {45})}}});
  };
  mano("MANO_LEFT.npz", 4);
  mano("MANO_RIGHT.npz", 6);
  const auto alone = folder.read(chain(52, 2, 16), {.betas = 16});
  ml::merge_smplh(folder / "body.npz", folder / "MANO_LEFT.npz", folder / "MANO_RIGHT.npz", folder / "SMPLH_MALE.npz");
  const auto body = ml::read_body<B>(folder / "SMPLH_MALE.npz", {.betas = 16});
  for (const auto member : {&ml::BodyModel<B>::v_template, &ml::BodyModel<B>::shapedirs, &ml::BodyModel<B>::posedirs,
                            &ml::BodyModel<B>::J_regressor, &ml::BodyModel<B>::weights})
    CHECK(distance(body.model.*member, alone.model.*member) == 0);
  CHECK(body.model.parents == alone.model.parents);
  REQUIRE((body.left_hand && body.right_hand));
  CHECK(body.left_hand->components.to_vector() == synthetic::wave(4, 90));
  CHECK(body.left_hand->mean.to_vector() == synthetic::wave(5, 45));
  CHECK(body.right_hand->components.to_vector() == synthetic::wave(6, 90));
  CHECK(ml::NpzArchive::open(folder / "SMPLH_MALE.npz").read("hands_coeffsr").shape == std::vector<Index>{3, 3});
  CHECK(ml::with_mean_hands(body, ml::Tensor<B, 3>::zeros({1, 22, 9})).size(1) == 52);

  const auto merge = [&](const char* from, const char* left) {
    ml::merge_smplh(folder / from, folder / left, folder / "MANO_RIGHT.npz", folder / "other.npz");
  };
  CHECK_ERROR(merge("body.npz", "body.npz"), "no 'hands_components'; not a hand of MANO");
  folder.read(chain(24, 2, 10));
  CHECK_ERROR(merge("body.npz", "MANO_LEFT.npz"), "a body of 24 joints; hands belong to SMPL-H");
  CHECK(!ml::detail::readable(folder / "other.npz"));
}

TEST_CASE("face landmarks are points on triangles, and move with the body") {
  auto arrays = tiny();
  const std::int64_t triangles[] = {2, 0}, rows[] = {0, 1, 2, 2, 1, 0};
  arrays.push_back({"lmk_faces_idx", ml::NpyArray::of(std::span<const std::int64_t>(triangles), {2})});
  arrays.push_back({"lmk_bary_coords", array({0.5, 0.25, 0.25, 0, 0, 1}, {2, 3})});
  arrays.push_back({"dynamic_lmk_faces_idx", ml::NpyArray::of(std::span<const std::int64_t>(rows), {2, 3})});
  arrays.push_back({"dynamic_lmk_bary_coords", array(std::vector<double>(18, 1.0 / 3), {2, 3, 3})});
  const BodyFolder folder;
  const auto body = folder.read(arrays);
  REQUIRE(body.landmarks.size() == 2);
  REQUIRE(body.contours.size() == 2);
  CHECK(body.contours[1].corners[0] == synthetic::faces[2]);
  const auto vertices = ml::Tensor<B, 3>::from(synthetic::wave(9, 30), {2, 5, 3});
  const auto points = ml::surface_points(vertices, body.landmarks);
  CHECK(points.shape() == ml::Shape{2, 2, 3});
  const auto v = vertices.span(), p = points.span();
  for (std::size_t n = 0; n < 2; ++n) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto at = [&](std::size_t i) { return v[15 * n + 3 * i + c]; };  // triangle 2 is (2, 3, 4)
      CHECK(p[6 * n + c] == doctest::Approx(0.5 * at(2) + 0.25 * at(3) + 0.25 * at(4)));
      CHECK(p[6 * n + 3 + c] == at(2));  // of triangle 0, (0, 1, 2), the last corner
    }
  }
  named(arrays, "lmk_bary_coords") = array({0.5, 0.5}, {2, 1});
  CHECK_ERROR(folder.read(arrays), "[motionlang.io.407]");
  named(arrays, "lmk_bary_coords") = array({0.5, 0.25, 0.25, 0, 0, 1}, {2, 3});
  const std::int64_t none[] = {2, 3};
  named(arrays, "lmk_faces_idx") = ml::NpyArray::of(std::span<const std::int64_t>(none), {2});
  CHECK_ERROR(folder.read(arrays), "'lmk_faces_idx' has triangle 3 of 3");
  named(arrays, "lmk_faces_idx") = ml::NpyArray::of(std::span<const std::int64_t>(none, 1), {});
  CHECK_ERROR(folder.read(arrays), "'lmk_faces_idx' has 0 axes, expected 1 or 2");
}

TEST_CASE("extra points are vertices of the published bodies only") {
  CHECK(ml::extra_vertices(ml::BodyKind::smplh) == ml::extra_vertices(ml::BodyKind::smpl));
  CHECK(ml::extra_vertices(ml::BodyKind::smpl).size() == 21);
  CHECK(ml::extra_vertices(ml::BodyKind::smplx)[2] == 9448);
  CHECK(ml::extra_vertices(ml::BodyKind::other).empty());
  CHECK(ml::body_points[7].name == "left_heel");
  CHECK(ml::body_points[7].smpl == 3387);
  CHECK(BodyFolder().read(chain(24, 2, 10), {.betas = 10}).model.extra.empty());
}

TEST_CASE("what is not a body is refused") {
  const BodyFolder folder;
  auto refuse = [&](const char* name, const ml::NpyArray& other, const char* text) {
    auto arrays = tiny();
    named(arrays, name) = other;
    CHECK_ERROR(folder.read(arrays), text);
  };
  for (std::size_t i = 0; i < tiny().size(); ++i) {
    auto arrays = tiny();
    arrays.erase(arrays.begin() + static_cast<std::ptrdiff_t>(i));
    CHECK_ERROR(folder.read(arrays), "[motionlang.io.406]");
  }
  refuse("kintree_table", array({-1, 0, 1, 1, 0, 1, 3, 2}, {2, 4}), "'kintree_table' calls joint 2 3");
  refuse("kintree_table", array({-1, 2, 1, 1, 0, 1, 2, 3}, {2, 4}),
         "joint 1 has parent 2, which does not come before it");
  refuse("kintree_table", array({-1, -1, 1, 1, 0, 1, 2, 3}, {2, 4}), "joint 1 has parent -1");
  refuse("kintree_table", array({}, {2, 0}), "has no joints");
  refuse("v_template", array(numbers(12), {4, 3}), "[motionlang.io.407]");
  refuse("posedirs", array(numbers(405), {15, 27}), "'posedirs' is (15, 27), expected (5, 3, 27)");
  refuse("shapedirs", array(numbers(30), {3, 5, 2}), "[motionlang.io.407]");
  refuse("J_regressor", array(numbers(20), {5, 4}), "expected (4, 5)");
  refuse("weights", array(numbers(20), {5, 4}), "'weights' of vertex 0 sum up to");
  refuse("f", array(numbers(3), {1, 3}), "[motionlang.io.407]");
  const std::int64_t five[] = {0, 1, 5};
  refuse("f", ml::NpyArray::of(std::span<const std::int64_t>(five), {1, 3}), "face 0 has vertex 5 of 5");
  auto points = synthetic::template_points();
  points[4] = std::nan("");
  refuse("v_template", array(points, {5, 3}), "[motionlang.numeric.301]");
  ml::write_file(folder / "text.pkl", "not a body");
  CHECK_ERROR(ml::read_body<B>(folder / "text.pkl"), "[motionlang.io.40");
  CHECK_ERROR(ml::read_body<B>(folder / "missing.npz"), "[motionlang.io.401]");
}

TEST_CASE("files are found under their usual names; if there is none, the error says where to get it") {
  const TemporaryFolder root;
  CHECK_ERROR(ml::find_body_file(root.path, ml::BodyKind::smpl), "[motionlang.io.401] no SMPL file such as");
  CHECK_ERROR(ml::find_body_file(root.path, ml::BodyKind::smplh), "register at https://mano.is.tue.mpg.de");
  CHECK_ERROR(ml::find_body_file(root.path, ml::BodyKind::smplx), "SMPLX_NEUTRAL.npz: register at https://smpl-x");
  CHECK_ERROR(ml::find_body_file(root.path, ml::BodyKind::other), "[motionlang.config.101]");
  auto expect = [&](const std::string& name, ml::BodyKind kind, ml::BodyGender gender) {
    const auto file = root.path / name;
    std::filesystem::create_directories(file.parent_path());
    ml::write_file(file, "x");
    CHECK(ml::find_body_file(root.path, kind, gender).string() == file.string());
  };
  expect("smpl/basicModel_f_lbs_10_207_0_v1.0.0.pkl", ml::BodyKind::smpl, ml::BodyGender::female);
  expect("smpl/SMPL_FEMALE.pkl", ml::BodyKind::smpl, ml::BodyGender::female);
  expect("smplh/male/model.npz", ml::BodyKind::smplh, ml::BodyGender::male);
  expect("smplx/SMPLX_NEUTRAL.npz", ml::BodyKind::smplx, ml::BodyGender::neutral);
}
