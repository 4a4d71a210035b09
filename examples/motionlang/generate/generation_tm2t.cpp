// TM2T, as its repository leaves it, behind the Generator: one text for each motion, which is as long as the model has
// it.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/weights/tm2t_run.hpp>

#include "../files/feature_motion.hpp"

namespace program {

namespace {

using B = ml::EigenBackend<float>;

class Tm2tGenerator final : public EachAlone {
 public:
  explicit Tm2tGenerator(ml::Tm2tRun<B> run) : run_(std::move(run)) {}

  double fps() const override { return run_.fps; }
  std::string system() const override { return "TM2T"; }

 private:
  ml::Motion motion(const ml::Timeline& timeline, ml::Philox noise, const GenerationSettings&) const override {
    const ml::Interval& wanted = only_text(timeline);
    const auto words = run_.words.encode<B>(std::span(&wanted.text, 1));
    const auto rows = run_.model.generate(words, noise).rows;
    if (rows.size(0) == 0)
      ml::raise<ml::numeric_error>(302, "the model ends its motion for '", wanted.text,
                                   "' before the first frame; try another --seed");
    const std::vector<double> numbers(rows.span().begin(), rows.span().end());
    return motion_of_features("guoh3dfeats", numbers, run_.width(), run_.fps);
  }

  ml::Tm2tRun<B> run_;
};

}  // namespace

std::unique_ptr<Generator> load_tm2t(const std::filesystem::path& run, const ModelSources& sources) {
  return std::make_unique<Tm2tGenerator>(
      ml::load_tm2t_run<B>(ml::find_run(run), {.tokenizer = sources.tokenizer, .words = sources.text_encoder}));
}

}  // namespace program
