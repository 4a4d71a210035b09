// HumanML3D from AMASS: the files of clips, mirrored copies, captions, lists and statistics.
#include <doctest/doctest.h>

#include <motionlang/backend/reference.hpp>
#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/datasets/make_humanml3d.hpp>
#include <motionlang/features/statistics.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/kinematics/guo_chains.hpp>
#include <motionlang/kinematics/mirror_joints.hpp>

#include "../../support/check_error.hpp"
#include "../../support/made_up_humanml3d.hpp"

namespace {

namespace ml = motionlang;
using B = ml::ReferenceBackend<double>;
using Joints = std::vector<ml::Vec3<double>>;
using Names = std::vector<std::string>;

struct Sources : made_up::HumanMl3d {
  ml::MadeHumanMl3d make(const ml::HumanMl3dMaking& making = {.missing = true}) const {
    return ml::make_humanml3d<B>(sources, out, making);
  }
  /// The joints of the first row, step by step.
  Joints first_joints() const {
    const auto rows = ml::read_humanml3d_index(sources.repository / "index.csv");
    const auto sequence = ml::read_amass_sequence(sources.amass / "HDM05/a/walk_poses.npz");
    const auto body = ml::read_body<B>(sources.bodies / "smplh/male/model.npz", {.betas = 10, .extra_points = false});
    return ml::humanml3d_source_joints<double>(
        rows[0], sequence.frames, sequence.fps,
        [&](std::span<const ml::Index> numbers) { return ml::posed_joints(body.model, sequence, numbers); });
  }
  static std::vector<float> features(const Joints& joints) {
    const auto rows = ml::guoh3d_features(ml::humanml3d_chains(), std::span<const ml::Vec3<double>>(joints));
    return {rows.begin(), rows.end()};
  }
};

}  // namespace

TEST_CASE("HumanML3D from AMASS: clips, mirrored copies, captions, lists and statistics") {
  const Sources s;
  const ml::MadeHumanMl3d made = s.make();
  CHECK(made.made == 4);
  CHECK(made.there == 0);
  CHECK(made.captionless == 2);
  CHECK(made.left_out.text() == "2 left out: 2 without their source (000002)");

  const ml::HumanMl3dFolder data(s.out);
  const Joints joints = s.first_joints();
  REQUIRE(joints.size() == 58 * 22);  // 2 to 60 behind the lead of 60 frames
  CHECK(data.features("000000") == s.features(joints));
  const auto partners = ml::humanml3d_mirror_partners(22);
  CHECK(data.features("M000000") ==
        s.features(ml::mirror_joints(std::span<const ml::Vec3<double>>(joints), std::span<const int>(partners))));
  CHECK(data.load("000001").frames == 249);  // the whole file
  CHECK(data.captions("000000").at(0).text == "a person turns left.");
  CHECK(data.captions("M000000").at(0).text == "a person turns right.");
  CHECK(data.captions("000001").empty());

  CHECK(data.ids("train") == Names{"000000", "M000000"});
  CHECK(data.ids("all") == Names{"000000", "000001", "M000000", "M000001"});
  CHECK_ERROR(data.ids("val"), "[motionlang.io.401]");
  ml::FeatureStatistics statistics;
  for (const std::string& id : data.ids()) statistics.add(std::span<const float>(data.features(id)), 263);
  CHECK(data.mean().at(3) == doctest::Approx(statistics.mean()[3]));
  const auto deviation = ml::group_means(statistics.population_deviation(), ml::Guoh3dSlots{22}.groups());
  CHECK(data.deviation().at(100) == doctest::Approx(deviation[100]));
}

TEST_CASE("HumanML3D from AMASS: what exists is not made again") {
  const Sources s;
  s.make();
  const ml::HumanMl3dFolder data(s.out);
  const auto before = data.mean();
  std::filesystem::remove(s.out / "new_joints/M000000.npy");  // stopped in the middle
  const ml::MadeHumanMl3d again = s.make();
  CHECK(again.made == 2);
  CHECK(again.there == 2);
  CHECK(data.mean() == before);
  CHECK(data.load("M000000").frames == 57);

  CHECK_ERROR(s.make({.missing = true, .features = ml::guoh3d_corrected()}), "[motionlang.config.102]");
  const auto stop = [](ml::Index, ml::Index) { return false; };
  CHECK_THROWS_AS(ml::make_humanml3d<B>(s.sources, s / "other", {.missing = true}, stop), ml::cancelled);
  CHECK(std::filesystem::exists(s / "other/texts/M000001.txt"));  // what was made stays
}

TEST_CASE("HumanML3D from AMASS: without mirrored copies, and with sources that cannot be used") {
  const Sources s;
  std::filesystem::remove(s.sources.repository / "pose_data/humanact12/P01.npy");
  ml::write_npy(s.sources.repository / "pose_data/humanact12/P01.npy", made_up::array({1, 2, 3}, {1, 1, 3}));
  const ml::MadeHumanMl3d made = s.make({.mirrored = false, .missing = true});
  CHECK(made.made == 1);
  CHECK(made.left_out.text().find("has the shape 1 x 1 x 3, expected frames x 24 x 3") != std::string::npos);
  CHECK(ml::HumanMl3dFolder(s.out).ids("all") == Names{"000000"});
}

TEST_CASE("HumanML3D from AMASS: missing files are reported before the work") {
  const Sources s;
  CHECK_ERROR(s.make({}), "[motionlang.io.401] 1 of 3 sources of index.csv are missing");
  CHECK_FALSE(std::filesystem::exists(s.out));
  ml::write_file(s.sources.repository / "index.csv", std::string_view("source_path,start_frame,end_frame,new_name\n"
                                                                      "../secret.npy,0,1,000000.npy\n"));
  CHECK_ERROR(s.make(), "[motionlang.io.403] index.csv: the path '../secret.npy' leads out of its folder");
  const auto index = [&](const char* rows) {
    ml::write_file(s.sources.repository / "index.csv",
                   "source_path,start_frame,end_frame,new_name\n" + std::string(rows));
  };
  index("/secret.npy,0,1,000000.npy\n");
  CHECK_ERROR(s.make(), "[motionlang.io.403]");
  index("./pose_data/a.npy,0,1,000000.npy\n./pose_data/b.npy,0,1,M000000.npy\n");
  CHECK_ERROR(s.make(), "[motionlang.io.403] index.csv: the clip 'M000000', or its mirrored copy, has two rows");
  std::filesystem::remove_all(s.sources.repository / "HumanML3D/texts");
  CHECK_ERROR(s.make(), "unpack HumanML3D/texts.zip");
}
