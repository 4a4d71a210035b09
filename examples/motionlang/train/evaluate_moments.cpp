// motionlang evaluate --moments: long motions are made of clips of different texts, and TMR says where in them each
// text happens.
//
// The clips follow each other as features do, which say how the body moves from frame to frame, not where it is: paths
// join, the pose jumps. A window is a stretch of these frames around a middle (metrics/retrieval.hpp); the one whose
// latent is most like that of the text is the answer, right if its intersection with the clip over their union is large
// enough.
#include <cstdio>
#include <set>

#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/metrics/retrieval.hpp>
#include <motionlang/search/unit_rows.hpp>

#include "../progress_bar.hpp"
#include "../search/search_model.hpp"
#include "evaluate.hpp"
#include "training_command.hpp"

namespace program {

using ml::Index;

namespace {

struct LongMotion {
  std::vector<float> rows;  // of features
  std::vector<ml::FrameSlice> stretches;
  std::vector<std::string> texts;
};

/// Joins `clips` random clips, no two of one text. It joins fewer if a thousand draws find no other text.
LongMotion joined(const std::vector<ml::DescribedMotion>& motions, Index width, Index clips, ml::Philox rng) {
  LongMotion out;
  std::set<std::string> said;
  for (int tries = 0; tries < 1000 && std::ssize(out.texts) < clips; ++tries) {
    const ml::DescribedMotion& m = motions[rng.below(static_cast<std::uint32_t>(motions.size()))];
    const ml::DescribedText& t = m.texts.front();
    if (!said.insert(t.text).second) continue;
    out.stretches.push_back({std::ssize(out.rows) / width, t.frames.length});
    out.texts.push_back(t.text);
    const auto first = m.rows.begin() + t.frames.first * width;
    out.rows.insert(out.rows.end(), first, first + t.frames.length * width);
  }
  return out;
}

/// Answers to all queries by windows of one length, or of all.
struct Answers {
  std::string windows;
  std::vector<ml::FrameSlice> found;
};
constexpr double overlaps[] = {0.3, 0.4, 0.5, 0.6, 0.7};

void print(const Answers& a, std::span<const ml::FrameSlice> wanted) {
  std::printf("  %-22s", a.windows.c_str());
  for (const double least : overlaps) std::printf(" %7.2f", 100 * ml::localisation_accuracy(a.found, wanted, least));
  std::printf("\n");
}

}  // namespace

void evaluate_moments(const EvaluationOptions& o) {
  const ml::TextMotionFile file = ml::read_text_motion_config(o.model);
  const SearchModel model = search_model(o.model, o.text_encoder);
  const double fps = model.model().fps;
  auto config = file.config.data;
  config.mirror = false;
  const auto data =
      read_motions_of({o.data, o.captions, {}, o.annotations, o.splits}, config, ml::row_maker(file.config.features));
  const auto& part = data.part(o.part);
  if (part.empty()) ml::raise<ml::config_error>(101, "the part '", o.part, "' has no motions");

  std::vector<Answers> answers;
  for (const double seconds : o.windows) answers.push_back({ml::concat_text(seconds, " s"), {}});
  answers.push_back({"all lengths", {}});
  Answers chance{"a random window", {}};
  std::vector<ml::FrameSlice> wanted;
  const Index stride = std::max<Index>(1, std::lround(o.stride * fps));
  ProgressBar bar("looking for moments");
  for (Index k = 0; k < o.moments; ++k) {
    auto rng = ml::Philox{.seed = o.seed}.split("moments").split(static_cast<std::uint64_t>(k));
    const LongMotion motion = joined(part, data.width, o.joined, rng.split("clips"));
    if (std::ssize(motion.texts) < 2)
      ml::raise<ml::config_error>(101, "the part '", o.part, "' has fewer than two different texts");
    const auto rows = model.normalised(motion.rows);
    std::vector<ml::FrameSlice> windows;
    std::vector<std::size_t> ends;  // of the windows of each length
    for (const double seconds : o.windows) {
      const auto own = ml::moment_windows(model.frames(rows), std::max<Index>(1, std::lround(seconds * fps)), stride);
      windows.insert(windows.end(), own.begin(), own.end());
      ends.push_back(windows.size());
    }
    const Index width = model.model().width;
    const auto moments = ml::unit_rows(model.encode_windows(rows, windows), width),
               texts = ml::unit_rows(model.encode_texts(motion.texts), width);
    for (std::size_t t = 0; t < motion.texts.size(); ++t) {
      wanted.push_back(motion.stretches[t]);
      std::vector<double> alike(windows.size());
      for (std::size_t w = 0; w < windows.size(); ++w) {
        for (std::size_t c = 0; c < static_cast<std::size_t>(width); ++c)
          alike[w] += static_cast<double>(texts[t * static_cast<std::size_t>(width) + c] *
                                          moments[w * static_cast<std::size_t>(width) + c]);
      }
      const auto best = [&](std::size_t begin, std::size_t end) {
        return ml::best_moment(std::span(windows).subspan(begin, end - begin),
                               std::span(alike).subspan(begin, end - begin));
      };
      for (std::size_t i = 0; i < ends.size(); ++i) answers[i].found.push_back(best(i == 0 ? 0 : ends[i - 1], ends[i]));
      answers.back().found.push_back(best(0, windows.size()));
      chance.found.push_back(windows[rng.below(static_cast<std::uint32_t>(windows.size()))]);
    }
    bar(k + 1, o.moments);
  }
  bar.finish();
  std::printf("%s in %s of %td clips of the %s part; %% found with intersection over union from\n  %-22s",
              ml::counted(wanted.size(), "text").c_str(), ml::counted(o.moments, "motion").c_str(), o.joined,
              o.part.c_str(), "windows");
  for (const double least : overlaps) std::printf(" %7.1f", least);
  std::printf("\n");
  for (const Answers& a : answers) print(a, wanted);
  print(chance, wanted);
}

}  // namespace program
