// Raw KIT-ML as described motions: rows of its positions, its lists, and its motions in AMASS.
#include <motionlang/datasets/kit_recordings.hpp>

#include <doctest/doctest.h>

#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/features/rifke.hpp>
#include <motionlang/formats/amass.hpp>

#include "../../support/check_error.hpp"
#include "../../support/raw_kit.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using ml::Index;

namespace {

/// Five recordings: of 200, 72 (9 frames at 12.5), 73 (10 frames), 400 and 200 frames, the last without a text.
struct Kit : TemporaryFolder {
  Kit() {
    const int frames[] = {200, 72, 73, 400, 200};
    for (int i = 0; i < 5; ++i) {
      const std::string id = "0000" + std::to_string(i);
      std::vector<std::string> texts{"a person walks", "somebody goes " + std::to_string(i)};
      if (i == 4) texts.clear();
      raw_kit::write(*this / "kit", id, joints(i, frames[i]), texts);
    }
    std::filesystem::create_directories(*this / "splits");
    ml::write_file(*this / "splits/train", std::string_view("00000\n00001\n00002\n00004\n"));
    ml::write_file(*this / "splits/test", std::string_view("00003\n"));
  }
  static ml::Motion walk(int i, int frames) { return synthetic::walk({.frames = frames, .fps = 100, .turn = 0.3 * i}); }
  static std::vector<ml::Vec3<double>> joints(int i, int frames) { return raw_kit::joints_of(walk(i, frames)); }
  ml::DataSources sources() const { return {.data = *this / "kit", .splits = *this / "splits"}; }
};

ml::DataConfig lengths() { return {.min_seconds = 0.8, .max_seconds = 40}; }

}  // namespace

TEST_CASE("raw KIT-ML: every 8th frame, as published; lengths of all lists but the test's count at 12.5") {
  const Kit kit;
  CHECK(ml::is_kit_recordings(kit / "kit"));
  CHECK(!ml::is_kit_recordings(kit / "splits"));
  CHECK(!ml::is_kit_recordings(kit / "none"));
  const auto data = ml::read_described_motions(kit.sources(), lengths(), ml::row_maker("rifke64"));
  REQUIRE((data.training.size() == 2 && data.validation.empty() && data.test.size() == 1));
  CHECK((data.training[0].id == "00000" && data.training[1].id == "00002" && data.test[0].id == "00003"));
  CHECK(data.left_out.text() ==
        "2 left out: 1 shorter than 0.8 s or longer than 40 s (00001), 1 without a text (00004)");
  CHECK(data.training[0].texts[1].text == "somebody goes 0");
  CHECK(data.test[0].texts[0].frames == ml::FrameSlice{0, 50});

  const auto all = Kit::joints(0, 200);
  std::vector<ml::Vec3<double>> eighth;
  for (std::size_t f = 0; f < 200; f += 8) eighth.insert(eighth.end(), &all[21 * f], &all[21 * f] + 21);
  const auto rows = ml::rifke_features(ml::temos_rifke(), std::span<const ml::Vec3<double>>(eighth)).features;
  REQUIRE(data.training[0].rows.size() == rows.size());
  double worst = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) worst = std::max(worst, std::abs(data.training[0].rows[i] - rows[i]));
  CHECK(worst < 1e-4);  // units of 1/640 m, six digits

  // the same motions at the rate of the recordings
  auto at_100 = ml::row_maker("rifke64");
  at_100.fps = 100;
  const auto whole = ml::read_described_motions(kit.sources(), lengths(), at_100);
  REQUIRE(whole.training.size() == 2);
  CHECK(std::ssize(whole.training[1].rows) == 73 * 64);
  CHECK_ERROR(ml::read_described_motions(kit.sources(), lengths(), ml::row_maker("guoh3d")),
              "kitml_amass_path.json of TEMOS");
}

TEST_CASE("raw KIT-ML: the list of AMASS leads to the motions of SMPL") {
  const Kit kit;
  for (const char* folder : {"KIT/3", "EKUT/5", "CMU/7"})
    std::filesystem::create_directories(kit / "kit/amass" / folder);
  ml::write_amass(kit / "kit/amass/KIT/3/go_stageii.npz", Kit::walk(0, 200));
  ml::write_amass(kit / "kit/amass/EKUT/5/turn_poses.npz", Kit::walk(2, 100));
  ml::write_amass(kit / "kit/amass/CMU/7/far_poses.npz", Kit::walk(3, 400));
  const auto entry = [](const char* id, const char* path, const char* collection) {
    return ml::concat_text("\"", id, "\": {\"path\": \"", path, "\", \"identifier\": \"", collection, "\"}");
  };
  const auto list = [&](const std::string& entries) {
    ml::write_file(kit / "kit/kitml_amass_path.json", "{" + entries + "}");
  };
  list(entry("00000", "3/go_poses.npz", "kit") + ", " + entry("00002", "5/turn_poses.npz", "cmu") + ", " +
       entry("00003", "7/far_poses.npz", "cmu"));
  const ml::DataSources sources = kit.sources();
  const auto data = ml::read_described_motions(sources, lengths(), ml::row_maker("smplvelp"));
  REQUIRE((data.training.size() == 2 && data.test.size() == 1));
  CHECK(std::ssize(data.training[0].rows) == 25 * 135);
  CHECK(std::ssize(data.training[1].rows) == 13 * 135);
  CHECK(data.left_out.text() == "2 left out: 1 that the list of AMASS lacks (00001), 1 without a text (00004)");

  const ml::KitAmassPaths paths((kit / "kit/kitml_amass_path.json").string());
  CHECK(paths.file("00000", kit / "kit/amass") == kit / "kit/amass/KIT/3/go_stageii.npz");
  CHECK(paths.file("00002", kit / "kit/amass") == kit / "kit/amass/EKUT/5/turn_poses.npz");
  CHECK(paths.file("00001", kit / "kit/amass").empty());
  CHECK((paths.has("00003") && !paths.has("00001")));
  list(entry("00000", "3/gone_poses.npz", "kit") + ", " + entry("00003", "7/far_poses.npz", "cmu") + ", " +
       entry("00002", "5/turn_poses.npz", "cmu"));
  CHECK(ml::read_described_motions(sources, lengths(), ml::row_maker("smplvelp"))
            .left_out.text()
            .find("1 without a file in AMASS (00000)") != std::string::npos);
  list(entry("00000", "../3/go_poses.npz", "kit"));
  CHECK_ERROR(ml::KitAmassPaths((kit / "kit/kitml_amass_path.json").string()).file("00000", kit / "kit/amass"),
              "[motionlang.io.403]");
  list(entry("00000", "3/go_poses.npz", "bml"));
  CHECK_ERROR(ml::KitAmassPaths((kit / "kit/kitml_amass_path.json").string()).file("00000", kit / "kit/amass"),
              "not kit or cmu");
}
