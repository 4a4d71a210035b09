// motionlang evaluate of SINC and TEACH, trained here or published: errors of motions for labels of BABEL, compared
// with motions that do not depend on the labels. For SINC also the similarity to a motion encoder; for TEACH the jump
// between two actions, and its baselines.
#include <cstdio>
#include <optional>

#include <motionlang/train/sinc_evaluation.hpp>
#include <motionlang/train/teach_evaluation.hpp>
#include <motionlang/weights/babel_config.hpp>

#include "../formatted.hpp"
#include "../progress_bar.hpp"
#include "../usage_error.hpp"
#include "evaluate.hpp"
#include "film_strips.hpp"
#include "processes.hpp"

namespace program {

using B = EvaluationBackend;

namespace {

ml::CheckpointOptions sources_of(const EvaluationOptions& o) { return {o.text_encoder, o.statistics}; }

/// The data configuration of a model trained here, or the defaults.
template <class Config>
auto data_of(const std::filesystem::path& model) {
  return ml::find_run(model).system == "motionlang" ? ml::read_babel_config<Config>(model).config.data
                                                    : decltype(Config::data)();
}

/// Throws usage_error 102 for options that contradict each other.
ml::BabelSources babel_of(const EvaluationOptions& o) {
  const ml::BabelSources out{o.data, o.babel, o.validation, o.splits, o.spelling};
  as_usage([&] { out.require_sound(); });
  if (o.part == "all" && !(o.validation.empty() && o.splits.empty()))
    ml::raise<usage_error>(102,
                           "--part all measures all of --babel and does not go with --babel-validation or --splits");
  return out;
}

template <class Data>
ml::MeasuredItems items_of(const EvaluationOptions& o, const ml::BabelSources& sources,
                           const ml::MotionFeatures& features, const Data& config, const ml::BabelReader& reader) {
  ProgressBar bar("reading motions");
  return {sources, features.name, o.part, ml::split_config(config), reader, bar};
}

void print(const ml::ComparedJoints<B>& joints) {
  std::printf("joints of %s\n", joints.has_body()
                                    ? "SMPL-H"
                                    : "our own skeleton; --body SMPLH_MALE compares those of SMPL-H as published");
}
void print(const ml::LabelSentences& sentences) {
  const char* verbs = !ml::has_gerund(sentences.conjunction()) ? ""
                      : sentences.has_tags()
                          ? ", with the -ing form of the second verb"
                          : ", without the -ing form of its paper, for which --tags says what the verbs are";
  std::printf("two labels as in '%s'%s\n",
              ml::join_labels(std::vector<std::string>{"walk", "wave"}, sentences.conjunction()).c_str(), verbs);
}

/// Film strips of generated and of recorded motions, if they are wanted.
template <class Measures>
void show_in(FilmStrips& strips, Measures& how) {
  if (!strips.wanted()) return;
  how.shows = [&strips](const std::string& text) { return strips.shows(text); };
  how.made = [&strips](const std::string& text, const ml::SmplVelpMotion<float>& made,
                       const ml::DescribedMotion& truth) {
    strips.add(
        text, [&] { return ml::motion_of_smplvelp(made, ml::babel_fps); },
        [&] {
          return ml::motion_of_smplvelp(ml::smplvelp_inverse(std::span<const float>(truth.rows)), ml::babel_fps);
        });
  };
}

std::string types_of(const std::string& items) {
  if (items == "pairs" || items == "unseen") return "spatial_pairs";
  return items == "single" ? "seg+seq" : "seg+seq+spatial_pairs";
}

}  // namespace

void evaluate_sinc(const EvaluationOptions& o) {
  const ml::BabelSources sources = babel_of(o);
  const bool unseen = o.items == "unseen";
  if (unseen && o.part == "all")
    ml::raise<usage_error>(102, "--items unseen needs motions to train on; --part all does not have any");
  if (!o.tags.empty() && !ml::has_gerund(o.conjunction))
    ml::raise<usage_error>(102, "--tags is for --conjunction while and during");
  const ml::LabelSentences sentences(o.conjunction, o.tags);
  FilmStrips strips(o);
  auto config = data_of<ml::SincTrainingConfig>(o.model);
  config.types = types_of(o.items);
  // The thesis takes 15 to 600 frames (B.3.1), the released program up to 800.
  config.longest = o.longest > 0 ? o.longest : unseen ? 600 : 800;
  const auto model = ml::load_sinc<B>(o.model, sources_of(o));
  const ml::ComparedJoints<B> joints("smplnh", o.body);
  std::optional<ml::MotionLikeness<B>> likeness;
  if (!o.temos.empty()) of_option("--temos ", [&] { likeness.emplace(o.temos, sources_of(o), *model.features); });
  std::optional<ml::BodyPartTable> parts;
  if (!o.body_parts.empty()) parts = ml::open_body_part_table(ml::FilePath(o.body_parts));
  ml::MeasuredItems items = items_of(o, sources, *model.features, config, ml::sinc_reader(config));
  const ml::UnseenPairs pairs(items.data().training);
  items.choose([&](const ml::DescribedMotion& m) { return m.texts.size() <= 2 && (!unseen || pairs.has(m)); }, o.keys);
  std::printf("%s\n", items.description().c_str());
  of_option("--tags ", [&] { sentences.require(items.chosen()); });
  if (model.model.config.mode == ml::SincMode::single)
    print(sentences);
  else
    std::printf("labels are read apart\n");
  print(joints);

  ProgressBar bar("generating");
  ml::SincMeasures<B> how{.joints = joints,
                          .sentences = sentences,
                          .parts = parts ? &*parts : nullptr,
                          .likeness = likeness ? &*likeness : nullptr,
                          .samples = o.samples,
                          .seed = o.seed,
                          .communicator = processes()};
  show_in(strips, how);
  const auto errors = ml::sinc_errors(model, items, how, bar);
  bar.finish();
  print(ml::errors_table(errors));
  if (likeness) {
    const auto row = [](const char* motions, double score) { std::printf("  %-22s   %7.3f\n", motions, score); };
    std::printf("\n  TEMOS score\n");
    row("one sample", likeness->score());
    if (likeness->has_composed()) row("labels alone, composed", likeness->score_of_composed());
    row("another recorded one", likeness->score_of_others());
  }
}

void evaluate_teach(const EvaluationOptions& o) {
  const ml::BabelSources sources = babel_of(o);
  FilmStrips strips(o);
  const auto config = data_of<ml::TeachTrainingConfig>(o.model);
  const auto model = ml::load_teach<B>(o.model, sources_of(o));
  const ml::ComparedJoints<B> joints("mmmns", o.body);
  std::vector<ml::TeachBaseline<B>> baselines;
  const auto add = [&](const char* option, const std::filesystem::path& folder, auto load) {
    if (!folder.empty()) of_option(option, [&] { baselines.push_back(load(folder, sources_of(o), *model.features)); });
  };
  add("--independent ", o.independent, ml::independent_baseline<B>);
  add("--joint ", o.joint, ml::joint_baseline<B>);
  ml::MeasuredItems items = items_of(o, sources, *model.features, config, ml::teach_reader(config));
  items.choose(ml::has_two_actions, o.keys);
  const char* moved =
      o.alignment == ml::Alignment::full ? "turned and moved to the end of the first" : "moved to the end of the first";
  std::printf("%s\nthe second action %s, %s between them interpolated\n", items.description().c_str(), moved,
              ml::counted(o.slerp_window, "frame").c_str());
  print(joints);

  ProgressBar bar("generating");
  ml::TeachMeasures<B> how{.joints = joints,
                           .baselines = std::move(baselines),
                           .samples = o.samples,
                           .window = o.slerp_window,
                           .alignment = o.alignment,
                           .seed = o.seed,
                           .communicator = processes()};
  show_in(strips, how);
  const auto figures = ml::teach_figures(model, items, how, bar);
  bar.finish();
  print(ml::errors_table(figures.errors));
  std::printf("\n  transition distance (m), nothing interpolated\n");
  for (const auto& t : figures.transitions) std::printf("  %-29s   %7.3f\n", t.name.c_str(), t.metres);
}

}  // namespace program
