// SPDX-License-Identifier: MIT
// Bodies of mtt_evaluation.hpp.
#pragma once

#include <cstdio>   // numbers
#include <numbers>  // pi

#include <motionlang/datasets/mtt_motions.hpp>
#include <motionlang/features/smplrifke.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/train/mtt_evaluation.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<MttRun> mtt_method_runs(double overlap) {
  return {{"one text", StmcMode::one_text, overlap},
          {"DiffCollage, single track", StmcMode::single_track, overlap},
          {"SINC without lerp", StmcMode::sinc, overlap},
          {"SINC with lerp", StmcMode::sinc_lerp, overlap},
          {"STMC", StmcMode::stmc, overlap}};
}

MOTIONLANG_BODY std::vector<MttRun> mtt_overlap_runs(std::span<const double> overlaps) {
  std::vector<MttRun> out;
  for (const double seconds : overlaps)
    out.push_back({concat_text("STMC, overlap ", seconds, " s"), StmcMode::stmc, seconds});
  return out;
}

MOTIONLANG_BODY std::vector<double> mtt_features_of_rows(std::string_view layout, std::span<const double> rows) {
  const ChainSkeleton& skeleton = humanml3d_chains();
  if (layout == "smplrifke") {
    const auto motion = smplrifke_inverse(rows, {.first_angle = std::numbers::pi});
    return mtt_features(skeleton, std::span<const Vec3<double>>(motion.joints), smplrifke_joints, true);
  }
  if (layout == "guoh3dfeats" && std::ssize(rows) % Guoh3dSlots{}.size() == 0) {
    const auto joints = guoh3d_joints(rows);
    return mtt_features(skeleton, std::span<const Vec3<double>>(joints), Guoh3dSlots{}.joints, false);
  }
  raise<config_error>(102, "mtt_features_of_rows: features '", layout,
                      "' are neither STMC's (smplrifke) nor HumanML3D's (guoh3dfeats of 263 numbers)");
}

MOTIONLANG_BODY std::vector<double> mtt_features_of_recorded(std::span<const Vec3<double>> joints) {
  return mtt_features(humanml3d_chains(), joints, Guoh3dSlots{}.joints, false);
}

MOTIONLANG_BODY std::vector<std::vector<double>> mtt_features_of_recordings(const FilePath& list,
                                                                            const FilePath& folder, std::size_t texts) {
  const auto clips = parse_mtt_motions(read_file(list), list.string());
  if (clips.size() != texts)
    raise<config_error>(102, list.string(), ": ", counted(clips.size(), "clip"), " for ", counted(texts, "text"));
  std::vector<std::vector<double>> out;
  out.reserve(clips.size());
  for (const MttClip& clip : clips) out.push_back(mtt_features_of_recorded(read_mtt_motion(folder, clip)));
  return out;
}

MOTIONLANG_BODY void require_mtt_judge(std::string_view features, double fps, std::string_view folder) {
  if (features != "guoh3d" || fps != 20)
    raise<config_error>(102, folder, ": a model of features '", features, "' at ", fps,
                        " frames per second; timelines are measured by one of HumanML3D's, guoh3d at 20");
}

MOTIONLANG_BODY MttRow mtt_recorded_row(const MttReference<double>& reference) {
  const MttScores scores = mtt_ground_truth(reference);
  return {.name = "recorded", .recorded = true, .as_coded = scores, .as_written = scores};
}

MOTIONLANG_BODY TableStyle parse_table_style(std::string_view name, std::string_view where) {
  constexpr std::string_view names[] = {"text", "markdown", "latex", "csv"};
  for (std::size_t i = 0; i < std::size(names); ++i) {
    if (name == names[i]) return static_cast<TableStyle>(i);
  }
  raise<config_error>(103, where, " '", name, "' is not one of ", join_text(names));
}

namespace detail {

inline constexpr std::size_t mtt_columns = 6;
inline constexpr const char* mtt_headers[mtt_columns] = {"R@1 %", "R@3 %", "M2T", "M2M", "FID+", "trans. cm"};

/// The cells of a row: tracks, crops, and the numbers with as many decimals as the paper gives them.
inline std::vector<std::string> mtt_cells(const MttRow& row, MttFlavour flavour) {
  const auto number = [](double x, int decimals) {
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", decimals, x);
    return std::isnan(x) ? std::string("-") : std::string(text);
  };
  const MttScores& s = row.scores(flavour);
  return {row.recorded ? "-"
          : row.tracks ? "multi"
                       : "single",
          row.recorded ? "-"
          : row.crops  ? "multi"
                       : "single",
          number(100 * s.r1, 1),
          number(100 * s.r3, 1),
          number(s.m2t, 3),
          number(s.m2m, 3),
          number(s.fid, 3),
          number(100 * s.transition, 1)};
}

/// A line of columns of fixed width.
inline std::string mtt_text_line(const std::string& name, const std::vector<std::string>& cells) {
  char text[64];
  std::snprintf(text, sizeof text, "  %-28s", name.c_str());
  std::string out = text;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    std::snprintf(text, sizeof text, i < 2 ? "  %-6s" : " %9s", cells[i].c_str());
    out += text;
  }
  return out + '\n';
}

inline std::string mtt_line(const std::string& name, const std::vector<std::string>& cells, TableStyle style) {
  if (style == TableStyle::text) return mtt_text_line(name, cells);
  const bool markdown = style == TableStyle::markdown, latex = style == TableStyle::latex;
  const char* const between = markdown ? " | " : latex ? " & " : ",";
  std::string out = markdown ? "| " : "";
  // LaTeX as the published program prints it: the name in 32 columns.
  char padded[64];
  std::snprintf(padded, sizeof padded, "%-32s", name.c_str());
  out += latex ? padded : style == TableStyle::csv ? '"' + name + '"' : name;
  for (const std::string& cell : cells) out += between + cell;
  return out + (markdown ? " |\n" : latex ? " \\\\\n" : "\n");
}

}  // namespace detail

MOTIONLANG_BODY std::string mtt_table(std::span<const MttRow> rows, const MttTableOptions& options) {
  const bool latex = options.style == TableStyle::latex;
  std::vector<std::string> header{"tracks", "crops"};
  header.insert(header.end(), std::begin(detail::mtt_headers), std::end(detail::mtt_headers));
  if (latex) header = {"R1", "R3", "M2T S", "M2M S", "FID+", "Trans."};
  std::string out = detail::mtt_line(latex ? "name" : "method", header, options.style);
  if (options.style == TableStyle::markdown) {
    out += "| ---";
    for (std::size_t i = 0; i < header.size(); ++i) out += " | ---";
    out += " |\n";
  }
  for (const MttRow& row : rows) {
    auto cells = detail::mtt_cells(row, options.flavour);
    if (latex) cells.erase(cells.begin(), cells.begin() + 2);
    out += detail::mtt_line(row.name, cells, options.style);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
