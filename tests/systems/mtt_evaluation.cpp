// The tables of STMC's paper: every row is what its motions give, by hand; judged by the bundled TMR.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/datasets/mtt_motions.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/generate/mtt_runs.hpp>
#include <motionlang/generate/stmc_motion_model.hpp>
#include <motionlang/train/mtt_evaluation.hpp>

#include "../support/check_error.hpp"
#include "../support/small_denoisers.hpp"
#include "../support/small_model.hpp"
#include "../support/synthetic_motion.hpp"
#include "../support/temporary_folder.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using doctest::Approx;

namespace {

const std::vector<ml::MttText> texts = ml::parse_mtt_texts(
    "walk forward # legs\nsit down # legs # spine\nraise both arms # left arm # right arm\n"
    "wave the right hand # right arm\n");
const auto timelines = ml::mtt_timelines(texts, {.count = 3, .mean = 2, .std = 0.4, .cap = 3});

const ml::TmrSearchEncoder<B>& tmr() {
  static const ml::TmrSearchEncoder<B> encoder(ml::load_tmr<B>(MOTIONLANG_BUNDLED_TMR));
  return encoder;
}
ml::Stmc<B> stmc() {
  auto m = small::model<B>();
  ml::prepare(m);
  return m;
}
/// Features of a walk for each text.
std::vector<std::vector<double>> walks() {
  std::vector<std::vector<double>> out;
  for (int i = 0; i < 4; ++i) {
    const auto walk = synthetic::walk({.frames = 50 + 10 * i, .turn = 0.3 * i});
    out.push_back(ml::mtt_features_of_recorded(ml::detail::first_joints(walk, 22)));
  }
  return out;
}
bool same(const ml::MttScores& a, const ml::MttScores& b) {
  const auto equal = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  return equal(a.r1, b.r1) && equal(a.r3, b.r3) && equal(a.m2t, b.m2t) && equal(a.m2m, b.m2m) && equal(a.fid, b.fid) &&
         equal(a.transition, b.transition);
}

}  // namespace

TEST_CASE("the rows are those of the methods that are named, and of the overlaps") {
  CHECK(ml::mtt_runs({}, 0.5, {}).size() == 5);
  const auto runs = ml::mtt_runs(std::vector<std::string>{"sinc", "stmc"}, 0.3, std::vector{0.25, 1.0});
  REQUIRE(runs.size() == 4);
  CHECK(ml::to_string(runs[0].mode) == "sinc");
  CHECK(ml::to_string(runs[1].mode) == "stmc");
  CHECK(runs[1].overlap == 0.3);
  CHECK(runs[3].overlap == 1.0);
}

TEST_CASE("a row has the figures of the motions that the model makes in its mode") {
  const auto model = stmc();
  const auto any = ml::stmc_motion_model(stmc());
  const auto reference = ml::mtt_reference(tmr(), texts, walks());
  CHECK(reference.text_latents.size() == 4 * static_cast<std::size_t>(tmr().model().width));
  CHECK(reference.motion_latents.size() == reference.text_latents.size());
  ml::Index last = 0, total = 0;
  bool grows = true;
  auto progress = [&](ml::Index done, ml::Index all) {
    return grows = grows && done >= last, last = done, total = all, true;
  };
  const auto runs = ml::mtt_method_runs();
  const auto rows = ml::mtt_rows(*any, tmr(), reference, texts, timelines, runs, {.seed = 5}, progress);
  CHECK((grows && last == total && total == 5 * 3 * 100));
  REQUIRE(rows.size() == 6);
  CHECK(rows[0].recorded);
  CHECK((rows[0].as_coded.m2m == Approx(1) && rows[0].as_coded.fid == 0));

  std::vector<ml::Timeline> frames;
  for (const auto& t : timelines) frames.push_back(ml::to_frames(t, 20));
  const ml::StmcOptions hidden{.hidden = ml::HiddenTexts::ignore};
  const auto features = model.generate(frames, ml::Philox{.seed = 5}, hidden);
  std::vector<ml::MttMotion<double>> motions;
  for (std::size_t m = 0; m < 3; ++m) {
    const std::vector<double> values(features[m].span().begin(), features[m].span().end());
    motions.push_back({frames[m], ml::mtt_labels(texts, timelines[m]), ml::mtt_features_of_rows("smplrifke", values)});
    CHECK(std::ssize(motions[m].features) == 263 * (frames[m].end() - 1));
  }
  const auto encode = [](const ml::Rows<double>& crop) { return ml::mtt_latent(tmr(), crop); };
  const std::span<const ml::MttMotion<double>> all = motions;
  CHECK(same(rows[5].as_coded, ml::mtt_scores(all, reference, encode)));
  CHECK(same(rows[5].as_written, ml::mtt_scores(all, reference, encode, {.flavour = ml::MttFlavour::as_written})));
  CHECK((rows[5].name == "STMC" && rows[5].tracks && rows[5].crops));
  CHECK((rows[1].name == "one text" && !rows[1].tracks && !rows[1].crops));
  CHECK((!rows[2].tracks && rows[2].crops));
  for (std::size_t a = 1; a < 6; ++a) {
    for (std::size_t b = 1; b < a; ++b) CHECK_FALSE(same(rows[a].as_written, rows[b].as_written));
  }

  const double overlaps[] = {0.5, 1};
  const auto of_overlaps =
      ml::mtt_rows(*any, tmr(), reference, texts, timelines, ml::mtt_overlap_runs(overlaps), {.seed = 5});
  REQUIRE(of_overlaps.size() == 3);
  CHECK(same(of_overlaps[1].as_coded, rows[5].as_coded));  // 0.5 s is the overlap of the methods
  CHECK_FALSE(same(of_overlaps[2].as_coded, rows[5].as_coded));
  CHECK(of_overlaps[2].name == "STMC, overlap 1 s");
}

TEST_CASE("batches: the first has the noise of the seed, the others noise of their own; work can be stopped") {
  const auto any = ml::stmc_motion_model(stmc());
  const ml::MttRun run{"STMC"};
  const auto together = ml::mtt_made(*any, timelines, run, {.seed = 5});
  const auto alone = ml::mtt_made(*any, timelines, run, {.seed = 5, .batch = 1});
  REQUIRE((together.size() == 3 && alone.size() == 3));
  CHECK(alone[0] == together[0]);
  const std::vector<ml::TimelineInSeconds> twice{timelines[0], timelines[0]};
  const auto repeated = ml::mtt_made(*any, twice, run, {.seed = 5, .batch = 1});
  CHECK(repeated[0] == alone[0]);
  CHECK(repeated[1] != repeated[0]);
  CHECK(ml::mtt_made(*any, timelines, run, {.seed = 6}) != together);
  CHECK(ml::mtt_made(*any, timelines, run, {.seed = 5, .noise_scale = ml::NoiseScale::posterior_variance}) != together);
  CHECK_ERROR(ml::mtt_made(*any, timelines, run, {.batch = 0}), "[motionlang.config.101]");
  auto stop = [](ml::Index, ml::Index) { return false; };
  CHECK_THROWS_AS(ml::mtt_made(*any, timelines, run, {}, stop), ml::cancelled);
}

TEST_CASE("crops that a model cannot make are refused before it makes any; others where they are wrong") {
  const auto reference = ml::mtt_reference(tmr(), texts);
  CHECK(reference.motion_latents.empty());
  const auto mdm = ml::stmc_motion_model(small::model_of<ml::MdmDenoiser<small::B>>());
  CHECK(mdm->longest_crop() == small::crop_frames);
  ml::Index calls = 0;
  auto count = [&](ml::Index, ml::Index) { return ++calls > 0; };
  CHECK_ERROR(ml::mtt_rows(*mdm, tmr(), reference, texts, timelines, ml::mtt_method_runs(), {}, count),
              "[motionlang.timeline.508]");
  CHECK(calls == 0);
  const std::vector<ml::TimelineInSeconds> other{{{{"fly", 0, 1, texts[0].parts}, {"sit down", 1, 2, texts[1].parts}}}};
  const auto any = ml::stmc_motion_model(stmc());
  CHECK_ERROR(ml::mtt_rows(*any, tmr(), reference, texts, other, ml::mtt_method_runs()), "'fly' is not among");
  const std::vector<ml::TimelineInSeconds> brief{
      {{{"walk forward", 0, 2, texts[0].parts}, {"sit down", 1.95, 2, texts[1].parts}}}};
  CHECK_ERROR(ml::require_mtt_crops(*any, brief, ml::mtt_method_runs()), "[motionlang.timeline.504] 'sit down'");
  CHECK_ERROR(ml::mtt_reference(tmr(), std::span<const ml::MttText>(texts).first(2), walks()),
              "[motionlang.shape.204]");
  CHECK_ERROR(ml::mtt_features_of_rows("rifke", {}), "[motionlang.config.102]");
  CHECK_ERROR(ml::require_mtt_judge("rifke", 12.5, "tmr"), "[motionlang.config.102] tmr: a model of features 'rifke'");
}

TEST_CASE("tables: numbers as the paper gives them, '-' for what is not measured") {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const std::vector<ml::MttRow> rows{
      {.name = "recorded", .recorded = true, .as_written = {0.55, 0.733, 0.748, 1, 0, 0.0149}},
      {.name = "STMC",
       .tracks = true,
       .crops = true,
       .as_coded = {0.3049, 0.509, 0.6751, 0.665, 0.459, 0.009},
       .as_written = {0.3049, 0.509, 0.6751, none, none, 0.014}}};
  CHECK(ml::mtt_table(rows, {.style = ml::TableStyle::markdown}) ==
        "| method | tracks | crops | R@1 % | R@3 % | M2T | M2M | FID+ | trans. cm |\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n"
        "| recorded | - | - | 55.0 | 73.3 | 0.748 | 1.000 | 0.000 | 1.5 |\n"
        "| STMC | multi | multi | 30.5 | 50.9 | 0.675 | - | - | 1.4 |\n");
  CHECK(ml::mtt_table(std::span(rows).last(1), {.flavour = ml::MttFlavour::as_coded, .style = ml::TableStyle::latex}) ==
        "name                             & R1 & R3 & M2T S & M2M S & FID+ & Trans. \\\\\n"
        "STMC                             & 30.5 & 50.9 & 0.675 & 0.665 & 0.459 & 0.9 \\\\\n");
  CHECK(ml::mtt_table(std::span(rows).last(1), {.style = ml::TableStyle::csv}) ==
        "\"method\",tracks,crops,R@1 %,R@3 %,M2T,M2M,FID+,trans. cm\n"
        "\"STMC\",multi,multi,30.5,50.9,0.675,-,-,1.4\n");
  CHECK(ml::parse_table_style("latex") == ml::TableStyle::latex);
  CHECK_ERROR(ml::parse_table_style("pdf"), "[motionlang.config.103] table 'pdf' is not one of text, markdown");
  const std::string text = ml::mtt_table(rows, {});
  CHECK(text ==
        "  method                        tracks  crops      R@1 %     R@3 %       M2T       M2M      FID+ trans. cm\n"
        "  recorded                      -       -           55.0      73.3     0.748     1.000     0.000       1.5\n"
        "  STMC                          multi   multi       30.5      50.9     0.675         -         -       1.4\n");
}

TEST_CASE("mtt_features_of_rows: of HumanML3D's numbers and of STMC's the same figures for the same walk") {
  const ml::Motion walk = synthetic::walk({.frames = 40, .turn = 0.4});
  const auto own = ml::mtt_features_of_recorded(ml::detail::first_joints(walk, 22));
  const auto smpl = ml::mtt_features_of_rows("smplrifke", ml::smplrifke_from_motion(walk));
  const auto again = ml::mtt_features_of_rows("guoh3dfeats", own);
  REQUIRE(smpl.size() == own.size());
  REQUIRE(again.size() == own.size() - 263);
  double of_smpl = 0, of_guo = 0;
  for (std::size_t i = 0; i < again.size(); ++i) {
    if (i % 263 >= 259) continue;  // contacts are thresholds
    of_smpl = std::max(of_smpl, std::abs(smpl[i] - own[i])), of_guo = std::max(of_guo, std::abs(again[i] - own[i]));
  }
  CHECK(of_smpl < 1e-2);
  CHECK(of_guo < 1e-2);
}

TEST_CASE("the recorded motion of each text is read from a list") {
  const TemporaryFolder folder;
  ml::write_bvh(folder / "a.bvh", synthetic::walk({.frames = 80}));
  ml::write_file(folder / "list.txt", std::string_view("a # 0 # 2\na # 1 # 3\n"));
  const auto features = ml::mtt_features_of_recordings(folder / "list.txt", folder.path, 2);
  REQUIRE(features.size() == 2);
  CHECK(features[1] == ml::mtt_features_of_recorded(ml::read_mtt_motion(folder.path, {"a", 1, 3})));
  CHECK(features[0] != features[1]);
  CHECK_ERROR(ml::mtt_features_of_recordings(folder / "list.txt", folder.path, 3), "list.txt: 2 clips for 3 texts");
}
