// motionlang evaluate of ACTOR, trained here or published: accuracy, FID, diversity and multimodality over several
// seeds. It measures recorded, generated, denoised and interpolated motions (thesis table 3.8). The classifier is one
// that was trained on the training part, or a published one.
#include <cstdio>
#include <set>

#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/train/made_motions.hpp>
#include <motionlang/train/recognition.hpp>
#include <motionlang/weights/actor_model.hpp>

#include "../files/motion_files.hpp"
#include "../formatted.hpp"
#include "../progress_bar.hpp"
#include "../usage_error.hpp"
#include "action_options.hpp"
#include "evaluate.hpp"
#include "processes.hpp"
#include "training_command.hpp"

namespace program {

using ml::Index;
using B = EvaluationBackend;

namespace {

/// The motions to measure.
struct Measured {
  ml::DescribedMotions data;
  const std::vector<ml::DescribedMotion>* part;

  Measured(const EvaluationOptions& o, const ml::DataConfig& config, const ml::ActorClipsConfig& clips,
           std::span<const std::string> labels)
      : data(
            read_motions_of({o.data, {}, o.labels, o.annotations, o.splits, true}, config, ml::actor_row_maker(clips))),
        part(&data.part(o.part)) {
    require_dataset(o.dataset, o.data);
    if (part->empty()) ml::raise<ml::config_error>(101, "the part '", o.part, "' has no motions");
    std::printf("%s of the %s part, %s\n", ml::counted(part->size(), "motion").c_str(), o.part.c_str(),
                ml::counted(labels.size(), "class", "classes").c_str());
  }
};

}  // namespace

void evaluate_actor(const EvaluationOptions& o) {
  if (o.classifier.empty())
    ml::raise<usage_error>(102, "ACTOR needs a classifier as judge: name its folder or file with --classifier");
  if (!o.strips.empty()) make_output_folder("--strips", o.strips);
  const ml::ActorModel<B> model(o.model);
  const auto& file = model.file;
  const ml::ActorClipsConfig& clips = file.config.clips;
  const bool ours = std::filesystem::is_directory(o.classifier);
  if (ours && !(o.body.empty() && o.regressor.empty()))
    ml::raise<usage_error>(102, "--body and --joint-regressor are for the file of a published GRU; ",
                           o.classifier.string(), " was trained here");
  auto who = ours ? ml::ActionJudge<B>(o.classifier) : ml::ActionJudge<B>(o.classifier, clips, o.body, o.regressor);
  const ml::ActorClipsConfig& seen = who.file.config.clips;
  ml::require_same_clips(clips, seen);
  who.numbers = ml::numbers_of(file.labels, who.file.labels);
  const Measured measured(o, file.config.data, clips, file.labels);
  const auto& part = *measured.part;
  ProgressBar bar("evaluating");
  ml::RecognitionOptions how{.seeds = o.seeds, .seed = o.seed, .communicator = processes()};
  if (!o.durations.empty()) {
    const auto lengths = ml::duration_results(model, who, part, o.durations, how, bar);
    bar.finish();
    std::printf("\n");
    return print(ml::duration_table(lengths));
  }
  std::vector<ml::DescribedMotion> others;
  if (!o.made.empty())
    others = ml::MadeMotions(o.made, o.made_rate).of_actions(file.labels, ml::actor_row_maker(clips));
  if (!others.empty()) how.made = &others;
  const auto results = ml::recognition_results(model, who, part, how, bar);
  bar.finish();
  print(ml::recognition_table(results));
  if (o.strips.empty() || processes().rank() > 0) return;
  std::set<std::string> taken;
  for (const ml::Motion& motion : ml::action_examples(model, o.count, o.seed))
    write_motion(o.strips / (unique_name(safe_file_name(motion.name), taken) + ".svg"), motion);
}

void evaluate_classifier(const EvaluationOptions& o) {
  const ml::ActionJudge<B> who(o.model);
  const Measured measured(o, who.file.config.data, who.file.config.clips, who.file.labels);
  const auto accuracies = ml::recorded_accuracies(who, *measured.part, o.seeds, o.seed, processes());
  std::printf("  accuracy %%  %s\n", ml::recognition_cell("accuracy_gt", accuracies).c_str());
}

}  // namespace program
