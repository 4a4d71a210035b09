// Golden functions: STMC's evaluation on MTT.
#include <motionlang/compose/mtt_timelines.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/metrics/mtt.hpp>

#include "geometry.hpp"

namespace {

using golden::Case, golden::Registration;
using golden::out_list, golden::vectors, golden::Vectors;
namespace ml = motionlang;
using ml::Index;

void generation(Case& c) {
  const auto config = c.config();
  ml::MttOptions options{.count = config["count"].as<Index>(),
                         .seed = config["seed"].as<std::int64_t>(),
                         .mean = config["mean"].as<double>(),
                         .std = config["std"].as<double>(),
                         .cap = config["cap"].as<double>()};
  for (std::size_t p = 0; p < options.weights.size(); ++p) {
    options.weights[p] = config["weights"][std::string(ml::body_part_names[p])].as<Index>();
  }
  std::string file;
  for (const auto& line : c.text().as<std::vector<std::string>>()) file += line + '\n';
  c.out_text("file_utf8", ml::write_timelines(ml::mtt_timelines(ml::parse_mtt_texts(file), options)));
}

void realism_crops(Case& c) {
  const auto config = c.config();
  const ml::RealismCrops crops{.frames = config["crop_frames"].as<Index>(),
                               .samples = config["samples"].as<Index>(),
                               .seed = config["seed"].as<std::uint32_t>(),
                               .features = config["features"].as<Index>()};
  const auto starts = ml::fixed_crop_starts(crops);
  c.out("starts", starts);
  const auto frames = c.values<Index>("in/feature_frames");
  std::vector<Index> left;
  for (const Index n : frames) {
    for (const Index start : starts) left.push_back(ml::crop_frames(start, n, crops));
  }
  c.out("crop_frames", {std::ssize(frames), crops.samples}, left);
}

/// HumanML3D's skeleton with the bone lengths of the case.
ml::ChainSkeleton skeleton_of(const Case& c) {
  ml::ChainSkeleton skeleton = ml::humanml3d_chains();
  skeleton.lengths.clear();
  for (const auto& offset : vectors<double>(c, "target_offsets")) skeleton.lengths.push_back(norm(offset));
  skeleton.foot_threshold = c.config()["feet_threshold"].as<double>();
  return skeleton;
}
template <class S>
std::vector<S> features_of(const Case& c, const Vectors<S>& joints, Index count) {
  return ml::mtt_features(skeleton_of(c), std::span<const ml::Vec3<S>>(joints), count, c.config()["z_up"].as<bool>());
}
/// Features of all motions that stand behind each other.
template <class S>
std::vector<std::vector<S>> all_features(const Case& c, const std::string& name) {
  const auto joints = vectors<S>(c, name);
  const auto ptr = c.values<Index>("in/" + name + "_ptr");
  const Index count = c.shape("in/" + name)[1];
  std::vector<std::vector<S>> out;
  for (std::size_t m = 0; m + 1 < ptr.size(); ++m) {
    out.push_back(features_of<S>(c, {joints.begin() + count * ptr[m], joints.begin() + count * ptr[m + 1]}, count));
  }
  return out;
}
/// Intervals without texts and parts.
std::vector<ml::Timeline> timelines_of(const Case& c) {
  const auto ptr = c.values<std::size_t>("in/timeline_ptr");
  const auto times = c.values<Index>("in/intervals");
  std::vector<ml::Timeline> out(ptr.size() - 1);
  for (std::size_t m = 0; m + 1 < ptr.size(); ++m) {
    for (std::size_t i = ptr[m]; i < ptr[m + 1]; ++i)
      out[m].intervals.push_back({"", times[2 * i], times[2 * i + 1], {}});
  }
  return out;
}

template <class S>
void features(Case& c) {
  const auto out = features_of(c, vectors<S>(c, "joints"), c.shape("in/joints")[1]);
  c.out("features", {std::ssize(out) / 263, 263}, out);
}
template <class S>
void local_joints(Case& c) {
  const auto features = c.values<S>("in/features");
  out_list<S>(c, "joints", ml::mtt_local_joints(std::span<const S>(features)));
}

void transition_points(Case& c) {
  const auto timelines = timelines_of(c);
  const auto frames = c.values<Index>("in/feature_frames");
  using enum ml::MttFlavour;
  for (const auto& [name, flavour] :
       {std::pair<std::string, ml::MttFlavour>{"as_coded", as_coded}, {"as_written", as_written}}) {
    std::vector<Index> all, ptr{0};
    for (std::size_t m = 0; m < timelines.size(); ++m) {
      for (const Index p : ml::transition_points(timelines[m], frames[m], flavour)) all.push_back(p);
      ptr.push_back(std::ssize(all));
    }
    c.out(name, all);
    c.out(name + "_ptr", ptr);
  }
  std::vector<Index> quarters;
  for (const Index n : frames) {
    for (const Index p : ml::quarter_points(n)) quarters.push_back(p);
  }
  c.out("quarters", {std::ssize(frames), 3}, quarters);
}

template <class S>
void transition_distance(Case& c) {
  const auto timelines = timelines_of(c);
  const auto motions = all_features<S>(c, "joints");
  auto mean = [&](ml::MttOrigin origin, auto points_of) {
    std::vector<double> all;
    for (std::size_t m = 0; m < motions.size(); ++m) {
      const auto joints = ml::mtt_local_joints(std::span<const S>(motions[m]));
      const auto points = points_of(timelines[m], std::ssize(joints) / 22);
      const auto each = ml::mtt_transitions(std::span<const ml::Vec3<S>>(joints), points, origin);
      all.insert(all.end(), each.begin(), each.end());
    }
    return std::accumulate(all.begin(), all.end(), 0.0) / static_cast<double>(all.size());
  };
  using enum ml::MttFlavour;
  auto inner = [](ml::MttFlavour flavour) {
    return [flavour](const ml::Timeline& t, Index frames) { return ml::transition_points(t, frames, flavour); };
  };
  auto quarters = [](const ml::Timeline&, Index frames) { return ml::quarter_points(frames); };
  c.out_scalar("as_coded", mean(ml::MttOrigin::own_x, inner(as_coded)));
  c.out_scalar("as_coded_onetext", mean(ml::MttOrigin::own_x, quarters));
  c.out_scalar("ground_truth_flavour", mean(ml::MttOrigin::root, quarters));
  c.out_scalar("as_written", mean(ml::MttOrigin::root, inner(as_written)));
}

template <class S>
void metrics_from_latents(Case& c) {
  const auto intervals = c.values<S>("in/crop_latents"), crops = c.values<S>("in/realism_latents"),
             texts = c.values<S>("in/text_latents"), motions = c.values<S>("in/motion_latents");
  const auto labels = c.values<Index>("in/labels");
  const Index d = c.shape("in/crop_latents")[1];
  const ml::Rows crop_rows(intervals, d), text_rows(texts, d), motion_rows(motions, d);
  const auto shape = c.shape("out/sim_m2t");
  c.out("sim_m2t", shape, ml::cosine_similarities(crop_rows, text_rows));
  c.out("sim_m2m", shape, ml::cosine_similarities(crop_rows, motion_rows));
  const auto s = ml::mtt_semantics(crop_rows, labels, text_rows, motion_rows);
  c.out_scalar("r1", s.r1);
  c.out_scalar("r3", s.r3);
  c.out_scalar("m2t", s.m2t);
  c.out_scalar("m2m", s.m2m);
  const auto truth = ml::detail::own_semantics(motion_rows, text_rows);
  c.out_scalar("gt_r1", truth.r1);
  c.out_scalar("gt_r3", truth.r3);
  c.out_scalar("gt_m2t", truth.m2t);
  const auto unit = ml::unit_rows(ml::Rows(crops, d)), reference = ml::unit_rows(motion_rows);
  const auto a = ml::gaussian_statistics(ml::Rows(unit, d)), b = ml::gaussian_statistics(ml::Rows(reference, d));
  c.out("mean", a.mean);
  c.out("covariance", {d, d}, a.covariance);
  c.out("reference_mean", b.mean);
  c.out("reference_covariance", {d, d}, b.covariance);
  c.out_scalar("fid", ml::frechet_distance(a, b));
}

template <class S>
void metrics_from_motions(Case& c) {
  const auto projection = c.values<double>("in/projection"), bias = c.values<double>("in/bias");
  const Index latent = std::ssize(bias);
  auto encode = [&](const ml::Rows<S>& rows) {
    std::vector<double> out = bias;
    for (Index t = 0; t < rows.size(); ++t) {
      for (std::size_t i = 0; i < projection.size(); ++i) {
        const std::size_t feature = i / bias.size();
        out[i % bias.size()] +=
            static_cast<double>(rows[t][feature]) * projection[i] / static_cast<double>(rows.size());
      }
    }
    return out;
  };
  ml::MttReference<S> reference{c.values<double>("in/text_latents"), {}, all_features<S>(c, "gt_joints"), latent};
  for (const auto& features : reference.features) {
    for (const double x : encode(ml::Rows(features, 263))) reference.motion_latents.push_back(x);
  }
  const auto timelines = timelines_of(c);
  const auto labels = c.values<Index>("in/labels");
  const auto features = all_features<S>(c, "joints");
  std::vector<ml::MttMotion<S>> motions;
  auto label = labels.begin();
  for (std::size_t m = 0; m < features.size(); ++m) {
    const auto end = label + std::ssize(timelines[m].intervals);
    motions.push_back({timelines[m], {label, end}, features[m]});
    label = end;
  }
  for (const bool one_text : {false, true}) {
    const auto s =
        ml::mtt_scores(std::span<const ml::MttMotion<S>>(motions), reference, encode, {.one_text = one_text});
    const std::string prefix = one_text ? "onetext_" : "";
    c.out_scalar(prefix + "r1", s.r1);
    c.out_scalar(prefix + "r3", s.r3);
    c.out_scalar(prefix + "m2t", s.m2t);
    c.out_scalar(prefix + "m2m", s.m2m);
    c.out_scalar(prefix + "fid", s.fid);
    c.out_scalar(prefix + "transition", s.transition);
  }
  const auto truth = ml::mtt_ground_truth(reference);
  c.out_scalar("gt_r1", truth.r1);
  c.out_scalar("gt_r3", truth.r3);
  c.out_scalar("gt_m2t", truth.m2t);
  c.out_scalar("gt_transition", truth.transition);
}

const Registration generated{"mtt generation", "double", generation};
const Registration crops{"mtt realism crops", "double", realism_crops};
const Registration features64{"mtt features", "double", features<double>};
const Registration features32{"mtt features", "float", features<float>};
const Registration local64{"mtt local joints", "double", local_joints<double>};
const Registration local32{"mtt local joints", "float", local_joints<float>};
const Registration points{"mtt transition points", "double", transition_points};
const Registration distance64{"mtt transition distance", "double", transition_distance<double>};
const Registration distance32{"mtt transition distance", "float", transition_distance<float>};
const Registration latents64{"mtt metrics from latents", "double", metrics_from_latents<double>};
const Registration latents32{"mtt metrics from latents", "float", metrics_from_latents<float>};
const Registration motions64{"mtt metrics from motions", "double", metrics_from_motions<double>};
const Registration motions32{"mtt metrics from motions", "float", metrics_from_motions<float>};

}  // namespace
