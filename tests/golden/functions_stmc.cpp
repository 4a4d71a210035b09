// Golden functions: stitching, steps and whole chains of STMC, on its own denoiser and on MDM and MotionDiffuse.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/compose/baselines.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/features/guoh3d.hpp>
#include <motionlang/systems/sinc_baseline.hpp>

#include "models.hpp"
#include "timelines.hpp"

namespace {

using golden::Case, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

ml::BatchPlan plan_of(const Case& c) { return golden::planned(c, golden::timelines_of(c), golden::plan_options(c)); }
/// SINC's plan: neither extensions nor transition crops.
ml::BatchPlan hard_cuts(const Case& c) {
  auto options = golden::plan_options(c);
  options.extend = options.transition_crops = false;
  return golden::planned(c, golden::timelines_of(c), options);
}

template <ml::Backend B>
void stitching(Case& c) {
  const auto plan = plan_of(c);
  const auto rows = ml::CropRows::of(plan);
  const auto shape = c.shape("in/crops");
  std::vector<Index> lengths;
  for (Index i = 0; i < rows.offsets.count(); ++i) lengths.push_back(rows.offsets.length(i));
  const auto crops = ml::from_padded(tensor<B, 3>(c, "in/crops"), std::span<const Index>(lengths));
  const ml::Stitcher<B> stitch(plan, golden::layout_of(c), crops.offsets, plan.frames);
  const auto composite = stitch(crops.rows);
  c.out("composite", {std::ssize(plan.timelines), plan.frames, shape.back()}, composite.span());
}

template <ml::Backend B>
void interpolation(Case& c) {
  const auto plan = hard_cuts(c);
  const auto motion = golden::rows<B>(c, "in/motion");
  const auto out = ml::interpolate_transitions(plan, golden::layout_of(c), motion, c.shape("in/motion")[1]);
  c.out("motion", c.shape("in/motion"), out.span());
}

/// (timelines, frames, features) with zeros behind the end of each timeline; `stride` rows of x per timeline.
template <ml::Backend B>
ml::Tensor<B, 3> ends_cut(const ml::Tensor<B, 2>& x, const ml::BatchPlan& plan, Index stride) {
  std::vector<Index> lengths;
  for (const auto& p : plan.timelines) lengths.push_back(p.frames);
  const auto all = ml::reshape<3>(x, {std::ssize(plan.timelines), stride, x.size(1)});
  return ml::to_padded(ml::from_padded(all, std::span<const Index>(lengths)), 0, plan.frames);
}

template <ml::Backend B>
ml::TextFeatures<B> normalised(const golden::MdmSmplModel<B>& m, ml::TextFeatures<B> text) {
  text.tokens.rows = m.text_normalizer.normalize(text.tokens.rows);
  return text;
}

template <ml::Backend B>
void single_step(Case& c) {
  const auto m = golden::mdm_smpl_model<B>(c);
  const auto d = golden::diffusion_of(c.config());
  const auto t = c.config()["t"].as<Index>();
  const ml::Collage<B, ml::MdmSmplDenoiser<B>> collage(
      m.denoiser, plan_of(c), golden::layout_of(c), normalised(m, golden::text_features<B>(c)),
      normalised(m, golden::one_text<B>(c, "in/text_empty")), c.config()["guidance"].as<double>());
  const auto x = golden::rows<B>(c, "in/x_t");
  const auto s = collage.step(x, t);
  std::vector<Index> lengths;
  const auto& offsets = collage.crop_offsets();
  for (Index i = 0; i < offsets.count(); ++i) lengths.push_back(offsets.length(i));
  c.out("lengths", lengths);
  auto crops = [&](const std::string& name, const ml::Tensor<B, 2>& rows) {
    golden::out(c, name, ml::to_padded(ml::Sequences<B>(rows, offsets)));
  };
  crops("crops", s.crops);
  crops("cond", s.cond);
  crops("null", s.null);
  crops("guided", s.guided);
  const auto step = ml::ancestral_step(d, x, s.x0, golden::rows<B>(c, "noise/000"), std::span(&t, 1),
                                       {.noise_scale = golden::noise_scale_of(c.config())});
  auto motion = [&](const std::string& name, const ml::Tensor<B, 2>& rows) {
    golden::out(c, name, ends_cut(rows, collage.plan(), collage.stride()));
  };
  motion("composite", step.x0);
  motion("mean", step.mean);
  motion("x_prev", step.x_prev);
}

/// The texts of a chain with the vectors that its file has for them.
template <ml::Backend B>
struct TextsOfCase {
  std::map<std::string, ml::TextFeatures<B>> features;

  template <ml::Backend C>
  requires std::same_as<C, B> ml::TextFeatures<C> encode(std::span<const std::string> texts)
  const {
    ml::TextFeatures<B> out;
    std::vector<ml::Tensor<B, 2>> rows;
    std::vector<Index> lengths;
    for (const std::string& text : texts) {
      const auto& f = features.at(text);
      rows.push_back(f.tokens.rows);
      lengths.push_back(rows.back().size(0));
      out.end_position.insert(out.end_position.end(), f.end_position.begin(), f.end_position.end());
    }
    out.tokens = {ml::concat(std::span<const ml::Tensor<B, 2>>(rows), 0), ml::Offsets(lengths)};
    return out;
  }
};
/// `text` has those of every interval in order, equal texts equal ones.
template <ml::Backend B>
TextsOfCase<B> texts_of(const ml::BatchPlan& plan, const ml::TextFeatures<B>& text, const ml::TextFeatures<B>& null) {
  TextsOfCase<B> out{{{"", null}}};
  Index next = 0;
  for (const auto& p : plan.timelines) {
    for (const auto& i : p.timeline.intervals)
      out.features.emplace(i.text, ml::gather(text, std::vector<Index>{next++}));
  }
  return out;
}

/// A chain of the system over any denoiser: the noise as the system wants it, the outputs that all hosts share.
template <ml::Backend B, class D>
struct Host {
  Case& c;
  ml::Stmc<B, D, TextsOfCase<B>> stmc;
  std::function<ml::Tensor<B, 3>(const std::string&)> noise;  // a file's noise as (sequences, frames, features)

  /// Returns the motions, zero behind their ends, and hands over x_after_..., first_composite and x0 through `out`.
  template <class Out>
  ml::Tensor<B, 3> run(const ml::BatchPlan& plan, const Out& out) const {
    const auto config = c.config();
    const auto prediction =
        config.contains("prediction") ? golden::prediction_of(config) : stmc.denoiser.traits().prediction;
    const auto mode = config.value_or("mode", std::string("none"));
    const auto z_of = [&](Index draw, const ml::Shape& shape) {  // a crop never reads rows that the file does not have
      const auto z = noise(golden::noise_name(draw));
      const Index more = shape[1] - z.size(1);
      return more <= 0 ? ml::slice(z, 1, 0, shape[1])
                       : ml::concat(1, z, ml::Tensor<B, 3>::zeros({z.size(0), more, z.size(2)}));
    };
    const auto watched = [&](const ml::Collage<B, D>& collage, const auto&, const ml::Tensor<B, 2>& x, Index t) {
      const auto cut = [&](const ml::Tensor<B, 2>& rows) { return ends_cut(rows, collage.plan(), collage.stride()); };
      const bool first = t + 1 == stmc.diffusion.steps();
      if (!first) out("x_after_" + golden::three_digits(t + 1), cut(x));
      const auto x0 = ml::clean_motion(collage, stmc.diffusion, prediction, x, t);
      if (first) out("first_composite", cut(x0));
      if (t == 0) out("x0", cut(x0)), out("x_after_000", cut(x0));
      return x0;
    };
    const ml::StmcOptions options{.guidance = config["guidance"].template as<double>(),
                                  .sampling = ml::SamplingOptions{.noise_scale = golden::noise_scale_of(config)}};
    const bool sinc = mode == "sinc" || mode == "sinc_lerp";
    const auto cuts = mode == "sinc" ? ml::SincCuts::hard : ml::SincCuts::interpolated;
    const auto motions = sinc ? ml::sinc_baseline_from(stmc, plan, z_of, options, cuts, watched)
                              : stmc.generate_from(plan, z_of, options, watched);
    std::vector<Index> lengths;
    for (const auto& m : motions) lengths.push_back(m.size(0));
    if (c.wants("n_frames")) c.out("n_frames", lengths);
    return ml::to_padded(
        ml::Sequences<B>(ml::concat(std::span<const ml::Tensor<B, 2>>(motions), 0), ml::Offsets(lengths)));
  }
};

/// singletrack and onetext: the original file in seconds, converted, written, read again in frames.
std::vector<ml::Timeline> converted(Case& c) {
  std::vector<ml::TimelineInSeconds> out;
  const bool single = c.config()["mode"].as<std::string>() == "singletrack";
  for (const auto& t : ml::parse_timelines_in_seconds(c.text().as<std::string>(), {.as_published = true})) {
    out.push_back(single ? ml::single_track(t) : ml::one_text(t));
  }
  const auto timelines =
      ml::parse_timelines(ml::write_timelines(out), {.fps = c.config()["fps"].as<double>(), .as_published = true});
  std::vector<Index> intervals;
  std::string texts;
  for (const auto& t : timelines) {
    for (const auto& i : t.intervals) {
      intervals.insert(intervals.end(), {i.start, i.end});
      texts += (texts.empty() ? "" : "\n") + i.text;
    }
  }
  c.out("intervals", {std::ssize(intervals) / 2, 2}, intervals);
  c.out_text("texts_utf8", texts);
  return timelines;
}

/// MDM-SMPL with the statistics of the case.
template <ml::Backend B>
Host<B, ml::MdmSmplDenoiser<B>> mdm_smpl_host(Case& c, const ml::BatchPlan& plan, const ml::FeatureLayout& layout) {
  const auto m = golden::mdm_smpl_model<B>(c);
  return {.c = c,
          .stmc = {.denoiser = m.denoiser,
                   .text_encoder = texts_of(plan, golden::text_features<B>(c), golden::one_text<B>(c, "in/text_empty")),
                   .motion_normalizer = m.motion_normalizer,
                   .text_normalizer = m.text_normalizer,
                   .diffusion = golden::diffusion_of(c.config()),
                   .layout = layout},
          .noise = [&c](const std::string& name) { return tensor<B, 3>(c, name); }};
}
/// The other denoisers, whose chains end in normalised features.
template <ml::Backend B, class D>
ml::Stmc<B, D, TextsOfCase<B>> without_statistics(const Case& c, const D& denoiser, const TextsOfCase<B>& texts,
                                                  const ml::FeatureLayout& layout) {
  return {.denoiser = denoiser,
          .text_encoder = texts,
          .motion_normalizer = ml::Normalizer<B>::identity(layout.size),
          .text_normalizer = ml::Normalizer<B>::identity(texts.features.begin()->second.tokens.rows.size(1)),
          .diffusion = golden::diffusion_of(c.config()),
          .layout = layout};
}

/// SINC's modes cut hard.
bool is_independent(const Case& c) { return c.config().value_or("mode", std::string("none")).starts_with("sinc"); }

template <ml::Backend B>
void chain(Case& c) {
  const auto mode = c.config()["mode"].as<std::string>();
  const auto plan = is_independent(c) ? hard_cuts(c)
                    : mode == "singletrack" || mode == "onetext"
                        ? golden::planned(c, converted(c), golden::plan_options(c))
                        : plan_of(c);
  const auto motion =
      mdm_smpl_host<B>(c, plan, golden::layout_of(c))
          .run(plan, [&](const std::string& name, const ml::Tensor<B, 3>& t) { golden::out_if_wanted(c, name, t); });
  golden::out(c, "motion", motion);
}

/// Plain text to motion: every text is a timeline of its own.
ml::BatchPlan one_timeline_each(std::span<const Index> lengths) {
  std::vector<ml::Timeline> out;
  for (std::size_t i = 0; i < lengths.size(); ++i)
    out.push_back({{{std::to_string(i), 0, lengths[i], ml::BodyParts::all()}}});
  return ml::plan_timelines(out);
}
/// All features belong to one part: nothing is composed.
ml::FeatureLayout whole_layout(Index features) {
  return ml::FeatureLayout::from_owner("whole", features, [](Index) { return ml::BodyPart::legs; });
}

template <ml::Backend B>
void text_chain(Case& c) {
  const auto plan = one_timeline_each(c.values<Index>("in/lengths"));
  const auto motion = mdm_smpl_host<B>(c, plan, whole_layout(c.config()["nfeats"].as<Index>()))
                          .run(plan, [&](const std::string& name, const ml::Tensor<B, 3>& t) {
                            golden::out_if_wanted(c, name == "x0" ? "x0_normalised" : name, t);
                          });
  golden::out(c, "motion", motion);
}

template <ml::Backend B>
ml::Tensor<B, 3> mdm_noise(const Case& c, const std::string& name) {
  const auto s = c.shape(name);
  return ml::reshape<3>(golden::mdm_rows(tensor<B, 4>(c, name)), {s[0], s[3], s[1] * s[2]});
}
template <ml::Backend B>
void out_mdm(Case& c, const std::string& name, const ml::Tensor<B, 3>& t) {
  if (!c.wants(name)) return;
  const auto s = c.shape("out/" + name);
  golden::out(c, name,
              golden::mdm_layout(ml::reshape<2>(t, {t.size(0) * t.size(1), t.size(2)}), {s[0], s[1], s[2], t.size(1)}));
}
/// Runs a chain on MDM; hands over the motion in its layout and returns it.
template <ml::Backend B>
ml::Tensor<B, 3> run_mdm(Case& c, const ml::BatchPlan& plan) {
  const auto m = golden::mdm_model<B>(c);
  const auto text = golden::text_features<B>(c);
  const auto null = golden::zero_text(ml::gather(text, std::vector<Index>{0}));
  const Host<B, ml::MdmDenoiser<B>> host{
      .c = c,
      .stmc = without_statistics<B>(c, m, texts_of(plan, text, null), ml::guoh3dfeats_layout()),
      .noise = [&](const std::string& name) { return mdm_noise<B>(c, name); }};
  const auto out = [&](const std::string& name, const ml::Tensor<B, 3>& t) { out_mdm(c, name, t); };
  const auto motion = host.run(plan, out);
  out("motion", motion);
  return motion;
}
template <ml::Backend B>
ml::Tensor<B, 3> run_motiondiffuse(Case& c, const ml::BatchPlan& plan, const ml::TextFeatures<B>& null) {
  const auto m = golden::motiondiffuse_model<B>(c);
  const Host<B, ml::MotionDiffuseDenoiser<B>> host{
      .c = c,
      .stmc = without_statistics<B>(c, m, texts_of(plan, golden::clip_features<B>(c), null), ml::guoh3dfeats_layout()),
      .noise = [&](const std::string& name) { return tensor<B, 3>(c, name); }};
  const auto out = [&](const std::string& name, const ml::Tensor<B, 3>& t) { golden::out_if_wanted(c, name, t); };
  const auto motion = host.run(plan, out);
  out("motion", motion);
  return motion;
}

/// The plain loop on a whole batch: one call of the network with the texts, and if it is guided another without them.
/// noise: a file's as the frames that the network sees; out(name, those frames).
template <ml::Backend B, class D, class Noise, class Out>
void plain_chain(const Case& c, const D& denoiser, const ml::TextFeatures<B>& text, ml::Prediction prediction,
                 const Noise& noise, const Out& out) {
  const auto config = c.config();
  const auto d = golden::diffusion_of(config);
  const double w = config.value_or("guidance", 1.0);
  const auto without = golden::zero_text(text);
  const ml::Sequences<B> start = noise(golden::noise_name(0));
  auto network = [&](const ml::Tensor<B, 2>& x, Index t) {
    const std::vector<Index> steps(static_cast<std::size_t>(start.count()), d.network_t(t));
    const auto cond = denoiser(start.with(x), steps, text).rows;
    return w == 1 ? cond : ml::guide(cond, denoiser(start.with(x), steps, without).rows, w);
  };
  const auto end = ml::sample_ancestral(
      d, start.rows, network, [&](Index draw) { return noise(golden::noise_name(draw + 1)).rows; },
      {.prediction = prediction, .noise_scale = golden::noise_scale_of(config)}, ml::detail::KeepX0{}, {}, -1,
      [&](Index t, const auto& step) { out("x_after_" + golden::three_digits(t), start.with(step.x_prev)); });
  out("motion", start.with(end));
}

template <ml::Backend B>
void mdm_text_chain(Case& c) {
  const auto m = golden::mdm_model<B>(c);
  const auto shape = c.shape("noise/000");
  auto noise = [&](const std::string& name) {
    if (!m.config.mask_frames) return ml::from_equal(mdm_noise<B>(c, name));
    const auto mask = c.values<unsigned char>("in/mask");
    return ml::from_padded(mdm_noise<B>(c, name), std::span<const unsigned char>(mask));
  };
  plain_chain<B>(
      c, m, golden::mdm_condition<B>(c, m.config, shape[0]), golden::prediction_of(c.config()), noise,
      [&](const std::string& name, const ml::Sequences<B>& x) { out_mdm(c, name, ml::to_padded(x, 0, shape[3])); });
}

template <ml::Backend B>
void motiondiffuse_text_chain(Case& c) {
  const auto m = golden::motiondiffuse_model<B>(c);
  const auto lengths = c.values<Index>("in/lengths");
  const Index frames = c.shape("noise/000")[1];
  auto cut = [&](const ml::Tensor<B, 3>& x) { return ml::from_padded(x, std::span<const Index>(lengths)); };
  auto noise = [&](const std::string& name) {  // standard attention masks nothing
    const auto all = tensor<B, 3>(c, name);
    return m.config.no_eff ? ml::from_equal(all) : cut(all);
  };
  plain_chain<B>(c, m, golden::clip_features<B>(c), ml::Prediction::eps, noise,
                 [&](const std::string& name, const ml::Sequences<B>& x) {
                   golden::out_if_wanted(c, name, ml::to_padded(cut(ml::to_padded(x, 0, frames)), 0, frames));
                 });
}

/// Joints of normalised features, (timelines, frames, 22, 3), zero behind the ends.
template <ml::Backend B>
void out_joints(Case& c, const ml::Tensor<B, 3>& motion, const ml::BatchPlan& plan) {
  using S = typename B::scalar;
  const ml::Normalizer<B> statistics{tensor<B, 1>(c, "in/mean"), tensor<B, 1>(c, "in/std"), 0};
  std::vector<S> out(static_cast<std::size_t>(motion.size(0) * motion.size(1) * 66));
  for (std::size_t m = 0; m < plan.timelines.size(); ++m) {
    const auto one = ml::slice(ml::slice(motion, 0, static_cast<Index>(m), static_cast<Index>(m) + 1), 1, 0,
                               plan.timelines[m].frames);
    const auto features = statistics.denormalize(one);
    std::size_t at = m * static_cast<std::size_t>(motion.size(1)) * 66;
    for (const auto& j : ml::guoh3d_joints<S>(features.span())) out[at++] = j.x, out[at++] = j.y, out[at++] = j.z;
  }
  c.out("joints", {motion.size(0), motion.size(1), 22, 3}, out);
}

template <ml::Backend B>
void chain_on_mdm(Case& c) {
  auto plan = is_independent(c) ? hard_cuts(c) : plan_of(c);
  const auto empty = c.values<unsigned char>("in/text_is_empty");
  std::size_t next = 0;
  for (auto& p : plan.timelines) {
    for (auto& i : p.timeline.intervals) {
      if (empty.at(next++) != 0) i.text.clear();
    }
  }
  out_joints(c, run_mdm<B>(c, plan), plan);
}

template <ml::Backend B>
void chain_on_motiondiffuse(Case& c) {
  const auto plan = is_independent(c) ? hard_cuts(c) : plan_of(c);
  const auto null = golden::clip_features<B>(c, "in/clip_rows_empty", "in/end_position_empty");
  out_joints(c, run_motiondiffuse<B>(c, plan, null), plan);
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"stmc stitching", variant, stitching<B>},
          {"stmc transition interpolation", variant, interpolation<B>},
          {"stmc step", variant, single_step<B>},
          {"stmc chain", variant, chain<B>},
          {"mdm smpl text chain", variant, text_chain<B>},
          {"mdm text chain", variant, mdm_text_chain<B>},
          {"motiondiffuse text chain", variant, motiondiffuse_text_chain<B>},
          {"stmc chain on mdm", variant, chain_on_mdm<B>},
          {"stmc chain on motiondiffuse", variant, chain_on_motiondiffuse<B>}};
}
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
