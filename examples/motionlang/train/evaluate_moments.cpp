// motionlang evaluate --moments: where TMR finds each text in long motions that join clips of different texts.
#include <cstdio>

#include <motionlang/datasets/babel_motions.hpp>
#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/train/moment_evaluation.hpp>
#include <motionlang/weights/text_motion_model.hpp>

#include "../progress_bar.hpp"
#include "../search/search_model.hpp"
#include "../usage_error.hpp"
#include "evaluate.hpp"
#include "processes.hpp"
#include "training_command.hpp"

namespace program {

namespace {

/// As in the thesis, 5.3.6.
void evaluate_babel_moments(const EvaluationOptions& o, const ml::TextMotionFile& file, const SearchModel& model) {
  const ml::BabelSources sources{o.data, o.babel, o.validation, o.splits, o.spelling};
  as_usage([&] { sources.require_sound(); });
  ml::RowMaker maker = ml::row_maker(file.config.features);
  maker.fps = file.fps;
  const int part = o.part == "all" ? -1 : o.part == "training" ? 0 : o.part == "validation" ? 1 : 2;
  const auto sequences = [&] {
    ProgressBar bar("reading motions");
    return ml::read_babel_sequences(sources, maker, file.config.data, part, bar);
  }();
  ProgressBar bar("looking for moments");
  const auto figures =
      ml::sequence_moment_figures(model, sequences,
                                  {.windows = o.windows.empty() ? std::vector<double>{1, 2, 3} : o.windows,
                                   .stride = o.stride > 0 ? o.stride : 1 / file.fps,
                                   .seed = o.seed,
                                   .communicator = processes()},
                                  bar);
  bar.finish();
  std::printf("%s in %s of BABEL; %% found with intersection over union from\n%s",
              ml::counted(figures.wanted.size(), "text").c_str(), ml::counted(sequences.size(), "sequence").c_str(),
              ml::moments_table(figures).c_str());
}

}  // namespace

void evaluate_moments(const EvaluationOptions& o) {
  const ml::TextMotionFile file = ml::read_text_motion_config(o.model);
  const SearchModel model = search_model(o.model, o.text_encoder);
  if (!o.babel.empty()) return evaluate_babel_moments(o, file, model);
  auto config = file.config.data;
  config.mirror = false;
  const auto data =
      read_motions_of({o.data, o.captions, {}, o.annotations, o.splits}, config, ml::row_maker(file.config.features));
  const auto& part = data.part(o.part);
  if (part.empty()) ml::raise<ml::config_error>(101, "the part '", o.part, "' has no motions");

  ProgressBar bar("looking for moments");
  ml::MomentEvaluationOptions options{
      .motions = o.moments, .joined = o.joined, .seed = o.seed, .communicator = processes()};
  if (!o.windows.empty()) options.windows = o.windows;
  if (o.stride > 0) options.stride = o.stride;
  const auto figures = ml::moment_figures(model, data.width, part, options, bar);
  bar.finish();
  std::printf("%s in %s of %td clips of the %s part; %% found with intersection over union from\n%s",
              ml::counted(figures.wanted.size(), "text").c_str(), ml::counted(o.moments, "motion").c_str(), o.joined,
              o.part.c_str(), ml::moments_table(figures).c_str());
}

}  // namespace program
