// SPDX-License-Identifier: MIT
/// Measures motions made from timelines by the tables of STMC's paper, with TMR as the judge.
///
///     const TmrSearchEncoder<B> tmr(load_tmr<B>("examples/models/tmr_free"));
///     const auto texts = parse_mtt_texts(read_file("texts.txt"));
///     const auto reference = mtt_reference(tmr, texts);                        // without recorded motions
///     const MttRow row = mtt_row(tmr, reference, {.name = "STMC"}, motions);
///     use(mtt_table(std::span(&row, 1), {.flavour = MttFlavour::as_written}));
///
/// Each row has both flavours of metrics/mtt.hpp: `as_coded` compares with the published tables, `as_written` is what
/// the thesis describes.
/// Source  thesis 6.3, tables 6.1 and 6.2; STMC (Petrovich et al., CVPR workshops 2024) mtt/mtt_metrics.py
#pragma once

#include <span>         // rows
#include <string>       // names
#include <string_view>  // numbers
#include <vector>       // tables

#include <motionlang/compose/baselines.hpp>
#include <motionlang/compose/mtt_timelines.hpp>
#include <motionlang/file/file_path.hpp>
#include <motionlang/kinematics/guo_chains.hpp>
#include <motionlang/metrics/mtt.hpp>
#include <motionlang/search/tmr_search_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A way of making motions from timelines: a row of a table.
struct MttRun {
  std::string name{};
  StmcMode mode = StmcMode::stmc;
  double overlap = 0.5;  // seconds
};
/// Those of table 6.1: one text, DiffCollage on a single track, SINC without and with interpolation, STMC.
std::vector<MttRun> mtt_method_runs(double overlap = 0.5);
/// Those of table 6.2: STMC with several overlaps, in seconds.
std::vector<MttRun> mtt_overlap_runs(std::span<const double> overlaps);
/// The overlaps of table 6.2.
inline constexpr double published_overlaps[] = {0.25, 0.4, 0.5, 0.6, 0.75, 1.0, 1.25};

/// Figures of a run. Of recorded motions both flavours are the same.
struct MttRow {
  std::string name{};
  bool tracks = false;  // more than one, or one
  bool crops = false;   // several, or one
  bool recorded = false;
  MttScores as_coded{}, as_written{};

  const MttScores& scores(MttFlavour flavour) const { return flavour == MttFlavour::as_coded ? as_coded : as_written; }
};

enum class TableStyle { text, markdown, latex, csv };
/// "text", "markdown", "latex" or "csv". Throws config_error 103.
TableStyle parse_table_style(std::string_view name, std::string_view where = "table");

struct MttTableOptions {
  MttFlavour flavour = MttFlavour::as_written;
  TableStyle style = TableStyle::text;
};
/// The rows as a table with its header: R@1 and R@3 in percent, transitions in centimetres, "-" for what is not
/// measured.
std::string mtt_table(std::span<const MttRow> rows, const MttTableOptions& options);

/// The features of a model's motion as the metrics want them: HumanML3D's, of the positions that the model predicts
/// (`value_from` joints of the published programs).
/// layout  of the rows: "smplrifke" (205) or "guoh3dfeats" (263)
/// Throws  config_error 102 for another layout or width, shape_error 205
std::vector<double> mtt_features_of_rows(std::string_view layout, std::span<const double> rows);

/// The same of joints as read_mtt_motion gives them: (frames, 22), Y up.
std::vector<double> mtt_features_of_recorded(std::span<const Vec3<double>> joints);

/// The same of the recorded motion of each text.
/// list    a file as datasets/mtt_motions.hpp describes; its paths lead into `folder`
/// texts   their number. Throws config_error 102 for another number of motions, and what the readers throw
std::vector<std::vector<double>> mtt_features_of_recordings(const FilePath& list, const FilePath& folder,
                                                            std::size_t texts);

/// Throws config_error 102 unless a retrieving model reads HumanML3D's features at 20 frames per second.
void require_mtt_judge(std::string_view features, double fps, std::string_view folder);

/// The latent of a crop of features, (frames, 263), not normalised.
template <Backend B>
std::vector<float> mtt_latent(const TmrSearchEncoder<B>& tmr, const Rows<double>& crop) {
  const std::vector<float> values(crop.values().begin(), crop.values().end());
  const FrameSlice whole{0, crop.size()};
  return tmr.encode_windows(tmr.normalised(values), std::span(&whole, 1));
}

/// Latents that motions are compared with.
/// recorded  HumanML3D's features of a motion for each text, or none
/// Throws    config_error 102 for a model of other features; shape_error 204 for another number of motions
template <Backend B>
MttReference<double> mtt_reference(const TmrSearchEncoder<B>& tmr, std::span<const MttText> texts,
                                   std::vector<std::vector<double>> recorded = {}) {
  const TmrCheckpoint<B>& model = tmr.checkpoint();
  require_mtt_judge(model.features->name, model.fps, model.folder);
  if (!recorded.empty())
    detail::require_same_count("mtt_reference: texts against motions", std::ssize(texts), std::ssize(recorded));
  std::vector<std::string> said;
  for (const MttText& t : texts) said.push_back(t.text);
  const auto latents = tmr.encode_texts(said);
  MttReference<double> out{{latents.begin(), latents.end()}, {}, std::move(recorded), tmr.model().width};
  for (const auto& features : out.features) {
    for (const float x : mtt_latent(tmr, Rows(features, Guoh3dSlots{}.size())))
      out.motion_latents.push_back(static_cast<double>(x));
  }
  return out;
}

/// The row of the recorded motions.
MttRow mtt_recorded_row(const MttReference<double>& reference);

/// The row of motions that were made in a run. Their timelines are those of the data set, whatever they were made from.
template <Backend B>
MttRow mtt_row(const TmrSearchEncoder<B>& tmr, const MttReference<double>& reference, const MttRun& run,
               std::span<const MttMotion<double>> motions) {
  const auto scores = [&](MttFlavour flavour) {
    return mtt_scores(motions, reference, [&](const Rows<double>& crop) { return mtt_latent(tmr, crop); },
                      {.flavour = flavour, .one_text = run.mode == StmcMode::one_text});
  };
  const bool one_text = run.mode == StmcMode::one_text, one_track = one_text || run.mode == StmcMode::single_track;
  return {.name = run.name,
          .tracks = !one_track,
          .crops = !one_text,
          .as_coded = scores(MttFlavour::as_coded),
          .as_written = scores(MttFlavour::as_written)};
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/mtt_evaluation.ipp>
#endif
