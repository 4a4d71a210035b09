// Golden functions: timelines of STMC, their text form, and the integers of a composition.
#include <motionlang/compose/baselines.hpp>
#include <motionlang/compose/plan.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/core/python_random.hpp>
#include <motionlang/features/layout.hpp>

#include "timelines.hpp"

namespace {

using golden::Case, golden::Registration;
namespace ml = motionlang;

/// As published: intervals without a frame are taken.
ml::TimelineTextOptions as_published(const Case& c) {
  return {.fps = c.config().value_or("fps", 20.0), .as_published = true, .name = c.name()};
}

std::string joined_texts(const auto& timelines) {
  std::string out;
  for (const auto& t : timelines) {
    for (const auto& i : t.intervals) out += (out.empty() ? "" : "\n") + i.text;
  }
  return out;
}

/// The integers of all intervals, one row after the other.
template <class T>
void out_timelines(Case& c, const std::vector<ml::BasicTimeline<T>>& timelines) {
  std::vector<ml::Index> ptr{0};
  std::vector<T> start, end;
  std::vector<std::uint8_t> parts;
  for (const auto& t : timelines) {
    for (const auto& i : t.intervals) {
      start.push_back(i.start), end.push_back(i.end);
      for (int p = 0; p < ml::body_part_count; ++p) parts.push_back(i.parts.has(static_cast<ml::BodyPart>(p)));
    }
    ptr.push_back(std::ssize(start));
  }
  c.out("timeline_ptr", ptr);
  c.out("start", start);
  c.out("end", end);
  c.out("parts", {std::ssize(start), ml::body_part_count}, parts);
  c.out_text("texts_utf8", joined_texts(timelines));
}

void timeline_parsing(Case& c) {
  const auto text = c.text().as<std::string>();
  if (c.config()["fps"].is_null())
    out_timelines(c, ml::parse_timelines_in_seconds(text, as_published(c)));
  else
    out_timelines(c, ml::parse_timelines(text, as_published(c)));
}

void timeline_rejection(Case& c) {
  std::vector<std::uint8_t> rejected;
  for (const std::string& text : c.text().as<std::vector<std::string>>()) {
    try {
      ml::parse_timelines(text, as_published(c));
      rejected.push_back(0);
    } catch (const ml::timeline_error&) {
      rejected.push_back(1);
    }
  }
  c.out("rejected", rejected);
}

void text_list(Case& c) {
  std::vector<ml::Index> frames;
  std::string texts;
  for (const ml::TimedText& t : ml::parse_text_list(c.text().as<std::string>(), as_published(c))) {
    texts += (frames.empty() ? "" : "\n") + t.text;
    frames.push_back(t.frames);
  }
  c.out("frames", frames);
  c.out_text("texts_utf8", texts);
}

void timeline_writing(Case& c) {
  c.out_text("file_utf8",
             ml::write_timelines(ml::parse_timelines_in_seconds(c.text().as<std::string>(), as_published(c))));
}

void baseline_timelines(Case& c) {
  std::vector<ml::TimelineInSeconds> single, one;
  for (const auto& t : ml::parse_timelines_in_seconds(c.text().as<std::string>(), as_published(c))) {
    single.push_back(ml::single_track(t));
    one.push_back(ml::one_text(t));
  }
  c.out_text("singletrack_utf8", ml::write_timelines(single));
  c.out_text("onetext_utf8", ml::write_timelines(one));
}

void body_part_indices(Case& c) {
  const ml::FeatureLayout layout = golden::layout_of(c);
  layout.validate();
  for (int p = 0; p < ml::body_part_count; ++p) {
    std::string name(ml::body_part_names[static_cast<std::size_t>(p)]);
    std::replace(name.begin(), name.end(), ' ', '_');
    c.out(name, layout.indices(static_cast<ml::BodyPart>(p)));
  }
}

/// Rows of integers of equal length.
struct Table {
  ml::Index columns;
  std::vector<ml::Index> values{};

  void add(std::initializer_list<ml::Index> row) { values.insert(values.end(), row); }
  void out(Case& c, const std::string& name) const { c.out(name, {std::ssize(values) / columns, columns}, values); }
};

void out_plan(Case& c, const ml::BatchPlan& batch) {
  Table pieces{2}, piece_owner{5}, merged{5}, crops{4}, add{7}, subtract{7}, lerp{5}, net_weight{2};
  std::vector<ml::Index> pieces_ptr{0}, texts, texts_ptr{0}, frames;
  for (ml::Index m = 0; m < std::ssize(batch.timelines); ++m) {
    const ml::TimelinePlan& plan = batch.timelines[static_cast<std::size_t>(m)];
    for (std::size_t k = 0; k < plan.pieces.size(); ++k) {
      pieces.add({plan.pieces[k].start, plan.pieces[k].end});
      texts.insert(texts.end(), plan.pieces[k].intervals.begin(), plan.pieces[k].intervals.end());
      texts_ptr.push_back(std::ssize(texts));
      const ml::PartOwners& o = plan.owners[k];
      piece_owner.add({o[0], o[1], o[2], o[3], o[4]});
    }
    pieces_ptr.push_back(std::ssize(texts_ptr) - 1);
    const auto part = [](ml::BodyPart p) { return static_cast<ml::Index>(p); };
    const auto slices = [&](Table& table, const std::vector<ml::Slice>& list) {
      for (const ml::Slice& s : list) {
        table.add({m, part(s.part), s.crop, s.from.start, s.from.end, s.to.start, s.to.end});
      }
    };
    for (const auto& i : plan.merged) merged.add({m, part(i.part), i.owner, i.range.start, i.range.end});
    for (const auto& i : plan.crops) crops.add({m, i.is_transition(), i.range.start, i.range.end});
    for (const auto& w : plan.lerp) lerp.add({m, part(w.part), w.transition, w.range.start, w.range.end});
    slices(add, plan.add), slices(subtract, plan.subtract);
    const ml::NetWeights net = ml::net_weights(plan);
    net_weight.add({net.smallest, net.largest});
    frames.push_back(plan.frames);
  }
  c.out("pieces_ptr", pieces_ptr), c.out("piece_texts", texts), c.out("piece_texts_ptr", texts_ptr);
  c.out("batch_ptr", batch.first_crop), c.out("n_frames", frames);
  pieces.out(c, "pieces"), piece_owner.out(c, "piece_owner"), merged.out(c, "merged"), crops.out(c, "crops");
  add.out(c, "add"), subtract.out(c, "subtract"), lerp.out(c, "lerp"), net_weight.out(c, "net_weight");
}

template <class G>
ml::BatchPlan planned(const Case& c, G ties) {
  const auto timelines = golden::timelines_of(c);
  const auto overlap = c.values<ml::Index>("in/overlap");
  std::vector<ml::TimelinePlan> plans;
  for (std::size_t m = 0; m < timelines.size(); ++m) {
    ml::PlanOptions options = golden::plan_options(c);
    options.overlap = overlap.at(m);
    plans.push_back(ml::plan_timeline(timelines[m], options, ties));
  }
  return ml::batch_plans(std::move(plans));
}

void timeline_processing(Case& c) {
  const bool random = c.config().value_or("ties", "lowest") == "cpython_random";
  out_plan(c, random ? planned(c, golden::seeded<ml::PythonRandom>(c.config()["seed"])) : planned(c, ml::FirstWins{}));
}

/// 0 accepted, 1 gap, 2 a cut at which no part changes its owner.
void timeline_processing_errors(Case& c) {
  const auto timelines = golden::timelines_of(c);
  const auto overlap = c.values<ml::Index>("in/overlap");
  std::vector<ml::Index> kind;
  for (std::size_t m = 0; m < timelines.size(); ++m) {
    try {
      ml::plan_timeline(timelines[m], {.overlap = overlap.at(m), .gaps = ml::Gaps::refuse});
      kind.push_back(0);
    } catch (const ml::timeline_error& e) {
      kind.push_back(e.id() == 505 ? 1 : e.id() == 506 ? 2 : e.id());
    }
  }
  c.out("kind", kind);
}

const Registration registrations[] = {
    {"stmc timeline parsing", "integers", timeline_parsing},
    {"stmc timeline rejection", "integers", timeline_rejection},
    {"stmc text list parsing", "integers", text_list},
    {"stmc timeline writing", "integers", timeline_writing},
    {"stmc baseline timelines", "integers", baseline_timelines},
    {"stmc body part indices", "integers", body_part_indices},
    {"stmc timeline processing", "integers", timeline_processing},
    {"stmc timeline processing errors", "integers", timeline_processing_errors},
};

}  // namespace
