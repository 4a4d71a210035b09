// SPDX-License-Identifier: MIT
// Bodies of study_counts.hpp.
#pragma once

#include <algorithm>  // any_of, clamp
#include <cmath>      // sqrt
#include <map>        // items
#include <numeric>    // accumulate
#include <set>        // systems
#include <utility>    // pair

#include <motionlang/core/formatted.hpp>
#include <motionlang/metrics/study_counts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline bool passes(const Study& study, const StudyTrial& trial, const StudyAnswer& answer) {
  const int right = study.items[trial.item].right;
  if (study.kind == StudyKind::rating) return trial.shown[0] == right ? answer.rating >= 4 : answer.rating <= 2;
  return !answer.places.empty() && trial.shown[static_cast<std::size_t>(answer.places[0])] == right;
}

/// Collects the answers of the raters who are kept.
class StudyCounter {
 public:
  explicit StudyCounter(const Study& study) : study_(study) {}

  void add(const StudyTrial& trial, const StudyAnswer& answer) {
    ++trials_[{trial.item, std::set<int>(trial.shown.begin(), trial.shown.end())}];
    if (study_.kind == StudyKind::pairs) add_pair(trial, answer);
    if (study_.kind == StudyKind::ranking) {
      for (std::size_t place = 0; place < answer.places.size(); ++place) {
        const int system = trial.shown[static_cast<std::size_t>(answer.places[place])];
        values_[system][trial.item].push_back(static_cast<double>(place + 1));
      }
    }
    if (study_.kind == StudyKind::rating) values_[trial.shown[0]][trial.item].push_back(answer.rating);
  }
  void finish(StudyCounts& out) const {
    double answers = 0;
    for (const auto& [trial, count] : trials_) answers += static_cast<double>(count);
    out.raters_for_item = trials_.empty() ? 0 : answers / static_cast<double>(trials_.size());
    for (const auto& [systems, items] : votes_) out.pairs.push_back(pair_of(systems, items));
    for (const auto& [system, items] : values_) {
      if (study_.kind == StudyKind::ranking)
        out.ranks.push_back({system, counts_of(items, study_.systems.size()), mean_over_items(items)});
      if (study_.kind == StudyKind::rating) {
        RatingCount r{system, {}, mean_over_items(items)};
        const auto counts = counts_of(items, r.ratings.size());
        std::copy(counts.begin(), counts.end(), r.ratings.begin());
        out.ratings.push_back(r);
      }
    }
  }

 private:
  struct Votes {
    std::size_t a = 0, none = 0, b = 0;
  };
  using Items = std::map<std::size_t, std::vector<double>>;

  void add_pair(const StudyTrial& trial, const StudyAnswer& answer) {
    const auto [a, b] = std::minmax(trial.shown[0], trial.shown[1]);
    Votes& votes = votes_[{a, b}][trial.item];
    if (answer.places.empty())
      ++votes.none;
    else
      ++(trial.shown[static_cast<std::size_t>(answer.places[0])] == a ? votes.a : votes.b);
  }
  static PairCount pair_of(const std::pair<int, int>& systems, const std::map<std::size_t, Votes>& items) {
    PairCount out{.a = systems.first, .b = systems.second, .items = items.size()};
    for (const auto& [item, votes] : items) {
      out.votes_a += votes.a, out.votes_none += votes.none, out.votes_b += votes.b;
      ++(votes.a > votes.b ? out.items_a : votes.a < votes.b ? out.items_b : out.items_tied);
    }
    const auto total = static_cast<double>(items.size()), a = static_cast<double>(out.items_a),
               tied = static_cast<double>(out.items_tied);
    out.preferred = wilson_share(a + 0.5 * tied, total);
    out.preferred_or_similar = wilson_share(a + tied, total);
    return out;
  }
  /// How often each of the values 1 ... `largest` occurs.
  static std::vector<std::size_t> counts_of(const Items& items, std::size_t largest) {
    std::vector<std::size_t> out(largest);
    for (const auto& [item, values] : items) {
      for (const double v : values) ++out[static_cast<std::size_t>(v) - 1];
    }
    return out;
  }
  static MeanInterval mean_over_items(const Items& items) {
    std::vector<double> means;
    for (const auto& [item, values] : items)
      means.push_back(std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size()));
    return replication_interval(means);
  }

  const Study& study_;
  std::map<std::pair<std::size_t, std::set<int>>, std::size_t> trials_;
  std::map<std::pair<int, int>, std::map<std::size_t, Votes>> votes_;
  std::map<int, Items> values_;  // of each system: ranks or ratings of each item
};

}  // namespace detail

MOTIONLANG_BODY StudyShare wilson_share(double part, double total) {
  if (!(total > 0)) return {};
  constexpr double z = 1.96;
  const double p = part / total, middle = p + z * z / (2 * total);
  const double reach = z * std::sqrt(p * (1 - p) / total + z * z / (4 * total * total)), below = 1 + z * z / total;
  return {p, std::clamp((middle - reach) / below, 0.0, 1.0), std::clamp((middle + reach) / below, 0.0, 1.0)};
}

MOTIONLANG_BODY double RankCount::share(std::size_t place) const {
  if (place >= places.size())
    raise<shape_error>(203, "RankCount::share: place ", place, " of ", counted(places.size(), "rank"));
  const double all = std::accumulate(places.begin(), places.end(), 0.0);
  return all > 0 ? static_cast<double>(places[place]) / all : 0;
}

MOTIONLANG_BODY StudyCounts count_study(const Study& study, std::span<const StudyAnswers> answers, double pass_share) {
  const bool any_catch = std::any_of(study.items.begin(), study.items.end(),
                                     [](const StudyItem& i) { return i.role == StudyRole::catch_trial; });
  StudyCounts out;
  detail::StudyCounter counter(study);
  for (const StudyAnswers& file : answers) {
    const auto trials = study_trials(study, file.seed);
    StudyRater rater{file.rater, file.answers.size()};
    for (const StudyAnswer& a : file.answers) {
      const StudyTrial& trial = trials[a.trial];
      if (study.items[trial.item].role != StudyRole::catch_trial) continue;
      ++rater.caught;
      rater.passed += detail::passes(study, trial, a) ? 1 : 0;
    }
    rater.kept = !any_catch || (rater.caught > 0 && static_cast<double>(rater.passed) >=
                                                        pass_share * static_cast<double>(rater.caught) - 1e-9);
    for (const StudyAnswer& a : file.answers) {
      const StudyTrial& trial = trials[a.trial];
      if (rater.kept && study.items[trial.item].role == StudyRole::counted) counter.add(trial, a);
    }
    out.raters.push_back(std::move(rater));
  }
  counter.finish(out);
  return out;
}

namespace detail {

inline std::string pair_table(const Study& study, const std::vector<PairCount>& pairs) {
  const auto name = [&](int system) { return study.systems[static_cast<std::size_t>(system)]; };
  const auto share = [](const StudyShare& s) {
    return formatted("%.1f (%.1f to %.1f)", 100 * s.share, 100 * s.low, 100 * s.high);
  };
  std::string out =
      "| a | b | items | votes a / none / b | items a / tie / b | a preferred % (95 %) | preferred or similar % (95 %) "
      "|\n"
      "|---|---|---|---|---|---|---|\n";
  for (const PairCount& p : pairs)
    out += concat_text("| ", name(p.a), " | ", name(p.b), " | ", p.items, " | ", p.votes_a, " / ", p.votes_none, " / ",
                       p.votes_b, " | ", p.items_a, " / ", p.items_tied, " / ", p.items_b, " | ", share(p.preferred),
                       " | ", share(p.preferred_or_similar), " |\n");
  return out;
}
inline std::string rank_table(const Study& study, const std::vector<RankCount>& ranks) {
  std::string out = "| system | mean rank (95 %) |", line = "|---|---|";
  for (std::size_t i = 0; i < study.systems.size(); ++i) {
    out += concat_text(" rank ", i + 1, " % |");
    line += "---|";
  }
  out += "\n" + line + "\n";
  for (const RankCount& r : ranks) {
    out += "| " + study.systems[static_cast<std::size_t>(r.system)];
    out += formatted(" | %.2f +- %.2f |", r.rank.mean, r.rank.half_width);
    for (std::size_t place = 0; place < r.places.size(); ++place) out += formatted(" %.1f |", 100 * r.share(place));
    out += "\n";
  }
  return out;
}
inline std::string rating_table(const Study& study, const std::vector<RatingCount>& ratings) {
  std::string out = "| system | mean (95 %) | 1 | 2 | 3 | 4 | 5 |\n|---|---|---|---|---|---|---|\n";
  for (const RatingCount& r : ratings) {
    out += "| " + study.systems[static_cast<std::size_t>(r.system)];
    out += formatted(" | %.2f +- %.2f | ", r.rating.mean, r.rating.half_width) + join_text(r.ratings, " | ") + " |\n";
  }
  return out;
}

}  // namespace detail

MOTIONLANG_BODY std::string describe_raters(const StudyCounts& counts, std::span<const std::string> files) {
  std::string out;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < counts.raters.size(); ++i) {
    const StudyRater& r = counts.raters[i];
    kept += r.kept ? 1 : 0;
    if (!r.kept)
      out += formatted("left out: %s (%s), %zu of %s passed\n", r.name.c_str(), files[i].c_str(), r.passed,
                       counted(r.caught, "catch trial").c_str());
  }
  return out + formatted("%zu of %s kept, %.1f answers for each trial\n", kept,
                         counted(counts.raters.size(), "rater").c_str(), counts.raters_for_item);
}

MOTIONLANG_BODY std::string study_table(const Study& study, const StudyCounts& counts) {
  if (study.kind == StudyKind::pairs) return detail::pair_table(study, counts.pairs);
  if (study.kind == StudyKind::ranking) return detail::rank_table(study, counts.ranks);
  return detail::rating_table(study, counts.ratings);
}

MOTIONLANG_NAMESPACE_END
