// SPDX-License-Identifier: MIT
/// Measures how well TMR finds moments: the place of each text in long motions. These are sequences of BABEL, as in the
/// thesis, or are made of clips of different texts.
///
///     const MomentFigures f = moment_figures(tmr, data.width, data.test, {.motions = 100});
///     for (const MomentAnswers& a : f.answers) use(a.windows, localisation_accuracy(a.found, f.wanted, 0.4));
///
/// Joined clips follow each other as features, which describe the movement from frame to frame and no absolute place.
/// So paths join, but the pose jumps. A window is a range of these frames around a middle (metrics/retrieval.hpp). The
/// answer is the window whose latent is most similar to that of the text.
///
/// Source  TMR (Petrovich, Black, Varol, ICCV 2023), section 4.4; thesis 5.3.6 with windows of 20, 40 and 60 frames.
///         The other lengths and the stride are choices made here
#pragma once

#include <algorithm>  // max
#include <cmath>      // lround
#include <cstdint>    // seed
#include <set>        // texts
#include <span>       // windows
#include <string>     // texts
#include <vector>     // rows

#include <motionlang/core/progress.hpp>
#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/metrics/retrieval.hpp>
#include <motionlang/search/tmr_search_encoder.hpp>
#include <motionlang/search/unit_rows.hpp>
#include <motionlang/train/shared_items.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Several clips as one motion.
struct JoinedClips {
  std::vector<float> rows;            // of features
  std::vector<FrameSlice> stretches;  // frames of each text
  std::vector<std::string> texts;
};
/// Joins random clips, no two of one text. It joins fewer if a thousand draws find no other text.
/// width  values of a frame
JoinedClips join_random_clips(const std::vector<DescribedMotion>& motions, Index width, Index clips, Philox rng);

/// A sequence with its texts in the same form.
JoinedClips as_joined(const DescribedMotion& sequence);

struct MomentEvaluationOptions {
  Index motions = 100;                         // to make
  Index joined = 5;                            // clips in each
  std::vector<double> windows{1, 2, 3, 4, 6};  // seconds of the windows
  double stride = 0.2;                         // seconds from one window to the next
  std::uint64_t seed = 0;
  AnyCommunicator communicator{};  // processes that share the motions; all get the figures of all
};
/// Answers to all queries.
struct MomentAnswers {
  std::string windows;  // "2 s", "all lengths" or "a random window"
  std::vector<FrameSlice> found;
};
struct MomentFigures {
  std::vector<FrameSlice> wanted;  // of each text of each motion
  std::vector<MomentAnswers> answers;
};

/// motion(k, rng)   the k-th long motion, in the model's features, not normalised
/// Throws           cancelled
template <Backend B, class Make>
MomentFigures moment_figures_of(const TmrSearchEncoder<B>& tmr, Index motions, Make motion_of,
                                const MomentEvaluationOptions& options, Progress progress = {}) {
  const auto frames_of = [&](double seconds) { return std::max<Index>(1, std::lround(seconds * tmr.model().fps)); };
  MomentFigures out;
  for (const double seconds : options.windows) out.answers.push_back({concat_text(seconds, " s"), {}});
  out.answers.push_back({"all lengths", {}});
  MomentAnswers chance{"a random window", {}};
  const auto of_motion = [&](Index k, const Progress&) {
    MessageWriter message;
    auto rng = Philox{.seed = options.seed}.split("moments").split(static_cast<std::uint64_t>(k));
    const JoinedClips motion = motion_of(k, rng);
    const auto rows = tmr.normalised(motion.rows);
    std::vector<FrameSlice> windows;
    std::vector<std::size_t> ends;  // of the windows of each length
    for (const double seconds : options.windows) {
      const auto own = moment_windows(tmr.frames(rows), frames_of(seconds), frames_of(options.stride));
      windows.insert(windows.end(), own.begin(), own.end());
      ends.push_back(windows.size());
    }
    const auto latent = static_cast<std::size_t>(tmr.model().width);
    const auto moments = unit_rows(tmr.encode_windows(rows, windows), tmr.model().width),
               texts = unit_rows(tmr.encode_texts(motion.texts), tmr.model().width);
    for (std::size_t t = 0; t < motion.texts.size(); ++t) {
      std::vector<FrameSlice> found{motion.stretches[t]};
      std::vector<double> alike(windows.size());
      for (std::size_t w = 0; w < windows.size(); ++w) {
        for (std::size_t c = 0; c < latent; ++c)
          alike[w] += static_cast<double>(texts[t * latent + c] * moments[w * latent + c]);
      }
      const auto best = [&](std::size_t begin, std::size_t end) {
        return best_moment(std::span(windows).subspan(begin, end - begin),
                           std::span(alike).subspan(begin, end - begin));
      };
      for (std::size_t i = 0; i < ends.size(); ++i) found.push_back(best(i == 0 ? 0 : ends[i - 1], ends[i]));
      found.push_back(best(0, windows.size()));
      found.push_back(windows[rng.below(static_cast<std::uint32_t>(windows.size()))]);
      message.list(std::span<const FrameSlice>(found));
    }
    return message.bytes();
  };
  for (const std::string& message : shared_items(options.communicator, motions, of_motion, progress)) {
    for (MessageReader in(message); !in.at_end();) {  // the texts of a motion
      const auto found = in.list<FrameSlice>();
      out.wanted.push_back(found.front());
      for (std::size_t i = 0; i < out.answers.size(); ++i) out.answers[i].found.push_back(found[1 + i]);
      chance.found.push_back(found.back());
    }
  }
  out.answers.push_back(std::move(chance));
  return out;
}

/// Joined clips. part: motions, of which only the first text counts; in the model's features, not normalised
/// width   values of a frame
/// Throws  config_error 101 for fewer than two different texts; cancelled
template <Backend B>
MomentFigures moment_figures(const TmrSearchEncoder<B>& tmr, Index width, const std::vector<DescribedMotion>& part,
                             const MomentEvaluationOptions& options, Progress progress = {}) {
  return moment_figures_of(
      tmr, options.motions,
      [&](Index, const Philox& rng) {
        auto motion = join_random_clips(part, width, options.joined, rng.split("clips"));
        if (std::ssize(motion.texts) < 2) raise<config_error>(101, "moment_figures: fewer than two different texts");
        return motion;
      },
      options, progress);
}

/// Sequences, each with several texts about some of its frames: read_babel_sequences. Every text is a query in its own
/// sequence. Throws cancelled.
template <Backend B>
MomentFigures sequence_moment_figures(const TmrSearchEncoder<B>& tmr, const std::vector<DescribedMotion>& sequences,
                                      const MomentEvaluationOptions& options, Progress progress = {}) {
  return moment_figures_of(
      tmr, std::ssize(sequences),
      [&](Index k, const Philox&) { return as_joined(sequences[static_cast<std::size_t>(k)]); }, options, progress);
}

/// Percent of the texts whose answer overlaps the right place by at least 0.1, 0.2, ... 0.7 (intersection over
/// union), for each length of windows, below a header.
std::string moments_table(const MomentFigures& figures);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/moment_evaluation.ipp>
#endif
