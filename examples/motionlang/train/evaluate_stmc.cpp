// motionlang evaluate of STMC, MDM and MotionDiffuse: the tables of STMC's paper on timelines.
#include <cstdio>

#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/generate/mtt_runs.hpp>

#include "../commands.hpp"
#include "../generate/generation.hpp"
#include "../progress_bar.hpp"
#include "../search/search_model.hpp"
#include "evaluate.hpp"
#include "processes.hpp"

namespace program {

namespace {

/// Those of a file, or drawn from the texts; the first ones if fewer are wanted.
std::vector<ml::TimelineInSeconds> timelines_of(const EvaluationOptions& o, std::span<const ml::MttText> texts) {
  const ml::Index wanted = o.first.value_or(0);
  if (o.timelines.empty()) {
    const ml::MttOptions usual;
    return ml::mtt_timelines(texts, {.count = wanted > 0 ? wanted : usual.count});
  }
  auto out = ml::parse_timelines_in_seconds(ml::read_file(o.timelines), {.name = o.timelines.string()});
  if (wanted > 0 && wanted < std::ssize(out)) out.resize(static_cast<std::size_t>(wanted));
  return out;
}

}  // namespace

void evaluate_stmc(const EvaluationOptions& o) {
  if (o.texts.empty()) ml::raise<usage_error>(102, o.model.string(), ": --texts is needed to measure STMC");
  if (o.recorded.empty() != o.data.empty())
    ml::raise<usage_error>(102, "--recorded and --data belong together: which motion shows each text, and where it is");
  const auto texts = ml::parse_mtt_texts(ml::read_file(o.texts), o.texts.string());
  const auto timelines = timelines_of(o, texts);
  const SearchModel tmr = search_model(o.tmr.empty() ? default_search_model() : o.tmr, o.tmr_text_encoder);
  std::vector<std::vector<double>> recorded;
  if (!o.recorded.empty())
    recorded = ml::mtt_features_of_recordings(ml::FilePath(o.recorded), ml::FilePath(o.data), texts.size());
  const auto reference = ml::mtt_reference(tmr, texts, std::move(recorded));
  const auto model =
      load_generator("eigen", o.model, {.text_encoder = o.text_encoder.string(), .statistics = o.statistics.string()});
  ml::MttRunOptions how{
      .seed = o.seed, .batch = o.batch, .steps = o.steps, .guidance = o.guidance, .communicator = processes()};
  if (!o.noise_factor.empty()) how.noise_scale = ml::parse_noise_scale(o.noise_factor);

  const ml::TableStyle style = ml::parse_table_style(o.table);
  ProgressBar bar("generating and measuring");
  const auto rows =
      ml::mtt_rows(*model, tmr, reference, texts, timelines, ml::mtt_runs(o.modes, o.overlap, o.overlaps), how, bar);
  bar.finish();
  std::printf("%s of %s, seed %ju; judged by %s (%s)\n", ml::counted(timelines.size(), "timeline").c_str(),
              ml::counted(texts.size(), "text").c_str(), static_cast<std::uintmax_t>(o.seed), tmr.model().path.c_str(),
              tmr.model().id.c_str());
  for (const auto& [flavour, about] :
       {std::pair{ml::MttFlavour::as_coded, "as coded, to compare with the published tables"},
        std::pair{ml::MttFlavour::as_written, "as written in the thesis"}}) {
    std::printf("\n%s\n%s", about, ml::mtt_table(rows, {.flavour = flavour, .style = style}).c_str());
  }
  std::printf("\n");
}

}  // namespace program
