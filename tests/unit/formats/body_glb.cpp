// The user's body in motion: names of joints, hands, the mesh in GLB files, one OBJ file for each frame.
#include <motionlang/backend/reference.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/formats/body_glb.hpp>
#include <motionlang/formats/figure_body.hpp>
#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/view/body_viewer.hpp>

#include "../../support/check_error.hpp"
#include "../../support/octahedra_body.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::ReferenceBackend<double>;

namespace {

/// A body of SMPL's joints, a head taller than the library's figure, with one direction of shape: broader.
ml::Body<B> tall_body() {
  ml::Skeleton s = ml::smpl24_skeleton();
  for (auto& o : s.offsets) o = 1.1 * o;
  ml::Body<B> body = ml::figure_body<B>(s);
  body.kind = ml::BodyKind::smpl;
  std::vector<double> broader;
  const auto points = body.model.v_template.span();
  for (std::size_t i = 0; i < points.size(); ++i) broader.push_back(i % 3 == 0 ? 0.1 * points[i] : 0);
  body.model.shapedirs = ml::Tensor<B, 2>::from(broader, {std::ssize(broader), 1});
  return body;
}
double largest_difference(const std::vector<ml::Vec3<double>>& a, std::span<const double> b) {
  REQUIRE(b.size() == 3 * a.size());
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    worst = std::max(worst, norm(a[i] - ml::Vec3<double>{b[3 * i], b[3 * i + 1], b[3 * i + 2]}));
  return worst;
}

}  // namespace

TEST_CASE("names of the joints of bodies") {
  CHECK(ml::body_joint_names(ml::BodyKind::smpl, 24) == ml::smpl24_skeleton().names);
  const auto h = ml::body_joint_names(ml::BodyKind::smplh, 52), x = ml::body_joint_names(ml::BodyKind::smplx, 55);
  CHECK(h.size() == 52);
  CHECK(h[22] == "left_index1");
  CHECK(h[51] == "right_thumb3");
  CHECK(x.size() == 55);
  CHECK(x[22] == "jaw");
  CHECK(x[40] == "right_index1");
  CHECK(ml::body_joint_names(ml::BodyKind::other, 2) == std::vector<std::string>{"joint_0", "joint_1"});
}

TEST_CASE("a motion on a body: its joints are where the model puts them, its legs scale the path") {
  const auto body = tall_body();
  const ml::Motion walk = synthetic::walk({.frames = 6, .turn = 0.3});
  const std::vector<double> betas{0.7};
  const ml::Motion own = ml::motion_on_body(body, walk, std::span<const double>(betas));
  CHECK(own.skeleton.names == walk.skeleton.names);
  CHECK(own.root[5].z == doctest::Approx(1.1 * walk.root[5].z));
  CHECK(norm(own.skeleton.offset(16)) > 1.1 * norm(walk.skeleton.offset(16)));  // broader
  const auto posed = ml::pose_body(body.model, own, std::span<const double>(betas));
  CHECK(largest_difference(own.positions(), posed.joints.span()) < 1e-9);
  const ml::Motion kit{ml::kit21_skeleton(), 20, {{}}, std::vector(21, ml::Quaternion<double>::identity()), "kit"};
  CHECK_ERROR(ml::motion_on_body(body, kit), "[motionlang.config.106] motion_on_body: the 21 joints of motion 'kit'");
  const std::vector<double> two{0.7, 1};
  CHECK_ERROR(ml::motion_on_body(body, walk, std::span<const double>(two)), "[motionlang.shape.204]");
}

TEST_CASE("hands of a motion on a body of SMPL-H") {
  ml::Body<B> body = ml::figure_body<B>(octahedra::skeleton(ml::BodyKind::smplh));
  body.kind = ml::BodyKind::smplh;
  std::vector<double> mean(45, 0.0);
  mean[2] = -0.5;
  body.left_hand = ml::HandPoses<B>{ml::Tensor<B, 2>::zeros({1, 45}), ml::Tensor<B, 1>::from(mean, {45})};
  const ml::Motion walk = synthetic::walk({.frames = 2});
  const ml::Motion bent = ml::motion_on_body(body, walk),
                   flat = ml::motion_on_body(body, walk, {}, ml::BodyHands::flat);
  CHECK(bent.skeleton.size() == 52);
  CHECK(bent.rotations(1)[22].z == doctest::Approx(std::sin(-0.25)));
  CHECK(flat.rotations(1)[22].z == 0);
  CHECK(bent.rotations(1)[37].w == 1);  // no such hand in the file
  CHECK(bent.rotations(1)[21].w == walk.rotations(1)[21].w);
}

TEST_CASE("a body in a GLB file: skin, weights, animation") {
  const TemporaryFolder folder;
  auto body = tall_body();
  // one vertex that follows five joints: the four largest are kept
  std::vector<double> weights(body.model.weights.span().begin(), body.model.weights.span().end());
  std::fill_n(weights.begin(), 24, 0.0);
  weights[1] = 0.4, weights[2] = 0.3, weights[3] = 0.05, weights[4] = 0.15, weights[5] = 0.1;
  body.model.weights = ml::Tensor<B, 2>::from(weights, body.model.weights.shape());
  const ml::Motion walk = synthetic::walk({.frames = 6, .turn = 0.3});
  ml::write_body_glb(folder / "walk.glb", body, std::span(&walk, 1));
  const auto file = ml::GlbFile::open(folder / "walk.glb");
  const ml::Motion read = file.motion(0, walk.fps), own = ml::motion_on_body(body, walk);
  REQUIRE(read.frames() == own.frames());
  const auto a = read.positions(), b = own.positions();
  double worst = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    worst = std::max(
        worst,
        norm(a[i / 24 * 24 + static_cast<std::size_t>(read.skeleton[own.skeleton.name(static_cast<int>(i % 24))])] -
             b[i]));
  }
  CHECK(worst < 1e-5);
  const auto mesh = ml::detail::body_mesh(body, {});
  CHECK(mesh.positions.size() == static_cast<std::size_t>(body.model.vertices()));
  CHECK(mesh.triangles.size() == 3 * body.faces.size());
  CHECK(std::vector<int>(mesh.joints.begin(), mesh.joints.begin() + 4) == std::vector<int>{1, 2, 4, 5});
  for (std::size_t i = 0; i < mesh.weights.size(); i += 4) {
    CHECK(mesh.weights[i] + mesh.weights[i + 1] + mesh.weights[i + 2] + mesh.weights[i + 3] == 65535);
  }
  CHECK(mesh.weights[0] == doctest::Approx(65535 * 0.4 / 0.95).epsilon(1e-4));
  // of a sphere around a joint normals point outwards
  const auto head = vec_cast<float>(own.skeleton.rest_positions()[15]);
  int outwards = 0, of_head = 0;
  for (std::size_t v = 1; v < mesh.positions.size(); ++v) {
    if (mesh.joints[4 * v] != 15) continue;
    ++of_head;
    outwards += dot(mesh.positions[v] - head, mesh.normals[v]) > 0;
  }
  CHECK(of_head > 100);
  CHECK(outwards > 0.9 * of_head);
  body.faces.clear();
  CHECK_ERROR(ml::body_glb_bytes(body, std::span(&walk, 1)), "[motionlang.config.101] GLB: the body has no faces");
}

TEST_CASE("a body as one OBJ file for each frame") {
  const TemporaryFolder folder;
  const auto body = tall_body();
  const ml::Motion walk = synthetic::walk({.frames = 35});
  CHECK(ml::write_body_objs(folder / "walk.obj", body, walk) == 35);
  const std::string last = ml::read_file(folder / "walk_0034.obj");
  CHECK(last.starts_with("v "));
  const auto posed = ml::pose_body(body.model, ml::motion_on_body(body, walk));
  const auto width = static_cast<std::size_t>(3 * body.model.vertices());
  CHECK(last == ml::obj_text(std::span<const double>(posed.vertices.span()).subspan(34 * width, width),
                             std::span<const std::array<Index, 3>>(body.faces)));
}

TEST_CASE("a page with a body: its surface at rest, and motions on its joints") {
  const auto body = tall_body();
  const ml::Motion walk = synthetic::walk({.frames = 3});
  const std::vector<ml::ViewerMotion> motions{{walk, {{"walking", 0, 1}}}, {walk}};
  const std::string page = ml::body_viewer_html(body, std::span<const ml::ViewerMotion>(motions));
  const auto begin = page.find("id=\"data\">") + 10, end = page.find("</script>", begin);
  const auto json = nlohmann::json::parse(page.substr(begin, end - begin));
  CHECK(json["motions"].size() == 2);
  CHECK(json["motions"][0]["tracks"].size() == 1);
  const auto bytes = [&](const char* name) { return ml::detail::from_base64(json["body"][name].get<std::string>()); };
  const auto count = static_cast<std::size_t>(body.model.vertices());
  CHECK(bytes("positions").size() == 12 * count);
  CHECK(bytes("joints").size() == 8 * count);
  CHECK(bytes("weights").size() == 8 * count);
  CHECK(bytes("triangles").size() == 12 * body.faces.size());
  CHECK(json["body"]["parents"] == json["motions"][0]["parents"]);
  CHECK(json["body"]["offsets"] == json["motions"][0]["offsets"]);
  const std::vector<double> two{0.5, 1};
  CHECK_ERROR(ml::body_viewer_html(body, std::span<const ml::ViewerMotion>(motions), std::span<const double>(two)),
              "[motionlang.shape.204]");
  ml::Body<B> bare = body;
  bare.faces.clear();
  CHECK_ERROR(ml::body_viewer_html(bare, std::span<const ml::ViewerMotion>(motions)), "[motionlang.config.101] viewer");
}
