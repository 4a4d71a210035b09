// Motions that a model remembers, in motions of STMC: what follows them, what does not, and after an edit.
#include <motionlang/compose/recalled_motions.hpp>

#include <doctest/doctest.h>

#include <cmath>   // lround
#include <limits>  // NaN
#include <memory>  // memories
#include <set>     // choices

#include <motionlang/backend/eigen.hpp>
#include <motionlang/generate/generate_motion.hpp>
#include <motionlang/systems/stmc_edit.hpp>
#include <motionlang/weights/stmc_record.hpp>

#include "../support/check_error.hpp"
#include "../support/small_denoisers.hpp"
#include "../support/temporary_folder.hpp"

namespace ml = motionlang;
using ml::Index, ml::Timeline;
using small::B;

namespace {

constexpr ml::Philox rng{.seed = 7};

/// Remembers waving: 205 values that grow with the frame, and depend on the choice.
class Waves final : public ml::MotionRecall {
 public:
  std::vector<double> features(const std::string& text, Index frames, double choice) const override {
    if (text.find("wave") == text.npos) return {};
    std::vector<double> out;
    for (Index i = 0; i < frames * width; ++i)
      out.push_back(0.01 * static_cast<double>(i / width) + (choice < 0.5 ? 1.0 : 2.0));
    return out;
  }
  std::string fingerprint() const override { return "waves"; }
  Index width = 205;
};

template <class D = ml::MdmSmplDenoiser<B>>
auto model_with_memory() {
  auto model = small::model_of<D>();
  model.memory = std::make_shared<Waves>();
  return model;
}
Timeline walk_then_wave(Index end = 16) {
  return {{{"walk", 0, 8, ml::BodyParts::all()}, {"wave the right hand", 8, end, ml::BodyParts::all()}}};
}
/// The final step of ddim takes the clean estimate as it is.
ml::StmcOptions options(double recall) {
  return {.overlap = 4,
          .guidance = 2,
          .steps = 4,
          .sampling = ml::SamplingOptions{.sampler = ml::SamplingOptions::Sampler::ddim},
          .recall = recall};
}
double value(const ml::Tensor<B, 2>& m, Index frame, Index feature) { return m.span()[frame * 205 + feature]; }

}  // namespace

TEST_CASE("with all of it, the motion is the remembered one where its text alone rules") {
  const auto model = model_with_memory();
  const auto made = model.generate(walk_then_wave(), rng, options(1));
  const double own = value(made, 15, 0) - 0.01 * 7;  // 1 or 2, by the noise
  CHECK((std::abs(own - 1) < 1e-4 || std::abs(own - 2) < 1e-4));
  for (Index f = 10; f < 16; ++f) {  // behind the transition
    for (const Index i : {0, 3, 50, 204}) CHECK(value(made, f, i) == doctest::Approx(own + 0.01 * double(f - 8)));
  }
  CHECK(std::abs(value(made, 2, 50) - own) > 1e-3);
}

TEST_CASE("without recall, or for texts without a motion, the network makes all") {
  auto plain = model_with_memory();
  plain.memory = nullptr;
  const auto with = model_with_memory();
  const auto same = [&](const Timeline& t, double recall) {
    return small::numbers(plain.generate(t, rng, options(recall))) ==
           small::numbers(with.generate(t, rng, options(recall)));
  };
  CHECK(same(walk_then_wave(), 0));
  CHECK_FALSE(same(walk_then_wave(), 0.5));
  CHECK(same({{{"walk", 0, 16, ml::BodyParts::all()}}}, 0.9));
}

TEST_CASE("the texts of other tracks keep their parts") {
  const auto model = model_with_memory();
  const Timeline t{{{"walk", 0, 16, ml::BodyParts::all()},
                    {"wave the right hand", 4, 12, ml::BodyParts{}.with(ml::BodyPart::right_arm)}}};
  const auto made = model.generate(t, rng, options(1));
  const auto own = [&](ml::BodyPart part) { return model.layout.indices(part).front(); };
  const double waving = value(made, 8, own(ml::BodyPart::right_arm));
  CHECK((std::abs(waving - 1.04) < 1e-4 || std::abs(waving - 2.04) < 1e-4));
  CHECK(std::abs(value(made, 8, own(ml::BodyPart::legs)) - waving) > 1e-3);
}

TEST_CASE("the noise of a timeline chooses the motion, alone and in a batch") {
  const auto model = model_with_memory();
  std::set<int> chosen;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const std::vector<Timeline> both{walk_then_wave(), walk_then_wave()};
    const auto batch = model.generate(both, {.seed = seed}, options(1));
    for (const auto& m : batch) chosen.insert(static_cast<int>(std::lround(value(m, 15, 0) - 0.07)));
    CHECK(small::numbers(batch[0]) == small::numbers(model.generate(both[0], {.seed = seed}, options(1))));
    auto second = options(1);
    second.first = 1;  // as another process makes it
    CHECK(small::numbers(batch[1]) == small::numbers(model.generate(both[1], {.seed = seed}, second)));
  }
  CHECK(chosen == std::set<int>{1, 2});
}

TEST_CASE_TEMPLATE("after an edit the bits are those of a whole run", D, ml::MdmSmplDenoiser<B>, ml::MdmDenoiser<B>,
                   ml::MotionDiffuseDenoiser<B>) {
  const auto model = model_with_memory<D>();
  const std::vector<Timeline> before{walk_then_wave()};
  auto shorter = before, other = before, again = before;
  shorter[0].intervals[1].end = 14;
  other[0].intervals[1].text = "sit down";
  again[0].intervals.push_back({"wave", 16, 23, ml::BodyParts::all()});
  for (const auto& after : {shorter, other, again, before}) {
    for (const Index overlap : {0, 4, 30}) {  // with 30, each crop has all frames
      auto how = options(0.9);
      how.overlap = overlap;
      ml::StmcRecord<B> record;
      ml::generate_recorded<B>(model, before, rng, how, record);
      const auto edited = ml::regenerate<B>(model, record, after);
      CHECK(small::numbers(edited[0]) == small::numbers(model.generate(after, rng, how)[0]));
    }
  }
}

TEST_CASE("a record belongs to the motions and to the recall of its run") {
  const TemporaryFolder folder;
  const auto model = model_with_memory();
  ml::StmcRecord<B> record;
  ml::generate_recorded<B>(model, std::vector{walk_then_wave()}, rng, options(0.25), record);
  ml::save_stmc_record(folder / "record", record, model);
  const auto file = ml::SafetensorsFile::open(folder / "record");
  CHECK(ml::load_stmc_record(file, model).options.recall == 0.25);
  auto metadata = file.metadata();
  metadata["recall"] = "7";
  ml::write_safetensors(folder / "broken", file.tensors(), metadata);
  CHECK_ERROR(ml::load_stmc_record(ml::SafetensorsFile::open(folder / "broken"), model),
              "metadata 'recall' = 7 is not in 0 ... 1");
  auto plain = model;
  plain.memory = nullptr;
  CHECK_ERROR(ml::load_stmc_record(file, plain), "[motionlang.config.102]");
}

TEST_CASE("a recall or a motion that does not fit is refused") {
  auto model = model_with_memory();
  for (const double recall : {1.5, -0.5, std::numeric_limits<double>::quiet_NaN()})
    CHECK_ERROR(model.generate(walk_then_wave(), rng, options(recall)), "[motionlang.config.101] Stmc: a recall of ");
  auto narrow = std::make_shared<Waves>();
  narrow->width = 204;
  model.memory = narrow;
  CHECK_ERROR(model.generate(walk_then_wave(), rng, options(1)),
              "[motionlang.shape.205] recalled_motions: 1632 values");
}
