// motionlang evaluate --moments: where TMR finds each text in long motions that join clips of different texts.
#include <cstdio>

#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/train/moment_evaluation.hpp>
#include <motionlang/weights/text_motion_model.hpp>

#include "../progress_bar.hpp"
#include "../search/search_model.hpp"
#include "evaluate.hpp"
#include "training_command.hpp"

namespace program {

void evaluate_moments(const EvaluationOptions& o) {
  const ml::TextMotionFile file = ml::read_text_motion_config(o.model);
  const SearchModel model = search_model(o.model, o.text_encoder);
  auto config = file.config.data;
  config.mirror = false;
  const auto data =
      read_motions_of({o.data, o.captions, {}, o.annotations, o.splits}, config, ml::row_maker(file.config.features));
  const auto& part = data.part(o.part);
  if (part.empty()) ml::raise<ml::config_error>(101, "the part '", o.part, "' has no motions");

  ProgressBar bar("looking for moments");
  const auto figures = ml::moment_figures(
      model, data.width, part,
      {.motions = o.moments, .joined = o.joined, .windows = o.windows, .stride = o.stride, .seed = o.seed}, bar);
  bar.finish();
  std::printf("%s in %s of %td clips of the %s part; %% found with intersection over union from\n%s",
              ml::counted(figures.wanted.size(), "text").c_str(), ml::counted(o.moments, "motion").c_str(), o.joined,
              o.part.c_str(), ml::moments_table(figures).c_str());
}

}  // namespace program
