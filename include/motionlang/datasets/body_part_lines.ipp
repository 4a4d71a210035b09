// SPDX-License-Identifier: MIT
// Bodies of body_part_lines.hpp.
#pragma once

#include <algorithm>  // find_if
#include <cmath>      // lround
#include <set>        // labels

#include <motionlang/core/text_lines.hpp>
#include <motionlang/datasets/babel_motions.hpp>
#include <motionlang/datasets/body_part_lines.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/json.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string body_part_questions(std::span<const std::string> labels, BodyPartPrompt form) {
  std::string out;
  for (const std::string& label : labels) {
    nlohmann::ordered_json line;
    line["label"] = label, line["prompt"] = body_part_prompt(label, form);
    out += line.dump() + "\n";
  }
  return out;
}

MOTIONLANG_BODY BodyPartAnswers parse_body_part_answers(std::string_view text, std::string_view name) {
  BodyPartAnswers out;
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    if (detail::trim(line).empty()) return;
    const std::string place = concat_text(name, ":", number);
    const nlohmann::json document = parse_json(line, place);
    const JsonView view(document, place);
    out.emplace_back(view["label"].as<std::string>(), view["answer"].as<std::string>());
  });
  return out;
}

MOTIONLANG_BODY BodyPartAnswers read_body_part_answers(const FilePath& path) {
  const std::string text = read_file(path);
  const auto first = text.find('\n');
  const bool lines = text.substr(0, first).find("\"answer\"") != text.npos;
  if (lines) return parse_body_part_answers(text, path.string());
  const nlohmann::json document = parse_json(text, path.string());
  const JsonView view(document, path.string());
  BodyPartAnswers out;
  for (const std::string& label : view.keys()) out.emplace_back(label, view[label][2].as<std::string>());
  return out;
}

MOTIONLANG_BODY std::vector<std::string> unanswered_labels(std::span<const std::string> labels,
                                                           const BodyPartAnswers& answers) {
  std::set<std::string_view> known;
  for (const auto& [label, answer] : answers) {
    if (known_body_part_answer(answer)) known.insert(label);
  }
  std::vector<std::string> out;
  for (const std::string& label : labels) {
    if (!known.contains(label)) out.push_back(label);
  }
  return out;
}

MOTIONLANG_BODY std::string body_part_table_text(const BodyPartAnswers& answers) {
  nlohmann::ordered_json table = nlohmann::ordered_json::object();
  for (const auto& [label, answer] : answers) table[label] = {"", "", answer};
  return table.dump(1) + "\n";
}

MOTIONLANG_BODY BodyPartTruth parse_body_part_truth(std::string_view text, std::string_view name) {
  BodyPartTruth out;
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    if (detail::trim(line).empty() || line.front() == '#') return;
    std::vector<std::string> fields;
    for (std::size_t begin = 0; begin <= line.size();) {
      const std::size_t end = std::min(line.find('\t', begin), line.size());
      fields.emplace_back(detail::trim(line.substr(begin, end - begin)));
      begin = end + 1;
    }
    if (fields.size() != 1 + sinc_part_count)
      raise<io_error>(403, name, ":", number, ": ", counted(fields.size(), "field"), ", expected a label and six");
    out.labels.push_back(fields.front());
    for (std::size_t p = 1; p < fields.size(); ++p) {
      const std::string& f = fields[p];
      if (f != "0" && f != "0.5" && f != "1") raise<io_error>(403, name, ":", number, ": '", f, "' is not 0, 0.5 or 1");
      out.wanted.push_back(f == "1" ? 1 : f == "0" ? 0 : 0.5);
    }
  });
  return out;
}

MOTIONLANG_BODY std::vector<std::string> parse_label_list(std::string_view text) {
  std::set<std::string> found;
  detail::for_each_line(text, [&](std::string_view line, Index) {
    if (!line.empty()) found.emplace(line);
  });
  return {found.begin(), found.end()};
}

MOTIONLANG_BODY std::vector<std::string> babel_labels(const FilePath& babel, const FilePath& spelling) {
  const auto words = detail::read_spelling(spelling.string());
  SincDataConfig config;
  config.types = "seg+seq";
  config.shortest = 1;
  const BabelReader reader = sinc_reader(config);
  const auto file = BabelFile::open(babel);
  std::set<std::string> found;
  for (const std::string& id : file.ids()) {
    const BabelSequence sequence = file.load(id);
    const Index frames = std::lround(sequence.dur * babel_fps);
    for (const BabelItem& item : reader(sequence, std::max<Index>(frames, 1), words, true).items) {
      for (const DescribedText& t : item.texts) found.insert(t.text);
    }
  }
  return {found.begin(), found.end()};
}

MOTIONLANG_NAMESPACE_END
