// SPDX-License-Identifier: MIT
// Bodies of mtt_timelines.hpp.
#pragma once

#include <algorithm>  // find_if
#include <cmath>      // trunc
#include <optional>   // timelines

#include <motionlang/compose/baselines.hpp>
#include <motionlang/compose/detail/timeline_line.hpp>
#include <motionlang/compose/mtt_timelines.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/core/python_random.hpp>
#include <motionlang/core/rounding.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<MttText> parse_mtt_texts(std::string_view file, std::string_view name) {
  std::vector<MttText> out;
  detail::for_each_line(file, [&](std::string_view content, Index number) {
    if (detail::trim(content).empty()) return;
    const detail::TimelineLine line(content, number, name);
    if (line.fields() < 2) line.fail(501, line.fields(), "expected 'text # body part'");
    out.push_back({line.text(), line.parts(1, {})});
  });
  if (out.empty()) raise<timeline_error>(507, name, ": no line");
  return out;
}

namespace detail {

class MttGenerator {
 public:
  MttGenerator(std::span<const MttText> texts, const MttOptions& options)
      : texts_(texts), options_(options), random_(options.seed) {
    for (const MttText& t : texts) {
      Index weight = 0;
      for (int p = 0; p < body_part_count; ++p) {
        if (t.parts.has(static_cast<BodyPart>(p))) weight += options.weights[static_cast<std::size_t>(p)];
      }
      weights_.push_back(weight);
    }
  }

  /// One timeline, or nothing if no text is left for the second track.
  std::optional<TimelineInSeconds> draw() {
    const auto pair = random_.sample_counts(weights_, 2);
    const MttText &one = at(pair[0]), &two = at(pair[1]);
    const double d1 = duration(random_.gauss(options_.mean, options_.std));
    const double d2 = duration(random_.gauss(options_.mean, options_.std));
    struct Window {
      double length, offset;
      BodyParts taken;
    };
    const Window left{d1, 0, one.parts}, right{d2, d1, two.parts},
        both{std::min(d1 + d2, options_.cap), 0, united(one.parts, two.parts)};
    const std::array<const Window*, 4> places{&left, &right, d1 > d2 ? &left : &right, &both};
    constexpr std::array<Index, 4> often{2, 2, 2, 1};
    const Window& window = *places[static_cast<std::size_t>(random_.sample_counts(often, 1)[0])];

    const double drawn = python_round(options_.mean + options_.std * random_.gauss(0, 1), 2);
    std::vector<Index> candidates;
    for (Index k = 0; k < std::ssize(texts_) && drawn <= window.length; ++k) {
      if ((at(k).parts.bits & window.taken.bits) == 0 && k != pair[0] && k != pair[1]) candidates.push_back(k);
    }
    if (candidates.empty()) return std::nullopt;
    const MttText& third = at(candidates[static_cast<std::size_t>(random_.choice(std::ssize(candidates)))]);
    const double d3 = std::min(drawn, options_.cap);
    const double start = python_round(window.offset + random_.uniform(0, window.length - d3), 2);
    TimelineInSeconds out{{{one.text, 0, d1, one.parts},
                           {two.text, d1, d1 + d2, two.parts},
                           {third.text, start, start + d3, third.parts}}};
    for (auto& i : out.intervals) i.start = hundredths(i.start), i.end = hundredths(i.end);
    return out;
  }

 private:
  const MttText& at(Index k) const { return texts_[static_cast<std::size_t>(k)]; }
  double duration(double drawn) const { return std::min(python_round(drawn, 2), options_.cap); }
  /// Seconds as written, which may lose a hundredth.
  static double hundredths(double seconds) { return std::trunc(seconds * 100) / 100; }

  std::span<const MttText> texts_;
  const MttOptions& options_;
  PythonRandom random_;
  std::vector<Index> weights_;
};

}  // namespace detail

MOTIONLANG_BODY std::vector<TimelineInSeconds> mtt_timelines(std::span<const MttText> texts,
                                                             const MttOptions& options) {
  detail::MttGenerator generator(texts, options);
  std::vector<TimelineInSeconds> out;
  for (int misses = 0; std::ssize(out) < options.count;) {
    if (auto timeline = generator.draw()) {
      out.push_back(std::move(*timeline));
      misses = 0;
    } else if (++misses > 100'000) {  // the published loop would not end
      raise<config_error>(102, "mtt_timelines: of ", counted(texts.size(), "text"), " none fits beside two others");
    }
  }
  return out;
}

MOTIONLANG_BODY MttFiles mtt_files(std::span<const TimelineInSeconds> timelines) {
  std::vector<TimelineInSeconds> single, one;
  for (const TimelineInSeconds& t : timelines) {
    single.push_back(single_track(t));
    one.push_back(one_text(t));
  }
  return {write_timelines(timelines), write_timelines(single), write_timelines(one)};
}

MOTIONLANG_BODY std::vector<Index> mtt_labels(std::span<const MttText> texts, const TimelineInSeconds& timeline) {
  std::vector<Index> out;
  for (const IntervalInSeconds& i : timeline.intervals) {
    const auto found = std::find_if(texts.begin(), texts.end(), [&](const MttText& t) { return t.text == i.text; });
    if (found == texts.end())
      raise<config_error>(102, "mtt_labels: '", i.text, "' is not among the ", counted(texts.size(), "text"));
    out.push_back(found - texts.begin());
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
