// HumanAct12, UESTC and NTU-13 in files of their form: poses, paths, views, parts, and files that do not fit.
#include <motionlang/datasets/action_recordings.hpp>

#include <doctest/doctest.h>

#include <motionlang/datasets/actor_clips.hpp>
#include <motionlang/geometry/axis_angle.hpp>

#include "../../support/actor_pickles.hpp"
#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
namespace pickles = actor_pickles;
using ml::Index;

namespace {

std::vector<ml::ActionRecording> recordings_of(const char* name, const std::filesystem::path& folder,
                                               ml::LeftOut* left_out = nullptr) {
  std::vector<ml::ActionRecording> out;
  const auto left = ml::read_action_recordings(name, folder, 25, [&](ml::ActionRecording r) { out.push_back(r); });
  if (left_out != nullptr) *left_out = left;
  return out;
}

/// The rows that the published program makes of a recording: two rows of each matrix, and the path.
std::vector<double> published_rows(const std::vector<double>& poses, const std::vector<ml::Vec3<double>>& path) {
  std::vector<double> out;
  for (std::size_t f = 0; f < path.size(); ++f) {
    for (std::size_t j = 0; j < 24; ++j) {
      const double* v = &poses[72 * f + 3 * j];
      const auto r = ml::to_matrix(ml::AxisAngle<double>{{v[0], v[1], v[2]}});
      out.insert(out.end(), r.m.begin(), r.m.begin() + 6);
    }
    out.insert(out.end(), {path[f].x - path[0].x, path[f].y - path[0].y, path[f].z - path[0].z, 0, 0, 0});
  }
  return out;
}
std::vector<float> rows_of(const ml::Motion& motion) {
  const ml::ActorClipsConfig clips{.turned_ahead = false, .camera = true, .fps = 25, .num_frames = -1, .max_len = 1000};
  const auto rows = ml::actor_row_maker(clips).rows(motion);
  ml::DescribedMotion d;
  d.rows.assign(rows.begin(), rows.end());
  ml::PythonRandom random(std::uint64_t{1});
  return ml::actor_window(d, clips, random);
}
void check_same(const std::vector<float>& rows, const std::vector<double>& expected) {
  REQUIRE(rows.size() == expected.size());
  double worst = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) worst = std::max(worst, std::abs(rows[i] - expected[i]));
  CHECK(worst < 1e-6);
}
ml::Vec3<double> point(const std::vector<double>& numbers, std::size_t i) {
  return {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
}

/// Two frames of 49 joints for each video; the joints of UESTC are not centred.
struct Uestc : TemporaryFolder {
  std::vector<std::string> names{"a0_d0_p001_c1_color.avi", "a12_d3_p045_c2_color.avi", "a39_d2_p003_c2_color.avi",
                                 "a1_d8_p001_c2_color.avi", "a1_d8_p004_c1_color.avi"};
  std::string lengths = "3\n2\n3\n3\n9\n";
  std::vector<std::vector<double>> poses, joints;
  std::vector<double> camera;

  Uestc() {
    for (Index f = 0; f < 3; ++f) {
      const auto t = static_cast<double>(f);
      camera.insert(camera.end(), {1 + 0.5 * t, 7, 0.1 * t, 0.3 - 0.2 * t});
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
      poses.push_back(pickles::poses(3, static_cast<double>(i)));
      joints.push_back(pickles::joints(3, 49, static_cast<double>(i)));
    }
    write();
  }
  void write() const {
    std::vector<std::string> p, j, c;
    for (std::size_t i = 0; i < names.size(); ++i) {
      p.push_back(pickles::array(poses[i], {3, 72}));
      j.push_back(pickles::array(joints[i], {3, 49, 3}));
      c.push_back(pickles::array(camera, {3, 4}));
    }
    std::string lines;
    for (const auto& n : names) lines += n + "\r\n";
    pickles::write_uestc_files(path, p, j, c, lines, lengths);
  }
};

}  // namespace

TEST_CASE("HumanAct12: rotations as they are, the path of joint 0, names of the classes") {
  const TemporaryFolder folder;
  pickles::write_humanact12(folder.path, 3);
  CHECK(ml::action_data_set(folder.path) == "humanact12");
  CHECK(ml::action_data_set(folder / "none").empty());
  const auto all = recordings_of("humanact12", folder.path);
  REQUIRE(all.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    const double phase = static_cast<double>(i % 2) + 0.05 * static_cast<double>(i);
    const auto joints = pickles::joints(14, 24, phase);
    CHECK((all[i].id == std::to_string(i) && all[i].action == (i % 2 == 0 ? "warm_up" : "walk")));
    CHECK((all[i].training && all[i].test && all[i].motion.fps == 25));
    std::vector<ml::Vec3<double>> path;
    for (std::size_t f = 0; f < 14; ++f) path.push_back(point(joints, 24 * f));
    check_same(rows_of(all[i].motion), published_rows(pickles::poses(14, phase), path));
    // down is up in our world, and away comes near
    const auto& root = all[i].motion.root_at(0);
    CHECK(root.x == doctest::Approx(path[0].x));
    CHECK(root.y == doctest::Approx(-path[0].y));
    CHECK(root.z == doctest::Approx(-path[0].z));
  }
}

TEST_CASE("HumanAct12: arrays in the order of Fortran, and files that do not fit") {
  const TemporaryFolder folder;
  const auto write = [&](const std::string& poses, const std::string& joints, const std::string& classes) {
    pickles::write(folder / "humanact12poses.pkl", pickles::dictionary({{pickles::text("poses"), poses},
                                                                        {pickles::text("joints3D"), joints},
                                                                        {pickles::text("y"), classes}}));
  };
  const auto poses = pickles::poses(2, 0), joints = pickles::joints(2, 24, 0);
  std::vector<double> turned;
  for (std::size_t i = 0; i < 72; ++i) turned.insert(turned.end(), {poses[i], poses[72 + i]});
  const auto one = pickles::list({pickles::array(turned, {2, 72}, true)});
  const auto points = pickles::list({pickles::array(joints, {2, 24, 3})});
  write(one, points, pickles::list({pickles::number(11)}));
  const auto all = recordings_of("humanact12", folder.path);
  REQUIRE(all.size() == 1);
  CHECK(all[0].action == "throw");
  check_same(rows_of(all[0].motion), published_rows(poses, {point(joints, 0), point(joints, 24)}));

  write(one, points, pickles::list({pickles::number(12)}));
  CHECK_ERROR(recordings_of("humanact12", folder.path), "[motionlang.io.403]");
  write(one, points, pickles::list({}));
  CHECK_ERROR(recordings_of("humanact12", folder.path), "1 poses, 1 joints3D and 0 y");
  write(one, pickles::list({pickles::array(pickles::joints(3, 24, 0), {3, 24, 3})}),
        pickles::list({pickles::number(1)}));
  CHECK_ERROR(recordings_of("humanact12", folder.path), "2 poses and 3 frames of joints");
  write(one, pickles::list({pickles::array(pickles::joints(2, 22, 0), {2, 22, 3})}),
        pickles::list({pickles::number(1)}));
  CHECK_ERROR(recordings_of("humanact12", folder.path), "expected rows of 72 numbers");
  auto odd = joints;
  odd[5] = std::numeric_limits<double>::quiet_NaN();
  write(one, pickles::list({pickles::array(odd, {2, 24, 3})}), pickles::list({pickles::number(1)}));
  CHECK_ERROR(recordings_of("humanact12", folder.path), "[motionlang.io.403]");
  write("cos\nsystem\n(U\x01xtR", points, pickles::list({}));
  CHECK_ERROR(recordings_of("humanact12", folder.path), "the file tries to execute code");
  CHECK_ERROR(recordings_of("humanact13", folder.path), "[motionlang.config.103]");
  CHECK_ERROR(recordings_of("humanact12", folder / "none"), "[motionlang.io.401]");
}

TEST_CASE("UESTC: names, people, and the depth of a picture") {
  const auto video = ml::parse_uestc_video("a12_d3_p045_c2_color.avi");
  CHECK((video.action == 12 && video.view == 3 && video.subject == 45 && video.camera == 2));
  for (const char* wrong :
       {"a12_d3_p045.avi", "12_d3_p045_c2_color.avi", "a_d3_p045_c2_color.avi", "", "a1_d2_p-3_c1_"})
    CHECK_ERROR(ml::parse_uestc_video(wrong), "[motionlang.io.403]");
  int people = 0;
  for (int subject = 1; subject <= 118; ++subject) people += ml::trains_with_uestc_subject(subject) ? 1 : 0;
  CHECK(people == 51);
  CHECK((ml::trains_with_uestc_subject(1) && !ml::trains_with_uestc_subject(3)));

  // 270 pixels for each unit: 500 / 270, and half of that where the scale is 2
  const std::vector<double> camera{1, 9, 0.25, -1, 2, 9, 0.5, 1};
  const std::vector<ml::Vec3<double>> joints{{0, 0, 5}, {3, 4, 1}, {1, 1, 0}, {2, 9, 0}};
  const auto path = ml::uestc_path(camera, joints);
  REQUIRE(path.size() == 2);
  CHECK((path[0].x == 0 && path[0].y == 0 && path[0].z == 0));
  CHECK(path[1].x == 0.25);
  CHECK(path[1].y == 2);
  CHECK(path[1].z == doctest::Approx(-0.5 * 500.0 / 270));
}

TEST_CASE("UESTC: the second camera is turned to the front, and people are in one part") {
  const Uestc folder;
  ml::LeftOut left_out;
  CHECK(ml::action_data_set(folder.path) == "uestc");
  const auto all = recordings_of("uestc", folder.path, &left_out);
  REQUIRE(all.size() == 4);
  CHECK(left_out.text() == "1 left out: 1 of a camera that moves (a1_d8_p001_c2_color.avi)");
  CHECK((all[0].action == "0" && all[1].action == "12" && all[2].action == "39" && all[3].action == "1"));
  CHECK((all[0].training && !all[0].test && all[1].training && !all[2].training && all[2].test));
  CHECK((all[0].motion.frames() == 3 && all[1].motion.frames() == 2 && all[3].motion.frames() == 3));

  for (const std::size_t i : {std::size_t{0}, std::size_t{1}, std::size_t{2}}) {
    CAPTURE(i);
    const double angle = i == 0 ? 0 : -(i == 1 ? 3 : 2) * std::numbers::pi / 4;
    const auto turn = ml::from_axis_angle(ml::Vec3<double>{0, 1, 0}, angle);
    std::vector<ml::Vec3<double>> points, path;
    for (std::size_t k = 0; k < 3 * 49; ++k) points.push_back(point(folder.joints[i], k));
    const auto moved = ml::uestc_path(folder.camera, points);
    auto poses = folder.poses[i];
    for (std::size_t f = 0; f < static_cast<std::size_t>(all[i].motion.frames()); ++f) {
      path.push_back(ml::rotate(turn, points[49 * f + 8] + moved[f]));
      const ml::AxisAngle<double> root{{poses[72 * f], poses[72 * f + 1], poses[72 * f + 2]}};
      const auto v = ml::to_axis_angle(turn * ml::to_quaternion(root)).v;
      poses[72 * f] = v.x, poses[72 * f + 1] = v.y, poses[72 * f + 2] = v.z;
    }
    check_same(rows_of(all[i].motion), published_rows(poses, path));
  }
}

TEST_CASE("UESTC: lists that do not fit") {
  Uestc folder;
  folder.lengths = "3\n2\n";
  folder.write();
  CHECK_ERROR(recordings_of("uestc", folder.path), "5 names, 2 num_frames_min, 5 pose");
  folder.lengths = "3\n2\nmany\n3\n9\n";
  folder.write();
  CHECK_ERROR(recordings_of("uestc", folder.path), "'many' is not a whole number");
  folder.lengths = "3\n2\n0\n3\n9\n";
  folder.write();
  CHECK(recordings_of("uestc", folder.path).size() == 3);
  folder.names[0] = "a40_d0_p001_c1_color.avi";
  folder.write();
  CHECK_ERROR(recordings_of("uestc", folder.path), "action 40 of 40");
}

TEST_CASE("NTU-13: joblib files of person 1, of thirteen actions") {
  CHECK(ml::ntu13_class("vibe/S001C001P001R001A006.pkl") == 0);
  CHECK(ml::ntu13_class("S001C001P001R001A102.pkl") == 12);
  CHECK(ml::ntu13_class("S001C001P001R001A010.pkl") == -1);
  for (const char* wrong : {"S001.pkl", "A.pk", "xA12b.pkl"})
    CHECK_ERROR(ml::ntu13_class(wrong), "[motionlang.io.403]");

  const TemporaryFolder folder;
  const auto poses = pickles::poses(4, 0.5), joints = pickles::joints(4, 49, 0.5);
  const auto person = pickles::ntu13_person(4, 0.5);
  pickles::write(folder / "vibe/S1A099.pkl", pickles::dictionary({{pickles::number(1), person}}));
  pickles::write(folder / "vibe/S2A099.pkl", pickles::dictionary({{pickles::number(2), person}}));
  ml::write_file(folder / "ntu_vibe_list.txt", std::string_view("vibe/S1A099.pkl\nvibe/S2A099.pkl\nvibe/S3A001.pkl\n"));
  ml::LeftOut left_out;
  const auto all = recordings_of("ntu13", folder.path, &left_out);
  REQUIRE(all.size() == 1);
  CHECK((all[0].action == "10" && all[0].training && all[0].test));
  std::vector<ml::Vec3<double>> path;
  for (std::size_t f = 0; f < 4; ++f) path.push_back(point(joints, 49 * f + 8));
  check_same(rows_of(all[0].motion), published_rows(poses, path));
  CHECK(left_out.text() == "2 left out: 1 of another action (vibe/S3A001.pkl), 1 without a person 1 (vibe/S2A099.pkl)");
  ml::write_file(folder / "ntu_vibe_list.txt", std::string_view("../S1A099.pkl\n"));
  CHECK_ERROR(recordings_of("ntu13", folder.path), "[motionlang.io.403]");
}
