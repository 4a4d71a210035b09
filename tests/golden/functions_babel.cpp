// Golden functions: labels of BABEL, and what TEACH and SINC make of them: pairs, simultaneous segments, items,
// sentences.
#include <motionlang/datasets/babel.hpp>
#include <motionlang/datasets/simultaneous_segments.hpp>
#include <motionlang/datasets/sinc_items.hpp>
#include <motionlang/datasets/teach_pairs.hpp>
#include <motionlang/text/joined_labels.hpp>

#include "golden.hpp"

namespace {

using golden::Case, golden::Registration;
namespace ml = motionlang;
using Strings = std::vector<std::string>;

std::string joined(const Strings& list, std::string_view between) {
  std::string out;
  for (const std::string& s : list) {
    if (&s != list.data()) out += between;
    out += s;
  }
  return out;
}
ml::SpellingTable spelling_of(const Case& c) {
  ml::SpellingTable spelling;
  if (!c.text().contains("spelling")) return spelling;
  for (const auto& [word, instead] : c.text()["spelling"].as<std::map<std::string, std::string>>())
    spelling[word] = instead;
  return spelling;
}
/// Compares rows of `width` numbers. NumPy may have recorded a list of no rows without their width.
void out_rows(Case& c, const std::string& name, ml::Index width, const std::vector<ml::Index>& values) {
  const bool flat = values.empty() && c.wants(name) && c.shape("out/" + name) == ml::Shape{0};
  c.out(name, flat ? ml::Shape{0} : ml::Shape{std::ssize(values) / width, width}, values);
}
void out_intervals(Case& c, const std::string& name, const std::vector<ml::BabelSegment>& segments) {
  std::vector<ml::Index> times;
  for (const auto& s : segments) times.insert(times.end(), {s.start, s.end});
  out_rows(c, name, 2, times);
}
void out_texts(Case& c, const std::string& name, const std::vector<ml::BabelSegment>& segments) {
  Strings texts;
  for (const auto& s : segments) texts.push_back(s.text);
  c.out_text(name, joined(texts, "\n"));
}

void label_cleaning(Case& c) {
  const ml::SpellingTable spelling = spelling_of(c);
  Strings cleaned;
  for (const std::string& label : c.text()["labels"].as<Strings>())
    cleaned.push_back(ml::clean_babel_label(label, spelling));
  c.out_text("labels_utf8", joined(cleaned, "\n"));
}

/// An entry of the file whose text the case holds.
struct Entry {
  std::string id;
  bool in_segments;                         // has labels of segments
  std::vector<ml::BabelSegment> intervals;  // of these, or one for the whole motion
};
std::vector<Entry> entries(const Case& c) {
  const auto fps = c.config()["fps"].as<double>();
  const auto frames = c.config()["length"].as<ml::Index>();
  const auto annotations = c.text()["annotations"];
  const ml::BabelFile file = ml::BabelFile::from_text(annotations.json().dump());
  std::vector<Entry> out;
  for (const std::string& id : file.ids()) {
    const ml::BabelSequence s = file.load(id);
    if (!s.frame_annotations.empty()) {
      out.push_back({id, true, ml::babel_intervals(s.frame_annotations[0].labels, fps, frames, spelling_of(c))});
    } else {
      const std::string& label = s.sequence_annotations.at(0).labels.at(0).proc_label;
      out.push_back({id, false, {{0, frames, ml::clean_babel_label(label, spelling_of(c))}}});
    }
  }
  return out;
}

/// First and last frames as published: the last one of the second action is one too far.
void append_split(std::vector<ml::Index>& out, const ml::PairFrames& f) {
  const auto none = ml::FrameRange{-1, 0}, transition = f.transition.value_or(none);
  out.insert(out.end(),
             {f.first.start, f.first.end - 1, transition.start, transition.end - 1, f.second.start, f.second.end});
}
Strings texts_of(const std::vector<ml::ActionPair>& pairs) {
  Strings out;
  for (const auto& p : pairs) out.push_back(p.first.text + "\t" + p.second.text);
  return out;
}

void teach_pair_extraction(Case& c) {
  const auto config = c.config();
  const ml::TeachLengths usual;
  const ml::Index shortest = config.value_or("min_frames", usual.shortest);
  const ml::TeachLengths train{shortest, config.value_or("max_frames_train", usual.longest)},
      evaluation{shortest, config.value_or("max_frames_eval", ml::Index(100'000))};
  for (const Entry& e : entries(c)) {
    const auto valid = [&](const char* type, bool is) { c.out_scalar(std::string("valid_") + type + "_" + e.id, is); };
    valid("seg", e.in_segments), valid("seq", !e.in_segments), valid("pairs", e.in_segments),
        valid("pairs_only", e.in_segments);
    const std::string type = e.in_segments ? "seg" : "seq";
    out_intervals(c, type + "_" + e.id, e.intervals);
    out_texts(c, type + "_texts_utf8_" + e.id, e.intervals);
    if (!e.in_segments) continue;
    const auto pairs = ml::teach_pairs(e.intervals);
    const auto whole = ml::joined_pairs(pairs);
    out_intervals(c, "pairs_only_" + e.id, whole);
    out_texts(c, "pairs_only_texts_utf8_" + e.id, whole);
    std::vector<ml::Index> segments, split, lengths, frames, accepted_train, accepted_eval;
    for (const auto& p : pairs) {
      const auto times = [&](const std::optional<ml::BabelSegment>& s) {
        segments.insert(segments.end(), {s ? s->start : -1, s ? s->end : -1});
      };
      times(p.first), times(p.transition), times(p.second);
      const ml::PairFrames f = p.frames();
      append_split(split, f);
      lengths.insert(lengths.end(), {f.first.size(), f.transition_size(), f.second.size()});
      frames.insert(frames.end(), {f.all().start, f.all().end});
      accepted_train.push_back(ml::is_teach_length(f, train));
      accepted_eval.push_back(ml::is_teach_length(f, evaluation));
    }
    out_rows(c, "segments_" + e.id, 6, segments);
    out_rows(c, "split_" + e.id, 6, split);
    out_rows(c, "lengths_" + e.id, 3, lengths);
    out_rows(c, "frames_" + e.id, 2, frames);
    c.out("accepted_train_" + e.id, accepted_train);
    c.out("accepted_eval_" + e.id, accepted_eval);
    c.out_text("texts_utf8_" + e.id, joined(texts_of(pairs), "\n"));
  }
}

/// Ranges with their labels: one line each, labels separated by tabs.
void out_simultaneous(Case& c, const std::string& ranges, const std::string& labels,
                      const std::vector<ml::SimultaneousSegment>& list) {
  std::vector<ml::Index> times;
  Strings lines;
  for (const auto& s : list) {
    times.insert(times.end(), {s.start, s.end});
    lines.push_back(joined(s.texts, "\t"));
  }
  out_rows(c, ranges, 2, times);
  c.out_text(labels, joined(lines, "\n"));
}

void sinc_simultaneous(Case& c) {
  const auto most = c.config()["simultaneous_max"].as<ml::Index>();
  const auto lists = c.text()["segments"];
  for (ml::Index k = 0; k < lists.size(); ++k) {
    std::vector<ml::BabelSegment> segments;
    for (ml::Index i = 0; i < lists[k].size(); ++i) {
      const auto s = lists[k][i];
      segments.push_back({s[0].as<ml::Index>(), s[1].as<ml::Index>(), s[2].as<std::string>()});
    }
    const auto found = ml::simultaneous_segments(segments, most);
    const std::string number = std::to_string(k);
    c.out_scalar("count" + number, static_cast<double>(found.size()));
    out_simultaneous(c, "ranges" + number, "labels_utf8_" + number, found);
  }
}

void sinc_babel_items(Case& c) {
  const auto most = c.config()["simultaneous_max"].as<ml::Index>();
  for (const Entry& e : entries(c)) {
    if (!e.in_segments) {
      c.out("seq_" + e.id, std::vector<ml::Index>{e.intervals[0].start, e.intervals[0].end});
      c.out_text("seq_label_utf8_" + e.id, e.intervals[0].text);
      continue;
    }
    const auto segments = ml::sinc_segments(e.intervals);
    const auto spatial = ml::simultaneous_segments(segments, most);
    const auto pairs = ml::teach_pairs(e.intervals);
    out_intervals(c, "seg_" + e.id, segments);
    out_texts(c, "seg_labels_utf8_" + e.id, segments);
    c.out_scalar("spatial_count_" + e.id, static_cast<double>(spatial.size()));
    out_simultaneous(c, "spatial_" + e.id, "spatial_labels_utf8_" + e.id, spatial);
    c.out_scalar("pairs_count_" + e.id, static_cast<double>(pairs.size()));
    std::vector<ml::Index> split;
    for (const auto& p : pairs) append_split(split, p.frames());
    out_rows(c, "pairs_split_" + e.id, 6, split);
    c.out_text("pairs_texts_utf8_" + e.id, joined(texts_of(pairs), "\n"));
  }
}

/// Labels in the order of the config, or sorted where there is none.
ml::BodyPartTable part_table(const Case& c) {
  const auto answers = c.text()["table"];
  const ml::Index answer = c.config().value_or("answer_index", ml::Index(2));
  ml::BodyPartTable table;
  for (const std::string& label : c.config().value_or("table_order", answers.keys()))
    table.add(label, answers[label][answer].as<std::string>());
  return table;
}
void append_parts(std::vector<ml::Index>& out, const ml::SincParts& parts) {
  for (std::size_t p = 0; p < parts.size(); ++p) out.push_back(parts[p]);
}

void sinc_body_part_labels(Case& c) {
  const auto table = part_table(c);
  const auto labels = c.text()["labels"].as<Strings>();
  const ml::Index n = std::ssize(labels);
  std::vector<ml::Index> vectors, compatible;
  for (const std::string& a : labels) {
    append_parts(vectors, table.parts(a));
    for (const std::string& b : labels) compatible.push_back(ml::are_compatible(table.parts(a), table.parts(b)));
  }
  c.out("vectors", {n, 6}, vectors);
  c.out("compatible", {n, n}, compatible);
}

void sinc_sentence_variants(Case& c) {
  const auto lists = c.text()["labels"];
  const auto tags = c.text()["tags"];
  const auto tagger = [&](std::string_view sentence) {
    const auto words = tags[std::string(sentence)];
    std::vector<ml::TaggedWord> out;
    for (ml::Index i = 0; i < words.size(); ++i)
      out.push_back({words[i][0].as<std::string>(), words[i][1].as<bool>() ? "VERB" : ""});
    return out;
  };
  const auto out = [&](const std::string& name, ml::Conjunction conjunction) {
    Strings sentences;
    for (ml::Index i = 0; i < lists.size(); ++i)
      sentences.push_back(ml::join_labels(lists[i].as<Strings>(), conjunction, tagger));
    c.out_text(name + "_utf8", joined(sentences, "\n"));
  };
  using enum ml::Conjunction;
  out("while", while_), out("sim", simultaneously), out("comma", comma), out("same_time", same_time);
  out("during", during), out("evaluation", same_time);
}

/// Options of the published samplers. Without a request whole clips are taken.
ml::SincWindow window_of(const Case& c) {
  const ml::SincWindow usual;
  const auto config = c.config();
  const auto request = config.value_or("request_frames", ml::Index(0));
  return {std::max<ml::Index>(request, 0), config.value_or("min_frames", usual.shortest),
          config.value_or("max_frames", usual.longest)};
}

void sinc_frame_window(Case& c) {
  const ml::SincWindow window = window_of(c);
  const auto shift = c.values<ml::Index>("noise/shift");
  std::vector<ml::Index> start, length, accepted, largest;
  for (const ml::Index n : c.values<ml::Index>("in/frames")) {
    const auto slice = window.of(n, [&](ml::Index) { return shift[start.size()]; });
    start.push_back(slice.first), length.push_back(slice.length);
    accepted.push_back(window.accepts(n)), largest.push_back(window.largest_start(n));
  }
  c.out("start", start), c.out("length", length), c.out("accepted", accepted), c.out("largest_shift", largest);
}

/// The draws of one item in the order in which they are asked for.
struct GivenDraws {
  double u;
  std::vector<ml::Index> numbers;
  std::size_t at = 0;

  double uniform() const { return u; }
  std::uint32_t below(std::uint32_t) { return static_cast<std::uint32_t>(numbers.at(at++)); }
};

void sinc_training_item(Case& c) {
  const auto config = c.config();
  const auto list = c.text()["items"];
  std::vector<ml::SincItem> items;
  for (ml::Index i = 0; i < list.size(); ++i) {
    const auto key = list[i]["key"].as<std::string>(), source = key.substr(0, key.find('-'));
    using enum ml::SincSource;
    items.push_back({source == "seg"             ? segment
                     : source == "seq"           ? sequence
                     : source == "spatial_pairs" ? simultaneous
                                                 : pair,
                     list[i]["labels"].as<Strings>(), list[i]["frames"].as<ml::Index>()});
  }
  const ml::BodyPartTable table = part_table(c);
  const ml::SincItems data(items, table);
  for (ml::Index k = 0; k < std::ssize(items); ++k) {
    if (const auto partners = data.partners(k); !partners.empty()) c.out("partners_" + std::to_string(k), partners);
  }
  const ml::SincDrawOptions options{.proportion = config["proportion"].as<double>(),
                                    .synthetic = config.value_or("synthetic", true),
                                    .random = config.value_or("random", false),
                                    .window = window_of(c)};
  const auto which = c.values<ml::Index>("in/item"), position = c.values<ml::Index>("noise/partner_position"),
             bits = c.values<ml::Index>("noise/random_bits"), shift = c.values<ml::Index>("noise/shift");
  const auto u = c.values<double>("noise/u");
  std::vector<ml::Index> synthetic, partner, start, length;
  Strings labels;
  for (std::size_t d = 0; d < which.size(); ++d) {
    GivenDraws draws{u[d], {}};
    if (position[d] >= 0) draws.numbers.push_back(position[d]);
    if (position[d] >= 0 && options.random) {
      const auto from = bits.begin() + static_cast<std::ptrdiff_t>(12 * d);
      draws.numbers.insert(draws.numbers.end(), from, from + 12);
    }
    draws.numbers.push_back(shift[d]);
    const ml::SincElement e = data.draw(which[d], options, draws);
    synthetic.push_back(e.partner.has_value()), partner.push_back(e.partner.value_or(-1));
    start.push_back(e.window.first), length.push_back(e.window.length);
    labels.push_back(joined(e.labels, "\t"));
    std::vector<ml::Index> vectors;
    for (const auto& parts : e.parts) append_parts(vectors, parts);
    c.out("part_vectors_" + std::to_string(d), {std::ssize(e.parts), 6}, vectors);
  }
  c.out("synthetic", synthetic), c.out("partner", partner);
  c.out("window_start", start), c.out("window_length", length);
  c.out_text("labels_utf8", joined(labels, "\n"));
}

const Registration registrations[] = {
    {"babel label cleaning", "text", label_cleaning},
    {"teach pair extraction", "text", teach_pair_extraction},
    {"sinc simultaneous segments", "text", sinc_simultaneous},
    {"sinc babel items", "text", sinc_babel_items},
    {"sinc body part labels", "text", sinc_body_part_labels},
    {"sinc sentence variants", "text", sinc_sentence_variants},
    {"sinc frame window", "integers", sinc_frame_window},
    {"sinc training item", "integers", sinc_training_item},
};

}  // namespace
