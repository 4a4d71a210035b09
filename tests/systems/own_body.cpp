// STMC over a body of seven parts: the human one with two legs and a pelvis, which carries the path.
#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/systems/sinc_baseline.hpp>
#include <motionlang/systems/stmc_keep.hpp>
#include <motionlang/weights/stmc_record.hpp>

#include "../support/check_error.hpp"
#include "../support/small_model.hpp"
#include "../support/temporary_folder.hpp"

namespace ml = motionlang;
using ml::BodyPart, ml::BodyParts, ml::Index, ml::Timeline;

namespace {

using B = ml::EigenBackend<float>;
constexpr ml::Philox rng{.seed = 7};

const ml::BodyPartition body({.names = {"left arm", "right arm", "left leg", "right leg", "head", "spine", "pelvis"},
                              .path = "pelvis"});

ml::FeatureLayout layout() {
  std::vector<BodyPart> parts;
  for (int j = 0; j < 24; ++j) {
    const BodyPart human = ml::smpl_part_of_joint[static_cast<std::size_t>(j)];
    const auto name = human != BodyPart::legs ? ml::to_string(human)
                      : j == 0                ? "pelvis"
                      : j % 3 == 1            ? "left leg"
                                              : "right leg";
    parts.push_back(*body.find(name));
  }
  return ml::smplrifke_layout(parts, 22, body);
}
auto model() {
  auto m = small::model<B>();
  m.layout = layout();
  return m;
}
Timeline two_texts() {
  return ml::parse_timeline(
      "walk forward # 0 # 2 # pelvis # left leg # right leg # spine\n"
      "raise both arms # 0.5 # 1.5 # left arm # right arm # left leg\n",
      {.body = body});
}
std::vector<std::vector<float>> numbers(const std::vector<ml::Tensor<B, 2>>& motions) {
  std::vector<std::vector<float>> out;
  for (const auto& m : motions) out.push_back(small::numbers(m));
  return out;
}

}  // namespace

TEST_CASE("where the same texts own the same features, the motion has the bits of the human body") {
  const auto seven = ml::parse_timeline(
      "walk forward # 0 # 2 # pelvis # left leg # right leg\nraise both arms # 0.5 # 1.5 # left arm # right arm\n",
      {.body = body});
  const auto human =
      ml::parse_timeline("walk forward # 0 # 2 # legs\nraise both arms # 0.5 # 1.5 # left arm # right arm\n");
  const auto of_stmc = [&](const auto& m, const ml::Timeline& t) { return small::numbers(m.generate(t, rng)); };
  CHECK(of_stmc(model(), seven) == of_stmc(small::model<B>(), human));
  CHECK(of_stmc(model(), two_texts()) != of_stmc(small::model<B>(), human));
  for (const auto cuts : {ml::SincCuts::hard, ml::SincCuts::interpolated}) {
    const auto of_sinc = [&](const auto& m, const ml::Timeline& t) {
      return small::numbers(ml::sinc_baseline(m, std::span(&t, 1), rng, {}, cuts).front());
    };
    CHECK(of_sinc(model(), seven) == of_sinc(small::model<B>(), human));
    CHECK(of_sinc(model(), two_texts()) != of_sinc(small::model<B>(), human));
  }
}

TEST_CASE("a timeline of another body than the model's is refused") {
  CHECK_ERROR(model().generate(small::one_text(), rng),
              "[motionlang.config.102] FeatureLayout 'smplrifke' is of a body");
  CHECK_ERROR(small::model<B>().generate(two_texts(), rng), "[motionlang.config.102]");
}

TEST_CASE("parts of the body are kept, and all seven by default") {
  const auto m = model();
  const std::vector timelines{two_texts()};
  const auto clip = m.generate(two_texts(), ml::Philox{.seed = 99});
  std::vector<ml::KeptMotion<B>> kept{{clip, {{{0, 5}}, {{10, 20}, body.parts({"pelvis", "right leg"})}}}};
  const auto made = ml::generate_around<B>(m, timelines, rng, {}, kept).front();
  std::vector<int> owner(205);
  for (int p = 0; p < body.size(); ++p) {
    for (const Index i : m.layout.indices(BodyPart{p})) owner[static_cast<std::size_t>(i)] = p;
  }
  for (Index f = 0; f < 20; ++f) {
    int same = 0, of_kept = 0, others = 0;
    for (Index i = 0; i < 205; ++i) {
      const auto at = static_cast<std::size_t>(f * 205 + i);
      const bool wanted =
          f < 5 || (f >= 10 && (owner[static_cast<std::size_t>(i)] == 6 || owner[static_cast<std::size_t>(i)] == 3));
      const bool is_same = std::abs(made.span()[at] - clip.span()[at]) < 1e-5f;
      of_kept += wanted ? 1 : 0;
      same += wanted && is_same ? 1 : 0;
      others += !wanted && !is_same ? 1 : 0;
    }
    CHECK(same == of_kept);
    CHECK(of_kept == (f < 5 ? 205 : f < 10 ? 0 : 4 + 6 + 4 * 6 + 4 * 3));
    CHECK(others >= (205 - of_kept) * 9 / 10);
  }
}

TEST_CASE("a record keeps the body of its timelines, and edits go on from it") {
  const TemporaryFolder folder;
  const auto m = model();
  const std::vector timelines{two_texts()};
  ml::StmcRecord<B> record;
  ml::generate_recorded(m, timelines, rng, {.steps = 3}, record);
  ml::save_stmc_record(folder / "run", record, m);
  const auto file = ml::SafetensorsFile::open(folder / "run");
  CHECK(file.metadata().at("body/parts") == "left arm # right arm # left leg # right leg # head # spine # pelvis");
  CHECK(file.metadata().at("body/path") == "pelvis");
  auto read = ml::load_stmc_record<B>(file, m);
  CHECK(read.timelines == timelines);
  auto edited = timelines;
  edited[0].intervals[1].text = "sit down";
  CHECK(numbers(ml::regenerate(m, read, edited)) == numbers(m.generate(edited, rng, {.steps = 3})));

  const auto human = small::model<B>();
  ml::generate_recorded(human, std::vector{small::one_text()}, rng, {.steps = 3}, record);
  ml::save_stmc_record(folder / "human", record, human);
  CHECK_FALSE(ml::SafetensorsFile::open(folder / "human").metadata().contains("body/parts"));
}
