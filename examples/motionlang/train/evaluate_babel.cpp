// motionlang evaluate of SINC and TEACH: errors of motions for labels of BABEL, next to those of motions that know no
// label; how alike motions of SINC are to a motion encoder, and how far TEACH's jump where two actions meet. Of our
// training, or as published.
#include <algorithm>
#include <cstdio>

#include <motionlang/features/smplh_joints.hpp>
#include <motionlang/io/body_file.hpp>
#include <motionlang/io/body_part_table.hpp>
#include <motionlang/io/vae_run.hpp>
#include <motionlang/metrics/temos_score.hpp>

#include "../generate/from_babel.hpp"
#include "../progress_bar.hpp"
#include "babel_model.hpp"
#include "babel_motions.hpp"
#include "evaluate.hpp"
#include "position_errors.hpp"

namespace program {

using ml::Index;
using B = ml::EigenBackend<float>;

namespace {

using Clip = ml::SmplVelpMotion<float>;

ModelSources sources_of(const EvaluationOptions& o) { return {o.text_encoder.string(), o.statistics.string(), {}}; }
bool is_trained(const std::filesystem::path& model) { return ml::find_run(model).system == "motionlang"; }

/// Throws config_error 102 for options that contradict each other.
BabelSources babel_of(const EvaluationOptions& o) {
  const BabelSources out{o.data, o.babel, o.validation, o.splits, o.spelling};
  out.require_sound();
  if (o.part == "all" && !(o.validation.empty() && o.splits.empty()))
    ml::raise<ml::config_error>(102, "--part all measures all of --babel: neither --babel-validation nor --splits");
  return out;
}

/// Items of BABEL, which motions are measured, and what blind guesses are made of.
struct Items {
  DescribedMotions data;
  const std::vector<DescribedMotion>* part = nullptr;
  std::vector<Index> measured;  // of the part

  /// lots    how clips are split; of `--part all` not at all
  /// reader  is asked for items as evaluations take them, of all parts
  /// wanted  which of them are measured
  Items(const EvaluationOptions& o, const BabelSources& sources, const ml::MotionFeatures& features, DataConfig lots,
        const BabelReader& reader, bool (*wanted)(const DescribedMotion&)) {
    const bool all = o.part == "all";
    if (all) lots.test_share = lots.validation_share = 0;
    ProgressBar bar("reading motions");
    data = read_babel_motions(
        sources, std::string(features.name), lots,
        [&](const ml::BabelSequence& s, Index frames, const ml::SpellingTable& spelling, bool) {
          return reader(s, frames, spelling, false);
        },
        bar);
    bar.finish();
    part = all ? &data.training : &data.part(o.part);
    for (Index i = 0; i < std::ssize(*part); ++i) {
      if (wanted((*part)[static_cast<std::size_t>(i)])) measured.push_back(i);
    }
    if (measured.empty()) ml::raise<ml::config_error>(101, "the part '", o.part, "' has no motions");
    const std::string which = all ? o.babel.string() : "the " + o.part + " part";
    std::printf("%zu motions of %s\n", measured.size(), which.c_str());
  }
  Items(const Items&) = delete;
  Items& operator=(const Items&) = delete;

  const DescribedMotion& operator[](Index i) const { return (*part)[static_cast<std::size_t>(i)]; }
  /// The number among those to train on, if they are the ones that are measured.
  Index own(Index i) const { return part == &data.training ? i : -1; }
};

Clip recorded(const DescribedMotion& m) { return ml::smplvelp_inverse(std::span<const float>(m.rows)); }

/// The joints of a set (joint_sets.hpp): those of the user's SMPL-H, or of our own skeleton, whose ankles stand for the
/// heels.
class ComparedJoints {
 public:
  /// Throws config_error 102 for another body, and what read_body throws.
  ComparedJoints(const char* set, const std::filesystem::path& body) : set_(set) {
    if (body.empty()) return;
    body_ = ml::read_body<B>(body);
    if (body_->kind != ml::BodyKind::smplh || body_->model.extra.empty())
      ml::raise<ml::config_error>(102, body.string(), ": a body of ", body_->model.joints(), " joints and ",
                                  body_->model.vertices(), " vertices; BABEL is measured on SMPL-H's 52 and 6890");
  }

  Joints operator()(const Clip& clip) const {
    const Index frames = std::ssize(clip.trans);
    if (body_) {
      std::vector<float> rotations, trans;
      for (const auto& r : clip.rotations) rotations.insert(rotations.end(), r.m.begin(), r.m.end());
      for (const auto& p : clip.trans) trans.insert(trans.end(), {p.x, p.y, p.z});
      const auto joints = ml::smplh_joints(set_, *body_, ml::Tensor<B, 3>::from(rotations, {frames, 22, 9}),
                                           ml::Tensor<B, 2>::from(trans, {frames, 3}));
      Joints out;
      const auto x = joints.span();
      for (std::size_t i = 0; i < x.size(); i += 3)
        out.push_back(ml::vec_cast<double>(ml::Vec3{x[i], x[i + 1], x[i + 2]}));
      return out;
    }
    const auto own = ml::detail::turned_up(ml::detail::first_joints(ml::motion_of_smplvelp(clip, babel_fps), 22), true);
    Joints points, trans;  // of SMPL-H, of which a set has the first ones and the heels
    constexpr std::size_t of_body = 73, left_heel = 59, left_ankle = 7, right_ankle = 8;
    for (std::size_t t = 0; t < clip.trans.size(); ++t) {
      trans.push_back(ml::vec_cast<double>(clip.trans[t]));
      for (std::size_t j = 0; j < of_body; ++j)
        points.push_back(own[22 * t + (j < 22 ? j : j == left_heel ? left_ankle : right_ankle)]);
    }
    return ml::select_joints<double>(set_, points, trans);
  }
  /// Of motion i of those to train on.
  std::function<Joints(Index)> of(const std::vector<DescribedMotion>& motions) const {
    return [this, &motions](Index i) { return (*this)(recorded(motions[static_cast<std::size_t>(i)])); };
  }
  void tell() const {
    std::printf("joints of %s\n",
                body_ ? "SMPL-H" : "our own skeleton; --body SMPLH_MALE compares those of SMPL-H as published");
  }

 private:
  std::string set_;
  std::optional<ml::Body<B>> body_;
};

/// Motions as an encoder of motions sees them: the TEMOS score.
class MotionLikeness {
 public:
  /// folder    a SINC of our training, or a SINC or TEMOS as published, of the same features
  /// features  of the motions
  /// Throws    config_error 102 for other features or another rate, and what the readers throw
  MotionLikeness(const std::filesystem::path& folder, const ModelSources& sources, const ml::MotionFeatures& features)
      : exact_yaw_(features.name == "smplvelp") {
    const auto take = [&](auto parts) {
      if (parts.features->name != features.name || parts.fps != babel_fps)
        ml::raise<ml::config_error>(102, "--temos ", folder.string(), ": a model of ", parts.features->name, " at ",
                                    parts.fps, " frames per second, the motions are ", features.name, " at ",
                                    babel_fps);
      mean_of_ = [parts = std::move(parts)](const std::vector<float>& rows) {
        const Index width = parts.features->width, frames = std::ssize(rows) / width;
        const auto x = parts.normalizer.normalize(ml::Tensor<B, 2>::from(rows, {frames, width}));
        return parts.model.encode_motion(ml::Sequences<B>(x, ml::Offsets{frames})).mu.to_vector();
      };
    };
    if (is_trained(folder))
      take(trained_sinc(folder, sources));
    else if (system_of_run(folder) == "sinc")
      take(published_sinc(folder, sources));
    else
      take(text_latents(ml::load_temos_run<B>(
          ml::find_run(folder), {.text_encoder = sources.text_encoder, .statistics = sources.statistics})));
  }

  /// As published, what was made is turned ahead once more.
  void add(const Clip& made, const std::vector<float>& rows) {
    const auto own = ml::smplvelp_features(std::span<const ml::Matrix3<float>>(made.rotations),
                                           std::span<const ml::Vec3<float>>(made.trans), {.exact_yaw = exact_yaw_});
    made_.push_back(mean_of_(own)), recorded_.push_back(mean_of_(rows));
  }
  /// Of what was made, and of the recorded motions in a circle, each against the next.
  void print() const {
    auto others = recorded_;
    std::rotate(others.begin(), others.begin() + 1, others.end());
    std::printf("\n  TEMOS score\n  %-22s   %7.3f\n  %-22s   %7.3f\n", "one sample", score(made_),
                "another recorded one", score(others));
  }

 private:
  double score(const std::vector<std::vector<float>>& of) const {
    const auto rows = [](const std::vector<std::vector<float>>& means) {
      std::vector<float> all;
      for (const auto& m : means) all.insert(all.end(), m.begin(), m.end());
      return all;
    };
    const Index width = std::ssize(recorded_.front());
    const auto a = rows(of), b = rows(recorded_);
    return ml::temos_score(ml::Rows(std::span(a), width), ml::Rows(std::span(b), width));
  }

  bool exact_yaw_;
  std::function<std::vector<float>(const std::vector<float>&)> mean_of_;
  std::vector<std::vector<float>> made_, recorded_;
};

std::string types_of(const std::string& items) {
  if (items == "pairs") return "spatial_pairs";
  return items == "single" ? "seg+seq" : "seg+seq+spatial_pairs";
}

}  // namespace

void evaluate_sinc(const EvaluationOptions& o) {
  const BabelSources sources = babel_of(o);
  const bool ours = is_trained(o.model);
  SincDataConfig config = ours ? read_babel_config<SincTrainingConfig>(o.model).config.data : SincDataConfig();
  config.types = types_of(o.items);
  const SincLatents model = ours ? trained_sinc(o.model, sources_of(o)) : published_sinc(o.model, sources_of(o));
  const ComparedJoints joints_of("smplnh", o.body);
  std::optional<MotionLikeness> likeness;
  if (!o.temos.empty()) likeness.emplace(o.temos, sources_of(o), *model.features);
  std::optional<ml::BodyPartTable> parts;
  if (!o.body_parts.empty()) parts = ml::open_body_part_table(ml::FilePath(o.body_parts));
  const Items items(o, sources, *model.features, lots_of(config), sinc_reader(config),
                    [](const DescribedMotion& m) { return m.texts.size() <= 2; });
  std::printf("two labels as in '%s'\n",
              ml::join_labels(std::vector<std::string>{"walk", "wave"}, o.conjunction).c_str());
  joints_of.tell();

  const JointErrors none(ml::sinc_rifke());
  SampledErrors sampled(none, o.samples);
  JointErrors at_mean = none, composed = none;
  BlindErrors blind(ml::sinc_rifke(), none, std::ssize(items.data.training), joints_of.of(items.data.training), o.seed);
  const auto rng = ml::Philox{.seed = o.seed};
  ProgressBar bar("generating");
  for (std::size_t k = 0; k < items.measured.size(); ++k) {
    const Index i = items.measured[k];
    const DescribedMotion& d = items[i];
    const auto labels = labels_of(d);
    const Joints truth = joints_of(recorded(d));
    const ml::Offsets length{std::ssize(d.rows) / items.data.width};
    const auto made = [&](const ml::Sequences<B>& tokens, const ml::Philox& noise, Index count,
                          const ml::LatentSampling& how) {
      std::vector<ml::Tensor<B, 2>> out;
      for (const auto& s : ml::text_to_motion(model.model, tokens, length, noise, count, how)) out.push_back(s.rows);
      return out;
    };
    const auto tokens_of = [&](const std::string& text) { return model.tokens(std::span(&text, 1)); };
    const auto sentence = tokens_of(ml::join_labels(labels, o.conjunction));
    std::vector<Joints> samples;
    for (const auto& rows : made(sentence, rng, o.samples, {})) {
      const Clip clip = ml::sinc_motion(model.normalizer, rows);
      if (likeness && samples.empty()) likeness->add(clip, d.rows);
      samples.push_back(joints_of(clip));
    }
    sampled.add(samples, truth);
    at_mean.add(joints_of(ml::sinc_motion(model.normalizer, made(sentence, rng, 1, {.mean = true}).front())), truth);
    if (parts && labels.size() == 2) {
      const auto alone = [&](std::size_t label) {
        return made(tokens_of(labels[label]), rng.split("alone").split(static_cast<std::uint64_t>(label)), 1, {}).front();
      };
      composed.add(joints_of(ml::sinc_composed(model.normalizer, alone(0), parts->parts(labels[0]), alone(1),
                                               parts->parts(labels[1]))),
                   truth);
    }
    blind.add(truth, items.own(i));
    if (!bar(static_cast<std::ptrdiff_t>(k) + 1, std::ssize(items.measured))) throw ml::cancelled();
  }
  bar.finish();
  print_error_heads();
  sampled.print();
  print_errors("mean of the latent", at_mean.result());
  if (composed.clips() > 0) print_errors("labels alone, composed", composed.result());
  blind.print();
  if (likeness) likeness->print();
}

void evaluate_teach(const EvaluationOptions& o) {
  const BabelSources sources = babel_of(o);
  const bool ours = is_trained(o.model);
  const TeachDataConfig config = ours ? read_babel_config<TeachTrainingConfig>(o.model).config.data : TeachDataConfig();
  const TeachLatents model = ours ? trained_teach(o.model, sources_of(o)) : published_teach(o.model, sources_of(o));
  const ComparedJoints joints_of("mmmns", o.body);
  const Items items(o, sources, *model.features, lots_of(config), teach_reader(config), [](const DescribedMotion& m) {
    return m.texts[0].frames.length > 1 && m.texts[1].frames.length > 1;
  });
  using enum ml::Alignment;
  std::printf("the second action %s, %td frames between them interpolated\n",
              o.alignment == full ? "turned and moved to the end of the first" : "moved to the end of the first",
              o.slerp_window);
  joints_of.tell();

  const ml::RifkeVariant variant = ml::temos_rifke();
  const JointErrors none(variant);
  SampledErrors sampled(none, o.samples);
  JointErrors at_mean = none;
  BlindErrors blind(variant, none, std::ssize(items.data.training), joints_of.of(items.data.training), o.seed);
  double aligned = 0, moved = 0, real = 0;  // jumps
  const auto rng = ml::Philox{.seed = o.seed};
  ProgressBar bar("generating");
  for (std::size_t k = 0; k < items.measured.size(); ++k) {
    const Index i = items.measured[k];
    const DescribedMotion& d = items[i];
    const Index first = d.texts[0].frames.length;  // the rest is the transition and the second action
    const ml::Offsets lengths{first, std::ssize(d.rows) / items.data.width - first};
    const auto tokens = model.tokens(labels_of(d));
    const auto made = [&](Index sample, Index window, const ml::LatentSampling& how) {
      return ml::actions_to_motion(model.model, tokens, lengths, rng.split(static_cast<std::uint64_t>(sample)), window,
                                   how);
    };
    const auto joined = [&](const ml::Sequences<B>& parts, Index window, ml::Alignment how) {
      return joints_of(ml::teach_motion(model.normalizer, parts, window, how));
    };
    const auto jump = [&](const Joints& joints) {
      return ml::transition_distance(std::span<const ml::Vec3<double>>(joints), variant.joints, first);
    };
    const Joints truth = joints_of(recorded(d));
    std::vector<Joints> samples;
    for (Index s = 0; s < o.samples; ++s)
      samples.push_back(joined(made(s, o.slerp_window, {}), o.slerp_window, o.alignment));
    sampled.add(samples, truth);
    at_mean.add(joined(made(0, o.slerp_window, {.mean = true}), o.slerp_window, o.alignment), truth);
    blind.add(truth, items.own(i));
    const auto parts = made(0, 0, {});
    aligned += jump(joined(parts, 0, full)), moved += jump(joined(parts, 0, translation)), real += jump(truth);
    if (!bar(static_cast<std::ptrdiff_t>(k) + 1, std::ssize(items.measured))) throw ml::cancelled();
  }
  bar.finish();
  print_error_heads();
  sampled.print();
  print_errors("mean of the latent", at_mean.result());
  blind.print();
  const auto count = static_cast<double>(items.measured.size());
  std::printf("\n  transition distance (m), nothing interpolated\n");
  for (const auto& [what, sum] : {std::pair("turned and moved", aligned), {"moved", moved}, {"recorded", real}})
    std::printf("  %-22s   %7.3f\n", what, sum / count);
}

}  // namespace program
