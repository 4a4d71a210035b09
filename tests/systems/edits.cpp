// STMC after an edit: the bits of a run that takes nothing over, for less work; what is kept; the record in a file.
#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/systems/stmc_edit.hpp>
#include <motionlang/systems/stmc_reuse.hpp>
#include <motionlang/weights/stmc_record.hpp>

#include "../support/check_error.hpp"
#include "../support/kernel_sets.hpp"
#include "../support/small_denoisers.hpp"
#include "../support/temporary_folder.hpp"

namespace ml = motionlang;
using ml::BodyParts, ml::Index, ml::Timeline;
using small::B;

namespace {

constexpr ml::Philox rng{.seed = 7};

/// Texts one after the other, eight frames each.
Timeline chain(const std::vector<std::string>& texts) {
  Timeline t;
  for (Index i = 0; const std::string& text : texts)
    t.intervals.push_back({text, 8 * i, 8 * i + 8, BodyParts::all()}), ++i;
  return t;
}
const std::vector<std::string> seven{"walk", "sit down", "raise both arms", "walk forward", "wave", "sit", "walk"};
Timeline edited_chain() {
  auto t = chain(seven);
  t.intervals[1].text = "wave the right hand";
  return t;
}

struct Rerun {
  std::vector<std::vector<float>> motions;
  ml::StmcReuse reuse;
};
std::vector<std::vector<float>> numbers(const std::vector<ml::Tensor<B, 2>>& motions) {
  std::vector<std::vector<float>> out;
  for (const auto& m : motions) out.push_back(small::numbers(m));
  return out;
}
template <class Model>
Rerun rerun(const Model& model, const std::vector<Timeline>& before, const std::vector<Timeline>& after,
            const ml::StmcOptions& options, const ml::RegenerateOptions& how = {}) {
  ml::StmcRecord<B> record;
  const auto first = ml::generate_recorded(model, before, rng, options, record);
  CHECK(numbers(first) == numbers(model.generate(before, rng, options)));
  Rerun out;
  out.motions = numbers(ml::regenerate(model, record, after, how, &out.reuse));
  return out;
}

}  // namespace

TEST_CASE_TEMPLATE("after any edit the bits are those of a whole run", D, ml::MdmSmplDenoiser<B>, ml::MdmDenoiser<B>,
                   ml::MotionDiffuseDenoiser<B>) {
  const auto model = small::model_of<D>();
  const auto before = chain(seven);
  auto moved = before, added = before, removed = before, longer = before;
  moved.intervals[2].end = moved.intervals[3].start = 27;
  added.intervals.push_back({"wave", 30, 44, BodyParts{}.with(ml::BodyPart::left_arm)});
  removed.intervals.erase(removed.intervals.begin() + 5);
  longer.intervals.back().end += 3;
  for (const Timeline& after : {edited_chain(), moved, added, removed, longer, before}) {
    for (auto sampler : {ml::SamplingOptions::Sampler::ddpm, ml::SamplingOptions::Sampler::ddim}) {
      for (Index overlap : {0, 4}) {
        const ml::StmcOptions options{
            .overlap = overlap, .steps = 4, .sampling = ml::SamplingOptions{.sampler = sampler, .eta = 0.5}};
        const auto again = rerun(model, {before, chain({"sit"})}, {after, chain({"sit"})}, options);
        CHECK(again.motions == numbers(model.generate(std::vector{after, chain({"sit"})}, rng, options)));
        CHECK(again.reuse.exact);
        CHECK(again.reuse.steps == 4);
        CHECK(again.reuse.work < again.reuse.whole_work);
        CHECK(again.reuse.frames == after.end() + 8);
        CHECK(again.reuse.kept >= 8);
        if (after == before) CHECK(again.reuse.work == 0);
      }
    }
  }
}

TEST_CASE("how much is taken over depends on the number of steps and on cuts that nothing spans") {
  const auto model = small::model<B>();
  const auto run = [&](Index steps, Index overlap) {
    return rerun(model, {chain(seven)}, {edited_chain()}, {.overlap = overlap, .steps = steps}).reuse;
  };
  const auto few = run(2, 4), many = run(8, 4), cut = run(8, 0);
  CHECK(few.kept == 30);  // the second step changes the crop behind the edit's: up to frame 26
  CHECK(few.everywhere == 0);
  CHECK(many.kept == 0);
  CHECK(many.everywhere == 6);  // the edit is in the second of seven
  CHECK(3 * few.work < 2 * few.whole_work);
  CHECK(many.work > few.work);
  CHECK(cut.kept == 48);
  CHECK(7 * cut.work == cut.whole_work);
}

TEST_CASE("a limit keeps frames against the model, and the result is marked as no whole run") {
  const auto model = small::model<B>();
  const ml::StmcOptions options{.overlap = 4};
  const auto before = numbers({model.generate(chain(seven), rng, options)});
  const auto again = rerun(model, {chain(seven)}, {edited_chain()}, options, {.within = 5});
  CHECK_FALSE(again.reuse.exact);
  CHECK(again.reuse.kept == 56 - 22);  // the crop of the edit has frames 6 to 17
  CHECK(again.reuse.everywhere == 0);
  const auto same = [&](Index from, Index to) {
    return std::equal(before[0].begin() + from * 205, before[0].begin() + to * 205,
                      again.motions[0].begin() + from * 205);
  };
  CHECK(same(0, 1));
  CHECK(same(23, 56));
  CHECK_FALSE(same(1, 2));
  CHECK_FALSE(same(22, 23));

  // A later run from its record is that of a whole run no more, whatever it takes over.
  ml::StmcRecord<B> record;
  ml::generate_recorded(model, std::vector{chain(seven)}, rng, options, record);
  ml::StmcReuse reuse;
  ml::regenerate(model, record, std::vector{edited_chain()}, {.within = 5}, &reuse);
  ml::regenerate(model, record, std::vector{chain(seven)}, {}, &reuse);
  CHECK_FALSE(reuse.exact);
}

TEST_CASE("edit after edit from the record of the run before") {
  const auto model = small::model<B>();
  const ml::StmcOptions options{.overlap = 4, .steps = 3};
  ml::StmcRecord<B> record;
  ml::generate_recorded(model, std::vector{chain(seven)}, rng, options, record);
  auto t = chain(seven);
  for (std::size_t i : {0u, 6u, 3u}) {
    t.intervals[i].text = "raise both arms";
    t.intervals[i].parts = BodyParts{}.with(ml::BodyPart::spine);
    ml::StmcReuse reuse;
    const auto motions = ml::regenerate(model, record, std::vector{t}, {}, &reuse);
    CHECK(numbers(motions) == numbers({model.generate(t, rng, options)}));
    CHECK(reuse.work < reuse.whole_work);
  }
}

TEST_CASE("nothing is kept where the crops of a batch depend on each other") {
  auto model = small::model_of<ml::MdmDenoiser<B>>();
  ml::StmcRecord<B> record;
  const ml::StmcOptions options{.overlap = 4, .steps = 3};
  ml::generate_recorded(model, std::vector{chain(seven)}, rng, options, record);
  ml::Philox weights{.seed = 3};
  model.denoiser = ml::MdmDenoiser<B>(
      {.nfeats = 205, .arch = ml::MdmArch::gru, .text_dim = 12, .latent_dim = 32, .num_layers = 1, .crop_frames = 24},
      weights);
  CHECK_ERROR(ml::regenerate(model, record, std::vector{chain(seven)}), "[motionlang.config.102] edits");
  CHECK_ERROR(ml::generate_recorded(model, std::vector{chain(seven)}, rng, options, record),
              "[motionlang.config.102] edits");
}

TEST_CASE("progress counts steps, and a cancelled run leaves the record as it was") {
  const auto model = small::model<B>();
  ml::StmcRecord<B> record;
  ml::generate_recorded(model, std::vector{chain(seven)}, rng, {.steps = 3}, record);
  Index calls = 0;
  auto stop = [&](Index done, Index total) { return ++calls, total == 3 && done < 2; };
  CHECK_THROWS_AS(ml::regenerate(model, record, std::vector{edited_chain()}, {.progress = stop}), ml::cancelled);
  CHECK(calls == 2);
  CHECK(record.timelines == std::vector{chain(seven)});
  CHECK(numbers(ml::regenerate(model, record, std::vector{edited_chain()})) ==
        numbers({model.generate(edited_chain(), rng, {.steps = 3})}));
  record.x0.pop_back();
  CHECK_ERROR(ml::regenerate(model, record, std::vector{edited_chain()}),
              "[motionlang.config.102] regenerate: the record has 2 steps, a run of this model 3");
}

TEST_CASE("a record in a file: the same run, refused for another model") {
  const TemporaryFolder folder;
  const auto model = small::model<B>();
  const ml::StmcOptions options{
      .overlap = 4,
      .guidance = 1.75,
      .steps = 3,
      .sampling = ml::SamplingOptions{.sampler = ml::SamplingOptions::Sampler::ddim, .eta = 0.25},
      .hidden = ml::HiddenTexts::ignore};
  auto odd = chain(seven);
  odd.intervals[2].text = "a # \"strange\"\ntext";
  const std::vector timelines{odd, chain({"sit", "walk"})};
  ml::StmcRecord<B> record;
  ml::generate_recorded(model, timelines, ml::Philox{.seed = 0xFFFFFFFFFFFFFFF1u, .stream = 3}, options, record);
  ml::save_stmc_record(folder / "run", record, model, {{"cut_texts", "1"}});
  auto read = ml::load_stmc_record<B>(ml::SafetensorsFile::open(folder / "run"), model);
  CHECK(read.timelines == timelines);
  CHECK(read.exact);
  auto edited = timelines;
  edited[0].intervals[1].text = "walk";
  CHECK(numbers(ml::regenerate(model, read, edited)) == numbers(ml::regenerate(model, record, edited)));
  CHECK(ml::SafetensorsFile::open(folder / "run").metadata().at("cut_texts") == "1");

  for (const auto& sampling : {ml::SamplingOptions{}, ml::published_stmc_sampling}) {
    ml::StmcRecord<B> of_factor;
    ml::generate_recorded(model, timelines, ml::Philox{.seed = 4},
                          {.overlap = 4, .steps = 3, .sampling = sampling, .hidden = ml::HiddenTexts::ignore},
                          of_factor);
    ml::save_stmc_record(folder / "factor", of_factor, model);
    auto again = ml::load_stmc_record<B>(ml::SafetensorsFile::open(folder / "factor"), model);
    CHECK(numbers(ml::regenerate(model, again, edited)) == numbers(ml::regenerate(model, of_factor, edited)));
  }

  ml::regenerate(model, record, timelines, {.within = 0});
  ml::save_stmc_record(folder / "limited", record, model);
  CHECK_FALSE(ml::load_stmc_record<B>(ml::SafetensorsFile::open(folder / "limited"), model).exact);

  CHECK_ERROR(ml::load_stmc_record<B>(ml::SafetensorsFile::open(folder / "run"), small::model<B>(small::config(), 2)),
              "[motionlang.config.102]");
  ml::write_safetensors(folder / "other", {}, {{"model", "stmc"}});
  CHECK_ERROR(ml::load_stmc_record<B>(ml::SafetensorsFile::open(folder / "other"), model), "[motionlang.config.103]");
}

TEST_CASE("a record of a model of two precisions is refused for a model that has only one of them") {
  const TemporaryFolder folder;
  const auto with = [](ml::Precision denoiser, ml::Precision text) {
    auto model = small::model<B>();
    ml::prepare(model.denoiser, denoiser);
    ml::prepare(model.text_encoder, text);
    return model;
  };
  using enum ml::Precision;
  const auto model = with(bf16, fp32);
  const std::vector timelines{chain({"sit", "walk"})};
  ml::StmcRecord<B> record;
  ml::generate_recorded(model, timelines, ml::Philox{.seed = 5}, {.steps = 3}, record);
  ml::save_stmc_record(folder / "run", record, model);
  const auto file = ml::SafetensorsFile::open(folder / "run");
  const std::string precision = file.metadata().at("precision");
  CHECK_MESSAGE(precision.starts_with("bf16, fp32 from text_encoder."), precision);
  CHECK(ml::load_stmc_record<B>(file, with(bf16, fp32)).timelines == timelines);
  CHECK_ERROR(ml::load_stmc_record<B>(file, with(bf16, bf16)), "made with products in bf16, fp32 from text_encoder.");
  CHECK_ERROR(ml::load_stmc_record<B>(file, with(fp32, fp32)), "[motionlang.config.102]");
}

TEST_CASE("bf16x3: after an edit the bits are those of a whole run, of a model that is wide enough for tiles") {
  auto config = small::config();
  config.denoiser.latent_dim = 256, config.denoiser.ff_size = 512;
  const auto model = small::model<B>(config);
  const auto before = chain(seven), after = edited_chain();
  const auto in_fp32 = numbers(model.generate(std::vector{after}, rng, {.steps = 3}));
  const kernel_sets::InPrecision precision(ml::Precision::bf16x3);
  for (const Index overlap : {0, 4}) {
    const ml::StmcOptions options{.overlap = overlap, .steps = 3};
    const auto whole = numbers(model.generate(std::vector{after}, rng, options));
    const auto again = rerun(model, {before}, {after}, options);
    CHECK(again.motions == whole);
    CHECK(again.reuse.exact);
    CHECK(again.reuse.work < again.reuse.whole_work);
  }
  if (ml::detail::kernels<float>().isa == ml::detail::Isa::amx)
    CHECK(numbers(model.generate(std::vector{after}, rng, {.steps = 3})) != in_fp32);
}
