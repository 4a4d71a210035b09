// motionlang evaluate of ACTOR: accuracy, FID, diversity and multimodality of generated motions next to recorded ones,
// of these denoised, and of what lies between two of them (thesis table 3.8), over several seeds, by a classifier that
// was trained on the training part, or by a published one. ACTOR is of our training, or as it was published.
#include <cstdio>
#include <set>

#include <motionlang/metrics/diversity.hpp>
#include <motionlang/metrics/frechet.hpp>
#include <motionlang/metrics/summary.hpp>
#include <motionlang/weights/actor_file.hpp>

#include "../files/motion_files.hpp"
#include "../progress_bar.hpp"
#include "../usage_error.hpp"
#include "action_task.hpp"
#include "evaluate.hpp"

namespace program {

using ml::Index;
using B = TrainingBackend;

namespace {

/// What the classifier says of a set of motions.
struct Judged {
  std::vector<float> features;
  Index width = 0;
  double accuracy = 0;
  ml::Rows<float> rows() const { return {features, width}; }
};

/// Who judges, and what it is shown.
struct Judge {
  ActionModelFile<ClassifierConfig> file;
  Classifier<B> classifier;
  std::vector<Index> numbers{};  // that it gives to the classes of the motions

  /// A classifier of train-classifier.
  explicit Judge(const std::filesystem::path& folder)
      : file(read_action_config<ClassifierConfig>(folder, "classifier")) {
    const auto weights = open_action_weights(folder);
    const auto room = ml::detail::room_of(weights);
    classifier = Classifier<B>(file.config, std::ssize(file.labels), ml::Philox{});
    load_action_weights(classifier, weights);
  }
  /// The file of a published one: ST-GCN, or a GRU that reads the 24 joints of SMPL with the way of the root, or the 18
  /// points of NTU-13 without it. It sees motions of the rate of the model and as they face, in the world of a camera.
  /// body, regressor  of the user (body_points.hpp); without them a GRU is given the joints of our own skeleton
  /// Throws  io_error 404 for another file, 407 for other joints, config_error 102 for a body that is missing or not
  ///         read
  Judge(const std::filesystem::path& path, const ActorClipsConfig& clips, const std::filesystem::path& body,
        const std::filesystem::path& regressor) {
    const ml::WeightFile weights = ml::open_weights(path);
    Index classes = 0, read = 0, wanted = 0;  // numbers a frame
    if (const ml::TensorView* const gates = weights.find("recurrent.weight_ih_l0")) {
      classifier.gru = ml::load_gru_classifier<B>(weights);
      classifier.drawn_state = true;
      classes = classifier.gru->linear2.out(), read = gates->shape[1], wanted = 24 * 3;
      if (read == 18 * 3) {
        if (body.empty())
          ml::raise<ml::config_error>(
              102, path.string(), " reads 18 points of a body: --body SMPL, --joint-regressor J_regressor_extra.npy");
        wanted = 18 * 3;
      }
      if (!body.empty()) read_body_points(wanted == 18 * 3 ? "a2m" : "smpl", body, regressor);
    } else if (const ml::TensorView* const norm = weights.find("data_bn.weight")) {
      classifier.stgcn = ml::load_stgcn<B>(weights);
      classes = classifier.stgcn->fcn.out(), read = norm->shape[0], wanted = 24 * 6;
    } else {
      ml::raise<ml::io_error>(404, path.string(), ": neither the GRU of Action2Motion nor ST-GCN");
    }
    if (read != wanted)
      ml::raise<ml::io_error>(407, path.string(), ": a classifier of ", ml::counted(read, "number"),
                              " a frame, expected ", wanted, ": SMPL's 24 joints");
    if (!classifier.points && !(body.empty() && regressor.empty()))
      ml::raise<ml::config_error>(102, path.string(), " has no use for --body '", body.string(),
                                  "', --joint-regressor '", regressor.string(), "'");
    ml::prepare(classifier);
    file.config.clips = clips;
    file.config.clips.pose = "rot6d", file.config.clips.camera = true;
    file.config.clips.translation = classifier.gru.has_value();
    file.labels = class_names("humanact12", classes);
  }

 private:
  /// One motion after the other, since a surface is large.
  void read_body_points(const char* name, const std::filesystem::path& body, const std::filesystem::path& regressor) {
    const auto points = std::make_shared<const BodyPoints<B>>(name, body, regressor);
    const bool translate = points->points == ml::ActorPoints::smpl;
    classifier.points = [points, translate](const ml::Sequences<B>& x, const ActorClipsConfig& clips) {
      std::vector<float> values;
      for (Index s = 0; s < x.count(); ++s) {
        const auto one = (*points)({x[s], ml::Offsets{x.offsets.length(s)}}, clips, translate).rows;
        values.insert(values.end(), one.span().begin(), one.span().end());
      }
      const Index frames = x.offsets.rows();
      return x.with(ml::Tensor<B, 2>::from(values, {frames, std::ssize(values) / std::max<Index>(1, frames)}));
    };
  }
};

/// Classifies motions in batches: batch(numbers) gives them with their classes.
template <class Batch>
Judged judge(const Judge& who, Index motions, const ml::Philox& rng, Batch batch) {
  Judged out;
  constexpr Index at_once = 64;
  double right = 0;
  for (Index at = 0; at < motions; at += at_once) {
    std::vector<Index> which;
    for (Index i = at; i < std::min(at + at_once, motions); ++i) which.push_back(i);
    ActionBatch<B> b = batch(which);
    for (Index& y : b.classes) y = who.numbers[static_cast<std::size_t>(y)];
    const auto said = who.classifier(b.x, who.file.config.clips, rng.split(static_cast<std::uint64_t>(at)));
    const auto confusion =
        ml::confusion_matrix(ml::Rows(said.logits.span(), said.logits.size(1)), std::span<const Index>(b.classes));
    right += ml::accuracy(confusion) * static_cast<double>(which.size());
    out.features.insert(out.features.end(), said.features.span().begin(), said.features.span().end());
    out.width = said.features.size(1);
  }
  out.accuracy = right / static_cast<double>(motions);
  return out;
}

/// The motions that are measured, with their classes.
struct Measured {
  DescribedMotions data;
  const std::vector<DescribedMotion>* part;
  std::vector<Index> classes;

  Measured(const EvaluationOptions& o, const DataConfig& config, const ActorClipsConfig& clips,
           std::span<const std::string> labels)
      : data([&] {
          ProgressBar bar("reading motions");
          return read_described_motions({o.data, {}, o.labels, o.annotations, o.splits, true}, config,
                                        actor_row_maker(clips), bar);
        }()),
        part(&data.part(o.part)),
        classes(classes_of(*part, labels)) {
    if (part->empty()) ml::raise<ml::config_error>(101, "the part '", o.part, "' has no motions");
    std::printf("%s of the %s part, %s\n", ml::counted(part->size(), "motion").c_str(), o.part.c_str(),
                ml::counted(labels.size(), "class", "classes").c_str());
  }
};

/// Classes numbered without those of which there is no motion and so no pair, and how many are left.
std::pair<std::vector<Index>, Index> present_classes(std::span<const Index> classes, Index kinds) {
  std::vector<Index> numbered, number(static_cast<std::size_t>(kinds), -1);
  Index present = 0;
  for (const Index y : classes) {
    Index& n = number[static_cast<std::size_t>(y)];
    if (n < 0) n = present++;
    numbered.push_back(n);
  }
  return {numbered, present};
}

/// The mean over seeds, with the interval of ACTOR's tables.
std::string summary(const std::string& metric, std::span<const double> of_seeds) {
  const auto r = ml::actor_summary(metric, of_seeds);
  char text[32];
  std::snprintf(text, sizeof text, "%.2f +-%.2f", r.mean, r.half_width);
  return text;
}

}  // namespace

void evaluate_actor(const EvaluationOptions& o) {
  if (o.classifier.empty())
    ml::raise<usage_error>(102, "ACTOR is judged by a classifier: --classifier names its folder or its file");
  if (!o.strips.empty()) make_output_folder("--strips", o.strips);
  const ActorModel<B> model(o.model);
  const auto& file = model.file;
  const ActorClipsConfig& clips = file.config.clips;
  const bool ours = std::filesystem::is_directory(o.classifier);
  if (ours && !(o.body.empty() && o.regressor.empty()))
    ml::raise<usage_error>(102, "--body and --joint-regressor are for the file of a published GRU; ",
                           o.classifier.string(), " is of our training");
  Judge who = ours ? Judge(o.classifier) : Judge(o.classifier, clips, o.body, o.regressor);
  const ActorClipsConfig& seen = who.file.config.clips;
  require_same_clips(clips, seen);
  who.numbers = numbers_of(file.labels, who.file.labels);
  const Measured measured(o, file.config.data, clips, file.labels);
  const auto& part = *measured.part;
  const auto& classes = measured.classes;
  const Index count = std::ssize(part), kinds = std::ssize(file.labels);
  const auto [numbered, present] = present_classes(classes, kinds);
  const RecognitionSets<B> motions{model, part, classes, clips, seen};
  std::map<std::string, std::vector<double>> results;
  ProgressBar bar("evaluating");
  for (Index s = 0; s < o.seeds; ++s) {
    const auto seed = ml::Philox{.seed = o.seed + static_cast<std::uint64_t>(s)};
    const auto first = seed.split("gt"), second = seed.split("gt2");
    const auto of_batch = [&](const char* name, std::span<const Index> which) {
      return seed.split(name).split(static_cast<std::uint64_t>(which.front()));
    };
    const auto judged = [&](const char* name, auto batch) {
      return std::pair(std::string(name), judge(who, count, seed.split("judge").split(name), batch));
    };
    const std::map<std::string, Judged> sets{
        judged("gt", [&](auto which) { return motions.recorded(which, first); }),
        judged("gt2", [&](auto which) { return motions.recorded(which, second); }),
        judged("gen",
               [&](auto which) {
                 return motions.sampled(which, first, of_batch("noise", which));  // as long as "gt"
               }),
        judged("denoised", [&](auto which) { return motions.denoised(which, first); }),
        judged("between", [&](auto which) {
          return motions.interpolated(which, first, seed.split("others"), of_batch("between", which));
        })};
    for (const auto& [name, set] : sets) {
      ml::NumpyRandom random(static_cast<std::uint32_t>(o.seed) + static_cast<std::uint32_t>(s));
      results["accuracy_" + name].push_back(set.accuracy);
      results["diversity_" + name].push_back(
          ml::mean_pair_distance(set.rows(), ml::random_pairs(set.rows().size(), 200, random)));
      results["multimodality_" + name].push_back(
          ml::mean_pair_distance(set.rows(), ml::pairs_within_classes(numbered, present, 20, random)));
      if (name != "gt") results["fid_" + name].push_back(ml::frechet_distance(sets.at("gt").rows(), set.rows()));
    }
    bar(s + 1, o.seeds);
  }
  bar.finish();
  std::printf("  %-25s %-12s %-12s %-12s %-12s\n", "", "accuracy %", "FID", "diversity", "multimodality");
  for (const auto& [name, what] : {std::pair{"gt", "recorded"},
                                   {"gt2", "recorded, other windows"},
                                   {"gen", "generated"},
                                   {"denoised", "denoised"},
                                   {"between", "between two of an action"}}) {
    std::printf("  %-25s", what);
    for (const char* metric : {"accuracy_", "fid_", "diversity_", "multimodality_"}) {
      const auto found = results.find(std::string(metric) + name);
      if (found == results.end()) {
        std::printf(" %-12s", "-");
        continue;
      }
      std::printf(" %-12s", summary(found->first, found->second).c_str());
    }
    std::printf("\n");
  }
  if (o.strips.empty()) return;
  std::set<std::string> taken;
  for (Index k = 0; k < std::min(kinds, o.count); ++k) {
    auto noise = ml::Philox{.seed = o.seed}.split("strips").split(static_cast<std::uint64_t>(k));
    const std::vector<Index> action{k}, length{clips.num_frames > 0 ? clips.num_frames : clips.min_len};
    const auto made = ml::generate(model.actor, action, length, noise);
    const auto rows = made.rows.to_vector();
    auto motion = actor_motion(rows, clips);
    motion.name = file.labels[static_cast<std::size_t>(k)];
    write_motion(o.strips / (unique(file_name(motion.name), taken) + ".svg"), motion);
  }
}

void evaluate_classifier(const EvaluationOptions& o) {
  Judge who(o.model);
  const ActorClipsConfig& clips = who.file.config.clips;
  who.numbers = numbers_of(who.file.labels, who.file.labels);
  const Measured measured(o, who.file.config.data, clips, who.file.labels);
  std::vector<double> accuracies;
  for (Index s = 0; s < o.seeds; ++s) {
    const auto seed = ml::Philox{.seed = o.seed + static_cast<std::uint64_t>(s)};
    accuracies.push_back(judge(who, std::ssize(*measured.part), seed.split("judge"), [&](auto which) {
                           return action_batch<B>(*measured.part, measured.classes, which, clips, seed.split("gt"));
                         }).accuracy);
  }
  std::printf("  accuracy %%  %s\n", summary("accuracy_gt", accuracies).c_str());
}

}  // namespace program
