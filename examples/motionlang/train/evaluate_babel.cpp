// motionlang evaluate of SINC and TEACH: errors of motions for labels of BABEL, next to those of motions that know no
// label; how alike motions of SINC are to a motion encoder; how far TEACH's jump where two actions meet, and its
// baselines. Of our training, or as published.
#include <algorithm>
#include <cstdio>
#include <map>
#include <set>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/datasets/babel_motions.hpp>
#include <motionlang/datasets/body_part_table.hpp>
#include <motionlang/datasets/humanml3d_texts.hpp>
#include <motionlang/features/smplh_joints.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/formats/body_file.hpp>
#include <motionlang/generate/load_motion_model.hpp>
#include <motionlang/metrics/temos_score.hpp>
#include <motionlang/weights/sinc_checkpoint.hpp>
#include <motionlang/weights/teach_checkpoint.hpp>
#include <motionlang/weights/temos_checkpoint.hpp>

#include "../progress_bar.hpp"
#include "../usage_error.hpp"
#include "evaluate.hpp"
#include "film_strips.hpp"
#include "position_errors.hpp"

namespace program {

using ml::Index;
using B = ml::EigenBackend<float>;

namespace {

using Clip = ml::SmplVelpMotion<float>;

ml::CheckpointOptions sources_of(const EvaluationOptions& o) { return {o.text_encoder, o.statistics}; }
bool is_trained(const std::filesystem::path& model) { return ml::find_run(model).system == "motionlang"; }

/// Calls f with the parts of a model that makes a motion of one text: SINC or TEACH, of our training or as published,
/// or TEMOS as published.
/// option    what names its folder
/// features  that it has to have
/// Throws    config_error 102 for other features or another rate, 103 for another system, and what the readers throw
template <class F>
void with_model(const std::string& option, const std::filesystem::path& folder, const ml::CheckpointOptions& sources,
                const ml::MotionFeatures& features, F f) {
  const auto take = [&](auto parts) {
    if (parts.features->name != features.name || parts.fps != ml::babel_fps)
      ml::raise<ml::config_error>(102, option, " ", folder.string(), ": a model of ", parts.features->name, " at ",
                                  parts.fps, " frames per second, the motions are ", features.name, " at ",
                                  ml::babel_fps);
    f(std::move(parts));
  };
  const bool ours = is_trained(folder);
  const std::string system = ours ? ml::read_model_folder(folder).system : ml::system_of_run(folder);
  if (system == "sinc")
    take(ml::load_sinc<B>(folder, sources));
  else if (system == "teach")
    take(ml::load_teach<B>(folder, sources));
  else if (system == "temos" && !ours)
    take(ml::load_temos<B>(folder, sources));
  else
    ml::raise<ml::config_error>(103, option, " ", folder.string(), ": a model of '", system,
                                "'; taken are sinc and teach, and temos as published");
}

/// Throws config_error 102 for options that contradict each other.
ml::BabelSources babel_of(const EvaluationOptions& o) {
  const ml::BabelSources out{o.data, o.babel, o.validation, o.splits, o.spelling};
  as_usage([&] { out.require_sound(); });
  if (o.part == "all" && !(o.validation.empty() && o.splits.empty()))
    ml::raise<usage_error>(102, "--part all measures all of --babel: neither --babel-validation nor --splits");
  return out;
}

/// Items of BABEL, which motions are measured, and what blind guesses are made of.
struct Items {
  ml::DescribedMotions data;
  const std::vector<ml::DescribedMotion>* part = nullptr;
  std::vector<Index> measured;  // of the part

  /// split   how clips are split; of `--part all` not at all
  /// reader  is asked for items as evaluations take them, of all parts
  Items(const EvaluationOptions& o, const ml::BabelSources& sources, const ml::MotionFeatures& features,
        ml::DataConfig split, const ml::BabelReader& reader) {
    const bool all = o.part == "all";
    if (all) split.test_share = split.validation_share = 0;
    ProgressBar bar("reading motions");
    data = ml::read_babel_motions(
        sources, std::string(features.name), split,
        [&](const ml::BabelSequence& s, Index frames, const ml::SpellingTable& spelling, bool) {
          return reader(s, frames, spelling, false);
        },
        bar);
    bar.finish();
    part = all ? &data.training : &data.part(o.part);
  }
  /// Chooses what is measured: of the items that are wanted, those that `--keys` names. Throws config_error 101 if
  /// there are none, io_error 401, 403 of the list.
  void choose(const EvaluationOptions& o, const std::function<bool(const ml::DescribedMotion&)>& wanted) {
    std::set<std::string> keys;
    if (!o.keys.empty()) {
      const auto ids = ml::read_ids(o.keys);
      keys = {ids.begin(), ids.end()};
    }
    for (Index i = 0; i < std::ssize(*part); ++i) {
      const ml::DescribedMotion& m = (*this)[i];
      if (wanted(m) && (o.keys.empty() || keys.contains(m.id))) measured.push_back(i);
    }
    const std::string which = o.part == "all" ? o.babel.string() : "the " + o.part + " part",
                      by_keys = o.keys.empty() ? "" : ", of " + ml::counted(keys.size(), "key");
    if (measured.empty()) ml::raise<ml::config_error>(101, which, " has no motions to measure", by_keys);
    std::printf("%s of %s%s\n", ml::counted(measured.size(), "motion").c_str(), which.c_str(), by_keys.c_str());
  }
  Items(const Items&) = delete;
  Items& operator=(const Items&) = delete;

  const ml::DescribedMotion& operator[](Index i) const { return (*part)[static_cast<std::size_t>(i)]; }
  /// The number among those to train on, if they are the ones that are measured.
  Index own(Index i) const { return part == &data.training ? i : -1; }
};

Clip recorded(const ml::DescribedMotion& m) { return ml::smplvelp_inverse(std::span<const float>(m.rows)); }
/// Film strips of what was made and of what was recorded.
void show(FilmStrips& strips, const std::string& text, const Clip& made, const ml::DescribedMotion& truth) {
  strips.add(
      text, [&] { return ml::motion_of_smplvelp(made, ml::babel_fps); },
      [&] { return ml::motion_of_smplvelp(recorded(truth), ml::babel_fps); });
}

/// The joints of a set (joint_sets.hpp): those of the user's SMPL-H, or of our own skeleton, whose ankles stand for the
/// heels.
class ComparedJoints {
 public:
  /// Throws config_error 102 for another body, and what read_body throws.
  ComparedJoints(const char* set, const std::filesystem::path& body) : set_(set) {
    if (body.empty()) return;
    body_ = ml::read_body<B>(body);
    if (body_->kind != ml::BodyKind::smplh || body_->model.extra.empty())
      ml::raise<ml::config_error>(102, body.string(), ": a body of ", ml::counted(body_->model.joints(), "joint"),
                                  " and ", ml::counted(body_->model.vertices(), "vertex", "vertices"),
                                  "; BABEL is measured on SMPL-H's 52 and 6890");
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
    const auto own =
        ml::detail::turned_up(ml::detail::first_joints(ml::motion_of_smplvelp(clip, ml::babel_fps), 22), true);
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
  std::function<Joints(Index)> of(const std::vector<ml::DescribedMotion>& motions) const {
    return [this, &motions](Index i) { return (*this)(recorded(motions[static_cast<std::size_t>(i)])); };
  }
  void print() const {
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
  /// folder    a model of the same features (with_model)
  MotionLikeness(const std::filesystem::path& folder, const ml::CheckpointOptions& sources,
                 const ml::MotionFeatures& features)
      : exact_yaw_(features.name == "smplvelp") {
    with_model("--temos", folder, sources, features, [&](auto parts) {
      mean_of_ = [parts = std::move(parts)](const std::vector<float>& rows) {
        const Index width = parts.features->width, frames = std::ssize(rows) / width;
        const auto x = parts.normalizer.normalize(ml::Tensor<B, 2>::from(rows, {frames, width}));
        return parts.model.encode_motion(ml::Sequences<B>(x, ml::Offsets{frames})).mu.to_vector();
      };
    });
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

/// How far joints jump from the first action to the second, the sum over the motions: where the second is turned and
/// moved to the end of the first, and where it is moved only.
struct Jumps {
  double aligned = 0, moved = 0;
};

/// A model that knows no action before, as a baseline of TEACH.
struct Baseline {
  std::string name;
  bool has_parts;  // which are joined; else one motion for both labels
  ml::Normalizer<B> normalizer;
  /// The parts of one motion, normalised, as of Teach::generate.
  std::function<ml::Sequences<B>(const std::vector<std::string>& labels, const ml::Offsets& lengths, ml::Philox noise,
                                 Index window)>
      parts;
  JointErrors errors;
  Jumps jumps{};
};

/// "independent": both actions alone, joined as TEACH's are; "joint": one motion of the text "a, b". Throws what
/// with_model throws.
/// Source  thesis A.3.3
std::vector<Baseline> baselines_of(const EvaluationOptions& o, const ml::MotionFeatures& features,
                                   const JointErrors& none) {
  std::vector<Baseline> out;
  if (!o.independent.empty()) {
    with_model("--independent", o.independent, sources_of(o), features, [&](auto model) {
      const auto parts = [model](const std::vector<std::string>& labels, const ml::Offsets& lengths, ml::Philox noise,
                                 Index window) {
        const auto eps = ml::Tensor<B, 2>::randn({std::ssize(labels), model.model.config.latent_dim}, noise);
        return ml::independent_actions(model.model, model.tokens(labels), lengths, eps, window);
      };
      out.push_back({"independent", true, model.normalizer, parts, none});
    });
  }
  if (!o.joint.empty()) {
    with_model("--joint", o.joint, sources_of(o), features, [&](auto model) {
      const auto parts = [model](const std::vector<std::string>& labels, const ml::Offsets& lengths, ml::Philox noise,
                                 Index) {
        const std::string text = ml::join_labels(labels, ml::Conjunction::comma);
        const ml::Offsets whole{lengths.rows()};
        return ml::text_to_motion(model.model, model.tokens(std::span(&text, 1)), whole, noise).front();
      };
      out.push_back({"joint", false, model.normalizer, parts, none});
    });
  }
  return out;
}

std::string types_of(const std::string& items) {
  if (items == "pairs" || items == "unseen") return "spatial_pairs";
  return items == "single" ? "seg+seq" : "seg+seq+spatial_pairs";
}

/// What the published evaluation leaves out: pairs of labels that training has, in whatever order, and those with
/// "stand".
/// Source  thesis B.3.1
class SeenPairs {
 public:
  explicit SeenPairs(const std::vector<ml::DescribedMotion>& training) {
    for (const ml::DescribedMotion& m : training) pairs_.insert(pair_of(m));
  }
  bool is_new(const ml::DescribedMotion& m) const {
    const auto pair = pair_of(m);
    return !pair.contains("stand") && !pairs_.contains(pair);
  }

 private:
  static std::multiset<std::string> pair_of(const ml::DescribedMotion& m) {
    const auto labels = ml::labels_of(m);
    return {labels.begin(), labels.end()};
  }
  std::set<std::multiset<std::string>> pairs_;
};

/// Labels as sentences. Where a file says which of their words are verbs, the second one gets its -ing form.
class Sentences {
 public:
  /// Throws config_error 102 for such a file where there is no -ing form, and what ml::read_captions throws.
  explicit Sentences(const EvaluationOptions& o) : conjunction_(o.conjunction), tags_(o.tags) {
    const bool has_gerund = o.conjunction == ml::Conjunction::while_ || o.conjunction == ml::Conjunction::during;
    if (tags_.empty()) {
      if (has_gerund) verbs_ = ", without the -ing form of its paper, for which --tags says what the verbs are";
      return;
    }
    if (!has_gerund) ml::raise<usage_error>(102, "--tags is for --conjunction while and during");
    for (ml::MotionCaption& c : ml::read_captions(tags_)) words_.emplace(c.text, std::move(c.words));
    verbs_ = ", with the -ing form of the second verb";
  }

  /// Throws config_error 103, with the sentences, if the file lacks some of these motions.
  void require(const Items& items) const {
    std::set<std::string> missing;
    for (const Index i : items.measured) {
      const std::string plain = ml::join_labels(ml::labels_of(items[i]), conjunction_);
      if (!tags_.empty() && !words_.contains(plain)) missing.insert(plain);
    }
    if (missing.empty()) return;
    std::string lines;
    for (const std::string& s : missing) lines += "\n" + s;
    ml::raise<ml::config_error>(103, "--tags ", tags_.string(), ": no words of ",
                                ml::counted(missing.size(), "sentence"), ":", lines);
  }
  std::string operator()(const std::vector<std::string>& labels) const {
    if (tags_.empty()) return ml::join_labels(labels, conjunction_);
    return ml::join_labels(labels, conjunction_, [&](std::string_view plain) { return words_.at(std::string(plain)); });
  }
  void print() const {
    std::printf("two labels as in '%s'%s\n",
                ml::join_labels(std::vector<std::string>{"walk", "wave"}, conjunction_).c_str(), verbs_.c_str());
  }

 private:
  ml::Conjunction conjunction_;
  std::filesystem::path tags_;
  std::string verbs_;
  std::map<std::string, std::vector<ml::TaggedWord>> words_;  // of sentences
};

}  // namespace

void evaluate_sinc(const EvaluationOptions& o) {
  const ml::BabelSources sources = babel_of(o);
  const bool unseen = o.items == "unseen";
  if (unseen && o.part == "all")
    ml::raise<usage_error>(102, "--items unseen needs motions to train on; --part all does not have any");
  const Sentences sentence_of(o);
  FilmStrips strips(o);
  ml::SincDataConfig config =
      is_trained(o.model) ? ml::read_babel_config<ml::SincTrainingConfig>(o.model).config.data : ml::SincDataConfig();
  config.types = types_of(o.items);
  const auto model = ml::load_sinc<B>(o.model, sources_of(o));
  const ComparedJoints joints_of("smplnh", o.body);
  std::optional<MotionLikeness> likeness;
  if (!o.temos.empty()) likeness.emplace(o.temos, sources_of(o), *model.features);
  std::optional<ml::BodyPartTable> parts;
  if (!o.body_parts.empty()) parts = ml::open_body_part_table(ml::FilePath(o.body_parts));
  Items items(o, sources, *model.features, ml::split_config(config), ml::sinc_reader(config));
  const SeenPairs seen(items.data.training);
  items.choose(o, [&](const ml::DescribedMotion& m) { return m.texts.size() <= 2 && (!unseen || seen.is_new(m)); });
  sentence_of.require(items);
  sentence_of.print();
  joints_of.print();

  const JointErrors none(ml::sinc_rifke());
  SampledErrors sampled(none, o.samples);
  JointErrors at_mean = none, composed = none;
  BlindErrors blind(ml::sinc_rifke(), none, std::ssize(items.data.training), joints_of.of(items.data.training), o.seed);
  const auto rng = ml::Philox{.seed = o.seed};
  ProgressBar bar("generating");
  for (std::size_t k = 0; k < items.measured.size(); ++k) {
    const Index i = items.measured[k];
    const ml::DescribedMotion& d = items[i];
    const auto labels = ml::labels_of(d);
    const Joints truth = joints_of(recorded(d));
    const ml::Offsets length{std::ssize(d.rows) / items.data.width};
    const auto made = [&](const ml::Sequences<B>& tokens, const ml::Philox& noise, Index count,
                          const ml::LatentSampling& how) {
      std::vector<ml::Tensor<B, 2>> out;
      for (const auto& s : ml::text_to_motion(model.model, tokens, length, noise, count, how)) out.push_back(s.rows);
      return out;
    };
    const auto tokens_of = [&](const std::string& text) { return model.tokens(std::span(&text, 1)); };
    const std::string text = sentence_of(labels);
    const auto sentence = tokens_of(text);
    std::vector<Joints> samples;
    for (const auto& rows : made(sentence, rng, o.samples, {})) {
      const Clip clip = ml::sinc_motion(model.normalizer, rows);
      if (likeness && samples.empty()) likeness->add(clip, d.rows);
      samples.push_back(joints_of(clip));
    }
    sampled.add(samples, truth);
    const Clip mean = ml::sinc_motion(model.normalizer, made(sentence, rng, 1, {.mean = true}).front());
    at_mean.add(joints_of(mean), truth);
    show(strips, text, mean, d);
    if (parts && labels.size() == 2) {
      const auto alone = [&](std::size_t label) {
        return made(tokens_of(labels[label]), rng.split("alone").split(static_cast<std::uint64_t>(label)), 1, {})
            .front();
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
  print_errors(sampled);
  print_errors("mean of the latent", at_mean.result());
  if (composed.clips() > 0) print_errors("labels alone, composed", composed.result());
  print_errors(blind);
  if (likeness) likeness->print();
}

void evaluate_teach(const EvaluationOptions& o) {
  const ml::BabelSources sources = babel_of(o);
  FilmStrips strips(o);
  const ml::TeachDataConfig config =
      is_trained(o.model) ? ml::read_babel_config<ml::TeachTrainingConfig>(o.model).config.data : ml::TeachDataConfig();
  const auto model = ml::load_teach<B>(o.model, sources_of(o));
  const ComparedJoints joints_of("mmmns", o.body);
  const ml::RifkeVariant variant = ml::temos_rifke();
  const JointErrors none(variant);
  std::vector<Baseline> baselines = baselines_of(o, *model.features, none);
  Items items(o, sources, *model.features, ml::split_config(config), ml::teach_reader(config));
  items.choose(
      o, [](const ml::DescribedMotion& m) { return m.texts[0].frames.length > 1 && m.texts[1].frames.length > 1; });
  using enum ml::Alignment;
  std::printf("the second action %s, %s between them interpolated\n",
              o.alignment == full ? "turned and moved to the end of the first" : "moved to the end of the first",
              ml::counted(o.slerp_window, "frame").c_str());
  joints_of.print();

  SampledErrors sampled(none, o.samples);
  JointErrors at_mean = none;
  BlindErrors blind(variant, none, std::ssize(items.data.training), joints_of.of(items.data.training), o.seed);
  Jumps own;
  double real = 0;
  const auto rng = ml::Philox{.seed = o.seed};
  ProgressBar bar("generating");
  for (std::size_t k = 0; k < items.measured.size(); ++k) {
    const Index i = items.measured[k];
    const ml::DescribedMotion& d = items[i];
    const Index first = d.texts[0].frames.length;  // the rest is the transition and the second action
    const ml::Offsets lengths{first, std::ssize(d.rows) / items.data.width - first};
    const auto labels = ml::labels_of(d);
    const auto tokens = model.tokens(labels);
    const auto made = [&](Index sample, Index window, const ml::LatentSampling& how) {
      return ml::actions_to_motion(model.model, tokens, lengths, rng.split(static_cast<std::uint64_t>(sample)), window,
                                   how);
    };
    const auto as_asked = [&](const ml::Normalizer<B>& normalizer, const ml::Sequences<B>& parts) {
      return ml::teach_motion(normalizer, parts, o.slerp_window, o.alignment);
    };
    const auto jump = [&](const Joints& joints) {
      return ml::transition_distance(std::span<const ml::Vec3<double>>(joints), variant.joints, first);
    };
    const auto add_jumps = [&](Jumps& to, const ml::Normalizer<B>& normalizer, const ml::Sequences<B>& parts) {
      to.aligned += jump(joints_of(ml::teach_motion(normalizer, parts, 0, full)));
      to.moved += jump(joints_of(ml::teach_motion(normalizer, parts, 0, translation)));
    };
    const Joints truth = joints_of(recorded(d));
    std::vector<Joints> samples;
    for (Index s = 0; s < o.samples; ++s)
      samples.push_back(joints_of(as_asked(model.normalizer, made(s, o.slerp_window, {}))));
    sampled.add(samples, truth);
    const Clip mean = as_asked(model.normalizer, made(0, o.slerp_window, {.mean = true}));
    at_mean.add(joints_of(mean), truth);
    show(strips, ml::join_labels(labels, ml::Conjunction::comma), mean, d);
    for (Baseline& b : baselines) {
      const auto parts = [&](Index window) { return b.parts(labels, lengths, rng.split(std::uint64_t{0}), window); };
      b.errors.add(joints_of(as_asked(b.normalizer, parts(o.slerp_window))), truth);
      add_jumps(b.jumps, b.normalizer, parts(0));
    }
    blind.add(truth, items.own(i));
    add_jumps(own, model.normalizer, made(0, 0, {}));
    real += jump(truth);
    if (!bar(static_cast<std::ptrdiff_t>(k) + 1, std::ssize(items.measured))) throw ml::cancelled();
  }
  bar.finish();
  print_error_heads();
  print_errors(sampled);
  print_errors("mean of the latent", at_mean.result());
  for (const Baseline& b : baselines) print_errors(b.name, b.errors.result());
  print_errors(blind);
  const auto count = static_cast<double>(items.measured.size());
  std::printf("\n  transition distance (m), nothing interpolated\n");
  const auto print = [&](const std::string& what, double sum) {
    std::printf("  %-29s   %7.3f\n", what.c_str(), sum / count);
  };
  print("turned and moved", own.aligned), print("moved", own.moved);
  for (const Baseline& b : baselines) {
    print(b.has_parts ? b.name + ", turned and moved" : b.name, b.jumps.aligned);
    if (b.has_parts) print(b.name + ", moved", b.jumps.moved);
  }
  print("recorded", real);
}

}  // namespace program
