// Golden functions: position errors of TEMOS, TEACH and SINC, and the jump between two actions.
#include <motionlang/metrics/ape_ave.hpp>

#include "geometry.hpp"

namespace {

using golden::Case, golden::Registration;
using golden::out_list, golden::vectors, golden::Vectors, golden::view;
namespace ml = motionlang;
using ml::Index;

template <class S>
std::span<const ml::Vec3<S>> joints_view(const Vectors<S>& joints) {
  return joints;
}
std::string numbered(const std::string& name, Index i) { return name + "_" + std::to_string(i); }

/// TEMOS' joints are in millimetres, except those of "mmmns".
template <class S>
S unit_of(const Case& c) {
  const bool metres = c.config().value_or("jointstype", std::string("mmm")) == "mmmns";
  return c.config().value_or("force_in_meter", false) && !metres ? S(0.001) : S(1);
}
template <class S>
ml::ApeAveMetric<S> temos_metric(const Case& c) {
  return ml::ApeAveMetric<S>(ml::temos_rifke(), unit_of<S>(c));
}

void out_means(Case& c, const std::string& prefix, const ml::ApeAve& errors) {
  for (const auto& [kind, e] : {std::pair{"APE_", errors.ape}, {"AVE_", errors.ave}}) {
    c.out_scalar(prefix + kind + "root", e.root);
    c.out_scalar(prefix + kind + "traj", e.trajectory);
    c.out_scalar(prefix + kind + "mean_pose", e.mean_local());
    c.out_scalar(prefix + kind + "mean_joints", e.mean_joints());
  }
}

/// Four tensors of a motion cut to `frames`, under these names.
template <class S>
void out_parts(Case& c, const ml::CanonicalMotion<S>& motion, Index frames, const std::array<std::string, 4>& names) {
  auto cut = [&](auto list) {
    list.resize(list.size() / static_cast<std::size_t>(motion.frames()) * static_cast<std::size_t>(frames));
    return list;
  };
  out_list<S>(c, names[0], cut(motion.joints));
  out_list<S>(c, names[1], cut(motion.local));
  out_list<S>(c, names[2], cut(motion.root));
  std::vector<S> trajectory;
  for (const auto& p : cut(motion.trajectory)) trajectory.insert(trajectory.end(), p.begin(), p.end());
  c.out(names[3], {frames, 2}, trajectory);
}

template <class S>
void temos_metrics(Case& c) {
  auto metric = temos_metric<S>(c);
  for (Index i = 0; i < c.config()["sequences"].as<Index>(); ++i) {
    const auto generated = vectors<S>(c, numbered("generated", i)), reference = vectors<S>(c, numbered("reference", i));
    metric.add(generated, reference);
    if (i > 0) continue;
    const auto a = ml::canonical_motion(ml::temos_rifke(), joints_view(generated), unit_of<S>(c));
    const auto b = ml::canonical_motion(ml::temos_rifke(), joints_view(reference), unit_of<S>(c));
    for (const auto& [side, motion] : {std::pair{"generated_", &a}, {"reference_", &b}}) {
      const std::string s = side;
      out_parts(c, *motion, std::min(a.frames(), b.frames()),
                {s + "joints", s + "poses_local", s + "root", s + "traj"});
    }
  }
  out_means(c, "", metric.result());
}

template <class S>
void temos_samples(Case& c) {
  const Index samples = c.config()["samples"].as<Index>();
  auto best = temos_metric<S>(c), worst = best;
  std::vector<ml::ApeAveMetric<S>> each(static_cast<std::size_t>(samples), best);
  for (Index i = 0; i < c.config()["sequences"].as<Index>(); ++i) {
    const auto reference = vectors<S>(c, numbered("reference", i));
    std::vector<Vectors<S>> generated;
    for (Index s = 0; s < samples; ++s) generated.push_back(vectors<S>(c, numbered(numbered("generated", i), s)));
    const std::vector<std::span<const ml::Vec3<S>>> views(generated.begin(), generated.end());
    best.add_best(views, reference);
    worst.add_worst(views, reference);
    for (std::size_t s = 0; s < each.size(); ++s) each[s].add(views[s], reference);
  }
  out_means(c, "best/", best.result());
  out_means(c, "worst/", worst.result());
  std::vector<ml::ApeAve> results;
  for (const auto& metric : each) results.push_back(metric.result());
  out_means(c, "avg/", ml::mean_errors(results));
}

template <class S>
void temos_padded(Case& c) {
  auto metric = temos_metric<S>(c);
  const auto generated = vectors<S>(c, "generated"), reference = vectors<S>(c, "reference");
  const auto lengths = c.values<Index>("in/lengths");
  const std::size_t clip = generated.size() / lengths.size();
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    metric.add_padded(joints_view(generated).subspan(i * clip, clip), joints_view(reference).subspan(i * clip, clip),
                      lengths[i]);
  }
  out_means(c, "", metric.result());
}

/// TEACH's and SINC's cases name clips alike; only TEACH's hold the steps in between.
template <class S, class Variant>
void clip_metrics(Case& c, Variant variant) {
  ml::ApeAveMetric<S> metric(variant);
  for (Index i = 0; c.has("in/" + numbered("generated", i)); ++i) {
    const auto generated = vectors<S>(c, numbered("generated", i)), reference = vectors<S>(c, numbered("reference", i));
    metric.add(generated, reference);
    if (!c.wants(numbered("rifke", i))) continue;
    const auto features = ml::rifke_features(variant, joints_view(generated)).features;
    const auto motion = ml::canonical_motion(variant, joints_view(generated));
    c.out(numbered("rifke", i), {motion.frames(), variant.size()}, features);
    out_list<S>(c, numbered("rifke_inverse", i), motion.joints);
    const Index frames = std::min(motion.frames(), std::ssize(reference) / variant.joints);
    out_parts(c, motion, frames,
              {numbered("joints", i), numbered("local", i), numbered("root", i), numbered("trajectory", i)});
  }
  const auto errors = metric.result();
  out_means(c, "", errors);
  for (const auto& [kind, e] : {std::pair{"APE_", errors.ape}, {"AVE_", errors.ave}}) {
    c.out(std::string(kind) + "pose", e.local);
    c.out(std::string(kind) + "joints", e.joints);
  }
}
template <class S>
void teach_metrics(Case& c) {
  clip_metrics<S>(c, ml::temos_rifke());
}
template <class S>
void sinc_metrics(Case& c) {
  clip_metrics<S>(c, ml::sinc_rifke());
}

template <class S>
void teach_transition(Case& c) {
  const auto lengths = c.values<Index>("in/length_0");
  double sum = 0;
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    const auto joints = vectors<S>(c, numbered("joints", static_cast<Index>(k)));
    sum += ml::transition_distance(joints_view(joints), c.shape("in/joints_" + std::to_string(k))[1], lengths[k]);
  }
  c.out_scalar("distance", sum / static_cast<double>(lengths.size()));
}

const Registration metrics64{"temos metrics", "double", temos_metrics<double>};
const Registration metrics32{"temos metrics", "float", temos_metrics<float>};
const Registration samples64{"temos metrics of several samples", "double", temos_samples<double>};
const Registration samples32{"temos metrics of several samples", "float", temos_samples<float>};
const Registration padded64{"temos metrics of a padded batch", "double", temos_padded<double>};
const Registration padded32{"temos metrics of a padded batch", "float", temos_padded<float>};
const Registration teach64{"teach ape and ave", "double", teach_metrics<double>};
const Registration teach32{"teach ape and ave", "float", teach_metrics<float>};
const Registration sinc64{"sinc ape and ave", "double", sinc_metrics<double>};
const Registration sinc32{"sinc ape and ave", "float", sinc_metrics<float>};
const Registration jump64{"teach transition distance", "double", teach_transition<double>};
const Registration jump32{"teach transition distance", "float", teach_transition<float>};

}  // namespace
